//! Domains of typed formulas, and cancelled searches.

use super::*;
use crate::view::search;
use std::cell::Cell as Asked;
use zeroset_syntax::{Document, Options, read};

fn document(text: &str) -> Document {
    read(text, &Options::default()).expect("reads")
}

pub(super) fn found(text: &str) -> AutoDomain {
    search(&document(text)).expect(text)
}

#[test]
fn a_ball_is_bounded_by_a_snug_box_wherever_it_is() {
    for (centre, radius) in [
        ([0.0; 3], 1.0),
        ([3.0, 0.0, -20.0], 0.5),
        ([-100.0, 7.0, 0.25], 0.03125),
        ([1e9, -2e9, 1.0], 1.0),
        ([0.0; 3], 1e-9),
        ([0.0; 3], 1e12),
    ] {
        let [x, y, z] = centre;
        let found = found(&format!("(x-({x}))^2+(y-({y}))^2+(z-({z}))^2=({radius})^2"));
        assert_eq!(found.finding, Finding::Bounded);
        for (axis, c) in centre.into_iter().enumerate() {
            assert!(found.low[axis] < c - radius && c + radius < found.high[axis], "{found:?}");
            assert!(found.high[axis] - found.low[axis] < 2.5 * radius, "{found:?}");
        }
    }
}

#[test]
fn a_point_has_room_around_it_wherever_it_is() {
    for (text, place) in [
        ("x^2+y^2+z^2 = 0", [0.0; 3]),
        ("x^4+y^4+z^4 = 0", [0.0; 3]),
        ("abs(x)^20+abs(y)^20+abs(z)^20 = 0", [0.0; 3]),
        ("1e-290*(x^2+y^2+z^2) = 0", [0.0; 3]),
        ("1e200*(x^2+y^2+z^2) = 0", [0.0; 3]),
        ("(x-1)^2+(y-2)^2+z^2 = 0", [1.0, 2.0, 0.0]),
        ("x^2+y^2+z^2-2x-4y+5 = 0", [1.0, 2.0, 0.0]),
        ("(x-1)^4+(y-2)^4+(z+3)^4 = 0", [1.0, 2.0, -3.0]),
        ("sqrt((x-1e6)^2+y^2+z^2) = 0", [1e6, 0.0, 0.0]),
        ("cosh(x-1)+cosh(y)+cosh(z) = 3", [1.0, 0.0, 0.0]),
    ] {
        let found = found(text);
        let [low, high] = [-1.0, 1.0].map(|side: f64| place.map(|along| along + side));
        assert_eq!((found.low, found.high), (low, high), "{text}");
        assert_eq!(found.finding, Finding::Bounded, "{text}");
    }
    // One third has no short decimal, so the bounds are rounded.
    let found = found("abs(x-1/3)+abs(y)+abs(z) = 0");
    assert_eq!((found.low, found.high), ([-0.67, -1.0, -1.0], [1.33, 1.0, 1.0]));
}

#[test]
fn what_is_small_is_no_point() {
    for (text, place, radius) in [
        ("x^2+y^2+z^2 = 1e-18", [0.0; 3], 1e-9),
        ("x^2+y^2+z^2 = 1e-200", [0.0; 3], 1e-100),
        ("1e-290*(x^2+y^2+z^2-1e-18) = 0", [0.0; 3], 1e-9),
        ("(x^2+y^2+z^2-1e-18)^2 = 0", [0.0; 3], 1e-9),
        ("(x-1)^2+(y-2)^2+z^2 = 1e-18", [1.0, 2.0, 0.0], 1e-9),
        ("max(x^2+y^2+z^2-1, 0) = 0", [0.0; 3], 1.0),
    ] {
        let found = found(text);
        for (axis, along) in place.into_iter().enumerate() {
            let sides = [along - found.low[axis], found.high[axis] - along];
            assert!(
                sides.iter().all(|side| (1.0..1.3).contains(&(side / radius))),
                "{text}: {found:?}"
            );
        }
    }
}

#[test]
fn a_curve_has_room_around_it() {
    for (text, low, high) in [
        ("x^2+y^2 = 0", [-1.0, -1.0, -2.0], [1.0, 1.0, 2.0]),
        ("(x-1)^2+(y-2)^2 = 0", [0.0, 1.0, -2.0], [2.0, 3.0, 2.0]),
        ("x^2+y^2 = 0 {0<z<1}", [-0.275, -0.275, -0.05], [0.275, 0.275, 1.05]),
    ] {
        let found = found(text);
        assert_eq!((found.low, found.high), (low, high), "{text}");
    }
}

