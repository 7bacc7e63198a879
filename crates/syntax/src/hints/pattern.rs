//! Patterns of statements. A capital letter stands for a part of a statement with paired brackets
//! and without relations. `P` and `Q` may also stand for conditions. `S` and `T` stand for calls,
//! `N` for a name, `U` and `V` for numbers. All else stands for itself. Blanks do not matter.

use std::collections::BTreeMap;
use std::ops::Range;

/// Largest number of pieces of a statement that is compared with patterns.
const MOST_PIECES: usize = 80;

/// The parts of a statement for which the letters of a pattern stand.
pub(crate) type Parts<'a> = BTreeMap<char, &'a str>;

/// The words, numbers and signs of a text.
pub(crate) fn pieces(text: &str) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    let mut chars = text.char_indices().peekable();
    let is_dots = |at: usize| text[at..].starts_with("..");
    while let Some((start, first)) = chars.next() {
        if first.is_whitespace() {
            continue;
        }
        let is_word = first.is_alphabetic() || first == '_';
        let goes_on = |at: usize, c: char| {
            if is_word {
                c.is_alphanumeric() || c == '_'
            } else {
                first.is_ascii_digit() && (c.is_ascii_digit() || c == '.' && !is_dots(at))
            }
        };
        let mut end = start + first.len_utf8();
        while let Some((at, next)) = chars.next_if(|(at, c)| goes_on(*at, *c)) {
            end = at + next.len_utf8();
        }
        all.push(start..end);
    }
    all
}

/// A text with other words in place of some of its words, numbers and signs.
pub(crate) fn renamed(text: &str, other: impl Fn(&str) -> Option<String>) -> String {
    let mut all = String::new();
    let mut end = 0;
    for piece in pieces(text) {
        all += &text[end..piece.start];
        end = piece.end;
        let word = &text[piece];
        all += &other(word).unwrap_or_else(|| word.to_owned());
    }
    all + &text[end..]
}

/// The parts of `text` that the letters of `pattern` stand for, if they match.
pub(crate) fn matched<'a>(pattern: &str, text: &'a str) -> Option<Parts<'a>> {
    // Rejects most patterns quickly: they have a word or a sign that the text lacks.
    let is_literal =
        |word: &&str| !word.contains(|c: char| c.is_uppercase() || "(){}[],:".contains(c));
    if pattern.split(' ').filter(is_literal).any(|word| !text.contains(word)) {
        return None;
    }
    let (all, own) = (pieces(text), pieces(pattern));
    let own: Vec<&str> = own.into_iter().map(|piece| &pattern[piece]).collect();
    if all.len() > MOST_PIECES {
        return None;
    }
    let mut parts = Parts::new();
    let mut left = 2000;
    find(&own, &all, text, &mut parts, &mut left).then_some(parts)
}

/// `template` with the parts in place of its letters, in brackets where operators need them.
pub(crate) fn filled(template: &str, parts: &Parts<'_>) -> String {
    let mut text = String::new();
    let mut end = 0;
    for piece in pieces(template) {
        let word = &template[piece.clone()];
        text += &template[end..piece.start];
        end = piece.end;
        let Some(part) = letter(word).and_then(|letter| parts.get(&letter)) else {
            text += word;
            continue;
        };
        let before = template[..piece.start].trim_end().ends_with(['*', '/', '^', '-']);
        let behind = template[end..].trim_start().starts_with(['*', '/', '^']);
        if (before || behind) && !is_atom(part) {
            text.extend(["(", part, ")"]);
        } else {
            text += part;
        }
    }
    text + &template[end..]
}

/// Returns whether a part is a name, a number, a call or in brackets.
fn is_atom(part: &str) -> bool {
    let all = pieces(part);
    let mut depth = 0_i32;
    let is_closed_before_end = all.iter().enumerate().any(|(index, piece)| {
        match &part[piece.clone()] {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        let is_name = index == 0 && part.starts_with(char::is_alphabetic) && all.len() > 2;
        depth == 0 && index + 1 < all.len() && !is_name
    });
    !is_closed_before_end
}

/// The letter, if a piece of a pattern is a single capital letter.
fn letter(piece: &str) -> Option<char> {
    let mut chars = piece.chars();
    chars.next().filter(|c| c.is_ascii_uppercase() && chars.next().is_none())
}

fn find<'a>(
    own: &[&str],
    all: &[Range<usize>],
    text: &'a str,
    parts: &mut Parts<'a>,
    left: &mut usize,
) -> bool {
    *left = left.saturating_sub(1);
    let Some((first, rest)) = own.split_first() else { return all.is_empty() };
    let Some(letter) = letter(first) else {
        let is_same =
            all.first().is_some_and(|piece| text[piece.clone()].eq_ignore_ascii_case(first));
        return is_same && *left > 0 && find(rest, &all[1..], text, parts, left);
    };
    let is_minus = |at: usize| all.get(at).is_some_and(|piece| &text[piece.clone()] == "-");
    let is_number = matches!(letter, 'U' | 'V');
    let most = match letter {
        'N' => 1,
        _ if is_number => 1 + usize::from(is_minus(0)),
        _ => all.len(),
    };
    let mut depth = 0_i32;
    for (index, piece) in all.iter().enumerate().take(most) {
        let typed = &text[piece.clone()];
        if letter == 'N' && !typed.starts_with(char::is_alphabetic)
            || is_number && typed.parse::<f64>().is_err() && !(index == 0 && is_minus(0))
        {
            return false;
        }
        match typed {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        let is_relation = matches!(typed, "=" | "<" | ">" | "≤" | "≥" | "and" | "or" | ";");
        let is_condition = matches!(letter, 'P' | 'Q');
        if depth < 0 || *left == 0 || depth == 0 && is_relation && !is_condition {
            return false;
        }
        let is_call = index > 1
            && text[all[0].clone()].starts_with(char::is_alphabetic)
            && &text[all[1].clone()] == "("
            && typed == ")";
        let fits = is_call || !matches!(letter, 'S' | 'T');
        let fits = fits && (!is_number || index + 1 == most);
        if depth == 0 && fits && find(rest, &all[index + 1..], text, parts, left) {
            let part = &text[all[0].start..piece.end];
            // A letter stands for the same text wherever it occurs.
            if letter != 'N' && parts.get(&letter).is_some_and(|other| *other != part) {
                parts.remove(&letter);
                continue;
            }
            parts.insert(letter, part);
            return true;
        }
    }
    false
}

/// A call: the places of its name, of its arguments and of the whole.
pub(crate) struct Call<'a> {
    pub name: &'a str,
    pub arguments: Vec<&'a str>,
    pub range: Range<usize>,
}

/// All calls in a statement. Inner calls follow the call that contains them.
pub(crate) fn calls(text: &str) -> Vec<Call<'_>> {
    let all = pieces(text);
    let mut calls = Vec::new();
    for (index, pair) in all.windows(2).enumerate() {
        let name = &text[pair[0].clone()];
        if &text[pair[1].clone()] != "(" || !name.starts_with(char::is_alphabetic) {
            continue;
        }
        let (mut depth, mut arguments, mut start) = (0_i32, Vec::new(), pair[1].end);
        for piece in &all[index + 1..] {
            match &text[piece.clone()] {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth -= 1,
                "," if depth == 1 => {
                    arguments.push(text[start..piece.start].trim());
                    start = piece.end;
                }
                _ => {}
            }
            if depth == 0 {
                arguments.push(text[start..piece.start].trim());
                arguments.retain(|argument| !argument.is_empty());
                calls.push(Call { name, arguments, range: pair[0].start..piece.end });
                break;
            }
        }
    }
    calls
}
