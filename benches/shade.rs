//! What a picture costs apart from tracing and generated code: set-up of the G-buffer, normals, colours.
//!
//! `cargo bench --bench shade` takes 512×512 pixels on one thread and prints ns per drawn pixel, or per pixel of the
//! background; names are `shade/case`. Surfaces are spheres whose distances are known, and the kernel asked for gradients
//! hands its points on.

use glam::DVec3;
use std::hint::black_box;
use std::time::Instant;
use zeroset_eval::{Gradients, Kernel, Points, Real, SampleGradient};
use zeroset_trace::{
    Appearance, Camera, Found, GBuffer, Light, NormalSource, Projection, RayGrid, StandardView,
    Status, hand_back_colours, normals, shade,
};

const SIZE: usize = 512;
const ROUNDS: usize = 201;

/// The gradient of half the squared distance from the origin: as little work as a kernel can have.
struct HandedOn;

impl<T: Real> Kernel<SampleGradient, T> for HandedOn {
    fn ask(&self, points: &Points<T>, out: &mut Gradients<T>) {
        out.gradient = points.at;
    }
}

/// Paints a sphere about the origin, from outside or from within.
fn paint(rays: &RayGrid, radius: f64) -> GBuffer {
    let mut buffer = GBuffer::new(SIZE, SIZE, 0);
    for pixel in 0..SIZE * SIZE {
        let ray = rays.ray_of(pixel);
        let middle = -ray.origin.dot(ray.direction.normalize());
        let half = (middle * middle - ray.origin.length_squared() + radius * radius).sqrt();
        let near = if middle > half { middle - half } else { middle + half };
        if near.is_finite() {
            let status = Status::Hit;
            buffer.set(pixel, &Found { status, distance: near, drawn: near, ..Found::MISS });
        }
    }
    buffer
}

/// What is measured, in the order of the columns.
const STAGES: [&str; 6] = ["new", "handed back", "normals", "in f64", "colours", "near light"];

/// Seconds that each stage takes: of interleaved rounds one in twenty was faster. A busy machine slows all others down, and
/// there is no rival that it would slow down as much.
fn time(rays: &RayGrid, buffer: &mut GBuffer) -> [f64; 6] {
    let far = Appearance::new(Default::default(), Light::above_left(rays));
    let near = Appearance::new(Default::default(), Light::Positional(DVec3::new(3.0, -3.0, 3.0)));
    let gradients = NormalSource::<f32>::Gradient(&HandedOn);
    let gradients_in_f64 = NormalSource::<f64>::Gradient(&HandedOn);
    let mut times = [const { Vec::new() }; 6];
    for _ in 0..ROUNDS {
        let mut stage = 0;
        let mut lap = |work: &mut dyn FnMut()| {
            let start = Instant::now();
            work();
            times[stage].push(start.elapsed().as_secs_f64());
            stage += 1;
        };
        lap(&mut || drop(black_box(GBuffer::new(SIZE, SIZE, 0))));
        let mut written = GBuffer::new(SIZE, SIZE, 0);
        written.reset(SIZE, SIZE, 0);
        written.hand_back();
        lap(&mut || black_box(GBuffer::new(SIZE, SIZE, 0)).hand_back());
        // The next round begins without.
        drop(GBuffer::new(SIZE, SIZE, 0));
        buffer.normal.fill([0.0; 3]);
        lap(&mut || _ = black_box(normals(buffer, rays, gradients, 1e-3)));
        buffer.normal.fill([0.0; 3]);
        lap(&mut || _ = black_box(normals(buffer, rays, gradients_in_f64, 1e-3)));
        hand_back_colours(shade(buffer, rays, &far));
        lap(&mut || hand_back_colours(black_box(shade(buffer, rays, &far))));
        lap(&mut || hand_back_colours(black_box(shade(buffer, rays, &near))));
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 20]
    })
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    let (offset, up) = StandardView::Iso.offset_and_up();
    let projection = Projection::Perspective { fov: StandardView::FOV };
    let camera = Camera::new(offset, DVec3::ZERO, up, projection).expect("valid");
    let rays = camera.rays(SIZE, SIZE);
    println!("{:20}{:>9}{}", "ns per pixel", "pixels", STAGES.map(|s| format!("{s:>13}")).concat());
    let print = |name: &str, pixels: usize, times: [f64; 6]| {
        let columns = times.map(|time| format!("{:13.2}", 1e9 * time / pixels as f64)).concat();
        println!("{:20}{pixels:9}{columns}", format!("shade/{name}"));
    };
    let all = SIZE * SIZE;
    let background = time(&rays, &mut GBuffer::new(SIZE, SIZE, 0));
    print("background", all, background);
    for (name, radius) in [("full", 10.0), ("sphere", 1.0)] {
        let mut buffer = paint(&rays, radius);
        let drawn = (0..all).filter(|&pixel| buffer.is_drawn(pixel)).count();
        // Set-up is the same for each pixel; of the rest, what the background takes is not counted.
        let (share, mut times) = ((all - drawn) as f64 / all as f64, time(&rays, &mut buffer));
        for (stage, time) in times.iter_mut().enumerate() {
            *time = if stage < 2 {
                *time * drawn as f64 / all as f64
            } else {
                *time - share * background[stage]
            };
        }
        print(name, drawn, times);
    }
}
