//! Reads notebooks of Python: the calls that draw, wherever they stand in a statement, and the
//! scalars of grids. A statement that neither defines nor draws is left out, with one note.

use crate::curve_commands::{COMMANDS, LISTED, draws_surface};
use crate::drawing_calls::{DRAWING_CALLS, WRAPPERS};
use crate::formats::part;
use crate::plot_commands::{CONTAINERS, GRIDS, is_plot};
use crate::program_reader::{
    Frame, Procedure, ProcedureParameter, ProgramReader, Statements, Unread,
};
use crate::program_words::Words;
use zeroset_parser::lex::spelling::{plain_name, short_name};
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::*;
use zeroset_parser::tree::ast::{ExprKind, NamedValue};
use zeroset_parser::tree::scope::is_function;
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Attributes of a grid that hold its scalars.
const SCALARS: &[&str] = &["point_data", "point_arrays", "cell_data", "cell_arrays"];

/// Words that begin a block. The block is read as if it had no such line above it.
const HEADERS: &[&str] = &["class", "with", "try", "except", "finally"];

/// Prefix of the names for values of statements that were left out.
pub(crate) const UNREAD: &str = "#unread";

impl Words<'_> {
    /// Returns whether a statement is a plot command, perhaps with a name before it.
    pub(crate) fn is_drawing(self, tokens: &[Token]) -> bool {
        let value = &tokens[self.assigned_at(tokens).map_or(0, |at| at + 1)..];
        let word = value.first().map_or("", |first| self.word(*first));
        let is_open = |next: &Token| matches!(next.kind, OpenParen | OpenBracket | OpenBrace);
        let is_command = || {
            is_plot(word)
                || draws_surface(word)
                || LISTED.contains(&word)
                || matches!(word, "contour" | "Manipulate" | "Table")
        };
        value.get(1).is_some_and(is_open) && is_command()
    }

    /// Returns whether a statement beside plot commands sets or prints something, as
    /// `p.Color = 'red'` does.
    pub(crate) fn is_aside(self, tokens: &[Token]) -> bool {
        let plots = |token: &Token| {
            let word = self.word(*token);
            is_plot(word) || COMMANDS.contains(&word) || word.starts_with("ez") || word == "splot"
        };
        Self::has_unknown(tokens)
            && !tokens.iter().any(plots)
            && !self.is_drawing(tokens)
            && !self.is_style(tokens)
            && self.unwrap_statement(tokens).is_none()
    }

    /// Returns whether a statement calls a method that draws, or a command that draws over a grid.
    pub(crate) fn draws_by_call(self, tokens: &[Token]) -> bool {
        let word = self.word(tokens[0]);
        let begins_with_plot = (GRIDS.contains(&word) || LISTED.contains(&word))
            && tokens.get(1).is_some_and(|open| open.kind == OpenParen);
        begins_with_plot
            || tokens.windows(3).any(|part| {
                let word = self.word(part[1]);
                self.is_dot(part[0])
                    && part[2].kind == OpenParen
                    && DRAWING_CALLS.iter().any(|row| row.word == word)
            })
    }
}

