//! Domains that are clipped to a ball. Claims about their rays equal the claims for the box,
//! restricted to the ball.

use glam::DVec3;
use zeroset_render::model::render;
use zeroset_render::picture::Settings;
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::Program;
use zeroset_scene::view::bounds;
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Driver, GBuffer, METHODS, Proves, RayGrid, Status, TraceOptions};

/// A picture of this size has tiles of both sizes, and incomplete tiles.
const SIZE: [usize; 2] = [46, 38];

type Function = fn(DVec3) -> f64;

/// Surfaces that extend beyond the ball, and their functions in double precision.
const SURFACES: [(&str, Function); 4] = [
    ("x^2+y^2-z^2=1", |p| p.x * p.x + p.y * p.y - p.z * p.z - 1.0),
    ("x*y*z=1", |p| p.x * p.y * p.z - 1.0),
    ("4(x^2+y^2+z^2)+16x*y*z=1", |p| 4.0 * p.length_squared() + 16.0 * p.x * p.y * p.z - 1.0),
    ("z=sin(3x)*cos(2y)", |p| p.z - (3.0 * p.x).sin() * (2.0 * p.y).cos()),
];

fn region() -> Region {
    let half = DVec3::new(2.0, 2.0, 1.75);
    let centre = DVec3::new(0.25, 0.0, -0.125);
    Region::new(centre - half, centre + half).expect("a box").with_ball()
}

fn camera(number: usize) -> Camera {
    let eye = [DVec3::new(4.0, -5.0, 3.0), DVec3::new(-7.0, 2.0, -4.0), DVec3::new(0.5, 0.3, 0.2)];
    let projection = if number == 1 {
        Projection::Orthographic { height: 4.5 }
    } else {
        Projection::Perspective { fov: 45.0 }
    };
    Camera::new(eye[number], DVec3::new(0.1, 0.2, -0.3), DVec3::Z, projection).expect("a camera")
}

/// The part of a ray in both ball and box, as two values of t; `None` if there is no such part.
fn chord(rays: &RayGrid, pixel: usize, region: &Region) -> Option<[f64; 2]> {
    let ray = rays.ray_of(pixel);
    let ball = region.ball().expect("one");
    let way = ball.centre - ray.origin;
    let square = ray.direction.length_squared();
    let nearest = way.dot(ray.direction) / square;
    let off = (way - nearest * ray.direction).length();
    let half = (ball.radius * ball.radius - off * off).max(0.0).sqrt() / square.sqrt();
    let (mut near, mut far) = ((nearest - half).max(0.0), nearest + half);
    for axis in 0..3 {
        let at = |face: f64| (face - ray.origin[axis]) / ray.direction[axis];
        let [one, other] = [at(region.low()[axis]), at(region.high()[axis])];
        (near, far) = (near.max(one.min(other)), far.min(one.max(other)));
    }
    (off < ball.radius && near < far).then_some([near, far])
}

