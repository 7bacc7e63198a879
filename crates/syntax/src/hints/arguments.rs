//! Hints on calls with too few arguments, or with arguments in another order.

use super::pattern::{Call, calls};
use super::{Mistake, Proposal};
use zeroset_parser::ErrorKind;

pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let is_of_call = matches!(
        mistake.kind,
        ErrorKind::WrongCount { .. }
            | ErrorKind::BuilderArgument { .. }
            | ErrorKind::FormUsage { .. }
            | ErrorKind::NumberInSequence { .. }
            | ErrorKind::NotAVariable { .. }
            | ErrorKind::WhichVariable
            | ErrorKind::RangeNotWhole
    );
    if !is_of_call {
        return Vec::new();
    }
    // The innermost call around the error.
    let around = |call: &Call<'_>| {
        call.range.start <= mistake.place.start && mistake.place.end <= call.range.end
    };
    let all = calls(mistake.line);
    let Some(call) = all.iter().rfind(|call| around(call)) else { return Vec::new() };
    let mut proposals = Vec::new();
    // Rounds a number that must be whole.
    let whole = mistake.typed().parse::<f64>().ok().filter(|number| number.fract() != 0.0);
    proposals.extend(whole.map(|number| {
        let number = number.ceil().max(1.0).to_string();
        let line = mistake.replaced(mistake.place.clone(), &number);
        Proposal::new("the number must be whole", line)
    }));
    if let ErrorKind::RangeNotWhole = mistake.kind {
        let line = mistake.replaced(mistake.place.clone(), "5");
        proposals.push(Proposal::new("the ends of a sum are constant whole numbers", line));
    }
    let mut add = |why: &str, arguments: &[&str]| {
        let other = format!("{}({})", call.name, arguments.join(", "));
        proposals.push(Proposal::new(why, mistake.replaced(call.range.clone(), &other)));
    };
    let given = call.arguments.as_slice();
    if let Some(decimal) = with_points(call) {
        let arguments: Vec<&str> = decimal.iter().map(String::as_str).collect();
        add("a decimal number has a decimal point", &arguments);
    }
    for swapped in orders(given) {
        add("the arguments stand in another order", &swapped);
    }
    let axes = [("x", "(1, 0, 0)"), ("y", "(0, 1, 0)"), ("z", "(0, 0, 1)")];
    let with_vectors: Vec<&str> = given
        .iter()
        .map(|one| axes.iter().find(|(axis, _)| axis == one).map_or(*one, |(_, vector)| vector))
        .collect();
    add("an axis is a vector", &with_vectors);
    let is_padded = call.name != "repeat";
    if is_padded && given.last().is_some_and(|last| last.parse::<f64>().is_ok()) {
        add("a vector has three components", &[given, &["0", "0"]].concat());
    }
    let examples =
        usages(call.name).into_iter().flat_map(calls).filter(|one| one.name == call.name);
    let examples: Vec<Vec<&str>> = examples.map(|one| one.arguments).collect();
    for example in examples.iter().filter(|example| example.len() > given.len()) {
        add("an argument is missing", &[given, &example[given.len()..]].concat());
        for (at, value) in example.iter().enumerate().take(given.len()) {
            let mut filled = given.to_vec();
            filled.insert(at, value);
            add("an argument is missing", &filled);
        }
    }
    for example in examples.iter().filter(|example| example.len() <= given.len()) {
        add("there are too many arguments", &given[..example.len()]);
    }
    if given.is_empty() {
        add("the argument stands in the brackets", &["x"]);
        add("the arguments stand in the brackets", &["x", "y"]);
    } else if examples.is_empty() {
        for count in (1..given.len()).rev() {
            add("there are too many arguments", &given[..count]);
        }
    }
    // Another line with other numbers is no correction.
    let has_numbers = given.iter().any(|one| one.contains(|c: char| c.is_ascii_digit()));
    for example in examples.iter().filter(|_| !has_numbers) {
        add("the arguments are others", example);
    }
    proposals
}

/// Arguments such as `3,0,5` with the commas before or behind a 0 as decimal points: `3, 0.5`.
fn with_points(call: &Call<'_>) -> Option<Vec<String>> {
    let is_digits = |one: &&str| !one.is_empty() && one.bytes().all(|c| c.is_ascii_digit());
    let given = &call.arguments;
    if !given.contains(&"0") || !given.iter().all(is_digits) {
        return None;
    }
    // A number that ends with a decimal comma goes on with the next argument.
    let starts = |at: usize| given[at] == "0" || given.len() == 4 && at.is_multiple_of(2);
    let mut all = Vec::new();
    let mut at = 0;
    while at < given.len() {
        if starts(at) && at + 1 < given.len() {
            all.push(format!("{}.{}", given[at], given[at + 1]));
            at += 2;
        } else {
            all.push(given[at].to_owned());
            at += 1;
        }
    }
    Some(all)
}

/// Other orders of two to four arguments.
fn orders<'a>(given: &[&'a str]) -> Vec<Vec<&'a str>> {
    match *given {
        [a, b] => vec![vec![b, a]],
        [a, b, c] => vec![vec![b, a, c], vec![b, c, a], vec![c, a, b], vec![a, c, b]],
        [a, b, c, d] => vec![vec![d, a, b, c], vec![b, c, d, a]],
        _ => Vec::new(),
    }
}

/// Examples of the calls of a function.
fn usages(name: &str) -> Vec<&'static str> {
    let builders = zeroset_ops::builders(name).map(|row| row.usage);
    builders.chain(zeroset_ops::form(name).map(|form| form.usage)).collect()
}
