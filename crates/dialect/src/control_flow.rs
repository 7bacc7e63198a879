//! Unrolls the loops of programs. If the condition of a branch is unknown, both sides of the branch
//! run. Each variable that the sides assign becomes a choice between two values.

use crate::arrays::Array;
use crate::blocks::ProgramStep;
use crate::known_numbers::{count, number_expr, number_of};
use crate::language::Language;
use crate::lists::Element;
use crate::program_reader::{Frame, ProgramReader, Statements};
use zeroset_parser::lex::token::{Token, in_brackets, outside, span_of};
use zeroset_parser::lex::token_kind::TokenKind::{self, Comma, Equals, OpenBracket};
use zeroset_parser::tree::ast::{Expr, ExprKind, Name, Relation};
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Largest number of steps: the statements and iterations in loops, branches and inlined calls.
pub(crate) const MAX_STEPS: usize = 1000;

/// Name of the variable that records an early exit from a loop or function. The name is a keyword,
/// so no variable of a program has it.
pub(crate) const EXIT_LEVEL: &str = "break";
/// Name of the variable that holds a function's returned value.
pub(crate) const RESULT: &str = "return";

/// Levels of an early exit: an exit from the iteration, from the loop, or from the function.
const ROUND: f64 = 1.0;
const LOOP: f64 = 2.0;
const FUNCTION: f64 = 3.0;

