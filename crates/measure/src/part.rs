//! A solid's part of one box: its integrals and its ends, between two bounds.

use crate::clip::{Moments, Strip, clip, cube};
use crate::density::{Clipped, DensityFault, Weight};
use crate::wall::Wall;
use glam::DVec3;
use zeroset_interval::Interval;
use zeroset_space::{Cell, Region};

/// Bound of rounding errors: of a part's integrals relative to the integrals over the whole box,
/// and of coordinates and function values in a box.
pub const ROUNDING: f64 = 1e-13;
/// Width of a whole box's weighted integral, relative to the integral, that may be rounding alone.
const WIDTH_OF_ROUNDING: f64 = 32.0 * ROUNDING;
/// Space at the ends of a wall's box, as a share of the wall's extent.
const SPARE: f64 = 1e-3;
/// A wall's box is made smaller if its extent becomes smaller by this factor.
const SNUG: f64 = 0.9;

/// A solid's part of a box, and whether the boundary may cut it. `None` if it is empty.
pub type Found = Option<(Part, bool)>;

/// A solid's part of a box.
#[derive(Clone, Copy)]
pub struct Part {
    /// The box.
    pub cell: Cell,
    /// The axis along which the part is a wall's thickness. The box is then halved along the other
    /// axes only.
    axis: Option<usize>,
    /// Lower and upper bounds of the integrals over the part.
    pub moments: [Moments; 2],
    /// The corners of a box whose sides the part is proven to reach. `None` if no point is proven.
    pub inner: Option<[DVec3; 2]>,
    /// The corners of a box around the part.
    pub outer: [DVec3; 2],
    /// Bounds of the integrals' sizes over the whole box.
    pub size: Moments,
    /// Bounds of the density, and whether it has a value at each point of the box.
    pub density: (Interval, bool),
    /// The density's fault in the box.
    pub fault: Option<DensityFault>,
}

impl Part {
    /// Width of the volume's bounds.
    pub fn width(&self) -> f64 {
        self.moments[1].volume - self.moments[0].volume
    }

    /// The boxes whose parts make up this one. `None` if the box is too small to be halved.
    pub fn halves(&self) -> Option<impl Iterator<Item = Cell> + use<>> {
        let (cell, axis) = (self.cell, self.axis);
        let is_proper = cell.parts().all(|half| (0..3).all(|axis| half.extent(axis) > 0.0));
        let halves = cell.parts().filter_map(move |mut half| {
            if let Some(k) = axis {
                if half.low[k] > cell.low[k] {
                    return None;
                }
                half.high[k] = cell.high[k];
            }
            Some(half)
        });
        is_proper.then_some(halves)
    }

    /// The box without the ends along the axis that are proven not to hold the wall. `None` if it
    /// is not much smaller.
    pub fn snug(&self) -> Option<Cell> {
        let k = self.axis?;
        let [low, high] = self.outer.map(|corner| corner[k]);
        let spare = SPARE * (high - low) + 1e3 * f64::EPSILON * low.abs().max(high.abs());
        let mut snug = self.cell;
        snug.low[k] = snug.low[k].max(low - spare);
        snug.high[k] = snug.high[k].min(high + spare);
        (snug.extent(k) < SNUG * self.cell.extent(k) && snug.extent(k) > 0.0).then_some(snug)
    }
}

/// The place of a box.
pub struct Frame {
    middle: DVec3,
    half: DVec3,
    origin: DVec3,
    /// Rounding of a coordinate, as a share of the box.
    rounding: DVec3,
}

impl Frame {
    /// The place of a box, whose integrals take coordinates from `origin`.
    pub fn of(cell: &Cell, origin: DVec3) -> Self {
        let (low, high) = (DVec3::from_array(cell.low), DVec3::from_array(cell.high));
        let half = 0.5 * (high - low);
        let rounding =
            DVec3::splat(ROUNDING) + 8.0 * f64::EPSILON * low.abs().max(high.abs()) / half;
        Self { middle: 0.5 * (low + high), half, origin, rounding }
    }

    /// The strip with the rounding of the box's coordinates and of the strip's values. Its width is
    /// never 0, since a function that is 0 has no proven sign.
    pub fn rounded(&self, strip: Strip) -> Strip {
        let slack =
            strip.slope.abs().dot(self.rounding) + ROUNDING * strip.value.abs() + f64::MIN_POSITIVE;
        Strip { error: strip.error + slack, ..strip }
    }

