//! The prompt's help, built from the tables of commands, functions and equivalents. It is organized
//! by use.

use super::command::{COMMANDS, CommandRow, Purpose};
use super::reply::{Refusal, Reply, refused, say};
use super::{equivalents, status_words};
use std::collections::HashSet;
use std::fmt::Write as _;
use zeroset_parser::settings::setting_word;
use zeroset_style::COLOR_MAPS;
use zeroset_syntax::{WordKind, language_names, word_help, words};

/// The topic that lists equivalents in other programs.
const EQUIVALENTS_TOPIC: &str = "coming";

/// The command whose help also explains the words of the window's status line.
const STATUS: &str = "status";

/// Lines of a document, each with its meaning.
const LINES: &[(&str, &str)] = &[
    ("x^2 + y^2 + z^2 = 1", "a surface: all points at which this holds"),
    ("z = sin(x) cos(y)", "a graph"),
    ("x^2 + y^2 <= 1 and abs(z) <= 2", "a solid"),
    ("z = x y {x^2 + y^2 < 1}", "only where a condition holds"),
    ("curve x^2 + y^2 = 1, z = x", "a curve, in which two surfaces meet"),
    ("(cos t, sin t, t/5) for t in [0, 20]", "a curve with a parameter"),
    ("point (1, 2, 3)", "a point"),
    ("r = 2 in [0, 5]", "a value with a slider, for use in formulas"),
    ("f(a, b) = a^2 + b^2", "a function, for use in formulas"),
    ("domain 3", "the picture shows -3 to 3 on each axis"),
    ("color viridis(z)", "the surface's color by a value; color red is one color"),
];

/// Largest width of a list of names, in letters.
const WIDTH: usize = 96;

/// Returns help on a function, command or word. For an empty name, lists all of these.
pub(super) fn help(name: &str) -> Result<Reply, Refusal> {
    if name.is_empty() {
        return say(everything());
    }
    if name == EQUIVALENTS_TOPIC {
        return say(equivalents::listed());
    }
    let bare = name.trim_start_matches(':');
    if let Some(row) = COMMANDS.iter().find(|row| row.name == bare) {
        let mut usage = format!("{}: {}", row.usage(), row.doc);
        if !row.arguments.is_empty() {
            let _ = write!(usage, "; as in {}", row.as_typed());
        }
        if row.name == STATUS {
            let _ = write!(usage, "\n{}", status_words::explained());
        } else if row.name == "color" {
            let _ = write!(usage, "\nmaps: {}", COLOR_MAPS.map(|map| map.name).join(", "));
        }
        return say(usage);
    }
    let native = zeroset_ops::natives(name).map(|row| {
        let aliases = match row.aliases {
            [] => String::new(),
            aliases => format!(" (also {})", aliases.join(", ")),
        };
        format!("{}{aliases}: {}", row.name, row.doc)
    });
    let mut found: Vec<String> = native.collect();
    if found.is_empty() {
        found = zeroset_ops::composed(name)
            .map(|f| format!("{}({}): {}", f.name, f.parameters.join(", "), f.doc))
            .collect();
    }
    if found.is_empty() {
        let line = |row: &zeroset_ops::Builder| {
            let (signature, distance) = (row.signature(), row.distance.words());
            format!("{signature}: {}; {distance}; as in {}", row.doc, row.usage)
        };
        found = zeroset_ops::builders(name).map(line).collect();
    }
    if found.is_empty() {
        found.extend(zeroset_ops::form(name).map(|form| format!("{}: {}", form.usage, form.doc)));
    }
    if found.is_empty() {
        found.extend(word_help(name).map(|help| format!("{name}: {help}")));
    }
    if !found.is_empty() {
        return say(found.join("\n"));
    }
    let commands = COMMANDS.iter().map(|row| row.name);
    let nearest = language_names()
        .chain(commands)
        .map(|other| {
            // Among equally near names, prefer one that is a prefix of `bare`.
            (strsim::damerau_levenshtein(other, bare), !bare.starts_with(other), other)
        })
        .min()
        .filter(|(distance, _, other)| *distance <= 2 && other.len() > *distance);
    let hint = match nearest {
        Some((0, ..)) | None => ":help lists everything".to_owned(),
        Some((.., other)) => format!("did you mean {other}?"),
    };
    refused(format!("no function or command named '{name}'; {hint}"))
}

