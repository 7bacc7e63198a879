//! Domains chosen by the caller, by the document and by default.

use super::*;
use zeroset_syntax::{Options, read};

fn document(text: &str) -> Document {
    read(text, &Options::default()).expect("reads")
}

fn found(text: &str) -> ([f64; 3], [f64; 3]) {
    let (region, _) = region(&document(text), DomainChoice::Document, None).expect("valid");
    (region.low().to_array(), region.high().to_array())
}

#[test]
fn domains_are_a_word_a_number_or_six() {
    assert_eq!("auto".parse(), Ok(DomainChoice::Auto));
    assert_eq!("3".parse(), Ok(DomainChoice::Bounds([-3.0, 3.0, -3.0, 3.0, -3.0, 3.0])));
    assert_eq!(
        "-1,1, 0,2,.5,1e1".parse(),
        Ok(DomainChoice::Bounds([-1.0, 1.0, 0.0, 2.0, 0.5, 10.0]))
    );
    for text in ["", "1,2", "1,2,3,4,5", "a", "1,2,3,4,5,6,7", "1,,2"] {
        assert!(text.parse::<DomainChoice>().is_err(), "{text}");
    }
}

#[test]
fn the_document_s_domain_counts_unless_another_is_given() {
    assert_eq!(found("domain 2\nx+y+z"), ([-2.0; 3], [2.0; 3]));
    assert_eq!(found("domain 1.2\nx+y+z"), ([-1.2; 3], [1.2; 3]));
    let given = DomainChoice::Bounds([0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    let (region, _) = region(&document("domain 2\nx+y+z"), given, None).expect("valid");
    assert_eq!(region.high(), DVec3::ONE);
}

#[test]
fn between_given_ranges_the_rest_of_a_surface_is_shown_whole() {
    let ground = |text: &str, range: &str| {
        let (low, high) = found(&format!("domain x in {range}, y in {range}\n{text}"));
        [low[2], high[2]]
    };
    for (text, range, [low, high]) in [
        ("z = x^2 - y^2", "[-10, 10]", [-100.0, 100.0]),
        ("z = x^2 - y^2", "[-1, 1]", [-1.0, 1.0]),
        ("z = x^2 + y^2", "[5, 10]", [50.0, 200.0]),
        ("z = 1000 + x*y", "[0, 2]", [1000.0, 1004.0]),
        ("z = exp(x^2)", "[-3, 3]", [1.0, 9_f64.exp()]),
        ("z = exp(x^2)", "[-4, 4]", [1.0, 16_f64.exp()]),
        ("z = x^5*y^3 - y", "[-9, 9]", [-9_f64.powi(8), 9_f64.powi(8)]),
        ("z^2 = x^2 + y^2", "[-3, 3]", [-18_f64.sqrt(), 18_f64.sqrt()]),
    ] {
        let [from, to] = ground(text, range);
        let most = 0.2 * (high - low);
        let is_around = (low - most..=low).contains(&from) && (high..=high + most).contains(&to);
        assert!(is_around, "{text} in {range}: {from}, {to}");
    }
    // Nothing bounds these along z, or they would be a needle.
    for text in ["z = 1/(x^2 + y^2)", "x^2 + y^2 = 1", "aspect equal\nz = exp(x^2)"] {
        let [from, to] = ground(text, "[-4, 4]");
        assert!(to - from < 20.0, "{text}: {from}, {to}");
    }
    // A point beyond the surface is shown, too.
    let [_, to] = ground("z = x^2 + y^2\npoint (0, 0, 50)", "[-1, 1]");
    assert!((50.0..60.0).contains(&to), "{to}");
    let (low, high) = found("domain z in [0, 3]\nx^2 + y^2 = z^2");
    assert!(low[0] < -3.0 && high[0] > 3.0 && high[0] < 4.0, "{low:?}, {high:?}");
}

/// A curve in a plane across an axis has the domain of the surface over which it lies.
#[test]
fn plane_curves_that_go_on_have_the_domain_of_their_equation() {
    for (equation, plane, axis, at) in [
        ("x^3 + y^3 = 6x*y", "z = 0", 2, 0.0),
        ("y = sin(x)/x", "z = 0", 2, 0.0),
        ("y = cos(x)/x", "z = 2", 2, 2.0),
        ("y = x*sin(x)", "2z + 3 = 0", 2, -1.5),
        ("x^3 + z^3 = 6x*z", "y = 1", 1, 1.0),
        ("y^2 = z^3 - 4z + 1", "0 = x", 0, 0.0),
    ] {
        let surface = found(equation);
        for both in [format!("curve {equation}, {plane}"), format!("curve {plane}, {equation}")] {
            let curve = found(&both);
            for other in (0..3).filter(|other| *other != axis) {
                let ends = [curve.0[other], curve.1[other]];
                assert_eq!(ends, [surface.0[other], surface.1[other]], "{both}");
            }
            assert!(curve.0[axis] < at && at < curve.1[axis], "{both}: {curve:?}");
        }
    }
    // The plane's coordinate may occur in the equation. Two curves have one domain.
    let both = "curve x^3 + y^3 = 6x*y + z - 1, z = 1; curve y = x^2, z = -3";
    let (low, high) = found(both);
    assert!(low[2] < -3.0 && 1.0 < high[2] && high[0] > 3.2 && high[1] > 3.2, "{high:?}");
    let (_, searched) =
        region(&document("curve y = x^3, z = 0"), DomainChoice::Auto, None).expect("a region");
    assert_eq!(searched.map(|found| found.finding), Some(Finding::Unbounded));
    // A curve that is bounded has a box of its own.
    let (_, searched) = region(&document("curve x^4 + y^2 = 1, z = 0"), DomainChoice::Auto, None)
        .expect("a region");
    assert_eq!(searched.map(|found| found.finding), Some(Finding::Bounded));
}

#[test]
fn what_turns_with_the_time_is_in_the_domain_whole() {
    for (text, reach) in [
        ("rotate(box(1, 0.5, 0.3), t) <= 0", [1.118, 1.118, 0.3]),
        ("rotate(torus(1, 0.3), t, (1, 0, 0)) <= 0", [1.3, 1.3, 1.3]),
        ("rotate(sphere(0.5, (1, 0, 0)), t) = 0", [1.5, 1.5, 0.5]),
        (
            "p = (x cos(t) + z sin(t), y, z cos(t) - x sin(t))\nlength((length(p.xz)-1, p.y)) = 0.3",
            [1.3, 0.3, 1.3],
        ),
        ("x^2 + y^2 + z^2 = 2 + sin(t)", [1.7, 1.7, 1.7]),
        ("translate(sphere(1), 3cos(t), 3sin(t), 0) <= 0", [4.0, 4.0, 1.0]),
    ] {
        for at in [0.0, 1.0, 5.0] {
            let (low, high) = found(&format!("t = {at} in [0, 2pi]\n{text}"));
            for axis in 0..3 {
                let fits = |end: f64| (0.98 * reach[axis]..1.5 * reach[axis]).contains(&end);
                assert!(fits(-low[axis]) && fits(high[axis]), "{text} at {at}: {low:?}, {high:?}");
            }
        }
    }
}

#[test]
fn what_goes_on_alike_in_all_directions_is_cut_by_a_ball() {
    let found = |text: &str, choice, to| {
        let (region, searched) =
            region(&document(text), choice, Clipping { plane: ClipChoice::Document, to })
                .expect(text);
        (region, searched.map(|found| found.finding))
    };
    let auto = |text| found(text, DomainChoice::Document, ClipShape::Auto);
    for text in ["x^2+y^2-z^2=1", "x*y*z=1", "4(x^2+y^2+z^2)+16x*y*z=1", "x^2+y^2=z^2"] {
        let (region, finding) = auto(text);
        let ball = region.ball().expect(text);
        assert_eq!(ball.radius, region.half_extent());
        assert_eq!(finding, Some(Finding::UnboundedInBall));
        let (region, finding) = found(text, DomainChoice::Document, ClipShape::Box);
        assert_eq!((region.ball(), finding), (None, Some(Finding::Unbounded)));
    }
    for text in ["z=x^2-y^2", "x*y*z=0", "x+y+z=1", "x^2+y^2=1", "sin(x)+sin(y)+sin(z)=0"] {
        let (region, finding) = auto(text);
        assert_eq!((region.ball(), finding), (None, Some(Finding::Unbounded)), "{text}");
        let (region, finding) = found(text, DomainChoice::Auto, ClipShape::Ball);
        assert!(region.ball().is_some() && finding == Some(Finding::UnboundedInBall));
    }
    // A typed domain is a box, unless the document asks for a ball.
    assert_eq!(auto("domain 3\nx^2+y^2-z^2=1").0.ball(), None);
    assert_eq!(auto("x^2+y^2+z^2=1").0.ball(), None);
    let ball = auto("domain ball 3/2\nx^2+y^2+z^2=1").0.ball().expect("typed");
    assert_eq!((ball.centre, ball.radius), (DVec3::ZERO, 1.5));
    let other = DomainChoice::Bounds([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0]);
    assert_eq!(found("domain ball 3\nx*y*z=1", other, ClipShape::Auto).0.ball(), None);
    assert_eq!(
        found("domain ball 3\nx*y*z=1", DomainChoice::Document, ClipShape::Box).0.ball(),
        None
    );
}

#[test]
fn a_domain_left_open_is_searched_for() {
    let (low, high) = found("x^2+y^2+z^2=1");
    assert!(low.iter().all(|low| (-1.3..-1.0).contains(low)), "{low:?}");
    assert!(high.iter().all(|high| (1.0..1.3).contains(high)), "{high:?}");
    let (low, high) = found("domain z in [0, 5]\nx^2+y^2+z^2=1");
    assert!((low[2], high[2]) == (0.0, 5.0) && low[0] > -1.3);
    assert_eq!(found("sin(x)+sin(y)+sin(z)").1, [std::f64::consts::TAU; 3]);
}

#[test]
fn a_surface_beyond_all_domains_is_refused_with_what_to_type() {
    for (text, smaller) in [
        ("x^2+y^2+z^2=1e36", "(1e18*x)^2+(1e18*y)^2+(1e18*z)^2=1e36"),
        ("x^2+y^2+z^2=1e50^2", "(1e50*x)^2+(1e50*y)^2+(1e50*z)^2=1e50^2"),
        ("x^2+y^2+z^2=1e300", "(1e150*x)^2+(1e150*y)^2+(1e150*z)^2=1e300"),
    ] {
        let error = region(&document(text), DomainChoice::Document, None).expect_err(text);
        let said = error.to_string();
        let factor = smaller.split(['(', '*']).nth(1).expect("a factor");
        assert!(said.contains("±1e18") && said.contains(&format!("({factor}*x) for x")), "{said}");
        let (region, _) = region(&document(smaller), DomainChoice::Document, None).expect(smaller);
        assert!(region.high().max_element() < 1.2, "{smaller}");
    }
}

#[test]
fn what_only_a_color_depends_on_is_not_idle() {
    let document = document("r = 2\ns = 3\ncolor viridis(r*z + t)\nx^2+y^2+z^2=1");
    let idle = |name: &str| {
        let parameter = document.parameters.iter().find(|parameter| parameter.name == name);
        is_idle(&document, parameter.expect(name))
    };
    assert!(!idle("r") && !idle("t") && idle("s") && depends_on_time(&document));
}
