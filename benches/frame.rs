//! Whole pictures by every method: trace, normals and colours of 512×512 pixels on one thread.
//!
//! `cargo bench --bench frame [-- SURFACES… METHODS… --no-contract --no-tiles --no-interval]` prints, for each surface and method, median milliseconds of interleaved rounds,
//! what was asked of kernels, and how many pixels are decided.

use glam::DVec3;
use std::time::Duration;
use zeroset::model::Model;
use zeroset::picture::{Picture, Settings};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Camera, Ideas, METHODS, Method, Projection, Region};

const ROUNDS: usize = 15;

/// Names, formulas and half-extents of domains: those of Knoll et al. 2007, and the gyroid.
const SURFACES: [(&str, &str, f64); 10] = [
    ("sphere", "x^2+y^2+z^2-1", 1.2),
    ("torus", "(sqrt(x^2+y^2)-0.8)^2+z^2-0.11111", 1.3),
    ("steiner", "x^2*y^2+y^2*z^2+x^2*z^2+x*y*z", 1.0),
    ("mitchell", "4*(x^4+(y^2+z^2)^2)+17*x^2*(y^2+z^2)-20*(x^2+y^2+z^2)+17", 2.0),
    ("tangle", "x^4-5*x^2+y^4-5*y^2+z^4-5*z^2+11.8", 3.0),
    ("teardrop", "0.5*x^5+0.5*x^4-y^2-z^2", 1.2),
    ("klein", "(x^2+y^2+z^2+2*y-1)*((x^2+y^2+z^2-2*y-1)^2-8*z^2)+16*x*z*(x^2+y^2+z^2-2*y-1)", 4.2),
    (
        "barth",
        "4*(2.618033988749895*x^2-y^2)*(2.618033988749895*y^2-z^2)*(2.618033988749895*z^2-x^2)\
         -4.23606797749979*(x^2+y^2+z^2-1)^2",
        2.0,
    ),
    ("linked-tori", "((10*x)^2+(10*y-2)^2+(10*z)^2+13)^2-53*((10*x)^2+(10*y-2)^2)", 1.0),
    ("gyroid", "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)", std::f64::consts::TAU),
];

fn milliseconds(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e3
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let without = |idea: &str| std::env::args().any(|given| given == idea);
    let ideas = Ideas {
        contract: !without("--no-contract"),
        tiles: !without("--no-tiles"),
        intervals: !without("--no-interval"),
    };
    // A name of both is the surface's, unless it is given twice.
    let times = |name: &str| wanted.iter().filter(|wanted| *wanted == name).count();
    let is_surface = |name: &str| SURFACES.iter().any(|surface| surface.0 == name);
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
    for (name, formula, half) in SURFACES {
        let given = |name| wanted.iter().any(|wanted| wanted == name);
        if SURFACES.iter().any(|surface| given(surface.0)) && !given(name) {
            continue;
        }
        let document = read(formula, &Options::default()).expect(name);
        let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect(name);
        let eye = DVec3::new(2.0, 1.5, 3.0) * half;
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, projection).expect(name);
        let settings = Settings { ideas, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect(name);
        let mut times = vec![(Vec::new(), Vec::new()); methods.len()];
        let mut pictures: Vec<Picture> = Vec::new();
        for round in 0..=ROUNDS {
            for (method, times) in methods.iter().zip(&mut times) {
                let settings = Settings { method, ..settings.clone() };
                let picture = model.trace(&camera, &settings, &|_| true).expect(name);
                if round > 0 {
                    times.0.push(picture.statistics.times.trace);
                    times.1.push(picture.statistics.times.shade);
                    picture.buffer.hand_back();
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
