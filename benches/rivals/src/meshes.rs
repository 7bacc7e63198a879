//! zeroset's meshes beside fidget's (manifold dual contouring), at the same largest error.
//!
//! fidget's mesh at a depth has some largest distance to the surface. zeroset is given the widest
//! tolerance with which its mesh is at least as near. Both are then timed, from graph to triangles.

use crate::measure::{Times, measure_within};
use crate::parts::models::{SPHERES, solids, spheres};
use crate::side::Side;
use crate::surfaces::{SURFACES, Surface};
use crate::voxels::tree;
use anyhow::{Context, Result, anyhow};
use clap::Args;
use fidget::context::Tree;
use fidget::jit::JitFunction;
use fidget::mesh::{Octree, Settings};
use fidget::shape::{BoundShape, Shape};
use glam::DVec3;
use nalgebra::Matrix4;
use zeroset_eval::{Gradients, LANES, Points};
use zeroset_mesh::{MOST_CELLS, Options, mesh};
use zeroset_scene::program::Program;
use zeroset_syntax::Document;
use zeroset_testkit::machine::{processor, threads};

/// Arguments of `meshes`.
#[derive(Args)]
pub struct MeshesArguments {
    /// Depths of fidget's octree, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "7,8")]
    depths: Vec<u8>,
    /// Surfaces and models, separated by commas; all if not given
    #[arg(long, value_delimiter = ',')]
    surfaces: Vec<String>,
    /// Most rounds per surface; every side makes its mesh once in each
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Seconds per surface and depth, after which no round begins
    #[arg(long, default_value_t = 20.0)]
    budget: f64,
}

/// Triangles with their corners in world units.
#[derive(Default)]
pub struct Triangles(pub Vec<[DVec3; 3]>);

/// fidget's mesher.
pub struct Dual {
    tree: Tree,
    half: f64,
    depth: u8,
    /// The mesh, once it is drawn.
    pub mesh: Triangles,
}

impl Dual {
    /// A mesher of a cube around the origin, whose edge is twice `half`.
    pub fn new(tree: Tree, half: f64, depth: u8) -> Self {
        Self { tree, half, depth, mesh: Triangles::default() }
    }
}

/// The document's first function, as fidget takes it.
///
/// # Errors
/// If fidget lacks an operation.
pub fn tree_of(document: &Document) -> Result<Tree> {
    tree(&document.graph, document.surfaces[0].root)
}

impl Side for Dual {
    fn name(&self) -> String {
        format!("fidget {}", self.depth)
    }

    fn size(&self) -> usize {
        1 << self.depth
    }

    fn draw(&mut self) -> Result<()> {
        let shape: BoundShape<'_, JitFunction, f32> = Shape::from(self.tree.clone()).try_into()?;
        let world_to_model = Matrix4::new_scaling(self.half as f32);
        let settings =
            Settings { depth: self.depth, world_to_model, threads: None, ..Settings::default() };
        let octree = Octree::build(&shape, &settings).ok_or_else(|| anyhow!("cancelled"))?;
        let mesh = octree.walk_dual();
        let at = |vertex: usize| {
            let [x, y, z] = mesh.vertices[vertex].into();
            DVec3::new(x.into(), y.into(), z.into())
        };
        self.mesh.0 = mesh.triangles.iter().map(|t| [t.x, t.y, t.z].map(at)).collect();
        Ok(())
    }

    fn distances(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// zeroset's mesher, with or without the proof of the shape.
pub struct Ours<'a> {
    document: &'a Document,
    surface: &'a Surface,
    tolerance: f64,
    is_estimated: bool,
    /// The mesh, once it is drawn.
    pub mesh: Triangles,
    /// Number of cells without a proof.
    pub unproven: usize,
}

impl<'a> Ours<'a> {
    /// A mesher with this tolerance, without the proof of the shape if `is_estimated`.
    pub fn new(
        document: &'a Document,
        surface: &'a Surface,
        tolerance: f64,
        is_estimated: bool,
    ) -> Self {
        let mesh = Triangles::default();
        Self { document, surface, tolerance, is_estimated, mesh, unproven: 0 }
    }
}

impl Side for Ours<'_> {
    fn name(&self) -> String {
        if self.is_estimated { "without proof" } else { "with proof" }.to_owned()
    }

    fn size(&self) -> usize {
        0
    }

    fn draw(&mut self) -> Result<()> {
        let region = self.surface.region()?;
        let program = Program::new(self.document, zeroset_mesh::domain(&region))?;
        let is_solid = program.is_solid(0);
        let options = Options {
            region,
            larger: None,
            tolerance: self.tolerance,
            is_solid,
            is_estimated: self.is_estimated,
            has_large_faces: false,
            most_cells: MOST_CELLS,
        };
        let mesh = mesh(&program, 0, &options, &|| true)?.expect("nobody cancels it");
        let at = |vertex: u32| mesh.vertices[vertex as usize];
        self.mesh.0 = mesh.triangles.iter().map(|triangle| triangle.map(at)).collect();
        self.unproven = mesh.unproven.len();
        Ok(())
    }

