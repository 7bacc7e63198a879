//! The region's box over a picture, with labeled ticks. Lines behind the surface are faint.

use super::canvas::{Canvas, Rgb};
use super::letters::{width, with_minus};
use super::projector::{PictureView, Projector};
use super::ticks::ticks;
use glam::{DVec2, DVec3};
use zeroset_scene::camera::corners;

const SEEN: u32 = 190;
const HIDDEN: u32 = 36;

/// Width of a line, in dots of a letter.
const WIDTH: f64 = 1.1;

/// Least space between labels, in dots of a letter.
const SPACE: f64 = 5.0;

/// Least length of an axis with labels, in dots of a letter.
const LEAST: f64 = 2.0;

/// Number of pieces into which an edge is divided for tests of visibility.
const PIECES: usize = 256;

impl Projector<'_> {
    /// Draws a segment between two points in space. Its hidden parts are fainter.
    fn line(&self, cover: &mut Cover, from: DVec3, to: DVec3) {
        // Start, end and opacity of a part of the edge with the same visibility throughout.
        let mut part: Option<(DVec2, DVec2, Option<u32>)> = None;
        let mut draw = |part: Option<(DVec2, DVec2, Option<u32>)>| {
            if let Some((from, to, Some(share))) = part {
                cover.line(from, to, share);
            }
        };
        for piece in 0..=PIECES {
            let point = from.lerp(to, piece as f64 / PIECES as f64);
            // Positions far outside the picture are not drawn.
            let near = |at: DVec2| at.abs().max_element() < 1e5;
            let Some((at, distance)) = self.project(point).filter(|(at, _)| near(*at)) else {
                draw(part.take());
                continue;
            };
            let share = if self.is_seen(at, distance) { SEEN } else { HIDDEN };
            part = Some(match part {
                None => (at, at, None),
                Some((from, _, before)) if before.is_none_or(|before| before == share) => {
                    (from, at, Some(share))
                }
                Some(whole @ (_, last, _)) => {
                    draw(Some(whole));
                    (last, at, Some(share))
                }
            });
        }
        draw(part);
    }
}

/// Opacity of the lines at each pixel. Lines that cross do not add up.
struct Cover {
    width: usize,
    height: usize,
    /// Thickness of a line, in pixels.
    thickness: f64,
    shares: Vec<u8>,
}

impl Cover {
    fn new(canvas: &Canvas) -> Self {
        let (width, height) = (canvas.width, canvas.height);
        let thickness = WIDTH * canvas.scale;
        Self { width, height, thickness, shares: vec![0; width * height] }
    }

