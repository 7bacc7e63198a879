//! Patterns of several rays through a pixel, and the mean of their colors.

use crate::color::LinearRgb;
use glam::Vec3;
use zeroset_trace::SIDE;

/// The positions of a pixel's rays, in a square of columns and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// Number of columns, which is the number of rows.
    pub side: usize,
    /// The positions with a ray, by column and row; `None` if all have one.
    places: Option<&'static [[usize; 2]]>,
}

/// Four rays, one in each column and each row. A nearly vertical or horizontal edge never meets two
/// of them at once.
const FOUR: [[usize; 2]; 4] = [[1, 0], [3, 1], [0, 2], [2, 3]];

impl Pattern {
    /// One ray through the center.
    pub const ONE: Self = Self { side: 1, places: None };

    /// The numbers of rays that a pixel may have.
    pub const COUNTS: [usize; 4] = [1, 4, 16, 64];

    /// The pattern with this number of rays; `None` if there is no such pattern.
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

    /// Number of rays.
    pub fn count(&self) -> usize {
        self.places.map_or(self.side * self.side, <[_]>::len)
    }

    /// Returns whether every position has a ray.
    pub fn is_full(&self) -> bool {
        self.places.is_none()
    }

    /// The column and row, among a pixel's positions, at which each of its patches begins.
    ///
    /// # Panics
    /// If the pattern has only one ray.
    pub fn patches(&self) -> impl Iterator<Item = [usize; 2]> {
        assert!(self.side >= SIDE, "a pixel is a patch or several");
        let across = self.side / SIDE;
        (0..across * across).map(move |n| [n % across, n / across].map(|place| SIDE * place))
    }

    /// For each position of a pixel, whether it has a ray. The order is patch by patch, and row by
    /// row in each patch.
    pub fn rays(&self) -> Vec<bool> {
        let mut rays = vec![self.is_full(); self.side * self.side];
        for [column, row] in self.places.unwrap_or_default() {
            rays[row * SIDE + column] = true;
        }
        rays
    }

    /// The mean of a pixel's opacities, given as for [`Pattern::mean`].
    ///
    /// # Panics
    /// If the number of opacities differs from the number of positions.
    pub fn mean_alpha(&self, alpha: &[u8]) -> u8 {
        assert_eq!(alpha.len(), self.side * self.side, "all places of one pixel");
        let sum: usize = match self.places {
            None => alpha.iter().copied().map(usize::from).sum(),
            Some(places) => {
                places.iter().map(|[column, row]| usize::from(alpha[row * SIDE + column])).sum()
            }
        };
        ((sum + self.count() / 2) / self.count()) as u8
    }

    /// The mean light of a pixel's rays as sRGB bytes. `bytes` has the colors of all positions, in
    /// the order of [`Pattern::rays`].
    ///
    /// # Panics
    /// If the number of colors differs from the number of positions.
    pub fn mean(&self, bytes: &[[u8; 3]]) -> [u8; 3] {
        assert_eq!(bytes.len(), self.side * self.side, "all places of one pixel");
        let light = |bytes: [u8; 3]| Vec3::from_array(LinearRgb::from_srgb(bytes).0);
        let sum: Vec3 = match self.places {
            None => bytes.iter().copied().map(light).sum(),
            Some(places) => {
                places.iter().map(|[column, row]| light(bytes[row * SIDE + column])).sum()
            }
        };
        LinearRgb((sum / self.count() as f32).to_array()).to_srgb()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_eval::LANES;

    #[test]
    fn rays_are_spread_over_columns_and_rows() {
        for count in Pattern::COUNTS {
            let pattern = Pattern::of(count).expect("listed");
            let all = |n: usize| [n % pattern.side, n / pattern.side];
            let places =
                pattern.places.map_or_else(|| (0..count).map(all).collect(), <[_]>::to_vec);
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
            if count > 1 {
                assert_eq!(pattern.rays().iter().filter(|ray| **ray).count(), count);
            }
        }
        assert_eq!(Pattern::of(3), None);
    }

    #[test]
    fn means_are_of_light() {
        for count in Pattern::COUNTS.into_iter().skip(1) {
            let pattern = Pattern::of(count).expect("listed");
            let corners: Vec<[usize; 2]> = pattern.patches().collect();
            let mean = |is_white: &dyn Fn([usize; 2]) -> bool| {
                let of_patch = |[x, y]: &[usize; 2]| {
                    let place = |n: usize| [x + n % SIDE, y + n / SIDE];
                    let bytes =
                        (0..LANES).map(place).map(|at| [if is_white(at) { 255 } else { 0 }; 3]);
                    bytes.collect::<Vec<_>>()
                };
                pattern.mean(&corners.iter().flat_map(of_patch).collect::<Vec<_>>())
            };
            let half = pattern.side / 2;
            let found = [mean(&|_| true), mean(&|_| false), mean(&|[x, _]| x < half)];
            // Half of the rays meet the left half. Half of the light is sRGB byte 188.
            assert_eq!(found, [[255; 3], [0; 3], [188; 3]], "{count}");
            assert_eq!(mean(&|[_, y]| y < half), [188; 3]);
        }
    }
}
