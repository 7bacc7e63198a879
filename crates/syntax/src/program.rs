//! Programs as people paste them, brought to statements of this language: functions with bodies,
//! typed declarations, names that are set again, `return`.
//!
//! A name that a function sets becomes a function of the same parameters, so that nothing is left
//! that runs in steps: `vec2 q = p.xz;` in `f(p)` is `f_q(p) = p.xz`, and `q` below it `f_q(p)`. Each
//! time that a name is set again it is another one. What a formula means is not known here.

use crate::aliases::Aliases;
use crate::arrange::arrange;
use crate::ast::{Expr, ExprKind, Function, Name, NamedValue};
use crate::error::{Error, ErrorKind, Fallible};
use crate::limits::Limits;
use crate::note::{Note, NoteKind};
use crate::program_words::{Words, begins_name, bracketed, size_of, split};
use crate::scan::{Piece, Token, scan};
use crate::spelling::is_setting;
use crate::statement::Head;
use rustc_hash::FxHashSet;

/// The most names that a function sets, and the most functions on one line.
const MOST_NAMES: usize = 300;

/// A statement, and what the program around it says of it.
pub(crate) struct Unit {
    pub piece: Piece,
    /// What it defines, where its symbols are the right side only.
    pub head: Option<Head>,
    /// What names stand for here, the last of a name counting.
    pub aliases: Aliases,
    /// The components that are set, of a vector that had this value before.
    pub write: Option<Write>,
    /// Whether a height over x and y is drawn.
    pub is_height: bool,
}

/// Some components of a vector, which are set.
pub(crate) struct Write {
    pub letters: String,
    pub before: ExprKind,
    pub size: usize,
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
        program: Program { in_steps, ..Program::default() },
    };
    let mut top = Frame::default();
    let mut statements = statements.into_iter();
    while let Some(tokens) = statements.next() {
        reader.statement(tokens, &mut top, &mut statements)?;
    }
    Ok(reader.program)
}

/// The names of a function's body, or of what is outside functions.
#[derive(Default)]
struct Frame {
    /// The function's name and parameters.
    function: Option<(Name, Vec<Name>)>,
    aliases: Aliases,
    /// Names that were set, with the number of their components.
    set: Vec<(String, usize)>,
}

struct Reader<'a> {
    words: Words<'a>,
    limits: &'a Limits,
    /// Names that the text uses, or that were made.
    taken: FxHashSet<String>,
    /// Names that were defined.
    heads: FxHashSet<String>,
    program: Program,
}

type Statements = std::vec::IntoIter<Vec<Token>>;

