//! Simplification must preserve values and domains of definition.

use crate::suite::{Failure, Tally, contradiction};
use crate::{Case, Defined, Oracle, Place, Rng, minimise, pack_boxes};
use zeroset_eval::{Binding, Enclose, Kernel, Reference, Tape};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Graph, IrError, Node, NodeId, display, rewrite, simplify};
use zeroset_ops::Op;

/// Points and boxes checked on each case.
const POINTS: usize = 16;
const BOXES: usize = 4;

/// The type of [`rewrite`] and [`simplify`].
type Pass =
    fn(&Graph, &[NodeId], &[Interval; 3], &[Interval]) -> Result<(Graph, Vec<NodeId>), IrError>;

/// A function before and after the passes.
struct Versions {
    typed: (Graph, NodeId),
    rewritten: (Graph, NodeId),
    simplified: (Graph, NodeId),
}

impl Versions {
    fn of(case: &Case) -> Option<Self> {
        let bounds = &case.assumptions;
        let one = |(graph, roots): (Graph, Vec<NodeId>)| (graph, roots[0]);
        let run = |pass: Pass| {
            pass(&case.graph, &[case.root], &bounds.domain, &bounds.parameters).ok().map(one)
        };
        Some(Self {
            typed: (case.graph.clone(), case.root),
            rewritten: run(rewrite)?,
            simplified: run(simplify)?,
        })
    }
}

/// Compares a case's function with its rewritten and with its simplified form. The oracle does so
/// at points of the domain, the reference evaluator over boxes.
///
/// # Errors
/// The first contradiction, with a smaller case that still shows it.
pub fn check_simplification(case: &Case, rng: &mut Rng) -> Result<Tally, Failure> {
    let Some(versions) = Versions::of(case) else { return Ok(Tally::default()) };
    let mut tally = Tally::default();
    let oracles = Oracles::new(&versions);
    for _ in 0..POINTS {
        let region = case.random_box::<f64>(rng);
        let point = case.random_point(rng, &region);
        let values = case.random_values(rng);
        tally.compared += 1;
        match oracles.contradiction(point, &values) {
            Ok(defined) => tally.defined += u64::from(defined),
            Err(_) => {
                return Err(smaller(case, &Place::At(point), &|case| at(case, point, &values)));
            }
        }
    }
    for _ in 0..BOXES {
        let region = case.random_box::<f64>(rng);
        tally.compared += 1;
        if over(case, &region).is_some() {
            return Err(smaller(case, &Place::over(&region), &|case| over(case, &region)));
        }
    }
    Ok(tally)
}

struct Oracles<'a>([Oracle<'a>; 3]);

impl<'a> Oracles<'a> {
    fn new(versions: &'a Versions) -> Self {
        let all = [&versions.typed, &versions.rewritten, &versions.simplified];
        Self(all.map(|(graph, root)| Oracle::new(graph, &[*root])))
    }

    /// Whether all versions are certainly defined at a point. An error says how they differ.
    fn contradiction(&self, point: [f64; 3], values: &[(f64, f64)]) -> Result<bool, String> {
        let [was, rewritten, simplified] = self.0.each_ref().map(|o| o.at(point, values)[0]);
        for (is, pass) in [(rewritten, "rewritten"), (simplified, "simplified")] {
            if let Some(what) = contradiction(was, is) {
                return Err(format!("{pass}, it is {what}: {was:?} became {is:?}"));
            }
        }
        Ok([was, rewritten, simplified].iter().all(|claim| claim.defined == Defined::Yes))
    }
}

/// Returns the contradiction between versions that the oracle finds at a point.
fn at(case: &Case, point: [f64; 3], values: &[(f64, f64)]) -> Option<String> {
    let versions = Versions::of(case)?;
    Oracles::new(&versions).contradiction(point, values).err()
}

/// Returns the contradiction between versions that the reference evaluator finds over a box.
fn over(case: &Case, region: &[[f64; 2]; 3]) -> Option<String> {
    // Only constant folding shows whether a computed exponent is an integer. In the graph as typed,
    // the evaluator may take such a power for a real power, whose domain of definition is smaller.
    if has_computed_exponent(&case.graph) {
        return None;
    }
    let versions = Versions::of(case)?;
    let enclose = |(graph, root): &(Graph, NodeId)| {
        let tape = Tape::new(graph, &[*root], &case.assumptions);
        let kernel = Reference::<Enclose, _>::new(tape, Binding::new(&case.parameters));
        let answer = &kernel.eval_all(&pack_boxes(&[*region]))[0];
        (-answer.neg_lo[0], answer.hi[0], answer.facts(0))
    };
    let (was, is) = (enclose(&versions.typed), enclose(&versions.simplified));
    let defined = [was, is].map(|(.., facts)| facts.has(Facts::DEFINED));
    let nowhere = [was, is].map(|(.., facts)| facts.has(Facts::NOWHERE));
    let meet = was.0 <= is.1 && is.0 <= was.1;
    let what = if defined.contains(&true) && nowhere.contains(&true) {
        "defined throughout and nowhere"
    } else if defined.contains(&true) && !meet {
        "two enclosures that do not meet"
    } else {
        return None;
    };
    Some(format!("{what}: {was:?} became {is:?}"))
}

/// Whether some exponent is an operation on constants.
fn has_computed_exponent(graph: &Graph) -> bool {
    let mut varies = vec![false; graph.len()];
    let mut found = false;
    for (id, node) in graph.iter() {
        varies[id.index()] = match node {
            Node::Variable(_) | Node::Parameter(_) => true,
            Node::Constant(_) => false,
            Node::Apply(op, operands) => {
                if *op == Op::Pow {
                    let exponent = operands[1];
                    let computed = matches!(graph.node(exponent), Node::Apply(..));
                    found |= computed && !varies[exponent.index()];
                }
                operands.iter().any(|operand| varies[operand.index()])
            }
        };
    }
    found
}

fn smaller(case: &Case, place: &Place, wrong: &dyn Fn(&Case) -> Option<String>) -> Failure {
    let least = minimise(case, &mut |case| wrong(case).is_some());
    let what = wrong(&least).unwrap_or_default();
    let after = Versions::of(&least)
        .map(|versions| display(&versions.simplified.0, versions.simplified.1, &[]))
        .unwrap_or_default();
    Failure::new(format!("{what}\n{}\nsimplified to {after}", least.describe::<f32>(place)))
}
