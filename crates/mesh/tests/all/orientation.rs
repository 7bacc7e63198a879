//! Closed pieces of an equation face out, whatever the sign of its function.

use crate::mesh_of;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use zeroset_mesh::{Connected, Mesh};

/// The volumes that the pieces of a mesh enclose, from the least to the greatest magnitude. They
/// are below 0 for pieces that face in.
fn volumes(mesh: &Mesh) -> Vec<f64> {
    let mut connected = Connected::new(mesh.vertices.len(), &mesh.triangles);
    let mut volumes: BTreeMap<u32, f64> = BTreeMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize]);
        *volumes.entry(connected.first(triangle[0])).or_default() += a.dot(b.cross(c)) / 6.0;
    }
    let mut volumes: Vec<f64> = volumes.into_values().collect();
    volumes.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    volumes
}

/// Compares the volumes of a mesh's pieces with exact ones.
fn check(text: &str, half: f64, exact: &[f64], turned: usize) {
    let mesh = mesh_of(text, half, 0.02);
    let found = volumes(&mesh);
    println!("{text}: volumes {found:.3?}, {} turned", mesh.turned);
    assert!(mesh.is_closed, "{text}");
    assert_eq!((found.len(), mesh.turned), (exact.len(), turned), "{text}: {found:?}");
    for (found, exact) in found.iter().zip(exact) {
        assert!((found - exact).abs() < 0.06 * exact.abs(), "{text}: {found}, not {exact}");
    }
}

/// The volume of a ball.
fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// The volume of a torus.
fn torus(radius: f64, tube: f64) -> f64 {
    2.0 * PI * PI * radius * tube * tube
}

#[test]
fn nests_face_out_for_either_sign() {
    let around = |radius: f64| format!("((sqrt(x^2+y^2)-2)^2+z^2-{})", radius * radius);
    let at = |x: f64, radius: f64| format!("((x-({x}))^2+y^2+z^2-{})", radius * radius);
    for (pieces, half, exact, nests) in [
        (vec![at(0.0, 1.0)], 1.5, vec![ball(1.0)], 1),
        (vec![at(0.0, 1.0), at(0.0, 2.0)], 2.5, vec![-ball(1.0), ball(2.0)], 1),
        (vec![at(-1.5, 1.0), at(1.5, 1.2)], 3.0, vec![ball(1.0), ball(1.2)], 2),
        (vec![around(0.4), around(0.8)], 3.0, vec![-torus(2.0, 0.4), torus(2.0, 0.8)], 1),
        // The ball is in the hole of the torus, and so outside of it.
        (vec![at(0.0, 0.8), around(0.6)], 3.0, vec![ball(0.8), torus(2.0, 0.6)], 2),
        // A ball, with a torus around it, in a ball.
        (
            vec![at(0.0, 0.8), around(0.6), at(0.0, 2.9)],
            3.0,
            vec![-ball(0.8), -torus(2.0, 0.6), ball(2.9)],
            1,
        ),
        // Two balls in a ball, one of them with a ball in it.
        (
            vec![at(1.4, 0.5), at(-1.4, 0.9), at(1.4, 1.0), at(0.0, 2.8)],
            3.0,
            vec![ball(0.5), -ball(0.9), -ball(1.0), ball(2.8)],
            1,
        ),
    ] {
        let product = pieces.join("*");
        check(&format!("{product} = 0"), half, &exact, 0);
        check(&format!("0 = {product}"), half, &exact, nests);
    }
    check("1 - x^2-y^2-z^2 = 0", 1.5, &[ball(1.0)], 1);
}

/// The equation of metaballs is usually written with f > 0 inside.
#[test]
fn metaballs_face_out() {
    let half = 3.0;
    let field = |at: DVec3| 1.0 / at.length_squared() + 1.0 / (at - DVec3::X).length_squared();
    let steps: usize = 100;
    let along = |k: usize| ((k as f64 + 0.5) / steps as f64 * 2.0 - 1.0) * half;
    let is_inside = |k: &usize| {
        let [x, y, z] = [k % steps, k / steps % steps, k / steps / steps].map(along);
        field(DVec3::new(x, y, z)) > 1.0
    };
    let inside = (0..steps.pow(3)).filter(is_inside).count();
    let volume = inside as f64 * (2.0 * half / steps as f64).powi(3);
    check("1/(x^2+y^2+z^2) + 1/((x-1)^2+y^2+z^2) = 1", half, &[volume], 1);
}

