//! Curves and points over a picture: tubes and balls of a constant width in pixels. Surfaces hide
//! what is behind them. Nothing here traces a curve.

use super::canvas::{Canvas, Rgb};
use super::projector::{PictureView, Projector};
use glam::{DVec2, DVec3};
use zeroset_scene::curves::{TracedLine, TracedPoint};

/// Width of a curve in pixels, unless the document sets it. Large pictures scale it like letters.
const WIDTH: f64 = 2.5;

/// Width of a point, in widths of a curve.
const BALL: f64 = 3.2;

/// Colors of curves, in turn, for those without a color of their own.
const COLORS: [[u8; 3]; 6] =
    [[205, 38, 44], [28, 104, 205], [22, 138, 66], [214, 120, 0], [134, 60, 176], [0, 140, 150]];

/// Direction to the light, in the picture: to the right, down, and toward the viewer.
const LIGHT: [f64; 3] = [-0.45, -0.6, 0.66];

/// Positions farther than this from the picture are not drawn, in pixels.
const FAR: f64 = 1e5;

/// Nearest depth of a point that is drawn, as a share of the region's size.
const NEAREST: f64 = 1e-4;

/// Width of the gap that a tube leaves in a tube behind it, in pixels on each side.
const GAP: f64 = 1.3;

/// A tube leaves a gap in tubes that are farther away by at least this many of its widths.
const CUT: f64 = 4.0;

/// Parts of a curve that are nearer than this along it leave no gap in each other, in pixels.
const NEIGHBORS: i32 = 24;

/// Longest segment whose ends decide whether it is seen, in pixels.
const SHORT: f64 = 6.0;

/// Room between the positions of two curves, in pixels.
const ROOM: f64 = 4096.0;

/// Two tubes cross if their depths differ by more than this many of their widths.
const APART: f64 = 1.5;

/// A vertex in the picture.
#[derive(Clone, Copy)]
struct Vertex {
    at: DVec2,
    /// Distance along the ray, and along the view.
    distance: f64,
    depth: f64,
    color: [u8; 3],
}

/// A tube or a ball over a pixel: the share of the pixel that it covers, and its color.
#[derive(Clone, Copy, Default)]
struct Cover {
    share: u8,
    color: [u8; 3],
    distance: f32,
    /// Position along the curve, in pixels of the picture. All curves share one scale: each starts
    /// [`ROOM`] behind the end of the one before.
    along: i32,
    /// Distance of the pixel from the middle of the tube or ball, in pixels.
    off: f32,
}

/// Tubes and balls over one pixel.
struct PixelCover {
    x: u32,
    y: u32,
    /// The tube or ball that is nearest to the eye.
    front: Cover,
    /// The nearest of the tubes and balls behind `front`.
    back: Cover,
    /// A nearer tube has a gap beside it, in which tubes beyond this distance are left out. The
    /// second number is the nearer tube's position along the curves.
    cut: (f32, i32),
}

impl PixelCover {
    /// Adds a part of a tube of this width in world units.
    fn add(&mut self, new: Cover, width: f64) {
        let Self { front, back, .. } = self;
        let apart = (front.distance - new.distance).abs() > (APART * width) as f32;
        if front.share == 0 || !apart {
            // Neighboring segments of a curve cover a pixel once. The nearer middle gives the
            // shade.
            let is_nearer = new.share == front.share && new.off < front.off;
            if new.share > front.share || is_nearer {
                *front = new;
            }
        } else if new.distance < front.distance {
            (*back, *front) = (*front, new);
        } else if new.share > back.share {
            *back = new;
        }
    }

    /// Leaves out tubes that are farther than a tube of this width beside the pixel.
    fn cut(&mut self, distance: f64, width: f64, along: i32) {
        let limit = (distance + CUT * width) as f32;
        if limit < self.cut.0 {
            self.cut = (limit, along);
        }
    }

    /// Returns whether a tube is behind the gap of another one, or of another part of its curve.
    /// `loops` are the first and the last position of each closed curve.
    fn is_cut(&self, cover: Cover, loops: &[[i32; 2]]) -> bool {
        let (limit, along) = self.cut;
        if cover.distance <= limit {
            return false;
        }
        let apart = cover.along.saturating_sub(along).saturating_abs();
        let number = loops.partition_point(|[_, last]| *last < cover.along.max(along));
        let around = loops.get(number).filter(|[first, _]| *first <= cover.along.min(along));
        around.map_or(apart, |[first, last]| apart.min(last - first - apart)) > NEIGHBORS
    }
}

