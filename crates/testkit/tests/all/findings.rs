//! Regression tests: formulas for which a property failed, each with the box that showed it. Long
//! runs and fuzzers found them.

use zeroset_eval::{Binding, Enclose, Enclosures, Kernel, Reference, Tape};
use zeroset_interval::Interval;
use zeroset_ir::simplify;
use zeroset_syntax::{Options, read};
use zeroset_testkit::property::native_interval;
use zeroset_testkit::{Adversarial, Case, pack_boxes};

const ENTIRE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// A formula, the domain that its code may assume, a box, and a description of the failure.
struct Finding {
    formula: &'static str,
    domain: [[f64; 2]; 3],
    region: [[f64; 2]; 3],
    /// Range in which the formula's bounds must lie, even where the formula is undefined.
    /// Operations on these bounds may rely on that.
    within: [f64; 2],
    was: &'static str,
}

const FINDINGS: [Finding; 6] = [
    Finding {
        formula: "mod(-1.4490664005279541015625/3*z, z)",
        domain: [ENTIRE; 3],
        region: [[0.0; 2], [0.0; 2], [f64::MAX; 2]],
        within: [0.0, f64::INFINITY],
        was: "a sum of software f64 near overflow was not rounded up",
    },
    Finding {
        formula: "sin(mod(x^2, y))",
        domain: [ENTIRE, [-1.0, 0.0], ENTIRE],
        region: [[368_889_152.0, 368_889_184.0], [-0.0, 0.0], [0.0; 2]],
        within: [-1.0, 1.0],
        was: "the sine of a remainder by 0 had bounds beyond all reals",
    },
    Finding {
        formula: "mod(x^2, y)",
        domain: [ENTIRE, [-1.0, 0.0], ENTIRE],
        region: [[368_889_152.0, 368_889_184.0], [-0.0, 0.0], [0.0; 2]],
        within: [-0.0, 0.0],
        was: "a remainder by 0 had bounds outside its range",
    },
    Finding {
        formula: "x^(-2147483648)",
        domain: [ENTIRE; 3],
        region: [[-1.0; 2], [0.0; 2], [0.0; 2]],
        within: [1.0, 1.0],
        was: "an even exponent without an opposite became odd",
    },
    Finding {
        formula: "atan2(mod(-3, 1), acos(x))",
        domain: [ENTIRE; 3],
        region: [[2.29, 2.31], [0.0; 2], [0.0; 2]],
        within: [0.0, 0.0],
        was: "the angle of the origin had bounds outside its range",
    },
    Finding {
        formula: "acos(atan2(mod(-3, 1), acos(x)))",
        domain: [ENTIRE; 3],
        region: [[2.29, 2.31], [0.0; 2], [0.0; 2]],
        within: [1.57, 1.58],
        was: "and a bound of what was computed from it was NaN",
    },
];

fn case(finding: &Finding) -> Case {
    let document = read(finding.formula, &Options::default()).expect("reads");
    let domain = finding.domain.map(|[lo, hi]| Interval { lo, hi });
    Case {
        root: document.surfaces[0].root,
        graph: document.graph,
        assumptions: zeroset_eval::Assumptions { domain, parameters: Vec::new() },
        parameters: Vec::new(),
    }
}

/// Returns native and reference bounds of a case over a box.
fn bounds<T: Adversarial>(case: &Case, region: [[f64; 2]; 3]) -> [Enclosures<T>; 2] {
    let round = |end: f64| T::nearest(end.clamp(-T::LARGEST.into(), T::LARGEST.into()));
    let boxes = pack_boxes(&[region.map(|range| range.map(round))]);
    let native = native_interval::<T>(case).expect("small");
    let domain = &case.assumptions.domain;
    let (graph, roots) = simplify(&case.graph, &[case.root], domain, &[]).expect("small");
    let tape = Tape::new(&graph, &roots, &case.assumptions);
    let reference = Reference::<Enclose, T>::new(tape, Binding::empty());
    [native.eval_all(&boxes).remove(0), reference.eval_all(&boxes).remove(0)]
}

fn check<T: Adversarial>(finding: &Finding) {
    let [native, reference] = bounds::<T>(&case(finding), finding.region);
    let what = format!("{:?}, {}: {native:?}\n{reference:?}", finding.formula, finding.was);
    let ends = |answer: &Enclosures<T>| [answer.neg_lo[0], answer.hi[0]].map(Into::into);
    let (these, those): ([f64; 2], [f64; 2]) = (ends(&native), ends(&reference));
    assert_eq!(these, those, "{what}");
    let [neg_lo, hi] = these;
    let [least, most] = finding.within;
    assert!(-neg_lo <= hi && -neg_lo >= least && hi <= most, "{what}");
}

#[test]
fn what_was_found_stays_fixed() {
    for finding in &FINDINGS {
        check::<f32>(finding);
        check::<f64>(finding);
    }
}
