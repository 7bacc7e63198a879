//! Domains and cameras chosen by the caller, by the document and by default.

use super::*;
use zeroset_space::Basis;
use zeroset_style::VIEWS;
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
fn the_camera_comes_from_the_caller_then_the_document_then_the_default() {
    let text = "domain 2\nview eye (4, 0, 0)\nx+y+z";
    let document = document(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect("valid");
    let eye = |choice: CameraChoice| camera(&document, &region, &choice).expect("valid").eye();
    assert_eq!(eye(CameraChoice::default()), DVec3::X * 4.0);
    let own = CameraChoice { eye: Some(DVec3::Z * 9.0), ..CameraChoice::default() };
    assert_eq!(eye(own), DVec3::Z * 9.0);
    let side = CameraChoice { view: Some(&VIEWS[0]), ..CameraChoice::default() };
    assert_eq!(eye(side), DVec3::new(4.0, -6.0, 4.5));
}

#[test]
fn programs_of_shaders_are_seen_with_y_up() {
    let ups = |text: &str, choice: CameraChoice| {
        let document = document(text);
        let (region, _) = region(&document, DomainChoice::Document, None).expect("valid");
        let camera = camera(&document, &region, &choice).expect("valid");
        (camera.up(), camera.eye() - camera.target())
    };
    let map = "float map(vec3 p) { return length(p) - 1.0; }";
    for text in [
        map,
        "p.y - sin(p.x)*sin(p.z)",
        "length(vec3(x, y, z)) - 1.0",
        "isosurface { function { x*x + y*y + z*z - 1 } contained_by { box { -2, 2 } } }",
    ] {
        let (up, way) = ups(text, CameraChoice::default());
        assert!(up == DVec3::Y && way.y > 0.0 && way.z > way.y, "{text}: {up} {way}");
    }
    for text in ["x^2+y^2+z^2=1", "y = x^2 - z^2", "f(x, y) = x*y", "float f = x*y; z = f"] {
        assert_eq!(ups(text, CameraChoice::default()).0, DVec3::Z, "{text}");
    }
    // A line or a flag about the view wins.
    assert_eq!(ups(&format!("view iso\n{map}"), CameraChoice::default()).0, DVec3::Z);
    let side = CameraChoice { view: Some(&VIEWS[0]), ..CameraChoice::default() };
    assert_eq!(ups(map, side).0, DVec3::Z);
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
fn every_view_can_be_named_in_a_document() {
    for view in &VIEWS {
        let document = document(&format!("domain 2\nview {}\nx+y+z", view.name));
        let (region, _) = region(&document, DomainChoice::Document, None).expect("valid");
        let named = camera(&document, &region, &CameraChoice::default());
        let projection = Projection::Perspective { fov: FOV };
        assert_eq!(
            named.expect("valid"),
            standard_camera(view, &region, projection).expect("valid")
        );
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

fn looks_along(name: &str) -> DVec3 {
    let region = Region::new(DVec3::splat(-1.0), DVec3::new(3.0, 1.0, 1.0)).expect("valid");
    let view = StandardView::named(name).expect("listed");
    let projection = Projection::Perspective { fov: FOV };
    let camera = standard_camera(view, &region, projection).expect("valid");
    assert_eq!(camera.target(), DVec3::X);
    camera.basis().forward
}

#[test]
fn views_look_where_their_names_say() {
    assert_eq!(looks_along("front"), DVec3::Y);
    assert_eq!(looks_along("back"), DVec3::NEG_Y);
    assert_eq!(looks_along("left"), DVec3::X);
    assert_eq!(looks_along("right"), DVec3::NEG_X);
    assert_eq!(looks_along("top"), DVec3::NEG_Z);
    assert_eq!(looks_along("bottom"), DVec3::Z);
    let iso = looks_along("iso");
    assert!(iso.x < 0.0 && iso.y > 0.0 && iso.z < 0.0);
}

#[test]
fn the_six_sides_show_the_whole_cube() {
    let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("valid");
    for view in &VIEWS[1..] {
        let projection = Projection::Perspective { fov: FOV };
        let camera = standard_camera(view, &region, projection).expect("valid");
        let Basis { forward, right, up } = camera.basis();
        for corner in 0..8 {
            let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let to = DVec3::new(sign(0), sign(1), sign(2)) - camera.eye();
            let depth = to.dot(forward);
            let reach = depth * (FOV / 2.0).to_radians().tan();
            let inside = to.dot(up).abs() < reach && to.dot(right).abs() < reach;
            assert!(inside, "{} loses corner {corner}", view.name);
        }
    }
}

#[test]
fn an_eye_in_the_center_looks_in_the_direction_of_the_view() {
    let region = Region::new(DVec3::splat(-1.0), DVec3::splat(3.0)).expect("valid");
    let eye = Some(DVec3::splat(1.0));
    for text in ["x = 0", "view top\nx = 0"] {
        let document = document(text);
        let looks_along = |choice: &CameraChoice| {
            let camera = camera(&document, &region, choice).expect("a camera");
            (camera.target() - camera.eye()).normalize()
        };
        let outside = looks_along(&CameraChoice::default());
        let inside = looks_along(&CameraChoice { eye, ..CameraChoice::default() });
        assert!((outside - inside).length() < 1e-12, "{text}: {outside}, {inside}");
    }
    let same = CameraChoice { eye, target: eye, ..CameraChoice::default() };
    assert!(camera(&document("x = 0"), &region, &same).is_err());
}
