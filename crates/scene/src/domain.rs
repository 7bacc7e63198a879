//! Automatic domains: where to look if neither the caller nor the document gives a domain
//! (`--domain auto`).
//!
//! If a surface is proven to lie in some box, however large, halving tightens that box. Otherwise a
//! window is chosen that shows the surface's features. The limit counts evaluations, not time, so
//! the same document has the same domain on every machine. This module depends neither on cameras
//! nor on pictures.

mod bounds;
mod centre;
mod climb;
mod critical;
mod fading;
mod graph;
mod ground;
mod heights;
mod homogeneous;
mod moving;
mod partial;
mod period;
mod polynomial;
mod shape;
mod tops;
mod waves;
mod window;

use crate::coordinate::coordinate;
use crate::program::{Program, ProgramError};
use glam::DVec3;
use homogeneous::Homogeneous;
pub(crate) use moving::{Motion, find_moving};
pub(crate) use shape::GraphShape;
use std::cell::Cell as Counter;
use waves::Wave;
use window::{Window, WindowChooser};
use zeroset_eval::Assumptions;
use zeroset_interval::Interval;
use zeroset_ir::{Graph, Node, NodeId};
use zeroset_ops::Op;
use zeroset_space::{Cell, CellSearch, places_about};

/// Half the side of the domain of an empty surface, and of the window on one without a scale.
const DEFAULT_HALF: f64 = 2.0;

/// Number of halvings of a box: first with intervals alone, then also with affine forms.
const BOX_DEPTH: u32 = 6;
const FINE_DEPTH: u32 = 7;

/// Half the side of the largest cube that is searched, for a surface that cannot be proven bounded
/// in all of space.
pub const REACH: f64 = 1_099_511_627_776.0; // 2^40

/// Largest number of evaluations in a search, for all surfaces together. `WORK_AT_INFINITY` is a
/// separate limit for evaluations at infinity.
const WORK: u64 = 400_000;
const WORK_AT_INFINITY: u64 = 20_000;

/// Largest number of nodes whose search may use all evaluations. Larger graphs get fewer, so that
/// the search of a union of 100,000 parts takes a second or two, not minutes.
const SHORT: u64 = 2_000;

/// Largest number of evaluations at infinity for one box.
const WORK_AT_ONCE: u64 = 6_000;

/// Greatest ratio of the extent of a surface between given ranges to the largest of these. The
/// second ratio is for a graph whose heights are stretched for display.
const LONGEST_PART: f64 = 1000.0;
const LONGEST_STRETCHED_PART: f64 = 1e9;

/// Space left around a bounded surface, as a share of its extent on each axis. Around curves, it is
/// a share of their largest extent.
const SPACE: f64 = 0.05;

/// Extents are displayed with their own ratio up to this ratio.
const MOST_UNEVEN: f64 = 4.0;

/// Returns whether two extents differ too much to be displayed with their own ratio.
pub(crate) fn differ(one: f64, other: f64) -> bool {
    one > MOST_UNEVEN * other || other > MOST_UNEVEN * one
}

/// A domain, and the result of the search that found it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoDomain {
    /// The corner with the smallest coordinates.
    pub low: [f64; 3],
    /// The corner with the largest coordinates.
    pub high: [f64; 3],
    /// A proof that the surface is empty or bounded, or the lack of one.
    pub finding: Finding,
    /// Per axis, whether the surface is a graph that continues beyond the lower and the upper end.
    pub cut: [[bool; 2]; 3],
}

impl AutoDomain {
    /// The domain of curves and points alone: a box around `ends`, or a cube without them.
    pub(crate) fn of_box(ends: Option<[DVec3; 2]>) -> Self {
        let cut = [[false; 2]; 3];
        let [low, high] = ends.map_or([DVec3::NEG_ONE, DVec3::ONE], around_curves);
        let (low, high) = (low.to_array(), high.to_array());
        Self { low, high, finding: Finding::Traced, cut }
    }

    /// This domain, extended to hold the box of curves and points too.
    pub(crate) fn with_box(self, ends: [DVec3; 2]) -> Self {
        let [low, high] = ends.map(|end| end.to_array());
        let is_within = (0..3).all(|k| self.low[k] <= low[k] && high[k] <= self.high[k]);
        if is_within {
            return self;
        }
        let [low, high] = around_curves(ends).map(|end| end.to_array());
        if self.finding.is_empty() {
            return Self { low, high, finding: Finding::Traced, ..self };
        }
        let finding = match self.finding {
            // The ball would cut the curves.
            Finding::UnboundedInBall => Finding::Unbounded,
            other => other,
        };
        let low = [0, 1, 2].map(|k| self.low[k].min(low[k]));
        let high = [0, 1, 2].map(|k| self.high[k].max(high[k]));
        Self { low, high, finding, ..self }
    }

