//! Enters lines into a document's text. Knows statements and lines, but not their meaning. A
//! "drawing" is a statement that draws a surface.

use super::values::{Place, kept_range, name, place, right_side};
use std::ops::Range;
use zeroset_dialect::is_scene_function;
use zeroset_parser::Limits;
use zeroset_parser::settings::setting_word;
use zeroset_parser::tree::ast::{ExprKind, Function, Statement};
use zeroset_parser::tree::scope::canonical;
use zeroset_scene::number::number;
use zeroset_syntax::{is_expression_list, parse};

/// Returns `text` after `line` is entered.
///
/// - A definition replaces the one with the same name; a single value is replaced in place.
/// - A drawing replaces all others, or is added to them if `adding`. It is never hidden. So does a
///   surface in spherical or cylindrical coordinates, such as `phi = pi/3`, though it may look like
///   a definition.
/// - A new function of a program that draws it, such as `map` of a shader, replaces them, too.
/// - A setting such as `domain`, `view` or `color` replaces earlier lines of that setting.
/// - A new number keeps the range of the old value, widened to hold the number.
///
/// `text` and `line` may contain errors, which are reported when the result is read. If the text
/// has errors that `line` does not correct, the result is `line` alone.
pub fn entered(text: &str, line: &str, adding: bool) -> String {
    let limits = Limits::default();
    let line = line.trim();
    let base = text.trim_end();
    if base.is_empty() || parse(base, &limits).is_err() && !completes(base, line) {
        return line.to_owned();
    }
    let joined = format!("{base}\n{line}");
    if let Some(word) = scene_word(line) {
        let (new, rest) = setting_and_rest(line);
        // Style lines apply to the drawings below them, so the line goes to the top.
        let is_style = matches!(word, "color" | "opacity" | "material" | "width" | "hidden");
        if !rest.is_empty() {
            let is_of_added = is_style && adding && draws(base, rest);
            let joined = format!("{base}\n{}{line}", usual_style(base));
            let with_setting = || entered(&entered(text, new, adding), rest, adding);
            return if is_of_added { joined } else { with_setting() };
        }
        let kept = without_lines(base, word);
        return if is_style {
            let (comment, rest) = kept.split_at(leading_comments(&kept));
            format!("{comment}{new}\n{rest}")
        } else {
            format!("{kept}\n{new}")
        };
    }
    let Ok(statements) = parse(&joined, &limits) else {
        // A formula cannot join an expression list, and so replaces it.
        let replaces = is_expression_list(base) && parse(line, &limits).is_ok();
        return if replaces { line.to_owned() } else { joined };
    };
    let start = base.len() + 1;
    // The parser adds statements that are not in the text, such as definitions of coordinates.
    let typed =
        statements.iter().map(|one| (statement_span(one), one)).filter(|(_, one)| is_typed(one));
    let (old, new): (Vec<_>, Vec<_>) = typed.partition(|(span, _)| span.start < start);
    if let Some(text) = with_value_replaced(base, line, &old, &new) {
        return text;
    }
    let surfaces = coordinate_surfaces(base, &old);
    let is_known = |(_, one): &Placed<'_>| old.iter().any(|(_, other)| name(other) == name(one));
    let draws = new.iter().any(|(_, one)| name(one).is_none())
        || draws_function(line) && !new.iter().any(is_known)
        || !adding && is_coordinate_surface(base, line, &old, &surfaces);
    let replaced = |(span, one): &Placed<'_>| match name(one) {
        Some(own) => {
            let is_drawing = draws && !adding && surfaces.contains(&span.start);
            is_drawing || new.iter().any(|(_, other)| name(other) == Some(own))
        }
        None => draws && !adding,
    };
    let mut kept = joined.clone();
    for (span, _) in old.iter().rev().filter(|one| replaced(one)) {
        kept.replace_range(statement_piece(&joined, span), "");
    }
    // If the text needs a function's old definition, keep both. The later definition takes effect.
    if parse(&kept, &limits).is_err() {
        return joined;
    }
    if draws && adding {
        kept.insert_str(kept.len() - line.len(), &usual_style(base));
    } else if draws && !adding {
        let typed = kept.split_off(kept.len() - line.len());
        let before = without_lines(&kept, "hidden");
        kept = if before.is_empty() { typed } else { format!("{}\n{typed}", before.trim_end()) };
    }
    kept.trim_start_matches('\n').to_owned()
}

