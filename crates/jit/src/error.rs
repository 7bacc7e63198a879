//! Why a kernel could not be made.

/// Why native code could not be made.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// This processor lacks what kernels need.
    #[error("native kernels need {0}")]
    Unsupported(&'static str),
    /// The expression has more operations than a kernel may hold.
    #[error("the formula has {operations} operations; a kernel holds at most {limit}")]
    TooLarge {
        /// Operations asked for.
        operations: usize,
        /// Operations allowed.
        limit: usize,
    },
    /// The code would be too long, or take too long to make.
    #[error("the formula needs about {instructions} instructions; a kernel holds at most {limit}")]
    TooLong {
        /// Instructions that would be emitted, before registers are allocated.
        instructions: usize,
        /// Instructions allowed.
        limit: usize,
    },
    /// The code would need too much stack for its intermediate results.
    #[error("the formula needs {bytes} bytes of stack; a kernel may use at most {limit}")]
    TooDeep {
        /// Bytes needed.
        bytes: u32,
        /// Bytes allowed.
        limit: u32,
    },
    /// The code generator failed: a defect, with its report.
    #[error("code generation failed: {0}")]
    Codegen(String),
}
