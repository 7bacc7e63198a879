//! fidget's renderer, which prunes voxels from front to back by intervals in native code.
//!
//! It draws the solid f < 0. So the sign of f is chosen such that most rays enter the domain
//! outside the solid.

use crate::reference::Entries;
use crate::side::Side;
use crate::surfaces::{FOV, Surface, View};
use anyhow::{Result, anyhow, bail};
use fidget::context::Tree;
use fidget::eval::MathFunction;
use fidget::raster::voxel::{EvalConfig, Image, RenderConfig, render};
use fidget::render::{CancelToken, RenderHints, ThreadPool, VoxelSize};
use fidget::shape::{BoundShape, Shape};
use glam::DVec3;
use nalgebra::{Matrix4, Vector4};
use zeroset_ir::{Axis, Graph, Node, NodeId};
use zeroset_ops::Op;
use zeroset_trace::RayGrid;

/// A shape, with its last picture. `F` is what evaluates it: native code or a virtual machine.
pub struct Voxels<F> {
    name: String,
    shape: Shape<F>,
    config: RenderConfig,
    rays: RayGrid,
    depth: Depth,
    is_parallel: bool,
    entries: Option<Entries>,
    image: Image,
}

/// The depth in front of the eye at z in fidget's world.
#[derive(Clone, Copy)]
enum Depth {
    /// The inverse depth at z = 0, and how much it grows up to z = 1.
    Inverse([f64; 2]),
    /// The depth at z = 0, and how much it grows up to z = 1.
    Linear([f64; 2]),
}

impl Depth {
    fn at(self, z: f64) -> f64 {
        match self {
            Self::Inverse([middle, growth]) => 1.0 / (middle + growth * z),
            Self::Linear([middle, growth]) => middle + growth * z,
        }
    }
}

impl<F: MathFunction> Voxels<F> {
    /// Prepares the surface in `size`³ voxels, with normals. Without `entries`, the solid is where
    /// f is below 0.
    ///
    /// # Errors
    /// If fidget lacks an operation.
    pub fn new(
        name: String,
        surface: &Surface,
        entries: Option<Entries>,
        size: usize,
        is_parallel: bool,
    ) -> Result<Self> {
        let document = surface.document()?;
        let mut tree = tree(&document.graph, document.surfaces[0].root)?;
        if entries.is_some_and(Entries::are_mostly_below) {
            tree = -tree;
        }
        if surface.is_cut {
            for axis in [Tree::x(), Tree::y(), Tree::z()] {
                tree = tree.max(axis.abs() - surface.half as f32);
            }
        }
        let rays = RayGrid::new(&surface.camera()?, size, size);
        let (matrix, depth) = match surface.view {
            View::Oblique => oblique(&rays, surface.half),
            View::Front => front(&rays, surface.half),
        };
        let mut config = RenderConfig::from_size(VoxelSize::from(size as u32));
        config.world_to_model = matrix;
        let (shape, image) = (Shape::from(tree), Image::default());
        Ok(Self { name, shape, config, rays, depth, is_parallel, entries, image })
    }
}

/// Returns the matrix from fidget's world, with coordinates within ±1, to space. It reproduces
/// zeroset's rays: along each, z is linear in the inverse depth. At z = 1 is a plane in front of
/// the domain.
fn oblique(rays: &RayGrid, half: f64) -> (Matrix4<f32>, Depth) {
    let (eye, forward) = (rays.eye(), rays.forward());
    let reach = (FOV / 2.0).to_radians().tan();
    let extent = half * forward.abs().element_sum();
    let (near, far) = (eye.length() - extent, eye.length() + extent);
    let middle = f64::midpoint(1.0 / near, 1.0 / far);
    let growth = (1.0 / near - 1.0 / far) / 2.0;
    let [right, up] = [rays.right() * reach, rays.up() * reach];
    let centre = centre(right, up, rays);
    let matrix = Matrix4::from_columns(&[
        column(right, 0.0),
        column(up, 0.0),
        column(eye * growth, growth),
        column(eye * middle + forward + centre, middle),
    ]);
    (matrix, Depth::Inverse([middle, growth]))
}