/// Where those surfaces begin that `base` draws, and that are among the definitions of `old`: an
/// equation such as `r = 1 + cos(theta)` defines r once another line uses r. A line without a
/// coordinate on its right side, such as `r = 2`, may be meant as either, and is a definition then.
fn coordinate_surfaces(base: &str, old: &[Placed<'_>]) -> Vec<usize> {
    let defines = |(_, one): &&Placed<'_>| name(one).is_some();
    if !old.iter().any(|one| defines(&one)) {
        return Vec::new();
    }
    let drawn = drawings(base);
    let is_surface = |(span, one): &&Placed<'_>| {
        let Statement::Define(definition) = one else { return false };
        drawn.iter().any(|other| other.start == span.start)
            && words(&base[definition.body.span.range()])
                .any(|word| matches!(word, "x" | "y" | "z") || canonical(word).is_some())
    };
    old.iter().filter(is_surface).map(|(span, _)| span.start).collect()
}

/// Returns whether a line such as `phi = pi/3` is meant as a surface: it is one if it stands alone,
/// and no line of `base` uses its name, apart from `surfaces` and an equation like it. `r = 2` is
/// not: people give r a value before they type the formula with it.
fn is_coordinate_surface(base: &str, line: &str, old: &[Placed<'_>], surfaces: &[usize]) -> bool {
    let head = |text: &str| text.split('=').next().and_then(|head| canonical(head.trim()));
    let own = head(line);
    let uses = |(span, _): &Placed<'_>| {
        let typed = &base[span.clone()];
        let is_surface = surfaces.contains(&span.start) || head(typed) == own;
        !is_surface && words(typed).any(|word| canonical(word) == own)
    };
    own.is_some_and(|own| own != "r") && !drawings(line).is_empty() && !old.iter().any(uses)
}

/// The names in a text.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphabetic() && c != '_').filter(|word| !word.is_empty())
}

/// Returns whether a line has only definitions, and the text parses once they are added.
pub(super) fn completes(text: &str, line: &str) -> bool {
    let limits = Limits::default();
    parse(line, &limits).is_ok_and(|all| all.iter().all(|one| name(one).is_some()))
        && parse(&format!("{}\n{line}", text.trim_end()), &limits).is_ok()
}

/// The lines after which a drawing at the end of the text has its usual color and opacity and is
/// shown, whatever style lines are above it. Empty if no style line is above it.
fn usual_style(text: &str) -> String {
    // Whether a color, an opacity and a hiding are in effect.
    let mut open = [false; 3];
    for line in text.split(['\n', ';']) {
        let mut words = line.split_whitespace().skip(1);
        match scene_word(line) {
            Some("color") => {
                open[0] = words.next() != Some("auto");
                let is_share = |word: &str| word.ends_with('%') || word.parse::<f64>().is_ok();
                open[1] |= words.any(is_share);
            }
            Some("opacity") => open[1] = !matches!(words.next(), Some("100%" | "1")),
            Some("hidden") => open[2] = words.next() != Some("off"),
            _ => {}
        }
    }
    let lines = ["color auto\n", "opacity 100%\n", "hidden off\n"];
    lines.into_iter().zip(open).filter(|(_, is_open)| *is_open).map(|(line, _)| line).collect()
}

/// The text without the setting lines that begin with this word.
fn without_lines(text: &str, word: &str) -> String {
    let kept: Vec<&str> = text.lines().filter(|line| scene_word(line) != Some(word)).collect();
    kept.join("\n")
}

