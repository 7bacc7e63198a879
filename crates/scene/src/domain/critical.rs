//! Critical points of a function on its surface or near it: nodes, and the middles of necks and
//! handles.
//!
//! Newton's method starts from places spread about a center, so the points found move with the
//! surface. A point counts if the function is 0 there or changes sign nearby, and intervals do not
//! rule out a zero. Some points may be missed. This module depends neither on cameras nor on
//! pictures.

use super::polynomial::{Symmetric, principal};
use glam::DVec3;
use zeroset_eval::{Kernel, Sample};
use zeroset_space::{Cell, CellSearch, places_about};

/// Distances from the center to critical points near the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CriticalDistances {
    /// Distance to the farthest critical point that is isolated or on a closed curve; 0 without
    /// one.
    pub farthest: f64,
    /// Distance to the nearest critical point on a curve that is not closed, if one is found.
    pub nearest: Option<f64>,
}

impl CriticalDistances {
    /// The combined result of two searches.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let both = self.nearest.into_iter().chain(other.nearest);
        Self { farthest: self.farthest.max(other.farthest), nearest: both.reduce(f64::min) }
    }
}

/// A search for critical points of one function.
pub struct CriticalSearch<'a> {
    pub search: &'a CellSearch<'a>,
    pub values: &'a dyn Kernel<Sample, f64>,
    /// Whether the function depends on each axis.
    pub depends: [bool; 3],
    pub centre: DVec3,
    /// Half the side of the cube in which starts are spread. Some points are found farther away.
    pub half: f64,
}

/// Number of starts in the cube. A path that leaves the center by more than `FARTHEST` half sides
/// is lost.
const STARTS: u32 = 32;
const FARTHEST: f64 = 4.0;
/// Largest number of Newton steps. A path ends at a step shorter than `CONVERGED` half sides.
const STEPS: usize = 20;
const CONVERGED: f64 = 1e-5;

/// Distance between the places from whose values derivatives are computed, as a share of the half
/// side. First and second derivatives of polynomials then have half the digits of a value.
const DIFFERENCE: f64 = 1e-3;

/// Number of values that a Newton step uses: one at the place, six beside it along one axis, and
/// six beside it along two axes at once.
const STENCIL: usize = 13;

/// A critical point is isolated if the matrix of second derivatives, once scaled, has a determinant
/// of at least this magnitude. Scaling divides each entry by √(r·c): r and c are the largest
/// magnitudes in the entry's row and column.
const LEAST_DETERMINANT: f64 = 1e-2;
/// In this scaling, r and c count as at least this share of the largest second derivative. So the
/// entries of an axis with almost no second derivatives stay near 0.
const FLATTEST: f64 = 1e-4;

/// A curve of critical points counts as closed if at least `CURVE_POINTS` points are found, none
/// farther from the center than `CLOSED` half sides.
const CURVE_POINTS: usize = 8;
const CLOSED: f64 = 0.75;

/// The surface is near a critical point if it comes within a radius of `NEAR` times the point's
/// distance from the center. That radius, its half and its quarter are tried, the shortest first.
const NEAR: f64 = 0.5;
const HALVINGS: i32 = 3;

/// A value below this share of the values nearby counts as 0.
const ZERO: f64 = 1e-6;

/// Two points within this share of the half side count as one.
const MERGED: f64 = 1e-4;

/// The end of a path.
#[derive(Clone, Copy, PartialEq)]
enum PathEnd {
    /// At an isolated critical point.
    Isolated,
    /// At a critical point on a curve of critical points.
    OnCurve,
    /// Too far away, or at a place without a next step.
    Lost,
}

/// A path to a critical point: its latest place, and its end once it has ended.
#[derive(Clone, Copy)]
struct NewtonPath {
    place: DVec3,
    end: Option<PathEnd>,
}

