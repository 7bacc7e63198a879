//! Recognizes the token at the start of a text, from its characters and a little context.
//!
//! Pasted notations become tokens of this language: LaTeX environments, comments of other
//! languages, names of modules before functions, components of vectors.

use crate::lex::environment::environment;
use crate::lex::foreign_signs::foreign;
use crate::lex::spelling::{
    PRIMES, differentiated, is_name_char, line_length, plain_text, prefix_length, start,
    superscript_digit, token_kind, vulgar,
};
use crate::lex::token::LexContext;
use crate::lex::token_kind::TokenKind::{self, *};

/// Names of modules, as in `np.sin`. A module's name is skipped before a dot and a name.
#[rustfmt::skip] // several words a line
const MODULES: &[&str] = &[
    "np", "numpy", "math", "Math", "sp", "sympy", "scipy", "jnp", "torch", "tf", "glm", "linalg",
    "mpmath", "mp", "cp", "xp", "Mathf", "special", "plotting", "functools", "Funcs",
];

/// LaTeX commands whose braces hold text that is not part of a formula.
const LABELS: &[&str] = &["tag", "label"];

/// Words in `\text{…}` that only introduce a condition, or mean nothing.
const CONDITION_WORDS: &[&str] = &["if", "for", "when", "where", "while", "with", ""];

/// Words for the last piece of a choice, which counts where no condition holds.
pub(crate) const OTHERWISE: &[&str] =
    &["otherwise", "else", "elsewhere", "True", "true", "default"];

/// The token at the start of `rest`, and its length in bytes. Skipped text is a `Blank`.
pub(crate) fn lex(rest: &str, context: LexContext) -> (TokenKind, usize) {
    let Some(character) = rest.chars().next() else {
        return (Blank, 0);
    };
    let length = character.len_utf8();
    if let Some(length) = python_string(rest, context) {
        let is_doc = context.last.is_none();
        return (if is_doc { Blank } else { Unknown }, length);
    }
    if let Some(comment) = comment(rest, context) {
        return (Blank, comment);
    }
    if let Some(found) = foreign(rest, context) {
        return found;
    }
    if matches!(character, '\\' | 'd' | '∂')
        && let Some(length) = differential(rest)
    {
        return (TokenKind::Name, length);
    }
    match character {
        '#' if rest.starts_with("#define ") => (TokenKind::Name, "#define".len()),
        '#' if let Some(length) = slot(rest) => (TokenKind::Name, length),
        '#' => match prefix_length(&rest[1..], |c| c.is_ascii_hexdigit()) {
            digits @ 1.. if context.is_color => (HexColor, 1 + digits),
            _ => (Blank, line_length(rest)),
        },
        '0'..='9' if context.is_part => (Digit, 1),
        '1'..='9' if context.last == Some(Root) && context.follows_command => (Digit, 1),
        '.' if rest.starts_with("..") => (Dots, prefix_length(rest, |c| c == '.')),
        '…' => (Dots, length),
        '.' if context.touching.is_some_and(ends_value) => component(rest, context),
        '0'..='9' | '.' => number(rest),
        '\\' => command(rest, context),
        // Dollar signs around a formula are skipped. A dollar sign inside a formula is an error.
        '$' if context.last.is_some()
            && !rest[1..].trim_start_matches([' ', '\t', '\r']).is_empty()
            && !rest[1..]
                .trim_start_matches([' ', '\t', '\r'])
                .starts_with(['\n', '$', ',', '.', ':', ';', '#']) =>
        {
            (Unknown, 1)
        }
        '&' if !rest.starts_with("&&") => (Ampersand, 1),
        // The signs in `5!!` and `!=` are not factorials.
        '!' if context.last.is_some_and(TokenKind::ends_operand)
            && context.last != Some(Factorial)
            && !rest[1..].starts_with(['!', '=']) =>
        {
            (Factorial, 1)
        }
        '=' | '!' if rest[1..].starts_with("==") => {
            (if character == '=' { Equals } else { NotEqual }, 3)
        }
        '!' if !rest.starts_with("!=") && !context.last.is_some_and(TokenKind::ends_operand) => {
            (Not, 1)
        }
        '∑' | 'Σ' if rest[length..].trim_start().starts_with(['_', '^']) => (BigSum, length),
        '∏' | 'Π' if rest[length..].trim_start().starts_with(['_', '^']) => (BigProduct, length),
        '_' if matches!(context.last, Some(BigSum | BigProduct)) => (Underscore, 1),
        '_' if matches!(context.last, Some(CloseBrace | Number | TokenKind::Name))
            && rest[1..].starts_with('{') =>
        {
            (Underscore, 1)
        }
        '_' if context.is_python => (TokenKind::Name, prefix_length(rest, is_name_char)),
        _ if vulgar(character).is_some() => (VulgarFraction, length),
        'ℯ' | '∇' => (TokenKind::Name, length),
        // After an operand, a degree sign is read as a name.
        '°' if context.last.is_some_and(TokenKind::ends_operand) => (TokenKind::Name, length),
        // The point of space in TouchDesigner.
        'm' if rest.starts_with("me.curPos.") => (TokenKind::Name, "me.curPos".len()),
        _ if character.is_alphabetic() => {
            // A name ends after its Unicode subscript.
            let is_below = |c: char| ('₀'..='₉').contains(&c);
            let end = prefix_length(rest, is_name_char);
            let below = rest[..end].find(is_below);
            let end = below.map_or(end, |at| at + prefix_length(&rest[at..], is_below));
            // After an operand, `AND` and `OR` join conditions. Elsewhere they may name functions.
            let is_joint = context.last.is_some_and(TokenKind::ends_operand);
            match &rest[..end] {
                "AND" if is_joint => return (And, end),
                "OR" if is_joint => return (Or, end),
                "NOT" => return (Not, end),
                // A part of `\frac` without braces is a single letter.
                word if context.is_part && !word.is_empty() => return name(rest, length),
                _ => {}
            }
            module(rest, end).map_or_else(|| name(rest, end), |length| (Blank, length))
        }
        '⁻' | '⁺' | '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' => {
            let sign = if matches!(character, '⁻' | '⁺') { length } else { 0 };
            match prefix_length(&rest[sign..], |c| superscript_digit(c).is_some()) {
                0 => (Unknown, length),
                digits => (Superscript, sign + digits),
            }
        }
        _ => {
            // Two characters are tried before one, because `<=` begins with `<`.
            let two = rest.char_indices().nth(2).map_or(rest.len(), |(at, _)| at);
            let found =
                [two, length].into_iter().find_map(|end| Some((token_kind(&rest[..end])?, end)));
            found.unwrap_or((Unknown, length))
        }
    }
}

