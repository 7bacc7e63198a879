//! The claims of rewritings as problems for a solver: for all real inputs, the graph before and the
//! graph after have the same value, and are defined at the same points.
//!
//! Each node becomes a real and a condition under which it is defined. The value of a function is
//! some number. Known of it are range, and the table's values, parity and inverses, which are not
//! proven here. Calls with equal operands have equal values.

use crate::testing::TestGraphBuilder;
use crate::{Constant, Graph, NamedConstant, Node, NodeId, Variability, display, variabilities};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};
use zeroset_interval::Interval;
use zeroset_ops::{Class, Domain, Law, Op, Parity};

/// A problem under construction.
#[derive(Default)]
struct Problem {
    text: String,
    /// Calls of functions: operation, operands, and the name of the value.
    calls: Vec<(Op, Vec<String>, String)>,
    constants: Vec<(Constant, String)>,
}

fn number(value: &BigRational) -> String {
    let size = value.abs();
    let text = format!("(/ {}.0 {}.0)", size.numer(), size.denom());
    if value.is_negative() { format!("(- {text})") } else { text }
}

fn float(value: f64) -> String {
    number(&BigRational::from_float(value).expect("a finite number"))
}

impl Problem {
    fn line(&mut self, line: &str) {
        self.text += line;
        self.text.push('\n');
    }

    fn within(&mut self, name: &str, range: Interval) {
        if range.lo.is_finite() {
            self.line(&format!("(assert (<= {} {name}))", float(range.lo)));
        }
        if range.hi.is_finite() {
            self.line(&format!("(assert (<= {name} {}))", float(range.hi)));
        }
    }

    fn input(&mut self, name: &str, range: Interval) {
        self.line(&format!("(declare-const {name} Real)"));
        self.within(name, range);
    }

    fn constant(&mut self, constant: &Constant) -> String {
        if let Some(exact) = constant.exact() {
            return number(exact);
        }
        if let Some((_, name)) = self.constants.iter().find(|(known, _)| known == constant) {
            return name.clone();
        }
        let half_tau = match constant {
            Constant::Named(NamedConstant::Tau) => {
                Some(self.constant(&Constant::Named(NamedConstant::Pi)))
            }
            _ => None,
        };
        let name = format!("c{}", self.constants.len());
        self.constants.push((constant.clone(), name.clone()));
        self.input(&name, constant.bounds());
        if let Some(pi) = half_tau {
            self.line(&format!("(assert (= {name} (* 2.0 {pi})))"));
        }
        name
    }

    /// The value of a function that the solver does not know, with its facts.
    fn call(&mut self, op: Op, operands: &[String]) -> String {
        let found = self.calls.iter().find(|(known, at, _)| *known == op && at == operands);
        if let Some((.., name)) = found {
            return name.clone();
        }
        let name = format!("f{}", self.calls.len());
        self.line(&format!("(declare-const {name} Real) ; {op:?}"));
        let row = op.row();
        let a = operands[0].clone();
        for pair in row.values {
            let (at, value) = (float(pair.0.into()), float(pair.1.into()));
            self.line(&format!("(assert (=> (= {a} {at}) (= {name} {value})))"));
        }
        match op {
            Op::Sqrt => {
                self.line(&format!(
                    "(assert (=> (<= 0.0 {a}) (and (<= 0.0 {name}) (= (* {name} {name}) {a}))))"
                ));
            }
            Op::Cbrt => self.line(&format!("(assert (= (* {name} {name} {name}) {a}))")),
            Op::Exp => self.line(&format!("(assert (< 0.0 {name}))")),
            Op::Sin | Op::Cos => self.wave(op, &a, &name),
            Op::Pow => {
                for (exponent, power) in [("1.0", a.clone()), ("2.0", format!("(* {a} {a})"))] {
                    let whole = format!("(= {} {exponent})", operands[1]);
                    self.line(&format!("(assert (=> {whole} (= {name} {power})))"));
                }
            }
            _ => {}
        }
        let others: Vec<_> =
            self.calls.iter().filter(|(known, ..)| *known == op).cloned().collect();
        for (_, at, value) in others {
            let equal: Vec<String> =
                at.iter().zip(operands).map(|(a, b)| format!("(= {a} {b})")).collect();
            self.line(&format!("(assert (=> (and {}) (= {value} {name})))", equal.join(" ")));
            let opposite = format!("(= {} (- {a}))", at[0]);
            match row.parity {
                Parity::Even => self.line(&format!("(assert (=> {opposite} (= {value} {name})))")),
                Parity::Odd => {
                    self.line(&format!("(assert (=> {opposite} (= {value} (- {name}))))"));
                }
                Parity::Neither => {}
            }
        }
        self.calls.push((op, operands.to_vec(), name.clone()));
        if let Class::Function(Law::Undoes(inner)) = row.class {
            let inner: Vec<_> =
                self.calls.iter().filter(|(known, ..)| *known == inner).cloned().collect();
            for (inner, at, value) in inner {
                let domain =
                    condition(inner.row().domain, &at).unwrap_or_else(|| "false".to_owned());
                self.line(&format!(
                    "(assert (=> (and {domain} (= {a} {value})) (= {name} {})))",
                    at[0]
                ));
            }
        }
        name
    }

