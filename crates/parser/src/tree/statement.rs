//! Determines the kind of each statement and builds the statement's trees.

use crate::lex::scanner::LexedStatement;
use crate::lex::spelling::{is_definable, plain_name};
use crate::lex::token::{Token, bracketed, outside};
use crate::lex::token_kind::TokenKind::*;
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Errors, Fallible, MAX_ERRORS};
use crate::messages::note::{Note, NoteKind};
use crate::span::Span;
use crate::tree::ast::{
    Definition, Expr, ExprKind, Function, Name, NamedValue, Relation, Statement,
};
use crate::tree::builder::{Builder, relation};
use crate::tree::built_statement::{BuiltStatement, with_parts};
use crate::tree::derivatives::operator;
use crate::tree::diagnose::recognise;
use crate::tree::grammar::{Pair, Rule};
use crate::tree::raw_statement::{Head, RawStatement, ValueConversion};
use crate::tree::scope::{
    Conditions, NameMeaning, Scope, built_in, coordinate, is_builder, numbered,
};
use rustc_hash::FxHashSet;
use zeroset_ir::Axis;
use zeroset_ops::FormKind;

/// Largest number of parameters of a function. Each use of a name searches all parameters.
const MAX_PARAMETERS: usize = 64;

/// A statement that the grammar has recognized.
pub struct ParsedStatement<'i> {
    /// The statement's tokens.
    pub raw: &'i RawStatement,
    /// The statement as parsed. The grammar's rule is the kind of the statement.
    pub pair: Pair<'i>,
    /// The left side, if the statement is a definition.
    pub head: Option<Head>,
}

impl ParsedStatement<'_> {
    /// Returns whether the statement draws a curve or a point.
    pub fn is_curve(&self) -> bool {
        self.pair.as_rule() == Rule::curve_line || self.is_located()
    }

    /// Returns whether the statement has no coordinates: a point, a segment, or a curve with a
    /// parameter.
    pub fn is_located(&self) -> bool {
        matches!(self.pair.as_rule(), Rule::path_line | Rule::point_line | Rule::segment_line)
    }
}

/// Parses each of `statements`, whose text is `text`.
///
/// # Errors
/// If there is no statement, or some do not fit the grammar.
pub fn lines<'i>(
    text: &str,
    statements: &'i [RawStatement],
) -> Result<Vec<ParsedStatement<'i>>, Errors> {
    if statements.is_empty() {
        return Err(Error::new(Span::at(text.len()), ErrorKind::Empty).into());
    }
    let mut lines = Vec::new();
    let mut errors = Vec::new();
    for raw in statements {
        let lexed = &raw.lexed;
        let rule = if raw.head.is_some() { Rule::line } else { rule(lexed) };
        match recognise(text, lexed, rule) {
            Ok(pair) => {
                let typed = || (rule == Rule::line).then(|| head(text, lexed, &pair)).flatten();
                let head = raw.head.clone().or_else(typed);
                lines.push(ParsedStatement { raw, pair, head });
            }
            Err(error) => errors.push(*error),
        }
        if errors.len() >= MAX_ERRORS {
            break;
        }
    }
    if errors.is_empty() { Ok(lines) } else { Err(Errors::new(errors)) }
}

/// Returns the grammar's rule for a statement. The first two tokens determine the rule, except for
/// a line such as `light (…`: there, all tokens of the line count.
fn rule(lexed: &LexedStatement) -> Rule {
    let mut kinds = lexed.tokens.iter().map(|token| token.kind);
    let rule = match kinds.next() {
        Some(DomainWord) => Rule::domain_line,
        Some(ViewWord) => Rule::view_line,
        Some(ColorWord) => Rule::color_line,
        Some(LookWord) => Rule::look_line,
        Some(BackgroundWord) => Rule::background_line,
        Some(SettingWord) => Rule::setting_line,
        Some(PointWord) => return Rule::point_line,
        Some(SegmentWord) => return Rule::segment_line,
        Some(CurveWord) => {
            let has_range = outside(&lexed.tokens, For).is_some();
            return if has_range { Rule::path_line } else { Rule::curve_line };
        }
        _ => return Rule::line,
    };
    let in_point = |kind| matches!(kind, Number | Comma | Minus | Plus | CloseParen);
    // `view = 3` and `view(x) = …` are ordinary definitions.
    match kinds.next() {
        // In a line such as `light (1, 2, 3)`, the brackets hold numbers only.
        Some(OpenParen) if rule == Rule::setting_line && kinds.all(in_point) => rule,
        Some(OpenParen) if rule != Rule::domain_line => Rule::line,
        Some(Plus | Minus | SquareRoot | CubeRoot | Not) => rule,
        Some(kind) if kind.is_operator() => Rule::line,
        _ => rule,
    }
}