/// The pixels over which there are tubes or balls.
struct PixelCovers {
    width: usize,
    /// For each pixel, the number of its cover, counted from 1; 0 without one.
    numbers: Vec<u32>,
    all: Vec<PixelCover>,
    /// First and last position of each closed curve, in order.
    loops: Vec<[i32; 2]>,
}

impl PixelCovers {
    fn new(width: usize, height: usize) -> Self {
        Self { width, numbers: vec![0; width * height], all: Vec::new(), loops: Vec::new() }
    }

    /// The tubes and balls over a pixel, which is added unless it is known.
    fn at(&mut self, x: usize, y: usize) -> &mut PixelCover {
        let number = &mut self.numbers[y * self.width + x];
        if *number == 0 {
            let none = Cover::default();
            let cut = (f32::INFINITY, 0);
            self.all.push(PixelCover { x: x as u32, y: y as u32, front: none, back: none, cut });
            *number = self.all.len() as u32;
        }
        &mut self.all[*number as usize - 1]
    }

    /// Draws all pixels on the canvas, the farther tube or ball first.
    fn blend(&self, canvas: &mut Canvas) {
        for pixel in &self.all {
            for cover in [pixel.back, pixel.front] {
                if cover.share > 0 && !pixel.is_cut(cover, &self.loops) {
                    let (x, y) = (i64::from(pixel.x), i64::from(pixel.y));
                    canvas.blend(x, y, rgb(cover.color), u32::from(cover.share));
                }
            }
        }
    }
}

fn rgb([red, green, blue]: [u8; 3]) -> Rgb {
    u32::from_be_bytes([0, red, green, blue])
}

/// Draws curves and points over a picture in the upper `height` rows of the canvas.
pub fn draw_curves(canvas: &mut Canvas, shown: PictureView<'_>, height: usize) {
    if shown.curves.is_empty() || canvas.width == 0 || height == 0 {
        return;
    }
    let projector = Projector::new(shown, canvas.width, height);
    let mut covers = PixelCovers::new(canvas.width, height);
    let scale = canvas.scale;
    let mut along = 0.0;
    for line in &shown.curves.lines {
        draw_line(&mut covers, &projector, line, scale, &mut along);
        along += ROOM;
    }
    let mut labels = Vec::new();
    for point in &shown.curves.points {
        if let Some(at) = draw_point(&mut covers, &projector, point, scale) {
            labels.push((at, point));
        }
    }
    covers.blend(canvas);
    // If two labels overlap, the label of the nearer point is written.
    let depth = |point: &TracedPoint| projector.depth(point.at);
    labels.sort_by(|(_, one), (_, other)| depth(one).total_cmp(&depth(other)));
    write_labels(canvas, &labels, shown.letter_colors(), height);
}

/// Draws a polyline. `along` is its position along all curves, which it moves.
fn draw_line(
    covers: &mut PixelCovers,
    projector: &Projector<'_>,
    line: &TracedLine,
    scale: f64,
    along: &mut f64,
) {
    let start = *along;
    let radius = line.width.unwrap_or(WIDTH) * scale / 2.0;
    let nearest = NEAREST * projector.shown.region.half_extent();
    let color = |n: usize| match line.colors.as_slice() {
        [] => COLORS[line.order % COLORS.len()],
        [one] => *one,
        all => all[n.min(all.len() - 1)],
    };
    for (n, pair) in line.at.windows(2).enumerate() {
        let depths = [pair[0], pair[1]].map(|at| projector.depth(at));
        if depths[0].max(depths[1]) <= nearest {
            continue;
        }
        // A segment that goes behind the eye is cut.
        let mut ends = [pair[0], pair[1]];
        for k in 0..2 {
            if depths[k] < nearest {
                let share = (nearest - depths[k]) / (depths[1 - k] - depths[k]);
                ends[k] = pair[k].lerp(pair[1 - k], share);
            }
        }
        let vertex = |at: DVec3, color: [u8; 3]| {
            let (place, distance) = projector.project(at)?;
            Some(Vertex { at: place, distance, depth: projector.depth(at), color })
        };
        if let (Some(from), Some(to)) = (vertex(ends[0], color(n)), vertex(ends[1], color(n + 1))) {
            draw_segment(covers, projector, [from, to], [radius, scale], *along);
            *along += from.at.distance(to.at).min(FAR);
        }
    }
    if line.at.first() == line.at.last() {
        covers.loops.push([start as i32, *along as i32]);
    }
}

