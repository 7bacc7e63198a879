//! Removes the notation that other systems put around formulas: plot commands, declarations of
//! names, braces.

use crate::grids::GRIDS;
use crate::program_words::Words;
use zeroset_parser::lex::token_kind::TokenKind::{self, *};

use crate::lists::with_signs;
use crate::plot_commands::{minus_level, restrict};
use zeroset_parser::Span;
use zeroset_parser::lex::spelling::plain_name;
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, outside, split};
use zeroset_parser::tree::scope::{NameMeaning, built_in, canonical};

/// Conditions such as `x, y, z >= 0`, in which a comma joins names, as one for each name.
fn written_out(conditions: Vec<Vec<Token>>) -> Vec<Vec<Token>> {
    let mut all: Vec<Vec<Token>> = Vec::new();
    let mut names: Vec<Token> = Vec::new();
    for condition in conditions {
        match condition.as_slice() {
            [name] if name.kind.is_name() => {
                names.push(*name);
                continue;
            }
            [name, sign, ..] if name.kind.is_name() && sign.kind.is_relation() => {
                let own = |name: Token| std::iter::once(name).chain(condition[1..].iter().copied());
                all.extend(names.drain(..).map(|name| own(name).collect()));
            }
            _ => all.extend(names.drain(..).map(|name| vec![name])),
        }
        all.push(condition);
    }
    all.extend(names.into_iter().map(|name| vec![name]));
    all
}

/// Largest number of tokens after names were replaced by values.
const MAX_SUBSTITUTED: usize = 10_000;

/// Commands of other systems that only declare names or change settings.
#[rustfmt::skip] // several words a line
const SETUP: &[&str] = &[
    "syms", "restart", "clc", "clear", "close", "hold", "figure", "ring", "LIB", "Clear",
    "ClearAll", "Needs", "draw_curve", "clear_screen", "using", "namespace", "package",
    "precision", "pkg",
];

/// Setup commands whose arguments are in brackets.
const SETUP_CALLS: &[&str] = &["var", "with", "load", "library", "require", "reset", "kill"];

/// Functions that create symbols.
const SYMBOLS: &[&str] = &["symbols", "Symbol", "var", "sym", "PolynomialRing", "require"];

/// Words that may stand before a formula to draw.
const PLOT_WORDS: &[&str] = &["plot", "graph", "draw", "Plot", "Graph", "Draw"];

