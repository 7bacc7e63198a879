//! Kernels that find zeros. If they evaluate a piecewise function's branches one by one, they must
//! lose no zero, and native code must give the same bits as the reference. Without branches, they
//! must agree with the bounds of the same tape.
//!
//! The functions are f − f(p) for a random point p of a box, so each has a zero in the box.
//!
//! A long run: `ZEROSET_CASES=10000000 cargo test --release -p zeroset-testkit --test all
//! branches`.

use std::convert::Infallible;
use zeroset_eval::{
    Assumptions, Binding, Boxes, BranchTest, Enclose, FindZeros, FindZerosInBranch, Kernel, LANES,
    Real, Reference, Tape,
};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{clear, rewrite, simplify};
use zeroset_jit::{Compiled, Native};
use zeroset_ops::{Class, Continuity, Op, TABLE};
use zeroset_testkit::property::KernelKind;
use zeroset_testkit::{
    Adversarial, Case, Defined, Effort, GraphOptions, Oracle, Place, Rng, count_claims,
    hexadecimal, pack_boxes,
};

/// Points checked for each case, each in a box of its own.
const POINTS: usize = 16;

/// Returns a case's function minus a new parameter, which is numbered after all others.
fn shifted(case: &Case) -> Case {
    let mut shifted = case.clone();
    let value = shifted.graph.parameter(case.assumptions.parameters.len() as u32);
    shifted.root = shifted.graph.apply(Op::Sub, &[case.root, value]);
    shifted.assumptions.parameters.push(Interval::ENTIRE);
    shifted
}

/// Returns the tape that finds a case's zeros branch by branch, built as in programs, and the tape
/// of the function alone.
fn tapes<T: Real>(case: &Case) -> Option<(Tape<T>, Tape<T>)> {
    let Assumptions { domain, parameters } = &case.assumptions;
    let (mut graph, roots) = rewrite(&case.graph, &[case.root], domain, parameters).ok()?;
    let mut typed = vec![roots[0]];
    typed.extend(clear(&mut graph, roots[0]).map(|cleared| cleared.numerator));
    let (graph, roots) = simplify(&graph, &typed, domain, parameters).ok()?;
    let branches = Tape::branches(&graph, &roots, &case.assumptions)?;
    Some((branches, Tape::new(&graph, &roots[..1], &case.assumptions)))
}

/// Returns options for graphs of operations that jump or have poles, with some arithmetic. Now and
/// then all operations are used.
fn options(rng: &mut Rng) -> GraphOptions {
    let ops = TABLE.iter().filter(|row| match row.class {
        Class::Quotient | Class::Power | Class::Sum | Class::Product | Class::Extremum => true,
        _ => row.continuity == Continuity::Jumps,
    });
    let ops: Vec<Op> = ops.map(|row| row.op).collect();
    let plain = GraphOptions { size: rng.u32(1..10), parameters: 1, ..GraphOptions::default() };
    match rng.u32(0..8) {
        0 => plain,
        1 | 2 => GraphOptions { ops, ..plain },
        _ => GraphOptions { ops, adversarial: false, ..plain },
    }
}

/// Whether a kernel finds a zero possible in the only box of `boxes`.
fn is_possible<T: Real>(kernel: &dyn Kernel<FindZeros, T>, boxes: &[Boxes<T>]) -> bool {
    kernel.eval_all(boxes)[0].possible & 1 == 1
}

/// Whether the only box of `boxes` is proven empty branch by branch, by kernels that `bind` makes.
/// `values` are those of a case's parameters, the last that of the parameter which is subtracted.
fn is_empty<T: Real, K: Kernel<FindZerosInBranch, T> + 'static>(
    values: &[Interval],
    is_solid: bool,
    bind: impl Fn(Binding<T>) -> K,
    boxes: &[Boxes<T>],
) -> bool {
    let bind = |binding| Ok::<_, Infallible>(Box::new(bind(binding)) as Box<_>);
    let Ok(test) = BranchTest::new(values, is_solid, bind);
    test.proven_empty(&boxes[0], 1) == 1
}

#[test]
fn no_zero_is_lost_and_native_code_agrees() {
    check::<f32>(0x5eed_0900_0000, 30_000);
}

#[test]
fn no_zero_is_lost_and_native_code_agrees_in_f64() {
    check::<f64>(0x5eed_0910_0000, 15_000);
}

