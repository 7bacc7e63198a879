//! The suite must accept a correct kernel and reject each kind of false claim.

use super::*;
use crate::{Case, Claim, Defined, GraphOptions, Oracle};
use zeroset_eval::{
    Boxes, Enclose, EncloseGradient, Enclosures, GradientEnclosures, Gradients, LANES, Lanes,
    Points, Sample, SampleGradient, Values,
};
use zeroset_interval::Facts;
use zeroset_ops::Op;

const SEED: u64 = 0x5eed_0040;

struct ConstantKernel {
    lo: f32,
    hi: f32,
    facts: Facts,
}

impl Kernel<Enclose> for ConstantKernel {
    fn eval(&self, _: &Boxes, answers: &mut Enclosures) {
        let mask = |fact| if self.facts.has(fact) { u16::MAX } else { 0 };
        *answers = Enclosures {
            neg_lo: Lanes::splat(-self.lo),
            hi: Lanes::splat(self.hi),
            nowhere: mask(Facts::NOWHERE),
            defined: mask(Facts::DEFINED),
            continuous: mask(Facts::CONTINUOUS),
        };
    }
}

fn verdict(lo: f32, hi: f32, facts: Facts) -> Result<Tally, Failure> {
    let make = |_: &Graph, _: NodeId| -> Box<dyn Kernel<Enclose>> {
        Box::new(ConstantKernel { lo, hi, facts })
    };
    check_interval_ops(&make, SEED, 64)?;
    check_interval_graphs(&make, SEED, &GraphOptions::default(), 100, 16)
}

#[track_caller]
fn assert_fails(lo: f32, hi: f32, facts: Facts, reason: &str) {
    let failure = verdict(lo, hi, facts).expect_err(reason).to_string();
    assert!(failure.contains(reason), "{failure}");
    assert!(failure.contains("{\"f\":"), "{failure}");
}

#[test]
fn interval_lies_are_caught() {
    let (least, most) = (f32::NEG_INFINITY, f32::INFINITY);
    let tally = verdict(least, most, Facts::NONE).expect("claims nothing");
    assert!(tally.compared == 6400 && tally.defined > 2000, "{tally:?}");
    assert_fails(-1.0, 1.0, Facts::NONE, "the bounds miss");
    assert_fails(least, -1e30, Facts::NONE, "the bounds miss");
    assert_fails(1e30, most, Facts::NONE, "the bounds miss");
    assert_fails(least, most, Facts::NOWHERE, "called undefined");
    assert_fails(least, most, Facts::DEFINED, "called defined");
    assert_fails(least, most, Facts::CONTINUOUS, "called defined");
    assert_fails(f32::NAN, most, Facts::NONE, "NaN");
    assert_fails(most, most, Facts::NONE, "beyond all reals");
    assert_fails(1.0, 0.0, Facts::NONE, "not in order");
}

/// A kernel that evaluates points by the oracle, and then changes the values by `spoil`.
struct Sampler {
    graph: Graph,
    root: NodeId,
    spoil: fn(f64) -> f64,
}

impl Sampler {
    fn at(&self, point: [f64; 3]) -> f64 {
        let claim = Oracle::new(&self.graph, &[self.root]).at(point, &[])[0];
        match claim.defined {
            Defined::No => f64::NAN,
            Defined::Yes | Defined::Unknown => {
                (self.spoil)(claim.lo.max(f64::MIN) / 2.0 + claim.hi.min(f64::MAX) / 2.0)
            }
        }
    }
}

fn point(points: &Points, lane: usize) -> [f64; 3] {
    points.at.map(|axis| f64::from(axis[lane]))
}

impl Kernel<Sample> for Sampler {
    fn eval(&self, points: &Points, answers: &mut Values) {
        for lane in 0..LANES {
            answers.value[lane] = self.at(point(points, lane)) as f32;
        }
    }
}

impl Kernel<SampleGradient> for Sampler {
    fn eval(&self, points: &Points, answers: &mut Gradients) {
        for lane in 0..LANES {
            let here = point(points, lane);
            answers.value[lane] = self.at(here) as f32;
            for axis in 0..3 {
                // This step is smaller than the check's step, so it crosses no further kinks.
                let step = 1.0 / 262_144.0;
                let (mut before, mut after) = (here, here);
                before[axis] -= step;
                after[axis] += step;
                let slope = (self.at(after) - self.at(before)) / (2.0 * step);
                answers.gradient[axis][lane] = slope as f32;
            }
        }
    }
}

fn points(spoil: fn(f64) -> f64) -> Result<Tally, Failure> {
    let make = |graph: &Graph, root: NodeId| -> Box<dyn Kernel<Sample>> {
        let graph = graph.clone();
        Box::new(Sampler { graph, root, spoil })
    };
    let tolerance = |_, _, claim: Claim| {
        let size = claim.hi.abs().max(claim.lo.abs());
        Some((size * 1e-6).max(1e-38))
    };
    check_points(&make, SEED, 100, &tolerance)
}

