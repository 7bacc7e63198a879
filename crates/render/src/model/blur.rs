//! Blurs over the pixels of a picture.

use rayon::prelude::*;

/// Number of box blurs, one after another. Together they are nearly a Gaussian blur.
const TIMES: usize = 3;

/// Sums of weights below this are rounding errors.
const LEAST_WEIGHT: f32 = 1e-6;

/// Nearly a Gaussian blur: [`TIMES`] means over squares that reach `radius` pixels to each side.
/// Only pixels whose distance `drawn` is finite count. The mean is NaN where none of them is near.
/// `width` is that of the picture.
pub(super) fn blur(values: &[u8], drawn: &[f64], width: usize, radius: usize) -> Vec<f32> {
    let weight = |drawn: &f64| if drawn.is_finite() { 1.0 } else { 0.0 };
    let weights: Vec<f32> = drawn.iter().map(weight).collect();
    let values = values.iter().zip(&weights).map(|(value, weight)| f32::from(*value) * weight);
    let [sums, counts] =
        [values.collect(), weights].map(|sums| box_blur(sums, width, radius, TIMES));
    let mean =
        |(sum, count): (&f32, &f32)| if *count > LEAST_WEIGHT { sum / count } else { f32::NAN };
    sums.iter().zip(&counts).map(mean).collect()
}

/// Means over the squares around each pixel, which reach `radius` pixels to each side. They are
/// taken `times` times. Beyond the picture's edge, values are 0. `width` is that of the picture.
pub(super) fn box_blur(
    mut values: Vec<f32>,
    width: usize,
    radius: usize,
    times: usize,
) -> Vec<f32> {
    let mut width = width.max(1);
    for _ in 0..2 {
        let rows = values.par_chunks_mut(width);
        rows.for_each_init(Vec::new, |copy, row| {
            (0..times).for_each(|_| box_blur_row(row, copy, radius));
        });
        let height = values.len() / width;
        values = transposed(&values, width);
        width = height.max(1);
    }
    values
}

/// Means over the pixels that are at most `radius` away in the row.
fn box_blur_row(row: &mut [f32], copy: &mut Vec<f32>, radius: usize) {
    copy.clear();
    copy.extend_from_slice(row);
    let share = 1.0 / (2 * radius + 1) as f64;
    let mut sum: f64 = copy.iter().take(radius).copied().map(f64::from).sum();
    for (n, value) in row.iter_mut().enumerate() {
        sum += f64::from(copy.get(n + radius).copied().unwrap_or_default());
        *value = (sum * share) as f32;
        sum -= n.checked_sub(radius).map_or(0.0, |first| copy[first].into());
    }
}

/// Columns as rows.
fn transposed(values: &[f32], width: usize) -> Vec<f32> {
    let height = values.len() / width;
    let mut turned = vec![0.0; values.len()];
    turned.par_chunks_mut(height.max(1)).enumerate().for_each(|(column, turned)| {
        let column = values.iter().skip(column).step_by(width);
        turned.iter_mut().zip(column).for_each(|(to, from)| *to = *from);
    });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_values_stay_and_only_pixels_of_the_ground_count() {
        let (width, height, radius) = (31, 23, 3);
        let mut values = vec![100; width * height];
        let mut drawn = vec![1.0; width * height];
        for n in (0..values.len()).filter(|n| n % width < 9) {
            (values[n], drawn[n]) = (255, f64::INFINITY);
        }
        let even = blur(&values, &drawn, width, radius);
        let is_even = |n: &usize| (even[*n] - 100.0).abs() < 0.01;
        assert!((0..values.len()).filter(|n| drawn[*n].is_finite()).all(|n| is_even(&n)));
    }

    #[test]
    fn a_step_becomes_a_slope() {
        let width = 40;
        let values: Vec<u8> =
            (0..width * width).map(|n| if n % 40 < 20 { 0 } else { 200 }).collect();
        let soft = blur(&values, &vec![1.0; values.len()], width, 2);
        let row = &soft[10 * width..11 * width];
        assert!(row.is_sorted_by(|a, b| a <= &(b + 0.01)));
        assert!(row[10] < 0.01 && (row[29] - 200.0).abs() < 0.01);
        assert!((row[19] + row[20] - 200.0).abs() < 0.01 && row[19] > 80.0);
        // Columns are as rows.
        let turned =
            transposed(&values.iter().map(|value| f32::from(*value)).collect::<Vec<_>>(), width);
        let turned: Vec<u8> = turned.iter().map(|value| *value as u8).collect();
        let other = blur(&turned, &vec![1.0; values.len()], width, 2);
        assert!((0..width).all(|k| (other[k * width + 10] - row[k]).abs() < 0.01));
    }
}
