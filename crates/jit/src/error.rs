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
    /// The code generator failed: a defect, with its report.
    #[error("code generation failed: {0}")]
    Codegen(String),
}
