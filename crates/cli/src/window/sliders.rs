//! How sliders are moved: by the mouse, by the keys, by the clock. A value is asked for when the
//! picture of the one before is there, so that pictures are seen however long they take.

use super::panel::Panel;
use super::{FRAME, Window};
use std::time::{Duration, Instant};
use zeroset_live::{Slider, Snapshot};
use zeroset_render::overlay::Canvas;

/// Two presses of the same slider within so long are a double click.
const DOUBLE: Duration = Duration::from_millis(400);
/// A coarse picture is followed by that of the next value so long after its value was asked for, so
/// that a finer one that comes within that time is seen.
const COARSE: Duration = Duration::from_millis(30);
/// A picture of a value is waited for so long before the next value is asked for.
const LATE: Duration = Duration::from_millis(250);
/// Between keys that move a slider on there is no more than this.
const NUDGE: Duration = Duration::from_millis(700);
/// With Shift, a slider moves so many times less far.
const FINE: f64 = 0.1;
/// Steps of an arrow key from one end of a slider to the other.
const STEPS: f64 = 100.0;
/// A loop of time has so many values that are told apart.
const TIMES: f64 = 5000.0;

/// The sliders of the picture that is seen, and what moves them.
#[derive(Default)]
pub struct Sliders {
    all: Vec<Slider>,
    panel: Option<Panel>,
    scroll: usize,
    hovered: Option<usize>,
    /// The slider that is held, with the value that the hand is at.
    held: Option<(usize, f64)>,
    /// The slider that was pressed last.
    pressed: Option<(String, Instant)>,
    /// A value that is still to be asked for.
    wanted: Option<(Slider, f64)>,
    /// The last request, and when it was made.
    sent: Option<(u64, Instant)>,
    playing: Option<Playing>,
    /// When a key last moved one.
    nudged: Option<Instant>,
}

/// Time that passes.
struct Playing {
    since: Instant,
    from: f64,
}

impl Sliders {
    /// Stops time, where it is seen to be, and tells whether it passed.
    pub fn pause(&mut self) -> bool {
        let passed = self.playing.take().is_some();
        if passed {
            self.wanted = None;
        }
        passed
    }

    /// Whether a hand or the clock moves one.
    pub fn is_moving(&self) -> bool {
        self.held.is_some() || self.playing.is_some()
    }

    /// The same, where keys that follow each other are one movement.
    pub fn is_in_motion(&self) -> bool {
        self.is_moving() || self.nudged.is_some_and(|at| at.elapsed() < NUDGE)
    }

    /// What their panel takes of the window, in pixels.
    pub fn width(&self) -> usize {
        self.panel.map_or(0, |panel| panel.width)
    }

    /// The sliders as they are to be drawn, where, and which is under the pointer.
    pub fn shown(&self) -> Option<(Panel, Vec<Slider>, Option<usize>)> {
        Some((self.panel?, self.all.clone(), self.hovered))
    }

    /// Takes those of another picture.
    pub fn follow(&mut self, mut all: Vec<Slider>) {
        // The hand, or what was asked for, is ahead of the picture.
        for slider in &mut all {
            let asked = self.all.iter().find(|one| one.name == slider.name);
            let is_ahead = self.held.is_some() || self.wanted.is_some();
            if let Some(asked) = asked.filter(|_| is_ahead) {
                slider.value = asked.value.max(slider.low).min(slider.high);
            }
        }
        if all.len() != self.all.len() {
            (self.held, self.hovered) = (None, None);
        }
        self.all = all;
    }

    /// Finds a place for them in a picture of so many pixels, with the letters of `canvas`.
    pub fn lay_out(&mut self, size: (usize, usize), canvas: &Canvas) {
        self.panel = Panel::new(&self.all, self.scroll, size, canvas);
    }

    fn want(&mut self, index: usize, value: f64) {
        if let Some(slider) = self.all.get_mut(index) {
            slider.value = value;
            self.wanted = Some((slider.clone(), value));
        }
    }
}

impl Window {
    pub(super) fn hover_slider(&mut self, at: Option<(f64, f64)>) {
        let sliders = &mut self.sliders;
        sliders.hovered = sliders.held.map(|(index, _)| index).or_else(|| sliders.panel?.at(at?));
    }

    /// Takes hold of the slider under the pointer, and tells whether there is one.
    pub(super) fn press_slider(&mut self, at: (f64, f64)) -> bool {
        let sliders = &mut self.sliders;
        let Some(panel) = sliders.panel else { return false };
        let Some(index) = panel.at(at) else { return false };
        let slider = sliders.all[index].clone();
        if slider.is_time {
            sliders.pause();
        }
        let now = Instant::now();
        let again = (slider.name.clone(), now);
        let before = sliders.pressed.replace(again);
        let is_double = before.is_some_and(|(name, at)| name == slider.name && now - at < DOUBLE);
        if is_double {
            (sliders.pressed, sliders.wanted) = (None, None);
            self.session.live.restore(&slider);
            self.session.hush();
            return true;
        }
        sliders.held = Some((index, slider.value));
        if !panel.is_on_handle(&slider, at.0) {
            self.move_slider(panel.value(&slider, at.0));
        }
        true
    }

