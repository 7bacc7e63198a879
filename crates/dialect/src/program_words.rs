//! Recognizes the words of programs and the parts of statements. Does not parse formulas.

use zeroset_parser::lex::spelling::{ACCENTS, plain_name, start, token_kind};
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::ast::Name;
use zeroset_parser::{Error, ErrorKind, Span};

/// Beginnings of the names of vector types. The number of components follows, as in `vec3`.
const VECTORS: &[&str] = &["vec", "float", "half", "ivec", "uvec", "bvec", "dvec"];

/// Usual names of functions that return the distance from a point to the scene.
const SCENES: &[&str] =
    &["map", "sdf", "SDF", "scene", "sceneSDF", "sdScene", "mapScene", "DE", "getDist", "GetDist"];

/// Returns whether a function with this name is usually the distance from a point to the scene.
pub fn is_scene_function(name: &str) -> bool {
    SCENES.contains(&name)
}

/// Largest number of signs `@` in a statement that are read as applications. Each becomes brackets.
const MAX_AT_SIGNS: usize = 20;

/// Returns whether `word` is an integer type.
pub(crate) fn is_whole_type(word: &str) -> bool {
    matches!(word, "int" | "uint" | "long" | "unsigned") || is_whole_vector(word)
}

/// Returns whether `word` is a type of vectors of integers.
pub(crate) fn is_whole_vector(word: &str) -> bool {
    (word.starts_with("ivec") || word.starts_with("uvec")) && size_of(word) > 1
}

/// Returns whether `word` is a type or a modifier before a declared name.
pub(crate) fn is_type(word: &str) -> bool {
    let sized =
        |stem: &str, ends: &[&str]| word.strip_prefix(stem).is_some_and(|end| ends.contains(&end));
    match word {
        "float" | "int" | "double" | "half" | "real" | "bool" | "uint" | "const" | "let"
        | "var" | "auto" | "static" | "inline" | "uniform" | "varying" | "out" | "inout"
        | "highp" | "mediump" | "lowp" | "local" | "function" | "fn" | "void" | "precise"
        | "long" | "unsigned" | "in" | "poly" | "public" | "constexpr" | "nonlocal" | "global" => {
            true
        }
        _ => {
            VECTORS.iter().any(|stem| sized(stem, &["2", "3", "4"]))
                || sized("vec", &["2f", "3f", "4f"])
                || sized("mat", &["2", "3", "4"])
                || ["mat", "float"].iter().any(|stem| sized(stem, &["2x2", "3x3", "4x4"]))
        }
    }
}

/// Number of components of a type; 1 if it is not a vector type.
pub(crate) fn size_of(word: &str) -> usize {
    let is_vector = VECTORS.iter().any(|stem| word.starts_with(stem)) && !word.contains('x');
    let word = word.strip_suffix('f').unwrap_or(word);
    match word.chars().last().and_then(|last| last.to_digit(10)) {
        Some(digit @ 2..=4) if is_vector => digit as usize,
        _ => 1,
    }
}

/// Looks up the words of tokens in the text of the program.
#[derive(Clone, Copy, Default)]
pub(crate) struct Words<'a> {
    pub text: &'a str,
}

impl<'a> Words<'a> {
    /// Returns whether a statement comes from a language in which y points up. Such a statement
    /// names a vector type, takes components such as `p.xz`, or has POV-Ray's `isosurface { … }`.
    pub(crate) fn has_y_up(self, tokens: &[Token]) -> bool {
        let is_vector = |token: &Token| {
            let word = self.word(*token);
            token.kind == TokenKind::Component || is_type(word) && size_of(word) > 1
        };
        let is_pov = |pair: &[Token]| {
            self.word(pair[0]) == "isosurface" && pair[1].kind == TokenKind::OpenBrace
        };
        tokens.iter().any(is_vector) || tokens.windows(2).any(is_pov)
    }

