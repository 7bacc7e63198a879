//! The pieces of a surface in one box, over a side of the box.
//!
//! All coordinates are the box's own, which run from −1 to 1.

use crate::clip::Strip;
use crate::polygon::{Line, Polygon};
use glam::DVec2;
use zeroset_interval::Interval;
use zeroset_scene::choices::Choice;

/// Bound of rounding errors of polygons in a square.
const ROUNDING: f64 = 1e-13;

/// The side of a choice in a box in which its parts have these values: whether it is inside. `None`
/// if that is not known. Then the parts that may decide are added to `parts`.
pub fn side(
    choice: &Choice,
    value: &dyn Fn(usize) -> Interval,
    parts: &mut Vec<usize>,
) -> Option<bool> {
    let part = |part: usize, is_opposite: bool, parts: &mut Vec<usize>| {
        let value = value(part);
        if value.hi < 0.0 || value.lo > 0.0 {
            return Some((value.hi < 0.0) != is_opposite);
        }
        parts.push(part);
        None
    };
    let (all, decisive) = match choice {
        Choice::Part(number) => return part(*number, false, parts),
        Choice::Opposite(number) => return part(*number, true, parts),
        Choice::Min(all) => (all, true),
        Choice::Max(all) => (all, false),
    };
    let before = parts.len();
    let mut found = Some(!decisive);
    for one in all {
        match side(one, value, parts) {
            Some(is_inside) if is_inside == decisive => {
                parts.truncate(before);
                return Some(decisive);
            }
            Some(_) => {}
            None => found = None,
        }
    }
    found
}

/// A part whose zeros are a graph over a side of a box.
pub struct Graph {
    /// The number of the part.
    pub part: usize,
    /// The axis across the side.
    pub axis: usize,
    /// The part as a linear function with an error.
    pub strip: Strip,
    /// Bounds of the factor of the area.
    pub factor: Interval,
    /// The factor as a linear function with an error.
    pub form: Option<Strip>,
}

/// The pieces of a surface in one box.
pub struct Pieces<'a> {
    /// The function.
    pub choice: &'a Choice,
    /// The parts that matter, and their linear functions.
    pub parts: &'a [usize],
    pub strips: &'a [Option<Strip>],
    /// Bounds of all parts.
    pub signs: &'a dyn Fn(usize) -> Interval,
}

/// A polygon in which some parts have known signs.
struct Signed {
    polygon: Polygon,
    /// For each part that matters, its sign, or 0.
    signs: Vec<f64>,
}

