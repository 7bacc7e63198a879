//! The certified tracer: the first zero of a function on a ray, proven by the oracle's arithmetic.
//!
//! It exists to contradict the project's tracers, so it shares no code with them, with kernels or
//! with software intervals. It is slow. A ray is a real line, given by floats that are taken as
//! exact.

mod line;
mod search;
#[cfg(test)]
mod tests;

pub use line::{FunctionOnLine, Line};
use search::Search;
use zeroset_ir::{Constant, Graph, NodeId};

/// Proof about the zeros of a function on the part of a line inside a box. Distances are multiples
/// of the line's direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Undecided pieces before the first certain crossing, in order and disjoint. The function has
    /// no zero before the first piece, nor between two pieces.
    pub unresolved: Vec<Unresolved>,
    /// The first certain crossing. If `None`, there is no zero outside the unresolved pieces.
    pub crossing: Option<Crossing>,
    /// Number of evaluations of the function.
    pub evaluations: u32,
}

impl Certificate {
    /// Whether the function certainly has no zero.
    pub fn is_miss(&self) -> bool {
        self.unresolved.is_empty() && self.crossing.is_none()
    }

    /// Returns a distance before which the function certainly has no zero.
    pub fn first(&self) -> f64 {
        let unresolved = self.unresolved.first().map_or(f64::INFINITY, |piece| piece.near);
        self.crossing.map_or(f64::INFINITY, |crossing| crossing.near).min(unresolved)
    }
}

/// Two distances. Between them the function is continuous and changes its sign, so it has a zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Lower end, where the function is not 0. No zero lies between the last unresolved piece and
    /// this end.
    pub near: f64,
    /// Upper end. Here the function is not 0 and has the other sign.
    pub far: f64,
    /// Whether the function is monotone between the ends, and so has just one zero there.
    pub simple: bool,
}

/// A piece of a ray that may contain a zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unresolved {
    /// Distance at which the piece starts.
    pub near: f64,
    /// Distance at which the piece ends.
    pub far: f64,
    /// The reason why the piece is undecided.
    pub reason: UnresolvedReason,
}

/// The place where a line enters a box from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxEntry {
    /// Bounds of the distance at which the line enters.
    pub distance: (f64, f64),
    /// Whether the function is below 0 at the entry, if that is certain. An undefined function is
    /// not below 0.
    pub below: Option<bool>,
}

/// The reason why a piece of a ray is undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum UnresolvedReason {
    /// The sign is the same on both sides: the function touches or nears zero, or crosses it twice.
    Touching,
    /// The function may jump.
    Jump,
    /// The function may be undefined.
    Undefined,
    /// The ray enters or leaves the box in this piece, so the zero may lie outside the box.
    Edge,
    /// The budget of evaluations was used up.
    Budget,
}

/// Default number of evaluations per ray.
pub const BUDGET: u32 = 50_000;

/// A function prepared for tracing.
#[derive(Clone, Debug)]
pub struct Function(FunctionOnLine);

impl Function {
    /// Prepares the function `root` of `graph`, as typed, with these values of its parameters.
    ///
    /// # Panics
    /// If `root` does not belong to `graph`, or a parameter has no value.
    pub fn new(graph: &Graph, root: NodeId, parameters: &[Constant]) -> Self {
        Self(FunctionOnLine::new(graph, root, parameters))
    }

    /// Traces the part of `line` with t ≥ 0 inside the box `region`, which has a lower and an upper
    /// end per axis. Takes about `budget` evaluations at most.
    pub fn trace(&self, line: &Line, region: &[[f64; 2]; 3], budget: u32) -> Certificate {
        Search::new(&self.0, line, budget).run(line.clip(region))
    }

    /// Returns the place where `line` certainly enters `region` from outside. `None` if the line
    /// starts inside the box, or if it is not certain that the line meets the box.
    pub fn entry(&self, line: &Line, region: &[[f64; 2]; 3]) -> Option<BoxEntry> {
        let clip = line.clip(region)?;
        let [near, far] = [clip.outer[0], clip.inner[0]];
        let comes_in = near > 0.0 && far < clip.inner[1];
        comes_in.then(|| {
            let below = Search::new(&self.0, line, 1).is_below(near, far);
            BoxEntry { distance: (near, far), below }
        })
    }
}
