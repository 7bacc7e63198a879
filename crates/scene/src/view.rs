//! The region of a document. The caller's choice comes first, then the document's, then a default.

use crate::curves::{self, PlaneCurves};
use crate::domain::{self, AutoDomain, Finding, Motion};
use crate::number::{nearest, numbers};
use crate::patches;
use crate::program::{Program, ProgramError};
use crate::proportions;
use glam::DVec3;
use std::cell::LazyCell;
use std::str::FromStr;
use zeroset_interval::Interval;
use zeroset_ir::{Constant, Node, NodeId};
use zeroset_space::{CameraError, HalfSpace, LARGEST_COORDINATE, Region, RegionError};
use zeroset_syntax::{
    Document, DomainLine, Parameter, ParameterKind, PointValue, Surface, SurfaceColor,
};

/// The caller's choice of a domain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DomainChoice {
    /// The document's domain. If the document gives none, the same as [`DomainChoice::Auto`].
    #[default]
    Document,
    /// The domain that an interval search for the surface finds.
    Auto,
    /// A box: the lower and upper bounds of x, y and z.
    Bounds([f64; 6]),
}

impl FromStr for DomainChoice {
    type Err = String;

    /// Reads `auto`, one number or six numbers. Does not check that the numbers bound a box.
    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "auto" {
            return Ok(Self::Auto);
        }
        match numbers(text)?[..] {
            [r] => Ok(Self::Bounds([-r, r, -r, r, -r, r])),
            [a, b, c, d, e, f] => Ok(Self::Bounds([a, b, c, d, e, f])),
            ref other => Err(format!(
                "expected auto, one number or six with commas between, found {} numbers",
                other.len()
            )),
        }
    }
}

/// The caller's choice of a clipping plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ClipChoice {
    /// The document's clipping plane, if it has one.
    #[default]
    Document,
    /// No plane, even if the document has one.
    Off,
    /// A plane that keeps this half-space.
    Plane(HalfSpace),
}

impl ClipChoice {
    /// The plane that clips, where `own` is the document's plane.
    pub fn or(self, own: Option<HalfSpace>) -> Option<HalfSpace> {
        match self {
            Self::Document => own,
            Self::Off => None,
            Self::Plane(plane) => Some(plane),
        }
    }
}

impl FromStr for ClipChoice {
    type Err = String;

    /// Reads `off` or four numbers. Does not check that they define a plane.
    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "off" {
            return Ok(Self::Off);
        }
        match numbers(text)?[..] {
            [a, b, c, offset] => Ok(Self::Plane(HalfSpace { normal: DVec3::new(a, b, c), offset })),
            ref other => {
                Err(format!("expected off or 4 numbers with commas between, found {}", other.len()))
            }
        }
    }
}

/// The shape that a domain is clipped to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClipShape {
    /// The document's shape, if it gives one. Otherwise the ball, if a search found the domain and
    /// the surface looks better in a ball; else the box.
    #[default]
    Auto,
    /// The [ball](Region::with_ball) in the domain's box.
    Ball,
    /// The domain's box.
    Box,
}

/// A choice of how to clip a domain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clipping {
    /// The clipping plane.
    pub plane: ClipChoice,
    /// The shape to clip to.
    pub to: ClipShape,
}

impl From<Option<ClipChoice>> for Clipping {
    fn from(plane: Option<ClipChoice>) -> Self {
        Self { plane: plane.unwrap_or_default(), ..Self::default() }
    }
}

/// The reason why a document cannot be shown as requested.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The camera is invalid.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The domain or the clipping plane is invalid.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// The surface was found, but too far away for a domain.
    #[error(
        "the surface reaches to ±{reach:.2e}, and a domain ends at ±1e18: draw it smaller, with \
         ({scale:e}*x) for x, ({scale:e}*y) for y and ({scale:e}*z) for z"
    )]
    Far {
        /// The largest magnitude of a coordinate of the domain that was found.
        reach: f64,
        /// A power of ten by which the surface is smaller than 10.
        scale: f64,
    },
    /// The document has nothing to draw.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

