//! Maps every spelling of the language to a standard spelling. Nothing here knows names' meanings.

use crate::lex::token_kind::TokenKind;
use crate::settings::{SettingRow, setting};
use zeroset_style::StandardView;

/// The kind of a fixed spelling, such as `<=` or `\le`. The kind `Blank` separates tokens, and
/// `LineEnd` ends a statement.
///
/// This is the only list of the language's words, operators and LaTeX names, apart from `SETTINGS`.
pub fn token_kind(spelling: &str) -> Option<TokenKind> {
    use TokenKind::*;
    Some(match spelling {
        " " | "\t" | "\u{A0}" | "\u{2009}" | "\u{202F}" | "\u{3000}" | "\u{2062}" | "\u{FEFF}"
        | "\u{AD}" | "\u{200A}" | "\u{200B}" | "\u{200C}" | "\u{200D}" | "\u{2002}" | "\u{2003}" | "\u{2060}"
        | "\u{2061}" | "\u{200E}" | "\u{200F}" | "\u{202A}" | "\u{202C}" | "\u{202D}" | "\u{2066}" | "\u{2069}"
        // LaTeX commands for space and for the size of brackets.
        | r"\," | r"\;" | r"\:" | r"\!" | r"\ " | r"\quad" | r"\qquad" | r"\displaystyle"
        | r"\left" | r"\right" | r"\middle" | r"\bigl" | r"\bigr" | r"\big" | r"\biggl" | r"\biggr"
        | r"\bigg" | r"\Bigl" | r"\Bigr" | r"\Big" | r"\Biggl" | r"\Biggr" | r"\Bigg"
        // LaTeX commands and HTML entities for fonts, limits and space.
        | r"\small" | r"\normalsize" | r"\large" | r"\Large" | r"\textstyle" | r"\limits"
        | r"\nolimits" | r"\displaylimits" | r"\mathbf" | r"\mathsf" | r"\boldsymbol" | r"\bf"
        | r"\rm" | r"\it" | r"\hspace" | r"\enspace" | r"\nonumber" | r"\notag" | "&nbsp;"
        | "&thinsp;"
        // Marks that separate a formula from the text around it.
        | r"\(" | r"\)" | r"\]" | "$" => Blank,
        "\n" | "\r" => LineEnd,
        ";" => Semicolon,
        "," => Comma,
        ":" | r"\colon" => Colon,
        "?" => QuestionMark,
        // The percent sign after an opacity. `foreign` reads the remainder operator `%`.
        "%" => Percent,
        "+" => Plus,
        // A dash between values can only be a minus.
        "-" | "−" | "&minus;" | "–" | "—" | "‒" | "﹣" => Minus,
        "*" | "·" | "×" | "⋅" | "∙" | "∗" | "⨯" | "✕" | "•" | r"\ast" | r"\cdot" | r"\times"
        | "&times;" | "&middot;" | "&sdot;" => Star,
        "/" | "÷" | "∕" | "⁄" | r"\div" | "&divide;" => Slash,
        "^" | "**" | "ˆ" => Caret,
        "√" | "&radic;" => SquareRoot,
        "∛" => CubeRoot,
        "=" | "==" | ":=" => Equals,
        "!=" | "≠" | "<>" | r"\ne" | r"\neq" | "&ne;" => NotEqual,
        "<" | r"\lt" | "&lt;" => Less,
        "<=" | "≤" | "⩽" | "≦" | r"\le" | r"\leq" | r"\leqslant" | "&le;" => LessEqual,
        ">" | r"\gt" | "&gt;" => Greater,
        ">=" | "≥" | "⩾" | "≧" | r"\ge" | r"\geq" | r"\geqslant" | "&ge;" => GreaterEqual,
        "and" | "&&" | "∧" | r"\land" | r"\wedge" => And,
        "or" | "∨" | r"\lor" | r"\vee" => Or,
        "not" | "¬" | r"\lnot" | r"\neg" => Not,
        "in" | "∈" | r"\in" => In,
        "(" => OpenParen,
        ")" => CloseParen,
        "[" => OpenBracket,
        "]" => CloseBracket,
        "{" | r"\{" | r"\lbrace" => OpenBrace,
        "}" | r"\}" | r"\rbrace" => CloseBrace,
        "⟨" | r"\langle" => OpenList,
        "⟩" | r"\rangle" => CloseList,
        "⌊" | r"\lfloor" => OpenFloor,
        "⌋" | r"\rfloor" => CloseFloor,
        "⌈" | r"\lceil" => OpenCeiling,
        "⌉" | r"\rceil" => CloseCeiling,
        "|" | "‖" | "∣" | r"\|" | r"\mid" | r"\vert" | r"\Vert" => Bar,
        r"\lvert" | r"\lVert" => OpenBar,
        r"\rvert" | r"\rVert" => CloseBar,
        r"\over" => Over,
        r"\sum" => BigSum,
        r"\prod" => BigProduct,
        "&sup2;" | "&sup3;" => Superscript,
        // Spellings that have no meaning in this language.
        r"\pm" | r"\mp" | r"\int" | r"\iint" | r"\iiint" | r"\oint" | r"\partial"
        | r"\lim" | "&amp;" => Unknown,
        r"\bmod" => Remainder,
        r"\frac" | r"\dfrac" | r"\tfrac" | r"\cfrac" => Fraction,
        r"\sqrt" => Root,
        // Commands for upright letters, such as a name in braces.
        r"\operatorname" | r"\mathrm" | r"\mathit" | r"\text" | r"\textrm" | r"\textnormal" => Upright,
        "x" => X,
        "y" => Y,
        "z" => Z,
        "auto" => Auto,
        "eye" | "target" | "up" => VectorKey,
        "fov" | "ortho" => NumberKey,
        name if StandardView::named(name).is_some() => Preset,
        name if let Some(setting) = setting(name) => TokenKind::of_setting(setting.kind),
        _ => return None,
    })
}

