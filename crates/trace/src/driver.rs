//! What all methods share: which rays go together, threads, cancelling, progress, and where findings go.
//!
//! How a ray is followed is not known here.

use crate::camera::Ray;
use crate::found::Found;
use crate::gbuffer::{GBuffer, Kept};
use crate::grid::{RayGrid, SIDE};
use crate::light::Light;
use crate::method::{Segment, Start, Tracer};
use crate::near::{TURNS, turn};
use crate::rows::{Rows, work_on};
use crate::work::Work;
use glam::DVec3;
use rayon::prelude::*;
use zeroset_eval::LANES;

/// Rows of a band, the unit of work that threads share and that may be cancelled; and pixels on the side of its squares.
pub const BAND_ROWS: usize = 16;
/// Rays handed to a method at once: 8×8 pixels, whose data stay in the nearest cache.
pub(crate) const RAYS: usize = 64;
/// Pixels of a list that go together.
const LIST: usize = 1024;

/// A method at work on one surface, as seen from one place.
#[derive(Clone, Copy)]
pub struct Driver<'a> {
    /// Where rays start and go.
    pub rays: &'a RayGrid,
    /// What follows them.
    pub tracer: &'a dyn Tracer,
    /// Told how many pixels were finished since it was last called; ends the work early by returning `false`. Pixels of a
    /// new picture that were not reached then are undecided and not painted, and those followed on are as they were.
    pub advance: &'a (dyn Fn(usize) -> bool + Sync),
}

/// A pixel's column and row: an index would have to be divided again for each ray.
type Pixel = [u32; 2];

/// What became of a tile's rays, but for misses.
type Findings = Vec<(Pixel, Found)>;

