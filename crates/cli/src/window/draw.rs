//! Draws the window: either the gallery, or the picture with texts, sliders and the list of
//! surfaces over it. Draws again only if something changes.

use super::enlarge::enlarge;
use super::page::Page;
use super::panel::PanelContent;
use super::recent::RecentMenu;
use super::tasks::LineGoal;
use super::{MESSAGE_TIME, PAUSE, Window, browser, list};
use crate::help;
use crate::theme::{GROUND, INK};
use anyhow::{Context, Result};
use minifb::MouseMode;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;
use zeroset_live::{Fault, Rendering, Snapshot, Working, defined};
use zeroset_render::overlay::{Canvas, FreeArea, Overlay, Rgb, with_minus};

const PAPER: Rgb = 0x00f4_f4f6;
const DIM: Rgb = 0x00b0_b0bc;
const LINE_GROUND: Rgb = 0x0010_1014;
const SELECTED: Rgb = 0x0030_5890;
const WRONG: Rgb = 0x00d0_3030;
const WRONG_TEXT: Rgb = 0x00ff_9090;

/// Space at the left and right of lines of text, in dots of a letter.
const MARGIN: usize = 6;
/// Says where to type.
const PLACEHOLDER: &str = "type a formula, such as x^2 + y^2 = z";

/// The picture at the window's size, with its axes. It is kept while only the overlays change.
#[derive(Default)]
pub struct Backdrop {
    rendering: Option<Arc<Rendering>>,
    size: (usize, usize),
    scale: f64,
    free: FreeArea,
    pixels: Vec<Rgb>,
}

/// Everything that a window's content depends on.
#[derive(Clone, PartialEq)]
pub struct Content {
    size: (usize, usize),
    /// Address of the visible rendering. It stays valid, since a visible rendering is kept alive.
    rendering: Option<*const Rendering>,
    fault: Option<String>,
    wrong: bool,
    /// The work on a picture that is late.
    working: Option<Working>,
    hover: Option<String>,
    line: Option<LineContent>,
    /// Says the effect of Enter, or where to type if no line is open.
    hint: Option<String>,
    candidates: Option<String>,
    message: Option<String>,
    sliders: Option<PanelContent>,
    surfaces: Option<list::ListContent>,
    gallery: Option<browser::GalleryContent>,
    recent: Option<RecentMenu>,
    help: bool,
    page: Option<Page>,
}

/// The typed line: its text, and the cursor and the selection in bytes.
#[derive(Clone, PartialEq)]
struct LineContent {
    text: String,
    cursor: usize,
    selection: Range<usize>,
}

impl Content {
    /// Returns the message that is shown above the status line and the typed line, with its color.
    fn message_above(&self) -> Option<(&str, Rgb)> {
        let candidates = self.candidates.as_deref().map(|text| (text, DIM));
        let fault = self.fault.as_deref().map(|text| (text, WRONG_TEXT));
        let message = self.message.as_deref().map(|text| (text, INK));
        let hint = self.hint.as_deref().filter(|_| self.line.is_some()).map(|text| (text, DIM));
        candidates.or(fault).or(message).or(hint)
    }
}

/// Layout of the lines of text at the bottom of the window. Lengths are in pixels.
struct Layout {
    margin: usize,
    /// Width between the margins.
    room: usize,
    row: usize,
    /// Top of the status line.
    bottom: i64,
}

impl Window {
    /// Draws the window if its content has changed. Returns whether it was drawn.
    pub(super) fn draw(&mut self, seen: &Snapshot) -> Result<bool> {
        if self.message.as_ref().is_some_and(|(_, since)| since.elapsed() > MESSAGE_TIME) {
            self.message = None;
        }
        self.compared = Instant::now();
        // The title can change while the picture stays, for example when a document is saved.
        self.update_title();
        let content = self.content(seen);
        if self.drawn.as_ref() == Some(&content) {
            return Ok(false);
        }
        self.active = self.compared;
        let (picture, scale) = (self.picture_size(), self.scale_at(content.size.1));
        let left = content.sliders.as_ref().map_or(0, |sliders| sliders.panel.width);
        let right = content.surfaces.as_ref().map_or(picture.0, |surfaces| surfaces.list.left());
        // Legends are at the bottom, since the lists are at the top. The row of the typed line is
        // free of them.
        let bottom = picture.1.saturating_sub(Canvas::line_height_at(scale));
        let free = FreeArea { columns: left..right.max(left), bottom };
        self.backdrop.follow(seen.rendering.as_ref(), picture, content.size, scale, free);
        let canvas = self.compose(&content);
        self.native
            .update_with_buffer(&canvas.pixels, canvas.width, canvas.height)
            .context("the window cannot be drawn to")?;
        self.drawn = Some(content);
        Ok(true)
    }

