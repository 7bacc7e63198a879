//! Surfaces of planes alone, whose meshes are exact.

use crate::flush::check_crossings;
use crate::shapes::{euler, volume};
use crate::{flat_mesh_in, mesh_by};
use fastrand::Rng;
use glam::DVec3;
use std::f64::consts::PI;
use zeroset_mesh::Mesh;
use zeroset_space::Region;
use zeroset_testkit::Effort;

fn region(half: f64) -> Region {
    Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a region")
}

#[test]
fn polyhedra_are_exact() {
    for (text, corners, number, exact) in [
        ("box(1, 2, 0.5) <= 0", 8, 2, 8.0),
        ("abs(x) + abs(y) + abs(z) <= 1.5", 6, 2, 4.5),
        ("2*abs(x) + abs(y)/2 + abs(z) = 1", 6, 2, 4.0 / 3.0),
        // The same function with the opposite sign: the closed piece of an equation faces out.
        ("1 - 2*abs(x) - abs(y)/2 - abs(z) = 0", 6, 2, 4.0 / 3.0),
        ("max(abs(x) - 1, abs(y) - 1, abs(z) - 1, 0) <= 0", 8, 2, 8.0),
        ("w = 0.7; box(w, w, w/2) <= 0", 8, 2, 4.0 * 0.7 * 0.7 * 0.7),
        ("shell(box(1,1,1), 0.001) <= 0", 16, 4, 8.0 - 1.998_f64.powi(3)),
        // A wedge, whose planes meet in no point of the grid.
        ("max(3*x + y - 1, y - 3*x - 1, -y - 1, abs(z) - 1) <= 0", 6, 2, 8.0 / 3.0),
        // Four planes through a corner of a step.
        (
            "union(intersect(box(1, 1.5, 1.5, (2, -1.5, 0.5)), -1*y-1*z-1), \
          box(1.5, 0.5, 1.5, (-0.5, -0.5, -1.5))) <= 0",
            14,
            2,
            18.0,
        ),
        // The domain cuts a solid, and closes it.
        ("x + y + z <= 0", 10, 2, 108.0),
    ] {
        let mesh = flat_mesh_in(text, region(3.0), 1.0);
        assert!(mesh.is_proven(), "{text}: {:?}", mesh.unproven);
        assert_eq!(euler(&mesh), (number, 0), "{text}");
        let found = volume(&mesh);
        assert!((found / exact - 1.0).abs() < 1e-12, "{text}: {found}, not {exact}");
        check_crossings(&mesh, text);
        // Faces are cut along planes of other faces, which adds corners.
        assert!(
            (corners..=2 * corners).contains(&mesh.vertices.len()),
            "{text}: {}",
            mesh.vertices.len()
        );
    }
}

#[test]
fn surfaces_that_touch_themselves_are_not_proven() {
    for text in [
        "union(box(1,1,1), box(0.5,0.5,0.5,(1.5,1.5,0))) <= 0",
        "union(box(1,1,1), box(0.5,0.5,0.5,(1.5,1.5,1.5))) <= 0",
        "max(abs(x), abs(y), abs(z) - abs(x) - abs(y)) <= 1e-13",
    ] {
        let mesh = flat_mesh_in(text, region(3.0), 1.0);
        assert!(!mesh.triangles.is_empty() && !mesh.is_proven(), "{text}");
    }
}

#[test]
fn other_surfaces_are_not_taken_for_polyhedra() {
    for text in [
        "max(abs(x), abs(y), z^2) = 1",
        "x + y = z",
        // A sheet, at which the function does not change its sign.
        "max(abs(z), abs(x) - 1, abs(y) - 1) = 0",
        // The function is 0 inside, or at the domain's faces.
        "max(abs(x) - 1, abs(y) - 1, abs(z) - 1, 0) = 0",
        "max(abs(x) - 2, abs(y) - 2, abs(z) - 1) = 0",
        "max(abs(x), abs(y)) = 1",
    ] {
        let mesh = |is_flat| mesh_by(text, region(2.0), 0.5, 2000, is_flat);
        let [flat, other] = [true, false].map(mesh);
        assert!(flat.triangles == other.triangles, "{text}: {}", flat.triangles.len());
    }
}

