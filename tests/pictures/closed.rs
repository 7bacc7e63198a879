//! Rays from outside to points inside of closed parametric surfaces. None may be a miss, and each
//! hit lies before the point inside. Otherwise the ray slipped between cells.
//!
//! A long run: `ZEROSET_CASES=1000000 cargo test --test all slips -- --nocapture`.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};
use zeroset_scene::program::Program;
use zeroset_scene::view::bounds;
use zeroset_space::{Ray, Region};
use zeroset_syntax::{Options, read};
use zeroset_testkit::{Adversarial, Effort, Rng, count_claims};
use zeroset_trace::{
    KernelStats, RayResult, Segment, Start, Status, TraceOptions, Tracer, patch_tracer,
};

/// A closed surface.
struct Closed {
    text: &'static str,
    /// Half the side of a cube that holds it.
    half: f64,
    /// The ranges of u and v.
    ranges: [[f64; 2]; 2],
    at: fn(f64, f64) -> DVec3,
    /// Whether a ray from this point to infinity must meet the surface. False near the surface.
    is_inside: fn(DVec3) -> bool,
}

const SURFACES: [Closed; 5] = [
    Closed {
        text: "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]",
        half: 1.5,
        ranges: [[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]],
        at: |u, v| DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin()),
        is_inside: |p| p.length() < 1.0 - 1e-9,
    },
    Closed {
        text: "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]",
        half: 3.5,
        ranges: [[0.0, TAU]; 2],
        at: |u, v| DVec3::new((2.0 + v.cos()) * u.cos(), (2.0 + v.cos()) * u.sin(), v.sin()),
        is_inside: |p| (p.x.hypot(p.y) - 2.0).hypot(p.z) < 1.0 - 1e-9,
    },
    // Steiner's surface: inside, the number of crossings on the way out is odd.
    Closed {
        text: "(sin u cos v sin v, cos u cos v sin v, sin u cos u cos(v)^2) for u in [0, 2pi], v in [-pi/2, pi/2]",
        half: 0.6,
        ranges: [[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]],
        at: |u, v| {
            let (along, across) = (v.cos() * v.sin(), u.sin() * u.cos());
            DVec3::new(u.sin() * along, u.cos() * along, across * v.cos() * v.cos())
        },
        is_inside: |p| {
            let [x, y, z] = (p * p).to_array();
            x * y + y * z + z * x - p.x * p.y * p.z < -1e-9
        },
    },
    // Dupin's cyclide.
    Closed {
        text: "w(u, v) = 2 - cos u cos v; (((3/2) (1 - 2 cos u cos v) + 3 cos u)/w(u, v), sqrt(3) sin(u) (2 - 1.5 cos v)/w(u, v), sqrt(3) sin(v) (cos u - 1.5)/w(u, v)) for u in [0, 2pi], v in [0, 2pi]",
        half: 5.0,
        ranges: [[0.0, TAU]; 2],
        at: |u, v| {
            let (root, both) = (3.0_f64.sqrt(), u.cos() * v.cos());
            let x = 1.5 * (1.0 - 2.0 * both) + 3.0 * u.cos();
            let y = root * u.sin() * (2.0 - 1.5 * v.cos());
            DVec3::new(x, y, root * v.sin() * (u.cos() - 1.5)) / (2.0 - both)
        },
        is_inside: |p| {
            let sum = p.length_squared() + 3.0 - 2.25;
            sum * sum - 4.0 * (2.0 * p.x - 1.5).powi(2) - 12.0 * p.y * p.y < -1e-7
        },
    },
    // A sphere with bumps.
    Closed {
        text: "r(u, v) = 1 + sin(3u) cos(v)^3/4; (r(u, v) cos u cos v, r(u, v) sin u cos v, r(u, v) sin v) for u in [0, 2pi], v in [-pi/2, pi/2]",
        half: 1.5,
        ranges: [[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]],
        at: |u, v| bumpy(u, v) * DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin()),
        is_inside: |p| p.length() < bumpy(p.y.atan2(p.x), p.z.atan2(p.x.hypot(p.y))) - 1e-9,
    },
];

fn bumpy(u: f64, v: f64) -> f64 {
    1.0 + (3.0 * u).sin() * v.cos().powi(3) / 4.0
}

