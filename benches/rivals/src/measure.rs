//! Interleaved rounds of drawing, and statistics of their times.

use crate::side::Side;
use anyhow::Result;
use rustix::time::{ClockId, clock_gettime};
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

/// As [`measure`], but with the processor time of the process, which other programs hardly change.
/// Rounds end when all sides together have taken `most` seconds. The first round, which warms up,
/// counts if there is time for no other.
///
/// # Errors
/// If a renderer cannot draw.
pub fn measure_within<'a>(
    sides: &mut [Box<dyn Side + Send + 'a>],
    rounds: usize,
    most: f64,
) -> Result<Vec<Times>> {
    let start = processor_seconds();
    let mut times = vec![Vec::with_capacity(rounds); sides.len()];
    for round in 0..=rounds {
        // The rounds so far tell whether there is time for another.
        let spent = processor_seconds() - start;
        if round > 0 && spent + spent / round as f64 > most {
            break;
        }
        if round == 1 {
            times.iter_mut().for_each(Vec::clear);
        }
        for turn in 0..sides.len() {
            let side = (round + turn) % sides.len();
            let start = processor_seconds();
            sides[side].draw()?;
            times[side].push((processor_seconds() - start) / sides[side].pictures() as f64);
        }
    }
    Ok(times.into_iter().map(Times).collect())
}

/// Processor time of all threads of this process, in seconds.
fn processor_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

impl Times {
    /// Number of rounds.
    pub fn rounds(&self) -> usize {
        self.0.len()
    }

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
