//! Tests of the library as a program that depends on it sees it: proofs against independent ones,
//! pictures against those of the command line, wrong use, and the examples.

mod errors;
mod examples;
mod functions;
mod scenes;