/// The text without its `number`-th drawing, counted from 1.
///
/// # Errors
/// If there is no such drawing: the number of drawings, or 0 if the text has errors.
pub(super) fn without_drawing(text: &str, number: usize) -> Result<String, usize> {
    let drawings = drawings(text);
    let Some(span) = number.checked_sub(1).and_then(|index| drawings.get(index)) else {
        return Err(drawings.len());
    };
    let mut kept = text.to_owned();
    kept.replace_range(statement_piece(text, span), "");
    Ok(kept.trim_start_matches('\n').trim_end().to_owned())
}

/// The text with `line` in place of its `number`-th drawing, counted from 1.
///
/// # Errors
/// If there is no such drawing: the number of drawings, or 0 if the text has errors.
pub(super) fn with_drawing(text: &str, number: usize, line: &str) -> Result<String, usize> {
    let drawings = drawings(text);
    let Some(span) = number.checked_sub(1).and_then(|index| drawings.get(index)) else {
        return Err(drawings.len());
    };
    let mut changed = text.to_owned();
    changed.replace_range(span.clone(), line);
    Ok(changed)
}

/// The `number`-th drawing of a text, counted from 1, as typed.
pub(super) fn drawing(text: &str, number: usize) -> Option<&str> {
    text.get(drawings(text).get(number.checked_sub(1)?)?.clone())
}

/// The byte ranges of the drawings in a text: the surfaces in order, then the curves and points.
fn drawings(text: &str) -> Vec<Range<usize>> {
    let statements = parse(text, &Limits::default()).unwrap_or_default();
    let draws = |one: &&Statement| name(one).is_none() && is_typed(one);
    let drawings = statements.iter().filter(draws);
    let (curves, surfaces): (Vec<&Statement>, Vec<&Statement>) =
        drawings.partition(|one| matches!(one, Statement::Curve(_)));
    surfaces.into_iter().chain(curves).map(statement_span).collect()
}

/// Returns whether entering a line into a text adds a drawing. The text matters: `x = r` may define
/// `r`, but is a drawing if the text already defines `r`.
pub(super) fn draws(text: &str, line: &str) -> bool {
    if scene_word(line).is_some() {
        let (_, rest) = setting_and_rest(line);
        return !rest.is_empty() && draws(text, rest);
    }
    let joined = format!("{text}\n{line}");
    if drawings(&joined).iter().any(|span| span.start > text.len()) {
        return true;
    }
    let statements = parse(&joined, &Limits::default()).unwrap_or_default();
    let all = statements.iter().map(|one| (statement_span(one), one));
    let old: Vec<_> = all.filter(|(span, one)| span.end <= text.len() && is_typed(one)).collect();
    is_coordinate_surface(text, line, &old, &coordinate_surfaces(text, &old))
}

/// Returns whether a program draws one of its functions without a statement that says so, since its
/// name is usual for a scene, such as `map` in a shader.
pub(super) fn draws_function(program: &str) -> bool {
    let is_called = |one: &Statement| match one {
        Statement::Draw { expr, .. } => {
            let ExprKind::Call(Function::Defined(name), _) = &expr.kind else { return false };
            !is_typed(one) && is_scene_function(name)
        }
        Statement::Define(_) | Statement::Curve(_) => false,
    };
    parse(program, &Limits::default()).is_ok_and(|all| all.iter().any(is_called))
}

/// The text without those comments, `domain` lines and `view` lines that also occur in `lines`.
pub(super) fn without_scenery(text: &str, lines: &str) -> String {
    let is_scenery = |line: &str| {
        line.trim_start().starts_with('#') || matches!(scene_word(line), Some("domain" | "view"))
    };
    let gone: Vec<&str> = lines.lines().filter(|line| is_scenery(line)).collect();
    let kept: Vec<&str> = text.lines().filter(|line| !gone.contains(line)).collect();
    kept.join("\n")
}

/// Returns whether a statement was typed, not added by the parser.
fn is_typed(statement: &Statement) -> bool {
    let span = match statement {
        Statement::Draw { expr, .. } => expr.span,
        Statement::Define(definition) => definition.name.span,
        Statement::Curve(curve) => curve.span,
    };
    span.start < span.end
}

