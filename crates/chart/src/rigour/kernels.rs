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
pub struct KernelSet {
    single: PrecisionKernels<f32>,
    double: PrecisionKernels<f64>,
}

/// The kernels in one precision, each compiled at its first use.
pub struct PrecisionKernels<T: Real> {
    tape: Tape<T>,
    arithmetic: Arithmetic,
    records: bool,
    zeros: KernelSlot<FindZeros, T>,
    bounds: KernelSlot<Enclose, T>,
    segments: KernelSlot<ContractSegments, T>,
    tiles: KernelSlot<ContractTiles, T>,
}

type KernelSlot<Q, T> = OnceLock<Result<RecordingKernel<Q, T>, KernelError>>;

/// A kernel that can record its inputs.
pub struct RecordingKernel<Q: Query, T: Real> {
    kernel: ComparisonKernel<Q, T>,
    recorded: Option<Mutex<Vec<Q::Input<T>>>>,
}

impl<Q: Query, T: Real> RecordingKernel<Q, T> {
    /// The kernel for a tracer. Unless inputs are recorded, it is the compiled kernel itself,
    /// called as zeroset calls its kernels.
    fn for_tracer(&self) -> &dyn Kernel<Q, T> {
        if self.recorded.is_some() { self } else { &self.kernel }
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for RecordingKernel<Q, T> {
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        if let Some(recorded) = &self.recorded {
            recorded.lock().unwrap_or_else(PoisonError::into_inner).push(input.clone());
        }
        self.kernel.eval(input, output);
    }
}

/// A set with a kernel for the query `Q`.
pub trait HasKernel<Q: Query, T: Real> {
    /// The kernel's slot.
    fn slot(&self) -> &KernelSlot<Q, T>;
}

/// Defines the queries that a set has kernels for, each with its slot. Methods get each kernel by
/// the slot's name.
macro_rules! has {
    ($($question:ty: $slot:ident,)*) => {
        $(impl<T: Real> HasKernel<$question, T> for PrecisionKernels<T> {
            fn slot(&self) -> &KernelSlot<$question, T> {
                &self.$slot
            }
        })*

        impl<T: Real> Kernels<T> for PrecisionKernels<T> {
            $(fn $slot(&self) -> KernelResult<'_, $question, T> {
                Ok(self.get_or_compile()?.for_tracer())
            })*

            fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
                Ok(None)
            }
        }
    };
}

has! {
    FindZeros: zeros,
    Enclose: bounds,
    ContractSegments: segments,
    ContractTiles: tiles,
}

impl<T: Real> PrecisionKernels<T> {
    fn get_or_compile<Q: Query>(&self) -> Result<&RecordingKernel<Q, T>, KernelError>
    where
        Self: HasKernel<Q, T>,
    {
        let make = || {
            let kernel =
                ComparisonKernel::new(self.tape.clone(), Binding::empty(), self.arithmetic);
            let kernel = kernel.map_err(|error| -> KernelError { std::sync::Arc::new(error) })?;
            Ok(RecordingKernel { kernel, recorded: self.records.then(Mutex::default) })
        };
        self.slot().get_or_init(make).as_ref().map_err(Clone::clone)
    }
}

impl SurfaceKernels for KernelSet {
    fn single(&self) -> &dyn Kernels<f32> {
        &self.single
    }
    fn double(&self) -> &dyn Kernels<f64> {
        &self.double
    }
}

/// A floating-point type, and the choice of a set's kernels in this type.
pub trait KernelPrecision: KernelFloat {
    /// The precision.
    const PRECISION: Precision;

    /// The set's kernels in this precision.
    fn own(set: &KernelSet) -> &PrecisionKernels<Self>;
}

impl KernelPrecision for f32 {
    const PRECISION: Precision = Precision::F32;

    fn own(set: &KernelSet) -> &PrecisionKernels<Self> {
        &set.single
    }
}

impl KernelPrecision for f64 {
    const PRECISION: Precision = Precision::F64;

    fn own(set: &KernelSet) -> &PrecisionKernels<Self> {
        &set.double
    }
}

impl KernelSet {
    /// The kernels of a program's only surface, in this arithmetic. They record their inputs if
    /// `records` is true.
    ///
    /// # Errors
    /// If the surface has parameters or poles, which need further kernels. The error is one phrase.
    pub fn new(program: &Program, arithmetic: Arithmetic, records: bool) -> Result<Self, String> {
        let has_poles = program.cleared(0).map_err(|error| error.to_string())?.is_some();
        if has_poles || !program.values().is_empty() {
            return Err("only surfaces without parameters and poles are compared".to_owned());
        }
        Ok(Self {
            single: PrecisionKernels::new(program, arithmetic, records)?,
            double: PrecisionKernels::new(program, arithmetic, records)?,
        })
    }

    /// The kernel for a query.
    ///
    /// # Errors
    /// If it cannot be compiled.
    pub fn kernel<T: KernelPrecision, Q: Query>(
        &self,
    ) -> Result<&ComparisonKernel<Q, T>, KernelError>
    where
        PrecisionKernels<T>: HasKernel<Q, T>,
    {
        Ok(&T::own(self).get_or_compile()?.kernel)
    }

    /// The inputs that the query's kernel has recorded.
    ///
    /// # Errors
    /// If the kernel cannot be compiled.
    pub fn recorded<T: KernelPrecision, Q: Query>(&self) -> Result<Vec<Q::Input<T>>, KernelError>
    where
        PrecisionKernels<T>: HasKernel<Q, T>,
    {
        let recorded = T::own(self).get_or_compile()?.recorded.as_ref();
        Ok(recorded.map_or_else(Vec::new, |recorded| {
            recorded.lock().unwrap_or_else(PoisonError::into_inner).clone()
        }))
    }
}

impl<T: KernelFloat> PrecisionKernels<T> {
    fn new(program: &Program, arithmetic: Arithmetic, records: bool) -> Result<Self, String> {
        let tape = program.tape(0, KernelSource::Function).map_err(|error| error.to_string())?;
        Ok(Self {
            tape: tape.ok_or("it has no function")?,
            arithmetic,
            records,
            zeros: KernelSlot::new(),
            bounds: KernelSlot::new(),
            segments: KernelSlot::new(),
            tiles: KernelSlot::new(),
        })
    }
}
