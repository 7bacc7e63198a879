//! Native kernels give the bits of the reference evaluator: one graph per operation, adversarial lanes.

use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, IntervalKernel, PointKernel, PointPacket,
    Reference, Tape, ValuePacket,
};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph};
use zeroset_jit::{NativeInterval, NativePoint};
use zeroset_ops::TABLE;

/// A small generator, so that this crate's own tests need no other crate: splitmix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn end(&mut self) -> f32 {
        let special = [0.0, -0.0, 1.0, -1.0, 0.5, f32::MIN_POSITIVE, 1e-45, f32::MAX, -f32::MAX];
        match self.next() % 4 {
            0 => special[self.next() as usize % special.len()],
            1 => {
                let bits = f32::from_bits(self.next() as u32);
                if bits.is_nan() { 3.0 } else { bits }
            }
            2 => (self.next() % 64) as f32 * std::f32::consts::FRAC_PI_2 - 40.0,
            _ => (self.next() % 2000) as f32 / 250.0 - 4.0,
        }
    }

    fn bounds(&mut self) -> (f32, f32) {
        let (a, b) = (self.end(), self.end());
        let (lo, hi) = if self.next().is_multiple_of(4) { (a, a) } else { (a.min(b), a.max(b)) };
        (lo.min(f32::MAX), hi.max(-f32::MAX))
    }
}

fn same(a: f32, b: f32) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

#[test]
fn every_operation_agrees_on_intervals_and_points() {
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
            let tape = Tape::new(&graph, &[root], &assumptions);
            let reference = Reference::new(tape.clone(), Binding::empty());
            let native = NativeInterval::compile(&tape, &Binding::empty()).expect(row.name);
            let points = NativePoint::compile(&tape, &Binding::empty()).expect(row.name);
            let mut boxes = vec![BoxPacket::default(); 600];
            let mut at = vec![PointPacket::default(); 600];
            for (packet, at) in boxes.iter_mut().zip(&mut at) {
                for axis in 0..3 {
                    for lane in 0..4 {
                        let (mut lo, mut hi) = random.bounds();
                        if bounded {
                            (lo, hi) = (lo.clamp(-8.0, 8.0), hi.clamp(-8.0, 8.0));
                        }
                        packet.neg_lo[axis][lane] = -lo;
                        packet.hi[axis][lane] = hi;
                        at.at[axis][lane] = hi;
                    }
                }
            }
            let mut expected = vec![EnclosurePacket::default(); boxes.len()];
            let mut found = expected.clone();
            reference.enclose(&boxes, &mut expected);
            native.enclose(&boxes, &mut found);
            for ((packet, e), f) in boxes.iter().zip(&expected).zip(&found) {
                for lane in 0..4 {
                    let agree = same(e.neg_lo[lane], f.neg_lo[lane])
                        && same(e.hi[lane], f.hi[lane])
                        && e.facts[lane] == f.facts[lane];
                    assert!(agree, "{} lane {lane}: {packet:?}\n{e:?}\n{f:?}", row.name);
                    assert!(!f.neg_lo[lane].is_nan() && !f.hi[lane].is_nan(), "{}", row.name);
                }
            }
            let mut expected = vec![ValuePacket::default(); at.len()];
            let mut found = expected.clone();
            reference.sample(&at, &mut expected);
            points.sample(&at, &mut found);
            for ((packet, e), f) in at.iter().zip(&expected).zip(&found) {
                for lane in 0..4 {
                    assert!(
                        same(e.value[lane], f.value[lane]),
                        "{} lane {lane}: {packet:?}\n{e:?}\n{f:?}",
                        row.name
                    );
                }
            }
        }
    }
}
