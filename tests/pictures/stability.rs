//! Formulas on which methods for implicit surfaces are known to fail. Claims about these formulas
//! must be true. Points painted without a root are counted.

use super::truth_support::{Pixel, SIDE, Truth, compare, path, read, rounding};
use glam::DVec3;
use serde::Deserialize;
use std::fmt::Write;
use std::fs::File;
use zeroset_render::model::render;
use zeroset_render::picture::{Picture, Precision, Settings};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Document, Options};
use zeroset_trace::{METHODS, Method, Proves, RayGrid, Status, TraceOptions, UndecidedReason};

/// The depth with which the method `knoll` draws the pictures for the table of results.
const DEPTH: u32 = 12;

/// A formula, and a description of its correct picture.
#[derive(Deserialize)]
pub struct Case {
    pub slug: String,
    pub formula: String,
    pub domain: [f64; 6],
    want: String,
    /// The largest share of pixels that may be undecided.
    #[serde(default)]
    pub max_undecided: f64,
    /// Expected result for a formula whose roots are not known.
    #[serde(default)]
    pub expect: String,
}

pub fn cases(name: &str) -> Vec<Case> {
    let file = File::open(path(name)).expect("a list");
    serde_json::from_reader(file).expect("a valid list")
}

pub fn region(case: &Case) -> Region {
    let [x0, x1, y0, y1, z0, z1] = case.domain;
    Region::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)).expect("a domain")
}

pub fn document(case: &Case) -> Document {
    let document = zeroset_syntax::read(&case.formula, &Options::default());
    document.unwrap_or_else(|errors| panic!("{}: {errors}", case.slug))
}

fn settings() -> Settings {
    Settings {
        options: TraceOptions {
            precision: Precision::F32,
            depth: DEPTH,
            ..TraceOptions::default()
        },
        width: SIDE,
        height: SIDE,
        method: Method::named("knoll").expect("a row"),
        ..Settings::default()
    }
}

/// A picture of the formula, drawn from the reference's camera.
fn picture(case: &Case, truth: &Truth) -> Picture {
    picture_with(case, truth, &settings())
}

pub fn picture_with(case: &Case, truth: &Truth, settings: &Settings) -> Picture {
    let [eye, target, up] =
        [truth.view.eye, truth.view.target, truth.view.up].map(DVec3::from_array);
    let projection = Projection::Perspective { fov: truth.view.fov };
    let camera = Camera::new(eye, target, up, projection).expect("a camera");
    let picture = render(&document(case), &region(case), &camera, settings);
    picture.unwrap_or_else(|error| panic!("{}: {error}", case.slug))
}

/// Counts of results on rays that the reference decides.
#[derive(Default)]
struct Tally {
    open: usize,
    roots: usize,
    misses: usize,
    hits: usize,
    painted: usize,
    walls: usize,
    blank: usize,
    /// Claims that contradict a root or the lack of one.
    false_claims: Vec<String>,
}

impl Tally {
    fn new(case: &Case, truth: &Truth, picture: &Picture, precision: Precision) -> Self {
        let mut tally = Self::default();
        for (index, pixel) in truth.pixels.iter().enumerate() {
            if pixel.open {
                tally.open += 1;
                continue;
            }
            let buffer = &picture.buffer;
            let (distance, drawn) = (buffer.distance(index), buffer.drawn[index]);
            tally.add(pixel, buffer.status[index], distance, drawn);
            if let Some(claim) = contradiction(pixel, buffer.status[index], distance, precision) {
                let (i, j) = (index % SIDE, index / SIDE);
                let claim = format!("{}, column {i}, row {j}: {claim} {pixel:?}", case.slug);
                tally.false_claims.push(claim);
            }
        }
        tally
    }

    fn add(&mut self, pixel: &Pixel, status: Status, distance: f64, drawn: f64) {
        let rooted = pixel.zero.is_finite();
        self.roots += usize::from(rooted);
        self.misses += usize::from(status == Status::Miss);
        self.hits += usize::from(status == Status::Hit);
        if status == Status::Undecided {
            self.painted += usize::from(drawn.is_finite());
            self.walls += usize::from(drawn.is_finite() && !rooted);
            self.blank += usize::from(distance.is_finite() && drawn.is_infinite());
        }
    }

    /// Number of rays painted without a root, as a share of all rays.
    fn share_of_walls(&self) -> f64 {
        self.walls as f64 / (SIDE * SIDE) as f64
    }
}

/// Describes a claim about a ray, if the ray's roots contradict it. A miss claims no root on the
/// ray. A distance claims no root before it. A hit claims a root at its distance.
fn contradiction(
    pixel: &Pixel,
    status: Status,
    distance: f64,
    precision: Precision,
) -> Option<String> {
    let room = rounding(precision) * (1.0 + distance.abs());
    let is_false = match status {
        Status::Miss => pixel.zero.is_finite(),
        Status::Undecided => distance > pixel.zero + room,
        Status::Hit => (distance - pixel.zero).abs() > room,
    };
    is_false.then(|| format!("{status:?} at {distance}, but"))
}

