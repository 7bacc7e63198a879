//! What other systems put around a formula: commands that plot it, declarations of names, braces of print. No formula is
//! looked into.

use crate::lexer::begins_operand;
use crate::program_words::{Words, bracketed, closing, split};
use crate::scan::Token;
use crate::span::Span;
use crate::spelling::is_name;
use crate::steps::outside;

/// Commands that only declare names, or set up a system.
const SETUP: &[&str] = &[
    "syms",
    "restart",
    "clc",
    "clear",
    "close",
    "hold",
    "figure",
    "ring",
    "LIB",
    "Clear",
    "ClearAll",
    "Needs",
    "draw_curve",
    "clear_screen",
    "using",
    "namespace",
    "package",
    "precision",
];

/// The same, where brackets follow.
const SETUP_CALLS: &[&str] = &["var", "with", "load", "library", "require", "reset", "kill"];

/// What makes symbols of names.
const SYMBOLS: &[&str] = &["symbols", "Symbol", "var", "sym", "PolynomialRing"];

/// Commands that plot their first argument.
const PLOTS: &[&str] = &[
    "ContourPlot3D",
    "RegionPlot3D",
    "ImplicitRegion",
    "implicit_plot3d",
    "implicitplot3d",
    "ImplicitPlot3D",
    "fimplicit3",
    "ezimplot3",
    "isosurface",
    "implicit",
    "plot_implicit",
    "Plot3D",
    "plot3d",
    "draw3d",
    "fsurf",
    "ezsurf",
    "surf",
];

/// Those among them of which it is a height.
const HEIGHTS: &[&str] = &["Plot3D", "plot3d", "fsurf", "ezsurf", "surf"];

/// What means nothing around a formula.
const AROUND: &[&str] =
    &["Simplify", "FullSimplify", "Evaluate", "N", "Expand", "Factor", "simplify", "expand"];

/// Words before a formula that ask for its picture.
const ASKS: &[&str] = &["plot", "graph", "draw", "Plot", "Graph", "Draw"];

/// What stands for a statement.
pub(crate) enum Unwrapped {
    /// These statements; none if it means nothing.
    Statements(Vec<Vec<Token>>),
    /// The value of this name is drawn.
    Drawn(Token),
}

