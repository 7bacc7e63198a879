use std::io::Write;
use zeroset_interval::{Facts, Interval, fold};
use zeroset_ops::Op;
use zeroset_testkit::Rng;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    for (op, name) in [
        (Op::Erf, "erf"),
        (Op::BesselJ0, "j0"),
        (Op::BesselJ1, "j1"),
        (Op::BesselJ2, "j2"),
        (Op::BesselJ3, "j3"),
    ] {
        let mut random = Rng::with_seed(7);
        let mut out =
            std::io::BufWriter::new(std::fs::File::create(format!("/tmp/pts_{name}")).unwrap());
        for _ in 0..n {
            let unit = 2.0 * (random.u64(..) as f64 / u64::MAX as f64) - 1.0;
            let x = match random.u32(0..4) {
                0 => 40.0 * unit,
                1 => 10.0 * unit,
                2 => 1e4 * unit,
                _ => unit * 2f64.powi(-random.i32(0..300)),
            };
            let (b, _) = fold(op, &[(Interval::point(x).unwrap(), Facts::TOTAL)]);
            for v in [x, b.lo, b.hi] {
                out.write_all(&v.to_le_bytes()).unwrap();
            }
        }
    }
}
