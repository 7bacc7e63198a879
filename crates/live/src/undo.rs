//! The history for undo and redo. Knows which changes form one step, but not what a step means.

use super::pipeline::Request;
use std::mem;
use std::sync::Arc;
use std::time::{Duration, Instant};

const MAX_STEPS: usize = 200;

/// Longest pause between two changes that belong to one gesture.
const PAUSE: Duration = Duration::from_secs(1);

/// A kind of continuous change. All its small changes are undone as one step.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Gesture {
    /// Turning, moving or zooming the view.
    View,
    /// Moving the clipping plane.
    Clip,
    /// Dragging a value of this name, or moving it by the clock.
    Value(String),
}

/// A dragged value, with its definition before the drag.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dragged {
    pub name: String,
    /// The value before it was dragged, as typed.
    pub value: String,
    /// Right side of the definition before the drag, with the range. Empty without a definition.
    pub side: String,
}

/// State of the document and its view, for undo.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Checkpoint {
    pub request: Request,
    /// The last text that parsed.
    pub readable: Arc<str>,
    pub dragged: Vec<Dragged>,
}

impl Checkpoint {
    /// Returns whether both states are equal, apart from the picture's size and the axes.
    fn is_same(&self, other: &Self) -> bool {
        let mut framed = self.clone();
        framed.copy_size_and_axes(other);
        framed == *other
    }

    fn copy_size_and_axes(&mut self, other: &Self) {
        self.request.axes = other.request.axes;
        let size = &other.request.settings;
        let settings = &mut self.request.settings;
        (settings.width, settings.height) = (size.width, size.height);
    }
}

/// The history: steps to undo and steps to redo.
#[derive(Default)]
pub(super) struct Undo {
    past: Vec<Checkpoint>,
    future: Vec<Checkpoint>,
    last: Option<(Gesture, Instant)>,
    /// Set while a mouse button is held. A gesture then continues despite pauses.
    held: bool,
}

impl Undo {
    /// Records a change from `before` to `now`. A change that continues a gesture joins its step.
    pub fn note(&mut self, before: Checkpoint, now: &Checkpoint, gesture: Option<Gesture>) {
        if before.is_same(now) {
            return;
        }
        let goes_on = self.last.as_ref().is_some_and(|(last, at)| {
            Some(last) == gesture.as_ref() && (self.held || at.elapsed() < PAUSE)
        });
        self.last = gesture.map(|gesture| (gesture, Instant::now()));
        if goes_on && self.future.is_empty() {
            return;
        }
        self.future.clear();
        if self.past.len() == MAX_STEPS {
            self.past.remove(0);
        }
        self.past.push(before);
    }

    /// Sets whether a mouse button is held. The next change starts a new step.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
        self.last = None;
    }

    /// Returns the previous state and stores `now` for redo. `None` if there is nothing to undo.
    pub fn back(&mut self, now: &Checkpoint) -> Option<Checkpoint> {
        let mut other = self.past.pop()?;
        other.copy_size_and_axes(now);
        self.future.push(now.clone());
        self.last = None;
        Some(other)
    }

    /// Returns the state that was last undone. `None` if there is nothing to redo.
    pub fn forth(&mut self, now: &Checkpoint) -> Option<Checkpoint> {
        mem::swap(&mut self.past, &mut self.future);
        let other = self.back(now);
        mem::swap(&mut self.past, &mut self.future);
        other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkpoint(text: &str) -> Checkpoint {
        let request = Request { text: text.into(), ..Request::default() };
        Checkpoint { request, readable: text.into(), dragged: Vec::new() }
    }

    #[test]
    fn steps_are_taken_back_and_forth_and_gestures_whole() {
        let mut undo = Undo::default();
        undo.note(checkpoint("a"), &checkpoint("b"), None);
        for (before, now) in [("b", "c"), ("c", "d")] {
            undo.note(checkpoint(before), &checkpoint(now), Some(Gesture::View));
        }
        undo.note(checkpoint("d"), &checkpoint("d"), None);
        assert_eq!(undo.back(&checkpoint("d")), Some(checkpoint("b")));
        assert_eq!(undo.back(&checkpoint("b")), Some(checkpoint("a")));
        assert_eq!(undo.back(&checkpoint("a")), None);
        assert_eq!(undo.forth(&checkpoint("a")), Some(checkpoint("b")));
        // A new change clears the redo steps.
        undo.note(checkpoint("b"), &checkpoint("e"), None);
        assert_eq!(undo.forth(&checkpoint("e")), None);
        assert_eq!(undo.back(&checkpoint("e")), Some(checkpoint("b")));
    }

    #[test]
    fn what_a_hand_does_after_letting_go_is_another_step() {
        let mut undo = Undo::default();
        for (before, now) in [("a", "b"), ("b", "c")] {
            undo.hold(true);
            undo.note(checkpoint(before), &checkpoint(now), Some(Gesture::View));
            undo.hold(false);
        }
        assert_eq!(undo.back(&checkpoint("c")), Some(checkpoint("b")));
    }

    #[test]
    fn a_picture_of_another_size_is_no_step() {
        let mut undo = Undo::default();
        let mut larger = checkpoint("a");
        larger.request.settings.width = 9;
        undo.note(checkpoint("a"), &larger, None);
        assert_eq!(undo.back(&larger), None);
    }

    #[test]
    fn the_oldest_steps_are_forgotten() {
        let mut undo = Undo::default();
        (0..MAX_STEPS + 9)
            .for_each(|n| undo.note(checkpoint(&n.to_string()), &checkpoint("now"), None));
        assert_eq!(undo.past.len(), MAX_STEPS);
        assert_eq!(undo.past[0], checkpoint("9"));
    }
}
