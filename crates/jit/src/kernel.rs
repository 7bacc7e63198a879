//! Safe handles on compiled kernels.

use crate::code::Code;
use crate::compiler::{Kind, compile};
use crate::error::Error;
use crate::rounding::call_rounding_up;
use std::marker::PhantomData;
use std::sync::Arc;
use zeroset_eval::{
    Binding, BoxPacket, EnclosurePacket, GradientKernel, GradientPacket, IntervalKernel,
    PointKernel, PointPacket, Real, Tape, ValuePacket,
};

/// The bits of a vector, aligned as vector instructions want it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
struct Vector(u128);

/// Compiled code of one kind, without parameter values. Clones share the code; it is freed with the last of them.
#[derive(Clone)]
struct Compiled {
    code: Arc<Code>,
    parameters: usize,
}

impl Compiled {
    fn new<T: Real>(tape: &Tape<T>, kind: Kind) -> Result<Self, Error> {
        Ok(Self { code: Arc::new(compile(tape, kind)?), parameters: tape.parameters() })
    }

    fn check<T: Real>(&self, binding: &Binding<T>) {
        assert_eq!(self.parameters, binding.values().len(), "parameters");
    }
}

macro_rules! kernel {
    ($(#[$doc:meta])* $name:ident, $kind:expr) => {
        $(#[$doc])*
        #[derive(Clone)]
        pub struct $name<T: Real = f32> {
            compiled: Compiled,
            parameters: Arc<[Vector]>,
            format: PhantomData<T>,
        }

        impl<T: Real> $name<T> {
            /// Compiles `tape` for this processor and binds its parameters.
            ///
            /// # Errors
            /// If the processor is not supported or the formula too large.
            ///
            /// # Panics
            /// If the tape has another number of outputs or parameters than this needs.
            pub fn compile(tape: &Tape<T>, binding: &Binding<T>) -> Result<Self, Error> {
                let compiled = Compiled::new(tape, $kind)?;
                compiled.check(binding);
                Ok(Self::new(compiled, binding))
            }

            /// The same code with other parameter values. The values must lie within what the tape assumed.
            ///
            /// # Panics
            /// If the number of parameters differs.
            #[must_use]
            pub fn bind(&self, binding: &Binding<T>) -> Self {
                self.compiled.check(binding);
                Self::new(self.compiled.clone(), binding)
            }

            fn new(compiled: Compiled, binding: &Binding<T>) -> Self {
                Self { parameters: Self::vectors(binding), compiled, format: PhantomData }
            }

            /// Whether both run the same code, compiled once.
            pub fn shares_code(&self, other: &Self) -> bool {
                Arc::ptr_eq(&self.compiled.code, &other.compiled.code)
            }

            /// Size of the machine code in bytes.
            pub fn code_bytes(&self) -> usize {
                self.compiled.code.bytes
            }

            /// Runs the code over packets.
            #[inline]
            fn run<I, O>(&self, inputs: &[I], outputs: &mut [O]) {
                assert!(outputs.len() >= inputs.len(), "output shorter than input");
                // SAFETY: `I` and `O` are the packets that code of this kind and format reads and writes: each kernel
                // calls this in one place, below, and holds code of a tape in its own `T`. Both slices hold at least
                // `count` of them. Packets are 16-byte aligned by their type, parameters by theirs, and their number
                // was checked when they were bound. Kernels do not unwind.
                unsafe {
                    call_rounding_up(
                        self.compiled.code.entry(),
                        inputs.as_ptr().cast(),
                        outputs.as_mut_ptr().cast(),
                        inputs.len(),
                        self.parameters.as_ptr().cast(),
                        self.compiled.code.constants(),
                    );
                }
            }
        }
    };
}

kernel! {
    /// Encloses a function over boxes, in native code.
    NativeInterval, Kind::Interval
}
kernel! {
    /// Samples a function at points, in native code.
    NativePoint, Kind::Point
}
kernel! {
    /// Samples a function and its gradient, in native code. The tape's outputs are the value and the three derivatives.
    NativeGradient, Kind::Gradient
}

impl<T: Real> NativeInterval<T> {
    fn vectors(binding: &Binding<T>) -> Arc<[Vector]> {
        let facts = binding.limits().map(|facts| Vector(T::splat_facts(facts)));
        let bounds = binding.enclosures().iter().flatten().map(|end| Vector(end.splat()));
        facts.into_iter().chain(bounds).collect()
    }
}

impl<T: Real> NativePoint<T> {
    fn vectors(binding: &Binding<T>) -> Arc<[Vector]> {
        binding.values().iter().map(|value| Vector(value.splat())).collect()
    }
}

impl<T: Real> NativeGradient<T> {
    fn vectors(binding: &Binding<T>) -> Arc<[Vector]> {
        NativePoint::vectors(binding)
    }
}

impl<T: Real> IntervalKernel<T> for NativeInterval<T> {
    #[inline]
    fn enclose(&self, boxes: &[BoxPacket<T>], out: &mut [EnclosurePacket<T>]) {
        self.run(boxes, out);
    }
}

impl<T: Real> PointKernel<T> for NativePoint<T> {
    fn sample(&self, points: &[PointPacket<T>], out: &mut [ValuePacket<T>]) {
        self.run(points, out);
    }
}

impl<T: Real> GradientKernel<T> for NativeGradient<T> {
    fn gradient(&self, points: &[PointPacket<T>], out: &mut [GradientPacket<T>]) {
        self.run(points, out);
    }
}