/// As [`oblique`], for parallel rays. Voxels fill the domain.
fn front(rays: &RayGrid, half: f64) -> (Matrix4<f32>, Depth) {
    let [right, up] = [rays.right() * half, rays.up() * half];
    let matrix = Matrix4::from_columns(&[
        column(right, 0.0),
        column(up, 0.0),
        column(rays.forward() * -half, 0.0),
        column(centre(right, up, rays), 1.0),
    ]);
    (matrix, Depth::Linear([rays.eye().length(), -half]))
}

fn column(v: DVec3, w: f64) -> Vector4<f32> {
    Vector4::from([v.x, v.y, v.z, w].map(|x| x as f32))
}

/// fidget's pixel positions are half a pixel off center, towards the lower left of the picture.
/// Returns the way back, given those from the middle to the right and to the upper edge.
fn centre(right: DVec3, up: DVec3, rays: &RayGrid) -> DVec3 {
    (right + up) / rays.width() as f64
}

/// Converts the function as typed. fidget simplifies it.
pub fn tree(graph: &Graph, root: NodeId) -> Result<Tree> {
    let needed = graph.reachable(&[root]);
    let mut trees: Vec<Option<Tree>> = vec![None; graph.len()];
    for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        let tree = match node {
            Node::Variable(Axis::X) => Tree::x(),
            Node::Variable(Axis::Y) => Tree::y(),
            Node::Variable(Axis::Z) => Tree::z(),
            Node::Constant(constant) => Tree::constant(constant.bounds().lo as f32),
            Node::Parameter(_) => bail!("fidget would need values of parameters"),
            Node::Apply(op, operands) => {
                let at = |n: usize| trees[operands[n].index()].clone().expect("comes before");
                match op {
                    Op::Neg => -at(0),
                    Op::Abs => at(0).abs(),
                    Op::Sqr => at(0).square(),
                    Op::Sqrt => at(0).sqrt(),
                    Op::Sin => at(0).sin(),
                    Op::Cos => at(0).cos(),
                    Op::Exp => at(0).exp(),
                    Op::Ln => at(0).ln(),
                    Op::Min => at(0).min(at(1)),
                    Op::Max => at(0).max(at(1)),
                    // A solid keeps gaps of f out. The models have none: f has a value everywhere.
                    Op::Otherwise => at(0),
                    Op::Add => at(0) + at(1),
                    Op::Sub => at(0) - at(1),
                    Op::Mul => at(0) * at(1),
                    Op::Div => at(0) / at(1),
                    Op::Pow => match graph.node(operands[1]) {
                        Node::Constant(n) if n.as_integer().is_some_and(|n| n >= 0) => {
                            at(0).pow(n.as_integer().expect("just seen"))
                        }
                        _ => bail!("fidget has whole powers only"),
                    },
                    // No surface of the table has other operations.
                    other => bail!("`{}` was not told to fidget", other.row().name),
                }
            }
        };
        trees[id.index()] = Some(tree);
    }
    trees[root.index()].clone().ok_or_else(|| anyhow!("no formula"))
}

impl<F: MathFunction + RenderHints> Side for Voxels<F> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn size(&self) -> usize {
        self.rays.width()
    }

    fn draw(&mut self) -> Result<()> {
        let shape: BoundShape<'_, F, f32> = self.shape.clone().try_into()?;
        // fidget's global pool is the pool in which this function runs.
        let threads = self.is_parallel.then_some(&ThreadPool::Global);
        let evaluation = EvalConfig { tile_sizes: None, threads, cancel: CancelToken::new() };
        let image = render(shape, &self.config, &evaluation);
        self.image = image.ok_or_else(|| anyhow!("nobody cancelled it"))?;
        Ok(())
    }

    fn distances(&self) -> Vec<f64> {
        let size = self.size() as f64;
        let distance = |(pixel, depth): (usize, u32)| {
            if depth == 0 {
                return f64::INFINITY;
            }
            // `depth` is the index of the first voxel inside, plus one. Indices grow towards the
            // eye, so voxel `depth` is outside.
            let z = (f64::from(depth) - 0.5 - size / 2.0) * 2.0 / size;
            self.rays.ray_of(pixel).distance(self.depth.at(z))
        };
        self.image.iter().map(|pixel| pixel.depth).enumerate().map(distance).collect()
    }

    fn remark(&self) -> Option<String> {
        let share = self.entries?.minority()?;
        Some(format!(
            "fidget cannot draw it: of solids it draws the cut face, and {:.0} % of the rays enter the domain inside",
            100.0 * share
        ))
    }
}
