//! Critical points of a function that are on its surface or near it: nodes, and the middles of
//! necks and handles.
//!
//! They are looked for by Newton's method from places that are spread about a centre, so that those
//! of a surface that is moved are found moved. What counts is confirmed by a change of sign nearby
//! that intervals do not rule out; that others were missed is possible. Knows neither cameras nor
//! pictures.

use super::polynomial::{Vector, principal};
use zeroset_eval::{Kernel, Sample};
use zeroset_space::{Cell, Search, places_about};

/// How far critical points near the surface are from the centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// The farthest of those that are alone or along closed curves; 0 if none is found.
    pub farthest: f64,
    /// The nearest of those along curves that go on, if one is found.
    pub nearest: Option<f64>,
}

impl Found {
    /// What is found in both searches.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let both = self.nearest.into_iter().chain(other.nearest);
        Self { farthest: self.farthest.max(other.farthest), nearest: both.reduce(f64::min) }
    }
}

/// Where critical points are looked for, and by what.
pub struct Seeker<'a> {
    pub search: &'a Search<'a>,
    pub values: &'a dyn Kernel<Sample, f64>,
    /// Whether the function depends on each axis.
    pub depends: [bool; 3],
    /// They are looked for around this place,
    pub centre: [f64; 3],
    /// so far on each axis; some are found farther.
    pub half: f64,
}

/// So many starts are spread in the cube, and what goes so many times farther is lost.
const STARTS: u32 = 32;
const FARTHEST: f64 = 4.0;
/// Steps of Newton's method at most, and how short the last one is, as a share of the half side.
const STEPS: usize = 20;
const SETTLED: f64 = 1e-5;

/// Derivatives are taken of values that are so far apart, as a share of the half side: first and
/// second ones of polynomials then have half of the digits of a value.
const APART: f64 = 1e-3;

/// Values around a place: there, one step either way along each axis, and along two at once.
const AROUND: usize = 13;

/// A critical point is alone if the determinant of the second derivatives, each axis scaled to its
/// own, is at least this.
const ALONE: f64 = 1e-2;
/// What bends along an axis less than this share of what it does along another is taken for
/// straight there.
const FLATTEST: f64 = 1e-4;

/// The curve along which others are is closed if so many are found, and none farther than this
/// share of the half side.
const SOME: usize = 8;
const CLOSED: f64 = 0.75;

/// The surface is near a critical point if it comes nearer than this share of the way from the
/// centre; looked for at that, its half and its quarter, the shortest first.
const NEAR: f64 = 0.5;
const HALVINGS: i32 = 3;

/// What is no more than this share of the values nearby is 0.
const NOTHING: f64 = 1e-6;

/// What is found again lies within this share of the half side.
const SAME: f64 = 1e-4;

/// How a way ends.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// At a critical point that is alone.
    Alone,
    /// At one of others along a curve.
    Among,
    /// Too far away, or where there is no next step.
    Lost,
}

/// A place on its way to a critical point.
#[derive(Clone, Copy)]
struct Way {
    place: Vector,
    end: Option<End>,
}

