//! Builders against their definitions, written here by hand: which points are inside, how far the
//! surface is, and at which point a moved solid is evaluated.

use std::f64::consts::{PI, TAU};
use zeroset_ops::{BUILDERS, Distance};
use zeroset_syntax::{Options, read};
use zeroset_testkit::{Adversarial, Defined, Oracle, Rng};

type Point = [f64; 3];

/// Half the side of the cube in which surfaces are sampled.
const REACH: f64 = 3.2;
/// Distance between neighbors of the grid.
const STEP: f64 = 0.08;
/// Random points are at most this far from the origin on each axis.
const NEAR: f64 = 1.5;

/// The function that a text draws, by the oracle. The text has no sliders.
fn function(text: &str) -> impl Fn(Point) -> f64 + use<> {
    let document = read(text, &Options::default());
    let document = document.unwrap_or_else(|errors| panic!("{}", errors.render(None, text, false)));
    let root = document.surfaces[document.surfaces.len() - 1].root;
    let graph: &'static zeroset_ir::Graph = Box::leak(Box::new(document.graph));
    let oracle = Oracle::new(graph, &[root]);
    let text = text.to_owned();
    move |point| {
        let claim = oracle.at(point, &[])[0];
        assert!(claim.defined == Defined::Yes && claim.hi - claim.lo < 1e-9, "{text} at {point:?}");
        f64::midpoint(claim.lo, claim.hi)
    }
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// The distance to a box that reaches from −a to a; 0 inside.
fn from_box(p: Point, a: Point) -> f64 {
    length([0, 1, 2].map(|axis| p[axis] - p[axis].clamp(-a[axis], a[axis])))
}

/// The distance to the line from p to q.
fn from_line(at: Point, p: Point, q: Point) -> f64 {
    let (along, way) = (minus(q, p), minus(at, p));
    let t = (dot(way, along) / dot(along, along)).clamp(0.0, 1.0);
    length(minus(way, along.map(|part| t * part)))
}

/// The point turned about an axis through the origin, as a screw would be.
fn turned(p: Point, angle: f64, axis: Point) -> Point {
    let k = axis.map(|part| part / length(axis));
    let cross = [k[1] * p[2] - k[2] * p[1], k[2] * p[0] - k[0] * p[2], k[0] * p[1] - k[1] * p[0]];
    let along = dot(k, p);
    [0, 1, 2]
        .map(|i| p[i] * angle.cos() + cross[i] * angle.sin() + k[i] * along * (1.0 - angle.cos()))
}

/// Returns whether a point is inside the solid that the usage of a builder describes.
fn is_inside(usage: &str, p: Point) -> bool {
    let [x, y, z] = p;
    let around = x.hypot(y);
    match usage {
        "sphere(1)" => length(p) < 1.0,
        "sphere((2, 0, 0), 1)" | "translate(sphere(1), 2, 0, 0)" => length([x - 2.0, y, z]) < 1.0,
        "box(2, 1, 1)" => x.abs() < 2.0 && y.abs() < 1.0 && z.abs() < 1.0,
        "box(1)" => x.abs() < 1.0 && y.abs() < 1.0 && z.abs() < 1.0,
        "rounded_box(2, 1, 1, 0.2)" => from_box(p, [1.8, 0.8, 0.8]) < 0.2,
        "rounded_box(1, 0.2)" => from_box(p, [0.8; 3]) < 0.2,
        "cylinder(0.5, 1)" => around < 0.5 && z.abs() < 1.0,
        "cylinder((0, 0, 0), (1, 1, 1), 0.2)" => {
            let along = x + y + z;
            0.0 < along && along < 3.0 && length([x, y, z].map(|part| part - along / 3.0)) < 0.2
        }
        "cone(0.5, 1)" => z > -1.0 && around < 0.25 * (1.0 - z),
        "cone(0.5, 0.2, 1)" => z.abs() < 1.0 && around < 0.35 - 0.15 * z,
        "torus(1, 0.3)" => (around - 1.0).hypot(z) < 0.3,
        "capsule(0.3, 1)" => from_line(p, [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]) < 0.3,
        "capsule((0, 0, 0), (1, 1, 1), 0.2)" => from_line(p, [0.0; 3], [1.0; 3]) < 0.2,
        "ellipsoid(2, 1, 1)" | "scale(sphere(1), 2, 1, 1)" => {
            (x / 2.0).powi(2) + y * y + z * z < 1.0
        }
        "halfspace(0, 0, 1)" => z < 0.0,
        "halfspace((0, 0, 1), 0.5)" => z < 0.5,
        "circle(1)" => around < 1.0,
        "rectangle(2, 1)" => x.abs() < 2.0 && y.abs() < 1.0,
        "polygon(6, 1)" => {
            let angle = y.atan2(x).rem_euclid(PI / 3.0);
            around * angle.min(PI / 3.0 - angle).cos() < 1.0
        }
        "extrude(circle(1), 0.5)" | "revolve(rectangle(1, 0.5))" => around < 1.0 && z.abs() < 0.5,
        "revolve(rectangle(0.2, 0.5), 1)" => (around - 1.0).abs() < 0.2 && z.abs() < 0.5,
        "rotate(box(2, 1, 1), 30°)" => {
            is_inside("box(2, 1, 1)", turned(p, -PI / 6.0, [0.0, 0.0, 1.0]))
        }
        "rotate(box(2, 1, 1), 30°, (1, 0, 0))" => {
            is_inside("box(2, 1, 1)", turned(p, -PI / 6.0, [1.0, 0.0, 0.0]))
        }
        "scale(sphere(1), 2)" => length(p) < 2.0,
        "mirror(sphere(1, (1, 0, 0)), 1, 0, 0)" => length([x + 1.0, y, z]) < 1.0,
        "repeat(sphere(1), (3, 0, 0), 5)" => {
            (0..5).any(|i| length([x - 3.0 * f64::from(i), y, z]) < 1.0)
        }
        "repeat(sphere(1), 3, 3, 0)" => {
            let cell = |x: f64| (x + 1.5).rem_euclid(3.0) - 1.5;
            length([cell(x), cell(y), z]) < 1.0
        }
        "ring(sphere(1, (3, 0, 0)), 8)" => (0..8).any(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 8.0).sin_cos();
            length([x - 3.0 * cos, y - 3.0 * sin, z]) < 1.0
        }),
        "shell(sphere(1), 0.1)" => 0.9 < length(p) && length(p) < 1.0,
        "offset(box(1), 0.2)" => from_box(p, [1.0; 3]) < 0.2,
        other => panic!("which points are inside {other}?"),
    }
}

