//! Adapter from the program to the properties of `testkit`: scenes become claims about rays, and
//! formulas become kernels.
//!
//! Fuzz targets include this file.

use glam::DVec3;
use zeroset_eval::{Boxes, FindZeros, Kernel, KernelFloat, Zeros};
use zeroset_interval::Interval;
use zeroset_render::model::render;
use zeroset_render::picture::{Picture, Precision, Settings};
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::Program;
use zeroset_space::{Camera, Projection, Region};
use zeroset_testkit::certified::Line;
use zeroset_testkit::property::{Formula, Pixel, RayClaim, Scene};
use zeroset_trace::{METHODS, Method, RayGrid, Status, TraceOptions};

/// Returns the claims of every method's picture about the rays of its pixels. `None` if the scene's
/// camera is invalid or its formula has no surface.
#[allow(dead_code)] // each fuzz target needs one of the two
pub fn draw(scene: &Scene) -> Option<Vec<Pixel>> {
    let mut pixels = Vec::new();
    for method in &METHODS {
        let (camera, picture) = picture(scene, method)?;
        pixels.extend(claims(scene, &camera, &picture));
    }
    Some(pixels)
}

/// A picture of a scene, with brackets.
pub fn picture(scene: &Scene, method: &'static Method) -> Option<(Camera, Picture)> {
    picture_with(scene, method, true)
}

/// A picture of a scene.
pub fn picture_with(
    scene: &Scene,
    method: &'static Method,
    brackets: bool,
) -> Option<(Camera, Picture)> {
    let [[x0, x1], [y0, y1], [z0, z1]] = scene.formula.region;
    let region = Region::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)).ok()?;
    let [eye, target, up] = [scene.eye, scene.target, scene.up].map(DVec3::from_array);
    let projection = match scene.fov {
        Ok(fov) => Projection::Perspective { fov },
        Err(height) => Projection::Orthographic { height },
    };
    let camera = Camera::new(eye, target, up, projection).ok()?;
    let [width, height] = scene.size;
    let precision = [Precision::Auto, Precision::F32, Precision::F64]
        .into_iter()
        .find(|precision| precision.to_string() == scene.precision)?;
    let settings = Settings {
        options: TraceOptions {
            precision,
            depth: scene.depth,
            tolerance: scene.tolerance,
            ..TraceOptions::default()
        },
        method,
        width,
        height,
        brackets,
        ..Settings::default()
    };
    let document = &scene.formula.document;
    let picture = render(document, &region, &camera, &settings).ok()?;
    Some((camera, picture))
}

/// The claims of a picture about each pixel's ray.
pub fn claims(scene: &Scene, camera: &Camera, picture: &Picture) -> Vec<Pixel> {
    let [width, height] = scene.size;
    let frame = RayGrid::new(camera, width, height);
    let pixels = (0..width * height).map(|index| {
        let ray = frame.ray_of(index);
        let line = Line { eye: ray.origin.to_array(), direction: ray.direction.to_array() };
        let buffer = &picture.buffer;
        let (distance, drawn) = (buffer.distance(index), buffer.drawn[index]);
        let method = picture.method.name;
        assert!(drawn >= distance, "{scene}, {method}: painted at {drawn}, before {distance}");
        let normal = buffer.normal[index];
        let is_number = !buffer.is_drawn(index) || normal.iter().all(|part| part.is_finite());
        assert!(is_number, "{scene}: {normal:?}");
        let claimed = match buffer.status[index] {
            Status::Miss => RayClaim::Miss,
            Status::Hit => RayClaim::Hit(buffer.bracket[index].map(|end| ray.parameter(end))),
            Status::Undecided => RayClaim::Undecided(ray.parameter(distance)),
        };
        let hit = (buffer.status[index] == Status::Hit).then(|| {
            // At the limit of precision, brackets are wider than the tolerance.
            let [near, far] = buffer.bracket[index];
            let room = scene.tolerance * frame.footprint(drawn) + (far - near);
            let ends = [drawn - room, drawn + room].map(|end| ray.parameter(end));
            (usize::from(buffer.surface[index]), ends)
        });
        Pixel { place: [index % width, index / width], line, claimed, hit }
    });
    pixels.collect()
}

/// The kernel that decides where a formula may vanish; `None` if it has no surface.
///
/// # Panics
/// If the kernel does not compile.
#[allow(dead_code)] // each fuzz target needs one of the two
pub fn zero_kernel<T: KernelFloat>(formula: &Formula) -> Option<Box<dyn Kernel<FindZeros, T>>> {
    let domain = formula.region.map(|[lo, hi]| Interval { lo, hi });
    let program = Program::new(&formula.document, domain).ok()?;
    program.kernels::<T>(0).zeros().expect("compiles");
    Some(Box::new(First(program)))
}

/// As [`zero_kernel`], but interpreted. Nothing is compiled, so many formulas can be tried.
#[allow(dead_code)] // one fuzz target needs it
pub fn interpreted_zero_kernel<T: KernelFloat>(
    formula: &Formula,
) -> Option<Box<dyn Kernel<FindZeros, T>>> {
    let domain = formula.region.map(|[lo, hi]| Interval { lo, hi });
    let program = Program::new(&formula.document, domain).ok()?.on(Evaluator::Reference);
    Some(Box::new(First(program)))
}

/// The first surface of a program, as a kernel.
struct First(Program);

impl<T: KernelFloat> Kernel<FindZeros, T> for First {
    fn eval(&self, boxes: &Boxes<T>, zeros: &mut Zeros) {
        self.0.kernels::<T>(0).zeros().expect("compiles").eval(boxes, zeros);
    }
}
