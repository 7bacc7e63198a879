//! How surfaces are hidden, seen through, moved and taken away by the mouse and the keys.

use super::Window;
use super::list::{List, Part};
use super::sliders::is_next_due;
use crate::cli::canvas::Canvas;
use crate::cli::line_edit::LineEdit;
use minifb::Key;
use std::sync::Arc;
use std::time::Instant;
use zeroset::live::{Listed, Rendering, Snapshot};

/// How far an arrow key moves an opacity.
const STEP: f64 = 0.05;

/// The list of the surfaces that are seen, and what changes them.
#[derive(Default)]
pub struct Surfaces {
    /// Whose they are.
    rendering: Option<Arc<Rendering>>,
    all: Vec<Listed>,
    list: Option<List>,
    /// Whether the list is wanted; if nobody says so, where there is more than one surface.
    wanted: Option<bool>,
    scroll: usize,
    hovered: Option<(usize, Part)>,
    held: Option<Held>,
    /// An opacity that is still to be asked for.
    opacity: Option<(usize, f64)>,
    /// The last request for one, and when it was made.
    sent: Option<(u64, Instant)>,
}

/// What a hand holds.
#[derive(Clone, Copy)]
enum Held {
    /// The opacity of a surface.
    Opacity(usize),
    /// A surface, and the place where it would go.
    Row(usize, usize),
}

/// All that is drawn of the list.
#[derive(Clone, PartialEq)]
pub struct Shown {
    list: List,
    all: Vec<Listed>,
    hovered: Option<(usize, Part)>,
    dragged: Option<(usize, usize)>,
}

impl Shown {
    /// Whether formulas are listed, too.
    pub fn has_formulas(&self) -> bool {
        self.list.has_formulas()
    }

    pub fn draw(&self, canvas: &mut Canvas) {
        self.list.draw(canvas, &self.all, self.hovered, self.dragged);
    }
}

impl Surfaces {
    /// The list as it is to be drawn.
    pub fn shown(&self) -> Option<Shown> {
        let dragged = match self.held {
            Some(Held::Row(from, to)) => Some((from, to)),
            Some(Held::Opacity(_)) | None => None,
        };
        let (list, all, hovered) = (self.list?, self.all.clone(), self.hovered);
        Some(Shown { list, all, hovered, dragged })
    }

    fn want(&mut self, index: usize, opacity: f64) {
        if let Some(surface) = self.all.get_mut(index) {
            surface.opacity = opacity.clamp(0.0, 1.0);
            self.opacity = Some((index, surface.opacity));
        }
    }
}

impl Window {
    /// Takes the surfaces of what is seen.
    pub(super) fn follow_surfaces(&mut self, seen: &Snapshot) {
        let (width, height) = self.picture_size();
        let scale = self.scale_at(self.size().1);
        let taken = self.sliders.width();
        let surfaces = &mut self.surfaces;
        let place = |rendering: &Option<Arc<Rendering>>| rendering.as_ref().map(Arc::as_ptr);
        if place(&surfaces.rendering) != place(&seen.rendering) {
            surfaces.rendering.clone_from(&seen.rendering);
            let mut all = seen.rendering.as_ref().map(|seen| seen.surfaces()).unwrap_or_default();
            if all.len() != surfaces.all.len() {
                (surfaces.held, surfaces.hovered, surfaces.opacity) = (None, None, None);
            }
            // The hand is ahead of the picture.
            if let Some((index, opacity)) = surfaces.opacity {
                all[index].opacity = opacity;
            }
            surfaces.all = all;
        }
        let count = surfaces.all.len();
        let is_wanted = surfaces.wanted.unwrap_or(count > 1);
        let letters = Canvas::new(width, height, Vec::new(), scale);
        surfaces.list = is_wanted
            .then(|| List::new(count, surfaces.scroll, taken, (width, height), &letters))
            .flatten();
    }

    pub(super) fn hover_surface(&mut self, at: Option<(f64, f64)>) {
        let surfaces = &mut self.surfaces;
        if surfaces.held.is_none() {
            surfaces.hovered = surfaces.list.zip(at).and_then(|(list, at)| list.at(at));
        }
    }

    /// Shows the list, or no longer.
    pub(super) fn toggle_list(&mut self) {
        let is_shown = self.surfaces.list.is_some();
        self.surfaces.wanted = Some(!is_shown);
    }

