//! Moves sliders by mouse, keys and clock. A slow picture is still shown: the next value is
//! requested only when the previous value's picture is finished.

use super::panel::{Panel, PanelContent, SliderPart};
use super::{FRAME, Window};
use std::time::{Duration, Instant};
use zeroset_live::{Slider, Snapshot};
use zeroset_render::overlay::Canvas;

/// Longest time between the two presses of a double click.
const DOUBLE_CLICK: Duration = Duration::from_millis(400);
/// Least time between requests while only a coarse picture is visible. A finer picture that is
/// finished within this time is shown.
const COARSE_FRAME: Duration = Duration::from_millis(30);
/// If a value's picture takes longer than this, the next value is requested without waiting for it.
const MAX_WAIT: Duration = Duration::from_millis(250);
/// Longest pause between key presses that count as one movement.
const KEY_PAUSE: Duration = Duration::from_millis(700);
/// A slider's movement is multiplied by this factor while Shift is held.
const FINE: f64 = 0.1;
/// An arrow key moves a slider from one end to the other in this many presses.
const STEPS: f64 = 100.0;
/// Number of values that a running value takes in one loop over its range.
const TIME_STEPS: f64 = 5000.0;
/// Seconds in which a value other than `t` runs to the end of its range and back.
const ROUND_TRIP: f64 = 8.0;

/// The sliders of the visible picture, and their movement.
#[derive(Default)]
pub struct Sliders {
    all: Vec<Slider>,
    panel: Option<Panel>,
    scroll: usize,
    hovered: Option<(usize, SliderPart)>,
    /// Index of the slider that is being dragged, and its value before rounding.
    held: Option<(usize, f64)>,
    /// Name of the slider that was pressed last, and time of the press.
    pressed: Option<(String, Instant)>,
    /// A slider and the value that it was moved to, which is still to be requested.
    wanted: Option<(Slider, f64)>,
    /// Revision of the last request, and when it was made.
    sent: Option<(u64, Instant)>,
    playing: Option<Playing>,
    /// When a key last moved a slider.
    nudged: Option<Instant>,
}

/// A running clock: the name of the value that it moves, when it began, and the value at that time.
struct Playing {
    name: String,
    since: Instant,
    from: f64,
}

impl Playing {
    /// The value of the slider now. The time counts seconds, from the start of its range again and
    /// again. Other values move to the end of their range and back.
    fn value(&self, slider: &Slider) -> f64 {
        let range = slider.high - slider.low;
        let (begun, passed) = (self.from - slider.low, self.since.elapsed().as_secs_f64());
        let above = if slider.is_time {
            (begun + passed) % range
        } else {
            let way = (begun + passed * 2.0 * range / ROUND_TRIP) % (2.0 * range);
            if way > range { 2.0 * range - way } else { way }
        };
        slider.rounded(slider.low + above, range / TIME_STEPS)
    }
}

impl Sliders {
    /// Stops the clock at the displayed value, and returns whether it was running.
    pub fn pause(&mut self) -> bool {
        let passed = self.playing.take().is_some();
        if passed {
            self.wanted = None;
        }
        passed
    }

    /// Whether the mouse or the clock is moving a slider.
    pub fn is_moving(&self) -> bool {
        self.held.is_some() || self.playing.is_some()
    }

    /// Whether the mouse, the clock or a recent press of a key is moving a slider.
    pub fn is_in_motion(&self) -> bool {
        self.is_moving() || self.nudged.is_some_and(|at| at.elapsed() < KEY_PAUSE)
    }

    /// Name of the slider that the clock moves. `None` for the time, whose domain holds all times.
    pub fn played(&self) -> Option<&str> {
        let slider = &self.all[self.playing_index()?];
        (!slider.is_time).then_some(slider.name.as_str())
    }

    /// Width of the panel in pixels, or 0 without a panel.
    pub fn width(&self) -> usize {
        self.panel.map_or(0, |panel| panel.width)
    }

    /// Returns the panel to draw.
    pub fn shown(&self) -> Option<PanelContent> {
        let (panel, sliders, hovered) = (self.panel?, self.all.clone(), self.hovered);
        Some(PanelContent { panel, sliders, hovered, playing: self.playing_index() })
    }

    /// Index of the slider that the clock moves.
    fn playing_index(&self) -> Option<usize> {
        let name = &self.playing.as_ref()?.name;
        self.all.iter().position(|one| one.name == *name)
    }

    /// Adopts the sliders of a new picture.
    pub fn follow(&mut self, mut all: Vec<Slider>) {
        // Keep dragged values, and values to be requested: they are newer than the picture's.
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

    /// Lays out the panel in a picture of this size in pixels, with the letters of `canvas`.
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
        let held = sliders.held.map(|(index, _)| (index, SliderPart::Track));
        sliders.hovered = held.or_else(|| sliders.panel?.at(at?));
    }

