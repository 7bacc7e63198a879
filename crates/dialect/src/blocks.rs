//! Splits blocks of programs into trees of statements. Formulas stay unparsed.

use crate::effects::is_doubled;
use crate::program_words::Words;
use zeroset_parser::lex::token_kind::TokenKind::*;

use zeroset_parser::lex::token::{Token, closing, outside};
use zeroset_parser::{Error, ErrorKind, Fallible};

/// Deepest nesting of blocks.
const MAX_DEPTH: usize = 40;

/// A statement, or a control structure with the statements it contains.
#[derive(Debug)]
pub(crate) enum ProgramStep {
    Plain(Vec<Token>),
    /// Statements in braces.
    Block(Vec<ProgramStep>),
    If {
        condition: Vec<Token>,
        yes: Vec<ProgramStep>,
        no: Vec<ProgramStep>,
    },
    /// A `for` or `while` loop. `next` runs after each iteration. `while` has no `next` or `start`.
    Loop {
        word: Token,
        start: Vec<Token>,
        condition: Vec<Token>,
        next: Vec<Token>,
        body: Vec<ProgramStep>,
        /// Statements after Python's `else`, which run unless the loop was left early.
        otherwise: Vec<ProgramStep>,
    },
    /// A loop over the values of a list or range. `pattern` is one variable or several, as in
    /// `for a, b in pairs:`. `name` is its first token.
    Each {
        name: Token,
        pattern: Vec<Token>,
        values: Vec<Token>,
        body: Vec<ProgramStep>,
        otherwise: Vec<ProgramStep>,
    },
}

impl ProgramStep {
    /// Returns whether `steps` contain, at any depth, a statement that begins with `word`.
    pub(crate) fn has(steps: &[Self], words: Words<'_>, word: &str) -> bool {
        steps.iter().any(|step| match step {
            Self::Plain(tokens) => tokens.first().is_some_and(|first| words.word(*first) == word),
            Self::If { yes, no, .. } => Self::has(yes, words, word) || Self::has(no, words, word),
            Self::Block(inner) => Self::has(inner, words, word),
            Self::Loop { body, otherwise, .. } | Self::Each { body, otherwise, .. } => {
                Self::has(body, words, word) || Self::has(otherwise, words, word)
            }
        })
    }

    /// A token near the start of the step, for error messages.
    pub(crate) fn first(&self) -> Option<Token> {
        match self {
            Self::Plain(tokens) => tokens.first().copied(),
            Self::Block(inner) => inner.first().and_then(Self::first),
            Self::If { condition, .. } => condition.first().copied(),
            Self::Loop { word, .. } => Some(*word),
            Self::Each { name, .. } => Some(*name),
        }
    }
}

/// The variables of `a, b in values`, and the tokens of the values.
pub(crate) fn loop_names(tokens: &[Token]) -> Option<(Vec<Token>, &[Token])> {
    let within = outside(tokens, In)?;
    let is_name = |token: &Token| token.kind.is_name();
    let is_sign =
        |token: &Token| token.kind == Comma || token.kind == OpenParen || token.kind == CloseParen;
    let left = &tokens[..within];
    let names: Vec<Token> = left.iter().copied().filter(is_name).collect();
    let is_read = !names.is_empty() && left.iter().all(|token| is_name(token) || is_sign(token));
    is_read.then(|| (names, &tokens[within + 1..]))
}

/// Drops the semicolons at the start of `tokens`.
fn skip(tokens: &[Token]) -> &[Token] {
    let count = tokens.iter().take_while(|token| token.kind == Semicolon).count();
    &tokens[count..]
}