    fn distances(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Steps of Newton's method from a point of a mesh to the surface.
const STEPS: usize = 8;

impl Triangles {
    /// The distances to the surface from the corners, the middles of edges, and the centers, in
    /// order. Points from which Newton's method does not reach the surface are left out.
    fn distances(&self, program: &Program) -> Result<Vec<f64>> {
        let mut starts = Vec::new();
        for [a, b, c] in &self.0 {
            starts.extend([*a, a.midpoint(*b), b.midpoint(*c), c.midpoint(*a), (a + b + c) / 3.0]);
        }
        let kernel = program.kernels::<f64>(0).gradients()?;
        let mut distances = Vec::new();
        for starts in starts.chunks(LANES) {
            let mut points = starts.to_vec();
            let mut last = [f64::INFINITY; LANES];
            for _ in 0..STEPS {
                let mut found = Gradients::<f64>::default();
                kernel.eval(&Points::near(&points)[0], &mut found);
                for (lane, point) in points.iter_mut().enumerate() {
                    let gradient =
                        DVec3::from_array(found.gradient.each_ref().map(|axis| axis[lane]));
                    let step = gradient * (found.value[lane] / gradient.length_squared());
                    *point -= step;
                    last[lane] = step.length();
                }
            }
            for (lane, (start, end)) in starts.iter().zip(&points).enumerate() {
                let distance = start.distance(*end);
                if last[lane] <= 1e-3 * distance || distance < 1e-12 {
                    distances.push(distance);
                }
            }
        }
        distances.sort_by(f64::total_cmp);
        Ok(distances)
    }
}

/// The largest of sorted distances, but for a thousandth of them: near singular points Newton's
/// method goes astray.
fn largest(distances: &[f64]) -> f64 {
    let left_out = distances.len() / 1000;
    distances.len().checked_sub(1 + left_out).map_or(f64::NAN, |last| distances[last])
}

/// Measures all surfaces, and prints a table.
///
/// # Errors
/// If a surface is not valid, or a side makes no mesh.
pub fn run(arguments: &MeshesArguments) -> Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!("{}, 1 of {} threads", processor(), threads());
    println!(
        "processor time from graph to triangles, medians of interleaved rounds; error: largest distance from \
         the\nmesh to the surface but for a thousandth of the points; /: time over that of fidget\n"
    );
    println!(
        "{:16}{:14}{:>10}{:>6}{:>7}{:>8}{:>11}{:>12}{:>10}",
        "surface", "side", "ms", "± %", "rounds", "/", "triangles", "error", "unproven"
    );
    let models = [spheres(100, SPHERES)].into_iter().chain(solids().into_iter().take(2));
    let models: Vec<Surface> = models.map(|model| model.surface).collect();
    let mut ratios = [Vec::new(), Vec::new()];
    for surface in SURFACES.iter().chain(&models) {
        let is_wanted = arguments.surfaces.is_empty()
            || arguments.surfaces.iter().any(|name| *name == *surface.name);
        for depth in arguments.depths.iter().filter(|_| is_wanted) {
            let found = pool.install(|| compare(surface, *depth, arguments));
            match found.with_context(|| surface.name.to_string()) {
                Ok(found) => (0..2).for_each(|k| ratios[k].push(found[k])),
                Err(error) => println!("{:16}{error:#}", surface.name),
            }
        }
    }
    for (name, ratios) in ["without the proof", "with the proof"].iter().zip(&ratios) {
        let mean = ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64;
        println!("{name}: geometric mean of / {:.3} over {}", mean.exp(), ratios.len());
    }
    Ok(())
}

/// Measures a surface at a depth. Returns the ratios of zeroset's times to fidget's, without and
/// with the proof.
fn compare(surface: &Surface, depth: u8, arguments: &MeshesArguments) -> Result<[f64; 2]> {
    let document = surface.document()?;
    let program = Program::new(&document, zeroset_mesh::domain(&surface.region()?))?;
    let mut dual = Dual::new(tree_of(&document)?, surface.half, depth);
    dual.draw()?;
    let error = largest(&dual.mesh.distances(&program)?);
    let ours =
        |tolerance: f64, is_estimated: bool| Ours::new(&document, surface, tolerance, is_estimated);
    let (mut tolerance, mut near) = (16.0 * error, f64::INFINITY);
    while near > error {
        tolerance *= 0.5_f64.sqrt();
        let mut trial = ours(tolerance, true);
        trial.draw()?;
        near = largest(&trial.mesh.distances(&program)?);
    }
    let (mut without, mut with) = (ours(tolerance, true), ours(tolerance, false));
    without.draw()?;
    with.draw()?;
    let found = [&dual.mesh, &without.mesh, &with.mesh].map(|mesh| mesh.0.len());
    let unproven = with.unproven;
    let errors = [error, near, largest(&with.mesh.distances(&program)?)];
    let mut sides: [Box<dyn Side + Send + '_>; 3] =
        [Box::new(dual), Box::new(without), Box::new(with)];
    let times = measure_within(&mut sides, arguments.rounds as usize, arguments.budget)?;
    for (k, (side, own)) in sides.iter().zip(&times).enumerate() {
        let unproven = if k == 2 { unproven.to_string() } else { "-".to_owned() };
        println!(
            "{:16}{:14}{:>10.1}{:>6.1}{:>7}{:>8.2}{:>11}{:>12.2e}{unproven:>10}",
            surface.name,
            side.name(),
            own.median() * 1e3,
            own.spread() * 100.0,
            own.rounds(),
            own.ratio(&times[0]),
            found[k],
            errors[k],
        );
    }
    Ok([1, 2].map(|k: usize| Times::ratio(&times[k], &times[0])))
}
