//! Times the steps of a picture besides tracing and generated code: set-up of the G-buffer,
//! normals, colors.
//!
//! `cargo bench --bench shade` draws 512×512 pixels on one thread. It prints ns per drawn pixel, or
//! per pixel of the background, in rows named `shade/case`. The surfaces are spheres with known
//! distances. The gradient kernel only copies its points. Each of the first columns times one step
//! over the whole picture. Set-up is timed in new memory and in an empty picture's memory. The last
//! two columns time a frame that is drawn band by band in the previous frame's memory: its set-up,
//! then its normals and colors.

use glam::DVec3;
use std::hint::black_box;
use std::time::Instant;
use zeroset_eval::{Gradients, Kernel, Points, Real, SampleGradient};
use zeroset_shade::{Appearance, ColorDepth, Colors, Light, NormalSource, Shader, normals, shade};
use zeroset_space::{Camera, Projection};
use zeroset_style::{FOV, VIEWS};
use zeroset_trace::{
    BAND_ROWS, Band, Driver, GBuffer, Kept, KernelStats, RayGrid, RayResult, Segment, Start,
    Status, Tracer,
};

const SIZE: usize = 512;
const ROUNDS: usize = 201;

/// The cheapest possible gradient kernel. A point is the gradient of half its squared distance from
/// the origin.
struct CopyPoints;

impl<T: Real> Kernel<SampleGradient, T> for CopyPoints {
    fn eval(&self, points: &Points<T>, out: &mut Gradients<T>) {
        out.gradient = points.at;
    }
}

/// Returns the picture of a sphere around the origin, seen from outside or inside.
fn paint(rays: &RayGrid, radius: f64) -> GBuffer {
    let mut buffer = GBuffer::new(SIZE, SIZE, 0);
    for pixel in 0..SIZE * SIZE {
        let ray = rays.ray_of(pixel);
        let middle = -ray.origin.dot(ray.direction.normalize());
        let half = (middle * middle - ray.origin.length_squared() + radius * radius).sqrt();
        let near = if middle > half { middle - half } else { middle + half };
        if near.is_finite() {
            let status = Status::Hit;
            buffer
                .set(pixel, &RayResult { status, distance: near, drawn: near, ..RayResult::MISS });
        }
    }
    buffer
}

/// A tracer whose hits are those of the given buffer. Without a buffer, every ray misses.
struct KnownHits<'a>(Option<&'a GBuffer>);

impl Tracer for KnownHits<'_> {
    fn follow(&self, _: &[Segment], _: Start, _: &mut [RayResult], _: &mut KernelStats) {}

    fn band(&self, _: &RayGrid, band: &mut Band<'_>, _: &mut KernelStats) {
        let Some(known) = self.0 else { return };
        for row in 0..band.height {
            let first = (band.top + row) * band.width;
            for column in 0..band.width {
                let (status, drawn) = (known.status[first + column], known.drawn[first + column]);
                if status == Status::Hit {
                    let found = RayResult { status, distance: drawn, drawn, ..RayResult::MISS };
                    band.set(column, row, &found);
                }
            }
        }
    }
}

/// Measured stages, in the order of the columns.
const STAGES: [&str; 8] = [
    "new",
    "handed back",
    "normals",
    "in f64",
    "colors",
    "near light",
    "frame set up",
    "frame lit",
];
/// Indices of stages that cost the same for drawn pixels and for the background.
const PER_PIXEL_STAGES: [usize; 3] = [0, 1, 6];

