//! Comparison of enclosures with the tightest ones, counted by operation and written as a table.

use super::function::QueryResult;
use super::itl::Decoration;
use std::collections::BTreeMap;
use std::fmt::Write;
use zeroset_interval::{Facts, Interval};

/// The float type whose ulps are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ulp {
    F32,
    F64,
}

impl Ulp {
    /// Returns the number of floats from one number to another.
    fn between(self, a: f64, b: f64) -> u64 {
        let signed = |negative, magnitude: i64| if negative { -magnitude } else { magnitude };
        let place = |x: f64| match self {
            Self::F32 => {
                let x = x as f32;
                signed(x.is_sign_negative(), i64::from(x.to_bits() & (u32::MAX >> 1)))
            }
            Self::F64 => signed(x.is_sign_negative(), (x.to_bits() & (u64::MAX >> 1)) as i64),
        };
        let (a, b) = (place(a), place(b));
        a.abs_diff(b)
    }
}

/// Comparison of an enclosure with the tightest one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The result is the tightest, or correctly proven empty.
    Tight,
    /// The worse end is too far out by this number of floats.
    Wider(u64),
    /// An end is infinite although a finite one is possible.
    Unbounded,
    /// The tightest result is empty, but the evaluator does not prove that.
    Unproven,
}

/// Compares a result with the tightest enclosure. An error says why the result is wrong.
pub fn judge(answer: QueryResult, tightest: Option<Interval>, ulp: Ulp) -> Result<Verdict, String> {
    let nowhere = answer.facts.has(Facts::NOWHERE);
    let Some(tightest) = tightest else {
        return Ok(if nowhere { Verdict::Tight } else { Verdict::Unproven });
    };
    if nowhere || !answer.bounds.encloses(tightest) {
        return Err(format!("{answer:?} does not hold {tightest:?}"));
    }
    let ends =
        [(answer.bounds.lo, tightest.lo), (answer.bounds.hi, tightest.hi)].map(|(ours, best)| {
            let ulps = ulp.between(ours, best);
            (ulps, ours.is_infinite() && ulps > 1)
        });
    Ok(match ends[0].0.max(ends[1].0) {
        0 => Verdict::Tight,
        _ if ends[0].1 || ends[1].1 => Verdict::Unbounded,
        ulps => Verdict::Wider(ulps),
    })
}

const WIDTHS: [(u64, &str); 5] =
    [(1, "1 ulp"), (2, "2"), (4, "3-4"), (64, "5-64"), (u64::MAX, "more")];

#[derive(Default)]
struct OperationTally {
    cases: u64,
    tight: u64,
    wider: [u64; WIDTHS.len()],
    unbounded: u64,
    unproven: u64,
    contained: u64,
    skipped: u64,
    decorations: [u64; 3],
}

/// Counts for one evaluator.
#[derive(Default)]
pub struct EvaluatorTally {
    rows: BTreeMap<String, OperationTally>,
    skipped: BTreeMap<String, u64>,
    listed: Vec<String>,
    /// Number of results for finite operands that should be the tightest but are not.
    pub loose: u64,
}

impl EvaluatorTally {
    fn row(&mut self, name: &str) -> &mut OperationTally {
        let row = self.rows.entry(name.to_owned()).or_default();
        row.cases += 1;
        row
    }

    pub fn skip(&mut self, name: &str, reason: &str) {
        self.row(name).skipped += 1;
        *self.skipped.entry(format!("{name}: {reason}")).or_default() += 1;
    }

    /// Counts a case in which only the containment of the result was checked.
    pub fn contain(&mut self, name: &str) {
        self.row(name).contained += 1;
    }

    pub fn count(&mut self, name: &str, verdict: Verdict) {
        let row = self.row(name);
        match verdict {
            Verdict::Tight => row.tight += 1,
            Verdict::Wider(ulps) => {
                let column = WIDTHS.iter().position(|(most, _)| ulps <= *most);
                row.wider[column.expect("the last column is for all")] += 1;
            }
            Verdict::Unbounded => row.unbounded += 1,
            Verdict::Unproven => row.unproven += 1,
        }
    }

    /// Counts whether the evaluator's decoration equals the expected one, is weaker or is stronger.
    pub fn decorate(&mut self, name: &str, ours: Decoration, expected: Decoration) {
        let row = self.rows.get_mut(name).expect("counted before");
        row.decorations[match ours.cmp(&expected) {
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Less => 1,
            std::cmp::Ordering::Greater => 2,
        }] += 1;
    }

    pub fn list(&mut self, line: String) {
        self.listed.push(line);
    }

    /// Number of cases of these operations whose enclosure is not the tightest.
    pub fn wider(&self, names: &[&str]) -> u64 {
        let rows = self.rows.iter().filter(|(name, _)| names.contains(&name.as_str()));
        let sum =
            |row: &OperationTally| row.wider.iter().sum::<u64>() + row.unbounded + row.unproven;
        rows.map(|(_, row)| sum(row)).sum()
    }

    /// Number of decorations that are stronger than the standard allows.
    pub fn stronger(&self) -> u64 {
        self.rows.values().map(|row| row.decorations[2]).sum()
    }

    /// Writes the table, then the skipped cases with reasons, then the listed cases.
    pub fn write(&self, title: &str, to: &mut String) {
        let mut heads = vec!["cases", "tight"];
        heads.extend(WIDTHS.map(|(_, head)| head));
        heads.extend(["unbounded", "not empty", "contained", "skipped", "dec. same", "weaker"]);
        let mut lines = vec![format!("{title}\n"), format!("{:16}", "operation")];
        for head in &heads {
            let _ = write!(lines[1], "{head:>10}");
        }
        let mut sums = vec![0; heads.len()];
        for (name, row) in &self.rows {
            let mut cells = vec![row.cases, row.tight];
            cells.extend(row.wider);
            cells.extend([row.unbounded, row.unproven, row.contained, row.skipped]);
            cells.extend(&row.decorations[..2]);
            sums.iter_mut().zip(&cells).for_each(|(sum, cell)| *sum += cell);
            lines.push(cells.iter().fold(format!("{name:16}"), |line, cell| line + &shown(*cell)));
        }
        lines.push(sums.iter().fold(format!("{:16}", "all"), |line, cell| line + &shown(*cell)));
        lines.push(String::new());
        lines.extend(self.skipped.iter().map(|(why, count)| format!("skipped {count:5}  {why}")));
        lines.push(String::new());
        lines.extend(self.listed.iter().cloned());
        for line in lines {
            to.push_str(line.trim_end());
            to.push('\n');
        }
        to.push('\n');
    }
}

fn shown(count: u64) -> String {
    if count == 0 { format!("{:>10}", ".") } else { format!("{count:>10}") }
}