/// The setting whose lines begin with `word`, which may be in styled letters.
pub fn typed_setting(word: &str) -> Option<&'static SettingRow> {
    setting(&plain_text(word))
}

/// Returns whether `character` may stand in a name after its first letter.
pub fn is_name_char(character: char) -> bool {
    character.is_alphabetic()
        || character.is_ascii_digit()
        || character == '_'
        || ('₀'..='₉').contains(&character)
}

/// Length in bytes of the longest start of `text` that consists of `accepted` characters.
pub fn prefix_length(text: &str, accepted: impl Fn(char) -> bool) -> usize {
    text.find(|c| !accepted(c)).unwrap_or(text.len())
}

/// Length in bytes of the first line of `rest`, without its line break.
pub(crate) fn line_length(rest: &str) -> usize {
    rest.find('\n').unwrap_or(rest.len())
}

/// The longest start of `text` that has at most `most` bytes.
pub fn start(text: &str, most: usize) -> &str {
    &text[..text.floor_char_boundary(most)]
}

/// Signs behind a function that stand for its derivative. The last one stands for two.
pub(crate) const PRIMES: [char; 4] = ['\'', '′', '’', '″'];

/// The upper part of an operator of differentiation without `∂` or `d` and its order: `f` for
/// `\partial^2 f`.
pub(crate) fn differentiated(above: &str) -> &str {
    let above = above.trim().trim_start_matches(r"\partial").trim_start_matches(['d', '∂']);
    above.trim_start_matches(['^', '{', '}', '2', '3', '4', '²', '³', ' '])
}

/// Returns whether `text` can be defined: it must be a name in plain letters, and no operator.
pub fn is_definable(text: &str) -> bool {
    text.starts_with(char::is_alphabetic)
        && text
            .chars()
            .all(|c| is_name_char(c) && plain_text(c.encode_utf8(&mut [0; 4])).starts_with(c))
        && token_kind(text).is_none_or(TokenKind::is_name)
}

/// The plain digit for a superscript digit.
pub(crate) fn superscript_digit(character: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().zip('0'..='9').find(|(s, _)| *s == character).map(|(_, digit)| digit)
}

/// Numerator and denominator of a fraction that is one character, such as `½`.
pub(crate) fn vulgar(character: char) -> Option<[char; 2]> {
    Some(match character {
        '½' => ['1', '2'],
        '⅓' => ['1', '3'],
        '⅔' => ['2', '3'],
        '¼' => ['1', '4'],
        '¾' => ['3', '4'],
        '⅕' => ['1', '5'],
        '⅖' => ['2', '5'],
        '⅗' => ['3', '5'],
        '⅘' => ['4', '5'],
        '⅙' => ['1', '6'],
        '⅚' => ['5', '6'],
        '⅛' => ['1', '8'],
        '⅜' => ['3', '8'],
        '⅝' => ['5', '8'],
        '⅞' => ['7', '8'],
        _ => return None,
    })
}

/// The plain character for a full-width or mathematical variant of a letter, digit or sign.
pub(crate) fn plain(character: char) -> Option<char> {
    let code = u32::from(character);
    if (0xFF01..=0xFF5E).contains(&code) {
        return char::from_u32(code - 0xFF01 + 0x21);
    }
    if character == 'ℎ' {
        return Some('h');
    }
    // Mathematical alphabets, from bold to monospace: 26 capitals, then 26 small letters.
    if (0x1D400..0x1D6A4).contains(&code) {
        let at = (code - 0x1D400) % 52;
        let first = if at < 26 { 'A' } else { 'a' };
        return char::from_u32(u32::from(first) + at % 26);
    }
    // Mathematical digits in five styles.
    if (0x1D7CE..0x1D800).contains(&code) {
        return char::from_digit((code - 0x1D7CE) % 10, 10);
    }
    None
}

