//! Rewrites the tokens of one statement to the form that the grammar reads. Rewrites choices in any
//! notation, lists, ranges and labels.
//!
//! Tokens keep their order and their places in the text. A bracket that was not typed has an empty
//! span. Nothing here knows the meanings of names.

use crate::lex::environment::{matrix, scalar_products};
use crate::lex::lexer::OTHERWISE;
use crate::lex::scanner::{LexedStatement, scan};
use crate::lex::spelling::typed_setting;
use crate::lex::token::{Token, outside};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use std::collections::VecDeque;

/// A token, or a pair of brackets with its arranged contents.
enum TokenTree {
    Leaf(Token),
    Group(Token, Vec<Token>, Token),
}

impl TokenTree {
    fn is(&self, kind: TokenKind) -> bool {
        matches!(self, Self::Leaf(token) if token.kind == kind)
    }

    /// Changes the kind of a single token. Does nothing to a group.
    fn set(&mut self, kind: TokenKind) {
        if let Self::Leaf(token) = self {
            token.kind = kind;
        }
    }

    fn span(&self) -> Span {
        match self {
            Self::Leaf(token) => token.span,
            Self::Group(open, _, close) => open.span.to(close.span),
        }
    }
}

/// The statements of a text that is not a program.
///
/// # Errors
/// As [`scan`] and [`arrange`].
pub fn statements(text: &str, limits: &Limits) -> Fallible<Vec<LexedStatement>> {
    let mut pieces = Vec::new();
    for tokens in scan(text, limits)? {
        pieces.extend(arrange(text, tokens, limits)?);
    }
    Ok(pieces)
}

/// The statement that `tokens` form, ready for the grammar; `None` if the statement is empty.
///
/// # Errors
/// If sums or brackets are nested too deeply, or bars are ambiguous.
pub fn arrange(
    text: &str,
    tokens: Vec<Token>,
    limits: &Limits,
) -> Fallible<Option<LexedStatement>> {
    let is_setting = tokens[0].kind.is_setting();
    let mut tokens = tokens;
    if !is_setting {
        trim(text, &mut tokens);
        spreadsheet(text, &mut tokens);
    } else if tokens.len() > 2 && tokens[0].kind == SettingWord {
        without_pixels(text, &mut tokens);
    }
    let series = tokens.iter().filter(|token| matches!(token.kind, BigSum | BigProduct));
    if let Some(token) = series.clone().nth(limits.depth / 4) {
        return Err(Error::new(token.span, ErrorKind::TooDeep { limit: limits.depth / 4 }));
    }
    let mut arranger = Arranger { text, limits, depth: 0, is_setting };
    let mut tokens = tokens.into_iter().peekable();
    let mut arranged = arranger.level(&mut tokens, None)?;
    // Tokens of these kinds that remain have no meaning in any notation.
    for token in &mut arranged {
        if matches!(token.kind, Ampersand | QuestionMark | RowEnd | At | Over) {
            token.kind = Unknown;
        }
    }
    if arranged.is_empty() {
        return Ok(None);
    }
    LexedStatement::new(scalar_products(text, arranged)).map(Some)
}

/// Removes a label, punctuation at the end, and marks of bold text or of a quotation.
pub fn trim(text: &str, tokens: &mut Vec<Token>) {
    let typed = |token: &Token| &text[token.span.range()];
    while tokens.len() > 1
        && tokens.last().is_some_and(|last| {
            last.kind == Comma || last.kind == Colon || (last.kind == Unknown && typed(last) == ".")
        })
    {
        tokens.pop();
    }
    // Removes the marks of bold text or quotation marks, then the `>` of a quoted e-mail.
    if let [first, .., last] = tokens.as_slice()
        && [("**", "**"), ("‘", "’"), ("'", "'")].contains(&(typed(first), typed(last)))
    {
        tokens.pop();
        tokens.remove(0);
    }
    while tokens.len() > 1 && typed(&tokens[0]) == ">" {
        tokens.remove(0);
    }
    // In `\text{heart} = …`, a name that the text does not use again is a label.
    if let [label, equals, _, ..] = tokens.as_slice()
        && equals.kind == Equals
        && typed(label).starts_with(r"\text{")
        && text.matches(typed(label)).count() == 1
    {
        tokens.drain(..2);
    }
    if let [label, colon, _, ..] = tokens.as_slice()
        && label.kind == TokenKind::Name
        && colon.kind == Colon
        && !tokens.iter().any(|token| token.kind == QuestionMark)
    {
        tokens.drain(..2);
    }
}

