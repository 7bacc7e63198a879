//! Smoothing changes the colors along edges, and nothing else.

use glam::Vec3;
use zeroset_render::model::Model;
use zeroset_render::picture::{Normals, Picture, Settings};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::gallery::example;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::{LinearRgb, Pattern, edges};
use zeroset_space::Camera;
use zeroset_style::{Choices, RAY_COUNTS};
use zeroset_syntax::{Options, read};
use zeroset_trace::{METHODS, Precision, RayGrid, TraceOptions};

fn scene(text: &str, settings: &Settings) -> (Model, Camera) {
    let text = example(text).map_or(text, |example| example.text);
    let document = read(text, &Options::default()).expect("reads");
    let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
    let camera = camera::camera(&CameraChoice::typed(&document), &region).expect("a camera");
    (Model::new(&document, &region, settings).expect("compiles"), camera)
}

fn settings(count: usize) -> Settings {
    let antialias = Pattern::of(count).expect("a pattern");
    Settings { width: 96, height: 80, antialias, occlusion: true, ..Settings::default() }
}

fn picture(model: &Model, camera: &Camera, settings: &Settings) -> Picture {
    model.trace(camera, settings, &|_| true).expect("compiled")
}

/// Mean distance between colors in linear light, over the pixels that `only` selects.
fn off(one: &Picture, other: &Picture, only: &[bool]) -> f64 {
    let light = |picture: &Picture, pixel: usize| {
        Vec3::from_array(LinearRgb::from_srgb(picture.rgb.as_chunks().0[pixel]).0)
    };
    let pixels = || (0..only.len()).filter(|&pixel| only[pixel]);
    let sum: f64 =
        pixels().map(|pixel| f64::from(light(one, pixel).distance(light(other, pixel)))).sum();
    sum / pixels().count() as f64
}

const SURFACES: [&str; 4] =
    ["sphere", "tangle", "gyroid", "x^2+y^2+z^2=1; x=0.3; (x-1)^2+y^2<=0.1"];

#[test]
fn more_rays_bring_edges_nearer_to_what_they_are() {
    for text in SURFACES {
        let (model, camera) = scene(text, &settings(1));
        let pictures = RAY_COUNTS.map(|count| picture(&model, &camera, &settings(count)));
        let [plain, four, sixteen, many] = &pictures;
        let edges = edges(&plain.buffer, &RayGrid::new(&camera, 96, 80));
        let count = edges.iter().filter(|edge| **edge).count();
        let [without, four, sixteen] = [plain, four, sixteen].map(|one| off(one, many, &edges));
        println!(
            "{text}: {count} pixels with edges; off without {without:.4}, of four rays {:.3} of that, \
             of sixteen {:.3}",
            four / without,
            sixteen / without
        );
        assert!(count > 100 && without > 0.03);
        assert!(four < 0.5 * without && sixteen < 0.2 * without);
        let others: Vec<bool> = edges.iter().map(|edge| !edge).collect();
        for (picture, count) in pictures.iter().zip(RAY_COUNTS) {
            assert_eq!(picture.buffer, plain.buffer, "what is known of pixels");
            assert!(off(picture, plain, &others) == 0.0, "elsewhere nothing changes");
            let rays = edges.iter().filter(|edge| **edge).count() * count;
            assert_eq!(picture.statistics.edge_rays, if count > 1 { rays } else { 0 });
        }
    }
}

/// Number of pixels whose colors differ strongly.
fn apart(one: &Picture, other: &Picture) -> usize {
    let [one, other] = [one, other].map(|picture| picture.rgb.as_chunks::<3>().0);
    let is_apart = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 60);
    one.iter().zip(other).filter(|&pair| is_apart(pair)).count()
}

#[test]
fn what_f32_cannot_tell_is_not_painted_along_edges() {
    // Surfaces with jumps, with a branch cut, and with functions beyond the range of `f32`.
    for text in [
        "floor-steps",
        "mod(x,1)=z",
        "atan2(y,x)=z",
        "(x^2+y^2+z^2+(1.5e11)^2-(5e10)^2)^2=4(1.5e11)^2*(x^2+y^2)",
        "1e-300*(x^2+y^2+z^2-1)=0",
        "domain 3e11\n(x^2+y^2+z^2+(1.5e11)^2-(5e10)^2)^2=4(1.5e11)^2*(x^2+y^2)\nz=0",
    ] {
        let settings = settings(16);
        let fine = Settings {
            options: TraceOptions { precision: Precision::F64, ..settings.options },
            ..settings.clone()
        };
        let (model, camera) = scene(text, &fine);
        let fine = picture(&model, &camera, &fine);
        let (model, camera) = scene(text, &settings);
        let usual = picture(&model, &camera, &settings);
        let drawn = (0..96 * 80).filter(|&pixel| fine.buffer.is_drawn(pixel)).count();
        let apart = apart(&usual, &fine);
        println!("{text}: {drawn} pixels drawn, {apart} with other colors than in f64");
        assert!(drawn > 200 && apart <= 2, "{text}: {apart} of {drawn}");
    }
}

