//! Solids with faces in common planes, whose shapes are known exactly.

use crate::shapes::{euler, volume};
use crate::{flat_mesh_in, mesh_of, mesh_with, reduce};
use fastrand::Rng;
use glam::DVec3;
use std::f64::consts::PI;
use std::time::Instant;
use zeroset_mesh::Mesh;
use zeroset_space::Region;
use zeroset_testkit::{Crossings, Effort, crossings};

#[test]
fn flush_faces_are_proven() {
    let crossed = "p=max(abs(x)-2,abs(y)-1,abs(z)-1); q=max(abs(x)-1,abs(y)-2,abs(z-1)-2); \
                   h=max(abs(x)-.5,abs(y)-.5,abs(z-1)-2); subtract(union(p,q),h)<=0";
    for (text, number, exact) in [
        (crossed, 0, 36.0),
        ("union(cylinder(1,1), cylinder(0.6,1,(0,0,2))) <= 0", 2, 2.72 * PI),
        ("union(cylinder(1,1), box(0.6,0.6,0.5,(0,0,1.5))) <= 0", 2, 2.0 * PI + 1.44),
        (
            "union(cone(1.5,0.5,1), cylinder(0.8,0.5,(0,0,1.5))) <= 0",
            2,
            13.0 / 6.0 * PI + 0.64 * PI,
        ),
        ("subtract(box(2,2,1), cylinder(0.5,1)) <= 0", 0, 32.0 - 0.5 * PI),
        (
            "subtract(union(box(2,2,0.5), box(1,1,1.5)), cylinder(0.5,1.5)) <= 0",
            0,
            24.0 - 0.75 * PI,
        ),
        // A hole and a peg that fills it.
        ("union(subtract(box(2,2,1), cylinder(0.5,1)), cylinder(0.5,1)) <= 0", 2, 32.0),
        // A step, from three boxes with three planes in common.
        (
            "union(box(.5,1,.5,(-.5,0,-.5)), box(.5,1,1,(.5,0,0)), box(.5,.5,.5,(-.5,.5,.5))) <= 0",
            2,
            7.0,
        ),
        ("intersect(box(1,1,1,(0,0,1)), subtract(box(1.5), box(2,2,1,(0,0,-1)))) <= 0", 2, 6.0),
        ("max(abs(x)-1, abs(y)-1, abs(z)-1, min(x-1, 1-z, 1-x)) <= 0", 2, 8.0),
    ] {
        let (clock, tolerance) = (Instant::now(), 0.01);
        let mesh = mesh_of(text, 3.3, tolerance);
        let (found, (count, open)) = (volume(&mesh), euler(&mesh));
        println!(
            "{text}: {} triangles, {} unproven of {} cells, {} far, Euler {count}, volume {found}, {:?}",
            mesh.triangles.len(),
            mesh.unproven.len(),
            mesh.cells,
            mesh.far,
            clock.elapsed()
        );
        assert_eq!((count, open), (number, 0), "{text}");
        assert!((found / exact - 1.0).abs() < 5e-3, "{text}: {found}, not {exact}");
        assert!(mesh.is_proven(), "{text}");
    }
}

/// Number of unit cubes along an edge of the grid.
const SIDE: usize = 4;

/// A solid of unit cubes, by the indices of cubes.
struct Cubes([[[bool; SIDE]; SIDE]; SIDE]);

impl Cubes {
    fn all(is_inside: impl Fn([usize; 3]) -> bool) -> Self {
        let mut cubes = Self([[[false; SIDE]; SIDE]; SIDE]);
        for (x, plane) in cubes.0.iter_mut().enumerate() {
            for (y, row) in plane.iter_mut().enumerate() {
                for (z, cube) in row.iter_mut().enumerate() {
                    *cube = is_inside([x, y, z]);
                }
            }
        }
        cubes
    }

    /// Returns whether a cube is inside. Cubes beyond the grid are outside. The indices are one too
    /// large.
    fn at(&self, [x, y, z]: [usize; 3]) -> bool {
        let index = |along: usize| along.checked_sub(1).filter(|along| *along < SIDE);
        match [x, y, z].map(index) {
            [Some(x), Some(y), Some(z)] => self.0[x][y][z],
            _ => false,
        }
    }