/// The text with one value replaced in place, which keeps the order of parameters. `None` unless
/// `line` is a single definition of a value that the text defines exactly once.
fn with_value_replaced(
    base: &str,
    line: &str,
    old: &[Placed<'_>],
    new: &[Placed<'_>],
) -> Option<String> {
    let value = |(_, one): &Placed<'_>| match one {
        Statement::Define(value) if value.parameters.is_none() => Some(value.name.text.clone()),
        Statement::Define(_) | Statement::Draw { .. } | Statement::Curve(_) => None,
    };
    let [one] = new else { return None };
    let wanted = value(one)?;
    let mut places = old.iter().filter(|other| value(other).as_ref() == Some(&wanted));
    let (Some((span, _)), None) = (places.next(), places.next()) else { return None };
    if line.contains(['\n', ';', '#']) {
        return None;
    }
    let rest = &base[span.end..];
    let end = span.end + end_of_statement(rest).unwrap_or(rest.len());
    let range = kept_range(base, line, &wanted).unwrap_or_default();
    let line = format!("{line}{range}");
    let space = if is_comment(&base[end..]) { " " } else { "" };
    Some(format!("{}{line}{space}{}", &base[..span.start], &base[end..]))
}

/// The text with `name` set to `value`. The definition gets `range` if it has no range, and is
/// added if it is missing. `None` if the result would not parse.
pub(super) fn with_value(text: &str, name: &str, value: &str, range: &str) -> Option<String> {
    let Some(Place { body, range: typed }) = place(text, name) else {
        // If the value comes from the command line, the text parses only with the definition added.
        let joined = format!("{}\n{name} = {value} in {range}", text.trim_end());
        return parse(&joined, &Limits::default()).is_ok().then_some(joined);
    };
    let with = |what: &str| format!("{}{what}{}", &text[..body.start], &text[body.end..]);
    if let Some((low, high)) = typed {
        let holds = || {
            let (low, high) = (number(&text[low])?, number(&text[high])?);
            Some((low..=high).contains(&number(value)?))
        };
        // A value from the command line may lie outside the range. Then extend the range.
        let extended = || entered(text, &format!("{name} = {value}"), false);
        return Some(if holds() == Some(false) { extended() } else { with(value) });
    }
    // Some definitions, such as those in programs, cannot have a range.
    let is_read = |new: &String| right_side(new, name).is_some_and(|(read, _)| read == value);
    [format!("{value} in {range}"), value.to_owned()].iter().map(|what| with(what)).find(is_read)
}

/// The byte range of a statement in the text, and the statement.
type Placed<'a> = (Range<usize>, &'a Statement);

/// The first word of a setting line such as `view top`. `None` for a formula or a definition.
fn scene_word(line: &str) -> Option<&'static str> {
    let word = line.split_whitespace().next()?;
    // A setting's word may also be defined as a value: `domain = 2` is a definition.
    let defines = line.trim_start()[word.len()..].trim_start().starts_with(['=', '(']);
    setting_word(word).filter(|_| !defines)
}

/// A setting at the start of a line, and what is typed behind it, as in `domain 2; x = 1`.
fn setting_and_rest(line: &str) -> (&str, &str) {
    let mut is_quoted = false;
    let is_end = |c: char| {
        is_quoted ^= c == '"';
        matches!(c, ';' | '\n') && !is_quoted
    };
    match line.split_once(is_end) {
        Some((setting, rest)) => (setting.trim_end(), rest.trim_start()),
        None => (line, ""),
    }
}

/// Length in bytes of the comment lines at the start of a text.
fn leading_comments(text: &str) -> usize {
    text.split_inclusive('\n').take_while(|line| line.starts_with('#')).map(str::len).sum()
}

fn statement_span(statement: &Statement) -> Range<usize> {
    match statement {
        Statement::Draw { expr, restrictions, .. } => {
            let ends = restrictions.iter().map(|one| one.span.end);
            expr.span.start..ends.fold(expr.span.end, usize::max)
        }
        Statement::Define(definition) => {
            let ends = definition.range.iter().map(|range| range.1.span.end);
            definition.name.span.start..ends.fold(definition.body.span.end, usize::max)
        }
        Statement::Curve(curve) => curve.span.range(),
    }
}

