//! Wrong use of the library gives one clear error, worded as on the command line, and no panic.

#[allow(dead_code)] // the tests of the program use all of it
#[path = "../program/cli_support/mod.rs"]
mod cli_support;

pub use cli_support::Sandbox;
use std::time::Duration;
use zeroset::{
    Camera, Domain, Error, ErrorKind, Function, MeshSettings, Ray, Scene, Settings, TraceSettings,
};

const INFINITY: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;

/// Runs the program, which must succeed.
pub fn run(place: &Sandbox, arguments: &[&str]) {
    place.run(arguments).ok();
}

fn said(arguments: &[&str]) -> String {
    let run = Sandbox::new().run(&[&["render"], arguments, &["-o", "a.png"]].concat());
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    run.stderr
}

#[test]
fn wrong_texts_are_pointed_at_as_on_the_command_line() {
    for text in ["x + foo(y)", "(x + * 1", "x $ y\nz = sinn(x)\nr = ", "x^2+y^2+", "f(x)=f(x)+1"] {
        let error = Scene::read(text).expect_err("wrong");
        assert_eq!(said(&[text]), format!("{error}\n"));
        assert_eq!(Function::parse(text).expect_err("wrong"), error);
        assert_eq!((error.kind(), format!("{error:?}")), (ErrorKind::Syntax, error.to_string()));
        assert!(!error.diagnostics().is_empty());
        let parts: Vec<String> = error.diagnostics().iter().map(ToString::to_string).collect();
        assert_eq!(parts.join("\n\n"), error.to_string());
        for diagnostic in error.diagnostics() {
            assert!(text.get(diagnostic.span.clone()).is_some(), "{diagnostic:?}");
            assert!(diagnostic.to_string().contains(&diagnostic.message));
        }
    }
    let error = Scene::read("x + sinn(y)").expect_err("wrong");
    assert_eq!(error.diagnostics()[0].suggestion, Some((4..8, "sin".to_owned())));
}

#[test]
fn meshes_are_refused_as_pictures_are() {
    let scene = |text| Scene::read(text).expect("reads");
    let coarse = MeshSettings::new().tolerance(0.3);
    for (text, settings, message) in [
        ("x-x", MeshSettings::new(), "every point is a zero"),
        ("x^2+y^2+z^2 = 1", coarse.clone().tolerance(0.0), "tolerance must be a finite length"),
        ("x^2+y^2+z^2 = 1", coarse.clone().tolerance(NAN), "tolerance must be a finite length"),
        ("x^2+y^2+z^2 = 1", coarse.clone().budget(Duration::ZERO), "not done within 0 s"),
        ("z = 0", coarse.clone().domain([0.0..=NAN, 0.0..=1.0, 0.0..=1.0]), "domain"),
    ] {
        let error = scene(text).mesh(&settings).expect_err(text);
        assert!(error.to_string().contains(message), "{error}");
    }
    let place = Sandbox::new();
    let mesh = scene("x^2+y^2+z^2 = 1").mesh(&coarse).expect("a mesh");
    assert_eq!(mesh.save(place.path("a.step")).expect_err("step").kind(), ErrorKind::Argument);
    assert_eq!(mesh.save(place.path("no/a.stl")).expect_err("no").kind(), ErrorKind::File);
    let none = scene("hidden\nz = 0").mesh(&coarse.domain(Domain::Auto)).expect("nothing");
    assert_eq!(none.save(place.path("a.stl")).expect_err("empty").kind(), ErrorKind::Argument);
    assert!(place.files().is_empty());
    for name in ["a.stl", "a.obj", "a.ply", "a.3mf", "a.glb"] {
        mesh.save(place.path(name)).expect(name);
        assert!(std::fs::metadata(place.path(name)).expect(name).len() > 1000, "{name}");
    }
}

#[test]
fn formulas_without_a_surface_are_refused_as_on_the_command_line() {
    for text in ["3", "x-x", "sqrt(-1-x^2)"] {
        let error = Scene::read(text).expect("reads").render(&Settings::new(9, 9));
        let error = error.expect_err("no surface");
        assert_eq!(
            (said(&[text]), error.kind()),
            (format!("error: {error}\n"), ErrorKind::Formula)
        );
        // As functions these texts can be evaluated, but they have no surface to trace.
        let function = Function::parse(text).expect("a function");
        assert_eq!(function.eval(&[[0.0; 3]]).len(), 1);
        assert_eq!(function.trace(&[]).expect_err("no surface").kind(), ErrorKind::Formula);
    }
    for (flags, settings) in [
        (
            ["--domain", "1,0,-1,1,-1,1"],
            Settings::new(9, 9).domain([1.0..=0.0, -1.0..=1.0, -1.0..=1.0]),
        ),
        (["--domain", "2e18"], Settings::new(9, 9).domain([(); 3].map(|()| -2e18..=2e18))),
        (["--eye", "1e200,0,0"], Settings::new(9, 9).camera(Camera::new().eye([1e200, 0.0, 0.0]))),
        (["--fov", "180"], Settings::new(9, 9).camera(Camera::new().fov(180.0))),
        (["--up", "2,-3,2.25"], Settings::new(9, 9).camera(Camera::new().up([2.0, -3.0, 2.25]))),
    ] {
        let text = "x^2+y^2+z^2 = 1";
        let error = Scene::read(text).expect("reads").render(&settings).expect_err("refused");
        let told = said(&[&[text], &flags[..]].concat());
        assert_eq!((told, error.kind()), (format!("error: {error}\n"), ErrorKind::Argument));
    }
}

