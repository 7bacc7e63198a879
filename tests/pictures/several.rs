//! Claims of pictures of several surfaces, compared with the nearest root that the certified tracer
//! finds. The surfaces hide, meet and touch one another, coincide or nearly do, and some are
//! solids.
//!
//! A long run: `ZEROSET_CASES=2000 cargo test --release --test all several -- --nocapture`.

use super::cameras::{Survey, scene};
use super::property_support::picture_with;
use zeroset_testkit::property::{Formula, Scene};
use zeroset_testkit::{Adversarial, Effort, Rng};
use zeroset_trace::{GBuffer, METHODS};

/// Half the side of the region.
const EXTENT: f64 = 2.0;

/// A random multiple of 1/8 as text, from `low` to `high` eighths. It is exact in all floats.
fn eighths(rng: &mut Rng, low: i32, high: i32) -> String {
    format!("({:?})", f64::from(rng.i32(low..=high)) / 8.0)
}

/// A function that has zeros in the region.
fn function(rng: &mut Rng) -> String {
    let [x, y, z] = ["x", "y", "z"].map(|axis| format!("({axis}-{})", eighths(rng, -8, 8)));
    let size = eighths(rng, 4, 12);
    match rng.u32(0..7) {
        0 | 1 => format!("{x}^2+{y}^2+{z}^2-{size}^2"),
        2 => {
            let [a, b, c] = [(); 3].map(|()| eighths(rng, -8, 8));
            format!("{a}*{x}+{b}*{y}+{c}*{z}+{z}/16")
        }
        3 => format!("({x}^2+{y}^2+{z}^2+0.84*{size}^2)^2-4*{size}^2*({x}^2+{y}^2)"),
        4 => format!("abs{x}+abs{y}+abs{z}-{size}"),
        5 => format!("sin(3*{x})*cos(2*{y})-{z}"),
        _ => format!("{size}/{x}+{y}-{z}"),
    }
}

/// A second function. Its zeros coincide with those of `other`, lie next to them, touch them along
/// a curve, or are anywhere.
fn beside(other: &str, rng: &mut Rng) -> String {
    match rng.u32(0..5) {
        0 => other.to_owned(),
        1 => {
            let sign = if rng.bool() { '+' } else { '-' };
            format!("{other}{sign}2^-{}", rng.u32(2..=24))
        }
        2 => format!("{other}+({})^2", function(rng)),
        _ => function(rng),
    }
}

fn formula(rng: &mut Rng) -> Formula {
    let mut functions = vec![function(rng)];
    for _ in 0..rng.u32(1..=2) {
        functions.push(beside(&functions[0], rng));
    }
    let texts: Vec<String> = functions
        .into_iter()
        .map(|function| format!("{function} {} 0", ["=", "=", "<=", ">="][rng.u32(0..4) as usize]))
        .collect();
    let text = texts.join("; ");
    Formula::from_text(&text, [[-EXTENT, EXTENT]; 3]).expect(&text)
}

/// A random scene; `None` if its camera shows nothing.
fn random_scene(case: u64, rng: &mut Rng) -> Option<Scene> {
    let formula = formula(rng);
    let scene = scene(&formula, case % 4, rng)?;
    let precision = ["auto", "f32", "f64"][rng.u32(0..3) as usize];
    let tolerance = if f64::uniform(rng) < 0.5 { 0.5 } else { 5e-4 };
    Some(Scene { precision, tolerance, ..scene })
}

#[test]
fn pictures_of_several_surfaces_claim_nothing_false() {
    let effort = Effort::from_environment(0x5eed_0770, 40);
    let (mut survey, mut none) = (Survey::default(), 0);
    for case in effort.seed..effort.seed + effort.cases {
        let rng = &mut Rng::with_seed(case);
        match random_scene(case, rng) {
            Some(scene) => survey.add(&scene, case, rng),
            None => none += 1,
        }
    }
    println!("{survey}; {none} cameras see nothing");
    // A single repeated case need not reach the averages that many cases reach.
    if effort.cases > 1 {
        let each = effort.cases / 2;
        assert!(survey.crossings > survey.compared() / 3 && none < effort.cases / 4);
        assert!(survey.hits[0] > 8 * each && survey.hits[1] > 4 * each && survey.hits[2] > each);
    }
}

#[test]
fn a_zero_may_lie_before_an_undecided_segment_that_its_bracket_reaches_beyond() {
    // In one pixel of this case, a sphere's zero lies before an undecided segment of a solid. The
    // segment begins before the middle of the zero's bracket.
    const CASE: u64 = 0x5eed_a2a3;
    let rng = &mut Rng::with_seed(CASE);
    let scene = random_scene(CASE, rng).expect("a view");
    let mut survey = Survey::default();
    survey.add(&scene, CASE, rng);
    assert!(survey.crossings > 100, "{survey}");
    // Claims do not depend on whether brackets are stored.
    let [(_, kept), (_, plain)] =
        [true, false].map(|kept| picture_with(&scene, &METHODS[0], kept).expect("a picture"));
    assert!(plain.buffer.bracket.is_empty());
    for pixel in 0..plain.buffer.status.len() {
        let claim = |buffer: &GBuffer| (buffer.status[pixel], buffer.distance(pixel).to_bits());
        assert_eq!(claim(&kept.buffer), claim(&plain.buffer), "pixel {pixel}");
    }
}
