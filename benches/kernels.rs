//! Interval kernels: native code, rigorous, against the same operations in intrinsics that round to nearest.
//!
//! `cargo bench --bench kernels` prints a table; names are `kernel/case`.

mod rival;

use rival::{Comparison, Rival, SURFACES, barth, compare, mitchell, sphere};
use std::hint::black_box;
use zeroset::program::Program;
use zeroset_eval::{
    BoxPacket, EnclosurePacket, IntervalKernel, LANES, PointKernel, PointPacket, ValuePacket,
};
use zeroset_interval::Interval;
use zeroset_syntax::{Options, read};

/// Packets per call: small enough for the first cache level.
const PACKETS: usize = 128;
const CALLS: usize = 2_000;
const ROUNDS: usize = 101;

/// Boxes as a traverser asks for them: 1/16 of the domain wide, all over it.
fn boxes(half: f64) -> Vec<BoxPacket> {
    let mut state = 1_u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    (0..PACKETS)
        .map(|_| {
            let mut packet = BoxPacket::default();
            for axis in 0..3 {
                for lane in 0..LANES {
                    let lo = half * (2.0 * random() - 1.0);
                    packet.neg_lo[axis][lane] = -lo as f32;
                    packet.hi[axis][lane] = (lo + half / 8.0).min(half) as f32;
                }
            }
            packet
        })
        .collect()
}

fn time(native: &dyn IntervalKernel, rival: &dyn IntervalKernel, half: f64) -> Comparison {
    let boxes = boxes(half);
    let mut out =
        [vec![EnclosurePacket::default(); PACKETS], vec![EnclosurePacket::default(); PACKETS]];
    native.enclose(&boxes, &mut out[0]);
    rival.enclose(&boxes, &mut out[1]);
    // The same function: enclosures differ by rounding only.
    for (a, b) in out[0].iter().zip(&out[1]) {
        for lane in 0..LANES {
            let size = a.hi[lane].abs() + a.neg_lo[lane].abs() + 100.0;
            assert!((a.hi[lane] - b.hi[lane]).abs() < 1e-5 * size, "{a:?} {b:?}");
            assert!((a.neg_lo[lane] - b.neg_lo[lane]).abs() < 1e-5 * size, "{a:?} {b:?}");
        }
    }
    let [mut a, mut b] = out;
    compare(
        ROUNDS,
        || (0..CALLS).for_each(|_| native.enclose(black_box(&boxes), black_box(&mut a))),
        || (0..CALLS).for_each(|_| rival.enclose(black_box(&boxes), black_box(&mut b))),
    )
}

fn main() {
    println!("{:24}{:>12}{:>12}{:>8}   quartiles", "", "native", "rival", "ratio");
    println!("{:24}{:>12}{:>12}", "", "ns/box", "ns/box");
    for (name, formula, half) in SURFACES {
        let document = read(formula, &Options::default()).expect(name);
        let program = Program::new(&document, [Interval { lo: -half, hi: half }; 3]).expect(name);
        let native = program.interval_kernel(0).expect(name);
        let result = match name {
            "sphere" => time(&native, &Rival(sphere), half),
            "mitchell" => time(&native, &Rival(mitchell), half),
            _ => time(&native, &Rival(barth), half),
        };
        let per_box = 1e9 / (CALLS * PACKETS * LANES) as f64;
        println!(
            "{:24}{:12.3}{:12.3}{:8.3}   {:.3} to {:.3}",
            format!("kernel/{name}"),
            result.ours * per_box,
            result.theirs * per_box,
            result.ratio,
            result.quartiles[0],
            result.quartiles[1],
        );
    }
    gyroid();
}

/// The gyroid has no rival here: what a call of its kernels costs, four boxes or four points a packet.
fn gyroid() {
    const HALF: f64 = std::f64::consts::TAU;
    const FEWER: usize = CALLS / 10;
    let formula = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";
    let document = read(formula, &Options::default()).expect("reads");
    let program =
        Program::new(&document, [Interval { lo: -HALF, hi: HALF }; 3]).expect("a surface");
    let interval = program.interval_kernel(0).expect("compiles");
    let point = program.point_kernel(0).expect("compiles");
    let boxes = boxes(HALF);
    let points: Vec<PointPacket> =
        boxes.iter().map(|packet| PointPacket { at: packet.hi }).collect();
    let mut enclosures = vec![EnclosurePacket::default(); PACKETS];
    let mut values = vec![ValuePacket::default(); PACKETS];
    let enclose = || {
        for _ in 0..FEWER {
            interval.enclose(black_box(&boxes), black_box(&mut enclosures));
        }
    };
    let sample = || {
        for _ in 0..FEWER {
            point.sample(black_box(&points), black_box(&mut values));
        }
    };
    let result = compare(ROUNDS, enclose, sample);
    let per_packet = 1e9 / (FEWER * PACKETS) as f64;
    println!("\n{:24}{:>12}{:>12}", "ns per packet of 4", "interval", "point");
    println!(
        "{:24}{:12.1}{:12.1}   ({} and {} bytes of code)",
        "gyroid",
        result.ours * per_packet,
        result.theirs * per_packet,
        interval.code_bytes(),
        point.code_bytes(),
    );
}
