//! Hints on numbers: units, separators, decimal commas, percentages, indices, and endless ranges.

use super::{Mistake, Proposal};

/// Units that people write behind numbers.
const UNITS: [&str; 15] = [
    "mm", "cm", "km", "meters", "meter", "metres", "inches", "inch", "ft", "px", "units", "unit",
    "m", "um", "rad",
];
/// Words for degrees.
const DEGREES: [&str; 4] = ["degrees", "degree", "deg", "grad"];
/// Spellings of infinity.
const ENDLESS: [&str; 7] = ["infinity", "Infinity", "infty", "\\infty", "inf", "oo", "∞"];

pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let line = mistake.line;
    let mut all = vec![
        Proposal::new("numbers have no units", without_units(line)),
        Proposal::new("an angle in degrees has the sign `°`", with_degrees(line)),
        Proposal::new("a number has no separators", without_separators(line)),
        Proposal::new("a number has no separators", without_blanks(line)),
        Proposal::new("a mixed number is a sum", with_sums(line)),
        Proposal::new("a power of ten is multiplied by `*`", with_times(line)),
        Proposal::new("a number has one decimal point", with_one_point(line)),
        Proposal::new("a decimal number has a decimal point", with_points(line)),
        Proposal::new("an exponent stands above, an index below", raised(mistake)),
    ];
    for word in ENDLESS {
        let ends = [format!("..{word}"), format!(".. {word}"), format!("..+{word}")];
        for end in ends.iter().filter(|end| line.contains(end.as_str())) {
            all.push(Proposal::new("a sum has a last term", line.replacen(end, "..50", 1)));
        }
    }
    let is_share = line.contains('=') || line.contains(" of ");
    if let Some((before, behind)) = line.split_once('%').filter(|_| is_share) {
        let number = before.trim_end();
        let start = number.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
        if let Ok(percent) = number[start..].parse::<f64>() {
            let share = (percent * 10.0).round() / 1000.0;
            let rest = behind.trim_start().strip_prefix("of ").unwrap_or(behind).trim_start();
            let (first, rest) = (&number[..start], rest.trim_start_matches('*').trim_start());
            let why = "a percentage is a decimal number";
            all.push(Proposal::new(why, format!("{first}{share}*{rest}")));
            all.push(Proposal::new(why, format!("{first}{share}{behind}")));
        }
    }
    if let Some(share) = line.strip_prefix("transparency").map(str::trim) {
        let percent = share.strip_suffix('%').map(|percent| percent.trim().parse::<f64>());
        let share = percent.unwrap_or_else(|| share.parse().map(|share: f64| share * 100.0));
        if let Ok(percent) = share {
            let line = format!("opacity {}%", 100.0 - percent);
            all.push(Proposal::new("how much light a surface blocks is its `opacity`", line));
        }
    }
    all
}

/// Applies `change` behind each number of a line. It gets the text behind the number, and returns a
/// replacement and the number of bytes to replace.
fn behind_numbers(line: &str, change: impl Fn(&str) -> Option<(&'static str, usize)>) -> String {
    let mut text = String::new();
    let mut at = 0;
    while let Some(first) = line[at..].chars().next() {
        let ends = first.is_ascii_digit() || first == '.';
        text.push(first);
        at += first.len_utf8();
        let next_is_digit = line[at..].starts_with(|c: char| c.is_ascii_digit() || c == '.');
        if ends
            && !next_is_digit
            && let Some((other, length)) = change(&line[at..])
        {
            text += other;
            at += length;
        }
    }
    text
}

/// The length of one of `words` at the start of `rest`, with blanks before it.
fn word_length(rest: &str, words: &[&str]) -> Option<usize> {
    let typed = rest.trim_start();
    let end = typed.find(|c: char| !c.is_alphanumeric()).unwrap_or(typed.len());
    words.contains(&&typed[..end]).then(|| rest.len() - typed.len() + end)
}

fn without_units(line: &str) -> String {
    behind_numbers(line, |rest| Some(("", word_length(rest, &UNITS)?)))
}

fn with_degrees(line: &str) -> String {
    behind_numbers(line, |rest| Some(("°", word_length(rest, &DEGREES)?)))
}

/// Applies `change` to the digits and separators of each number of a line.
fn numbers(line: &str, change: impl Fn(&str) -> Option<String>) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let length = rest[start..].find(|c: char| !c.is_ascii_digit() && !".,'_".contains(c));
        let end = length.map_or(rest.len(), |length| start + length);
        let number = rest[start..end].trim_end_matches(['.', ',', '\'', '_']);
        text += &rest[..start];
        text += &change(number).unwrap_or_else(|| number.to_owned());
        rest = &rest[start + number.len()..];
    }
    text + rest
}

