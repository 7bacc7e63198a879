//! Curves, points, axes, legends and a title over a picture.

mod axes;
mod canvas;
mod curves;
mod letters;
mod projector;
mod ticks;

pub use canvas::{Canvas, Rgb};
pub use letters::with_minus;
pub use projector::PictureView;
pub(crate) use projector::Projector;

use crate::legend::Legend;
use crate::picture::Picture;
use crate::pixels::Pixels;
use axes::draw_box;
use curves::draw_curves;
use std::ops::Range;
use ticks::ticks;
use zeroset_style::Choices;
use zeroset_syntax::Document;

/// Number of picture rows per unit of letter size. Smaller pictures have letters of that size, too.
const ROWS: f64 = 640.0;

/// Height of all legends together, as a share of the picture's height.
const TALL: f64 = 0.42;

/// Greatest width of a legend's title, in dots.
const LONGEST: usize = 190;

/// Smallest and largest size of a title's letters, in sizes of other letters.
const TITLE_SIZES: [f64; 2] = [0.75, 1.35];

/// Space around a legend, in dots.
const SPACE: usize = 10;

/// The part of a window's picture that its panels leave free.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeArea {
    /// The columns between the panels at the top.
    pub columns: Range<usize>,
    /// The row above which the panel at the bottom begins.
    pub bottom: usize,
}

/// The choice of axes, legends and title over a picture.
#[derive(Clone)]
pub struct Overlay {
    /// Set to draw the region's box with ticks.
    pub axes: bool,
    /// Set to draw the legends of color maps.
    legend: bool,
    /// A line of text at the top.
    title: Option<String>,
}

impl Overlay {
    /// Curves and points alone.
    pub const CURVES: Self = Self { axes: false, legend: false, title: None };

    /// An overlay with or without axes, and with the document's title. A legend comes with axes
    /// unless the document chooses otherwise.
    pub fn new(axes: bool, document: &Document) -> Self {
        Self::asked(Choices { axes: Some(axes), ..Choices::default() }, document)
    }

    /// An overlay without a title. A legend comes with axes unless these choices say otherwise.
    pub fn of(Choices { axes, legend, .. }: Choices) -> Self {
        let axes = axes == Some(true);
        Self { axes, legend: legend.unwrap_or(axes), title: None }
    }

    /// An overlay with axes and legend as these choices have them, or else the document's.
    pub fn asked(choices: Choices, document: &Document) -> Self {
        let title = document.picture.title.clone();
        Self { title, ..Self::of(choices.or(document.picture.choices)) }
    }

    /// This overlay with another title, if there is one. An empty title removes the document's.
    #[must_use]
    pub fn titled(self, title: Option<&str>) -> Self {
        let title = title.map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "));
        Self { title: title.or(self.title).filter(|text| !text.is_empty()), ..self }
    }

    /// An overlay with axes and legend as the document chooses.
    pub fn said(document: &Document) -> Self {
        Self::asked(Choices::default(), document)
    }

    /// Draws curves and points, axes, legends and title over a picture in the upper `height` rows
    /// of the canvas. Legends begin below the title. With `free`, they end at its last row, and the
    /// title is between its columns.
    pub fn draw(
        &self,
        canvas: &mut Canvas,
        shown: PictureView<'_>,
        height: usize,
        free: Option<&FreeArea>,
    ) {
        draw_curves(canvas, shown, height);
        if self.axes {
            draw_box(canvas, shown, height);
        }
        let mut top = canvas.dots(SPACE);
        if let Some(title) = &self.title {
            let columns = free.map_or(0..canvas.width, |free| free.columns.clone());
            top += draw_title(canvas, title, (top, columns), shown.ink());
        }
        if self.legend {
            draw_legends(canvas, shown, height, (top, free.map(|free| free.bottom)));
        }
    }

    /// Height of this many legends in a picture of this height, with letters of this scale.
    pub fn legends_height(count: usize, height: usize, scale: f64) -> usize {
        count * legend_height(count, height, scale)
    }

