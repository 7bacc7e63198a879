//! Speed against accuracy of every method of `zeroset`, measured and charted.
//!
//! [`grid`] says what is measured: surfaces, [`views`], and each method with the options that it
//! reads. [`measure`] takes the times, [`errors`] holds pictures against a [`mod@reference`] that
//! is proven by the certified tracer, and both become a [`row`] of a [`store`]. Charts and pages
//! are made of rows alone.
//!
//! Methods are known here by their rows in [`METHODS`](zeroset_trace::METHODS) only.

pub mod arguments;
pub mod charts;
pub mod check;
pub mod difference;
pub mod error;
pub mod errors;
pub mod files;
pub mod grid;
pub mod groups;
pub mod growth;
pub mod machine;
pub mod measure;
pub mod page;
pub mod pareto;
pub mod plot;
pub mod progress;
pub mod quantile;
pub mod rays;
pub mod reference;
pub mod rigour;
pub mod row;
pub mod run;
pub mod stability;
pub mod store;
pub mod surfaces;
pub mod truth;
pub mod views;
