//! Safe handles on compiled kernels.

use crate::code::Code;
use crate::compiler::{Kind, compile};
use crate::error::Error;
use crate::rounding::call_rounding_up;
use std::sync::Arc;
use zeroset_eval::{
    Binding, BoxPacket, EnclosurePacket, GradientKernel, GradientPacket, IntervalKernel, Lanes,
    PointKernel, PointPacket, Tape, ValuePacket,
};

/// Four lanes aligned as vector instructions want them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
struct Vector([u32; 4]);

impl Vector {
    fn from_f32(lanes: Lanes) -> Self {
        Self(lanes.map(f32::to_bits))
    }
}

/// Compiled code of one kind, without parameter values. Clones share the code; it is freed with the last of them.
#[derive(Clone)]
struct Compiled {
    code: Arc<Code>,
    parameters: usize,
}

impl Compiled {
    fn new(tape: &Tape, kind: Kind) -> Result<Self, Error> {
        Ok(Self { code: Arc::new(compile(tape, kind)?), parameters: tape.parameters() })
    }

    fn check(&self, binding: &Binding) {
        assert_eq!(self.parameters, binding.values().len(), "parameters");
    }
}

macro_rules! kernel {
    ($(#[$doc:meta])* $name:ident, $kind:expr) => {
        $(#[$doc])*
        #[derive(Clone)]
        pub struct $name {
            compiled: Compiled,
            parameters: Arc<[Vector]>,
        }

        impl $name {
            /// Compiles `tape` for this processor and binds its parameters.
            ///
            /// # Errors
            /// If the processor is not supported or the formula too large.
            ///
            /// # Panics
            /// If the tape has another number of outputs or parameters than this needs.
            pub fn compile(tape: &Tape, binding: &Binding) -> Result<Self, Error> {
                let compiled = Compiled::new(tape, $kind)?;
                compiled.check(binding);
                Ok(Self { parameters: Self::vectors(binding), compiled })
            }

            /// The same code with other parameter values. The values must lie within what the tape assumed.
            ///
            /// # Panics
            /// If the number of parameters differs.
            #[must_use]
            pub fn bind(&self, binding: &Binding) -> Self {
                self.compiled.check(binding);
                Self { parameters: Self::vectors(binding), compiled: self.compiled.clone() }
            }

            /// Size of the machine code in bytes.
            pub fn code_bytes(&self) -> usize {
                self.compiled.code.bytes
            }

            /// Runs the code over packets.
            #[inline]
            fn run<I, O>(&self, inputs: &[I], outputs: &mut [O]) {
                assert!(outputs.len() >= inputs.len(), "output shorter than input");
                // SAFETY: `I` and `O` are the packets that code of this kind reads and writes (each kernel calls
                // this in one place, below); both slices hold at least `count` of them; packets are 16-byte
                // aligned by their type, parameters by theirs, and their number was checked when they were bound.
                // Kernels do not unwind.
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

impl NativeInterval {
    fn vectors(binding: &Binding) -> Arc<[Vector]> {
        let facts = binding.limits().map(|facts| Vector([facts.bits(); 4]));
        let bounds = binding.enclosures().iter().flatten().map(|lanes| Vector::from_f32(*lanes));
        facts.into_iter().chain(bounds).collect()
    }
}

impl NativePoint {
    fn vectors(binding: &Binding) -> Arc<[Vector]> {
        binding.values().iter().map(|lanes| Vector::from_f32(*lanes)).collect()
    }
}

impl NativeGradient {
    fn vectors(binding: &Binding) -> Arc<[Vector]> {
        NativePoint::vectors(binding)
    }
}

impl IntervalKernel for NativeInterval {
    #[inline]
    fn enclose(&self, boxes: &[BoxPacket], out: &mut [EnclosurePacket]) {
        self.run(boxes, out);
    }
}

impl PointKernel for NativePoint {
    fn sample(&self, points: &[PointPacket], out: &mut [ValuePacket]) {
        self.run(points, out);
    }
}

impl GradientKernel for NativeGradient {
    fn gradient(&self, points: &[PointPacket], out: &mut [GradientPacket]) {
        self.run(points, out);
    }
}
