//! What all methods share: which rays go together, threads, cancelling, progress, and where findings go.
//!
//! How a ray is followed is not known here.

use crate::camera::Ray;
use crate::gbuffer::{Found, GBuffer};
use crate::grid::RayGrid;
use crate::light::Light;
use crate::method::{Segment, Start, Tracer};
use crate::work::Work;
use glam::DVec3;
use rayon::prelude::*;

/// Pixels on the side of a tile: the unit of work that threads share and that may be cancelled.
const TILE: usize = 32;
/// Rays handed to a method at once: 8×8 pixels of a tile, whose data stay in the nearest cache.
const RAYS: usize = 64;

/// A method at work on one surface, as seen from one place.
#[derive(Clone, Copy)]
pub struct Driver<'a> {
    /// Where rays start and go.
    pub rays: &'a RayGrid,
    /// What follows them.
    pub tracer: &'a dyn Tracer,
    /// Told how many pixels were finished since it was last called; ends the work early by returning `false`. Pixels not
    /// reached then stay as they were, in a new picture misses: it is of no use.
    pub advance: &'a (dyn Fn(usize) -> bool + Sync),
}

/// A pixel's column and row: an index would have to be divided again for each ray.
type Pixel = [u32; 2];

/// What became of a tile's rays, but for misses.
type Findings = Vec<(Pixel, Found)>;