    /// Range of a wave, and its values at multiples of π/6 that are rational.
    fn wave(&mut self, op: Op, a: &str, name: &str) {
        self.within(name, Interval { lo: -1.0, hi: 1.0 });
        let pi = self.constant(&Constant::Named(NamedConstant::Pi));
        for k in -36_i32..=36 {
            // Both waves by the sine of an angle from 0 to 11 parts.
            let part = (k + if op == Op::Cos { 3 } else { 0 }).rem_euclid(12);
            let value = match part {
                0 | 6 => "0.0",
                1 | 5 => "0.5",
                3 => "1.0",
                7 | 11 => "(- 0.5)",
                9 => "(- 1.0)",
                _ => continue,
            };
            let angle = number(&BigRational::new(k.into(), 6.into()));
            self.line(&format!("(assert (=> (= {a} (* {angle} {pi})) (= {name} {value})))"));
        }
    }

    /// Adds all nodes that `root` needs. An error is the reason for which one cannot be stated.
    fn graph(&mut self, graph: &Graph, root: NodeId, prefix: &str) -> Result<String, String> {
        let ranks = variabilities(graph);
        let needed = graph.reachable(&[root]);
        for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
            let name = format!("{prefix}{}", id.index());
            let (value, defined) = match node {
                Node::Variable(axis) => (["x", "y", "z"][*axis as usize].to_owned(), "true".into()),
                Node::Parameter(k) => (format!("p{k}"), "true".to_owned()),
                Node::Constant(constant) => (self.constant(constant), "true".to_owned()),
                Node::Apply(op, operands) => {
                    let at: Vec<String> =
                        operands.iter().map(|id| format!("{prefix}{}", id.index())).collect();
                    let exponent =
                        operands.get(1).map(|id| (graph.number(*id).cloned(), ranks[id.index()]));
                    self.apply(*op, &at, exponent)?
                }
            };
            self.line(&format!("(define-fun {name} () Real {value})"));
            self.line(&format!("(define-fun {name}d () Bool {defined})"));
        }
        Ok(format!("{prefix}{}", root.index()))
    }

    fn apply(
        &mut self,
        op: Op,
        at: &[String],
        exponent: Option<(Option<Constant>, Variability)>,
    ) -> Result<(String, String), String> {
        let a = &at[0];
        let all =
            format!("(and {})", at.iter().map(|a| format!("{a}d")).collect::<Vec<_>>().join(" "));
        let b = at.get(1).map_or("", String::as_str);
        let value = match op {
            Op::Neg => format!("(- {a})"),
            Op::Add => format!("(+ {a} {b})"),
            Op::Sub => format!("(- {a} {b})"),
            Op::Mul => format!("(* {a} {b})"),
            Op::Div => format!("(/ {a} {b})"),
            Op::Sqr => format!("(* {a} {a})"),
            Op::Abs => format!("(ite (<= 0.0 {a}) {a} (- {a}))"),
            Op::Sign => format!("(ite (< 0.0 {a}) 1.0 (ite (< {a} 0.0) (- 1.0) 0.0))"),
            Op::Min => format!("(ite (<= {a} {b}) {a} {b})"),
            Op::Max => format!("(ite (<= {a} {b}) {b} {a})"),
            Op::Floor => format!("(to_real (to_int {a}))"),
            Op::Ceil => format!("(- (to_real (to_int (- {a}))))"),
            Op::Fract => format!("(- {a} (to_real (to_int {a})))"),
            Op::SelectNegative => {
                let value = format!("(ite (< {a} 0.0) {b} {})", at[2]);
                return Ok((value, format!("(and {a}d (ite (< {a} 0.0) {b}d {}d))", at[2])));
            }
            Op::Otherwise => return Ok((format!("(ite {a}d {a} {b})"), format!("(or {a}d {b}d)"))),
            Op::WhereNonneg | Op::WherePositive | Op::WhereNonzero | Op::WhereDefined => a.clone(),
            Op::Pow => return self.power(at, &all, exponent.expect("two operands")),
            _ => self.call(op, at),
        };
        let inside = condition(op.row().domain, at).ok_or_else(|| format!("{op:?}"))?;
        Ok((value, format!("(and {all} {inside})")))
    }

    /// The value of a power, and where it is defined. All operands must be, as `all` states.
    fn power(
        &mut self,
        at: &[String],
        all: &str,
        (exponent, rank): (Option<Constant>, Variability),
    ) -> Result<(String, String), String> {
        let a = &at[0];
        let Some(exact) = exponent.as_ref().and_then(Constant::exact) else {
            if rank == Variability::Constant {
                return Err("an exponent that is computed".to_owned());
            }
            let inside = format!("(or (< 0.0 {a}) (and (= {a} 0.0) (< 0.0 {})))", at[1]);
            return Ok((self.call(Op::Pow, at), format!("(and {all} {inside})")));
        };
        let twice = exact * BigRational::from_integer(2.into());
        let n = twice.is_integer().then(|| twice.to_integer().to_i64()).flatten();
        let n = n.filter(|n| n.abs() <= 48).ok_or("an exponent that is no half")?;
        let is_whole = n % 2 == 0;
        let (base, count) =
            if is_whole { (a.clone(), n / 2) } else { (self.call(Op::Sqrt, &at[..1]), n) };
        let product = match count.unsigned_abs() {
            0 => "1.0".to_owned(),
            1 => base,
            count => format!("(*{})", format!(" {base}").repeat(count as usize)),
        };
        let value = if count < 0 { format!("(/ 1.0 {product})") } else { product };
        let inside = match (is_whole, n < 0) {
            (true, false) => "true".to_owned(),
            (true, true) => format!("(not (= {a} 0.0))"),
            (false, false) => format!("(<= 0.0 {a})"),
            (false, true) => format!("(< 0.0 {a})"),
        };
        Ok((value, format!("(and {all} {inside})")))
    }
}

