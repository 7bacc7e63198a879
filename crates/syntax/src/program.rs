//! Programs as people paste them, brought to statements of this language: functions with bodies,
//! typed declarations, names that are set again, `return`.
//!
//! A name that a function sets becomes a function of the same parameters, so that nothing is left
//! that runs in steps: `vec2 q = p.xz;` in `f(p)` is `f_q(p) = p.xz`, and `q` below it `f_q(p)`. Each
//! time that a name is set again it is another one. What a formula means is not known here.

use crate::aliases::Aliases;
use crate::arrange::arrange;
use crate::ast::{Definition, Expr, ExprKind, Function, Name, NamedValue, Statement};
use crate::calls::{Given, Macro, Procedure};
use crate::control::RESULT;
use crate::counting::{number_of, written};
use crate::error::{Error, ErrorKind, Fallible};
use crate::limits::Limits;
use crate::note::{Note, NoteKind};
use crate::program_words::{Words, begins_name, bracketed, is_whole_type, size_of, split};
use crate::scan::{Piece, Token, scan};
use crate::span::Span;
use crate::spelling::{is_name, is_setting};
use crate::statement::Head;
use crate::steps::{Step, closing};
use crate::value::LETTERS;
use crate::wrappers::Unwrapped;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cell::Cell;
use std::rc::Rc;

/// The most names that a function sets.
const MOST_NAMES: usize = 1500;

/// The most functions on one line.
const MOST_FUNCTIONS: usize = 300;

/// A statement, and what the program around it says of it.
pub(crate) struct Unit {
    pub piece: Piece,
    /// What it defines, where its symbols are the right side only.
    pub head: Option<Head>,
    /// What names stand for here, the last of a name counting.
    pub aliases: Aliases,
    /// What is made of its value.
    pub wrap: Option<Wrap>,
    /// Whether a height over x and y is drawn.
    pub is_height: bool,
}

/// What a program makes of a value before it has a name.
pub(crate) enum Wrap {
    /// Some components of a vector are set, which had this value before.
    Write { letters: String, before: ExprKind, size: usize },
    /// 1 where a condition holds, else 0.
    Flag,
    /// One component of it.
    Pick(char),
}

/// A statement that the text does not spell out.
pub(crate) struct Made {
    pub statement: Statement,
    pub span: Span,
    /// Names that it uses.
    pub used: FxHashSet<String>,
}

impl Made {
    pub(crate) fn new(statement: Statement, span: Span) -> Self {
        let mut used = FxHashSet::default();
        let (Statement::Draw { expr, .. } | Statement::Define(Definition { body: expr, .. })) =
            &statement;
        names_in(expr, &mut used);
        Self { statement, span, used }
    }
}

/// Collects the names of the document that what a program makes is made of.
fn names_in(expr: &Expr, used: &mut FxHashSet<String>) {
    match &expr.kind {
        ExprKind::Name(NamedValue::Defined(name)) => {
            used.insert(name.clone());
        }
        ExprKind::Call(function, arguments) => {
            if let Function::Defined(name) = function {
                used.insert(name.clone());
            }
            for argument in arguments {
                names_in(argument, used);
            }
        }
        ExprKind::Choice(pieces, otherwise) => {
            for (condition, value) in pieces {
                names_in(condition, used);
                names_in(value, used);
            }
            if let Some(otherwise) = otherwise {
                names_in(otherwise, used);
            }
        }
        ExprKind::Compare(left, rest) => {
            names_in(left, used);
            for (_, right) in rest {
                names_in(right, used);
            }
        }
        ExprKind::Sum(left, rest) => {
            names_in(left, used);
            for (_, right) in rest {
                names_in(right, used);
            }
        }
        ExprKind::Component(inner, _) | ExprKind::Negate(inner) => names_in(inner, used),
        _ => {}
    }
}

/// A text as statements.
#[derive(Default)]
pub(crate) struct Program {
    pub units: Vec<Unit>,
    /// Whether names are typed or set in steps, as programs do.
    pub in_steps: bool,
    /// The last function of one vector of three components.
    pub last_function: Option<Name>,
    /// The last number that was set outside functions.
    pub last_value: Option<Name>,
    /// What the text does not spell out.
    pub made: Vec<Made>,
    /// Names that were made for branches and loops, which may be used nowhere.
    pub generated: FxHashSet<String>,
    pub notes: Vec<Note>,
}

