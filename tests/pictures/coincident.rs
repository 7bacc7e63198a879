//! Solids whose parts meet in whole faces: faces inside of them, and sheets, are proven to be no
//! boundary. Equations keep them.

use glam::DVec3;
use zeroset_render::model::render;
use zeroset_render::picture::{Picture, Settings};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Status, TraceOptions};

const SIDE: usize = 64;

/// A picture of the cube ±3 from this eye, with all the rays' brackets.
fn seen_from(eye: [f64; 3], text: &str) -> Picture {
    let document = read(text, &Options::default()).expect(text);
    let region = Region::new(DVec3::splat(-3.0), DVec3::splat(3.0)).expect("a cube");
    let projection = Projection::Perspective { fov: 50.0 };
    let (eye, target) = (DVec3::from_array(eye), DVec3::new(0.1, 0.2, 0.3));
    let camera = Camera::new(eye, target, DVec3::Z, projection).expect("a camera");
    let plain = Settings { width: SIDE, height: SIDE, ..Settings::default() };
    let options = TraceOptions { tolerance: 0.005, ..plain.options };
    render(&document, &region, &camera, &Settings { options, ..plain }).expect(text)
}

fn seen(text: &str) -> Picture {
    seen_from([3.1, -5.2, 2.3], text)
}

/// Number of rays with each status: misses, hits and undecided ones.
fn statuses(picture: &Picture) -> [usize; 3] {
    [Status::Miss, Status::Hit, Status::Undecided]
        .map(|status| picture.buffer.status.iter().filter(|found| **found == status).count())
}

/// Checks that two solids have the same statuses and distances, and that all rays are decided.
fn expect_same(text: &str, other: &str, eye: [f64; 3]) {
    let [picture, expected] = [text, other].map(|text| seen_from(eye, text));
    let [misses, hits, undecided] = statuses(&picture);
    assert!(misses + hits == SIDE * SIDE && hits > 400, "{text}: {misses} {hits} {undecided}");
    for pixel in 0..SIDE * SIDE {
        let [own, other] =
            [&picture, &expected].map(|it| (it.buffer.status[pixel], it.buffer.drawn[pixel]));
        let is_near = own.1 == other.1 || (own.1 - other.1).abs() < 2e-3;
        assert!(own.0 == other.0 && is_near, "{text}, pixel {pixel}: {own:?}, not {other:?}");
    }
}

/// The box between these bounds.
fn block([x, y, z]: [[f64; 2]; 3]) -> String {
    format!(
        "max({}-x, x-{}, {}-y, y-{}, {}-z, z-{})",
        Signed(x[0]),
        Signed(x[1]),
        Signed(y[0]),
        Signed(y[1]),
        Signed(z[0]),
        Signed(z[1])
    )
}

/// A number in brackets, since a sign may not follow another one.
struct Signed(f64);

impl std::fmt::Display for Signed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({})", self.0)
    }
}

#[test]
fn boxes_that_share_a_face_are_like_one_box() {
    let (y, z) = ([-0.7, 0.9], [-1.1, 1.3]);
    let halves = [[-1.3, 0.3], [0.3, 1.7]].map(|x| block([x, y, z]));
    let both = format!("min({}, {}) <= 0", halves[0], halves[1]);
    let whole = format!("{} <= 0", block([[-1.3, 1.7], y, z]));
    expect_same(&both, &whole, [3.1, -5.2, 2.3]);
    // From inside, the common face does not hide what is behind it.
    expect_same(&both, &whole, [-0.9, 0.1, 0.2]);
    let conditions = "(-1.3<=x<=0.3 or 0.9<=3x<=5.1) and -0.7<=y<=0.9 and -1.1<=z<=1.3";
    expect_same(conditions, &whole, [3.1, -5.2, 2.3]);
}

#[test]
fn flush_windows_are_open_and_glass_fills_them() {
    let (x, y, z) = ([-2.0, 2.0], [-0.3, 0.3], [-1.2, 1.2]);
    let wall = block([x, y, z]);
    let windows = [[-1.4, -0.6], [-0.6, 0.2], [0.7, 1.5]];
    let cut = |y: [f64; 2]| windows.map(|x| block([x, y, [-0.5, 0.6]])).join(", ");
    let flush = format!("max({wall}, -min({})) <= 0", cut(y));
    let through = format!("max({wall}, -min({})) <= 0", cut([-1.0, 1.0]));
    expect_same(&flush, &through, [3.1, -5.2, 2.3]);
    let glazed = format!("min(max({wall}, -min({})), {}) <= 0", cut(y), cut(y));
    expect_same(&glazed, &format!("{wall} <= 0"), [3.1, -5.2, 2.3]);
    expect_same(&glazed, &format!("{wall} <= 0"), [-1.7, 0.1, 0.2]);
}

