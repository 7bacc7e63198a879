//! Patterns of several rays through a pixel, and the mean over them.

use glam::Vec4;
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

    /// The mean over a pixel's rays. `value` gives the value at each position, in the order of
    /// [`Pattern::rays`].
    pub fn mean(&self, value: impl Fn(usize) -> Vec4) -> Vec4 {
        let sum: Vec4 = match self.places {
            None => (0..self.side * self.side).map(value).sum(),
            Some(places) => places.iter().map(|[column, row]| value(row * SIDE + column)).sum(),
        };
        sum / self.count() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_eval::LANES;
    use zeroset_style::RAY_COUNTS;

    #[test]
    fn rays_are_spread_over_columns_and_rows() {
        for count in RAY_COUNTS {
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
    fn means_are_over_all_rays() {
        for count in RAY_COUNTS.into_iter().skip(1) {
            let pattern = Pattern::of(count).expect("listed");
            let corners: Vec<[usize; 2]> = pattern.patches().collect();
            let mean = |is_lit: &dyn Fn([usize; 2]) -> bool| {
                let value = |n: usize| {
                    let ([x, y], own) = (corners[n / LANES], n % LANES);
                    let place = [x + own % SIDE, y + own / SIDE];
                    if is_lit(place) { Vec4::ONE } else { Vec4::ZERO }
                };
                pattern.mean(value)
            };
            let half = pattern.side / 2;
            let found = [mean(&|_| true), mean(&|_| false), mean(&|[x, _]| x < half)];
            assert_eq!(found, [1.0, 0.0, 0.5].map(Vec4::splat), "{count}");
            assert_eq!(mean(&|[_, y]| y < half), Vec4::splat(0.5));
        }
    }
}