    /// The smallest domain that contains both domains. A domain of an empty surface does not count.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        if other.finding.is_empty() || self.finding.is_empty() {
            let (kept, empty) = if self.finding.is_empty() { (other, self) } else { (self, other) };
            return Self { finding: kept.finding.max(empty.finding), ..kept };
        }
        let low = [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis]));
        let high = [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis]));
        let cut = [0, 1, 2].map(|axis| {
            let reaches = |found: &Self, side: usize| {
                let ends = [found.low[axis] == low[axis], found.high[axis] == high[axis]];
                found.cut[axis][side] && ends[side]
            };
            [0, 1].map(|side| reaches(&self, side) || reaches(&other, side))
        });
        Self { low, high, finding: self.finding.max(other.finding), cut }
    }

    /// One phrase that describes the finding, and where the domain cuts a graph.
    pub fn describe(&self) -> String {
        let mut phrase = self.finding.describe().to_owned();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let ends = [self.low[axis], self.high[axis]].into_iter().zip(self.cut[axis]);
            let cuts: Vec<String> =
                ends.filter(|(_, is_cut)| *is_cut).map(|(end, _)| coordinate(end)).collect();
            if !cuts.is_empty() {
                phrase += ", cut at ";
                phrase += name;
                phrase += " = ";
                phrase += &cuts.join(" and ");
            }
        }
        phrase
    }
}

/// A proof that a surface is empty or bounded, or the lack of one. The finding for several surfaces
/// is the greatest of their findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finding {
    /// The surface is proven to have no point.
    Empty,
    /// The surface is proven to have no point within ±[`REACH`].
    EmptyNear,
    /// There are curves and points alone. The domain is a box around them.
    Traced,
    /// The whole surface is proven to lie in the domain.
    Bounded,
    /// The part of the surface within ±[`REACH`] is proven to lie in the domain.
    BoundedNear,
    /// The surface moves. At some values of the parameter that moves, it is proven to lie in the
    /// domain. For other values there is no proof.
    BoundedAtTimes,
    /// The surface could not be proven bounded. The domain is a window, and the surface looks
    /// better in the window's [ball](zeroset_space::Region::with_ball).
    UnboundedInBall,
    /// The surface could not be proven bounded. The domain is a window: a box.
    Unbounded,
}

impl Finding {
    /// One phrase that describes the finding.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Traced => "the box of curves, points and parametric surfaces",
            Self::Bounded => "bounded: proven",
            Self::BoundedNear => "bounded: proven up to ±1e12",
            Self::BoundedAtTimes => "bounded at the times tried, else not proven",
            Self::Unbounded => "unbounded, clipped to a box",
            Self::UnboundedInBall => "unbounded, clipped to a ball",
            Self::Empty => "empty: proven",
            Self::EmptyNear => "empty: proven up to ±1e12",
        }
    }

    /// The finding for all times, if this one holds at some of them.
    #[must_use]
    pub fn between_times(self) -> Self {
        if self.is_bounded() { Self::BoundedAtTimes } else { self }
    }

    /// Returns whether the surface is proven empty, at least within ±[`REACH`].
    pub fn is_empty(self) -> bool {
        matches!(self, Self::Empty | Self::EmptyNear)
    }

    /// Returns whether the surface is proven to lie in the domain, at least within ±[`REACH`].
    pub fn is_bounded(self) -> bool {
        matches!(self, Self::Bounded | Self::BoundedNear)
    }
}

/// Chooses a domain that shows all surfaces of `program`, which must have been built for all of
/// space. The search calls `wanted` between evaluations. Once `wanted` returns false, it must keep
/// returning false, and the result is `None`.
///
/// # Errors
/// If a kernel cannot be compiled.
pub fn find_while(
    program: &Program,
    is_stretched: bool,
    wanted: &dyn Fn() -> bool,
) -> Result<Option<AutoDomain>, ProgramError> {
    let Some(mut search) = cell_search(program, wanted)? else { return Ok(None) };
    let mut cut = [[false; 2]; 3];
    let (found, finding) = match reach(program, &search) {
        Reach::Empty => (Cell::cube(DEFAULT_HALF), Finding::Empty),
        Reach::Within(whole, [bounded, empty]) => match tighten(program, &mut search, whole)? {
            Some(hull) => (around(program, &hull), bounded),
            None => (Cell::cube(DEFAULT_HALF), empty),
        },
        Reach::Open(bounds) => {
            let window = windows(program, is_stretched, &search, bounds)?;
            cut = window.cut;
            let is_round = window.is_round;
            (window.cell, if is_round { Finding::UnboundedInBall } else { Finding::Unbounded })
        }
    };
    let Cell { low, high } = valid_box(found);
    // The result of a cancelled search is not reliable.
    Ok(wanted().then_some(AutoDomain { low, high, finding, cut }))
}