    /// Presses the slider under the pointer, and returns whether there is one.
    pub(super) fn press_slider(&mut self, at: (f64, f64)) -> bool {
        let sliders = &mut self.sliders;
        let Some(panel) = sliders.panel else { return false };
        let Some((index, part)) = panel.at(at) else { return false };
        let Some(slider) = sliders.all.get(index).cloned() else { return false };
        match part {
            SliderPart::Play => {
                self.toggle_play_of(index);
                return true;
            }
            SliderPart::Value => {
                self.edit_value(&slider);
                return true;
            }
            SliderPart::Track => {}
        }
        if sliders.playing_index() == Some(index) {
            sliders.pause();
        }
        let now = Instant::now();
        let again = (slider.name.clone(), now);
        let before = sliders.pressed.replace(again);
        let is_double =
            before.is_some_and(|(name, at)| name == slider.name && now - at < DOUBLE_CLICK);
        if is_double {
            (sliders.pressed, sliders.wanted) = (None, None);
            self.session.live.restore(&slider);
            self.session.report_in_window();
            return true;
        }
        sliders.held = Some((index, slider.value));
        if !panel.is_on_handle(&slider, at.0) {
            self.move_slider(panel.value(&slider, at.0));
        }
        true
    }

    /// Moves the dragged slider by this many pixels.
    pub(super) fn drag_slider(&mut self, across: f64) {
        let fine = if self.is_shifted() { FINE } else { 1.0 };
        let Some((panel, (index, value))) = self.sliders.panel.zip(self.sliders.held) else {
            return;
        };
        let Some(slider) = self.sliders.all.get(index) else { return };
        // A press with a movement is not the first click of a double click.
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

    /// Releases the slider. Requests its last value, even if the previous value's picture is
    /// unfinished.
    pub(super) fn release_slider(&mut self) {
        self.sliders.held = None;
        self.sliders.sent = None;
        self.ask_for_value();
    }

    /// Moves the slider under the pointer by this many steps. Returns whether there is a slider.
    pub(super) fn nudge(&mut self, steps: f64) -> bool {
        let fine = if self.is_shifted() { FINE } else { 1.0 };
        let sliders = &mut self.sliders;
        let Some((index, _)) = sliders.hovered else { return false };
        let Some(slider) = sliders.all.get(index).cloned() else { return false };
        if sliders.playing_index() == Some(index) {
            sliders.pause();
        }
        let step = fine * (slider.high - slider.low) / STEPS;
        sliders.nudged = Some(Instant::now());
        sliders.want(index, slider.rounded(slider.value + steps * step, step));
        true
    }

    /// If the pointer is over the sliders and some are not visible, scrolls them and returns true.
    pub(super) fn scroll_sliders(&mut self, steps: f64) -> bool {
        let sliders = &mut self.sliders;
        let panel = sliders.panel.filter(|_| sliders.hovered.is_some());
        panel.is_some_and(|panel| panel.rows.scroll(&mut sliders.scroll, steps))
    }

    /// Starts or stops the clock for the time.
    pub(super) fn toggle_play(&mut self) {
        if self.sliders.pause() {
            return;
        }
        match self.sliders.all.iter().position(|one| one.is_time) {
            Some(index) => self.toggle_play_of(index),
            None => self.say("there is no time t in what is drawn: write it into a formula first"),
        }
    }

    /// Starts the clock for the slider with this index, or stops it if it runs for that slider.
    fn toggle_play_of(&mut self, index: usize) {
        let was_playing = self.sliders.playing_index() == Some(index);
        self.sliders.pause();
        if was_playing {
            return;
        }
        let slider = self.sliders.all[index].clone();
        // Record an undo step for this value, since changes by the clock are not recorded.
        self.session.live.drag(&slider, slider.value);
        let Slider { name, value: from, .. } = slider;
        self.sliders.playing = Some(Playing { name, since: Instant::now(), from });
    }

    /// Opens the definition of a slider's value in the line.
    fn edit_value(&mut self, slider: &Slider) {
        self.sliders.pause();
        self.put_line_away();
        self.open_line().insert_text(&slider.definition());
        self.follow_typing();
    }

    /// Sets the running value to that of this moment.
    pub(super) fn play(&mut self, seen: &Snapshot) {
        let sliders = &mut self.sliders;
        let Some(playing) = &sliders.playing else { return };
        self.active = Instant::now();
        let index = sliders.playing_index().filter(|_| seen.rendering.is_some());
        let Some(index) = index else {
            sliders.pause();
            return;
        };
        let value = playing.value(&sliders.all[index]);
        sliders.want(index, value);
    }

    /// Requests the value that a slider was moved to, if a request is due.
    pub(super) fn send_value(&mut self, seen: &Snapshot) {
        if is_next_due(self.sliders.sent, seen) {
            self.ask_for_value();
        }
    }

    fn ask_for_value(&mut self) {
        let Some((slider, value)) = self.sliders.wanted.take() else { return };
        let live = &self.session.live;
        let is_played = self.sliders.playing.as_ref().is_some_and(|one| one.name == slider.name);
        let revision =
            if is_played { live.pass(&slider, value) } else { live.drag(&slider, value) };
        self.sliders.sent = Some((revision, Instant::now()));
        self.session.report_in_window();
    }
}

/// Whether the next value may be requested. The last request must be finished and at least `FRAME`
/// old, or `COARSE_FRAME` if its picture is coarse. Failing that, it must be older than `MAX_WAIT`.
pub fn is_next_due(sent: Option<(u64, Instant)>, seen: &Snapshot) -> bool {
    let fault = seen.fault.as_ref().map_or(0, |fault| fault.revision);
    let (latest, coarse) = match &seen.rendering {
        Some(seen) if seen.revision > fault => (seen.revision, seen.coarse),
        Some(_) | None => (fault, false),
    };
    sent.is_none_or(|(sent, at)| {
        let least = if coarse { COARSE_FRAME } else { FRAME };
        let passed = at.elapsed();
        latest >= sent && passed >= least || passed > MAX_WAIT
    })
}