fn draw_segment(
    covers: &mut PixelCovers,
    projector: &Projector<'_>,
    [from, to]: [Vertex; 2],
    [radius, scale]: [f64; 2],
    start: f64,
) {
    let (width, height) = (projector.rays.width(), projector.rays.height());
    if from.at.abs().max(to.at.abs()).max_element() > FAR {
        return;
    }
    let reach = radius + 0.5;
    let gap = reach + GAP * scale;
    let range = |a: f64, b: f64, size: usize| {
        let low = (a.min(b) - gap).floor().clamp(0.0, size as f64);
        let high = (a.max(b) + gap).ceil().clamp(0.0, size as f64);
        low as usize..high as usize
    };
    let way = to.at - from.at;
    let square = way.length_squared().max(1e-12);
    // On a short segment, the ends decide whether all of it is seen.
    let ends = [from, to].map(|end| seen(projector, end.at, end.distance));
    let whole = (ends[0] == ends[1] && square < SHORT * SHORT).then_some(ends[0]);
    if whole == Some(0.0) {
        return;
    }
    for y in range(from.at.y, to.at.y, height) {
        let columns = columns(from.at, way, y, gap, range(from.at.x, to.at.x, width));
        for x in columns {
            let pixel = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let share = ((pixel - from.at).dot(way) / square).clamp(0.0, 1.0);
            let foot = from.at + way * share;
            let off = pixel - foot;
            let length = off.length();
            if length >= gap {
                continue;
            }
            // Along a segment in the picture, the reciprocal of the depth changes evenly.
            let weight = share * from.depth / (share * from.depth + (1.0 - share) * to.depth);
            let distance = from.distance + (to.distance - from.distance) * weight;
            let depth = from.depth + (to.depth - from.depth) * weight;
            let clear = whole.unwrap_or_else(|| seen(projector, foot, distance));
            let along = (start + share * square.sqrt()) as i32;
            let width = 2.0 * radius * projector.pixel_size(depth);
            let covered = (reach - length).clamp(0.0, 1.0);
            if covered <= 0.0 {
                if clear > 0.0 {
                    covers.at(x, y).cut(distance, width, along);
                }
                continue;
            }
            let share_of_pixel = (covered * clear * 255.0) as u8;
            if share_of_pixel == 0 {
                continue;
            }
            let color = [0, 1, 2].map(|k| {
                let (a, b) = (f64::from(from.color[k]), f64::from(to.color[k]));
                a + (b - a) * weight
            });
            let color = shaded(color, off / reach);
            let distance = distance as f32;
            let off = length as f32;
            let new = Cover { share: share_of_pixel, color, distance, along, off };
            covers.at(x, y).add(new, width);
        }
    }
}

/// The columns of row `y` that a segment may cover, within `all`.
fn columns(
    from: DVec2,
    way: DVec2,
    y: usize,
    reach: f64,
    all: std::ops::Range<usize>,
) -> std::ops::Range<usize> {
    let beside = reach * way.length() / way.y.abs();
    if !beside.is_finite() {
        return all;
    }
    let crossed = |y: f64| from.x + ((y - from.y) / way.y).clamp(0.0, 1.0) * way.x;
    let [first, last] = [crossed(y as f64), crossed(y as f64 + 1.0)];
    let low = (first.min(last) - beside).floor().max(all.start as f64) as usize;
    let high = (first.max(last) + beside).ceil().min(all.end as f64).max(0.0) as usize;
    low.min(all.end)..high.max(low.min(all.end))
}

/// Share of light that comes from a point of a curve past the surface in front of it, if any.
fn seen(projector: &Projector<'_>, at: DVec2, distance: f64) -> f64 {
    let (pixel, is_seen) = projector.is_seen_nearby(at, distance);
    if is_seen {
        return 1.0;
    }
    let surface = projector.shown.picture.buffer.surface[pixel];
    projector.shown.curves.clear.get(usize::from(surface)).copied().unwrap_or(0.0)
}

