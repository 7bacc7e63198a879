//! Lines of a document set colors, light and opacity. Their pictures are compared with the same
//! pictures made in other ways.

use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};
use zeroset_render::model::{Model, render};
use zeroset_render::picture::{Picture, Settings};
use zeroset_render::progress::Done;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::{LinearRgb, Pattern};
use zeroset_space::{Camera, HalfSpace, Projection, Region};
use zeroset_style::{Choices, ColorMap};
use zeroset_syntax::{Options, read};
use zeroset_trace::{RayGrid, TraceOptions};

const SIDE: usize = 48;

fn settings() -> Settings {
    Settings {
        options: TraceOptions { tolerance: 0.01, ..TraceOptions::default() },
        width: SIDE,
        height: SIDE,
        ..Settings::default()
    }
}

/// A camera that looks along x from 8 units before the origin, with parallel rays.
fn camera() -> Camera {
    let projection = Projection::Orthographic { height: 3.0 };
    Camera::new(DVec3::NEG_X * 8.0, DVec3::ZERO, DVec3::Z, projection).expect("a camera")
}

fn rays() -> RayGrid {
    RayGrid::new(&camera(), SIDE, SIDE)
}

fn picture_of(text: &str, clip: Option<HalfSpace>, settings: &Settings) -> Picture {
    let document = read(text, &Options::default()).expect(text);
    let domain = DomainChoice::Bounds([-2.0, 2.0, -2.0, 2.0, -2.0, 2.0]);
    let (region, _) =
        view::region(&document, domain, clip.map(view::ClipChoice::Plane)).expect(text);
    render(&document, &region, &camera(), settings).expect(text)
}

fn picture(text: &str) -> Picture {
    picture_of(text, None, &settings())
}

fn pixel(picture: &Picture, n: usize) -> [u8; 3] {
    picture.rgb.as_chunks().0[n]
}

/// Mixes colors in linear light by their shares.
fn mixed(parts: &[([u8; 3], f32)]) -> [u8; 3] {
    let mut sum = [0.0; 3];
    for (rgb, share) in parts {
        let light = LinearRgb::from_srgb(*rgb).0;
        sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += share * light);
    }
    LinearRgb(sum).to_srgb()
}

fn assert_near(one: [u8; 3], other: [u8; 3], what: &str) {
    let off = (0..3).map(|part| one[part].abs_diff(other[part])).max();
    assert!(off <= Some(2), "{what}: {one:?} and {other:?}");
}

/// The opacity of a sphere of radius 1 where a ray along x meets it, at a foot this far from the
/// middle ray: that of a sheet that the ray crosses at an angle.
fn opacity_of_sheet(opacity: f64, foot: DVec3) -> f32 {
    let facing = (1.0 - foot.y * foot.y - foot.z * foot.z).sqrt();
    (1.0 - (1.0 - opacity).powf(1.0 / facing)) as f32
}

/// The half-space of the points with coordinates of at least `x` along the x axis.
fn behind(x: f64) -> HalfSpace {
    HalfSpace { normal: DVec3::NEG_X, offset: -x }
}

#[test]
fn translucent_surfaces_are_mixed_from_front_to_back() {
    let (one, other) = ("color tomato", "color steelblue");
    let (first, second) = ("(x+0.5)^2+y^2+z^2=1", "(x-0.5)^2+y^2+z^2=1");
    let alone =
        |color: &str, text: &str, clip| picture_of(&format!("{color}\n{text}"), clip, &settings());
    // The layers, in the order in which rays meet them. The order of lines does not matter.
    let layers = [
        alone(one, first, None),
        alone(other, second, None),
        alone(one, first, Some(behind(-0.5))),
        alone(other, second, Some(behind(0.5))),
    ];
    let ground = picture("x^2+y^2+z^2=9");
    for text in [
        format!("{one} 60%\n{first}\n{other} 60%\n{second}"),
        format!("opacity 60%\n{other}\n{second}\n{one}\n{first}"),
    ] {
        let all = picture(&text);
        let mut checked = 0;
        for n in 0..SIDE * SIDE {
            let foot = rays().ray_of(n).origin;
            // Skip rays that leave one sphere before they enter the other.
            if foot.y.hypot(foot.z) > 0.84 {
                continue;
            }
            let mut left = 1.0;
            let mut parts = Vec::new();
            let share = opacity_of_sheet(0.6, foot);
            for layer in &layers {
                parts.push((pixel(layer, n), share * left));
                left *= 1.0 - share;
            }
            parts.push((pixel(&ground, 0), left));
            assert_near(pixel(&all, n), mixed(&parts), &format!("{text} at {foot}"));
            checked += 1;
        }
        assert!(checked > 400, "{checked}");
    }
}