    fn volume(&self) -> usize {
        self.0.as_flattened().as_flattened().iter().filter(|cube| **cube).count()
    }

    /// Number of faces between a cube and the outside.
    fn area(&self) -> usize {
        let sides = |at: [usize; 3]| {
            let differs = |axis: &usize| {
                let mut next = at;
                next[*axis] += 1;
                self.at(at) != self.at(next)
            };
            (0..3).filter(differs).count()
        };
        corners().map(sides).sum()
    }

    /// Euler's number of the boundary, which is twice that of the closed solid.
    fn euler(&self) -> i64 {
        let mut sum = 0;
        for at in corners() {
            // The cell of each dimension that ends in this corner: it extends backward along the
            // axes in `along`.
            for along in 0..8_u8 {
                let touches = (0..8_u8).any(|step| {
                    let is_across = step & along == 0;
                    let cube = [0, 1, 2].map(|k| at[k] + usize::from(step >> k & 1));
                    is_across && self.at(cube)
                });
                let sign = if along.count_ones() % 2 == 0 { 1 } else { -1 };
                sum += if touches { sign } else { 0 };
            }
        }
        2 * sum
    }

    /// Returns whether the boundary is a surface: around each corner, the cubes that are inside are
    /// connected by faces, and so are those that are outside.
    fn is_manifold(&self) -> bool {
        let is_connected = |at: [usize; 3], inside: bool| {
            let cube = |step: u8| [0, 1, 2].map(|k| at[k] + usize::from(step >> k & 1));
            let own = (0..8).filter(|step| self.at(cube(*step)) == inside);
            let all: u8 = own.fold(0, |all, step| all | 1 << step);
            let mut found = all & all.wrapping_neg();
            loop {
                let near = (0..8_u8).filter(|step| found >> step & 1 == 1);
                let grown = near.fold(found, |grown, step| {
                    (0..3).fold(grown, |grown, axis| grown | 1 << (step ^ 1 << axis))
                });
                if grown & all == found {
                    return found == all;
                }
                found = grown & all;
            }
        };
        corners().all(|at| is_connected(at, true) && is_connected(at, false))
    }
}

/// All corners of the cubes, by the indices of the cube before each.
fn corners() -> impl Iterator<Item = [usize; 3]> {
    let side = SIDE + 1;
    (0..side.pow(3)).map(move |k| [k % side, k / side % side, k / side / side])
}

/// The formula of a random solid made of boxes with integer corners from −2 to 2, and its cubes.
fn random_solid(random: &mut Rng, depth: usize) -> (String, Cubes) {
    if depth == 0 {
        let [x, y, z] = [(); 3].map(|()| {
            let low = random.usize(..SIDE);
            [low, low + 1 + random.usize(..SIDE - low)]
        });
        let bounds = |name: char, [low, high]: [usize; 2]| {
            let [low, high] = [low, high].map(|end| end as f64 - 2.0);
            match random.u8(..3) {
                0 => format!("{low}-{name},{name}-({high})"),
                1 => format!("abs({name}-({}))-{}", 0.5 * (low + high), 0.5 * (high - low)),
                _ => format!("2*({low})-2*{name},({name}-({high}))/3"),
            }
        };
        let mut bounds = bounds;
        let text = format!("max({},{},{})", bounds('x', x), bounds('y', y), bounds('z', z));
        let holds = |at: usize, [low, high]: [usize; 2]| low <= at && at < high;
        return (text, Cubes::all(|at| holds(at[0], x) && holds(at[1], y) && holds(at[2], z)));
    }
    let (one, first) = random_solid(random, depth - 1);
    let below = random.usize(..depth);
    let (other, second) = random_solid(random, below);
    let both = |join: fn(bool, bool) -> bool| {
        Cubes::all(|[x, y, z]| join(first.0[x][y][z], second.0[x][y][z]))
    };
    match random.u8(..5) {
        0 | 1 => (format!("min({one},{other})"), both(|a, b| a || b)),
        2 | 3 => (format!("max({one},-{other})"), both(|a, b| a && !b)),
        _ => (format!("max({one},{other})"), both(|a, b| a && b)),
    }
}