/// Number of bytes within which a comment must end.
const MAX_COMMENT_BYTES: usize = 10_000;

/// Prompts at the start of a line. The first two are those of Sage.
const PROMPTS: [&str; 4] = ["....:", "sage:", ">>>", "..."];

/// Length of the string at the start of `rest`, if the text is a program in Python. Letters such as
/// `f` and `r` may stand before the quotation mark.
fn python_string(rest: &str, context: LexContext) -> Option<usize> {
    let prefix = prefix_length(rest, |c| "rbfuRBFU".contains(c));
    let quoted = &rest[prefix..];
    let mark = quoted.chars().next().filter(|mark| matches!(mark, '"' | '\''))?;
    if !context.is_python || prefix > 2 || prefix > 0 && context.touching.is_some_and(ends_value) {
        return None;
    }
    let triple = mark.to_string().repeat(3);
    if let Some(inner) = quoted.strip_prefix(&triple) {
        let length = start(inner, MAX_COMMENT_BYTES).find(&triple)?;
        return Some(prefix + length + 6);
    }
    let mut is_escaped = false;
    let end = quoted[1..line_length(quoted)].find(|c| {
        let ends = c == mark && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        ends
    });
    end.map(|end| prefix + end + 2)
}

/// Length of the comment, Markdown mark or line continuation at the start of `rest`.
fn comment(rest: &str, context: LexContext) -> Option<usize> {
    // A comment must be closed. Otherwise a stray opening mark would hide the rest of the text.
    for (open, close) in [("/*", "*/"), ("(*", "*)"), ("\"\"\"", "\"\"\"")] {
        if let Some(inner) = rest.strip_prefix(open) {
            let length = start(inner, MAX_COMMENT_BYTES).find(close);
            return length.map(|length| open.len() + length + close.len());
        }
    }
    // Marks of Markdown: a fence of a code block, or a bullet.
    if context.starts_line && rest.starts_with("```") {
        return Some(line_length(rest));
    }
    if context.starts_line && context.last.is_none() && rest.starts_with('•') {
        return Some('•'.len_utf8());
    }
    // The prompts of Sage and Python.
    let prompts = if context.is_python { &PROMPTS[..] } else { &PROMPTS[..2] };
    let prompt = prompts.iter().find(|prompt| rest.starts_with(**prompt));
    if let Some(prompt) = prompt.filter(|_| context.starts_line) {
        return Some(prompt.len());
    }
    // The prompts of a notebook, such as `In [5]:`.
    if context.is_python && context.starts_line && rest.starts_with("In [") {
        let digits = prefix_length(&rest[4..], |c| c.is_ascii_digit());
        if rest[4 + digits..].starts_with("]:") {
            return Some(digits + 6);
        }
    }
    // A command of the shell in a notebook.
    if context.is_python && context.starts_line && rest.starts_with('!') {
        return Some(line_length(rest));
    }
    // A backslash at the end of a line: the next line continues the statement.
    if let Some(blank) = rest.strip_prefix('\\') {
        let blank = blank.strip_prefix('\r').unwrap_or(blank);
        if blank.starts_with('\n') {
            return Some(rest.len() - blank.len() + 1);
        }
    }
    (context.starts_line && rest.starts_with('%')).then(|| line_length(rest))
}

