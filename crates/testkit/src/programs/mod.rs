//! Random programs of other languages, and a comparison of values with other interpreters.
//!
//! A program is one function of a point. Its statements have side effects in every place where the
//! language allows them, in a defined order. A file of programs holds their values, too, once an
//! interpreter of the language has computed them.

mod glsl;
mod openscad;
mod python;
mod records;

pub use records::{Outcome, ProgramRecord, compare, read_records, write_records};

use crate::random::Rng;

/// A language of programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Shaders of OpenGL.
    Glsl,
    /// Python 3.
    Python,
    /// `OpenSCAD`.
    OpenScad,
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 3] = [Self::Glsl, Self::Python, Self::OpenScad];

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Glsl => "glsl",
            Self::Python => "python",
            Self::OpenScad => "openscad",
        }
    }

    /// Returns a random program in this language.
    pub fn program(self, rng: &mut Rng) -> String {
        match self {
            Self::Glsl => glsl::program(rng),
            Self::Python => python::program(rng),
            Self::OpenScad => openscad::program(rng),
        }
    }
}

/// Returns one of `all`.
fn pick<T: Clone>(rng: &mut Rng, all: &[T]) -> T {
    all[rng.u32(0..all.len() as u32) as usize].clone()
}

/// Returns true once in `count` times.
fn once_in(rng: &mut Rng, count: u32) -> bool {
    rng.u32(0..count) == 0
}
