//! Errors of compiling a kernel.

/// The reason why native code could not be compiled.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// This processor lacks a feature that kernels need, or a frame would be too large.
    #[error("native kernels need {0}")]
    Unsupported(&'static str),
    /// The expression has more operations than a kernel may hold.
    #[error("the formula has {operations} operations; a kernel holds at most {limit}")]
    TooLarge {
        /// Number of operations in the expression.
        operations: usize,
        /// Largest number of operations allowed.
        limit: usize,
    },
    /// The code would be too long, or take too long to compile.
    #[error("the formula needs about {instructions} instructions; a kernel holds at most {limit}")]
    TooLong {
        /// Number of instructions before register allocation.
        instructions: usize,
        /// Largest number of instructions allowed.
        limit: usize,
    },
    /// The intermediate results would need too much stack.
    #[error("the formula needs {bytes} bytes of stack; a kernel may use at most {limit}")]
    TooDeep {
        /// Bytes of stack needed.
        bytes: u32,
        /// Largest number of bytes allowed.
        limit: u32,
    },
    /// The code generator failed with this report. Such a failure is always a defect.
    #[error("code generation failed: {0}")]
    Codegen(String),
}

impl Error {
    /// Returns whether the formula is too large for a kernel.
    pub fn is_of_size(&self) -> bool {
        matches!(self, Self::TooLarge { .. } | Self::TooLong { .. } | Self::TooDeep { .. })
    }
}