fn signed(rng: &mut Rng) -> f64 {
    2.0 * f64::uniform(rng) - 1.0
}

fn vector(rng: &mut Rng) -> DVec3 {
    DVec3::new(signed(rng), signed(rng), signed(rng))
}

impl Closed {
    fn point_inside(&self, rng: &mut Rng) -> DVec3 {
        loop {
            let point = vector(rng) * self.half;
            if (self.is_inside)(point) {
                return point;
            }
        }
    }

    /// A point of the surface at an edge or a corner of cells. Cells are equal parts of the
    /// rectangle, and their numbers are powers of two.
    fn point_of_edge(&self, rng: &mut Rng) -> DVec3 {
        let is_corner = rng.bool();
        let [u, v] = self.ranges.map(|[low, high]| {
            let parts = f64::from(1 << rng.u32(1..=10));
            let share = (f64::uniform(rng) * parts).floor() / parts;
            let share = if is_corner || rng.bool() { share } else { f64::uniform(rng) };
            low + (high - low) * share
        });
        (self.at)(u, v)
    }

    /// Rays from outside, each with the t of a point inside. They have any directions, are
    /// near each other as those of pixels, or pass points at edges of cells.
    fn rays(&self, rng: &mut Rng) -> Vec<(Ray, f64)> {
        let (kind, count) = (rng.u32(0..3), rng.u32(1..=48));
        let size = f64::from(rng.u32(1..=16)) / 8.0;
        let (common, middle) = (vector(rng), self.point_inside(rng));
        let ray = |_| {
            let (inside, direction) = match kind {
                0 => (self.point_inside(rng), vector(rng)),
                1 => (middle, common + vector(rng) * 1e-2),
                _ => {
                    let inside = self.point_inside(rng);
                    (inside, inside - self.point_of_edge(rng))
                }
            };
            let direction = direction.normalize() * size;
            let t = f64::from(rng.u32(8..=32)) * self.half / size;
            (Ray { origin: inside - direction * t, direction }, t)
        };
        (0..count).map(ray).collect()
    }
}

/// Follows rays, and returns the number of hits among them.
fn hits(tracer: &dyn Tracer, rays: &[(Ray, f64)], text: &str) -> usize {
    let segment =
        |(ray, _): &(Ray, f64)| Segment { ray: *ray, to: f64::INFINITY, pixel: [0.0, 1e-3] };
    let segments: Vec<Segment> = rays.iter().map(segment).collect();
    let mut found = vec![RayResult::MISS; rays.len()];
    tracer.follow(&segments, Start::Anywhere, &mut found, &mut KernelStats::default());
    for ((ray, inside), found) in rays.iter().zip(&found) {
        assert!(found.status != Status::Miss, "{text}: a miss is claimed of {ray:?}");
        // Before its distance, no zero is claimed to be.
        let free = if found.status == Status::Hit { found.bracket[0] } else { found.distance };
        assert!(free <= *inside, "{text}: {found:?} is claimed of {ray:?}, inside at {inside}");
    }
    found.iter().filter(|found| found.status == Status::Hit).count()
}

#[test]
fn no_ray_slips_between_cells() {
    let effort = Effort::from_environment(0x5eed_0c10, 20_000);
    for closed in &SURFACES {
        let document = read(closed.text, &Options::default()).expect(closed.text);
        let half = DVec3::splat(closed.half);
        let region = Region::new(-half, half).expect("a cube");
        let program = Program::new(&document, bounds(&region))
            .and_then(|program| program.with_patches(&document))
            .expect(closed.text);
        let patch = program.patch(0).expect("a parametric surface");
        let tree = patch.tree().expect("a kernel");
        let tracer = patch_tracer(tree, &region, TraceOptions::default());
        let rng = &mut Rng::with_seed(effort.seed);
        let (mut count, mut proven) = (0, 0);
        while count < effort.cases as usize / SURFACES.len() {
            let rays = closed.rays(rng);
            proven += hits(&*tracer, &rays, closed.text);
            count += rays.len();
        }
        println!("{}: {count} rays, {proven} hits", closed.text);
        assert!(10 * proven > 9 * count, "{proven} of {count} are hits");
        count_claims(count as u64);
    }
}