/// The only child of `pair`; `None` unless it has exactly one child, which matches `rule`.
fn only(pair: Pair<'_>, rule: Rule) -> Option<Pair<'_>> {
    let mut inner = pair.into_inner();
    let first = inner.next()?;
    (inner.next().is_none() && first.as_rule() == rule).then_some(first)
}

/// The left side of a statement that looks like a definition. A statement with `==` never does.
fn head(text: &str, lexed: &LexedStatement, line: &Pair<'_>) -> Option<Head> {
    let typed = |pair: &Pair<'_>| lexed.tokens[lexed.index(pair.as_span().start())].span;
    let name = |pair: Pair<'_>| {
        let span = typed(&pair);
        let is_name = pair.as_rule() == Rule::name;
        is_name.then(|| Name { text: plain_name(&text[span.range()]), span })
    };
    let expression = line.clone().into_inner().find(|p| p.as_rule() == Rule::expression)?;
    let mut sides = expression.into_inner();
    if sides.clone().any(|part| matches!(part.as_rule(), Rule::not | Rule::joint)) {
        return None;
    }
    let mut left = sides.next()?.into_inner();
    let sign = sides.next()?;
    if relation(&sign) != Relation::Equal || &text[typed(&sign).range()] == "==" {
        return None;
    }
    let defined = name(left.next()?)?;
    let parameters = match left.next() {
        None => None,
        Some(group) if group.as_rule() == Rule::group => {
            let arguments = group.into_inner();
            let names =
                arguments.map(|argument| name(only(only(argument, Rule::sum)?, Rule::name)?));
            Some(names.collect::<Option<Vec<Name>>>().filter(|names| !names.is_empty())?)
        }
        Some(_) => return None,
    };
    left.next().is_none().then_some(Head { name: defined, parameters })
}

