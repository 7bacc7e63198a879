//! A text and the document read from it, with the values of its parameters.

use crate::error::{Diagnostic, Error};
use std::ops::RangeInclusive;
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_scene::number::nearest;
use zeroset_syntax::{Document, Options};

/// A named number that can be set without reading the text again. Examples are `r = 2`, the slider
/// `r = 2 in [0, 5]`, and the time `t`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Name of the parameter.
    pub name: String,
    /// The parameter's value, as the nearest `f64`.
    pub value: f64,
    /// The range in the text, with ends as the nearest `f64`s. One kernel serves the whole range. A
    /// value outside the range needs a new kernel.
    pub range: Option<RangeInclusive<f64>>,
}

pub(crate) struct Text {
    text: String,
    pub document: Document,
}

impl Text {
    pub fn read(text: &str) -> Result<Self, Error> {
        match zeroset_syntax::read(text, &Options::default()) {
            Ok(document) => Ok(Self { text: text.to_owned(), document }),
            Err(errors) => Err(Error::syntax(&errors, text)),
        }
    }

    pub fn notes(&self) -> Vec<Diagnostic> {
        self.document.notes.iter().map(|note| Diagnostic::note(note, &self.text)).collect()
    }

    pub fn parameters(&self) -> Vec<Parameter> {
        let parameter = |parameter: &zeroset_syntax::Parameter| Parameter {
            name: parameter.name.clone(),
            value: nearest(&parameter.value),
            range: parameter.range.as_ref().map(|(low, high)| nearest(low)..=nearest(high)),
        };
        self.document.parameters.iter().map(parameter).collect()
    }

    /// Reads an expression with the names of the text, and the values that its parameters have now.
    pub fn expression(&self, expression: &str) -> Result<Document, Error> {
        let read = zeroset_syntax::read_expression(&self.text, expression, &Options::default());
        let mut document = read.map_err(|errors| Error::syntax(&errors, expression))?;
        for parameter in &mut document.parameters {
            let own = |one: &&zeroset_syntax::Parameter| one.name == parameter.name;
            if let Some(own) = self.document.parameters.iter().find(own) {
                parameter.value = own.value.clone();
            }
        }
        Ok(document)
    }

    /// Returns the document with the parameter `name` set to exactly `value`.
    pub fn with(&self, name: &str, value: f64) -> Result<Document, Error> {
        let point = Interval::point(value)
            .ok_or_else(|| Error::argument(format!("`{name}` is set to {value}: not a number")))?;
        let mut document = self.document.clone();
        if let Some(found) = document.parameters.iter_mut().find(|one| one.name == name) {
            found.value = Constant::enclosed(point);
            return Ok(document);
        }
        let names = document.parameters.iter().map(|one| format!("`{}`", one.name));
        let names = names.collect::<Vec<_>>().join(", ");
        let known = if names.is_empty() { "there is none" } else { names.as_str() };
        Err(Error::argument(format!("`{name}` is not a parameter of the text: {known}")))
    }
}
