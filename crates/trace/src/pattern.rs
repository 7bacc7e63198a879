//! Several rays through a pixel, and the mean of what they show.

use crate::colour::LinearRgb;
use glam::Vec3;

/// Where rays go through a pixel that is cut into columns and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// Columns and rows of a pixel.
    pub side: usize,
    /// Those that have a ray, by column and row; `None` if all have.
    places: Option<&'static [[usize; 2]]>,
}

/// Four rays, one in each column and each row, so that no edge that is nearly upright or level meets two at once.
const FOUR: [[usize; 2]; 4] = [[1, 0], [3, 1], [0, 2], [2, 3]];

impl Pattern {
    /// The ray through the centre.
    pub const ONE: Self = Self { side: 1, places: None };

    /// How many rays there may be.
    pub const COUNTS: [usize; 4] = [1, 4, 16, 64];

    /// That of so many rays; `None` if there is none.
    pub fn of(count: usize) -> Option<Self> {
        let (side, places): (_, Option<&'static [[usize; 2]]>) = match count {
            1 => (1, None),
            4 => (4, Some(&FOUR)),
            16 => (4, None),
            64 => (8, None),
            _ => return None,
        };
        Some(Self { side, places })
    }

    /// How many rays it has.
    pub fn count(&self) -> usize {
        self.places.map_or(self.side * self.side, <[_]>::len)
    }

    /// Where they are, by column and row.
    pub fn places(&self) -> impl Iterator<Item = [usize; 2]> {
        let all = move |n: usize| [n % self.side, n / self.side];
        (0..self.count()).map(move |n| self.places.map_or_else(|| all(n), |places| places[n]))
    }

    /// For each row of pixels, of which `only` tells which are wanted, `across` of them in a row: which places of the finer
    /// picture have a ray.
    pub fn rays(&self, only: &[bool], across: usize) -> Vec<bool> {
        let width = across * self.side;
        let mut rays = vec![false; only.len() * self.side * self.side];
        for pixel in (0..only.len()).filter(|&pixel| only[pixel]) {
            let first = self.first(pixel, across);
            self.places().for_each(|[column, row]| rays[first + row * width + column] = true);
        }
        rays
    }

    /// The index of a pixel's first place in the finer picture.
    fn first(&self, pixel: usize, across: usize) -> usize {
        (pixel / across * across * self.side + pixel % across) * self.side
    }

    /// The mean light of a pixel's rays, as sRGB bytes, in the finer picture `bytes`.
    pub fn mean(&self, bytes: &[u8], pixel: usize, across: usize) -> [u8; 3] {
        let (bytes, first, width) =
            (bytes.as_chunks().0, self.first(pixel, across), across * self.side);
        let light = |[column, row]: [usize; 2]| {
            Vec3::from_array(LinearRgb::from_srgb(bytes[first + row * width + column]).0)
        };
        let sum: Vec3 = self.places().map(light).sum();
        LinearRgb((sum / self.count() as f32).to_array()).to_srgb()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_spread_over_columns_and_rows() {
        for count in Pattern::COUNTS {
            let pattern = Pattern::of(count).expect("listed");
            let places: Vec<_> = pattern.places().collect();
            assert_eq!((places.len(), pattern.count()), (count, count));
            for axis in 0..2 {
                let mut seen = vec![0; pattern.side];
                for place in &places {
                    seen[place[axis]] += 1;
                }
                assert!(
                    seen.iter().all(|&times| times == count / pattern.side),
                    "{count}: {seen:?}"
                );
            }
            assert_eq!(pattern.rays(&[true], 1).iter().filter(|ray| **ray).count(), count);
        }
        assert_eq!(Pattern::of(3), None);
    }

    #[test]
    fn means_are_of_light() {
        // Three pixels in a row: white, black, half of the rays white.
        for count in Pattern::COUNTS.into_iter().skip(1) {
            let pattern = Pattern::of(count).expect("listed");
            let (side, width) = (pattern.side, 3 * pattern.side);
            let is_white = |n: usize| match n % width / side {
                0 => true,
                1 => false,
                // What a ray in every row and column sees of the left half is half.
                _ => n % side < side / 2,
            };
            let bytes: Vec<u8> =
                (0..width * side).flat_map(|n| [if is_white(n) { 255 } else { 0 }; 3]).collect();
            let mean = |pixel| pattern.mean(&bytes, pixel, 3);
            // Half of the light is code 188.
            assert_eq!([mean(0), mean(1), mean(2)], [[255; 3], [0; 3], [188; 3]], "{count}");
            let rays = pattern.rays(&[false, true, false], 3);
            assert!((0..rays.len()).all(|n| !rays[n] || n % width / side == 1));
        }
    }
}