/// Removes the notation of a spreadsheet cell: the `=` in front, the brackets of `PI()`, and
/// semicolons between arguments, which become commas.
fn spreadsheet(text: &str, tokens: &mut Vec<Token>) {
    if tokens.len() < 2 || tokens[0].kind != Equals {
        return;
    }
    tokens.remove(0);
    for token in tokens.iter_mut().filter(|token| token.kind == Semicolon) {
        token.kind = Comma;
    }
    let mut index = 0;
    while index + 2 < tokens.len() {
        let is_pi = text[tokens[index].span.range()].eq_ignore_ascii_case("pi");
        if is_pi && tokens[index + 1].kind == OpenParen && tokens[index + 2].kind == CloseParen {
            tokens.drain(index + 1..=index + 2);
        }
        index += 1;
    }
}

/// Removes the unit in `width 3px`.
fn without_pixels(text: &str, tokens: &mut Vec<Token>) {
    let typed = |token: &Token| &text[token.span.range()];
    let is_width = typed_setting(typed(&tokens[0])).is_some_and(|row| row.word == "width");
    tokens.pop_if(|last| is_width && typed(last) == "px");
}

struct Arranger<'a> {
    text: &'a str,
    limits: &'a Limits,
    depth: usize,
    is_setting: bool,
}

type Tokens = std::iter::Peekable<std::vec::IntoIter<Token>>;

