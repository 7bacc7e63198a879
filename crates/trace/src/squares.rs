//! The order in which a band's pixels are followed: by squares of neighbors, or by patches.

use crate::grid::SIDE;
use zeroset_eval::LANES;

/// Number of rays that a method gets at once: 8×8 pixels, whose data stay in the nearest cache.
pub(crate) const RAYS: usize = 64;

/// Columns and rows within a square, in Morton order. So every four in sequence are 2×2 pixels, and
/// every sixteen are 4×4 pixels.
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

/// The pixels of a band, square by square. At the band's edges, squares of 2×2 pixels are completed
/// by repeating the last column or row.
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

/// The pixels of a band of patches, a few patches at a time.
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
