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
