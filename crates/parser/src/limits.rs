//! Limits on the size of a text. The error for a text that exceeds a limit states the limit.

/// Limits on a text, its syntax trees and its expression graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the text, in bytes.
    pub bytes: usize,
    /// Number of tokens in the text, such as numbers, names, operators and brackets.
    pub symbols: usize,
    /// Nesting depth of brackets, powers, signs and function arguments in the text. Definitions
    /// that use one another do not count.
    pub depth: usize,
    /// Number of nodes in the expression graph, with definitions expanded. A short text has a lower
    /// limit: see [`Limits::nodes_for`].
    pub nodes: usize,
    /// Number of surfaces.
    pub surfaces: usize,
    /// Number of curves and points.
    pub curves: usize,
}

impl Limits {
    /// Largest number of nodes for a text of this many bytes: eight for each byte, at least
    /// 262,144, at most [`Limits::nodes`]. So a short text whose sums and functions expand without
    /// end is refused within a second.
    pub fn nodes_for(&self, bytes: usize) -> usize {
        self.nodes.min(bytes.saturating_mul(8).max(1 << 18))
    }
}

impl Default for Limits {
    /// 64 mebibytes, eight million tokens, a nesting depth of 200, three million nodes, 10,000
    /// surfaces, 10,000 curves and points.
    fn default() -> Self {
        let nodes = zeroset_ir::NODE_LIMIT;
        Self {
            bytes: 64 << 20,
            symbols: 8_000_000,
            depth: 200,
            nodes,
            surfaces: 10_000,
            curves: 10_000,
        }
    }
}
