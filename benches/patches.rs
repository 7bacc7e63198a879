//! Times pictures of parametric surfaces on one thread, beside pictures of the same surfaces by
//! their equations, and beside the usual way of drawing them: triangles and a depth buffer.
//!
//! `cargo bench --bench patches` prints a line for each of ten surfaces. It has the median
//! milliseconds of interleaved rounds of tracing 512×512 pixels, and the ratios. The triangles are
//! those of a grid over the parameters. Its cells are halved until no chord between neighbors is
//! more than half a pixel from the point between them. Points are evaluated by the same native
//! kernels, in `f32`. Neither shading nor the search for the grid counts.

use glam::{DVec3, Vec3};
use std::time::{Duration, Instant};
use zeroset_eval::{Kernel, LANES, Points, Sample, Values};
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::program::Program;
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};

#[path = "../tests/pictures/pairs.rs"]
mod pairs;

const SIZE: usize = 512;
const ROUNDS: usize = 9;
/// Largest distance between a chord and the surface, in pixels.
const CHORD: f32 = 0.5;
/// Largest number of cells along a parameter.
const MOST: usize = 1024;
/// Tangent of half the angle of view.
const TANGENT: f64 = 0.36;
/// Least depth of a point in front of the eye.
const NEAR: f32 = 1e-3;

/// A view of a cube around the origin.
struct View {
    half: f32,
    eye: DVec3,
    camera: Camera,
}

impl View {
    fn new(half: f64) -> Self {
        let eye = DVec3::new(0.3, -0.8, 0.5).normalize() * (4.0 * half);
        let fov = 2.0 * TANGENT.atan().to_degrees();
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, Projection::Perspective { fov });
        Self { half: half as f32, eye, camera: camera.expect("a camera") }
    }

    /// Column, row and depth of a point in the picture.
    fn seen(&self, at: Vec3) -> Vec3 {
        let (basis, at) = (self.camera.basis(), at.as_dvec3() - self.eye);
        let depth = at.dot(basis.forward);
        let scale = SIZE as f64 / 2.0 / (TANGENT * depth);
        let middle = SIZE as f64 / 2.0;
        let (right, up) = (at.dot(basis.right), at.dot(basis.up));
        DVec3::new(middle + scale * right, middle - scale * up, depth).as_vec3()
    }
}

/// A grid of points over the parameters.
struct Grid {
    cells: [usize; 2],
    points: Vec<Vec3>,
}

impl Grid {
    fn new(
        coordinates: [&dyn Kernel<Sample, f32>; 3],
        ranges: [[f64; 2]; 2],
        cells: [usize; 2],
    ) -> Self {
        let [columns, rows] = cells.map(|cells| cells + 1);
        let mut points = vec![Vec3::ZERO; columns * rows];
        let value = |axis: usize, index: usize| {
            let [low, high] = ranges[axis];
            (low + (high - low) * index as f64 / cells[axis] as f64) as f32
        };
        let mut input = Points::default();
        for (chunk, points) in points.chunks_mut(LANES).enumerate() {
            for lane in 0..points.len() {
                let index = chunk * LANES + lane;
                input.at[0][lane] = value(0, index % columns);
                input.at[1][lane] = value(1, index / columns);
            }
            input.count = points.len() as u32;
            for (axis, kernel) in coordinates.iter().enumerate() {
                let mut output = Values::default();
                kernel.eval(&input, &mut output);
                for (lane, point) in points.iter_mut().enumerate() {
                    point[axis] = output.value[lane];
                }
            }
        }
        Self { cells, points }
    }

    fn at(&self, u: usize, v: usize) -> Vec3 {
        self.points[v * (self.cells[0] + 1) + u]
    }

    /// Largest distance of a point from the chord between its neighbors along each parameter, in
    /// pixels, of those in the cube.
    fn chords(&self, view: &View) -> [f32; 2] {
        let [columns, rows] = self.cells;
        let mut most = [0.0_f32; 2];
        let is_in = |at: Vec3| at.abs().max_element() <= view.half;
        for v in 0..=rows {
            for u in 0..=columns {
                let at = self.at(u, v);
                let ends = [
                    (u > 0 && u < columns).then(|| [self.at(u - 1, v), self.at(u + 1, v)]),
                    (v > 0 && v < rows).then(|| [self.at(u, v - 1), self.at(u, v + 1)]),
                ];
                for (most, ends) in most.iter_mut().zip(ends) {
                    let Some([one, other]) = ends.filter(|_| is_in(at)) else { continue };
                    let [at, one, other] = [at, one, other].map(|at| view.seen(at).truncate());
                    let along = (other - one).normalize_or_zero();
                    *most = most.max((at - one).perp_dot(along).abs());
                }
            }
        }
        most
    }

    /// Draws all triangles into a depth buffer.
    fn draw(&self, view: &View, depths: &mut [f32]) {
        let seen: Vec<Vec3> = self.points.iter().map(|at| view.seen(*at)).collect();
        let columns = self.cells[0] + 1;
        for v in 0..self.cells[1] {
            for u in 0..self.cells[0] {
                let corner = v * columns + u;
                let all = [corner, corner + 1, corner + columns, corner + columns + 1];
                if all.iter().any(|corner| {
                    seen[*corner].z < NEAR || self.points[*corner].abs().max_element() > view.half
                }) {
                    continue;
                }
                let [a, b, c, d] = all.map(|corner| seen[corner]);
                fill([a, b, c], depths);
                fill([b, d, c], depths);
            }
        }
    }
}