/// Cases that paint more pixels without a root than they should, each with the reason.
const TOO_MUCH: [(&str, &str); 2] = [
    ("chebyshev-12", "the last slabs are too thick for its large coefficients"),
    ("endpoint-extremum", "the domain is some thousand f32 steps wide"),
];

#[test]
fn no_claim_is_false_and_the_table_is_as_before() {
    let mut table = String::from(HEAD);
    let mut false_claims = Vec::new();
    for (case, truth) in cases("stability/index.json").iter().zip(read("stability")) {
        assert_eq!((&case.slug, case.domain), (&truth.view.slug, truth.view.domain));
        let picture = picture(case, &truth);
        let tally = Tally::new(case, &truth, &picture, Precision::F32);
        let share = tally.share_of_walls();
        let Tally { open, roots, misses, hits, painted, walls, blank, .. } = tally;
        let is_within = share <= case.max_undecided;
        writeln!(
            table,
            "{:18} {open:6} {roots:6} {misses:6} {hits:6} {painted:6} {walls:6} {blank:6}  {:6.2} {:6.2}{}",
            case.slug,
            100.0 * share,
            100.0 * case.max_undecided,
            if is_within { "" } else { "  !" },
        )
        .expect("a line");
        let reason = TOO_MUCH.iter().find(|(slug, _)| *slug == case.slug).map(|(_, why)| why);
        if let Some(reason) = reason {
            println!("{}: {reason}; wanted: {}", case.slug, case.want);
        }
        assert_eq!(is_within, reason.is_none(), "{}: {:.2} % of walls", case.slug, 100.0 * share);
        let normals = &picture.buffer.normal;
        assert!(normals.iter().flatten().all(|part| part.is_finite()), "{}", case.slug);
        false_claims.extend(tally.false_claims);
    }
    print!("{table}");
    let first = false_claims[..false_claims.len().min(20)].join("\n");
    assert!(false_claims.is_empty(), "{} false claims:\n{first}", false_claims.len());
    compare("stability_table.txt", &table);
}

const HEAD: &str = "\
Formulas on which other methods fail, 64x64 rays, depth 12, compared with exact first roots.
The test `stability` compares this table; ZEROSET_BLESS=1 cargo test --test all stability:: writes it.

  open   rays that the reference could not decide; they count in no other column
  roots  rays with a root
  miss   rays proven to have none
  hit    rays proven to have one
  paint  undecided rays on which a point is painted
  walls  those of them without a root
  blank  undecided rays on which nothing is painted
  share  of walls in all rays, in percent
  want   the largest share that is wanted; those above are marked

                     open  roots   miss    hit  paint  walls  blank   share   want
";

/// Checks a function that is 0 throughout a solid. Rays that meet the solid must be undecided from
/// their first point in it.
pub fn check_zero_throughout(case: &Case, frame: &RayGrid, picture: &Picture) {
    let region = region(case);
    let is_inside = |point: DVec3| match case.slug.as_str() {
        "zero-times-inf" => true,
        // The solid's radius is 9. A margin for rounding is subtracted.
        "solid-zero" => point.x.hypot(point.y) < 8.999,
        other => panic!("what is the solid of {other}?"),
    };
    let mut met = 0;
    for index in 0..SIDE * SIDE {
        let ray = frame.ray_of(index);
        let points = (0..20_000).map(|step| f64::from(step) * 3e-3);
        let first = points.into_iter().find(|&distance| {
            let point = ray.at(ray.parameter(distance));
            point.cmpge(region.low()).all() && point.cmple(region.high()).all() && is_inside(point)
        });
        let Some(first) = first else { continue };
        met += 1;
        let (status, distance) = (picture.buffer.status[index], picture.buffer.distance(index));
        assert_eq!(status, Status::Undecided, "{} pixel {index}", case.slug);
        assert!(distance <= first + rounding(Precision::F32), "{} pixel {index}", case.slug);
    }
    assert!(met > 500, "{}: {met} rays meet the solid", case.slug);
    println!("{}: {met} rays undecided from their first point in it", case.slug);
}

#[test]
fn what_has_no_single_roots_is_refused_or_undecided() {
    for case in cases("stability/others.json") {
        let region = region(&case);
        let document = document(&case);
        let choice = zeroset_scene::camera::CameraChoice::typed(&document);
        let camera = zeroset_scene::camera::camera(&choice, &region).expect("a camera");
        let picture = match render(&document, &region, &camera, &settings()) {
            Ok(picture) => picture,
            Err(error) => {
                println!("{} is refused: {error}", case.slug);
                assert_eq!(case.expect, "refused-or-undecided", "{}: {error}", case.slug);
                continue;
            }
        };
        let counts = picture.buffer.counts();
        println!("{}: {counts:?}; wanted: {}", case.slug, case.want);
        match case.expect.as_str() {
            "undecided-from-entry" => {
                check_zero_throughout(&case, &RayGrid::new(&camera, SIDE, SIDE), &picture);
            }
            "refused-or-undecided" => {
                assert_eq!(counts.hit, 0, "{}", case.slug);
                assert!(counts.undecided > 0, "{}", case.slug);
            }
            other => panic!("{}: {other}?", case.slug),
        }
        assert!(picture.buffer.normal.iter().flatten().all(|part| part.is_finite()));
    }
}

