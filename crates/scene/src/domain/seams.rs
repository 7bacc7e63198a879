//! Tests of windows on surfaces that are bounded in some directions only, on graphs, and on what
//! repeats.

use super::tests::found;
use std::f64::consts::{PI, TAU};

/// The largest share of its extent by which an end may be outside of the wanted one.
const ROOM: f64 = 0.16;

/// Checks a domain. An end that is NaN may be anywhere.
fn check(text: &str, wanted: [[f64; 2]; 3]) {
    let found = found(text);
    for (axis, [low, high]) in wanted.into_iter().enumerate() {
        let range = [found.low[axis], found.high[axis]];
        let room = ROOM * if low.is_nan() || high.is_nan() { 0.0 } else { high - low };
        let fits = |end: f64, inner: f64, sign: f64| {
            inner.is_nan() || (-1e-9..=room.max(1.6)).contains(&(sign * (end - inner)))
        };
        assert!(fits(range[0], low, -1.0) && fits(range[1], high, 1.0), "{text}: {found:?}");
    }
}

const ANY: f64 = f64::NAN;

#[test]
fn what_is_bounded_in_some_directions_is_whole_in_these() {
    let half = |r: f64| [-r, r];
    for (text, wanted) in [
        ("x^2+y^2<=25 and z>=0", [half(5.0), half(5.0), [0.0, 10.0]]),
        ("abs(x)<=10 and abs(y)<=10 and z>=0", [half(10.0), half(10.0), [0.0, 20.0]]),
        ("1<=x<=7 and y<=7 and 0<=z<=1", [[1.0, 7.0], [1.0, 7.0], [0.0, 1.0]]),
        (
            "abs(sin x cos y+sin y cos z+sin z cos x)<=0.2 and x^2+y^2<=100",
            [half(10.0), half(10.0), half(4.0 * PI)],
        ),
        ("y=x^4-16 {abs(x)<2}", [half(2.0), [-16.0, 0.0], [ANY, ANY]]),
        ("y^2+z^2<=400", [[ANY, ANY], half(20.0), half(20.0)]),
        ("abs(x)+abs(z)<=60 and y<=-5", [half(60.0), [-125.0, -5.0], half(60.0)]),
        ("z=x*y {x^2+y^2<100}", [half(10.0), half(10.0), half(50.0)]),
        ("x=4-y^2 {abs(y)<=3}", [[-5.0, 4.0], half(3.0), [ANY, ANY]]),
        ("-2<=x-y<=2 and -2<=x+y<=2 and z<=0", [half(2.0), half(2.0), [-4.0, 0.0]]),
        ("1e4<=x^2+z^2<=4e4", [half(200.0), [ANY, ANY], half(200.0)]),
        ("x+y+z<=90 and x>=0 and y>=0 and z>=0", [[0.0, 90.0]; 3]),
    ] {
        check(text, wanted);
    }
}

#[test]
fn a_graph_has_all_its_heights() {
    for (text, low, high) in [
        ("z=e^(-x^2-y^2)", 0.0, 1.0),
        ("z=1/(1+x^2+y^2)", 0.0, 1.0),
        ("z=x^2/4-y^2/9", -4.0 / 9.0, 1.0),
        ("z=atan2(y,x)", -PI, PI),
        ("z=5+3exp(-x^2)", 5.0, 8.0),
        ("z=cos(x)*cos(y)/2", -0.5, 0.5),
        ("z=tanh(x)+tanh(y)", -2.0, 2.0),
        ("z=sqrt(1+x^2)-sqrt(1+y^2)", 1.0 - 5.0_f64.sqrt(), 5.0_f64.sqrt() - 1.0),
        ("z=abs(x-7)+abs(y+1)", 0.0, 4.0),
        ("z=1000exp(-(x^2+y^2)/5000)", 0.0, 1000.0),
    ] {
        let found = found(text);
        assert_eq!(found.cut, [[false; 2]; 3], "{text}: {found:?}");
        let space = 0.05 * (high - low);
        let fits = |end: f64, wanted: f64| (-1e-9..space).contains(&(end - wanted));
        assert!(fits(-found.low[2], -low) && fits(found.high[2], high), "{text}: {found:?}");
    }
}