impl Seeker<'_> {
    /// Looks for critical points.
    pub fn find(&self) -> Found {
        let starts: Vec<Vector> = (1..=STARTS).map(|n| self.start(n)).collect();
        let ends = self.descend(&starts);
        let among = || ends.iter().filter(|(_, end)| *end == End::Among).map(|(place, _)| *place);
        // Of a curve that goes on, points are found wherever it is looked for them.
        let farthest = among().map(|place| distance(place, self.centre)).fold(0.0, f64::max);
        let is_closed = among().count() >= SOME && farthest <= CLOSED * self.half;
        let (mut known, mut found) = (Vec::<Vector>::new(), Found::default());
        for (place, end) in ends {
            let is_same = |other: &Vector| distance(*other, place) <= SAME * self.half;
            if known.iter().any(is_same) {
                continue;
            }
            known.push(place);
            let Some(far) = self.distance_if_near(place) else { continue };
            let one = if end == End::Alone || is_closed {
                Found { farthest: far, nearest: None }
            } else {
                Found { farthest: 0.0, nearest: Some(far) }
            };
            found = found.and(one);
        }
        found
    }

    /// One of a sequence of places that fill a cube evenly: multiples of 1/g, 1/g² and 1/g³ with g⁴
    /// = g + 1 (Roberts, 2018: the sequence R₃).
    fn start(&self, n: u32) -> Vector {
        let strides = [0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901];
        [0, 1, 2].map(|axis| {
            let place = 2.0 * (f64::from(n) * strides[axis]).fract() - 1.0;
            let along = if self.depends[axis] { self.half * place } else { 0.0 };
            self.centre[axis] + along
        })
    }

    /// The critical points at which these starts end.
    fn descend(&self, starts: &[Vector]) -> Vec<(Vector, End)> {
        let way = |place: &Vector| Way { place: *place, end: None };
        let mut ways: Vec<Way> = starts.iter().map(way).collect();
        for _ in 0..STEPS {
            let on_the_way = ways.iter_mut().filter(|way| way.end.is_none());
            let mut on_the_way: Vec<&mut Way> = on_the_way.collect();
            if on_the_way.is_empty() || !self.search.is_wanted() {
                break;
            }
            let around = on_the_way.iter().flat_map(|way| self.around(way.place));
            let values = self.search.values(self.values, &around.collect::<Vec<_>>());
            for (way, values) in on_the_way.iter_mut().zip(values.chunks_exact(AROUND)) {
                self.step(way, values);
            }
        }
        let ended = ways.iter().filter_map(|way| Some((way.place, way.end?)));
        ended.filter(|(_, end)| *end != End::Lost).collect()
    }

    /// The places whose values tell how a function changes around one: that, those a step away
    /// along each axis and back, and those along two axes and back.
    fn around(&self, place: Vector) -> Vec<Vector> {
        let alone: [[i8; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        let both: [[i8; 3]; 3] = [[0, 1, 1], [1, 0, 1], [1, 1, 0]];
        let back = |steps: [[i8; 3]; 3]| steps.map(|step| step.map(|along| -along));
        let apart = APART * self.half;
        let there =
            |step: [i8; 3]| [0, 1, 2].map(|axis| place[axis] + apart * f64::from(step[axis]));
        let steps = [alone, back(alone), both, back(both)].into_iter().flatten();
        [[0; 3]].into_iter().chain(steps).map(there).collect()
    }

    /// A step of Newton's method.
    fn step(&self, way: &mut Way, values: &[f64]) {
        let (here, up, down, both) = (values[0], &values[1..4], &values[4..7], &values[7..13]);
        let mut gradient = [0, 1, 2].map(|a| (up[a] - down[a]) / 2.0);
        let along = [0, 1, 2].map(|a| up[a] - 2.0 * here + down[a]);
        let bend = |a: usize, b: usize| {
            if a == b {
                return along[a];
            }
            let other = 3 - a - b;
            (both[other] - 2.0 * here + both[3 + other] - along[a] - along[b]) / 2.0
        };
        let mut matrix = [0, 1, 2].map(|a| [bend(a, 0), bend(a, 1), bend(a, 2)]);
        let most = matrix.as_flattened().iter().fold(0.0_f64, |most, part| most.max(part.abs()));
        for axis in (0..3).filter(|axis| !self.depends[*axis]) {
            (matrix[axis], gradient[axis]) = ([0.0; 3], 0.0);
            matrix[axis][axis] = most;
        }
        let solved = solve(matrix, gradient.map(|slope| -slope));
        let Some(Step { way: step, rest, determinant }) = solved else {
            way.end = Some(End::Lost);
            return;
        };
        let [step, rest] = [step, rest].map(|way| way.map(|along| APART * self.half * along));
        let far = distance(way.place, self.centre);
        let [length, left] = [step, rest].map(|way| distance(way, [0.0; 3]));
        let share = (far.max(self.half) / (2.0 * length)).min(1.0);
        way.place = [0, 1, 2].map(|axis| way.place[axis] + share * step[axis]);
        way.end = if far > FARTHEST * self.half {
            Some(End::Lost)
        } else if length.max(left) <= SETTLED * self.half {
            Some(if determinant.abs() >= ALONE { End::Alone } else { End::Among })
        } else {
            None
        };
    }

    /// How far a critical point is from the centre; `None` if the surface is not near it, or if the
    /// point is on a line through the centre along an axis: on those the surface itself is looked
    /// for.
    fn distance_if_near(&self, place: Vector) -> Option<f64> {
        let far = distance(place, self.centre);
        let is_off = |axis: &usize| (place[*axis] - self.centre[*axis]).abs() > SAME * self.half;
        if (0..3).filter(is_off).count() < 2 {
            return None;
        }
        let is_near = (0..HALVINGS).rev().map(|k| NEAR * far * 0.5_f64.powi(k)).any(|radius| {
            let steps = self.depends.map(|depends| if depends { radius } else { 0.0 });
            let around: Vec<Vector> = places_about(place, steps).collect();
            let values = self.search.values(self.values, &around);
            // That in the middle is the critical point.
            let here = values[13];
            let most = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let is_on = here.abs() <= NOTHING * most;
            let is_near = is_on || values.iter().any(|there| here * there < 0.0);
            is_near && !self.search.open(&[Cell::about(place, radius)]).is_empty()
        });
        let way = [0, 1, 2].map(|axis| place[axis] - self.centre[axis]);
        is_near.then(|| way.iter().map(|along| along * along).sum::<f64>().sqrt())
    }
}

/// The largest difference along an axis.
fn distance(a: Vector, b: Vector) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).abs()).fold(0.0, f64::max)
}