impl Pieces<'_> {
    /// Bounds of the solid's part of a face across an axis, in the square's coordinates.
    pub fn face(&self, axis: usize) -> [f64; 2] {
        let project = |strip: &Strip| {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            let slope = DVec2::new(strip.slope[a], strip.slope[b]);
            Line { value: strip.value, slope, error: strip.error + strip.slope[axis].abs() }
        };
        let lines: Vec<Option<Line>> =
            self.strips.iter().map(|strip| strip.as_ref().map(project)).collect();
        let (mut sure, mut none) = (0.0, 0.0);
        Self::split(Polygon::square(), &lines, &mut |region| {
            let (area, _) = region.polygon.moments();
            match self.is_inside(&region.signs, None) {
                Some(true) => sure += area,
                Some(false) => none += area,
                None => {}
            }
        });
        [(sure - ROUNDING).max(0.0), (4.0 - none + ROUNDING).clamp(0.0, 4.0)]
    }

    /// Bounds of the area of a graph's piece of the surface, in the coordinates of the square.
    pub fn graph(&self, graph: &Graph, is_open: [bool; 2]) -> [f64; 2] {
        let Graph { axis, strip, .. } = graph;
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        let steep = strip.slope[*axis];
        // On the graph, the coordinate along the axis is this linear function.
        let height = Line {
            value: -strip.value / steep,
            slope: DVec2::new(strip.slope[a], strip.slope[b]) / -steep,
            error: strip.error / steep.abs(),
        };
        let project = |strip: &Strip| {
            let along = strip.slope[*axis];
            Line {
                value: strip.value + along * height.value,
                slope: DVec2::new(strip.slope[a], strip.slope[b]) + along * height.slope,
                error: strip.error + along.abs() * height.error,
            }
        };
        let (mut all, mut most) = (Polygon::square(), Polygon::square());
        let upper = Line { value: height.value - 1.0, ..height };
        let lower = Line { value: -height.value - 1.0, ..height.negated() };
        for (line, is_open) in [(lower, is_open[0]), (upper, is_open[1])] {
            // The graph does not go beyond an end that is not open.
            if is_open {
                all = all.cut(&line, line.error);
                most = most.cut(&line, -line.error);
            }
        }
        let line = |(part, strip): (&usize, &Option<Strip>)| {
            if *part == graph.part { None } else { strip.as_ref().map(project) }
        };
        let lines: Vec<Option<Line>> = self.parts.iter().zip(self.strips).map(line).collect();
        let factor = graph.form.as_ref().map(project);
        let integral = |polygon: &Polygon| {
            let (area, first) = polygon.moments();
            let bounds = [graph.factor.lo * area, graph.factor.hi * area];
            let near = factor.map_or(bounds, |factor| {
                let mean = factor.value * area + factor.slope.dot(first);
                [mean - factor.error * area, mean + factor.error * area]
            });
            [bounds[0].max(near[0]), bounds[1].min(near[1])]
        };
        let (mut low, mut high, mut without) = (0.0, 0.0, 0.0);
        let mut decided = 0.0;
        Self::split(all, &lines, &mut |region| {
            let ends =
                [-1.0, 1.0].map(|sign| self.is_inside(&region.signs, Some((graph.part, sign))));
            match ends {
                [Some(one), Some(other)] if one != other => {
                    let [least, greatest] = integral(&region.polygon);
                    (low, high) = (low + least, high + greatest);
                    decided += region.polygon.moments().0;
                }
                [Some(_), Some(_)] => without += region.polygon.moments().0,
                _ => {}
            }
        });
        // Elsewhere in the larger polygon, the piece may be there or not.
        let rest = (most.moments().0 - decided - without).max(0.0) + ROUNDING;
        [(low - ROUNDING * graph.factor.hi).max(0.0), high + rest * graph.factor.hi]
    }

    /// Divides a polygon into regions in which parts have proven signs. Leaves out where a part may
    /// be 0.
    fn split(polygon: Polygon, lines: &[Option<Line>], found: &mut dyn FnMut(&Signed)) {
        let mut regions = vec![Signed { polygon, signs: vec![0.0; lines.len()] }];
        for (number, line) in lines.iter().enumerate() {
            let Some(line) = line else { continue };
            let mut parts = Vec::new();
            for region in regions {
                for (line, sign) in [(*line, -1.0), (line.negated(), 1.0)] {
                    let polygon = region.polygon.cut(&line, line.error);
                    if !polygon.is_empty() {
                        let mut signs = region.signs.clone();
                        signs[number] = sign;
                        parts.push(Signed { polygon, signs });
                    }
                }
            }
            regions = parts;
        }
        regions.iter().for_each(found);
    }

    /// Returns whether a point is inside where the parts that matter have these signs, and one part
    /// has its own.
    fn is_inside(&self, signs: &[f64], own: Option<(usize, f64)>) -> Option<bool> {
        let value = |part: usize| {
            let sign = match own {
                Some((own, sign)) if own == part => sign,
                _ => match self.parts.binary_search(&part) {
                    Ok(place) => signs[place],
                    Err(_) => return (self.signs)(part),
                },
            };
            Interval { lo: sign, hi: sign }
        };
        side(self.choice, &value, &mut Vec::new())
    }
}
