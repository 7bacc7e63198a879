//! Pictures of large formulas by the steps that matter in each part equal pictures by all steps.
//!
//! A long run: `ZEROSET_CASES=200 cargo test --test all random_solids -- --nocapture`.

use super::parts_support::{Counts, EVALUATORS, SIZE, Scene, both};
use glam::DVec3;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};
use zeroset_eval::{
    ContractSegments, ContractTiles, Enclose, FindZeros, Kernel, KernelError, KernelResult,
    Kernels, PartSurface, SurfaceKernels, Tiles,
};
use zeroset_render::picture::Precision;
use zeroset_space::{Camera, Projection};
use zeroset_testkit::property::random_choices;
use zeroset_testkit::{Effort, Rng};
use zeroset_trace::{
    Driver, GBuffer, Method, Patch, RayGrid, Status, TraceOptions, UndecidedReason,
};

/// A surface that says nothing about the last part of each space that is divided into parts.
struct LeavesOut<'a>(Box<dyn SurfaceKernels + 'a>);

macro_rules! leave_out_parts {
    ($float:ident, $kernels:ident) => {
        impl Kernels<$float> for LeavesOut<'_> {
            fn zeros(&self) -> KernelResult<'_, FindZeros, $float> {
                self.0.$kernels().zeros()
            }
            fn bounds(&self) -> KernelResult<'_, Enclose, $float> {
                self.0.$kernels().bounds()
            }
            fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, $float>; 2]>, KernelError> {
                self.0.$kernels().cleared()
            }
            fn segments(&self) -> KernelResult<'_, ContractSegments, $float> {
                self.0.$kernels().segments()
            }
            fn tiles(&self) -> KernelResult<'_, ContractTiles, $float> {
                self.0.$kernels().tiles()
            }
            fn has_parts(&self) -> bool {
                self.0.$kernels().has_parts()
            }
            fn in_tiles(&self, tiles: &Tiles<$float>) -> Vec<PartSurface> {
                let mut parts = self.0.$kernels().in_tiles(tiles);
                parts.pop();
                let nested = |part| match part {
                    PartSurface::Short(surface) => PartSurface::Short(Box::new(LeavesOut(surface))),
                    other => other,
                };
                parts.into_iter().map(nested).collect()
            }
        }
    };
}

leave_out_parts!(f32, single);
leave_out_parts!(f64, double);

impl SurfaceKernels for LeavesOut<'_> {
    fn single(&self) -> &dyn Kernels<f32> {
        self
    }
    fn double(&self) -> &dyn Kernels<f64> {
        self
    }
}

/// The kernels of a surface, lent.
struct Lent<'a>(&'a dyn SurfaceKernels);

impl SurfaceKernels for Lent<'_> {
    fn single(&self) -> &dyn Kernels<f32> {
        self.0.single()
    }
    fn double(&self) -> &dyn Kernels<f64> {
        self.0.double()
    }
}

/// The statuses of a picture by parts, as far as `advance` wants it.
fn status(scene: &Scene, advance: &(dyn Fn(usize) -> bool + Sync)) -> Vec<Status> {
    let rays = RayGrid::new(&scene.camera, SIZE, SIZE);
    scene.trace((&scene.program, 0), &rays, advance).status
}

/// A union of spheres, sharp or blended.
fn spheres(count: usize, is_smooth: bool, rng: &mut Rng) -> String {
    let number = |rng: &mut Rng| f64::from(rng.i32(-1500..=1500)) / 1000.0;
    let mut parts: Vec<String> = Vec::new();
    let mut text = String::new();
    for n in 0..count {
        let [x, y, z] = [(); 3].map(|()| number(rng));
        let _ = writeln!(text, "s_{n} = sqrt((x-({x}))^2+(y-({y}))^2+(z-({z}))^2)-0.2");
        parts.push(format!("s_{n}"));
    }
    for n in 0.. {
        let [a, b] = match &parts[..] {
            [a, b, ..] => [a.clone(), b.clone()],
            _ => break,
        };
        let blend =
            if is_smooth { format!("-max(0.1-abs({a}-{b}),0)^2/0.4") } else { String::new() };
        let _ = writeln!(text, "t_{n} = min({a},{b}){blend}");
        parts.drain(..2);
        parts.push(format!("t_{n}"));
    }
    format!("{text}0 = {}", parts[0])
}

#[test]
fn unions_of_spheres_are_the_same() {
    let mut rng = Rng::with_seed(0x5eed_c000);
    let mut counts = Counts::default();
    for precision in [Precision::Auto, Precision::F64] {
        for is_smooth in [false, true] {
            let text = spheres(80, is_smooth, &mut rng);
            let options = TraceOptions { precision, ..TraceOptions::default() };
            let pictures = both(&text, options).expect("a surface");
            counts.add(&text, &pictures);
        }
    }
    assert!(counts.hit > 2000 && counts.undecided == [0, 0], "{counts:?}");
}

