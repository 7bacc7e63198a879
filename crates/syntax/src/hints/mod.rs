//! Hints that say what to write: each is a whole line, and the line has been read.
//!
//! For an error, tables and a few functions propose corrected lines. Each is read together with the
//! rest of the text. The first one without an error becomes the advice. So a hint never leads to
//! the next error.
//! Nothing here changes how a text is read.

mod arguments;
mod curves;
mod lines;
mod notations;
mod numbers;
mod pattern;
mod solids;
mod values;
mod words;

pub(crate) use pattern::renamed;

use crate::document::reading::{self, Document, Options};
use std::ops::Range;
use zeroset_parser::{Error, ErrorKind, Errors, Limits, Span, Suggestion};

/// Largest size of a text that gets hints, in bytes.
const MOST_TEXT: usize = 2000;
/// Largest number of errors that get hints.
const MOST_ERRORS: usize = 3;
/// Largest number of nodes of a corrected text.
const MOST_NODES: usize = 20_000;
/// Largest number of lines that are tried for an error.
const MOST_TRIED: usize = 40;

/// A proposed correction.
pub(crate) struct Proposal {
    /// The reason, as a phrase that ends before a colon; empty if the line speaks for itself.
    pub why: String,
    /// The text to write in place of the statement, in one or more lines.
    pub line: String,
    /// True if `line` takes the place of the whole text.
    is_text: bool,
}

impl Proposal {
    /// A correction of the whole text.
    fn text(why: impl Into<String>, text: impl Into<String>) -> Self {
        Self { is_text: true, ..Self::new(why, text) }
    }

    /// A correction of the statement.
    fn new(why: impl Into<String>, line: impl Into<String>) -> Self {
        Self { why: why.into(), line: line.into(), is_text: false }
    }
}

/// An error, and the statement in which it lies.
pub(crate) struct Mistake<'a> {
    pub text: &'a str,
    /// The statement, as it stands in the text.
    pub line: &'a str,
    /// The error's place in the statement.
    pub place: Range<usize>,
    pub kind: &'a ErrorKind,
    pub suggestion: Option<&'a Suggestion>,
}

impl Mistake<'_> {
    /// The text at the error's place.
    pub fn typed(&self) -> &str {
        self.line.get(self.place.clone()).unwrap_or("")
    }

    /// The statement with `replacement` in place of `range`.
    pub fn replaced(&self, range: Range<usize>, replacement: &str) -> String {
        let (before, behind) = (self.line.get(..range.start), self.line.get(range.end..));
        format!("{}{replacement}{}", before.unwrap_or_default(), behind.unwrap_or_default())
    }
}