/// If time ends after tracing, points keep the surface's own color, and a remark says so.
#[test]
fn colors_that_were_not_computed_in_time_are_told() {
    let text = "x^2+y^2+z^2=1";
    let document = read(&format!("color viridis(z)\n{text}"), &Options::default()).expect("reads");
    let domain = DomainChoice::Bounds([-2.0, 2.0, -2.0, 2.0, -2.0, 2.0]);
    let (region, _) = view::region(&document, domain, None).expect("a region");
    let model = Model::new(&document, &region, &settings()).expect("compiles");
    let traced = AtomicUsize::new(0);
    let until_traced = |done| match done {
        Done::Pixels(now) => traced.fetch_add(now, Ordering::Relaxed) + now < SIDE * SIDE,
        Done::Edges { .. } => panic!("time has ended"),
    };
    let draw = |advance: &(dyn Fn(Done) -> bool + Sync)| {
        model.trace(&camera(), &settings(), advance).expect("compiled")
    };
    let (cut, whole) = (draw(&until_traced), draw(&|_| true));
    assert_eq!((&cut.buffer, cut.statistics.pixels), (&whole.buffer, whole.statistics.pixels));
    assert_eq!(cut.rgb, picture(text).rgb);
    assert_ne!(cut.rgb, whole.rgb);
    assert_eq!(cut.remarks, ["there was no time to compute the colors of all points"]);
    assert!(whole.remarks.is_empty());
}

#[test]
fn what_is_claimed_does_not_hang_on_opacity() {
    for text in ["x^2+y^2+z^2=1", "x*y*z=0.1\nx^2+y^2=z", "x^2+y^2+z^2<=5"] {
        let (opaque, clear) = (picture(text), picture(&format!("opacity 30%\n{text}")));
        assert_eq!(opaque.buffer, clear.buffer, "{text}");
        assert_eq!(opaque.statistics.pixels, clear.statistics.pixels);
        assert_ne!(opaque.rgb, clear.rgb, "{text}");
        assert_eq!(picture(&format!("opacity 1\n{text}")).rgb, opaque.rgb, "{text}");
    }
}

#[test]
fn an_opaque_surface_hides_what_is_behind_it() {
    let inner = "color steelblue\nx^2+y^2+z^2=0.25";
    let alone = picture(inner);
    let around = picture("color tomato\nx^2+y^2+z^2=1");
    let both = picture(&format!("color tomato 25%\nx^2+y^2+z^2=1\n{inner}"));
    let mut checked = 0;
    for n in 0..SIDE * SIDE {
        let foot = rays().ray_of(n).origin;
        if foot.y.hypot(foot.z) < 0.45 {
            let share = opacity_of_sheet(0.25, foot);
            let parts = [(pixel(&around, n), share), (pixel(&alone, n), 1.0 - share)];
            assert_near(pixel(&both, n), mixed(&parts), "through the outer sphere");
            checked += 1;
        }
    }
    assert!(checked > 100, "{checked}");
    // Smoothing changes only pixels along edges.
    let smooth = Settings { antialias: Pattern::of(16).expect("a pattern"), ..settings() };
    let smooth = picture_of(&format!("color tomato 25%\nx^2+y^2+z^2=1\n{inner}"), None, &smooth);
    let middle = SIDE * SIDE / 2 + SIDE / 2;
    assert_eq!(pixel(&smooth, middle), pixel(&both, middle));
    let changed = (0..SIDE * SIDE).filter(|&n| pixel(&smooth, n) != pixel(&both, n)).count();
    assert!((60..600).contains(&changed), "{changed}");
}

type Value = fn(DVec3) -> f64;

