//! Applies functions. A function takes an argument in brackets, or the implicit product after the
//! function.

use crate::lex::spelling::short_formula;
use crate::lex::token_kind::TokenKind::{Minus, Number, Slash};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::NoteKind;
use crate::span::Span;
use crate::tree::ast::{Expr, ExprKind, Function, NamedValue};
use crate::tree::builder::{Builder, number_only, product_of, quotient_of};
use crate::tree::delimited::{is_vector, native};
use crate::tree::grammar::{Pair, Rule};
use crate::tree::juxtaposition::{FactorItem, FactorItems};
use crate::tree::print::factor_text;
use crate::tree::scope::{Callee, ROOT_NAMES, is_builder, is_variadic};
use zeroset_ir::NamedConstant;
use zeroset_ops::Op;

/// Functions of angles. An angle is in degrees in `OpenSCAD`.
const ANGULAR: &[&str] = &["sin", "cos", "tan", "asin", "acos", "atan", "atan2"];

impl Builder<'_> {
    /// Builds a call of `callee`. The arguments are in brackets. Without brackets, the argument is
    /// the implicit product up to the next function.
    pub(crate) fn application(
        &mut self,
        callee: &Callee,
        span: Span,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Expr> {
        let mut callee = callee.clone();
        let mut exponent = None;
        if let Some(FactorItem::Caret(..) | FactorItem::Superscript(_)) = items.front() {
            let power = self.function_exponent(items)?;
            if is_minus_one(&power) {
                callee = self.inverse(&callee, span.to(power.span))?;
            } else {
                exponent = Some(power);
            }
        }
        let brackets = match items.front() {
            Some(FactorItem::Group(pair) | FactorItem::Delimited(pair))
                if matches!(pair.as_rule(), Rule::group | Rule::braces) =>
            {
                Some(pair.clone())
            }
            _ => None,
        };
        let (arguments, place) = if let Some(pair) = brackets {
            items.pop_front();
            let place = self.span(&pair);
            let arguments = self.arguments(&callee, pair, place)?;
            (self.with_radicand(&mut callee, span, arguments, items)?, place)
        } else {
            let argument = self.bare_argument(&callee, span, items)?;
            let place = argument.span;
            (vec![argument], place)
        };
        let call = self.call(&callee, span, arguments, place)?;
        Ok(match exponent {
            None => call,
            Some(exponent) => {
                let place = call.span;
                Expr::new(ExprKind::Power(Box::new(call), Box::new(exponent)), place)
            }
        })
    }

    /// Reads `root(3)(x)` of `AsciiMath` and `sqrt[3](x)` as roots of x. Takes the second pair of
    /// brackets from `items`. Mathematica's `Sqrt[3](x)` remains a product.
    #[inline(never)] // keeps the stack frames of nested calls small
    fn with_radicand(
        &mut self,
        callee: &mut Callee,
        span: Span,
        mut arguments: Vec<Expr>,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Vec<Expr>> {
        let Some(FactorItem::Group(radicand) | FactorItem::Delimited(radicand)) = items.front()
        else {
            return Ok(arguments);
        };
        let is_group = radicand.as_rule() == Rule::group;
        let has_index = match callee {
            Callee::BuiltIn(name) if name == "root" => is_group,
            Callee::BuiltIn(name) if name == "sqrt" => {
                self.text[span.range()].starts_with('s')
                    && self.text[span.end..].trim_start().starts_with('[')
                    && (is_group || radicand.as_rule() == Rule::braces)
            }
            _ => false,
        };
        // The index of a root is a whole number or a defined name. Any other `sqrt[a](b)` is a
        // product.
        let is_index = |one: &Expr| {
            one.whole_number().is_some()
                || matches!(one.kind, ExprKind::Name(NamedValue::Defined(_)))
        };
        let is_whole = callee.name() == "root" || arguments.iter().all(is_index);
        if has_index && is_whole && arguments.len() == 1 {
            *callee = Callee::BuiltIn("root".to_owned());
            let place = self.span(radicand);
            let mut of = self.arguments(callee, radicand.clone(), place)?;
            items.pop_front();
            of.append(&mut arguments);
            return Ok(of);
        }
        Ok(arguments)
    }

    /// Reads arguments in brackets, or a single argument in braces. Among the arguments of a
    /// builder, the name of a function stands for its value at the point.
    #[inline(never)]
    fn arguments(&mut self, callee: &Callee, pair: Pair<'_>, span: Span) -> Fallible<Vec<Expr>> {
        let is_builder = matches!(callee, Callee::BuiltIn(name) if is_builder(name));
        if pair.as_rule() == Rule::group {
            let read = if is_builder { Self::of_point } else { Self::argument };
            return pair.into_inner().map(|argument| read(self, argument)).collect();
        }
        Ok(vec![self.nested(span, 1, |b| b.delimited(pair, span))?])
    }

    /// Reads the exponent between a function and its argument, as in `sin^2 x`.
    #[inline(never)]
    fn function_exponent(&mut self, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        let signs = match items.pop_front() {
            Some(FactorItem::Superscript(number)) => return Ok(number),
            Some(FactorItem::Caret(signs, _)) => signs,
            _ => Vec::new(),
        };
        let exponent = self.power(items)?;
        number_only(&exponent)?;
        self.signed(&signs, |_| Ok(exponent))
    }

    #[inline(never)]
    fn inverse(&mut self, callee: &Callee, span: Span) -> Fallible<Callee> {
        let name = callee.name().to_owned();
        let has_inverse = matches!(callee, Callee::BuiltIn(_))
            && matches!(
                name.as_str(),
                "sin" | "cos" | "tan" | "sec" | "csc" | "cot" | "sinh" | "cosh" | "tanh"
            );
        if !has_inverse {
            return Err(Error::new(span, ErrorKind::InversePower { name }));
        }
        let inverse = format!("a{name}");
        let kind = NoteKind::InverseFunction { name, inverse: inverse.clone() };
        self.note(span, kind);
        Ok(Callee::BuiltIn(inverse))
    }

    /// Reads an argument without brackets, as in `sin 2x`.
    #[inline(never)]
    fn bare_argument(
        &mut self,
        callee: &Callee,
        span: Span,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Expr> {
        let forms = self.scope.signatures(callee);
        if items.is_empty() || forms.function(1).is_none() {
            let name = callee.name().to_owned();
            let kind = ErrorKind::NeedsArgument { name, count: forms.least() };
            return Err(self.suggest_brackets(Error::new(span, kind), span));
        }
        let mut factors: Vec<Expr> = Vec::new();
        while !items.is_empty() {
            if let (Some(FactorItem::Function(..)), false) = (items.front(), factors.is_empty()) {
                break;
            }
            // In LaTeX, brackets behind a variable are another factor: `\tan \phi (…)`.
            if let (Some(FactorItem::Group(pair)), Some(last)) = (items.front(), factors.last())
                && self.text[span.range()].starts_with('\\')
                && matches!(last.kind, ExprKind::Name(_))
            {
                let place = self.span(pair);
                let read = short_formula(&factor_text(last));
                let name = callee.name().to_owned();
                self.note(span.to(place), NoteKind::FunctionOfProduct { name, read });
                break;
            }
            self.factor(items, &mut factors)?;
        }
        if let [_, second, ..] = factors.as_slice()
            && has_spaced_names(&factors)
        {
            let second = second.span;
            let read: Vec<String> = factors.iter().map(factor_text).collect();
            let name = callee.name().to_owned();
            let read = short_formula(&read.join("*"));
            self.note(span.to(second), NoteKind::FunctionOfProduct { name, read });
        }
        self.note_powers(&factors);
        let product = product_of(factors)?;
        number_only(&product)?;
        if matches!(callee, Callee::BuiltIn(name) if matches!(name.as_str(), "sqrt" | "cbrt"))
            && items.is_empty()
            && self.root_goes_on(&product)
        {
            let name = callee.name().to_owned();
            let read = short_formula(&product.to_string());
            self.note(span.to(product.span), NoteKind::FunctionOfProduct { name, read });
        }
        self.note_quotient(callee, span, &product);
        Ok(product)
    }

    /// Adds a note to `sin x/2`, which others read as `sin(x/2)`.
    fn note_quotient(&mut self, callee: &Callee, span: Span, argument: &Expr) {
        let next = self.lexed.tokens.partition_point(|one| one.span.start < argument.span.end);
        let [slash, divisor, ..] = &self.lexed.tokens[next..] else { return };
        if slash.kind == Slash && (divisor.kind == Number || divisor.kind.is_name()) {
            let place = span.to(divisor.span);
            let divisor = &self.text[divisor.span.range()];
            let name = callee.name();
            let read = short_formula(&format!("{name}({argument})/{divisor}"));
            let other = short_formula(&format!("{name}({}/{divisor})", factor_text(argument)));
            self.note(place, NoteKind::ImplicitDivision { read, other });
        }
    }

    /// Suggests `sin(-x)` in the error for `sin -x`, which is read as a subtraction.
    fn suggest_brackets(&self, error: Box<Error>, span: Span) -> Box<Error> {
        let next = self.lexed.tokens.partition_point(|token| token.span.start < span.end);
        match &self.lexed.tokens[next..] {
            [sign, operand, ..]
                if sign.kind == Minus
                    && sign.span.end == operand.span.start
                    && (operand.kind == Number || operand.kind.is_name())
                    && operand.span.end - span.end <= 40 =>
            {
                let argument = &self.text[sign.span.to(operand.span).range()];
                error.suggest(Span::new(span.end, operand.span.end), format!("({argument})"))
            }
            _ => error,
        }
    }

    /// Builds a call. The number of arguments selects the function.
    #[inline(never)]
    pub(crate) fn call(
        &mut self,
        callee: &Callee,
        span: Span,
        arguments: Vec<Expr>,
        place: Span,
    ) -> Fallible<Expr> {
        let mut arguments = arguments;
        self.note_function(callee, span);
        let typed = &self.text[span.range()];
        match (callee, arguments.as_mut_slice()) {
            // In programs and in modules such as `np`, this is well known.
            (Callee::BuiltIn(name), [_])
                if name == "log"
                    && matches!(typed, "log" | "\\log")
                    && !self.scope.in_steps
                    && !self.text[..span.start].ends_with('.') =>
            {
                self.note(span, NoteKind::NaturalLogarithm);
            }
            // In SymPy and MATLAB, `Heaviside(0)` is 1/2.
            (Callee::BuiltIn(name), [_]) if name == "heaviside" && typed == "Heaviside" => {
                let number = |digits| Expr::of_digits(digits, span);
                arguments.push(number("1").over(number("2"), span));
            }
            // Mathematica's `Clip[x, {a, b}]` takes the two bounds as a list.
            (
                Callee::BuiltIn(_),
                [_, Expr { kind: ExprKind::Call(Function::Vector(2), ends), .. }],
            ) if typed == "Clip" => {
                let ends = ends.clone();
                arguments.truncate(1);
                arguments.extend(ends);
            }
            (Callee::BuiltIn(name), [index, radicand])
                if name != "surd"
                    && ROOT_NAMES.contains(&name.as_str())
                    && is_swapped_root(index, radicand) =>
            {
                std::mem::swap(index, radicand);
                let read = short_formula(&format!("{name}({index}, {radicand})"));
                self.note(span.to(place), NoteKind::RootOf { read });
            }
            // Typst writes fractions as `frac(a, b)`.
            (Callee::BuiltIn(name), [_, _]) if name == "frac" => {
                return quotient_of(arguments);
            }
            (Callee::Numbered(name, number), [_]) => {
                arguments.insert(0, Expr::of_digits(number.as_str(), span));
                let callee = Callee::BuiltIn((*name).to_owned());
                return self.call(&callee, span, arguments, place);
            }
            (Callee::Logarithm(base), [_]) => {
                let base = Expr::of_digits(base.as_str(), span);
                let argument = arguments.remove(0);
                return Ok(logarithm(argument, base, span.to(place)));
            }
            // The base of a logarithm comes first in Mathematica, and last in Python.
            (Callee::BuiltIn(name), [_, _]) if name == "log" => {
                let before = &self.text[..span.start];
                let is_first = typed == "Log" && self.text[span.end..].starts_with('[');
                let is_last = ["math.", "sp.", "sympy.", "mpmath.", "mp."]
                    .iter()
                    .any(|module| before.ends_with(module));
                if is_first || is_last {
                    if is_first {
                        arguments.swap(0, 1);
                    }
                    let base = arguments.remove(1);
                    return Ok(logarithm(arguments.remove(0), base, span.to(place)));
                }
            }
            (Callee::BuiltIn(name), [first, second]) if name == "arctan" && typed == "ArcTan" => {
                std::mem::swap(first, second);
                let kind = ExprKind::Call(Function::Native(Op::Atan2), arguments.clone());
                let read = short_formula(&Expr::new(kind, span.to(place)).to_string());
                self.note(span.to(place), NoteKind::ArcTanOfPoint { read });
            }
            _ => {}
        }
        self.native_call(callee, span, arguments, place)
    }

    /// Builds a call whose arguments are in the order of this language.
    #[inline(never)]
    fn native_call(
        &mut self,
        callee: &Callee,
        span: Span,
        mut arguments: Vec<Expr>,
        place: Span,
    ) -> Fallible<Expr> {
        let forms = self.scope.signatures(callee);
        // `min` and `max` of a single vector apply to the vector's components.
        if let (Callee::BuiltIn(_), [only]) = (callee, arguments.as_slice())
            && let Some(function @ Function::Native(Op::Min | Op::Max)) = forms.function(2)
            && (is_vector(only) || may_be_vector(only))
        {
            return Ok(Expr::new(ExprKind::Call(function, arguments), span.to(place)));
        }
        let Some(function) = forms.function(arguments.len()) else {
            return Err(self.wrong_count(callee, span, place, arguments.len()));
        };
        let before = &self.text[..span.start];
        if let (Callee::BuiltIn(name), [argument]) = (callee, arguments.as_mut_slice())
            && name == "sinc"
            && (before.ends_with("np.") || before.ends_with("numpy."))
        {
            // In numpy, `sinc(a)` is sin(πa)/(πa).
            *argument = product_of([pi_at(argument.span), argument.clone()])?;
            self.note(span.to(place), NoteKind::SincOfNumpy);
        }
        let is_decimal = matches!(callee, Callee::BuiltIn(name) if name == "log")
            && self.scope.in_degrees
            && arguments.len() == 1;
        // In OpenSCAD, `log` has the base 10.
        let function = if is_decimal { Function::Native(Op::Log10) } else { function };
        let call = |arguments| Expr::new(ExprKind::Call(function, arguments), span.to(place));
        if let Callee::BuiltIn(name) = callee
            && self.scope.in_degrees
            && ANGULAR.contains(&name.as_str())
        {
            self.note(span, NoteKind::DegreesOfOpenscad);
            let half = |place| [Expr::of_digits("180", place), pi_at(place)];
            if matches!(name.as_str(), "sin" | "cos" | "tan") {
                let argument = arguments.remove(0);
                let [degrees, radians] = half(argument.span);
                arguments.insert(0, product_of([argument, radians])?.over(degrees, place));
            } else {
                let [degrees, radians] = half(place);
                return Ok(product_of([call(arguments), degrees])?.over(radians, span.to(place)));
            }
        }
        Ok(call(arguments))
    }

    /// Adds a note if other languages define the function differently.
    pub(crate) fn note_function(&mut self, callee: &Callee, span: Span) {
        if let Callee::BuiltIn(name) = callee {
            match name.as_str() {
                "acot" | "arccot" => self.note(span, NoteKind::ArcCotangent),
                "sinc" => self.note(span, NoteKind::Sinc),
                _ => {}
            }
        }
    }

    /// The error for a call with a number of arguments that the function does not take.
    pub(crate) fn wrong_count(
        &self,
        callee: &Callee,
        span: Span,
        place: Span,
        given: usize,
    ) -> Box<Error> {
        let kind = ErrorKind::WrongCount {
            name: callee.name().to_owned(),
            expected: self.scope.signatures(callee).to_string(),
            given,
            usage: usage(callee),
        };
        Error::new(span.to(place), kind)
    }
}

/// Returns whether a value depends on a name of the document, which may name a vector.
fn may_be_vector(expr: &Expr) -> bool {
    expr.all_parts().into_iter().any(|part| {
        matches!(part.kind, ExprKind::Name(NamedValue::Local(_))) || part.kind.defined().is_some()
    })
}

/// Returns whether the arguments of a root are swapped, as in `root(3, x)`. Nobody means the x-th
/// root of 3.
pub(crate) fn is_swapped_root(first: &Expr, second: &Expr) -> bool {
    first.whole_number().is_some_and(|index| index > 1) && second.number().is_none()
}

/// The constant pi, with its place.
fn pi_at(place: Span) -> Expr {
    Expr::new(ExprKind::Name(NamedValue::Constant(NamedConstant::Pi)), place)
}

/// The logarithm of `argument` to `base`: ln(argument)/ln(base).
fn logarithm(argument: Expr, base: Expr, span: Span) -> Expr {
    let ln = |expr: Expr| {
        let place = expr.span;
        native(Op::Ln, expr, place)
    };
    ln(argument).over(ln(base), span)
}

/// Usage of a built-in function: a call with named parameters, and the function's line of help.
fn usage(callee: &Callee) -> Option<String> {
    let Callee::BuiltIn(name) = callee else {
        return None;
    };
    if let "log" | "ln" = name.as_str() {
        return Some(
            "logarithms are natural; write `ln(a)/ln(b)` for the logarithm of a to base b"
                .to_owned(),
        );
    }
    if let Some(composed) = zeroset_ops::composed(name).next() {
        return Some(format!("`{name}({})`: {}", composed.parameters.join(", "), composed.doc));
    }
    let rows: Vec<String> = zeroset_ops::builders(name)
        .map(|row| format!("`{}`, as in `{}`: {}", row.signature(), row.usage, row.doc))
        .collect();
    if !rows.is_empty() {
        return Some(rows.join("; or "));
    }
    let row = zeroset_ops::natives(name).last()?;
    let operands = ["a", "b", "c"][..row.op.arity()].join(", ");
    let more = if is_variadic(row.op) { ", …" } else { "" };
    Some(format!("`{name}({operands}{more})`: {}", row.doc))
}

/// Returns whether a blank separates two factors that are no numbers, as in `sin x y`. The second
/// factor may not be meant as part of the function's argument.
fn has_spaced_names(factors: &[Expr]) -> bool {
    let is_name = |expr: &Expr| !matches!(expr.kind, ExprKind::Number(_));
    factors.windows(2).any(|pair| {
        let apart = pair[0].span.end < pair[1].span.start;
        apart && is_name(&pair[0]) && is_name(&pair[1])
    })
}

fn is_minus_one(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Negate(inner) if inner.number() == Some("1"))
}