impl CriticalSearch<'_> {
    /// Searches for critical points from several starts. Returns their distances from the center.
    pub fn find(&self) -> CriticalDistances {
        let starts: Vec<DVec3> = (1..=STARTS).map(|n| self.start(n)).collect();
        let ends = self.descend(&starts);
        let among =
            || ends.iter().filter(|(_, end)| *end == PathEnd::OnCurve).map(|(place, _)| *place);
        // On a curve that is not closed, points are found at every distance that is searched.
        let farthest = among().map(|place| distance(place, self.centre)).fold(0.0, f64::max);
        let is_closed = among().count() >= CURVE_POINTS && farthest <= CLOSED * self.half;
        let (mut known, mut found) = (Vec::<DVec3>::new(), CriticalDistances::default());
        for (place, end) in ends {
            let is_same = |other: &DVec3| distance(*other, place) <= MERGED * self.half;
            if known.iter().any(is_same) {
                continue;
            }
            known.push(place);
            let Some(far) = self.distance_if_near(place) else { continue };
            let one = if end == PathEnd::Isolated || is_closed {
                CriticalDistances { farthest: far, nearest: None }
            } else {
                CriticalDistances { farthest: 0.0, nearest: Some(far) }
            };
            found = found.and(one);
        }
        found
    }

    /// The point where path `n` starts. The points fill the cube evenly: their coordinates are the
    /// multiples by `n`, modulo 1, of 1/g, 1/g² and 1/g³ with g⁴ = g + 1 (Roberts, 2018: the
    /// sequence R₃).
    fn start(&self, n: u32) -> DVec3 {
        let strides = [0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901];
        let along = |axis: usize| {
            let place = 2.0 * (f64::from(n) * strides[axis]).fract() - 1.0;
            if self.depends[axis] { self.half * place } else { 0.0 }
        };
        self.centre + DVec3::from_array([0, 1, 2].map(along))
    }

    /// The critical points at which paths from these starts end.
    fn descend(&self, starts: &[DVec3]) -> Vec<(DVec3, PathEnd)> {
        let way = |place: &DVec3| NewtonPath { place: *place, end: None };
        let mut ways: Vec<NewtonPath> = starts.iter().map(way).collect();
        for _ in 0..STEPS {
            let on_the_way = ways.iter_mut().filter(|way| way.end.is_none());
            let mut on_the_way: Vec<&mut NewtonPath> = on_the_way.collect();
            if on_the_way.is_empty() || !self.search.is_wanted() {
                break;
            }
            let around = on_the_way.iter().flat_map(|way| self.around(way.place));
            let values = self.search.values(self.values, &around.collect::<Vec<_>>());
            for (way, values) in on_the_way.iter_mut().zip(values.chunks_exact(STENCIL)) {
                self.step(way, values);
            }
        }
        let ended = ways.iter().filter_map(|way| Some((way.place, way.end?)));
        ended.filter(|(_, end)| *end != PathEnd::Lost).collect()
    }

    /// The places whose values give the derivatives at `place`: itself, one step either way along
    /// each axis, and one step either way along each pair of axes.
    fn around(&self, place: DVec3) -> Vec<[f64; 3]> {
        let alone = [DVec3::X, DVec3::Y, DVec3::Z];
        let both = alone.map(|axis| DVec3::ONE - axis);
        let back = |steps: [DVec3; 3]| steps.map(|step| -step);
        let steps = [alone, back(alone), both, back(both)].into_iter().flatten();
        let there = |step: DVec3| (place + DIFFERENCE * self.half * step).to_array();
        [DVec3::ZERO].into_iter().chain(steps).map(there).collect()
    }

    /// Takes one step of Newton's method. `values` are the function's values at the path's place
    /// and at the points around it.
    fn step(&self, way: &mut NewtonPath, values: &[f64]) {
        let (here, up, down, both) = (values[0], &values[1..4], &values[4..7], &values[7..13]);
        let mut gradient = DVec3::from_array([0, 1, 2].map(|a| (up[a] - down[a]) / 2.0));
        let along = [0, 1, 2].map(|a| up[a] - 2.0 * here + down[a]);
        let bend = |a: usize, b: usize| {
            if a == b {
                return along[a];
            }
            let other = 3 - a - b;
            (both[other] - 2.0 * here + both[3 + other] - along[a] - along[b]) / 2.0
        };
        let mut matrix = [0, 1, 2].map(|a| DVec3::new(bend(a, 0), bend(a, 1), bend(a, 2)));
        let most = matrix.map(largest).into_iter().fold(0.0, f64::max);
        for axis in (0..3).filter(|axis| !self.depends[*axis]) {
            (matrix[axis], gradient[axis]) = (DVec3::ZERO, 0.0);
            matrix[axis][axis] = most;
        }
        let solved = solve(matrix, -gradient);
        let Some(NewtonStep { way: step, rest, determinant }) = solved else {
            way.end = Some(PathEnd::Lost);
            return;
        };
        let [step, rest] = [step, rest].map(|way| DIFFERENCE * self.half * way);
        let far = distance(way.place, self.centre);
        let [length, left] = [step, rest].map(largest);
        let share = (far.max(self.half) / (2.0 * length)).min(1.0);
        way.place += share * step;
        way.end = if far > FARTHEST * self.half {
            Some(PathEnd::Lost)
        } else if length.max(left) <= CONVERGED * self.half {
            Some(if determinant.abs() >= LEAST_DETERMINANT {
                PathEnd::Isolated
            } else {
                PathEnd::OnCurve
            })
        } else {
            None
        };
    }

    /// The distance of a critical point from the center. `None` if the surface is not near the
    /// point. Also `None` for a point on a line through the center along an axis: another search
    /// covers these lines.
    fn distance_if_near(&self, place: DVec3) -> Option<f64> {
        let far = distance(place, self.centre);
        let is_off = |axis: &usize| (place[*axis] - self.centre[*axis]).abs() > MERGED * self.half;
        if (0..3).filter(is_off).count() < 2 {
            return None;
        }
        let is_near = (0..HALVINGS).rev().map(|k| NEAR * far * 0.5_f64.powi(k)).any(|radius| {
            let steps = self.depends.map(|depends| if depends { radius } else { 0.0 });
            let around: Vec<[f64; 3]> = places_about(place.to_array(), steps).collect();
            let values = self.search.values(self.values, &around);
            // The middle one of 27 places is the critical point.
            let here = values[13];
            let most = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let is_on = here.abs() <= ZERO * most;
            let is_near = is_on || values.iter().any(|there| here * there < 0.0);
            is_near && !self.search.open(&[Cell::about(place.to_array(), radius)]).is_empty()
        });
        is_near.then(|| place.distance(self.centre))
    }
}