#[test]
fn wrong_values_are_caught() {
    let tally = points(|value| value).unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 5000, "{tally:?}");
    for (spoil, reason) in [
        ((|_| f64::NAN) as fn(f64) -> f64, "no value where there is one"),
        (|value| value * 1.001, "too far off"),
        (|value| value + value.signum() * f64::INFINITY, "too far off"),
    ] {
        let failure = points(spoil).expect_err(reason).to_string();
        assert!(failure.contains(reason), "{failure}");
    }
    let make = |_: &Graph, _: NodeId| -> Box<dyn Kernel<Sample>> { Box::new(ZeroKernel) };
    let failure = check_points(&make, SEED, 100, &|_, _, _| None).expect_err("zero everywhere");
    assert!(failure.to_string().contains("a value where there is none"));
}

struct ZeroKernel;

impl Kernel<Sample> for ZeroKernel {
    fn eval(&self, _: &Points, _: &mut Values) {}
}

impl Kernel<SampleGradient> for ZeroKernel {
    fn eval(&self, _: &Points, _: &mut Gradients) {}
}

#[test]
fn wrong_gradients_are_caught() {
    let make = |graph: &Graph, root: NodeId| -> Box<dyn Kernel<SampleGradient>> {
        let graph = graph.clone();
        let spoil = |value| value;
        Box::new(Sampler { graph, root, spoil })
    };
    let tally = check_gradients(&make, SEED, 50, 1e-3).unwrap_or_else(|fail| panic!("{fail}"));
    assert!(tally.defined > 10_000, "{tally:?}");
    let make = |_: &Graph, _: NodeId| -> Box<dyn Kernel<SampleGradient>> { Box::new(ZeroKernel) };
    let failure = check_gradients(&make, SEED, 50, 1e-3).expect_err("no slope");
    assert!(failure.to_string().contains("derivative 0 is 0e0"), "{failure}");
}

#[derive(Clone, Copy)]
struct ConstantGradientKernel {
    range: [f32; 2],
    lipschitz: bool,
    differentiable: bool,
}

impl Kernel<EncloseGradient> for ConstantGradientKernel {
    fn eval(&self, _: &Boxes, answers: &mut GradientEnclosures) {
        let [lo, hi] = self.range;
        let mask = |claim| if claim { u16::MAX } else { 0 };
        *answers = GradientEnclosures {
            neg_lo: Lanes::splat(f32::INFINITY),
            hi: Lanes::splat(f32::INFINITY),
            gradient_neg_lo: [Lanes::splat(-lo); 3],
            gradient_hi: [Lanes::splat(hi); 3],
            lipschitz: mask(self.lipschitz),
            differentiable: mask(self.differentiable),
        };
    }
}

#[test]
fn lies_about_slopes_are_caught() {
    const ANY: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];
    let verdict = |range, lipschitz, differentiable| {
        let slope = ConstantGradientKernel { range, lipschitz, differentiable };
        let make = |_: &Case| -> Option<Box<dyn Kernel<EncloseGradient>>> { Some(Box::new(slope)) };
        check_slopes_of_ops(&make, SEED, 32)
    };
    let tally = verdict([1.0, 0.0], false, false).expect("claims nothing");
    assert!(tally.compared > 10_000 && tally.defined == 0, "{tally:?}");
    for (range, lipschitz, differentiable, reason) in [
        (ANY, false, true, "not Lipschitz continuous"),
        (ANY, true, false, "where undefined"),
        ([1.0, 0.0], true, false, "not in order"),
        ([0.0, 0.0], true, false, "slopes allow"),
        ([-1e30, -2.0], true, false, "slopes allow"),
    ] {
        let failure = verdict(range, lipschitz, differentiable).expect_err(reason).to_string();
        assert!(failure.contains(reason) && failure.contains("{\"f\":"), "{failure}");
    }
}

#[test]
fn wrong_rewrites_are_caught() {
    let run = |rewrite: Rewrite| check_rewrite(rewrite, SEED, &GraphOptions::default(), 500);
    let same = run(&|graph, root, _| Some((graph.clone(), root)));
    assert!(same.is_ok_and(|tally| tally.defined > 1000));
    let negated = run(&|graph, root, _| {
        let mut graph = graph.clone();
        let root = graph.apply(Op::Neg, &[root]);
        Some((graph, root))
    });
    let restricted = run(&|graph, root, _| {
        let mut graph = graph.clone();
        let root = graph.apply(Op::WherePositive, &[root, root]);
        Some((graph, root))
    });
    // A parameter without bounds contradicts no value. But it is defined everywhere.
    let total = run(&|_, _, _| {
        let mut graph = Graph::new();
        let root = graph.parameter(0);
        Some((graph, root))
    });
    for (verdict, reason) in [
        (negated, "another value"),
        (restricted, "no longer defined"),
        (total, "defined where it was not"),
    ] {
        let failure = verdict.expect_err(reason).to_string();
        assert!(failure.contains(reason), "{failure}");
    }
}
