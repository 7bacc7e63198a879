//! Native kernels return the same bits as the reference evaluator. Each operation is tested on
//! adversarial lanes.

use std::fmt::Debug;
use zeroset_eval::{
    Assumptions, Batch, Binding, Boxes, Enclose, Input, Kernel, LANES, Output, Points, Query, Real,
    Reference, Sample, Tape,
};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph};
use zeroset_jit::{Compiled, Threaded, vector_widths};
use zeroset_ops::TABLE;

/// A small random generator (splitmix64), so that these tests need no other crate.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn end<T: Draw>(&mut self) -> T {
        let special = [0.0, -0.0, 1.0, -1.0, 0.5];
        match self.next() % 4 {
            0 => {
                let ordinary = special[self.next() as usize % special.len()];
                [T::from_bits(1), T::LEAST_NORMAL, T::LARGEST, -T::LARGEST, T::nearest(ordinary)]
                    [(self.next() as usize % 9).min(4)]
            }
            1 => {
                let value = T::from_bits(self.next());
                if value.into().is_nan() { T::nearest(3.0) } else { value }
            }
            2 => {
                let angle = (self.next() % 64) as f64 * std::f64::consts::FRAC_PI_2;
                T::nearest(angle - 40.0)
            }
            _ => T::nearest((self.next() % 2000) as f64 / 250.0 - 4.0),
        }
    }

    fn bounds<T: Draw>(&mut self) -> (T, T) {
        let (a, b) = (self.end::<T>(), self.end::<T>());
        let (lo, hi) =
            if self.next().is_multiple_of(4) { (a, a) } else { (least(a, b), most(a, b)) };
        (least(lo, T::LARGEST), most(hi, -T::LARGEST))
    }
}

/// The part of a float type that this test needs.
trait Draw: Real {
    fn from_bits(bits: u64) -> Self;
}

impl Draw for f32 {
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
}

impl Draw for f64 {
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}

fn least<T: Real>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

fn most<T: Real>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

fn same<T: Real>(a: T, b: T) -> bool {
    a == b || (a.into().is_nan() && b.into().is_nan())
}

#[test]
fn every_operation_agrees_on_intervals_and_points() {
    every_operation_agrees::<f32>();
}

#[test]
fn every_operation_agrees_in_f64_too() {
    every_operation_agrees::<f64>();
}

fn every_operation_agrees<T: Draw>() {
    let seed = 0x5eed_0001;
    println!("seed {seed:#x}");
    let mut random = Random(seed);
    for row in TABLE {
        for bounded in [false, true] {
            let mut graph = Graph::new();
            let operands: Vec<_> =
                Axis::ALL[..row.op.arity()].iter().map(|&axis| graph.variable(axis)).collect();
            let root = graph.apply(row.op, &operands);
            let mut assumptions = Assumptions::none(0);
            if bounded {
                assumptions.domain = [Interval { lo: -8.0, hi: 8.0 }; 3];
            }
            let tape = Tape::<T>::new(&graph, &[root], &assumptions);
            let mut boxes = vec![Boxes { count: LANES as u32, ..Boxes::default() }; 150];
            let mut points = vec![Points { count: LANES as u32, ..Points::default() }; 150];
            for (boxes, points) in boxes.iter_mut().zip(&mut points) {
                for axis in 0..3 {
                    for lane in 0..LANES {
                        let (mut lo, mut hi) = random.bounds::<T>();
                        if bounded {
                            let inside = |x: T| T::nearest(x.into().clamp(-8.0, 8.0));
                            (lo, hi) = (inside(lo), inside(hi));
                        }
                        boxes.neg_lo[axis][lane] = -lo;
                        boxes.hi[axis][lane] = hi;
                        points.at[axis][lane] = hi;
                    }
                }
            }
            for found in agreed::<Enclose, T>(&tape, &boxes) {
                let is_nan = |end: &T| (*end).into().is_nan();
                assert!(!found.neg_lo.iter().chain(&*found.hi).any(is_nan), "{}", row.name);
            }
            agreed::<Sample, T>(&tape, &points);
        }
    }
}

/// Returns the results of native code, after comparing them with the reference.
fn agreed<Q: Query, T: Real>(tape: &Tape<T>, inputs: &[Q::Input<T>]) -> Vec<Q::Output<T>>
where
    Q::Input<T>: Debug,
    Q::Output<T>: Debug,
{
    let compiled = Compiled::<Q, T>::new(tape.clone()).expect("compiles");
    assert_eq!(Some(compiled.vector_bytes()), vector_widths().next(), "{:?}", tape.steps());
    let found = compiled.bind(Binding::empty()).eval_all(inputs);
    compare::<Q, T>(tape, inputs, &found);
    let quick = Compiled::<Q, T>::quickly(tape.clone()).expect("compiles");
    let kernel = quick.bind(Binding::empty());
    compare::<Q, T>(tape, inputs, &kernel.eval_all(inputs));
    quick.optimize().expect("compiles");
    assert_eq!(quick.code_bytes(), compiled.code_bytes(), "{:?}", tape.steps());
    compare::<Q, T>(tape, inputs, &kernel.eval_all(inputs));
    let threaded = Threaded::<Q, T>::new(tape.clone(), &Binding::empty()).expect("stencils");
    compare::<Q, T>(&tape.clone().coarse(), inputs, &threaded.eval_all(inputs));
    found
}

/// Compares results with those of the reference.
fn compare<Q: Query, T: Real>(tape: &Tape<T>, inputs: &[Q::Input<T>], found: &[Q::Output<T>])
where
    Q::Input<T>: Debug,
    Q::Output<T>: Debug,
{
    let expected = Reference::<Q, T>::new(tape.clone(), Binding::empty()).eval_all(inputs);
    for ((input, e), f) in inputs.iter().zip(&expected).zip(found) {
        let lanes =
            |number| e.quantity(number).iter().zip(&**f.quantity(number)).take(input.count());
        let quantities =
            (0..Q::Output::<T>::QUANTITIES).all(|q| lanes(q).all(|(a, b)| same(*a, *b)));
        let used = |mask: u16| mask << (LANES - input.count());
        let masks = (0..Q::Output::<T>::MASKS).all(|n| used(e.mask(n)) == used(f.mask(n)));
        assert!(quantities && masks, "{:?}: {input:?}\n{e:?}\n{f:?}", tape.steps());
    }
}