/// The distance in the maximum norm.
fn distance(a: DVec3, b: DVec3) -> f64 {
    largest(a - b)
}

/// The largest magnitude of a coordinate.
fn largest(way: DVec3) -> f64 {
    way.to_array().into_iter().fold(0.0, |most: f64, along| most.max(along.abs()))
}

/// The solution of a symmetric system, and how reliable it is.
struct NewtonStep {
    way: DVec3,
    /// The possible error of each coordinate of the solution, caused by directions with almost no
    /// second derivative.
    rest: DVec3,
    /// The determinant of the scaled matrix.
    determinant: f64,
}

/// Solves `matrix` · step = `wanted`. If the determinant is below [`LEAST_DETERMINANT`], the
/// shortest solution is taken, since any step along a curve of critical points would do. `None` if
/// the result is not finite.
fn solve(matrix: Symmetric, wanted: DVec3) -> Option<NewtonStep> {
    let most = matrix.map(largest);
    let least = FLATTEST * most.into_iter().fold(0.0, f64::max);
    let scale = DVec3::from_array(most.map(|most| most.max(least).sqrt().recip()));
    let scaled = [0, 1, 2].map(|axis| scale[axis] * matrix[axis] * scale);
    let (wanted, [a, b, c]) = (scale * wanted, scaled);
    let columns = [b.cross(c), c.cross(a), a.cross(b)];
    let determinant = a.dot(columns[0]);
    let (mut solution, mut rest) = (DVec3::ZERO, DVec3::ZERO);
    if determinant.abs() >= LEAST_DETERMINANT {
        for (column, wanted) in columns.into_iter().zip(wanted.to_array()) {
            solution += column * wanted / determinant;
        }
    } else {
        for (size, along) in principal(scaled) {
            let far = along.dot(wanted);
            if size.abs() >= LEAST_DETERMINANT {
                solution += far / size * along;
            } else {
                rest += (far / LEAST_DETERMINANT * along).abs();
            }
        }
    }
    let (way, rest) = (scale * solution, scale * rest);
    (way.is_finite() && rest.is_finite()).then_some(NewtonStep { way, rest, determinant })
}
