//! A density: a function by which integrals over a solid are weighted.
//!
//! In a box, it lies near a polynomial of degree 2. The integrals of the polynomial are exact over
//! the whole box, and those of a linear function over polyhedra. So the error of the density falls
//! with the cube of a box's size where it bends smoothly, and with the square where the boundary
//! cuts the box.

use crate::clip::{Moments, Tetrahedron};
use crate::taylor::{Derivatives, Quadratic};
use crate::wall::{enclosures, sides, value};
use glam::DVec3;
use thiserror::Error;
use zeroset_interval::Interval;
use zeroset_scene::coordinate::{coordinate, decimal};
use zeroset_scene::program::{Program, ProgramError};
use zeroset_space::Cell;
use zeroset_syntax::Document;

/// Bound of rounding errors, relative to the largest values.
const ROUNDING: f64 = 1e-13;

/// A function by which integrals over a solid are weighted.
pub struct Density {
    function: Program,
    /// Its partial derivatives. `None` if these are too large.
    slopes: Option<Program>,
}

/// A reason why a solid has no mass.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DensityFault {
    /// The density has no value at a point of the solid.
    #[error("the density has no value in the solid near ({})", listed(.0))]
    Undefined(DVec3),
    /// The density has no bounds in a small box.
    #[error(
        "the mass may be infinite: the density is not proven to be bounded in the solid near ({}), \
         where it may have a pole", listed(.0)
    )]
    Unbounded(DVec3),
}

/// A point with four digits of its largest coordinate.
fn listed(point: &DVec3) -> String {
    let largest = point.abs().max_element().max(f64::MIN_POSITIVE);
    let unit = largest.log10().ceil() as i32 - 4;
    point.to_array().map(|along| coordinate(decimal(along, unit))).join(", ")
}

impl Density {
    /// The density whose formula is the one surface of a document, in a domain.
    ///
    /// # Errors
    /// If the formula is too large, or a kernel is not available.
    pub fn new(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        let function = Program::unchecked(document, domain)?;
        function.kernels::<f64>(0).bounds()?;
        let slopes = function.slopes(0).ok();
        let is_made =
            |program: &Program, axis: usize| program.kernels::<f64>(axis).gradient_bounds().is_ok();
        // Without derivatives, bounds are only wider.
        let slopes = slopes
            .filter(|slopes| is_made(&function, 0) && (0..3).all(|axis| is_made(slopes, axis)));
        Ok(Self { function, slopes })
    }

    /// The density in each of up to sixteen boxes.
    pub fn in_boxes(&self, cells: &[Cell]) -> Vec<Weight> {
        let boxes: Vec<[Interval; 3]> = cells.iter().map(sides).collect();
        let Ok(kernel) = self.function.kernels::<f64>(0).bounds() else {
            return vec![Weight::UNKNOWN; cells.len()];
        };
        let bounds = enclosures(kernel, &boxes);
        let slopes = self.slopes.as_ref().filter(|_| bounds.defined != 0);
        let derivatives =
            slopes.and_then(|slopes| Derivatives::of((&self.function, 0), Some(slopes), cells));
        let weight = |(lane, cell): (usize, &Cell)| {
            let is = |mask: u16| mask >> lane & 1 == 1;
            let range = value(&bounds, lane);
            let form = derivatives.as_ref().filter(|_| is(bounds.defined));
            Weight {
                range,
                is_defined: is(bounds.defined),
                is_undefined: is(bounds.nowhere),
                form: form.and_then(|derivatives| derivatives.form(cell, lane)),
            }
        };
        cells.iter().enumerate().map(weight).collect()
    }
}

/// A density in a box.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// Bounds of the values that it has.
    range: Interval,
    /// True if it has a value at each point of the box.
    pub is_defined: bool,
    /// True if it has no value in the box.
    is_undefined: bool,
    /// A polynomial near the density.
    form: Option<Quadratic>,
}

/// A solid's part of a box, in the cube's coordinates.
pub struct Clipped<'a> {
    /// Tetrahedra that are proven to lie inside. `None` if all of the box does.
    pub inner: Option<&'a [Tetrahedron]>,
    /// The integrals over the tetrahedra.
    pub sure: Moments,
    /// The integrals over a polyhedron around the part.
    pub all: Moments,
}

impl Weight {
    /// A density of which nothing is known.
    const UNKNOWN: Self =
        Self { range: Interval::ENTIRE, is_defined: false, is_undefined: false, form: None };

    /// Bounds of the values. They include 0 if the density may be undefined at some points. They
    /// are all reals if it is undefined everywhere: then the box holds no part of the solid, or the
    /// density is at fault.
    pub fn range(&self) -> Interval {
        match (self.is_undefined, self.is_defined) {
            (true, _) => Interval::ENTIRE,
            (false, true) => self.range,
            (false, false) => self.range.hull(Interval::ZERO),
        }
    }

    /// The density's fault if the solid has these points in the box, in the cube's coordinates.
    /// `placed` takes a point from there to space.
    pub fn fault(
        &self,
        part: &Clipped<'_>,
        placed: &dyn Fn(DVec3) -> DVec3,
    ) -> Option<DensityFault> {
        let point = match part.inner {
            None => DVec3::ZERO,
            Some(inner) => inner.first()?.iter().sum::<DVec3>() / 4.0,
        };
        self.is_undefined.then(|| DensityFault::Undefined(placed(point)))
    }

    /// Bounds of the weighted integrals over a solid's part of a box. `bounds` are those of the
    /// integrals, `moved` takes integrals from the cube's coordinates to theirs. Each has one sign
    /// in all of the box. `rounding` is that of the cube's coordinates. Also returns a bound of the
    /// density's size.
    pub fn weighted(
        &self,
        bounds: [Moments; 2],
        part: &Clipped<'_>,
        moved: &dyn Fn(Moments) -> Moments,
        rounding: f64,
    ) -> ([Moments; 2], f64) {
        let range = self.range();
        let [least, most] = bounds.map(|bound| bound.to_array());
        let plain = |k: usize| Interval { lo: least[k], hi: most[k] };
        // A mean of the density times the integral.
        let mut found = std::array::from_fn(|k| plain(k).times(range));
        let mut size = range.magnitude();
        if let Some(form) = &self.form {
            let linear = form.linear();
            let (inner, error) = match part.inner {
                None => (form.moments(), form.error),
                Some(inner) => (Moments::weighted(inner, &linear), linear.error),
            };
            let error = error + (ROUNDING + rounding) * form.size();
            let [inner, sure, all] = [inner, part.sure, part.all].map(|of| moved(of).to_array());
            let around = |value: f64| Interval { lo: value, hi: value };
            let spread = Interval { lo: -error, hi: error };
            let beyond = range.hull(Interval::ZERO);
            for (k, found) in found.iter_mut().enumerate() {
                let near = around(inner[k])
                    .plus(spread.times(around(sure[k])))
                    .plus(beyond.times(around(all[k] - sure[k])));
                let (lo, hi) = (near.lo.max(found.lo), near.hi.min(found.hi));
                if lo <= hi {
                    *found = Interval { lo, hi };
                }
            }
            size = size.max(form.size());
        }
        let ends = [found.map(|one| one.lo), found.map(|one| one.hi)];
        (ends.map(Moments::from_array), size)
    }
}
