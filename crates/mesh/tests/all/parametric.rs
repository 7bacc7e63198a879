//! Meshes of parametric surfaces.

use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use zeroset_mesh::{MOST_CELLS, Mesh, ParametricOptions, parametric_mesh};
use zeroset_scene::program::Program;
use zeroset_space::{HalfSpace, Region};
use zeroset_syntax::read;
use zeroset_testkit::crossings;

fn mesh_of(text: &str, tolerance: f64) -> Mesh {
    mesh_with(text, tolerance, false)
}

fn mesh_with(text: &str, tolerance: f64, is_full: bool) -> Mesh {
    mesh_in(text, region(100.0), tolerance, is_full)
}

/// A cube around 0.
fn region(half: f64) -> Region {
    Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a region")
}

fn mesh_in(text: &str, region: Region, tolerance: f64, is_full: bool) -> Mesh {
    let document = read(text, &zeroset_syntax::Options::default()).expect(text);
    let whole = [zeroset_interval::Interval { lo: -1.0, hi: 1.0 }; 3];
    let program = Program::new(&document, whole).expect(text);
    let program = program.with_patches(&document).expect(text);
    let tree = program.patch(0).expect(text).tree().expect("a kernel");
    let options = ParametricOptions { region, tolerance, is_full, most_cells: MOST_CELLS };
    parametric_mesh(tree, &options, &|| true).expect("wanted")
}

/// Per edge, how many triangles run along it in either direction.
fn edges(mesh: &Mesh) -> HashMap<[u32; 2], [u32; 2]> {
    let mut counts = HashMap::<_, [u32; 2]>::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            counts.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    counts
}

fn euler(mesh: &Mesh) -> i64 {
    let [vertices, triangles] = [mesh.vertices.len(), mesh.triangles.len()].map(|n| n as i64);
    vertices - edges(mesh).len() as i64 + triangles
}

/// Closed surfaces, their Euler numbers, and whether they have two sides.
const CLOSED: [(&str, i64, bool); 8] = [
    ("(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]", 2, true),
    ("((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]", 0, true),
    // Klein's bottle of a figure 8: a side is turned around.
    (
        "r(u, v) = 2 + cos(u/2) sin(v) - sin(u/2) sin(2v); (r(u, v) cos u, r(u, v) sin u, sin(u/2) sin(v) + cos(u/2) sin(2v)) for u in [0, 2pi], v in [0, 2pi]",
        0,
        false,
    ),
    // The cross-cap: opposite points of a side are the same.
    (
        "(cos(u) sin(2v), sin(u) sin(2v), cos(v)^2 - cos(u)^2 sin(v)^2) for u in [0, 2pi], v in [0, pi/2]",
        1,
        false,
    ),
    // A triangle that turns by a third of a turn on its way around.
    (
        "s(u, v) = u/3 - 2v; (sin(u) (7 + cos(s(u, v)) + 2 cos(u/3 + v)), cos(u) (7 + cos(s(u, v)) + 2 cos(u/3 + v)), sin(s(u, v)) + 2 sin(u/3 + v)) for u in [-pi, pi], v in [-pi, pi]",
        0,
        true,
    ),
    // The horn torus: a sphere whose poles are the same point.
    ("((1 - cos v) cos u, (1 - cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]", 1, true),
    // The sphere twice, one over the other.
    ("(cos u cos v, sin u cos v, sin v) for u in [0, 4pi], v in [-pi/2, pi/2]", 2, true),
    (
        "((3 + cos v) cos(2u), (3 + cos v) sin(2u), sin(v) + sin(3u)) for u in [0, 2pi], v in [0, 2pi]",
        0,
        true,
    ),
];

#[test]
fn closed_surfaces_have_closed_meshes() {
    for (text, expected, has_sides) in CLOSED {
        for tolerance in [0.3, 0.01] {
            let mesh = mesh_of(text, tolerance);
            assert!(mesh.is_proven() && mesh.is_closed && mesh.is_parametric, "{text}");
            let edges = edges(&mesh);
            assert!(edges.values().all(|[one, other]| one + other == 2), "{text}: an edge");
            let is_sided = edges.values().all(|count| *count == [1, 1]);
            assert_eq!((euler(&mesh), is_sided), (expected, has_sides), "{text}, {tolerance}");
        }
    }
}