/// Returns the seconds of each stage: the 5th percentile of interleaved rounds. Other load on the
/// machine slows most rounds down, so a median would be too large.
fn time(rays: &RayGrid, buffer: &mut GBuffer) -> [f64; STAGES.len()] {
    let far = Appearance::new(Default::default(), Light::above_left(rays));
    let near = Appearance::new(Default::default(), Light::Positional(DVec3::new(3.0, -3.0, 3.0)));
    let gradients = NormalSource::<f32>::Gradient(&CopyPoints);
    let gradients_in_f64 = NormalSource::<f64>::Gradient(&CopyPoints);
    let shader = Shader::new(rays, &far);
    let mut times = [const { Vec::new() }; STAGES.len() + 1];
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
        // Takes the memory that was handed back, and frees it.
        drop(GBuffer::new(SIZE, SIZE, 0));
        buffer.normal.fill([0.0; 3]);
        lap(&mut || _ = black_box(normals(buffer, rays, gradients, 1e-3)));
        buffer.normal.fill([0.0; 3]);
        lap(&mut || _ = black_box(normals(buffer, rays, gradients_in_f64, 1e-3)));
        let shaded = |look| shade(buffer, rays, look, &[], ColorDepth::Bytes);
        shaded(&far).hand_back();
        lap(&mut || black_box(shaded(&far)).hand_back());
        lap(&mut || black_box(shaded(&near)).hand_back());
        // Before each measured frame, a painted frame hands its memory back.
        let known = Some(&*buffer);
        for (known, is_lit) in [(None, false), (known, false), (known, true)] {
            frame(rays, Some(buffer), Some(&shader));
            lap(&mut || frame(rays, known, is_lit.then_some(&shader)));
        }
        // Frees the memory that was handed back, so that the next round starts without any.
        drop([(); 2].map(|()| GBuffer::new(SIZE, SIZE, 0)));
    }
    let sorted = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 20]
    });
    let [times @ .., traced, lit] = sorted;
    let mut all = [0.0; STAGES.len()];
    let [first @ .., last] = &mut all;
    first.copy_from_slice(&times);
    *last = lit - traced;
    all
}

/// Draws a frame of the known hits, with normals and colors if there is a shader.
fn frame(rays: &RayGrid, known: Option<&GBuffer>, shader: Option<&Shader<'_>>) {
    let driver = Driver { rays, tracer: &KnownHits(known), advance: &|_| true };
    let mut colors = Colors::unset(ColorDepth::Bytes, SIZE * SIZE);
    let parts = colors.as_mut().split(BAND_ROWS * SIZE);
    let source = NormalSource::<f32>::Gradient(&CopyPoints);
    let (buffer, _) =
        driver.new_picture(0, Kept::default(), &[], (&[], &[]), parts, |rows, colors| {
            let canvas = shader.map(|shader| shader.canvas(colors));
            canvas.map_or_else(KernelStats::default, |canvas| {
                source.compute_normals(rows, rays, 1e-3, Some(canvas))
            })
        });
    black_box(&buffer);
    buffer.hand_back();
    colors.hand_back();
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    let (offset, up) = (DVec3::from(VIEWS[0].offset), DVec3::from(VIEWS[0].up));
    let projection = Projection::Perspective { fov: FOV };
    let camera = Camera::new(offset, DVec3::ZERO, up, projection).expect("valid");
    let rays = RayGrid::new(&camera, SIZE, SIZE);
    println!("{:20}{:>9}{}", "ns per pixel", "pixels", STAGES.map(|s| format!("{s:>13}")).concat());
    let print = |name: &str, pixels: usize, times: [f64; STAGES.len()]| {
        let columns = times.map(|time| format!("{:13.2}", 1e9 * time / pixels as f64)).concat();
        println!("{:20}{pixels:9}{columns}", format!("shade/{name}"));
    };
    let all = SIZE * SIZE;
    let background = time(&rays, &mut GBuffer::new(SIZE, SIZE, 0));
    print("background", all, background);
    for (name, radius) in [("full", 10.0), ("sphere", 1.0)] {
        let mut buffer = paint(&rays, radius);
        let drawn = (0..all).filter(|&pixel| buffer.is_drawn(pixel)).count();
        // Set-up costs the same for every pixel. For other stages, the background's cost is
        // subtracted.
        let (share, mut times) = ((all - drawn) as f64 / all as f64, time(&rays, &mut buffer));
        for (stage, time) in times.iter_mut().enumerate() {
            *time = if PER_PIXEL_STAGES.contains(&stage) {
                *time * drawn as f64 / all as f64
            } else {
                *time - share * background[stage]
            };
        }
        print(name, drawn, times);
    }
}
