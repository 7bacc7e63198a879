//! Scales pictures to the window. Coarse pictures are interpolated and appear smooth.

use zeroset_render::overlay::Rgb;

/// Number of steps from one pixel to the next.
const ONE: usize = 256;

/// A position between two pixels. `share` is the distance from the first pixel, in steps.
#[derive(Clone, Copy)]
struct SamplePosition {
    first: usize,
    second: usize,
    share: u32,
}

/// Spreads `to` pixels over the length of `from` pixels, and returns the position of each.
fn places(from: usize, to: usize) -> Vec<SamplePosition> {
    let last = from.saturating_sub(1);
    let place = |n: usize| {
        // Distances are measured between the centers of pixels.
        let at = ((2 * n + 1) * from * ONE / (2 * to)).saturating_sub(ONE / 2);
        let first = (at / ONE).min(last);
        SamplePosition { first, second: (first + 1).min(last), share: (at % ONE) as u32 }
    };
    (0..to).map(place).collect()
}

/// Draws the picture `rgb`, of size `from`, into the upper `height` rows of `pixels`. `rgb` holds
/// rows of red, green and blue bytes, and a row of `pixels` has `width` pixels. Interpolates colors
/// unless the sizes are equal.
pub fn enlarge(rgb: &[u8], from: [usize; 2], pixels: &mut [Rgb], [width, height]: [usize; 2]) {
    let colors = rgb.as_chunks::<3>().0;
    let rows = pixels.chunks_exact_mut(width).take(height);
    if from == [width, height] {
        for (row, colors) in rows.zip(colors.chunks_exact(width)) {
            for (pixel, [r, g, b]) in row.iter_mut().zip(colors) {
                *pixel = u32::from(*r) << 16 | u32::from(*g) << 8 | u32::from(*b);
            }
        }
        return;
    }
    let columns = places(from[0], width);
    for (row, place) in rows.zip(places(from[1], height)) {
        let line = |number: usize| &colors[number * from[0]..][..from[0]];
        let (upper, lower) = (line(place.first), line(place.second));
        for (pixel, column) in row.iter_mut().zip(&columns) {
            let channel = |k: usize| {
                let across = |line: &[[u8; 3]]| {
                    let [a, b] = [column.first, column.second].map(|n| u32::from(line[n][k]));
                    a * (ONE as u32 - column.share) + b * column.share
                };
                let (above, below) = (across(upper), across(lower));
                let sum = above * (ONE as u32 - place.share) + below * place.share;
                (sum + (1 << 15)) >> 16
            };
            *pixel = channel(0) << 16 | channel(1) << 8 | channel(2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_the_same_size_is_shown_as_it_is() {
        let rgb: Vec<u8> = (0..3 * 6).collect();
        let mut pixels = [0; 9];
        enlarge(&rgb, [3, 2], &mut pixels, [3, 2]);
        assert_eq!(
            pixels,
            [0x00_01_02, 0x03_04_05, 0x06_07_08, 0x09_0a_0b, 0x0c_0d_0e, 0x0f_10_11, 0, 0, 0]
        );
    }

    #[test]
    fn a_coarse_picture_is_smooth_and_nowhere_beyond_its_colors() {
        // A picture of two pixels: black on the left, white on the right.
        let rgb = [[0; 3], [255; 3]].concat();
        let mut pixels = [7; 8];
        enlarge(&rgb, [2, 1], &mut pixels, [8, 1]);
        let greys: Vec<u32> = pixels.iter().map(|pixel| pixel & 0xff).collect();
        assert_eq!((greys[0], greys[7]), (0, 255));
        assert!(greys.is_sorted() && greys[3] > 80 && greys[4] < 175, "{greys:?}");
        assert!(pixels.iter().all(|pixel| pixel & 0xff == pixel >> 16));
        // A window of one pixel shows the middle of a picture, and a picture of one pixel fills any
        // window.
        let mut one = [7];
        enlarge(&rgb, [2, 1], &mut one, [1, 1]);
        assert_eq!(one[0] & 0xff, 128);
        let mut all = [7; 6];
        enlarge(&[9; 3], [1, 1], &mut all, [3, 2]);
        assert_eq!(all, [0x09_09_09; 6]);
    }
}