#[test]
fn colors_are_those_of_values() {
    let map = ColorMap::named("viridis").expect("listed");
    let (sphere, slider) = ("x^2+y^2+z^2=1", "r = 2 in [0, 3]");
    let rays = rays();
    let values: [(&str, Value); 5] = [
        ("z", |at| at.z),
        ("nz^3", |at| at.z.powi(3)),
        ("r*y - 1", |at| 2.0 * at.y - 1.0),
        ("depth - 8", |at| at.x),
        ("abs(ny)", |at| at.y.abs()),
    ];
    for (text, value) in values {
        let colored = picture(&format!("{slider}\ncolor viridis({text}, -1, 1)\n{sphere}"));
        for n in [[20, 17], [30, 24], [15, 33]].map(|[column, row]| row * SIDE + column) {
            let ray = rays.ray_of(n);
            let at = ray.at(ray.parameter(colored.buffer.drawn[n]));
            let [red, green, blue] = map.bytes(value(at).midpoint(1.0));
            let plain = picture(&format!("color #{red:02x}{green:02x}{blue:02x}\n{sphere}"));
            assert_near(pixel(&colored, n), pixel(&plain, n), &format!("{text} at {at}"));
        }
    }
    // Without a range, the scale runs from the least to the greatest visible value.
    let colored = picture(&format!("color viridis(2z)\n{sphere}"));
    let [legend] = &colored.legends[..] else { panic!("one scale") };
    assert!(legend.low < -1.9 && legend.high > 1.9 && legend.high <= 2.0, "{legend:?}");
    assert!(legend.value == "2*z" && legend.step.is_none(), "{legend:?}");
    assert!(picture(sphere).legends.is_empty());
    // This value is constant up to the errors of painted points, so the color is the middle one.
    let flat = picture("color viridis(x)\nx = y/1e9 + 0.3");
    let [one] = &flat.legends[..] else { panic!("one scale") };
    assert!(one.low == one.high && (one.low - 0.3).abs() < 0.01, "{one:?}");
    // A surface has its own color where the value is undefined.
    let [nowhere, own] =
        ["color viridis(sqrt(z-5))\n", ""].map(|line| picture(&format!("{line}{sphere}")));
    assert_eq!(nowhere.rgb, own.rgb);
}

#[test]
fn contours_are_dark_where_a_value_is_a_multiple() {
    let settings = Settings { width: 3 * SIDE, height: 3 * SIDE, ..settings() };
    let plain = picture_of("x=y/4", None, &settings);
    let lined = picture_of("contours z, 0.5\nx=y/4", None, &settings);
    let same = picture_of("color viridis(z, -2, 2)\ncontours 0.5\nx=y/4", None, &settings);
    assert_eq!(same.legends[0].step, Some(0.5));
    let rays = RayGrid::new(&camera(), settings.width, settings.height);
    let mut lines = 0;
    for row in 0..settings.height {
        let n = row * settings.width + settings.width / 2;
        let z = rays.ray_of(n).origin.z;
        let off = (z / 0.5 - (z / 0.5).round()).abs() * 0.5 / rays.footprint(8.0);
        let [before, after] = [&plain, &lined].map(|picture| u32::from(pixel(picture, n)[0]));
        if off < 0.6 {
            lines += 1;
            assert!(after < before * 9 / 10, "{z}: {before} and {after}");
        } else if off > 2.0 {
            assert_eq!(before, after, "{z}");
        }
    }
    assert!((5..=12).contains(&lines), "{lines}");
}

