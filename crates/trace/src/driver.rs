//! What all methods share: which rays go together, threads, cancelling, progress, and where findings go.
//!
//! How a ray is followed is not known here.

use crate::frame::Frame;
use crate::gbuffer::GBuffer;
use crate::light::Light;
use crate::method::{Found, Segment, Start, Tracer};
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
    pub frame: &'a Frame,
    /// What follows them.
    pub tracer: &'a dyn Tracer,
    /// Told how many pixels were finished since it was last called; ends the work early by returning `false`. Pixels not
    /// reached are then left as they were.
    pub advance: &'a (dyn Fn(usize) -> bool + Sync),
}

/// Indices of pixels that belong together.
type Tile = Vec<usize>;

impl Driver<'_> {
    /// Traces all pixels.
    pub fn picture(&self) -> (GBuffer, Work) {
        let (width, height) = (self.frame.width(), self.frame.height());
        let across = width.div_ceil(TILE);
        let tiles = (0..across * height.div_ceil(TILE)).into_par_iter().map(|tile| {
            let (left, top) = (TILE * (tile % across), TILE * (tile / across));
            let size = (width - left).min(TILE) * (height - top).min(TILE);
            (squares(left, top, width, height), size)
        });
        let mut buffer = GBuffer::new(width, height, 0);
        let work = self.scatter(tiles, &mut buffer);
        (buffer, work)
    }

    /// Traces these pixels of a picture anew, in the order in which they should go together.
    ///
    /// # Panics
    /// If there is no such pixel, or the picture has another size.
    pub fn pixels(&self, pixels: &[usize], buffer: &mut GBuffer) -> Work {
        assert_eq!((buffer.width, buffer.height), (self.frame.width(), self.frame.height()));
        let tiles = pixels.par_chunks(TILE * TILE).map(|tile| (tile.to_vec(), tile.len()));
        for &pixel in pixels {
            buffer.set(pixel, &Found::MISS);
        }
        self.scatter(tiles, buffer)
    }

    fn scatter(
        &self,
        tiles: impl IndexedParallelIterator<Item = (Tile, usize)>,
        buffer: &mut GBuffer,
    ) -> Work {
        let segment = |pixel: usize| {
            let (origin, direction) =
                self.frame.line(pixel % self.frame.width(), pixel / self.frame.width());
            Segment { origin, direction, to: f64::INFINITY }
        };
        let (found, work) = self.follow(tiles, &segment, Start::Anywhere);
        for (pixel, found) in found {
            let length = segment(pixel).direction.length();
            let world = |distance: f64| distance * length;
            buffer.set(
                pixel,
                &Found { distance: world(found.distance), drawn: world(found.drawn), ..found },
            );
        }
        work
    }

    /// Finds which painted points of `buffer` do not see the light. A ray starts `offset` away from its point (in world
    /// units), and what it meets before it is clear of that surface does not count: otherwise a surface would shade
    /// itself wherever enclosures are wide.
    pub fn shadows(&self, buffer: &mut GBuffer, light: &Light, offset: f64) -> Work {
        let painted: Vec<usize> =
            (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)).collect();
        let segment = |pixel: usize| {
            let ray = self.frame.ray_of(pixel);
            let point = ray.at(buffer.drawn[pixel]);
            let (way, distance) = light.towards(point);
            // Off the surface on the side of the eye, then along the light.
            let origin = point - ray.direction * offset + way * offset;
            Segment { origin, direction: way, to: distance }
        };
        let tiles = painted.par_chunks(TILE * TILE).map(|tile| (tile.to_vec(), 0));
        let (found, work) = self.follow(tiles, &segment, Start::OnSurface);
        painted.iter().for_each(|&pixel| buffer.shadow[pixel] = false);
        for (pixel, found) in found {
            buffer.shadow[pixel] = found.drawn.is_finite();
        }
        work
    }

    /// Follows a ray for each pixel; returns what is no miss.
    fn follow(
        &self,
        tiles: impl IndexedParallelIterator<Item = (Tile, usize)>,
        segment: &(impl Fn(usize) -> Segment + Sync),
        start: Start,
    ) -> (Vec<(usize, Found)>, Work) {
        let done: Vec<(Vec<(usize, Found)>, Work)> = tiles
            .map(|(tile, size)| {
                let mut work = Work::default();
                let mut all = Vec::new();
                if !(self.advance)(0) {
                    return (all, work);
                }
                let unset = Segment { origin: DVec3::ZERO, direction: DVec3::Z, to: 0.0 };
                let (mut rays, mut found) = ([unset; RAYS], [Found::MISS; RAYS]);
                for pixels in tile.chunks(RAYS) {
                    let (rays, found) = (&mut rays[..pixels.len()], &mut found[..pixels.len()]);
                    for (ray, &pixel) in rays.iter_mut().zip(pixels) {
                        *ray = segment(pixel);
                    }
                    self.tracer.follow(rays, start, found, &mut work);
                    let kept = pixels.iter().zip(found).filter(|(_, found)| **found != Found::MISS);
                    all.extend(kept.map(|(&pixel, found)| (pixel, *found)));
                }
                (self.advance)(size);
                (all, work)
            })
            .collect();
        let mut work = Work::default();
        let mut all = Vec::with_capacity(done.iter().map(|(found, _)| found.len()).sum());
        for (found, part) in done {
            work += part;
            all.extend(found);
        }
        (all, work)
    }
}

/// The pixels of a tile, square by square: each four in a row are 2×2 pixels, each sixteen 4×4, each 64 8×8. Squares
/// that stick out of the picture repeat its last pixels.
fn squares(left: usize, top: usize, width: usize, height: usize) -> Tile {
    let reach = |from: usize, end: usize| (end - from).min(TILE);
    let mut tile = Vec::with_capacity(TILE * TILE);
    for place in 0..TILE * TILE / 4 {
        // Every other bit of the place in Morton's order.
        let bits = |from: usize| (0..4).map(|k| (place >> (2 * k + from) & 1) << k).sum::<usize>();
        let (x, y) = (2 * bits(0), 2 * bits(1));
        if x < reach(left, width) && y < reach(top, height) {
            for (i, j) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
                let (i, j) = ((left + i).min(width - 1), (top + j).min(height - 1));
                tile.push(j * width + i);
            }
        }
    }
    tile
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
                        let columns = four.iter().map(|pixel| pixel % width);
                        let rows = four.iter().map(|pixel| pixel / width);
                        assert!(
                            columns.clone().max().expect("four") < columns.min().expect("four") + 2
                        );
                        assert!(rows.clone().max().expect("four") < rows.min().expect("four") + 2);
                    }
                    tile.iter().for_each(|&pixel| seen[pixel] += 1);
                }
            }
            assert!(seen.iter().all(|&times| times > 0), "{width}×{height}");
        }
        let first: Vec<(usize, usize)> = squares(32, 0, 64, 32)[..16]
            .iter()
            .map(|pixel| (pixel % 64 - 32, pixel / 64))
            .collect();
        assert!(first.iter().all(|&(x, y)| x < 4 && y < 4), "{first:?}");
    }
}
