//! Waves of angles and quotients are rewritten before they are drawn. The rewritten functions must
//! keep the values and the zeros of the typed ones.

use super::scene::Formula;
use crate::suite::{Failure, Tally, contradiction};
use crate::{Claim, Defined, Oracle, Rng};
use zeroset_interval::Interval;
use zeroset_ir::{
    Graph, Node, NodeId, RationalForm, algebraic_angles, clear, display, rewrite, without_gaps,
};
use zeroset_ops::Op;

/// Points per formula.
const POINTS: usize = 16;

/// Checks the rewritten forms of a formula at points of its region, by the oracle. In the tally,
/// `compared` counts points and forms, and `defined` those at which both are certainly defined.
///
/// # Errors
/// The first contradiction.
pub fn check_seams(formula: &Formula, rng: &mut Rng) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let (mut graph, mut root) = (formula.document.graph.clone(), formula.document.surfaces[0].root);
    if rng.bool() {
        // As programs do.
        let domain = formula.region.map(|[lo, hi]| Interval { lo, hi });
        let Ok((rewritten, roots)) = rewrite(&graph, &[root], &domain, &[]) else {
            return Ok(tally);
        };
        (graph, root) = (rewritten, roots[0]);
    }
    let forms = Forms::of(&mut graph, root);
    let roots = forms.roots();
    if roots.is_empty() {
        return Ok(tally);
    }
    let all: Vec<NodeId> = std::iter::once(root).chain(roots).collect();
    let oracle = Oracle::new(&graph, &all);
    for _ in 0..POINTS {
        let is_simple = rng.u32(0..4) > 0;
        let point = if is_simple { formula.random_point(rng) } else { formula.point_anywhere(rng) };
        let claims = oracle.at(point, &[]);
        tally.compared += 1;
        match forms.contradiction(claims[0], &claims[1..], is_simple) {
            Ok(defined) => tally.defined += u64::from(defined),
            Err(what) => {
                let shown: Vec<String> = all
                    .iter()
                    .zip(&claims)
                    .map(|(id, claim)| format!("{}: {claim:?}", display(&graph, *id, &[])))
                    .collect();
                return Err(Failure::new(format!(
                    "{what} at {point:?}\n{}\n{formula}",
                    shown.join("\n")
                )));
            }
        }
    }
    Ok(tally)
}

/// The forms that differ from the function.
struct Forms {
    algebraic: Option<NodeId>,
    filled: Option<NodeId>,
    cleared: Option<RationalForm>,
    /// Set if the function may have a value where a part has none. Where a gap of that part is
    /// filled, the function then changes: in a closed set without interior.
    bridges: bool,
}

impl Forms {
    fn of(graph: &mut Graph, root: NodeId) -> Self {
        let other = |id: NodeId| (id != root).then_some(id);
        let needed = graph.reachable(&[root]);
        let bridges = graph
            .iter()
            .any(|(id, node)| needed[id.index()] && matches!(node, Node::Apply(Op::Otherwise, _)));
        Self {
            algebraic: other(algebraic_angles(graph, root)),
            filled: other(without_gaps(graph, root, &[])),
            cleared: clear(graph, root),
            bridges,
        }
    }

    fn roots(&self) -> Vec<NodeId> {
        let parts = self.cleared.iter().flat_map(|form| [form.numerator, form.denominator]);
        self.algebraic.into_iter().chain(self.filled).chain(parts).collect()
    }

    /// Whether all are certainly defined, if the claims on the [roots](Self::roots) agree with that
    /// on the function. A simple point may lie in a set without interior.
    fn contradiction(&self, f: Claim, claims: &[Claim], is_simple: bool) -> Result<bool, String> {
        let mut rest = claims.iter().copied();
        let mut next = |is_there: bool| rest.next().filter(|_| is_there);
        if self.algebraic.is_some()
            && let Some(is) = next(true)
            && let Some(what) = contradiction(f, is)
        {
            return Err(format!("as algebra, it is {what}"));
        }
        if self.filled.is_some()
            && let Some(is) = next(true)
            && f.defined == Defined::Yes
            && !(self.bridges && is_simple)
            && let Some(what) = contradiction(f, is)
        {
            return Err(format!("with gaps filled, it is {what}"));
        }
        if let (Some(n), Some(d)) = (next(self.cleared.is_some()), next(self.cleared.is_some()))
            && let Some(what) = cleared_wrongly(f, n, d)
        {
            return Err(format!("in rational form, {what}"));
        }
        Ok(f.defined == Defined::Yes && claims.iter().all(|claim| claim.defined == Defined::Yes))
    }
}

/// Compares a function with its numerator and denominator at one point.
fn cleared_wrongly(f: Claim, n: Claim, d: Claim) -> Option<&'static str> {
    let is_zero =
        |claim: Claim| claim.defined == Defined::Yes && claim.lo == 0.0 && claim.hi == 0.0;
    let is_nonzero =
        |claim: Claim| claim.defined == Defined::Yes && (claim.lo > 0.0 || claim.hi < 0.0);
    match f.defined {
        Defined::Yes if n.defined == Defined::No || d.defined == Defined::No => {
            Some("a part is undefined where the function is not")
        }
        Defined::Yes if is_zero(d) => Some("a pole where the function is defined"),
        Defined::Yes if is_zero(f) && is_nonzero(n) => Some("a zero is lost"),
        Defined::Yes if is_nonzero(f) && is_zero(n) => Some("a zero too many"),
        Defined::No if is_zero(n) && is_nonzero(d) => {
            Some("a zero where the function has no value")
        }
        _ => None,
    }
}
