//! Tests that branches together contain every value, and are the whole box where nothing jumps.

use zeroset_interval::{
    Branch, Enclosure, Exponent, Fact, Format, Interval, Operand, Software, Split, Vector128,
    enclose_branch,
};
use zeroset_ops::{Class, Continuity, Op, TABLE};

/// A generator of random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn end(&mut self) -> f64 {
        let special = [0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 1e-45, 1.7e7, -2.5e9, 3e38, -3e38];
        match self.next() % 4 {
            0 => special[self.next() as usize % special.len()],
            _ => (self.next() % 4001) as f64 / 500.0 - 4.0,
        }
    }

    /// A random interval, sometimes unbounded, and a point in it.
    fn bounds(&mut self) -> (Interval, f64) {
        let (a, b, c) = (self.end(), self.end(), self.end());
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let point = a + b + c - lo - hi;
        let point = if (lo..=hi).contains(&point) { point } else { a };
        let bounds = match self.next() % 16 {
            0 => Interval { lo: f64::NEG_INFINITY, hi },
            1 => Interval { lo, hi: f64::INFINITY },
            2 => Interval { lo: point, hi: point },
            _ => Interval { lo, hi },
        };
        (bounds, point)
    }
}

fn operand(bounds: Interval, exponent: Exponent) -> Operand<Vector128> {
    let lanes = |end: f64| Vector128::from_f64([end; 2]);
    let value = Enclosure::total(lanes(-bounds.lo), lanes(bounds.hi));
    Operand { value, range: Interval::ENTIRE, exponent }
}

fn over(op: Op, operands: &[Operand<Vector128>], branch: Branch) -> (f64, f64, [bool; 3]) {
    let value = enclose_branch(&mut Software::new(), Format::F64, op, operands, branch);
    let is = |fact: Fact<Vector128>| fact.mask(&mut Software::new(), Format::F64).bits_64()[0] != 0;
    let facts = [value.facts.nowhere, value.facts.defined, value.facts.continuous].map(is);
    (0.0 - value.neg_lo.f64()[0], 0.0 + value.hi.f64()[0], facts)
}

#[test]
fn parts_cover_the_box_and_are_the_whole_where_nothing_jumps() {
    let seed = 0x5eed_0a00;
    println!("seed {seed:#x}");
    let mut random = Random(seed);
    for row in TABLE {
        let exponents: &[i32] = if row.class == Class::Power { &[-3, -1, -2, 3] } else { &[0] };
        for (exponent, case) in exponents.iter().flat_map(|n| (0..4000).map(move |k| (*n, k))) {
            let mut operands = Vec::new();
            let mut points = Vec::new();
            for place in 0..row.op.arity() {
                let (mut bounds, mut point) = random.bounds();
                let mut kind = Exponent::Real;
                if row.class == Class::Power && place == 1 {
                    point = f64::from(exponent);
                    bounds = Interval { lo: point, hi: point };
                    kind = Exponent::Integer(exponent);
                }
                operands.push(operand(bounds, kind));
                points.push(operand(Interval { lo: point, hi: point }, kind));
            }
            let exponent = operands[operands.len() - 1].exponent;
            let ranges: Vec<Interval> = operands.iter().map(|operand| operand.range).collect();
            let parting = Split::of(row.op, &ranges, exponent);
            assert_eq!(
                parting != Split::Whole,
                row.continuity == Continuity::Jumps
                    || row.class == Class::Quotient
                    || matches!(exponent, Exponent::Integer(-3 | -1)),
                "{}",
                row.name
            );
            let (at_lo, at_hi, [at_nowhere, ..]) = over(row.op, &points, Branch::Whole);
            let whole = over(row.op, &operands, Branch::Whole);
            let mut holds = at_nowhere;
            for &branch in parting.branches() {
                let (lo, hi, facts) = over(row.op, &operands, branch);
                let context = || {
                    format!(
                        "{} {branch:?} case {case}: {operands:?}\n{whole:?}, {lo} {hi} {facts:?}",
                        row.name
                    )
                };
                assert!(lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY, "{}", context());
                assert!(whole.0 <= lo && hi <= whole.1, "beyond the whole: {}", context());
                holds |= !facts[0] && lo <= at_hi && at_lo <= hi;
                if whole.2[2] {
                    assert_eq!((lo, hi, facts), whole, "{}", context());
                }
            }
            assert!(holds, "{} case {case}: {operands:?} lost {points:?}", row.name);
        }
    }
}

#[test]
fn parts_are_single_values_where_a_function_takes_two_or_three() {
    let of = |op: Op, bounds: [(f64, f64); 3]| -> Vec<(f64, f64)> {
        let operands = bounds.map(|(lo, hi)| operand(Interval { lo, hi }, Exponent::Real));
        let operands = &operands[..op.arity()];
        let ranges = operands.iter().map(|operand| operand.range).collect::<Vec<_>>();
        let branches = Split::of(op, &ranges, Exponent::Real).branches();
        branches
            .iter()
            .map(|&branch| over(op, operands, branch))
            .map(|(lo, hi, _)| (lo, hi))
            .collect()
    };
    let none = (0.0, 0.0);
    assert_eq!(of(Op::Floor, [(0.9, 1.1), none, none]), [(0.0, 0.0), (1.0, 1.0)]);
    assert_eq!(of(Op::Floor, [(0.9, 3.1), none, none]), [(0.0, 0.0), (1.0, 3.0)]);
    assert_eq!(of(Op::Ceil, [(0.9, 1.1), none, none]), [(1.0, 1.0), (2.0, 2.0)]);
    assert_eq!(of(Op::Round, [(0.4, 0.6), none, none]), [(0.0, 0.0), (1.0, 1.0)]);
    assert_eq!(of(Op::Trunc, [(-1.1, -0.9), none, none]), [(-1.0, -1.0), (0.0, 0.0)]);
    assert_eq!(of(Op::Sign, [(-1.0, 2.0), none, none]), [(-1.0, -1.0), (0.0, 0.0), (1.0, 1.0)]);
    assert_eq!(of(Op::Fract, [(0.75, 1.25), none, none]), [(0.75, 1.0), (0.0, 0.25)]);
    assert_eq!(of(Op::Mod, [(2.5, 3.5), (1.5, 1.5), none]), [(1.0, 1.5), (0.0, 0.5)]);
    assert_eq!(
        of(Op::Div, [(1.0, 2.0), (-0.5, 0.25), none]),
        [(f64::NEG_INFINITY, -2.0), (4.0, f64::INFINITY)]
    );
    let pi = std::f64::consts::PI.next_up();
    let cut = of(Op::Atan2, [(-1.0, 1.0), (-2.0, -1.0), none]);
    assert!(cut[0].0 == -pi && (-2.4..-2.3).contains(&cut[0].1), "{cut:?}");
    assert!(cut[1].1 == pi && (2.3..2.4).contains(&cut[1].0), "{cut:?}");
    assert_eq!(
        of(Op::SelectNegative, [(-1.0, 1.0), (2.0, 3.0), (4.0, 5.0)]),
        [(2.0, 3.0), (4.0, 5.0)]
    );
}