impl Arranger<'_> {
    fn typed(&self, token: Token) -> &str {
        &self.text[token.span.range()]
    }

    /// The text of a name; empty for other nodes.
    fn word(&self, node: &TokenTree) -> &str {
        match node {
            TokenTree::Leaf(token) if token.kind == TokenKind::Name => self.typed(*token),
            _ => "",
        }
    }

    /// Arranges the tokens before the bracket that closes `open`. Leaves that bracket in `tokens`.
    fn level(&mut self, tokens: &mut Tokens, open: Option<Token>) -> Fallible<Vec<Token>> {
        let in_pieces = open.is_some_and(|open| open.kind == OpenChoice);
        let in_matrix = open.is_some_and(|open| open.kind == OpenMatrix);
        // The parts between commas, each with the comma that ends it.
        let mut segments: Vec<(Vec<TokenTree>, Option<Token>)> = Vec::new();
        let mut segment: Vec<TokenTree> = Vec::new();
        while let Some(mut token) = tokens.peek().copied() {
            if open.is_some_and(|open| open.kind.closer() == Some(token.kind)) {
                break;
            }
            tokens.next();
            if token.kind.closer().is_some() {
                let inner = self.level(tokens, Some(token))?;
                let Some(close) = tokens.next() else { break };
                // The lexer skips the word in `{\text{for}}`, so the braces are skipped too. `get`
                // is needed because an expanded macro may put `close` before `token` in the text.
                let between = self.text.get(token.span.end..close.span.start).unwrap_or("");
                if inner.is_empty() && token.kind == OpenBrace && between.contains(r"\text") {
                    continue;
                }
                let group = self.group((token, close), inner, open.is_some(), segment.last());
                segment.push(group);
                continue;
            }
            if token.kind == RowEnd && in_pieces {
                token.kind = Comma;
            }
            if token.kind != Comma && !(in_matrix && token.kind == RowEnd) {
                segment.push(TokenTree::Leaf(token));
                continue;
            }
            // In a choice, a comma before a condition or at the end of a row separates nothing.
            let is_empty = segment.is_empty() && in_pieces;
            let ends_value = in_pieces
                && tokens.peek().is_some_and(|next| matches!(next.kind, If | RowEnd | CloseChoice));
            if !is_empty && !ends_value {
                segments.push((std::mem::take(&mut segment), Some(token)));
            }
        }
        segments.push((segment, None));
        if let (true, Some((last, None))) = (segments.len() > 1, segments.last())
            && last.is_empty()
            && open.is_some_and(|open| {
                matches!(open.kind, OpenParen | OpenBracket | OpenChoice | OpenMatrix)
            })
        {
            // A trailing comma leaves an empty part, which is dropped.
            segments.pop();
        }
        if open.is_some_and(|open| open.kind == OpenParen) {
            // Options of numpy and SymPy that do not change the value are dropped.
            let is_option = |(segment, _): &(Vec<TokenTree>, Option<Token>)| {
                segment.len() > 2
                    && segment[1].is(Equals)
                    && matches!(self.word(&segment[0]), "axis" | "keepdims" | "evaluate")
            };
            segments.retain(|segment| !is_option(segment));
        }
        if let Some((_, comma)) = segments.last_mut() {
            *comma = None;
        }
        let mut arranged = Vec::new();
        for (segment, comma) in segments {
            self.segment(segment, open, &mut arranged)?;
            arranged.extend(comma);
        }
        Ok(arranged)
    }

    /// Groups a pair of brackets with its contents. Braces are a choice if they hold a colon, and
    /// may be a list if they hold a comma.
    fn group(
        &self,
        (mut open, mut close): (Token, Token),
        inner: Vec<Token>,
        nested: bool,
        before: Option<&TokenTree>,
    ) -> TokenTree {
        if open.kind == OpenMatrix {
            let (open, inner, close) = matrix(self.typed(open), (open, close), &inner);
            return TokenTree::Group(open, inner, close);
        }
        let colon = outside(&inner, Colon).is_some();
        let comma = outside(&inner, Comma).is_some();
        let relation =
            inner.iter().any(|token| token.kind.is_relation() || token.kind.is_logical());
        let typed = self.typed(open);
        let is_printed = typed == r"\{" || typed == r"\lbrace";
        // LaTeX may have a factor in braces, as in `z{r^3}`. A restriction has a relation.
        let is_factor = |last: &TokenTree| {
            let is_axis = matches!(last, TokenTree::Leaf(token) if token.kind.is_axis());
            is_axis && typed == "{" && !comma && !inner.is_empty()
        };
        let is_value = !colon && !relation;
        if is_printed && is_value && (!comma || is_called(before))
            || is_value && before.is_some_and(is_factor) && self.text.contains('\\')
        {
            (open.kind, close.kind) = (OpenParen, CloseParen);
        } else if open.kind == OpenBrace && colon {
            (open.kind, close.kind) = (OpenChoice, CloseChoice);
        } else if open.kind == OpenBrace
            && !self.is_setting
            && (comma && (nested || !relation) || nested && is_one_list(&inner))
        {
            (open.kind, close.kind) = (OpenList, CloseList);
        }
        TokenTree::Group(open, inner, close)
    }

    /// Arranges the nodes between two commas and appends them to `out`.
    fn segment(
        &mut self,
        mut nodes: Vec<TokenTree>,
        open: Option<Token>,
        out: &mut Vec<Token>,
    ) -> Fallible<()> {
        if open.is_some() {
            self.mark_keywords(&mut nodes);
        }
        for index in 1..nodes.len() {
            // numpy joins conditions by `&`, as in `(a) & (b)`.
            if let [TokenTree::Group(..), sign, TokenTree::Group(..), ..] = &mut nodes[index - 1..]
                && sign.is(Ampersand)
            {
                sign.set(And);
            }
        }
        if open.is_none() {
            self.rewrite_where(&mut nodes, out.is_empty());
        }
        if let Some(at) = nodes.iter().position(|node| node.is(Over)) {
            push_over(nodes, at, out);
            return Ok(());
        }
        self.rewrite_infix_mod(&mut nodes);
        self.rewrite_if_then(&mut nodes);
        let is_ternary = nodes.iter().any(|node| node.is(QuestionMark));
        let is_conditional = nodes.iter().skip(1).any(|node| self.word(node) == "if")
            && nodes.iter().any(|node| self.word(node) == "else");
        if is_ternary || is_conditional {
            // The left side of an equation is no part of a choice on the right side.
            let choice = nodes
                .iter()
                .position(|node| node.is(QuestionMark) || self.word(node) == "if")
                .unwrap_or(0);
            let is_equals = |node: &TokenTree| {
                matches!(node, TokenTree::Leaf(token) if token.kind == Equals
                    && (is_conditional || !self.typed(*token).starts_with("==")))
            };
            let start = nodes[..choice].iter().rposition(is_equals).map_or(0, |index| index + 1);
            let rest = nodes.split_off(start);
            flatten(nodes, out);
            return self.push_choice(rest, is_ternary, out);
        }
        flatten(nodes, out);
        Ok(())
    }

    /// Rewrites `x + y = z where z > 0` as `x + y = z {z > 0}`.
    fn rewrite_where(&self, nodes: &mut Vec<TokenTree>, is_first: bool) {
        let is_lead = |node: &TokenTree| matches!(self.word(node), "where" | "when" | "for");
        let Some(at) = nodes.iter().position(is_lead).filter(|at| *at > 0 && is_first) else {
            return;
        };
        let compares =
            |node: &TokenTree| matches!(node, TokenTree::Leaf(token) if token.kind.is_inequality());
        if !nodes[at + 1..].iter().any(compares) {
            return;
        }
        let mut inner = Vec::new();
        flatten(nodes.split_off(at + 1), &mut inner);
        let Some(word) = nodes.pop() else { return };
        let end = inner.last().map_or(word.span().end, |last| last.span.end);
        let open = Token::new(OpenBrace, Span::at(word.span().end));
        nodes.push(TokenTree::Group(open, inner, Token::new(CloseBrace, Span::at(end))));
    }

    /// Rewrites `a mod b` as `a % b`. `mod` must follow an operand or a bar, and must not precede
    /// brackets with several arguments, as in `mod(a, b)`.
    fn rewrite_infix_mod(&self, nodes: &mut [TokenTree]) {
        for index in 1..nodes.len() {
            let is_call = |next: &TokenTree| matches!(next, TokenTree::Group(_, inner, _) if inner.iter().any(|token| token.kind == Comma));
            let ends = match &nodes[index - 1] {
                TokenTree::Leaf(token) => {
                    token.kind.ends_operand() || matches!(token.kind, Bar | CloseBar)
                }
                TokenTree::Group(..) => true,
            };
            let is_infix = ends
                && self.word(&nodes[index]) == "mod"
                && nodes.get(index + 1).is_some_and(|next| !is_call(next));
            if is_infix {
                nodes[index].set(Remainder);
            }
        }
    }

    /// Rewrites `if c then a else b` as `c ? a : b`.
    fn rewrite_if_then(&self, nodes: &mut Vec<TokenTree>) {
        if !nodes.iter().any(|node| self.word(node) == "then") {
            return;
        }
        nodes.retain(|node| !matches!(self.word(node), "if" | "end" | "fi"));
        for node in nodes.iter_mut() {
            match self.word(node) {
                "then" => node.set(QuestionMark),
                "else" | "elif" | "elseif" => node.set(Colon),
                _ => {}
            }
        }
    }

    /// Sets the kinds of words that have a role inside brackets: in ranges, generators or choices.
    fn mark_keywords(&self, nodes: &mut [TokenTree]) {
        if nodes.iter().any(|node| node.is(Dots))
            && let Some(TokenTree::Leaf(equals)) = nodes.get_mut(1)
            && equals.kind == Equals
        {
            equals.kind = CountFrom;
        }
        let is_otherwise = |node: &TokenTree| OTHERWISE.contains(&self.word(node));
        if let [first, colon, ..] = nodes
            && colon.is(Colon)
            && is_otherwise(first)
        {
            first.set(Otherwise);
        }
        for index in 1..nodes.len() {
            let follows = nodes[index - 1].is(If);
            let within = nodes[index - 1].is(In);
            let kind = match self.word(&nodes[index]) {
                word if follows && OTHERWISE.contains(&word) => Otherwise,
                // `flatten` drops this word. The `If` before it already separates the condition.
                "for" | "if" if follows => Blank,
                "for" => For,
                "range" if within => RangeCall,
                _ => continue,
            };
            nodes[index].set(kind);
        }
    }

    /// Appends `c ? a : b` or `a if c else b` to `out`, as a choice.
    fn push_choice(
        &mut self,
        nodes: Vec<TokenTree>,
        is_ternary: bool,
        out: &mut Vec<Token>,
    ) -> Fallible<()> {
        let span = nodes.first().map_or(Span::default(), TokenTree::span);
        self.depth += 1;
        if self.depth > self.limits.depth / 4 {
            let limit = self.limits.depth / 4;
            return Err(Error::new(span, ErrorKind::TooDeep { limit }));
        }
        out.push(Token::new(OpenChoice, Span::at(span.start)));
        let end = nodes.last().map_or(span.end, |node| node.span().end);
        let mut rest = VecDeque::from(nodes);
        // Each iteration takes one piece: the nodes before `?` or `if`, then those up to `:` or
        // `else`.
        while let Some((first, second)) = self.choice_signs(rest.iter(), is_ternary) {
            let joint = rest[second].span();
            let sign = rest[first].span();
            let mut parts = rest.drain(..=second);
            let before: Vec<TokenTree> = parts.by_ref().take(first).collect();
            let between: Vec<TokenTree> = parts.by_ref().skip(1).take(second - first - 1).collect();
            drop(parts);
            self.part(before, is_ternary, out)?;
            out.push(Token::new(if is_ternary { Colon } else { If }, sign));
            self.part(between, is_ternary, out)?;
            out.push(Token::new(Comma, joint));
        }
        flatten(rest.into(), out);
        out.push(Token::new(CloseChoice, Span::at(end)));
        self.depth -= 1;
        Ok(())
    }

    /// Appends a part of a choice to `out`. The part may itself be a choice.
    fn part(
        &mut self,
        nodes: Vec<TokenTree>,
        is_ternary: bool,
        out: &mut Vec<Token>,
    ) -> Fallible<()> {
        if self.choice_signs(nodes.iter(), is_ternary).is_some() {
            return self.push_choice(nodes, is_ternary, out);
        }
        flatten(nodes, out);
        Ok(())
    }

    /// Indices of the first `?` or `if`, and of its `:` or `else`.
    fn choice_signs<'n>(
        &self,
        nodes: impl Iterator<Item = &'n TokenTree> + Clone,
        is_ternary: bool,
    ) -> Option<(usize, usize)> {
        let opens = |node: &TokenTree| {
            if is_ternary { node.is(QuestionMark) } else { self.word(node) == "if" }
        };
        let closes = |node: &TokenTree| {
            if is_ternary { node.is(Colon) } else { self.word(node) == "else" }
        };
        let first = nodes.clone().position(opens)?;
        let mut depth = 0_usize;
        for (index, node) in nodes.enumerate().skip(first) {
            if opens(node) {
                depth += 1;
            } else if closes(node) {
                depth -= 1;
                if depth == 0 {
                    return Some((first, index));
                }
            }
        }
        None
    }
}