/// Returns whether a component such as `.xz` can follow a token of `kind`.
fn ends_value(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Name | Component) || kind.is_axis() || kind.is_closer()
}

/// The token of `.xz` or `.sin` after a value, and its length. A method without effect is blank.
fn component(rest: &str, context: LexContext) -> (TokenKind, usize) {
    let word = &rest[1..=prefix_length(&rest[1..], is_name_char)];
    if is_component(word) {
        return (Component, 1 + word.len());
    }
    if method(word).is_some() && rest[1 + word.len()..].starts_with('(') {
        return (Method, 1 + word.len());
    }
    if word == "T" {
        return (Blank, 2);
    }
    if matches!(word, "doit" | "evalf" | "simplify") && rest[1 + word.len()..].starts_with("()") {
        return (Blank, 3 + word.len());
    }
    // A dot before an unknown name is an error. Any other dot begins a number or ends a sentence.
    let is_name =
        context.touching.is_some_and(TokenKind::is_name) && word.starts_with(char::is_alphabetic);
    if is_name { (Unknown, 1) } else { number(rest) }
}

/// The function that has the effect of a method, such as `pow` for Rust's `powi`.
pub(crate) fn method(word: &str) -> Option<&'static str> {
    const ALIKE: &[&str] = &[
        "pow", "sqrt", "cbrt", "abs", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh",
        "cosh", "tanh", "exp", "ln", "log2", "log10", "floor", "ceil", "round", "recip", "min",
        "max", "clamp", "hypot", "length", "square", "diff",
    ];
    const OTHERS: &[(&str, &str)] =
        &[("powi", "pow"), ("powf", "pow"), ("signum", "sign"), ("norm", "length")];
    let alike = ALIKE.iter().find(|name| **name == word).copied();
    let other = || OTHERS.iter().find(|(name, _)| *name == word).map(|(_, function)| *function);
    alike.or_else(other)
}

/// Returns whether `word` names components of a vector, such as `xz` or `rgb`.
fn is_component(word: &str) -> bool {
    let one_of = |letters: &str| word.chars().all(|letter| letters.contains(letter));
    matches!(word.len(), 1..=4) && (one_of("xyzw") || one_of("rgba") || one_of("stpq"))
}

/// Length of a module's name with the dot or `::` after it, if a member of the module follows.
fn module(rest: &str, end: usize) -> Option<usize> {
    if rest[end..].starts_with("::") && matches!(&rest[..end], "std" | "glm" | "plot") {
        return Some(end + 2);
    }
    let member = rest[end..].strip_prefix('.')?;
    let word = &member[..prefix_length(member, is_name_char)];
    let is_member = word.starts_with(char::is_alphabetic) && !is_component(word);
    (is_member && MODULES.contains(&&rest[..end])).then_some(end + 1)
}

/// Length of a slot of Mathematica at the start of `rest`, such as `#1` in `#1 + 1 &`. Elsewhere
/// `#` begins a comment.
fn slot(rest: &str) -> Option<usize> {
    let length = 1 + prefix_length(&rest[1..], |c| c.is_ascii_digit());
    let line = start(&rest[length..], 400);
    let behind = line.trim_start_matches(' ');
    let is_operand = behind.starts_with(|c| "^*/+-)],&[<>=.".contains(c));
    (is_operand && line.contains('&') && !line.contains("&&&")).then_some(length)
}

