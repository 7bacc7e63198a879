//! Tests of the library through its public interface: proofs against independent proofs, pictures
//! against those of the command line, wrong use, and the examples.

mod errors;
mod examples;
mod functions;
mod scenes;
