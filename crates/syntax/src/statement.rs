//! Statements: which kind each is, and its trees.

use crate::ast::{Definition, Expr, ExprKind, Name, Relation, Statement};
use crate::build::{Builder, relation};
use crate::diagnose::diagnose;
use crate::error::{Error, ErrorKind, Fallible, MOST};
use crate::grammar::{Pair, Rule, Zeroset};
use crate::limits::Limits;
use crate::note::{Note, NoteKind};
use crate::scan::{Piece, TokenKind, is_operator_word, scan};
use crate::scope::{Meaning, Scope};
use crate::span::Span;
use crate::spelling::plain_name;
use pest::Parser as _;
use rustc_hash::FxHashSet;

/// The words that begin a line which is no formula.
pub(crate) const SETTINGS: [&str; 4] = ["domain", "view", "color", "colour"];

/// Each use of a name looks through the parameters, so their number is bounded.
const MOST_PARAMETERS: usize = 64;

/// What the first words of a statement make of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LineKind {
    Formula,
    Domain,
    View,
    Color,
}

/// A statement that the grammar has recognised.
pub(crate) struct Line<'i> {
    pub kind: LineKind,
    pub pair: Pair<'i>,
    pub span: Span,
    pub head: Option<Head>,
}

/// `name` or `name(parameters)` before a `=`.
#[derive(Clone, Debug)]
pub(crate) struct Head {
    pub name: Name,
    pub parameters: Option<Vec<Name>>,
}

/// A statement with its trees, and what was noticed while building them.
pub(crate) struct Built {
    pub statement: Statement,
    pub span: Span,
    pub notes: Vec<Note>,
    pub used: FxHashSet<String>,
}

/// Splits `text` and recognises each statement.
pub(crate) fn lines<'i>(text: &'i str, limits: &Limits) -> Result<Vec<Line<'i>>, Vec<Error>> {
    let pieces = scan(text, limits).map_err(|error| vec![*error])?;
    if pieces.is_empty() {
        return Err(vec![*Error::new(Span::at(text.len()), ErrorKind::Empty)]);
    }
    let mut lines = Vec::new();
    let mut errors = Vec::new();
    for piece in &pieces {
        match line(text, piece) {
            Ok(line) => lines.push(line),
            Err(error) => errors.push(*error),
        }
        if errors.len() >= MOST {
            break;
        }
    }
    if errors.is_empty() { Ok(lines) } else { Err(errors) }
}

fn line<'i>(text: &'i str, piece: &Piece) -> Fallible<Line<'i>> {
    let kind = line_kind(text, piece);
    let rule = match kind {
        LineKind::Formula => Rule::line,
        LineKind::Domain => Rule::domain_line,
        LineKind::View => Rule::view_line,
        LineKind::Color => Rule::color_line,
    };
    let source = &text[piece.span.range()];
    let mut pairs =
        Zeroset::parse(rule, source).map_err(|error| diagnose(text, piece, kind, &error))?;
    let pair = pairs.next().expect("a statement is one pair");
    let head = if kind == LineKind::Formula { head(&pair, piece.span.start) } else { None };
    Ok(Line { kind, pair, span: piece.span, head })
}

fn line_kind(text: &str, piece: &Piece) -> LineKind {
    let token = |index: usize| piece.tokens.get(index);
    let kind = match token(0).map(|first| &text[first.span.range()]) {
        Some("domain") => LineKind::Domain,
        Some("view") => LineKind::View,
        Some("color" | "colour") => LineKind::Color,
        _ => return LineKind::Formula,
    };
    // `view = 3` and `view(x) = …` are definitions like any other.
    let Some(second) = token(1) else {
        return kind;
    };
    let sign = &text[second.span.range()];
    let is_operator = second.kind == TokenKind::Sign && !matches!(sign, "-" | "+" | "−");
    if is_operator || (second.kind == TokenKind::Open('(') && kind != LineKind::Domain) {
        LineKind::Formula
    } else {
        kind
    }
}

