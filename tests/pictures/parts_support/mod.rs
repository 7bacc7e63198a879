//! Pictures of large formulas by the steps that matter in each part, and by all steps.

pub mod models;

use glam::DVec3;
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::Program;
use zeroset_scene::view::{DomainChoice, bounds, region};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Driver, GBuffer, Method, RayGrid, Status, TraceOptions, UndecidedReason};

/// Width and height of most pictures.
pub const SIZE: usize = 48;

/// Evaluators by parts, and by all steps.
pub const EVALUATORS: [Evaluator; 2] = [Evaluator::Native, Evaluator::Whole];

/// A document in the cube from −2 to 2, and its camera.
pub struct Scene {
    pub program: Program,
    pub region: Region,
    pub camera: Camera,
    pub options: TraceOptions,
}

impl Scene {
    /// # Panics
    /// If the text has no surface.
    pub fn new(text: &str) -> Self {
        Self::read(text).expect("a surface")
    }

    /// # Errors
    /// If the text has no surface. The message has the reason.
    pub fn read(text: &str) -> Result<Self, String> {
        let document = read(text, &Options::default()).map_err(|error| format!("{error:?}"))?;
        let cube = DomainChoice::Bounds([-2.0, 2.0, -2.0, 2.0, -2.0, 2.0]);
        let (region, _) = region(&document, cube, None).map_err(|error| error.to_string())?;
        let program = Program::new(&document, bounds(&region));
        let program = program.map_err(|error| error.to_string())?;
        let projection = Projection::Perspective { fov: 40.0 };
        let eye = DVec3::new(4.0, 5.0, 3.0);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
        Ok(Self { program, region, camera, options: TraceOptions::default() })
    }

    /// Traces a surface of one of the scene's programs, as far as `advance` wants it. The picture
    /// has brackets.
    pub fn trace(
        &self,
        (program, surface): (&Program, usize),
        rays: &RayGrid,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> GBuffer {
        let method = Method::named("affine").expect("the default method");
        let options = TraceOptions { is_solid: program.is_solid(surface), ..self.options };
        let kernels = program.surface(surface);
        let tracer = method.prepare(kernels, &self.region, options).expect("kernels");
        let mut buffer = GBuffer::new(rays.width(), rays.height(), 0).with_brackets();
        Driver { rays, tracer: &*tracer, advance }.picture(&mut buffer);
        // Even where a picture is cancelled, each pixel is examined or given up.
        assert_eq!(buffer.reasons()[UndecidedReason::Unseen as usize], 0);
        buffer
    }
}

/// The pictures of a text, by parts and by all steps. `None` if the text has no surface.
pub fn both(text: &str, options: TraceOptions) -> Option<[GBuffer; 2]> {
    let scene = Scene { options, ..Scene::read(text).ok()? };
    let rays = RayGrid::new(&scene.camera, SIZE, SIZE);
    let trace = |evaluator| scene.trace((&scene.program.on(evaluator), 0), &rays, &|_| true);
    Some(EVALUATORS.map(trace))
}

/// Bounds that a picture proves for the distance of the first zero on a pixel's ray. Both are
/// infinite for a miss. Only the upper one is infinite for an undecided pixel.
pub fn claimed(buffer: &GBuffer, pixel: usize) -> [f64; 2] {
    match buffer.status[pixel] {
        Status::Hit => buffer.bracket[pixel],
        Status::Miss => [f64::INFINITY; 2],
        // This distance is not rounded down.
        Status::Undecided => [buffer.distance(pixel) * (1.0 - 1e-6), f64::INFINITY],
    }
}

/// Number of pixels that are hit by all steps, undecided by parts, and undecided by all steps.
#[derive(Debug, Default)]
pub struct Counts {
    pub hit: usize,
    pub undecided: [usize; 2],
}

impl Counts {
    /// Adds the pictures of a case.
    ///
    /// # Panics
    /// If one picture proves a zero where the other disproves it.
    pub fn add(&mut self, case: &str, pictures: &[GBuffer; 2]) {
        for pixel in 0..pictures[0].status.len() {
            let claims = pictures.each_ref().map(|picture| claimed(picture, pixel));
            let [[near, far], [first, last]] = claims;
            assert!(near <= last && first <= far, "pixel {pixel}: {claims:?}\n{case}");
            self.count(pictures.each_ref().map(|picture| picture.status[pixel]));
        }
    }

    /// Adds a pixel with these statuses by parts and by all steps.
    pub fn count(&mut self, statuses: [Status; 2]) {
        self.hit += usize::from(statuses[1] == Status::Hit);
        for (undecided, status) in self.undecided.iter_mut().zip(statuses) {
            *undecided += usize::from(status == Status::Undecided);
        }
    }
}
