//! A reader of test cases in the interval test language of ITF1788: `name operand… = result;`
//! within `testcase … { }`.
//!
//! The reader knows the notation of numbers, intervals and decorations, but no operations.

use zeroset_interval::{Facts, Interval};

/// One line of a test: an operation, its operands and its tightest result.
#[derive(Clone, Debug)]
pub struct TestCase {
    pub name: String,
    pub operands: Vec<Term>,
    pub result: Term,
    /// The case's line in the file, with single spaces.
    pub text: String,
}

/// An operand or a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// An interval (`None` if empty), decorated or bare.
    Set(Option<Interval>, Option<Decoration>),
    /// The invalid interval, `NaI` ("not an interval").
    Nai,
    /// An integer, the exponent of `pown`.
    Integer(i32),
}

/// A decoration of IEEE 1788, from the weakest claim to the strongest. `com` counts as `Dac`: it
/// adds that the bounds are finite, which the bounds show themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Decoration {
    /// Nothing is claimed.
    Trv,
    /// Defined throughout.
    Def,
    /// Defined and continuous throughout.
    Dac,
}

impl Decoration {
    /// Returns the facts with the same meaning.
    pub fn facts(self) -> Facts {
        match self {
            Self::Trv => Facts::NONE,
            Self::Def => Facts::DEFINED,
            Self::Dac => Facts::TOTAL,
        }
    }

    /// Returns the strongest decoration that these facts imply.
    pub fn of(facts: Facts) -> Self {
        if facts.has(Facts::TOTAL) {
            Self::Dac
        } else if facts.has(Facts::DEFINED) {
            Self::Def
        } else {
            Self::Trv
        }
    }
}

/// Returns all cases of a file.
///
/// # Panics
/// If the file contains notation that this reader does not know, so that no case is skipped
/// unnoticed.
pub fn parse(file: &str) -> Vec<TestCase> {
    let mut text = file.to_owned();
    while let Some(start) = text.find("/*") {
        let end = start + text[start..].find("*/").expect("a closed comment") + 2;
        text.replace_range(start..end, "");
    }
    let text: String =
        text.lines().flat_map(|line| [line.split("//").next().unwrap_or(""), "\n"]).collect();
    let mut cases = Vec::new();
    for block in text.split("testcase").skip(1) {
        let (_, body) = block.split_once('{').expect("a test has a body");
        let (body, rest) = body.split_once('}').expect("a body ends");
        assert!(rest.trim().is_empty(), "between tests: {rest}");
        let lines = body.split(';').map(str::trim).filter(|line| !line.is_empty());
        cases.extend(lines.map(case));
    }
    cases
}

fn case(line: &str) -> TestCase {
    let text = line.split_whitespace().collect::<Vec<_>>().join(" ");
    let (left, right) = text.split_once('=').unwrap_or_else(|| panic!("no result: {text}"));
    let (name, operands) = left.trim().split_once(' ').unwrap_or_else(|| panic!("{text}"));
    let results = terms(right);
    assert_eq!(results.len(), 1, "one result: {text}");
    TestCase {
        name: name.to_owned(),
        operands: terms(operands),
        result: results[0],
        text: text.clone(),
    }
}

fn terms(text: &str) -> Vec<Term> {
    let mut rest = text.trim();
    let mut terms = Vec::new();
    while !rest.is_empty() {
        let end = match rest.strip_prefix('[') {
            Some(_) => {
                let close = rest.find(']').unwrap_or_else(|| panic!("no bracket: {text}")) + 1;
                close + rest[close..].find(' ').unwrap_or(rest.len() - close)
            }
            None => rest.find(' ').unwrap_or(rest.len()),
        };
        terms.push(term(&rest[..end]));
        rest = rest[end..].trim_start();
    }
    terms
}

fn term(text: &str) -> Term {
    let Some(inner) = text.strip_prefix('[') else {
        return Term::Integer(text.parse().unwrap_or_else(|_| panic!("an integer: {text}")));
    };
    let (inner, decoration) = inner.split_once(']').expect("found before");
    let decoration = match decoration {
        "" => None,
        "_trv" => Some(Decoration::Trv),
        "_def" => Some(Decoration::Def),
        "_dac" | "_com" => Some(Decoration::Dac),
        other => panic!("a decoration: {other}"),
    };
    let bounds = match inner.trim() {
        "nai" => return Term::Nai,
        "empty" => None,
        "entire" => Some(Interval::ENTIRE),
        ends => {
            let (lo, hi) = ends.split_once(',').unwrap_or((ends, ends));
            let bounds = Interval::new(number(lo), number(hi));
            Some(bounds.unwrap_or_else(|| panic!("an interval: {text}")))
        }
    };
    Term::Set(bounds, decoration)
}

/// Returns a number. Decimals are rounded to the nearest `f64`, as in the C++ source of the tests.
fn number(text: &str) -> f64 {
    let text = text.trim().to_lowercase();
    let (sign, magnitude) = match text.strip_prefix('-') {
        Some(magnitude) => (-1.0, magnitude),
        None => (1.0, text.strip_prefix('+').unwrap_or(&text)),
    };
    let value = match magnitude.strip_prefix("0x") {
        Some(digits) => hexadecimal(digits),
        None => magnitude.parse().ok(),
    };
    // Adding +0 turns −0 into +0, since an interval has no signed zeros.
    0.0 + sign * value.unwrap_or_else(|| panic!("a number: {text}"))
}

/// Reads a number like `1.8p-3` exactly. The files contain only numbers that are `f64`.
fn hexadecimal(digits: &str) -> Option<f64> {
    let (digits, exponent) = digits.split_once('p')?;
    let exponent: i32 = exponent.parse().ok()?;
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let significand = u64::from_str_radix(&format!("{whole}{fraction}"), 16).ok()?;
    assert!(significand < 1 << 53, "more digits than an f64 has: {digits}");
    let exponent = exponent - 4 * fraction.len() as i32;
    let half = exponent / 2;
    Some(significand as f64 * 2_f64.powi(half) * 2_f64.powi(exponent - half))
}

#[test]
fn notation_is_understood() {
    let file = "/* a\n[1] */ testcase a { // b\n f [-0x1.8P-1, INFINITY]_com 3 = [empty]_trv;\n }";
    let cases = parse(file);
    assert_eq!(cases.len(), 1);
    let bounds = Interval::new(-0.75, f64::INFINITY);
    let operands = vec![Term::Set(bounds, Some(Decoration::Dac)), Term::Integer(3)];
    assert_eq!((cases[0].name.as_str(), &cases[0].operands), ("f", &operands));
    assert_eq!(cases[0].result, Term::Set(None, Some(Decoration::Trv)));
    assert_eq!(hexadecimal("0.0000000000001p-1022"), Some(5e-324));
    assert_eq!(hexadecimal("1.fffffffffffffp1023"), Some(f64::MAX));
}