#[test]
fn parameters_give_colors_and_lines() {
    let sheet = |names: [&str; 2]| {
        let [s, t] = names;
        format!("({s}/4, {s}, {t}) for {s} in [-2, 2], {t} in [-2, 2]")
    };
    let [one, other] = [sheet(["s", "t"]), sheet(["b", "s"])];
    let near = |one: &Picture, other: &Picture, what: &str| {
        for n in (0..SIDE * SIDE).filter(|n| one.buffer.is_drawn(*n)) {
            assert_near(pixel(one, n), pixel(other, n), what);
        }
    };
    for (typed, same, sheet) in [("s", "y", &one), ("t^2 - s", "z^2 - y", &one), ("s", "z", &other)]
    {
        let [typed, same] =
            [typed, same].map(|value| picture(&format!("color viridis({value}, -2, 2)\n{sheet}")));
        near(&typed, &same, sheet);
    }
    // Each surface has its own names, which hide those of the text.
    let two = |values: [&str; 2]| {
        let before = "(b/4 - 1, b, s) for b in [-2, 0], s in [-2, 0]";
        let [first, second] = values.map(|value| format!("color turbo({value}, -2, 2)"));
        picture(&format!("s = 1 in [0, 2]\n{first}\n{one}\n{second}\n{before}"))
    };
    near(&two(["s", "s"]), &two(["y", "z"]), "two surfaces");
    let sphere = "x^2+y^2+z^2 = 1";
    let [nowhere, own] =
        ["color viridis(b)\n", ""].map(|line| picture(&format!("{line}{sphere}\n{other}")));
    let on_sphere = |n: &usize| own.buffer.surface[*n] == 0 && own.buffer.is_drawn(*n);
    let at: Vec<usize> = (0..SIDE * SIDE).filter(on_sphere).collect();
    assert!(at.len() > 100 && at.iter().all(|n| pixel(&nowhere, *n) == pixel(&own, *n)));
    // On an equation, names mean what the text says.
    for definition in ["s = z", "s = 0.5 in [0, 1]"] {
        let with = |value: &str| {
            picture(&format!("{definition}\ncolor turbo({value}, -2, 2)\n{sphere}\n{one}"))
        };
        let [by_name, by_value] = [with("s"), with(definition[4..].split(' ').next().unwrap())];
        assert!(at.iter().all(|n| pixel(&by_name, *n) == pixel(&by_value, *n)), "{definition}");
        assert!(at.iter().any(|n| pixel(&by_name, *n) != pixel(&own, *n)), "{definition}");
    }
    // A mesh has twelve cells along each parameter, so three in a unit of y and of z here.
    let settings = Settings { width: 3 * SIDE, height: 3 * SIDE, ..settings() };
    let [plain, lined] =
        [&one, &format!("mesh\n{one}")].map(|text| picture_of(text, None, &settings));
    let rays = RayGrid::new(&camera(), settings.width, settings.height);
    let off = |at: f64| (3.0 * at - (3.0 * at).round()).abs() / 3.0 / rays.footprint(8.0);
    let (mut dark, mut light) = (0, 0);
    for n in 0..plain.buffer.drawn.len() {
        let at = rays.ray_of(n).origin;
        let least = off(at.y).min(off(at.z));
        let [before, after] = [&plain, &lined].map(|picture| u32::from(pixel(picture, n)[0]));
        if least < 0.6 {
            dark += 1;
            assert!(after < before * 9 / 10, "{at}: {before} and {after}");
        } else if least > 2.0 {
            light += 1;
            assert_eq!(before, after, "{at}");
        }
    }
    assert!(dark > 1000 && light > 1000, "{dark} and {light}");
}

#[test]
fn lines_of_a_document_are_as_the_settings() {
    let text = "x^2+y^2+z^2=1\n(x+1.5)^2+y^2+z^2=0.1";
    let said = |line: &str| picture(&format!("{line}\n{text}")).rgb;
    let set = |settings: &Settings| picture_of(text, None, settings).rgb;
    let plain = set(&settings());
    let light = Settings { light: Some(DVec3::new(-4.0, 3.0, 5.0)), ..settings() };
    assert_eq!(said("light -4, 3, 5"), set(&light));
    let shadows =
        Settings { choices: Choices { shadows: Some(true), ..Choices::default() }, ..settings() };
    assert_eq!(said("shadows"), set(&shadows));
    assert_eq!(said("shadows off"), plain);
    let plane = HalfSpace { normal: DVec3::new(0.0, 1.0, 0.5), offset: 0.25 };
    let clipped = picture_of(text, Some(plane), &settings()).rgb;
    assert_eq!(said("clip 0, 1, 1/2, 0.25"), clipped);
    for changed in [set(&light), set(&shadows), clipped] {
        assert_ne!(changed, plain);
    }
    // Arguments of the caller override lines of the document.
    let both = picture_of(&format!("clip 1, 0, 0, 0\n{text}"), Some(plane), &settings()).rgb;
    assert_eq!(both, said("clip 0, 1, 1/2, 0.25"));
}

#[test]
fn rays_followed_alone_find_points_as_exactly() {
    let sphere = "x^2+y^2+z^2=1";
    let region = Region::new(-2.0 * DVec3::ONE, 2.0 * DVec3::ONE).expect("a cube");
    let document = read(sphere, &Options::default()).expect("reads");
    let mut alone = settings();
    alone.options.tiles = false;
    let picture = render(&document, &region, &camera(), &alone).expect("a picture");
    let mut hits = 0;
    for n in (0..SIDE * SIDE).filter(|&n| picture.buffer.is_drawn(n)) {
        let foot = rays().ray_of(n).origin;
        let square = 1.0 - foot.y * foot.y - foot.z * foot.z;
        if square > 0.05 {
            let off = (picture.buffer.drawn[n] - (8.0 - square.sqrt())).abs();
            assert!(off < 0.02 * 3.0 / SIDE as f64, "{off} at {foot}");
            hits += 1;
        }
    }
    assert!(hits > 600, "{hits}");
}