/// Decides which lines with a left side are definitions. Removes the left side from all others.
pub fn resolve_heads(
    text: &str,
    lines: &mut [ParsedStatement<'_>],
    scope: &mut Scope,
    notes: &mut Vec<Note>,
) {
    for line in lines.iter_mut() {
        if line.raw.head.is_some() {
            continue;
        }
        let is_no_definition = |head: &Head| {
            !may_define(head)
                || is_miscounted(head)
                || is_of_sequence(text, head, &line.raw.lexed)
                || is_product(text, head)
        };
        if line.head.as_ref().is_some_and(is_no_definition) {
            line.head = None;
        }
    }
    resolve_level_sets(text, lines, notes);
    // `hypot(a, b) = 2` is drawn only if a and b have values, so all other names are defined first.
    for line in lines.iter() {
        let Some(head) = &line.head else { continue };
        if head.parameters.is_none() && is_vector(text, &line.raw.lexed) {
            scope.vectors.insert(head.name.text.clone());
        }
        if line.raw.head.is_some() || !is_built_in(head) && head.name.text != "t" {
            scope.define(&head.name.text, head.parameters.as_ref().map(Vec::len));
        }
    }
    for line in lines.iter_mut() {
        let own = line.head.as_ref().filter(|_| line.raw.head.is_none());
        let Some(head) = own.filter(|head| is_built_in(head)) else {
            continue;
        };
        let parameters = head.parameters.as_deref().unwrap_or_default();
        let takes_functions = zeroset_ops::form(&head.name.text).is_some_and(|form| {
            matches!(form.meaning, FormKind::Derivative | FormKind::OfDerivatives(_))
        });
        let known = |name: &Name| match scope.meaning(&name.text, &[]) {
            NameMeaning::Value(_) | NameMeaning::Product => true,
            NameMeaning::Function(_) => takes_functions,
            NameMeaning::Unknown => false,
        };
        if parameters.iter().all(known) {
            let name = head.name.text.clone();
            notes.push(Note { span: head.name.span, kind: NoteKind::BuiltInOnTheLeft { name } });
            line.head = None;
        } else {
            scope.define(&head.name.text, Some(parameters.len()));
        }
    }
}

/// Finds equations that look like definitions. After a definition of `f(x, y, z)`, the equation
/// `f(x, y, z) = 4` is a level surface. After a definition of `f(x, y)`, the equation `f(x, y) = z`
/// is the graph of f.
fn resolve_level_sets(text: &str, lines: &mut [ParsedStatement<'_>], notes: &mut Vec<Note>) {
    let mut defined: FxHashSet<(String, usize)> = FxHashSet::default();
    let numbers = numbers(text, lines);
    for line in lines.iter_mut() {
        let Some(head) = &line.head else { continue };
        let parameters = head.parameters.iter().flatten().map(|name| name.text.as_str());
        if !parameters
            .clone()
            .eq(["x", "y", "z"].into_iter().take(parameters.clone().count().max(2)))
        {
            continue;
        }
        let key = (head.name.text.clone(), parameters.count());
        let is_value = line.raw.head.is_none() && is_value(text, &line.raw.lexed, key.1, &numbers);
        if is_value && defined.contains(&key) {
            notes.push(Note { span: head.name.span, kind: NoteKind::LevelOf { name: key.0 } });
            line.head = None;
        } else {
            defined.insert(key);
        }
    }
}

/// The names whose definitions are plain numbers.
fn numbers(text: &str, lines: &[ParsedStatement<'_>]) -> FxHashSet<String> {
    let named = lines.iter().filter(|line| {
        line.head.as_ref().is_some_and(|head| head.parameters.is_none())
            && right_side(&line.raw.lexed).all(|token| matches!(token.kind, Number | Minus))
    });
    let name =
        |line: &ParsedStatement<'_>| text[line.head.as_ref()?.name.span.range()].to_owned().into();
    named.filter_map(name).collect()
}

/// The tokens after the equals sign, up to a condition in braces or a range.
fn right_side(lexed: &LexedStatement) -> impl Iterator<Item = &Token> {
    let right = lexed.tokens.iter().skip_while(|token| token.kind != Equals).skip(1);
    right.take_while(|token| !matches!(token.kind, OpenBrace | In))
}

/// Returns whether the right side after `f(…) =` is a constant instead of the body of f. For two
/// parameters, z counts as a constant.
fn is_value(
    text: &str,
    lexed: &LexedStatement,
    parameters: usize,
    numbers: &FxHashSet<String>,
) -> bool {
    right_side(lexed).filter(|token| token.kind.is_name()).all(|token| {
        let name = &text[token.span.range()];
        parameters == 2 && name == "z"
            || numbers.contains(name)
            || matches!(
                built_in(name),
                NameMeaning::Function(_) | NameMeaning::Value(NamedValue::Constant(_))
            )
    })
}

/// Returns whether a left side can be defined. A name made of coordinates, such as `xy`, cannot,
/// nor can an operator such as ∂/∂x.
fn may_define(head: &Head) -> bool {
    let name = head.name.text.as_str();
    if name == "t" {
        return head.parameters.is_none();
    }
    let is_operator = operator(name).is_some() || name.contains(['{', '}', '/']);
    // Programs name the coordinates of a curve so: `xt(t) = cos(t)`.
    let of_time = head.parameters.as_ref().is_some_and(|all| all.iter().any(|one| one.text == "t"));
    if of_time && name.len() > 1 {
        return !is_operator;
    }
    !is_operator && !name.chars().all(|c| matches!(c, 'x' | 'y' | 'z' | 't'))
}

/// Returns whether the right side of a definition is a vector by its form: values in brackets, or a
/// function that gives a vector.
fn is_vector(text: &str, lexed: &LexedStatement) -> bool {
    const FUNCTIONS: [&str; 7] = ["vec2", "vec3", "vec4", "vector", "Vector", "normalize", "cross"];
    let right: Vec<Token> = right_side(lexed).copied().collect();
    let is_call = right.first().is_some_and(|first| FUNCTIONS.contains(&&text[first.span.range()]));
    let group = &right[usize::from(is_call)..];
    let Some((inner, [])) = bracketed(group) else { return false };
    is_call || outside(inner, Comma).is_some()
}

/// Returns whether the left side is a product such as `xsin(z)` that occurs once in the text. A
/// function of this name would be called elsewhere.
fn is_product(text: &str, head: &Head) -> bool {
    let name = head.name.text.as_str();
    let own = |parameters: &Vec<Name>| parameters.iter().all(|one| coordinate(&one.text).is_some());
    let begins = name.starts_with(['x', 'y', 'z']);
    begins
        && head.parameters.as_ref().is_some_and(own)
        && text.matches(name).count() == 1
        && Scope::default().product_with_call(name, &[]).is_some()
}

/// Returns whether the left side is a valid call of a function of the language.
fn is_built_in(head: &Head) -> bool {
    accepts(head) == Some(true)
}

/// Returns whether a line is an equation such as `P_3(x) = z`: its left side names a function of a
/// sequence, and its right side lacks the parameter, which is a coordinate.
fn is_of_sequence(text: &str, head: &Head, lexed: &LexedStatement) -> bool {
    let parameters = head.parameters.as_deref().unwrap_or_default();
    let [parameter] = parameters else { return false };
    numbered(&head.name.text).is_some()
        && coordinate(&parameter.text).is_some()
        && right_side(lexed).all(|token| text[token.span.range()] != parameter.text)
}

/// Returns whether the left side calls a function of the language with too few or too many
/// coordinates. Such a line defines nothing, because its parameters would hide the coordinates.
fn is_miscounted(head: &Head) -> bool {
    let mut parameters = head.parameters.iter().flatten();
    parameters.all(|p| coordinate(&p.text).is_some()) && accepts(head) == Some(false)
}

/// Returns whether the language's function called `head` takes as many arguments as `head` has
/// parameters; `None` if there is no such function, or `head` has no parameters.
fn accepts(head: &Head) -> Option<bool> {
    let count = head.parameters.as_ref()?.len();
    if let Some(form) = zeroset_ops::form(&head.name.text) {
        let is_own = |arity| (form.name == head.name.text && count == arity).then_some(true);
        return match form.meaning {
            FormKind::Vector(_) | FormKind::Matrix(_) => Some(true),
            FormKind::OfVectors(function) if !function.is_complex() => {
                Some(count == function.arity())
            }
            FormKind::Multiply => Some(count == 2),
            FormKind::Choose
            | FormKind::Pieces
            | FormKind::Sum
            | FormKind::Product
            | FormKind::Iterate => None,
            // Many texts define such names themselves, as in `re(x, y) = …` and `D(x, y, z) = …`.
            FormKind::OfVectors(function) => is_own(function.arity()),
            FormKind::OfDerivatives(_) => is_own(1),
            FormKind::Derivative => is_own(count.max(2)),
        };
    }
    match built_in(&head.name.text) {
        // Many texts define such names themselves, as in `box(x, y, z) = …` and `scale = 2`.
        NameMeaning::Function(_) if is_builder(&head.name.text) => None,
        NameMeaning::Function(callee) => {
            Some(Scope::default().signatures(&callee).function(count).is_some())
        }
        NameMeaning::Value(_) | NameMeaning::Product | NameMeaning::Unknown => None,
    }
}

/// Builds the trees of one line.
///
/// # Errors
/// If a formula of the line is wrong.
///
/// # Panics
/// If `line` is not of the grammar's rule for a line with a formula.
pub fn build(
    text: &str,
    line: ParsedStatement<'_>,
    scope: &Scope,
    limits: &Limits,
) -> Fallible<BuiltStatement> {
    let locals = line.head.as_ref().and_then(|head| head.parameters.as_deref());
    let mut builder =
        Builder::new(text, &line.raw.lexed, scope, locals.unwrap_or_default(), limits);
    builder.aliases = line.raw.aliases.clone();
    let mut parts = line.pair.into_inner();
    let expression = parts.next().expect("a line has an expression");
    let mut range = None;
    let mut restrictions = Vec::new();
    let mut braces = None;
    for part in parts {
        let span = builder.span(&part);
        match part.as_rule() {
            Rule::range => {
                let bounds = part.into_inner().next().expect("a range has bounds");
                range = Some((builder.bounds(bounds)?, span));
            }
            Rule::restriction => {
                braces = Some(span);
                restrictions.extend(builder.restrictions(part)?);
            }
            _ => {}
        }
    }
    let statement = if let Some(head) = &line.head {
        if let Some(span) = braces {
            let error = Error::new(span, ErrorKind::RestrictedDefinition);
            let bounds = slider_bounds(&head.name, &restrictions);
            let typed = builder.text[line.raw.lexed.span.start..span.start].trim_end();
            let meant = bounds.map(|(low, high)| format!("{typed} in [{low}, {high}]"));
            return Err(error.suggest_optional(line.raw.lexed.span, meant));
        }
        let range = range.map(|(ends, _)| ends);
        Statement::Define(match &line.raw.head {
            Some(_) => set(&mut builder, head, expression, line.raw.conversion.as_ref())?,
            None => define(&mut builder, head, expression, range)?,
        })
    } else {
        if let Some((_, span)) = range {
            return Err(Error::new(span, ErrorKind::RangeOutsideDefinition));
        }
        let expr = builder.expression(expression)?;
        if let ExprKind::Call(Function::Vector(size), _) = &expr.kind
            && text[expr.span.range()].starts_with('(')
        {
            let place = Span::at(expr.span.end - 1);
            let meant = (*size == 2).then_some(", 0");
            let error = Error::new(expr.span, ErrorKind::Tuple);
            return Err(meant.into_iter().fold(error, |error, meant| error.suggest(place, meant)));
        }
        let expr = if line.raw.is_height && !expr.is_condition() {
            let z = ExprKind::Name(NamedValue::Coordinate(Axis::Z));
            Expr::new(z, expr.span).equals(expr)
        } else {
            expr
        };
        Statement::Draw { expr, restrictions }
    };
    let Builder { notes, used, .. } = builder;
    Ok(BuiltStatement { statement, span: line.raw.lexed.span, notes, used })
}

/// The ends of a slider's range, if the braces hold a condition such as `0 < a < 3`.
fn slider_bounds<'e>(name: &Name, braces: &'e [Expr]) -> Option<(&'e Expr, &'e Expr)> {
    let [Expr { kind: ExprKind::Compare(first, rest), .. }] = braces else { return None };
    let [(before, middle), (behind, last)] = rest.as_slice() else { return None };
    let is_own =
        matches!(&middle.kind, ExprKind::Name(NamedValue::Defined(own)) if *own == name.text);
    let is = |one: Relation, other: Relation| {
        [before, behind].into_iter().all(|relation| *relation == one || *relation == other)
    };
    match is_own {
        true if is(Relation::Less, Relation::LessEqual) => Some((first, last)),
        true if is(Relation::Greater, Relation::GreaterEqual) => Some((last, first)),
        _ => None,
    }
}

/// Builds the definition for a variable that a program assigns. `expression` is the right side.
fn set(
    builder: &mut Builder<'_>,
    head: &Head,
    expression: Pair<'_>,
    conversion: Option<&ValueConversion>,
) -> Fallible<Definition> {
    check_head(head, false, false)?;
    let mut body = builder.expression(expression)?;
    let span = body.span;
    if conversion.is_none() && builder.scope.conditions == Conditions::OfMathMod {
        body = builder.as_number(body);
    }
    let is_condition = body.is_condition();
    match conversion {
        Some(ValueConversion::Indicator) => {
            if !is_condition {
                // In C, any value other than 0 is true.
                body = body.compared(Relation::Unequal, Expr::of_digits("0", span), span);
            }
            body = body.indicator(span);
        }
        _ if is_condition => return Err(Error::new(span, ErrorKind::ConditionAsValue)),
        Some(ValueConversion::Part(letter)) => {
            body = Expr::new(ExprKind::Component(Box::new(body), letter.to_string()), span);
        }
        Some(ValueConversion::Write { letters, before, size }) => {
            builder.used.extend(before.defined().map(str::to_owned));
            if let ExprKind::Name(NamedValue::Defined(name)) = before {
                let meaning = builder.scope.meaning(name, &builder.locals);
                if !matches!(meaning, NameMeaning::Value(NamedValue::Defined(_))) {
                    return Err(builder.unknown(name, name, head.name.span));
                }
            }
            body = Expr::new(with_parts(letters, before, *size, &body.kind, span), span);
        }
        None => {}
    }
    let (name, parameters) = (head.name.clone(), head.parameters.clone());
    Ok(Definition { name, parameters, body, range: None })
}

/// Fails if the left side of a definition has too many parameters, equal parameters, or a name that
/// cannot be defined. `is_function` and `is_keyword` describe the defined name.
fn check_head(head: &Head, is_function: bool, is_keyword: bool) -> Fallible<()> {
    let parameters = head.parameters.as_deref().unwrap_or_default();
    if parameters.len() > MAX_PARAMETERS {
        let limit = MAX_PARAMETERS;
        return Err(Error::new(head.name.span, ErrorKind::TooManyParameters { limit }));
    }
    for (index, parameter) in parameters.iter().enumerate() {
        if parameters[..index].contains(parameter) {
            let name = parameter.text.clone();
            return Err(Error::new(parameter.span, ErrorKind::DuplicateParameter { name }));
        }
    }
    // LaTeX can spell names that plain text cannot. Such names cannot be defined.
    let word = std::iter::once(&head.name).chain(parameters).find(|n| !is_definable(&n.text));
    if let Some(name) = (is_function || is_keyword).then_some(&head.name).or(word) {
        let kind = ErrorKind::Reserved { name: name.text.clone(), is_function };
        return Err(Error::new(name.span, kind));
    }
    Ok(())
}

/// Builds the definition `head = …`. Reads only the right side of `expression`.
fn define(
    builder: &mut Builder<'_>,
    head: &Head,
    expression: Pair<'_>,
    range: Option<(Expr, Expr)>,
) -> Fallible<Definition> {
    let name = &head.name;
    let is_function = head.parameters.is_none()
        && !is_builder(&name.text)
        && matches!(built_in(&name.text), NameMeaning::Function(_));
    // `domain(x) = …` is probably a mistyped `domain` line.
    let is_keyword = head.parameters.is_some() && name.text == "domain";
    check_head(head, is_function, is_keyword)?;
    let span = builder.span(&expression);
    let mut sides = expression.into_inner().skip(2);
    let body = sides.next().expect("a definition has a right side");
    let second = sides.next().filter(|second| {
        // In `f(x, y, z) = x^2 + y^2 - z = 0`, the second equals sign is ignored.
        let mut rest = sides.clone();
        let zero = rest.next().is_some_and(|side| builder.typed(&side) == "0");
        let is_zero = relation(second) == Relation::Equal && zero && rest.next().is_none();
        !(is_zero && head.parameters.is_some())
    });
    if let Some(second) = second {
        let place = builder.span(&second);
        return Err(if relation(&second) == Relation::Equal {
            Error::new(place, ErrorKind::SeveralEquals)
        } else {
            let end = sides.last().map_or(place, |last| builder.span(&last));
            Error::new(builder.span(&body).to(end), ErrorKind::DefinitionIsCondition)
        });
    }
    let body = builder.nested(span, 1, |b| b.sum(body))?;
    if body.is_condition() {
        return Err(Error::new(body.span, ErrorKind::DefinitionIsCondition));
    }
    Ok(Definition { name: name.clone(), parameters: head.parameters.clone(), body, range })
}

/// Returns whether an expression is a number, perhaps negated. A name defined so is a slider.
pub fn is_plain_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_) => true,
        ExprKind::Negate(inner) => inner.number().is_some(),
        _ => false,
    }
}
