//! When work ends early: after some time, or once somebody asks for it.

use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Limits of work. The default is to go on to the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limit {
    /// Time that the work may take.
    pub budget: Option<Duration>,
    /// Time from which the budget counts. `None` if it counts from the start of each piece of work.
    pub begun: Option<Instant>,
    /// Ends the work once it is set.
    pub stop: Option<StopFlag>,
}

/// A flag that is set to end work.
#[derive(Clone, Copy, Debug)]
pub struct StopFlag(pub &'static AtomicBool);

impl PartialEq for StopFlag {
    /// Returns whether both are the same flag.
    fn eq(&self, other: &Self) -> bool {
        ptr::eq(self.0, other.0)
    }
}

impl Eq for StopFlag {}

impl Limit {
    /// The same limits, with the budget starting now.
    #[must_use]
    pub fn begin(self) -> Self {
        Self { begun: Some(Instant::now()), ..self }
    }

    /// Returns a function that tells whether work is still wanted: some of the budget is left, and
    /// nobody has asked for the end. The budget counts from now unless `begun` is set.
    pub fn wanted(&self) -> impl Fn() -> bool + Send + Sync + use<> {
        self.wanted_for(1.0)
    }

    /// Like [`Limit::wanted`], for choosing a region or a camera. It allows a quarter of the time
    /// that is left, so that most of the time remains for the picture.
    pub fn wanted_to_choose(&self) -> impl Fn() -> bool + Send + Sync + use<> {
        self.wanted_for(0.25)
    }

    fn wanted_for(&self, share: f64) -> impl Fn() -> bool + Send + Sync + use<> {
        let now = Instant::now();
        let end = self.budget.and_then(|budget| self.begun.unwrap_or(now).checked_add(budget));
        let end = end.map(|end| now + end.saturating_duration_since(now).mul_f64(share));
        let limit = *self;
        move || !limit.is_stopped() && end.is_none_or(|end| Instant::now() < end)
    }

    /// The part of the budget that is left. `None` without a budget.
    pub fn time_left(&self) -> Option<Duration> {
        let spent = self.begun.map_or(Duration::ZERO, |begun| begun.elapsed());
        self.budget.map(|budget| budget.saturating_sub(spent))
    }

    /// Returns whether somebody has asked for the end.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|StopFlag(flag)| flag.load(Ordering::Relaxed))
    }
}