/// Returns the region of `document` to look at, and the result of the search for a domain, if one
/// was needed.
///
/// # Errors
/// If a range is empty or not finite, if the clipping plane has no normal, or if a search is needed
/// but there is no surface.
///
/// # Panics
/// Never: this search is not cancelled.
pub fn region(
    document: &Document,
    choice: DomainChoice,
    cut: impl Into<Clipping>,
) -> Result<(Region, Option<AutoDomain>), SceneError> {
    Ok(region_while(&mut None, document, choice, cut, &|| true)?.expect("wanted to the end"))
}

/// As [`region`], but can be cancelled. The search calls `wanted` repeatedly. Once `wanted` returns
/// false, it must keep returning false, and the result is `None`.
///
/// `search` holds the program of the previous search, and receives the program of this one. The
/// previous program is reused without compiling if the documents differ only in parameter values.
///
/// # Errors
/// As [`region`].
pub fn region_while(
    search: &mut Option<Program>,
    document: &Document,
    choice: DomainChoice,
    cut: impl Into<Clipping>,
    wanted: &dyn Fn() -> bool,
) -> Result<Option<(Region, Option<AutoDomain>)>, SceneError> {
    let (mut ranges, mut searched) = (given_ranges(document, choice), None);
    let Clipping { plane, to } = cut.into();
    let is_typed_ball =
        matches!((choice, &document.domain), (DomainChoice::Document, Some(DomainLine::Ball(_))));
    let mut is_ball = to == ClipShape::Ball || to == ClipShape::Auto && is_typed_ball;
    let is_tall = LazyCell::new(|| proportions::may_stretch(document));
    if ranges.contains(&None) {
        let Some(mut found) = search_while(search, document, *is_tall, wanted)? else {
            return Ok(None);
        };
        let looks_better =
            found.finding == Finding::UnboundedInBall && ranges.iter().all(Option::is_none);
        is_ball |= to == ClipShape::Auto && looks_better;
        if let Finding::Unbounded | Finding::UnboundedInBall = found.finding {
            found.finding = if is_ball { Finding::UnboundedInBall } else { Finding::Unbounded };
        }
        // A given range was not chosen by the search, so it does not count as cut.
        for axis in (0..3).filter(|axis| ranges[*axis].is_some()) {
            found.cut[axis] = [false; 2];
        }
        // Between given ranges, an unbounded surface may be bounded.
        if ranges.iter().any(Option::is_some)
            && found.finding == Finding::Unbounded
            && let Some(program) = search
            && let program = program.over_time(document)
            && let Some(part) = domain::find_between(&program, &ranges, *is_tall, wanted)?
        {
            let part = AutoDomain { low: part.low, high: part.high, ..found };
            let ends = extent(document);
            let part = ends.map_or(part, |ends| part.with_box(ends));
            for axis in (0..3).filter(|axis| ranges[*axis].is_none()) {
                (found.low[axis], found.high[axis]) = (part.low[axis], part.high[axis]);
                found.cut[axis] = [false; 2];
            }
        }
        let open = (0..3).filter(|axis| ranges[*axis].is_none());
        let reach = open.map(|axis| found.high[axis].max(-found.low[axis])).fold(0.0, f64::max);
        if reach > LARGEST_COORDINATE {
            let scale = format!("1e{}", reach.log10().floor()).parse().unwrap_or(reach);
            return Err(SceneError::Far { reach, scale });
        }
        searched = Some(found);
        for (axis, range) in ranges.iter_mut().enumerate() {
            range.get_or_insert([found.low[axis], found.high[axis]]);
        }
    }
    let [x, y, z] = ranges.map(Option::unwrap_or_default);
    let (low, high) = (DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]));
    let region = clipped(low, high, is_ball, plane.or(typed_clip(document)))?;
    let is_needle = || proportions::is_needle(document, &region);
    let stretch = proportions::stretch(&region, || *is_tall || is_needle());
    Ok(Some((region.with_stretch(stretch), searched)))
}

/// Returns whether [`region`] must search for the surface.
pub fn needs_search(document: &Document, choice: DomainChoice) -> bool {
    given_ranges(document, choice).contains(&None)
}