impl Words<'_> {
    /// What stands for a statement that is more than a formula.
    pub(crate) fn unwrapped(self, tokens: &[Token]) -> Option<Unwrapped> {
        let first = *tokens.first()?;
        let next = tokens.get(1);
        let word = self.word(first);
        let opens = next.is_some_and(|next| matches!(next.symbol, '(' | '['));
        let is_setting = next.is_some_and(|next| matches!(next.symbol, '=' | ':' | ','));
        let statements = |all: Vec<Vec<Token>>| Some(Unwrapped::Statements(all));
        if SETUP.contains(&word)
            && (next.is_none_or(|next| is_name(next.symbol)) || word == "Needs")
            || SETUP_CALLS.contains(&word) && opens && !is_setting && Self::is_whole_call(tokens)
        {
            return statements(Vec::new());
        }
        if word == "draw_surface" && next.is_none() {
            let mut places = self.text.match_indices("surface");
            let is_set =
                places.any(|(at, word)| self.text[at + word.len()..].trim_start().starts_with('='));
            return is_set.then_some(Unwrapped::Drawn(first));
        }
        if let Some(equals) = tokens.iter().position(|token| token.symbol == '=')
            && let [made, open, ..] = &tokens[equals + 1..]
            && SYMBOLS.contains(&self.word(*made))
            && open.symbol == '('
        {
            return statements(Vec::new());
        }
        if first.symbol == '{' {
            return self.in_braces(tokens).map(|inner| Unwrapped::Statements(vec![inner]));
        }
        match word {
            "With" | "Module" | "Block" if opens => return Self::with(tokens).and_then(statements),
            "isosurface" | "function" if next.is_some_and(|next| next.symbol == '{') => {
                return self.of_pov(tokens).map(|inner| Unwrapped::Statements(vec![inner]));
            }
            _ if AROUND.contains(&word) && opens && Self::is_whole_call(tokens) => {
                let (inner, _) = bracketed(&tokens[1..])?;
                return statements(vec![inner]);
            }
            _ if ASKS.contains(&word)
                && next.is_some_and(|next| next.symbol != '(' && begins_operand(next.symbol)) =>
            {
                return statements(vec![tokens[1..].to_vec()]);
            }
            _ => {}
        }
        if let [name, less, minus, function, ..] = tokens
            && less.symbol == '<'
            && minus.symbol == '-'
            && self.word(*function) == "function"
        {
            let mut all = vec![*name, Token::new('=', Span::at(less.span.start))];
            all.extend(&tokens[3..]);
            return statements(vec![all]);
        }
        self.of_maple(tokens).and_then(statements)
    }

    /// Whether a statement is one call and nothing else.
    fn is_whole_call(tokens: &[Token]) -> bool {
        let end = closing(&tokens[1..]);
        end.is_some_and(|end| {
            tokens[end + 2..].iter().all(|token| matches!(token.symbol, ':' | '?' | ','))
        })
    }

    /// What stands in braces around an equation, or behind the colon of a set.
    fn in_braces(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let end = closing(tokens)?;
        if tokens[end + 1..].iter().any(|token| !matches!(token.symbol, ',' | '?')) {
            return None;
        }
        let inner = &tokens[1..end];
        let has = |sign| outside(inner, sign);
        if let (Some(within), Some(colon)) = (has('∈'), has(':').or_else(|| has('|')))
            && within < colon
        {
            return Some(inner[colon + 1..].to_vec());
        }
        if self.text[tokens[0].span.end..].trim_start().starts_with(r"\displaystyle") {
            return Some(inner.to_vec());
        }
        let is_choice = has(':').is_some() || has('⸮').is_some() || has(',').is_some();
        (has('=').is_some() && !is_choice).then(|| inner.to_vec())
    }

    /// `With[{a = 2}, body]`.
    fn with(tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let (inner, rest) = bracketed(&tokens[1..])?;
        let [names, body] = <[_; 2]>::try_from(split(inner, ',')).ok()?;
        let (names, more) = bracketed(&names).filter(|_| names[0].symbol == '{')?;
        if !rest.is_empty() || !more.is_empty() {
            return None;
        }
        let mut all = split(names, ',');
        all.retain(|tokens| tokens.len() > 1);
        all.extend(split(body, ';'));
        Some(all)
    }

    /// `function { … }` and `isosurface { function { … } threshold 1 … }`.
    fn of_pov(self, tokens: &[Token]) -> Option<Vec<Token>> {
        if self.word(tokens[0]) == "function" {
            return bracketed(&tokens[1..])
                .filter(|(_, rest)| rest.is_empty())
                .map(|(inner, _)| inner);
        }
        let (inner, _) = bracketed(&tokens[1..])?;
        let at = inner.iter().position(|token| self.word(*token) == "function")?;
        let mut rest = inner[at + 1..].to_vec();
        if rest.first()?.symbol == '(' {
            rest = bracketed(&rest)?.1;
        }
        let (body, rest) = bracketed(&rest)?;
        let level = rest.iter().position(|token| self.word(*token) == "threshold");
        let number = level.map(|at| {
            let after = &rest[at + 1..];
            let end =
                after.iter().position(|t| !matches!(t.symbol, '0' | '-')).unwrap_or(after.len());
            after[..end].to_vec()
        });
        Some(match number {
            Some(number) if !number.is_empty() => less(body, number),
            _ => body,
        })
    }

    /// `a := 2: b := 3`, whose statements end with colons.
    fn of_maple(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let sets = tokens
            .get(1)
            .is_some_and(|next| next.symbol == '=' && &self.text[next.span.range()] == ":=");
        let colon = outside(tokens, ':').filter(|colon| sets && colon + 1 < tokens.len())?;
        let is_choice = outside(tokens, '⸮').is_some();
        (!is_choice).then(|| vec![tokens[..colon].to_vec(), tokens[colon + 1..].to_vec()])
    }

    /// Leaves of a command that plots its first argument only that; whether that is a height.
    pub(crate) fn plot(self, tokens: &mut Vec<Token>) -> bool {
        let word = self.word(tokens[0]);
        if !PLOTS.contains(&word) {
            return false;
        }
        let Some((inner, rest)) = bracketed(&tokens[1..]) else { return false };
        let is_ended = rest.iter().all(|token| matches!(token.symbol, ':' | '?'));
        let arguments = split(inner, ',');
        let is_inner = |part: &&Vec<Token>| self.word(part[0]) == "implicit";
        let Some(formula) = arguments.iter().find(is_inner).or(arguments.first()) else {
            return false;
        };
        if !is_ended {
            return false;
        }
        let mut formula = formula.clone();
        if self.word(formula[0]) == "implicit" {
            self.plot(&mut formula);
        }
        if formula.first().is_some_and(|first| first.symbol == '@')
            && let Some((_, body)) = bracketed(&formula[1..])
        {
            formula = body;
        }
        // `Contours -> {1}`
        let level = arguments.iter().find_map(|part| match part.as_slice() {
            [name, minus, arrow, value @ ..]
                if self.word(*name) == "Contours" && minus.symbol == '-' && arrow.symbol == '>' =>
            {
                let inner = bracketed(value).map_or(value.to_vec(), |(inner, _)| inner);
                (!inner.iter().any(|token| token.symbol == ',')).then_some(inner)
            }
            _ => None,
        });
        if let Some(level) = level.filter(|_| outside(&formula, '=').is_none()) {
            formula = less(formula, level);
        }
        // A function by its name alone is drawn where nothing else is.
        if let [name] = formula.as_slice()
            && name.symbol == 'a'
        {
            formula.clear();
        }
        *tokens = formula;
        HEIGHTS.contains(&word)
    }
}

/// `(formula) - (level)`
fn less(formula: Vec<Token>, level: Vec<Token>) -> Vec<Token> {
    let at = |tokens: &[Token]| Span::at(tokens.last().map_or(0, |last| last.span.end));
    let start = |tokens: &[Token]| Span::at(tokens.first().map_or(0, |first| first.span.start));
    let mut all = vec![Token::new('(', start(&formula))];
    let end = at(&formula);
    all.extend(formula);
    all.push(Token::new(')', end));
    all.push(Token::new('-', end));
    all.push(Token::new('(', start(&level)));
    let end = at(&level);
    all.extend(level);
    all.push(Token::new(')', end));
    all
}
