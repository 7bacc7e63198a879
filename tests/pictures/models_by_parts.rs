//! Random models that are drawn by parts: pictures, and patches of rays along edges. The steps that
//! matter in each part must prove nothing that all steps disprove.
//!
//! A long run: `ZEROSET_CASES=500 cargo test --test all models_by_parts -- --nocapture`.

use super::parts_support::models::Writer;
use super::parts_support::{Counts, EVALUATORS, Scene, claimed};
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};
use zeroset_render::picture::Precision;
use zeroset_scene::program::Program;
use zeroset_space::{Camera, HalfSpace, Projection};
use zeroset_testkit::{Effort, Rng};
use zeroset_trace::{GBuffer, Patch, RayGrid, Status, TraceOptions};

/// Number of patches of a surface, and number of times that they get windows.
const PATCHES: usize = 24;
const ROUNDS: usize = 3;
/// Largest error of the ends of a window, in t. They are rounded to `f32` relative to the region.
const SLACK: f64 = 1e-5;
/// Rows of a picture that is divided in the tree of parts.
const TALL: usize = 161;

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::from(rng.u32(0..=1 << 20)) / f64::from(1 << 20)
}

fn vector(rng: &mut Rng, reach: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| between(rng, -reach, reach)))
}

/// A camera outside of the model, in it, without perspective, or far away.
fn camera(rng: &mut Rng) -> Option<Camera> {
    let kind = rng.u32(0..8);
    let (eye, fov) = match kind {
        0..=2 => (vector(rng, 1.0).try_normalize()? * between(rng, 3.6, 8.0), (25.0, 60.0)),
        3 | 4 => (vector(rng, 1.8), (60.0, 110.0)),
        5 | 6 => (vector(rng, 1.0).try_normalize()? * between(rng, 3.6, 20.0), (0.0, 0.0)),
        _ => (vector(rng, 1.0).try_normalize()? * between(rng, 20.0, 400.0), (3.0, 40.0)),
    };
    let projection = match kind {
        5 | 6 => Projection::Orthographic { height: between(rng, 0.4, 5.0) },
        _ => Projection::Perspective { fov: between(rng, fov.0, fov.1) },
    };
    Camera::new(eye, vector(rng, 0.8), vector(rng, 1.0), projection).ok()
}

/// A model, the size of its picture, and a text that repeats the case. The error is the reason why
/// there is no surface or no view.
fn random_case(seed: u64) -> Result<(Scene, [usize; 2], String), String> {
    let mut rng = Rng::with_seed(seed);
    let rng = &mut rng;
    let is_tall = seed.is_multiple_of(9);
    let surfaces = if is_tall { 1 } else { [1, 1, 2, 3][rng.u32(0..4) as usize] };
    let mut writer = Writer::new(rng);
    for _ in 0..surfaces {
        writer.surface(if is_tall { 24 } else { 20 + 16 / surfaces + (seed % 13) as usize });
    }
    let text = writer.text();
    let size = if is_tall {
        [rng.u32(130..=200) as usize, rng.u32(TALL as u32..=200) as usize]
    } else {
        [rng.u32(17..=56) as usize, rng.u32(17..=56) as usize]
    };
    let mut scene = Scene::read(&text)?;
    scene.camera = camera(rng).ok_or("a camera without direction")?;
    if rng.u32(0..4) == 0 {
        let (normal, offset) = (vector(rng, 1.0), between(rng, -0.3, 0.8));
        scene.region = scene.region.with_clip(HalfSpace { normal, offset }).expect("a normal");
    }
    if rng.u32(0..6) == 0 {
        scene.region = scene.region.with_ball();
    }
    scene.options = TraceOptions {
        precision: [Precision::Auto, Precision::F32, Precision::F64][rng.u32(0..3) as usize],
        tolerance: [0.5, 0.5, 0.01][rng.u32(0..3) as usize],
        ..scene.options
    };
    let Scene { camera, region, options, .. } = &scene;
    let command = format!(
        "ZEROSET_SEED={seed:#x} ZEROSET_CASES=1 cargo test --test all models_by_parts -- --nocapture"
    );
    let case = format!("{command}\n{camera:?}\n{region:?}\n{options:?}\n{size:?}\n{text}");
    Ok((scene, size, case))
}