/// Removes the separators of thousands, as in `1,000,000` and `1.000,5`.
fn without_separators(line: &str) -> String {
    numbers(line, |number| {
        let separator = number.chars().find(|c| !c.is_ascii_digit())?;
        let last = number.chars().rfind(|c| !c.is_ascii_digit())?;
        let (whole, decimals) =
            if last == separator { (number, "") } else { number.rsplit_once(last)? };
        let mut groups = whole.split(separator);
        let is_first = groups.next().is_some_and(|first| (1..=3).contains(&first.len()));
        let are_groups = is_first && groups.all(|group| group.len() == 3);
        let whole = whole.replace(separator, "");
        let point = if decimals.is_empty() { "" } else { "." };
        are_groups.then(|| format!("{whole}{point}{decimals}"))
    })
}

/// `1 000 000` without its blanks.
fn without_blanks(line: &str) -> String {
    let mut text = String::new();
    for (at, sign) in line.char_indices() {
        let before = text.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = text.len() - before.len();
        let behind = &line[at + sign.len_utf8()..];
        let group = behind.find(|c: char| !c.is_ascii_digit()).unwrap_or(behind.len());
        let is_number = digits > 0 && !before.ends_with(|c: char| c.is_alphanumeric() || c == '.');
        let is_separator = matches!(sign, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}');
        if !(is_separator && is_number && group == 3) {
            text.push(sign);
        }
    }
    text
}

/// `3 1/2` and `2½` as sums in brackets.
fn with_sums(line: &str) -> String {
    const FRACTIONS: [(char, &str); 5] =
        [('½', "1/2"), ('⅓', "1/3"), ('¼', "1/4"), ('¾', "3/4"), ('⅔', "2/3")];
    let spaced = FRACTIONS.iter().fold(line.to_owned(), |line, (sign, fraction)| {
        line.replace(*sign, &format!(" {fraction} "))
    });
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let is_whole = |word: &str| !word.is_empty() && word.bytes().all(|c| c.is_ascii_digit());
    let is_fraction = |word: &str| {
        word.split_once('/').is_some_and(|(top, bottom)| is_whole(top) && is_whole(bottom))
    };
    let mut all: Vec<String> = Vec::new();
    let mut is_mixed = false;
    for word in &words {
        let digits = all.last().map_or("", |last| last.trim_start_matches('('));
        if is_fraction(word) && is_whole(digits) {
            let digits = digits.to_owned();
            let last = all.pop().unwrap_or_default();
            is_mixed = true;
            all.push(format!("{}({digits} + {word})", &last[..last.len() - digits.len()]));
        } else {
            all.push((*word).to_owned());
        }
    }
    if is_mixed { all.join(" ") } else { line.to_owned() }
}

/// `2x10^3` and `2 x 10^3` with a sign of multiplication.
fn with_times(line: &str) -> String {
    let mut text = String::new();
    let mut end = 0;
    for (at, _) in line.match_indices('x') {
        let behind = line[at + 1..].trim_start();
        let is_number = line[..at].trim_end().ends_with(|c: char| c.is_ascii_digit());
        if is_number && (behind.starts_with("10^") || behind.starts_with("10⁻")) {
            text += line[end..at].trim_end();
            text.push('*');
            end = line.len() - behind.len();
        }
    }
    text + &line[end..]
}

/// `1.2.3` with its first decimal point only.
fn with_one_point(line: &str) -> String {
    numbers(line, |number| {
        let count = number.matches('.').count();
        let mut parts = number.split('.').filter(|part| !part.is_empty());
        let (whole, decimals) = (parts.next()?, parts.next()?);
        (count > 1).then(|| format!("{whole}.{decimals}"))
    })
}

/// `0,5` with a decimal point.
fn with_points(line: &str) -> String {
    let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let has_list = line.contains(['[', '{'])
        || line.match_indices(',').any(|(at, _)| {
            is_digit(line[at + 1..].chars().next()) && !is_digit(line[..at].chars().next_back())
        });
    numbers(line, |number| {
        let (whole, decimals) = number.split_once(',').filter(|_| !has_list)?;
        let is_decimal = whole.len() < 3 && decimals.bytes().all(|digit| digit.is_ascii_digit());
        is_decimal.then(|| format!("{whole}.{decimals}"))
    })
}

/// Raises the index of a name, as in `y₂`, so that it is a power.
fn raised(mistake: &Mistake<'_>) -> String {
    let power = |c: char| {
        let digit = u32::from(c).checked_sub(u32::from('₀')).filter(|digit| *digit < 10);
        digit.and_then(|digit| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize)).unwrap_or(c)
    };
    let typed: String = mistake.typed().chars().map(power).collect();
    mistake.replaced(mistake.place.clone(), &typed)
}
