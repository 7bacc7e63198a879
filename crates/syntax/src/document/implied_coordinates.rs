//! Defines coordinates that a text uses without defining them: r, rho, theta and phi, and the point
//! of space in programs.
//!
//! The used names together determine the coordinate system, and a note states the definitions. A
//! definition in the text takes precedence.

use crate::lower::constant::evaluate_text;
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_parser::lex::arrangement::statements;
use zeroset_parser::lex::spelling::plain_name;
use zeroset_parser::lex::token::{Token, span_of};
use zeroset_parser::lex::token_kind::TokenKind::{self, Component, X, Y, Z};
use zeroset_parser::tree::ast::{Definition, ExprKind, Name, NamedValue, Statement};
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::grammar::Rule;
use zeroset_parser::tree::raw_statement::ValueConversion;
use zeroset_parser::tree::scope::{NameMeaning, Scope, built_in, canonical};
use zeroset_parser::tree::statement::ParsedStatement;
use zeroset_parser::{Limits, Note, NoteKind, Span};

/// A name, and the text of the name's definition.
type ImpliedDefinition = (&'static str, &'static str);

/// Names of the point of space. The last one is LaTeX's `\vec{r}`.
const POINTS: [&str; 3] = ["p", "pos", "vec_r"];

/// The unit vectors of LaTeX, such as `\hat{i}`.
const UNIT_VECTORS: [ImpliedDefinition; 3] =
    [("hat_i", "vec3(1, 0, 0)"), ("hat_j", "vec3(0, 1, 0)"), ("hat_k", "vec3(0, 0, 1)")];

pub(crate) const CYLINDER_RADIUS: &str = "sqrt(x^2 + y^2)";
const SPHERE_RADIUS: &str = "sqrt(x^2 + y^2 + z^2)";
pub(crate) const AZIMUTH: &str = "atan2(y, x)";

/// The azimuth from 0 to 2π, for texts that have angles above π.
const FULL_AZIMUTH: &str = "mod(atan2(y, x), 2*pi)";

/// The uses of each name. A use is the index of a line and a place in the text.
type Uses = FxHashMap<&'static str, Vec<(usize, Span)>>;