/// Counts over a run.
#[derive(Debug, Default)]
struct Survey {
    surfaces: usize,
    /// Surfaces that are drawn by parts.
    by_parts: usize,
    /// Pictures whose rows are so many that the tree of parts is divided.
    tall: usize,
    pixels: usize,
    pictures: Counts,
    /// Pictures by parts that are given up.
    given_up: Counts,
    /// Rays of patches with windows.
    rays: usize,
    patches: Counts,
    /// Zeros that lie in a window, so that they must be found.
    wanted: usize,
    /// Rays whose window has no zero although they have one elsewhere.
    elsewhere: usize,
}

/// A range of t around the first zero of a ray, beside it, or without ends.
fn window(rng: &mut Rng, zero: f64) -> [f64; 2] {
    let near = 10_f64.powf(between(rng, -4.5, -1.0));
    let far = 10_f64.powf(between(rng, -2.0, 0.7));
    let window = match rng.u32(0..9) {
        0 => [zero - near, zero + far],
        1 => [zero - far, zero + near],
        2 => [zero - far, zero + far],
        3 => [zero - far, zero - near],
        4 => [zero + near, zero + far],
        5 => [0.0, zero + near],
        6 => [zero - near, f64::INFINITY],
        7 => [zero + near, f64::INFINITY],
        _ => [0.0, f64::INFINITY],
    };
    window.map(|t| t.max(0.0))
}

/// A case whose patches are compared.
struct PatchCase<'a> {
    scene: &'a Scene,
    programs: &'a [Program; 2],
    surface: usize,
    /// The rays of which patches are taken.
    rays: RayGrid,
    text: &'a str,
}

impl PatchCase<'_> {
    fn trace(&self, rays: &RayGrid) -> [GBuffer; 2] {
        let trace = |program| self.scene.trace((program, self.surface), rays, &|_| true);
        self.programs.each_ref().map(trace)
    }

    /// Traces patches at random places, near the hits of a picture, then again with windows.
    fn compare(&self, picture: &GBuffer, rng: &mut Rng, survey: &mut Survey) {
        let times = self.rays.height() / picture.height;
        let hits: Vec<usize> =
            (0..picture.status.len()).filter(|&at| picture.status[at] == Status::Hit).collect();
        let most = [self.rays.width() - 4, self.rays.height() - 4];
        let mut places = Vec::with_capacity(PATCHES);
        for _ in 0..PATCHES {
            let pixel = match &hits[..] {
                [] => rng.u64(0..picture.status.len() as u64) as usize,
                _ => hits[rng.u64(0..hits.len() as u64) as usize],
            };
            let at = [pixel % picture.width, pixel / picture.width].map(|at| {
                (at * times + rng.u64(0..times as u64) as usize)
                    .saturating_sub(rng.u32(0..4) as usize)
            });
            places.push([at[0].min(most[0]), at[1].min(most[1])]);
        }
        let patches = |windows: &[[f64; 2]]| {
            let places = places.iter().zip(windows);
            let patch = |(&[column, row], &between): (&[usize; 2], &[f64; 2])| Patch {
                column,
                row,
                between,
            };
            self.rays.patches(places.map(patch).collect())
        };
        let all = patches(&[[0.0, f64::INFINITY]; PATCHES]);
        let whole = self.trace(&all);
        survey.patches.add(self.text, &whole);
        for _ in 0..ROUNDS {
            let windows: Vec<[f64; 2]> = (0..PATCHES)
                .map(|row| {
                    let of_patch = 16 * row..16 * (row + 1);
                    let is_hit = |pixel: &usize| whole[1].status[*pixel] == Status::Hit;
                    let hits: Vec<usize> = of_patch.filter(is_hit).collect();
                    let zero = if hits.is_empty() {
                        all.eye().length() + between(rng, -2.0, 2.0)
                    } else {
                        let pixel = hits[rng.u64(0..hits.len() as u64) as usize];
                        let [near, far] = whole[1].bracket[pixel];
                        all.ray_of(pixel).parameter(0.5 * (near + far))
                    };
                    window(rng, zero)
                })
                .collect();
            let found = self.trace(&patches(&windows));
            for pixel in 0..found[0].status.len() {
                self.compare_ray(pixel, windows[pixel / 16], &all, [&whole, &found], survey);
            }
        }
    }

    /// Compares what is claimed of a ray by parts and by all steps, without a window and with it.
    fn compare_ray(
        &self,
        pixel: usize,
        window: [f64; 2],
        rays: &RayGrid,
        [whole, found]: [&[GBuffer; 2]; 2],
        survey: &mut Survey,
    ) {
        let claims = [whole, found].map(|two| two.each_ref().map(|one| claimed(one, pixel)));
        let statuses = found.each_ref().map(|one| one.status[pixel]);
        let ray = rays.ray_of(pixel);
        let ends = [window[0] + SLACK, window[1] - SLACK].map(|t| ray.distance(t));
        // A zero that is proven to be in the window.
        let is_wanted =
            |[near, far]: [f64; 2]| far < f64::INFINITY && ends[0] <= near && far <= ends[1];
        let [known, windowed] = claims;
        let context =
            || format!("ray {pixel} between {window:?}: {known:?}, {windowed:?}\n{}", self.text);
        for one in windowed {
            // No zero is found before the ray's first. The ray may be examined beyond the window.
            let is_first = known.iter().all(|[near, _]| *near <= one[1]);
            assert!(is_first, "a false hit of {}", context());
            // A zero in the window is not passed over.
            for other in known.into_iter().chain(windowed).filter(|other| is_wanted(*other)) {
                assert!(one[0] <= other[1], "a lost zero of {}", context());
            }
        }
        survey.patches.count(statuses);
        survey.rays += 1;
        survey.wanted += usize::from(is_wanted(known[1]));
        survey.elsewhere +=
            usize::from(known[1][1] < f64::INFINITY && statuses == [Status::Miss; 2]);
    }
}

