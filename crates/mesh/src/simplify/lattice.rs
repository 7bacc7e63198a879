//! Places of vertices as whole numbers, so that every decision about them is exact.

use glam::{DVec3, I64Vec3};

/// Number of bits of a coordinate within the domain. Products of three differences, and sums of six
/// such products, fit 128 bits.
const BITS: i32 = 39;
/// Number of bits of a coordinate from the origin, so that each is exact in `f64`.
const BITS_FROM_ORIGIN: i32 = 52;
/// Number of bits of the significand of `f32`.
const BITS_OF_SINGLE: i32 = 24;

/// A grid of points in the domain.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// The place of (0, 0, 0), a multiple of the unit and of the step.
    base: DVec3,
    /// Distance between neighbors, in world units: a power of two.
    pub unit: f64,
    /// Coordinates are to be multiples of this many units, a power of two.
    step: i64,
    /// True if such coordinates are `f32`.
    pub is_single: bool,
}

impl Lattice {
    /// The grid for the box between two points. Coordinates are to be `f32`, unless these are
    /// farther apart than `most`.
    pub fn new([low, high]: [DVec3; 2], most: f64) -> Self {
        let largest = exponent(low.abs().max(high.abs()).max_element());
        let fine = (exponent((high - low).max_element()) - BITS).max(largest - BITS_FROM_ORIGIN);
        let single = fine.max(largest - BITS_OF_SINGLE);
        let is_single = single_spacing([low, high]) <= most;
        let coarse = if is_single { single } else { fine };
        let spacing = power(coarse);
        let base = (low / spacing).floor() * spacing;
        Self { base, unit: power(fine), step: 1 << (coarse - fine), is_single }
    }

    /// The length of a step, in world units.
    pub fn step_length(&self) -> f64 {
        self.unit * self.step as f64
    }

    /// The nearest point of the grid.
    pub fn nearest(&self, place: DVec3) -> I64Vec3 {
        ((place - self.base) / self.unit).round().as_i64vec3()
    }

    /// The eight points around a point whose coordinates are multiples of a step, the nearest
    /// first.
    pub fn around(&self, point: I64Vec3) -> [I64Vec3; 8] {
        let low = point - (point & (self.step - 1));
        let corner = |k: i64| low + I64Vec3::new(k & 1, k >> 1 & 1, k >> 2) * self.step;
        let mut all = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
        all.sort_by_key(|corner| (*corner - point).length_squared());
        all
    }

    /// Returns whether a point's coordinates are multiples of a step.
    pub fn is_round(&self, point: I64Vec3) -> bool {
        (point.x | point.y | point.z) & (self.step - 1) == 0
    }

    /// The place of a point, exact.
    pub fn place(&self, point: I64Vec3) -> DVec3 {
        self.base + point.as_dvec3() * self.unit
    }

    /// The place of a point between others, rounded.
    pub fn between(&self, point: DVec3) -> DVec3 {
        self.base + point * self.unit
    }

    /// The place of a point from the grid's origin, in world units.
    pub fn relative(&self, point: I64Vec3) -> DVec3 {
        point.as_dvec3() * self.unit
    }

    /// The nearest rounded point to a place from the grid's origin.
    pub fn rounded_relative(&self, place: DVec3) -> I64Vec3 {
        (place / self.step_length()).round().as_i64vec3() * self.step
    }
}

/// The least whole number e with x ≤ 2ᵉ, for a finite x above 0.
/// The largest distance between neighboring `f32` between two points, on one axis.
pub fn single_spacing([low, high]: [DVec3; 2]) -> f64 {
    power(exponent(low.abs().max(high.abs()).max_element()) - BITS_OF_SINGLE)
}

fn exponent(x: f64) -> i32 {
    let bits = (x.to_bits() >> 52) as i32 - 1023;
    bits + i32::from(x > power(bits))
}

fn power(exponent: i32) -> f64 {
    2.0_f64.powi(exponent)
}