#[test]
fn what_is_claimed_is_true_of_the_ball() {
    const SAMPLES: usize = 400;
    let region = region();
    let (mut hits, mut beside, mut cut_off) = (0, 0, 0);
    for (number, (text, function)) in SURFACES.into_iter().enumerate() {
        let document = read(text, &Options::default()).expect(text);
        let program = Program::new(&document, bounds(&region)).expect(text);
        let boxed = Region::new(region.low(), region.high()).expect("a box");
        for (method, view) in METHODS.iter().flat_map(|method| [(method, number % 3), (method, 2)])
        {
            let rays = RayGrid::new(&camera(view), SIZE[0], SIZE[1]);
            let picture = |region: &Region| {
                let tracer = method.prepare(program.surface(0), region, TraceOptions::default());
                let tracer = tracer.expect(method.name);
                let mut buffer = GBuffer::new(SIZE[0], SIZE[1], 0).with_brackets();
                Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
                buffer
            };
            let (round, whole) = (picture(&region), picture(&boxed));
            for pixel in 0..SIZE[0] * SIZE[1] {
                let what = (text, method.name, view, pixel);
                let ray = rays.ray_of(pixel);
                let length = ray.distance(1.0);
                let Some([near, far]) = chord(&rays, pixel, &region) else {
                    beside += 1;
                    assert_eq!(round.status[pixel], Status::Miss, "{what:?}");
                    continue;
                };
                let slack = 1e-6 * far;
                let status = round.status[pixel];
                if status == Status::Hit {
                    hits += 1;
                    let bracket = round.bracket[pixel].map(|distance| distance / length);
                    assert!(near - slack <= bracket[0] && bracket[1] <= far + slack, "{what:?}");
                    let signs = bracket.map(|t| function(ray.at(t)));
                    let is_small = signs.map(f64::abs).iter().any(|value| *value < 1e-12);
                    assert!(is_small || signs[0] * signs[1] < 0.0, "{what:?}: {signs:?}");
                }
                if round.drawn[pixel].is_finite() {
                    let t = round.drawn[pixel] / length;
                    let reach = 0.05 + slack;
                    assert!(near - reach <= t && t <= far + reach, "{what:?}");
                }
                // A ray on which the function changes its sign well inside the ball is no miss.
                let at = |n: usize| {
                    near + slack + (far - near - 2.0 * slack) * n as f64 / SAMPLES as f64
                };
                let values: Vec<f64> = (0..=SAMPLES).map(|n| function(ray.at(at(n)))).collect();
                let crosses =
                    far - near > 4.0 * slack && values.windows(2).any(|two| two[0] * two[1] < 0.0);
                if crosses && method.proves != Proves::Nothing {
                    assert_ne!(status, Status::Miss, "{what:?}");
                }
                // A ray that misses in the whole box does not hit in the ball.
                if whole.status[pixel] == Status::Miss {
                    assert_ne!(status, Status::Hit, "{what:?}");
                }
                cut_off +=
                    usize::from(whole.status[pixel] == Status::Hit && status == Status::Miss);
            }
        }
    }
    assert!(hits > 4000 && beside > 4000 && cut_off > 1000, "{hits} {beside} {cut_off}");
}

#[test]
fn the_reference_evaluator_draws_the_same_balls() {
    let region = region();
    for (number, (text, _)) in SURFACES.into_iter().enumerate() {
        let document = read(text, &Options::default()).expect(text);
        let program = Program::new(&document, bounds(&region)).expect(text);
        let rays = RayGrid::new(&camera(number % 3), 22, 18);
        for method in &METHODS {
            let options = TraceOptions { depth: 7, tolerance: 0.1, ..TraceOptions::default() };
            let [native, software] = [Evaluator::Native, Evaluator::Reference].map(|evaluator| {
                let program = program.on(evaluator);
                let mut buffer = GBuffer::new(22, 18, 0);
                let tracer =
                    method.prepare(program.surface(0), &region, options).expect(method.name);
                let driver = Driver { rays: &rays, tracer: &*tracer, advance: &|_| true };
                let work = driver.picture(&mut buffer);
                (buffer, work)
            });
            assert_eq!(native, software, "{text} {}", method.name);
        }
    }
}

#[test]
fn a_solid_is_capped_by_the_sphere() {
    let document = read("z <= 10", &Options::default()).expect("reads");
    let region = Region::new(-DVec3::ONE, DVec3::ONE).expect("a cube").with_ball();
    let projection = Projection::Orthographic { height: 2.0 };
    let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection).expect("one");
    let settings = Settings { width: 32, height: 32, ..Settings::default() };
    let picture = render(&document, &region, &camera, &settings).expect("a picture");
    let rays = RayGrid::new(&camera, 32, 32);
    let (mut hits, buffer) = (0, &picture.buffer);
    for pixel in 0..32 * 32 {
        let ray = rays.ray_of(pixel);
        let square = 1.0 - ray.origin.x * ray.origin.x - ray.origin.z * ray.origin.z;
        assert_eq!(buffer.status[pixel] == Status::Hit, square > 0.0, "{square}");
        if square > 0.0 {
            hits += 1;
            assert!((buffer.drawn[pixel] - (5.0 - square.sqrt())).abs() < 1e-6);
            let at = ray.at(buffer.drawn[pixel]).as_vec3();
            let normal = glam::Vec3::from(buffer.normal[pixel]);
            assert!(buffer.is_cap(pixel) && normal.distance(at) < 1e-3, "{normal} at {at}");
        }
    }
    assert!(hits > 700, "{hits}");
}
