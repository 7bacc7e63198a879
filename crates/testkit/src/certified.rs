//! The certified tracer: where on a ray a function first vanishes, proven with the oracle's
//! arithmetic alone.
//!
//! It exists to contradict the traversers, so it shares no code with them, with kernels or with
//! software intervals, and it is slow. It knows no pictures and no cameras: a ray is a real line,
//! given by floats that count as exact.

mod line;
mod search;
#[cfg(test)]
mod tests;

pub use line::{Along, Line};
use search::Search;
use zeroset_ir::{Constant, Graph, NodeId};

/// What is certain of a function on the part of a line inside a box. Distances are multiples of the
/// line's direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// The pieces before the first certain crossing of which nothing could be decided, in order and
    /// apart. The function has no zero before the first of them, nor between them.
    pub unresolved: Vec<Unresolved>,
    /// The first certain crossing; `None` if there is none, and then the function has no zero after
    /// the last unresolved piece either.
    pub crossing: Option<Crossing>,
    /// How often the function was evaluated.
    pub evaluations: u32,
}

impl Certificate {
    /// Whether the function certainly has no zero.
    pub fn is_miss(&self) -> bool {
        self.unresolved.is_empty() && self.crossing.is_none()
    }

    /// A distance before which the function certainly has no zero.
    pub fn first(&self) -> f64 {
        let unresolved = self.unresolved.first().map_or(f64::INFINITY, |piece| piece.near);
        self.crossing.map_or(f64::INFINITY, |crossing| crossing.near).min(unresolved)
    }
}

/// Two distances between which the function is continuous and changes its sign, so that it has a
/// zero there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The function is not 0 here and has no zero between here and the last unresolved piece.
    pub near: f64,
    /// The function is not 0 here and has the other sign.
    pub far: f64,
    /// Whether the function is monotone in between: then there is one zero.
    pub simple: bool,
}

/// A piece of a ray on which there may be a zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unresolved {
    /// Where it starts.
    pub near: f64,
    /// Where it ends.
    pub far: f64,
    /// Why it could not be decided.
    pub reason: Reason,
}

/// Where a line comes into a box from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Bounds of the distance.
    pub distance: (f64, f64),
    /// Whether the function is below 0 there, where that is certain; a function without a value is
    /// not.
    pub below: Option<bool>,
}

/// Why a piece of a ray could not be decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Reason {
    /// The function has the same sign on both sides: it touches zero, or nearly does, or crosses it
    /// twice.
    Touching,
    /// It may jump.
    Jump,
    /// It may be undefined.
    Undefined,
    /// The ray enters or leaves the box here: the zero may lie outside.
    Edge,
    /// There was no time for more.
    Budget,
}

/// Evaluations per ray, unless the caller wants others.
pub const BUDGET: u32 = 50_000;

/// A function prepared for tracing.
#[derive(Clone, Debug)]
pub struct Function(Along);

impl Function {
    /// The function `root` of `graph`, as typed, with these values of its parameters.
    ///
    /// # Panics
    /// If `root` does not belong to `graph`, or a parameter has no value.
    pub fn new(graph: &Graph, root: NodeId, parameters: &[Constant]) -> Self {
        Self(Along::new(graph, root, parameters))
    }

    /// What is certain on `line`, from its origin on and inside the box `region` (per axis, its
    /// lower and upper end), within about `budget` evaluations.
    pub fn trace(&self, line: &Line, region: &[[f64; 2]; 3], budget: u32) -> Certificate {
        Search::new(&self.0, line, budget).run(line.clip(region))
    }

    /// Where `line` certainly comes into `region` from outside; `None` if it starts inside, misses
    /// it or may do so.
    pub fn entry(&self, line: &Line, region: &[[f64; 2]; 3]) -> Option<Entry> {
        let clip = line.clip(region)?;
        let [near, far] = [clip.outer[0], clip.inner[0]];
        let comes_in = near > 0.0 && far < clip.inner[1];
        comes_in.then(|| {
            let below = Search::new(&self.0, line, 1).is_below(near, far);
            Entry { distance: (near, far), below }
        })
    }
}
