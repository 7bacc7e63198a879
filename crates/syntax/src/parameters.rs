//! Which names are parameters, sliders and time, and what values they have.

use crate::ast::Definition;
use crate::constant;
use crate::document::{Parameter, ParameterKind, Reader};
use crate::error::{Error, ErrorKind, Fallible, Origin};
use crate::limits::Limits;
use crate::lower::Meaning;
use crate::note::{Note, NoteKind};
use crate::scope::nearest;
use crate::span::Span;
use crate::spelling::is_definable;
use crate::statement::{Built, is_plain_number};
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_interval::Interval;
use zeroset_ir::Constant;

/// A parameter before it has a number.
struct Slider {
    value: Constant,
    range: Option<(Constant, Constant)>,
    span: Option<Span>,
}

impl<'a> Reader<'a> {
    /// The values of the overrides, by name; errors are kept.
    pub(crate) fn overrides(
        &mut self,
        definitions: &[(&Definition, &Built)],
        used: &FxHashSet<&str>,
    ) -> FxHashMap<&'a str, Constant> {
        let mut values = FxHashMap::default();
        for (name, value) in self.options.overrides {
            let given = format!("{name}={value}");
            let span = Span::new(0, name.len());
            let defined = definitions.iter().find(|(d, _)| d.name.text == *name);
            let error = if !is_definable(name) {
                Some(ErrorKind::OverrideNotAName { name: name.clone() })
            } else if matches!(name.as_str(), "x" | "y" | "z") {
                Some(ErrorKind::OverrideCoordinate { name: name.clone() })
            } else if defined.is_some_and(|(d, _)| d.parameters.is_some()) {
                Some(ErrorKind::OverrideFunction { name: name.clone() })
            } else if defined.is_none() && !used.contains(name.as_str()) {
                Some(ErrorKind::UnknownOverride { name: name.clone() })
            } else {
                None
            };
            let result = match error {
                Some(kind) => {
                    let mut error = Error::new(span, kind);
                    if matches!(error.kind, ErrorKind::UnknownOverride { .. }) {
                        let known = definitions.iter().map(|(d, _)| d.name.text.as_str());
                        let known = known.chain(used.iter().copied()).filter(|n| n != name);
                        if let Some(meant) = nearest(name, known) {
                            error = error.suggest(span, meant);
                        }
                    }
                    Err(error)
                }
                None => {
                    constant::evaluate_text(value, &self.options.limits).map_err(|mut error| {
                        let shift = name.len() + 1;
                        let moved = |span: Span| Span::new(span.start + shift, span.end + shift);
                        error.span = moved(error.span);
                        if let Some(suggestion) = &mut error.suggestion {
                            suggestion.span = moved(suggestion.span);
                        }
                        error
                    })
                }
            };
            match result {
                Ok(value) => {
                    values.insert(name.as_str(), value);
                }
                Err(mut error) => {
                    error.origin = Origin::Override(given);
                    self.errors.push(*error);
                }
            }
        }
        values
    }

    /// What every defined name means, and the parameters among them; errors are kept.
    pub(crate) fn parameters<'d>(
        &mut self,
        definitions: &[(&'d Definition, &Built)],
        overrides: &FxHashMap<&'d str, Constant>,
        drawings: &[&Built],
    ) -> (FxHashMap<&'d str, Meaning<'d>>, Vec<Parameter>)
    where
        'a: 'd,
    {
        let mut names = FxHashMap::default();
        let mut parameters: Vec<Parameter> = Vec::new();
        let mut add = |name: &str, kind, slider: Slider| {
            let number = parameters.len() as u32;
            parameters.push(Parameter {
                name: name.to_owned(),
                number,
                value: slider.value,
                range: slider.range,
                kind,
                span: slider.span,
            });
            number
        };
        let mut time_set = false;
        for (definition, _) in definitions {
            let name = definition.name.text.as_str();
            let is_time = name == "t";
            let given = overrides.get(name).cloned();
            let is_slider = definition.parameters.is_none()
                && (is_time
                    || definition.range.is_some()
                    || given.is_some()
                    || is_plain_number(&definition.body));
            if !is_slider {
                if let (Some(_), Some((low, high))) = (&definition.parameters, &definition.range) {
                    let span = low.span.to(high.span);
                    self.errors.push(*Error::new(span, ErrorKind::RangeOutsideDefinition));
                }
                names.insert(name, Meaning::Definition(definition));
                continue;
            }
            match slider(definition, given, &self.options.limits) {
                Ok(mut slider) => {
                    let kind = if is_time { ParameterKind::Time } else { ParameterKind::Slider };
                    if let (true, Some(time)) =
                        (is_time, self.options.time.and_then(Interval::point))
                    {
                        slider.value = Constant::enclosed(time);
                    }
                    time_set |= is_time;
                    if let Some((low, high)) = &slider.range
                        && (slider.value.bounds().hi < low.bounds().lo
                            || high.bounds().hi < slider.value.bounds().lo)
                    {
                        let kind = NoteKind::OutsideRange { name: name.to_owned() };
                        self.notes.push(Note { span: definition.name.span, kind });
                    }
                    let number = add(name, kind, slider);
                    if !is_time {
                        names.insert(name, Meaning::Parameter(number));
                    }
                }
                Err(error) => self.errors.push(*error),
            }
        }
        for (name, _) in self.options.overrides {
            let name = name.as_str();
            let Some(value) = overrides.get(name) else {
                continue;
            };
            if name != "t" && !names.contains_key(name) {
                let slider = Slider { value: value.clone(), range: None, span: None };
                let number = add(name, ParameterKind::Slider, slider);
                names.insert(name, Meaning::Parameter(number));
            }
        }
        let uses_time = drawings.iter().any(|b| b.used.contains("t"))
            || definitions.iter().any(|(_, b)| b.used.contains("t"));
        if !time_set && (uses_time || overrides.contains_key("t")) {
            let value = self
                .options
                .time
                .and_then(Interval::point)
                .map(Constant::enclosed)
                .or_else(|| overrides.get("t").cloned())
                .unwrap_or_else(|| Constant::integer(0));
            let slider = Slider { value, range: None, span: None };
            add("t", ParameterKind::Time, slider);
        }
        (names, parameters)
    }
}

/// The value and range of a slider's definition.
fn slider(definition: &Definition, given: Option<Constant>, limits: &Limits) -> Fallible<Slider> {
    let is_given = given.is_some();
    let value = match given {
        Some(value) => value,
        None => constant::evaluate(&definition.body, limits)?,
    };
    let range = match &definition.range {
        None => None,
        Some((low, high)) => {
            let span = low.span.to(high.span);
            let (low, high) = (constant::evaluate(low, limits)?, constant::evaluate(high, limits)?);
            if low.bounds().lo >= high.bounds().hi {
                return Err(Error::new(span, ErrorKind::EmptyRange));
            }
            let outside =
                value.bounds().hi < low.bounds().lo || high.bounds().hi < value.bounds().lo;
            if outside && !is_given {
                return Err(Error::new(definition.body.span, ErrorKind::OutsideRange));
            }
            Some((low, high))
        }
    };
    Ok(Slider { value, range, span: Some(definition.name.span) })
}
