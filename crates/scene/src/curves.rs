//! Curves and points of a document, traced to polylines for the present values of its parameters.
//!
//! Tracing computes in ordinary floats, and no proof depends on it. Only the search for the cells
//! that may hold a curve of two equations uses enclosures. Nothing here knows cameras or pixels.

pub(crate) mod functions;
mod intersection;
mod march;
mod path;
mod plane;
mod shaped;

use crate::number::nearest;
use crate::patches::hull;
use functions::bound;
use glam::DVec3;
pub(crate) use plane::{PlaneCurves, in_planes};
use rayon::prelude::*;
use zeroset_interval::Interval;
use zeroset_ir::{Constant, NodeId};
use zeroset_space::Region;
use zeroset_syntax::{Curve, CurveShape, Document, MappedColor, ParameterKind, SurfaceColor};

/// Curves and points in a region, ready to be drawn.
#[derive(Clone, Debug, Default)]
pub struct TracedCurves {
    /// The curves, in pieces.
    pub lines: Vec<TracedLine>,
    /// The points.
    pub points: Vec<TracedPoint>,
    /// Remarks on curves that are not drawn, or not exactly.
    pub remarks: Vec<String>,
    /// For each surface, the share of light that it lets through.
    pub clear: Vec<f64>,
}

/// A piece of a curve.
#[derive(Clone, Debug)]
pub struct TracedLine {
    /// Vertices of the polyline, in order. There are at least two.
    pub at: Vec<DVec3>,
    /// Colors of the vertices, or one color for all; empty for the default color.
    pub colors: Vec<[u8; 3]>,
    /// Number of the curve among all curves and points of the document.
    pub number: usize,
    /// Number of the curve among all curves. It selects the default color.
    pub order: usize,
    /// Width in pixels, if the document sets it.
    pub width: Option<f64>,
}

/// A point that is drawn.
#[derive(Clone, Debug)]
pub struct TracedPoint {
    /// The point's place in space.
    pub at: DVec3,
    /// The text beside it.
    pub label: String,
    /// Its color; `None` for the default color.
    pub color: Option<[u8; 3]>,
    /// Number of the point among all curves and points of the document.
    pub number: usize,
    /// Width in pixels, if the document sets it.
    pub width: Option<f64>,
}

impl TracedCurves {
    /// Returns whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.points.is_empty()
    }

    /// Vertices of all curves, and all points.
    pub fn places(&self) -> impl Iterator<Item = DVec3> + '_ {
        let lines = self.lines.iter().flat_map(|line| line.at.iter().copied());
        lines.chain(self.points.iter().map(|point| point.at))
    }

    /// Per axis, whether all curves and points lie in one plane across it.
    pub fn flat(&self) -> [bool; 3] {
        let low = self.places().fold(DVec3::INFINITY, DVec3::min);
        let high = self.places().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = high - low;
        let thickest = FLAT * size.max_element();
        size.to_array().map(|extent| (0.0..=thickest).contains(&extent))
    }
}

/// The remark that arrays, meshes and counts leave curves out.
pub const UNPROVEN: &str =
    "curves and points are drawn, not proven: arrays, counts and meshes leave them out";

/// Drawings are flat if their thickness is at most this share of their largest extent: that is how
/// exactly curves are traced.
const FLAT: f64 = 1e-6;

/// Largest number of points with labels of their coordinates. More would cover one another.
const LABELED_POINTS: usize = 50;

/// Traces the visible curves and points of `document` in `region`.
pub fn trace(document: &Document, region: &Region) -> TracedCurves {
    let curves = &document.curves;
    let mut all = TracedCurves::default();
    if curves.is_empty() {
        return all;
    }
    all.clear = document.drawn_surfaces().map(|surface| 1.0 - surface.opacity).collect();
    let lines = curves.all.iter().enumerate();
    let lines = lines.filter(|(_, curve)| !matches!(curve.shape, CurveShape::Point { .. }));
    let lines: Vec<_> = lines.enumerate().filter(|(_, (_, curve))| !curve.hidden).collect();
    let traced: Vec<(Vec<TracedLine>, Option<String>)> = lines
        .into_par_iter()
        .map(|(order, (number, curve))| line(document, region, [order, number], curve))
        .collect();
    for (lines, remark) in traced {
        all.lines.extend(lines);
        all.remarks.extend(remark);
    }
    color_by_values(document, &mut all.lines);
    let points = points(document);
    let has_labels = points.len() <= LABELED_POINTS;
    for (number, curve, at) in points {
        let CurveShape::Point { label, .. } = &curve.shape else { continue };
        let Some(at) = at else {
            all.remarks.push(format!("'{}' has no value, so it is not drawn", curve.echo));
            continue;
        };
        if !shaped::holds(region, at) || curve.hidden {
            continue;
        }
        let own = || if has_labels { coordinates_text(at) } else { String::new() };
        all.points.push(TracedPoint {
            at,
            label: label.clone().unwrap_or_else(own),
            color: plain(curve),
            number,
            width: curve.width,
        });
    }
    all
}

/// The pieces of one curve, and a remark if it is not drawn exactly.
fn line(
    document: &Document,
    region: &Region,
    [order, number]: [usize; 2],
    curve: &Curve,
) -> (Vec<TracedLine>, Option<String>) {
    let size = 2.0 * region.half_extent();
    let (pieces, problem) = match &curve.shape {
        CurveShape::Path { at, ends } => match path::Path::new(document, *at, *ends) {
            Some(path) => path.traced(region, size),
            None => (Vec::new(), Some("has no range, or is too large")),
        },
        CurveShape::Intersection(both) => intersection::traced(document, *both, region),
        CurveShape::Point { .. } => (Vec::new(), None),
    };
    let pieces = pieces.iter().flat_map(|piece| shaped::clipped(region, piece));
    let colors: Vec<[u8; 3]> = plain(curve).into_iter().collect();
    let lines = pieces
        .map(|at| TracedLine { at, colors: colors.clone(), number, order, width: curve.width })
        .collect();
    let remark = problem.map(|problem| format!("the curve '{}' {problem}", curve.echo));
    (lines, remark)
}

