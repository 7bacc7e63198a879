//! The kernels of one function, as methods use them.

use crate::batch::{Boxes, Enclosures, Planes, Tiles, Zeros};
use crate::branches::BranchTest;
use crate::lanes::LANES;
use crate::query::{
    ContractSegments, ContractTiles, Enclose, EncloseGradient, FindZeros, Kernel, Sample,
    SampleGradient, eval_lanes,
};
use crate::real::Real;
use std::error::Error;
use std::fmt;
use std::sync::Arc;
use zeroset_interval::Interval;

/// The reason why a kernel is not available.
pub type KernelError = Arc<dyn Error + Send + Sync>;

/// A kernel, or the reason why it is not available.
pub type KernelResult<'a, Q, T> = Result<&'a dyn Kernel<Q, T>, KernelError>;

/// The kernels of one function, in `f32` and in `f64`.
///
/// A kernel is compiled when it is first requested, so a caller should request only what a picture
/// needs. An implementation may leave out kernels, which are then not available.
pub trait SurfaceKernels: Send + Sync {
    /// Returns the kernels that compute in `f32`.
    fn single(&self) -> &dyn Kernels<f32> {
        &NoKernel
    }
    /// Returns the kernels that compute in `f64`.
    fn double(&self) -> &dyn Kernels<f64> {
        &NoKernel
    }
}

/// The kernels of one function in one precision. Each method returns an error if its kernel is not
/// available.
#[allow(clippy::missing_errors_doc, reason = "the same for each, and said above")]
pub trait Kernels<T: Real>: Sync {
    /// The kernel that tests whether boxes may hold a zero.
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that bounds the function.
    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that bounds the function at points of one part of space, by only the steps that
    /// matter there. Elsewhere, its answers are meaningless. `None` if these kernels are for all of
    /// space.
    fn bounds_in_part(&self) -> Option<KernelResult<'_, Enclose, T>> {
        None
    }
    /// The kernels that bound the numerator and the denominator of the function's rational form, if
    /// it has one. Within its domain of definition, the function is 0 where the numerator is 0 and
    /// the denominator is not. The function has poles where the denominator is 0.
    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that narrows segments of rays to their zeros. It uses the numerator of the
    /// function's rational form if there is one, else the function.
    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that narrows tiles of rays to their zeros, for the function that
    /// [`Kernels::segments`] uses.
    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that bounds the function and its gradient.
    fn gradient_bounds(&self) -> KernelResult<'_, EncloseGradient, T> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that samples the function.
    fn values(&self) -> KernelResult<'_, Sample, T> {
        Err(Arc::new(NoKernel))
    }
    /// The kernel that samples the function and its gradient.
    fn gradients(&self) -> KernelResult<'_, SampleGradient, T> {
        Err(Arc::new(NoKernel))
    }
    /// Returns whether parts of space may have surfaces of their own ([`Self::in_tiles`]).
    fn has_parts(&self) -> bool {
        false
    }
    /// For each tile, the surface to use in it. An empty list stands for [`PartSurface::Same`] in
    /// each tile.
    fn in_tiles(&self, _: &Tiles<T>) -> Vec<PartSurface> {
        Vec::new()
    }
}

/// The surface to use in a part of space.
pub enum PartSurface {
    /// There is no zero in the part.
    Empty,
    /// Kernels for the part take as much time as the kernels for all of space.
    Same,
    /// A surface with the same zeros and signs in the part, and the same domain of definition,
    /// whose kernels take less time. It has those kernels that find zeros along rays.
    Short(Box<dyn SurfaceKernels>),
}

/// A float type that selects the kernels of a surface.
pub trait KernelFloat: Real {
    /// Returns the kernels of a surface that compute in this type.
    fn kernels(surface: &dyn SurfaceKernels) -> &dyn Kernels<Self>;
}

impl KernelFloat for f32 {
    fn kernels(surface: &dyn SurfaceKernels) -> &dyn Kernels<Self> {
        surface.single()
    }
}

impl KernelFloat for f64 {
    fn kernels(surface: &dyn SurfaceKernels) -> &dyn Kernels<Self> {
        surface.double()
    }
}

/// The error for a query that a surface has no kernel for.
#[derive(Clone, Copy, Debug)]
struct NoKernel;

impl fmt::Display for NoKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("this surface has no kernel for this question")
    }
}

impl Error for NoKernel {}
impl<T: Real> Kernels<T> for NoKernel {}