#[test]
fn colors_do_not_depend_on_threads_or_on_when_they_are_made() {
    let choices = Choices { shadows: Some(true), ..Choices::default() };
    let settings = Settings { choices, shadow_depth: Some(8), ..settings(16) };
    for text in SURFACES {
        let (model, camera) = scene(text, &settings);
        let whole = picture(&model, &camera, &settings);
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        for threads in [1, 3] {
            let pool = pool(threads).expect("threads");
            let same = pool.install(|| picture(&model, &camera, &settings));
            assert!(same.rgb == whole.rgb && same.buffer == whole.buffer, "{threads} threads");
        }
        let plain = picture(&model, &camera, &settings.plain());
        assert!(plain.rgb != whole.rgb);
        let lit = model.relight(&plain, &camera, &settings, &|_| true).expect("compiled");
        assert!(lit.rgb == whole.rgb && lit.buffer == whole.buffer, "{text}");
        assert_eq!(lit.statistics.edge_rays, whole.statistics.edge_rays);
    }
}

#[test]
fn rows_that_are_colored_at_once_are_as_those_that_are_colored_later() {
    // The width is no multiple of a tile, and a row has more than sixteen tiles of 16×16 pixels.
    let settings = Settings { width: 277, height: 37, ..Settings::default() };
    let hatched = "(x^2+y^2+z^2-1)^2=0";
    for text in ["tangle", "gyroid", "x^2+y^2<=1", hatched] {
        let (model, camera) = scene(text, &settings);
        let at_once = picture(&model, &camera, &settings);
        let later = model.relight(&at_once, &camera, &settings, &|_| true).expect("compiled");
        assert!(at_once.rgb == later.rgb && at_once.buffer == later.buffer, "{text}");
        let colors: std::collections::BTreeSet<_> = at_once.rgb.as_chunks::<3>().0.iter().collect();
        assert!(colors.len() > 2, "{text}: {colors:?}");
    }
}

#[test]
fn normals_that_are_not_kept_are_found_for_colors() {
    let settings = Settings { width: 93, height: 70, ..Settings::default() };
    let central = Settings { normals: Some(Normals::Central), ..settings.clone() };
    // `smooth` has a gradient everywhere, `creased` lacks some gradients, and `cut` has a cap.
    let (smooth, creased, cut) = ("tangle", "abs(x)+abs(y)+abs(z)=1", "x^2+y^2<=1");
    for (text, kept) in
        [(smooth, &settings), (creased, &settings), (cut, &settings), (smooth, &central)]
    {
        let (model, camera) = scene(text, kept);
        let settings = Settings { keeps_normals: false, ..kept.clone() };
        let kept = picture(&model, &camera, kept);
        let picture = picture(&model, &camera, &settings);
        assert!(picture.rgb == kept.rgb, "{text}");
        // A cap gets its normals while it is traced, so the picture of a cap keeps normals.
        assert_eq!(picture.buffer.normal.is_empty(), text != cut, "{text}");
        // Passes that need normals compute them again.
        let lit = model.relight(&picture, &camera, &settings, &|_| true).expect("compiled");
        assert!(lit.rgb == kept.rgb, "{text}, in the same light");
        let settled = model.settle(&picture, &camera, &settings, &|_| true).expect("compiled");
        assert!(settled.expect("wanted").rgb == kept.rgb, "{text}, settled");
        let other = Settings { antialias: Pattern::of(16).expect("a pattern"), ..settings };
        let edges = |settings: &Settings| {
            model.trace(&camera, settings, &|_| true).expect("compiled").statistics.edge_rays
        };
        let kept = Settings { keeps_normals: true, ..other.clone() };
        assert!(edges(&other) > 0 && edges(&other) == edges(&kept), "{text}");
    }
}

#[test]
fn every_method_smooths_edges() {
    let plain = Settings { width: 48, height: 40, ..settings(1) };
    for method in &METHODS {
        let settings = Settings { method, ..plain.clone() };
        let (model, camera) = scene("torus-sqrt-form", &settings);
        let pictures = [1, 16, 64].map(|count| {
            let antialias = Pattern::of(count).expect("a pattern");
            picture(&model, &camera, &Settings { antialias, ..settings.clone() })
        });
        let [plain, some, many] = &pictures;
        let edges = edges(&plain.buffer, &RayGrid::new(&camera, 48, 40));
        let share = off(some, many, &edges) / off(plain, many, &edges);
        println!("{}: {share:.3}", method.name);
        assert!(share < 0.2, "{}", method.name);
    }
}
