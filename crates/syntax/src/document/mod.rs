//! Reads a text into a [`Document`](crate::Document). This runs all stages. It also decides which
//! names are parameters, and what a text without formulas draws.
//!
//! This is the only folder that calls `dialect`. `parameters` extends the `DocumentReader` of
//! `reading`, which calls it as one of its steps.

pub(crate) mod heading;
pub(crate) mod implied_coordinates;
pub(crate) mod implied_drawing;
pub(crate) mod parameters;
pub(crate) mod reading;
pub(crate) mod recursion;