/// Finds the surfaces where some of the ranges of x, y and z are given: a box around that part,
/// with space along the other axes. `None` if the part is empty, if it is not proven to be bounded,
/// if it is too long to be shown as a whole, or once `wanted` returns false.
///
/// # Errors
/// If a kernel cannot be compiled.
pub(crate) fn find_between(
    program: &Program,
    ranges: &[Option<[f64; 2]>; 3],
    is_stretched: bool,
    wanted: &dyn Fn() -> bool,
) -> Result<Option<Cell>, ProgramError> {
    let Some(mut search) = cell_search(program, wanted)? else { return Ok(None) };
    let [low, high] = [0, 1].map(|end| {
        let everywhere = [-REACH, REACH];
        ranges.map(|range| range.unwrap_or(everywhere)[end])
    });
    let Some(hull) = search.tight(Cell { low, high }, BOX_DEPTH) else { return Ok(None) };
    let open = || (0..3).filter(|axis| ranges[*axis].is_none());
    if !open().all(|axis| -REACH < hull.low[axis] && hull.high[axis] < REACH) {
        return Ok(None);
    }
    let Some(hull) = tighten(program, &mut search, hull)? else { return Ok(None) };
    let given = (0..3).filter(|axis| ranges[*axis].is_some());
    let widest = given.map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let longest = if is_stretched { LONGEST_STRETCHED_PART } else { LONGEST_PART };
    let is_shown = open().all(|axis| hull.extent(axis) <= longest * widest);
    Ok((is_shown && wanted()).then(|| valid_box(thickened(with_margin(&hull), THIN))))
}

/// The part of space in which surfaces are proven to lie.
enum Reach {
    /// There are no surfaces.
    Empty,
    /// A finite box, with the findings for surfaces in it and for none in it.
    Within(Cell, [Finding; 2]),
    /// A box of which some ends are infinite.
    Open(Cell),
}

/// The part of space in which all surfaces are proven to lie.
fn reach(program: &Program, search: &CellSearch<'_>) -> Reach {
    let mut at_infinity = share(program, WORK_AT_INFINITY);
    let everything = everything(program, search, &mut at_infinity);
    let Some(bounds) = everything.or_else(|| bounds::bounds(search)) else { return Reach::Empty };
    if bounds.is_finite() {
        return Reach::Within(bounds, [Finding::Bounded, Finding::Empty]);
    }
    let near = everything_near(search);
    near.map_or(Reach::Open(bounds), |near| {
        Reach::Within(near, [Finding::BoundedNear, Finding::EmptyNear])
    })
}

/// A search of cells for the surfaces of a program. `None` once `wanted` returns false.
fn cell_search<'a>(
    program: &'a Program,
    wanted: &'a dyn Fn() -> bool,
) -> Result<Option<CellSearch<'a>>, ProgramError> {
    let surfaces = (0..program.roots().len()).take_while(|_| wanted());
    let surfaces = surfaces.map(|surface| program.kernels::<f64>(surface).zeros());
    let surfaces = surfaces.collect::<Result<Vec<_>, _>>()?;
    let work = Counter::new(share(program, WORK));
    Ok(wanted().then_some(CellSearch { surfaces, forms: Vec::new(), wanted, work }))
}

/// The evaluations of a search, of which large programs get fewer.
fn share(program: &Program, work: u64) -> u64 {
    work * SHORT / SHORT.max(program.graph().len() as u64)
}

/// A box around all parts of `whole` that may hold a surface. Intervals find it, then affine forms
/// tighten it.
fn tighten<'a>(
    program: &'a Program,
    search: &mut CellSearch<'a>,
    whole: Cell,
) -> Result<Option<Cell>, ProgramError> {
    let Some(hull) = search.tight(whole, BOX_DEPTH) else { return Ok(None) };
    let surfaces = (0..program.roots().len()).take_while(|_| search.is_wanted());
    let forms = surfaces.map(|surface| program.kernels::<f64>(surface).tiles());
    let forms = forms.collect::<Result<Vec<_>, _>>()?;
    if forms.len() == program.roots().len() {
        search.forms = forms;
    }
    Ok(search.tight(hull, FINE_DEPTH))
}