/// The ranges of x, y and z that are given. `None` for a range to be searched.
fn given_ranges(document: &Document, choice: DomainChoice) -> [Option<[f64; 2]>; 3] {
    match (choice, &document.domain) {
        (DomainChoice::Bounds([x0, x1, y0, y1, z0, z1]), _) => {
            [[x0, x1], [y0, y1], [z0, z1]].map(Some)
        }
        (DomainChoice::Document, Some(DomainLine::Box(typed))) => {
            let floats = |(low, high): &(Constant, Constant)| [nearest(low), nearest(high)];
            typed.each_ref().map(|range| range.as_ref().map(floats))
        }
        (DomainChoice::Document, Some(DomainLine::Ball(radius))) => {
            let radius = nearest(radius);
            [Some([-radius, radius]); 3]
        }
        (DomainChoice::Auto, _) | (DomainChoice::Document, None | Some(DomainLine::Auto)) => {
            [None; 3]
        }
    }
}

/// The document's own clipping plane.
pub fn typed_clip(document: &Document) -> Option<HalfSpace> {
    document.picture.clip.as_ref().map(|numbers| {
        let [a, b, c, d] = numbers.each_ref().map(nearest);
        HalfSpace { normal: DVec3::new(a, b, c), offset: d }
    })
}

/// The box from `low` to `high`, cut by the plane `clip`, and by the box's ball if `is_round`.
///
/// # Errors
/// If the box is empty or not finite, or the plane has no normal.
pub fn clipped(
    low: DVec3,
    high: DVec3,
    is_round: bool,
    clip: Option<HalfSpace>,
) -> Result<Region, RegionError> {
    let whole = Region::new(low, high)?;
    let whole = if is_round { whole.with_ball() } else { whole };
    clip.map_or(Ok(whole), |clip| whole.with_clip(clip))
}

/// Searches for the surfaces with intervals, and ignores the document's domain. Parameters have
/// their present values; time covers its whole range, or some times if that is not bounded. The
/// domain also holds points and curves with a parameter. Curves of two equations count if there is
/// no surface.
///
/// # Errors
/// If there is no surface, or a kernel cannot be compiled.
///
/// # Panics
/// Never: this search is not cancelled.
pub fn search(document: &Document) -> Result<AutoDomain, ProgramError> {
    let is_tall = proportions::may_stretch(document);
    Ok(search_while(&mut None, document, is_tall, &|| true)?.expect("wanted to the end"))
}

/// As [`search`], but can be cancelled, and reuses the program of the previous search if possible.
/// Calls `wanted` between kernels and evaluations, and returns `None` once `wanted` returns false.
fn search_while(
    search: &mut Option<Program>,
    document: &Document,
    is_tall: bool,
    wanted: &dyn Fn() -> bool,
) -> Result<Option<AutoDomain>, ProgramError> {
    let ends = extent(document);
    let proxy = document.surfaces.is_empty().then(|| curves::as_surfaces(document));
    let Some(document) = proxy.as_ref().map_or(Some(document), Option::as_ref) else {
        return Ok(Some(AutoDomain::of_box(ends)));
    };
    let again = search.take().and_then(|before| before.rebound(document)?.ok());
    let program = search.insert(if let Some(program) = again {
        program
    } else {
        let program = Program::new(document, [Interval::ENTIRE; 3])?;
        // Most searches take less time than their kernels take to compile.
        program.hurry();
        program
    });
    let found = find(program, document, is_tall, wanted)?;
    let found = match (found, &proxy) {
        (Some(found), Some(Some(proxy))) if !found.finding.is_bounded() => {
            around_plane_curves(document, &proxy.surfaces, wanted).unwrap_or(found).into()
        }
        (found, _) => found,
    };
    Ok(found.map(|found| ends.map_or(found, |ends| found.with_box(ends))))
}

/// The box of all that is given by parameters. `None` if there is nothing.
fn extent(document: &Document) -> Option<[DVec3; 2]> {
    curves::extent(document).into_iter().chain(patches::extent(document)).reduce(patches::hull)
}

/// A domain of the surfaces of `program`. Time covers its whole range.
fn find(
    program: &Program,
    document: &Document,
    is_tall: bool,
    wanted: &dyn Fn() -> bool,
) -> Result<Option<AutoDomain>, ProgramError> {
    let moves = |(time, _): &(usize, Interval)| !is_idle(document, &document.parameters[*time]);
    match program.times(document).filter(moves) {
        Some((parameter, range)) => {
            domain::find_moving(program, Motion { parameter, range }, is_tall, wanted)
        }
        None => domain::find_while(program, is_tall, wanted),
    }
}

