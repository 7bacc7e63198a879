//! The kernels of a surface in one arithmetic, which can record their inputs.

use std::sync::{Mutex, OnceLock, PoisonError};
use zeroset_eval::{
    Binding, ContractSegments, ContractTiles, Enclose, FindZeros, Kernel, KernelError, KernelFloat,
    KernelResult, Kernels, Query, Real, SurfaceKernels, Tape,
};
use zeroset_jit::comparison::{Arithmetic, ComparisonKernel};
use zeroset_scene::program::{KernelSource, Program};
use zeroset_trace::Precision;

/// The kernels of a surface without parameters and poles, in both precisions.
pub struct Set {
    single: Own<f32>,
    double: Own<f64>,
}

/// The kernels in one precision, each compiled at its first use.
pub struct Own<T: Real> {
    tape: Tape<T>,
    arithmetic: Arithmetic,
    keeps: bool,
    zeros: Slot<FindZeros, T>,
    bounds: Slot<Enclose, T>,
    segments: Slot<ContractSegments, T>,
    tiles: Slot<ContractTiles, T>,
}

type Slot<Q, T> = OnceLock<Result<Watched<Q, T>, KernelError>>;

/// A kernel, with its recorded inputs if it records them.
pub struct Watched<Q: Query, T: Real> {
    kernel: ComparisonKernel<Q, T>,
    seen: Option<Mutex<Vec<Q::Input<T>>>>,
}

impl<Q: Query, T: Real> Watched<Q, T> {
    /// The kernel for a tracer. It is the compiled kernel itself, called like the product's, unless
    /// inputs are recorded.
    fn asked(&self) -> &dyn Kernel<Q, T> {
        if self.seen.is_some() { self } else { &self.kernel }
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for Watched<Q, T> {
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        if let Some(seen) = &self.seen {
            seen.lock().unwrap_or_else(PoisonError::into_inner).push(input.clone());
        }
        self.kernel.eval(input, output);
    }
}

/// A query that a set has a kernel for.
pub trait Has<Q: Query, T: Real> {
    /// The kernel's slot.
    fn slot(&self) -> &Slot<Q, T>;
}

macro_rules! has {
    ($($question:ty: $slot:ident,)*) => {
        $(impl<T: Real> Has<$question, T> for Own<T> {
            fn slot(&self) -> &Slot<$question, T> {
                &self.$slot
            }
        })*
    };
}

has! {
    FindZeros: zeros,
    Enclose: bounds,
    ContractSegments: segments,
    ContractTiles: tiles,
}

impl<T: Real> Own<T> {
    fn watched<Q: Query>(&self) -> Result<&Watched<Q, T>, KernelError>
    where
        Self: Has<Q, T>,
    {
        let make = || {
            let kernel = ComparisonKernel::new(self.tape.clone(), Binding::empty(), self.arithmetic);
            let kernel = kernel.map_err(|error| -> KernelError { std::sync::Arc::new(error) })?;
            Ok(Watched { kernel, seen: self.keeps.then(Mutex::default) })
        };
        self.slot().get_or_init(make).as_ref().map_err(Clone::clone)
    }
}

impl<T: Real> Kernels<T> for Own<T> {
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        Ok(self.watched()?.asked())
    }
    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        Ok(self.watched()?.asked())
    }
    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }
    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        Ok(self.watched()?.asked())
    }
    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        Ok(self.watched()?.asked())
    }
}

impl SurfaceKernels for Set {
    fn single(&self) -> &dyn Kernels<f32> {
        &self.single
    }
    fn double(&self) -> &dyn Kernels<f64> {
        &self.double
    }
}

/// A precision, as a type that selects a set's kernels.
pub trait Float: KernelFloat {
    /// The precision.
    const PRECISION: Precision;

    /// The set's kernels in this precision.
    fn own(set: &Set) -> &Own<Self>;
}

impl Float for f32 {
    const PRECISION: Precision = Precision::F32;

    fn own(set: &Set) -> &Own<Self> {
        &set.single
    }
}

impl Float for f64 {
    const PRECISION: Precision = Precision::F64;

    fn own(set: &Set) -> &Own<Self> {
        &set.double
    }
}

impl Set {
    /// The kernels of a program's only surface, in this arithmetic; they record inputs if it
    /// `keeps` them.
    ///
    /// # Errors
    /// One phrase, if the surface has parameters or poles, which need further kernels.
    pub fn new(program: &Program, arithmetic: Arithmetic, keeps: bool) -> Result<Self, String> {
        let has_poles = program.cleared(0).map_err(|error| error.to_string())?.is_some();
        if has_poles || !program.values().is_empty() {
            return Err("only surfaces without parameters and poles are compared".to_owned());
        }
        Ok(Self {
            single: Own::new(program, arithmetic, keeps)?,
            double: Own::new(program, arithmetic, keeps)?,
        })
    }

    /// The kernel for a query.
    ///
    /// # Errors
    /// If it cannot be compiled.
    pub fn kernel<T: Float, Q: Query>(&self) -> Result<&ComparisonKernel<Q, T>, KernelError>
    where
        Own<T>: Has<Q, T>,
    {
        Ok(&T::own(self).watched()?.kernel)
    }

    /// The inputs that the query's kernel has recorded.
    ///
    /// # Errors
    /// If the kernel cannot be compiled.
    pub fn seen<T: Float, Q: Query>(&self) -> Result<Vec<Q::Input<T>>, KernelError>
    where
        Own<T>: Has<Q, T>,
    {
        let seen = T::own(self).watched()?.seen.as_ref();
        Ok(seen.map_or_else(Vec::new, |seen| {
            seen.lock().unwrap_or_else(PoisonError::into_inner).clone()
        }))
    }
}

impl<T: KernelFloat> Own<T> {
    fn new(program: &Program, arithmetic: Arithmetic, keeps: bool) -> Result<Self, String> {
        let tape = program.tape(0, KernelSource::Function).map_err(|error| error.to_string())?;
        Ok(Self {
            tape: tape.ok_or("it has no function")?,
            arithmetic,
            keeps,
            zeros: Slot::new(),
            bounds: Slot::new(),
            segments: Slot::new(),
            tiles: Slot::new(),
        })
    }
}
