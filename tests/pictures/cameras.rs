//! Claims of gallery pictures are compared with the certified tracer. Random cameras are far,
//! close, grazing and inside.
//!
//! The full run: `ZEROSET_CASES=200 cargo test --release --test all cameras -- --nocapture`.

use super::property_support::{claims, picture};
use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use zeroset_scene::gallery::examples;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_syntax::{Options, read};
use zeroset_testkit::property::{Formula, Pixel, RayClaim, Scene, picture as check_claims};
use zeroset_testkit::{Adversarial, Effort, Rng};
use zeroset_trace::{METHODS, RayGrid};

/// Width and height of a picture. It has tiles of every size, and incomplete tiles.
const SIZE: [usize; 2] = [84, 60];
/// Rays per picture and method that the certified tracer checks.
const RAYS: u32 = 48;

/// The gallery's formulas within their domains, with their names.
fn formulas() -> Vec<(&'static str, Formula)> {
    let mut formulas = Vec::new();
    for example in examples() {
        let document = read(example.text, &Options::default()).expect(example.slug);
        let (region, _) = region(&document, DomainChoice::Document, None).expect(example.slug);
        let bounds = [0, 1, 2].map(|axis| [region.low()[axis], region.high()[axis]]);
        let formula = Formula::from_text(example.text, bounds).expect("shows all that it draws");
        formulas.push((example.slug, formula));
    }
    formulas
}

fn vector(f: impl Fn(usize) -> f64) -> [f64; 3] {
    [f(0), f(1), f(2)]
}

/// A random direction of any length.
fn direction(rng: &mut Rng) -> [f64; 3] {
    loop {
        let way = [(); 3].map(|()| 2.0 * f64::uniform(rng) - 1.0);
        let square: f64 = way.iter().map(|part| part * part).sum();
        if (0.01..=1.0).contains(&square) {
            return way;
        }
    }
}

fn from_afar(formula: &Formula, rng: &mut Rng) -> Scene {
    let half = formula.region.map(|[low, high]| 0.5 * (high - low));
    let way = direction(rng);
    let size = way.iter().map(|part| part * part).sum::<f64>().sqrt();
    let away = 2.0 + 2.0 * f64::uniform(rng);
    Scene {
        eye: vector(|axis| formula.aim[axis] + away * half[axis] * way[axis] / size),
        target: formula.aim,
        up: direction(rng),
        fov: if rng.u32(0..4) == 0 {
            Err(half[0] + half[2])
        } else {
            Ok(20.0 + 50.0 * f64::uniform(rng))
        },
        size: SIZE,
        depth: 10,
        tolerance: 0.5,
        precision: "auto",
        formula: formula.clone(),
    }
}

/// A random painted point of a picture, with its normal.
fn painted(scene: &Scene, rng: &mut Rng) -> Option<([f64; 3], [f64; 3])> {
    let (camera, picture) = picture(scene, &METHODS[0])?;
    let buffer = &picture.buffer;
    let painted: Vec<usize> = (0..buffer.drawn.len()).filter(|&k| buffer.is_drawn(k)).collect();
    let pixel = *painted.get(rng.u64(0..painted.len().max(1) as u64) as usize)?;
    let ray = RayGrid::new(&camera, SIZE[0], SIZE[1]).ray_of(pixel);
    let point = ray.at(ray.parameter(buffer.drawn[pixel]));
    Some((point.to_array(), buffer.normal[pixel].map(f64::from)))
}