/// Reads `text` as statements.
pub(crate) fn program(text: &str, limits: &Limits) -> Fallible<Program> {
    let mut statements = scan(text, limits)?;
    let words = Words { text };
    words.join_bodies(&mut statements);
    let taken = statements
        .iter()
        .flatten()
        .map(|token| &text[token.span.range()])
        .collect::<FxHashSet<_>>();
    let in_steps = statements.iter().any(|tokens| words.is_step(tokens));
    let mut reader = Reader {
        words,
        limits,
        taken: taken.into_iter().map(str::to_owned).collect(),
        heads: FxHashSet::default(),
        macros: FxHashMap::default(),
        procedures: FxHashMap::default(),
        constants: FxHashMap::default(),
        generated: FxHashSet::default(),
        steps: 0,
        written: Cell::new(0),
        program: Program { in_steps, ..Program::default() },
    };
    let mut top = Frame::default();
    let mut statements = statements.into_iter();
    while let Some(tokens) = statements.next() {
        reader.statement(tokens, &mut top, &mut statements)?;
    }
    reader.end(&top, Span::at(text.len()))?;
    reader.program.generated = reader.generated;
    Ok(reader.program)
}

/// The names of a function's body, or of what is outside functions.
#[derive(Clone, Default)]
pub(crate) struct Frame {
    /// The function's name and parameters.
    pub function: Option<(Name, Vec<Name>)>,
    pub aliases: Aliases,
    /// Names that were set, with the number of their components.
    pub set: Vec<(String, usize)>,
    /// Names that count in whole numbers, and have a number that is known.
    pub whole: FxHashSet<String>,
    /// How many branches and loops are around.
    pub nested: usize,
    /// How many calls are around that are written out.
    pub depth: usize,
    /// What names begin with that are made in a call that is written out.
    pub prefix: Option<String>,
    /// Whether the result was written as it stands.
    pub is_done: bool,
}

pub(crate) struct Reader<'a> {
    pub words: Words<'a>,
    pub limits: &'a Limits,
    /// Names that the text uses, or that were made.
    taken: FxHashSet<String>,
    /// Names that were defined.
    pub heads: FxHashSet<String>,
    pub macros: FxHashMap<String, Rc<Macro>>,
    pub procedures: FxHashMap<String, Rc<Procedure>>,
    /// Numbers that names stand for outside functions.
    pub constants: FxHashMap<String, f64>,
    /// Names that were made in branches and loops.
    pub generated: FxHashSet<String>,
    /// How many statements were run.
    pub steps: usize,
    /// How many symbols macros were written out to.
    pub written: Cell<usize>,
    pub program: Program,
}

pub(crate) type Statements = std::vec::IntoIter<Vec<Token>>;

