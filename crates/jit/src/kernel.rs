//! Safe handles to compiled kernels.

use crate::code::Code;
use crate::compiler::{Tier, compile, optimize};
use crate::error::Error;
use crate::rounding::call_rounding_up;
use std::fmt;
use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};
use zeroset_eval::{Binding, Input, Kernel, Query, Real, Tape};

/// Native code that answers a query. It is valid for all parameter values within the tape's
/// assumptions. Clones share the code; dropping the last clone frees it.
#[derive(Clone)]
pub struct Compiled<Q: Query, T: Real = f32> {
    code: Arc<TieredCode>,
    tape: Arc<Tape<T>>,
    query: PhantomData<Q>,
}

/// Code, and perhaps code that does the same operations in less time.
struct TieredCode {
    first: Code,
    /// The code that is used once it exists; `None` if the first is as good as any. The first is
    /// kept, since a call may be running it.
    better: OnceLock<Option<Code>>,
}

impl TieredCode {
    #[inline]
    fn best(&self) -> &Code {
        match self.better.get() {
            Some(Some(better)) => better,
            Some(None) | None => &self.first,
        }
    }
}

impl<Q: Query, T: Real> Compiled<Q, T> {
    /// Compiles `tape` for this processor.
    ///
    /// # Errors
    /// If the processor is not supported or the formula is too large.
    ///
    /// # Panics
    /// If the tape computes more or fewer expressions than the query needs.
    pub fn new(tape: Tape<T>) -> Result<Self, Error> {
        Self::of_width(tape, usize::MAX)
    }

    /// Like [`Compiled::new`], but takes half the time. The code may run up to 1.7 times as long,
    /// until [`Compiled::optimize`] has replaced it. Results have the same bits.
    ///
    /// # Errors
    /// As for [`Compiled::new`].
    ///
    /// # Panics
    /// As for [`Compiled::new`].
    pub fn quickly(tape: Tape<T>) -> Result<Self, Error> {
        match compile::<Q, T>(&tape, usize::MAX, Some(Tier::Fast)) {
            Ok(code) => Ok(Self::with(code, OnceLock::new(), tape)),
            // The other tier may do with less stack.
            Err(Error::TooDeep { .. }) => Self::new(tape),
            Err(error) => Err(error),
        }
    }

    /// Replaces code made by [`Compiled::quickly`], for all clones and all kernels bound to it.
    /// Calls that are running end with the old code.
    ///
    /// # Errors
    /// If code generation fails. Then the old code stays in use.
    pub fn optimize(&self) -> Result<(), Error> {
        if self.code.better.get().is_none() {
            let better = optimize::<Q, T>(&self.tape)?;
            // If two threads get here, the first one's code is used.
            let _ = self.code.better.set(better);
        }
        Ok(())
    }

    /// Like [`Compiled::new`], but with vectors of at most `widest` bytes. Measurements use it to
    /// imitate processors with narrower vectors.
    ///
    /// # Errors
    /// As for [`Compiled::new`].
    ///
    /// # Panics
    /// As for [`Compiled::new`].
    pub fn narrow(tape: Tape<T>, widest: usize) -> Result<Self, Error> {
        Self::of_width(tape, widest)
    }

    fn of_width(tape: Tape<T>, widest: usize) -> Result<Self, Error> {
        let code = compile::<Q, T>(&tape, widest, None)?;
        Ok(Self::with(code, OnceLock::from(None), tape))
    }

    fn with(first: Code, better: OnceLock<Option<Code>>, tape: Tape<T>) -> Self {
        let code = Arc::new(TieredCode { first, better });
        Self { code, tape: Arc::new(tape), query: PhantomData }
    }

    /// Binds values to the parameters of the code.
    ///
    /// # Panics
    /// If `binding` has more or fewer parameters than the tape, or if a parameter's value is
    /// outside the range that the tape assumes.
    pub fn bind(&self, binding: Binding<T>) -> Native<Q, T> {
        Q::check(&self.tape, &binding);
        Native { compiled: self.clone(), binding }
    }

    /// Size of the machine code in bytes.
    pub fn code_bytes(&self) -> usize {
        self.code.best().bytes
    }

    /// Width in bytes of the vectors that the code computes with.
    pub fn vector_bytes(&self) -> usize {
        self.code.best().width
    }
}

/// A kernel in native code.
///
/// A call sets the rounding mode to +∞ and ends in the default mode, to nearest. Rust code assumes
/// the default everywhere; a caller that uses another mode must set it again. The caller's
/// exception flags are lost.
#[derive(Clone)]
pub struct Native<Q: Query, T: Real = f32> {
    compiled: Compiled<Q, T>,
    binding: Binding<T>,
}

impl<Q: Query, T: Real> Native<Q, T> {
    /// Compiles `tape` for this processor and binds its parameters.
    ///
    /// # Errors
    /// If the processor is not supported or the formula is too large.
    ///
    /// # Panics
    /// If the tape computes more or fewer expressions than the query needs, or if
    /// [`Compiled::bind`] panics.
    pub fn new(tape: Tape<T>, binding: Binding<T>) -> Result<Self, Error> {
        Ok(Compiled::new(tape)?.bind(binding))
    }

    /// The compiled code, without parameter values.
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
        Q::check_input(&self.compiled.tape, input);
        self.eval_clipped(input, output);
    }

    #[inline]
    fn eval_clipped(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        let Compiled { code, tape, .. } = &self.compiled;
        Q::check_count(input);
        debug_assert!(input.is_within(&tape.assumptions().domain), "a box is not clipped");
        // SAFETY: the code was compiled for this query and format. It reads and writes batches in
        // the layout of the sealed trait `Batch`, and only as many lanes as `check_count` allows.
        // `bind` has checked that there are as many parameters as in the tape. Batches are
        // aligned by their type. Kernels do not unwind.
        unsafe {
            call_rounding_up(
                code.best().entry(),
                (&raw const *input).cast(),
                (&raw mut *output).cast(),
                input.count(),
                self.binding.quantities().as_ptr().cast(),
            );
        }
    }
}
