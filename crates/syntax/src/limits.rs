//! Limits on the size of a text. The error for a text that exceeds a limit states the limit.

/// Limits on a text, its syntax trees and its expression graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the text, in bytes.
    pub bytes: usize,
    /// Number of tokens in the text, such as numbers, names, operators and brackets.
    pub symbols: usize,
    /// Nesting depth of brackets, powers, signs and function arguments.
    pub depth: usize,
    /// Number of nodes in the expression graph, with definitions expanded.
    pub nodes: usize,
    /// Number of surfaces. Each surface is compiled separately.
    pub surfaces: usize,
}

impl Default for Limits {
    /// Ten mebibytes, a million tokens, a nesting depth of 200, 262,144 nodes, 1,000 surfaces.
    fn default() -> Self {
        Self { bytes: 10 << 20, symbols: 1_000_000, depth: 200, nodes: 1 << 18, surfaces: 1000 }
    }
}
