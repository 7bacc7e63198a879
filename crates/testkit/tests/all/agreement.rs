//! Native code must give the same bits as the reference evaluator, in both precisions. The inputs
//! are random graphs with parameters, as typed and simplified, over all of space and over boxes.
//!
//! A long run:
//! `ZEROSET_CASES=100000000 cargo test --release -p zeroset-testkit --test all agreement`.

use zeroset_ir::Node;
use zeroset_ops::{Op, TABLE};
use zeroset_testkit::property::{KernelKind, agree};
use zeroset_testkit::{Adversarial, Case, Effort, GraphOptions, Rng, count_claims};

/// Returns the number of inputs per kernel. A short test has few, so that it checks many formulas.
/// A long run has so many that compiling is a small part of the work.
fn inputs(cases: u64) -> usize {
    if cases <= 1_000_000 { 256 } else { 1024 }
}

/// Prints the current case's seed if a test panics.
struct SeedReporter(u64);

impl Drop for SeedReporter {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("ZEROSET_SEED={:#x} ZEROSET_CASES=1", self.0);
        }
    }
}

/// Compares until `effort.cases` inputs agree. Panics on the first input that does not agree.
fn check<T: Adversarial>(seed: u64, subject: KernelKind, simple: bool, options: &GraphOptions) {
    let effort = Effort::from_environment(
        seed,
        match subject {
            // Affine forms have longer code, and few formulas have branches.
            KernelKind::Segments | KernelKind::Tiles | KernelKind::Branches => 6_000,
            _ => 15_000,
        },
    );
    let mut compared = 0;
    for seed in effort.seed.. {
        if compared >= effort.cases {
            break;
        }
        let _reporter = SeedReporter(seed);
        let mut rng = Rng::with_seed(seed);
        let case = Case::random(&mut rng, options);
        match agree::<T>(subject, simple, &case, &mut rng, inputs(effort.cases)) {
            Ok(tally) => compared += tally.compared,
            Err(failure) => panic!("{failure}"),
        }
    }
    println!("{compared} inputs agree");
    count_claims(compared);
}

fn options() -> GraphOptions {
    GraphOptions { size: 8, parameters: 2, ..GraphOptions::default() }
}

/// Returns options for formulas that are differentiated. They are shorter, since derivatives grow.
fn short() -> GraphOptions {
    GraphOptions { size: 4, ..options() }
}

/// Checks adversarial formulas, then typical ones, each as typed and simplified.
fn check_all<T: Adversarial>(
    seed: u64,
    subject: KernelKind,
    [adversarial, typical]: [&GraphOptions; 2],
) {
    let typical = GraphOptions { adversarial: false, ..typical.clone() };
    check::<T>(seed, subject, false, adversarial);
    check::<T>(seed + 0x10_0000, subject, true, adversarial);
    check::<T>(seed + 0x20_0000, subject, false, &typical);
    check::<T>(seed + 0x30_0000, subject, true, &typical);
}

fn long() -> GraphOptions {
    GraphOptions { size: 16, ..options() }
}

/// Inputs of each query for each operation, in each precision: the random formulas of a short run
/// need not hold all operations.
const INPUTS_OF_OPERATION: usize = 32;

#[test]
fn every_operation_agrees_for_every_query() {
    every_operation_agrees::<f32>(0x5eed_0880_0000);
    every_operation_agrees::<f64>(0x5eed_08c0_0000);
}

/// Returns a random case whose function applies `op`, not one that was folded to a constant.
fn applied(op: Op, options: &GraphOptions, rng: &mut Rng) -> Case {
    let is_applied =
        |case: &Case| matches!(case.graph.node(case.root), Node::Apply(of, _) if *of == op);
    std::iter::repeat_with(|| Case::random(rng, options)).find(is_applied).expect("endless")
}

fn every_operation_agrees<T: Adversarial>(seed: u64) {
    println!("seed {seed:#x}");
    let mut rng = Rng::with_seed(seed);
    let (mut lanes, mut branches) = (0, 0);
    for row in TABLE {
        let options = GraphOptions { size: 1, ops: vec![row.op], ..GraphOptions::default() };
        for subject in KernelKind::ALL {
            let case = applied(row.op, &options, &mut rng);
            match agree::<T>(subject, false, &case, &mut rng, INPUTS_OF_OPERATION) {
                Err(failure) => panic!("{}: {failure}", row.name),
                Ok(tally) if subject == KernelKind::Branches => branches += tally.compared,
                Ok(tally) => {
                    assert!(tally.compared > 0, "{}: {subject:?}", row.name);
                    lanes += tally.compared;
                }
            }
        }
    }
    println!("{lanes} inputs agree, {branches} of branches");
    assert!(branches > 0, "some operations jump");
}

#[test]
fn bounds_agree() {
    check_all::<f32>(0x5eed_0400_0000, KernelKind::Bounds, [&options(), &long()]);
    check_all::<f64>(0x5eed_0440_0000, KernelKind::Bounds, [&options(), &long()]);
}

#[test]
fn zeros_agree() {
    check_all::<f32>(0x5eed_0480_0000, KernelKind::Zeros, [&options(), &long()]);
    check_all::<f64>(0x5eed_04c0_0000, KernelKind::Zeros, [&options(), &long()]);
}

#[test]
fn zeros_by_branches_agree() {
    check_all::<f32>(0x5eed_0680_0000, KernelKind::Branches, [&options(), &long()]);
    check_all::<f64>(0x5eed_06c0_0000, KernelKind::Branches, [&options(), &long()]);
}

#[test]
fn values_agree() {
    check_all::<f32>(0x5eed_0500_0000, KernelKind::Values, [&options(), &long()]);
    check_all::<f64>(0x5eed_0540_0000, KernelKind::Values, [&options(), &long()]);
}

#[test]
fn gradients_agree() {
    check_all::<f32>(0x5eed_0600_0000, KernelKind::Gradients, [&short(), &options()]);
    check_all::<f64>(0x5eed_0640_0000, KernelKind::Gradients, [&short(), &options()]);
}

#[test]
fn forward_gradients_agree() {
    check_all::<f32>(0x5eed_0800_0000, KernelKind::Forward, [&short(), &options()]);
    check_all::<f64>(0x5eed_0840_0000, KernelKind::Forward, [&short(), &options()]);
}

#[test]
fn gradient_bounds_agree() {
    check_all::<f32>(0x5eed_0580_0000, KernelKind::GradientBounds, [&short(), &options()]);
    check_all::<f64>(0x5eed_05c0_0000, KernelKind::GradientBounds, [&short(), &options()]);
}

#[test]
fn segments_agree() {
    check_all::<f32>(0x5eed_0700_0000, KernelKind::Segments, [&options(), &long()]);
    check_all::<f64>(0x5eed_0740_0000, KernelKind::Segments, [&options(), &long()]);
}

#[test]
fn tiles_agree() {
    check_all::<f32>(0x5eed_0780_0000, KernelKind::Tiles, [&short(), &options()]);
    check_all::<f64>(0x5eed_07c0_0000, KernelKind::Tiles, [&short(), &options()]);
}