    /// Does what a press of the left button means on the list, and tells whether it is there.
    pub(super) fn press_surface(&mut self, at: (f64, f64)) -> bool {
        let Some((index, part)) = self.surfaces.list.and_then(|list| list.at(at)) else {
            return false;
        };
        match part {
            Part::Swatch => self.toggle_surface(index),
            Part::Formula => self.surfaces.held = Some(Held::Row(index, index)),
            Part::Opacity(opacity) => {
                self.surfaces.held = Some(Held::Opacity(index));
                self.surfaces.want(index, opacity);
            }
            Part::Delete => self.delete_surface(index),
        }
        true
    }

    /// Moves what is held on the list.
    pub(super) fn drag_surface(&mut self, at: (f64, f64)) {
        let surfaces = &mut self.surfaces;
        let Some(list) = surfaces.list else { return };
        match &mut surfaces.held {
            Some(Held::Opacity(index)) => {
                let index = *index;
                surfaces.want(index, list.opacity(at.0));
            }
            Some(Held::Row(_, to)) => *to = list.place(at.1),
            None => {}
        }
    }

    /// Lets go of what is held on the list; if `cancelled`, it goes nowhere.
    pub(super) fn release_surface(&mut self, cancelled: bool) {
        match self.surfaces.held.take() {
            Some(Held::Row(from, to)) if from != to && !cancelled => self.move_surface(from, to),
            Some(Held::Opacity(_)) => self.ask_for_opacity(),
            Some(Held::Row(..)) | None => {}
        }
    }

    /// Hides the surface with this index, or shows it.
    pub(super) fn toggle_surface(&mut self, index: usize) {
        let Some(surface) = self.surfaces.all.get(index) else { return };
        let result = self.session.live.hide(index + 1, !surface.hidden);
        self.told(result);
    }

    fn move_surface(&mut self, from: usize, to: usize) {
        let result = self.session.live.move_surface(from + 1, to + 1);
        self.told(result);
    }

    /// What is left is looked at anew, on another thread.
    fn delete_surface(&mut self, index: usize) {
        let mut line = LineEdit::default();
        format!(":delete {}", index + 1).chars().for_each(|letter| line.insert(letter));
        let _ = self.lines.send(line);
    }

    /// What a key does to the surface under the pointer; tells whether there is one.
    pub(super) fn change_surface(&mut self, key: Key) -> bool {
        let Some((index, _)) = self.surfaces.hovered else { return false };
        let Some(surface) = self.surfaces.all.get(index) else { return false };
        let (opacity, last) = (surface.opacity, self.surfaces.all.len() - 1);
        match key {
            Key::Left => self.surfaces.want(index, opacity - STEP),
            Key::Right => self.surfaces.want(index, opacity + STEP),
            Key::Up if self.is_shifted() && index > 0 => self.move_surface(index, index - 1),
            Key::Down if self.is_shifted() && index < last => self.move_surface(index, index + 1),
            Key::Delete => self.delete_surface(index),
            _ => return false,
        }
        true
    }

    /// Scrolls the list if the pointer is over it and there are more, and tells whether so.
    pub(super) fn scroll_surfaces(&mut self, steps: f64) -> bool {
        let surfaces = &mut self.surfaces;
        let Some(list) = surfaces.list.filter(|list| list.scrolls()) else { return false };
        if surfaces.hovered.is_none() {
            return false;
        }
        let first = list.first;
        surfaces.scroll = if steps > 0.0 { first.saturating_sub(1) } else { first + 1 };
        true
    }

    /// Asks for the opacity that is wanted, if the picture of the one before is there.
    pub(super) fn send_opacity(&mut self, seen: &Snapshot) {
        if self.surfaces.opacity.is_some() && is_next_due(self.surfaces.sent, seen) {
            self.ask_for_opacity();
        }
    }

    fn ask_for_opacity(&mut self) {
        let Some((index, opacity)) = self.surfaces.opacity.take() else { return };
        self.active = Instant::now();
        let result = self.session.live.set_opacity(index + 1, opacity);
        self.surfaces.sent = Some((self.session.live.revision(), Instant::now()));
        self.told(result);
    }

    /// Says why something was refused.
    fn told(&mut self, result: Result<(), zeroset::live::Refusal>) {
        self.session.hush();
        match result {
            Ok(()) => self.message = None,
            Err(refusal) => self.say(&refusal.to_string()),
        }
    }
}
