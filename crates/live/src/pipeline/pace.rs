//! Chooses the sizes of pictures during typing and dragging, from the times of earlier pictures.
//! Knows only times and pixel counts.

use std::time::Duration;

/// Target time of a coarse picture. Other work included, about thirty appear per second.
const COARSE: Duration = Duration::from_millis(20);

/// If the full picture takes at most this long, no coarse picture is drawn first.
const PROMPT_FULL: Duration = Duration::from_millis(30);

/// If the full picture should take longer than this, one of half its width and height comes first.
const PATIENCE: Duration = Duration::from_millis(150);

/// Largest reduction of width and height. It is also used while the cost of pictures is unknown.
const COARSEST: f64 = 8.0;

/// If the reduction is smaller than this, the full picture is drawn instead.
const NEARLY_FULL: f64 = 1.15;

/// Measured cost of the current model's pictures.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// Number of pixels drawn in the time [`COARSE`].
    affordable: Option<f64>,
    /// Time per pixel of the last full picture, in seconds.
    full: Option<f64>,
}

impl Pace {
    /// Factor by which the first picture is smaller in width and height than the full picture. The
    /// full picture has this many `pixels`.
    pub fn first(&self, pixels: usize) -> f64 {
        let Some(affordable) = self.affordable else { return COARSEST };
        if self.full.is_some_and(|pixel| pixel * pixels as f64 <= PROMPT_FULL.as_secs_f64()) {
            return 1.0;
        }
        let scale = (pixels as f64 / affordable).sqrt();
        if scale <= NEARLY_FULL { 1.0 } else { scale.min(COARSEST) }
    }

    /// Factor by which the next picture is smaller than the full one in width and height. The last
    /// picture had the factor `scale`. The result is 2 if `scale` is above 2.5 and drawing all
    /// `pixels` is slow, else 1.
    pub fn next(&self, scale: f64, pixels: usize) -> f64 {
        let each = self.full.or(self.affordable.map(|pixels| COARSE.as_secs_f64() / pixels));
        let is_slow = each.is_some_and(|each| each * pixels as f64 > PATIENCE.as_secs_f64());
        if scale > 2.5 && is_slow { 2.0 } else { 1.0 }
    }

    /// Records the time of a picture with this many pixels.
    pub fn learn(&mut self, pixels: usize, is_full: bool, took: Duration) {
        let pixels = pixels as f64;
        let seconds = took.as_secs_f64().max(1e-9);
        let affordable = pixels * COARSE.as_secs_f64() / seconds;
        if is_full {
            self.full = Some(seconds / pixels);
            // A coarse picture's pixels cost more, since tiles decide fewer of them. So the full
            // picture gives only an upper bound.
            self.affordable =
                Some(self.affordable.map_or(affordable, |known| known.min(affordable)));
        } else {
            self.affordable = Some(affordable);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: usize = 512 * 512;

    fn ms(ms: f64) -> Duration {
        Duration::from_secs_f64(ms / 1e3)
    }

    /// Reductions chosen for the pictures of one request. The full picture takes `full_ms`, and
    /// each pixel of a coarse picture takes a third longer than one of the full picture.
    fn scales(pace: &mut Pace, full_ms: f64) -> Vec<f64> {
        let mut scales = vec![pace.first(FULL)];
        loop {
            let scale = *scales.last().expect("one");
            let is_full = scale == 1.0;
            let share = if is_full { 1.0 } else { 4.0 / 3.0 / (scale * scale) };
            pace.learn((FULL as f64 / scale / scale) as usize, is_full, ms(full_ms * share));
            if is_full {
                return scales;
            }
            scales.push(pace.next(scale, FULL));
        }
    }

    #[test]
    fn slower_pictures_come_in_more_steps() {
        let steps = |full_ms| {
            let mut pace = Pace::default();
            [scales(&mut pace, full_ms), scales(&mut pace, full_ms)]
        };
        assert_eq!(steps(5.0), [vec![8.0, 1.0], vec![1.0]]);
        assert_eq!(steps(29.0), [vec![8.0, 1.0], vec![1.0]]);
        let [first, second] = steps(60.0);
        assert_eq!(first, [8.0, 1.0]);
        assert!((2.0..2.1).contains(&second[0]) && second[1..] == [1.0], "{second:?}");
        let [first, second] = steps(400.0);
        assert_eq!(first, [8.0, 2.0, 1.0]);
        assert!((5.0..5.3).contains(&second[0]) && second[1..] == [2.0, 1.0], "{second:?}");
        assert_eq!(steps(9000.0)[1], [8.0, 2.0, 1.0]);
    }

    #[test]
    fn a_coarse_picture_takes_its_time_and_no_more() {
        let mut pace = Pace::default();
        pace.learn(FULL, true, ms(300.0));
        for _ in 0..8 {
            // Part of the time does not depend on the picture's size.
            let took = |pixels: usize| ms(4.0 + 296.0 * pixels as f64 / FULL as f64);
            let pixels = (FULL as f64 / pace.first(FULL).powi(2)) as usize;
            pace.learn(pixels, false, took(pixels));
        }
        let pixels = FULL as f64 / pace.first(FULL).powi(2);
        let took = 4.0 + 296.0 * pixels / FULL as f64;
        assert!((19.0..21.0).contains(&took), "{took}");
    }

    #[test]
    fn larger_windows_are_coarser() {
        let mut pace = Pace::default();
        pace.learn(FULL, true, ms(25.0));
        assert_eq!(pace.first(FULL), 1.0);
        assert!((2.2..2.3).contains(&pace.first(4 * FULL)));
    }
}
