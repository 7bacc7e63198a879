//! Lines about the picture, such as `domain`, `view` and `color`, as data.
//!
//! Nothing here knows what a line changes in a picture. `lines` picks the reader of each line;
//! `scene` and `paint` have them. All three extend `Builder`.

pub(crate) mod lines;
pub(crate) mod paint;
pub(crate) mod scene;