impl Driver<'_> {
    /// Traces all pixels into a buffer of misses.
    ///
    /// # Panics
    /// If the buffer has another size than the picture.
    pub fn picture(&self, buffer: &mut GBuffer) -> Work {
        self.picture_where(&[], buffer)
    }

    /// Traces the pixels for which `only` says so, row by row, all if it is empty. Of others it may write what it finds by
    /// the way: a proof or nothing.
    ///
    /// # Panics
    /// If the buffer has another size than the picture, or `only` another number of pixels.
    pub fn picture_where(&self, only: &[bool], buffer: &mut GBuffer) -> Work {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        work_on(buffer.rows(BAND_ROWS), |mut rows| self.rows(&mut rows, only))
    }

    /// A new picture of the surface with this number, otherwise as [`Driver::picture_where`] makes it, with what is to be
    /// `kept`. Each [`BAND_ROWS`] rows are handed to `finish` while they are in the nearer caches, together with what
    /// of `parts` is theirs.
    ///
    /// # Panics
    /// If there are fewer parts than bands of rows, or `only` has another number of pixels.
    pub fn new_picture<E: Send>(
        &self,
        surface: u16,
        kept: Kept,
        only: &[bool],
        parts: Vec<E>,
        finish: impl Fn(&mut Rows<'_>, E) -> Work + Sync,
    ) -> (GBuffer, Work) {
        let (width, height) = (self.rays.width(), self.rays.height());
        let mut buffer = GBuffer::unset(width, height, surface, kept);
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        assert!(parts.len() >= height.div_ceil(BAND_ROWS), "a part for each band");
        let make = |(mut rows, part): (Rows<'_>, E)| {
            rows.clear();
            let mut work = self.rows(&mut rows, only);
            work += finish(&mut rows, part);
            work
        };
        let work = work_on(buffer.rows(BAND_ROWS).into_iter().zip(parts).collect(), make);
        (buffer, work)
    }

    fn rows(&self, rows: &mut Rows<'_>, only: &[bool]) -> Work {
        let (mut work, wanted) = (Work::default(), || (self.advance)(0));
        let mut band = rows.band(only, &wanted);
        if band.is_wanted() {
            self.tracer.band(self.rays, &mut band, &mut work);
            (self.advance)(band.width * band.height);
        } else {
            band.give_up(0);
        }
        work
    }

    /// Finds which painted points of `buffer` do not see the light: that of `lights` whose turn it is, in squares of as many
    /// pixels. A ray starts `offset` away from its point (in world
    /// units), and what it meets before it is clear of that surface does not count: otherwise a surface would shade
    /// itself wherever enclosures are wide.
    pub fn shadows(&self, buffer: &mut GBuffer, lights: &[Light; TURNS], offset: f64) -> Work {
        let painted: Vec<usize> =
            (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)).collect();
        let segment = |pixel: Pixel| {
            let [column, row] = pixel.map(|place| place as usize);
            let light = &lights[turn([column, row])];
            let (ray, pixel) = (self.rays.ray(column, row), self.index(pixel));
            let t = ray.parameter(buffer.drawn[pixel]);
            let (way, distance) = light.towards(ray.at(t));
            // Off the surface on the side of the eye, then along the light.
            let origin = ray.at(t - ray.parameter(offset)) + way * offset;
            // That something is in the way is enough.
            Segment {
                ray: Ray { origin, direction: way },
                to: distance,
                pixel: [f64::INFINITY, 0.0],
            }
        };
        let tiles = painted.par_chunks(LIST).map(|tile| self.places(tile));
        buffer.shadow.clear();
        buffer.shadow.resize(buffer.status.len(), 0);
        let mut work = Work::default();
        for (found, part) in self.follow(tiles, &segment, Start::OnSurface) {
            work += part;
            for (pixel, found) in found {
                let hidden = if found.drawn.is_finite() { u8::MAX } else { 0 };
                buffer.shadow[self.index(pixel)] = hidden;
            }
        }
        work
    }

    /// Follows the rays of pixels on from the given distances, in world units; where those are not finite, the pixel stays as
    /// it is. What is found is behind something else, and tells nothing of the whole ray.
    ///
    /// # Panics
    /// If there are not as many distances as pixels, or the buffer has another size than the picture.
    pub fn behind(&self, starts: &[f64], start: Start, buffer: &mut GBuffer) -> Work {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        assert_eq!(starts.len(), buffer.status.len());
        let wanted = |pixel: &usize| starts[*pixel].is_finite();
        let pixels: Vec<usize> = (0..starts.len()).filter(wanted).collect();
        let [width, growth] = self.rays.pixel();
        let segment = |pixel: Pixel| {
            let [column, row] = pixel.map(|place| place as usize);
            let ray = self.rays.ray(column, row);
            let t = ray.parameter(starts[self.index(pixel)]);
            Segment {
                ray: Ray { origin: ray.at(t), ..ray },
                to: f64::INFINITY,
                pixel: [width + growth * t, growth],
            }
        };
        let tiles = pixels.par_chunks(LIST).map(|tile| self.places(tile));
        let mut work = Work::default();
        for (found, part) in self.follow(tiles, &segment, start) {
            work += part;
            for (pixel, found) in found {
                let pixel = self.index(pixel);
                let from = starts[pixel];
                let found = Found {
                    distance: found.distance + from,
                    drawn: found.drawn + from,
                    bracket: found.bracket.map(|end| end + from),
                    ..found
                };
                buffer.set(pixel, &found);
            }
        }
        work
    }

    fn index(&self, [column, row]: Pixel) -> usize {
        row as usize * self.rays.width() + column as usize
    }

    fn places(&self, pixels: &[usize]) -> Vec<Pixel> {
        let width = self.rays.width();
        pixels.iter().map(|pixel| [(pixel % width) as u32, (pixel / width) as u32]).collect()
    }

    /// Follows a ray for each pixel; returns what is no miss, distances in world units, tile by tile but for those that were
    /// no longer wanted.
    fn follow(
        &self,
        tiles: impl ParallelIterator<Item = Vec<Pixel>>,
        segment: &(impl Fn(Pixel) -> Segment + Sync),
        start: Start,
    ) -> Vec<(Findings, Work)> {
        let follow = |tile: Vec<Pixel>| {
            if !(self.advance)(0) {
                return None;
            }
            let (mut all, mut work) = (Vec::new(), Work::default());
            let ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };
            let unset = Segment { ray, to: 0.0, pixel: [0.0; 2] };
            let (mut rays, mut found) = ([unset; RAYS], [Found::MISS; RAYS]);
            for pixels in tile.chunks(RAYS) {
                let (rays, found) = (&mut rays[..pixels.len()], &mut found[..pixels.len()]);
                for (ray, &pixel) in rays.iter_mut().zip(pixels) {
                    *ray = segment(pixel);
                }
                self.tracer.follow(rays, start, found, &mut work);
                for ((&pixel, found), Segment { ray, .. }) in pixels.iter().zip(found).zip(rays) {
                    if !found.is_miss() {
                        all.push((pixel, found.scaled(ray.distance(1.0))));
                    }
                }
            }
            Some((all, work))
        };
        tiles.filter_map(follow).collect()
    }
}

