//! A document with its source, and what the command line reports about it.

use super::arguments::DocumentArgs;
use super::notes;
use super::source::{self, Source};
use anyhow::Result;
use std::time::{Duration, Instant};
use zeroset_parser::Errors;
use zeroset_scene::coordinate::coordinate;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::Region;
use zeroset_syntax::{Document, Options};

/// A document to draw or explain.
pub struct Subject {
    /// The text, and where it came from.
    pub source: Source,
    /// The document read from it.
    pub document: Document,
    /// The choice of the domain.
    pub domain: DomainChoice,
    /// Time that reading took.
    pub parse: Duration,
}

impl Subject {
    /// Finds and reads the text.
    ///
    /// # Errors
    /// If the text is missing or invalid.
    pub fn read(arguments: &DocumentArgs) -> Result<Self> {
        Ok(Self::read_beside(arguments, None)?.0)
    }

    /// Finds and reads the text, and an expression that a flag gives beside it, with the names of
    /// the text. `beside` is the flag and the expression. Prints the notes on the expression.
    ///
    /// # Errors
    /// If the text is missing, or it or the expression is invalid.
    pub fn read_beside(
        arguments: &DocumentArgs,
        beside: Option<(&str, &str)>,
    ) -> Result<(Self, Option<Document>)> {
        let values = &arguments.values;
        let (overrides, time) = (values.overrides()?, values.time()?);
        let used = beside.map_or_else(Vec::new, |(_, text)| zeroset_syntax::names_in(text));
        let options =
            Options { overrides: &overrides, used_beside: &used, time, ..Options::default() };
        let subject = Self::read_by(arguments, |text| zeroset_syntax::read(text, &options))?;
        let mut expression = None;
        if let Some((flag, text)) = beside {
            let read = zeroset_syntax::read_expression(&subject.source.text, text, &options);
            let document = read.map_err(|errors| {
                notes::FormattedError(errors.render(Some(flag), text, notes::colored()))
            })?;
            for note in &document.notes {
                notes::say(&note.render(Some(flag), text, notes::colored()));
            }
            expression = Some(document);
        }
        if !expression.as_ref().is_some_and(view::depends_on_time) {
            note_time(time, &subject.document);
        }
        Ok((subject, expression))
    }

    /// Finds the text, and lets `read` turn it into a document.
    ///
    /// # Errors
    /// If the text is missing or invalid.
    pub fn read_by(
        arguments: &DocumentArgs,
        read: impl FnOnce(&str) -> Result<Document, Errors>,
    ) -> Result<Self> {
        let source = source::find(&arguments.source)?;
        let domain = arguments.values.domain();
        let started = Instant::now();
        let read = read(&source.text);
        let parse = started.elapsed();
        match read {
            Ok(document) => Ok(Self { source, document, domain, parse }),
            Err(errors) => {
                let shown =
                    errors.render(Some(&source.from.to_string()), &source.text, notes::colored());
                Err(notes::FormattedError(shown).into())
            }
        }
    }

    /// Prints the document's notes. A note tells how the parser understood an ambiguous text.
    pub fn show_notes(&self) {
        for note in &self.document.notes {
            let Source { from, text } = &self.source;
            notes::say(&note.render(Some(&from.to_string()), text, notes::colored()));
        }
    }
}

/// Reports that `--time` has no effect, if the flag is given but `document` does not use the time.
pub fn note_time(time: Option<f64>, document: &Document) {
    if time.is_some() && !view::depends_on_time(document) {
        notes::note("--time changes nothing: `t` occurs nowhere in the formula");
    }
}

/// Describes a domain of which some ranges were found automatically, in one line.
pub fn describe_domain(found: &AutoDomain, region: &Region) -> String {
    let (low, high) = (region.low(), region.high());
    let range = |axis: usize| [low[axis], high[axis]].map(coordinate).join("..");
    let [x, y, z] = [0, 1, 2].map(range);
    let shown = if x == y && y == z {
        format!("x, y, z in {x}")
    } else {
        format!("x in {x}, y in {y}, z in {z}")
    };
    format!("{}; domain {shown}", found.describe())
}
