//! Color maps and contour lines, which show the value of a function at each point.
//!
//! Values are computed in ordinary floats. No proof depends on them.

use super::Model;
use super::trace::Advance;
use crate::legend::{Legend, round_step};
use crate::progress::Done;
use glam::Vec4;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};
use zeroset_scene::number::nearest;
use zeroset_scene::point_value::{Place, PointValues};
use zeroset_shade::{Appearance, ColorDepth, LinearRgb, Paint};
use zeroset_style::ColorMap;
use zeroset_syntax::{MappedColor, PointValue, SurfaceColor};
use zeroset_trace::{GBuffer, RayGrid};

/// Width of a contour line, in pixels.
const WIDTH: f64 = 1.4;
/// Approximate number of contour lines over the range of values, if no step is given.
const LINES: f64 = 12.0;
/// Contour lines that are less than this many pixels apart fade into their mean color.
const DENSE: f64 = 3.0;
/// A range wider than this share of its largest value is not due to rounding errors.
const LEAST_RANGE: f64 = 1e-2;
/// Uncertainty of the position of a painted point along its ray, in pixels.
const POINT_UNCERTAINTY: f64 = 0.1;
/// Number of points that a thread processes between two checks of the time.
const PART: usize = 8;

/// Everything needed to color a picture: light, surface colors and paint.
pub(super) struct Coloring<'a> {
    /// Light and surface colors.
    pub appearance: Appearance,
    /// The format in which colors are kept: bytes or floats.
    pub depth: ColorDepth,
    /// Color maps and contour lines. `None` if there are neither.
    pub painter: Option<Painter<'a>>,
    /// Light and opacity of the ground behind the surfaces. Empty without a ground.
    pub ground: Vec<Option<[f32; 4]>>,
}

impl Coloring<'_> {
    /// The light and opacity of the ground at a pixel, if it is seen there.
    pub fn ground_at(&self, pixel: usize) -> Option<Vec4> {
        self.ground.get(pixel).copied().flatten().map(Vec4::from_array)
    }
}

/// Color maps and contour lines on the surfaces.
pub(super) struct Painter<'a> {
    model: &'a Model,
    /// As for [`Model::trace`]. No further values are computed once it returns `false`.
    advance: Advance<'a>,
    is_cut: AtomicBool,
    /// Color scale of each surface; `None` if the surface has its own color.
    scales: Vec<Option<ValueScale<'a>>>,
    /// Value and step of the contour lines on each surface.
    contours: Vec<Option<(&'a PointValue, f64)>>,
    /// Value and step of the lines of a mesh, on all surfaces but parametric ones.
    mesh: Vec<(&'a PointValue, f64)>,
}

/// A color map, and the range of a value that is mapped to its colors.
#[derive(Clone, Copy)]
struct ValueScale<'a> {
    map: &'static ColorMap,
    value: &'a PointValue,
    low: f64,
    high: f64,
}

impl<'a> Painter<'a> {
    /// Returns whether there are color maps or contour lines.
    pub fn is_wanted(model: &Model) -> bool {
        let is_mapped = |surface| Self::mapped(model, surface).is_some();
        model.setting.coordinates.is_some() || (0..model.surfaces()).any(is_mapped)
    }

    /// The color map of a surface. `None` without a map, or if the surface is hidden.
    fn mapped(model: &Model, surface: usize) -> Option<&MappedColor> {
        match &model.styles[surface].color {
            Some(SurfaceColor::Mapped(mapped)) if !model.styles[surface].hidden => Some(mapped),
            Some(SurfaceColor::Mapped(_) | SurfaceColor::Plain(_)) | None => None,
        }
    }