/// The functions that propose corrections, in the order of their trial.
const SOURCES: [fn(&Mistake<'_>) -> Vec<Proposal>; 8] = [
    solids::proposals,
    notations::proposals,
    words::proposals,
    lines::proposals,
    numbers::proposals,
    curves::proposals,
    arguments::proposals,
    words::misspelled,
];

/// Reads a document: one line or a whole file. An [expression list](crate::is_expression_list) is
/// one solid.
///
/// # Errors
/// Fails if the text or an override has errors. Each statement and each override gives at most one
/// error.
pub fn read(text: &str, options: &Options<'_>) -> Result<Document, Errors> {
    reading::read(text, options).map_err(|errors| advised(text, options, errors))
}

/// Reads a document from bytes that should be UTF-8.
///
/// # Errors
/// Fails with the errors of [`read`], or with one error if the bytes are not UTF-8.
pub fn read_bytes(bytes: &[u8], options: &Options<'_>) -> Result<Document, Errors> {
    match std::str::from_utf8(bytes) {
        Ok(text) => read(text, options),
        Err(error) => {
            let offset = error.valid_up_to();
            Err(Error::new(Span::at(offset), ErrorKind::NotUtf8 { offset }).into())
        }
    }
}

/// Adds advice to the errors for which a corrected line can be read.
fn advised(text: &str, options: &Options<'_>, mut errors: Errors) -> Errors {
    if text.len() > MOST_TEXT {
        return errors;
    }
    let count = errors.iter().count();
    let places: Vec<Span> = errors.iter().map(|error| error.span).collect();
    for (index, place) in places.into_iter().take(MOST_ERRORS).enumerate() {
        let Some(error) = errors.iter().nth(index) else { break };
        let is_decimal = |meant: &Suggestion| meant.replacement == ".";
        if error.suggestion.as_ref().is_some_and(is_decimal) {
            continue;
        }
        let Some(Advice { mut words, line, mends_all }) =
            advice(text, options, place, (error, count))
        else {
            continue;
        };
        // The usual advice on these errors helps beside the corrected line.
        let is_kept = matches!(
            error.kind,
            ErrorKind::WrongCount { .. }
                | ErrorKind::BuilderArgument { .. }
                | ErrorKind::FormUsage { .. }
                | ErrorKind::EquationInCondition
        );
        if let (true, Some(usual)) = (is_kept, error.help(text)) {
            words.extend(["; ", &usual]);
        }
        errors.advise(index, words, line);
        // The other errors follow from this one.
        if mends_all {
            errors.keep_only(index);
            break;
        }
    }
    errors
}

/// Advice on an error.
struct Advice {
    words: String,
    /// The line that it says to write in place of the statement.
    line: Option<String>,
    /// True if the text has no error with that line.
    mends_all: bool,
}

impl Advice {
    /// Advice that gives no line.
    fn without_line(words: String) -> Self {
        Self { words, line: None, mends_all: false }
    }
}

/// The advice on an error at `place`, whose text has `count` errors.
fn advice(
    text: &str,
    options: &Options<'_>,
    place: Span,
    (error, count): (&Error, usize),
) -> Option<Advice> {
    let (kind, suggestion) = (&error.kind, error.suggestion.as_ref());
    let whole = statement(text, place);
    let line = text.get(whole.clone())?;
    let clip = |at: usize| at.clamp(whole.start, whole.end) - whole.start;
    let mistake =
        Mistake { text, line, place: clip(place.start)..clip(place.end), kind, suggestion };
    let absent = match kind {
        ErrorKind::UnknownFunction { name } => words::absent(name),
        _ => None,
    };
    if let Some((why, false)) = absent {
        return Some(Advice::without_line(why.to_owned()));
    }
    if let Some(advice) = lines::unread(&mistake).or_else(|| notations::unread(&mistake)) {
        return Some(Advice::without_line(advice));
    }
    let proposals = SOURCES.iter().flat_map(|source| source(&mistake));
    let proposals = proposals.filter(|proposal| proposal.line != line).take(MOST_TRIED);
    // Reading is cheap only for small formulas.
    let limits = Limits { nodes: options.limits.nodes.min(MOST_NODES), ..options.limits };
    let options = &Options { limits, ..*options };
    for Proposal { why, line, is_text } in proposals {
        let range = if is_text { 0..text.len() } else { whole.clone() };
        let end = range.start + line.len();
        let corrected = format!("{}{line}{}", &text[..range.start], &text[range.end..]);
        let read = reading::read(&corrected, options);
        let mends_all = read.is_ok();
        let is_better = match read {
            Ok(_) => true,
            // A function alone draws nothing, but is right.
            Err(errors) if is_definition(&errors) => true,
            Err(errors) => {
                let is_outside = |error: &Error| !(range.start..=end).contains(&error.span.start);
                errors.iter().count() < count && errors.iter().all(is_outside)
            }
        };
        if is_better {
            // Unchanged lines are not repeated.
            let is_new = |one: &&str| text.lines().all(|other| other.trim() != one.trim());
            let new: Vec<&str> = line.lines().filter(is_new).collect();
            let shown = new.join("` and below it `");
            let shown = shown.trim();
            let words = match why.as_str() {
                "" => format!("write `{shown}`"),
                why if why.ends_with('?') => format!("{why} Write `{shown}`"),
                why => format!("{why}: write `{shown}`"),
            };
            let line = (!is_text).then(|| line.trim().replace('\n', "; "));
            return Some(Advice { words, line, mends_all });
        }
    }
    let values = || values::missing(&mistake, &whole, options);
    let absent = absent.map(|(why, _)| why.to_owned());
    solids::unread(&mistake).or(absent).or_else(values).map(Advice::without_line)
}

/// Returns whether the only error is that the text draws nothing.
fn is_definition(errors: &Errors) -> bool {
    errors.iter().all(|error| matches!(error.kind, ErrorKind::NothingToDraw { .. }))
}

/// The range of the statement around `place`. Semicolons in brackets are parts of it.
pub fn statement(text: &str, place: Span) -> Range<usize> {
    let at = text.floor_char_boundary(place.start.min(text.len()));
    let is_line_end = |c: char| matches!(c, '\n' | '\r');
    let mut start = text[..at].rfind(is_line_end).map_or(0, |end| end + 1);
    let mut end = text[at..].find(is_line_end).map_or(text.len(), |end| at + end);
    let mut depth = 0_i32;
    for (index, sign) in
        text[start..end].char_indices().map(|(index, c)| (start + index, c)).collect::<Vec<_>>()
    {
        match sign {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ';' if depth <= 0 && index < at => start = index + 1,
            ';' | '#' if depth <= 0 => {
                end = index;
                break;
            }
            _ => {}
        }
    }
    let line = &text[start..end.max(start)];
    let blank = line.len() - line.trim_start().len();
    start + blank..start + line.trim_end().len().max(blank)
}
