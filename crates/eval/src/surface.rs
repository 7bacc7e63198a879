//! One function as a method sees it: the kernels that answer for it.

use crate::batch::{Boxes, Zeros};
use crate::query::{
    ContractSegments, ContractTiles, Enclose, EncloseGradient, FindZeros, Kernel, Sample,
    SampleGradient,
};
use crate::real::Real;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

/// Why a kernel cannot be had.
pub type KernelError = Arc<dyn Error + Send + Sync>;

/// A kernel, or why there is none.
pub type KernelResult<'a, Q, T> = Result<&'a dyn Kernel<Q, T>, KernelError>;

/// What may be asked of one function, in either precision.
///
/// A kernel is made when it is first asked for, so only what a picture needs should be. What an
/// implementation leaves out is not answered.
pub trait SurfaceKernels: Sync {
    /// Kernels that compute in `f32`.
    fn single(&self) -> &dyn Kernels<f32> {
        &NoKernel
    }
    /// Kernels that compute in `f64`.
    fn double(&self) -> &dyn Kernels<f64> {
        &NoKernel
    }
}

/// The kernels of one function in one precision; each may be impossible to make, for a reason that
/// is told.
#[allow(clippy::missing_errors_doc, reason = "the same for each, and said above")]
pub trait Kernels<T: Real>: Sync {
    /// May a box hold a zero?
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        Err(Arc::new(NoKernel))
    }
    /// Bounds of the function.
    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        Err(Arc::new(NoKernel))
    }
    /// Bounds of the numerator and of the denominator of the function's cleared form, if it has
    /// one: where the function is defined, it vanishes where the numerator does and the denominator
    /// does not, and it has its poles where the denominator vanishes.
    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Err(Arc::new(NoKernel))
    }
    /// Contractions of segments of rays: of the numerator of the function's cleared form, if it has
    /// one, else of the function.
    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        Err(Arc::new(NoKernel))
    }
    /// Contractions of tiles of rays, of the same function as [`Kernels::segments`].
    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        Err(Arc::new(NoKernel))
    }
    /// Bounds of function and gradient.
    fn gradient_bounds(&self) -> KernelResult<'_, EncloseGradient, T> {
        Err(Arc::new(NoKernel))
    }
    /// Samples of the function.
    fn values(&self) -> KernelResult<'_, Sample, T> {
        Err(Arc::new(NoKernel))
    }
    /// Samples of function and gradient.
    fn gradients(&self) -> KernelResult<'_, SampleGradient, T> {
        Err(Arc::new(NoKernel))
    }
}

/// A float type by which a surface's kernels are picked.
pub trait KernelFloat: Real {
    /// The kernels of a surface that compute in this type.
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

/// Why there is no answer: the surface has no kernel for the question.
#[derive(Clone, Copy, Debug)]
struct NoKernel;

impl fmt::Display for NoKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("this surface has no kernel for this question")
    }
}

impl Error for NoKernel {}
impl<T: Real> Kernels<T> for NoKernel {}

/// Where a function may vanish, by up to three forms of it, each asked only where the one before
/// leaves lanes open.
pub struct ZeroTest<T: Real> {
    /// The function.
    pub function: Box<dyn Kernel<FindZeros, T>>,
    /// The numerator of its cleared form, which vanishes at the same points of the function's
    /// domain: poles are proven empty by it, and a root near a pole has bounds.
    pub numerator: Option<Box<dyn Kernel<FindZeros, T>>>,
    /// The function branch by branch ([`Tape::branches`](crate::Tape::branches)), asked where it
    /// may jump.
    pub branches: Option<Box<dyn Kernel<FindZeros, T>>>,
}

impl<T: Real> Kernel<FindZeros, T> for ZeroTest<T> {
    #[inline]
    fn eval(&self, boxes: &Boxes<T>, zeros: &mut Zeros) {
        self.function.eval(boxes, zeros);
        // What a kernel leaves in lanes that are not in use has no meaning, and is asked no
        // further.
        zeros.possible &= u16::MAX >> (u16::BITS - boxes.count);
        if let Some(numerator) = &self.numerator
            && zeros.possible != 0
        {
            let cleared = ask_some(&**numerator, boxes, zeros.possible);
            zeros.possible &= cleared.possible;
            zeros.unbounded &= cleared.unbounded;
        }
        if let Some(branches) = &self.branches
            && zeros.possible & zeros.jumping != 0
        {
            let together = ask_some(&**branches, boxes, zeros.possible & zeros.jumping);
            zeros.possible &= together.possible | !zeros.jumping;
        }
    }
}

/// Asks about some lanes of a batch: gathered, if that leaves at most half of it. Of other lanes
/// nothing is known.
fn ask_some<T: Real>(kernel: &dyn Kernel<FindZeros, T>, boxes: &Boxes<T>, lanes: u16) -> Zeros {
    let mut zeros = Zeros::default();
    if 2 * lanes.count_ones() > boxes.count {
        kernel.eval(boxes, &mut zeros);
        return zeros;
    }
    kernel.eval(&boxes.gathered(lanes), &mut zeros);
    let mut spread = Zeros::default();
    for (from, lane) in (0..u16::BITS).filter(|lane| lanes >> lane & 1 == 1).enumerate() {
        spread.possible |= (zeros.possible >> from & 1) << lane;
        spread.unbounded |= (zeros.unbounded >> from & 1) << lane;
        spread.jumping |= (zeros.jumping >> from & 1) << lane;
    }
    spread
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Assumptions, Binding, Reference, Tape};
    use zeroset_interval::Interval;
    use zeroset_ir::{Axis, Graph};
    use zeroset_ops::Op;

    /// Lanes not in use hold zeros here, which are out of the domain: asking about them would be
    /// refused.
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