    /// The text of a token that is a name; empty for any other token.
    pub(crate) fn word(self, token: Token) -> &'a str {
        if token.kind.is_name() { &self.text[token.span.range()] } else { "" }
    }

    /// Returns whether `word` is among `tokens`.
    pub(crate) fn has(self, tokens: &[Token], word: &str) -> bool {
        tokens.iter().any(|token| self.word(*token) == word)
    }

    pub(crate) fn name(self, token: Token) -> Name {
        Name { text: plain_name(&self.text[token.span.range()]), span: token.span }
    }

    /// The error for a program's word that is not supported.
    pub(crate) fn unsupported(self, token: Token) -> Box<Error> {
        Error::new(token.span, ErrorKind::Program { word: self.word(token).to_owned() })
    }

    /// Returns whether the first word begins a command: a name or a block follows it, perhaps after
    /// a condition in brackets, as in `else a` or `if (c) a`.
    pub(crate) fn is_command(tokens: &[Token]) -> bool {
        let Some(next) = tokens.get(1) else { return false };
        if next.kind.is_name() || next.kind == OpenBrace {
            return true;
        }
        // `if(c, a, b)` is a value; `if (c) a` is a command.
        let Some((inner, rest)) = bracketed(&tokens[1..]) else { return false };
        split(inner, Comma).len() == 1
            && rest.first().is_some_and(|next| next.kind.is_name() || next.kind == OpenBrace)
    }

    /// Joins each function body in braces to the statement before it, which ends with parameters.
    pub(crate) fn join_bodies(self, statements: &mut Vec<Vec<Token>>) {
        let mut index = 1;
        while index < statements.len() {
            let before = &statements[index - 1];
            let is_body = statements[index][0].kind == OpenBrace
                && before.last().is_some_and(|token| token.kind == CloseParen)
                && self.types(before) > 0;
            // In OpenSCAD the right side of a definition may stand on the next line.
            let is_right = before.last().is_some_and(|token| token.kind == Equals)
                && self.word(before[0]) == "function";
            if is_body || is_right {
                let body = statements.remove(index);
                statements[index - 1].extend(body);
            } else {
                index += 1;
            }
        }
    }

    /// Returns whether a statement occurs only in programs, for example `a += 1`.
    pub(crate) fn is_step(self, tokens: &[Token]) -> bool {
        let first = self.word(tokens[0]);
        let types = self.types(tokens);
        let is_open = !matches!(first, "function" | "let" | "var" | "const");
        let is_import = matches!(first, "import" | "from") && begins_name(tokens.get(1));
        let is_grid = |token: &Token| {
            matches!(self.word(*token), "meshgrid" | "mgrid" | "symbols" | "ndgrid" | "ogrid")
        };
        if is_import || tokens.iter().any(is_grid) && tokens.iter().any(|t| t.kind == Equals) {
            return true;
        }
        if types > 0 && is_open || first == "return" && tokens.len() > 1 || first == "#define" {
            return true;
        }
        match tokens {
            [name, component, equals, ..] if name.kind.is_name() => {
                component.kind == Component && equals.kind == Equals && self.may_assign(*equals)
                    || component.kind.is_arithmetic()
                        && equals.kind == Equals
                        && component.span.end == equals.span.start
            }
            _ => false,
        }
    }

    /// Returns whether an equals sign may assign. A sign that is typed `==` compares.
    fn may_assign(self, equals: Token) -> bool {
        !self.text[equals.span.range()].starts_with("==")
    }

    /// Number of types and modifiers before a declared name; 0 if no name follows them.
    pub(crate) fn types(self, tokens: &[Token]) -> usize {
        let is_type = |(at, token): &(usize, &Token)| {
            let word = self.word(**token);
            let is_alias = || {
                // The text is searched only for the first of two words.
                if !begins_name(tokens.get(at + 1)) {
                    return false;
                }
                let head = start(self.text, 2000);
                !word.is_empty()
                    && (head.contains(&format!("typedef double {word};"))
                        || head.contains(&format!("typedef float {word};")))
            };
            is_type(word)
                || word == "T" && start(self.text, 2000).contains("typename T")
                || is_alias()
        };
        let count = tokens.iter().enumerate().take_while(is_type).count();
        if begins_name(tokens.get(count)) { count } else { 0 }
    }

    /// Returns whether `tokens` begin with a function whose body is in braces.
    pub(crate) fn has_body(self, tokens: &[Token]) -> bool {
        self.function(tokens).is_some()
    }

    /// Name, parameters and body of the function at the start of `tokens`, and the tokens after the
    /// body.
    #[allow(clippy::type_complexity)] // callers destructure it
    pub(crate) fn function(
        self,
        tokens: &[Token],
    ) -> Option<(Token, Vec<Vec<Token>>, Vec<Token>, Vec<Token>)> {
        let types = self.types(tokens);
        if types == 0 {
            return None;
        }
        let name = tokens[types];
        let (parameters, rest) = bracketed(&tokens[types + 1..])?;
        // The result type may stand before the body, as in `-> f32 {`.
        let brace = rest.iter().position(|token| token.kind == OpenBrace)?;
        let is_arrow = rest.first().is_some_and(|token| token.kind == Minus);
        if brace > 0 && !is_arrow {
            return None;
        }
        let (body, rest) = bracketed(&rest[brace..])?;
        Some((name, split(parameters, Comma), body.to_vec(), rest.to_vec()))
    }

    /// Name and parameters of `def name(parameters):`, and the tokens after the colon.
    pub(crate) fn python_function(
        tokens: &[Token],
    ) -> Option<(Token, Vec<Vec<Token>>, Vec<Token>)> {
        let (parameters, rest) = bracketed(tokens.get(2..)?)?;
        let colon = rest.iter().position(|token| token.kind == Colon)?;
        let name = *tokens.get(1)?;
        name.kind.is_name().then(|| (name, split(parameters, Comma), rest[colon + 1..].to_vec()))
    }

    /// Name, parameters and value of `f = lambda x: …` or `f = (x) => …`; `f =` may be left out.
    #[allow(clippy::type_complexity)] // callers destructure it
    pub(crate) fn lambda(
        self,
        tokens: &[Token],
    ) -> Option<(Option<Token>, Vec<Vec<Token>>, Vec<Token>)> {
        let (name, rest) = match tokens {
            [name, equals, rest @ ..] if name.kind.is_name() && equals.kind == Equals => {
                (Some(*name), rest)
            }
            rest => (None, rest),
        };
        if self.word(*rest.first()?) == "lambda" {
            let colon = rest.iter().position(|token| token.kind == Colon)?;
            let parameters = split(&rest[1..colon], Comma);
            return Some((name, parameters, rest[colon + 1..].to_vec()));
        }
        // Mathematica writes `Function[{x, y}, value]`.
        if self.word(rest[0]) == "Function" {
            let (inner, more) = bracketed(&rest[1..])?;
            let [names, value] = <[_; 2]>::try_from(split(inner, Comma)).ok()?;
            let (names, _) = bracketed(&names)?;
            return more.is_empty().then(|| (name, split(names, Comma), value));
        }
        let is_word = matches!(self.word(rest[0]), "function" | "proc") || rest[0].kind == At;
        let is_capture = rest[0].kind == OpenBracket
            && rest.get(1).is_some_and(|next| next.kind == CloseBracket);
        let before = if is_word { 1 } else { 2 * usize::from(is_capture) };
        let rest = &rest[before..];
        let (parameters, value) = bracketed(rest).filter(|_| rest[0].kind == OpenParen)?;
        let parameters = split(parameters, Comma);
        match value {
            [first, second, value @ ..]
                if second.kind == Greater
                    && matches!(first.kind, Equals | Minus)
                    && first.span.end == second.span.start =>
            {
                Some((name, parameters, value.to_vec()))
            }
            value if is_word || is_capture => {
                let is_end = |token: &&Token| matches!(self.word(**token), "end" | "proc");
                let ends = value.iter().rev().take_while(is_end).count();
                let value = &value[..value.len() - ends];
                (!value.is_empty()).then(|| (name, parameters, value.to_vec()))
            }
            _ => None,
        }
    }

    /// Name, number of components and default value of a parameter.
    pub(crate) fn parameter(self, tokens: &[Token]) -> Option<(Token, usize, Option<Vec<Token>>)> {
        let equals = tokens.iter().position(|token| token.kind == Equals);
        let declared = &tokens[..equals.unwrap_or(tokens.len())];
        let colon = declared.iter().position(|token| token.kind == Colon);
        let before = &declared[..colon.unwrap_or(declared.len())];
        let name = *before.iter().rfind(|token| token.kind.is_name())?;
        let size = declared.iter().map(|token| size_of(self.word(*token))).max().unwrap_or(1);
        Some((name, size, equals.map(|equals| tokens[equals + 1..].to_vec())))
    }

    /// Name, component letters and value of `name = value`, `name.xy = value` or `name += value`.
    pub(crate) fn assignment(
        self,
        tokens: &[Token],
    ) -> Option<(Token, Option<String>, Vec<Token>)> {
        let (name, rest) = tokens.split_first()?;
        if !name.kind.is_name() {
            return None;
        }
        let letters = rest.first().filter(|token| token.kind == Component);
        let rest = &rest[usize::from(letters.is_some())..];
        let typed = letters.map(|token| self.text[token.span.start + 1..token.span.end].to_owned());
        match rest {
            [equals, value @ ..] if equals.kind == Equals && self.may_assign(*equals) => {
                let is_arrow = value
                    .first()
                    .is_some_and(|next| next.kind == Greater && next.span.start == equals.span.end);
                (!is_arrow).then(|| (*name, typed, value.to_vec()))
            }
            [operator, equals, value @ ..]
                if operator.kind.is_arithmetic()
                    && equals.kind == Equals
                    && operator.span.end == equals.span.start
                    && !value.is_empty() =>
            {
                let mut whole = vec![*name];
                whole.extend(letters);
                whole.push(*operator);
                whole.extend(in_brackets(value));
                Some((*name, typed, whole))
            }
            _ => None,
        }
    }

    /// The names before the equals sign of `a, b = …`, and the tokens after the sign.
    fn set_at_once(tokens: &[Token]) -> Option<(Vec<Token>, &[Token])> {
        let equals = tokens.iter().position(|token| token.kind == Equals)?;
        let single = |tokens: &Vec<Token>| match tokens.as_slice() {
            [only] if only.kind.is_name() => Some(*only),
            _ => None,
        };
        let names: Option<_> = split(&tokens[..equals], Comma).iter().map(single).collect();
        names.map(|names| (names, &tokens[equals + 1..]))
    }

    /// The names and values of `a, b = 1, 2`.
    pub(crate) fn parallel(tokens: &[Token]) -> Option<(Vec<Token>, Vec<Vec<Token>>)> {
        let (names, values) = Self::set_at_once(tokens)?;
        let values = split(values, Comma);
        (names.len() > 1 && names.len() == values.len()).then_some((names, values))
    }

    /// The names and the value of `x, y, z = p`.
    pub(crate) fn unpacked(tokens: &[Token]) -> Option<(Vec<Token>, &[Token])> {
        Self::set_at_once(tokens).filter(|(names, _)| matches!(names.len(), 2..=4))
    }

    /// Returns whether a parameter is a point: `lines` use its components, or compute a length.
    pub(crate) fn is_point(self, parameter: &[Token], lines: &[Vec<Token>]) -> bool {
        let Some((name, _, None)) = self.parameter(parameter) else { return false };
        let name = self.word(name);
        lines.iter().any(|line| {
            let takes = line.windows(2).any(|pair| {
                self.word(pair[0]) == name
                    && (pair[1].kind == Component
                        || pair[1].kind == OpenBracket && pair[0].span.end == pair[1].span.start)
            });
            let unpacks = Self::unpacked(line)
                .is_some_and(|(_, value)| matches!(value, [only] if self.word(*only) == name));
            // The line computes a length, as in `norm(p)`.
            let measures = line.iter().any(|t| matches!(self.word(*t), "norm" | "length"));
            takes || unpacks || measures
        })
    }

    /// The first operator that stands before its operands, as in `(+ a b)`.
    pub(crate) fn prefixed(self, tokens: &[Token]) -> Option<Token> {
        let found = tokens.windows(3).find(|part| {
            part[0].kind == OpenParen
                && matches!(part[1].kind, Plus | Star | Slash)
                && self.text[part[1].span.end..].starts_with(char::is_whitespace)
        });
        found.map(|part| part[1])
    }

    /// Returns whether a statement is only a value: no assignment, no declaration and no `return`.
    pub(crate) fn is_value(self, tokens: &[Token]) -> bool {
        let Some(first) = tokens.first() else { return false };
        self.word(*first) != "return"
            && self.types(tokens) == 0
            && self.assignment(tokens).is_none()
            && tokens.iter().all(|token| token.kind != Equals)
    }

    /// Turns `name: f32 = value` into `name = value`.
    pub(crate) fn without_type(tokens: Vec<Token>) -> Vec<Token> {
        let equals = tokens.iter().position(|token| token.kind == Equals).unwrap_or(tokens.len());
        let is_typed = tokens.get(1).is_some_and(|next| next.kind == Colon)
            && tokens[2..equals]
                .iter()
                .all(|t| t.kind.is_name() || matches!(t.kind, Less | Greater | Number | Unknown));
        if !is_typed {
            return tokens;
        }
        let mut short = vec![tokens[0]];
        short.extend(&tokens[equals..]);
        short
    }

    /// Turns Mathematica's `f@x` into `f(x)`, from the last sign to the first, and the braces of
    /// `\overline{…}` into round brackets.
    pub(crate) fn apply_signs(self, tokens: &mut Vec<Token>) {
        if tokens.iter().filter(|token| token.kind == At).count() > MAX_AT_SIGNS {
            return;
        }
        for at in (1..tokens.len()).rev() {
            // `\vec{r}` is one name.
            let is_accent = ACCENTS.iter().any(|(accent, _)| self.word(tokens[at - 1]) == *accent);
            let end = match bracketed(&tokens[at..]) {
                Some(([name], _)) if name.kind.is_name() => at + 2,
                _ => at,
            };
            if is_accent && (end > at || tokens[at].kind.is_name()) {
                let span = tokens[at - 1].span.to(tokens[end].span);
                tokens.splice(at - 1..=end, [Token::new(TokenKind::Name, span)]);
                continue;
            }
            // `{\cos^2} x` is `\cos^2 x`.
            if tokens[at - 1].kind == OpenBrace
                && self.word(tokens[at]).starts_with('\\')
                && tokens.get(at + 1).is_some_and(|next| next.kind == Caret)
                && let Some(end) = closing(&tokens[at - 1..])
                && (end == 4 || closing(&tokens[at + 2..]).is_some_and(|inner| end == inner + 4))
            {
                tokens.remove(at - 1 + end);
                tokens.remove(at - 1);
                continue;
            }
            if self.word(tokens[at - 1]) == r"\overline"
                && tokens[at].kind == OpenBrace
                && let Some(end) = closing(&tokens[at..])
            {
                tokens[at].kind = OpenParen;
                tokens[at + end].kind = CloseParen;
            }
            let is_applied = tokens[at].kind == At && tokens[at - 1].kind == TokenKind::Name;
            let Some(next) = tokens.get(at + 1).filter(|_| is_applied) else { continue };
            if next.kind == OpenParen {
                tokens.remove(at);
                continue;
            }
            let mut end = at + 2;
            while let Some(length) = tokens.get(end..).and_then(closing) {
                let touches = tokens[end - 1].span.end == tokens[end].span.start;
                if !touches || !matches!(tokens[end].kind, OpenBracket | OpenParen) {
                    break;
                }
                end += length + 1;
            }
            let place = Span::at(tokens[end - 1].span.end);
            tokens[at] = Token::new(OpenParen, Span::at(tokens[at].span.start));
            tokens.insert(end, Token::new(CloseParen, place));
        }
    }

    /// Turns the left side `f[x_, y_]` of a definition in Mathematica into `f[x, y]`.
    pub(crate) fn patterns(self, tokens: &mut [Token]) {
        if tokens.get(1).is_none_or(|next| next.kind != OpenBracket) {
            return;
        }
        let Some(length) = closing(&tokens[1..]) else { return };
        for token in &mut tokens[2..=length] {
            let typed = &self.text[token.span.range()];
            if token.kind == TokenKind::Name && typed.len() > 1 && typed.ends_with('_') {
                token.span = Span::new(token.span.start, token.span.end - 1);
                if let letter @ ("x" | "y" | "z") = &self.text[token.span.range()] {
                    token.kind = token_kind(letter).unwrap_or(TokenKind::Name);
                }
            }
        }
    }
}

/// Returns whether `token` is a name.
pub(crate) fn begins_name(token: Option<&Token>) -> bool {
    token.is_some_and(|token| token.kind.is_name())
}