/// Writes the depths of a triangle where it is nearer than what is there.
fn fill([a, b, c]: [Vec3; 3], depths: &mut [f32]) {
    let area = (b - a).truncate().perp_dot((c - a).truncate());
    if area == 0.0 {
        return;
    }
    let last = (SIZE - 1) as f32;
    let first = |low: f32| (low - 0.5).ceil().clamp(0.0, last) as usize;
    let end = |high: f32| (high + 0.5).floor().clamp(0.0, SIZE as f32) as usize;
    let columns = first(a.x.min(b.x).min(c.x))..end(a.x.max(b.x).max(c.x));
    let rows = first(a.y.min(b.y).min(c.y))..end(a.y.max(b.y).max(c.y));
    // The change of each corner's share from one column to the next.
    let across = Vec3::new(b.y - c.y, c.y - a.y, a.y - b.y) / area;
    let inverse = Vec3::new(a.z, b.z, c.z).recip();
    for row in rows {
        let y = row as f32 + 0.5;
        let x = columns.start as f32 + 0.5;
        let shares = Vec3::new(
            (b.x - x) * (c.y - y) - (b.y - y) * (c.x - x),
            (c.x - x) * (a.y - y) - (c.y - y) * (a.x - x),
            (a.x - x) * (b.y - y) - (a.y - y) * (b.x - x),
        ) / area;
        // The pixels of the row that are inside.
        let (mut low, mut high) = (0.0_f32, (columns.len() as f32) - 1.0);
        for (share, step) in shares.to_array().into_iter().zip(across.to_array()) {
            match step {
                0.0 if share < 0.0 => high = -1.0,
                0.0 => {}
                _ if step > 0.0 => low = low.max((-share / step).ceil()),
                _ => high = high.min((-share / step).floor()),
            }
        }
        if low > high {
            continue;
        }
        let (mut nearness, step) = ((shares + across * low).dot(inverse), across.dot(inverse));
        let start = row * SIZE + columns.start;
        for depth in &mut depths[start + low as usize..=start + high as usize] {
            *depth = depth.min(1.0 / nearness);
            nearness += step;
        }
    }
}

/// The coarsest grid whose chords are short enough.
fn grid(program: &Program, ranges: [[f64; 2]; 2], view: &View) -> Grid {
    let mut cells = [8; 2];
    loop {
        let grid = Grid::new(kernels(program), ranges, cells);
        let chords = grid.chords(view);
        let long = [0, 1].map(|axis| chords[axis] > CHORD && cells[axis] < MOST);
        if long == [false; 2] {
            return grid;
        }
        cells = [0, 1].map(|axis| cells[axis] << u32::from(long[axis]));
    }
}

fn kernels(program: &Program) -> [&dyn Kernel<Sample, f32>; 3] {
    [0, 1, 2].map(|axis| program.kernels::<f32>(axis).values().expect("a kernel"))
}

fn milliseconds(times: &mut [Duration]) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e3
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    println!("{SIZE}×{SIZE} pixels, one thread, medians of {ROUNDS}, ms");
    println!(
        "{:>10}{:>10}{:>10}{:>12}{:>8}{:>8}  surface",
        "patches", "equation", "triangles", "count", "p/e", "p/t"
    );
    for [patch, equation, half] in pairs::PAIRS {
        let half: f64 = half.parse().expect("a number");
        let view = View::new(half);
        let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a cube");
        let settings = Settings { width: SIZE, height: SIZE, ..Settings::default() };
        let models = [patch, equation].map(|text| {
            let document = read(text, &Options::default()).expect(text);
            Model::new(&document, &region, &settings).expect(text)
        });
        let surface = models[0].program().patch(0).expect("a parametric surface");
        let (program, ranges) = (surface.coordinates(), surface.ranges());
        let cells = grid(program, ranges, &view).cells;
        let mut times = [const { Vec::new() }; 3];
        for round in 0..=ROUNDS {
            for (model, times) in models.iter().zip(&mut times) {
                let picture = model.trace(&view.camera, &settings, &|_| true).expect(patch);
                times.extend((round > 0).then_some(picture.statistics.times.trace));
                picture.hand_back();
            }
            let begun = Instant::now();
            let mut depths = vec![f32::INFINITY; SIZE * SIZE];
            Grid::new(kernels(program), ranges, cells).draw(&view, &mut depths);
            times[2].extend((round > 0).then_some(begun.elapsed()));
            std::hint::black_box(depths);
        }
        let [patches, by_equation, triangles] = times.each_mut().map(|times| milliseconds(times));
        println!(
            "{patches:10.1}{by_equation:10.1}{triangles:10.1}{:12}{:8.1}{:8.1}  {equation}",
            2 * cells[0] * cells[1],
            patches / by_equation,
            patches / triangles,
        );
    }
}