    /// Records curves, axes, legends and title for a picture of this size, to be mixed into its
    /// rows. `shown` may be a smaller picture of the same view.
    pub fn marks(&self, shown: PictureView<'_>, [width, height]: [usize; 2]) -> Canvas {
        let scale = (height as f64 / ROWS).max(1.0);
        let mut canvas = Canvas::new(width, height, Vec::new(), scale);
        if !shown.picture.rgb.is_empty() {
            self.draw(&mut canvas, shown, height, None);
        }
        canvas
    }

    /// The picture's pixels with curves, axes, legends and title.
    pub fn over(&self, shown: PictureView<'_>) -> Pixels {
        let Picture { buffer, rgb, alpha, .. } = shown.picture;
        let mut pixels = Pixels { rgb: rgb.clone(), alpha: alpha.clone() };
        let marks = self.marks(shown, [buffer.width, buffer.height]);
        marks.mix_into(&mut pixels.rgb, &mut pixels.alpha, 0);
        pixels
    }
}

/// Height of each of `count` legends in a picture of this height, with its title and the space
/// around it.
fn legend_height(count: usize, height: usize, scale: f64) -> usize {
    let tall = (TALL * height as f64) as usize / count.max(1);
    tall + Canvas::line_height_at(scale) + Canvas::dots_at(SPACE, scale)
}

/// Writes a title in the middle of the row `top`, as far as these columns allow. Letters of a long
/// title are smaller, and its end may be missing. Returns the height of the line.
fn draw_title(
    canvas: &mut Canvas,
    title: &str,
    (top, columns): (usize, Range<usize>),
    ink: u32,
) -> usize {
    let (usual, space) = (canvas.scale, canvas.dots(SPACE));
    let room = columns.len().saturating_sub(2 * space);
    let wide = (canvas.text_width(title) as f64).max(1.0);
    let [smallest, largest] = TITLE_SIZES;
    canvas.scale *= (room as f64 / wide).clamp(smallest, largest);
    let title = canvas.fitting(title, room);
    let wide = canvas.text_width(&title);
    let middle = canvas.width.saturating_sub(wide) / 2;
    let last = columns.end.saturating_sub(space + wide);
    let left = middle.min(last).max(columns.start + space);
    canvas.write(&title, left as i64, top as i64, ink);
    let tall = canvas.line_height();
    canvas.scale = usual;
    tall
}

/// Draws legends one below another at the right edge of a picture in the upper `height` rows of the
/// canvas. They begin at the row `top`, or end at the row `bottom`.
fn draw_legends(
    canvas: &mut Canvas,
    shown: PictureView<'_>,
    height: usize,
    (top, bottom): (usize, Option<usize>),
) {
    let legends = &shown.picture.legends;
    let (ink, space) = (shown.ink(), canvas.dots(SPACE));
    let each = legend_height(legends.len(), height, canvas.scale);
    let tall = each - canvas.line_height() - space;
    let first = bottom.map_or(top, |bottom| bottom.saturating_sub(legends.len() * each));
    for (n, legend) in legends.iter().enumerate() {
        let top = first + n * each;
        draw_legend(canvas, legend, top, tall, ink);
    }
}

