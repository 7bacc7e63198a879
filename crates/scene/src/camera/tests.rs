//! Cameras chosen by the caller, by the document and by default.

use super::*;
use crate::view::{DomainChoice, region};
use zeroset_space::Basis;
use zeroset_style::VIEWS;
use zeroset_syntax::{Options, read};

fn document(text: &str) -> Document {
    read(text, &Options::default()).expect("reads")
}

/// The camera of a document, for the caller's choice.
fn chosen(
    document: &Document,
    region: &Region,
    choice: CameraChoice,
) -> Result<Camera, CameraError> {
    camera(&choice.or(CameraChoice::typed(document)), region)
}

fn standard(view: &'static StandardView, region: &Region) -> Camera {
    let choice = CameraChoice { view: Some(view), ..CameraChoice::default() };
    camera(&choice, region).expect("valid")
}

#[test]
fn the_camera_comes_from_the_caller_then_the_document_then_the_default() {
    let text = "domain 2\nview eye (4, 0, 0)\nx+y+z";
    let document = document(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect("valid");
    let eye = |choice: CameraChoice| chosen(&document, &region, choice).expect("valid").eye();
    assert_eq!(eye(CameraChoice::default()), DVec3::X * 4.0);
    let own = CameraChoice { eye: Some(DVec3::Z * 9.0), ..CameraChoice::default() };
    assert_eq!(eye(own), DVec3::Z * 9.0);
    let side = CameraChoice { view: Some(&VIEWS[0]), ..CameraChoice::default() };
    assert_eq!(eye(side), DVec3::new(4.0, -6.0, 4.5));
    // A view replaces the upward direction, too, but neither target nor projection.
    let document = self::document("domain 2\nview up (1, 1, 0) target (1, 0, 0) fov 30\nx+y+z");
    let camera = chosen(&document, &region, side).expect("valid");
    let projection = Projection::Perspective { fov: 30.0 };
    assert_eq!((camera.up(), camera.target()), (DVec3::Z, DVec3::X));
    assert_eq!(camera.projection(), projection);
}

#[test]
fn programs_of_shaders_are_seen_with_y_up() {
    let ups = |text: &str, choice: CameraChoice| {
        let document = document(text);
        let (region, _) = region(&document, DomainChoice::Document, None).expect("valid");
        let camera = chosen(&document, &region, choice).expect("valid");
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
fn every_view_can_be_named_in_a_document() {
    for view in &VIEWS {
        let document = document(&format!("domain 2\nview {}\nx+y+z", view.name));
        let (region, _) = region(&document, DomainChoice::Document, None).expect("valid");
        let named = chosen(&document, &region, CameraChoice::default());
        assert_eq!(named.expect("valid"), standard(view, &region));
    }
}

fn looks_along(name: &str) -> DVec3 {
    let region = Region::new(DVec3::splat(-1.0), DVec3::new(3.0, 1.0, 1.0)).expect("valid");
    let view = StandardView::named(name).expect("listed");
    let camera = standard(view, &region);
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
        let camera = standard(view, &region);
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
            let camera = chosen(&document, &region, *choice).expect("a camera");
            (camera.target() - camera.eye()).normalize()
        };
        let outside = looks_along(&CameraChoice::default());
        let inside = looks_along(&CameraChoice { eye, ..CameraChoice::default() });
        assert!((outside - inside).length() < 1e-12, "{text}: {outside}, {inside}");
    }
    let same = CameraChoice { eye, target: eye, ..CameraChoice::default() };
    assert!(chosen(&document("x = 0"), &region, same).is_err());
}