#[test]
fn products_of_planes_are_the_same() {
    let mut rng = Rng::with_seed(0x5eed_c200);
    let mut number = || f64::from(rng.i32(-100..=100)) / 100.0;
    let mut plane = || {
        let [a, b, c, d] = [(); 4].map(|()| number());
        format!("({a:.2}*x+{b:.2}*y+{c:.2}*z-{d:.2})")
    };
    // Below minima and maxima, only the sign of products matters.
    let mut product = || format!("{}*{}*{}", plane(), plane(), plane());
    let choices = ["min", "max"].into_iter().cycle().take(60);
    let text = choices.fold(product(), |all, word| format!("{word}({all}, {})", product()));
    let text = format!("0 = {text}");
    let mut counts = Counts::default();
    counts.add(&text, &both(&text, TraceOptions::default()).expect("a surface"));
    assert!(counts.hit > 500 && counts.undecided == [0, 0], "{counts:?}");
}

#[test]
fn random_solids_are_the_same() {
    let effort = Effort::from_environment(0x5eed_c100, 8);
    let mut counts = Counts::default();
    let mut drawn = 0;
    for seed in effort.seed.. {
        if drawn == effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let formula = random_choices(&mut rng, 14);
        let text = if seed % 2 == 0 { format!("0 = {formula}") } else { format!("{formula} <= 0") };
        if text.len() < 4000 || text.len() > 40_000 || text.contains("if(") {
            continue;
        }
        if let Some(pictures) = both(&text, TraceOptions::default()) {
            let before = counts.hit;
            let case = format!("ZEROSET_SEED={seed:#x} ZEROSET_CASES=1\n{text}");
            counts.add(&case, &pictures);
            println!("seed {seed:#x}: {} bytes, {} hits", text.len(), counts.hit - before);
            drawn += u64::from(counts.hit - before > 60);
        }
    }
    println!("{counts:?}");
    let [parts, whole] = counts.undecided;
    assert!(counts.hit > 60 * drawn as usize && parts <= whole + whole / 4 + 50, "{counts:?}");
}

/// The distance from a box is |a| in front of a face and −|a| behind it, by two terms that have a
/// corner there. Forms do not get nearly linear at the zero, so its ray is halved until rounding
/// ends that. Then two signs prove the zero. Halving on in `f64` would take twice as many segments.
#[test]
fn corners_at_zeros_are_proven_by_signs() {
    let mut rng = Rng::with_seed(0x5eed_c600);
    let mut text = String::new();
    for n in 0..24 {
        let mut number = || f64::from(rng.i32(-1200..=1200)) / 1000.0;
        let [x, y, z] = [(); 3].map(|()| number());
        let _ = writeln!(text, "p_{n} = max(abs(x-({x}))-0.3, abs(y-({y}))-0.2)");
        let _ = writeln!(text, "q_{n} = abs(z-({z}))-0.25");
        let inside = format!("min(max(p_{n}, q_{n}), 0)");
        let _ = writeln!(text, "b_{n} = {inside}+sqrt(max(p_{n}, 0)^2+max(q_{n}, 0)^2)");
        let _ = if n == 0 {
            writeln!(text, "c_0 = b_0")
        } else {
            let (a, b) = (format!("c_{}", n - 1), format!("b_{n}"));
            writeln!(text, "c_{n} = min({a},{b})-max(0.02-abs({a}-{b}),0)^2/0.08")
        };
    }
    let scene = Scene::new(&format!("{text}c_23 <= 0"));
    let method = Method::named("affine").expect("the default method");
    let surface = scene.program.surface(0);
    let tracer = method.prepare(surface, &scene.region, scene.options).expect("kernels");
    let mut buffer = GBuffer::new(SIZE, SIZE, 0);
    let rays = RayGrid::new(&scene.camera, SIZE, SIZE);
    let work = Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
    let counts = buffer.counts();
    println!("{} segments for {counts:?}", work.segments.lanes);
    assert!(counts.hit > 250 && counts.undecided == 0, "{counts:?}");
    assert!(work.segments.lanes < 32 * counts.hit as u64, "{}", work.segments.lanes);
}

/// A picture that is given up proves no miss where the whole picture has a hit.
#[test]
fn what_is_given_up_is_no_miss() {
    let text = spheres(80, false, &mut Rng::with_seed(0x5eed_c200));
    let scene = Scene::new(&text);
    let whole = status(&scene, &|_| true);
    let mut undecided = 0;
    for wanted in (0..SIZE * SIZE).step_by(SIZE * SIZE / 24) {
        let done = AtomicUsize::new(0);
        let advance = |pixels: usize| done.fetch_add(pixels, Ordering::Relaxed) < wanted;
        for (found, whole) in status(&scene, &advance).iter().zip(&whole) {
            let is_false = (*found, *whole) == (Status::Miss, Status::Hit);
            assert!(!is_false, "{wanted} pixels");
            undecided += usize::from(*found == Status::Undecided);
        }
    }
    assert!(undecided > 0, "nothing was given up");
}