impl Driver<'_> {
    /// Traces all pixels.
    pub fn picture(&self) -> (GBuffer, Work) {
        let (width, height) = (self.rays.width(), self.rays.height());
        let across = width.div_ceil(TILE);
        let tiles = (0..across * height.div_ceil(TILE)).into_par_iter().map(|tile| {
            let (left, top) = (TILE * (tile % across), TILE * (tile / across));
            let size = (width - left).min(TILE) * (height - top).min(TILE);
            (squares(left, top, width, height), size)
        });
        let mut buffer = GBuffer::new(width, height, 0);
        let mut work = Work::default();
        for (found, part) in
            self.follow(tiles, &self.primary(), Start::Anywhere).into_iter().flatten()
        {
            work += part;
            self.write(found, &mut buffer);
        }
        (buffer, work)
    }

    /// Traces these pixels of a picture anew, in the order in which they should go together.
    ///
    /// # Panics
    /// If there is no such pixel, or the picture has another size.
    pub fn pixels(&self, pixels: &[usize], buffer: &mut GBuffer) -> Work {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        let tiles = pixels.par_chunks(TILE * TILE).map(|tile| (self.places(tile), tile.len()));
        let mut work = Work::default();
        let done = self.follow(tiles, &self.primary(), Start::Anywhere);
        for (tile, done) in pixels.chunks(TILE * TILE).zip(done) {
            // A pixel that was not reached keeps what is known of it: to call it a miss would be a claim.
            let Some((found, part)) = done else { continue };
            work += part;
            for &pixel in tile {
                buffer.set(pixel, &Found::MISS);
            }
            self.write(found, buffer);
        }
        work
    }

    /// The rays through the pixels' centres.
    fn primary(&self) -> impl Fn(Pixel) -> Segment + Sync {
        let rays = *self.rays;
        move |[column, row]| Segment {
            ray: rays.ray(column as usize, row as usize),
            to: f64::INFINITY,
        }
    }

    fn write(&self, found: Findings, buffer: &mut GBuffer) {
        for (pixel, found) in found {
            buffer.set(self.index(pixel), &found);
        }
    }

    /// Finds which painted points of `buffer` do not see the light. A ray starts `offset` away from its point (in world
    /// units), and what it meets before it is clear of that surface does not count: otherwise a surface would shade
    /// itself wherever enclosures are wide.
    pub fn shadows(&self, buffer: &mut GBuffer, light: &Light, offset: f64) -> Work {
        let painted: Vec<usize> =
            (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)).collect();
        let segment = |pixel: Pixel| {
            let [column, row] = pixel.map(|place| place as usize);
            let (ray, pixel) = (self.rays.ray(column, row), self.index(pixel));
            let t = ray.parameter(buffer.drawn[pixel]);
            let (way, distance) = light.towards(ray.at(t));
            // Off the surface on the side of the eye, then along the light.
            let origin = ray.at(t - ray.parameter(offset)) + way * offset;
            Segment { ray: Ray { origin, direction: way }, to: distance }
        };
        let tiles = painted.par_chunks(TILE * TILE).map(|tile| (self.places(tile), 0));
        for &pixel in &painted {
            buffer.shadow[pixel] = false;
        }
        let mut work = Work::default();
        for (found, part) in self.follow(tiles, &segment, Start::OnSurface).into_iter().flatten() {
            work += part;
            for (pixel, found) in found {
                buffer.shadow[self.index(pixel)] = found.drawn.is_finite();
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

    /// Follows a ray for each pixel; returns what is no miss, tile by tile, distances in world units. `None` for a tile
    /// that was no longer wanted.
    fn follow(
        &self,
        tiles: impl IndexedParallelIterator<Item = (Vec<Pixel>, usize)>,
        segment: &(impl Fn(Pixel) -> Segment + Sync),
        start: Start,
    ) -> Vec<Option<(Findings, Work)>> {
        let follow = |(tile, size): (Vec<Pixel>, usize)| {
            if !(self.advance)(0) {
                return None;
            }
            let (mut all, mut work) = (Vec::new(), Work::default());
            let unset = Segment { ray: Ray { origin: DVec3::ZERO, direction: DVec3::Z }, to: 0.0 };
            let (mut rays, mut found) = ([unset; RAYS], [Found::MISS; RAYS]);
            for pixels in tile.chunks(RAYS) {
                let (rays, found) = (&mut rays[..pixels.len()], &mut found[..pixels.len()]);
                for (ray, &pixel) in rays.iter_mut().zip(pixels) {
                    *ray = segment(pixel);
                }
                self.tracer.follow(rays, start, found, &mut work);
                for ((&pixel, found), Segment { ray, .. }) in pixels.iter().zip(found).zip(rays) {
                    if *found != Found::MISS {
                        let length = ray.distance(1.0);
                        found.distance *= length;
                        found.drawn *= length;
                        all.push((pixel, *found));
                    }
                }
            }
            (self.advance)(size);
            Some((all, work))
        };
        tiles.map(follow).collect()
    }
}

/// Columns and rows within a tile, square by square (Morton's order): each four in a row are 2×2 pixels, each sixteen
/// 4×4, each 64 8×8.
const ORDER: [Pixel; TILE * TILE] = {
    let mut order = [[0; 2]; TILE * TILE];
    let mut place = 0;
    while place < order.len() {
        let mut bit = 0;
        while bit < TILE.ilog2() {
            order[place][0] |= (place as u32 >> (2 * bit) & 1) << bit;
            order[place][1] |= (place as u32 >> (2 * bit + 1) & 1) << bit;
            bit += 1;
        }
        place += 1;
    }
    order
};

/// The pixels of a tile in this order. Squares of 2×2 that stick out of the picture repeat its last pixels.
fn squares(left: usize, top: usize, width: usize, height: usize) -> Vec<Pixel> {
    let [left, top, width, height] = [left, top, width, height].map(|place| place as u32);
    let place = |&[x, y]: &Pixel| [left + x, top + y];
    if left + TILE as u32 <= width && top + TILE as u32 <= height {
        return ORDER.iter().map(place).collect();
    }
    let reaches = |&[x, y]: &Pixel| (x & !1) < width && (y & !1) < height;
    let inside = ORDER.iter().map(place).filter(reaches);
    inside.map(|[x, y]| [x.min(width - 1), y.min(height - 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_picture_in_squares() {
        for (width, height) in [(64, 32), (33, 35), (1, 7), (8, 1)] {
            let mut seen = vec![0; width * height];
            for top in (0..height).step_by(TILE) {
                for left in (0..width).step_by(TILE) {
                    let tile = squares(left, top, width, height);
                    assert_eq!(tile.len() % 4, 0);
                    for four in tile.chunks(4) {
                        let columns = four.iter().map(|[column, _]| *column);
                        let rows = four.iter().map(|[_, row]| *row);
                        assert!(
                            columns.clone().max().expect("four") < columns.min().expect("four") + 2
                        );
                        assert!(rows.clone().max().expect("four") < rows.min().expect("four") + 2);
                    }
                    for [i, j] in tile {
                        seen[j as usize * width + i as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&times| times > 0), "{width}×{height}");
        }
        let first = &squares(32, 0, 64, 32)[..16];
        assert!(first.iter().all(|&[x, y]| x < 36 && y < 4), "{first:?}");
    }
}
