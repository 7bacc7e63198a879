//! The prompt's help, built from the tables of commands, functions and equivalents.

use super::command::COMMANDS;
use super::reply::{Refusal, Reply, refused, say};
use super::{equivalents, status_words};
use std::collections::HashSet;
use std::fmt::Write as _;
use zeroset_style::COLOR_MAPS;
use zeroset_syntax::{WordKind, language_names, word_help, words};

/// The topic that lists equivalents in other programs.
const EQUIVALENTS_TOPIC: &str = "coming";

/// The command whose help also explains the words of the window's status line.
const STATUS: &str = "status";

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
        let usage = format!("{}: {}", row.usage(), row.doc);
        let is_status = row.name == STATUS;
        return say(if is_status {
            format!("{usage}\n{}", status_words::explained())
        } else {
            usage
        });
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
        if name == "color" && !found.is_empty() {
            found.push(format!("maps: {}", COLOR_MAPS.map(|map| map.name).join(", ")));
        }
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
    let mut text =
        String::from("Type a formula such as x^2+y^2+z^2 = 1, a definition such as r = 2, or:\n");
    let width = COMMANDS.iter().map(|row| row.usage().len()).max().unwrap_or(0);
    for row in COMMANDS.iter() {
        let _ = writeln!(text, "  {:width$}  {}", row.usage(), row.doc);
    }
    text.push_str("What the window's status line says: :help status\n");
    text.push_str("Coming from Desmos, Mathematica, Surfer, GLSL or libfive? :help coming\n");
    text.push_str("Functions (:help NAME tells more):");
    let mut column = usize::MAX;
    let mut told = HashSet::new();
    for name in zeroset_ops::names().filter(|name| told.insert(*name)) {
        if column.saturating_add(name.len() + 1) > 96 {
            text.push_str("\n ");
            column = 1;
        }
        column += name.len() + 1;
        let _ = write!(text, " {name}");
    }
    for (kind, title) in [
        (WordKind::Setting, "Lines about the picture:"),
        (WordKind::Drawing, "Curves and points:"),
        (WordKind::Operator, "Between conditions and ranges:"),
        (WordKind::Program, "Of programs:"),
    ] {
        let all: Vec<&str> =
            words().filter(|(_, other)| *other == kind).map(|(name, _)| name).collect();
        let _ = write!(text, "\n{title} {}", all.join(" "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_that_completes_has_help_and_is_listed_once() {
        let list = everything();
        let (_, listed) = list.split_once("tells more):").expect("a list of functions");
        let (listed, _) = listed.split_once("\nLines").expect("lists of other words");
        let listed: Vec<&str> = listed.split_whitespace().collect();
        for name in zeroset_ops::names() {
            let Ok(Reply::Say(text)) = help(name) else { panic!("no help on {name}") };
            assert!(!text.is_empty(), "{name}");
            assert_eq!(listed.iter().filter(|other| **other == name).count(), 1, "{name}");
        }
        for (word, kind) in words() {
            let Ok(Reply::Say(text)) = help(word) else { panic!("no help on {word}, {kind:?}") };
            assert!(text.len() > word.len(), "{word}");
        }
    }
}
