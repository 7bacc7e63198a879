//! The finished share of a picture. Does not know how long the rest will take.

use std::sync::{Mutex, PoisonError};

/// Work on a picture that was done since the last report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Done {
    /// This many pixels were traced. A pixel counts once per visible surface.
    Pixels(usize),
    /// This many pixels on edges were smoothed.
    Edges {
        /// Number of pixels since the last report.
        now: usize,
        /// Number of all pixels on edges.
        all: usize,
    },
}

impl Done {
    /// No work: the report only asks whether more is wanted.
    pub const NOTHING: Self = Self::Pixels(0);
}

/// The stage of a picture, and how many of the stage's pixels are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage in one word, as messages name it.
    pub stage: &'static str,
    done: usize,
    all: usize,
}

impl Progress {
    /// The beginning of tracing this many pixels. A pixel counts once per visible surface.
    pub const fn tracing(pixels: usize) -> Self {
        Self { stage: "tracing", done: 0, all: pixels }
    }

    /// The progress after more work. `None` if the stage is not known.
    #[must_use]
    pub fn after(known: Option<Self>, more: Done) -> Option<Self> {
        const SMOOTHING: &str = "smoothing";
        match (known, more) {
            (Some(one), Done::Pixels(now)) if one.stage != SMOOTHING => {
                Some(Self { done: one.done + now, ..one })
            }
            (_, Done::Pixels(_)) => known,
            (_, Done::Edges { now, all }) => {
                let before = known.filter(|one| one.stage == SMOOTHING).map_or(0, |one| one.done);
                Some(Self { stage: SMOOTHING, done: before + now, all })
            }
        }
    }

    /// The done share of the stage in percent, rounded down.
    pub fn percent(&self) -> usize {
        // An empty stage is done.
        (100 * self.done).checked_div(self.all).map_or(100, |percent| percent.min(100))
    }
}

/// Listener to the progress of a picture, if there is one. Called from several threads.
pub type Listener<'a> = Option<&'a (dyn Fn(Progress) + Sync)>;

/// The progress of a picture that a listener hears of.
pub(crate) struct Count<'a> {
    known: Mutex<Option<Progress>>,
    listener: Listener<'a>,
}

impl<'a> Count<'a> {
    /// The beginning of tracing this many pixels, as for [`Progress::tracing`].
    pub fn tracing(pixels: usize, listener: Listener<'a>) -> Self {
        Self { known: Mutex::new(Some(Progress::tracing(pixels))), listener }
    }

    /// Adds work, and tells the listener the result.
    pub fn add(&self, done: Done) {
        let Some(listener) = self.listener else { return };
        let now = {
            let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            *known = Progress::after(*known, done);
            *known
        };
        now.into_iter().for_each(listener);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stage_goes_from_none_to_all_of_its_pixels() {
        let told = |known: Option<Progress>| known.map(|one| (one.stage, one.percent()));
        let mut known = Some(Progress::tracing(40));
        let mut after = |more| {
            known = Progress::after(known, more);
            told(known)
        };
        assert_eq!(after(Done::NOTHING), Some(("tracing", 0)));
        assert_eq!(after(Done::Pixels(39)), Some(("tracing", 97)));
        assert_eq!(after(Done::Pixels(1)), Some(("tracing", 100)));
        assert_eq!(after(Done::Edges { now: 0, all: 3 }), Some(("smoothing", 0)));
        assert_eq!(after(Done::Edges { now: 2, all: 3 }), Some(("smoothing", 66)));
        assert_eq!(after(Done::NOTHING), Some(("smoothing", 66)));
        assert_eq!(after(Done::Edges { now: 1, all: 3 }), Some(("smoothing", 100)));
        // Light alone has no pixels to trace.
        assert_eq!(Progress::after(None, Done::NOTHING), None);
        let smoothing = Progress::after(None, Done::Edges { now: 1, all: 4 });
        assert_eq!(told(smoothing), Some(("smoothing", 25)));
        assert_eq!(Progress::tracing(0).percent(), 100);
    }
}