/// Half the side of the domain around a surface that is a point.
const POINT: f64 = 1.0;
/// A surface is a point if the longest side of its box has at most `FLOATS` ulps. If that side is
/// shorter than `TINY`, the function's values decide.
const FLOATS: f64 = 16.0;
const TINY: f64 = 1e-6;

/// The domain around a bounded surface that lies in `hull`: a cube around a point, otherwise `hull`
/// with some space. A thin hull, such as a curve's, is thickened.
fn around(program: &Program, hull: &Cell) -> Cell {
    if is_point(program, hull) {
        let place = hull.centre().map(|along| rounded(along, POINT / 100.0));
        return cube_about(place, POINT).around(hull);
    }
    thickened(with_margin(hull), THIN)
}

/// Returns whether the surface is a point, or floats cannot distinguish it from one. Either its box
/// is a few ulps wide, or the box is tiny and the function may be 0 at each of 27 places in it:
/// near the origin, the values of x²+y²+z² underflow. The function of a surface that encloses a
/// volume is not 0 at some of these places, however small the box is.
fn is_point(program: &Program, hull: &Cell) -> bool {
    let (graph, parameters) = (program.graph(), program.values().to_vec());
    let may_vanish = |place: [f64; 3]| {
        let domain = place.map(|along| Interval { lo: along, hi: along });
        let assumptions = Assumptions { domain, parameters: parameters.clone() };
        let found = zeroset_eval::enclose_all(graph, program.roots(), &assumptions);
        found.iter().any(|(bounds, _)| bounds.lo <= 0.0 && 0.0 <= bounds.hi)
    };
    let eighths = [0, 1, 2].map(|axis| hull.extent(axis) / 8.0);
    hull.largest() <= FLOATS * f64::EPSILON * hull.reach()
        || hull.largest() < TINY && places_about(hull.centre(), eighths).all(may_vanish)
}

/// All of space.
const EVERYWHERE: Cell = Cell { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3] };

/// Exponents, to base 2, of the half sides of the cubes that are tried as boxes around a whole
/// surface.
const LADDER: [u32; 9] = [4, 12, 20, 40, 60, 100, 200, 400, 511];

/// A box in which all surfaces are proven to lie, if there is a proof.
fn everything(program: &Program, search: &CellSearch<'_>, work: &mut u64) -> Option<Cell> {
    let cubes = LADDER.map(|exponent| Cell::cube(f64::from(exponent).exp2()));
    if let Some(cube) = cubes.into_iter().find(|cube| search.nothing_outside(cube)) {
        return Some(cube);
    }
    let (graph, parameters) = (program.graph(), program.values());
    let mut whole: Option<Cell> = None;
    for &root in program.roots() {
        let even = [1; 3];
        let mut weights = vec![even];
        weights.extend(pure_weights(graph, root).filter(|weights| *weights != even));
        let half = weights.into_iter().find_map(|weights| {
            let function = Homogeneous::new(graph, root, parameters, weights)?;
            let mut exponents = LADDER.into_iter();
            let exponent = exponents.find(|exponent| {
                let share = (*work).min(WORK_AT_ONCE);
                let mut left = share;
                let is_within = function.is_within(*exponent, &mut left);
                *work -= share - left;
                is_within
            })?;
            Some(weights.map(|weight| f64::from(exponent * weight).exp2()))
        })?;
        let cell = Cell { low: half.map(|half| -half), high: half };
        whole = Some(whole.map_or(cell, |whole| whole.around(&cell)));
    }
    whole.filter(|whole| whole.high.iter().all(|half| half.is_finite()))
}

/// A box in which all surfaces within ±[`REACH`] are proven to lie, if there is a proof.
fn everything_near(search: &CellSearch<'_>) -> Option<Cell> {
    let cube = |exponent: i32| Cell::cube(f64::from(exponent).exp2());
    let is_clear = |exponent: &i32| search.nothing_between(&cube(*exponent), &cube(exponent + 1));
    (0..40).rev().take_while(is_clear).last().map(cube)
}