/// A plane between two balls is open, and its sides are those of the function's sign. The balls,
/// outside of which the signs differ, both face out.
#[test]
fn signs_may_differ_from_nest_to_nest() {
    let product = "z*(x^2+y^2+(z-1.5)^2-1)*(x^2+y^2+(z+1.5)^2-1)";
    for (text, up) in [(format!("{product} = 0"), 1.0), (format!("0 = {product}"), -1.0)] {
        let mesh = mesh_of(&text, 3.0, 0.05);
        assert!(!mesh.is_closed, "{text}");
        assert_eq!(mesh.turned, 1, "{text}");
        let mut found = volumes(&mesh);
        found.retain(|volume| volume.abs() > 1.0);
        assert_eq!(found.len(), 2, "{text}: {found:?}");
        assert!(found.iter().all(|volume| (volume / ball(1.0) - 1.0).abs() < 0.1), "{found:?}");
        let mut plane = 0;
        for corners in
            mesh.triangles.iter().map(|triangle| triangle.map(|k| mesh.vertices[k as usize]))
        {
            if corners.iter().all(|corner| corner.z.abs() < 0.1) {
                let [a, b, c] = corners;
                assert!((b - a).cross(c - a).z * up > 0.0, "{text}: {corners:?}");
                plane += 1;
            }
        }
        assert!(plane > 10, "{text}: {plane}");
    }
}

/// Open surfaces face where f > 0, and so do solids.
#[test]
fn open_surfaces_and_solids_stay() {
    for (text, f) in [
        ("z = 0.3x*y", (|at: DVec3| at.z - 0.3 * at.x * at.y) as fn(DVec3) -> f64),
        ("0.3x*y = z", |at| 0.3 * at.x * at.y - at.z),
        ("x^2+y^2 = 0.3", |at| at.x * at.x + at.y * at.y - 0.3),
        ("0.3 = x^2+y^2", |at| 0.3 - at.x * at.x - at.y * at.y),
        ("0.3 = x^2+y^2+z^2 {z > 0}", |at| 0.3 - at.length_squared()),
        ("x^2+y^2+z^2 <= 0.3", |at| at.length_squared() - 0.3),
        ("not x^2+y^2+z^2 < 0.3", |at| {
            (0.3 - at.length_squared()).max(at.abs().max_element() - 1.0)
        }),
    ] {
        let mesh = mesh_of(text, 1.0, 0.02);
        assert_eq!((mesh.turned, mesh.is_proven()), (0, true), "{text}");
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize]);
            let normal = (b - a).cross(c - a).normalize();
            let middle = (a + b + c) / 3.0;
            let [inner, outer] = [-0.05, 0.05].map(|by| f(middle + by * normal));
            assert!(inner < outer, "{text}: {middle} {normal}");
        }
    }
    let cavity = mesh_of("not x^2+y^2+z^2 < 0.3", 1.0, 0.02);
    assert!(volumes(&cavity)[0] < -0.6, "a hollow faces in");
}

/// A ball in a tube that the domain cuts: only the ball is closed.
#[test]
fn closed_pieces_within_open_ones_face_out() {
    for text in ["(x^2+y^2-1)*(x^2+y^2+z^2-0.25) = 0", "(1-x^2-y^2)*(x^2+y^2+z^2-0.25) = 0"] {
        let mesh = mesh_of(text, 1.5, 0.02);
        let inner = volumes(&mesh)[0];
        assert!((inner / ball(0.5) - 1.0).abs() < 0.1, "{text}: {inner}");
        assert_eq!(mesh.turned, usize::from(text.starts_with("(x")), "{text}");
    }
}