/// Asserts that a result is an error about an argument, in one line that contains `expected`.
fn assert_refused<T>(result: Result<T, Error>, expected: &str) {
    let error = result.err().unwrap_or_else(|| panic!("not refused: {expected}"));
    let message = error.to_string();
    assert_eq!(error.kind(), ErrorKind::Argument, "{message}");
    assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    assert!(error.diagnostics().is_empty());
}

#[test]
fn boxes_that_hold_nothing_are_refused() {
    let function = Function::parse("x^2+y^2+z^2-1").expect("a function");
    let whole = || -INFINITY..=INFINITY;
    assert!(function.enclose(&[[whole(), whole(), whole()]]).is_ok());
    assert!(function.enclose(&[]).expect("nothing").is_empty());
    for wrong in [
        1.0..=0.0,
        NAN..=1.0,
        0.0..=NAN,
        NAN..=NAN,
        INFINITY..=INFINITY,
        -INFINITY..=-INFINITY,
        INFINITY..=-INFINITY,
    ] {
        let boxes = [[whole(), whole(), whole()], [whole(), wrong, whole()]];
        assert_refused(function.enclose(&boxes), "the y range of box 1");
    }
}

#[test]
fn rays_that_go_nowhere_are_refused() {
    let function = Function::parse("x^2+y^2+z^2-1").expect("a function");
    let good = Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0] };
    for (ray, why) in [
        (Ray { direction: [0.0, -0.0, 0.0], ..good }, "no direction"),
        (Ray { direction: [0.0, NAN, 1.0], ..good }, "not a number"),
        (Ray { direction: [0.0, 1.0, INFINITY], ..good }, "not a number"),
        (Ray { direction: [1e101, 0.0, 0.0], ..good }, "not a number within ±1e100"),
        (Ray { origin: [0.0, NAN, 0.0], ..good }, "not a number"),
        (Ray { origin: [0.0, 0.0, -1e200], ..good }, "not a number within ±1e100"),
        (Ray { direction: [1e-101, 0.0, 0.0], ..good }, "too small"),
        (Ray { direction: [5e-324, 0.0, 0.0], ..good }, "too small"),
        (Ray { direction: [1e99, 3e-310, 0.0], ..good }, "too small"),
    ] {
        let refused = function.trace(&[good, good, ray]);
        let refused = refused.inspect_err(|error| assert!(error.to_string().starts_with("ray 2 ")));
        assert_refused(refused, why);
    }
    assert!(function.trace(&[]).expect("nothing").is_empty());
}

#[test]
fn settings_out_of_range_are_refused() {
    let scene = Scene::read("x^2+y^2+z^2 = 1").expect("reads");
    let new = || Settings::new(9, 9);
    for (settings, why) in [
        (Settings::new(0, 9), "a picture has from 1"),
        (Settings::new(9, 0), "a picture has from 1"),
        (Settings::new(usize::MAX, 2), "a picture has from 1"),
        (Settings::new(1 << 20, 1 << 20), "a picture has from 1"),
        (new().max_depth(0), "max_depth: a depth is between 1 and 20"),
        (new().max_depth(21), "max_depth: a depth is between 1 and 20"),
        (
            new().precision(zeroset::Precision::F64).max_depth(41),
            "max_depth: a depth is between 1 and 40",
        ),
        (new().steps(1), "steps: steps are between 2 and 1048576"),
        (new().steps(u32::MAX), "steps: steps are between 2 and 1048576"),
        (new().tolerance(0.0), "a tolerance is a number of pixels"),
        (new().tolerance(NAN), "a tolerance is a number of pixels"),
        (new().ambient(1.5), "ambient must be a share from 0 to 1"),
        (new().ambient(NAN), "ambient must be a share from 0 to 1"),
        (new().antialias(0), "antialias must be 1, 4, 16 or 64"),
        (new().antialias(3), "antialias must be 1, 4, 16 or 64"),
        (new().light([0.0, NAN, 0.0]), "light must be finite"),
        (new().domain([0.0..=NAN, 0.0..=1.0, 0.0..=1.0]), "the x range of the domain"),
        (new().domain([0.0..=1.0, -1.0..=1.0, 1.0..=1.0]), "the z range of the domain"),
        (new().camera(Camera::new().eye([NAN; 3])), "the eye has a coordinate"),
        (new().camera(Camera::new().orthographic(-1.0)), "the orthographic height"),
        (new().camera(Camera::new().up([0.0; 3])), "the up vector"),
    ] {
        assert_refused(scene.render(&settings), why);
    }
    let function = Function::parse("x^2+y^2+z^2-1").expect("a function");
    let new = TraceSettings::new;
    for (settings, why) in [
        (new().domain([1.0..=0.0, 0.0..=1.0, 0.0..=1.0]), "the x range of the domain"),
        (new().domain([(); 3].map(|()| -2e18..=2e18)), "not a number within ±1e18"),
        (new().accuracy(0.0), "accuracy must be"),
        (new().accuracy(-1.0), "accuracy must be"),
        (new().accuracy(NAN), "accuracy must be"),
        (new().accuracy(INFINITY), "accuracy must be"),
        (new().max_depth(0), "max_depth"),
        (new().steps(0), "steps"),
    ] {
        assert_refused(function.trace_with(&[], &settings), why);
    }
}

/// One text is nested too deeply. The other has too many symbols.
#[test]
fn what_is_too_large_is_refused() {
    let deep = "(".repeat(1 << 20);
    assert_eq!(Function::parse(&deep).expect_err("too deep").kind(), ErrorKind::Syntax);
    let terms: Vec<String> = (1..1_000_000).map(|n| format!("sin({n}x+y*{n}.5)")).collect();
    let error = Function::parse(&terms.join("+")).expect_err("too large");
    assert!(matches!(error.kind(), ErrorKind::Formula | ErrorKind::Syntax), "{error}");
}
