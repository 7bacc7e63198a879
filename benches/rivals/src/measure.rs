//! Interleaved rounds of drawing, and statistics of their times.

use crate::side::Side;
use anyhow::Result;
use std::time::Instant;

/// A renderer's seconds per picture, one number for each round.
pub struct Times(Vec<f64>);

/// Times all renderers. First each draws once without measurement. Then all of them draw in every
/// round. Each round begins with another renderer.
///
/// # Errors
/// If a renderer cannot draw.
pub fn measure(sides: &mut [Box<dyn Side + Send>], rounds: usize) -> Result<Vec<Times>> {
    sides.iter_mut().try_for_each(|side| side.draw())?;
    let mut times = vec![Vec::with_capacity(rounds); sides.len()];
    for round in 0..rounds {
        for turn in 0..sides.len() {
            let side = (round + turn) % sides.len();
            let start = Instant::now();
            sides[side].draw()?;
            times[side].push(start.elapsed().as_secs_f64() / sides[side].pictures() as f64);
        }
    }
    Ok(times.into_iter().map(Times).collect())
}

impl Times {
    /// The median, in seconds.
    pub fn median(&self) -> f64 {
        quantile(&self.0, 0.5)
    }

    /// Half the interquartile range, relative to the median.
    pub fn spread(&self) -> f64 {
        (quantile(&self.0, 0.75) - quantile(&self.0, 0.25)) / 2.0 / self.median()
    }

    /// Divides this renderer's time by that of `other` in each round. Returns the median of these
    /// ratios.
    pub fn ratio(&self, other: &Self) -> f64 {
        let ratios: Vec<f64> = self.0.iter().zip(&other.0).map(|(a, b)| a / b).collect();
        quantile(&ratios, 0.5)
    }
}

/// The value below which about this share of the values lies.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}
