//! Runs the side effects inside of expressions, in the order of their evaluation: assignments,
//! `++` and `--`, commas, and calls of functions that change variables.
//!
//! Each function here returns the tokens of an expression's value. All its effects have then
//! happened in the frame, and a saved value stands for each part with an effect. A part that only
//! sometimes runs, such as the right side of `&&`, becomes a side of a branch.

use crate::control_flow::more_than;
use crate::known_numbers::number_expr;
use crate::language::Language;
use crate::program_reader::{Frame, ProgramReader};
use zeroset_parser::lex::token::{Token, in_brackets, is_outside, outside, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{
    self, And, Colon, Comma, Component, Equals, Minus, Or, Plus, QuestionMark,
};
use zeroset_parser::tree::ast::ExprKind;
use zeroset_parser::tree::raw_statement::ValueConversion;
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// The tokens of a value. All side effects of computing the value have happened.
pub(crate) struct PureValue {
    pub tokens: Vec<Token>,
    /// True if the value is an integer. A typed language truncates quotients of integers.
    pub is_whole: bool,
}

/// A variable, or components of a variable, on the left of an assignment.
#[derive(Clone)]
pub(crate) struct Target {
    pub name: Token,
    pub letters: Option<Token>,
}

impl Target {
    /// The target at the start of `tokens`, and the number of its tokens.
    pub(crate) fn at_start(tokens: &[Token]) -> Option<(Self, usize)> {
        let name = *tokens.first().filter(|name| name.kind.is_name())?;
        let letters = tokens.get(1).copied().filter(|next| next.kind == Component);
        Some((Self { name, letters }, 1 + usize::from(letters.is_some())))
    }

    /// Reads `tokens` as a target. Fails if they are not a single target.
    pub(crate) fn of(tokens: &[Token]) -> Fallible<Self> {
        let found = Self::at_start(tokens).filter(|(_, length)| *length == tokens.len());
        found.map(|(target, _)| target).ok_or_else(|| {
            let span = span_of(tokens).unwrap_or_default();
            Error::new(span, ErrorKind::Target)
        })
    }

    pub(crate) fn tokens(&self) -> Vec<Token> {
        std::iter::once(self.name).chain(self.letters).collect()
    }
}

/// An assignment: its target, its operator unless it is a plain `=`, and its right side.
struct Assignment<'t> {
    target: &'t [Token],
    operator: Option<Token>,
    value: &'t [Token],
}

/// Returns whether two tokens at `at` are `++` or `--`.
pub(crate) fn is_doubled(tokens: &[Token], at: usize) -> bool {
    matches!(tokens.get(at..at + 2), Some([a, b]) if a.kind == b.kind
        && matches!(a.kind, Plus | Minus)
        && a.span.end == b.span.start)
}