fn draw_legend(canvas: &mut Canvas, legend: &Legend, top: usize, tall: usize, ink: u32) {
    let [thin, mark, gap, space, broad] = [1, 4, 8, SPACE, 14].map(|dots| canvas.dots(dots));
    let extent = legend.high - legend.low;
    let marks = if extent > 0.0 {
        ticks(legend.low, legend.high).0
    } else {
        // A single value, rounded to four digits since further digits may be rounding errors.
        let value = format!("{:.3e}", legend.low).parse().unwrap_or(legend.low);
        vec![(legend.low, f64::to_string(&value))]
    };
    let marks: Vec<(f64, String)> =
        marks.into_iter().map(|(value, text)| (value, with_minus(&text))).collect();
    let longest = marks.iter().map(|(_, text)| canvas.text_width(text)).max().unwrap_or(0);
    let title = canvas.fitting(&with_minus(&legend.value), canvas.dots(LONGEST));
    let right = canvas.width.saturating_sub(space);
    let left = right.saturating_sub(longest + gap + broad);
    let begin = right.saturating_sub(canvas.text_width(&title)).min(left);
    canvas.write(&title, begin as i64, top as i64, ink);
    let bar = top + canvas.line_height();
    for row in 0..tall {
        let share = 1.0 - (row as f64 + 0.5) / tall as f64;
        let [red, green, blue] = legend.map.bytes(share);
        let color = u32::from_be_bytes([0, red, green, blue]);
        canvas.fill(left as i64, (bar + row) as i64, broad, 1, color, 255);
    }
    let place = |value: f64| {
        let share = if extent > 0.0 { (legend.high - value) / extent } else { 0.5 };
        bar as f64 + share * tall as f64
    };
    if let Some(step) = legend.step.filter(|step| extent / step < tall as f64 / 4.0) {
        let first = (legend.low / step).ceil() as i64;
        for line in (first..).map(|line| line as f64 * step).take_while(|v| *v <= legend.high) {
            canvas.fill(left as i64, place(line) as i64, broad, thin, 0, 200);
        }
    }
    for (value, text) in marks {
        let row = place(value);
        canvas.fill((left + broad) as i64, row as i64, mark, thin, ink, 200);
        let y = row.round() as i64 - canvas.letter_height() as i64 / 2;
        canvas.write(&text, (left + broad + gap) as i64, y, ink);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::picture::Settings;
    use glam::DVec3;
    use zeroset_scene::curves::TracedCurves;
    use zeroset_space::{Camera, Projection, Region};

    fn picture(text: &str) -> (Picture, Camera, Region) {
        let document = zeroset_syntax::read(text, &zeroset_syntax::Options::default());
        let document = document.expect("reads");
        let region = Region::new(-2.0 * DVec3::ONE, 2.0 * DVec3::ONE).expect("a cube");
        let settings = Settings { width: 400, height: 300, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("a model");
        let projection = Projection::Perspective { fov: 40.0 };
        let eye = DVec3::new(5.0, -7.0, 4.0);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
        let picture = model.picture(&camera, &settings).expect("a picture");
        (picture, camera, region)
    }

    fn changed(picture: &Picture, after: &[u8]) -> Vec<usize> {
        let both = picture.rgb.as_chunks::<3>().0.iter().zip(after.as_chunks::<3>().0);
        both.enumerate().filter(|(_, (a, b))| a != b).map(|(n, _)| n).collect()
    }

    #[test]
    fn axes_are_drawn_over_the_picture_and_faint_behind_it() {
        let (picture, camera, region) = picture("x^2+y^2+z^2 = 1");
        let curves = TracedCurves::default();
        let shown =
            PictureView { camera: &camera, region: &region, picture: &picture, curves: &curves };
        assert_eq!(
            Overlay { axes: false, legend: true, title: None }.over(shown).rgb,
            picture.rgb,
            "there is nothing to tell"
        );
        let after = Overlay { axes: true, legend: false, title: None }.over(shown).rgb;
        let lines = changed(&picture, &after);
        let on_surface = lines.iter().filter(|&&n| picture.buffer.is_drawn(n)).count();
        assert!(lines.len() > 1500 && on_surface > 20, "{} {on_surface}", lines.len());
        // The same lines, without a surface in front of them.
        let mut clear = picture.clone();
        clear.buffer.drawn.fill(f64::INFINITY);
        let seen = Overlay { axes: true, legend: false, title: None }
            .over(PictureView { picture: &clear, ..shown })
            .rgb;
        let change = |rgb: &[u8], on_surface: bool| -> u64 {
            let lines = lines.iter().filter(|&&n| picture.buffer.is_drawn(n) == on_surface);
            lines.map(|&n| u64::from(picture.rgb[3 * n].abs_diff(rgb[3 * n]))).sum()
        };
        assert!(4 * change(&after, true) < 3 * change(&seen, true));
        let beside = [&after, &seen].map(|rgb| change(rgb, false));
        assert!(beside[0] <= beside[1] && 10 * beside[0] > 9 * beside[1], "{beside:?}");
    }

    #[test]
    fn a_legend_tells_values_by_their_colors() {
        let (picture, camera, region) = picture("color viridis(z)\nx^2+y^2+z^2 = 1");
        let [legend] = &picture.legends[..] else { panic!("{:?}", picture.legends) };
        assert!(legend.value == "z" && legend.low > -1.01 && legend.low < -0.8, "{legend:?}");
        assert!((0.95..1.01).contains(&legend.high), "{legend:?}");
        let curves = TracedCurves::default();
        let shown =
            PictureView { camera: &camera, region: &region, picture: &picture, curves: &curves };
        let after = Overlay { axes: false, legend: true, title: None }.over(shown).rgb;
        let pixels = after.as_chunks::<3>().0;
        for end in [0.0, 1.0] {
            let color = legend.map.bytes(end);
            let near = |pixel: &&[u8; 3]| (0..3).all(|part| pixel[part].abs_diff(color[part]) < 4);
            assert!(pixels.iter().filter(near).count() > 10, "{color:?}");
        }
    }

    #[test]
    fn a_title_is_in_the_middle_above_and_shrinks_before_it_is_cut() {
        let (picture, camera, region) = picture("x^2+y^2+z^2 = 1");
        let curves = TracedCurves::default();
        let shown =
            PictureView { camera: &camera, region: &region, picture: &picture, curves: &curves };
        let drawn = |title: &str, [width, height]: [usize; 2]| {
            let overlay = Overlay::CURVES.titled(Some(title));
            let canvas = overlay.marks(shown, [width, height]);
            let mut rgb = vec![255; 3 * width * height];
            canvas.mix_into(&mut rgb, &mut [], 0);
            let dark = rgb.as_chunks::<3>().0.iter().enumerate().filter(|(_, c)| c[0] < 128);
            let places: Vec<[usize; 2]> = dark.map(|(n, _)| [n % width, n / width]).collect();
            let ends = [0, 1].map(|axis| {
                let along = || places.iter().map(|place| place[axis]);
                [along().min().expect("letters"), along().max().expect("letters")]
            });
            (places.len(), ends)
        };
        for [width, height] in [[64, 64], [400, 300], [1600, 1600]] {
            let size = [width, height];
            let (_, [[left, right], [top, bottom]]) = drawn("Torus", size);
            assert!((left + right).abs_diff(width) <= 4 + width / 50, "{size:?} {left} {right}");
            assert!(top > 4 && bottom < height / 2 && bottom - top < 13.max(height / 20));
            // A long title stays in the picture, on one line, in smaller letters.
            let (ink, [[left, right], rows]) = drawn(&"Barth's sextic ".repeat(20), size);
            assert!(left >= 8 && right + 8 <= width && ink > 20, "{size:?} {left} {right}");
            assert!(rows[1] - rows[0] <= bottom - top + 4, "{size:?}");
        }
        // In a window a title is between the panels, in the middle if it fits there.
        for (columns, is_centred) in [(300..800, true), (0..800, true), (500..800, false)] {
            let mut canvas = Canvas::new(800, 300, vec![0x00ff_ffff; 800 * 300], 1.0);
            let free = FreeArea { columns: columns.clone(), bottom: 280 };
            Overlay::CURVES.titled(Some("Torus")).draw(&mut canvas, shown, 300, Some(&free));
            let row = canvas.pixels.iter().enumerate().filter(|(_, ink)| **ink != 0x00ff_ffff);
            let across: Vec<usize> = row.map(|(at, _)| at % 800).collect();
            let [left, right] =
                [across.iter().min(), across.iter().max()].map(|end| *end.expect("ink"));
            assert!(columns.contains(&left) && columns.contains(&right), "{columns:?}");
            assert_eq!(
                (left + right).abs_diff(800) < 40,
                is_centred,
                "{columns:?}: {left} {right}"
            );
        }
        // The font lacks these letters; something is written in their place.
        assert!(drawn("曲面", [400, 300]).0 > 10);
    }
}
