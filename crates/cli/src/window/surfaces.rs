//! Edits, hides, fades, moves and deletes formulas by mouse and keys.

use super::Window;
use super::list::{List, ListContent, ListPart};
use super::sliders::is_next_due;
use super::tasks::LineGoal;
use minifb::Key;
use std::time::Instant;
use zeroset_live::{Snapshot, SurfaceEntry};
use zeroset_render::overlay::Canvas;

/// Change of an opacity by one press of an arrow key.
const STEP: f64 = 0.05;

/// The list of formulas, and the user's changes to them.
#[derive(Default)]
pub struct Surfaces {
    /// The surfaces, then the curves and points.
    all: Vec<SurfaceEntry>,
    /// Number of the surfaces.
    surface_count: usize,
    list: Option<List>,
    /// Whether the user does not want the list.
    unwanted: bool,
    scroll: usize,
    hovered: Option<(usize, ListPart)>,
    held: Option<ListDrag>,
    /// A surface's index and the opacity that the user chose, which is still to be requested.
    opacity: Option<(usize, f64)>,
    /// Revision and time of the last request to change an opacity.
    sent: Option<(u64, Instant)>,
}

/// The target of a drag.
#[derive(Clone, Copy)]
enum ListDrag {
    /// The opacity of the surface with this index.
    Opacity(usize),
    /// A surface: its present index, and the index that it would get if dropped.
    Row(usize, usize),
}

impl Surfaces {
    /// Returns the list to draw.
    pub fn shown(&self, edited: Option<usize>) -> Option<ListContent> {
        let dragged = match self.held {
            Some(ListDrag::Row(from, to)) => Some((from, to)),
            Some(ListDrag::Opacity(_)) | None => None,
        };
        let (list, formulas, hovered) = (self.list?, self.all.clone(), self.hovered);
        let surfaces = self.surface_count;
        Some(ListContent { list, formulas, surfaces, hovered, edited, dragged })
    }

    /// Whether the user wants the list.
    pub fn is_wanted(&self) -> bool {
        !self.unwanted
    }

    /// Number of formulas.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Adopts the surfaces and the curves of a new picture.
    pub fn follow(&mut self, mut all: Vec<SurfaceEntry>, curves: Vec<SurfaceEntry>) {
        self.surface_count = all.len();
        all.extend(curves);
        if all.len() != self.all.len() {
            (self.held, self.hovered, self.opacity) = (None, None, None);
        }
        // Keep an opacity that waits to be requested, since it is newer than the picture's.
        if let Some((index, opacity)) = self.opacity {
            all[index].opacity = opacity;
        }
        self.all = all;
    }

    /// Lays out the list with the letters of `canvas`, in an area of this size in pixels. Its left
    /// `taken` columns are occupied.
    pub fn lay_out(&mut self, taken: usize, size: (usize, usize), canvas: &Canvas) {
        let list = || List::new(&self.all, self.scroll, taken, size, canvas);
        self.list = (!self.unwanted).then(list).flatten();
    }

    fn want(&mut self, index: usize, opacity: f64) {
        if let Some(surface) = self.all.get_mut(index) {
            surface.opacity = opacity.clamp(0.0, 1.0);
            self.opacity = Some((index, surface.opacity));
        }
    }
}

impl Window {
    pub(super) fn hover_surface(&mut self, at: Option<(f64, f64)>) {
        let surfaces = &mut self.surfaces;
        if surfaces.held.is_none() {
            surfaces.hovered = surfaces.list.zip(at).and_then(|(list, at)| list.at(at));
        }
    }

    /// Shows or hides the list.
    pub(super) fn toggle_list(&mut self) {
        self.surfaces.unwanted = self.surfaces.list.is_some();
    }

    /// Handles a press of the left button, and returns whether it hit the list.
    pub(super) fn press_surface(&mut self, at: (f64, f64)) -> bool {
        let Some((index, part)) = self.surfaces.list.and_then(|list| list.at(at)) else {
            return false;
        };
        let is_curve = index >= self.surfaces.surface_count;
        match part {
            ListPart::New => self.begin_formula(),
            ListPart::Swatch => self.toggle_surface(index),
            // A curve has no track of an opacity.
            ListPart::Opacity(_) if is_curve => {
                self.surfaces.held = Some(ListDrag::Row(index, index));
            }
            ListPart::Formula => self.surfaces.held = Some(ListDrag::Row(index, index)),
            ListPart::Opacity(opacity) => {
                self.surfaces.held = Some(ListDrag::Opacity(index));
                self.surfaces.want(index, opacity);
            }
            ListPart::Delete => self.delete_surface(index),
        }
        true
    }