#[test]
fn models_by_parts_are_as_by_all_steps() {
    let effort = Effort::from_environment(0x5eed_ca00, 24);
    let (mut survey, mut left_out) = (Survey::default(), 0);
    for seed in effort.seed..effort.seed + effort.cases {
        let (scene, size, text) = match random_case(seed) {
            Ok(case) => case,
            Err(why) => {
                println!("{seed:#x} is left out: {why}");
                left_out += 1;
                continue;
            }
        };
        let rng = &mut Rng::with_seed(!seed);
        let programs = EVALUATORS.map(|evaluator| scene.program.on(evaluator));
        let rays = RayGrid::new(&scene.camera, size[0], size[1]);
        for surface in 0..scene.program.roots().len() {
            let trace = |program| scene.trace((program, surface), &rays, &|_| true);
            let pictures = programs.each_ref().map(trace);
            survey.pictures.add(&text, &pictures);
            // A picture that is given up claims no more than one that is finished.
            let (wanted, done) = (rng.u64(0..pictures[0].status.len() as u64), AtomicU64::new(0));
            let advance = |pixels: usize| done.fetch_add(pixels as u64, Ordering::Relaxed) < wanted;
            let given_up = scene.trace((&programs[0], surface), &rays, &advance);
            survey.given_up.add(&text, &[given_up, pictures[1].clone()]);
            survey.surfaces += 1;
            survey.by_parts += usize::from(programs[0].kernels::<f32>(surface).has_parts());
            survey.tall += usize::from(size[1] >= TALL);
            survey.pixels += size[0] * size[1];
            let times = if size[1] >= TALL { 1 } else { 1 << rng.u32(0..5) };
            let rays = rays.finer(times);
            let case = PatchCase { scene: &scene, programs: &programs, surface, rays, text: &text };
            case.compare(&pictures[1], rng, &mut survey);
        }
    }
    println!("{survey:?}, {left_out} left out");
    // A single case that is repeated need not reach these shares.
    if effort.cases > 20 {
        let is_few = |[parts, whole]: [usize; 2], all| parts <= whole + whole / 4 + all / 1000;
        assert!(is_few(survey.pictures.undecided, survey.pixels), "{survey:?}");
        assert!(is_few(survey.patches.undecided, survey.rays), "{survey:?}");
        assert!(8 * left_out < effort.cases, "{left_out} cases are left out");
        assert!(4 * survey.by_parts > 3 * survey.surfaces && survey.tall > 2, "{survey:?}");
        assert!(8 * survey.pictures.hit > survey.pixels, "{survey:?}");
        assert!(
            8 * survey.wanted > survey.rays && 16 * survey.elsewhere > survey.rays,
            "{survey:?}"
        );
    }
}
