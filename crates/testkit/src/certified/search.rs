//! Search for zeros on a ray: pieces are halved until each is proven empty or too small to decide.

use super::line::{Clip, FunctionOnLine, Line};
use super::{Certificate, Crossing, Unresolved, UnresolvedReason};
use crate::oracle::{BoxClaim, Defined, Oracle, Span};

/// Least length of a piece, as a share of the ray's path through the box. For a smooth function,
/// halving mostly ends earlier: rounding errors exceed the function's changes on a piece.
const SMALLEST: f64 = f64::from_bits((1023 - 44) << 52); // 2^-44

/// Greatest number of undecided pieces reported. The ray beyond them is one more piece.
const MOST_UNRESOLVED: usize = 64;

/// Greatest share of a piece that a Newton step may leave. If it leaves more, the piece is halved.
const NEWTON_LEAVES: f64 = 0.5;
/// Margin added to either end of a Newton step's result, as a share of the result's width. With it,
/// the parts that are cut off can be proven empty.
const NEWTON_MARGIN: f64 = 0.125;

/// Result of evaluating the function on a piece.
enum PieceResult {
    /// The piece contains no zero. `None` stands for a function that is undefined on the piece.
    Empty(Option<Sign>),
    /// The piece has to be cut at these distances.
    Cut(Vec<f64>),
    /// The piece is not cut further. If there is no reason, the signs on either side decide.
    Leaf(Option<UnresolvedReason>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    Negative,
    Positive,
}

/// A run of adjacent leaves.
#[derive(Clone, Copy)]
struct Cluster {
    near: f64,
    far: f64,
    before: Option<Sign>,
    reason: Option<UnresolvedReason>,
}

pub(super) struct Search<'a> {
    value: Oracle<'a>,
    both: Oracle<'a>,
    parameters: Vec<(f64, f64)>,
    remaining: u32,
    budget: u32,
    smallest: f64,
    unresolved: Vec<Unresolved>,
}

impl<'a> Search<'a> {
    pub(super) fn new(function: &'a FunctionOnLine, line: &Line, budget: u32) -> Self {
        let FunctionOnLine { graph, root, slope } = function;
        Self {
            value: Oracle::new(graph, &[*root]),
            both: Oracle::new(graph, &[*root, *slope]),
            parameters: line.parameters(),
            remaining: budget,
            budget,
            smallest: 0.0,
            unresolved: Vec::new(),
        }
    }

    pub(super) fn run(mut self, clip: Option<Clip>) -> Certificate {
        let crossing = clip.and_then(|clip| self.search(&clip));
        Certificate {
            unresolved: self.unresolved,
            crossing,
            evaluations: self.budget - self.remaining,
        }
    }

    fn search(&mut self, clip: &Clip) -> Option<Crossing> {
        let [start, end] = clip.outer;
        if !end.is_finite() {
            self.give_up(start, end);
            return None;
        }
        self.smallest = (end - start) * SMALLEST;
        let mut pieces = vec![(start, end)];
        let mut cluster: Option<Cluster> = None;
        let mut before = None;
        while let Some((near, far)) = pieces.pop() {
            if self.remaining == 0 || self.unresolved.len() >= MOST_UNRESOLVED {
                self.give_up(cluster.map_or(near, |cluster| cluster.near), end);
                return None;
            }
            match self.evaluate_piece(near, far) {
                PieceResult::Empty(sign) => {
                    let crossing = cluster.take().and_then(|c| self.decide(c, sign, clip));
                    if crossing.is_some() {
                        return crossing;
                    }
                    before = sign;
                }
                PieceResult::Cut(at) => {
                    let mut ends = vec![near];
                    ends.extend(at);
                    ends.push(far);
                    pieces.extend(ends.windows(2).rev().map(|ends| (ends[0], ends[1])));
                }
                PieceResult::Leaf(reason) => {
                    let open = cluster.get_or_insert(Cluster { near, far, before, reason });
                    open.far = far;
                    open.reason = open.reason.max(reason);
                }
            }
        }
        cluster.and_then(|cluster| self.decide(cluster, None, clip))
    }

    fn give_up(&mut self, near: f64, far: f64) {
        self.unresolved.push(Unresolved { near, far, reason: UnresolvedReason::Budget });
    }

