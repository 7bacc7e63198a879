//! Marks of pasted lists and papers: numbers and bullets before formulas, numbers of equations
//! behind them, and ends of lines before a minus sign.
//!
//! Blanks of the same length replace them, so all places stay the same.

use std::ops::Range;
use zeroset_parser::{Note, NoteKind, Span};

/// Numbers as words of a list, in the order of counting.
const ROMAN: [&str; 10] = ["i", "ii", "iii", "iv", "v", "vi", "vii", "viii", "ix", "x"];

/// Signs that are nothing else than bullets.
const BULLETS: &str = "•◦▪●‣■";

/// Signs that are bullets where all lines begin with them.
const SIGNS: &str = "-–—−*";

/// The text without marks of lists, and notes on what is left out. `None` if it has no such marks.
pub(crate) fn without_list_marks(text: &str) -> Option<(String, Vec<Note>)> {
    let lines = lines(text);
    let mut marks = numbers(text, &lines);
    marks.extend(bullets(text, &lines));
    let mut plain = text.to_owned();
    let mut notes = Vec::new();
    if let Some(first) = marks.first() {
        let typed: Vec<String> =
            marks.iter().take(3).map(|mark| format!("`{}`", &text[mark.clone()])).collect();
        let span = Span::new(first.start, first.end);
        notes.push(Note { span, kind: NoteKind::MarksOfList { typed: typed.join(", ") } });
    }
    for mark in marks {
        // A formula behind a mark does not go on with the line above.
        let end = " ".repeat(mark.len() - 1);
        plain.replace_range(mark, &format!(";{end}"));
    }
    for number in lines.iter().filter_map(|line| number_of_equation(text, line)) {
        let typed = text[number.clone()].to_owned();
        let span = Span::new(number.start, number.end);
        plain.replace_range(number, &" ".repeat(typed.len()));
        notes.push(Note { span, kind: NoteKind::NumberOfEquation { typed } });
    }
    let mut has_gone_on = false;
    for at in 1..lines.len() {
        let sign = goes_on(&plain, &lines, at, has_gone_on);
        has_gone_on = sign.is_some();
        if let Some(sign) = sign {
            let end = lines[at - 1].end;
            plain.replace_range(end..sign.start, &" ".repeat(sign.start - end));
            notes.push(Note { span: sign, kind: NoteKind::LineGoesOn });
        }
    }
    (plain != text).then_some((plain, notes))
}

/// The lines without blanks at their ends, but for empty lines and comments.
fn lines(text: &str) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let begin = start + line.len() - line.trim_start().len();
        let typed = line.trim();
        if !typed.is_empty() && !typed.starts_with(['#', '%']) && !typed.starts_with("//") {
            all.push(begin..begin + typed.len());
        }
        start += line.len();
    }
    all
}

/// The label in `1.`, `2)` and `(a)` at the start of a line, and the length of the whole mark.
fn label(line: &str) -> Option<(&str, usize)> {
    let inner = line.strip_prefix('(').unwrap_or(line);
    let length = inner.find(|c: char| !c.is_ascii_digit() && !c.is_ascii_lowercase())?;
    let label = &inner[..length];
    let is_number = label.bytes().all(|c| c.is_ascii_digit());
    if length == 0 || length > 4 || !is_number && label.bytes().any(|c| c.is_ascii_digit()) {
        return None;
    }
    let is_open = inner.len() < line.len();
    let end = match inner[length..].strip_prefix('.') {
        Some(rest) if is_number && !is_open => {
            if rest.starts_with(')') {
                ".)"
            } else {
                "."
            }
        }
        _ if inner[length..].starts_with(')') => ")",
        _ => return None,
    };
    let size = line.len() - inner.len() + length + end.len();
    line[size..].starts_with([' ', '\t']).then_some((label, size))
}

/// The place of a label in the order of counting: as digits, as a letter, or as a Roman numeral.
fn ordinals(label: &str) -> [Option<usize>; 3] {
    let letter = match label.as_bytes() {
        [letter @ b'a'..=b'z'] => Some(usize::from(letter - b'a') + 1),
        _ => None,
    };
    let roman = ROMAN.iter().position(|numeral| *numeral == label).map(|at| at + 1);
    [label.parse().ok(), letter, roman]
}

