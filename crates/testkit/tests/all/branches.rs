//! Kernels that tell where a function may vanish, branch by branch: no zero is lost, and native code gives the bits of
//! the reference.
//!
//! For a random point p of a box, f − f(p) has a zero in the box, whatever f does elsewhere in it.
//!
//! A long run: `ZEROSET_CASES=10000000 cargo test --release -p zeroset-testkit --test all branches`.

use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, IntervalKernel, Real, Reference, Tape,
};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{clear, rewrite, simplify};
use zeroset_jit::NativeInterval;
use zeroset_ops::{Class, Continuity, Op, TABLE};
use zeroset_testkit::{
    Adversarial, Case, Defined, Effort, GraphOptions, Oracle, Place, Rng, hexadecimal, pack_boxes,
};

/// Points tried of each case, each in a box of its own.
const POINTS: usize = 16;

/// A case's function less a fresh parameter, which is numbered after all others.
fn shifted(case: &Case) -> Case {
    let mut shifted = case.clone();
    let value = shifted.graph.parameter(case.assumptions.parameters.len() as u32);
    shifted.root = shifted.graph.apply(Op::Sub, &[case.root, value]);
    shifted.assumptions.parameters.push(Interval::ENTIRE);
    shifted
}

/// Steps that tell where a case's function may vanish, made as programs make them; also those of the function alone.
fn tapes<T: Real>(case: &Case) -> Option<(Tape<T>, Tape<T>)> {
    let Assumptions { domain, parameters } = &case.assumptions;
    let (mut graph, roots) = rewrite(&case.graph, &[case.root], domain, parameters).ok()?;
    let mut typed = vec![roots[0]];
    typed.extend(clear(&mut graph, roots[0]).map(|cleared| cleared.numerator));
    let (graph, roots) = simplify(&graph, &typed, domain, parameters).ok()?;
    let branches = Tape::branches(&graph, &roots, &case.assumptions)?;
    Some((branches, Tape::new(&graph, &roots[..1], &case.assumptions)))
}

/// What jumps, has a pole, or is a little arithmetic around that; with everything else now and then.
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

fn enclosed<T: Real>(kernel: &dyn IntervalKernel<T>, packet: &BoxPacket<T>) -> EnclosurePacket<T> {
    let mut out = [EnclosurePacket::default()];
    kernel.enclose(std::slice::from_ref(packet), &mut out);
    out[0]
}

fn is_empty<T: Real>(packet: &EnclosurePacket<T>) -> bool {
    T::facts(packet.facts[0]).has(Facts::NOWHERE)
}

fn may_vanish<T: Real>(packet: &EnclosurePacket<T>) -> bool {
    let zero = T::nearest(0.0);
    !is_empty(packet) && packet.neg_lo[0] >= zero && packet.hi[0] >= zero
}

#[test]
fn no_zero_is_lost_and_native_code_agrees() {
    check::<f32>(0x5eed_0900_0000, 100_000);
}

#[test]
fn no_zero_is_lost_and_native_code_agrees_in_f64() {
    check::<f64>(0x5eed_0910_0000, 50_000);
}

fn check<T: Adversarial>(seed: u64, cases: u64) {
    let effort = Effort::from_environment(seed, cases);
    let (mut points, mut shut, mut cases) = (0, 0, 0);
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
        let mut native: Option<NativeInterval<T>> = None;
        cases += 1;
        for _ in 0..POINTS {
            let region: [[T; 2]; 3] = case.random_box(&mut rng);
            let point = case.random_point(&mut rng, &region);
            let claim = oracle.at(point, &values)[0];
            if claim.defined != Defined::Yes || claim.lo.is_infinite() || claim.hi.is_infinite() {
                continue;
            }
            let value = Interval { lo: claim.lo, hi: claim.hi };
            let bind = |value: Interval| {
                let known = case.parameters.iter().copied().chain([value]);
                Binding::new(&known.map(|bounds| (bounds, Facts::TOTAL)).collect::<Vec<_>>())
            };
            let packet = pack_boxes(&[region])[0];
            let mut compare = |value: Interval| {
                let binding = bind(value);
                let kernel = match &native {
                    Some(kernel) => kernel.bind(&binding),
                    None => NativeInterval::compile(&branches, &binding).expect("compiles"),
                };
                let answer = enclosed(&kernel, &packet);
                native = Some(kernel);
                let expected = enclosed(&Reference::new(branches.clone(), binding), &packet);
                let context = || {
                    let line = case.describe::<T>(&Place::over(&region));
                    let at = point.map(hexadecimal);
                    format!(
                        "{line}\nat {at:?}, {claim:?}\nnative {answer:?}\nreference {expected:?}\n\
                         ZEROSET_SEED={seed:#x} ZEROSET_CASES=1"
                    )
                };
                assert!(answer == expected, "the bits differ: {}", context());
                (answer, context())
            };
            let (answer, context) = compare(value);
            assert!(!is_empty(&answer), "a zero is lost: {context}");
            points += 1;
            // Beside the value, branches are often empty where the function as a whole is not.
            let beside = Interval { lo: value.lo + 0.25, hi: value.hi + 0.25 };
            let (answer, _) = compare(beside);
            let whole = enclosed(&Reference::new(plain.clone(), bind(beside)), &packet);
            shut += u32::from(is_empty(&answer) && may_vanish(&whole));
        }
    }
    println!("{points} zeros in {cases} functions kept, {shut} boxes emptied");
    assert!(u64::from(shut) * 200 > effort.cases || effort.cases < 1000, "{shut}");
}
