//! Drivers and methods over kernels of the tests' own.

mod late;
mod steps;
