//! A machine that writes what it executes as definitions for a solver. They say that results are
//! rounded up, by at most a unit.

use crate::machine::{Format, Machine};
use std::fmt::Write as _;
use std::path::Path;

/// Writes scripts to a folder below `ZEROSET_PROOFS`, if it is set. `proofs/run` solves them.
pub(super) fn write(folder: &str, scripts: impl IntoIterator<Item = (String, String)>) {
    let Some(root) = std::env::var_os("ZEROSET_PROOFS") else { return };
    let folder = Path::new(&root).join(folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    for (name, script) in scripts {
        std::fs::write(folder.join(format!("{name}.smt2")), script).expect("written");
    }
}

/// A machine whose vectors are numbers of terms.
#[derive(Default)]
pub(super) struct Script {
    /// Declarations and facts, a line each.
    pub(super) text: String,
    terms: Vec<String>,
    /// For each term the denominator, if it is a quotient.
    denominators: Vec<Option<usize>>,
}

impl Script {
    fn term(&mut self, term: String) -> usize {
        self.terms.push(term);
        self.denominators.push(None);
        self.terms.len() - 1
    }

    /// A constant of some kind.
    pub(super) fn declare(&mut self, name: &str, kind: &str) -> usize {
        let _ = writeln!(self.text, "(declare-const |{name}| {kind})");
        self.term(format!("|{name}|"))
    }

    /// An input.
    pub(super) fn input(&mut self, name: &str) -> usize {
        self.declare(name, "Real")
    }

    /// Adds a fact.
    pub(super) fn assume(&mut self, fact: &str) {
        let _ = writeln!(self.text, "(assert {fact})");
    }

    /// The text of a number.
    pub(super) fn text_of(&mut self, number: f64) -> String {
        let number = self.number(Format::F32, number);
        self.of(number).to_owned()
    }

    /// The text of a value.
    pub(super) fn of(&self, value: usize) -> &str {
        &self.terms[value]
    }

    /// The result of an operation that rounds.
    fn rounded(&mut self, exact: &str) -> usize {
        let value = self.declare(&format!("value {}", self.terms.len()), "Real");
        self.assume(&format!("(and (up {exact} {0}) (finite {0}))", self.of(value)));
        value
    }

    fn apply(&self, name: &str, operands: &[usize]) -> String {
        let operands: Vec<&str> = operands.iter().map(|operand| self.of(*operand)).collect();
        format!("({name} {})", operands.join(" "))
    }

    fn exact(&mut self, name: &str, operands: &[usize]) -> usize {
        let term = self.apply(name, operands);
        self.term(term)
    }

    /// A constant for a where `first` holds, else b. Terms would double with each choice.
    fn chosen(&mut self, first: &str, a: usize, b: usize) -> usize {
        let value = self.declare(&format!("value {}", self.terms.len()), "Real");
        let [a, b, chosen] = [a, b, value].map(|number| self.of(number).to_owned());
        self.assume(&format!("(= {chosen} (ite {first} {a} {b}))"));
        value
    }

    /// `sign` where a quotient is a number, and false where its denominator is 0.
    fn is_number_and(&self, value: usize, sign: String) -> String {
        match self.denominators[value] {
            Some(below) => format!("(and (not (= {} 0.0)) {sign})", self.of(below)),
            None => sign,
        }
    }
}

impl Machine for Script {
    type V = usize;

    /// Infinity is a number that is larger than all bounds.
    fn number(&mut self, _: Format, value: f64) -> usize {
        if value == f64::INFINITY {
            return self.term("infinity".to_owned());
        }
        let size = format!("{:.6}", value.abs());
        assert_eq!(size.parse::<f64>(), Ok(value.abs()), "all digits are written");
        self.term(if value < 0.0 { format!("(- {size})") } else { size })
    }

    fn bits(&mut self, _: Format, bits: u64) -> usize {
        let term = match bits {
            0 => "false",
            1 => "|least positive|",
            u64::MAX => "true",
            _ => unimplemented!("{bits:x}"),
        };
        self.term(term.to_owned())
    }

    fn add(&mut self, a: usize, b: usize) -> usize {
        let exact = self.apply("+", &[a, b]);
        self.rounded(&exact)
    }

    /// A difference from 0 is exact.
    fn sub(&mut self, a: usize, b: usize) -> usize {
        if self.of(a).parse() == Ok(0.0) {
            return self.neg(b);
        }
        let exact = self.apply("-", &[a, b]);
        self.rounded(&exact)
    }

    /// Products by powers of two are exact.
    fn mul(&mut self, a: usize, b: usize) -> usize {
        let is_half = |factor: usize| self.of(factor) == "0.500000";
        if is_half(a) || is_half(b) {
            return self.exact("*", &[a, b]);
        }
        let exact = self.apply("*", &[a, b]);
        self.rounded(&exact)
    }

    /// Two roundings give at least what one gives.
    fn mul_add(&mut self, a: usize, b: usize, c: usize) -> usize {
        let exact = format!("(+ {} {})", self.apply("*", &[a, b]), self.of(c));
        self.rounded(&exact)
    }

    /// A positive number by 0 is ∞. Nothing is said of other quotients by 0, and of those by
    /// numbers below 0. [`Self::min`] knows that a quotient by 0 may be NaN.
    fn div(&mut self, a: usize, b: usize) -> usize {
        let value = self.declare(&format!("value {}", self.terms.len()), "Real");
        let [above, below, quotient] = [a, b, value].map(|number| self.of(number).to_owned());
        self.assume(&format!("(=> (< 0.0 {below}) (up {above} (* {quotient} {below})))"));
        self.assume(&format!("(=> (< 0.0 {below}) (finite {quotient}))"));
        self.assume(&format!("(=> (= 0.0 {below}) (< 0.0 {above}) (= {quotient} infinity))"));
        self.denominators[value] = Some(b);
        value
    }

    fn neg(&mut self, a: usize) -> usize {
        self.exact("-", &[a])
    }

    fn floor(&mut self, a: usize) -> usize {
        self.exact("floor", &[a])
    }

    fn ceil(&mut self, a: usize) -> usize {
        let opposite = self.neg(a);
        let floor = self.floor(opposite);
        self.neg(floor)
    }

    fn abs(&mut self, a: usize) -> usize {
        self.exact("size", &[a])
    }

    fn min(&mut self, a: usize, b: usize) -> usize {
        let first = self.is_number_and(a, self.apply("<", &[a, b]));
        self.chosen(&first, a, b)
    }

    fn max(&mut self, a: usize, b: usize) -> usize {
        let first = self.apply("<", &[b, a]);
        self.chosen(&first, a, b)
    }

    fn lt(&mut self, a: usize, b: usize) -> usize {
        self.exact("<", &[a, b])
    }

    fn le(&mut self, a: usize, b: usize) -> usize {
        self.exact("<=", &[a, b])
    }

    fn eq(&mut self, a: usize, b: usize) -> usize {
        self.exact("=", &[a, b])
    }

    fn and(&mut self, a: usize, b: usize) -> usize {
        self.exact("and", &[a, b])
    }

    fn or(&mut self, a: usize, b: usize) -> usize {
        self.exact("or", &[a, b])
    }

    fn xor(&mut self, a: usize, b: usize) -> usize {
        self.exact("xor", &[a, b])
    }

    fn select(&mut self, mask: usize, a: usize, b: usize) -> usize {
        let mask = self.of(mask).to_owned();
        self.chosen(&mask, a, b)
    }

    /// The sign of 0 is not known.
    fn select_signed(&mut self, sign: usize, a: usize, b: usize) -> usize {
        let coin = format!("|sign of value {sign}|");
        let declaration = format!("(declare-const {coin} Bool)\n");
        if !self.text.contains(&declaration) {
            self.text += &declaration;
        }
        let first = format!("(or (< {0} 0.0) (and (= {0} 0.0) {coin}))", self.of(sign));
        self.chosen(&first, a, b)
    }

    not_recorded! {
        sqrt(a: usize) -> usize;
        trunc(a: usize) -> usize;
        nearest(a: usize) -> usize;
        int_add(a: usize, b: usize) -> usize;
        int_sub(a: usize, b: usize) -> usize;
        shift_left(a: usize, by: u8) -> usize;
        shift_right(a: usize, by: u8) -> usize;
        widen(a: usize) -> [usize; 2];
        narrow(halves: [usize; 2]) -> usize;
    }
}