#[test]
fn a_graph_that_is_cut_says_where() {
    for (text, cut, said) in [
        ("z=x^2+y^2", [false, true], "cut at z = 4"),
        ("z=x*y", [true, true], "cut at z = -2.52 and 2.52"),
        ("y=1/(x^2+z^2)", [false, true], "cut at y = 4"),
        ("x=ln(y^2+z^2)", [true, false], "cut at x = -2."),
        ("z=exp(-x^2-y^2)", [false, false], "clipped to a box"),
    ] {
        let found = found(text);
        let up = if text.starts_with('z') { 2 } else { usize::from(text.starts_with('y')) };
        assert_eq!(found.cut[up], cut, "{text}: {found:?}");
        assert!(found.describe().contains(said), "{text}: {}", found.describe());
    }
    // The window on another surface may reach beyond.
    assert_eq!(found("z=x^2+y^2\nx^2+y^2+(z-20)^2=1").cut[2], [false; 2]);
}

#[test]
fn a_graph_is_shown_until_it_has_faded_out() {
    // Half the extent is between these.
    for (text, x, y) in [
        ("z=exp(-(x^2+y^2)/200)", 20.0..40.0, 20.0..40.0),
        ("z=9/(1+(x-50)^2/4+y^2/100)", 4.0..10.0, 20.0..50.0),
        ("z=atan(x/100)+0*y", 200.0..600.0, 50.0..600.0),
        ("z=1/(1+exp(-x/1000))+1/(1+exp(y/1000))", 1500.0..6000.0, 1500.0..6000.0),
        ("z=x*exp(-(x^2+y^2)*900)", 0.05..0.2, 0.05..0.2),
        // Heights that grow without bound, however slowly, do not fade out.
        ("z=ln(1+x^2+y^2)", 2.0..2.1, 2.0..2.1),
        ("z=cbrt(x)+cbrt(y)", 2.0..2.1, 2.0..2.1),
        ("z=exp(x)+exp(y)", 2.0..2.1, 2.0..2.1),
    ] {
        let found = found(text);
        let half = [0, 1].map(|axis| (found.high[axis] - found.low[axis]) / 2.0);
        assert!(x.contains(&half[0]) && y.contains(&half[1]), "{text}: {found:?}");
    }
}

#[test]
fn cells_that_repeat_are_whole() {
    // Periods along x, y and z, how many of them are seen, and whether a cell begins at 0.
    for (text, wanted) in [
        ("hypot(x-2round(x/2),y-2round(y/2),z-2round(z/2))=0.5", [[-2.5, 2.5]; 3]),
        ("(mod(x,4)-2)^2+(mod(y,4)-2)^2+(mod(z,4)-2)^2=1", [[-3.0, 3.0]; 3]),
        ("(mod(x+1,2)-1)^2+y^2+z^2 <= 0.36", [[-2.6, 2.6], [-0.6, 0.6], [-0.6, 0.6]]),
        ("max(abs(fract(x)-0.5),abs(fract(y)-0.5),abs(fract(z)-0.5))=0.3", [[-0.8, 0.8]; 3]),
        ("(x-300round(x/300))^2+y^2+z^2=100", [[-310.0, 310.0], [-10.0, 10.0], [-10.0, 10.0]]),
        ("z=mod(x,3)+0*y", [[-3.0, 3.0], [ANY, ANY], [0.0, 3.0]]),
        ("z=fract(x)+fract(y)", [[-1.0, 1.0], [-1.0, 1.0], [0.0, 2.0]]),
        (
            "sin(x)+sin(10y)+sin(100z)=0",
            [[-TAU, TAU], [-0.1 * TAU, 0.1 * TAU], [-0.01 * TAU, 0.01 * TAU]],
        ),
    ] {
        let found = found(text);
        for (axis, [low, high]) in wanted.into_iter().enumerate() {
            let room = 0.1 * (high - low);
            let fits = |end: f64| end.is_nan() || (-1e-9..=room).contains(&end);
            let [below, above] = [low - found.low[axis], found.high[axis] - high];
            assert!(fits(below) && fits(above), "{text}: {found:?}");
        }
    }
}