    fn content(&mut self, seen: &Snapshot) -> Content {
        let gallery = self.gallery_content();
        let pick = self.pointer(MouseMode::Discard).and_then(|at| self.pick(at, seen));
        let edited = match self.goal {
            LineGoal::Edit(index) if self.line.is_some() => Some(index),
            _ => None,
        };
        let surfaces = self.surfaces.shown(edited);
        let sliders = self.sliders.shown();
        let of_slider = || Some(sliders.as_ref()?.tip()?.to_owned());
        let tip = surfaces.as_ref().and_then(list::ListContent::tip).or_else(of_slider);
        let rested = self.typed.elapsed() > PAUSE;
        let fault = self.fault(seen);
        Content {
            size: self.size(),
            rendering: seen.rendering.as_ref().map(Arc::as_ptr),
            fault: fault.filter(|_| rested).map(wrong),
            wrong: fault.is_some(),
            working: seen.working,
            hover: tip.or_else(|| Some(with_minus(&pick?.coordinates()?))),
            line: self.line.as_ref().map(|line| LineContent {
                text: line.text().to_owned(),
                cursor: line.cursor(),
                selection: line.selection(),
            }),
            hint: self.hint(),
            candidates: (!self.candidates.is_empty()).then(|| self.candidates.join("  ")),
            message: self.message.as_ref().map(|(text, _)| text.clone()),
            sliders,
            surfaces,
            gallery,
            recent: self.recent.clone(),
            help: self.help,
            page: self.page.clone(),
        }
    }

    /// The position in the typed line, in bytes, at a position in the window. `None` beside the row
    /// of the line. Without a line, the row exists while it says where to type.
    pub(super) fn line_position(&self, (x, y): (f64, f64)) -> Option<usize> {
        let (width, height) = self.picture_size();
        let canvas = Canvas::new(width, height, Vec::new(), self.scale_at(self.size().1));
        let top = height.saturating_sub(canvas.line_height()) as f64;
        if y < top || y >= height as f64 || self.line.is_none() && self.has_typed {
            return None;
        }
        let Some(line) = &self.line else { return Some(0) };
        let margin = canvas.dots(MARGIN);
        let room = width.saturating_sub(2 * margin);
        let (begin, skip) = line_start(&canvas, line.text(), line.cursor(), margin, room);
        let across = (x - begin as f64).max(0.0) as usize + canvas.dots(3);
        Some(skip + canvas.fitting_bytes(&line.text()[skip..], across))
    }

    /// Says what Enter does with the typed line. Without a line, says where to type, until
    /// something was entered.
    fn hint(&self) -> Option<String> {
        let Some(line) = &self.line else {
            return (!self.has_typed).then(|| PLACEHOLDER.to_owned());
        };
        let is_command = line.text().trim_start().starts_with(':');
        let count = self.surfaces.count();
        Some(match self.goal {
            _ if is_command => "Enter: do it   Esc: close".to_owned(),
            LineGoal::Replace if let [name] = &defined(line.text())[..] => {
                format!("Enter: set {name}   Esc: close")
            }
            LineGoal::Replace if count > 1 => {
                format!(
                    "Enter: replace all {count} formulas   Ctrl-Enter: add to them   Esc: close"
                )
            }
            LineGoal::Replace => {
                "Enter: replace the formula   Ctrl-Enter: add one   Esc: close".to_owned()
            }
            LineGoal::Add => "Enter: add the formula   Esc: close".to_owned(),
            LineGoal::Edit(index) => {
                format!("Enter: change formula {}   Ctrl-Enter: add one   Esc: close", index + 1)
            }
        })
    }