/// The condition for operands to be in a domain. `None` if the solver has no words for it.
fn condition(domain: Domain, at: &[String]) -> Option<String> {
    let (a, last) = (&at[0], &at[at.len() - 1]);
    Some(match domain {
        Domain::All => "true".to_owned(),
        Domain::Nonneg => format!("(<= 0.0 {a})"),
        Domain::Positive => format!("(< 0.0 {a})"),
        Domain::LastNonzero => format!("(not (= {last} 0.0))"),
        Domain::LastNonneg => format!("(<= 0.0 {last})"),
        Domain::LastPositive => format!("(< 0.0 {last})"),
        Domain::Unit => format!("(<= (- 1.0) {a} 1.0)"),
        Domain::UnitInside => format!("(< (- 1.0) {a} 1.0)"),
        Domain::FromOne => format!("(<= 1.0 {a})"),
        Domain::AnyNonzero => {
            let zero: Vec<String> = at.iter().map(|a| format!("(= {a} 0.0)")).collect();
            format!("(not (and {}))", zero.join(" "))
        }
        Domain::CosineNonzero | Domain::Power => return None,
    })
}

/// The problem of whether two graphs agree for all inputs within these bounds. The solver finds
/// inputs, and then none for which they differ.
fn agreement(
    before: (&Graph, NodeId),
    after: (&Graph, NodeId),
    [coordinates, parameters]: [&[Interval]; 2],
) -> Result<String, String> {
    let mut problem = Problem::default();
    for (name, range) in ["x", "y", "z"].iter().zip(coordinates) {
        problem.input(name, *range);
    }
    for (k, range) in parameters.iter().enumerate() {
        problem.input(&format!("p{k}"), *range);
    }
    let one = problem.graph(before.0, before.1, "b")?;
    let other = problem.graph(after.0, after.1, "a")?;
    let same = format!("(and (= {one}d {other}d) (=> {one}d (= {one} {other})))");
    problem.line(&format!("(check-sat)\n(assert (not {same}))\n(check-sat)"));
    Ok(problem.text)
}

/// Writes the problem of whether two graphs agree to a subfolder of the folder that
/// `ZEROSET_PROOFS` names, if it is set. `ranges` are those of coordinates and of parameters.
pub(crate) fn write(
    subfolder: &str,
    before: (&Graph, NodeId),
    after: (&Graph, NodeId),
    ranges: [&[Interval]; 2],
) {
    let Some(folder) = std::env::var_os("ZEROSET_PROOFS") else { return };
    let folder = std::path::Path::new(&folder).join(subfolder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let [text, new] = [before, after].map(|(graph, root)| display(graph, root, &["a", "b"]));
    match agreement(before, after, ranges) {
        Ok(problem) => {
            let mut hasher = FxHasher::default();
            text.hash(&mut hasher);
            let file = folder.join(format!("{:016x}.smt2", hasher.finish()));
            std::fs::write(file, format!("; {text} is {new}\n{problem}")).expect("written");
        }
        Err(reason) => println!("not stated, for {reason}: {text} is {new}"),
    }
}

#[test]
fn proofs_of_wrong_rewritings() {
    let builder = TestGraphBuilder::default();
    let [x, y, _] = builder.xyz();
    let one = builder.number("1");
    let range = Interval { lo: -2.0, hi: 2.0 };
    for (before, after) in [
        (x / x, one),
        (x.pow(2).f(Op::Sqrt), x),
        (2.0 * x + 3.0 * x, 6.0 * x),
        (x.f(Op::Sin) + (-x).f(Op::Sin), x.f(Op::Sin)),
        (x.f(Op::Ln).f(Op::Exp), x),
        (x.apply(Op::Min, &[y]), x),
    ] {
        let graph = builder.graph();
        let ranges: [&[Interval]; 2] = [&[range; 3], &[]];
        let stated = agreement((&graph, before.id), (&graph, after.id), ranges);
        assert!(stated.is_ok(), "{stated:?}");
        write("wrong-rewritings", (&graph, before.id), (&graph, after.id), ranges);
    }
}
