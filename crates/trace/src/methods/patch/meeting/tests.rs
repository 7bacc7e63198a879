//! Rays through known points of cells: no bound may leave out such a point.

use super::*;
use fearless_simd::Level;
use zeroset_eval::dispatch;
use zeroset_testkit::{Effort, Rng};

/// A number between 0 and 1.
fn unit(rng: &mut Rng) -> f64 {
    f64::from(rng.u32(..)) / f64::from(u32::MAX)
}

/// A number between −1 and 1.
fn share(rng: &mut Rng) -> f64 {
    unit(rng) * 2.0 - 1.0
}

/// Numbers of magnitudes between 10⁻³ and 10³.
fn vector(rng: &mut Rng) -> [f64; 3] {
    let size = 10_f64.powf(3.0 * share(rng));
    [(); 3].map(|()| size * share(rng))
}

/// A ray that passes a point at which a cell has (U, V), with the cell's error taken there, and the
/// t of the point. Cells are thin in some direction as often as not.
fn case(rng: &mut Rng) -> (Ray, CellShape, [f64; 2], f64) {
    let squeezed = |rng: &mut Rng| {
        let thin = 10_f64.powf(-8.0 * unit(rng));
        vector(rng).map(|part| part * thin)
    };
    let (centre, along_u, along_v) = (vector(rng), squeezed(rng), squeezed(rng));
    let [u, v] = [share(rng), share(rng)];
    let origin = DVec3::from_array(vector(rng));
    let size = DVec3::from_array(centre).length() + origin.length();
    // Larger than the rounding of the point and of the ray.
    let error = [(); 3].map(|()| size * 10_f64.powf(-12.0 + 10.0 * unit(rng)));
    let at = [0, 1, 2].map(|axis| {
        centre[axis] + along_u[axis] * u + along_v[axis] * v + 0.9 * error[axis] * share(rng)
    });
    let t = 10_f64.powf(2.0 * share(rng));
    let direction = (DVec3::from_array(at) - origin) / t;
    (Ray { origin, direction }, CellShape { centre, along_u, along_v, error }, [u, v], t)
}

/// The shape with its axes in a beam's order.
fn in_order(shape: &CellShape, axes: [usize; 3]) -> CellShape {
    let of = |all: [f64; 3]| axes.map(|axis| all[axis]);
    CellShape {
        centre: of(shape.centre),
        along_u: of(shape.along_u),
        along_v: of(shape.along_v),
        error: of(shape.error),
    }
}

fn check(seed: u64, beam: &Beam, shape: &CellShape, symbols: [f64; 2], t: Option<f64>) -> bool {
    let meeting = meeting(beam, &in_order(shape, beam.axes));
    let what = || {
        format!(
            "ZEROSET_SEED={seed:#x} ZEROSET_CASES=1: {beam:?}, {shape:?}: {meeting:?}, not {symbols:?}"
        )
    };
    assert!(meeting.is_possible, "{}", what());
    if meeting.is_solved {
        for ([middle, reach], symbol) in meeting.symbols.into_iter().zip(symbols) {
            assert!((symbol - middle).abs() <= reach, "{}", what());
        }
    }
    if let Some(t) = t {
        // The ray passes the point within its rounding.
        let slack = 1e-9 * t;
        assert!(meeting.t[0] - slack <= t && t <= meeting.t[1] + slack, "{}: {t}", what());
    }
    meeting.is_inside()
}

#[test]
fn a_point_of_a_cell_on_a_ray_is_not_left_out() {
    let (mut inside, mut groups) = (0, 0);
    let effort = Effort::from_environment(0x9a7c_0000, 100_000);
    for seed in effort.seed..effort.seed + effort.cases {
        let rng = &mut Rng::with_seed(seed);
        let (ray, shape, symbols, t) = case(rng);
        let axes = axes(main_axis(ray.direction));
        let beam = Beam::along(&ray, axes);
        inside += u32::from(check(seed, &beam, &shape, symbols, Some(t)));
        // Beams around this ray and others that are near.
        let near = 10_f64.powf(-6.0 * unit(rng));
        let mut group = |count: usize| {
            let segments: Vec<Segment> = (0..count)
                .map(|k| {
                    let mut moved = ray;
                    if k > 0 {
                        let shift = DVec3::from_array([(); 3].map(|()| near * share(rng)));
                        moved.origin += shift * ray.origin.length();
                        moved.direction *= 1.0 + near * share(rng);
                    }
                    Segment { ray: moved, to: f64::INFINITY, pixel: [1.0, 0.0] }
                })
                .collect();
            let rays = BeamLanes::new(&segments, axes);
            dispatch!(Level::new(), simd => rays.beam(simd))
        };
        let (one, other) = (group(4), group(LANES));
        let both = one.zip(other).and_then(Beam::of_both);
        for group in [one, other, both].into_iter().flatten() {
            groups += 1;
            check(seed, &group, &shape, symbols, None);
            let from = least_t(&group, &in_order(&shape, axes));
            // The ray passes the point within its rounding.
            assert!(from <= t + 1e-9 * t, "ZEROSET_SEED={seed:#x} ZEROSET_CASES=1: {from} > {t}");
        }
    }
    assert!(effort.cases < 1000 || groups > 0, "no group of rays");
    assert!(effort.cases < 1000 || inside > 0, "no cell with a proven zero");
}