    fn compose(&self, content: &Content) -> Canvas {
        let (width, height) = content.size;
        let scale = self.scale_at(height);
        let mut canvas = Canvas::new(width, height, self.backdrop.pixels.clone(), scale);
        if let Some(gallery) = &content.gallery {
            self.draw_gallery(&mut canvas, gallery);
            return canvas;
        }
        let rendering = self.backdrop.rendering.as_ref();
        if content.wrong {
            canvas.border(canvas.dots(2), WRONG);
        }
        let (row, margin) = (canvas.line_height(), canvas.dots(MARGIN));
        let room = width.saturating_sub(2 * margin);
        let layout = Layout { margin, room, row, bottom: height as i64 - row as i64 };
        let listed = content.surfaces.as_ref();
        let are_listed = listed.is_some_and(|shown| shown.list.has_formulas());
        if let Some(rendering) = rendering.filter(|_| !are_listed && content.sliders.is_none()) {
            canvas.label(&canvas.fitting(&echo(rendering), room), 0, 0, INK);
        }
        if let Some(sliders) = &content.sliders {
            sliders.draw(&mut canvas);
        }
        if let Some(shown) = listed {
            shown.draw(&mut canvas);
        }
        draw_status(&mut canvas, &layout, content, rendering);
        draw_texts(&mut canvas, &layout, content);
        if content.help {
            help::draw(&mut canvas);
        }
        if let Some(page) = &content.page {
            page.draw(&mut canvas);
        }
        if let Some(recent) = &content.recent {
            recent.draw(&mut canvas);
        }
        canvas
    }
}

/// Describes a fault with the key that corrects it, if there is one. The advice is in a line of its
/// own.
fn wrong(fault: &Fault) -> String {
    let message = fault.message();
    match (fault.missing_letter(), fault.advice()) {
        (Some(letter), _) => format!("{message}; F2: {letter} = 1"),
        (None, Some(advice)) if fault.correction().is_some() => {
            format!("{message}\nTab: {advice}")
        }
        (None, Some(advice)) => format!("{message}\n{advice}"),
        (None, None) => message,
    }
}

/// Returns the first surface's or curve's formula as it was read, and the number of further ones.
fn echo(rendering: &Rendering) -> String {
    let document = &rendering.document;
    let surfaces = document.drawn_surfaces().map(|surface| surface.echo);
    let mut echoes = surfaces.chain(document.curves.all.iter().map(|curve| curve.echo.as_str()));
    let echo = echoes.next().unwrap_or("");
    match document.drawn_surfaces().count() + document.curves.all.len() {
        0 | 1 => echo.to_owned(),
        more => format!("{echo}  and {} more", more - 1),
    }
}

/// Draws the status at the left, and the point under the pointer or a hint at the right.
fn draw_status(
    canvas: &mut Canvas,
    layout: &Layout,
    content: &Content,
    rendering: Option<&Arc<Rendering>>,
) {
    let Layout { margin, room, row, bottom } = *layout;
    canvas.fill(0, bottom, canvas.width, row, GROUND, 255);
    let status = match (rendering, content.working) {
        (Some(rendering), None) => rendering.in_words(),
        (Some(rendering), Some(working)) => format!("{working} · {}", rendering.in_words()),
        (None, Some(working)) => working.to_string(),
        (None, None) => "nothing is drawn".to_owned(),
    };
    let hover = content.hover.clone().unwrap_or_else(|| "F1 help".to_owned());
    let taken = canvas.text_width(&hover);
    let text_y = bottom + canvas.dots(2) as i64;
    let right = (canvas.width as i64 - margin as i64 - taken as i64).max(0);
    if room >= canvas.text_width(&status) + taken + 2 * margin {
        canvas.write(&hover, right, text_y, DIM);
    } else if content.line.is_none() && content.hint.is_none() && content.message_above().is_none()
    {
        // Both texts do not fit in one line, so the right one gets a line of its own.
        canvas.label(&hover, right, bottom - row as i64, DIM);
    }
    let left = canvas.fitting(&status, room);
    canvas.write(&left, margin as i64, text_y, INK);
}