/// A painted point has a normal even where the gradient is infinite, undefined or 0.
#[test]
fn every_painted_point_has_a_normal() {
    let unit = DVec3::splat(2.0);
    let region = Region::new(-unit, unit).expect("a cube");
    for formula in [
        "sqrt(x^2+y^2) - z",
        "x^2+y^2 - z^2",
        "abs(x) - z",
        "abs(abs(x) - abs(y)) - z",
        "cbrt(x) - y",
        "x^(1/3) - y",
        "x^1.5 - y",
        "sqrt(x) - y",
        "sqrt(1-x^2-y^2) - z",
        "sqrt(abs(x)) + z",
        "(x^2+y^2+z^2-1)^2",
        "abs(x^2+y^2+z^2-1)",
        "max(x, y, z) - 1",
        "x*(1/x) - 1",
        "sign(x) - y",
        "floor(x) > 0.5 and y < 1",
        "sqrt(x) < 1",
        "atan2(y, x) - z",
        "x^y - z",
        "y/x - z",
    ] {
        let document = zeroset_syntax::read(formula, &Options::default()).expect("reads");
        // From the front, some rays meet kinks and edges exactly.
        let eyes = [DVec3::new(4.0, -6.0, 3.0), DVec3::new(0.0, -8.0, 0.0)];
        for (method, eye) in METHODS.iter().flat_map(|method| eyes.map(|eye| (method, eye))) {
            let projection = Projection::Perspective { fov: 40.0 };
            let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
            let (width, height) = (SIDE + 1, SIDE + 1);
            let settings = Settings { width, height, method, ..settings() };
            let picture = render(&document, &region, &camera, &settings);
            let buffer = picture.expect("a picture").buffer;
            let mut painted = 0;
            for pixel in (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)) {
                let normal = DVec3::from_array(buffer.normal[pixel].map(f64::from));
                assert!((normal.length() - 1.0).abs() < 1e-5, "{formula}, {method:?}: {normal}");
                painted += 1;
            }
            // Two exceptions: a method that samples misses roots without a change of sign, and a
            // method that bounds the slope draws nothing where it has no bound.
            let touches = formula.contains("z^2-1)");
            let is_blind = touches && method.proves == Proves::Nothing
                || buffer.reasons()[UndecidedReason::Steep as usize] > 0;
            assert!(painted > 20 || is_blind, "{formula} by {method:?} from {eye}: {painted}");
        }
    }
}

/// No claim in `f64` is false, and fewer points are painted without a root than in `f32`.
#[test]
fn no_claim_in_double_precision_is_false() {
    let mut false_claims = Vec::new();
    let mut walls = [0; 2];
    for (case, truth) in cases("stability/index.json").iter().zip(read("stability")) {
        for (precision, walls) in [Precision::F32, Precision::F64].into_iter().zip(&mut walls) {
            let picture = picture_with(
                case,
                &truth,
                &Settings {
                    options: TraceOptions { precision, ..settings().options },
                    ..settings()
                },
            );
            let tally = Tally::new(case, &truth, &picture, precision);
            *walls += tally.walls;
            if precision == Precision::F64 {
                false_claims.extend(tally.false_claims);
            }
        }
    }
    assert!(false_claims.is_empty(), "{}", false_claims.join("\n"));
    println!("painted without a root: {} in f32, {} in f64", walls[0], walls[1]);
    assert!(walls[1] < walls[0], "{walls:?}");
}

/// A painted point is as near to the root as a slab is long, even if slabs are too thin for `f32`.
#[test]
fn finer_slabs_in_double_precision_are_nearer_to_the_root() {
    for (case, truth) in cases("stability/index.json").iter().zip(read("stability")) {
        if !["far-sphere", "near-sheets"].contains(&case.slug.as_str()) {
            continue;
        }
        let extent = case.domain.chunks(2).map(|range| range[1] - range[0]).fold(0.0, f64::max);
        for max_depth in [12, 20, 28, 36] {
            let settings = Settings {
                options: TraceOptions {
                    precision: Precision::F64,
                    depth: max_depth,
                    ..settings().options
                },
                ..settings()
            };
            let buffer = picture_with(case, &truth, &settings).buffer;
            let rooted =
                truth.pixels.iter().enumerate().filter(|(_, p)| p.zero.is_finite() && !p.open);
            let errors: Vec<f64> =
                rooted.map(|(index, pixel)| (buffer.drawn[index] - pixel.zero).abs()).collect();
            let worst = errors.iter().copied().fold(0.0, f64::max);
            println!(
                "{} at depth {max_depth}: {} roots, off by {worst:e}",
                case.slug,
                errors.len()
            );
            // A slab is at most four times as long along a ray as along its axis.
            let slab = 4.0 * extent * 0.5_f64.powi(max_depth as i32);
            assert!(!errors.is_empty() && worst <= slab + 1e-9, "{worst:e} against {slab:e}");
        }
    }
}
