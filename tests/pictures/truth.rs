//! Pictures of the whole gallery against exact first roots: no claim is false, and how far off the paint is.

use crate::truth_support::table::{Row, Table};
use crate::truth_support::{SIDE, Truth, compare, read, rounding};
use glam::DVec3;
use zeroset::gallery::example;
use zeroset::model::render;
use zeroset::picture::{Precision, Settings};
use zeroset::scene::{DomainChoice, bounds, region};
use zeroset_syntax::{Options, read as read_document};
use zeroset_trace::{Camera, GBuffer, Projection, RayGrid, Status};

/// The depth of the table.
const DEPTH: u32 = 12;

/// Rays with a crossing which the reference decided, over all surfaces.
const CROSSINGS: usize = 95_746;

/// What is varied.
#[derive(Clone, Copy, Debug)]
struct Method(u32, Precision);

/// That of the table.
const TABLE: Method = Method(DEPTH, Precision::F32);

/// The surface as seen by the reference's camera.
fn picture(truth: &Truth, method: Method) -> (RayGrid, GBuffer) {
    let view = &truth.view;
    let example = example(&view.slug).unwrap_or_else(|| panic!("no example {}", view.slug));
    let document = read_document(example.text, &Options::default())
        .unwrap_or_else(|errors| panic!("{}: {errors}", view.slug));
    let (region, _) = region(&document, DomainChoice::Document, None).expect("a domain");
    let domain = bounds(&region).map(|range| [range.lo, range.hi]);
    assert_eq!(domain.as_flattened(), view.domain, "{}: another domain", view.slug);
    let [eye, target, up] = [view.eye, view.target, view.up].map(DVec3::from_array);
    let projection = Projection::Perspective { fov: view.fov };
    let camera = Camera::new(eye, target, up, projection).expect("a camera");
    let (width, height) = (SIDE, SIDE);
    let Method(max_depth, precision) = method;
    let settings =
        Settings { width, height, max_depth, precision, normals: None, ..Settings::default() };
    let picture = render(&document, &region, &camera, &settings, &|_, _| {})
        .unwrap_or_else(|error| panic!("{}: {error}", view.slug));
    (camera.rays(SIDE, SIDE), picture.buffer)
}

/// Every claim about a ray that its first root contradicts.
///
/// A miss claims that there is no root, a distance that there is none before it. Both must hold for roots of any
/// multiplicity, hence for crossings. The painted point claims nothing, but lies nowhere that is proven empty.
fn contradictions(
    truth: &Truth,
    precision: Precision,
    frame: &RayGrid,
    buffer: &GBuffer,
) -> Vec<String> {
    let mut found = Vec::new();
    for (index, pixel) in truth.pixels.iter().enumerate() {
        let (status, distance) = (buffer.status[index], buffer.distance[index]);
        let drawn = buffer.drawn[index];
        let lost = status == Status::Miss && pixel.zero.is_finite();
        let beyond = distance > pixel.zero + rounding(precision) * (1.0 + pixel.zero);
        if drawn < distance || !pixel.open && (lost || beyond) {
            let (slug, ray) = (&truth.view.slug, frame.ray_of(index));
            let (i, j) = (index % SIDE, index / SIDE);
            found.push(format!(
                "{slug}, column {i}, row {j}: {status:?} from {distance}, painted at {drawn}, \
                 but {pixel:?} on {ray:?}"
            ));
        }
    }
    found
}

fn expect_none(contradictions: &[String]) {
    let first = contradictions[..contradictions.len().min(20)].join("\n");
    assert!(contradictions.is_empty(), "{} false claims:\n{first}", contradictions.len());
}

#[test]
fn no_claim_contradicts_an_exact_root_and_the_table_is_as_before() {
    let mut rows = Vec::new();
    let mut false_claims = Vec::new();
    for truth in read("truth") {
        let (frame, buffer) = picture(&truth, TABLE);
        false_claims.extend(contradictions(&truth, Precision::F32, &frame, &buffer));
        rows.push(Row::new(&truth, &buffer, DEPTH));
    }
    expect_none(&false_claims);
    let total = |head| rows.iter().map(|row| row.count(head)).sum::<usize>();
    assert_eq!((total("cross"), total("lost")), (CROSSINGS, 0));

    compare("truth_table.txt", &Table(&rows).to_string());
}

/// At the greatest depth, slabs are as thin as the floats can tell apart.
#[test]
fn no_claim_of_thinner_slabs_contradicts_an_exact_root() {
    let methods = [
        Method(16, Precision::F32),
        Method(Precision::F32.max_depth(), Precision::F32),
        Method(DEPTH, Precision::F64),
        Method(Precision::F64.max_depth(), Precision::F64),
    ];
    let mut false_claims = Vec::new();
    for truth in read("truth") {
        for method in methods {
            let (frame, buffer) = picture(&truth, method);
            let found = contradictions(&truth, method.1, &frame, &buffer);
            false_claims.extend(found.iter().map(|claim| format!("{method:?}: {claim}")));
        }
    }
    expect_none(&false_claims);
}

#[test]
fn false_claims_are_noticed() {
    let truths = read("truth");
    let sphere = truths.iter().find(|truth| truth.view.slug == "sphere").expect("a sphere");
    let (frame, right) = picture(sphere, TABLE);
    let noticed = |buffer: &GBuffer| contradictions(sphere, Precision::F32, &frame, buffer).len();
    assert_eq!(noticed(&right), 0);
    let roots = sphere.pixels.iter().filter(|pixel| pixel.zero.is_finite()).count();
    assert_eq!(noticed(&GBuffer::new(SIDE, SIDE, 0)), roots);

    let mut late = right.clone();
    for (distance, pixel) in late.distance.iter_mut().zip(&sphere.pixels) {
        *distance = pixel.zero * (1.0 + 4.0 * rounding(Precision::F32));
    }
    late.drawn.clone_from(&late.distance);
    assert_eq!(noticed(&late), roots);

    let mut early = right.clone();
    early.drawn.iter_mut().for_each(|drawn| *drawn -= 1e-3);
    assert_eq!(noticed(&early), right.counts().undecided);
}
