//! Tests of zeros a hair inside and outside of the region: of its faces, a clip plane or a ball.
//!
//! A long run: `ZEROSET_CASES=100000 cargo test --release -p zeroset-trace edges -- --nocapture`.

use crate::driver::Driver;
use crate::gbuffer::GBuffer;
use crate::grid::RayGrid;
use crate::method::Method;
use crate::options::{Precision, TraceOptions};
use crate::packet::tests::{exact, inside};
use crate::ray_result::Status;
use glam::DVec3;
use num_rational::BigRational;
use zeroset_eval::{
    Assumptions, Binding, ContractSegments, ContractTiles, Enclose, FindZeros, KernelError,
    KernelResult, Kernels, Real, Reference, SurfaceKernels, Tape,
};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, NodeId};
use zeroset_ops::Op;
use zeroset_space::{Camera, HalfSpace, Projection, Ray, Region};
use zeroset_testkit::{Adversarial, Effort, Rng};

/// Number of columns, and of rows, of a picture.
const SIDE: usize = 6;

/// The kernels of a function in one precision.
struct InSoftware<T: Real> {
    bounds: Reference<Enclose, T>,
    zeros: Reference<FindZeros, T>,
    segments: Reference<ContractSegments, T>,
    tiles: Reference<ContractTiles, T>,
}

impl<T: Real> InSoftware<T> {
    fn new(graph: &Graph, root: NodeId, region: &Region) -> Self {
        let (low, high) = (region.low(), region.high());
        let domain = [0, 1, 2].map(|axis| Interval { lo: low[axis], hi: high[axis] });
        let assumptions = Assumptions { domain, parameters: Vec::new() };
        let tape = Tape::new(graph, &[root], &assumptions);
        Self {
            bounds: Reference::new(tape.clone(), Binding::empty()),
            zeros: Reference::new(tape.clone(), Binding::empty()),
            segments: Reference::new(tape.clone(), Binding::empty()),
            tiles: Reference::new(tape, Binding::empty()),
        }
    }
}

impl<T: Real> Kernels<T> for InSoftware<T> {
    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        Ok(&self.bounds)
    }
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        Ok(&self.zeros)
    }
    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        Ok(&self.segments)
    }
    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        Ok(&self.tiles)
    }
    fn cleared(&self) -> Result<Option<[&dyn zeroset_eval::Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }
}

struct Both(InSoftware<f32>, InSoftware<f64>);

impl SurfaceKernels for Both {
    fn single(&self) -> &dyn Kernels<f32> {
        &self.0
    }
    fn double(&self) -> &dyn Kernels<f64> {
        &self.1
    }
}

/// The function normal·p − offset, or |p − centre|² − square.
enum Shape {
    Plane { normal: DVec3, offset: BigRational },
    Ball { centre: DVec3, square: BigRational },
}

impl Shape {
    fn write(&self, graph: &mut Graph) -> NodeId {
        let constant =
            |graph: &mut Graph, value: BigRational| graph.constant(Constant::rational(value));
        let mut sum = graph.integer(0);
        let (at, last) = match self {
            Self::Plane { normal, offset } => (normal, offset),
            Self::Ball { centre, square } => (centre, square),
        };
        for (axis, name) in Axis::ALL.into_iter().enumerate() {
            let coordinate = graph.variable(name);
            let number = constant(graph, exact(at[axis]));
            let term = match self {
                Self::Plane { .. } => graph.apply(Op::Mul, &[coordinate, number]),
                Self::Ball { .. } => {
                    let difference = graph.apply(Op::Sub, &[coordinate, number]);
                    graph.apply(Op::Sqr, &[difference])
                }
            };
            sum = graph.apply(Op::Add, &[sum, term]);
        }
        let last = constant(graph, last.clone());
        graph.apply(Op::Sub, &[sum, last])
    }

    /// The exact point at which a ray meets the plane. `None` for a ball.
    fn meets(&self, ray: &Ray) -> Option<[BigRational; 3]> {
        let Self::Plane { normal, offset } = self else { return None };
        let dot = |v: DVec3| (0..3).map(|k| exact(normal[k]) * exact(v[k])).sum::<BigRational>();
        let (along, start) = (dot(ray.direction), dot(ray.origin));
        if along == exact(0.0) {
            return None;
        }
        let t = (offset - start) / along;
        let point = |axis: usize| exact(ray.origin[axis]) + &t * exact(ray.direction[axis]);
        (t >= exact(0.0)).then(|| [0, 1, 2].map(point))
    }
}

