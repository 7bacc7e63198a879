//! Pictures drawn strip by strip equal whole ones.

use zeroset_render::model::{Model, Strip};
use zeroset_render::picture::{ColorDepth, Picture, Precision, Settings};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::program::ProgramError;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::{Pattern, UndecidedStyle};
use zeroset_space::Camera;
use zeroset_style::Choices;
use zeroset_syntax::{Options, read};
use zeroset_trace::{GBuffer, RayResult, TraceOptions};

fn scene(text: &str, settings: &Settings) -> (Model, Camera) {
    let document = read(text, &Options::default()).expect("reads");
    let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
    let camera = camera::camera(&CameraChoice::typed(&document), &region).expect("a camera");
    (Model::new(&document, &region, settings).expect("compiles"), camera)
}

/// Joins two pictures vertically.
fn stacked(parts: [&GBuffer; 2]) -> GBuffer {
    fn both<T: Clone>(parts: [&Vec<T>; 2]) -> Vec<T> {
        parts.map(Vec::as_slice).concat()
    }
    let height = parts.iter().map(|part| part.height).sum();
    let mut all = GBuffer::new(parts[0].width, height, 0);
    let pixels = parts.iter().flat_map(|part| (0..part.status.len()).map(move |k| (part, k)));
    for (pixel, (part, k)) in pixels.enumerate() {
        let (status, distance, drawn) = (part.status[k], part.distance(k), part.drawn[k]);
        all.set(
            pixel,
            &RayResult { status, distance, drawn, reason: part.reason(k), ..RayResult::MISS },
        );
        all.surface.set(pixel, part.surface[k], parts.iter().map(|part| part.status.len()).sum());
    }
    all.bracket = both(parts.map(|part| &part.bracket));
    all.normal = both(parts.map(|part| &part.normal));
    all.cap = both(parts.map(|part| &part.cap));
    all.shadow = both(parts.map(|part| &part.shadow));
    all.occlusion = both(parts.map(|part| &part.occlusion));
    all
}

/// A picture joined from strips of `rows` rows, and the picture that `strips_of_height` returns.
fn together(
    model: &Model,
    camera: &Camera,
    settings: &Settings,
    rows: usize,
) -> (Picture, Picture) {
    let mut all: Option<Picture> = None;
    let mut add = |Strip { top, picture, overview }: Strip<'_>| -> Result<(), ProgramError> {
        assert_eq!(overview.is_some(), settings.normals.is_some());
        assert!(picture.buffer.height <= rows);
        let Some(all) = &mut all else {
            all = Some(picture.clone());
            return Ok(());
        };
        assert_eq!(top, all.buffer.height);
        all.buffer = stacked([&all.buffer, &picture.buffer]);
        all.rgb.extend(&picture.rgb);
        all.light.extend(&picture.light);
        Ok(())
    };
    let told = model.strips_of_height(rows, camera, settings, None, &mut add).expect("compiled");
    (all.expect("a strip"), told)
}

/// For each quantity, the number of pixels in which it differs bit for bit.
fn different(one: &GBuffer, other: &GBuffer) -> [usize; 10] {
    fn count<T>(one: &[T], other: &[T], is_same: impl Fn(&T, &T) -> bool) -> usize {
        assert_eq!(one.len(), other.len());
        one.iter().zip(other).filter(|(one, other)| !is_same(one, other)).count()
    }
    let pixels = || 0..one.status.len();
    let drawn = |pixel: &usize| one.is_drawn(*pixel);
    let ends = |[near, far]: [f64; 2]| [near.to_bits(), far.to_bits()];
    [
        count(&one.status, &other.status, |a, b| a == b),
        pixels().filter(|&pixel| one.reason(pixel) != other.reason(pixel)).count(),
        count(&one.bracket, &other.bracket, |a, b| ends(*a) == ends(*b)),
        pixels().filter(|&pixel| one.distance(pixel) != other.distance(pixel)).count(),
        count(&one.drawn, &other.drawn, |a, b| a == b),
        pixels().filter(drawn).filter(|&pixel| one.surface[pixel] != other.surface[pixel]).count(),
        pixels().filter(drawn).filter(|&pixel| one.normal[pixel] != other.normal[pixel]).count(),
        count(&one.cap, &other.cap, |a, b| a == b),
        count(&one.shadow, &other.shadow, |a, b| a == b),
        count(&one.occlusion, &other.occlusion, |a, b| a == b),
    ]
}

/// Texts with translucent surfaces, colored values, contour lines, cut solids and undecided pixels.
const TEXTS: [&str; 5] = [
    "domain 1.3\nx^2+y^2+z^2=1",
    "domain 2\nx^4-5x^2+y^4-5y^2+z^4-5z^2+11.8; color steelblue 50%\nz=0.4; (x-1)^2+y^2<=0.1",
    "domain 3\ncolor viridis(z)\ncontours x\nsin x cos y + sin y cos z + sin z cos x = 0",
    "domain 1\n(x^2+y^2+z^2-0.8)^2=0",
    "domain 2\nfloor(2x)+y^2 <= z",
];

#[test]
fn strips_are_parts_of_the_whole_bit_for_bit() {
    let plain = Settings { width: 130, height: 118, occlusion: true, ..Settings::default() };
    let sixteen = Pattern::of(16).expect("a pattern");
    let depth = ColorDepth::Floats;
    let choices = Choices { shadows: Some(true), ..plain.choices };
    let shadow_depth = Some(7);
    let fine = Settings { antialias: sixteen, choices, shadow_depth, depth, ..plain.clone() };
    let marked = Settings { undecided: UndecidedStyle::Hatch, brackets: true, ..plain.clone() };
    let double = Settings {
        options: TraceOptions { precision: Precision::F64, ..fine.options },
        ..fine.clone()
    };
    for text in TEXTS {
        for settings in [&fine, &marked, &double] {
            let (model, camera) = scene(text, settings);
            let whole = model.trace(&camera, settings, &|_| true).expect("compiled");
            for rows in [16, 48] {
                let (all, told) = together(&model, &camera, settings, rows);
                assert_eq!(different(&all.buffer, &whole.buffer), [0; 10], "{text}: {rows} rows");
                let differ = all.rgb.iter().zip(&whole.rgb).filter(|(one, other)| one != other);
                assert_eq!((all.rgb.len(), differ.count()), (whole.rgb.len(), 0), "{text}");
                assert!(all.light == whole.light, "{text}");
                let (of_all, of_whole) = (&told.statistics, &whole.statistics);
                assert_eq!((of_all.pixels, of_all.open), (of_whole.pixels, of_whole.open));
                assert_eq!(of_all.edge_rays, of_whole.edge_rays);
                assert_eq!(told.why_undecided(), whole.why_undecided());
                assert_eq!((told.buffer.height, told.rgb.len()), (0, 0));
            }
        }
    }
}

#[test]
fn a_picture_of_moderate_size_is_one_strip() {
    let settings = Settings { width: 40, height: 30, occlusion: true, ..Settings::default() };
    let (model, camera) = scene(TEXTS[0], &settings);
    let mut strips = 0;
    let mut count = |strip: Strip<'_>| -> Result<(), ProgramError> {
        assert!(strip.overview.is_none() && strip.picture.buffer.height == 30);
        strips += 1;
        Ok(())
    };
    let told = model.strips(&camera, &settings, None, &mut count).expect("compiled");
    assert_eq!((strips, told.buffer.height), (1, 0));
    assert_eq!(told.statistics.pixels.hit + told.statistics.pixels.miss, 1200);
}
