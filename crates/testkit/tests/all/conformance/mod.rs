//! Conformance with IEEE 1788: the test vectors of ITF1788, for software intervals in `f64` and
//! native kernels in `f32` and `f64`.
//!
//! Every enclosure must contain the tightest one. `tests/data/itl/report.txt` lists how much wider
//! enclosures are. The test fails if its report differs from this file.
//! `ZEROSET_BLESS=1 cargo test -p zeroset-testkit --test all conformance` rewrites the file.

mod function;
mod itl;
mod tally;

use function::{Function, KnownDomain, Native, QueryResult, function, outward, value_of};
use itl::{Decoration, Term, TestCase, parse};
use std::fmt::Write;
use std::path::PathBuf;
use tally::{EvaluatorTally, Ulp, Verdict, judge};
use zeroset_eval::Real;
use zeroset_interval::{Facts, Interval};

/// Operations whose enclosures must be the tightest: in software, and natively for finite operands.
const TIGHTEST: [&str; 15] = [
    "neg", "add", "sub", "mul", "div", "recip", "sqr", "sqrt", "abs", "sign", "floor", "ceil",
    "trunc", "min", "max",
];
const ROUND: &str = "roundTiesToEven";

/// Enclosures up to this number of ulps wider than the tightest are counted, but not listed. For
/// the operations of `TIGHTEST`, every excess is listed.
const UNREMARKABLE: u64 = 64;

fn is_tightest(name: &str) -> bool {
    TIGHTEST.contains(&name) || name == ROUND
}

fn data() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/itl")
}

/// A case that can be run: its function, and those of its operands that are intervals or empty.
struct RunnableCase<'a> {
    case: &'a TestCase,
    function: Function,
    operands: Vec<(Option<Interval>, Option<Decoration>)>,
    result: Option<Interval>,
    decoration: Option<Decoration>,
}