#[test]
fn a_window_holds_what_is_particular_off_the_axes() {
    // Places that the window must hold, and the largest allowed half side.
    let handles = [[5.0, 5.0, 1.0], [-5.0, 5.0, -1.0], [5.0, -5.0, 0.0], [-5.0, -5.0, 0.0]];
    let cases: [(&str, &[[f64; 3]], f64); 6] = [
        ("(x-5)^2+(y-3)^2-(z-2)^2 = 0.2", &[[5.0, 3.0, 2.0]], 1.5),
        ("(x-4)^3-3(x-4)(y-2)^2 = z", &[[4.0, 2.0, 0.0]], 3.0),
        ("(x-2)*(y-3)*(z-4) = 1+3*(x-2)", &[[2.0, 3.0, 4.0]], 10.0),
        ("(x-3)^2+(y-2)^2 = (z-1)^2", &[[3.0, 2.0, 1.0]], 2.5),
        ("z*((x^2-25)^2+(y^2-25)^2+z^2-4) = 0.05", &handles, 12.0),
        (
            "((x-2)^2+(y-1)^2-z^2-0.1)*((x+2)^2+(y+1)^2-z^2-0.1) = 1",
            &[[2.0, 1.0, 0.0], [-2.0, -1.0, 0.0]],
            7.0,
        ),
    ];
    for (text, places, half) in cases {
        let found = found(text);
        for (axis, (low, high)) in found.low.into_iter().zip(found.high).enumerate() {
            let is_within = |place: &[f64; 3]| low < place[axis] && place[axis] < high;
            assert!(places.iter().all(is_within), "{text}: {found:?}");
            assert!(high - low <= 2.0 * half, "{text}: {found:?}");
        }
    }
}

#[test]
fn a_window_on_what_dies_away_shows_what_is_seen_of_it() {
    // Decaying waves go on forever; the window must show only those that are high enough.
    for (text, half) in [
        ("z=exp(-x^2-y^2) sin(5x)", 1.5..4.0),
        ("z=exp(-x^2) cos(7x)", 1.5..4.0),
        // Waves that decay along one axis are ridges as long as the window.
        ("z=sinc(x)", 8.0..20.0),
        ("y=sin(x)/x", 8.0..20.0),
        ("x=3+exp(-z^2)", 1.0..4.0),
    ] {
        let found = found(text);
        let (low, high) = (found.low, found.high);
        let axis = if text.starts_with('x') { 2 } else { 0 };
        assert!(half.contains(&high[axis]) && low[axis] == -high[axis], "{text}: {found:?}");
    }
}

#[test]
fn bounded_is_said_only_of_what_is_bounded() {
    for text in [
        "x^2+y^2=z^2",
        "x^2+y^2=1",
        "z=5",
        "x*y*z=1",
        "x^2+y^2-1e-9*z^2=1",
        "x^2+y^2+z^2-1e-30*x^4=1",
        "(x^2+y^2+z^2-1)*(z-1e15)=0",
        "x^2+y^2+z^2=1\nz=1e13",
        "y=exp(x)",
        "x^2+y^2+z^2=1/(x-3)",
        "sin(x)+sin(y)+sin(z)=0",
        "sqrt(x^2+y^2)=z",
        "x^4+y^4=x*y*z",
        "min(x^2+y^2+z^2-1,z-3)=0",
    ] {
        let found = found(text);
        assert!(
            found.finding != Finding::Bounded && !found.finding.is_empty(),
            "{text}: {found:?}"
        );
    }
}

#[test]
fn what_is_nowhere_is_proven_empty() {
    assert_eq!(found("x^2+y^2+z^2=-1").finding, Finding::Empty);
    assert_eq!(found("x^4+y^4+z^4-x*y*z+9=0").finding, Finding::Empty);
}

#[test]
fn what_waves_is_bounded_as_far_as_was_looked() {
    let found = found("x^2+y^2+z^2=9+x*sin(x)");
    assert_eq!(found.finding, Finding::BoundedNear);
    assert!(found.low[0] < -3.0 && found.high[0] < 6.0, "{found:?}");
}

#[test]
fn two_surfaces_share_a_domain() {
    let found = found("x^2+y^2+z^2=1\n(x-5)^2+y^2+z^2=1");
    assert!(found.low[0] < -1.0 && found.high[0] > 6.0 && found.high[1] < 1.3, "{found:?}");
}

