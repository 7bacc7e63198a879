//! Reads functions and control structures of programs. Finds their bodies and runs them.

use crate::blocks::ProgramStep;
use crate::control_flow::RESULT;
use crate::language::Language;
use crate::program_reader::{Frame, Procedure, ProcedureParameter, ProgramReader, Statements};
use crate::program_words::{Words, is_scene_function, is_whole_type, size_of};
use std::rc::Rc;
use zeroset_parser::lex::token::{Token, bracketed, closing, split};
use zeroset_parser::lex::token_kind::TokenKind::{
    self, Comma, Equals, OpenBrace, OpenParen, Semicolon,
};
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::{ExprKind, Name, NamedValue};
use zeroset_parser::tree::raw_statement::Head;
use zeroset_parser::tree::scope::coordinate;
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Largest number of functions on one line.
const MAX_FUNCTIONS: usize = 300;

/// Functions whose angles `OpenSCAD` has in degrees.
const ANGLES: &[&str] = &["sin", "cos", "tan", "asin", "acos", "atan", "atan2"];

/// The error for the solids of Python's module `sdf`.
const SOLIDS_OF_SDF: ErrorKind = ErrorKind::Format {
    format: "Python's module sdf",
    read: "no solids are read",
    help: "write a solid as a formula, such as `max(sphere(1), -cylinder(0.5))`, with `union(a, b)`, \
           `intersect(a, b)` and `subtract(a, b)`",
};

/// The error for a blob of POV-Ray.
const BLOB_OF_POV: ErrorKind = ErrorKind::Format {
    format: "POV-Ray",
    read: "no `blob` is read, and only the function of an `isosurface`",
    help: "write the sum of its parts, such as `1/((x - 1)^2 + y^2 + z^2) + 1/((x + 1)^2 + y^2 + z^2) = 2`",
};

/// The error for a module of `OpenSCAD`.
const MODULE_OF_OPENSCAD: ErrorKind = ErrorKind::Format {
    format: "OpenSCAD",
    read: "only functions and values are read, and no modules",
    help: "write the solid as a formula, such as `(sqrt(x^2 + y^2) - 2)^2 + z^2 <= 0.25`",
};