    /// Returns the crossing if the function changes its sign over `cluster`. Otherwise reports the
    /// cluster as unresolved.
    ///
    /// If the cluster has no reason, the function has a value at either end. That end is also the
    /// end of an empty piece, so the value has the sign of that piece.
    fn decide(&mut self, cluster: Cluster, after: Option<Sign>, clip: &Clip) -> Option<Crossing> {
        let Cluster { near, far, before, reason } = cluster;
        let inside = clip.inner[0] <= near && far <= clip.inner[1];
        let reason = match (reason, before, after) {
            (Some(reason), ..) => reason,
            (None, Some(before), Some(after)) if before == after => UnresolvedReason::Touching,
            (None, Some(_), Some(_)) if inside => {
                let [_, slope] = self.slope(near, far);
                let simple = slope.values.defined == Defined::Yes && !span(&slope).has_zero();
                return Some(Crossing { near, far, simple });
            }
            (None, ..) => UnresolvedReason::Edge,
        };
        self.unresolved.push(Unresolved { near, far, reason });
        None
    }

    fn evaluate_piece(&mut self, near: f64, far: f64) -> PieceResult {
        let natural = self.value(near, far);
        if natural.values.defined == Defined::No {
            return PieceResult::Empty(None);
        }
        if let Some(sign) = sign(span(&natural)) {
            return PieceResult::Empty(Some(sign));
        }
        let middle = near + (far - near) / 2.0;
        let small = far - near <= self.smallest || middle <= near || far <= middle;
        if !natural.continuous {
            let reason = if natural.values.defined == Defined::Yes {
                UnresolvedReason::Jump
            } else {
                UnresolvedReason::Undefined
            };
            return if small {
                PieceResult::Leaf(Some(reason))
            } else {
                PieceResult::Cut(vec![middle])
            };
        }
        let [_, slope] = self.slope(near, far);
        let usable = slope.values.defined == Defined::Yes && span(&slope).is_bounded();
        if !usable {
            return if small { PieceResult::Leaf(None) } else { PieceResult::Cut(vec![middle]) };
        }
        // The mean value theorem: f(t) lies in f(m) + F'·(t − m), for bounds F' of the slope.
        let slope = span(&slope);
        let (from, at_middle) = (Span::point(middle), span(&self.value(middle, middle)));
        let change = slope.mul(Span::new(near, far).sub(from));
        let mean = at_middle.add(change);
        if let Some(sign) = sign(mean) {
            return PieceResult::Empty(Some(sign));
        }
        let noise = at_middle.hi - at_middle.lo;
        if small || change.hi.max(-change.lo) <= noise {
            return PieceResult::Leaf(None);
        }
        PieceResult::Cut(newton(near, far, middle, at_middle, slope).unwrap_or(vec![middle]))
    }

    /// Whether the function is below 0 between two distances. `None` if that is not certain.
    pub(super) fn is_below(&mut self, near: f64, far: f64) -> Option<bool> {
        let claim = self.value(near, far).values;
        match claim.defined {
            Defined::No => Some(false),
            _ if claim.lo > 0.0 => Some(false),
            Defined::Yes if claim.hi < 0.0 => Some(true),
            Defined::Yes | Defined::Unknown => None,
        }
    }

    fn value(&mut self, near: f64, far: f64) -> BoxClaim {
        self.remaining = self.remaining.saturating_sub(1);
        self.value.over([(near, far), (0.0, 0.0), (0.0, 0.0)], &self.parameters)[0]
    }

    fn slope(&mut self, near: f64, far: f64) -> [BoxClaim; 2] {
        self.remaining = self.remaining.saturating_sub(1);
        let claims = self.both.over([(near, far), (0.0, 0.0), (0.0, 0.0)], &self.parameters);
        [claims[0], claims[1]]
    }
}

/// Returns cuts around the zeros of a piece by a Newton step. `None` if they cut off too little.
fn newton(near: f64, far: f64, middle: f64, value: Span, slope: Span) -> Option<Vec<f64>> {
    if slope.has_zero() {
        return None;
    }
    let zeros = Span::point(middle).sub(value.div(slope));
    let margin = (zeros.hi - zeros.lo) * NEWTON_MARGIN;
    let (lo, hi) = (zeros.lo - margin, zeros.hi + margin);
    let worth = hi.min(far) - lo.max(near) < (far - near) * NEWTON_LEAVES;
    let cuts: Vec<f64> = [lo, hi].into_iter().filter(|cut| near < *cut && *cut < far).collect();
    (worth && !cuts.is_empty()).then_some(cuts)
}

fn span(claim: &BoxClaim) -> Span {
    Span::new(claim.values.lo, claim.values.hi)
}

fn sign(values: Span) -> Option<Sign> {
    if values.hi < 0.0 {
        Some(Sign::Negative)
    } else if values.lo > 0.0 {
        Some(Sign::Positive)
    } else {
        None
    }
}
