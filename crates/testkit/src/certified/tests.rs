use super::*;
use zeroset_syntax::{Options, read};

/// Traces the line from `eye` along `direction` in a cube around the origin, with half side 4.
fn trace(formula: &str, eye: [f64; 3], direction: [f64; 3]) -> Certificate {
    let document = read(formula, &Options::default()).expect("reads");
    let parameters: Vec<_> = document.parameters.iter().map(|p| p.value.clone()).collect();
    let function = Function::new(&document.graph, document.surfaces[0].root, &parameters);
    function.trace(&Line { eye, direction }, &[[-4.0, 4.0]; 3], BUDGET)
}

/// Traces the line from x = −8 along the x axis.
fn along_x(formula: &str) -> Certificate {
    trace(formula, [-8.0, 0.0, 0.0], [1.0, 0.0, 0.0])
}

fn crosses_at(certificate: &Certificate, distance: f64) {
    let crossing = certificate.crossing.expect("a crossing");
    assert!(crossing.near <= distance && distance <= crossing.far, "{certificate:?}");
    assert!(crossing.far - crossing.near < 1e-10, "{certificate:?}");
}

fn reasons(certificate: &Certificate) -> Vec<UnresolvedReason> {
    certificate.unresolved.iter().map(|piece| piece.reason).collect()
}

#[test]
fn simple_roots_cross() {
    let certificate = along_x("x^2 - 2");
    crosses_at(&certificate, 8.0 - 2_f64.sqrt());
    assert!(certificate.crossing.is_some_and(|crossing| crossing.simple));
    assert!(certificate.unresolved.is_empty() && certificate.evaluations < 100);
    // Some roots lie where a piece might be cut.
    for root in ["0", "2", "-2", "1", "3", "-3", "1/3"] {
        let certificate = along_x(&format!("r = {root}\nx - r"));
        assert!(certificate.unresolved.is_empty(), "{root}: {certificate:?}");
        assert!(certificate.crossing.is_some(), "{root}: {certificate:?}");
    }
    // At a triple root the function changes its sign, but the root is not simple.
    let certificate = along_x("(x-1)^3");
    crosses_at(&certificate, 9.0);
    assert!(!certificate.crossing.is_some_and(|crossing| crossing.simple));
}

#[test]
fn the_sign_where_a_line_comes_in_is_known() {
    let entry = |formula: &str, eye: [f64; 3]| {
        let document = read(formula, &Options::default()).expect("reads");
        let function = Function::new(&document.graph, document.surfaces[0].root, &[]);
        let line = Line { eye, direction: [3.0, 0.0, 0.0] };
        function.entry(&line, &[[-4.0, 4.0]; 3])
    };
    let from = [-8.0, 0.0, 0.0];
    let met = entry("x + 3.5", from).expect("comes in");
    assert!(met.distance.0 <= 4.0 / 3.0 && 4.0 / 3.0 <= met.distance.1, "{met:?}");
    assert_eq!(met.below, Some(true));
    let below = |formula| entry(formula, from).and_then(|entry| entry.below);
    assert_eq!(
        [below("x + 4.5"), below("sqrt(x)"), below("x + 4")],
        [Some(false), Some(false), None]
    );
    assert_eq!(entry("x", [1.0, 0.0, 0.0]), None, "starts inside");
    assert_eq!(entry("x", [8.0, 0.0, 0.0]), None, "looks away");
    assert_eq!(entry("x", [-8.0, 4.5, 0.0]), None, "passes by");
}

#[test]
fn a_ray_without_a_root_misses() {
    assert!(along_x("x^2 + 1e-9").is_miss());
    assert!(along_x("y - 1/1000").is_miss());
    assert!(along_x("x - 5").is_miss(), "beyond the box");
    assert!(trace("x", [-8.0, 5.0, 0.0], [1.0, 0.0, 0.0]).is_miss(), "beside the box");
    assert!(trace("x", [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]).is_miss(), "behind the eye");
    assert!(along_x("sqrt(x-5)").is_miss(), "defined nowhere");
}

#[test]
fn what_it_cannot_know_has_its_reason() {
    assert_eq!(reasons(&along_x("(x-1/3)^2")), [UnresolvedReason::Touching]);
    assert_eq!(reasons(&along_x("abs(x)")), [UnresolvedReason::Touching]);
    assert_eq!(reasons(&along_x("1/(x-1/3)")), [UnresolvedReason::Undefined]);
    assert_eq!(reasons(&along_x("sqrt(x)")), [UnresolvedReason::Undefined]);
    assert_eq!(reasons(&along_x("floor(x)+1/2")), [UnresolvedReason::Jump]);
    assert_eq!(reasons(&along_x("x + 4")), [UnresolvedReason::Edge]);
    let document = read("x", &Options::default()).expect("reads");
    let function = Function::new(&document.graph, document.surfaces[0].root, &[]);
    let line = Line { eye: [-8.0, 0.0, 0.0], direction: [1.0, 0.0, 0.0] };
    let certificate = function.trace(&line, &[[-4.0, 4.0]; 3], 2);
    assert_eq!(reasons(&certificate), [UnresolvedReason::Budget]);
}

#[test]
fn a_crossing_behind_what_it_cannot_know_is_found() {
    let certificate = along_x("x^2*(x-1)");
    assert_eq!(reasons(&certificate), [UnresolvedReason::Touching]);
    crosses_at(&certificate, 9.0);
    let certificate = along_x("1/(x-1/3) - 1/2");
    assert_eq!(reasons(&certificate), [UnresolvedReason::Undefined]);
    crosses_at(&certificate, 31.0 / 3.0);
    // The roots 0 and 1e-15 may be too close together to be told apart.
    let certificate = along_x("x^2*(x-1e-15)");
    assert!(certificate.crossing.is_some() || reasons(&certificate).len() == 1);
}

#[test]
fn kinks_and_steep_places_cross() {
    crosses_at(&along_x("max(x, 2*x)"), 8.0);
    crosses_at(&along_x("cbrt(x-1)"), 9.0);
    crosses_at(&along_x("x + sqrt(max(x-1, 0))"), 8.0);
    crosses_at(&along_x("abs(x) - 1"), 7.0);
}
