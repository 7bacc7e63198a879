//! Lines about the picture, such as `domain`, `view` and `color`, as data.
//!
//! Nothing here knows how a line changes a picture. `lines` picks the reader of each line, which is
//! in `scene` or `paint`. All three extend `Builder`.

pub(crate) mod lines;
pub(crate) mod paint;
pub(crate) mod scene;