impl Reader<'_> {
    /// One statement, which may be a function with the statements after it.
    fn statement(
        &mut self,
        mut tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let Some(first) = tokens.first().copied() else {
            return Ok(());
        };
        if is_setting(first.symbol) && frame.function.is_none() {
            return self.plain(tokens, frame, false);
        }
        match self.words.word(first) {
            "import" | "from" if begins_name(tokens.get(1)) => return Ok(()),
            "for" | "while" | "struct" | "switch" | "void" | "if" | "else" | "do"
                if Words::is_command(&tokens) =>
            {
                let word = self.words.word(first).to_owned();
                return Err(Error::new(first.span, ErrorKind::Program { word }));
            }
            "def" if tokens.len() > 3 => return self.python(&tokens, following),
            "return" if tokens.len() > 1 => {
                tokens.remove(0);
                return self.result(tokens, frame);
            }
            "#define" if tokens.len() > 2 => {
                tokens.remove(0);
                let name = self.words.name(tokens.remove(0));
                return self.set(name, 1, tokens, None, frame);
            }
            "function" if tokens.len() > 2 && !self.words.has_body(&tokens) => {
                tokens.remove(0);
                let trigonometric = tokens.iter().find(|token| {
                    matches!(self.words.word(**token), "sin" | "cos" | "tan" | "atan2" | "atan")
                });
                let note = trigonometric
                    .map(|token| Note { span: token.span, kind: NoteKind::DegreesOfOpenscad });
                match self.words.with_bindings(&tokens) {
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
            for _ in 0..MOST_NAMES {
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
        let types = self.words.types(&tokens);
        if types > 0 {
            let size = tokens[..types].iter().map(|t| size_of(self.words.word(*t))).max();
            tokens.drain(..types);
            return self.declarations(tokens, size.unwrap_or(1), frame);
        }
        if self.program.in_steps || frame.function.is_some() {
            if let Some((left, right)) = Words::parallel(&tokens) {
                for (name, value) in left.into_iter().zip(right) {
                    self.set(self.words.name(name), 1, value, None, frame)?;
                }
                return Ok(());
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
        let is_height = plots && self.words.plot(&mut tokens);
        self.words.patterns(&mut tokens);
        self.push(tokens, None, None, &frame.aliases, is_height)
    }

    fn push(
        &mut self,
        tokens: Vec<Token>,
        head: Option<Head>,
        write: Option<Write>,
        aliases: &Aliases,
        is_height: bool,
    ) -> Fallible<()> {
        if tokens.is_empty() {
            return match head {
                Some(head) => Err(Error::new(head.name.span, ErrorKind::Unfinished)),
                None => Ok(()),
            };
        }
        if let Some(piece) = arrange(self.words.text, tokens, self.limits)? {
            let aliases = aliases.clone();
            self.heads.extend(head.iter().map(|head| head.name.text.clone()));
            self.program.units.push(Unit { piece, head, aliases, write, is_height });
        }
        Ok(())
    }

    /// `float a = 1., b = 2.`, its types taken away.
    fn declarations(&mut self, tokens: Vec<Token>, size: usize, frame: &mut Frame) -> Fallible<()> {
        for tokens in split(tokens, ',') {
            if let Some((name, parameters, value)) = self.words.lambda(&tokens) {
                self.lambda(name, parameters, value, frame)?;
            } else if let Some((name, None, value)) = self.words.assignment(&tokens) {
                let name = self.words.name(name);
                self.set(name, size, value, None, frame)?;
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
    fn set(
        &mut self,
        name: Name,
        size: usize,
        value: Vec<Token>,
        letters: Option<String>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        if frame.set.len() >= MOST_NAMES {
            return Err(Error::new(name.span, ErrorKind::TooManyNames { limit: MOST_NAMES }));
        }
        let again = frame.set.iter().any(|(set, _)| *set == name.text)
            && frame.aliases.find(&name.text).is_some()
            || self.defined(&name.text);
        let is_inner = frame.function.is_some();
        let text = match &frame.function {
            Some((function, _)) => self.fresh(&format!("{}_{}", function.text, name.text)),
            None if again
                || letters.is_some()
                || self.uses(&value, &name.text)
                || matches!(name.text.as_str(), "x" | "y" | "z" | "t") =>
            {
                self.fresh(&format!("{}_2", name.text))
            }
            None => name.text.clone(),
        };
        let parameters = frame.function.as_ref().map(|(_, parameters)| parameters.clone());
        let parameters = parameters.filter(|parameters| !parameters.is_empty());
        let write = letters.map(|letters| {
            let before = frame.aliases.find(&name.text);
            let before = before
                .map_or_else(|| ExprKind::Name(Self::unset(&name.text, frame)), ExprKind::clone);
            Write { letters, before, size }
        });
        let kind = match &parameters {
            None => ExprKind::Name(NamedValue::Defined(text.clone())),
            Some(parameters) => {
                let local = |name: &Name| {
                    let value = NamedValue::Local(name.text.clone());
                    Expr::new(ExprKind::Name(value), name.span)
                };
                let function = Function::Defined(text.clone());
                ExprKind::Call(function, parameters.iter().map(local).collect())
            }
        };
        let renamed = text != name.text;
        let made = Name { text, span: name.span };
        if size == 1 && write.is_none() && !is_inner {
            self.program.last_value = Some(made.clone());
        }
        let head = Head { name: made, parameters };
        self.push(value, Some(head), write, &frame.aliases, false)?;
        if renamed || is_inner {
            frame.aliases.push(name.text.clone(), kind);
        }
        frame.set.push((name.text, size));
        Ok(())
    }

    /// What a name stands for that nothing has set.
    fn unset(name: &str, frame: &Frame) -> NamedValue {
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
    fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.taken.insert(name.clone()) {
            number += 1;
            name = format!("{}_{number}", wanted.strip_suffix("_2").unwrap_or(wanted));
        }
        name
    }

    /// `return value`.
    fn result(&mut self, tokens: Vec<Token>, frame: &Frame) -> Fallible<()> {
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
        let mut frame = self.enter(self.words.name(name), parameters)?;
        let mut none = Vec::new().into_iter();
        let mut returned = false;
        for tokens in split(body, ';') {
            if returned {
                break;
            }
            returned = tokens.first().is_some_and(|token| self.words.word(*token) == "return");
            self.statement(tokens, &mut frame, &mut none)?;
        }
        if let (Some((name, _)), false) = (frame.function, returned) {
            let word = "void".to_owned();
            return Err(Error::new(name.span, ErrorKind::Program { word }));
        }
        Ok(rest)
    }

    /// `def name(parameters):` and the lines up to `return`.
    fn python(&mut self, tokens: &[Token], following: &mut Statements) -> Fallible<()> {
        let word = "def".to_owned();
        let refused = Error::new(tokens[0].span, ErrorKind::Program { word });
        let Some((name, parameters, first)) = Words::python(tokens) else {
            return Err(refused);
        };
        let mut frame = self.enter(self.words.name(name), parameters)?;
        let mut next = Some(first).filter(|first| !first.is_empty());
        loop {
            let Some(tokens) = next.take().or_else(|| following.next()) else {
                return Err(refused);
            };
            let returned = tokens.first().is_some_and(|t| self.words.word(*t) == "return");
            self.statement(tokens, &mut frame, following)?;
            if returned {
                return Ok(());
            }
        }
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
        let Some(name) = name else {
            return self.plain(value, frame, false);
        };
        let frame = self.enter(self.words.name(name), parameters)?;
        self.result(value, &frame)
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
