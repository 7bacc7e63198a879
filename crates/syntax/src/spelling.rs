//! The many spellings of a number or a name, brought to one. Knows characters only, not meanings.

/// Superscript digits as plain ones; a plus sign is dropped.
pub(crate) fn superscript(text: &str) -> String {
    text.chars()
        .filter_map(|c| match c {
            '⁻' => Some('-'),
            '⁺' => None,
            _ => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().zip('0'..='9').find(|(s, _)| *s == c).map(|(_, d)| d),
        })
        .collect()
}

/// Numerator and denominator of a fraction that is one character.
pub(crate) fn vulgar(character: char) -> Option<(char, char)> {
    Some(match character {
        '½' => ('1', '2'),
        '⅓' => ('1', '3'),
        '⅔' => ('2', '3'),
        '¼' => ('1', '4'),
        '¾' => ('3', '4'),
        '⅕' => ('1', '5'),
        '⅖' => ('2', '5'),
        '⅗' => ('3', '5'),
        '⅘' => ('4', '5'),
        '⅙' => ('1', '6'),
        '⅚' => ('5', '6'),
        '⅛' => ('1', '8'),
        '⅜' => ('3', '8'),
        '⅝' => ('5', '8'),
        '⅞' => ('7', '8'),
        _ => return None,
    })
}

/// A number's text in one spelling: `.5` as `0.5`, `1.` as `1`, an exponent after `e`.
pub(crate) fn decimal(typed: &str) -> String {
    let text = typed.replace('−', "-").replace('E', "e");
    let (mantissa, exponent) = match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text.as_str(), None),
    };
    let mut number = String::with_capacity(text.len() + 1);
    if mantissa.starts_with('.') {
        number.push('0');
    }
    number += mantissa.trim_end_matches('.');
    if let Some(exponent) = exponent {
        number.push('e');
        number += exponent.trim_start_matches('+');
    }
    number
}

/// A name without LaTeX around it: `\sin` as `sin`, `\operatorname{foo}` as `foo`, `x_{12}` as `x_12`.
pub(crate) fn plain_name(typed: &str) -> String {
    let text = typed.strip_prefix('\\').unwrap_or(typed);
    let text = match text.split_once('{') {
        Some(("operatorname" | "mathrm" | "mathit" | "text", inner)) => inner,
        _ => text,
    };
    text.chars().filter(|c| !matches!(c, '{' | '}')).collect()
}