/// Numbers and letters before formulas, if they count up. A bracket that is not open can only end
/// such a mark.
fn numbers(text: &str, lines: &[Range<usize>]) -> Vec<Range<usize>> {
    let labelled: Vec<(Range<usize>, &str)> = lines
        .iter()
        .filter_map(|line| {
            let (label, size) = label(&text[line.clone()])?;
            Some((line.start..line.start + size, label))
        })
        .collect();
    // There are few letters and Roman numerals, but there may be very many numbers.
    let is_value = |label: &str| {
        let value = |line: &Range<usize>| {
            let typed = text[line.clone()].strip_prefix(label);
            typed.is_some_and(|rest| rest.trim_start().starts_with('='))
        };
        label.starts_with(char::is_alphabetic) && lines.iter().any(value)
    };
    let counts = |style: usize| {
        let all: Option<Vec<usize>> =
            labelled.iter().map(|(_, label)| ordinals(label)[style]).collect();
        all.is_some_and(|all| {
            all.len() > 1
                && (style == 0 || all[0] == 1)
                && all.windows(2).all(|two| two[0] + 1 == two[1])
        })
    };
    let is_list = (0..3).any(counts) && !labelled.iter().any(|(_, label)| is_value(label));
    let is_mark = |mark: &Range<usize>| {
        let typed = &text[mark.clone()];
        is_list || typed.ends_with(')') && !typed.starts_with('(')
    };
    labelled.into_iter().map(|(mark, _)| mark).filter(is_mark).collect()
}

/// Bullets before formulas. A minus sign or an asterisk is one if all lines begin with it and a
/// blank.
fn bullets(text: &str, lines: &[Range<usize>]) -> Vec<Range<usize>> {
    let sign = |line: &Range<usize>| text[line.clone()].chars().next();
    let first = lines.first().and_then(sign).filter(|sign| SIGNS.contains(*sign));
    let begins = |line: &Range<usize>, own: char| {
        text[line.clone()].strip_prefix(own).is_some_and(|rest| rest.starts_with([' ', '\t']))
    };
    let is_list =
        first.is_some_and(|own| lines.len() > 1 && lines.iter().all(|line| begins(line, own)));
    let is_bullet =
        |line: &&Range<usize>| is_list || sign(line).is_some_and(|sign| BULLETS.contains(sign));
    let mark = |line: &Range<usize>| line.start..line.start + sign(line).map_or(0, char::len_utf8);
    lines.iter().filter(is_bullet).map(mark).collect()
}

/// The number in brackets behind an equation, as in `x^2 + y^2 = 1   (2.1)`.
fn number_of_equation(text: &str, line: &Range<usize>) -> Option<Range<usize>> {
    let typed = &text[line.clone()];
    let inner = typed.strip_suffix(')')?;
    let (before, number) = inner.rsplit_once('(')?;
    let is_letter = |c: char| c.is_ascii_lowercase();
    let digits = number.strip_suffix(is_letter).unwrap_or(number);
    let is_number = digits.starts_with(|c: char| c.is_ascii_digit())
        && digits.ends_with(|c: char| c.is_ascii_digit())
        && digits.bytes().all(|c| c.is_ascii_digit() || c == b'.');
    let formula = before.trim_end();
    let gap = before.len() - formula.len();
    let formula = formula.trim_end_matches([',', '.', ' ']);
    let ends = |signs: &str| formula.ends_with(|c: char| c.is_ascii_digit() || signs.contains(c));
    let is_ended = gap > 0 && ends("xyz") || gap > 1 && ends("xyz)]}|²³");
    let start = line.start + before.len();
    (is_number && is_ended && has_relation(formula)).then_some(start..line.end)
}

fn has_relation(formula: &str) -> bool {
    formula.contains(['=', '<', '>', '≤', '≥'])
}

/// The minus sign at the start of line number `at`, if the line goes on with the one above. It does
/// so if the line below begins with a relation, or if it has no relation and the equation above has
/// one. With `has_gone_on`, the line above goes on with others.
fn goes_on(text: &str, lines: &[Range<usize>], at: usize, has_gone_on: bool) -> Option<Span> {
    let line = &text[lines[at].clone()];
    let above = &text[lines[at - 1].clone()];
    let sign = line.chars().next().filter(|c| "-−–".contains(*c))?;
    // An indented line goes on anyway.
    let between = &text[lines[at - 1].end..lines[at].start];
    let is_next = between.matches('\n').count() == 1 && between.ends_with('\n');
    let is_plain =
        !line.contains([';', ',', '{', '#']) && !above.contains([';', ',', '{', '#', '"']);
    let is_before_relation =
        lines.get(at + 1).is_some_and(|next| text[next.clone()].starts_with('='));
    let is_rest = !has_relation(line) && (has_relation(above) || has_gone_on) && !defines(above);
    let place = lines[at].start;
    (is_next && is_plain && (is_before_relation || is_rest))
        .then(|| Span::new(place, place + sign.len_utf8()))
}