#[test]
fn triangles_face_outward_and_lie_within_the_tolerance() {
    // Turned inside out by its parameters.
    let sphere = "(cos u cos v, sin u cos v, sin v) for v in [-pi/2, pi/2], u in [0, 2pi]";
    for tolerance in [0.1, 0.01, 0.001] {
        let mesh = mesh_of(sphere, tolerance);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize]);
            let middle = (a + b + c) / 3.0;
            assert!((b - a).cross(c - a).dot(middle) > 0.0, "{a} {b} {c}");
            // Points between the vertices are the farthest.
            for point in [middle, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, a, b, c] {
                assert!((point.length() - 1.0).abs() <= tolerance, "{point}");
            }
        }
    }
}

#[test]
fn rims_stay_open() {
    for (text, expected) in [
        // A strip with one side and one rim.
        (
            "((2 + v cos(u/2)) cos u, (2 + v cos(u/2)) sin u, v sin(u/2)) for u in [0, 2pi], v in [-1, 1]",
            0,
        ),
        ("(u, v, u v) for u in [-1, 1], v in [-1, 1]", 1),
        // Covered twice: its rims are not glued to themselves.
        ("(cos u, sin u, v) for u in [0, 4pi], v in [0, 1]", 0),
        // A cone's tip is one point.
        ("(v cos u, v sin u, v) for u in [0, 2pi], v in [0, 1]", 1),
    ] {
        let mesh = mesh_of(text, 0.01);
        assert!(mesh.is_proven() && !mesh.is_closed, "{text}");
        assert!(edges(&mesh).values().all(|[one, other]| one + other <= 2), "{text}");
        assert_eq!(euler(&mesh), expected, "{text}");
    }
}

#[test]
fn gaps_are_told() {
    let steps = mesh_of("(u, v, floor(3u)/3) for u in [-1, 1], v in [-1, 1]", 0.01);
    assert!(!steps.unproven.is_empty() && !steps.is_proven());
    for triangle in &steps.triangles {
        let [a, b, c] = triangle.map(|vertex| steps.vertices[vertex as usize].z);
        assert!(a == b && b == c, "a wall across a jump");
    }
    let pole = mesh_of("(u, v, 1/u) for u in [-1, 1], v in [0, 1]", 0.05);
    assert!(!pole.unproven.is_empty() && pole.vertices.iter().all(|at| at.is_finite()));
    let half = mesh_of("(u, v, sqrt(u)) for u in [-1, 1], v in [0, 1]", 0.01);
    assert!(half.vertices.iter().all(|at| at.x >= -0.01), "where it has no value");
    // Too few cells: the distance is not proven.
    let document = read(CLOSED[0].0, &zeroset_syntax::Options::default()).expect("a sphere");
    let whole = [zeroset_interval::Interval { lo: -1.0, hi: 1.0 }; 3];
    let program = Program::new(&document, whole).expect("a sphere");
    let program = program.with_patches(&document).expect("a sphere");
    let tree = program.patch(0).expect("a sphere").tree().expect("a kernel");
    let region = region(2.0);
    let few = ParametricOptions { region, tolerance: 1e-6, is_full: false, most_cells: 50 };
    let coarse = parametric_mesh(tree, &few, &|| true).expect("wanted");
    assert!(coarse.far > 0 && !coarse.is_proven() && coarse.is_closed);
    assert!(parametric_mesh(tree, &few, &|| false).is_none());
}

/// The distance of a point from a triangle.
fn distance(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let is_inside = [[a, b], [b, c], [c, a]]
        .iter()
        .all(|[p, q]| (*q - *p).cross(point - *p).dot(normal) >= 0.0);
    if is_inside && normal.length() > 0.0 {
        return (point - a).dot(normal.normalize()).abs();
    }
    let to_edge = |[p, q]: [DVec3; 2]| {
        let share = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        (p + share * (q - p)).distance(point)
    };
    [[a, b], [b, c], [c, a]].map(to_edge).into_iter().fold(f64::INFINITY, f64::min)
}