impl Words<'_> {
    /// The statements in a wrapper, perhaps none. `None` if `tokens` have no wrapper.
    pub(crate) fn unwrap_statement(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let first = *tokens.first()?;
        let next = tokens.get(1);
        let word = self.word(first);
        let opens = next.is_some_and(|next| matches!(next.kind, OpenParen | OpenBracket));
        let is_setting = next.is_some_and(|next| matches!(next.kind, Equals | Colon | Comma));
        if word == "template" && next.is_some_and(|next| next.kind == Less) {
            let end = tokens.iter().position(|token| token.kind == Greater)?;
            return Some(vec![tokens[end + 1..].to_vec()]);
        }
        // Mathematica's `<<Package`.
        let is_package = first.kind == Less && next.is_some_and(|next| next.kind == Less);
        if is_package
            || word == "typedef"
            || word == "SPACE" && next.is_some_and(|next| next.kind == Equals)
            || word == r"\clean" && opens
            || SETUP.contains(&word)
                && (next.is_none_or(|next| next.kind.is_name()) || word == "Needs")
            || SETUP_CALLS.contains(&word) && opens && !is_setting && Self::is_whole_call(tokens)
        {
            return Some(Vec::new());
        }
        let level = self.level_of_function(tokens);
        if let Some(named) = self.named_equation(tokens).or(level) {
            return Some(vec![named]);
        }
        if let Some(equals) = tokens.iter().position(|token| token.kind == Equals)
            && let [callee, open, ..] = &tokens[equals + 1..]
            && (SYMBOLS.contains(&self.word(*callee)) && open.kind == OpenParen
                || GRIDS.contains(&self.word(*callee)))
        {
            return Some(Vec::new());
        }
        let found = self.behind_mark(tokens).map(|rest| vec![rest]);
        let found = found.or_else(|| self.with_rules(tokens));
        let found = found.or_else(|| self.with_values(tokens));
        if let Some(found) = found.or_else(|| self.of_surfer(tokens)) {
            return Some(found);
        }
        if first.kind == OpenBrace {
            return self.in_braces(tokens).map(|inner| vec![inner]);
        }
        // The name of a set, as in `E = {(x, y, z) : z > 0}`, is dropped.
        if let [name, equals, open, ..] = tokens
            && (name.kind, equals.kind, open.kind) == (TokenKind::Name, Equals, OpenBrace)
            && let Some(conditions) = self.set(&tokens[2..])
        {
            return Some(vec![conditions]);
        }
        match word {
            "With" | "Module" | "Block" if opens => return self.with(tokens),
            "function" if next.is_some_and(|next| next.kind == OpenBrace) => {
                let (inner, rest) = bracketed(&tokens[1..])?;
                return rest.is_empty().then(|| vec![inner.to_vec()]);
            }
            // These functions only rewrite the formula in their brackets.
            "Simplify" | "FullSimplify" | "Evaluate" | "N" | "Expand" | "Factor" | "simplify"
            | "expand"
                if opens && Self::is_whole_call(tokens) =>
            {
                let (inner, _) = bracketed(&tokens[1..])?;
                return Some(vec![inner.to_vec()]);
            }
            _ if PLOT_WORDS.contains(&word)
                && tokens.get(2).is_some()
                && next.is_some_and(|next| self.word(*next) == "of") =>
            {
                return Some(vec![tokens[2..].to_vec()]);
            }
            _ if PLOT_WORDS.contains(&word)
                && next
                    .is_some_and(|next| next.kind != OpenParen && next.kind.begins_operand()) =>
            {
                return Some(vec![tokens[1..].to_vec()]);
            }
            _ => {}
        }
        // R's `name <- value`.
        if let [name, less, minus, function, ..] = tokens
            && (less.kind, minus.kind) == (Less, Minus)
            && name.kind.is_name()
            && (self.word(*function) == "function"
                || !name.kind.is_axis()
                    && less.span.end == minus.span.start
                    && minus.span.end < function.span.start
                    && name.span.end < less.span.start)
        {
            let mut all = vec![*name, Token::new(Equals, Span::at(less.span.start))];
            all.extend(&tokens[3..]);
            return Some(vec![all]);
        }
        self.of_maple(tokens)
    }

    /// The tokens after a setup command such as `with(plots):`, or after a prompt: `In[1]:=`,
    /// `(%i1)` or `>>>`.
    fn behind_mark(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let rest = match tokens {
            [first, open, ..]
                if matches!(self.word(*first), "In" | "Out") && open.kind == OpenBracket =>
            {
                let (_, rest) = bracketed(&tokens[1..])?;
                rest.first().filter(|sign| sign.kind == Equals)?;
                rest[1..].to_vec()
            }
            [open, percent, mark, close, ..]
                if open.kind == OpenParen
                    && &self.text[percent.span.range()] == "%"
                    && self.word(*mark).starts_with(['i', 'o'])
                    && close.kind == CloseParen =>
            {
                tokens[4..].to_vec()
            }
            [a, b, c, ..] if [a, b, c].iter().all(|sign| sign.kind == Greater) => {
                tokens[3..].to_vec()
            }
            [first, ..] if SETUP_CALLS.contains(&self.word(*first)) => {
                let (_, rest) = bracketed(&tokens[1..])?;
                rest.first().filter(|colon| colon.kind == Colon)?;
                rest[1..].to_vec()
            }
            _ => return None,
        };
        (!rest.is_empty()).then_some(rest)
    }

    /// Turns `f(x, y, z) = formula = 2` into `formula = 2`, if the text uses `f` nowhere else.
    fn level_of_function(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let (name, call) = tokens.split_first().filter(|(name, _)| name.kind == TokenKind::Name)?;
        let (point, [equals, sides @ ..]) = bracketed(call)? else { return None };
        let is_point = point.iter().map(|token| token.kind).eq([X, Comma, Y, Comma, Z]);
        let level = &sides[outside(sides, Equals)? + 1..];
        let is_number = |token: &Token| matches!(token.kind, Number | Minus | Slash);
        let is_zero = matches!(level, [zero] if &self.text[zero.span.range()] == "0");
        let is_read = is_point
            && equals.kind == Equals
            && !level.is_empty()
            && level.iter().all(is_number)
            && !is_zero
            && self.text.matches(&format!("{}(", self.word(*name))).count() == 1;
        is_read.then(|| sides.to_vec())
    }

    /// Turns `name = left == right` into `name = (left) - (right)`, which a plot then draws.
    fn named_equation(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let [name, equals, sides @ ..] = tokens else { return None };
        // SymPy's `name = Eq(left, right)`.
        if let [eq, rest @ ..] = sides
            && self.word(*eq) == "Eq"
            && let Some([left, right]) =
                Self::inside(rest).and_then(|inner| <[_; 2]>::try_from(split(inner, Comma)).ok())
        {
            let mut all = vec![*name, *equals];
            all.extend(minus_level(&left, &right));
            return Some(all);
        }
        let at = outside(sides, Equals).filter(|at| *at > 0 && at + 1 < sides.len())?;
        let is_named = name.kind == TokenKind::Name
            && equals.kind == Equals
            && &self.text[equals.span.range()] != "=="
            && &self.text[sides[at].span.range()] == "=="
            && outside(&sides[at + 1..], Equals).is_none();
        let mut all = vec![*name, *equals];
        all.extend(minus_level(&sides[..at], &sides[at + 1..]));
        is_named.then_some(all)
    }

    /// Replaces names in `tokens` by values. `None` if the result is too long.
    pub(crate) fn substituted(
        tokens: &[Token],
        rules: &[(Token, Vec<Token>)],
        text: &str,
    ) -> Option<Vec<Token>> {
        let mut all = Vec::new();
        for token in tokens {
            let typed = &text[token.span.range()];
            let rule = rules.iter().find(|(name, _)| &text[name.span.range()] == typed);
            match rule {
                Some((_, value)) => all.extend(in_brackets(value)),
                None => all.push(*token),
            }
            if all.len() > MAX_SUBSTITUTED {
                return None;
            }
        }
        Some(all)
    }

    /// Splits Mathematica's `formula /. {a -> 2, b -> 3}` into the formula and two definitions. A
    /// coordinate is replaced in the formula instead, which may then use no other definition.
    fn with_rules(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let is_sign = |pair: &[Token]| {
            pair[0].kind == Slash && &self.text[pair[0].span.to(pair[1].span).range()] == "/."
        };
        let at = tokens.windows(2).position(is_sign)?;
        let rules = &tokens[at + 2..];
        let rules = bracketed(rules).map_or(rules, |(inner, _)| inner);
        let mut all = vec![tokens[..at].to_vec()];
        let mut substitutions = Vec::new();
        for rule in split(rules, Comma) {
            let [name, minus, arrow, value @ ..] = rule.as_slice() else { return None };
            if minus.kind != Minus || arrow.kind != Greater || !name.kind.is_name() {
                return None;
            }
            if name.kind.is_axis() {
                substitutions.push((*name, value.to_vec()));
                continue;
            }
            let mut line = vec![*name, Token::new(Equals, minus.span)];
            line.extend(value);
            all.push(line);
        }
        let is_known = |token: &Token| {
            token.kind != TokenKind::Name
                || built_in(&plain_name(self.word(*token))) != NameMeaning::Unknown
        };
        if !substitutions.is_empty() {
            let is_read = rules.windows(2).all(|pair| !is_sign(pair))
                && all.len() == 1
                && all[0].iter().all(is_known);
            all[0] = Self::substituted(&all[0], &substitutions, self.text).filter(|_| is_read)?;
        }
        (at > 0).then_some(all)
    }

    /// Splits `formula where a = 2, b = 3` into the formula and two definitions.
    fn with_values(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let is_word = |token: &Token| {
            token.kind == TokenKind::Name && matches!(self.word(*token), "where" | "with" | "for")
        };
        let at = tokens.iter().position(is_word)?;
        let mut formula = tokens[..at].to_vec();
        while formula.last().is_some_and(|last| last.kind == Comma) {
            formula.pop();
        }
        let mut all = vec![formula];
        for part in split(&tokens[at + 1..], Comma) {
            all.extend(split(&part, And));
        }
        let is_value = |part: &Vec<Token>| match part.as_slice() {
            [name, equals, value, ..] => {
                name.kind == TokenKind::Name && equals.kind == Equals && value.kind != Equals
            }
            _ => false,
        };
        let count = |is: fn(TokenKind) -> bool| tokens[..at].iter().filter(|t| is(t.kind)).count();
        let is_outside = count(|kind| kind.closer().is_some()) == count(TokenKind::is_closer);
        let (formula, values) = all.split_first()?;
        let is_read = is_outside && !formula.is_empty() && !values.is_empty();
        (is_read && values.iter().all(is_value)).then_some(all)
    }

    /// The formula or parameter on a line of a Surfer file.
    fn of_surfer(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        const PARAMETER: &str = "surface_parameter_";
        let (first, rest) = tokens.split_first()?;
        let equals = rest.first().filter(|equals| equals.kind == Equals)?;
        let word = self.word(*first);
        if word == "surface_equation" {
            return Some(vec![rest[1..].to_vec()]);
        }
        // Few lines begin like this, so the text is rarely searched.
        let name = word.strip_prefix(PARAMETER).filter(|name| !name.is_empty())?;
        if !self.text.contains("surface_equation") {
            return None;
        }
        let end = first.span.end;
        let mut all = vec![Token::new(TokenKind::Name, Span::new(end - name.len(), end)), *equals];
        all.extend(&rest[1..]);
        Some(vec![all])
    }

    /// Returns whether the text assigns `surface`, which is drawn by Surfer's `draw_surface`.
    pub(crate) fn sets_surface(self) -> bool {
        let mut places = self.text.match_indices("surface");
        places.any(|(at, word)| self.text[at + word.len()..].trim_start().starts_with('='))
    }

    /// Returns whether a statement consists of a single call.
    fn is_whole_call(tokens: &[Token]) -> bool {
        let end = closing(&tokens[1..]);
        end.is_some_and(|end| {
            tokens[end + 2..].iter().all(|token| matches!(token.kind, Colon | Unknown | Comma))
        })
    }

    /// The conditions of a set such as `{(x, y, z) : x > y}`, in which a bar may replace the colon.
    /// Several are joined by `and`; conditions beside an equation restrict it.
    fn set(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let (inner, rest) = bracketed(tokens)?;
        let has = |sign| outside(inner, sign);
        let sign = has(Colon).or_else(|| has(Bar));
        let within = has(In).zip(sign).is_some_and(|(within, sign)| within < sign);
        let is_sign = |sign: &Token| matches!(sign.kind, Colon | Bar);
        let is_point = |end: &usize| {
            inner[0].kind == OpenParen
                && self.coordinate_system(&inner[1..*end]).is_some()
                && inner.get(end + 1).is_some_and(is_sign)
        };
        let point = closing(inner).filter(is_point);
        let start = match point {
            Some(end) => end + 2,
            None => sign.filter(|_| within)? + 1,
        };
        let is_end = |token: &Token| matches!(token.kind, Comma | Unknown);
        if !rest.iter().all(is_end) {
            return None;
        }
        let is_equation = |part: &Vec<Token>| part.iter().any(|token| token.kind == Equals);
        let (mut equations, mut conditions): (Vec<_>, Vec<_>) =
            split(&inner[start..], Comma).into_iter().partition(is_equation);
        if point.is_some_and(|end| self.coordinate_system(&inner[1..end]) == Some(true)) {
            conditions = self.without_full_turns(conditions);
        }
        let joined = with_signs(&written_out(conditions), And);
        let Some(mut all) = equations.pop() else {
            return Some(joined).filter(|joined| !joined.is_empty());
        };
        if !joined.is_empty() {
            restrict(&mut all, &joined);
        }
        equations.is_empty().then_some(all)
    }

    /// Whether the coordinates `x, y, z`, `r, theta, z` or `rho, theta, phi` have angles. `None`
    /// for other names, and for angles whose names differ in meaning.
    fn coordinate_system(self, tokens: &[Token]) -> Option<bool> {
        let name = |part: &Vec<Token>| Some(self.canonical(*part.first()?));
        let names: Vec<String> = split(tokens, Comma).iter().map(name).collect::<Option<_>>()?;
        match names.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["x", "y"] | ["x", "y", "z"] => Some(false),
            ["r", "theta" | "phi", "z"] | ["rho", "theta", "phi"] => Some(true),
            _ => None,
        }
    }

    /// The plain text of a token, in which `φ` and `\varphi` are `phi`.
    fn canonical(self, token: Token) -> String {
        let name = plain_name(&self.text[token.span.range()]);
        canonical(&name).map_or(name, str::to_owned)
    }

    /// Leaves out conditions that hold for all angles: `0 <= theta <= 2 pi`, and beside it
    /// `0 <= phi <= pi`.
    fn without_full_turns(self, conditions: Vec<Vec<Token>>) -> Vec<Vec<Token>> {
        let ends = |part: &Vec<Token>| {
            let [zero, first, name, second, high @ ..] = part.as_slice() else { return None };
            let typed = |tokens: &[Token]| -> String {
                tokens.iter().map(|token| self.canonical(*token)).collect()
            };
            let is_angle = matches!(self.canonical(*name).as_str(), "theta" | "phi");
            let is_chain = [first, second].iter().all(|sign| matches!(sign.kind, Less | LessEqual));
            (is_angle && is_chain && typed(&[*zero]) == "0").then(|| typed(high))
        };
        let is_turn = |part: &Vec<Token>| {
            ends(part)
                .is_some_and(|high| matches!(high.as_str(), "2pi" | "2*pi" | "2·pi" | "2cdotpi"))
        };
        let has_turn = conditions.iter().any(is_turn);
        let is_half = |part: &Vec<Token>| has_turn && ends(part).is_some_and(|high| high == "pi");
        conditions.into_iter().filter(|part| !is_turn(part) && !is_half(part)).collect()
    }

    /// The equation in `{x^2 + y^2 = 1}`, or the condition in `{(x, y, z) : x > y}`.
    fn in_braces(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let end = closing(tokens)?;
        if tokens[end + 1..].iter().any(|token| !matches!(token.kind, Comma | Unknown)) {
            return None;
        }
        if let Some(conditions) = self.set(tokens) {
            return Some(conditions);
        }
        let inner = &tokens[1..end];
        let has = |sign| outside(inner, sign);
        if self.text[tokens[0].span.end..].trim_start().starts_with(r"\displaystyle") {
            return Some(inner.to_vec());
        }
        let is_choice = has(Colon).is_some() || has(QuestionMark).is_some() || has(Comma).is_some();
        (has(Equals).is_some() && !is_choice).then(|| inner.to_vec())
    }

    /// The definitions and the body of Mathematica's `With[{a = 2}, body]`.
    fn with(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let (inner, rest) = bracketed(&tokens[1..])?;
        let [names, body] = <[_; 2]>::try_from(split(inner, Comma)).ok()?;
        let (names, more) = bracketed(&names).filter(|_| names[0].kind == OpenBrace)?;
        if !rest.is_empty() || !more.is_empty() {
            return None;
        }
        let mut all = split(names, Comma);
        all.retain(|tokens| tokens.len() > 1);
        // A coordinate is replaced in the body, because it cannot be defined.
        let is_axis = |tokens: &Vec<Token>| tokens[0].kind.is_axis() && tokens[1].kind == Equals;
        let (axes, mut all): (Vec<_>, Vec<_>) = all.into_iter().partition(is_axis);
        let rules: Vec<(Token, Vec<Token>)> =
            axes.into_iter().map(|tokens| (tokens[0], tokens[2..].to_vec())).collect();
        let body = Self::substituted(&body, &rules, self.text)?;
        all.extend(split(&body, Semicolon));
        Some(all)
    }

    /// The two statements of Maple's `a := 2: b := 3`, in which a colon ends a statement.
    fn of_maple(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let sets = tokens
            .get(1)
            .is_some_and(|next| next.kind == Equals && &self.text[next.span.range()] == ":=");
        let colon = outside(tokens, Colon).filter(|colon| sets && colon + 1 < tokens.len())?;
        let is_choice = outside(tokens, QuestionMark).is_some();
        (!is_choice).then(|| vec![tokens[..colon].to_vec(), tokens[colon + 1..].to_vec()])
    }
}