/// Weights of x, y and z that give their highest powers the same weighted degree, if there are any:
/// 1, 2, 2 for x⁴+y²+z².
fn pure_weights(graph: &Graph, root: NodeId) -> impl Iterator<Item = [u32; 3]> {
    let mut powers: Vec<[Option<u32>; 3]> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        powers.push([0, 1, 2].map(|axis| match node {
            Node::Variable(other) => (*other as usize == axis).then_some(1),
            Node::Parameter(_) | Node::Constant(_) => Some(0),
            Node::Apply(op, operands) => {
                let power = |k: usize| powers[operands[k].index()][axis];
                let exponent = |k: usize| {
                    let whole = graph.number(operands[k])?.as_integer()?;
                    u32::try_from(whole).ok()
                };
                if *op == Op::Mul {
                    power(0).zip(power(1)).and_then(|(a, b)| a.checked_add(b))
                } else if *op == Op::Sqr {
                    power(0).and_then(|power| power.checked_mul(2))
                } else if *op == Op::Pow {
                    power(0).zip(exponent(1)).and_then(|(power, n)| power.checked_mul(n))
                } else {
                    (0..operands.len()).filter_map(power).max()
                }
            }
        }));
    }
    let whole = |power: Option<u32>| power.filter(|power| (1..=32).contains(power));
    let [x, y, z] = powers[root.index()].map(whole);
    let all = x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
    all.into_iter().map(|powers| {
        let common = powers.into_iter().fold(1, |all: u32, power| all / gcd(all, power) * power);
        powers.map(|power| common / power)
    })
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A box around the windows on all surfaces. It is clipped to a ball if all surfaces look better
/// so. If `is_stretched`, the box may have any proportions. All surfaces are proven to lie in
/// `bounds`.
fn windows(
    program: &Program,
    is_stretched: bool,
    search: &CellSearch<'_>,
    bounds: Cell,
) -> Result<Window, ProgramError> {
    let (graph, parameters) = (program.graph(), program.values());
    let mut windows = Vec::with_capacity(program.roots().len());
    for (surface, &root) in program.roots().iter().enumerate() {
        let shape = GraphShape::of(graph, root, parameters);
        let alone = CellSearch {
            surfaces: vec![search.surfaces[surface]],
            forms: Vec::new(),
            wanted: search.wanted,
            work: search.work.clone(),
        };
        let value = |node: NodeId| {
            move |point: [f64; 3]| {
                let domain = point.map(|c| Interval { lo: c, hi: c });
                let assumptions = Assumptions { domain, parameters: parameters.to_vec() };
                let bounds = zeroset_eval::enclose(graph, node, &assumptions).0;
                bounds.lo.midpoint(bounds.hi)
            }
        };
        let waves: Vec<_> = shape.waves.iter().copied().map(value).collect();
        let sight = WindowChooser {
            search: &alone,
            shape,
            values: program.kernels::<f64>(surface).values()?,
            centre: centre::centre(graph, root, parameters),
            waves: waves.iter().map(|wave| wave as &Wave<'_>).collect(),
            is_solid: program.is_solid(surface),
            is_stretched,
            bounds: match program.roots().len() {
                1 => bounds,
                _ => bounds::bounds(&alone).unwrap_or(EVERYWHERE),
            },
            cut: [[false; 2]; 3],
        };
        windows.push(sight.window());
        search.work.set(alone.work.get());
    }
    let cells = windows.iter().map(|window| window.cell);
    let cell = cells.reduce(|whole, cell| whole.around(&cell)).unwrap_or(Cell::cube(DEFAULT_HALF));
    // A graph that ends inside of another surface's window is not cut by it there.
    let is_cut = |axis: usize| {
        let at = |side: fn(&Cell) -> &[f64; 3], k: usize| {
            let cuts = |window: &Window| {
                window.cut[axis][k] && side(&window.cell)[axis] == side(&cell)[axis]
            };
            windows.iter().any(cuts)
        };
        [at(|cell| &cell.low, 0), at(|cell| &cell.high, 1)]
    };
    let is_round = windows.iter().all(|window| window.is_round);
    Ok(Window { cell, is_round, cut: [0, 1, 2].map(is_cut) })
}

/// A side shorter than this share of the longest is too thin: `FLAT` for a window, `THIN` for the
/// box around a bounded surface.
const FLAT: f64 = 0.01;
const THIN: f64 = 1e-4;
/// A side that is too thin gets this share of the longest.
const THICK: f64 = 0.5;

/// The box, thickened on every axis on which it is shorter than `share` of the longest side.
fn thickened(mut cell: Cell, share: f64) -> Cell {
    let largest = cell.largest();
    for (axis, middle) in cell.centre().into_iter().enumerate() {
        if cell.extent(axis) < share * largest {
            let half = THICK * largest / 2.0;
            let end = |end: f64| rounded(end, largest / 1000.0);
            (cell.low[axis], cell.high[axis]) = (end(middle - half), end(middle + half));
        }
    }
    cell
}

/// The box, with invalid bounds replaced. An axis without finite, increasing bounds gets a range
/// around its middle.
fn valid_box(mut cell: Cell) -> Cell {
    let largest = cell.largest();
    for axis in 0..3 {
        let (low, high) = (cell.low[axis], cell.high[axis]);
        if low.is_finite() && high.is_finite() && low < high && (high - low).is_finite() {
            continue;
        }
        let middle = low.midpoint(high);
        let middle = if middle.abs() <= REACH { middle } else { 0.0 };
        let half = if largest.is_finite() { largest.max(middle.abs() * 1e-6) } else { 0.0 };
        let half = if half > 0.0 { half } else { DEFAULT_HALF };
        (cell.low[axis], cell.high[axis]) = (middle - half, middle + half);
    }
    cell
}

/// A coordinate rounded to a multiple of the largest power of ten up to `grain`.
pub(crate) fn rounded(place: f64, grain: f64) -> f64 {
    let near = in_grains(place, grain, f64::round);
    if near.is_finite() { near } else { place }
}

/// Rounds a coordinate to a multiple of the largest power of ten up to `grain`. `whole` rounds the
/// number of multiples. The result is not finite if the power or the multiple overflows.
fn in_grains(place: f64, grain: f64, whole: impl Fn(f64) -> f64) -> f64 {
    let power = grain.log10().floor();
    // Dividing by a power of ten gives the float nearest to the decimal.
    let grain = 10.0_f64.powf(power.abs());
    if power < 0.0 { whole(place * grain) / grain } else { whole(place / grain) * grain }
}

/// The cube of half side `half` around a place. Its bounds are rounded to few digits, but are exact
/// along an axis on which the place is 0.
fn cube_about(place: [f64; 3], half: f64) -> Cell {
    let end = |along: f64, side: f64| {
        if along == 0.0 { side } else { rounded(along + side, half / 1000.0) }
    };
    Cell { low: place.map(|along| end(along, -half)), high: place.map(|along| end(along, half)) }
}

/// The box `ends` of curves with a margin around it, its bounds rounded to few digits. No side of
/// the result is empty.
fn around_curves([low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let largest = (high - low).max_element();
    let margin = if largest > 0.0 { SPACE * largest } else { 1.0 };
    // The margin must not vanish beside large coordinates.
    let least = 1e-6 * low.abs().max(high.abs()).max_element();
    let margin = margin.max(least);
    // Rounding takes at most a twentieth of the margin.
    let neat = |bound: f64| rounded(bound, margin / 10.0);
    [(low - DVec3::splat(margin)).map(neat), (high + DVec3::splat(margin)).map(neat)]
}

/// The box with some space on each side, its bounds rounded outward to few digits.
fn with_margin(cell: &Cell) -> Cell {
    grown(cell, SPACE)
}

/// The box with the share `space` of its extent on each side, its bounds rounded outward to few
/// digits.
fn grown(cell: &Cell, space: f64) -> Cell {
    let mut grown = *cell;
    // An axis without extent gets a millionth of the largest extent.
    let least = cell.largest() * 1e-6;
    for axis in 0..3 {
        let extent = cell.extent(axis).max(least);
        let space = space * extent;
        let neat = |bound: f64, outward: fn(f64) -> f64| {
            in_grains(bound, extent / 100.0, |grains| {
                // A bound that is a whole number of grains up to rounding is not moved outward by
                // another grain. The space around the surface absorbs the rounding error.
                let near = grains.round();
                if (grains - near).abs() < 1e-6 { near } else { outward(grains) }
            })
        };
        let low = neat(cell.low[axis] - space, f64::floor);
        let high = neat(cell.high[axis] + space, f64::ceil);
        // Far from the origin, rounding to grains may overflow.
        grown.low[axis] = if low.is_finite() { low.min(cell.low[axis]) } else { cell.low[axis] };
        grown.high[axis] =
            if high.is_finite() { high.max(cell.high[axis]) } else { cell.high[axis] };
    }
    grown
}

#[cfg(test)]
mod seams;
#[cfg(test)]
mod tests;
