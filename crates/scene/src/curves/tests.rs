use super::*;
use crate::view::{DomainChoice, region};
use zeroset_syntax::{Options, read};

fn document(text: &str) -> Document {
    read(text, &Options::default()).unwrap_or_else(|e| panic!("{}", e.render(None, text, false)))
}

fn cube(half: f64) -> Region {
    Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a cube")
}

fn traced(text: &str, half: f64) -> TracedCurves {
    trace(&document(text), &cube(half))
}

fn length(line: &[DVec3]) -> f64 {
    line.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Closed curves of two equations, with their lengths.
#[test]
fn a_curve_of_two_equations_is_closed_and_has_no_gap() {
    let circle = 2.0 * std::f64::consts::PI;
    for (text, pieces, expected) in [
        ("curve x^2+y^2+z^2=1, z=0", 1, circle),
        ("curve x^2+y^2+z^2=1, x+y+z=0.5", 1, circle * (1.0_f64 - 0.25 / 3.0).sqrt()),
        ("curve (x^2+y^2+z^2+8)^2=36(x^2+y^2), z=0.5", 2, circle * 6.0),
        ("curve x^2+y^2=0.01, z=0.1x", 1, circle * 0.1 * 1.002_496_9),
    ] {
        let half = 5.0;
        let found = traced(text, half);
        assert!(found.remarks.is_empty(), "{text}: {:?}", found.remarks);
        assert_eq!(found.lines.len(), pieces, "{text}");
        let all: f64 = found.lines.iter().map(|line| length(&line.at)).sum();
        assert!((all / expected - 1.0).abs() < 2e-3, "{text}: {all}, not {expected}");
        for line in &found.lines {
            assert_eq!(line.at.first(), line.at.last(), "{text}");
        }
    }
}

/// Every vertex is within 1e-6 of the domain's size of both surfaces.
#[test]
fn vertices_are_on_both_surfaces() {
    let viviani = |at: DVec3| {
        let sphere = (at.length() - 2.0).abs();
        let cylinder = ((at.x - 1.0).hypot(at.y) - 1.0).abs();
        sphere.max(cylinder)
    };
    let found = traced("curve x^2+y^2+z^2=4, (x-1)^2+y^2=1", 3.0);
    assert!(found.remarks.is_empty(), "{:?}", found.remarks);
    let worst = found.places().map(viviani).fold(0.0, f64::max);
    assert!(worst < 6e-6, "{worst}");
    // The curve's length is the integral of √(1 + cos²(t/2)) over t from 0 to 4π.
    let all: f64 = found.lines.iter().map(|line| length(&line.at)).sum();
    assert!((all - 15.280_8).abs() < 0.05, "{all} in {} pieces", found.lines.len());
    // No gap: the curve passes near each of these points of its parametrization.
    for n in 0..720 {
        let t = f64::from(n) * std::f64::consts::TAU / 360.0;
        let point = DVec3::new(1.0 + t.cos(), t.sin(), 2.0 * (t / 2.0).sin());
        let near = found.lines.iter().flat_map(|line| line.at.windows(2)).map(|pair| {
            let way = pair[1] - pair[0];
            let share = ((point - pair[0]).dot(way) / way.length_squared()).clamp(0.0, 1.0);
            (pair[0] + way * share).distance(point)
        });
        let near = near.fold(f64::INFINITY, f64::min);
        assert!(near < 0.01, "{t}: {near}");
    }
}

#[test]
fn curves_end_at_the_region_and_at_restrictions() {
    let found = traced("curve x=y, z=0", 2.0);
    let all: f64 = found.lines.iter().map(|line| length(&line.at)).sum();
    assert!((all - 4.0 * 2.0_f64.sqrt()).abs() < 1e-6 && found.lines.len() == 1, "{all}");
    let half = traced("curve x^2+y^2+z^2=1, z=0 {x > 0}", 2.0);
    let all: f64 = half.lines.iter().map(|line| length(&line.at)).sum();
    assert!((all - std::f64::consts::PI).abs() < 0.01, "{all}");
    assert!(half.places().all(|at| at.x > -1e-9));
    let ball = cube(2.0).with_ball();
    let line = trace(&document("curve x=y, z=0"), &ball);
    let all: f64 = line.lines.iter().map(|line| length(&line.at)).sum();
    assert!((all - 4.0).abs() < 1e-6, "{all}");
}

#[test]
fn two_curves_that_cross_are_both_followed() {
    let found = traced("curve x*y=0, z=0", 2.0);
    let all: f64 = found.lines.iter().map(|line| length(&line.at)).sum();
    assert!((all - 8.0).abs() < 0.05, "{all} in {} pieces", found.lines.len());
}

#[test]
fn a_curve_with_a_parameter_breaks_at_poles_and_jumps() {
    let helix = traced("(cos t, sin t, t/5) for t in [0, 10]", 3.0);
    let all: f64 = helix.lines.iter().map(|line| length(&line.at)).sum();
    assert!(helix.lines.len() == 1 && (all - 10.0 * 1.04_f64.sqrt()).abs() < 1e-3, "{all}");
    let pole = traced("(t, 1/t, 0) for t in [-2, 2]", 3.0);
    assert_eq!(pole.lines.len(), 2);
    assert!(pole.places().all(|at| (at.x * at.y - 1.0).abs() < 2e-3));
    let tangent = traced("(t, tan t, 0) for t in [-3, 3]", 3.0);
    assert_eq!(tangent.lines.len(), 3);
    let steps = traced("(t, floor(t), 0) for t in [0.5, 3.5]", 4.0);
    assert_eq!(steps.lines.len(), 4);
    let gap = traced("(t, sqrt(t^2-1), 0) for t in [-2, 2]", 4.0);
    assert_eq!(gap.lines.len(), 2);
    assert!(gap.places().any(|at| (at - DVec3::X).length() < 1e-3));
}

#[test]
fn sliders_move_curves() {
    let one = traced("a = 2\n(a cos t, sin t, 0) for t in [0, 2pi]\n(a, a^2, 0)", 5.0);
    assert!(one.places().any(|at| (at - 2.0 * DVec3::X).length() < 1e-6));
    assert_eq!(one.points[0].at, DVec3::new(2.0, 4.0, 0.0));
    assert_eq!(one.points[0].label, "(2, 4, 0)");
    let two = traced("a = 2\ncurve x^2+y^2=a, z=0", 5.0);
    assert!(two.places().all(|at| (at.length_squared() - 2.0).abs() < 1e-6));
}

#[test]
fn a_document_of_curves_has_their_box_as_its_domain() {
    let domain = |text: &str| {
        let (region, found) = region(&document(text), DomainChoice::Document, None).expect(text);
        assert!(found.is_some());
        [region.low(), region.high()]
    };
    let near = |[low, high]: [DVec3; 2], expected: [[f64; 3]; 2], off: f64| {
        let expected = expected.map(DVec3::from_array);
        assert!((low - expected[0]).abs().max_element() < off, "{low} {high}");
        assert!((high - expected[1]).abs().max_element() < off, "{low} {high}");
    };
    let helix = domain("(cos t, sin t, t/5) for t in [0, 20]");
    near(helix, [[-1.2, -1.2, -0.2], [1.2, 1.2, 4.2]], 1e-3);
    near(domain("(1, 2, 3)"), [[0.0, 1.0, 2.0], [2.0, 3.0, 4.0]], 1e-9);
    near(domain("curve x^2+y^2=1, z=x"), [[-1.1; 3], [1.1; 3]], 0.2);
    let both = domain("x^2+y^2+z^2=1\n(cos t, sin t, t/5) for t in [0, 20]");
    near(both, [[-1.2, -1.2, -1.1], [1.2, 1.2, 4.2]], 0.05);
    let moving = domain("t = 0 in [0, 6.2831853]\n(3cos t, 3sin t, 0)");
    near(moving, [[-3.3, -3.3, -0.3], [3.3, 3.3, 0.3]], 0.02);
    let pole = domain("(t, 1/t, 0) for t in [-1, 1]");
    assert!(pole[1].y < 100.0, "{pole:?}");
}

/// Texts that could take for ever, or have no curve. Limits of cells, steps and vertices end them.
#[test]
fn hostile_curves_end_with_a_remark() {
    for (text, remark) in [
        ("curve 0=0, 0=0", "meet in more than a curve"),
        ("curve x=0, x=0", ""),
        ("curve 1=0, x=0", "proven to have no part"),
        ("curve sqrt(-1)=x, y=0", ""),
        ("curve x^2+y^2+z^2=0, x=0", ""),
        ("curve sin(100x)=0, sin(100y)=0", ""),
        ("curve sin(1/x)=0, y=0", ""),
        ("(cos t, sin t, t) for t in [0, 1e300]", ""),
        ("(cos t, sin t, cos(2t)) for t in [0, 1e300]", ""),
        ("(cos t, sin t, cos(2t)) for t in [0, 1e9]", "bends too often"),
        ("(sin(1e9t), t, 0) for t in [0, 1]", "bends too often"),
        ("(sqrt(-1), t, 0) for t in [0, 1]", ""),
        ("(exp(exp(t)), t, 0) for t in [-1000, 1000]", ""),
        ("(t, sin(1/t), 0) for t in [0, 1]", ""),
        ("n = -1\n(t, t, t) for t in [0, n]", "has no range"),
        ("(1/0, 1, 2)", "has no value"),
    ] {
        let found = traced(text, 2.0);
        let remarks = found.remarks.join("; ");
        assert!(remarks.contains(remark), "{text}: {remarks:?}");
        assert!(found.places().all(DVec3::is_finite), "{text}");
        assert!(found.places().count() < 1 << 18, "{text}: {}", found.places().count());
    }
    let many: Vec<String> = (0..9000).map(|n| format!("({n}, {}, 0)", n * n)).collect();
    let many = many.join("\n");
    let found = trace(&document(&many), &cube(1e9));
    assert_eq!(found.points.len(), 9000);
    assert!(found.points.iter().all(|point| point.label.is_empty()));
}