impl Words<'_> {
    /// Returns whether `tokens` begin a control structure, such as `if (c) …`.
    pub(crate) fn is_control(self, tokens: &[Token]) -> bool {
        let Some(first) = tokens.first() else { return false };
        match self.word(*first) {
            "for" | "while" => tokens.get(1).is_some_and(|next| next.kind == OpenParen),
            // `if(c, a, b)` is a value; `if (c) a` is a statement.
            "if" => {
                let Some(end) = tokens.get(1..).and_then(closing) else { return false };
                tokens[1].kind == OpenParen
                    && outside(&tokens[2..=end], Comma).is_none()
                    && tokens.get(end + 2).is_none_or(|next| {
                        next.kind.is_name() && self.word(*next) != "else"
                            || next.kind == OpenBrace
                            || matches!(next.kind, Semicolon | OpenParen)
                            || is_doubled(tokens, end + 2)
                    })
            }
            "else" => {
                let begins = |next: &Token| next.kind.is_name() || next.kind == OpenBrace;
                tokens.get(1).is_none_or(begins) || is_doubled(tokens, 1)
            }
            _ => false,
        }
    }

    /// Returns whether the last statement of `tokens` is complete. An `if` or loop needs a body.
    pub(crate) fn is_whole(self, tokens: &[Token]) -> bool {
        let mut is_whole = true;
        let mut rest = skip(tokens);
        while let Some(first) = rest.first() {
            let is_else = self.word(*first) == "else";
            let is_control = is_else || self.is_control(rest);
            let end = match first.kind {
                _ if is_else => Some(1),
                _ if is_control => closing(&rest[1..]).map(|close| close + 2),
                OpenBrace => closing(rest).map(|close| close + 1),
                _ => outside(rest, Semicolon).or(Some(rest.len())),
            };
            let Some(end) = end else { return false };
            let is_empty = rest.get(end).is_some_and(|next| next.kind == Semicolon);
            is_whole = !is_control || is_empty;
            rest = skip(&rest[end..]);
        }
        is_whole
    }

    /// The statements of a block in braces.
    pub(crate) fn block(self, tokens: &[Token], depth: usize) -> Fallible<Vec<ProgramStep>> {
        let mut steps = Vec::new();
        let mut rest = skip(tokens);
        while !rest.is_empty() {
            rest = skip(self.step(rest, depth, &mut steps)?);
        }
        Ok(steps)
    }

    /// Appends the first statement of `tokens` to `steps` and returns the tokens after it.
    fn step<'t>(
        self,
        tokens: &'t [Token],
        depth: usize,
        steps: &mut Vec<ProgramStep>,
    ) -> Fallible<&'t [Token]> {
        let tokens = skip(tokens);
        let Some(first) = tokens.first().copied() else { return Ok(tokens) };
        if depth > MAX_DEPTH {
            return Err(Error::new(first.span, ErrorKind::TooDeep { limit: MAX_DEPTH }));
        }
        if first.kind == OpenBrace
            && let Some(end) = closing(tokens)
        {
            steps.push(ProgramStep::Block(self.block(&tokens[1..end], depth + 1)?));
            return Ok(&tokens[end + 1..]);
        }
        if matches!(self.word(first), "switch" | "struct" | "do") && Self::is_command(tokens) {
            return Err(self.unsupported(first));
        }
        if !self.is_control(tokens) || self.word(first) == "else" {
            let end = outside(tokens, Semicolon).unwrap_or(tokens.len());
            steps.push(ProgramStep::Plain(tokens[..end].to_vec()));
            return Ok(&tokens[end..]);
        }
        let Some(end) = closing(&tokens[1..]) else { return Err(self.unsupported(first)) };
        let (header, rest) = (&tokens[2..=end], &tokens[end + 2..]);
        let mut body = Vec::new();
        // In `for (…);` the body is empty.
        let mut rest = match rest.first() {
            Some(first) if first.kind == Semicolon => &rest[1..],
            _ => self.step(rest, depth + 1, &mut body)?,
        };
        match self.word(first) {
            "if" => {
                let mut no = Vec::new();
                let next = skip(rest);
                if next.first().is_some_and(|next| self.word(*next) == "else") {
                    rest = self.step(&next[1..], depth + 1, &mut no)?;
                }
                steps.push(ProgramStep::If { condition: header.to_vec(), yes: body, no });
            }
            "while" => {
                let (word, condition) = (first, header.to_vec());
                let (start, next, otherwise) = (Vec::new(), Vec::new(), Vec::new());
                steps.push(ProgramStep::Loop { word, start, condition, next, body, otherwise });
            }
            _ => {
                let parts: Vec<Vec<Token>> =
                    header.split(|token| token.kind == Semicolon).map(<[Token]>::to_vec).collect();
                if let Ok([start, condition, next]) = <[_; 3]>::try_from(parts) {
                    let (word, otherwise) = (first, Vec::new());
                    steps.push(ProgramStep::Loop { word, start, condition, next, body, otherwise });
                } else {
                    // JavaScript writes a loop over a list as `for (const c of [1, 2])`.
                    let of = header.iter().position(|token| self.word(*token) == "of");
                    let Some(of) = of.filter(|of| *of > 0) else {
                        return Err(self.unsupported(first));
                    };
                    let values = header[of + 1..].to_vec();
                    let is_word =
                        |token: &&Token| matches!(self.word(**token), "const" | "let" | "var");
                    let words = header.iter().take_while(is_word).count();
                    let (pattern, otherwise) = (header[words..of].to_vec(), Vec::new());
                    let Some(name) = pattern.first().copied() else {
                        return Err(self.unsupported(first));
                    };
                    steps.push(ProgramStep::Each { name, pattern, values, body, otherwise });
                }
            }
        }
        Ok(rest)
    }

    /// Number of spaces and tabs at the start of a statement's line.
    pub(crate) fn indent(self, tokens: &[Token]) -> usize {
        let start = tokens.first().map_or(0, |first| first.span.start);
        let line = self.text[..start].rfind('\n').map_or(0, |at| at + 1);
        self.text[line..].chars().take_while(|c| matches!(c, ' ' | '\t')).count()
    }

    /// Returns whether a statement begins an indented block after a colon, as `if c:` in Python.
    pub(crate) fn is_indented_control(self, tokens: &[Token]) -> bool {
        let word = tokens.first().map_or("", |first| self.word(*first));
        matches!(word, "if" | "elif" | "else" | "for" | "while")
            && !self.is_control(tokens)
            && outside(tokens, Colon).is_some()
            && outside(tokens, QuestionMark).is_none()
    }

    /// The statements of a block of indented lines.
    pub(crate) fn lines(self, lines: &[Vec<Token>], depth: usize) -> Fallible<Vec<ProgramStep>> {
        let mut steps = Vec::new();
        let mut index = 0;
        while index < lines.len() {
            index = self.line(lines, index, depth, &mut steps)?;
        }
        Ok(steps)
    }

    /// Appends the statement at `lines[index]` to `steps`. Returns the index of the next statement.
    fn line(
        self,
        lines: &[Vec<Token>],
        index: usize,
        depth: usize,
        steps: &mut Vec<ProgramStep>,
    ) -> Fallible<usize> {
        let tokens = &lines[index];
        let first = tokens[0];
        if depth > MAX_DEPTH {
            return Err(Error::new(first.span, ErrorKind::TooDeep { limit: MAX_DEPTH }));
        }
        if self.word(first) == "pass" && tokens.len() == 1 {
            return Ok(index + 1);
        }
        let colon = outside(tokens, Colon).filter(|_| self.is_indented_control(tokens));
        let Some(colon) = colon else {
            steps.push(ProgramStep::Plain(tokens.clone()));
            return Ok(index + 1);
        };
        let own = self.indent(tokens);
        let inner = lines[index + 1..].iter().take_while(|line| self.indent(line) > own).count();
        let mut next = index + 1 + inner;
        let body = if colon + 1 < tokens.len() {
            next = index + 1;
            vec![ProgramStep::Plain(tokens[colon + 1..].to_vec())]
        } else {
            self.lines(&lines[index + 1..next], depth + 1)?
        };
        let header = tokens[1..colon].to_vec();
        match self.word(first) {
            "if" | "elif" => {
                let mut no = Vec::new();
                if let Some(line) = lines.get(next)
                    && self.indent(line) == own
                    && matches!(self.word(line[0]), "elif" | "else")
                {
                    next = self.line(lines, next, depth + 1, &mut no)?;
                }
                steps.push(ProgramStep::If { condition: header, yes: body, no });
            }
            "else" => steps.extend(body),
            "while" => {
                let otherwise = self.otherwise(lines, &mut next, own, depth)?;
                let (word, condition) = (first, header);
                let (start, after) = (Vec::new(), Vec::new());
                steps.push(ProgramStep::Loop {
                    word,
                    start,
                    condition,
                    next: after,
                    body,
                    otherwise,
                });
            }
            _ => {
                let within = outside(&header, In).filter(|within| *within > 0);
                let Some(within) = within else { return Err(self.unsupported(first)) };
                let otherwise = self.otherwise(lines, &mut next, own, depth)?;
                let (pattern, values) = (header[..within].to_vec(), header[within + 1..].to_vec());
                let name = pattern[0];
                steps.push(ProgramStep::Each { name, pattern, values, body, otherwise });
            }
        }
        Ok(next)
    }

    /// The statements after the `else` of a loop, which may stand at `lines[next]`.
    fn otherwise(
        self,
        lines: &[Vec<Token>],
        next: &mut usize,
        own: usize,
        depth: usize,
    ) -> Fallible<Vec<ProgramStep>> {
        let mut steps = Vec::new();
        if let Some(line) = lines.get(*next)
            && self.indent(line) == own
            && self.word(line[0]) == "else"
        {
            *next = self.line(lines, *next, depth + 1, &mut steps)?;
        }
        Ok(steps)
    }
}