/// Collects the uses of r, rho, theta, phi, x, y and z, and of the point names `p` and `pos`.
/// Leaves out defined names, parameters, and variables of a program.
fn uses(text: &str, lines: &[ParsedStatement<'_>], scope: &Scope) -> Uses {
    let mut uses = Uses::default();
    for (index, line) in lines.iter().enumerate().filter(|(_, line)| !line.is_located()) {
        let raw = line.raw;
        let own = line.head.as_ref().filter(|_| raw.head.is_none()).map(|head| head.name.span);
        let parameters = line.head.iter().filter_map(|head| head.parameters.as_ref()).flatten();
        let hidden: Vec<&str> = parameters
            .map(|name| name.text.as_str())
            .chain(raw.aliases.iter().map(|(name, _)| name))
            .collect();
        for token in &line.raw.lexed.tokens {
            let name = match token.kind {
                X => Some("x"),
                Y => Some("y"),
                Z => Some("z"),
                TokenKind::Name => {
                    let name = plain_name(&text[token.span.range()]);
                    if scope.is_defined(&name) {
                        continue;
                    }
                    let units = UNIT_VECTORS.iter().map(|(name, _)| *name);
                    let point = POINTS.into_iter().chain(units).find(|point| *point == name);
                    let named = point.or_else(|| canonical(&name));
                    // `rcos(theta)` is a product with r.
                    let radius = || {
                        let function = name.strip_prefix('r').filter(|rest| rest.len() > 1)?;
                        let is_called = text[token.span.end..].starts_with('(');
                        let is_function = matches!(built_in(function), NameMeaning::Function(_))
                            && built_in(&name) == NameMeaning::Unknown;
                        (is_called && is_function).then_some("r")
                    };
                    named.or_else(radius).filter(|_| !hidden.contains(&name.as_str()))
                }
                _ => None,
            };
            if let (Some(name), true) = (name, own != Some(token.span)) {
                uses.entry(name).or_default().push((index, token.span));
            }
        }
        let before = match &raw.conversion {
            Some(ValueConversion::Write { before, .. }) => Some(before),
            _ => None,
        };
        if let Some(ExprKind::Name(NamedValue::Defined(name))) = before
            && let Some(point) = ["p", "pos"].into_iter().find(|point| point == name)
        {
            uses.entry(point).or_default().push((index, line.raw.lexed.span));
        }
    }
    uses
}

/// Turns a definition of r, rho, theta or phi, such as `r = 1 + cos(theta)`, into an equation if no
/// other line uses the defined name. The right side must contain another of these four names that
/// is not defined, or contain z without x and y, or be constant. A constant may also be used by
/// lines that relate it to other coordinates alone. Returns notes on equations with a constant
/// right side.
pub(crate) fn make_definitions_equations(
    text: &str,
    lines: &mut [ParsedStatement<'_>],
    scope: &Scope,
    is_program: bool,
) -> Vec<Note> {
    let is_function = |line: &ParsedStatement<'_>| {
        line.head.as_ref().is_some_and(|head| head.parameters.is_some())
    };
    // A function may be what is drawn. A constant beside it is then one of its numbers.
    let may_be_alone = !is_program && !lines.iter().any(is_function);
    let is_one_line = lines.len() == 1 && !text.trim().contains('\n');
    let used_by_curve = |lines: &[ParsedStatement<'_>], own: &str| {
        let is_own = |token: &Token| canonical(&plain_name(&text[token.span.range()])) == Some(own);
        let curves = lines.iter().filter(|line| line.is_located());
        curves.flat_map(|line| &line.raw.lexed.tokens).any(is_own)
    };
    let mut notes = Vec::new();
    let mut defined: FxHashSet<String> = lines
        .iter()
        .filter_map(|line| line.head.as_ref())
        .map(|head| canonical(&head.name.text).map_or(head.name.text.clone(), str::to_owned))
        .collect();
    let uses = uses(text, lines, scope);
    let is_here = |index: usize, name: &str| {
        uses.get(name).is_some_and(|all| all.binary_search_by_key(&index, |(at, _)| *at).is_ok())
    };
    let is_constant = |index: usize| {
        !["x", "y", "z", "r", "rho", "theta", "phi"].into_iter().any(|name| is_here(index, name))
    };
    // Constants come first: once drawn, they are no values for the other lines.
    let mut order: Vec<usize> = (0..lines.len()).collect();
    order.sort_by_key(|index| !is_constant(*index));
    for index in order {
        let line = &lines[index];
        let Some(head) = line.head.as_ref().filter(|head| head.parameters.is_none()) else {
            continue;
        };
        let Some(own) = canonical(&head.name.text).filter(|_| line.raw.head.is_none()) else {
            continue;
        };
        // Uses are in the order of their lines, so checking the first and the last use is enough.
        let used_elsewhere = uses.get(own).is_some_and(|all| {
            let mut ends = all.first().into_iter().chain(all.last());
            ends.any(|(at, _)| *at != index)
        });
        let is_related = used_elsewhere
            && uses[own].iter().all(|(at, _)| *at == index || relates(&lines[*at], *at, &uses));
        let is_here = |name: &str| is_here(index, name);
        let in_terms_of_others = ["r", "rho", "theta", "phi"]
            .into_iter()
            .any(|other| other != own && is_here(other) && !defined.contains(other));
        // `theta = z/2` is an equation. A formula with x or y may define the name instead.
        let has_part = |rule| line.pair.clone().into_inner().any(|part| part.as_rule() == rule);
        let is_restricted = has_part(Rule::restriction);
        let in_terms_of_z = is_here("z") && !is_restricted && !is_here("x") && !is_here("y");
        // Texts of several lines often define a radius that they do not use, but not the others.
        let is_alone = may_be_alone
            && !is_restricted
            && !has_part(Rule::range)
            && is_constant(index)
            && (own != "r" || is_one_line || is_related)
            && !scope.is_defined(own)
            && !used_by_curve(lines, own);
        let is_drawn = (in_terms_of_others || in_terms_of_z || is_alone) && !used_elsewhere;
        if is_drawn || is_alone && is_related {
            let name = own.to_owned();
            let kind = if is_related {
                NoteKind::CoordinateAmongOthers { name }
            } else {
                NoteKind::CoordinateAlone { name }
            };
            if is_alone {
                notes.push(Note { span: head.name.span, kind });
            }
            lines[index].head = None;
            defined.remove(own);
        }
    }
    notes
}

/// Returns whether line number `index` relates two of r, rho, theta and phi, without x, y and z, as
/// in `rho*cos(phi) = 1` and `r = 1 + cos(theta)`.
fn relates(line: &ParsedStatement<'_>, index: usize, uses: &Uses) -> bool {
    let is_here =
        |name: &&str| uses.get(name).is_some_and(|all| all.iter().any(|(at, _)| *at == index));
    let defined = match &line.head {
        Some(head) => match canonical(&head.name.text) {
            // Other lines take it for a value.
            Some(own) if !uses.contains_key(own) => Some(own),
            _ => return false,
        },
        None => None,
    };
    let names = ["r", "rho", "theta", "phi"];
    let used = names.iter().filter(|name| is_here(name) || defined == Some(**name)).count();
    used > 1 && !["x", "y", "z"].iter().any(is_here)
}

/// Returns the implied definitions, and notes that state them. Adds the names to `scope`. With
/// `has_angle`, phi is an angle even if no other of these names occurs.
pub(crate) fn implied(
    text: &str,
    lines: &[ParsedStatement<'_>],
    scope: &mut Scope,
    is_program: bool,
    limits: &Limits,
    has_angle: bool,
) -> (Vec<BuiltStatement>, Vec<Note>) {
    let uses = uses(text, lines, scope);
    let place = |name: &str| {
        let free = uses.get(name).filter(|_| !scope.is_defined(name));
        free.and_then(|all| all.iter().map(|(_, span)| *span).min())
    };
    let mut notes = Vec::new();
    let mut given: Vec<ImpliedDefinition> = Vec::new();
    for (name, body) in UNIT_VECTORS {
        if let Some(span) = place(name) {
            let definitions = format!("{name} = {body}");
            let kind = NoteKind::Coordinates { system: "a unit vector", definitions };
            notes.push(Note { span, kind });
            given.push((name, body));
        }
    }
    for name in POINTS {
        let is_arrow = name.starts_with("vec_");
        let is_vector = is_arrow
            || is_program
            || has_components(text, lines, name)
            || has_length(text, lines, name);
        if let (Some(span), true) = (place(name), is_vector) {
            notes.push(Note { span, kind: NoteKind::PointOfSpace { name: name.to_owned() } });
            given.push((name, "vec3(x, y, z)"));
        }
    }
    let [r, rho, theta, phi] = ["r", "rho", "theta", "phi"].map(place);
    // Beside x or y in a line, r is probably a radius whose definition is missing, unless they only
    // cut the drawing.
    let plane: FxHashSet<usize> = ["x", "y"]
        .iter()
        .filter_map(|name| uses.get(name))
        .flatten()
        .map(|(line, _)| *line)
        .collect();
    let is_radius = |at: &usize| plane.contains(at) && !only_cuts(text, &lines[*at]);
    let with_plane = uses.get("r").is_some_and(|all| all.iter().any(|(at, _)| is_radius(at)));
    // An equation between constants has no surface, so its φ is an angle.
    let is_constant = |line: &ParsedStatement<'_>| {
        let tokens = &line.raw.lexed.tokens;
        let is_fixed = |token: &Token| match token.kind {
            TokenKind::Name => {
                built_in(&plain_name(&text[token.span.range()])) != NameMeaning::Unknown
            }
            kind => !kind.is_axis(),
        };
        line.head.is_none()
            && tokens.iter().any(|token| token.kind == TokenKind::Equals)
            && tokens.iter().all(is_fixed)
    };
    // The plain word is the golden ratio.
    let is_sign =
        |(at, span): &(usize, Span)| &text[span.range()] != "phi" && is_constant(&lines[*at]);
    let has_angle = has_angle || uses.get("phi").is_some_and(|all| all.iter().any(is_sign));
    let is_angle = has_angle || r.is_some() || rho.is_some() || theta.is_some();
    let phi = phi.filter(|_| is_angle);
    let r = r.filter(|_| !with_plane || theta.is_some());
    let names = [r, rho, theta, phi].map(|place| place.is_some());
    if let Some((system, mut definitions)) = system(names, uses.contains_key("z")) {
        let place = [r, rho, theta, phi].into_iter().flatten().min();
        definitions.retain(|(name, _)| {
            let index = ["r", "rho", "theta", "phi"].iter().position(|other| other == name);
            index.is_some_and(|index| names[index]) || (*name == "rho" && names[3]) && !names[0]
        });
        for (name, body) in &mut definitions {
            if *body == AZIMUTH && goes_beyond_half(text, lines, name, limits) {
                *body = FULL_AZIMUTH;
            }
        }
        let listed: Vec<String> =
            definitions.iter().map(|(name, body)| format!("{name} = {body}")).collect();
        let definitions_text = listed.join("; ");
        let kind = NoteKind::Coordinates { system, definitions: definitions_text };
        notes.push(Note { span: place.unwrap_or_default(), kind });
        given.extend(definitions);
    }
    for (name, _) in &given {
        scope.imply(name);
    }
    let built =
        given.iter().filter_map(|(name, body)| define(name, &[], body, scope, limits)).collect();
    (built, notes)
}

/// Functions whose arguments may each be a condition that cuts a drawing.
const JOINTS: [&str; 7] = ["max", "min", "union", "intersect", "intersection", "subtract", "blend"];

/// Returns whether x and y occur only in half-spaces such as `x > 0`, and so cut what is drawn, as
/// in `max((r-1)^2 + z^2 - 0.1, -x) <= 0` and `z = r^2 {x > 0}`.
fn only_cuts(text: &str, line: &ParsedStatement<'_>) -> bool {
    let is_joint = |token: &Token| {
        token.kind == TokenKind::Name && JOINTS.contains(&&text[token.span.range()])
    };
    let is_end = |token: &Token| {
        use TokenKind::{And, CloseBrace, Comma, OpenBrace, Or, Semicolon};
        matches!(token.kind, And | Or | Comma | Semicolon | OpenBrace | CloseBrace)
    };
    line.raw.lexed.tokens.split(is_end).all(|part| {
        let part = match part {
            [first, second, rest @ ..]
                if is_joint(first) && second.kind == TokenKind::OpenParen =>
            {
                rest
            }
            other => other,
        };
        let is_linear = |token: &Token| {
            use TokenKind::{CloseParen, Minus, Number, Plus};
            matches!(token.kind, X | Y | Number | Plus | Minus | CloseParen)
                || token.kind.is_inequality()
        };
        !part.iter().any(|token| matches!(token.kind, X | Y)) || part.iter().all(is_linear)
    })
}

/// Returns whether an inequality such as `theta <= 3*pi/2` bounds an angle by more than π.
fn goes_beyond_half(
    text: &str,
    lines: &[ParsedStatement<'_>],
    angle: &str,
    limits: &Limits,
) -> bool {
    let is_end = |token: &&Token| {
        token.kind.is_relation()
            || token.kind.is_closer()
            || matches!(token.kind, TokenKind::And | TokenKind::Or | TokenKind::Comma)
    };
    let is_large = |tokens: &[Token]| {
        let span = span_of(tokens).and_then(|span| text.get(span.range()));
        let value = span.and_then(|typed| evaluate_text(typed, limits).ok());
        value.is_some_and(|value| value.bounds().lo > std::f64::consts::PI)
    };
    lines.iter().any(|line| {
        let tokens = &line.raw.lexed.tokens;
        (0..tokens.len()).any(|at| {
            let typed = plain_name(&text[tokens[at].span.range()]);
            if canonical(&typed) != Some(angle) {
                return false;
            }
            let (before, behind) = (&tokens[..at], &tokens[at + 1..]);
            match (before.last().map(|token| token.kind), behind.first().map(|token| token.kind)) {
                (_, Some(TokenKind::Less | TokenKind::LessEqual)) => {
                    let count = behind[1..].iter().take_while(|token| !is_end(token)).count();
                    is_large(&behind[1..=count])
                }
                (Some(TokenKind::Greater | TokenKind::GreaterEqual), _) => {
                    let before = &before[..at - 1];
                    let count = before.iter().rev().take_while(|token| !is_end(token)).count();
                    is_large(&before[before.len() - count..])
                }
                _ => false,
            }
        })
    })
}

/// The name and the definitions of the coordinate system to which the used names belong.
fn system(
    [r, rho, theta, phi]: [bool; 4],
    with_z: bool,
) -> Option<(&'static str, Vec<ImpliedDefinition>)> {
    let cylindrical = "cylindrical coordinates";
    let spherical = "spherical coordinates";
    Some(match (r, rho, theta, phi) {
        (false, false, false, false) => return None,
        (true, _, true, true) => (
            "spherical coordinates, where theta is the angle from the z axis",
            vec![
                ("r", SPHERE_RADIUS),
                ("theta", "acos(z/r)"),
                ("phi", AZIMUTH),
                ("rho", CYLINDER_RADIUS),
            ],
        ),
        (true, _, _, false) => {
            (cylindrical, vec![("r", CYLINDER_RADIUS), ("rho", SPHERE_RADIUS), ("theta", AZIMUTH)])
        }
        (true, _, false, true) => {
            (cylindrical, vec![("r", CYLINDER_RADIUS), ("rho", SPHERE_RADIUS), ("phi", AZIMUTH)])
        }
        (false, true, false, _) if with_z => {
            (cylindrical, vec![("rho", CYLINDER_RADIUS), ("phi", AZIMUTH)])
        }
        (false, true, _, _) | (false, false, _, true) => {
            (spherical, vec![("rho", SPHERE_RADIUS), ("theta", AZIMUTH), ("phi", "acos(z/rho)")])
        }
        (false, false, true, false) => (cylindrical, vec![("theta", AZIMUTH)]),
    })
}

/// Returns whether the text uses a component of the vector `name`, as in `p.x`.
fn has_components(text: &str, lines: &[ParsedStatement<'_>], name: &str) -> bool {
    lines.iter().any(|line| {
        line.raw.lexed.tokens.windows(2).any(|pair| {
            pair[0].kind == TokenKind::Name
                && pair[1].kind == Component
                && plain_name(&text[pair[0].span.range()]) == name
        })
    })
}

/// Returns whether the text has the length of `name`, as in `length(p) - 1`.
fn has_length(text: &str, lines: &[ParsedStatement<'_>], name: &str) -> bool {
    lines.iter().any(|line| {
        line.raw.lexed.tokens.windows(4).any(|four| {
            let word = |at: usize| &text[four[at].span.range()];
            matches!(word(0), "length" | "norm" | "magnitude")
                && four[1].kind == TokenKind::OpenParen
                && plain_name(word(2)) == name
                && four[3].kind == TokenKind::CloseParen
        })
    })
}

/// The statement of a definition that is not in the text. Without `parameters`, it names a value.
pub(crate) fn define(
    name: &str,
    parameters: &[&str],
    body: &str,
    scope: &Scope,
    limits: &Limits,
) -> Option<BuiltStatement> {
    let span = Span::default();
    let name_of = |text: &str| Name { text: text.to_owned(), span };
    let parameters: Vec<Name> = parameters.iter().map(|text| name_of(text)).collect();
    let statements = statements(body, limits).ok()?;
    let mut builder = Builder::new(body, statements.first()?, scope, &parameters, limits);
    let body = builder.only_expression().ok()?;
    let used = builder.used;
    let parameters = Some(parameters).filter(|parameters| !parameters.is_empty());
    let definition = Definition { name: name_of(name), parameters, body, range: None };
    Some(BuiltStatement { statement: Statement::Define(definition), span, notes: Vec::new(), used })
}
