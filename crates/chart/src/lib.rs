//! Measures and charts the speed and accuracy of every method of `zeroset`.
//!
//! A measurement has a surface, a view of [`views`] and a configuration of [`grid`]: a method with
//! values of its options. [`measure`] takes the times. [`errors`] compares pictures with a
//! [`mod@reference`] from the certified tracer. Times and errors make up a [`row`] of a [`store`].
//! Charts and pages are drawn from rows alone.
//!
//! Methods are known here only by their rows in [`METHODS`](zeroset_trace::METHODS).

pub mod arguments;
pub mod charts;
pub mod check;
pub mod difference;
pub mod error;
pub mod errors;
pub mod files;
pub mod grid;
pub mod groups;
pub mod machine;
pub mod measure;
pub mod page;
pub mod pareto;
pub mod parts;
pub mod plot;
pub mod progress;
pub mod quantile;
pub mod rays;
pub mod reference;
pub mod row;
pub mod run;
pub mod stability;
pub mod store;
pub mod surfaces;
pub mod truth;
pub mod views;
