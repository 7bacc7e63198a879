//! Tests of the live picture without a window.

mod cancel;
mod live_support;
mod parameters;
mod session;
mod sliders;
mod surfaces;
mod tiers;
mod undo;
