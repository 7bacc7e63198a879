//! Tests of drivers and methods with kernels of their own.

mod late;
mod steps;