fn everything() -> String {
    let mut text = String::from("Type a line of the document:\n");
    let typed: Vec<String> = COMMANDS.iter().map(CommandRow::as_typed).collect();
    let widths = typed.iter().map(String::len).chain(LINES.iter().map(|(line, _)| line.len()));
    let width = widths.max().unwrap_or(0);
    for (line, meaning) in LINES {
        let _ = writeln!(text, "  {line:width$}  {meaning}");
    }
    for (purpose, title) in Purpose::ALL {
        let _ = writeln!(text, "{title}:");
        let rows = COMMANDS.iter().zip(&typed).filter(|(row, _)| row.purpose == purpose);
        for (row, typed) in rows {
            let _ = writeln!(text, "  {typed:width$}  {}", row.doc);
        }
    }
    text.push_str(":help NAME tells more about a command or a word. Words are:\n");
    for (title, names) in word_lists() {
        list_names(&mut text, title, &names);
    }
    text.push_str("The words of the window's status line: :help status\n");
    text.push_str("Coming from Desmos, Mathematica, Surfer, GLSL or libfive? :help coming");
    text
}

/// Names of functions and other words, with titles. A function is listed under its first name only.
fn word_lists() -> Vec<(&'static str, Vec<&'static str>)> {
    let mut told = HashSet::new();
    let mut names = |is_listed: &dyn Fn(&str) -> bool| -> Vec<&'static str> {
        zeroset_ops::names().filter(|name| is_listed(name) && told.insert(*name)).collect()
    };
    let is_function = |name: &str| {
        zeroset_ops::natives(name).any(|row| row.name == name)
            || zeroset_ops::composed(name).any(|row| row.name == name)
    };
    let mut lists = vec![
        ("Functions", names(&is_function)),
        ("Solids", names(&|name| zeroset_ops::builders(name).any(|row| row.name == name))),
        (
            "Sums, vectors",
            names(&|name| zeroset_ops::form(name).is_some_and(|row| row.name == name)),
        ),
    ];
    for (kind, title) in [
        (WordKind::Setting, "About the picture"),
        (WordKind::Drawing, "Curves and points"),
        (WordKind::Operator, "Conditions, ranges"),
        (WordKind::Program, "Programs"),
    ] {
        let all = words().filter(|(_, other)| *other == kind).map(|(name, _)| name);
        let is_alias = |name: &&str| setting_word(name).is_some_and(|main| main != *name);
        lists.push((title, all.filter(|name| !is_alias(name)).collect()));
    }
    lists
}

/// Writes a title and names, with line breaks between names.
fn list_names(text: &mut String, title: &str, names: &[&str]) {
    let _ = write!(text, "  {title}:");
    let mut column = 3 + title.len();
    for name in names {
        if column + 1 + name.len() > WIDTH {
            text.push_str("\n   ");
            column = 3;
        }
        column += 1 + name.len();
        let _ = write!(text, " {name}");
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    #[test]
    fn every_name_that_completes_has_help_and_no_alias_is_listed() {
        let lists = word_lists();
        let listed: Vec<&str> = lists.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        for name in zeroset_ops::names() {
            let Ok(Reply::Say(text)) = help(name) else { panic!("no help on {name}") };
            assert!(!text.is_empty(), "{name}");
            let count = listed.iter().filter(|other| **other == name).count();
            assert!(count <= 1, "{name}");
        }
        for (word, kind) in words() {
            let Ok(Reply::Say(text)) = help(word) else { panic!("no help on {word}, {kind:?}") };
            assert!(text.len() > word.len(), "{word}");
        }
        for primary in ["sin", "min", "sum", "torus"] {
            assert!(listed.contains(&primary), "{primary}");
        }
        for alias in ["half2x2", "float2x2", "fmin", "colour"] {
            assert!(!listed.contains(&alias), "{alias}");
        }
        let shown = everything();
        assert!(shown.lines().all(|line| line.len() <= 110), "{shown}");
        for row in COMMANDS.iter() {
            assert!(shown.contains(&format!("  {} ", row.as_typed())), "{}", row.name);
        }
    }

    #[test]
    fn every_line_of_the_help_can_be_read() {
        for (line, _) in LINES {
            let text = format!("{line}\nx = 0");
            assert!(read(&text, &Options::default()).is_ok(), "{line}");
        }
    }
}