/// The part of the text to remove with a statement. It starts after the last line break or
/// semicolon before the statement. It ends with the next line break or semicolon, or with the line
/// of a comment that comes first.
fn statement_piece(text: &str, span: &Range<usize>) -> Range<usize> {
    let start = text[..span.start].rfind(['\n', ';']).map_or(0, |at| at + 1);
    let rest = &text[span.end..];
    let end = end_of_statement(rest).map_or(rest.len(), |at| {
        if is_comment(&rest[at..]) {
            rest[at..].find('\n').map_or(rest.len(), |line| at + line + 1)
        } else {
            at + 1
        }
    });
    start..span.end + end
}

/// Offset of the first line break, semicolon or comment in `rest`.
fn end_of_statement(rest: &str) -> Option<usize> {
    let end = rest.find(['\n', ';', '#']);
    rest.find("//").filter(|at| end.is_none_or(|end| *at < end)).or(end)
}

fn is_comment(rest: &str) -> bool {
    rest.starts_with('#') || rest.starts_with("//")
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "float map(vec3 p) { return length(p) - 1.0; }";

    #[test]
    fn drawings_replace_drawings_and_definitions_their_namesakes() {
        for (text, line, expected) in [
            ("", " x+y ", "x+y"),
            ("_0 var-x", "x+y", "x+y"),
            ("_0 var-x", "_1 neg _0", "_0 var-x\n_1 neg _0"),
            ("# list\n_0 var-x", "color red", "# list\ncolor red\n_0 var-x"),
            ("x+y", "x-y", "x-y"),
            ("r = 2\nx^2+y^2 = r", "z = r", "r = 2\nz = r"),
            ("r = 2\nx^2+y^2 = r", "r = 3", "r = 3\nx^2+y^2 = r"),
            ("s = 1; r = 2 # old\nx = r", "r = 3", "s = 1; r = 3 # old\nx = r"),
            ("r = 2 in [0, 5]\nx = r", "r = 3", "r = 3 in [0, 5]\nx = r"),
            ("r = 2 in [0, 5]\nx = r", "r = 9/2 + 2", "r = 9/2 + 2 in [0, 9/2 + 2]\nx = r"),
            ("r = 2 in [0, 2pi]\nx = r", "r = -1", "r = -1 in [-1, 2pi]\nx = r"),
            ("r = 2 in [0, 5]\nx = r", "r = y", "r = y\nx = r"),
            ("r = 2 in [0, 5]\nx = r", "r = 3 in [1, 9]", "r = 3 in [1, 9]\nx = r"),
            ("x = 1; y = 2; r = 3", "z = r", " r = 3\nz = r"),
            ("x = 1 # one; two\ny = 3", "z", "z"),
            ("x = 1\nclip 1, 0, 0, 0", "clip 0, 1, 0, 0", "x = 1\nclip 0, 1, 0, 0"),
            ("x = 1\naxes on", "axes off", "x = 1\naxes off"),
            ("# A\nopacity 50%\nx = 1", "opacity 80%", "# A\nopacity 80%\nx = 1"),
            ("color red\nx = 1", "colour blue", "colour blue\nx = 1"),
            ("material gloss\nx = 1", "material metal", "material metal\nx = 1"),
            ("x = 1\ny = 1", "ground on", "x = 1\ny = 1\nground on"),
            ("x = 1 // one; two\ny = 3", "z", "z"),
            ("r = 2 // a radius; old\nx = r", "r = 3", "r = 3 // a radius; old\nx = r"),
            ("x = 1 {y > 0,\n z > 0}\nr = 1", "z = r", "r = 1\nz = r"),
            ("# Title\nx", "y", "# Title\ny"),
            ("g(a) = a\nz = g(x)", "g(a) = 2a", "z = g(x)\ng(a) = 2a"),
            ("z = r^2", "r = 2", "z = r^2\nr = 2"),
            ("r = 1 + cos(theta)", "z = x", "z = x"),
            ("r = 1 + cos(theta)", "r^2 + z^2 = 9", "r^2 + z^2 = 9"),
            ("a = 2\nr = a + cos(theta)", "r^2 + z^2 = a", "a = 2\nr^2 + z^2 = a"),
            (
                "r = 1 + cos(theta)",
                "curve r = 1 + cos(theta), z = 0",
                "curve r = 1 + cos(theta), z = 0",
            ),
            ("ρ = 4 cos(φ)", "φ = pi/3", "φ = pi/3"),
            ("rho = 4 cos(phi)", "phi = pi/3", "phi = pi/3"),
            ("x = 1", "theta = pi/4", "theta = pi/4"),
            ("x = 1", "r = 2", "x = 1\nr = 2"),
            ("r = 2", "r^2 + z^2 = 9", "r = 2\nr^2 + z^2 = 9"),
            ("x^2 = a\na = 2", MAP, &format!("a = 2\n{MAP}")),
            (MAP, "z = map(vec3(x, y, 0))", &format!("{MAP}\nz = map(vec3(x, y, 0))")),
            (
                "float map(vec3 p) { return p.x; }\nmap(vec3(x, y, z)) = 2",
                MAP,
                &format!("float map(vec3 p) {{ return p.x; }}\nmap(vec3(x, y, z)) = 2\n{MAP}"),
            ),
            ("x = 1", "f(a) = a^2", "x = 1\nf(a) = a^2"),
            ("float d = length(p) - 1.;", "z = x", "float d = length(p) - 1.;\nz = x"),
            (
                "float f(vec3 p) { float a = p.x; return a; }",
                "float f(vec3 p) { return p.y; }",
                "float f(vec3 p) { float a = p.x; return a; }\nfloat f(vec3 p) { return p.y; }",
            ),
        ] {
            assert_eq!(entered(text, line, false), expected, "{text:?} and {line:?}");
        }
    }

    #[test]
    fn a_value_is_changed_where_it_stands() {
        for (text, value, expected) in [
            ("r = 2 in [0, 5] # radius\nx = r", "3.5", "r = 3.5 in [0, 5] # radius\nx = r"),
            ("r = 2 in [0, 5] # radius\nx = r", "7", "r = 7 in [0, 7] # radius\nx = r"),
            ("r = 2\nx = r", "-1", "r = -1 in [0, 9]\nx = r"),
            ("s = 1; r = -2; x = r", "0.5", "s = 1; r = 0.5 in [0, 9]; x = r"),
            ("x = r", "0.5", "x = r\nr = 0.5 in [0, 9]"),
        ] {
            assert_eq!(with_value(text, "r", value, "[0, 9]").as_deref(), Some(expected), "{text}");
        }
        let program = "float r = 0.5;\nfloat d = length(p) - r;";
        let new = with_value(program, "r", "0.75", "[0, 1]").expect("a value");
        assert!(parse(&new, &Limits::default()).is_ok(), "{new}");
        assert_eq!(right_side(&new, "r").map(|(value, _)| value).as_deref(), Some("0.75"));
    }

    #[test]
    fn a_drawing_may_join_the_others() {
        assert_eq!(entered("x = 1", "y = 1", true), "x = 1\ny = 1");
        assert_eq!(entered("r = 1\nx = r", "r = 2", true), "r = 2\nx = r");
    }

    #[test]
    fn what_is_typed_is_seen_whatever_was_hidden() {
        let text = "r = 1\nhidden\nx = r\nhidden off\ny = r\nhidden\nz = r";
        assert_eq!(entered(text, "x = y", false), "r = 1\nx = y");
        assert_eq!(entered(text, "x = y", true), format!("{text}\nhidden off\nx = y"));
        for (text, lines, added) in [
            ("color tomato 50%\nx = 1", "color auto\nopacity 100%", "y = 1"),
            ("color tomato; x = 1", "color auto", "y = 1"),
            ("opacity 0.3\ncolor viridis(z, -1, 1)\nx = 1", "color auto\nopacity 100%", "y = 1"),
            ("opacity 50%\nx = 1", "opacity 100%", "color red; y = 1"),
            ("color red\nx = 1", "color auto", "curve x = 0, y = 0"),
        ] {
            assert_eq!(entered(text, added, true), format!("{text}\n{lines}\n{added}"));
        }
        for (text, added) in [
            ("color red\nx = 1\ncolor auto", "y = 1"),
            ("color red 50%\nx = 1\ncolor auto\nopacity 100%\nz = 1", "y = 1"),
            ("color red\nx = 1", "r = 2"),
            ("title \"color red\"\nx = 1", "y = 1"),
        ] {
            assert_eq!(entered(text, added, true), format!("{text}\n{added}"));
        }
        let shown = "hidden\nx = 1\nhidden off\ny = 1";
        assert_eq!(entered(shown, "z = 1", true), format!("{shown}\nz = 1"));
        assert_eq!(entered("hidden\nx = r\nr = 2", "r = 1", false), "hidden\nx = r\nr = 1");
    }

    #[test]
    fn lines_about_the_scene_replace_their_like() {
        assert_eq!(entered("domain 2\nx+y", "domain 3", false), "x+y\ndomain 3");
        assert_eq!(entered("# A\nx+y", "color red", false), "# A\ncolor red\nx+y");
        assert_eq!(entered("color red\nx+y", "color blue", false), "color blue\nx+y");
        assert_eq!(
            entered("domain 2\nr = 1\nx", "domain 3; r = y; x = r", false),
            "domain 3\nr = y; x = r"
        );
        assert_eq!(
            entered("color red\nx", "color blue; width 2\ny", false),
            "width 2\ncolor blue\ny"
        );
        assert_eq!(entered("x", "color blue; y", true), "x\ncolor blue; y");
        assert_eq!(entered("x", "title \"a; b\"", false), "x\ntitle \"a; b\"");
        assert!(draws("", "domain 2; x^2+y^2 = 1") && !draws("", "domain 2; a = 3"));
    }

    #[test]
    fn a_drawing_is_taken_away_by_its_number() {
        let text = "# Two\nx = 1\nr = 2; y = r # the second\nz = 3 {x > 0}";
        assert_eq!(
            without_drawing(text, 1).as_deref(),
            Ok("# Two\nr = 2; y = r # the second\nz = 3 {x > 0}")
        );
        assert_eq!(without_drawing(text, 2).as_deref(), Ok("# Two\nx = 1\nr = 2;z = 3 {x > 0}"));
        assert_eq!(
            without_drawing(text, 3).as_deref(),
            Ok("# Two\nx = 1\nr = 2; y = r # the second")
        );
        assert_eq!(without_drawing(text, 4), Err(3));
        assert_eq!(without_drawing(text, 0), Err(3));
    }

    #[test]
    fn a_drawing_is_changed_where_it_stands() {
        let text = "# Two\nx = 1\ncolor red\ny = r; r = 2 # last";
        assert_eq!(drawing(text, 2), Some("y = r"));
        assert_eq!(
            with_drawing(text, 2, "z = r").as_deref(),
            Ok("# Two\nx = 1\ncolor red\nz = r; r = 2 # last")
        );
        assert_eq!(with_drawing(text, 3, "z"), Err(2));
        assert_eq!((drawing(text, 0), drawing(text, 3)), (None, None));
    }

    #[test]
    fn scenery_is_what_came_with_the_formula_and_nobody_set() {
        let came = "# A\n# b\ndomain 2\nview top\ncolor red\nx";
        assert_eq!(without_scenery(came, came), "color red\nx");
        assert_eq!(without_scenery("# A\ndomain 3\nx", came), "domain 3\nx");
        for (text, line) in [("", "x+y"), ("", "y = x^2"), ("r = 2", "x^2+y^2 = r")] {
            assert!(draws(text, line), "{line}");
        }
        for line in ["a = 2", "domain 2", "x^2+y^2 = r"] {
            assert!(!draws("", line), "{line}");
        }
    }

    #[test]
    fn what_is_wrong_is_kept_for_the_reader_to_see_but_not_built_upon() {
        assert_eq!(entered("x+y", "x+", false), "x+y\nx+");
        assert_eq!(entered("x+(", "x*y", false), "x*y");
    }
}