impl ProgramReader<'_> {
    /// Reads a statement outside functions. If one that does not draw has an error, it is left out.
    /// The error is reported only if a drawing needs a name that the statement defines.
    pub(crate) fn notebook_statement(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let tokens = self.as_lambda(self.with_substitutions(tokens));
        self.record_assigned(&tokens);
        if self.is_header(&tokens, frame, following) || self.notebook_draws(&tokens, frame)? {
            return Ok(());
        }
        if self.words.has(&tokens, "points") && self.grid(&tokens, frame)? {
            return Ok(());
        }
        if self.scalars(&tokens) || self.makes_symbols(&tokens) {
            return Ok(());
        }
        let mut names = self.defined_by(&tokens);
        if matches!(self.words.word(tokens[0]), "for" | "while" | "if") {
            let own = self.words.indent(&tokens);
            let block = following.as_slice().iter();
            let block = block.take_while(|line| self.words.indent(line) > own);
            names.extend(block.flat_map(|line| self.defined_by(line)));
        }
        if let Some(error) = self.left_out(&tokens, frame) {
            self.leave_out(&tokens, &names, error, frame);
            return Ok(());
        }
        let mark = (self.program.statements.len(), self.program.synthesized.len());
        let before = (frame.clone(), self.program.last_function.clone());
        match self.statement(tokens.clone(), frame, following) {
            Err(error) if !matches!(error.kind, ErrorKind::Format { .. }) => {
                self.program.statements.truncate(mark.0);
                self.program.synthesized.truncate(mark.1);
                (*frame, self.program.last_function) = before;
                self.leave_out(&tokens, &names, error, frame);
                Ok(())
            }
            done => {
                // Statements that set these names may have been left out. Now they have values.
                for name in names {
                    if frame.aliases.find(&name).is_some_and(is_unread) {
                        let value = NamedValue::Defined(name.clone());
                        frame.aliases.push(name, ExprKind::Name(value));
                    }
                }
                done
            }
        }
    }

    /// Returns whether a statement makes symbols from their names, as in `x = Symbol("x")`.
    fn makes_symbols(&self, tokens: &[Token]) -> bool {
        let Some(at) = self.words.assigned_at(tokens) else { return false };
        let typed = |token: &Token| &self.words.text[token.span.range()];
        let value = &tokens[at + 1..];
        let open = value.iter().position(|token| token.kind == OpenParen);
        let parts = open.and_then(|open| Words::inside(&value[open..])).map(|i| split(i, Comma));
        let path = &value[..open.unwrap_or(0)];
        match parts.as_deref() {
            Some([first, ..]) if matches!(first.as_slice(), [text] if text.kind == Unknown) => {
                let text = &first[0];
                let all = typed(text).trim_matches(|c| "\"'".contains(c));
                let mut given = all.split([' ', ',']).filter(|name| !name.is_empty());
                let names = tokens[..at].iter().filter(|token| token.kind.is_name());
                path.iter().all(|token| token.kind.is_name() || self.words.is_dot(*token))
                    && names
                        .map(|name| self.words.word(*name))
                        .all(|name| given.next() == Some(name))
            }
            _ => false,
        }
    }

    /// Returns whether a statement only begins a block: a class, a condition on `__name__`, or a
    /// function that returns nothing. If the function has parameters, its lines take the place of
    /// its calls, or are left out.
    fn is_header(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
        following: &mut Statements,
    ) -> bool {
        let word = self.words.word(tokens[0]);
        let ends_with_colon = tokens.last().is_some_and(|last| last.kind == Colon);
        if word == "if" && self.words.has(tokens, "__name__")
            || HEADERS.contains(&word) && ends_with_colon
        {
            return true;
        }
        if word != "def" || tokens.len() < 4 {
            return false;
        }
        let Some((name, parameters, first)) = Words::python_function(tokens) else { return false };
        let own = self.words.indent(tokens);
        let lines = following.as_slice().iter().take_while(|line| self.words.indent(line) > own);
        let count = lines.clone().count();
        if !first.is_empty() || count == 0 || self.returns(lines) {
            return false;
        }
        let is_own = |part: &Vec<Token>| self.words.word(part[0]) == "self";
        if !parameters.iter().all(is_own) {
            let body: Vec<Vec<Token>> = following.by_ref().take(count).collect();
            if !self.in_place_of_calls(name, &parameters, &body, following) {
                let error = Error::new(name.span, ErrorKind::NoFormula);
                self.leave_out(tokens, &self.defined_by(tokens), error, frame);
            }
        }
        true
    }

    /// The statements of a call of this language's Python package, such as `zs.Surface(f, a=2)`:
    /// the values of parameters, and the formula. `None` for other statements.
    pub(crate) fn package_surface(&self, tokens: &[Token]) -> Fallible<Option<Vec<Vec<Token>>>> {
        let call = &tokens[self.words.assigned_at(tokens).map_or(0, |at| at + 1)..];
        let call = match call {
            [module, dot, call @ ..] if module.kind.is_name() && self.words.is_dot(*dot) => call,
            call => call,
        };
        let Some((name, (inner, _))) =
            call.split_first().and_then(|(n, c)| Some((n, bracketed(c)?)))
        else {
            return Ok(None);
        };
        if self.words.word(*name) != "Surface" || self.arity(*name).is_some() {
            return Ok(None);
        }
        let is_value = |part: &Vec<Token>| part.get(1).is_some_and(|sign| sign.kind == Equals);
        let (mut values, formulas): (Vec<_>, Vec<_>) =
            self.words.plot_arguments(inner).into_iter().partition(is_value);
        let [formula] = formulas.as_slice() else { return Ok(None) };
        // plotly's `Surface` takes coordinates by their names.
        if values.iter().any(|value| value[0].kind.is_axis()) {
            return Ok(None);
        }
        values.push(match formula.as_slice() {
            [text] if text.kind == Unknown && text.span.end - text.span.start > 2 => {
                part(self.words.text, text.span.start + 1..text.span.end - 1, &self.limits)?
            }
            formula => formula.to_vec(),
        });
        Ok(Some(values))
    }

    /// Puts the lines of a function that draws in place of its calls. Returns false if there is
    /// no such call, or the call is read as a plot command.
    fn in_place_of_calls(
        &self,
        name: Token,
        parameters: &[Vec<Token>],
        body: &[Vec<Token>],
        following: &mut Statements,
    ) -> bool {
        let word = self.words.word(name);
        let draws =
            |line: &Vec<Token>| self.words.draws_by_call(line) || self.words.is_drawing(line);
        let is_plot = is_plot(word) && !CONTAINERS.contains(&word);
        if is_plot || !body.iter().any(draws) {
            return false;
        }
        let given = self.procedure_parameters(parameters);
        let procedure = Procedure { parameters: given, ..Procedure::default() };
        let is_main = self.words.text.contains("__name__");
        let mut all: Vec<Vec<Token>> = Vec::new();
        let mut is_called = false;
        for line in following.by_ref() {
            let is_outer = is_main || self.words.indent(&line) == self.words.indent(&[name]);
            let call = Words::inside(&line[1..]).filter(|_| self.words.word(line[0]) == word);
            let values = call.filter(|_| is_outer).and_then(|inner| {
                self.with_defaults(line[0], &procedure, &split(inner, Comma)).ok()
            });
            let Some(values) = values else {
                all.push(line);
                continue;
            };
            is_called = true;
            all.extend(body.iter().map(|line| self.with_values(line, &procedure, &values)));
        }
        *following = all.into_iter();
        is_called
    }

    /// A line of a function with values in place of its parameters. Keywords of calls stay.
    fn with_values(
        &self,
        line: &[Token],
        procedure: &Procedure,
        values: &[Vec<Token>],
    ) -> Vec<Token> {
        let mut all = Vec::new();
        for (at, token) in line.iter().enumerate() {
            let is_keyword = line.get(at + 1).is_some_and(|next| next.kind == Equals);
            let own = |given: &ProcedureParameter| given.name.text == self.words.word(*token);
            match procedure.parameters.iter().position(own).filter(|_| !is_keyword) {
                Some(index) if values[index].len() > 1 => all.extend(in_brackets(&values[index])),
                Some(index) => all.extend(&values[index]),
                None => all.push(*token),
            }
        }
        all
    }

    /// Returns whether the lines of a function return a value, apart from functions within it.
    fn returns<'t>(&self, lines: impl Iterator<Item = &'t Vec<Token>>) -> bool {
        let mut within = None;
        for line in lines {
            let indent = self.words.indent(line);
            if within.is_some_and(|own| indent > own) {
                continue;
            }
            within = (self.words.word(line[0]) == "def").then_some(indent);
            if within.is_none() && self.words.has(line, "return") {
                return true;
            }
        }
        false
    }

    /// The names that an assignment or a function defines.
    pub(crate) fn defined_by(&self, tokens: &[Token]) -> Vec<String> {
        let left = match (self.words.word(tokens[0]), self.words.assigned_at(tokens)) {
            ("def", _) => tokens.get(1..2).unwrap_or_default(),
            (_, Some(at)) => &tokens[..at],
            _ => return Vec::new(),
        };
        let names = left.iter().map(|token| self.words.word(*token));
        names.filter(|name| !name.is_empty()).map(str::to_owned).collect()
    }

    /// The reason to leave out a statement; `None` if it is to be read.
    fn left_out(&self, tokens: &[Token], frame: &Frame) -> Option<Box<Error>> {
        let first = tokens[0];
        let word = self.words.word(first);
        let is_import = matches!(word, "import" | "from");
        if is_import && self.words.has(tokens, "sdf") {
            return None;
        }
        let is_decorator = first.kind == At && tokens.get(1).is_none_or(|t| t.kind != OpenParen);
        let is_no_formula = is_decorator || is_import || word == "pass";
        // An assignment to a part of an array, as in `a[a > 1] = 1`, changes what its name means.
        let sets_part = self.words.assigned_at(tokens).is_some_and(|at| {
            let is_target = |token: &Token| {
                token.kind.is_name()
                    || token.kind.is_arithmetic()
                    || matches!(token.kind, Comma | OpenParen | CloseParen | Colon | Equals)
            };
            at > 1 && !tokens[..at].iter().all(is_target)
        });
        let is_plot = self.words.is_drawing(tokens);
        // Beside calls that draw, a formula alone on a line only shows its value.
        let is_word = matches!(word, "def" | "for" | "if" | "while" | "return" | "lambda");
        let is_bare = self.draws_by_calls && self.words.assigned_at(tokens).is_none() && !is_word;
        if is_bare && !is_plot {
            return Some(Error::new(first.span, ErrorKind::NoFormula));
        }
        if is_plot && !sets_part && !is_no_formula {
            return None;
        }
        if is_no_formula
            || sets_part
            || !matches!(word, "def" | "for" | "if" | "while") && Words::has_unknown(tokens)
        {
            let at =
                tokens.iter().find(|token| token.kind == Unknown).map_or(first.span, |t| t.span);
            return Some(Error::new(at, ErrorKind::NoFormula));
        }
        // A call of a function that neither the text nor this language knows.
        let end = tokens.get(1).filter(|open| open.kind == OpenParen && first.kind.is_name());
        let is_call =
            end.is_some() && closing(&tokens[1..]).is_some_and(|end| end + 2 == tokens.len());
        let is_known = self.arities.contains_key(word)
            || self.procedures.contains_key(word)
            || frame.aliases.find(word).is_some()
            || is_function(&plain_name(word));
        (is_call && !is_known).then(|| Error::new(first.span, ErrorKind::NoFormula))
    }

    /// Leaves out a statement. `error` is reported if a drawing needs one of `names`.
    pub(crate) fn leave_out(
        &mut self,
        tokens: &[Token],
        names: &[String],
        error: Box<Error>,
        frame: &mut Frame,
    ) {
        let span = span_of(tokens).unwrap_or_default();
        let key = format!("{UNREAD}{}", self.unread.len());
        for name in names {
            let value = NamedValue::Defined(key.clone());
            frame.aliases.push(name.clone(), ExprKind::Name(value));
        }
        self.unread.push(Unread { key, names: names.to_vec(), error });
        let first = self.words.text.get(span.range()).and_then(|text| text.lines().next());
        let example = short_name(first.unwrap_or("…"));
        let is_import = matches!(self.words.word(tokens[0]), "import" | "from");
        match &mut self.program.left_out {
            Some(note) => {
                if let NoteKind::StatementsLeftOut { count, example: shown } = &mut note.kind {
                    *count += 1;
                    // An import is the least telling example.
                    if shown.starts_with("import ") || shown.starts_with("from ") {
                        *shown = if is_import { shown.clone() } else { example };
                    }
                }
            }
            none => {
                *none =
                    Some(Note { span, kind: NoteKind::StatementsLeftOut { count: 1, example } });
            }
        }
    }

    /// Reads `grid["v"] = values` or `vol = Volume(values)`. The object then stands for the values.
    fn scalars(&mut self, tokens: &[Token]) -> bool {
        let Some(at) = self.words.assigned_at(tokens) else { return false };
        let (left, value) = (&tokens[..at], &tokens[at + 1..]);
        let name = left[0];
        let index = match left {
            [_] => &[][..],
            [_, dot, scalars, index @ ..]
                if self.words.is_dot(*dot) && SCALARS.contains(&self.words.word(*scalars)) =>
            {
                index
            }
            [_, index @ ..] => index,
            [] => return false,
        };
        let is_text = |token: &Token| token.kind == Unknown;
        let is_field = bracketed(index)
            .is_some_and(|(inner, rest)| rest.is_empty() && inner.len() == 1 && is_text(&inner[0]));
        let value = match is_field {
            true => Some(value.to_vec()),
            false if left.len() == 1 => WRAPPERS.iter().find_map(|word| {
                let (before, parts) = self.words.call_of(value, word)?;
                let is_path = before.iter().all(|t| t.kind.is_name() || self.words.is_dot(*t));
                parts.last().filter(|_| is_path).cloned()
            }),
            false => None,
        };
        let Some(value) = value.filter(|value| !Words::has_unknown(value)) else { return false };
        self.fields.insert(self.words.word(name).to_owned(), value);
        true
    }

    /// Turns `f = lambdify((x, y), value)` into a function of x and y.
    fn as_lambda(&self, tokens: Vec<Token>) -> Vec<Token> {
        let Some((before, parts)) = self.words.call_of(&tokens, "lambdify") else { return tokens };
        let [names, value, ..] = parts.as_slice() else { return tokens };
        let place = value[0].span.start;
        let mut all: Vec<Token> = before.to_vec();
        while all.last().is_some_and(|dot| self.words.is_dot(*dot)) {
            all.truncate(all.len().saturating_sub(2));
        }
        all.push(Token::new(At, Span::at(place)));
        all.extend(in_brackets(Words::inside(names).unwrap_or(names)));
        all.extend(in_brackets(&self.resolved(value)));
        all
    }

    /// Replaces `f.subs(x, 2*x)` and `f.subs({a: 2, b: 3})` by the value of `f` with these values.
    fn with_substitutions(&self, tokens: Vec<Token>) -> Vec<Token> {
        let at = tokens.windows(3).position(|part| {
            part[0].kind.is_name()
                && self.words.is_dot(part[1])
                && self.words.word(part[2]) == "subs"
        });
        let Some((at, (inner, rest))) = at.and_then(|at| Some((at, bracketed(&tokens[at + 3..])?)))
        else {
            return tokens;
        };
        let pairs: Vec<Vec<Token>> = match Words::inside(inner) {
            Some(list) if inner[0].kind == OpenBrace => split(list, Comma),
            _ => vec![inner.to_vec()],
        };
        let rules: Vec<(Token, Vec<Token>)> = pairs
            .iter()
            .filter_map(|pair| {
                let sign = pair.get(1).filter(|sign| matches!(sign.kind, Colon | Comma))?;
                pair[0].kind.is_name().then(|| (pair[0], split(pair, sign.kind).pop()))
            })
            .filter_map(|(name, value)| Some((name, value?)))
            .collect();
        let value = self.resolved(&tokens[at..=at]);
        let value = Words::substituted(&value, &rules, self.words.text);
        let Some(value) = value.filter(|_| rules.len() == pairs.len()) else { return tokens };
        let mut all = tokens[..at].to_vec();
        all.extend(in_brackets(&value));
        all.extend(rest);
        all
    }
}

/// Returns whether an alias is the value of a statement that was left out.
fn is_unread(kind: &ExprKind) -> bool {
    matches!(kind, ExprKind::Name(NamedValue::Defined(name)) if name.starts_with(UNREAD))
}