/// A random region, and a surface just outside of one of its bounds or just inside. The shift is a
/// share of the bound's size.
fn case(rng: &mut Rng, is_outside: bool) -> (Region, Shape) {
    let signed = |rng: &mut Rng| f64::uniform(rng) * 2.0 - 1.0;
    let vector = |rng: &mut Rng| DVec3::new(signed(rng), signed(rng), signed(rng));
    let centre = vector(rng) * [0.0, 3.0][rng.u32(0..2) as usize];
    let half = vector(rng).abs() + DVec3::splat(0.2);
    let mut region = Region::new(centre - half, centre + half).expect("a box");
    let share = exact(2_f64.powi(-rng.i32(18..80)) * (1.0 + f64::uniform(rng)));
    let factor = |size: f64| {
        let shift = &share * exact(size.abs() + 0.1);
        if is_outside { shift } else { -shift }
    };
    let shape = match rng.u32(0..3) {
        0 => {
            let axis = rng.u32(0..3) as usize;
            let (end, sign) =
                if rng.bool() { (region.high()[axis], 1.0) } else { (-region.low()[axis], -1.0) };
            let normal = DVec3::AXES[axis] * sign;
            Shape::Plane { normal, offset: exact(end) + factor(end) }
        }
        1 => {
            let normal = vector(rng) + DVec3::splat(0.01);
            let offset = normal.dot(centre + half * vector(rng) * 0.4);
            region = region.with_clip(HalfSpace { normal, offset }).expect("a plane");
            Shape::Plane { normal, offset: exact(offset) + factor(offset) }
        }
        _ => {
            region = region.with_ball();
            let ball = region.ball().expect("a ball");
            let square = exact(ball.radius) * exact(ball.radius);
            Shape::Ball { centre: ball.centre, square: square + factor(ball.radius) }
        }
    };
    (region, shape)
}

/// Returns the statuses of rays through a random picture of the region, and the rays.
fn statuses(region: &Region, shape: &Shape, rng: &mut Rng) -> Option<Vec<(Ray, Status)>> {
    let mut graph = Graph::new();
    let root = shape.write(&mut graph);
    let kernels =
        Both(InSoftware::new(&graph, root, region), InSoftware::new(&graph, root, region));
    let centre = region.centre();
    let way = DVec3::new(f64::uniform(rng) - 0.5, f64::uniform(rng) - 0.5, f64::uniform(rng) - 0.5);
    let eye = centre + way * region.half_extent() * [1.0, 6.0, 1000.0][rng.u32(0..3) as usize];
    let projection = Projection::Orthographic { height: 1.5 * region.half_extent() };
    let camera = Camera::new(eye, centre, DVec3::Z, projection).ok()?;
    let precision = [Precision::Auto, Precision::F32, Precision::F64][rng.u32(0..3) as usize];
    let options = TraceOptions { precision, tiles: rng.bool(), ..TraceOptions::default() };
    let affine = Method::named("affine").expect("a row");
    let tracer = affine.prepare(&kernels, region, options).expect("kernels");
    let rays = RayGrid::new(&camera, SIDE, SIDE);
    let mut buffer = GBuffer::new(SIDE, SIDE, 0);
    Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
    Some((0..SIDE * SIDE).map(|pixel| (rays.ray_of(pixel), buffer.status[pixel])).collect())
}

#[test]
fn zeros_a_hair_outside_are_no_hits_and_zeros_inside_no_misses() {
    let effort = Effort::from_environment(0x5eed_ed9e, 1500);
    let (mut kept_out, mut found) = (0_u64, 0_u64);
    for seed in effort.seed..effort.seed + effort.cases {
        let rng = &mut Rng::with_seed(seed);
        let is_outside = rng.bool();
        let (region, shape) = case(rng, is_outside);
        let Some(statuses) = statuses(&region, &shape, rng) else { continue };
        for (ray, status) in statuses {
            let again = format!("{ray:?} in {region:?}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1");
            if is_outside {
                assert!(status != Status::Hit, "a zero outside of the region is a hit: {again}");
                kept_out += 1;
            } else if let Some(point) = shape.meets(&ray)
                && inside(&region, &point)
            {
                assert!(status != Status::Miss, "a zero in the region is a miss: {again}");
                found += u64::from(status == Status::Hit);
            }
        }
    }
    println!("{kept_out} rays with a zero outside, {found} hits inside");
    assert!(kept_out > 10 * effort.cases && found > effort.cases, "{kept_out} {found}");
}
