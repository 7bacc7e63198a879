//! Reads lines about the picture, such as `domain`, `view` and `color`.
//!
//! Nothing here knows how a line changes a picture. For each line, `lines` calls a function of
//! `scene` or `paint`. All three files extend `LineReader`.

pub(crate) mod lines;
pub(crate) mod paint;
pub(crate) mod scene;
