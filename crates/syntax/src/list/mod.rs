//! Expression lists: the format of fidget and of the Prospero challenge.
//!
//! Each line of a list names one value: `_2 mul _1 _0`. Lists go straight to nodes of the graph.
//! Nothing here recurses, and nothing builds tokens or trees. So a list takes time and memory in
//! proportion to its length, however long its chains of values are.
//!
//! Nothing here knows the lines about the picture, which `document` reads.

pub(crate) mod line;
pub(crate) mod opcode;
pub(crate) mod reader;
