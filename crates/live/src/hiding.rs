//! Hides and shows surfaces, curves and points by `hidden` lines in the document's text.

use super::edit::{Edit, base};
use super::pipeline::Request;
use super::reply::{Refusal, no_such, refused};
use super::session::Live;
use super::surfaces::whole;
use std::ops::Range;
use zeroset_syntax::{Document, Options};

/// The place and the state of each drawing: the surfaces, then the curves and points.
fn drawings(document: &Document) -> Vec<(Range<usize>, bool)> {
    let surfaces = document.drawn_surfaces().map(|one| (one.span.range(), one.hidden));
    let curves = document.curves.all.iter().map(|one| (one.span.range(), one.hidden));
    surfaces.chain(curves).collect()
}

/// The text with other `hidden` lines, after `change` is applied to the drawings' states. `None` if
/// lines cannot express the change, as within a program.
fn changed(
    text: &str,
    options: &Options<'_>,
    change: impl FnOnce(&mut [bool]),
) -> Option<(String, Document)> {
    let document = zeroset_syntax::read(text, options).ok()?;
    let (places, mut states): (Vec<_>, Vec<bool>) = drawings(&document).into_iter().unzip();
    change(&mut states);
    let mut edits: Vec<(Range<usize>, &str)> = Vec::new();
    for line in document.lines.iter().filter(|line| line.word == "hidden") {
        edits.push((whole(text, &line.span.range()), ""));
    }
    let mut in_order: Vec<_> = places.iter().zip(&states).collect();
    in_order.sort_by_key(|(place, _)| place.start);
    let mut above = false;
    for (place, &is_hidden) in in_order {
        if is_hidden != above {
            let head = text[..place.start].trim_end_matches([' ', '\t']);
            let line = match (is_hidden, head.is_empty() || head.ends_with('\n')) {
                (true, true) => "hidden\n",
                (true, false) => "hidden; ",
                (false, true) => "hidden off\n",
                (false, false) => "hidden off; ",
            };
            edits.push((place.start..place.start, line));
        }
        above = is_hidden;
    }
    edits.sort_by_key(|(range, _)| (range.start, range.end));
    let mut new = text.to_owned();
    for (range, with) in edits.into_iter().rev() {
        new.replace_range(range, with);
    }
    let is_meant = |now: &Document| {
        let all = drawings(now);
        let pairs = || places.iter().zip(&states).zip(&all);
        all.len() == states.len()
            && pairs().all(|((old, state), (place, now))| {
                state == now && text[old.clone()] == new[place.clone()]
            })
    };
    let read = zeroset_syntax::read(&new, options).ok().filter(is_meant)?;
    Some((new, read))
}

impl Live {
    /// Hides or shows a surface, a curve or a point. Numbers count from 1; the curves and points
    /// come after the surfaces.
    ///
    /// # Errors
    /// If there is no such drawing, or no line can express the change.
    pub fn hide(&self, number: usize, hidden: bool) -> Result<(), Refusal> {
        self.change_hidden(number, |states| states[number - 1] = hidden)
    }

    /// Shows all drawings.
    ///
    /// # Errors
    /// If no line can express the change.
    pub(super) fn show_all(&self) -> Result<(), Refusal> {
        self.change_hidden(1, |states| states.fill(false))
    }

    /// Changes which drawings are hidden, and writes that to the text. Refused unless there is a
    /// drawing with this number.
    fn change_hidden(&self, number: usize, change: impl Fn(&mut [bool])) -> Result<(), Refusal> {
        let work = |request: &Request, readable: &str| {
            let base = base(request, readable, "");
            let options = request.options();
            let read = zeroset_syntax::read(&base, &options);
            let count = read.map_or(0, |now| drawings(&now).len());
            if !(1..=count).contains(&number) {
                return Err(no_such("drawing", number, count));
            }
            match changed(&base, &options, &change) {
                // The formulas are unchanged, so they are not checked again.
                Some((text, document)) => Ok(Edit::unchecked(text, document)),
                None => refused(
                    "this text has no place for that: write `hidden` lines yourself".to_owned(),
                ),
            }
        };
        self.edit(None, work).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hidden(text: &str, number: usize, hidden: bool) -> String {
        let edited = changed(text, &Options::default(), |states| states[number] = hidden);
        edited.map(|(text, _)| text).expect(text)
    }

    #[test]
    fn a_surface_is_hidden_and_shown_by_lines_of_its_own() {
        for (text, number, expected) in [
            ("x = 1", 0, "hidden\nx = 1"),
            ("x = 1\ny = 1\nz = 1", 1, "x = 1\nhidden\ny = 1\nhidden off\nz = 1"),
            ("# A\nx = 1; y = 1 # two", 1, "# A\nx = 1; hidden; y = 1 # two"),
            ("hidden # why\nx = 1\nhidden off\ny = 1", 1, "# why\nhidden\nx = 1\ny = 1"),
        ] {
            let new = hidden(text, number, true);
            assert_eq!(new, expected, "{text}");
            let shown = hidden(&new, number, false);
            let document = zeroset_syntax::read(&shown, &Options::default()).expect("reads");
            assert!(!document.surfaces[number].hidden, "{shown}");
        }
        let text = "x = 1\n y = 1 {x < 1}\nz = 1";
        assert_eq!(hidden(&hidden(text, 1, true), 1, false), text);
    }

    #[test]
    fn curves_and_points_are_hidden_and_shown() {
        let text = "(1, 2, 0)\nz = x\n(cos(t), sin(t), t)";
        for (number, expected) in [
            (0, "(1, 2, 0)\nhidden\nz = x\nhidden off\n(cos(t), sin(t), t)"),
            (1, "hidden\n(1, 2, 0)\nhidden off\nz = x\n(cos(t), sin(t), t)"),
            (2, "(1, 2, 0)\nz = x\nhidden\n(cos(t), sin(t), t)"),
        ] {
            let new = hidden(text, number, true);
            assert_eq!(new, expected);
            assert_eq!(hidden(&new, number, false), text);
        }
    }

    #[test]
    fn a_statement_of_a_program_has_no_place_for_a_line() {
        let text = "float d = length(p) - 1.;";
        assert!(changed(text, &Options::default(), |states| states.fill(true)).is_none());
    }
}
