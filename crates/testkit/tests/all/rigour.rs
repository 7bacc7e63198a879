//! Arithmetics that only measurements use. If results are rounded to nearest and then moved
//! outward, intervals and affine forms must enclose the oracle's values. If results are not moved,
//! they must miss some values.

use zeroset_eval::{Assumptions, Binding, Boxes, Enclose, Kernel, Real, Tape};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph, NodeId};
use zeroset_jit::comparison::{Arithmetic, ComparisonKernel};
use zeroset_ops::Op;
use zeroset_testkit::property::{
    ContractionTally, Engine, KernelOptions, check_contraction, compared_interval,
};
use zeroset_testkit::suite::{Failure, Tally, check_interval_cases, check_interval_ops};
use zeroset_testkit::{Adversarial, Case, Effort, GraphOptions, Rng};

fn alone<T: Real>(
    graph: &Graph,
    root: NodeId,
    arithmetic: Arithmetic,
) -> Box<dyn Kernel<Enclose, T>> {
    let tape = Tape::new(graph, &[root], &Assumptions::none(0));
    Box::new(ComparisonKernel::new(tape, Binding::empty(), arithmetic).expect("compiles"))
}

fn operations<T: Adversarial>(arithmetic: Arithmetic, seed: u64) -> Result<Tally, Failure> {
    println!("seed {seed:#x}");
    check_interval_ops::<T>(&|graph, root| alone(graph, root, arithmetic), seed, 2000)
}

#[test]
fn moved_results_of_every_operation_are_bounds() {
    for tally in [
        operations::<f32>(Arithmetic::Widened, 0x5eed_0c00),
        operations::<f64>(Arithmetic::Widened, 0x5eed_0c05),
    ] {
        let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
        assert!(tally.defined > 100_000, "{tally:?}");
    }
}

fn intervals<T: Adversarial>(arithmetic: Arithmetic, seed: u64) -> Result<Tally, Failure> {
    let effort = Effort::from_environment(seed, 100_000);
    let options = GraphOptions { size: 12, parameters: 1, ..GraphOptions::default() };
    let make = |case: &Case| compared_interval::<T>(case, arithmetic);
    let typical = GraphOptions { adversarial: false, ..options.clone() };
    let mut all = check_interval_cases::<T>(&make, effort, &typical)?;
    all.add(check_interval_cases::<T>(&make, effort, &options)?);
    Ok(all)
}

#[test]
fn moved_results_of_formulas_are_bounds() {
    for tally in [
        intervals::<f32>(Arithmetic::Widened, 0x5eed_0c10_0000),
        intervals::<f64>(Arithmetic::Widened, 0x5eed_0c20_0000),
    ] {
        println!("{:?}", tally.unwrap_or_else(|failure| panic!("{failure}")));
    }
}

fn forms<T: Adversarial>(arithmetic: Arithmetic, seed: u64) -> Result<ContractionTally, Failure> {
    let effort = Effort::from_environment(seed, 20_000);
    let mut all = ContractionTally::default();
    for seed in effort.seed.. {
        if all.planes >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let adversarial = rng.bool();
        let size = rng.u32(1..=16);
        let options = GraphOptions { size, adversarial, parameters: 1, ..GraphOptions::default() };
        let case = Case::random(&mut rng, &options);
        let kernel_options =
            KernelOptions { simple: rng.bool(), engine: Engine::ComparisonKernel(arithmetic) };
        all.add(check_contraction::<T>(kernel_options, &case, &mut rng, 4)?);
    }
    Ok(all)
}

#[test]
fn moved_results_make_forms_that_hold_their_values() {
    for all in [
        forms::<f32>(Arithmetic::Widened, 0x5eed_0c30_0000),
        forms::<f64>(Arithmetic::Widened, 0x5eed_0c40_0000),
    ] {
        let all = all.unwrap_or_else(|failure| panic!("{failure}"));
        println!("{all:?}");
        assert!(all.roots > 0 && all.narrowed > 0 && all.crossings > 0, "{all:?}");
    }
}

/// Shows that the cheapest arithmetic is not rigorous.
#[test]
fn results_that_are_not_moved_are_no_bounds() {
    let unsound = Arithmetic::Unsound;
    assert!(operations::<f32>(unsound, 0x5eed_0c50).is_err());
    assert!(operations::<f64>(unsound, 0x5eed_0c55).is_err());
    assert!(intervals::<f32>(unsound, 0x5eed_0c60_0000).is_err());
    assert!(intervals::<f64>(unsound, 0x5eed_0c70_0000).is_err());
    assert!(forms::<f32>(unsound, 0x5eed_0c80_0000).is_err());
    assert!(forms::<f64>(unsound, 0x5eed_0c90_0000).is_err());
}

/// The product of 3 and the float nearest to 1/3 is exactly 1 + 2⁻²⁵, which is not a float.
#[test]
fn a_product_is_missed_kept_by_two_floats_or_by_two_neighbours() {
    let third = 1.0_f32 / 3.0;
    let mut graph = Graph::new();
    let [x, y, _] = Axis::ALL.map(|axis| graph.variable(axis));
    let root = graph.apply(Op::Mul, &[x, y]);
    let at = [f64::from(third), 3.0, 0.0].map(|x| Interval { lo: x, hi: x });
    let exact = f64::from(third) * 3.0;
    let ends = |arithmetic| {
        let answer = &alone::<f32>(&graph, root, arithmetic).eval_all(&Boxes::around(&[at]))[0];
        [-answer.neg_lo[0], answer.hi[0]]
    };
    let [lo, hi] = ends(Arithmetic::Unsound);
    assert!(lo == hi && f64::from(lo) != exact, "{lo:e} {hi:e}, exactly {exact:e}");
    assert_eq!(ends(Arithmetic::Widened), [lo.next_down(), lo.next_up()]);
    let up = ends(Arithmetic::Upward);
    assert!(f64::from(up[0]) < exact && exact < f64::from(up[1]) && up[0].next_up() == up[1]);
}
