//! Mouse actions in the window: turning, moving, zooming, clicking and dragging.

use super::Window;
use super::keys::ZOOM;
use super::wheel::Wheel;
use crate::pick::Pick;
use minifb::{MouseButton, MouseMode};
use std::time::Instant;
use zeroset_live::Snapshot;

/// Largest movement during a click, in pixels.
const CLICK_DISTANCE: f64 = 3.0;

/// State of the mouse.
#[derive(Default)]
pub struct Mouse {
    drag: Option<Drag>,
    /// Last position of the pointer, and whether a button was held at that time.
    last: Option<((f64, f64), bool)>,
    wheel: Wheel,
    /// Whether the middle button was held at the last poll.
    middle: bool,
}

/// A press of a button, and the movement since.
struct Drag {
    start: (f64, f64),
    last: (f64, f64),
    moves: bool,
    what: DragTarget,
    /// Whether Esc ended the drag before the button was released.
    cancelled: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum DragTarget {
    Turn,
    Pan,
    Slider,
    /// Selects in the typed line.
    Line,
    /// Changes an opacity or moves a row in the list of surfaces.
    Surface,
}

impl Mouse {
    /// Cancels the current drag. Returns whether a drag was going on.
    pub fn cancel(&mut self) -> bool {
        let Some(drag) = &mut self.drag else { return false };
        drag.cancelled = true;
        true
    }
}

impl Window {
    pub(super) fn mouse(&mut self, seen: &Snapshot) {
        let Some(at) = self.pointer(MouseMode::Pass) else { return };
        let (_, height) = self.picture_size();
        let inside = self.pointer(MouseMode::Discard).is_some_and(|(_, y)| y < height as f64);
        self.hover_slider(inside.then_some(at));
        self.hover_surface(inside.then_some(at));
        self.wheel(at, inside);
        let left = self.native.get_mouse_down(MouseButton::Left);
        let right = self.native.get_mouse_down(MouseButton::Right);
        let held = left || right;
        let middle = self.native.get_mouse_down(MouseButton::Middle);
        if middle && !std::mem::replace(&mut self.mouse.middle, middle) && !self.browser.is_open() {
            self.paste(true);
        }
        self.mouse.middle = middle;
        let has_changed = self.mouse.last.replace((at, held)) != Some((at, held));
        if has_changed {
            self.active = Instant::now();
        }
        if self.browser.is_open() || self.recent.is_some() {
            let clicked = self.clicks.was_missed(held);
            let pressed = clicked || left && self.mouse.drag.is_none();
            if left {
                // A press that begins in the gallery or the menu has no effect outside it.
                let (start, last, what) = (at, at, DragTarget::Turn);
                let drag = Drag { start, last, moves: true, what, cancelled: true };
                self.mouse.drag.get_or_insert(drag);
            } else {
                // End a drag that began before the gallery opened.
                self.mouse.cancel();
                self.let_go(seen);
            }
            return if self.browser.is_open() {
                self.point_gallery(at, has_changed, pressed);
            } else {
                self.point_recent(at, has_changed, pressed);
            };
        }
        if self.clicks.was_missed(held) && inside && self.mouse.drag.is_none() {
            self.active = Instant::now();
            self.click(at, seen);
        }
        match &mut self.mouse.drag {
            None if held && inside => {
                self.session.live.hold(true);
                let what = if left && self.press_line(at, false) {
                    DragTarget::Line
                } else if left && self.press_slider(at) {
                    DragTarget::Slider
                } else if left && self.press_surface(at) || right && self.press_color(at) {
                    DragTarget::Surface
                } else if right || self.is_shifted() {
                    DragTarget::Pan
                } else {
                    DragTarget::Turn
                };
                let drag = Drag { start: at, last: at, moves: false, what, cancelled: false };
                self.mouse.drag = Some(drag);
            }
            None => {}
            Some(drag) if held => {
                let far = (at.0 - drag.start.0).hypot(at.1 - drag.start.1) > CLICK_DISTANCE;
                drag.moves |= far || drag.what == DragTarget::Slider;
                let (across, down) = (at.0 - drag.last.0, at.1 - drag.last.1);
                if drag.moves && !drag.cancelled && (across, down) != (0.0, 0.0) {
                    drag.last = at;
                    let live = &self.session.live;
                    match drag.what {
                        DragTarget::Pan => live.turn(|orbit| orbit.pan(across, down, height)),
                        DragTarget::Turn => live.turn(|orbit| orbit.turn(across, down, height)),
                        DragTarget::Line => drop(self.press_line(at, true)),
                        DragTarget::Slider => self.drag_slider(across),
                        DragTarget::Surface => self.drag_surface(at),
                    }
                }
            }
            Some(_) => self.let_go(seen),
        }
    }

    fn let_go(&mut self, seen: &Snapshot) {
        let Some(drag) = self.mouse.drag.take() else { return };
        if drag.what == DragTarget::Slider {
            self.release_slider();
        }
        if drag.what == DragTarget::Surface {
            self.release_surface(drag.cancelled, drag.moves);
        }
        self.session.live.hold(false);
        if !drag.moves && drag.what == DragTarget::Turn && !drag.cancelled {
            self.tell_point(drag.start, seen);
        }
    }

    /// Handles a click of the left button that began and ended between two polls.
    fn click(&mut self, at: (f64, f64), seen: &Snapshot) {
        if self.press_line(at, false) {
            // The cursor is where it was clicked.
        } else if self.press_slider(at) {
            self.release_slider();
            self.session.live.hold(false);
        } else if self.press_surface(at) {
            self.release_surface(false, false);
        } else {
            self.tell_point(at, seen);
        }
    }

    /// Moves the cursor of the typed line to the pointer, if the pointer is on that line. With
    /// `select`, the text between the old and the new place is selected. Returns whether the
    /// pointer is on the line.
    fn press_line(&mut self, at: (f64, f64), select: bool) -> bool {
        let Some(position) = self.line_position(at) else { return false };
        self.open_line().step_to(position, select);
        true
    }

    /// Returns the surface point visible at a position.
    pub(super) fn pick<'a>(&self, at: (f64, f64), seen: &'a Snapshot) -> Option<Pick<'a>> {
        Pick::at(seen.rendering.as_ref()?, at, self.picture_size())
    }

    /// Describes the point visible at a position, both in the window and in the terminal.
    fn tell_point(&mut self, at: (f64, f64), seen: &Snapshot) {
        if let Some(text) = self.pick(at, seen).map(|pick| pick.describe()) {
            self.session.say(&text);
            self.say(&text);
        }
    }

    /// Handles the wheel: zooms, moves the clipping plane, or scrolls a list.
    fn wheel(&mut self, at: (f64, f64), inside: bool) {
        let Some((_, counted)) = self.native.get_scroll_wheel() else { return };
        let steps = self.mouse.wheel.steps(counted).clamp(-5.0, 5.0);
        if steps == 0.0 || !inside {
            return;
        }
        self.active = Instant::now();
        if self.browser.is_open() {
            return self.scroll_gallery(steps);
        }
        if self.page.is_some() {
            return self.turn_page(-3 * steps.signum() as isize);
        }
        if self.has_control() {
            return self.session.live.move_cut(steps);
        }
        if self.scroll_sliders(steps) || self.scroll_surfaces(steps) {
            return;
        }
        let (width, height) = self.picture_size();
        let factor = ZOOM.powf(steps);
        let (across, down) = (at.0 - width as f64 / 2.0, at.1 - height as f64 / 2.0);
        self.session.live.turn(|orbit| orbit.zoom(factor, across, down, height));
    }
}