fn check<T: Adversarial>(seed: u64, cases: u64) {
    let effort = Effort::from_environment(seed, cases);
    let (mut points, mut shut, mut cases, mut boundaries) = (0, 0, 0, 0);
    for seed in effort.seed.. {
        if points >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let options = options(&mut rng);
        let case = Case::random(&mut rng, &options);
        let Some((branches, plain)) = tapes::<T>(&shifted(&case)) else { continue };
        let oracle = Oracle::new(&case.graph, &[case.root]);
        let values: Vec<(f64, f64)> = case.parameters.iter().map(|v| (v.lo, v.hi)).collect();
        let mut native: Option<Compiled<FindZerosInBranch, T>> = None;
        cases += 1;
        for _ in 0..POINTS {
            let region: [[T; 2]; 3] = case.random_box(&mut rng);
            let boxes = pack_boxes(&[region]);
            let mut compare = |value: Interval, is_solid: bool| {
                let code = native
                    .get_or_insert_with(|| Compiled::new(branches.clone()).expect("compiles"));
                let known: Vec<_> = case.parameters.iter().copied().chain([value]).collect();
                let answer = is_empty(&known, is_solid, |binding| code.bind(binding), &boxes);
                let reference = |binding| Reference::new(branches.clone(), binding);
                let expected = is_empty(&known, is_solid, reference, &boxes);
                let context = || {
                    let line = case.describe::<T>(&Place::over(&region));
                    format!(
                        "{line}\nless {value:?}, solid {is_solid}\n\
                         ZEROSET_SEED={seed:#x} ZEROSET_CASES=1"
                    )
                };
                assert!(answer == expected, "the bits differ, native {answer}: {}", context());
                (answer, context())
            };
            let mut sides: Vec<Interval> = Vec::new();
            for _ in 0..2 {
                let point = case.random_point(&mut rng, &region);
                let claim = oracle.at(point, &values)[0];
                let is_finite = claim.lo.is_finite() && claim.hi.is_finite();
                if claim.defined != Defined::Yes || !is_finite {
                    continue;
                }
                let value = Interval { lo: claim.lo, hi: claim.hi };
                for is_solid in [false, true] {
                    let (is_empty, context) = compare(value, is_solid);
                    assert!(
                        !is_empty,
                        "the zero at {:?} is lost: {context}",
                        point.map(hexadecimal)
                    );
                }
                points += 1;
                sides.push(value);
                // For another value, branches often prove a box empty that the whole function does
                // not.
                let beside = Interval { lo: value.lo + 0.25, hi: value.hi + 0.25 };
                let (is_empty, _) = compare(beside, false);
                let known: Vec<_> = case.parameters.iter().copied().chain([beside]).collect();
                let whole = Reference::new(plain.clone(), Binding::new(&known));
                shut += u32::from(is_empty && is_possible(&whole, &boxes));
            }
            // A solid's boundary lies between points at which its function has different signs.
            if let [a, b] = sides[..]
                && (a.hi < b.lo || b.hi < a.lo)
            {
                let middle = a.lo.midpoint(b.lo);
                let (is_empty, context) = compare(Interval { lo: middle, hi: middle }, true);
                assert!(!is_empty, "a boundary between {a:?} and {b:?} is lost: {context}");
                boundaries += 1;
            }
        }
    }
    println!(
        "{points} zeros and {boundaries} boundaries in {cases} functions kept, {shut} boxes emptied"
    );
    count_claims(points + boundaries);
    assert!(u64::from(shut) * 200 > effort.cases || effort.cases < 1000, "{shut}");
}

/// Boxes per kernel.
const BOXES: usize = 64;

#[test]
fn zeros_are_where_bounds_of_the_same_steps_hold_them() {
    zeros_and_bounds::<f32>(0x5eed_0920_0000);
    zeros_and_bounds::<f64>(0x5eed_0930_0000);
}

fn zeros_and_bounds<T: Adversarial>(seed: u64) {
    let effort = Effort::from_environment(seed, 50_000);
    let (mut boxes, mut possible) = (0, [0_u32; 3]);
    for seed in effort.seed.. {
        if boxes >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let options = GraphOptions { adversarial: rng.bool(), ..options(&mut rng) };
        let case = Case::random(&mut rng, &options);
        let Some(tape) = KernelKind::Zeros.tape::<T>(rng.bool(), &case) else { continue };
        let regions: Vec<_> = (0..BOXES).map(|_| case.random_box(&mut rng)).collect();
        let inputs = pack_boxes::<T>(&regions);
        let binding = Binding::new(&case.parameters);
        let zeros = Native::<FindZeros, T>::new(tape.clone(), binding.clone()).expect("compiles");
        let bounds = Native::<Enclose, T>::new(tape, binding).expect("compiles");
        let (zeros, bounds) = (zeros.eval_all(&inputs), bounds.eval_all(&inputs));
        for (index, region) in regions.iter().enumerate() {
            let (zeros, bounds, lane) =
                (&zeros[index / LANES], &bounds[index / LANES], index % LANES);
            let ends = [bounds.neg_lo[lane], bounds.hi[lane]];
            let holds_zero = ends.iter().all(|end| *end >= T::default());
            let is_infinite = ends.iter().any(|end| *end > T::LARGEST);
            let facts = bounds.facts(lane);
            let expected = [
                holds_zero && !facts.has(Facts::NOWHERE),
                is_infinite,
                !facts.has(Facts::CONTINUOUS),
            ];
            let found =
                [zeros.possible, zeros.unbounded, zeros.jumping].map(|mask| mask >> lane & 1 == 1);
            // If no zero is possible, the masks `unbounded` and `jumping` mean nothing.
            let compared = if expected[0] { 3 } else { 1 };
            assert_eq!(
                found[..compared],
                expected[..compared],
                "{ends:?} {facts:?}\n{}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1",
                case.describe::<T>(&Place::over(region))
            );
            for (count, found) in possible.iter_mut().zip(found) {
                *count += u32::from(found);
            }
            boxes += 1;
        }
    }
    count_claims(boxes);
    println!("{:?}: of {boxes} boxes {possible:?} possible, unbounded, jumping", T::FORMAT);
    let fair =
        possible.iter().all(|count| (boxes / 20..boxes * 19 / 20).contains(&u64::from(*count)));
    assert!(fair || effort.cases < 1000, "{possible:?}");
}