/// A surface, as text and as a function, the ends of u and v, and the most triangles that it needs.
type Known = (&'static str, fn(f64, f64) -> [f64; 3], [[f64; 2]; 2], usize);

/// Divisions by bounds of whole cells had 2.5 to 4 times as many triangles.
const KNOWN: [Known; 6] = [
    (
        "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]",
        |u, v| [u.cos() * v.cos(), u.sin() * v.cos(), v.sin()],
        [[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]],
        1600,
    ),
    (
        "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]",
        |u, v| [(2.0 + v.cos()) * u.cos(), (2.0 + v.cos()) * u.sin(), v.sin()],
        [[0.0, TAU], [0.0, TAU]],
        4000,
    ),
    (
        "(u - u^3/3 + u v^2, v - v^3/3 + v u^2, u^2 - v^2) for u in [-2, 2.1], v in [-2, 2]",
        |u, v| {
            let [x, y] = [u - u.powi(3) / 3.0 + u * v * v, v - v.powi(3) / 3.0 + v * u * u];
            [x, y, u * u - v * v]
        },
        [[-2.0, 2.1], [-2.0, 2.0]],
        5200,
    ),
    (
        "(v cos(u), v sin(u), u/4 + v^2) for u in [-pi, 2pi], v in [-0.2, 1]",
        |u, v| [v * u.cos(), v * u.sin(), u / 4.0 + v * v],
        [[-PI, TAU], [-0.2, 1.0]],
        1700,
    ),
    // A peak, at which both directions bend the same way.
    (
        "(u, v, exp(-20 (u^2 + v^2))) for u in [-1.1, 1], v in [-1, 0.9]",
        |u, v| [u, v, (-20.0 * (u * u + v * v)).exp()],
        [[-1.1, 1.0], [-1.0, 0.9]],
        1000,
    ),
    (
        "(3u, 3v, 0.3) for u in [-1, 1], v in [-1, 1]",
        |u, v| [3.0 * u, 3.0 * v, 0.3],
        [[-1.0, 1.0], [-1.0, 1.0]],
        72,
    ),
];

#[test]
fn each_point_of_the_surface_is_near_few_triangles() {
    const TOLERANCE: f64 = 0.01;
    for (text, surface, [us, vs], most) in KNOWN {
        let mesh = mesh_of(text, TOLERANCE);
        let count = mesh.triangles.len();
        assert!(mesh.is_proven(), "{text}");
        let at = |number: u32| mesh.vertices[number as usize];
        let triangles: Vec<[DVec3; 3]> = mesh.triangles.iter().map(|one| one.map(at)).collect();
        let mut random = fastrand::Rng::with_seed(68);
        let mut farthest = 0.0_f64;
        for _ in 0..4000 {
            let [u, v] = [us, vs].map(|[low, high]| low + (high - low) * random.f64());
            let point = DVec3::from_array(surface(u, v));
            let nearest = triangles.iter().map(|one| distance(point, *one));
            farthest = farthest.max(nearest.fold(f64::INFINITY, f64::min));
        }
        println!("{text}: {count} triangles, {farthest}");
        assert!(farthest <= TOLERANCE, "{text}: {farthest}");
        assert!(count <= most, "{text}: {count} triangles");
    }
}

#[test]
fn colors_of_vertices_have_more_triangles() {
    let [few, many] = [false, true].map(|is_full| mesh_with(KNOWN[0].0, 0.01, is_full));
    assert!(3 * few.triangles.len() < 2 * many.triangles.len() && many.is_proven());
}

#[test]
fn crossings_are_those_of_exact_predicates() {
    for (text, expected) in [
        (KNOWN[0].0, "none"),
        (KNOWN[1].0, "none"),
        (KNOWN[2].0, "crossing"),
        (KNOWN[3].0, "none"),
        (CLOSED[2].0, "crossing"),
        (CLOSED[3].0, "crossing"),
        // The sheets cross where both have edges.
        (
            "(u - u^3/3 + u v^2, v - v^3/3 + v u^2, u^2 - v^2) for u in [-2, 2], v in [-2, 2]",
            "touching",
        ),
        // The cone through its tip, which is a line in the rectangle, and the sphere twice.
        ("(v cos u, v sin u, v) for u in [0, 2pi], v in [-1, 1]", "touching"),
        (CLOSED[6].0, "touching"),
    ] {
        let mesh = mesh_of(text, 0.02);
        let found = mesh.crossings.expect("a parametric surface");
        let vertices: Vec<[f64; 3]> = mesh.vertices.iter().map(|at| at.to_array()).collect();
        let exact = crossings(&vertices, &mesh.triangles);
        println!("{text}: {found:?}, {} pairs meet, {} flat", exact.pairs.len(), exact.flat.len());
        assert!(found.crossing <= exact.pairs.len(), "{text}");
        assert!(found.crossing + found.touching >= exact.pairs.len(), "{text}");
        assert!(found.flat >= exact.flat.len(), "{text}");
        let said = match (found.crossing, found.touching, found.flat) {
            (0, 0, 0) => "none",
            (0, ..) => "touching",
            _ => "crossing",
        };
        assert_eq!(said, expected, "{text}");
        assert_eq!(found.is_none(), expected == "none", "{text}");
        assert_eq!(found.place.is_some(), expected != "none", "{text}");
    }
}

/// The vertices on edges of one triangle.
fn rim(mesh: &Mesh) -> Vec<DVec3> {
    let edges = edges(mesh);
    let open = edges.iter().filter(|(_, [one, other])| one + other == 1);
    open.flat_map(|(ends, _)| ends.map(|end| mesh.vertices[end as usize])).collect()
}

#[test]
fn the_domain_cuts_a_mesh() {
    const TOLERANCE: f64 = 0.01;
    let half_space = |normal: DVec3, offset| {
        let clip = HalfSpace { normal, offset };
        region(3.0).with_clip(clip).expect("a plane")
    };
    let oblique = DVec3::new(1.0, 2.0, -2.0);
    let [sphere, torus, .., flat] = KNOWN;
    for (known, region, expected) in [
        // Six holes, and one.
        (sphere, region(0.8), -4),
        (sphere, half_space(oblique, 1.5), 1),
        (sphere, Region::new(DVec3::new(-3.0, -3.0, 0.5), DVec3::splat(3.0)).expect("a box"), 1),
        // Half a torus.
        (torus, half_space(DVec3::NEG_X, 0.0), 0),
        (torus, region(2.0).with_ball(), 0),
        (flat, region(2.0).with_ball(), 1),
    ] {
        let (text, surface, [us, vs], _) = known;
        let mesh = mesh_in(text, region, TOLERANCE, false);
        assert!(mesh.is_proven() && !mesh.is_closed, "{text}, {region:?}");
        assert_eq!(euler(&mesh), expected, "{text}, {region:?}");
        assert!(edges(&mesh).values().all(|[one, other]| *one <= 1 && *other <= 1), "{text}");
        assert!(mesh.crossings.expect("a parametric surface").is_none(), "{text}");
        assert!(mesh.vertices.iter().all(|at| region.is_near(*at, 1e-6)), "{text}, {region:?}");
        let beyond = |at: &DVec3| (region.low() - *at).max(*at - region.high()).max_element();
        assert!(mesh.vertices.iter().all(|at| beyond(at) <= 1e-7), "{text}, {region:?}");
        // The rim is on the boundary.
        let rim = rim(&mesh);
        assert!(rim.len() > 20 && rim.iter().all(|at| !region.is_near(*at, -1e-6)), "{region:?}");
        let at = |number: u32| mesh.vertices[number as usize];
        let triangles: Vec<[DVec3; 3]> = mesh.triangles.iter().map(|one| one.map(at)).collect();
        let middles = rim.chunks(2).map(|ends| ends[0].midpoint(ends[1]));
        assert!(middles.into_iter().all(|at| !region.is_near(at, -TOLERANCE)), "{region:?}");
        let mut random = fastrand::Rng::with_seed(68);
        let mut inside = 0;
        for _ in 0..1500 {
            let [u, v] = [us, vs].map(|[low, high]| low + (high - low) * random.f64());
            let point = DVec3::from_array(surface(u, v));
            let nearest = triangles.iter().map(|one| distance(point, *one));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            if region.is_near(point, -TOLERANCE) {
                inside += 1;
                assert!(nearest <= TOLERANCE, "{text}, {region:?}: {point} is {nearest} away");
            } else if !region.is_near(point, TOLERANCE) {
                // Nothing is left outside.
                assert!(nearest > 0.9 * TOLERANCE, "{text}, {region:?}: {point}, {nearest}");
            }
        }
        assert!(inside > 100, "{text}, {region:?}: {inside} points inside");
    }
}

#[test]
fn a_domain_that_touches_or_misses_the_surface_cuts_nothing() {
    let text = KNOWN[0].0;
    for tolerance in [0.1, 0.003, 1e-4] {
        let mesh = mesh_in(text, region(1.0), tolerance, true);
        assert!(mesh.is_proven() && mesh.is_closed && euler(&mesh) == 2, "{tolerance}");
    }
    let beside = Region::new(DVec3::splat(0.7), DVec3::splat(2.0)).expect("a box");
    let mesh = mesh_in(text, beside, 0.001, false);
    assert!(mesh.triangles.is_empty() && mesh.is_proven() && !mesh.is_closed);
    // Cells outside stay large.
    let low = DVec3::new(0.6, -0.01, 0.79);
    let small = Region::new(low, low + DVec3::new(0.02, 0.02, 0.02)).expect("a box");
    let mesh = mesh_in(text, small, 1e-6, false);
    assert!(mesh.is_proven() && (20..2000).contains(&mesh.cells), "{} cells", mesh.cells);
}
