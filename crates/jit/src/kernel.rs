//! Safe handles on compiled kernels.

use crate::code::Code;
use crate::compiler::compile;
use crate::error::Error;
use crate::rounding::call_rounding_up;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use zeroset_eval::{Binding, Input, Kernel, Query, Real, Tape};

/// Native code that answers a question, for any parameter values that it assumes. Clones share the
/// code; it is freed with the last of them.
#[derive(Clone)]
pub struct Compiled<Q: Query, T: Real = f32> {
    code: Arc<Code>,
    tape: Arc<Tape<T>>,
    question: PhantomData<Q>,
}

impl<Q: Query, T: Real> Compiled<Q, T> {
    /// Compiles `tape` for this processor.
    ///
    /// # Errors
    /// If the processor is not supported or the formula too large.
    ///
    /// # Panics
    /// If the tape computes another number of expressions than the question needs.
    pub fn new(tape: Tape<T>) -> Result<Self, Error> {
        Self::of_width(tape, usize::MAX)
    }

    /// As [`Compiled::new`] for vectors of so many bytes at most, as processors run it that have no
    /// wider ones: to be compared.
    ///
    /// # Errors
    /// As [`Compiled::new`].
    ///
    /// # Panics
    /// As [`Compiled::new`].
    #[cfg(feature = "comparison")]
    pub fn narrow(tape: Tape<T>, widest: usize) -> Result<Self, Error> {
        Self::of_width(tape, widest)
    }

    fn of_width(tape: Tape<T>, widest: usize) -> Result<Self, Error> {
        let code = Arc::new(compile::<Q, T>(&tape, widest)?);
        Ok(Self { code, tape: Arc::new(tape), question: PhantomData })
    }

    /// The code with values for its parameters.
    ///
    /// # Panics
    /// If the number of parameters differs, or, in debug builds, if a value is not within what the
    /// tape assumes.
    pub fn bind(&self, binding: Binding<T>) -> Native<Q, T> {
        Q::check(&self.tape, &binding);
        Native { compiled: self.clone(), binding }
    }

    /// Size of the machine code in bytes.
    pub fn code_bytes(&self) -> usize {
        self.code.bytes
    }

    /// Bytes of the vectors that it computes with.
    pub fn vector_bytes(&self) -> usize {
        self.code.width
    }
}

/// A kernel in native code.
///
/// It runs with the rounding mode set to +∞ and leaves the default one, to nearest, whatever the
/// caller had set, and no exception flags of the caller. That is what Rust code assumes everywhere;
/// who has set another mode must set it again.
#[derive(Clone)]
pub struct Native<Q: Query, T: Real = f32> {
    compiled: Compiled<Q, T>,
    binding: Binding<T>,
}

impl<Q: Query, T: Real> Native<Q, T> {
    /// Compiles `tape` for this processor and binds its parameters.
    ///
    /// # Errors
    /// If the processor is not supported or the formula too large.
    ///
    /// # Panics
    /// If the tape computes another number of expressions than the question needs, or as
    /// [`Compiled::bind`].
    pub fn new(tape: Tape<T>, binding: Binding<T>) -> Result<Self, Error> {
        Ok(Compiled::new(tape)?.bind(binding))
    }

    /// The code without its values.
    pub fn compiled(&self) -> &Compiled<Q, T> {
        &self.compiled
    }
}

impl<Q: Query, T: Real> fmt::Debug for Native<Q, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "native code for {}, {} bytes", Q::NAME, self.compiled.code_bytes())
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for Native<Q, T> {
    #[inline]
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        let Compiled { code, tape, .. } = &self.compiled;
        Q::check_input(tape, input);
        // SAFETY: the code was compiled for this question and format, and reads and writes batches
        // as the sealed trait `Batch` lays them out, at most as many lanes as were checked to be
        // there; the binding has as many parameters as the tape, checked when they were bound.
        // Batches are aligned by their type. Kernels do not unwind.
        unsafe {
            call_rounding_up(
                code.entry(),
                (&raw const *input).cast(),
                (&raw mut *output).cast(),
                input.count(),
                self.binding.quantities().as_ptr().cast(),
            );
        }
    }
}