impl ProgramReader<'_> {
    /// Returns whether expressions in `frame` may have effects, or quotients that are truncated.
    pub(crate) fn may_have_effects(&self, frame: &Frame) -> bool {
        self.language != Language::Plain && (frame.is_inner() || self.program.in_steps)
    }

    /// Runs the effects in the expression `tokens`. Returns the tokens of its value.
    pub(crate) fn run_effects(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<Vec<Token>> {
        if !self.may_have_effects(frame) || tokens.is_empty() {
            return Ok(tokens);
        }
        let before = std::mem::take(&mut self.reads);
        let value = self.sequence(&tokens, frame)?;
        self.reads = before;
        Ok(value.tokens)
    }

    /// Runs an expression that is a statement, such as `a = b++, c -= 1`. Returns false if it has
    /// no effect.
    pub(crate) fn run_expression(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        if !self.has_effect(tokens) {
            return Ok(false);
        }
        self.reads.clear();
        for part in split(tokens, Comma) {
            self.run_for_effects(&part, frame)?;
            self.reads.clear();
        }
        Ok(true)
    }

    /// Returns whether evaluating `tokens` may change a variable.
    pub(crate) fn has_effect(&self, tokens: &[Token]) -> bool {
        let calls = |token: &Token| self.procedures.contains_key(self.words.word(*token));
        let has_call = !self.procedures.is_empty() && tokens.iter().any(calls);
        has_call
            || self.language.has_assignments()
                && (0..tokens.len())
                    .any(|at| is_doubled(tokens, at) || self.words.assigns(tokens, at))
    }

    /// Runs an expression and drops its value.
    fn run_for_effects(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<()> {
        if let Some((procedure, arguments)) = self.called(tokens) {
            return self.call_inline(tokens[0], &procedure, &arguments, frame).map(|_| ());
        }
        if let Some(found) = self.assigned(tokens) {
            return self.assign(&found, frame).map(|_| ());
        }
        if !self.has_effect(tokens) {
            let span = span_of(tokens).unwrap_or_default();
            return Err(Error::new(span, ErrorKind::NoEffect));
        }
        self.assignment(tokens, frame).map(|_| ())
    }

    /// Reads expressions between commas. All are evaluated, and the last one gives the value.
    pub(crate) fn sequence(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<PureValue> {
        let joins = self.language.has_assignments();
        let Some(comma) = tokens.iter().rposition(is_outside_backwards(Comma)).filter(|_| joins)
        else {
            return self.assignment(tokens, frame);
        };
        let mark = self.reads.len();
        for part in split(&tokens[..comma], Comma) {
            if self.has_effect(&part) {
                self.run_for_effects(&part, frame)?;
            }
            self.reads.truncate(mark);
        }
        self.assignment(&tokens[comma + 1..], frame)
    }

    /// The first assignment outside brackets, if it comes before any choice.
    fn assigned<'t>(&self, tokens: &'t [Token]) -> Option<Assignment<'t>> {
        if !self.language.has_assignments() {
            return None;
        }
        let mut is_outer = is_outside(Equals);
        let at = (0..tokens.len())
            .find(|at| is_outer(&tokens[*at]) && self.words.assigns(tokens, *at))?;
        if outside(tokens, QuestionMark).is_some_and(|mark| mark < at) {
            return None;
        }
        let touches = at > 0 && tokens[at - 1].span.end == tokens[at].span.start;
        let operator = tokens[..at].last().copied().filter(|operator| {
            touches
                && !operator.kind.is_name()
                && !operator.kind.is_closer()
                && operator.kind != Component
        });
        let target = &tokens[..at - usize::from(operator.is_some())];
        Some(Assignment { target, operator, value: &tokens[at + 1..] })
    }

    /// Reads an assignment, or any expression without a comma.
    pub(crate) fn assignment(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<PureValue> {
        self.deeper(tokens, |reader| {
            let Some(found) = reader.assigned(tokens) else {
                return reader.ternary(tokens, frame);
            };
            let target = reader.assign(&found, frame)?;
            Ok(reader.value_of(&target, frame))
        })
    }

    /// Runs `read` one level deeper. Fails beyond the limit of the nesting depth.
    pub(crate) fn deeper<T>(
        &mut self,
        tokens: &[Token],
        read: impl FnOnce(&mut Self) -> Fallible<T>,
    ) -> Fallible<T> {
        let limit = self.limits.depth;
        if self.expression_depth >= limit {
            let span = span_of(tokens).unwrap_or_default();
            return Err(Error::new(span, ErrorKind::TooDeep { limit }));
        }
        self.expression_depth += 1;
        let result = read(self);
        self.expression_depth -= 1;
        result
    }

    /// The value of a variable at this time.
    fn value_of(&mut self, target: &Target, frame: &mut Frame) -> PureValue {
        let name = self.words.name(target.name).text;
        let is_whole = frame.integers.contains(&name);
        let kind = match self.known_value(&[target.name], frame) {
            Some(number) => number_expr(number, target.name.span),
            None => frame.meaning(&name),
        };
        let mut tokens = vec![self.saved(kind, target.name.span, is_whole, frame)];
        tokens.extend(target.letters);
        PureValue { tokens, is_whole }
    }

    /// Carries out an assignment, and returns its target.
    fn assign(&mut self, found: &Assignment<'_>, frame: &mut Frame) -> Fallible<Target> {
        let target = Target::of(found.target)?;
        let mark = self.reads.len();
        if found.operator.is_some() {
            self.reads.push(self.words.word(target.name).to_owned());
        }
        if found.value.is_empty() {
            return Err(Error::new(target.name.span, ErrorKind::Unfinished));
        }
        let value = self.assignment(found.value, frame)?;
        self.reads.truncate(mark);
        self.write(&target, found.operator, value, frame)?;
        Ok(target)
    }

    /// Assigns `value` to `target`, or changes `target` by it if there is an operator.
    fn write(
        &mut self,
        target: &Target,
        operator: Option<Token>,
        value: PureValue,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let name = self.words.name(target.name);
        self.check_order(&name.text, target.name.span)?;
        let is_whole = frame.integers.contains(&name.text);
        let mut value = value;
        if let Some(operator) = operator {
            let before = PureValue { tokens: target.tokens(), is_whole };
            value = self.joined(before, operator, &value, frame)?;
        }
        self.store(target, value, frame)
    }

    /// Assigns `value` to `target`.
    pub(crate) fn store(
        &mut self,
        target: &Target,
        value: PureValue,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let name = self.words.name(target.name);
        let mut value = value;
        let is_whole = frame.integers.contains(&name.text);
        if is_whole && !value.is_whole && self.language == Language::Typed {
            value.tokens = vec![self.truncated(&value.tokens, frame)?];
        }
        let value = value.tokens;
        if let Some(letters) = target.letters {
            let size = frame.size(&name.text).unwrap_or(3);
            let before = frame.meaning(&name.text);
            let letters = self.words.text[letters.span.start + 1..letters.span.end].to_owned();
            let write = Some(ValueConversion::Write { letters, before, size });
            let within = frame.aliases.clone();
            return self.assign_within(name, size, value, write, &within, frame);
        }
        let size = frame.size(&name.text).unwrap_or(1);
        if self.is_condition(&value, frame) {
            let kind = self.flag(value, frame)?;
            frame.aliases.push(name.text.clone(), kind);
            frame.set.push((name.text, size));
            return Ok(());
        }
        if self.record_number(&name.text, &value, frame) {
            return Ok(());
        }
        self.set(name, size, value, frame)
    }

    /// Fails if the variable `name` was read before, in an expression that now changes it.
    pub(crate) fn check_order(&self, name: &str, span: Span) -> Fallible<()> {
        if self.reads.iter().any(|read| read == name) {
            return Err(Error::new(span, ErrorKind::Order { name: name.to_owned() }));
        }
        Ok(())
    }

    /// Changes a variable by 1. Returns the variable's new value if the sign stands before the
    /// variable, else its old value.
    pub(crate) fn step_by_one(
        &mut self,
        target: &Target,
        sign: Token,
        is_before: bool,
        frame: &mut Frame,
    ) -> Fallible<PureValue> {
        let old = self.value_of(target, frame);
        let one = ExprKind::Number("1".to_owned());
        let one = self.saved(one, target.name.span, true, frame);
        let is_whole = old.is_whole;
        let mut tokens = old.tokens.clone();
        tokens.extend([sign, one]);
        self.check_order(self.words.word(target.name), target.name.span)?;
        self.store(target, PureValue { tokens, is_whole }, frame)?;
        Ok(if is_before { self.value_of(target, frame) } else { old })
    }

    /// Reads `c ? a : b`. If `a` or `b` has effects, both are sides of a branch.
    fn ternary(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<PureValue> {
        let Some(mark) =
            outside(tokens, QuestionMark).filter(|_| self.language != Language::Python)
        else {
            return self.alternatives(tokens, frame);
        };
        let mut depth = 0_usize;
        let mut is_outer = is_outside(Colon);
        let mut is_mark = is_outside(QuestionMark);
        let colon = tokens[mark..].iter().position(|token| {
            let (is_colon, opens) = (is_outer(token), is_mark(token));
            depth += usize::from(opens);
            depth -= usize::from(is_colon && depth > 0);
            is_colon && depth == 0
        });
        let Some(colon) = colon.map(|colon| mark + colon) else {
            return Err(Error::new(tokens[mark].span, ErrorKind::Unfinished));
        };
        let (yes, no) = (&tokens[mark + 1..colon], &tokens[colon + 1..]);
        let (condition, at) = (&tokens[..mark], self.reads.len());
        let condition = self.alternatives(condition, frame)?.tokens;
        let has_effect = self.has_effect(yes) || self.has_effect(no);
        if has_effect {
            // The condition is evaluated before the sides change anything.
            self.reads.truncate(at);
        }
        if let Some(holds) = self.known_value(&condition, frame) {
            return if holds == 0.0 {
                self.assignment(no, frame)
            } else {
                self.sequence(yes, frame)
            };
        }
        if has_effect {
            return self.branches(
                condition,
                &mut |reader, frame| reader.sequence(yes, frame).map(Some),
                &mut |reader, frame| reader.assignment(no, frame).map(Some),
                frame,
            );
        }
        let (yes, no) = (self.assignment(yes, frame)?, self.assignment(no, frame)?);
        let is_whole = yes.is_whole && no.is_whole;
        let mut all = in_brackets(&condition);
        all.push(tokens[mark]);
        all.extend(in_brackets(&yes.tokens));
        all.push(tokens[colon]);
        all.extend(in_brackets(&no.tokens));
        Ok(PureValue { tokens: all, is_whole })
    }

    /// Reads `a || b`. If `b` has effects, they happen where `a` does not hold.
    fn alternatives(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<PureValue> {
        self.short_circuit(tokens, Or, frame)
    }

    /// Reads operands that are joined by `sign`, a logical "or" or "and". Effects of the right
    /// operand happen only where the left operand does not determine the result.
    fn short_circuit(
        &mut self,
        tokens: &[Token],
        sign: TokenKind,
        frame: &mut Frame,
    ) -> Fallible<PureValue> {
        let last = tokens.iter().rposition(is_outside_backwards(sign));
        let Some(at) = last.filter(|at| self.has_effect(&tokens[*at + 1..])) else {
            let Some(at) = last.filter(|at| self.has_effect(&tokens[..*at])) else {
                return match sign {
                    Or => self.short_circuit(tokens, And, frame),
                    _ => self.terms(tokens, frame),
                };
            };
            // Only the left side has effects, and it always runs.
            let left = &tokens[..at];
            let left = self.deeper(left, |reader| reader.short_circuit(left, sign, frame))?;
            let mut all = left.tokens;
            all.push(tokens[at]);
            all.extend(self.operand_of(sign, &tokens[at + 1..], frame)?.tokens);
            return Ok(PureValue { tokens: all, is_whole: false });
        };
        let mark = self.reads.len();
        let left = &tokens[..at];
        let left = self.deeper(left, |reader| reader.short_circuit(left, sign, frame))?.tokens;
        self.reads.truncate(mark);
        let right = &tokens[at + 1..];
        let mut run =
            |reader: &mut Self, frame: &mut Frame| reader.operand_of(sign, right, frame).map(Some);
        let mut skip = |_: &mut Self, _: &mut Frame| Ok(None);
        if sign == Or {
            self.branches(left, &mut skip, &mut run, frame)
        } else {
            self.branches(left, &mut run, &mut skip, frame)
        }
    }

    fn operand_of(
        &mut self,
        sign: TokenKind,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<PureValue> {
        if sign == Or { self.short_circuit(tokens, And, frame) } else { self.terms(tokens, frame) }
    }

    /// Runs two sides of a branch in an expression. A side returns its value, or `None` if the
    /// condition's value is its value. Returns the value of the side that the condition selects.
    fn branches(
        &mut self,
        condition: Vec<Token>,
        yes: Side<'_, Self>,
        no: Side<'_, Self>,
        frame: &mut Frame,
    ) -> Fallible<PureValue> {
        let span = span_of(&condition).unwrap_or_default();
        if let Some(holds) = self.known_value(&condition, frame) {
            let side = if holds == 0.0 { no(self, frame)? } else { yes(self, frame)? };
            return Ok(side.unwrap_or(PureValue { tokens: condition, is_whole: false }));
        }
        let holds = self.indicator(condition, frame)?;
        let (number, token) = self.new_saved(span);
        let key = number.clone();
        let (mut is_flag, mut is_whole) = (false, true);
        let mut side = |reader: &mut Self,
                        run: Side<'_, Self>,
                        holds: f64,
                        frame: &Frame|
         -> Fallible<Frame> {
            let mut inner = frame.inner();
            let kind = match run(reader, &mut inner)? {
                None => {
                    is_flag = true;
                    number_expr(holds, span)
                }
                Some(value) if reader.is_condition(&value.tokens, &inner) => {
                    is_flag = true;
                    reader.indicator(value.tokens, &mut inner)?
                }
                Some(value) => {
                    is_whole &= value.is_whole;
                    reader.kind_of(value.tokens, &mut inner)?
                }
            };
            inner.aliases.push(key.clone(), kind);
            Ok(inner)
        };
        let first = side(self, yes, 1.0, frame)?;
        let second = side(self, no, 0.0, frame)?;
        self.merge(frame, &first, &second, &more_than(holds, 0.0));
        if is_flag && let Some(kind) = frame.aliases.find(&number).cloned() {
            frame.aliases.push(number, more_than(kind, 0.0).kind);
        }
        let is_whole = is_whole && !is_flag;
        if is_whole {
            self.whole_values.insert(token.number);
        }
        Ok(PureValue { tokens: vec![token], is_whole })
    }
}

/// Runs a side of a branch. Returns its value, or `None` if that is the condition's.
type Side<'b, R> = &'b mut dyn FnMut(&mut R, &mut Frame) -> Fallible<Option<PureValue>>;

/// Returns a test for a `sign` outside brackets. The test must be called with each token, from the
/// last to the first.
fn is_outside_backwards(sign: TokenKind) -> impl FnMut(&Token) -> bool {
    let mut depth = 0_usize;
    move |token| {
        if token.kind.is_closer() {
            depth += 1;
        } else if token.kind.closer().is_some() {
            depth = depth.saturating_sub(1);
        }
        depth == 0 && token.kind == sign
    }
}