impl<'a> RunnableCase<'a> {
    fn new(case: &'a TestCase) -> Result<Self, &'static str> {
        let function = function(&case.name, &case.operands)?;
        let mut operands = Vec::new();
        for operand in &case.operands {
            match operand {
                Term::Set(bounds, decoration) => operands.push((*bounds, *decoration)),
                Term::Integer(_) => {}
                Term::Nai => return Err("there is no NaI"),
            }
        }
        let Term::Set(result, decoration) = case.result else {
            return Err("there is no NaI");
        };
        Ok(Self { case, function, operands, result, decoration })
    }

    fn bounds(&self) -> Vec<Option<Interval>> {
        self.operands.iter().map(|(bounds, _)| *bounds).collect()
    }

    /// Counts a result, lists it if its excess is large, and checks its facts.
    fn record(
        &self,
        answer: QueryResult,
        tightest: Option<Interval>,
        ulp: Ulp,
        tally: &mut EvaluatorTally,
    ) {
        let name = &self.case.name;
        let verdict = judge(answer, tightest, ulp)
            .unwrap_or_else(|violation| panic!("{}: {violation}", self.case.text));
        tally.count(name, verdict);
        let remarkable = match verdict {
            Verdict::Tight => false,
            Verdict::Wider(ulps) => is_tightest(name) || ulps > UNREMARKABLE,
            Verdict::Unbounded | Verdict::Unproven => true,
        };
        if remarkable {
            let unbounded = self.bounds().iter().flatten().any(|bounds| !bounds.is_bounded());
            let kind = if unbounded { "infinite" } else { "finite" };
            tally.loose += u64::from(is_tightest(name) && !unbounded);
            let QueryResult { bounds, .. } = answer;
            let shown = if answer.facts.has(Facts::NOWHERE) {
                "[empty]".to_owned()
            } else {
                format!("[{:e}, {:e}]", bounds.lo, bounds.hi)
            };
            tally.list(format!("{kind:9} {verdict:?}: {}; ours {shown}", self.case.text));
        }
        if let (Some(expected), Some(_)) = (self.decoration, self.result) {
            let ours = Decoration::of(answer.facts);
            tally.decorate(name, ours, expected);
            if ours > expected {
                tally.list(format!("stronger  {ours:?}: {}", self.case.text));
            }
        }
    }
}

fn in_software(cases: &[TestCase]) -> EvaluatorTally {
    let mut tally = EvaluatorTally::default();
    for case in cases {
        match RunnableCase::new(case) {
            Err(reason) => tally.skip(&case.name, reason),
            Ok(runnable) => {
                let operands: Vec<_> =
                    runnable.operands.iter().map(|(set, dec)| value_of(*set, *dec)).collect();
                let answer = runnable.function.fold(&operands);
                runnable.record(answer, runnable.result, Ulp::F64, &mut tally);
            }
        }
    }
    tally
}

fn natively<T: Real>(cases: &[TestCase], known_domain: KnownDomain, ulp: Ulp) -> EvaluatorTally {
    let mut native = Native::<T>::new(known_domain);
    let mut tally = EvaluatorTally::default();
    for case in cases {
        let runnable = match RunnableCase::new(case) {
            Ok(runnable) => runnable,
            Err(reason) => {
                tally.skip(&case.name, reason);
                continue;
            }
        };
        let is_total = |(set, dec): &(Option<Interval>, Option<Decoration>)| {
            set.is_none() || dec.is_none_or(|dec| dec == Decoration::Dac)
        };
        if !runnable.operands.iter().all(is_total) {
            tally.skip(&case.name, "operands of a kernel are defined and continuous");
            continue;
        }
        let exact = runnable.bounds();
        let widened: Vec<_> = exact.iter().map(|set| set.map(outward::<T>)).collect();
        let exponent = case.operands.iter().find(|operand| matches!(operand, Term::Integer(_)));
        let key = format!("{} {exponent:?}", case.name);
        let answer = native.enclose(&key, &runnable.function, &widened);
        if exact == widened {
            runnable.record(answer, runnable.result.map(outward::<T>), ulp, &mut tally);
            continue;
        }
        // The operands were widened to floats, so the enclosure may be wider than the case's
        // result. For operations of `TIGHTEST`, software gives the tightest enclosure of the
        // widened operands.
        if let Err(violation) = judge(answer, runnable.result, ulp) {
            panic!("{} natively: {violation}", case.text);
        }
        if is_tightest(&case.name) {
            let operands: Vec<_> = widened.iter().map(|set| value_of(*set, None)).collect();
            let QueryResult { bounds, facts } = runnable.function.fold(&operands);
            let tightest = (!facts.has(Facts::NOWHERE)).then(|| outward::<T>(bounds));
            let wider = RunnableCase { decoration: None, ..runnable };
            wider.record(answer, tightest, ulp, &mut tally);
        } else {
            tally.contain(&case.name);
        }
    }
    tally
}

#[test]
fn every_enclosure_holds_and_is_as_wide_as_reported() {
    let files = ["libieeep1788_elem.itl", "atan2.itl"];
    let cases: Vec<TestCase> = files
        .iter()
        .flat_map(|name| parse(&std::fs::read_to_string(data().join(name)).expect(name)))
        .collect();
    assert!(cases.len() > 3500, "only {} cases", cases.len());
    let software = in_software(&cases);
    let natives = [
        (
            "f32, nothing known of the operands",
            natively::<f32>(&cases, KnownDomain::Nothing, Ulp::F32),
        ),
        ("f32, compiled for the very box", natively::<f32>(&cases, KnownDomain::TheBox, Ulp::F32)),
        (
            "f64, nothing known of the operands",
            natively::<f64>(&cases, KnownDomain::Nothing, Ulp::F64),
        ),
        ("f64, compiled for the very box", natively::<f64>(&cases, KnownDomain::TheBox, Ulp::F64)),
    ];
    let mut report = String::new();
    let _ = writeln!(
        report,
        "ITF1788 vectors: {} cases, no enclosure that fails to hold the exact range.\n\n\
         Columns: an end is at most so many floats too far out; `unbounded`: an end is infinite that need not be;\n\
         `not empty`: a result not known to be empty; `contained`: operands are no floats and the tightest result over\n\
         widened ones is not known; `dec.`: facts against the expected decoration, `com` counting as `dac`.\n\
         Listed below each table: what is not the tightest, up to {UNREMARKABLE} ulp of elementary functions apart.\n",
        cases.len(),
    );
    software.write("Software intervals, f64", &mut report);
    for (what, tally) in &natives {
        tally.write(&format!("Native kernels, {what}"), &mut report);
    }
    let path = data().join("report.txt");
    if std::env::var_os("ZEROSET_BLESS").is_some() {
        std::fs::write(&path, &report).expect("the report can be written");
    }
    for tally in natives.iter().map(|(_, tally)| tally).chain([&software]) {
        assert_eq!(tally.stronger(), 0, "claims more than the standard allows");
        assert_eq!(tally.loose, 0, "wider on finite operands: see the report");
    }
    assert_eq!(software.wider(&TIGHTEST) + software.wider(&[ROUND]), 0, "see the report");
    let committed = std::fs::read_to_string(&path).expect("a report");
    let difference = report.lines().zip(committed.lines()).find(|(now, then)| now != then);
    assert!(report == committed, "{}: {difference:?}; ZEROSET_BLESS=1 rewrites it", path.display());
}