    /// Draws a straight line with smooth edges.
    fn line(&mut self, from: DVec2, to: DVec2, share: u32) {
        let reach = self.thickness / 2.0 + 0.5;
        let range = |a: f64, b: f64, size: usize| {
            let low = (a.min(b) - reach).floor().clamp(0.0, size as f64);
            let high = (a.max(b) + reach).ceil().clamp(0.0, size as f64);
            low as usize..high as usize
        };
        let (way, rows) = (to - from, range(from.y, to.y, self.height));
        // Horizontal distance from the line's center within which pixels of a row are covered.
        let beside = reach * way.length() / way.y.abs();
        for y in rows {
            let columns = if beside.is_finite() {
                let crossed = |y: f64| (y - from.y) / way.y;
                let [first, last] = [y as f64, y as f64 + 1.0].map(crossed);
                let ends = [first, last].map(|share| from.x + share.clamp(0.0, 1.0) * way.x);
                let (low, high) = (ends[0].min(ends[1]) - beside, ends[0].max(ends[1]) + beside);
                let whole = range(from.x, to.x, self.width);
                let part = range(low + reach, high - reach, self.width);
                whole.start.max(part.start)..whole.end.min(part.end)
            } else {
                range(from.x, to.x, self.width)
            };
            for x in columns {
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - from;
                let along = (at.dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
                let covered = (reach - (at - along * way).length()).clamp(0.0, 1.0);
                let place = &mut self.shares[y * self.width + x];
                *place = (*place).max((covered * f64::from(share)) as u8);
            }
        }
    }

    fn blend(&self, canvas: &mut Canvas, ink: Rgb) {
        // Skip pixels without lines, which are most of them.
        for (part, shares) in self.shares.chunks(64).enumerate() {
            if shares.iter().fold(0, |any, share| any | share) == 0 {
                continue;
            }
            for (n, share) in (64 * part..).zip(shares).filter(|(_, share)| **share > 0) {
                let (x, y) = (n % self.width, n / self.width);
                canvas.blend(x as i64, y as i64, ink, u32::from(*share));
            }
        }
    }
}

/// A label beside the box: its text, and its upper left corner and size in pixels.
#[derive(Clone, Debug)]
pub struct Label {
    pub text: String,
    pub place: DVec2,
    pub size: DVec2,
}

impl Label {
    /// Returns whether labels overlap or are closer than `space` horizontally.
    fn touches(&self, other: &Self, space: f64) -> bool {
        let space = DVec2::new(space, 0.0);
        self.place.cmplt(other.place + other.size + space).all()
            && other.place.cmplt(self.place + self.size + space).all()
    }
}

/// Draws the box, with ticks on one edge per axis, over a picture in the upper `height` rows.
/// Returns the labels.
pub fn draw_box(canvas: &mut Canvas, shown: PictureView<'_>, height: usize) -> Vec<Label> {
    let mut labels = Vec::new();
    let projector = Projector::new(shown, canvas.width, height);
    let (region, mut cover) = (shown.region, Cover::new(canvas));
    let corners = corners(region);
    let centre = projector.project(region.centre()).map(|(at, _)| at);
    let upward = shown.camera.displayed().up().abs();
    let upright = upward.max_position();
    for axis in 0..3 {
        let edges: Vec<(DVec3, DVec3)> = (0..8)
            .filter(|n| n >> axis & 1 == 0)
            .map(|n| (corners[n], corners[n | 1 << axis]))
            .collect();
        for (from, to) in &edges {
            projector.line(&mut cover, *from, *to);
        }
        // Ticks of the upright axis are on the leftmost edge in the picture, others on the lowest.
        let rank = |(from, to): &&(DVec3, DVec3)| {
            let at = projector.project(from.midpoint(*to)).map(|(at, _)| at)?;
            let rank = if axis == upright { -at.x } else { at.y };
            rank.is_finite().then_some((rank * 16.0) as i64)
        };
        let edge = edges.iter().filter(|edge| rank(edge).is_some()).max_by_key(rank);
        if let (Some(edge), Some(centre)) = (edge, centre) {
            label(canvas, &mut cover, &projector, axis, *edge, centre, &mut labels);
        }
    }
    cover.blend(canvas, shown.ink());
    labels
}

/// Writes tick values and the axis name along an edge.
fn label(
    canvas: &mut Canvas,
    cover: &mut Cover,
    projector: &Projector<'_>,
    axis: usize,
    (from, to): (DVec3, DVec3),
    centre: DVec2,
    labels: &mut Vec<Label>,
) {
    let (low, end) = (from[axis], to[axis]);
    let (ticks, step) = ticks(low, end);
    let middle = projector.project(from.midpoint(to)).map_or(centre, |(at, _)| at);
    // Labels are moved away from the edge at a right angle, so that labels of adjacent edges
    // separate. An edge viewed end-on has no such direction.
    let away = (middle - centre).normalize_or(DVec2::Y);
    let ends = projector.project(from).zip(projector.project(to));
    let across = ends.map_or(DVec2::ZERO, |((a, _), (b, _))| (b - a).perp());
    // With parallel rays, an axis that is seen from its end has the length 0.
    if across.length() < LEAST * canvas.scale {
        return;
    }
    let outward = match across.try_normalize() {
        Some(across) if across.dot(away) < 0.0 => -across,
        Some(across) => across,
        None => away,
    };
    let scale = canvas.scale;
    // Returns the position of a value on the edge, and its label. A label outside the picture is
    // moved into it.
    let size = DVec2::new(canvas.width as f64, projector.rays.height() as f64);
    let high = canvas.letter_height() as f64;
    let label = |value: f64, text: String, reach: f64| {
        let text = with_minus(&text);
        let mut point = from;
        point[axis] = value;
        let (at, _) = projector.project(point)?;
        let half = DVec2::new(width(&text, scale), high) / 2.0;
        let place = at + outward * (reach * scale + half.dot(outward.abs())) - half;
        let place = place.clamp(DVec2::ZERO, (size - 2.0 * half).max(DVec2::ZERO));
        Some((at, Label { text, place, size: 2.0 * half }))
    };
    // A label needs free space around it, or else is left out.
    let free = |label: &Label, labels: &[Label]| {
        !labels.iter().any(|other| label.touches(other, SPACE * scale))
    };
    let colors = projector.shown.letter_colors();
    let mut write = |label: Label, labels: &mut Vec<Label>| {
        let (x, y) = (label.place.x.round() as i64, label.place.y.round() as i64);
        canvas.write_with_halo(&label.text, x, y, colors);
        labels.push(label);
    };
    let mut marks = Vec::new();
    for (value, text) in ticks {
        let Some((at, label)) = label(value, text, 7.0) else { continue };
        marks.push(at);
        if free(&label, labels) {
            write(label, labels);
        }
    }
    // The axis name goes to the middle of the edge, or to the nearest free place.
    let name = ["x", "y", "z"][axis].to_owned();
    let places = [0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75].into_iter().filter_map(|steps| {
        let (_, label) = label(low.midpoint(end) + steps * step, name.clone(), 40.0)?;
        Some(label)
    });
    if let Some(label) = { places }.find(|label| free(label, labels)) {
        write(label, labels);
    }
    for at in marks {
        if at.abs().max_element() < 1e5 {
            cover.line(at, at + outward * (5.0 * scale), SEEN);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::framing;
    use crate::model::Model;
    use crate::picture::Settings;
    use zeroset_scene::camera::CameraChoice;
    use zeroset_scene::curves::TracedCurves;
    use zeroset_scene::view::{self, DomainChoice};

    /// Returns the labels of a picture of this size, for the region from -2 to 2 on each axis.
    fn labels(width: usize, height: usize, scale: f64, fitted: bool) -> Vec<Label> {
        labels_of("domain 2\nx^2+y^2+z^2 = 1", [width, height], scale, fitted)
    }

    fn labels_of(text: &str, size: [usize; 2], scale: f64, fitted: bool) -> Vec<Label> {
        let [width, height] = size;
        let settings = Settings { width, height, ..Settings::default() };
        let document = zeroset_syntax::read(text, &zeroset_syntax::Options::default());
        let (document, choice) = (document.expect("reads"), CameraChoice::default());
        let region = view::region(&document, DomainChoice::Document, None).expect("a cube").0;
        let model = Model::new(&document, &region, &settings).expect("a model");
        let whole = framing::camera(&model, &choice, &settings, true);
        let near = framing::camera(&model, &choice, &settings, false);
        let camera = if fitted { whole } else { near }.expect("a camera");
        let picture = model.picture(&camera, &settings).expect("a picture");
        let curves = TracedCurves::default();
        let shown =
            PictureView { camera: &camera, region: &region, picture: &picture, curves: &curves };
        let pixels = vec![0x00ff_ffff; width * height];
        draw_box(&mut Canvas::new(width, height, pixels, scale), shown, height)
    }

    #[test]
    fn labels_are_apart_and_within_the_picture() {
        for (width, height) in [(800, 600), (640, 460), (300, 200), (1600, 1180)] {
            for (scale, fitted) in [(1.0, false), (1.0, true), (1.5, true), (2.0, true)] {
                let labels = labels(width, height, scale, fitted);
                let space = SPACE * scale;
                for (index, one) in labels.iter().enumerate() {
                    let end = one.place + one.size;
                    assert!(one.place.min_element() >= 0.0, "{one:?}");
                    assert!(end.x <= width as f64 && end.y <= height as f64, "{one:?}");
                    for other in &labels[..index] {
                        assert!(!one.touches(other, space), "{one:?} and {other:?}");
                    }
                }
                assert!(labels.len() > 5, "{width}x{height}: {labels:?}");
            }
        }
    }

    #[test]
    fn every_axis_has_its_name_and_its_numbers_where_there_is_room() {
        let labels = labels(800, 600, 1.0, true);
        let mut texts: Vec<&str> = labels.iter().map(|label| label.text.as_str()).collect();
        texts.sort_unstable();
        // At the corner where x and z are both -2, two labels would overlap: one is left out.
        let mut expected = vec!["0", "0", "0", "1", "1", "1", "2", "2", "2", "x", "y", "z"];
        expected.extend(["−1", "−1", "−1", "−2", "−2"]);
        assert_eq!(texts, expected);
    }

    #[test]
    fn the_upright_axis_is_at_the_left_and_an_axis_seen_from_its_end_has_no_labels() {
        for (text, upright, hidden) in [
            ("domain 2\nx^2+y^2+z^2 = 1", "z", None),
            ("domain 2\nfloat map(vec3 p) { return length(p) - 1.0; }", "y", None),
            ("domain 2\nview top\nx^2+y^2+z^2 = 1", "y", None),
            ("view top\ncurve y = x^2, z = 0", "y", Some("z")),
            ("view front\n(s, 0, s^3) for s in [-2, 2]", "z", Some("y")),
            ("view right\npoint (0, 1, 2)\npoint (0, 2, 1)", "z", Some("x")),
        ] {
            let labels = labels_of(text, [800, 600], 1.0, true);
            let name = |name: &str| labels.iter().find(|label| label.text == name);
            let left = name(upright).expect(text).place.x;
            for other in ["x", "y", "z"].into_iter().filter(|other| *other != upright) {
                assert_eq!(name(other).is_none(), Some(other) == hidden, "{text}: {labels:?}");
                assert!(name(other).is_none_or(|label| left < label.place.x), "{text}: {labels:?}");
            }
        }
    }

    /// [`Cover::line`] visits only pixels near the line. The test checks that it misses no covered
    /// pixel.
    #[test]
    fn a_line_covers_what_is_near_it() {
        let (width, height) = (120, 90);
        let canvas = Canvas::new(width, height, Vec::new(), 1.0);
        let mut random = fastrand::Rng::with_seed(20_070_005);
        for case in 0..400 {
            let mut place = || DVec2::new(160.0 * random.f64() - 20.0, 120.0 * random.f64() - 15.0);
            let (from, mut to) = (place(), place());
            match case % 4 {
                0 => to.y = from.y,
                1 => to.x = from.x,
                2 => to = from.lerp(to, 0.02),
                _ => {}
            }
            let mut cover = Cover::new(&canvas);
            cover.line(from, to, SEEN);
            for (n, share) in cover.shares.iter().enumerate() {
                let at = DVec2::new((n % width) as f64 + 0.5, (n / width) as f64 + 0.5);
                let along = (at - from).dot(to - from) / (to - from).length_squared().max(1e-12);
                let off = (at - from.lerp(to, along.clamp(0.0, 1.0))).length();
                let covered = (WIDTH / 2.0 + 0.5 - off).clamp(0.0, 1.0) * f64::from(SEEN);
                assert!((covered - f64::from(*share)).abs() < 1.01, "{at} of {from} to {to}");
            }
        }
    }
}