/// A test for zeros that evaluates up to three forms of a function. A further form is evaluated
/// only for lanes that the earlier forms leave undecided.
pub struct ZeroTest<T: Real> {
    /// The function itself.
    pub function: Box<dyn Kernel<FindZeros, T>>,
    /// The numerator of the function's rational form, which has the function's zeros in the domain
    /// of definition. It is finite near poles. So it proves that a pole is no zero, and bounds
    /// roots near a pole.
    pub numerator: Option<Box<dyn Kernel<FindZeros, T>>>,
    /// The function branch by branch. It is evaluated in lanes where the function may jump.
    pub branches: Option<Arc<BranchTest<T>>>,
}

impl<T: Real> Kernel<FindZeros, T> for ZeroTest<T> {
    #[inline]
    fn eval(&self, boxes: &Boxes<T>, zeros: &mut Zeros) {
        self.function.eval(boxes, zeros);
        // Bits of unused lanes have no meaning and must not cause further evaluations.
        zeros.possible &= u16::MAX >> (u16::BITS - boxes.count);
        if let Some(numerator) = &self.numerator
            && zeros.possible != 0
        {
            let cleared = eval_lanes(&**numerator, boxes, zeros.possible);
            zeros.possible &= cleared.possible;
            zeros.unbounded &= cleared.unbounded;
        }
        if let Some(branches) = &self.branches
            && zeros.possible & zeros.jumping != 0
        {
            zeros.possible &= !branches.proven_empty(boxes, zeros.possible & zeros.jumping);
        }
    }
}

/// A kernel that bounds the function of a solid, and finds its sign branch by branch where it
/// jumps.
pub struct SideTest<T: Real> {
    /// The kernel that bounds the function.
    pub bounds: Box<dyn Kernel<Enclose, T>>,
    /// The function branch by branch.
    pub branches: Arc<BranchTest<T>>,
}

impl<T: Real> Kernel<Enclose, T> for SideTest<T> {
    fn eval(&self, boxes: &Boxes<T>, bounds: &mut Enclosures<T>) {
        self.bounds.eval(boxes, bounds);
        let used = u16::MAX >> (u16::BITS - boxes.count);
        let jumping = bounds.possible() & !bounds.continuous & used;
        if jumping == 0 {
            return;
        }
        let [below, above] = self.branches.proven_sides(boxes, jumping);
        // On each branch, a bound is a float below 0. So is the largest of them.
        let least = -T::above(f64::from_bits(1));
        for lane in (0..LANES).filter(|lane| (below | above) >> lane & 1 == 1) {
            let end = if below >> lane & 1 == 1 { &mut bounds.hi } else { &mut bounds.neg_lo };
            end[lane] = least;
        }
    }
}

/// A kernel that narrows tiles of rays, and tests tiles in which the function jumps branch by
/// branch.
pub struct TileTest<T: Real> {
    /// The kernel that narrows tiles.
    pub tiles: Box<dyn Kernel<ContractTiles, T>>,
    /// The function branch by branch.
    pub branches: Arc<BranchTest<T>>,
    /// The domain for which the kernels are compiled.
    pub domain: [Interval; 3],
}

impl<T: Real> Kernel<ContractTiles, T> for TileTest<T> {
    fn eval(&self, tiles: &Tiles<T>, planes: &mut Planes<T>) {
        self.tiles.eval(tiles, planes);
        let jumping = planes.possible & planes.jumping & u16::MAX >> (u16::BITS - tiles.count);
        if jumping == 0 {
            return;
        }
        let (boxes, inside) = tiles.boxes(&self.domain);
        let empty = self.branches.proven_empty(&boxes, jumping & inside) | jumping & !inside;
        planes.possible &= !empty;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Assumptions, Binding, Reference, Tape};
    use zeroset_interval::Interval;
    use zeroset_ir::{Axis, Graph};
    use zeroset_ops::Op;

    /// Unused lanes hold boxes at the origin, outside the domain: a kernel that evaluated them
    /// would panic.
    #[test]
    fn lanes_that_are_not_in_use_are_asked_no_further() {
        let mut graph = Graph::new();
        let [x, y, _] = Axis::ALL.map(|axis| graph.variable(axis));
        let root = graph.apply(Op::Sub, &[x, y]);
        let domain = [Interval { lo: 1.0, hi: 2.0 }; 3];
        let assumptions = Assumptions { domain, parameters: Vec::new() };
        let tape = Tape::<f32>::new(&graph, &[root], &assumptions);
        let kernel = || Box::new(Reference::<FindZeros>::new(tape.clone(), Binding::empty()));
        let test = ZeroTest { function: kernel(), numerator: Some(kernel()), branches: None };
        let at = |x: f64, y: f64| [x, y, 1.0].map(|c| Interval { lo: c, hi: c });
        let mut places = [at(1.0, 2.0); 9];
        places[4] = at(1.5, 1.5);
        let mut zeros = Zeros::default();
        test.eval(&Boxes::around(&places)[0], &mut zeros);
        assert_eq!(zeros.possible, 1 << 4);
    }
}