/// Columns and rows within a square, in Morton's order: each four in a row are 2×2 pixels, each sixteen 4×4.
const ORDER: [[usize; 2]; RAYS] = {
    let mut order = [[0; 2]; RAYS];
    let mut place = 0;
    while place < RAYS {
        let mut bit = 0;
        while bit < RAYS.ilog2() / 2 {
            order[place][0] |= (place >> (2 * bit) & 1) << bit;
            order[place][1] |= (place >> (2 * bit + 1) & 1) << bit;
            bit += 1;
        }
        place += 1;
    }
    order
};

/// The pixels of a band, square by square. Squares of 2×2 that stick out repeat its last pixels.
pub(crate) fn squares(width: usize, height: usize) -> impl Iterator<Item = Vec<[usize; 2]>> {
    let side = RAYS.isqrt();
    let corners = (0..height.div_ceil(side))
        .flat_map(move |down| (0..width.div_ceil(side)).map(move |right| [right, down]));
    corners.map(move |[right, down]| {
        let (left, top) = (side * right, side * down);
        let place = |&[x, y]: &[usize; 2]| [left + x, top + y];
        if left + side <= width && top + side <= height {
            return ORDER.iter().map(place).collect();
        }
        let reaches = |&[x, y]: &[usize; 2]| (x & !1) < width && (y & !1) < height;
        let inside = ORDER.iter().map(place).filter(reaches);
        inside.map(|[x, y]| [x.min(width - 1), y.min(height - 1)]).collect()
    })
}

/// The pixels of a band of patches, a few of these at a time.
pub(crate) fn patches(height: usize) -> impl Iterator<Item = Vec<[usize; 2]>> {
    let at_once = RAYS / LANES;
    let of_patch = |row: usize| ORDER[..LANES].iter().map(move |[x, y]| [x + SIDE * y, row]);
    let some =
        move |first: usize| (first..height.min(first + at_once)).flat_map(of_patch).collect();
    (0..height).step_by(at_once).map(some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_cover_a_band() {
        for (width, height) in [(64, 16), (33, 11), (1, 7), (8, 1)] {
            let mut seen = vec![0; width * height];
            for square in squares(width, height) {
                assert_eq!(square.len() % 4, 0);
                for four in square.chunks(4) {
                    let spread = |axis: usize| {
                        let places = four.iter().map(|place| place[axis]);
                        places.clone().max().expect("four") - places.min().expect("four")
                    };
                    assert!(spread(0) <= 1 && spread(1) <= 1, "{four:?}");
                }
                for [column, row] in square {
                    seen[row * width + column] += 1;
                }
            }
            assert!(seen.iter().all(|&times| times > 0), "{width}×{height}");
        }
    }
}