/// What a symmetric matrix brings to a wanted vector.
struct Step {
    way: Vector,
    /// How far along each axis it may be from where the step leads, since there it hardly bends.
    rest: Vector,
    /// The matrix's determinant where each axis is scaled so that its largest number is 1.
    determinant: f64,
}

/// The step that a symmetric matrix brings to `wanted`. Where its determinant is too small for
/// [`ALONE`], the shortest: nothing is known of steps along a curve. `None` if there is no scale.
fn solve(matrix: [Vector; 3], wanted: Vector) -> Option<Step> {
    let most = matrix.map(|row| row.iter().fold(0.0_f64, |most, part| most.max(part.abs())));
    let least = FLATTEST * most.iter().copied().fold(0.0, f64::max);
    let scale = most.map(|most| most.max(least).sqrt().recip());
    let scaled = [0, 1, 2].map(|a| [0, 1, 2].map(|b| scale[a] * matrix[a][b] * scale[b]));
    let wanted = [0, 1, 2].map(|axis| scale[axis] * wanted[axis]);
    let [a, b, c] = scaled;
    let cross = |a: Vector, b: Vector| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant: f64 = (0..3).map(|k| a[k] * columns[0][k]).sum();
    let (mut solution, mut rest) = ([0.0; 3], [0.0; 3]);
    if determinant.abs() >= ALONE {
        for (column, wanted) in columns.iter().zip(wanted) {
            solution = [0, 1, 2].map(|axis| solution[axis] + column[axis] * wanted / determinant);
        }
    } else {
        for (size, along) in principal(scaled) {
            let far = (0..3).map(|k| along[k] * wanted[k]).sum::<f64>();
            if size.abs() >= ALONE {
                solution = [0, 1, 2].map(|axis| solution[axis] + far / size * along[axis]);
            } else {
                rest = [0, 1, 2].map(|axis| rest[axis] + (far / ALONE * along[axis]).abs());
            }
        }
    }
    let [way, rest] = [solution, rest].map(|way| [0, 1, 2].map(|axis| scale[axis] * way[axis]));
    let is_finite = way.iter().chain(&rest).all(|along| along.is_finite());
    is_finite.then_some(Step { way, rest, determinant })
}