/// Points of the surface, found by halving edges of a grid whose ends lie on different sides.
fn surface(usage: &str) -> Vec<Point> {
    let count = (2.0 * REACH / STEP) as usize;
    // The grid avoids planes in which many surfaces lie.
    let place = |index: usize| index as f64 * STEP - REACH + 0.013;
    let at = |i: [usize; 3]| i.map(place);
    let side = count + 1;
    let index = |i: [usize; 3]| (i[0] * side + i[1]) * side + i[2];
    let mut inside = vec![false; side * side * side];
    let all = move || {
        (0..side).flat_map(move |i| (0..side).flat_map(move |j| (0..side).map(move |k| [i, j, k])))
    };
    for i in all() {
        inside[index(i)] = is_inside(usage, at(i));
    }
    let mut points = Vec::new();
    for i in all() {
        for axis in 0..3 {
            let mut next = i;
            next[axis] += 1;
            if next[axis] == side || inside[index(i)] == inside[index(next)] {
                continue;
            }
            let (mut low, mut high) = (at(i), at(next));
            for _ in 0..30 {
                let middle = [0, 1, 2].map(|axis| f64::midpoint(low[axis], high[axis]));
                if is_inside(usage, middle) == inside[index(i)] {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            points.push(low);
        }
    }
    points
}

fn random_point(rng: &mut Rng, reach: f64) -> Point {
    [0; 3].map(|_| reach * (2.0 * f64::uniform(rng) - 1.0))
}

#[test]
fn values_are_the_distances_that_the_table_promises() {
    let seed = 0xb11d;
    println!("seed {seed:#x}");
    let mut rng = Rng::with_seed(seed);
    let mut compared = 0;
    for row in BUILDERS {
        let usage = row.usage;
        let value = function(usage);
        let surface = surface(usage);
        assert!(surface.len() > 300, "{usage}: {}", surface.len());
        for _ in 0..150 {
            let (p, q) = (random_point(&mut rng, NEAR), random_point(&mut rng, NEAR));
            let q = if rng.bool() { q } else { [0, 1, 2].map(|k| p[k] + 0.05 * q[k]) };
            let (f, g) = (value(p), value(q));
            assert_eq!(f < 0.0, is_inside(usage, p), "{usage} at {p:?}: {f}");
            let apart = length(minus(p, q));
            assert!((f - g).abs() <= apart + 1e-9, "{usage}: {f} at {p:?}, {g} at {q:?}");
            let nearest =
                surface.iter().map(|s| length(minus(*s, p))).fold(f64::INFINITY, f64::min);
            if nearest > REACH - NEAR {
                continue;
            }
            compared += 1;
            assert!(f.abs() <= nearest + 1e-7, "{usage} at {p:?}: {f}, {nearest}");
            // The builders of the examples move and change exact solids.
            if matches!(row.distance, Distance::Exact | Distance::Same) {
                assert!(f.abs() >= nearest - 1.5 * STEP, "{usage} at {p:?}: {f}, {nearest}");
            }
        }
    }
    assert!(compared > 3000, "{compared}");
}

/// Exact distances are those of the nearest point, not of the nearest plane.
#[test]
fn bounds_are_not_called_exact() {
    let corner = function("box(1)")([2.0, 2.0, 2.0]);
    assert!((corner - 3_f64.sqrt()).abs() < 1e-12, "{corner}");
    let tip = function("cone(0.5, 1)")([0.0, 0.0, 2.0]);
    assert!(tip < 0.9, "{tip}");
}

/// A random move: its text around a solid, and the point at which the solid is evaluated.
fn random_move(rng: &mut Rng, inner: &str, p: Point) -> (String, Point, f64) {
    let v = [0; 3].map(|_| f64::from(rng.i32(-8..=8)) / 4.0);
    let n = [1.0, v[1], v[2]];
    match rng.u32(0..5) {
        0 => {
            let text = format!("translate({inner}, {}, {}, {})", v[0], v[1], v[2]);
            (text, minus(p, v), 1.0)
        }
        1 => {
            let text = format!("rotate({inner}, {})", v[0]);
            (text, turned(p, -v[0], [0.0, 0.0, 1.0]), 1.0)
        }
        2 => {
            let text = format!("rotate({inner}, {}, (1, {}, {}))", v[0], n[1], n[2]);
            (text, turned(p, -v[0], n), 1.0)
        }
        3 => {
            let across = 2.0 * dot(n, p) / dot(n, n);
            let text = format!("mirror({inner}, 1, {}, {})", n[1], n[2]);
            (text, minus(p, n.map(|part| across * part)), 1.0)
        }
        _ => {
            let k = f64::from(rng.u32(1..9)) / 4.0;
            (format!("scale({inner}, {k})"), p.map(|part| part / k), k)
        }
    }
}

#[test]
fn moves_evaluate_the_solid_at_the_point_moved_by_hand() {
    let seed = 0xb11e;
    println!("seed {seed:#x}");
    let mut rng = Rng::with_seed(seed);
    for _ in 0..400 {
        let solids = ["box(1, 0.5, 0.3)", "x^2 + y - z", "torus(1, 0.3)", "union(x, part)"];
        let solid = solids[rng.u32(0..4) as usize];
        let mut text = solid.to_owned();
        // The outermost move is the first to change the point, so moves are made from inside out.
        let start = random_point(&mut rng, 2.0);
        let count = rng.u32(1..6);
        let moves: Vec<u64> = (0..count).map(|_| rng.u64(0..u64::MAX)).collect();
        for seed in &moves {
            text = random_move(&mut Rng::with_seed(*seed), &text, start).0;
        }
        let (mut point, mut factor) = (start, 1.0);
        for seed in moves.iter().rev() {
            let (_, next, k) = random_move(&mut Rng::with_seed(*seed), "", point);
            (point, factor) = (next, factor * k);
        }
        let head = "part = box(0.2, 0.4, 0.3, (1, 0, 0))\n";
        let moved = function(&format!("{head}{text}"))(start);
        let by_hand = factor * function(&format!("{head}{solid}"))(point);
        assert!((moved - by_hand).abs() < 1e-8, "{text} at {start:?}: {moved}, {by_hand}");
    }
}

#[test]
fn definitions_and_functions_of_solids_move_as_what_they_stand_for() {
    let at = |text: &str| function(text)([0.3, -0.4, 0.9]);
    let same = |left: &str, right: &str| {
        let (left_value, right_value) = (at(left), at(right));
        assert!((left_value - right_value).abs() < 1e-12, "{left}, {right}");
    };
    same("part = box(1, 0.5, 0.3)\ntranslate(part, 1, 0, 0)", "box(1, 0.5, 0.3, (1, 0, 0))");
    same(
        "twice(s) = union(s, translate(s, 0, 0, 1))\nring(twice(twice(sphere(0.1, (2, 0, 0)))), 5)",
        "ring(repeat(sphere(0.1, (2, 0, 0)), (0, 0, 1), 3), 5)",
    );
    same("f(x, y, z) = x^2 - y*z\ntranslate(f(x, y, z), 1, 2, 3)", "(x-1)^2 - (y-2)*(z-3)");
    // The vector of a move may depend on the point: it is that of the point before the move.
    same("translate(x + 2*y, 0, x*z, 0)", "x + 2*(y - x*z)");
    same("rotate(translate(x - y, z, 0, 0), 90°)", "y - z + x");
    same("n = 3\nrepeat(sphere(0.1), (1, 0, 0), n)", "repeat(sphere(0.1), 1, 0, 0, 3)");
    same("iterate(mirror, 2, sphere(1, (1, 0, 0)), vec3(1, 0, 0))", "sphere(1, (1, 0, 0))");
    same("translate(3, 1, 0, 0) - x", "3 - x");
}

#[test]
fn overlapping_copies_are_all_there() {
    // Each sphere reaches over three of its neighbors.
    let copies = function("repeat(sphere(2), (1, 0, 0), 9)");
    let turned_copies = function("ring(sphere(2, (1, 0, 0)), 7)");
    let mut rng = Rng::with_seed(0xb11f);
    for _ in 0..200 {
        let p = random_point(&mut rng, 10.0);
        let each = |center: Point| length(minus(p, center)) - 2.0;
        let row = (0..9).map(|i| each([f64::from(i), 0.0, 0.0])).fold(f64::INFINITY, f64::min);
        assert!((copies(p) - row).abs() < 1e-9, "{p:?}");
        let ring = (0..7).map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 7.0).sin_cos();
            each([cos, sin, 0.0])
        });
        let ring = ring.fold(f64::INFINITY, f64::min);
        assert!((turned_copies(p) - ring).abs() < 1e-9, "{p:?}");
    }
}