/// `text` with each character in its [`plain`] form. Subscripts are written as in `x_1`.
pub(crate) fn plain_text(text: &str) -> String {
    let mut all = String::with_capacity(text.len());
    let mut is_below = false;
    for character in text.chars() {
        let digit = u32::from(character).checked_sub(u32::from('₀')).filter(|digit| *digit < 10);
        if let Some(digit) = digit.and_then(|digit| char::from_digit(digit, 10)) {
            if !is_below {
                all.push('_');
            }
            all.push(digit);
            is_below = true;
        } else {
            all.push(plain(character).unwrap_or(character));
            is_below = false;
        }
    }
    all
}

/// The standard text of a number. `.5` becomes `0.5`, and `1.` becomes `1`. An exponent
/// follows the letter `e`.
pub fn decimal(typed: &str) -> String {
    let text = plain_text(typed.trim_end_matches('f'));
    let text = text.replace('−', "-").replace("*^", "e").replace(['E', 'd', 'D'], "e");
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

/// LaTeX's accents of vectors, and the beginnings of the names of such vectors.
pub const ACCENTS: [(&str, &str); 3] =
    [(r"\vec", "vec_"), (r"\overrightarrow", "vec_"), (r"\hat", "hat_")];

/// The name of a vector such as `\vec{r}`: `vec_r`. A vector is another name than its letter.
fn vector_name(typed: &str) -> Option<String> {
    ACCENTS.into_iter().find_map(|(accent, prefix)| {
        let inner = typed.strip_prefix(accent).filter(|inner| inner.starts_with(['{', ' ']))?;
        let letter = inner.trim_matches(['{', '}', ' ', '\\']);
        // `\imath` is an i without its dot.
        Some(format!("{prefix}{}", letter.strip_suffix("math").unwrap_or(letter)))
    })
}

/// A name without LaTeX around it: `\sin` becomes `sin`, `\operatorname{foo}` becomes `foo`,
/// `x_{12}` becomes `x_12`, `\[Theta]` becomes `theta`, `\vec{r}` becomes `vec_r`.
pub fn plain_name(typed: &str) -> String {
    if let Some(named) = typed.strip_prefix("\\[").and_then(|rest| rest.strip_suffix(']')) {
        return named.to_lowercase();
    }
    if typed == "ℯ" {
        return "e".to_owned();
    }
    if matches!(typed, "@P" | "me.curPos") {
        return "p".to_owned();
    }
    if typed == "{0,1}" {
        return "i".to_owned();
    }
    if let Some(name) = typed.starts_with('\\').then(|| vector_name(typed)).flatten() {
        return name;
    }
    let typed = &plain_text(typed.strip_prefix('%').unwrap_or(typed));
    let text = typed.strip_prefix('\\').unwrap_or(typed).trim_end_matches('}');
    match text.split_once('{') {
        Some((name, subscript)) if name.ends_with('_') => format!("{name}{subscript}"),
        Some((_, inner)) => inner.to_owned(),
        None => text.to_owned(),
    }
}

/// A name for a message. A long name is cut off.
pub fn short_name(name: &str) -> String {
    short(name, 40, 40)
}

/// A formula for a message. A long formula is left out, because a part of it would mislead.
pub(crate) fn short_formula(formula: &str) -> String {
    short(formula, 24, 0)
}

/// `text`, if it has at most `longest` characters. Otherwise its first `kept` characters and `…`.
fn short(text: &str, longest: usize, kept: usize) -> String {
    if text.chars().nth(longest).is_none() {
        return text.to_owned();
    }
    text.chars().take(kept).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grammar_knows_symbols_only() {
        let grammar = include_str!("../../../../grammar/zeroset.pest");
        let rules = grammar.lines().filter(|line| !line.starts_with("//"));
        let literals: Vec<&str> =
            rules.flat_map(|line| line.split(['"', '\'']).skip(1).step_by(2)).collect();
        assert!(literals.len() > 60, "{}", literals.len());
        for literal in literals {
            let mut characters = literal.chars();
            let (Some(only), None) = (characters.next(), characters.next()) else {
                panic!("`{literal}` is not a symbol");
            };
            let kind = TokenKind::of_char(only).expect("a kind has this character");
            // No other kind except `Bar` has this spelling.
            assert!(
                token_kind(literal).is_none_or(|other| other == kind || other == TokenKind::Bar)
            );
        }
    }
}