impl ProgramReader<'_> {
    /// Reads a definition in the manner of a single system. Returns false for any other statement.
    pub(crate) fn of_other_system(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<bool> {
        let word = |at: usize| tokens.get(at).map_or("", |token| self.words.word(*token));
        let parameters_end =
            |at: usize| tokens.get(at..).filter(|rest| rest[0].kind == OpenParen).and_then(closing);
        let is_named = !word(1).is_empty();
        match (word(0), tokens) {
            ("import" | "from", _) if word(1) == "sdf" => {
                Err(Error::new(tokens[0].span, SOLIDS_OF_SDF))
            }
            ("blob", [first, open, ..]) if open.kind == OpenBrace => {
                Err(Error::new(first.span, BLOB_OF_POV))
            }
            ("module", [first, _, _, _, ..]) if is_named => {
                Err(Error::new(first.span, MODULE_OF_OPENSCAD))
            }
            ("function", [_, _, _, .., last])
                if is_named
                    && parameters_end(2).is_some_and(|end| {
                        end + 3 == tokens.len() || self.words.word(*last) == "end"
                    }) =>
            {
                self.function_to_end(tokens, following).map(|()| true)
            }
            // POV-Ray's `f = function { … }`, a function of x, y and z.
            (_, [name, equals, _, open, body @ .., _])
                if (equals.kind, open.kind) == (Equals, OpenBrace) && word(2) == "function" =>
            {
                self.pov_function(self.words.name(*name), body.to_vec()).map(|()| true)
            }
            // Julia's `f(x; a = 2) = …`.
            (word, [name, _, ..])
                if name.kind.is_name() && !matches!(word, "for" | "while" | "if") =>
            {
                let is_left =
                    |end: &usize| tokens.get(end + 2).is_some_and(|next| next.kind == Equals);
                let inner = parameters_end(1).filter(is_left).map_or(&[][..], |end| &tokens[..end]);
                let Some(at) = inner.iter().position(|token| token.kind == Semicolon) else {
                    return Ok(false);
                };
                let mut tokens = tokens.to_vec();
                tokens[at].kind = Comma;
                self.function_with_defaults(tokens, frame).map(|()| true)
            }
            _ => Ok(false),
        }
    }

    /// Reads functions with bodies in braces, then the statement after them on the same line.
    pub(crate) fn functions(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let place = tokens.first().map_or(Span::default(), |first| first.span);
        let mut rest = tokens;
        for _ in 0..MAX_FUNCTIONS {
            rest = self.function(rest)?;
            if rest.is_empty() {
                return Ok(());
            }
            if !self.words.has_body(&rest) {
                return self.statement(rest, frame, following);
            }
        }
        Err(Error::new(place, ErrorKind::TooManyNames { limit: MAX_FUNCTIONS }))
    }

    /// Reads one function with its body in braces. Returns the tokens after the body.
    pub(crate) fn function(&mut self, tokens: Vec<Token>) -> Fallible<Vec<Token>> {
        let Some((name, parameters, body, rest)) = self.words.function(&tokens) else {
            return Ok(tokens);
        };
        let types = &tokens[..self.words.types(&tokens)];
        let is_void = self.words.has(types, "void");
        let word = self.words.word(name).to_owned();
        if is_void && matches!(word.as_str(), "main" | "mainImage") {
            // `main` and `mainImage` only color pixels, so they are left out.
            let kind = NoteKind::MainLeftOut { name: word };
            self.program.notes.push(Note { span: name.span, kind });
            return Ok(rest);
        }
        let body = self.expanded(body, 0)?;
        let given = self.procedure_parameters(&parameters);
        let sizes: Vec<usize> = given.iter().map(|given| given.size).collect();
        let before = self.signatures.insert(word.clone(), sizes.clone());
        if self.language == Language::Typed && before.is_some_and(|before| before != sizes) {
            return Err(Error::new(name.span, ErrorKind::Overloaded { name: word }));
        }
        let uses_globals = self.uses_globals(&body);
        let is_procedure = is_void || given.iter().any(|given| given.is_out);
        let mut procedure = None;
        if is_procedure || uses_globals {
            let (changes_globals, body) =
                (self.changes_globals(&body), self.words.block(&body, 0)?);
            procedure = Some(Procedure { parameters: given, body, uses_globals, changes_globals });
        }
        if is_procedure {
            self.record_whole(types, &word);
            self.procedures.extend(procedure.map(|procedure| (word, Rc::new(procedure))));
            return Ok(rest);
        }
        let before = self.program.last_function.clone();
        let mut frame = self.enter(self.words.name(name), parameters)?;
        let returns_vector = types.iter().any(|token| size_of(self.words.word(*token)) > 1);
        let is_scene = is_scene_function(&word);
        if self.program.last_function.as_ref().is_some_and(|name| name.text == word) {
            self.program.draws_first_component = returns_vector && is_scene;
        }
        if before.is_some() && returns_vector && !is_scene {
            // A function that returns a vector, such as a color, does not replace an earlier
            // function to draw.
            self.program.last_function = before;
        }
        self.run_to_result(self.words.block(&body, 0)?, &mut frame)?;
        self.record_whole(types, &word);
        // The function is defined, too, because it may be the one to draw.
        self.procedures.extend(procedure.map(|procedure| (word, Rc::new(procedure))));
        Ok(rest)
    }

    /// Returns whether a function's body uses variables that functions change, or calls a function
    /// whose body does.
    fn uses_globals(&self, body: &[Token]) -> bool {
        body.iter().any(|token| {
            let word = self.words.word(*token);
            let called = self.procedures.get(word);
            self.mutable.contains(word) || called.is_some_and(|called| called.uses_globals)
        })
    }

    /// Returns whether a function's body changes variables outside functions, or calls a function
    /// that does.
    fn changes_globals(&self, body: &[Token]) -> bool {
        (0..body.len()).any(|at| {
            let word = self.words.word(body[at]);
            let called = self.procedures.get(word);
            self.mutable.contains(word) && self.words.may_change(body, at)
                || called.is_some_and(|called| called.changes_globals)
        })
    }

    /// Records whether the function `word` with these types returns an integer.
    fn record_whole(&mut self, types: &[Token], word: &str) {
        if types.iter().any(|token| is_whole_type(self.words.word(*token))) {
            self.whole_functions.insert(word.to_owned());
        }
    }

    /// Runs the body of a function, and ends the function. In Rust and Julia, the last expression
    /// of a body is the function's result.
    fn run_to_result(&mut self, mut steps: Vec<ProgramStep>, frame: &mut Frame) -> Fallible<()> {
        if let Some(ProgramStep::Plain(tokens)) = steps.last_mut()
            && self.language != Language::Typed
            && self.words.is_value(tokens)
        {
            tokens.insert(0, value_word(tokens[0]));
        }
        self.run_open(&steps, frame, false)?;
        self.leave_function(frame)
    }

    /// Ends a function. Fails if the function has no result.
    pub(crate) fn leave_function(&mut self, frame: &Frame) -> Fallible<()> {
        let Some(Head { name, .. }) = &frame.function else { return Ok(()) };
        if !frame.has_result && frame.aliases.find(RESULT).is_none() {
            let word = "void".to_owned();
            return Err(Error::new(name.span, ErrorKind::Program { word }));
        }
        self.end(frame, name.span);
        Ok(())
    }

    /// The parameters of a procedure, each with its direction: in, out or both.
    pub(crate) fn procedure_parameters(
        &self,
        parameters: &[Vec<Token>],
    ) -> Vec<ProcedureParameter> {
        let one = |tokens: &Vec<Token>| {
            let (token, size, default) = self.words.parameter(tokens)?;
            let is_whole = tokens.iter().any(|token| is_whole_type(self.words.word(*token)));
            let has = |word: &str| self.words.has(tokens, word);
            let is_out = has("out") || has("inout");
            Some(ProcedureParameter {
                name: self.words.name(token),
                size,
                is_whole,
                default,
                is_in: !has("out"),
                is_out,
            })
        };
        parameters.iter().filter_map(one).collect()
    }

    /// Runs an `if`, `for` or `while`. Its body may continue in the statements `following`.
    pub(crate) fn control(
        &mut self,
        mut tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let begins_else = |tokens: Option<&Vec<Token>>| {
            tokens.is_some_and(|tokens| self.words.word(tokens[0]) == "else")
        };
        while begins_else(following.as_slice().first()) || !self.words.is_whole(&tokens) {
            let end = tokens.last().map_or(0, |last| last.span.end);
            let is_whole = self.words.is_whole(&tokens);
            let semicolon = Token::new(Semicolon, Span::at(end));
            // A semicolon after `for (…)` is its empty body.
            if !is_whole && self.words.ends_with_semicolon(&tokens) {
                tokens.push(semicolon);
                continue;
            }
            let Some(more) = following.next() else { break };
            tokens.extend(Some(semicolon).filter(|_| is_whole));
            tokens.extend(more);
        }
        let tokens = self.expanded(tokens, 0)?;
        let mut steps = self.words.block(&tokens, 0)?;
        // The statements after a possible early `return` run under a condition.
        if ProgramStep::has(&steps, self.words, "return") {
            for more in following.by_ref() {
                steps.push(ProgramStep::Plain(more));
            }
        }
        self.run(&steps, frame)
    }

    /// Runs an `if`, `for` or `while` whose body is indented.
    pub(crate) fn indented_control(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let own = self.words.indent(&tokens);
        let mut lines = vec![tokens];
        while let Some(next) = following.as_slice().first() {
            let is_else = matches!(self.words.word(next[0]), "elif" | "else");
            if self.words.indent(next) <= own && !is_else {
                break;
            }
            lines.extend(following.next());
        }
        let steps = self.words.lines(&lines, 0)?;
        self.run(&steps, frame)
    }

    /// Reads `f(a) = value` of `OpenSCAD`. `tokens` begin after the word `function`.
    pub(crate) fn openscad_function(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        if self.language == Language::OpenScad
            && let Some((parameters, [equals, body @ ..])) = bracketed(&tokens[1..])
            && equals.kind == Equals
        {
            return self.function_of_openscad(tokens[0], split(parameters, Comma), body.to_vec());
        }
        self.function_with_defaults(tokens, frame)
    }

    /// Reads `f(a, b = 2) = value`.
    pub(crate) fn function_with_defaults(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let name = self.words.name(tokens[0]);
        match bracketed(&tokens[1..]) {
            Some((inner, [equals, rest @ ..]))
                if equals.kind == Equals
                    && rest.first().is_some_and(|word| self.words.word(*word) == "let") =>
            {
                let mut frame = self.enter(name, split(inner, Comma))?;
                self.bindings(rest.to_vec(), &mut frame)?;
            }
            Some((inner, [equals, rest @ ..]))
                if equals.kind == Equals && inner.iter().any(|token| token.kind == Equals) =>
            {
                let frame = self.enter(name, split(inner, Comma))?;
                self.result(rest.to_vec(), &frame)?;
            }
            found => {
                if let Some((inner, rest)) = found
                    && !inner.iter().any(|token| token.kind == Comma)
                    && self.words.is_point(inner, &[rest.to_vec()])
                {
                    self.record_drawn(&name);
                }
                self.plain(tokens, frame, false)?;
            }
        }
        Ok(())
    }

    /// Reads POV-Ray's `name = function { body }`.
    pub(crate) fn pov_function(&mut self, name: Name, body: Vec<Token>) -> Fallible<()> {
        let span = name.span;
        let parameters = ["x", "y", "z"].map(|axis| Name { text: axis.to_owned(), span });
        let parameters = Some(parameters.to_vec());
        let frame = Frame { function: Some(Head { name, parameters }), ..Frame::default() };
        self.result(body, &frame)
    }

    /// Reads a function of Lua or Julia, whose body ends with `end`.
    pub(crate) fn function_to_end(
        &mut self,
        tokens: &[Token],
        following: &mut Statements,
    ) -> Fallible<()> {
        let Some((parameters, body)) = bracketed(&tokens[2..]) else {
            return Err(self.words.unsupported(tokens[0]));
        };
        let first = Some(body.to_vec()).filter(|body| !body.is_empty());
        let lines = self.words.lines_to_end(&mut first.into_iter().chain(following))?;
        let mut lines = lines.into_iter();
        let (steps, _) = self.words.block_to_end(&mut lines, 0)?;
        let mut frame = self.enter(self.words.name(tokens[1]), split(parameters, Comma))?;
        self.run_to_result(steps, &mut frame)
    }

    /// Reads `def name(parameters):` and the lines of its body.
    pub(crate) fn python_function(
        &mut self,
        tokens: &[Token],
        following: &mut Statements,
    ) -> Fallible<()> {
        let word = "def".to_owned();
        let refused = Error::new(tokens[0].span, ErrorKind::Program { word });
        let Some((name, parameters, first)) = Words::python_function(tokens) else {
            return Err(refused);
        };
        let mut lines: Vec<Vec<Token>> =
            Some(first).filter(|first| !first.is_empty()).into_iter().collect();
        let own = self.words.indent(tokens);
        let is_indented =
            following.as_slice().first().is_some_and(|next| self.words.indent(next) > own);
        // A body that was pasted without indentation ends after its `return`.
        while let Some(next) = following.as_slice().first() {
            let ends = if is_indented {
                self.words.indent(next) <= own
            } else {
                self.ends_with_return(&lines)
            };
            if ends {
                break;
            }
            lines.extend(following.next());
        }
        if !lines.iter().any(|line| self.words.has(line, "return")) {
            return Err(refused);
        }
        let mut parameters = parameters;
        parameters.retain(|part| self.words.word(part[0]) != "self");
        let is_point = matches!(parameters.as_slice(), [only] if self.words.is_point(only, &lines));
        let steps = self.words.lines(&lines, 0)?;
        self.record_body(self.words.word(name), &parameters, self.words.lines(&lines, 0)?);
        let mut frame = self.enter(self.words.name(name), parameters)?;
        if is_point {
            self.record_drawn(&self.words.name(name));
        }
        self.run_open(&steps, &mut frame, false)?;
        self.leave_function(&frame)
    }

    /// Reads `f(a, b) = value` or `f = function(a, b) value` of `OpenSCAD`.
    fn function_of_openscad(
        &mut self,
        name: Token,
        parameters: Vec<Vec<Token>>,
        body: Vec<Token>,
    ) -> Fallible<()> {
        let is_point = matches!(parameters.as_slice(), [only] if self.words.is_point(only, std::slice::from_ref(&body)));
        if is_point {
            self.record_drawn(&self.words.name(name));
        }
        let Some(first) = body.first() else {
            return Err(Error::new(name.span, ErrorKind::Unfinished));
        };
        self.record_body(self.words.word(name), &parameters, vec![value_step(*first, &body)]);
        let mut frame = self.enter(self.words.name(name), parameters)?;
        let value = self.run_effects(body, &mut frame)?;
        self.result(value, &frame)
    }

    /// Records the body of a function, for calls that name parameters or leave some out.
    fn record_body(&mut self, name: &str, parameters: &[Vec<Token>], body: Vec<ProgramStep>) {
        let parameters = self.procedure_parameters(parameters);
        let procedure = Procedure { parameters, body, ..Procedure::default() };
        self.bodies.insert(name.to_owned(), Rc::new(procedure));
    }

    /// Returns whether the last line is a `return`.
    fn ends_with_return(&self, lines: &[Vec<Token>]) -> bool {
        lines.last().is_some_and(|line| self.words.word(line[0]) == "return")
    }

    /// Records `name`, a function of a point, as the function to draw. The usual name of a scene is
    /// replaced only by another one, since later functions often compute light or shadow.
    fn record_drawn(&mut self, name: &Name) {
        let is_scene = |name: &Name| is_scene_function(&name.text);
        let known = self.program.last_function.as_ref();
        if is_scene(name) || !known.is_some_and(is_scene) {
            self.program.last_function = Some(name.clone());
        }
    }

    /// Creates the frame of a function. Parameters with default values become definitions.
    pub(crate) fn enter(&mut self, name: Name, parameters: Vec<Vec<Token>>) -> Fallible<Frame> {
        if coordinate(&name.text).is_some() {
            let kind = ErrorKind::CoordinateFunction { name: name.text };
            return Err(Error::new(name.span, kind));
        }
        let mut frame = Frame { integers: self.integers.clone(), ..Frame::default() };
        let mut names = Vec::new();
        let mut given = Vec::new();
        for tokens in parameters {
            let Some((token, size, value)) = self.words.parameter(&tokens) else {
                continue;
            };
            let parameter = self.words.name(token);
            if tokens.iter().any(|token| is_whole_type(self.words.word(*token))) {
                frame.integers.insert(parameter.text.clone());
            } else {
                frame.integers.remove(&parameter.text);
            }
            if let Some(value) = value {
                given.push((parameter, value));
            } else {
                frame.set.push((parameter.text.clone(), size));
                names.push((parameter, size));
            }
        }
        if let [(_, 3)] = names.as_slice() {
            self.record_drawn(&name);
        }
        // A function of x, y and z is drawn rather than a value assigned before the function.
        if names.iter().map(|(name, _)| name.text.as_str()).eq(["x", "y", "z"]) {
            self.program.last_value = None;
        }
        for (parameter, value) in given {
            let text = self.fresh(&format!("{}_{}", name.text, parameter.text));
            let kind = ExprKind::Name(NamedValue::Defined(text.clone()));
            let head = Head { name: Name { text, span: parameter.span }, parameters: None };
            self.push(value, Some(head), None, &Aliases::default(), false)?;
            frame.aliases.push(parameter.text, kind);
        }
        let names: Vec<Name> = names.into_iter().map(|(name, _)| name).collect();
        let parameters = Some(names).filter(|names| !names.is_empty());
        frame.function = Some(Head { name, parameters });
        Ok(frame)
    }

    /// Reads `f = lambda x, y: …` or `f = (x, y) => …`.
    pub(crate) fn lambda(
        &mut self,
        name: Option<Token>,
        parameters: Vec<Vec<Token>>,
        value: Vec<Token>,
        frame: &Frame,
    ) -> Fallible<()> {
        let braces =
            closing(&value).filter(|end| value[0].kind == OpenBrace && end + 1 == value.len());
        let body = braces.map(|end| value[1..end].to_vec());
        let is_point = matches!(parameters.as_slice(), [only] if self.words.is_point(only, std::slice::from_ref(&value)));
        let name = match name {
            Some(name) => self.words.name(name),
            None if is_point => Name { text: self.fresh("f"), span: Span::at(value[0].span.start) },
            None => {
                let typed = parameters.iter().map(|part| part.first().map(|name| name.kind));
                let is_height = typed.eq([Some(TokenKind::X), Some(TokenKind::Y)])
                    && !self.is_condition(&value, frame);
                let mut frame = frame.clone();
                let value = self.with_calls(body.unwrap_or(value), &mut frame)?;
                return self.push(value, None, None, &frame.aliases, is_height);
            }
        };
        if is_point {
            self.record_drawn(&name);
        }
        if body.is_none()
            && matches!(self.language, Language::Python | Language::OpenScad)
            && let Some(first) = value.first()
        {
            self.record_body(&name.text, &parameters, vec![value_step(*first, &value)]);
        }
        self.note_radians(&value);
        let mut frame = self.enter(name, parameters)?;
        let Some(body) = body else {
            let value = self.run_effects(value, &mut frame)?;
            return self.result(value, &frame);
        };
        if !self.words.has(&body, "return") {
            let body = self.run_effects(body, &mut frame)?;
            return self.result(body, &frame);
        }
        let steps = self.words.block(&body, 0)?;
        self.run_open(&steps, &mut frame, false)?;
        self.leave_function(&frame)
    }

    /// Notes that angles are in radians in `function(x) sin(x)`, which `OpenSCAD` has, too.
    fn note_radians(&mut self, value: &[Token]) {
        let Some(first) = value.first().filter(|_| self.language == Language::Plain) else {
            return;
        };
        let before = self.words.text[..first.span.start].trim_end();
        let is_function = before.strip_suffix(')').is_some_and(|before| {
            before.rsplit('(').nth(0).is_some_and(|inner| {
                before[..before.len() - inner.len() - 1].trim_end().ends_with("function")
            })
        });
        let is_angle = |token: &&Token| ANGLES.contains(&self.words.word(**token));
        if is_function && let Some(token) = value.iter().find(is_angle) {
            self.program.notes.push(Note { span: token.span, kind: NoteKind::RadiansOfR });
        }
    }

    /// Reads `let(a = 1, b = 2) value`.
    pub(crate) fn bindings(&mut self, tokens: Vec<Token>, frame: &mut Frame) -> Fallible<()> {
        let Some((inner, rest)) = bracketed(&tokens[1..]) else {
            return self.plain(tokens, frame, false);
        };
        for tokens in split(inner, Comma) {
            if let Some((name, None, value)) = self.words.assignment(&tokens) {
                self.set(self.words.name(name), 1, value, frame)?;
            }
        }
        self.result(rest.to_vec(), frame)
    }
}

/// The word `return` before a value whose first token is `first`.
fn value_word(first: Token) -> Token {
    Token::new(TokenKind::Saved, Span::at(first.span.start))
}

/// A statement that returns the value `body`, whose first token is `first`.
fn value_step(first: Token, body: &[Token]) -> ProgramStep {
    ProgramStep::Plain(std::iter::once(value_word(first)).chain(body.iter().copied()).collect())
}