/// The color of a curve that is the same everywhere.
fn plain(curve: &Curve) -> Option<[u8; 3]> {
    match &curve.color {
        Some(SurfaceColor::Plain(color)) => Some(color.rgb),
        Some(SurfaceColor::Mapped(_)) | None => None,
    }
}

/// Colors each curve that has a color map by the value at its vertices.
fn color_by_values(document: &Document, lines: &mut [TracedLine]) {
    for (number, curve) in document.curves.all.iter().enumerate() {
        let Some(SurfaceColor::Mapped(MappedColor { map, value, range })) = &curve.color else {
            continue;
        };
        let own = || lines.iter().filter(|line| line.number == number);
        let places: Vec<DVec3> = own().flat_map(|line| line.at.iter().copied()).collect();
        let values = functions::values_at(document, value, &places);
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let [low, high] = match range {
            Some(range) => range.each_ref().map(nearest),
            None => {
                [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)]
            }
        };
        let mut colors = values.iter().map(|value| map.bytes((value - low) / (high - low)));
        for line in lines.iter_mut().filter(|line| line.number == number) {
            line.colors = colors.by_ref().take(line.at.len()).collect();
        }
    }
}

/// All points, each with its number, its statement and its place, if it has one.
fn points(document: &Document) -> Vec<(usize, &Curve, Option<DVec3>)> {
    let curves = &document.curves;
    let of = |(number, curve): (usize, &'_ Curve)| match &curve.shape {
        CurveShape::Point { at, .. } => Some((number, *at)),
        CurveShape::Path { .. } | CurveShape::Intersection(_) => None,
    };
    let found: Vec<(usize, [NodeId; 3])> = curves.all.iter().enumerate().filter_map(of).collect();
    let roots: Vec<NodeId> = found.iter().flat_map(|(_, at)| *at).collect();
    let known = match bound(document, &roots) {
        Some((graph, roots)) => roots.iter().map(|root| graph.number(*root).map(nearest)).collect(),
        None => vec![None; roots.len()],
    };
    let place = |values: &[Option<f64>]| {
        let [x, y, z] = [values[0]?, values[1]?, values[2]?];
        Some(DVec3::new(x, y, z)).filter(|at| at.is_finite())
    };
    let places = known.as_chunks::<3>().0.iter();
    found
        .iter()
        .zip(places)
        .map(|((number, _), values)| (*number, &curves.all[*number], place(values)))
        .collect()
}

/// Coordinates in brackets, with few digits.
fn coordinates_text(at: DVec3) -> String {
    let number = |value: f64| {
        let text = format!("{value:.3e}").parse::<f64>().unwrap_or(value);
        crate::coordinate::coordinate(if text == 0.0 { 0.0 } else { text })
    };
    let [x, y, z] = at.to_array().map(number);
    format!("({x}, {y}, {z})")
}

/// The corners of a box around all points and all curves with a parameter, hidden ones too, for all
/// times in the range of the time. `None` without points and such curves. The far parts of a curve
/// that goes to infinity are left out.
pub fn extent(document: &Document) -> Option<[DVec3; 2]> {
    let boxes = moments(document);
    let boxes = boxes.iter().flatten().filter_map(extent_now).chain(extent_now(document));
    boxes.reduce(hull)
}

/// The document at times in the range of the time, if a curve or a parametric surface depends on
/// the time.
pub(crate) fn moments(document: &Document) -> Option<Vec<Document>> {
    let mut parameters = document.parameters.iter();
    let time = parameters.position(|one| one.kind == ParameterKind::Time)?;
    let (low, high) = document.parameters[time].range.as_ref()?;
    let number = document.parameters[time].number;
    if !document.curves.depend_on(number) && !document.patches.depend_on(number) {
        return None;
    }
    let (low, high) = (nearest(low), nearest(high));
    let at = |n: usize| {
        let value = low + (high - low) * n as f64 / MOMENTS as f64;
        let mut document = document.clone();
        document.parameters[time].value = Interval::point(value).map(Constant::enclosed)?;
        Some(document)
    };
    (0..=MOMENTS).map(at).collect()
}

/// Number of parts of the range of the time, at whose ends curves are looked at.
const MOMENTS: usize = 16;

/// The box of [`extent`] at the present time.
fn extent_now(document: &Document) -> Option<[DVec3; 2]> {
    let mut places: Vec<DVec3> = points(document).into_iter().filter_map(|(.., at)| at).collect();
    for curve in &document.curves.all {
        if let CurveShape::Path { at, ends } = &curve.shape
            && let Some(path) = path::Path::new(document, *at, *ends)
        {
            places.extend(path.extent().into_iter().flatten());
        }
    }
    let low = places.iter().copied().reduce(DVec3::min)?;
    let high = places.iter().copied().reduce(DVec3::max)?;
    Some([low, high])
}

/// The document with one surface for each curve of two equations: the equation that both hold. Its
/// domain is the curves' domain. `None` if there is no such curve.
pub fn as_surfaces(document: &Document) -> Option<Document> {
    let surfaces = functions::both_zero(document);
    let (graph, surfaces) = surfaces?;
    Some(Document { graph, surfaces, ..document.clone() })
}

#[cfg(test)]
mod tests;