/// Draws the line that is being typed, and a message above it.
fn draw_texts(canvas: &mut Canvas, layout: &Layout, content: &Content) {
    let Layout { margin, room, row, bottom } = *layout;
    let mut above = bottom - row as i64;
    if let Some(line) = &content.line {
        draw_line(canvas, layout, line, above);
        above -= row as i64;
    } else if let Some(hint) = &content.hint {
        canvas.fill(0, above, canvas.width, row, LINE_GROUND, 240);
        let hint = canvas.fitting(hint, room);
        canvas.write(&hint, margin as i64, above + canvas.dots(2) as i64, DIM);
        above -= row as i64;
    }
    if let Some((text, color)) = content.message_above() {
        for line in text.lines().rev() {
            canvas.label(&canvas.fitting(line, room), 0, above, color);
            above -= row as i64;
        }
    }
}

/// Where the typed line begins: the column of its first visible letter, and that letter's position
/// in bytes.
fn line_start(
    canvas: &Canvas,
    text: &str,
    cursor: usize,
    margin: usize,
    room: usize,
) -> (usize, usize) {
    let begin = margin + canvas.text_width("> ");
    let place = |at: usize| canvas.text_width(&text[..at]);
    let hidden = place(cursor).saturating_sub(room.saturating_sub(begin));
    // Skip whole letters.
    let starts = text.char_indices().map(|(at, _)| at).chain([text.len()]);
    let skip = { starts }.find(|at| place(*at) >= hidden).unwrap_or(0);
    (begin, skip)
}

/// Draws the typed line with its cursor and its selection. A long line is scrolled so that its
/// cursor is visible.
fn draw_line(canvas: &mut Canvas, layout: &Layout, line: &LineContent, top: i64) {
    let Layout { margin, room, row, .. } = *layout;
    let y = top + canvas.dots(2) as i64;
    canvas.fill(0, top, canvas.width, row, LINE_GROUND, 240);
    let (begin, skip) = line_start(canvas, &line.text, line.cursor, margin, room);
    let place = |at: usize| canvas.text_width(&line.text[..at]);
    let left = |at: usize| (begin + place(at.max(skip)) - place(skip)) as i64;
    let (from, to) = (left(line.selection.start), left(line.selection.end));
    let at = left(line.cursor);
    canvas.fill(from, y, (to - from) as usize, canvas.letter_height(), SELECTED, 255);
    canvas.write("> ", margin as i64, y, DIM);
    canvas.write(&line.text[skip..], begin as i64, y, INK);
    canvas.fill(at, y, canvas.dots(2), canvas.letter_height(), INK, 255);
}

impl Backdrop {
    /// Scales the rendering's picture to its part of the window and draws its axes over it. Does
    /// nothing if neither rendering nor size has changed.
    fn follow(
        &mut self,
        rendering: Option<&Arc<Rendering>>,
        picture: (usize, usize),
        window: (usize, usize),
        scale: f64,
        free: FreeArea,
    ) {
        let is_same = self.rendering.as_ref().map(Arc::as_ptr) == rendering.map(Arc::as_ptr);
        let is_there = !self.pixels.is_empty() && self.free == free;
        if is_same && (self.size, self.scale) == (window, scale) && is_there {
            return;
        }
        self.rendering = rendering.cloned();
        (self.size, self.scale, self.free) = (window, scale, free);
        self.pixels.clear();
        self.pixels.resize(window.0 * window.1, PAPER);
        let Some(rendering) = rendering else { return };
        let buffer = &rendering.picture.buffer;
        let shown = rendering.picture.opaque_rgb();
        enlarge(&shown, [buffer.width, buffer.height], &mut self.pixels, [picture.0, picture.1]);
        let axes = rendering.request.axes.are_shown(&rendering.document);
        let pixels = std::mem::take(&mut self.pixels);
        let mut canvas = Canvas::new(window.0, window.1, pixels, scale);
        let around = Overlay::new(axes, &rendering.document);
        around.draw(&mut canvas, (&**rendering).into(), picture.1, Some(&self.free));
        self.pixels = canvas.pixels;
    }
}