fn number(rest: &str) -> (TokenKind, usize) {
    let digits = |text: &str| prefix_length(text, |c| c.is_ascii_digit());
    let mut end = digits(rest);
    let is_range = rest[end..].starts_with("..");
    if let Some(decimals) = rest[end..].strip_prefix('.').filter(|_| !is_range) {
        let count = digits(decimals);
        end += 1 + count;
        if end == 1 {
            return (Unknown, 1);
        }
        // C has numbers such as `1.f` and `1.0f`.
        let is_suffix = decimals[..count].bytes().all(|digit| digit == b'0');
        if let (true, Some(after)) = (is_suffix, decimals[count..].strip_prefix('f'))
            && !after.starts_with(is_name_char)
        {
            return (Number, end + 1);
        }
    }
    // Mathematica writes `1.5*^-3` for a number, and Fortran writes `1.0d0`.
    let has_point = rest[..end].contains('.');
    let tail = rest[end..].strip_prefix("*^");
    let tail = tail.or_else(|| rest[end..].strip_prefix(['e', 'E']));
    let fortran = rest[end..].strip_prefix(['d', 'D']).filter(|_| has_point);
    if let Some(exponent) = tail.or(fortran) {
        let exponent = exponent.strip_prefix(['+', '-', '−']).unwrap_or(exponent);
        if digits(exponent) > 0 {
            end = rest.len() - exponent.len() + digits(exponent);
        }
    }
    (Number, end)
}

/// Length of the primes at the start of `rest`, if brackets follow, as in `f'(x)`.
fn primes(rest: &str) -> Option<usize> {
    let length = Some(prefix_length(rest, |c| PRIMES.contains(&c))).filter(|length| *length > 0)?;
    let after = rest[length..].trim_start_matches(' ');
    let after = after.strip_prefix(r"\left").unwrap_or(after);
    after.starts_with(['(', '[']).then_some(length)
}

/// Length of an operator of differentiation at the start of `rest`, such as `\frac{d}{dx}`, d/dx
/// before brackets, or ∂/∂x.
fn differential(rest: &str) -> Option<usize> {
    let begins = |part: &str| {
        let part = part.trim_start();
        part.starts_with(['d', '∂']) || part.starts_with(r"\partial")
    };
    if let Some(inner) = rest.strip_prefix(r"\frac{") {
        let inner = start(inner, 80);
        let (above, below) = inner.split_once("}{").filter(|(above, _)| begins(above))?;
        let mut depth = 1;
        let end = below.find(|c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth == 0
        })?;
        // Above the line, the operator may be followed by the function's name.
        let is_operator = begins(below) && differentiated(above).chars().all(is_name_char);
        return is_operator.then_some(r"\frac{}{}".len() + above.len() + end);
    }
    let (sign, _) = start(rest, 20).split_once('/')?;
    let letter = rest[sign.len() + 1..].strip_prefix(sign)?;
    let length = letter.chars().next().filter(|c| c.is_alphabetic())?.len_utf8();
    let after = letter[length..].trim_start_matches(' ');
    let is_operator = match sign {
        "∂" => true,
        "d" => after.starts_with('(') || after.len() < letter.len() - length,
        _ => false,
    };
    is_operator.then_some(2 * sign.len() + 1 + length)
}

/// The token of a name, and its length with a subscript. The name's letters end at byte `end`.
fn name(rest: &str, end: usize) -> (TokenKind, usize) {
    if let Some(fixed) = token_kind(&rest[..end]).or_else(|| token_kind(&plain_text(&rest[..end])))
    {
        return (fixed, end);
    }
    // The letters may already include the underscore of a subscript.
    let base = rest[..end].strip_suffix('_').map_or(end, str::len);
    if let Some(primes) = primes(&rest[end..]) {
        return (TokenKind::Name, end + primes);
    }
    match rest[base..].strip_prefix('_') {
        Some(subscript) if subscript.starts_with('{') => {
            (TokenKind::Name, base + braced(subscript).map_or(0, |length| 1 + length))
        }
        // `\log_2` is a single name.
        Some(subscript) if base == end && rest.starts_with('\\') => {
            (TokenKind::Name, base + 1 + prefix_length(subscript, |c| c.is_ascii_digit()))
        }
        _ => (TokenKind::Name, end),
    }
}

