//! Library pictures equal those of the command line, whatever was rendered before.

use super::errors::{Sandbox, run};
use std::fs::File;
use std::io::BufReader;
use std::time::Duration;
use zeroset::{Camera, Counts, Picture, Reason, Scene, Settings, Status, UndecidedStyle};
use zeroset_testkit::npy;
use zeroset_trace::GBuffer;

/// Texts with solids, several surfaces, picture lines, translucent surfaces and unbounded surfaces.
const TEXTS: [&str; 8] = [
    "x^2+y^2+z^2 = 1",
    "z = x*y {x^2+y^2 < 4}",
    "domain x in [-2, 2], y in [-2, 2], z in [-1, 1]\nx^2+y^2 < 2 and z < 1/2",
    "look paper\nview top\ncolor coral 0.5\nx^2+y^2+z^2 = 1\ncolor gold\nx*y*z = 1/10",
    "sin(x)+sin(y)+sin(z)",
    "(x^2+y^2-z^2)^2",
    "axes on\ncolor viridis(z)\nx^2+y^2+z^2 = 1",
    "legend on\ncolor viridis(z)\ncontours 0.2\nz = x^2-y^2 {x^2+y^2 < 1}",
];

fn scene(text: &str) -> Scene {
    Scene::read(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn decoded(png: &[u8]) -> (u32, u32, Vec<u8>) {
    let image = image::load_from_memory(png).expect("a PNG").to_rgb8();
    (image.width(), image.height(), image.into_raw())
}

#[test]
fn pictures_and_arrays_are_those_of_the_command_line() {
    for text in TEXTS {
        let place = Sandbox::new();
        let outputs = ["-o", "a.png", "--status", "s.npy", "--bracket", "b.npy"];
        let outputs = [&outputs[..], &["--normal", "n.npy", "--points", "p.npy"]].concat();
        let size = ["--size", "70x50", "--undecided", "tint"];
        run(&place, &[&["render", text][..], &outputs, &size].concat());
        let settings = Settings::new(70, 50).undecided(UndecidedStyle::Tint);
        // The next picture reuses this buffer's memory. The old contents must not show.
        let mut earlier = GBuffer::new(70, 50, 0);
        earlier.normal.fill([0.0, 0.6, 0.8]);
        earlier.hand_back();
        let picture = scene(text).render(&settings).expect("a picture");
        let expected = decoded(&std::fs::read(place.path("a.png")).expect("written"));
        assert_eq!((70, 50, picture.rgb().to_vec()), expected, "{text}");
        let open = |name| BufReader::new(File::open(place.path(name)).expect("written"));
        let code = |status: &Status| match status {
            Status::Miss => 0,
            Status::Hit => 1,
            Status::Undecided => 2,
            _ => 3,
        };
        let status: Vec<u8> = picture.status().iter().map(code).collect();
        assert_eq!(status, npy::read_u8(open("s.npy")).expect("an array").data, "{text}");
        let bits = |all: &[f64]| all.iter().map(|one| one.to_bits()).collect::<Vec<_>>();
        let bracket = npy::read_f64(open("b.npy")).expect("an array").data;
        assert_eq!(bits(picture.brackets().as_flattened()), bits(&bracket), "{text}");
        let points: Vec<f64> = picture.points().flatten().collect();
        let written = npy::read_f64(open("p.npy")).expect("an array").data;
        assert_eq!(bits(&points), bits(&written), "{text}");
        let normal = npy::read_f32(open("n.npy")).expect("an array").data;
        assert_eq!(picture.normals().as_flattened(), normal, "{text}");
        check(&picture);
    }
}

/// Asserts that the arrays of a picture agree with one another.
fn check(picture: &Picture) {
    let (width, pixels) = (picture.width(), picture.width() * picture.height());
    assert_eq!(picture.rgb().len(), 3 * pixels);
    assert_eq!([picture.depth().len(), picture.brackets().len()], [pixels; 2]);
    let mut counts = [0; 3];
    let mut undecided = 0;
    for ((pixel, status), point) in picture.status().iter().enumerate().zip(picture.points()) {
        let (column, row) = (pixel % width, pixel / width);
        let (depth, [near, far]) = (picture.depth()[pixel], picture.brackets()[pixel]);
        match status {
            Status::Miss => assert!(depth == f64::INFINITY && near.is_nan()),
            Status::Hit => assert!(near <= depth && depth <= far, "{near} {depth} {far}"),
            _ => assert!(near.is_nan()),
        }
        assert_eq!(point.map(f64::is_finite), [depth.is_finite(); 3]);
        counts[*status as usize] += 1;
        assert_eq!(picture.reason(column, row).is_some(), *status == Status::Undecided);
        assert_eq!(picture.surface(column, row).is_some(), depth.is_finite());
        undecided += usize::from(*status == Status::Undecided);
    }
    let Counts { miss, hit, undecided: open, .. } = picture.counts();
    assert_eq!(counts, [miss, hit, open]);
    assert_eq!(picture.undecided().map(|(_, count)| count).sum::<usize>(), undecided);
    for (column, row) in [(width, 0), (0, picture.height())] {
        assert!(picture.reason(column, row).is_none() && picture.surface(column, row).is_none());
        assert!(picture.ray(column, row).is_none());
    }
}

#[test]
fn pictures_are_written_whole_or_not_at_all() {
    let place = Sandbox::new();
    let picture = scene(TEXTS[0]).render(&Settings::new(40, 30)).expect("a picture");
    picture.save(place.write("a.png", "something else")).expect("written");
    let mut bytes = Vec::new();
    picture.write_png(&mut bytes).expect("written");
    assert_eq!(std::fs::read(place.path("a.png")).expect("there"), bytes);
    assert_eq!(decoded(&bytes), (40, 30, picture.rgb().to_vec()));
    for (name, why) in [
        ("a.jpg", "pictures are written as PNG only"),
        ("none/a.png", "there is no directory"),
        ("", "names no file"),
    ] {
        let error = picture.save(place.path(name)).expect_err("refused");
        let is_directory = name.is_empty() && error.to_string().contains("is a directory");
        assert!(is_directory || error.to_string().contains(why), "{name}: {error}");
    }
    assert_eq!(place.files(), ["a.png"]);
    let fine = scene(TEXTS[0]).render(&Settings::new(40, 30).bits(16)).expect("a picture");
    assert!(picture.light().is_empty() && fine.light().len() == 40 * 30);
    let mut wide = Vec::new();
    fine.write_png(&mut wide).expect("written");
    let header = |bytes: &[u8]| (bytes[16..24].to_vec(), bytes[24]);
    assert_eq!(header(&wide), (header(&bytes).0, 16));
    let error = scene(TEXTS[0]).render(&Settings::new(40, 30).bits(12)).expect_err("refused");
    assert_eq!(error.to_string(), "bits must be 8 or 16");
    let error = picture.write_png(&mut [0; 99][..]).expect_err("no room");
    assert!(error.to_string().starts_with("cannot write the PNG: "), "{error}");
}

#[test]
fn a_picture_does_not_depend_on_the_ones_before() {
    // The square root simplifies in the smaller domain only. The larger one needs other code.
    let text = "r = 1.5 in [0.5, 2]\nx^4+y^4+z^4 = r^2 + 0.1*x*sqrt((x+1.3)^2)";
    let settings = Settings::new(64, 48).domain([-2.0..=2.0, -2.0..=2.0, -2.0..=2.0]);
    let near = settings.clone().domain([-1.0..=1.0, -1.0..=1.0, -1.0..=1.0]);
    let mut moved = scene(text);
    for r in [1.0, 0.75, 2.0, 3.5] {
        moved.set("r", r).expect("a parameter");
        for settings in [&settings, &near] {
            let picture = moved.render(settings).expect("a picture");
            let mut fresh = scene(text);
            fresh.set("r", r).expect("a parameter");
            let fresh = fresh.render(settings).expect("a picture");
            assert!(picture.rgb() == fresh.rgb() && picture.status() == fresh.status(), "{r}");
            let bits = |picture: &Picture| {
                picture.brackets().as_flattened().iter().map(|b| b.to_bits()).collect::<Vec<_>>()
            };
            assert_eq!(bits(&picture), bits(&fresh), "{r}");
            assert_eq!(picture.domain(), fresh.domain());
            check(&picture);
        }
    }
    assert!(moved.set("q", 1.0).is_err() && moved.set("r", f64::NAN).is_err());
    assert_eq!(moved.parameters()[0].value, 3.5);
}

#[test]
fn settings_change_the_picture_and_no_proof() {
    let saddle = scene(TEXTS[1]);
    let base = || Settings::new(64, 48).camera(Camera::new().eye([5.0, -6.0, 4.0]));
    let plain = saddle.render(&base()).expect("a picture");
    let others = [
        base().look("night".parse().expect("a look")),
        base().background([1, 2, 3]),
        base().light([9.0, 0.0, 9.0]),
        base().ambient(1.0),
        base().occlusion(false),
        base().antialias(1),
        base().shadows(true),
        base().axes(true),
    ];
    for settings in others {
        let other = saddle.render(&settings).expect("a picture");
        assert_eq!(other.status(), plain.status(), "{settings:?}");
        assert_eq!(other.brackets().len(), plain.brackets().len());
        assert!(other.rgb() != plain.rgb() || settings == base().shadows(true), "{settings:?}");
    }
    let sides: Vec<_> = zeroset::View::all()
        .map(|view| {
            let camera = Camera::new().view(view).target([0.0; 3]).orthographic(5.0);
            let settings = Settings::new(64, 48).camera(camera);
            saddle.render(&settings).expect("a picture").depth().to_vec()
        })
        .collect();
    assert!((1..sides.len()).all(|side| sides[side] != sides[0]));
    // With no time, every pixel is undecided.
    let none = saddle.render(&base().budget(Duration::ZERO)).expect("a picture");
    assert_eq!(none.undecided().collect::<Vec<_>>(), [(Reason::Budget, 64 * 48)]);
    assert_eq!(none.reason(0, 0), Some(Reason::Budget));
}

#[test]
fn rows_of_tables_are_found_by_their_names() {
    for method in zeroset::Method::all() {
        assert_eq!(method.name().parse(), Ok(method));

        assert!(!method.help().is_empty());
    }
    assert_eq!(zeroset::Method::default().name(), "affine");
    let error = "newton".parse::<zeroset::Method>().expect_err("no method");
    assert!(error.to_string().starts_with("'newton' is not a method: affine, knoll"), "{error}");
    assert!(zeroset::gallery().count() >= 95);
}
