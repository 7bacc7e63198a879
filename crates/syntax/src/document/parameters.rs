//! Decides which names are parameters, and computes the parameters' values.

use crate::document::reading::{DocumentReader, Parameter, ParameterKind};
use crate::lower::constant::{evaluate, evaluate_range, evaluate_text};
use crate::lower::lowering::NameBinding;
use crate::picture::scene::ConstantRange;
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_parser::lex::spelling::is_definable;
use zeroset_parser::tree::ast::Definition;
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::scope::{coordinate, nearest};
use zeroset_parser::tree::statement::is_plain_number;
use zeroset_parser::tree::whole_numbers::term_count_names;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, NoteKind, Origin, Span};

impl<'a> DocumentReader<'a> {
    /// Evaluates the overrides. Returns their values by name, and records errors.
    pub(crate) fn overrides(
        &mut self,
        definitions: &[(&Definition, &BuiltStatement)],
        used: &FxHashSet<&str>,
    ) -> FxHashMap<&'a str, Constant> {
        let mut values = FxHashMap::default();
        for (name, value) in self.options.overrides {
            match override_value(name, value, definitions, used, &self.options.limits) {
                Ok(value) => {
                    values.insert(name.as_str(), value);
                }
                Err(mut error) => {
                    error.origin = Origin::Override(format!("{name}={value}"));
                    self.errors.push(*error);
                }
            }
        }
        values
    }

    /// Binds every defined name, collects the parameters and records errors. Time is a parameter if
    /// the text defines `t`, a formula uses `t`, an override sets `t`, or `is_timed` is true.
    pub(crate) fn parameters<'d>(
        &mut self,
        definitions: &[(&'d Definition, &BuiltStatement)],
        overrides: &FxHashMap<&'d str, Constant>,
        drawings: &[&BuiltStatement],
        is_timed: bool,
    ) -> (FxHashMap<&'d str, NameBinding<'d>>, Vec<Parameter>)
    where
        'a: 'd,
    {
        let time = self.options.time.and_then(Interval::point).map(Constant::enclosed);
        let mut names = FxHashMap::default();
        let mut parameters: Vec<Parameter> = Vec::new();
        let mut add = |name: &str, value, range, span| {
            let number = parameters.len() as u32;
            let kind = if name == "t" { ParameterKind::Time } else { ParameterKind::Slider };
            let name = name.to_owned();
            parameters.push(Parameter { name, number, value, range, kind, span });
            NameBinding::Parameter(number)
        };
        let term_count_names = term_count_names(definitions, drawings);
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
                names.insert(name, NameBinding::Definition(definition));
                continue;
            }
            if term_count_names.contains(name) && !is_time && definition.range.is_none() {
                let limits = &self.options.limits;
                let value = given.map_or_else(|| evaluate(&definition.body, limits), Ok);
                let Some(value) = self.ok_or_record(value) else { continue };
                names.insert(name, NameBinding::Number(value));
                let kind = NoteKind::CountsTerms { name: name.to_owned() };
                self.notes.push(Note { span: definition.name.span, kind });
                continue;
            }
            let slider = self.ok_or_record(slider(definition, given, &self.options.limits));
            let Some((mut value, range)) = slider else { continue };
            let span = definition.name.span;
            if let (true, Some(time)) = (is_time, &time) {
                value = time.clone();
            }
            if range.as_ref().is_some_and(|range| is_outside(&value, range)) {
                let kind = NoteKind::OutsideRange { name: name.to_owned() };
                self.notes.push(Note { span, kind });
            }
            let parameter = add(name, value, range, Some(span));
            if is_time {
                time_set = true;
            } else {
                names.insert(name, parameter);
            }
        }
        for (name, _) in self.options.overrides {
            let name = name.as_str();
            if let Some(value) = overrides.get(name)
                && name != "t"
                && !names.contains_key(name)
            {
                let binding = if term_count_names.contains(name) {
                    NameBinding::Number(value.clone())
                } else {
                    add(name, value.clone(), None, None)
                };
                names.insert(name, binding);
            }
        }
        let mut built = drawings.iter().copied().chain(definitions.iter().map(|(_, built)| *built));
        let given = overrides.get("t").cloned();
        if !time_set && (given.is_some() || is_timed || built.any(|built| built.used.contains("t")))
        {
            add("t", time.or(given).unwrap_or_else(|| Constant::integer(0)), None, None);
        }
        (names, parameters)
    }
}

/// The constant that an override gives to `name`. `value` is the override's text.
fn override_value(
    name: &str,
    value: &str,
    definitions: &[(&Definition, &BuiltStatement)],
    used: &FxHashSet<&str>,
    limits: &Limits,
) -> Fallible<Constant> {
    let span = Span::new(0, name.len());
    let defined = definitions.iter().find(|(definition, _)| definition.name.text == name);
    let given = name.to_owned();
    let kind = if !is_definable(name) {
        ErrorKind::OverrideNotAName { name: given }
    } else if coordinate(name).is_some() {
        ErrorKind::OverrideCoordinate { name: given }
    } else if defined.is_some_and(|(definition, _)| definition.parameters.is_some()) {
        ErrorKind::OverrideFunction { name: given }
    } else if defined.is_none() && !used.contains(name) {
        let known = definitions.iter().map(|(definition, _)| definition.name.text.as_str());
        let meant = nearest(name, known.chain(used.iter().copied()));
        let error = Error::new(span, ErrorKind::UnknownOverride { name: given });
        return Err(error.suggest_optional(span, meant));
    } else {
        // A message shows `name=value`, so places in the value move by the length of `name=`.
        let moved = |place: Span| Span::new(place.start + span.end + 1, place.end + span.end + 1);
        return evaluate_text(value, limits).map_err(|mut error| {
            error.span = moved(error.span);
            if let Some(suggestion) = &mut error.suggestion {
                suggestion.span = moved(suggestion.span);
            }
            error
        });
    };
    Err(Error::new(span, kind))
}

/// The value and the range of a slider. `given` is the value from an override, if there is one.
fn slider(
    definition: &Definition,
    given: Option<Constant>,
    limits: &Limits,
) -> Fallible<(Constant, Option<ConstantRange>)> {
    let is_given = given.is_some();
    let value = given.map_or_else(|| evaluate(&definition.body, limits), Ok)?;
    let Some((low, high)) = &definition.range else {
        return Ok((value, None));
    };
    let range = evaluate_range(low, high, low.span.to(high.span), limits)?;
    if !is_given && is_outside(&value, &range) {
        return Err(Error::new(definition.body.span, ErrorKind::OutsideRange));
    }
    Ok((value, Some(range)))
}

/// Returns whether a value certainly lies outside the range from `low` to `high`.
fn is_outside(value: &Constant, (low, high): &ConstantRange) -> bool {
    value.bounds().hi < low.bounds().lo || high.bounds().hi < value.bounds().lo
}