#[test]
fn a_column_stands_on_its_step_and_a_core_fills_its_shell() {
    let step = block([[-1.5, 1.5], [-1.5, 1.5], [-1.2, -0.9]]);
    let column = |low: f64| format!("max(sqrt(x^2+y^2)-0.6, ({low})-z, z-1.4)");
    let standing = format!("min({step}, {}) <= 0", column(-0.9));
    let sunk = format!("min({step}, {}) <= 0", column(-1.1));
    expect_same(&standing, &sunk, [3.1, -5.2, 2.3]);
    expect_same(&standing, &sunk, [0.1, -0.2, 0.3]);
    let shell = "max(sqrt(x^2+y^2)-1.3, 0.6-sqrt(x^2+y^2), abs(z)-1)";
    let filled = format!("min({shell}, max(sqrt(x^2+y^2)-0.6, abs(z)-1)) <= 0");
    expect_same(&filled, "max(sqrt(x^2+y^2)-1.3, abs(z)-1) <= 0", [3.1, -5.2, 2.3]);
    expect_same(&filled, "max(sqrt(x^2+y^2)-1.3, abs(z)-1) <= 0", [0.1, -0.2, 0.3]);
}

#[test]
fn the_whole_condition_is_regularized() {
    let ball = "x^2+y^2+z^2-1.7";
    for text in [
        format!("max(0, {ball}) <= 0"),
        format!("x^2*({ball}) <= 0"),
        format!("({ball})^3 <= 0"),
        format!("min({ball}, max(x-1.5, 1.5-x)) <= 0"),
        format!("{ball} <= 0 and x <= 0.4 or {ball} <= 0 and x >= 0.4"),
    ] {
        expect_same(&text, &format!("{ball} <= 0"), [3.1, -5.2, 2.3]);
    }
}

#[test]
fn sheets_are_proven_misses_and_equations_keep_them() {
    let ball = "x^2+y^2+z^2-1.7";
    for function in [
        format!("max({ball}, z, -z)"),
        format!("({ball})^2"),
        format!("abs({ball})"),
        format!("max({ball}, x-0.1-0.2, 0.3-x)"),
    ] {
        let solid = seen(&format!("{function} <= 0"));
        assert_eq!(statuses(&solid), [SIDE * SIDE, 0, 0], "{function}");
        assert!(solid.remarks[0].contains("has no interior"), "{:?}", solid.remarks);
        assert!(solid.remarks[0].contains("'='"), "{:?}", solid.remarks);
        let [_, hits, undecided] = statuses(&seen(&format!("{function} = 0")));
        assert!(hits + undecided > 200, "{function}: {hits} {undecided}");
    }
    let [_, hits, undecided] = statuses(&seen(&format!("max(0, {ball}) = 0")));
    assert!(hits == 0 && undecided > 400, "{hits} {undecided}");
    let all = seen("min(z, -z) <= 0");
    assert!(all.remarks[0].contains("all of the domain"), "{:?}", all.remarks);
    assert_eq!(statuses(&all)[2], 0);
}

/// Where a function is 0 on an open set, that set belongs to the solid of `<=`, and not to that of
/// `<`.
#[test]
fn a_strict_solid_leaves_out_what_is_0() {
    for text in [
        "max(0,x) < 0",
        "max(x^2+y^2+z^2-1,0) < 0",
        "abs(x) < x",
        "not (max(0,x) >= 0)",
        "max(0,x) < 0 and y < 0",
        "0 > max(0,x) or abs(y) < y",
        "(x^2+y^2+z^2-1)^2 < 0",
        "x^2+y^2+z^2 < 4 where max(0,z) < 0",
    ] {
        assert_eq!(statuses(&seen(text)), [SIDE * SIDE, 0, 0], "{text}");
    }
    let eye = [3.1, -5.2, 2.3];
    expect_same("min(x,0) < 0", "x <= 0", eye);
    expect_same("max(min(x,0),z) < 0", "x <= 0 and z <= 0", eye);
    expect_same(
        "abs(x)+abs(y) < 1 or x^2+y^2+z^2 < 1",
        "abs(x)+abs(y) <= 1 or x^2+y^2+z^2 <= 1",
        eye,
    );
    expect_same("1 < x^2+y^2+z^2 <= 4 and z < 1", "1 <= x^2+y^2+z^2 <= 4 and z <= 1", eye);
    let two = |less: &str| {
        let blocks = [
            block([[-1.0, 0.0], [-1.0, 1.0], [-1.0, 1.0]]),
            block([[0.0, 1.0], [-1.0, 1.0], [-1.0, 1.0]]),
        ];
        format!("min({}, {}) {less} 0", blocks[0], blocks[1])
    };
    expect_same(&two("<"), &two("<="), eye);
    // If only one of the inequalities is strict, nothing false is claimed.
    let [_, hits, _] = statuses(&seen("max(0,x) < 0 and y <= 0"));
    assert_eq!(hits, 0);
}
