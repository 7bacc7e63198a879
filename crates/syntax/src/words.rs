//! All words of the language and their kinds, for help, completion and highlighting. The words come
//! from the tables that the parser uses. Nothing here knows how words are displayed.

use crate::picture::paint::POINT_NAMES;
use zeroset_ir::NamedConstant;
use zeroset_parser::settings::SETTINGS;
use zeroset_parser::tree::scope::{ROOT_NAMES, meaning};
use zeroset_style::{COLOR_MAPS, LOOKS, VIEWS};

/// Kind of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WordKind {
    /// A function. Its arguments are in brackets.
    Function,
    /// A coordinate, time, or a constant.
    Value,
    /// A word that joins conditions, or the word before a range.
    Operator,
    /// A word that begins a curve or a point.
    Drawing,
    /// A word that begins a line about the picture.
    Setting,
    /// A word that stands inside a line about the picture.
    InSetting,
    /// A word that is used in programs.
    Program,
}

/// Words of programs, each with an example that contains it.
const PROGRAM: &[(&str, &str)] = &[
    ("float", "float map(vec3 p) { return length(p) - 1.; }"),
    ("return", "float map(vec3 p) { return length(p) - 1.; }"),
    ("const", "const float r = 2.; return length(p) - r;"),
    ("else", "float d; if (x < 0.) { d = x; } else { d = y; } return d;"),
    ("for", "float d = z; for (int i = 0; i < 3; i++) { d += x; } return d;"),
    ("while", "float d = z; int i = 0; while (i < 3) { d += x; i++; } return d;"),
    ("def", "def f(x, y, z): return x + y"),
    ("lambda", "f = lambda x, y, z: x + y"),
];

/// Words of the kind [`WordKind::Drawing`], each with an example that contains it.
const DRAWINGS: &[(&str, &str)] =
    &[("curve", "curve x^2 + y^2 = 1, z = x"), ("point", "point (1, 2, 3)")];

/// Words of the kind [`WordKind::Operator`], each with an example that contains it.
const OPERATORS: &[(&str, &str)] = &[
    ("and", "x < 1 and y < 1"),
    ("or", "x < 1 or y < 1"),
    ("not", "not x < 1"),
    ("in", "r = 2 in [0, 5]"),
];

/// Help for coordinates and time.
const VALUES: &[(&str, &str)] = &[
    ("x", "a coordinate"),
    ("y", "a coordinate"),
    ("z", "a coordinate; up"),
    ("t", "time, which `--time`, a slider and the clock set"),
    ("r", "the distance from the z axis, where it is not defined: r = 1 + cos(3 theta)"),
    ("rho", "the distance from the origin, where it is not defined: rho = 2 sin(phi)"),
    ("theta", "the angle around the z axis, where it is not defined: r = 1 + cos(3 theta)"),
];

/// All words. A word that has several meanings occurs once for each kind.
pub fn words() -> impl Iterator<Item = (&'static str, WordKind)> {
    use WordKind::*;
    let functions = zeroset_ops::names().chain(ROOT_NAMES.iter().copied());
    let values = VALUES.iter().map(|(name, _)| *name).filter(|name| *name != "r");
    let values = values.chain(NamedConstant::ALL.iter().map(|constant| constant.name()));
    let views = VIEWS.map(|view| view.name).into_iter();
    let looks = LOOKS.map(|look| look.name).into_iter();
    let maps = COLOR_MAPS.map(|map| map.name).into_iter();
    let within = views.chain(looks).chain(maps).chain(POINT_NAMES);
    let within = within.chain(["auto", "ball", "on", "off", "eye", "target", "up", "fov", "ortho"]);
    let first = |(word, _): &(&'static str, &str)| *word;
    functions
        .map(|word| (word, Function))
        .chain(values.map(|word| (word, Value)))
        .chain(OPERATORS.iter().map(first).map(|word| (word, Operator)))
        .chain(DRAWINGS.iter().map(first).map(|word| (word, Drawing)))
        .chain(SETTINGS.iter().map(|setting| (setting.word, Setting)))
        .chain(within.map(|word| (word, InSetting)))
        .chain(PROGRAM.iter().map(first).map(|word| (word, Program)))
}

/// All functions, constants and coordinates of the language, with their aliases.
///
/// Besides the functions in the tables of `zeroset_ops`, the list contains `root(a, n)`, the n-th
/// root of a. If n is written as an odd whole number, negative numbers have roots too. Any other n
/// is read as `a^(1/n)`, for a ≥ 0.
pub fn language_names() -> impl Iterator<Item = &'static str> {
    let is_name = |kind| matches!(kind, WordKind::Function | WordKind::Value);
    words().filter(move |(_, kind)| is_name(*kind)).map(|(name, _)| name)
}

/// A line of help for a word; `None` for unknown words, and for functions of `zeroset_ops`.
pub fn word_help(word: &str) -> Option<String> {
    let found = |table: &[(&'static str, &'static str)]| {
        table.iter().find(|(name, _)| *name == word).map(|(_, text)| *text)
    };
    if let Some(setting) = SETTINGS.iter().find(|setting| setting.word == word) {
        return Some(format!("a line about the picture: {}", setting.hint));
    }
    if ROOT_NAMES.contains(&word) {
        return Some(
            "root(a, n) is the n-th root of a, of negative numbers too where n is odd".to_owned(),
        );
    }
    if let Some(text) = found(VALUES) {
        return Some(text.to_owned());
    }
    if let Some(constant) = NamedConstant::ALL.iter().find(|constant| constant.name() == word) {
        return Some(meaning(*constant).unwrap_or("a constant").to_owned());
    }
    if let Some(text) = found(OPERATORS).or_else(|| found(DRAWINGS)) {
        return Some(format!("as in {text}"));
    }
    if let Some(text) = found(PROGRAM) {
        return Some(format!("a word of programs, as in {text}"));
    }
    let lines = || SETTINGS.iter().filter(|setting| setting.hint.contains(word));
    words().any(|known| known == (word, WordKind::InSetting)).then(|| {
        let within = lines().map(|setting| format!("`{}`", setting.word)).collect::<Vec<_>>();
        match within.as_slice() {
            [] => "a word of lines about the picture".to_owned(),
            within => format!("a word of lines that begin with {}", within.join(", ")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;
    use zeroset_parser::Limits;

    #[test]
    fn examples_read_and_hold_their_words() {
        for (word, text) in PROGRAM.iter().chain(OPERATORS).chain(DRAWINGS) {
            let text = if *word == "in" { format!("{text}\nx = r") } else { (*text).to_owned() };
            let read = parse(&text, &Limits::default());
            assert!(read.is_ok(), "{}", read.unwrap_err().render(None, &text, false));
            assert!(text.split(|c: char| !c.is_alphanumeric()).any(|part| part == *word), "{text}");
        }
    }

    #[test]
    fn every_word_has_help() {
        let is_row = |word: &str| zeroset_ops::names().any(|name| name == word);
        for (word, kind) in words().filter(|(word, _)| !is_row(word)) {
            let help = word_help(word).unwrap_or_default();
            assert!(help.len() > 5 && !help.ends_with(": "), "{word} {kind:?}: {help}");
        }
    }
}
