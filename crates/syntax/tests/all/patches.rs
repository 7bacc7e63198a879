//! Parametric surfaces: how they are written, here and in other systems.

use crate::words::value_in;
use zeroset_ir::{Constant, NodeId};
use zeroset_parser::NoteKind;
use zeroset_syntax::{Document, Options, read};

fn document(text: &str) -> Document {
    read(text, &Options::default()).unwrap_or_else(|e| panic!("{}", e.render(None, text, false)))
}

/// The three coordinates of a document's last parametric surface at u = 0.75 and v = 2.5, and the
/// four ends of its ranges.
fn values(document: &Document) -> Vec<f64> {
    let patch = document.patches.all.last().expect("a parametric surface");
    let point = ["0.75", "2.5", "0"].map(|text| zeroset_syntax::constant(text).expect("a number"));
    let parameters: Vec<Constant> =
        document.parameters.iter().map(|parameter| parameter.value.clone()).collect();
    let value = |root: &NodeId| {
        let graph = &document.patches.graph;
        let bounds = value_in(graph, &parameters, *root, &point).expect("a value").bounds();
        assert!(bounds.hi - bounds.lo < 1e-9, "{bounds:?}");
        bounds.lo
    };
    patch.at.iter().chain(patch.ends.as_flattened()).map(value).collect()
}

/// Texts of several systems that all draw the same torus.
const TORUS: &[&str] = &[
    "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]",
    "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u = 0..2pi, v = 0..2pi",
    "((2 + cos v) cos u, (2 + cos v) sin u, sin v), 0 <= u <= 2pi, 0 <= v <= 2pi",
    "r(u, v) = ((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi] for v in [0, 2pi]",
    "((2 + cos t) cos s, (2 + cos t) sin s, sin t) for s in [0, 2pi], t in [0, 2pi]",
    "f(a) = 2 + cos a; (f(v) cos u, f(v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]",
    "R = 2 in [1, 3]; ((R + cos v) cos u, (R + cos v) sin u, sin v) for u in [0, R pi], v in [0, R pi]",
    "ParametricPlot3D[{(2 + Cos[v]) Cos[u], (2 + Cos[v]) Sin[u], Sin[v]}, {u, 0, 2 Pi}, {v, 0, 2 Pi}]",
    "ParametricPlot3D[(2 + Cos[v]) {Cos[u], Sin[u], 0} + {0, 0, Sin[v]}, {u, 0, 2 Pi}, {v, 0, 2 Pi}]",
    "r[u_] := {Cos[u], Sin[u], 0}\nParametricPlot3D[(2 + Cos[v]) r[u] + {0, 0, Sin[v]}, {u, 0, 2 Pi}, {v, 0, 2 Pi}]",
    "r(s) = (cos s, sin s, 0)\nr(u)*(2 + cos v) + (0, 0, sin v) for u in [0, 2pi], v in [0, 2pi]",
    "parametric_plot3d(((2+cos(v))*cos(u), (2+cos(v))*sin(u), sin(v)), (u, 0, 2*pi), (v, 0, 2*pi))",
    "plot3d_parametric_surface((2+cos(v))*cos(u), (2+cos(v))*sin(u), sin(v), (u, 0, 2*pi), (v, 0, 2*pi))",
    "Surface((2+cos(v)) cos(u), (2+cos(v)) sin(u), sin(v), u, 0, 2pi, v, 0, 2pi)",
    "fsurf(@(u,v) (2+cos(v)).*cos(u), @(u,v) (2+cos(v)).*sin(u), @(u,v) sin(v), [0 2*pi 0 2*pi])",
    "import numpy as np\nimport matplotlib.pyplot as plt\nu = np.linspace(0, 2*np.pi, 100)\nv = np.linspace(0, 2*np.pi, 100)\nu, v = np.meshgrid(u, v)\nX = (2 + np.cos(v)) * np.cos(u)\nY = (2 + np.cos(v)) * np.sin(u)\nZ = np.sin(v)\nfig = plt.figure()\nax = fig.add_subplot(projection='3d')\nax.plot_surface(X, Y, Z)\nplt.show()",
];