#[test]
fn a_cell_shows_what_the_shape_has_within_it() {
    let cells = function("repeat(sphere(1.2, (0.5, 0, 0)), 2, 0, 4)");
    for (p, cell) in [
        ([0.9, 0.0, 0.0], [0.9, 0.0, 0.0]),
        // The sphere of the first cell reaches to here. It is cut at x = 1.
        ([1.1, 0.0, 0.0], [-0.9, 0.0, 0.0]),
        ([2.9, 5.0, 7.0], [0.9, 5.0, -1.0]),
        ([-3.2, 0.5, -9.0], [0.8, 0.5, -1.0]),
    ] {
        let expected = length(minus(cell, [0.5, 0.0, 0.0])) - 1.2;
        assert!((cells(p) - expected).abs() < 1e-9, "{p:?}");
    }
}

#[test]
fn nested_moves_and_shared_solids_cost_what_their_result_costs() {
    let nodes = |text: &str| {
        let document = read(text, &Options::default());
        document.unwrap_or_else(|errors| panic!("{text}: {errors}")).graph.len()
    };
    // A part is added and all is moved, 100 times.
    let grown = |count: usize| {
        let lines = (1..=count)
            .map(|k| format!("u{k} = union(translate(u{}, 0.1, 0, 0), sphere(0.{k}))\n", k - 1));
        format!("u0 = box(1)\n{}u{count}", lines.collect::<String>())
    };
    let (some, more) = (nodes(&grown(40)), nodes(&grown(80)));
    assert!(more < 2 * some + 100, "{some}, {more}");
    // Both halves of each union are one solid.
    let shared = |count: usize| {
        let half = |k: usize| format!("translate(u{k}, 1, 0, 0)");
        let lines =
            (1..=count).map(|k| format!("u{k} = union({}, 1 + {})\n", half(k - 1), half(k - 1)));
        format!("u0 = box(1)\n{}u{count}", lines.collect::<String>())
    };
    let (some, more) = (nodes(&shared(40)), nodes(&shared(80)));
    assert!(more < 2 * some + 100, "{some}, {more}");
    // Both halves of each union differ, so there are 2^40 parts.
    let lines = (1..=40).map(|k| {
        let k = k - 1;
        format!("u{} = union(translate(u{k}, 1, 0, 0), translate(u{k}, 0, 1, 0))\n", k + 1)
    });
    let text = format!("u0 = box(1)\n{}u40", lines.collect::<String>());
    let errors = read(&text, &Options::default()).expect_err("too large");
    assert!(errors.to_string().contains("operations"), "{errors}");
}

#[test]
fn a_moved_solid_is_outside_where_its_function_has_no_value() {
    let document =
        read("translate(sqrt(x) - 1, 1, 0, 0) <= 0", &Options::default()).expect("reads");
    let root = document.surfaces[0].root;
    let oracle = Oracle::new(&document.graph, &[root]);
    for (x, is_outside) in [(0.5, true), (1.5, false), (2.5, true)] {
        let claim = oracle.at([x, 0.0, 0.0], &[])[0];
        assert_eq!(claim.defined, Defined::Yes);
        assert_eq!(claim.lo > 0.0, is_outside, "{x}: {claim:?}");
    }
}