/// The only child of `pair`, if it is one pair of the given rule.
fn only(pair: Pair<'_>, rule: Rule) -> Option<Pair<'_>> {
    let mut inner = pair.into_inner();
    let first = inner.next()?;
    (inner.next().is_none() && first.as_rule() == rule).then_some(first)
}

/// The powers of a sum that is a single run.
fn single_run(sum: Pair<'_>) -> Option<Vec<Pair<'_>>> {
    let run = only(only(sum, Rule::product)?, Rule::run)?;
    Some(run.into_inner().collect())
}

fn name_of(power: Pair<'_>, base: usize) -> Option<Name> {
    let pair = only(power, Rule::name)?;
    let span = pair.as_span();
    Some(Name {
        text: plain_name(pair.as_str()),
        span: Span::new(base + span.start(), base + span.end()),
    })
}

/// The left side of a statement, if it has the form of a definition; `==` states and never defines.
fn head(line: &Pair<'_>, base: usize) -> Option<Head> {
    let expression = line.clone().into_inner().find(|p| p.as_rule() == Rule::expression)?;
    let negation = only(only(expression, Rule::conjunction)?, Rule::negation)?;
    let mut chain = only(negation, Rule::chain)?.into_inner();
    let left = chain.next()?;
    let sign = chain.next()?;
    if relation(&sign) != Relation::Equal || sign.as_str().trim() == "==" {
        return None;
    }
    let mut powers = single_run(left)?.into_iter();
    let name = name_of(powers.next()?, base)?;
    let parameters = match powers.next() {
        None => None,
        Some(group) => {
            let arguments = only(only(group, Rule::group)?, Rule::arguments)?;
            let mut parameters = Vec::new();
            for argument in arguments.into_inner() {
                let sum = only(argument, Rule::conjunction)
                    .and_then(|p| only(p, Rule::negation))
                    .and_then(|p| only(p, Rule::chain))
                    .and_then(|p| only(p, Rule::sum))?;
                let mut powers = single_run(sum)?.into_iter();
                parameters.push(name_of(powers.next()?, base)?);
                if powers.next().is_some() {
                    return None;
                }
            }
            Some(parameters)
        }
    };
    powers.next().is_none().then_some(Head { name, parameters })
}

/// Decides for every line with a head whether it defines; those that do not lose their head.
pub(crate) fn settle_heads(lines: &mut [Line<'_>], scope: &mut Scope, notes: &mut Vec<Note>) {
    for line in lines.iter_mut() {
        if line.head.as_ref().is_some_and(|head| !may_define(head) || is_miscounted(head)) {
            line.head = None;
        }
    }
    // Whether `hypot(a, b) = 2` draws depends on whether a and b have values, so values come first.
    for head in lines.iter().filter_map(|line| line.head.as_ref()) {
        if !is_built_in(head) && head.name.text != "t" {
            scope.define(&head.name.text, head.parameters.as_ref().map(Vec::len));
        }
    }
    for line in lines.iter_mut() {
        let Some(head) = line.head.as_ref().filter(|head| is_built_in(head)) else {
            continue;
        };
        let parameters = head.parameters.as_deref().unwrap_or_default();
        let known = |name: &Name| {
            matches!(scope.meaning(&name.text, &[]), Meaning::Value(_) | Meaning::Product)
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

/// Whether the left side could define anything: coordinates, and names made of them only, are drawn.
fn may_define(head: &Head) -> bool {
    let name = head.name.text.as_str();
    if name == "t" {
        return head.parameters.is_none();
    }
    !name.chars().all(|c| matches!(c, 'x' | 'y' | 'z' | 't'))
}

/// Whether the left side is a call of a function of the language, with as many arguments as that takes.
fn is_built_in(head: &Head) -> bool {
    let Some(parameters) = &head.parameters else {
        return false;
    };
    accepts(&head.name.text, parameters.len()) == Some(true)
}

/// Whether the left side is a call of a function of the language on coordinates, but not on as many as it takes:
/// an equation with a slip rather than a definition, whose parameters would hide the coordinates.
fn is_miscounted(head: &Head) -> bool {
    let Some(parameters) = &head.parameters else {
        return false;
    };
    let are_coordinates = parameters.iter().all(|p| matches!(p.text.as_str(), "x" | "y" | "z"));
    are_coordinates && accepts(&head.name.text, parameters.len()) == Some(false)
}

/// Whether the function of the language called `name` takes `count` arguments; `None` if there is none.
fn accepts(name: &str, count: usize) -> Option<bool> {
    match Scope::default().meaning(name, &[]) {
        Meaning::Function(callee) => Some(Scope::default().counts(&callee).accept(count)),
        Meaning::Value(_) | Meaning::Product | Meaning::Unknown => None,
    }
}

/// Builds the trees of one line.
pub(crate) fn build(text: &str, line: Line<'_>, scope: &Scope, limits: &Limits) -> Fallible<Built> {
    let locals: &[Name] = match &line.head {
        Some(head) => head.parameters.as_deref().unwrap_or_default(),
        None => &[],
    };
    let mut builder = Builder::new(text, line.span.start, scope, locals, limits);
    let mut expression = None;
    let mut range = None;
    let mut restrictions = Vec::new();
    let mut braces = None;
    for child in line.pair.into_inner() {
        match child.as_rule() {
            Rule::expression => expression = Some(child),
            Rule::range => {
                let span = builder.span(&child);
                let mut ends = Vec::new();
                for bounds in child.into_inner().filter(|p| p.as_rule() == Rule::bounds) {
                    for end in bounds.into_inner() {
                        ends.push(builder.value(end)?);
                    }
                }
                let mut ends = ends.into_iter();
                range = ends.next().zip(ends.next()).map(|ends| (ends, span));
            }
            Rule::restriction => {
                braces = Some(builder.span(&child));
                for condition in child.into_inner().flat_map(Pair::into_inner) {
                    let condition = builder.expression(condition)?;
                    if !condition.is_condition() {
                        return Err(Error::new(condition.span, ErrorKind::RestrictionNotCondition));
                    }
                    restrictions.push(condition);
                }
            }
            _ => {}
        }
    }
    let expression = expression.expect("a line has an expression");
    let statement = if let Some(head) = &line.head {
        if let Some(span) = braces {
            return Err(Error::new(span, ErrorKind::RestrictedDefinition));
        }
        let definition = define(&mut builder, head, expression)?;
        Statement::Define(Definition { range: range.map(|(ends, _)| ends), ..definition })
    } else {
        if let Some((_, span)) = range {
            return Err(Error::new(span, ErrorKind::RangeOutsideDefinition));
        }
        let expr = builder.expression(expression)?;
        Statement::Draw { expr, restrictions }
    };
    Ok(Built { statement, span: line.span, notes: builder.notes, used: builder.used })
}

/// The definition `head = …`, whose left side is not built, for it names what does not exist yet.
fn define(builder: &mut Builder<'_>, head: &Head, expression: Pair<'_>) -> Fallible<Definition> {
    let name = &head.name;
    let parameters = head.parameters.as_deref().unwrap_or_default();
    if parameters.len() > MOST_PARAMETERS {
        let limit = MOST_PARAMETERS;
        return Err(Error::new(name.span, ErrorKind::TooManyParameters { limit }));
    }
    for (index, parameter) in parameters.iter().enumerate() {
        if parameters[..index].contains(parameter) {
            let name = parameter.text.clone();
            return Err(Error::new(parameter.span, ErrorKind::DuplicateParameter { name }));
        }
    }
    let built_in = Scope::default().meaning(&name.text, &[]);
    let is_function = head.parameters.is_none() && matches!(built_in, Meaning::Function(_));
    // `domain(x) = …` is a domain line with a slip.
    let is_keyword = head.parameters.is_some() && name.text == "domain";
    // LaTeX can spell names that cannot be written otherwise.
    let reserved = |name: &&Name| is_operator_word(&name.text);
    let word = std::iter::once(name).chain(parameters).find(reserved);
    if let Some(name) = (is_function || is_keyword).then_some(name).or(word) {
        let kind = ErrorKind::Reserved { name: name.text.clone(), is_function };
        return Err(Error::new(name.span, kind));
    }
    let span = builder.span(&expression);
    let sides: Vec<Pair<'_>> = expression
        .into_inner()
        .flat_map(Pair::into_inner)
        .flat_map(Pair::into_inner)
        .flat_map(Pair::into_inner)
        .collect();
    let [_, _, body, more @ ..] = sides.as_slice() else {
        return Err(Error::new(span, ErrorKind::Empty));
    };
    if let Some(second) = more.first() {
        let place = builder.span(second);
        return Err(if relation(second) == Relation::Equal {
            Error::new(place, ErrorKind::SeveralEquals)
        } else {
            let end = more.last().map_or(place, |last| builder.span(last));
            Error::new(builder.span(body).to(end), ErrorKind::DefinitionIsCondition)
        });
    }
    let body = builder.nested(span, |b| b.sum(body.clone()))?;
    if body.is_condition() {
        return Err(Error::new(body.span, ErrorKind::DefinitionIsCondition));
    }
    Ok(Definition { name: name.clone(), parameters: head.parameters.clone(), body, range: None })
}

/// Whether an expression is a number with or without a sign: the right side of a slider.
pub(crate) fn is_plain_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_) => true,
        ExprKind::Negate(inner) => inner.number().is_some(),
        _ => false,
    }
}