/// A scene with one of four kinds of camera: far, close to the surface, along it, or in the domain.
pub fn scene(formula: &Formula, kind: u64, rng: &mut Rng) -> Option<Scene> {
    let far = from_afar(formula, rng);
    let half = formula.region.map(|[low, high]| 0.5 * (high - low));
    let least = half.into_iter().fold(f64::INFINITY, f64::min);
    let away = least * 10_f64.powf(-1.0 - 4.0 * f64::uniform(rng));
    let tangent = |normal: [f64; 3], rng: &mut Rng| {
        let way = direction(rng);
        let dot: f64 = (0..3).map(|axis| way[axis] * normal[axis]).sum();
        vector(|axis| way[axis] - dot * normal[axis])
    };
    match kind {
        0 => Some(far),
        1 => {
            let (point, normal) = painted(&far, rng)?;
            let aside = tangent(normal, rng);
            let eye = vector(|axis| point[axis] + away * (normal[axis] + aside[axis]));
            Some(Scene { eye, target: point, ..far })
        }
        2 => {
            let (point, normal) = painted(&far, rng)?;
            let along = tangent(normal, rng);
            let back = least * (0.2 + 3.0 * f64::uniform(rng));
            let eye = vector(|axis| point[axis] + back * along[axis] + away * normal[axis]);
            Some(Scene { eye, target: point, fov: Ok(1.0 + 20.0 * f64::uniform(rng)), ..far })
        }
        _ => {
            let inside = |rng: &mut Rng| {
                formula.region.map(|[low, high]| low + (high - low) * f64::uniform(rng))
            };
            let (eye, target) = (inside(rng), inside(rng));
            Some(Scene { eye, target, fov: Ok(60.0 + 60.0 * f64::uniform(rng)), ..far })
        }
    }
}

/// Comparison of pictures' claims with the certified tracer.
#[derive(Default)]
pub struct Survey {
    /// Number of rays compared, by method.
    counts: BTreeMap<&'static str, u64>,
    /// Number of rays with a certain crossing.
    pub crossings: u64,
    /// Number of hits on each surface of a scene.
    pub hits: [u64; 3],
}

impl Survey {
    /// Chooses random pixels of each method's picture. If some pixels are undecided, at least half
    /// of the chosen ones are.
    fn chosen(&mut self, scene: &Scene, rng: &mut Rng) -> Vec<Pixel> {
        let mut chosen = Vec::new();
        for method in &METHODS {
            let Some((camera, picture)) = picture(scene, method) else { continue };
            let all = claims(scene, &camera, &picture);
            let undecided: Vec<&Pixel> = all
                .iter()
                .filter(|pixel| matches!(pixel.claimed, RayClaim::Undecided(_)))
                .collect();
            for k in 0..RAYS {
                let pixel = match &undecided[..] {
                    some if k % 2 == 0 && !some.is_empty() => {
                        *some[rng.u32(0..some.len() as u32) as usize]
                    }
                    _ => all[rng.u32(0..all.len() as u32) as usize],
                };
                *self.counts.entry(method.name).or_default() += 1;
                if let Some((surface, _)) = pixel.hit {
                    self.hits[surface] += 1;
                }
                chosen.push(pixel);
            }
        }
        chosen
    }

    /// Compares the claims of a scene's pictures, and counts them.
    ///
    /// # Panics
    /// If a claim is false. The message names the claim and how to repeat the case.
    pub fn add(&mut self, scene: &Scene, case: u64, rng: &mut Rng) {
        let pixels = self.chosen(scene, rng);
        let tally = check_claims(scene, &|_| Some(pixels.clone()))
            .unwrap_or_else(|failure| panic!("ZEROSET_SEED={case:#x} ZEROSET_CASES=1: {failure}"));
        self.crossings += tally.defined;
    }

    /// Number of rays compared.
    pub fn compared(&self) -> u64 {
        self.counts.values().sum()
    }
}

impl Display for Survey {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { counts, crossings, hits } = self;
        write!(f, "rays {counts:?}, {crossings} with a certain crossing, hits {hits:?}")
    }
}

#[test]
fn pictures_of_the_gallery_claim_nothing_false_from_anywhere() {
    let effort = Effort::from_environment(0x5eed_0760, 24);
    let formulas = formulas();
    let (mut survey, mut none) = (Survey::default(), 0);
    for case in effort.seed..effort.seed + effort.cases {
        let rng = &mut Rng::with_seed(case);
        // The factor gives neighboring cases different surfaces and cameras.
        let (slug, formula) = &formulas[(case * 29 % formulas.len() as u64) as usize];
        let Some(scene) = scene(formula, case % 4, rng) else {
            println!("case {case:#x}: nothing of {slug} is seen");
            none += 1;
            continue;
        };
        survey.add(&scene, case, rng);
    }
    println!("{survey}; {none} cameras see nothing");
    assert!(
        survey.compared() > 40 * (effort.cases - none)
            && survey.crossings > survey.compared() / 5
            && none < effort.cases / 4
    );
}