/// Panics unless triangles have areas and meet only in corners and edges that they share.
pub fn check_crossings(mesh: &Mesh, name: &str) {
    let vertices: Vec<[f64; 3]> = mesh.vertices.iter().map(|at| at.to_array()).collect();
    assert_eq!(crossings(&vertices, &mesh.triangles), Crossings::default(), "{name}");
}

#[test]
fn random_boxes_with_common_planes_have_their_shapes() {
    let Effort { seed, cases } = Effort::from_environment(0xb0c5, 80);
    let (mut skipped, mut empty, mut proven, mut slowest) = (0, 0, 0, (0, 0.0));
    let mut unrounded = 0;
    for case in seed..seed + cases {
        let random = &mut Rng::with_seed(case);
        let depth = 2 + random.usize(..3);
        let (solid, cubes) = random_solid(random, depth);
        let text = format!("{solid} <= 0");
        // With 4, the planes are planes of the grid.
        let half = if random.bool() { 4.0 } else { 2.6 };
        if cubes.volume() == 0 {
            empty += 1;
            continue;
        }
        let tolerance = 0.05;
        let clock = Instant::now();
        let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a region");
        let exact = flat_mesh_in(&text, region, tolerance);
        let mesh = mesh_with(&text, region, tolerance, 20_000);
        let seconds = clock.elapsed().as_secs_f64();
        if seconds > slowest.1 {
            slowest = (case, seconds);
        }
        let line = format!("seed {case:#x}: zeroset mesh '{text}' --domain={half}");
        // The exact mesh is proven wherever there is a proof.
        assert_eq!(exact.is_proven(), cubes.is_manifold(), "{:?}; {line}", exact.unproven);
        assert!((volume(&exact) - cubes.volume() as f64).abs() < 1e-9, "{line}");
        if cubes.is_manifold() {
            assert_eq!(euler(&exact), (cubes.euler(), 0), "{line}");
            check_crossings(&exact, &line);
            let mut fewer = exact;
            reduce(&mut fewer, &text, region, 2.0 * tolerance);
            assert!(fewer.is_proven(), "{:?}; {line}", fewer.unproven);
            assert_eq!(euler(&fewer), (cubes.euler(), 0), "{line}");
            check_crossings(&fewer, &line);
        }
        if !cubes.is_manifold() {
            assert!(!mesh.is_proven(), "a boundary that crosses itself is proven; {line}");
            skipped += 1;
            continue;
        }
        if !mesh.is_proven() {
            println!(
                "{} unproven of {}, {} far; {line}",
                mesh.unproven.len(),
                mesh.cells,
                mesh.far
            );
            continue;
        }
        proven += 1;
        check_crossings(&mesh, &line);
        assert_eq!(euler(&mesh), (cubes.euler(), 0), "{line}");
        let (found, exact) = (volume(&mesh), cubes.volume() as f64);
        let most = tolerance * cubes.area() as f64;
        assert!((found - exact).abs() < most, "{found}, not {exact}; {line}");
        let mut fewer = mesh;
        reduce(&mut fewer, &text, region, 2.0 * tolerance);
        if !fewer.is_proven() {
            println!("{:?}; {line}", fewer.unproven);
            unrounded += 1;
        }
        check_crossings(&fewer, &line);
        assert_eq!(euler(&fewer), (cubes.euler(), 0), "{line}");
    }
    let manifold = cases - skipped - empty;
    println!(
        "{cases} solids: {empty} empty, {skipped} not manifold, {proven} of {manifold} proven; \
         slowest {slowest:?}"
    );
    println!("{unrounded} cannot be rounded");
    assert!(20 * proven >= 19 * manifold, "{proven} of {manifold} are proven");
    assert_eq!(unrounded, 0, "cannot be rounded");
}