/// A random Boolean function of half-spaces, and whether it holds a point.
enum Solid {
    Half([i64; 4]),
    Union(Vec<Solid>),
    Common(Vec<Solid>),
}

impl Solid {
    fn random(random: &mut Rng, depth: usize) -> Self {
        if depth == 0 {
            return loop {
                let half = [3, 3, 3, 5].map(|most: i64| random.i64(-most + 1..most));
                if half[..3] != [0; 3] {
                    break Self::Half(half);
                }
            };
        }
        let all = (0..2 + random.usize(..2)).map(|_| Self::random(random, depth - 1)).collect();
        if random.bool() { Self::Union(all) } else { Self::Common(all) }
    }

    fn text(&self) -> String {
        let join = |all: &[Self]| all.iter().map(Self::text).collect::<Vec<_>>().join(", ");
        match self {
            Self::Half([x, y, z, constant]) => format!("{x}*x + {y}*y + {z}*z + {constant}/2"),
            Self::Union(all) => format!("min({})", join(all)),
            Self::Common(all) => format!("max({})", join(all)),
        }
    }

    fn value(&self, at: DVec3) -> f64 {
        let each = |all: &[Self]| -> Vec<f64> { all.iter().map(|one| one.value(at)).collect() };
        match self {
            Self::Half(half) => {
                let [x, y, z, constant] = half.map(|number| number as f64);
                DVec3::new(x, y, z).dot(at) + 0.5 * constant
            }
            Self::Union(all) => each(all).into_iter().fold(f64::INFINITY, f64::min),
            Self::Common(all) => each(all).into_iter().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// The winding number of a closed mesh around a point: the sum of the triangles' solid angles (van
/// Oosterom and Strackee, 1983), as a share of the whole sphere.
fn winding(mesh: &Mesh, at: DVec3) -> f64 {
    let angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize] - at);
        let (p, q, r) = (a.length(), b.length(), c.length());
        let below = p * q * r + a.dot(b) * r + b.dot(c) * p + c.dot(a) * q;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    mesh.triangles.iter().map(angle).sum::<f64>() / (4.0 * PI)
}

#[test]
fn random_polyhedra_hold_the_points_of_their_solids() {
    let Effort { seed, cases } = Effort::from_environment(0xf1a7, 300);
    let (mut inside, mut outside, mut proven, mut most) = (0, 0, 0, 0);
    for case in seed..seed + cases {
        let random = &mut Rng::with_seed(case);
        let depth = 1 + random.usize(..3);
        let solid = Solid::random(random, depth);
        let text = format!("{} <= 0", solid.text());
        let line = format!("seed {case:#x}: zeroset mesh '{text}' --domain=2");
        let mesh = flat_mesh_in(&text, region(2.0), 1.0);
        most = most.max(mesh.triangles.len());
        if mesh.is_proven() {
            proven += 1;
            assert_eq!(euler(&mesh).1, 0, "{line}");
            check_crossings(&mesh, &line);
        }
        for _ in 0..40 {
            let at = DVec3::from_array([(); 3].map(|()| 4.0 * random.f64() - 2.0));
            let value = solid.value(at);
            if value.abs() < 1e-3 {
                continue;
            }
            let (found, expected) = (winding(&mesh, at), if value < 0.0 { 1.0 } else { 0.0 });
            assert!((found - expected).abs() < 1e-6, "{found} at {at}, value {value}; {line}");
            *(if value < 0.0 { &mut inside } else { &mut outside }) += 1;
        }
    }
    println!(
        "seed {seed:#x}: {inside} points inside, {outside} outside, {proven} of {cases} proven, at most {most} triangles"
    );
    assert!(inside.min(outside) > 1000 && 2 * proven > cases);
}