    /// Handles a press of the right button: on a color, opens a line for another one. Returns
    /// whether it hit a color.
    pub(super) fn press_color(&mut self, at: (f64, f64)) -> bool {
        let hit = self.surfaces.list.and_then(|list| list.at(at));
        let Some((index, ListPart::Swatch)) = hit else { return false };
        if index >= self.surfaces.surface_count {
            self.say("a curve gets its color from a `color` line above it");
            return true;
        }
        self.put_line_away();
        self.open_line().insert_text(&format!(":color {} ", index + 1));
        true
    }

    /// Moves the dragged opacity or surface.
    pub(super) fn drag_surface(&mut self, at: (f64, f64)) {
        let surfaces = &mut self.surfaces;
        let Some(list) = surfaces.list else { return };
        match &mut surfaces.held {
            Some(ListDrag::Opacity(index)) => {
                let index = *index;
                surfaces.want(index, list.opacity(at.0));
            }
            Some(ListDrag::Row(from, to)) if *from < surfaces.surface_count => {
                *to = list.rows.nearest(at.1).min(surfaces.surface_count - 1);
            }
            Some(ListDrag::Row(..)) | None => {}
        }
    }

    /// Ends a drag on the list. With `cancelled`, a dragged surface stays at its old place. A click
    /// on a formula edits it.
    pub(super) fn release_surface(&mut self, cancelled: bool, moved: bool) {
        match self.surfaces.held.take() {
            Some(ListDrag::Row(index, _)) if !moved && !cancelled => self.edit_formula(index),
            Some(ListDrag::Row(from, to)) if from != to && !cancelled => {
                self.move_surface(from, to);
            }
            Some(ListDrag::Opacity(_)) => self.ask_for_opacity(),
            Some(ListDrag::Row(..)) | None => {}
        }
    }

    /// Opens a line for one more formula.
    fn begin_formula(&mut self) {
        self.put_line_away();
        self.open_line();
        self.goal = LineGoal::Add;
    }

    /// Opens the formula with this index in the line.
    fn edit_formula(&mut self, index: usize) {
        let Some(formula) = self.session.live.formula(index + 1) else {
            return self.say("this text has no formula of its own that can be edited here");
        };
        self.put_line_away();
        self.open_line().insert_text(&formula);
        self.goal = LineGoal::Edit(index);
        self.follow_typing();
    }

    /// Hides or shows the surface or curve with this index.
    pub(super) fn toggle_surface(&mut self, index: usize) {
        let Some(surface) = self.surfaces.all.get(index) else {
            return self.say(&format!("there is no drawing {}", index + 1));
        };
        let result = self.session.live.hide(index + 1, !surface.hidden);
        self.show_result(result);
    }

    fn move_surface(&mut self, from: usize, to: usize) {
        let result = self.session.live.move_surface(from + 1, to + 1);
        self.show_result(result);
    }

    /// Deletes a surface on another thread, since checking the remaining formulas takes time.
    fn delete_surface(&mut self, index: usize) {
        self.send(format!(":delete {}", index + 1), LineGoal::Replace);
    }

    /// Handles a key for the surface under the pointer, and returns whether it had an effect.
    pub(super) fn change_surface(&mut self, key: Key) -> bool {
        let Some((index, _)) = self.surfaces.hovered else { return false };
        let Some(surface) = self.surfaces.all.get(index) else { return false };
        let (opacity, last) = (surface.opacity, self.surfaces.surface_count.saturating_sub(1));
        match key {
            _ if index > last && key != Key::Delete => return false,
            Key::Left => self.surfaces.want(index, opacity - STEP),
            Key::Right => self.surfaces.want(index, opacity + STEP),
            Key::Up if self.is_shifted() && index > 0 => self.move_surface(index, index - 1),
            Key::Down if self.is_shifted() && index < last => self.move_surface(index, index + 1),
            Key::Delete => self.delete_surface(index),
            _ => return false,
        }
        true
    }

    /// If the pointer is over the list and some rows are not visible, scrolls it and returns true.
    pub(super) fn scroll_surfaces(&mut self, steps: f64) -> bool {
        let surfaces = &mut self.surfaces;
        let list = surfaces.list.filter(|_| surfaces.hovered.is_some());
        list.is_some_and(|list| list.rows.scroll(&mut surfaces.scroll, steps))
    }

    /// Requests the opacity that the user chose, if a request is due.
    pub(super) fn send_opacity(&mut self, seen: &Snapshot) {
        if is_next_due(self.surfaces.sent, seen) {
            self.ask_for_opacity();
        }
    }

    fn ask_for_opacity(&mut self) {
        let Some((index, opacity)) = self.surfaces.opacity.take() else { return };
        self.active = Instant::now();
        let result = self.session.live.set_opacity(index + 1, opacity);
        self.surfaces.sent = Some((self.session.live.revision(), Instant::now()));
        self.show_result(result);
    }

    /// Shows why a change was refused.
    fn show_result(&mut self, result: Result<(), zeroset_live::Refusal>) {
        self.session.report_in_window();
        match result {
            Ok(()) => self.message = None,
            Err(refusal) => self.say(&refusal.to_string()),
        }
    }
}