#[test]
fn a_torus_of_several_systems_is_the_same() {
    let (u, v) = (0.75_f64, 2.5_f64);
    let point = [(2.0 + v.cos()) * u.cos(), (2.0 + v.cos()) * u.sin(), v.sin()];
    let full = 2.0 * std::f64::consts::PI;
    for text in TORUS {
        let document = document(text);
        assert_eq!((document.patches.all.len(), document.surfaces.len()), (1, 0), "{text}");
        assert!(document.domain.is_none(), "{text}");
        let expected = point.into_iter().chain([0.0, full, 0.0, full]);
        for (found, expected) in values(&document).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{text}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_parametric_surface_is_echoed_as_it_is_read() {
    let text = "color red; (u, v, u v) for u in [-1, 1], v in [0, 2]\nhidden\nx = 1";
    let document = document(text);
    let patch = &document.patches.all[0];
    assert_eq!(patch.echo, "(u, v, u*v) for u in [-1, 1], v in [0, 2]");
    assert!(patch.color.is_some() && !patch.hidden && document.surfaces[0].hidden);
    assert_eq!(patch.names, ["u", "v"]);
    let again = read(&patch.echo, &Options::default()).expect("reads its own echo");
    assert_eq!(again.patches.all[0].echo, patch.echo);
}

#[test]
fn mistakes_in_parametric_surfaces_are_named() {
    let rows = [
        ("(u, v, 1) for u in [0, 1], u in [0, 1]", "two parameters are named `u`"),
        ("(u, v, x) for u in [0, 1], v in [0, 1]", "x"),
        ("(u, v) for u in [0, 1], v in [0, 1]", "coordinates"),
        ("(u, v, 1) for u in [1, 0], v in [0, 1]", "the lower end must be below"),
        ("(u, v, w) for u in [0, 1], v in [0, 1]", "`w` is not defined"),
        ("(u, v, 1) for u in [0, x], v in [0, 1]", "x"),
    ];
    for (text, part) in rows {
        let errors = read(text, &Options::default()).expect_err(text);
        let said = errors.render(None, text, false);
        assert!(said.contains(part), "{text}: {said}");
    }
}

#[test]
fn values_that_use_the_parameters_may_be_defined_before_the_command() {
    let command = "parametric_plot3d([r*cos(u), f_y, v], (u, 0, 2*pi), (v, 0, 1))";
    let text = format!("a = 2 in [1, 3]\nr = a + v\nf_y = r*sin(u)\n{command}");
    let document = document(&text);
    // The slider stays one.
    assert_eq!(document.parameters.len(), 1);
    assert_eq!((document.patches.all.len(), document.surfaces.len()), (1, 0));
    let (u, v, a) = (0.75_f64, 2.5_f64, 2.0);
    let found = values(&document);
    for (found, expected) in found.iter().zip([(a + v) * u.cos(), (a + v) * u.sin(), v]) {
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }
}

#[test]
fn lists_of_surfaces_are_read() {
    let one = "Surface(u cos(v), u sin(v), v, u, 0, 1, v, 0, pi)";
    let rows = [
        (format!("{{{one}, Surface(u, v, 3, u, 0, 1, v, 0, 1)}}"), vec![2.5, 3.0]),
        (format!("{one}\nSurface(u, v, 3, u, 0, 1, v, 0, 1)"), vec![2.5, 3.0]),
        ("Sequence(Surface(u, v, a v, u, 0, 1, v, 0, 1), a, 1, 3)".to_owned(), vec![2.5, 5.0, 7.5]),
        (
            "Sequence(Surface(u, v, a, u, 0, 1, v, 0, 1), a, 0, 1, 0.5)".to_owned(),
            vec![0.0, 0.5, 1.0],
        ),
    ];
    for (text, heights) in rows {
        let mut document = document(&text);
        let all = std::mem::take(&mut document.patches.all);
        let found: Vec<f64> = all
            .into_iter()
            .map(|patch| {
                document.patches.all = vec![patch];
                values(&document)[2]
            })
            .collect();
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        let is_same = found.len() == heights.len() && found.iter().zip(&heights).all(near);
        assert!(is_same, "{text}: {found:?}");
    }
}

#[test]
fn scripts_of_mathmod_are_refused_with_a_way_out() {
    let ranges = r#""Umin": ["0"], "Umax": ["1"], "Vmin": ["0"], "Vmax": ["1"]"#;
    let rows = [
        (
            format!(r#"{{"Param4D": {{"Fx": ["u"], "Fy": ["v"], "Fz": ["1"], {ranges}}}}}"#),
            "Param4D",
        ),
        (format!(r#"{{"Param3D": {{"Fx": ["NoiseW(u,v,1)"], "Fy": ["v"], {ranges}}}}}"#), "noise"),
        (r#"{"Param3D": {"Fx": ["u"], "Fy": ["v"], "Fz": ["1"]}}"#.to_owned(), "ranges"),
        (format!(r#"{{"Param3D": {{"Name": ["a"], {ranges}}}}}"#), "formula"),
    ];
    for (text, part) in rows {
        let errors = read(&text, &Options::default()).expect_err(&text);
        let said = errors.render(None, &text, false);
        assert!(said.contains(part) && said.contains("= help: "), "{text}: {said}");
    }
}

#[test]
fn a_function_of_three_js_is_refused_with_a_way_out() {
    let text = "function f(u, v, target) { target.set(u, v, 0); }\n\
                const g = new ParametricGeometry(f, 9, 9);";
    let errors = read(text, &Options::default()).expect_err("is not read");
    let said = errors.render(None, text, false);
    assert!(said.contains("three.js") && said.contains("write the coordinates"), "{said}");
}

#[test]
fn a_list_of_surfaces_draws_each() {
    let text = "ParametricPlot3D[{{u, v, 0}, {u, v, u v}, {0, u, v}}, {u, 0, 1}, {v, 0, 2}]";
    let document = document(text);
    assert_eq!(document.patches.all.len(), 3);
    assert_eq!(values(&document), [0.0, 0.75, 2.5, 0.0, 1.0, 0.0, 2.0]);
}

#[test]
fn infinite_ranges_are_cut_with_a_note() {
    for (range, ends) in [
        ("v in [-inf, inf]", [-5.0, 5.0]),
        ("v in (-∞, +∞)", [-5.0, 5.0]),
        ("v in R", [-5.0, 5.0]),
        ("v in ℝ", [-5.0, 5.0]),
        ("v in [0, oo]", [0.0, 10.0]),
        ("v = 7..Infinity", [7.0, 17.0]),
        ("-inf < v < 2", [-8.0, 2.0]),
    ] {
        let document = document(&format!("(v cos u, v sin u, u) for u in [0, 1], {range}"));
        assert_eq!(values(&document)[5..], ends, "{range}");
        let notes: Vec<&NoteKind> = document.notes.iter().map(|note| &note.kind).collect();
        let cut = NoteKind::CutRange { name: "v".to_owned(), length: 10 };
        assert_eq!(notes, [&cut], "{range}");
    }
    // Names of the text are its own.
    let named = document("R = 2 in [1, 3]; inf = 4\n(u, v, 0) for u in [0, inf], v in [0, R]");
    assert_eq!(values(&named)[3..], [0.0, 4.0, 0.0, 2.0]);
    assert!(named.notes.is_empty());
    for range in ["v in [inf, 3]", "v in [inf, inf]", "v in [0, -inf]"] {
        let text = format!("(u, v, 0) for u in [0, 1], {range}");
        assert!(read(&text, &Options::default()).is_err(), "{range}");
    }
}