/// Returns whether brackets directly after `before` hold arguments of `before`.
fn is_called(before: Option<&TokenTree>) -> bool {
    matches!(before, Some(TokenTree::Leaf(token)) if token.kind == TokenKind::Name)
}

/// Appends `a \over b` to `out` as a fraction.
fn push_over(mut nodes: Vec<TokenTree>, at: usize, out: &mut Vec<Token>) {
    let below = nodes.split_off(at + 1);
    let sign = nodes.pop().map_or(Span::default(), |node| node.span());
    for (index, part) in [nodes, below].into_iter().enumerate() {
        let start = part.first().map_or(sign, TokenTree::span).start;
        let end = part.last().map_or(sign, TokenTree::span).end;
        if index == 1 {
            out.push(Token::new(Slash, sign));
        }
        out.push(Token::new(OpenParen, Span::at(start)));
        flatten(part, out);
        out.push(Token::new(CloseParen, Span::at(end)));
    }
}

/// Returns whether the tokens `inner` are exactly one list.
fn is_one_list(inner: &[Token]) -> bool {
    let closes = inner.iter().position(|token| token.kind == CloseList);
    inner.first().is_some_and(|token| token.kind == OpenList) && closes == Some(inner.len() - 1)
}

/// Appends all tokens of `nodes` except `Blank` tokens to `out`, in order.
fn flatten(nodes: Vec<TokenTree>, out: &mut Vec<Token>) {
    for node in nodes {
        match node {
            TokenTree::Leaf(token) if token.kind == Blank => {}
            TokenTree::Leaf(token) => out.push(token),
            TokenTree::Group(open, inner, close) => {
                out.push(open);
                out.extend(inner);
                out.push(close);
            }
        }
    }
}