    /// The color maps and lines of a model; `None` if it has neither. If the document gives
    /// no range of values, the surface points in `picture` give it.
    pub fn new(
        model: &'a Model,
        picture: &GBuffer,
        rays: &RayGrid,
        advance: Advance<'a>,
    ) -> Option<Self> {
        let mapped = |surface: usize| Self::mapped(model, surface);
        let surfaces = 0..model.surfaces();
        if !Self::is_wanted(model) {
            return None;
        }
        let is_cut = AtomicBool::new(false);
        let blank = Self {
            model,
            advance,
            is_cut,
            scales: Vec::new(),
            contours: Vec::new(),
            mesh: Vec::new(),
        };
        let range = |value: &PointValue, shown: &dyn Fn(usize) -> bool| {
            let points = points(picture, |pixel| shown(usize::from(picture.surface[pixel])));
            let values = blank.values(value, &points, picture, rays, 0.0);
            let finite = values.iter().copied().filter(|value| value.is_finite());
            let none = [f64::INFINITY, f64::NEG_INFINITY];
            let [low, high] = finite.fold(none, |[low, high], v| [low.min(v), high.max(v)]);
            if low > high {
                return [0.0, 1.0];
            }
            if high - low > LEAST_RANGE * low.abs().max(high.abs()) {
                return [low, high];
            }
            // A range that the uncertainty of the points can explain counts as a single value.
            let moved = blank.values(value, &points, picture, rays, POINT_UNCERTAINTY);
            let both = values.iter().zip(moved);
            let unsure = both.map(|(value, moved)| (moved - value).abs()).fold(0.0, f64::max);
            if high - low > unsure { [low, high] } else { [low.midpoint(high); 2] }
        };
        let is_same = |one: &MappedColor, other: &MappedColor| {
            (one.map, &one.value.echo, &one.range) == (other.map, &other.value.echo, &other.range)
        };
        let scale = |surface: usize| {
            let own = mapped(surface)?;
            let [low, high] = match &own.range {
                Some(ends) => ends.each_ref().map(nearest),
                // Surfaces with the same color map and value share a scale.
                None => {
                    range(&own.value, &|other| mapped(other).is_some_and(|one| is_same(own, one)))
                }
            };
            Some(ValueScale { map: own.map, value: &own.value, low, high })
        };
        let coordinates = model.setting.coordinates.as_ref();
        let scales: Vec<Option<ValueScale<'_>>> = surfaces.clone().map(scale).collect();
        let contours = surfaces.map(|surface| {
            let setting = model.setting.lines.contours.as_ref()?;
            let scale = scales[surface];
            let value = setting.value.as_ref().or(scale.map(|scale| scale.value));
            let value = value.or(coordinates.map(|all| &all[2]))?;
            let [low, high] = match scale {
                _ if setting.step.is_some() => [0.0; 2],
                Some(scale) if setting.value.is_none() => [scale.low, scale.high],
                _ => range(value, &|_| true),
            };
            let step =
                setting.step.as_ref().map_or_else(|| round_step((high - low) / LINES), nearest);
            (step > 0.0 && step.is_finite()).then_some((value, step))
        });
        let contours = contours.collect();
        let size = model.region.high() - model.region.low();
        let line = |&axis: &usize| {
            let step = round_step(size[axis] / LINES);
            let is_valid = step > 0.0 && step.is_finite();
            coordinates.filter(|_| is_valid).map(|all| (&all[axis], step))
        };
        let mesh = model.setting.mesh.iter().filter_map(line).collect();
        Some(Self { scales, contours, mesh, ..blank })
    }

    /// Returns whether some values were not computed, since `advance` returned `false`.
    pub fn is_cut(&self) -> bool {
        self.is_cut.load(Ordering::Relaxed)
    }

    /// The legends, one for each distinct color scale.
    pub fn legends(&self) -> Vec<Legend> {
        let mut legends: Vec<Legend> = Vec::new();
        for (scale, contours) in self.scales.iter().zip(&self.contours) {
            let Some(ValueScale { map, value, low, high }) = scale else { continue };
            let own = contours.filter(|(contour, _)| contour.echo == value.echo);
            let step = own.map(|(_, step)| step);
            let legend = Legend { map, value: value.echo.clone(), low: *low, high: *high, step };
            if !legends.contains(&legend) {
                legends.push(legend);
            }
        }
        legends
    }