/// An eye that looks away from the region sees nothing.
#[test]
fn a_region_behind_the_eye_is_missed() {
    let text = spheres(80, false, &mut Rng::with_seed(0x5eed_c300));
    let mut scene = Scene::new(&text);
    let projection = Projection::Perspective { fov: 40.0 };
    scene.camera =
        Camera::new(DVec3::X * 10.0, DVec3::X * 20.0, DVec3::Z, projection).expect("a camera");
    assert!(status(&scene, &|_| true).iter().all(|status| *status == Status::Miss));
}

/// A function is above 0 everywhere, but nearly touches it. The steps that matter in one part cross
/// 0 in the next part, where they claim nothing.
#[test]
fn steps_prove_nothing_beyond_their_part() {
    let spheres = spheres(60, false, &mut Rng::with_seed(0x5eed_c400));
    // The spheres lie far below.
    let spheres = spheres.replace("(z-(", "(z+1.6-0.2*(");
    let (spheres, last) = spheres.rsplit_once("0 = ").expect("an equation");
    // The tangent of the sine at 0.250001, minus the sine.
    let tangent = "(z-0.250001)*cos(0.250001)+sin(0.250001)-sin(z)";
    let near = format!("({tangent}+1e-19)*(z-0.249998)");
    let text = format!("{spheres}0 = min({last}, max({near}, 0.249999-z))");
    let mut scene = Scene::new(&text);
    let projection = Projection::Orthographic { height: 1.0 };
    scene.camera =
        Camera::new(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection).expect("a camera");
    scene.options = TraceOptions { precision: Precision::F64, ..TraceOptions::default() };
    assert!(status(&scene, &|_| true).iter().all(|status| *status != Status::Hit));
}

/// Where a part is left out, pixels are undecided: neither a miss nor a hit behind it is claimed.
#[test]
fn a_part_that_is_left_out_proves_nothing() {
    let scene = Scene::new(&spheres(80, false, &mut Rng::with_seed(0x5eed_c501)));
    let method = Method::named("affine").expect("the default method");
    let rays = RayGrid::new(&scene.camera, 4 * SIZE, 4 * SIZE);
    let lent = Lent(scene.program.surface(0));
    let lacking = LeavesOut(Box::new(Lent(scene.program.surface(0))));
    let surfaces: [&dyn SurfaceKernels; 2] = [&lent, &lacking];
    let [whole, left] = surfaces.map(|surface| {
        let tracer = method.prepare(surface, &scene.region, scene.options).expect("kernels");
        let mut buffer = GBuffer::new(rays.width(), rays.height(), 0).with_brackets();
        Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
        buffer
    });
    let (mut unseen, mut lost) = (0, 0);
    for pixel in 0..whole.status.len() {
        match (whole.status[pixel], left.status[pixel]) {
            (known, Status::Undecided) if left.reason(pixel) == UndecidedReason::Unseen => {
                assert_eq!(left.distance(pixel), 0.0);
                unseen += 1;
                lost += usize::from(known == Status::Hit);
            }
            (Status::Hit, Status::Hit) => {
                let [[near, far], [first, last]] = [whole.bracket[pixel], left.bracket[pixel]];
                assert!(near <= last && first <= far, "another zero at pixel {pixel}");
            }
            (known, found) => assert_eq!(known, found, "pixel {pixel}"),
        }
    }
    assert!(unseen > 1000 && lost > 100, "{unseen} unseen pixels, {lost} of them hits");
}

/// Patches of one size, traced after smaller ones by the same tracer, have the statuses that they
/// have by all steps.
#[test]
fn patches_of_any_size_are_traced() {
    let scene = Scene::new(&spheres(80, false, &mut Rng::with_seed(0x5eed_c500)));
    let method = Method::named("affine").expect("the default method");
    let between = [0.0, f64::INFINITY];
    let pictures = EVALUATORS.map(|evaluator| {
        let program = scene.program.on(evaluator);
        let surface = program.surface(0);
        let tracer = method.prepare(surface, &scene.region, scene.options).expect("kernels");
        [64 * SIZE, SIZE].map(|size| {
            let patches = (0..size).step_by(size / (SIZE / 4)).flat_map(|row| {
                let columns = (0..size).step_by(size / (SIZE / 4));
                columns.map(move |column| Patch { column, row, between })
            });
            let rays = RayGrid::new(&scene.camera, size, size).patches(patches.collect());
            let mut buffer = GBuffer::new(rays.width(), rays.height(), 0);
            Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
            buffer.status
        })
    });
    assert!(pictures[1][1].iter().filter(|status| **status == Status::Hit).count() > 200);
    assert_eq!(pictures[0], pictures[1]);
}
