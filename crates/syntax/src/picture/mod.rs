//! Reads lines about the picture, such as `domain`, `view` and `color`.
//!
//! Nothing here knows how a line changes a picture. For each line, `lines` calls a method of
//! `LineReader`, which `scene` and `paint` extend.

pub(crate) mod line_reader;
pub(crate) mod lines;
pub(crate) mod paint;
pub(crate) mod scene;
