//! Zeros on single rays, located as closely as `f64` can prove.

use super::Model;
use crate::picture::{Picture, Settings};
use glam::DVec3;
use zeroset_eval::{Boxes, Enclose, Kernel, LANES};
use zeroset_interval::{Facts, Interval};
use zeroset_space::Ray;
use zeroset_trace::{DEPTH, RayGrid, Status};

/// Most times that a bracket is divided. Each time leaves a seventeenth of its length.
const ROUNDS: usize = 32;

/// Most changes of sign that are examined. A function may jump before it is zero.
const JUMPS: usize = 8;

/// Most digits behind the decimal point.
const MOST_DIGITS: usize = 17;

/// The surface's point on a ray.
pub struct Located {
    /// Bounds of t, between which the function changes its sign.
    pub t: [f64; 2],
    /// Bounds of the coordinates x, y and z.
    pub at: [Interval; 3],
}

impl Model {
    /// Locates the zero of a surface's function on `ray` that is at most `reach` from t = `near`;
    /// the first one, if there are several. `None` if no zero with a change of sign is proven
    /// there.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn locate(&self, surface: usize, ray: &Ray, near: f64, reach: f64) -> Option<Located> {
        let kernel = self.program.kernels::<f64>(surface).bounds().ok()?;
        let domain = self.program.domain();
        let line = Line { kernel, ray, domain };
        let (mut from, to) = ((near - reach).max(0.0), near + reach);
        for _ in 0..JUMPS {
            let t = line.change_of_sign([from, to])?;
            let [low, high] = t.map(|t| point(ray, t));
            let at = [0, 1, 2].map(|axis| low[axis].hull(high[axis]));
            // A solid has a face where its function jumps. An equation has no zero there.
            if self.styles[surface].is_solid || line.is_continuous(&at) {
                return Some(Located { t, at });
            }
            from = t[1];
        }
        None
    }

    /// Approximate error of the point that a pixel of a picture shows, in world units.
    pub fn reach(
        &self,
        picture: &Picture,
        rays: &RayGrid,
        settings: &Settings,
        pixel: usize,
    ) -> f64 {
        let method = picture.method_of(picture.buffer.surface[pixel].into());
        if method.reads.contains(&DEPTH) {
            let extent = 2.0 * self.region.half_extent();
            extent * 0.5_f64.powi(settings.options.depth as i32)
        } else {
            settings.options.tolerance * rays.footprint(picture.buffer.drawn[pixel])
        }
    }

    /// Locates the surface point that a pixel of a picture shows. `None` if the pixel is no hit, or
    /// shows a cap, or if no change of sign is proven there.
    pub fn locate_pixel(
        &self,
        picture: &Picture,
        rays: &RayGrid,
        settings: &Settings,
        pixel: usize,
    ) -> Option<Located> {
        let buffer = &picture.buffer;
        let is_cap = buffer.cap.get(pixel).is_some_and(|cap| *cap);
        if buffer.status[pixel] != Status::Hit || is_cap {
            return None;
        }
        let ray = rays.ray_of(pixel);
        let near = ray.parameter(buffer.drawn[pixel]);
        let reach = 2.0 * ray.parameter(self.reach(picture, rays, settings, pixel));
        self.locate(buffer.surface[pixel].into(), &ray, near, reach)
    }
}

/// A function on a ray.
struct Line<'a> {
    kernel: &'a dyn Kernel<Enclose, f64>,
    ray: &'a Ray,
    /// The domain of the kernel.
    domain: [Interval; 3],
}

impl Line<'_> {
    /// Returns the function's proven signs: `Some(true)` where it is above zero.
    fn signs(&self, places: &[f64]) -> Vec<Option<bool>> {
        let is_inside = |point: &[Interval; 3]| {
            point.iter().zip(&self.domain).all(|(at, axis)| axis.lo <= at.lo && at.hi <= axis.hi)
        };
        let points: Vec<[Interval; 3]> = places.iter().map(|t| point(self.ray, *t)).collect();
        let boxes: Vec<_> = points
            .iter()
            .map(|point| if is_inside(point) { *point } else { self.domain })
            .collect();
        let bounds = self.kernel.eval_all(&Boxes::around(&boxes)).remove(0);
        let sign = |(lane, point): (usize, &[Interval; 3])| {
            let is_above = bounds.neg_lo[lane] < 0.0;
            let is_proven = is_above || bounds.hi[lane] < 0.0;
            let is_defined = bounds.facts(lane).has(Facts::DEFINED);
            (is_proven && is_defined && is_inside(point)).then_some(is_above)
        };
        points.iter().enumerate().map(sign).collect()
    }

    /// Returns whether the function is proven continuous in a box within the domain.
    fn is_continuous(&self, range: &[Interval; 3]) -> bool {
        let bounds = self.kernel.eval_all(&Boxes::around(&[*range])).remove(0);
        bounds.facts(0).has(Facts::TOTAL)
    }

    /// Narrows a stretch of the ray to the first change of sign in it.
    fn change_of_sign(&self, mut ends: [f64; 2]) -> Option<[f64; 2]> {
        let between = |[from, to]: [f64; 2], k: usize| {
            from + (to - from) * (k as f64 + 1.0) / (LANES as f64 + 1.0)
        };
        let mut before = None;
        for round in 0..ROUNDS {
            let places: Vec<f64> = (0..LANES).map(|k| between(ends, k)).collect();
            if !places.is_sorted_by(|a, b| a < b) {
                break;
            }
            let found = self.signs(&places);
            // The first sign is that before the zero.
            before = before.or_else(|| found.iter().copied().flatten().next());
            let is_behind = |sign: &Option<bool>| sign.is_some() && *sign != before;
            let behind = found.iter().position(is_behind);
            if round == 0 {
                behind?;
            }
            let last = behind.unwrap_or(LANES);
            let first = found[..last].iter().rposition(|sign| *sign == before && sign.is_some());
            let new = [first.map_or(ends[0], |k| places[k]), behind.map_or(ends[1], |k| places[k])];
            if new == ends {
                break;
            }
            ends = new;
        }
        Some(ends)
    }
}

/// Returns the digits of a number within `bounds`, as many as both bounds share once rounded.
pub fn true_digits(bounds: Interval) -> String {
    let shown = |digits: usize| {
        let [lo, hi] = [bounds.lo, bounds.hi].map(|end| format!("{end:.digits$}"));
        let is_zero = |text: &str| text.chars().all(|c| "-0.".contains(c));
        if is_zero(&lo) && is_zero(&hi) {
            return Some(hi.replace('-', ""));
        }
        (lo == hi).then_some(lo)
    };
    let shared = (0..=MOST_DIGITS).rev().find_map(shown);
    shared.unwrap_or_else(|| format!("{:.0}", bounds.lo.midpoint(bounds.hi)))
}

/// Returns a box around the exact point of a ray at `t`.
fn point(ray: &Ray, t: f64) -> [Interval; 3] {
    let size: DVec3 = ray.origin.abs() + (ray.direction * t).abs();
    let error = size * (4.0 * f64::EPSILON);
    let (low, high) = (ray.at(t) - error, ray.at(t) + error);
    [0, 1, 2].map(|axis| Interval { lo: low[axis], hi: high[axis] })
}
