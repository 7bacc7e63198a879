//! Times every method on whole pictures, with normals and colors, on one thread. A picture has
//! 512×512 pixels, or N×N with `--size=N`.
//!
//! `cargo bench --bench frame [-- SURFACES… METHODS… FLAGS…]` prints a line for each surface and
//! method. It has the median milliseconds of interleaved rounds, the numbers of boxes, tiles,
//! segments and points evaluated, and the numbers of hits and of undecided pixels. Flags:
//! `--no-contract`, `--no-tiles`, `--no-interval`, `--f32`, `--f64`, `--rounds=N`, `--size=N`, and
//! `--cold`, which evicts the previous frame from the caches. To profile one round, compare runs
//! with `--rounds=1` and `--rounds=2`.

use glam::DVec3;
use include_dir::{Dir, include_dir};
use std::time::Duration;
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_trace::{METHODS, Method, Precision, TraceOptions};

/// Default of `--rounds`.
const ROUNDS: usize = 15;

/// Function files of the gyroid and of the surfaces in Knoll et al. 2007. Each states its domain.
static SURFACES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/crates/chart/data");

fn milliseconds(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e3
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let given = |option: &str| std::env::args().any(|given| given == option);
    let precision = match (given("--f32"), given("--f64")) {
        (true, false) => Precision::F32,
        (false, true) => Precision::F64,
        _ => Precision::Auto,
    };
    let rounds = std::env::args().find_map(|given| given.strip_prefix("--rounds=")?.parse().ok());
    let rounds = rounds.unwrap_or(ROUNDS).max(1);
    let size = std::env::args().find_map(|given| given.strip_prefix("--size=")?.parse().ok());
    // With `--cold`, writing this memory before each picture evicts the caches' content.
    let mut others = vec![0_u8; if given("--cold") { 64 << 20 } else { 0 }];
    // If surface and method share a name, it selects the surface. Given twice, it selects both.
    let times = |name: &str| wanted.iter().filter(|wanted| *wanted == name).count();
    let is_surface = |name: &str| SURFACES.get_file(format!("{name}.zset")).is_some();
    let named = |method: &&Method| times(method.name) > usize::from(is_surface(method.name));
    let some = METHODS.iter().any(|method| named(&method));
    let methods: Vec<&Method> = METHODS.iter().filter(|method| !some || named(method)).collect();
    println!(
        "{:14}{:10}{:>8}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}",
        "",
        "method",
        "trace",
        "shade",
        "boxes",
        "tiles",
        "segments",
        "points",
        "hits",
        "open",
        "ms"
    );
    let files = SURFACES.files().map(|file| {
        let name = file.path().file_stem().and_then(|name| name.to_str());
        (name.expect("UTF-8"), file.contents_utf8().expect("UTF-8"))
    });
    let surfaces: Vec<(&str, &str)> = files.collect();
    let given = |name: &str| wanted.iter().any(|wanted| wanted == name);
    let any = surfaces.iter().any(|(name, _)| given(name));
    for (name, text) in surfaces.into_iter().filter(|(name, _)| !any || given(name)) {
        let document = read(text, &Options::default()).expect(name);
        let (region, _) = view::region(&document, DomainChoice::Document, None).expect(name);
        let eye = DVec3::new(2.0, 1.5, 3.0) * region.half_extent();
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, projection).expect(name);
        let size = size.unwrap_or(Settings::default().width);
        let settings = Settings {
            options: TraceOptions {
                precision,
                contract: !given("--no-contract"),
                tiles: !given("--no-tiles"),
                intervals: !given("--no-interval"),
                ..TraceOptions::default()
            },
            width: size,
            height: size,
            keeps_normals: false,
            ..Settings::default()
        };
        let model = Model::new(&document, &region, &settings).expect(name);
        let mut times = vec![(Vec::new(), Vec::new()); methods.len()];
        let mut pictures: Vec<Picture> = Vec::new();
        for round in 0..=rounds {
            for (method, times) in methods.iter().zip(&mut times) {
                let settings = Settings { method, ..settings.clone() };
                std::hint::black_box(&mut others).fill(round as u8);
                let picture = model.trace(&camera, &settings, &|_| true).expect(name);
                if round > 0 {
                    times.0.push(picture.statistics.times.trace);
                    times.1.push(picture.statistics.times.shade);
                    picture.hand_back();
                } else {
                    pictures.push(picture);
                }
            }
        }
        for ((method, times), picture) in methods.iter().zip(times).zip(pictures) {
            let (work, pixels) = (picture.statistics.work, picture.statistics.pixels);
            let (trace, shade) = (milliseconds(times.0), milliseconds(times.1));
            println!(
                "{name:14}{:10}{trace:8.2}{shade:8.2}{:9}{:9}{:9}{:9}{:9}{:8}{:8.2}",
                method.name,
                work.interval.lanes,
                work.tiles.lanes,
                work.segments.lanes,
                work.point.lanes,
                pixels.hit,
                pixels.undecided,
                trace + shade
            );
        }
    }
}