    /// Moves the slider that is held by so many pixels.
    pub(super) fn drag_slider(&mut self, across: f64) {
        let fine = if self.is_shifted() { FINE } else { 1.0 };
        let Some((panel, (index, value))) = self.sliders.panel.zip(self.sliders.held) else {
            return;
        };
        let Some(slider) = self.sliders.all.get(index) else { return };
        // What moves is no click.
        self.sliders.pressed = None;
        let value = value + across * fine * panel.step(slider);
        self.move_slider(value);
    }

    fn move_slider(&mut self, value: f64) {
        let fine = if self.is_shifted() { FINE } else { 1.0 };
        let sliders = &mut self.sliders;
        let Some((panel, held)) = sliders.panel.zip(sliders.held.as_mut()) else { return };
        let Some(slider) = sliders.all.get(held.0) else { return };
        held.1 = value.max(slider.low).min(slider.high);
        let rounded = slider.rounded(value, fine * panel.step(slider));
        let index = held.0;
        sliders.want(index, rounded);
    }

    /// Lets go of the slider: its last value counts, whether there is a picture of the one before
    /// or not.
    pub(super) fn release_slider(&mut self) {
        self.sliders.held = None;
        self.sliders.sent = None;
        self.ask_for_value();
    }

    /// Moves the slider under the pointer by a step, and tells whether there is one.
    pub(super) fn nudge(&mut self, steps: f64) -> bool {
        let fine = if self.is_shifted() { FINE } else { 1.0 };
        let sliders = &mut self.sliders;
        let Some(index) = sliders.hovered else { return false };
        let Some(slider) = sliders.all.get(index).cloned() else { return false };
        if slider.is_time {
            sliders.pause();
        }
        let step = fine * (slider.high - slider.low) / STEPS;
        sliders.nudged = Some(Instant::now());
        sliders.want(index, slider.rounded(slider.value + steps * step, step));
        true
    }

    /// Scrolls the sliders if the pointer is over them and there are more, and tells whether so.
    pub(super) fn scroll_sliders(&mut self, steps: f64) -> bool {
        let sliders = &mut self.sliders;
        let panel = sliders.panel.filter(|_| sliders.hovered.is_some());
        panel.is_some_and(|panel| panel.rows.scroll(&mut sliders.scroll, steps))
    }

    /// Lets time pass, or no longer.
    pub(super) fn toggle_play(&mut self) {
        if self.sliders.pause() {
            return;
        }
        let Some(index) = self.sliders.all.iter().position(|one| one.is_time) else {
            return self.say("there is no time t in what is drawn: write it into a formula first");
        };
        let slider = self.sliders.all[index].clone();
        // A step to be taken back to: what the clock does afterwards is none.
        self.session.live.drag(&slider, slider.value);
        self.sliders.playing = Some(Playing { since: Instant::now(), from: slider.value });
    }

    /// Lets time go on by as much as has passed, round and round within its range.
    pub(super) fn play(&mut self, seen: &Snapshot) {
        let sliders = &mut self.sliders;
        let Some(Playing { since, from }) = &sliders.playing else { return };
        self.active = Instant::now();
        let index = sliders.all.iter().position(|one| one.is_time);
        let Some(index) = index.filter(|_| seen.rendering.is_some()) else {
            sliders.pause();
            return;
        };
        let slider = &sliders.all[index];
        let range = slider.high - slider.low;
        let value = slider.low + (from - slider.low + since.elapsed().as_secs_f64()) % range;
        let value = slider.rounded(value, range / TIMES);
        sliders.want(index, value);
    }

    /// Asks for the value that is wanted, if the picture of the one before is there.
    pub(super) fn send_value(&mut self, seen: &Snapshot) {
        if is_next_due(self.sliders.sent, seen) {
            self.ask_for_value();
        }
    }

    fn ask_for_value(&mut self) {
        let Some((slider, value)) = self.sliders.wanted.take() else { return };
        let live = &self.session.live;
        let revision = if slider.is_time && self.sliders.playing.is_some() {
            live.pass(&slider, value)
        } else {
            live.drag(&slider, value)
        };
        self.sliders.sent = Some((revision, Instant::now()));
        self.session.hush();
    }
}

/// Whether what was asked for last is seen: the full picture, or a coarse one that has been there
/// for a while.
pub fn is_next_due(sent: Option<(u64, Instant)>, seen: &Snapshot) -> bool {
    let fault = seen.fault.as_ref().map_or(0, |fault| fault.revision);
    let (latest, coarse) = match &seen.rendering {
        Some(seen) if seen.revision > fault => (seen.revision, seen.coarse),
        Some(_) | None => (fault, false),
    };
    sent.is_none_or(|(sent, at)| {
        let least = if coarse { COARSE } else { FRAME };
        let passed = at.elapsed();
        latest >= sent && passed >= least || passed > LATE
    })
}