    /// The part of the box where all functions are at most 0. It is a wall if one is given. Its
    /// integrals are weighted by the density, if there is one.
    pub fn part(
        &self,
        cell: &Cell,
        strips: &[Strip],
        is_defined: bool,
        wall: Option<&Wall>,
        weight: Option<&Weight>,
    ) -> Found {
        let mut outer = cube();
        let mut inner = if is_defined { cube() } else { Vec::new() };
        let mut is_cut = !is_defined;
        for strip in strips {
            let (least, most) = strip.bounds();
            if most <= 0.0 {
                continue;
            }
            if least > 0.0 {
                return None;
            }
            // Also if the bounds are not finite.
            is_cut = true;
            if !(least.is_finite() && most.is_finite()) {
                inner.clear();
                continue;
            }
            outer = clip(&outer, strip, -strip.error);
            inner = clip(&inner, strip, strip.error);
        }
        if outer.is_empty() {
            return None;
        }
        let all = if is_cut { Moments::of(&outer) } else { Moments::CUBE };
        let sure = if is_cut { Moments::of(&inner) } else { Moments::CUBE };
        let moved = |moments: Moments| moments.moved(self.middle - self.origin, self.half);
        let hull = |tetrahedra: &[[DVec3; 4]]| {
            let corners = tetrahedra.as_flattened();
            let low = corners.iter().copied().reduce(DVec3::min)?;
            let high = corners.iter().copied().reduce(DVec3::max)?;
            Some([low, high].map(|corner| self.middle + self.half * corner))
        };
        // In one box, each coordinate and each product has one sign. So the integrals over the part
        // are between those over the two polyhedra.
        let mut part = Part {
            cell: *cell,
            axis: None,
            moments: Moments::ordered([sure, all].map(moved)),
            inner: hull(&inner),
            outer: hull(&outer)?,
            size: Moments::most((self.middle - self.origin).abs() + self.half, self.half),
            density: (Interval::ONE, true),
            fault: None,
        };
        if let Some(wall) = wall {
            self.narrow(&mut part, wall);
        }
        if let Some(weight) = weight {
            let clipped = Clipped { inner: is_cut.then_some(&inner), sure, all };
            self.weigh(&mut part, weight, &clipped);
            // A box in which the density bends, or has no bounds, may be halved, too.
            let size = part.size.volume;
            let is_exact = size.is_finite() && part.width() <= WIDTH_OF_ROUNDING * size;
            is_cut |= !(is_exact && weight.is_defined);
        }
        Some((part, is_cut))
    }

    /// Weights the integrals over a part by the density.
    fn weigh(&self, part: &mut Part, weight: &Weight, clipped: &Clipped<'_>) {
        let moved = |moments: Moments| moments.moved(self.middle - self.origin, self.half);
        let rounding = self.rounding.element_sum();
        let (moments, size) = weight.weighted(part.moments, clipped, &moved, rounding);
        part.moments = moments;
        part.size = part.size.times(size);
        part.density = (weight.range(), weight.is_defined);
        part.fault = weight.fault(clipped, &|point| self.middle + self.half * point);
    }

    /// Narrows the bounds of a part that is a wall.
    fn narrow(&self, part: &mut Part, wall: &Wall) {
        let axis = wall.axis();
        let (strip, slope) = (self.rounded(wall.strip), self.rounded(wall.slope));
        let Some(volume) = wall.volume(strip, slope) else { return };
        part.axis = wall.is_thin(self.half).then_some(axis);
        // The box's extents are rounded.
        let slack = 4.0 * self.rounding.element_sum();
        let scale = self.half.element_product();
        let lo = (scale * volume.lo * (1.0 - slack)).max(part.moments[0].volume);
        let hi = (scale * volume.hi * (1.0 + slack)).min(part.moments[1].volume);
        let Some(volume) = Interval::new(lo, hi) else { return };
        let range = |axis: usize| {
            let [one, other] = part.outer.map(|corner| corner[axis] - self.origin[axis]);
            Interval { lo: one, hi: other }
        };
        let [x, y, z] = [0, 1, 2].map(range);
        part.moments = Moments::within(part.moments, volume, [x, y, z]);
        if part.inner.is_none() && lo > 0.0 {
            // There is a point of the solid in the outer box, but its place is not known.
            part.inner = Some([part.outer[1], part.outer[0]]);
        }
    }
}

/// The region's plane and ball in a box, as far as they cut it. `None` if the box is proven to lie
/// outside of the region.
pub fn cuts(region: &Region, frame: &Frame) -> Option<Vec<Strip>> {
    let &Frame { middle, half, .. } = frame;
    let mut strips = Vec::new();
    if let Some(plane) = region.clip() {
        let slope = plane.normal * half;
        let value = plane.normal.dot(middle) - plane.offset;
        let size = plane.normal.abs().dot(middle.abs()) + plane.offset.abs();
        strips.push(frame.rounded(Strip { value, slope, error: ROUNDING * size }));
    }
    if let Some(ball) = region.ball() {
        let way = middle - ball.centre;
        // The squares of the distance from the middle are between 0 and this.
        let bend = half.length_squared();
        let square = ball.radius * ball.radius;
        let value = way.length_squared() - square + 0.5 * bend;
        let size = (middle.abs() + ball.centre.abs()).length_squared() + square + bend;
        let error = 0.5 * bend + ROUNDING * size;
        strips.push(frame.rounded(Strip { value, slope: 2.0 * way * half, error }));
    }
    strips.retain(|strip| {
        let (_, most) = strip.bounds();
        most > 0.0 || most.is_nan()
    });
    let is_outside = strips.iter().any(|strip| strip.bounds().0 > 0.0);
    (!is_outside).then_some(strips)
}