/// A domain of curves that all lie in planes across one axis: that of the surfaces over which they
/// lie, with the planes in the middle. If the curves move, it holds their domains at some times.
/// `None` for other curves, or once `wanted` returns false.
fn around_plane_curves(
    document: &Document,
    surfaces: &[Surface],
    wanted: &dyn Fn() -> bool,
) -> Option<AutoDomain> {
    let moments = curves::moments(document);
    let moments = moments.as_deref().unwrap_or(std::slice::from_ref(document));
    let now = |document| around_plane_curves_now(&curves::in_planes(document, surfaces)?, wanted);
    let found: Option<Vec<AutoDomain>> = moments.iter().map(now).collect();
    found?.into_iter().reduce(AutoDomain::hull)
}

fn around_plane_curves_now(curves: &PlaneCurves, wanted: &dyn Fn() -> bool) -> Option<AutoDomain> {
    let document = &curves.surfaces;
    let program = Program::new(document, [Interval::ENTIRE; 3]).ok()?;
    program.hurry();
    let mut found = find(&program, document, false, wanted).ok()??;
    let others = (0..3).filter(|other| *other != curves.axis);
    let widest = others.map(|other| found.high[other] - found.low[other]).fold(0.0, f64::max);
    let end = |plane: f64, side: f64| domain::rounded(plane + side * widest / 4.0, widest / 1000.0);
    found.low[curves.axis] = end(curves.ends[0], -1.0);
    found.high[curves.axis] = end(curves.ends[1], 1.0);
    found.cut[curves.axis] = [false; 2];
    found.finding = match found.finding {
        Finding::UnboundedInBall => Finding::Unbounded,
        other => other,
    };
    Some(found)
}

/// Returns whether [`search`] gives the same result for two documents. Their surfaces must differ
/// only in values of parameters, each within its range.
pub fn same_search(one: &Document, other: &Document) -> bool {
    let parameters = one.parameters.iter().zip(&other.parameters);
    let is_alike = one.curves.are_alike(&other.curves)
        && one.patches.are_alike(&other.patches)
        && one.picture.is_equal == other.picture.is_equal;
    is_alike && { parameters }.all(|(one, other)| {
        let loops = one.kind == ParameterKind::Time && one.range.is_some();
        loops || one.value == other.value
    })
}

/// The bounds of x, y and z of a region's box.
pub fn bounds(region: &Region) -> [Interval; 3] {
    [0, 1, 2].map(|axis| Interval { lo: region.low()[axis], hi: region.high()[axis] })
}

/// Returns whether nothing that `document` draws depends on `parameter`.
pub fn is_idle(document: &Document, parameter: &Parameter) -> bool {
    let roots: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
    let needed = document.graph.reachable(&roots);
    let node = Node::Parameter(parameter.number);
    let is_drawn = document.graph.iter().any(|(id, other)| needed[id.index()] && *other == node);
    let number = parameter.number;
    let is_drawn =
        is_drawn || document.curves.depend_on(number) || document.patches.depend_on(number);
    let surfaces = document.drawn_surfaces().map(|surface| surface.color);
    let colors = surfaces.chain(document.curves.all.iter().map(|curve| curve.color.as_ref()));
    let colors = colors.filter_map(|color| match color {
        Some(SurfaceColor::Mapped(mapped)) => Some(&mapped.value),
        Some(SurfaceColor::Plain(_)) | None => None,
    });
    let lines = document.picture.contours.iter().filter_map(|lines| lines.value.as_ref());
    let paints = |value: &PointValue| value.graph.iter().any(|(_, other)| *other == node);
    !is_drawn && !colors.chain(lines).any(paints)
}

/// Returns whether anything that `document` draws depends on the time `t`.
pub fn depends_on_time(document: &Document) -> bool {
    let mut times = document.parameters.iter().filter(|one| one.kind == ParameterKind::Time);
    times.any(|time| !is_idle(document, time))
}

#[cfg(test)]
mod tests;
