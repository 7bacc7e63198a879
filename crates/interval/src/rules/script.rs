//! A machine that writes what it executes as definitions for a solver. They say that results are
//! rounded up.

use crate::machine::{Format, Machine};
use std::fmt::Write as _;
use std::path::Path;

/// Writes scripts to a folder below `ZEROSET_PROOFS`, if it is set. `proofs/run` solves them.
pub(super) fn write(folder: &str, scripts: impl IntoIterator<Item = (String, String)>) {
    for (name, script) in scripts {
        write_text(&format!("{folder}/{name}.smt2"), &script);
    }
}

/// Writes a file below `ZEROSET_PROOFS`, if it is set.
pub(super) fn write_text(path: &str, text: &str) {
    let Some(root) = std::env::var_os("ZEROSET_PROOFS") else { return };
    let path = Path::new(&root).join(path);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    std::fs::write(path, text).expect("written");
}

/// A machine whose vectors are numbers of terms.
#[derive(Default)]
pub(super) struct Script {
    /// Declarations and facts, a line each.
    pub(super) text: String,
    /// The largest relative error of an operation that rounds once, if it matters.
    unit: Option<f64>,
    terms: Vec<String>,
    /// For each term numerator and denominator, if it is a quotient.
    quotients: Vec<Option<[usize; 2]>>,
}

impl Script {
    /// A machine for statements that need the size of errors.
    pub(super) fn with_unit(unit: f64) -> Self {
        Self { unit: Some(unit), ..Self::default() }
    }

    fn term(&mut self, term: String) -> usize {
        self.terms.push(term);
        self.quotients.push(None);
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

    /// A result that is at least `exact`.
    fn above(&mut self, exact: &str) -> usize {
        let value = self.declare(&format!("value {}", self.terms.len()), "Real");
        self.assume(&format!("(and (up {exact} {0}) (finite {0}))", self.of(value)));
        value
    }

    /// The result of an operation that rounds once.
    fn rounded(&mut self, exact: &str) -> usize {
        let value = self.above(exact);
        if let Some(unit) = self.unit {
            let error = format!("(size (- {} {exact}))", self.of(value));
            self.assume(&format!("(<= {error} (* (/ 1.0 {:?}) (size {exact})))", 1.0 / unit));
        }
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

    /// `fact` where a value is a number, and false where it is NaN.
    fn is_number_and(&self, value: usize, fact: String) -> String {
        match self.quotients[value] {
            Some(parts) => {
                let [above, below] = parts.map(|part| self.of(part));
                format!("(and (not (= 0.0 {above} {below})) {fact})")
            }
            None => fact,
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
        self.assume(&format!("(finite {size})"));
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

    /// A half is exact.
    fn mul(&mut self, a: usize, b: usize) -> usize {
        let is_half = |factor: usize| self.of(factor) == "0.500000";
        if is_half(a) || is_half(b) {
            return self.exact("*", &[a, b]);
        }
        let exact = self.apply("*", &[a, b]);
        self.rounded(&exact)
    }

    /// Two roundings give at least what one gives, and may err by more than a unit.
    fn mul_add(&mut self, a: usize, b: usize, c: usize) -> usize {
        let exact = format!("(+ {} {})", self.apply("*", &[a, b]), self.of(c));
        self.above(&exact)
    }

    /// A number by 0 is ±∞, and 0 by 0 is NaN. Nothing is said of quotients by numbers below 0.
    fn div(&mut self, a: usize, b: usize) -> usize {
        let value = self.declare(&format!("value {}", self.terms.len()), "Real");
        let [above, below, quotient] = [a, b, value].map(|number| self.of(number).to_owned());
        self.assume(&format!("(=> (< 0.0 {below}) (up {above} (* {quotient} {below})))"));
        self.assume(&format!("(=> (< 0.0 {below}) (finite {quotient}))"));
        self.assume(&format!("(=> (= 0.0 {below}) (< 0.0 {above}) (= {quotient} infinity))"));
        self.assume(&format!("(=> (= 0.0 {below}) (< {above} 0.0) (= {quotient} (- infinity)))"));
        self.quotients[value] = Some([a, b]);
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