#[test]
fn a_slider_s_range_does_not_count_but_the_loop_of_time_does() {
    assert!(found("r = 1 in [0,5]\nx^2+y^2+z^2=r^2").high[0] < 1.3);
    assert!(found("t = 1 in [0,5]\nx^2+y^2+z^2=t^2").high[0] > 5.0);
}

#[test]
fn nothing_panics_and_every_domain_is_a_box() {
    for text in [
        "x^(1e9)+y=0",
        "x^2000+y^2000+z^2000=1",
        "x^9999999999=y",
        "exp(exp(exp(x)))=y",
        "1e308*x^2+y^2+z^2=1e308",
        "1e-320*x+y+z=0",
        "x/0+y=0",
        "ln(x)*ln(y)*ln(z)=1",
        "z=1/0*x*y",
        "z=ln(-x^2-y^2)+y",
        "z=x^300*y^300",
        "z=1e300*x*y",
        "floor(x)+floor(y)=z",
        "mod(x,1)=y*z",
        "tan(x)+tan(y)=z",
        "sin(1e300*x)+y+z=0",
        "x^2+y^2+z^2=0",
        "x^y+z=1",
        "atan2(y,x)=z",
        "x*0+y*0+z*1e-300=1",
    ] {
        let Ok(found) = search(&document(text)) else { continue };
        for axis in 0..3 {
            let [low, high] = [found.low[axis], found.high[axis]];
            assert!(low.is_finite() && high.is_finite() && low < high, "{text}: {found:?}");
        }
    }
}

#[test]
fn a_search_that_is_no_longer_wanted_ends_without_an_answer() {
    let document = document("(x-3)^2+y^2+(z+20)^2=0.25");
    let program = Program::new(&document, [Interval::ENTIRE; 3]).expect("small");
    let asked = Asked::new(0);
    let until = |last: u32| {
        asked.set(0);
        let wanted = || {
            asked.set(asked.get() + 1);
            asked.get() <= last
        };
        find_while(&program, false, &wanted).expect("code")
    };
    assert!(until(u32::MAX).is_some());
    let all = asked.get();
    for last in [0, 1, all / 2, all - 1] {
        assert_eq!(until(last), None, "asked {last} of {all} times");
        assert!(asked.get() < last + 64, "{} evaluations after {last}", asked.get());
    }
}

#[test]
fn bounds_have_few_digits() {
    assert_eq!(with_margin(&Cell::cube(1.0)), Cell::cube(1.1));
    let cell = Cell { low: [-130.0; 3], high: [128.0; 3] };
    assert_eq!(with_margin(&cell), Cell { low: [-143.0; 3], high: [141.0; 3] });
}

/// The longest side and the shortest.
fn sides(found: &AutoDomain) -> [f64; 2] {
    let sides = [0, 1, 2].map(|axis| found.high[axis] - found.low[axis]);
    [sides.into_iter().fold(0.0, f64::max), sides.into_iter().fold(f64::INFINITY, f64::min)]
}

#[test]
fn a_window_has_no_size_of_waves_that_have_none() {
    // Sines of an angle or of a quotient give the window no size. The rest of the formula may.
    for (text, longest) in [
        ("r=2cos(theta)", 2.0..5.0),
        ("r=cos(2*theta)", 2.0..5.0),
        ("r^2=cos(2*theta)", 2.0..5.0),
        ("r=20+cos(7*theta)", 42.0..80.0),
        ("r=z*cos(theta)", 2.0..5.0),
        ("sin(theta)^2+z^2=1", 2.0..5.0),
        ("z^2=cos(theta)", 2.0..5.0),
        ("z=r^2*cos(2*theta)", 4.0..6.0),
        ("z=sin(1/x)", 2.0..5.0),
        // The inner wave gives the window its size.
        ("z=sin(2*sin(x^2+y^2))", 4.0..8.0),
    ] {
        let found = found(text);
        assert!(longest.contains(&sides(&found)[0]), "{text}: {found:?}");
    }
}

/// Returns whether a range is roughly symmetric about a place.
fn is_about(place: f64, [low, high]: [f64; 2]) -> bool {
    (low + high - 2.0 * place).abs() < 0.1 * (high - low)
}