fn command(rest: &str, context: LexContext) -> (TokenKind, usize) {
    let end = 1 + prefix_length(&rest[1..], |c| c.is_ascii_alphabetic());
    if end == 1 {
        return sign(rest);
    }
    let word = &rest[1..end];
    let after = &rest[end..];
    match word {
        // In `x\y`, the sign is no command, and other systems divide by it in one way or the other.
        "x" | "y" | "z" => return (Unknown, 1),
        "begin" | "end" => return environment(rest, word == "begin", context.last),
        "left" | "right" if after.starts_with('.') => return (Blank, end + 1),
        "text" | "textrm" | "mbox" | "mathrm" | "textnormal" => {
            if let Some(found) = text(after) {
                return (found.0, end + found.1);
            }
        }
        "left" | "right" => {
            let bar = [r"\lvert", r"\rvert", r"\vert", r"\lVert", r"\rVert", r"\Vert", r"\|", "|"];
            let space = prefix_length(after, |c| c == ' ');
            let is_bar = |bar: &&&str| after[space..].starts_with(**bar);
            return match bar.iter().find(is_bar) {
                Some(bar) => {
                    (if word == "left" { OpenBar } else { CloseBar }, end + space + bar.len())
                }
                None => (Blank, end),
            };
        }
        "boxed" | "fbox" | "ensuremath" if after.starts_with('{') => return (Blank, end),
        // A command of MathPartner.
        "implicitPlot" if after.starts_with("3d") => return (TokenKind::Name, end + 2),
        _ if LABELS.contains(&word) && after.starts_with('{') => {
            return (Blank, after.find('}').map_or(rest.len(), |length| end + length + 1));
        }
        _ => {}
    }
    match name(rest, end) {
        (Upright, end) => {
            let is_name =
                rest[end..].starts_with('{') && rest[end + 1..].starts_with(char::is_alphabetic);
            (TokenKind::Name, end + braced(&rest[end..]).filter(|_| is_name).unwrap_or(0))
        }
        found => found,
    }
}

/// The token of a one-character command such as `\{`, or of a Mathematica name such as `\[Theta]`.
fn sign(rest: &str) -> (TokenKind, usize) {
    let two = 1 + rest[1..].chars().next().map_or(0, char::len_utf8);
    match &rest[..two] {
        r"\\" => (RowEnd, 2 + gap(&rest[2..])),
        r"\[" => {
            let word = prefix_length(&rest[2..], |c| c.is_ascii_alphabetic());
            if word > 0 && rest[2 + word..].starts_with(']') {
                (TokenKind::Name, word + 3)
            } else {
                (Blank, 2)
            }
        }
        // A brace before an environment has no meaning, so the brace is skipped.
        r"\{" if rest[2..].trim_start().starts_with(r"\begin{") => (Blank, 2),
        other => token_kind(other).map_or((Unknown, 1), |kind| (kind, two)),
    }
}

/// Length of a LaTeX row spacing such as `[2pt]`; 0 if there is none.
fn gap(rest: &str) -> usize {
    let Some(inner) = rest.strip_prefix('[') else { return 0 };
    let number = prefix_length(inner, |c| c.is_ascii_digit() || matches!(c, '.' | '-'));
    let unit = inner.get(number..number + 3);
    let is_gap = matches!(unit, Some("pt]" | "ex]" | "em]" | "mm]" | "cm]"));
    if number > 0 && is_gap { number + 4 } else { 0 }
}

/// The token of the words in braces after `\text`; `None` if the words may be a name.
fn text(rest: &str) -> Option<(TokenKind, usize)> {
    let inner = rest.strip_prefix('{')?;
    let length = start(inner, 60).find('}')?;
    let words = inner[..length].trim_matches([' ', ',', '.', ';', '~']);
    let kind = match words {
        "and" => And,
        "or" => Or,
        _ if CONDITION_WORDS.contains(&words) => Blank,
        _ if OTHERWISE.contains(&words) => Otherwise,
        _ => return None,
    };
    Some((kind, length + 2))
}

/// Length of a name or number in braces at the start of `rest`, with the braces.
fn braced(rest: &str) -> Option<usize> {
    let inner = rest.strip_prefix('{')?;
    let length = prefix_length(inner, is_name_char);
    (length > 0 && inner[length..].starts_with('}')).then_some(length + 2)
}
