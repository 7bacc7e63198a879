//! The implied drawing of a text that contains definitions only.

use rustc_hash::FxHashSet;
use zeroset_dialect::PastedProgram;
use zeroset_ir::Axis;
use zeroset_parser::tree::ast::{Definition, Expr, ExprKind, Function, NamedValue, Statement};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::statement::is_plain_number;
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Returns the drawing of a text that has only definitions. The last function of (x, y, z) or (x,
/// y) is drawn: its zero set for (x, y, z), its graph for (x, y). Functions with `generated` names
/// do not count.
pub(crate) fn implied_drawing(
    text: &str,
    definitions: &[(&Definition, &BuiltStatement)],
    generated: &FxHashSet<String>,
) -> Fallible<(BuiltStatement, Note)> {
    let typed = definitions.iter().filter(|(one, _)| !generated.contains(&one.name.text));
    for (definition, built) in typed.rev() {
        let parameters: Vec<&str> =
            definition.parameters.iter().flatten().map(|name| name.text.as_str()).collect();
        let span = definition.name.span;
        let coordinate = |axis| Expr::new(ExprKind::Name(NamedValue::Coordinate(axis)), span);
        let function = Function::Defined(definition.name.text.clone());
        let arguments: Vec<Expr> =
            Axis::ALL.iter().take(parameters.len()).map(|axis| coordinate(*axis)).collect();
        let call = Expr::new(ExprKind::Call(function, arguments), span);
        let head = text.get(span.end..definition.body.span.start).unwrap_or_default();
        let is_constant =
            is_plain_number(&definition.body) && head.contains('=') && !head.contains('\n');
        let expr = match parameters.as_slice() {
            // A function with a constant value was meant as an equation: `gyroid(x, y, z) = 0`.
            ["x", "y", "z"] if is_constant => continue,
            ["x", "y", "z"] => call.equals(Expr::of_digits("0", span)),
            ["x", "y"] => coordinate(Axis::Z).equals(call),
            _ => continue,
        };
        return Ok(drawn(expr, built.span, span));
    }
    let Some((definition, _)) = definitions.last() else {
        return Err(Error::new(Span::at(0), ErrorKind::Empty));
    };
    let kind = ErrorKind::NothingToDraw {
        last: definition.name.text.clone(),
        is_number: is_plain_number(&definition.body),
        parameters: definition.parameters.as_ref().map(Vec::len),
    };
    Err(Error::new(definition.name.span, kind))
}

/// Returns the drawing of a program that draws nothing itself: its last function of a point of
/// space, or else the value that the program assigns last.
pub(crate) fn drawn_by_program(
    program: &PastedProgram,
    built: &[BuiltStatement],
) -> Option<(BuiltStatement, Note)> {
    if built.iter().any(|built| !matches!(built.statement, Statement::Define(_))) {
        return None;
    }
    let (name, kind) = if let Some(name) = &program.last_function {
        let function = Function::Defined(name.text.clone());
        let coordinate = |axis| Expr::new(ExprKind::Name(NamedValue::Coordinate(axis)), name.span);
        let point = Axis::ALL.iter().map(|axis| coordinate(*axis)).collect();
        let point = Expr::new(ExprKind::Call(Function::Vector(3), point), name.span);
        let call = ExprKind::Call(function, vec![point]);
        let first = || Box::new(Expr::new(call.clone(), name.span));
        let is_vector = program.draws_first_component;
        (name, if is_vector { ExprKind::Component(first(), "x".to_owned()) } else { call.clone() })
    } else {
        let name = program.last_value.as_ref().filter(|_| program.in_steps)?;
        (name, ExprKind::Name(NamedValue::Defined(name.text.clone())))
    };
    let is_value = program.last_function.is_none();
    if is_value && program.is_height {
        let z =
            Expr::new(ExprKind::Name(NamedValue::Coordinate(Axis::Z)), Span::at(name.span.start));
        let value = Expr::new(kind, Span::at(name.span.start));
        return Some(drawn(z.equals(value), name.span, name.span));
    }
    // The expression is not in the text, so the expression's span is empty.
    let expr = Expr::new(kind, Span::at(name.span.start));
    Some(drawn(expr, name.span, name.span))
}

/// Creates a drawing of `expr`, which is not in the text. A note at `place` reports the drawing.
fn drawn(expr: Expr, span: Span, place: Span) -> (BuiltStatement, Note) {
    let kind = NoteKind::DrawsFunction { drawn: expr.to_string() };
    let statement = Statement::Draw { expr, restrictions: Vec::new() };
    (BuiltStatement::synthesized(statement, span), Note { span: place, kind })
}