    /// The paint of a picture's pixels. A pixel of the final picture is `side` of these pixels wide
    /// and high.
    pub fn paint(&self, picture: &GBuffer, rays: &RayGrid, side: usize) -> Vec<Paint> {
        let mut paint = vec![Paint::NONE; picture.drawn.len()];
        for surface in 0..self.model.surfaces() {
            let points = points(picture, |pixel| usize::from(picture.surface[pixel]) == surface);
            let (scale, contours) = (&self.scales[surface], &self.contours[surface]);
            let mut known: Option<(&str, Vec<f64>)> = None;
            if let Some(ValueScale { map, value, low, high }) = scale {
                let values = self.values(value, &points, picture, rays, 0.0);
                let extent = high - low;
                for (&pixel, value) in points.iter().zip(&values) {
                    // If the scale has only a single value, use the middle color.
                    let share = if extent > 0.0 { (value - low) / extent } else { 0.5 };
                    if !value.is_nan() {
                        paint[pixel].base = LinearRgb::from_srgb(map.bytes(share));
                    }
                }
                known = Some((&value.echo, values));
            }
            let mut draw = |values: &[f64], step: f64| {
                let lines = Lines { step, side: side as f64 };
                let mut field = vec![f64::NAN; picture.drawn.len()];
                points.iter().zip(values).for_each(|(&pixel, value)| field[pixel] = *value);
                for &pixel in &points {
                    let ink = lines.ink(&field, pixel, rays.beside(pixel)) as f32;
                    paint[pixel].ink = paint[pixel].ink.max(ink);
                }
            };
            let patch = self.model.program.patch(surface);
            let mesh = if patch.is_some() { &[][..] } else { &self.mesh };
            for (value, step) in contours.iter().chain(mesh) {
                let values = match &known {
                    Some((echo, values)) if *echo == value.echo => Cow::Borrowed(values),
                    _ => Cow::Owned(self.values(value, &points, picture, rays, 0.0)),
                };
                draw(&values, *step);
            }
            if let Some(patch) = patch.filter(|_| !self.model.setting.mesh.is_empty()) {
                for (axis, [low, high]) in patch.ranges().into_iter().enumerate() {
                    let share = |pixel: &usize| {
                        (self.parameters(picture, *pixel)[axis] - low) / (high - low)
                    };
                    draw(&points.iter().map(share).collect::<Vec<_>>(), 1.0 / LINES);
                }
            }
        }
        paint
    }

    /// The parameters of a pixel's point; NaN on an equation or a solid.
    fn parameters(&self, picture: &GBuffer, pixel: usize) -> [f64; 2] {
        let surface = usize::from(picture.surface[pixel]);
        let known = self.model.program.patch(surface).and(picture.parameters.get(pixel));
        known.map_or([f64::NAN; 2], |known| known.map(f64::from))
    }

    /// Values at the points of these pixels, each moved back along its ray by `behind` pixel
    /// widths. NaN for values that were not computed in time.
    fn values(
        &self,
        value: &PointValue,
        points: &[usize],
        picture: &GBuffer,
        rays: &RayGrid,
        behind: f64,
    ) -> Vec<f64> {
        let evaluated = PointValues::new(value, &self.model.setting.parameters);
        let place = |pixel: usize| {
            let ray = rays.ray_of(pixel);
            let drawn = picture.drawn[pixel];
            let t = ray.parameter(drawn);
            let at = ray.at(t + behind * rays.footprint(t));
            let [nx, ny, nz] = picture.normal[pixel].map(f64::from);
            let own = [nx, ny, nz, drawn];
            Place { at: at.to_array(), own, parameters: self.parameters(picture, pixel) }
        };
        let mut values = vec![f64::NAN; points.len()];
        let parts = values.par_chunks_mut(PART).zip(points.par_chunks(PART));
        parts.for_each_init(
            || evaluated.room(),
            |room, (values, points)| {
                if !(self.advance)(Done::NOTHING) {
                    self.is_cut.store(true, Ordering::Relaxed);
                    return;
                }
                for (values, two) in values.chunks_mut(2).zip(points.chunks(2)) {
                    let ends = [place(two[0]), place(two[two.len() - 1])];
                    values.copy_from_slice(&evaluated.pair(room, ends)[..two.len()]);
                }
            },
        );
        values
    }
}