#[test]
fn a_graph_with_poles_up_and_down_is_seen_from_its_middle() {
    for (text, middle, half) in [
        ("z=tan(x)*tan(y)", 0.0, 6.3),
        ("z=csc(x)*csc(y)", 0.0, 6.3),
        ("z=tan(x)+tan(y)", 0.0, 6.3),
        ("z=cot(x)*y", 0.0, 6.3),
        ("z=sec(x)*y", 0.0, 6.3),
        ("z=1/(x*y)", 0.0, 2.0),
        ("z=3+1/(x*y)", 3.0, 2.0),
        ("z=1/((x-3)*(y-2))", 0.0, 2.0),
        ("z=1/(x^2-y^2)", 0.0, 2.0),
        ("z=1/(x+y)", 0.0, 2.0),
        ("z=x*y/(x-y)", 0.0, 2.0),
        // The window is as wide as high, whatever the factor.
        ("z=100/(x*y)", 0.0, 8.0),
        ("z=0.01/(x*y)", 0.0, 0.5),
        ("z=100/x", 0.0, 16.0),
        ("z=0.1/x", 0.0, 1.0),
    ] {
        let found = found(text);
        let [longest, shortest] = sides(&found);
        assert!(is_about(middle, [found.low[2], found.high[2]]), "{text}: {found:?}");
        assert!(longest < 1.5 * shortest, "{text}: {found:?}");
        assert!((0.9 * half..1.4 * half).contains(&(longest / 2.0)), "{text}: {found:?}");
    }
}

#[test]
fn a_ridge_that_goes_on_has_no_place() {
    for (text, half) in [
        ("z=x^2*y", 2.0),
        ("z=x*abs(y)", 2.0),
        ("z=sqrt(x)*y", 2.0),
        ("z=abs(x)*abs(y)", 2.0),
        ("z=exp(x*y)", 2.0),
        ("z=(x+y)^2", 2.0),
        ("z=(x+2y)^2", 2.0),
        ("z=x^y", 2.0),
        ("z=min(x^2,y^2)", 2.0),
        ("z=cos(theta)", 2.0),
        ("z=sin(3*theta)", 2.0),
        ("z=x^2*y/100", 16.0),
        ("z=50*abs(x*y)", 0.25),
        ("z=floor(x)/3+0*y", 2.0),
        // A ridge that ends does determine a window.
        ("z=abs(x^2+y^2-25)", 8.0),
        ("z=max(abs(x),abs(y)-3)", 4.8),
    ] {
        let found = found(text);
        let ground = [0, 1].map(|axis| found.high[axis]);
        assert!(ground.iter().all(|high| (0.9..1.1).contains(&(high / half))), "{text}: {found:?}");
        let [longest, shortest] = sides(&found);
        assert!(shortest > 0.2 * longest, "{text}: {found:?}");
    }
}

#[test]
fn a_window_shows_only_the_ground_and_heights_that_a_graph_has() {
    for (text, low, high) in [
        ("x^x+y^y=z", [0.0, 0.0, 1.38], [2.0, 2.0, 4.0]),
        ("z=sqrt(x)*y", [0.0, -2.0, -2.1], [2.0, 2.0, 2.1]),
        ("z=ln(x-3)+ln(y)", [3.0, 0.0, -2.8], [5.0, 2.0, 1.5]),
        ("z=exp(x*y)", [-2.0, -2.0, 0.0], [2.0, 2.0, 5.3]),
        ("z=exp(x+y)", [-2.0, -2.0, 0.0], [2.0, 2.0, 5.3]),
        // At x = 0, intervals exclude no height; the window must still end near the graph's
        // heights.
        ("z=sin(x)/x", [-12.4, -12.4, -0.22], [12.4, 12.4, 1.0]),
        ("y=sin(3x)/x", [-12.5, -0.65, -12.5], [12.5, 3.0, 12.5]),
    ] {
        let found = found(text);
        let near = |a: f64, b: f64, size: f64| (a - b).abs() < 0.25 * size;
        for axis in 0..3 {
            let size = high[axis] - low[axis];
            let is_near =
                near(found.low[axis], low[axis], size) && near(found.high[axis], high[axis], size);
            assert!(is_near, "{text}: {found:?}");
        }
    }
}

#[test]
fn a_window_is_not_empty_where_a_wider_one_is_not() {
    for text in ["z=10/x^2", "z=100/x", "z=exp(x)+30", "y=sqrt(x-9)+12"] {
        let document = document(text);
        let program = Program::new(&document, [Interval::ENTIRE; 3]).expect("small");
        let found = found(text);
        let surfaces = vec![program.kernels::<f64>(0).zeros().expect("code")];
        let work = Counter::new(WORK);
        let search = CellSearch { surfaces, forms: Vec::new(), wanted: &|| true, work };
        let window = Cell { low: found.low, high: found.high };
        assert!(search.tight(window, BOX_DEPTH).is_some(), "{text}: {found:?}");
    }
}