impl Reader<'_> {
    /// One statement, which may be a function with the statements after it.
    pub(crate) fn statement(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let mut tokens = self.expanded(tokens, 0)?;
        let Some(first) = tokens.first().copied() else {
            return Ok(());
        };
        if let Some(sign) = self.words.prefixed(&tokens) {
            return Err(Error::new(sign.span, ErrorKind::Prefix));
        }
        if is_setting(first.symbol) && frame.function.is_none() {
            return self.plain(tokens, frame, false);
        }
        if frame.function.is_none() {
            match self.words.unwrapped(&tokens) {
                Some(Unwrapped::Statements(all)) => {
                    // Each is shorter, so that this ends.
                    for tokens in all {
                        self.statement(tokens, frame, &mut Vec::new().into_iter())?;
                    }
                    return Ok(());
                }
                Some(Unwrapped::Drawn(name)) => {
                    let value = NamedValue::Defined("surface".to_owned());
                    let expr = Expr::new(ExprKind::Name(value), name.span);
                    let statement = Statement::Draw { expr, restrictions: Vec::new() };
                    self.program.made.push(Made::new(statement, name.span));
                    return Ok(());
                }
                None => {}
            }
        }
        match self.words.word(first) {
            "import" | "from" if begins_name(tokens.get(1)) => return Ok(()),
            "for" | "while" | "if" if self.words.governs(&tokens) => {
                return self.governing(tokens, frame, following);
            }
            "for" | "while" | "if" if self.words.governs_lines(&tokens) => {
                return self.governing_lines(tokens, frame, following);
            }
            "struct" | "switch" | "do" | "else" | "elif"
                if Words::is_command(&tokens) || self.words.governs(&tokens) =>
            {
                let word = self.words.word(first).to_owned();
                return Err(Error::new(first.span, ErrorKind::Program { word }));
            }
            "def" if tokens.len() > 3 => return self.python(&tokens, following),
            "return" if tokens.len() > 1 => {
                tokens.remove(0);
                return self.result(tokens, frame);
            }
            "#define" if tokens.len() > 1 => {
                self.macro_of(&tokens[1..]);
                return Ok(());
            }
            "function"
                if tokens.len() > 2
                    && !self.words.has_body(&tokens)
                    && begins_name(tokens.get(1)) =>
            {
                tokens.remove(0);
                let trigonometric = tokens.iter().find(|token| {
                    matches!(self.words.word(**token), "sin" | "cos" | "tan" | "atan2" | "atan")
                });
                let note = trigonometric
                    .map(|token| Note { span: token.span, kind: NoteKind::DegreesOfOpenscad });
                let value = tokens.get(1..).and_then(bracketed);
                let value = value.filter(|(inner, rest)| {
                    let has_values = inner.iter().any(|token| token.symbol == '=');
                    has_values && rest.first().is_some_and(|next| next.symbol == '=')
                });
                match self.words.with_bindings(&tokens) {
                    None if value.is_some() => {
                        if let Some((inner, rest)) = value {
                            let name = self.words.name(tokens[0]);
                            let frame = self.enter(name, split(inner, ','))?;
                            self.result(rest[1..].to_vec(), &frame)?;
                        }
                    }
                    Some((name, parameters, bindings)) => {
                        let mut frame = self.enter(self.words.name(name), parameters)?;
                        self.bindings(bindings, &mut frame)?;
                    }
                    None => self.plain(tokens, frame, false)?,
                }
                if let Some(unit) = self.program.units.last_mut() {
                    unit.piece.notes.extend(note);
                }
                return Ok(());
            }
            "let" if tokens.get(1).is_some_and(|token| token.symbol == '(') => {
                return self.bindings(tokens, frame);
            }
            _ => {}
        }
        if self.words.has_body(&tokens) {
            let mut rest = tokens;
            for _ in 0..MOST_FUNCTIONS {
                rest = self.function(rest)?;
                if rest.is_empty() {
                    return Ok(());
                }
                if !self.words.has_body(&rest) {
                    return self.statement(rest, frame, following);
                }
            }
            return Err(Error::new(first.span, ErrorKind::TooManyNames { limit: MOST_NAMES }));
        }
        if let Some((procedure, arguments)) = self.called(&tokens) {
            self.inline(first, &procedure, &arguments, frame)?;
            return Ok(());
        }
        let types = self.words.types(&tokens);
        if types > 0 {
            let size = tokens[..types].iter().map(|t| size_of(self.words.word(*t))).max();
            let is_whole = tokens[..types].iter().any(|t| is_whole_type(self.words.word(*t)));
            tokens.drain(..types);
            return self.declarations(tokens, size.unwrap_or(1), is_whole, frame);
        }
        if self.counts(&tokens, frame) {
            return Ok(());
        }
        if self.program.in_steps || frame.function.is_some() {
            if let Some((left, right)) = Words::parallel(&tokens) {
                // All values are those before any of the names is set.
                let within = frame.aliases.clone();
                for (name, value) in left.into_iter().zip(right) {
                    self.set_within(self.words.name(name), 1, value, &within, frame)?;
                }
                return Ok(());
            }
            if let Some((names, value)) = Words::unpacked(&tokens) {
                return self.unpack(&names, &value, frame);
            }
            if let Some((name, letters, value)) = self.words.assignment(&tokens) {
                let name = self.words.name(name);
                let known = frame.set.iter().rfind(|(set, _)| *set == name.text);
                let size = known.map_or(3, |(_, size)| *size);
                let is_set = frame.function.is_some() || known.is_some() || letters.is_some();
                // `x = 3` is an equation, unless a program has declared x.
                let is_coordinate = matches!(name.text.as_str(), "x" | "y" | "z" | "t");
                if is_coordinate && !is_set {
                    return self.plain(tokens, frame, true);
                }
                let is_steps = is_set || self.words.is_step(&tokens);
                if is_steps || value.iter().any(|t| self.words.word(*t) == name.text) {
                    return self.set(name, size, value, letters, frame);
                }
                frame.set.push((name.text, size));
            }
        }
        if let Some((name, parameters, value)) = self.words.lambda(&tokens) {
            return self.lambda(name, parameters, value, frame);
        }
        self.plain(tokens, frame, true)
    }

    /// A statement as it stands.
    fn plain(&mut self, tokens: Vec<Token>, frame: &Frame, plots: bool) -> Fallible<()> {
        let mut tokens = tokens;
        if frame.function.is_some() && plots && self.words.assignment(&tokens).is_none() {
            return Err(Error::new(tokens[0].span, ErrorKind::NoEffect));
        }
        if let [name, equals, number] = tokens.as_slice()
            && equals.symbol == '='
            && number.symbol == '0'
            && let Some(value) = self.known(&[*number], &mut Frame::default())
        {
            self.constants.insert(self.words.word(*name).to_owned(), value);
        }
        let is_height = plots && self.words.plot(&mut tokens);
        self.words.patterns(&mut tokens);
        self.push(tokens, None, None, &frame.aliases, is_height)
    }

    pub(crate) fn push(
        &mut self,
        tokens: Vec<Token>,
        head: Option<Head>,
        wrap: Option<Wrap>,
        aliases: &Aliases,
        is_height: bool,
    ) -> Fallible<()> {
        if tokens.is_empty() {
            return match head {
                Some(head) => Err(Error::new(head.name.span, ErrorKind::Unfinished)),
                None => Ok(()),
            };
        }
        let changing = |token: &&Token| {
            let procedure = self.procedures.get(self.words.word(**token));
            procedure.is_some_and(|procedure| procedure.changes)
        };
        if let Some(token) = tokens.iter().find(changing) {
            let name = self.words.word(*token).to_owned();
            return Err(Error::new(token.span, ErrorKind::OutParameter { name }));
        }
        if let Some(piece) = arrange(self.words.text, tokens, self.limits)? {
            let aliases = aliases.clone();
            self.heads.extend(head.iter().map(|head| head.name.text.clone()));
            self.program.units.push(Unit { piece, head, aliases, wrap, is_height });
        }
        Ok(())
    }

    /// `float a = 1., b = 2.`, its types taken away.
    fn declarations(
        &mut self,
        tokens: Vec<Token>,
        size: usize,
        is_whole: bool,
        frame: &mut Frame,
    ) -> Fallible<()> {
        for tokens in split(tokens, ',') {
            let tokens = self.words.without_type(tokens);
            let is_inner = frame.function.is_some() || frame.prefix.is_some() || frame.nested > 0;
            if is_whole
                && is_inner
                && let Some(name) = tokens.first()
            {
                frame.whole.insert(self.words.word(*name).to_owned());
            }
            if self.counts(&tokens, frame) {
                continue;
            }
            if let Some((name, parameters, value)) = self.words.lambda(&tokens) {
                self.lambda(name, parameters, value, frame)?;
            } else if let Some((name, None, value)) = self.words.assignment(&tokens) {
                if let Some((procedure, arguments)) = self.called(&value) {
                    let kind = self.inline(value[0], &procedure, &arguments, frame)?;
                    let text = self.words.name(name).text;
                    let none = || Error::new(name.span, ErrorKind::NoEffect);
                    frame.aliases.push(text.clone(), kind.ok_or_else(none)?);
                    frame.set.push((text, size));
                    continue;
                }
                let name = self.words.name(name);
                self.set(name, size, value, None, frame)?;
            } else if let [name, open, ..] = tokens.as_slice()
                && open.symbol == '['
                && is_name(name.symbol)
            {
                return Err(Error::new(name.span, ErrorKind::Array));
            } else if let [name] = tokens.as_slice() {
                // A name that is set later.
                frame.set.push((self.words.word(*name).to_owned(), size));
            } else {
                self.plain(tokens, frame, false)?;
            }
        }
        Ok(())
    }

    /// `name = value`, or with `letters` some components of it.
    pub(crate) fn set(
        &mut self,
        name: Name,
        size: usize,
        value: Vec<Token>,
        letters: Option<String>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let within = frame.aliases.clone();
        let write = letters.map(|letters| {
            let before = within.find(&name.text);
            let before = before
                .map_or_else(|| ExprKind::Name(Self::unset(&name.text, frame)), ExprKind::clone);
            Wrap::Write { letters, before, size }
        });
        self.set_to(name, size, value, write, &within, frame)
    }

    /// `name = value`, whose names stand for what they are in `within`.
    pub(crate) fn set_within(
        &mut self,
        name: Name,
        size: usize,
        value: Vec<Token>,
        within: &Aliases,
        frame: &mut Frame,
    ) -> Fallible<()> {
        self.set_to(name, size, value, None, within, frame)
    }

    fn set_to(
        &mut self,
        name: Name,
        size: usize,
        value: Vec<Token>,
        wrap: Option<Wrap>,
        within: &Aliases,
        frame: &mut Frame,
    ) -> Fallible<()> {
        if frame.set.len() >= MOST_NAMES {
            return Err(Error::new(name.span, ErrorKind::TooManyNames { limit: MOST_NAMES }));
        }
        let again = frame.set.iter().any(|(set, _)| *set == name.text)
            && frame.aliases.find(&name.text).is_some()
            || self.defined(&name.text);
        let is_inner = frame.function.is_some() || frame.prefix.is_some() || frame.nested > 0;
        let text = match &frame.function {
            _ if is_inner => self.fresh(&frame.made_name(&name.text)),
            Some(_) => name.text.clone(),
            None if again
                || wrap.is_some()
                || self.uses(&value, &name.text)
                || matches!(name.text.as_str(), "x" | "y" | "z" | "t") =>
            {
                self.fresh(&format!("{}_2", name.text))
            }
            None => name.text.clone(),
        };
        let (parameters, kind) = frame.call(&text);
        if frame.nested > 0 {
            self.generated.insert(text.clone());
        }
        if frame.function.is_none() {
            match self.known(&value, &mut frame.clone()).filter(|_| wrap.is_none()) {
                Some(number) => self.constants.insert(name.text.clone(), number),
                None => self.constants.remove(&name.text),
            };
        }
        let renamed = text != name.text;
        let made = Name { text, span: name.span };
        if size == 1 && wrap.is_none() && frame.function.is_none() && frame.prefix.is_none() {
            self.program.last_value = Some(made.clone());
        }
        let head = Head { name: made, parameters };
        self.push(value, Some(head), wrap, within, false)?;
        if renamed || is_inner {
            frame.aliases.push(name.text.clone(), kind);
        }
        frame.set.push((name.text, size));
        Ok(())
    }

    /// What a name stands for that nothing has set.
    pub(crate) fn unset(name: &str, frame: &Frame) -> NamedValue {
        let parameters = frame.function.iter().flat_map(|(_, parameters)| parameters);
        if parameters.into_iter().any(|parameter| parameter.text == name) {
            NamedValue::Local(name.to_owned())
        } else {
            NamedValue::Defined(name.to_owned())
        }
    }

    fn defined(&self, name: &str) -> bool {
        self.heads.contains(name)
    }

    fn uses(&self, tokens: &[Token], name: &str) -> bool {
        tokens.iter().any(|token| self.words.word(*token) == name)
    }

    /// A name like `wanted` that the text does not use.
    pub(crate) fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.taken.insert(name.clone()) {
            number += 1;
            name = format!("{}_{number}", wanted.strip_suffix("_2").unwrap_or(wanted));
        }
        name
    }

    /// `return value`.
    pub(crate) fn result(&mut self, tokens: Vec<Token>, frame: &Frame) -> Fallible<()> {
        let head = frame.function.as_ref().map(|(name, parameters)| Head {
            name: name.clone(),
            parameters: Some(parameters.clone()).filter(|parameters| !parameters.is_empty()),
        });
        self.push(tokens, head, None, &frame.aliases, false)
    }

    /// A function whose body stands in braces; what follows it is left.
    fn function(&mut self, tokens: Vec<Token>) -> Fallible<Vec<Token>> {
        let Some((name, parameters, body, rest)) = self.words.function(&tokens) else {
            return Ok(tokens);
        };
        let types = &tokens[..self.words.types(&tokens)];
        let is_void = types.iter().any(|token| self.words.word(*token) == "void");
        let word = self.words.word(name).to_owned();
        if is_void && matches!(word.as_str(), "main" | "mainImage") {
            // What it would be drawn with.
            let kind = NoteKind::MainLeftOut { name: word };
            self.program.notes.push(Note { span: name.span, kind });
            return Ok(rest);
        }
        let body = self.expanded(body, 0)?;
        let mut steps = self.words.block(&body, 0)?;
        let given = self.given(&parameters);
        if is_void || given.iter().any(|given| given.is_out) {
            let changes = given.iter().any(|given| given.is_out);
            let procedure = Procedure { parameters: given, body: steps, changes };
            self.procedures.insert(word, Rc::new(procedure));
            return Ok(rest);
        }
        // In Rust the last expression is the result.
        let tail = steps.last().and_then(|last| match last {
            Step::Plain(tokens) if self.words.is_value(tokens) => Some(tokens.clone()),
            _ => None,
        });
        if tail.is_some() {
            steps.pop();
        }
        let mut frame = self.enter(self.words.name(name), parameters)?;
        self.run(&steps, &mut frame)?;
        if let Some(tail) = tail {
            self.result(tail, &frame)?;
            frame.is_done = true;
        }
        self.leave_function(&frame)?;
        Ok(rest)
    }

    /// Ends a function, which must return something.
    fn leave_function(&mut self, frame: &Frame) -> Fallible<()> {
        let Some((name, _)) = &frame.function else { return Ok(()) };
        if !frame.is_done && frame.aliases.find(RESULT).is_none() {
            let word = "void".to_owned();
            return Err(Error::new(name.span, ErrorKind::Program { word }));
        }
        self.end(frame, name.span)
    }

    /// Parameters, and which of them are changed.
    fn given(&self, parameters: &[Vec<Token>]) -> Vec<Given> {
        let one = |tokens: &Vec<Token>| {
            let (token, size, _) = self.words.parameter(tokens)?;
            let has = |word: &str| tokens.iter().any(|token| self.words.word(*token) == word);
            let is_out = has("out") || has("inout");
            Some(Given { name: self.words.name(token), size, is_in: !has("out"), is_out })
        };
        parameters.iter().filter_map(one).collect()
    }

    /// `if`, `for` or `while`, and what it governs, of which some may stand on further lines.
    fn governing(
        &mut self,
        mut tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let begins_else = |tokens: Option<&Vec<Token>>| {
            tokens.is_some_and(|tokens| self.words.word(tokens[0]) == "else")
        };
        while begins_else(following.as_slice().first()) || !self.words.is_whole(&tokens) {
            let Some(more) = following.next() else { break };
            tokens.push(Token::new(';', Span::at(more[0].span.start)));
            tokens.extend(more);
        }
        let tokens = self.expanded(tokens, 0)?;
        let mut steps = self.words.block(&tokens, 0)?;
        // A function may leave before its end: what follows is then a branch as well.
        if Step::has(&steps, self.words, "return") {
            for more in following.by_ref() {
                steps.push(Step::Plain(more));
            }
        }
        self.run(&steps, frame)
    }

    /// As `governing`, where lines are indented.
    fn governing_lines(
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

    /// Counts, where a name that counts is set to a number that is known.
    fn counts(&mut self, tokens: &[Token], frame: &mut Frame) -> bool {
        if Words::steps_by_one(tokens) && tokens.len() == 3 {
            return self.known(tokens, frame).is_some();
        }
        let Some((name, None, value)) = self.words.assignment(tokens) else { return false };
        let text = self.words.word(name).to_owned();
        let is_known = frame.aliases.find(&text).is_some_and(|kind| number_of(kind).is_some());
        if !is_known && !frame.whole.contains(&text) {
            return false;
        }
        let Some(number) = self.known(&value, frame) else { return false };
        frame.aliases.push(text.clone(), written(number, name.span));
        frame.set.push((text, 1));
        true
    }

    /// `x, y, z = p`.
    fn unpack(&mut self, names: &[Token], value: &[Token], frame: &mut Frame) -> Fallible<()> {
        let within = frame.aliases.clone();
        for (name, letter) in names.iter().zip(LETTERS.chars()) {
            let wrap = Some(Wrap::Pick(letter));
            self.set_to(self.words.name(*name), 1, value.to_vec(), wrap, &within, frame)?;
        }
        Ok(())
    }

    /// `def name(parameters):` and the lines up to `return`.
    fn python(&mut self, tokens: &[Token], following: &mut Statements) -> Fallible<()> {
        let word = "def".to_owned();
        let refused = Error::new(tokens[0].span, ErrorKind::Program { word });
        let Some((name, parameters, first)) = Words::python(tokens) else {
            return Err(refused);
        };
        let mut lines: Vec<Vec<Token>> =
            Some(first).filter(|first| !first.is_empty()).into_iter().collect();
        let own = self.words.indent(tokens);
        let is_indented =
            following.as_slice().first().is_some_and(|next| self.words.indent(next) > own);
        while lines.is_empty() || is_indented {
            let next = following.as_slice().first();
            if next.is_none_or(|next| is_indented && self.words.indent(next) <= own) {
                break;
            }
            lines.extend(following.next());
        }
        if !is_indented && !self.ends(&lines) {
            // Lost its indentation: it ends where it returns.
            for next in following.by_ref() {
                lines.push(next);
                if self.ends(&lines) {
                    break;
                }
            }
        }
        if !lines.iter().any(|line| line.iter().any(|token| self.words.word(*token) == "return")) {
            return Err(refused);
        }
        let is_point = matches!(parameters.as_slice(), [only] if self.words.is_point(only, &lines));
        let steps = self.words.lines(&lines, 0)?;
        let mut frame = self.enter(self.words.name(name), parameters)?;
        if is_point {
            self.program.last_function = Some(self.words.name(name));
        }
        self.run(&steps, &mut frame)?;
        self.leave_function(&frame)
    }

    /// Whether the last line returns.
    fn ends(&self, lines: &[Vec<Token>]) -> bool {
        lines.last().is_some_and(|line| self.words.word(line[0]) == "return")
    }

    /// The frame of a function; parameters with values become names that are set.
    fn enter(&mut self, name: Name, parameters: Vec<Vec<Token>>) -> Fallible<Frame> {
        let mut frame = Frame::default();
        let mut names = Vec::new();
        let mut given = Vec::new();
        for tokens in parameters {
            let Some((token, size, value)) = self.words.parameter(&tokens) else {
                continue;
            };
            let parameter = self.words.name(token);
            if let Some(value) = value {
                given.push((parameter, value));
            } else {
                frame.set.push((parameter.text.clone(), size));
                names.push((parameter, size));
            }
        }
        if let [(_, 3)] = names.as_slice() {
            self.program.last_function = Some(name.clone());
        }
        for (parameter, value) in given {
            let text = self.fresh(&format!("{}_{}", name.text, parameter.text));
            let kind = ExprKind::Name(NamedValue::Defined(text.clone()));
            let head = Head { name: Name { text, span: parameter.span }, parameters: None };
            self.push(value, Some(head), None, &Aliases::default(), false)?;
            frame.aliases.push(parameter.text, kind);
        }
        let names = names.into_iter().map(|(name, _)| name).collect();
        frame.function = Some((name, names));
        Ok(frame)
    }

    /// `f = lambda x, y: …` and `f = (x, y) => …`.
    fn lambda(
        &mut self,
        name: Option<Token>,
        parameters: Vec<Vec<Token>>,
        value: Vec<Token>,
        frame: &Frame,
    ) -> Fallible<()> {
        let braces = closing(&value).filter(|end| value[0].symbol == '{' && end + 1 == value.len());
        let body = braces.map(|end| value[1..end].to_vec());
        let Some(name) = name else {
            return self.plain(body.unwrap_or(value), frame, false);
        };
        let mut frame = self.enter(self.words.name(name), parameters)?;
        let Some(body) = body else { return self.result(value, &frame) };
        if !body.iter().any(|token| self.words.word(*token) == "return") {
            return self.result(body, &frame);
        }
        let steps = self.words.block(&body, 0)?;
        self.run(&steps, &mut frame)?;
        self.leave_function(&frame)
    }

    /// `let(a = 1, b = 2) value`.
    fn bindings(&mut self, tokens: Vec<Token>, frame: &mut Frame) -> Fallible<()> {
        let Some((inner, rest)) = bracketed(&tokens[1..]) else {
            return self.plain(tokens, frame, false);
        };
        for tokens in split(inner, ',') {
            if let Some((name, None, value)) = self.words.assignment(&tokens) {
                self.set(self.words.name(name), 1, value, None, frame)?;
            }
        }
        self.result(rest, frame)
    }
}