/// Returns whether a line begins like a definition, such as `a = 2` and `f(a) = a^2`. The line
/// below may be a formula that uses it.
fn defines(line: &str) -> bool {
    let Some((left, _)) = line.split_once('=') else { return false };
    let name = left.split('(').next().unwrap_or(left).trim();
    let is_name = name.starts_with(char::is_alphabetic)
        && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '\'');
    is_name && !["x", "y", "z"].contains(&name)
}

#[cfg(test)]
mod tests {
    use crate::{Options, read};

    /// The surfaces of a text, and its notes.
    fn seen(text: &str) -> (Vec<String>, String) {
        let document = read(text, &Options::default()).expect(text);
        let surfaces = document.surfaces.iter().map(|surface| surface.line()).collect();
        let notes = document.notes.iter().map(|note| note.message());
        (surfaces, notes.collect::<Vec<_>>().join("\n"))
    }

    #[test]
    fn marks_of_lists_are_left_out_with_a_note() {
        for (text, surfaces, note) in [
            (
                "1. z = x^2 + y^2\n2. z = 4 - x^2\n3. x + y = 1\n",
                vec!["z = x^2 + y^2", "z = 4 - x^2", "x + y = 1"],
                "`1.`, `2.`, `3.`",
            ),
            ("(1) -x = y\n(2) z = 1", vec!["-x = y", "z = 1"], "`(1)`"),
            ("a) z = x\nb) z = y", vec!["z = x", "z = y"], "`a)`"),
            ("(a) z = x\n(b) -z = y", vec!["z = x", "-z = y"], "`(b)`"),
            ("(i) z = x\n(ii) z = y", vec!["z = x", "z = y"], "`(ii)`"),
            ("3) x^2+y^2+z^2=1", vec!["x^2 + y^2 + z^2 = 1"], "`3)`"),
            ("• z = x\n• z = y", vec!["z = x", "z = y"], "`•`"),
            ("• z = x", vec!["z = x"], "`•`"),
            ("* z = x\n* z = y", vec!["z = x", "z = y"], "`*`"),
            ("- x^2+y^2-z^2=1\n- z=1", vec!["x^2 + y^2 - z^2 = 1", "z = 1"], "`-`"),
            ("– z = x\r\n– z = y\r\n", vec!["z = x", "z = y"], "`–`"),
            ("x^2+y^2+z^2=1 (2)", vec!["x^2 + y^2 + z^2 = 1"], "`(2)`"),
            ("x^2 + y^2 + z^2 = 1,    (2.1)", vec!["x^2 + y^2 + z^2 = 1"], "`(2.1)`"),
            ("z = (x + y)\t \t(3a)", vec!["z = x + y"], "`(3a)`"),
        ] {
            let (found, notes) = seen(text);
            assert_eq!(found, surfaces, "{text}");
            assert!(notes.contains(note) && notes.contains("left out"), "{text}: {notes}");
        }
    }

    #[test]
    fn a_formula_goes_on_behind_a_line_broken_before_a_minus_sign() {
        for (text, surface) in [
            ("x^2/4\n− y^2/9\n= z", "x^2/4 - y^2/9 = z"),
            ("z = x^2\n- y^2\n", "z = x^2 - y^2"),
            ("z = x^2\r\n- y^2\r\n- 1", "z = x^2 - y^2 - 1"),
        ] {
            let (found, notes) = seen(text);
            assert_eq!(found, [surface], "{text}");
            assert!(notes.contains("goes on with the line above"), "{text}: {notes}");
        }
    }

    #[test]
    fn other_numbers_and_signs_stay() {
        for (text, surfaces) in [
            ("1. z = x\n3. z = y", vec!["1*z = x", "3*z = y"]),
            ("a = 2\n(a) x = y\n(b) x = y\nb = 1", vec!["a*x = y", "b*x = y"]),
            ("-x = y\n-z = 1", vec!["-x = y", "-z = 1"]),
            ("a = 2\n-x^2 + a*z", vec!["-x^2 + a*z = 0"]),
            ("f(a) = a^2 - x/2\n-f(y) + z", vec!["-f(y) + z = 0"]),
            ("c = cos(1)\n- x + c", vec!["-x + c = 0"]),
            ("f(a) = 2a; z = f (2)", vec!["z = f(2)"]),
            ("z = x\n\n- y^2", vec!["z = x", "-y^2 = 0"]),
            ("z = x\n  - y^2", vec!["z = x - y^2"]),
        ] {
            assert_eq!(seen(text).0, surfaces, "{text}");
        }
    }
}
