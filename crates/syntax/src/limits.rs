//! How much text is read. Every limit has an error that states it.

/// Bounds on what a text may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of text.
    pub bytes: usize,
    /// Numbers, names, signs and brackets of the text.
    pub symbols: usize,
    /// Brackets, powers, signs and function arguments inside one another.
    pub depth: usize,
    /// Nodes of the expression graph, with definitions expanded.
    pub nodes: usize,
    /// Surfaces that are drawn: each has code of its own.
    pub surfaces: usize,
}

impl Default for Limits {
    /// One mebibyte, 100,000 symbols, 200 levels, 65,536 nodes, 1,000 surfaces.
    fn default() -> Self {
        Self { bytes: 1 << 20, symbols: 100_000, depth: 200, nodes: 1 << 16, surfaces: 1000 }
    }
}