/// The painted pixels for which `holds` is true.
fn points(picture: &GBuffer, holds: impl Fn(usize) -> bool) -> Vec<usize> {
    (0..picture.drawn.len()).filter(|&pixel| picture.is_drawn(pixel) && holds(pixel)).collect()
}

/// Contour lines in a picture.
struct Lines {
    /// Difference in value between adjacent lines.
    step: f64,
    /// Width of a pixel of the final picture, in pixels of the picture that is painted.
    side: f64,
}

impl Lines {
    /// The share of a pixel that lines cover. It depends on the pixel's value in `field`, and on
    /// the values of the pixels [beside](RayGrid::beside) it.
    fn ink(&self, field: &[f64], pixel: usize, beside: [Option<usize>; 4]) -> f64 {
        let value = field[pixel];
        // Values jump at outlines of surfaces, so use the smaller of the changes toward both sides.
        let [left, right, above, below] =
            beside.map(|there| (there.map_or(f64::NAN, |there| field[there]) - value).abs());
        let (across, down) = (left.min(right), above.min(below));
        let slope = across.hypot(down);
        let away = (value / self.step - (value / self.step).round()).abs() * self.step / slope;
        let width = WIDTH * self.side;
        let cover = (width / 2.0 + 0.5 - away).clamp(0.0, 1.0);
        let apart = self.step / slope / self.side;
        let mean = WIDTH / apart;
        let sharp = ((apart - DENSE / 2.0) / (DENSE / 2.0)).clamp(0.0, 1.0);
        let ink = sharp * cover + (1.0 - sharp) * mean.min(0.5);
        if ink.is_nan() { 0.0 } else { ink }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use zeroset_space::{Camera, Projection};

    #[test]
    fn lines_are_as_wide_whatever_the_slope() {
        for slope in [0.004, 0.05, 0.1] {
            let (width, height) = (400, 3);
            let field: Vec<f64> =
                (0..width * height).map(|n| slope * (n % width) as f64 + 0.01).collect();
            let (rays, lines) = (rays(width, height), Lines { step: 1.0, side: 1.0 });
            let row = width..2 * width;
            let ink: f64 = row.map(|pixel| lines.ink(&field, pixel, rays.beside(pixel))).sum();
            // There is one line for each whole number among the values.
            let crossed = (slope * 399.0 + 0.01).floor();
            assert!((ink / crossed / WIDTH - 1.0).abs() < 0.1, "{slope}: {ink} of {crossed}");
        }
        // Far too many lines fade into gray. A constant value has no lines.
        let field: Vec<f64> = (0..300).map(|n| 7.3 * f64::from(n % 100)).collect();
        let (rays, lines) = (rays(100, 3), Lines { step: 1.0, side: 1.0 });
        let ink = |field: &[f64], pixel: usize| lines.ink(field, pixel, rays.beside(pixel));
        assert!((100..200).all(|pixel| (ink(&field, pixel) - 0.5).abs() < 1e-9));
        assert!((100..200).all(|pixel| ink(&[0.3; 300], pixel) == 0.0));
    }

    fn rays(width: usize, height: usize) -> RayGrid {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::NEG_Y, DVec3::ZERO, DVec3::Z, projection);
        RayGrid::new(&camera.expect("valid"), width, height)
    }
}