impl ProgramReader<'_> {
    /// The number that `tokens` evaluate to; `None` if it is not known while the program is read.
    pub(crate) fn known_value(&self, tokens: &[Token], frame: &Frame) -> Option<f64> {
        count(self.words, tokens, &frame.aliases, &self.constants)
    }

    /// Runs the statements of a block. Its declarations end with it.
    pub(crate) fn run(&mut self, steps: &[ProgramStep], frame: &mut Frame) -> Fallible<()> {
        let mark = frame.declared.len();
        self.run_open(steps, frame, true)?;
        frame.leave_scope(mark);
        Ok(())
    }

    /// Runs the statements of a function's body, or of a block if `is_block`.
    pub(crate) fn run_open(
        &mut self,
        steps: &[ProgramStep],
        frame: &mut Frame,
        is_block: bool,
    ) -> Fallible<()> {
        for (index, step) in steps.iter().enumerate() {
            if frame.nested > 0 {
                self.count_step(step.first().map_or(Span::default(), |first| first.span))?;
            }
            match step {
                ProgramStep::Plain(tokens) => self.plain_step(tokens, frame)?,
                ProgramStep::If { condition, yes, no } => self.branch(condition, yes, no, frame)?,
                ProgramStep::Block(inner) => self.run(inner, frame)?,
                ProgramStep::Loop { word, start, condition, next, body, otherwise } => {
                    let counted = start.windows(2).filter(|pair| pair[1].kind == Equals);
                    let names = counted.map(|pair| self.words.word(pair[0]).to_owned());
                    frame.counters.extend(names);
                    let mark = frame.declared.len();
                    let mut before = start.as_slice();
                    let mut begin = |reader: &mut Self, frame: &mut Frame| {
                        reader.plain_step(std::mem::replace(&mut before, next), frame)?;
                        let holds = reader.holds(condition, frame)?;
                        if holds {
                            reader.count_step(word.span)?;
                        }
                        Ok(holds)
                    };
                    self.repeat(&mut begin, body, otherwise, frame)?;
                    frame.leave_scope(mark);
                }
                ProgramStep::Each { pattern, values, body, otherwise } => {
                    let mut rounds = self.rounds(pattern, values, frame)?.into_iter();
                    let span = span_of(pattern).unwrap_or_default();
                    let mut begin = |reader: &mut Self, frame: &mut Frame| {
                        let Some(values) = rounds.next() else { return Ok(false) };
                        reader.count_step(span)?;
                        for (name, value) in values {
                            reader.begin_round(name, &value, frame)?;
                        }
                        Ok(true)
                    };
                    self.repeat(&mut begin, body, otherwise, frame)?;
                }
            }
            let Some(left) = frame.exit_level().cloned() else { continue };
            let rest = &steps[index + 1..];
            if rest.is_empty() {
                return Ok(());
            }
            return self.unless_exited(left, frame, |reader, going| {
                if is_block { reader.run(rest, going) } else { reader.run_open(rest, going, false) }
            });
        }
        Ok(())
    }

    /// Gives a loop's variable its value in the next iteration.
    fn begin_round(&mut self, name: Token, value: &Element, frame: &mut Frame) -> Fallible<()> {
        let span = name.span;
        let text = self.words.text[span.range()].to_owned();
        // `p[1]` selects a part of an element.
        if value.is_list {
            let parts = value.parts.iter().map(|(_, part)| Element::single(part.clone()));
            self.arrays.insert(text.clone(), Array::of(parts.collect()));
        }
        let value = value.value();
        let Some(number) = self.known_value(&value, frame) else {
            return self.set(Name { text, span }, 1, value, frame);
        };
        let is_whole = |token: &Token| self.whole_values.contains(&token.number);
        if matches!(value.as_slice(), [only] if is_whole(only)) {
            frame.integers.insert(text.clone());
        }
        frame.aliases.push(text, number_expr(number, span));
        Ok(())
    }

    /// Counts one step: a statement or an iteration of a loop. Fails beyond `MAX_STEPS`.
    pub(crate) fn count_step(&mut self, place: Span) -> Fallible<()> {
        self.steps += 1;
        if self.steps > MAX_STEPS {
            return Err(Error::new(place, ErrorKind::TooManySteps { limit: MAX_STEPS }));
        }
        Ok(())
    }

    /// Runs `follow` as one side of a branch, for the case that `left` is 0: no early exit
    /// happened. If an exit certainly happened, does nothing.
    fn unless_exited(
        &mut self,
        left: ExprKind,
        frame: &mut Frame,
        follow: impl FnOnce(&mut Self, &mut Frame) -> Fallible<()>,
    ) -> Fallible<()> {
        if number_of(&left).is_none() {
            let mut going = frame.inner();
            going.aliases.push(EXIT_LEVEL.to_owned(), ExprKind::Number("0".to_owned()));
            follow(self, &mut going)?;
            let stopped = frame.clone();
            let is_same = frame.exit_level() == Some(&left) && going.exit_level().is_none();
            self.merge(frame, &stopped, &going, &more_than(left.clone(), 0.0));
            if is_same {
                frame.aliases.push(EXIT_LEVEL.to_owned(), left);
            }
        }
        Ok(())
    }

    /// Runs a statement that contains no other statements.
    fn plain_step(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<()> {
        if self.sets_element(tokens, frame)? {
            return Ok(());
        }
        let tokens = &self.with_elements(tokens.to_vec(), frame);
        let Some(first) = tokens.first() else { return Ok(()) };
        let word = match first.kind {
            // The value of a function without statements.
            TokenKind::Saved if first.number == 0 => "return",
            _ => self.words.word(*first),
        };
        match word {
            "break" if tokens.len() == 1 => record_exit(LOOP, frame),
            "continue" if tokens.len() == 1 => record_exit(ROUND, frame),
            "return" if tokens.len() == 1 => record_exit(FUNCTION, frame),
            "return" if frame.nested > 0 => {
                let name = Name { text: RESULT.to_owned(), span: first.span };
                let value = self.returned(&tokens[1..], frame)?;
                if self.is_condition(&value, frame) {
                    let kind = self.flag(value, frame)?;
                    frame.aliases.push(name.text.clone(), kind);
                    frame.set.push((name.text, 1));
                } else {
                    self.set(name, 1, value, frame)?;
                }
                record_exit(FUNCTION, frame);
            }
            "return" => {
                let value = self.returned(&tokens[1..], frame)?;
                self.result(value, frame)?;
                frame.has_result = true;
                record_exit(FUNCTION, frame);
            }
            _ => {
                self.statement(tokens.clone(), frame, &mut Statements::default())?;
            }
        }
        Ok(())
    }

    /// The value after `return`. Several values become a vector.
    fn returned(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<Vec<Token>> {
        let value = self.run_effects(tokens.to_vec(), frame)?;
        let is_tuple = self.language == Language::Python && outside(&value, Comma).is_some();
        let mut value = if is_tuple { in_brackets(&value) } else { value };
        if is_tuple && let [open, .., close] = value.as_mut_slice() {
            (open.kind, close.kind) = (OpenBracket, TokenKind::CloseBracket);
        }
        Ok(value)
    }

    /// Runs one side of an `if` with a known condition. Otherwise runs and merges both sides.
    fn branch(
        &mut self,
        condition: &[Token],
        yes: &[ProgramStep],
        no: &[ProgramStep],
        frame: &mut Frame,
    ) -> Fallible<()> {
        let condition = self.run_effects(condition.to_vec(), frame)?;
        if let Some(holds) = self.known_value(&condition, frame) {
            return self.run(if holds == 0.0 { no } else { yes }, frame);
        }
        let kind = self.indicator(condition, frame)?;
        let (mut first, mut second) = (frame.inner(), frame.inner());
        self.run(yes, &mut first)?;
        self.run(no, &mut second)?;
        self.merge(frame, &first, &second, &more_than(kind, 0.0));
        Ok(())
    }

    /// Runs a loop. `begin` prepares each iteration, and returns false when the loop ends.
    fn repeat(
        &mut self,
        begin: NextRound<'_, Self>,
        body: &[ProgramStep],
        otherwise: &[ProgramStep],
        frame: &mut Frame,
    ) -> Fallible<()> {
        frame.nested += 1;
        self.remaining_rounds(begin, body, frame)?;
        let left = frame.exit_level().cloned();
        // An exit from the loop is complete at this point. An exit from the function continues.
        self.drop_exits(LOOP, ProgramStep::has(body, self.words, "return"), frame);
        frame.nested -= 1;
        // Python's `else` of a loop runs unless the loop was left early.
        match left {
            _ if otherwise.is_empty() => Ok(()),
            None => self.run(otherwise, frame),
            Some(left) => {
                self.unless_exited(left, frame, |reader, going| reader.run(otherwise, going))
            }
        }
    }

    /// Runs the remaining iterations of a loop.
    fn remaining_rounds(
        &mut self,
        begin: NextRound<'_, Self>,
        body: &[ProgramStep],
        frame: &mut Frame,
    ) -> Fallible<()> {
        while begin(self, frame)? {
            self.run(body, frame)?;
            if let Some(left) = self.end_round(body, frame) {
                return self.unless_exited(left, frame, |reader, going| {
                    reader.remaining_rounds(begin, body, going)
                });
            }
        }
        Ok(())
    }

    /// Returns whether the condition of a loop holds. Fails if the condition's value is not known.
    fn holds(&mut self, condition: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let Some(span) = span_of(condition) else { return Ok(true) };
        let condition = self.run_effects(condition.to_vec(), frame)?;
        let known = self.known_value(&condition, frame).map(|holds| holds != 0.0);
        known.ok_or_else(|| Error::new(span, ErrorKind::LoopEnd))
    }

    /// Ends an iteration. Drops an exit by `continue`, and returns an exit by `break` or `return`.
    fn end_round(&mut self, body: &[ProgramStep], frame: &mut Frame) -> Option<ExprKind> {
        if ProgramStep::has(body, self.words, "continue") {
            let others =
                ["break", "return"].iter().any(|word| ProgramStep::has(body, self.words, word));
            self.drop_exits(ROUND, others, frame);
        }
        frame.exit_level().cloned()
    }

    /// Drops exits up to `level`. `others` is true if exits of a higher level may have happened.
    fn drop_exits(&mut self, level: f64, others: bool, frame: &mut Frame) {
        let Some(left) = frame.aliases.find(EXIT_LEVEL).cloned() else { return };
        let zero = ExprKind::Number("0".to_owned());
        let kind = match number_of(&left) {
            Some(number) if number > level => return,
            None if others => {
                let span = Span::default();
                let piece = (more_than(left.clone(), level), Expr::new(left, span));
                let body = ExprKind::Choice(vec![piece], Some(Box::new(Expr::new(zero, span))));
                self.synthesize(EXIT_LEVEL, body, frame)
            }
            _ => zero,
        };
        frame.aliases.push(EXIT_LEVEL.to_owned(), kind);
    }
}

/// Prepares the next iteration of a loop. Returns false if the loop has no more iterations.
type NextRound<'b, R> = &'b mut dyn FnMut(&mut R, &mut Frame) -> Fallible<bool>;

pub(crate) fn more_than(kind: ExprKind, level: f64) -> Expr {
    let span = Span::default();
    let level = Expr::new(number_expr(level, span), span);
    Expr::new(kind, span).compared(Relation::Greater, level, span)
}

fn record_exit(level: f64, frame: &mut Frame) {
    frame.aliases.push(EXIT_LEVEL.to_owned(), number_expr(level, Span::default()));
}
