//! Splits blocks of programs into trees of statements. Formulas stay unparsed.

use crate::effects::is_doubled;
use crate::lists::with_signs;
use crate::program_words::Words;
use zeroset_parser::lex::token_kind::TokenKind::*;

use zeroset_parser::lex::token::{Token, closing, outside, split};
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

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
    /// `for a, b in pairs:`.
    Each {
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

    /// A loop of `while`, whose first token is `word`.
    fn of_while(word: Token, condition: &[Token], body: Vec<Self>, otherwise: Vec<Self>) -> Self {
        let (start, condition, next) = (Vec::new(), condition.to_vec(), Vec::new());
        Self::Loop { word, start, condition, next, body, otherwise }
    }

    /// A token near the start of the step, for error messages.
    pub(crate) fn first(&self) -> Option<Token> {
        match self {
            Self::Plain(tokens) => tokens.first().copied(),
            Self::Block(inner) => inner.first().and_then(Self::first),
            Self::If { condition, .. } => condition.first().copied(),
            Self::Loop { word, .. } => Some(*word),
            Self::Each { pattern, .. } => pattern.first().copied(),
        }
    }
}

/// The range `a:b` of Julia, or `a, b` or `a, b, step` of Lua, in brackets with the step between
/// its ends. Other values stay as they are.
fn range_of(values: &[Token]) -> Vec<Token> {
    let mut parts = split(values, Colon);
    if parts.len() < 2 {
        parts = split(values, Comma);
        if parts.len() == 3 {
            parts.swap(1, 2);
        }
    }
    let place = values.first().map_or(0, |first| first.span.start);
    let mut all = vec![Token::new(OpenBracket, Span::at(place))];
    all.extend(with_signs(&parts, Colon));
    all.push(Token::new(CloseBracket, Span::at(place)));
    if parts.len() < 2 { values.to_vec() } else { all }
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
                steps.push(ProgramStep::of_while(first, header, body, Vec::new()));
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
                    if pattern.is_empty() {
                        return Err(self.unsupported(first));
                    }
                    steps.push(ProgramStep::Each { pattern, values, body, otherwise });
                }
            }
        }
        Ok(rest)
    }

    /// A line of Lua or Julia, divided where a block begins or ends.
    fn pieces(self, line: &[Token]) -> Vec<Vec<Token>> {
        let mut all: Vec<Vec<Token>> = Vec::new();
        let mut is_divided = true;
        let mut depth = 0_usize;
        for token in line {
            depth += usize::from(token.kind.closer().is_some());
            depth = depth.saturating_sub(usize::from(token.kind.is_closer()));
            let word = if depth == 0 { self.word(*token) } else { "" };
            match all.last_mut() {
                Some(last) if !is_divided && !matches!(word, "end" | "else" | "elseif") => {
                    last.push(*token);
                }
                _ => all.push(vec![*token]),
            }
            is_divided = matches!(word, "do" | "then" | "else" | "end");
        }
        all
    }

    /// The lines of a body of Lua or Julia up to its `end`, which is dropped.
    pub(crate) fn lines_to_end(
        self,
        following: &mut impl Iterator<Item = Vec<Token>>,
    ) -> Fallible<Vec<Vec<Token>>> {
        let mut lines = Vec::new();
        let mut depth = 1_usize;
        for line in following {
            let pieces = self.pieces(&line);
            let count = pieces.len();
            for (index, piece) in pieces.into_iter().enumerate() {
                match self.word(piece[0]) {
                    "for" | "while" | "if" | "function" => depth += 1,
                    "repeat" => return Err(self.unsupported(piece[0])),
                    "end" if depth == 1 && index + 1 < count => {
                        return Err(self.unsupported(piece[0]));
                    }
                    "end" => depth -= 1,
                    _ => {}
                }
                if depth == 0 {
                    return Ok(lines);
                }
                lines.push(piece);
            }
        }
        Ok(lines)
    }

    /// The statements of a block of Lua or Julia, and the line that ends it.
    pub(crate) fn block_to_end(
        self,
        lines: &mut std::vec::IntoIter<Vec<Token>>,
        depth: usize,
    ) -> Fallible<(Vec<ProgramStep>, Option<Vec<Token>>)> {
        let mut steps = Vec::new();
        while let Some(line) = lines.next() {
            let first = line[0];
            if depth > MAX_DEPTH {
                return Err(Error::new(first.span, ErrorKind::TooDeep { limit: MAX_DEPTH }));
            }
            match self.word(first) {
                "end" | "else" | "elseif" => return Ok((steps, Some(line))),
                "for" => {
                    let header = self.header(&line);
                    let at = outside(header, In).or_else(|| outside(header, Equals));
                    let at = at.filter(|at| *at > 0).ok_or_else(|| self.unsupported(first))?;
                    let (pattern, values) = (header[..at].to_vec(), range_of(&header[at + 1..]));
                    let (body, otherwise) = (self.block_to_end(lines, depth + 1)?.0, Vec::new());
                    steps.push(ProgramStep::Each { pattern, values, body, otherwise });
                }
                "while" => {
                    let body = self.block_to_end(lines, depth + 1)?.0;
                    steps.push(ProgramStep::of_while(first, self.header(&line), body, Vec::new()));
                }
                "if" => steps.push(self.branch_to_end(&line, lines, depth + 1)?),
                _ => steps.push(ProgramStep::Plain(line)),
            }
        }
        Ok((steps, None))
    }

    /// The tokens of `for … do`, `if … then` or `while … do` between the words.
    fn header(self, line: &[Token]) -> &[Token] {
        let is_end = line.last().is_some_and(|last| matches!(self.word(*last), "do" | "then"));
        &line[1..line.len() - usize::from(is_end)]
    }

    /// An `if` or `elseif` of Lua or Julia.
    fn branch_to_end(
        self,
        line: &[Token],
        lines: &mut std::vec::IntoIter<Vec<Token>>,
        depth: usize,
    ) -> Fallible<ProgramStep> {
        let (yes, ended) = self.block_to_end(lines, depth)?;
        let no = match ended {
            Some(line) if self.word(line[0]) == "else" => self.block_to_end(lines, depth)?.0,
            Some(line) if self.word(line[0]) == "elseif" => {
                vec![self.branch_to_end(&line, lines, depth + 1)?]
            }
            _ => Vec::new(),
        };
        Ok(ProgramStep::If { condition: self.header(line).to_vec(), yes, no })
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
                steps.push(ProgramStep::of_while(first, &header, body, otherwise));
            }
            _ => {
                let within = outside(&header, In).filter(|within| *within > 0);
                let Some(within) = within else { return Err(self.unsupported(first)) };
                let otherwise = self.otherwise(lines, &mut next, own, depth)?;
                let (pattern, values) = (header[..within].to_vec(), header[within + 1..].to_vec());
                steps.push(ProgramStep::Each { pattern, values, body, otherwise });
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
