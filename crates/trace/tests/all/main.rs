//! Tests of the driver and of methods, with kernels written for these tests.

mod late;
mod steps;
mod unseen;