/// A color in the light at a place of a tube or a ball: `off` is the offset from its middle, in
/// units of its radius.
fn shaded(color: [f64; 3], off: DVec2) -> [u8; 3] {
    let toward = (1.0 - off.length_squared()).max(0.0).sqrt();
    let normal = DVec3::new(off.x, off.y, toward);
    let light = normal.dot(DVec3::from_array(LIGHT)).max(0.0);
    let (diffuse, highlight) = (0.5 + 0.62 * light, 70.0 * light.powi(12));
    color.map(|part| (part * diffuse + highlight).clamp(0.0, 255.0) as u8)
}

/// Draws a ball. Returns its place in the picture, if it is seen.
fn draw_point(
    covers: &mut PixelCovers,
    projector: &Projector<'_>,
    point: &TracedPoint,
    scale: f64,
) -> Option<DVec2> {
    let (width, height) = (projector.rays.width(), projector.rays.height());
    let (at, distance) = projector.project(point.at)?;
    let size = DVec2::new(width as f64, height as f64);
    let is_inside = at.cmpge(DVec2::ZERO).all() && at.cmple(size).all();
    let clear = if is_inside { seen(projector, at, distance) } else { 0.0 };
    if clear <= 0.0 {
        return None;
    }
    let radius = ball_radius(point, scale);
    let reach = radius + 0.5;
    let range = |at: f64, size: usize| {
        (at - reach).max(0.0) as usize..((at + reach).ceil().max(0.0) as usize).min(size)
    };
    let [_, ink @ ..] = projector.shown.ink().to_be_bytes();
    let color = point.color.unwrap_or(ink).map(f64::from);
    let world = 2.0 * radius * projector.pixel_size(projector.depth(point.at));
    for y in range(at.y, height) {
        for x in range(at.x, width) {
            let off = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - at;
            let share = ((reach - off.length()).clamp(0.0, 1.0) * clear * 255.0) as u8;
            if share > 0 {
                // A ball is in front of the curve on which it lies.
                let distance = (distance - world) as f32;
                let color = shaded(color, off / reach);
                let off = off.length() as f32;
                let new = Cover { share, color, distance, along: i32::MIN / 2, off };
                covers.at(x, y).add(new, 0.0);
            }
        }
    }
    Some(at)
}

fn ball_radius(point: &TracedPoint, scale: f64) -> f64 {
    point.width.unwrap_or(WIDTH) * BALL / 2.0 * scale
}

/// Writes the labels of points that are seen, beside them. A label that would cover another one is
/// left out.
fn write_labels(
    canvas: &mut Canvas,
    labels: &[(DVec2, &TracedPoint)],
    colors: [Rgb; 2],
    height: usize,
) {
    let high = canvas.letter_height() as f64;
    let bounds = DVec2::new(canvas.width as f64, height as f64);
    let mut taken: Vec<[DVec2; 2]> = Vec::new();
    for (at, point) in labels.iter().filter(|(_, point)| !point.label.is_empty()) {
        let text = canvas.fitting(&point.label, canvas.width / 2);
        let size = DVec2::new(canvas.text_width(&text) as f64, high);
        let away = ball_radius(point, canvas.scale) + BESIDE * canvas.scale;
        let right = DVec2::new(at.x + away, at.y - high / 2.0);
        let left = DVec2::new(at.x - away - size.x, right.y);
        let place = if right.x + size.x <= bounds.x { right } else { left };
        let place = place.clamp(DVec2::ZERO, (bounds - size).max(DVec2::ZERO));
        let end = place + size;
        let covers = |other: &[DVec2; 2]| place.cmplt(other[1]).all() && other[0].cmplt(end).all();
        if taken.len() < MOST_LABELS && !taken.iter().any(covers) {
            let (x, y) = (place.x.round() as i64, place.y.round() as i64);
            canvas.write_with_halo(&text, x, y, colors);
            taken.push([place, end]);
        }
    }
}

/// Space between a point and its label, in dots.
const BESIDE: f64 = 4.0;

/// Largest number of labels. Each one is compared with all others.
const MOST_LABELS: usize = 1000;

#[cfg(test)]
mod tests;
