//! Reads a text into a [`Document`](crate::Document): runs all stages, and decides which names are
//! parameters and what a text without formulas draws.
//!
//! This is the only folder that calls the crate `dialect`. `listed` turns expression lists into
//! documents. `parameters` and `listed` add methods to the `DocumentReader` of `reading`.

pub(crate) mod curves;
pub(crate) mod expression;
pub(crate) mod foreign_definitions;
pub(crate) mod heading;
pub(crate) mod implied_coordinates;
pub(crate) mod implied_drawing;
mod likely_slips;
mod list_marks;
pub(crate) mod listed;
pub(crate) mod other_readings;
pub(crate) mod parameters;
pub(crate) mod patches;
mod plane_curve;
mod polar_curves;
pub(crate) mod reading;
pub(crate) mod recursion;
mod solids_in_sums;
mod thin_zeros;
