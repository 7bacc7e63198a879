//! Tests that call the library: its public interface, live pictures, and pictures of all kinds.
//! They are one program, since linking it takes longer than most of them.

#[path = "../library/mod.rs"]
mod library;
#[path = "../live/mod.rs"]
mod live;
#[path = "../pictures/mod.rs"]
mod pictures;
#[path = "../surroundings/mod.rs"]
mod surroundings;
