//! Uniforms: inputs of compiled code that depend on parameters alone. With them, other parameter
//! values need no compilation.
//!
//! Code reads the parameters and the uniforms. It is valid while the parameters are within assumed
//! ranges. This module computes these inputs for the present parameters, and reports when the code
//! is not valid for them. The module depends neither on documents nor on what the code computes.

use zeroset_eval::Assumptions;
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Graph, NodeId, compact, hoist};

/// The inputs of a tape beside coordinates: the parameters, then the uniforms computed from them.
#[derive(Clone, Debug)]
pub struct Uniforms {
    /// The expressions of the uniforms.
    graph: Graph,
    nodes: Vec<NodeId>,
    /// Assumed bounds of all inputs.
    assumed: Vec<Interval>,
}

impl Uniforms {
    /// Splits the graph of `roots` into uniforms and a graph that reads them. The returned graph
    /// and roots are valid while the parameters are within `assumptions`. Without `hoisted`, there
    /// are no uniforms.
    ///
    /// # Panics
    /// If `assumptions` has no bounds for a parameter.
    pub fn split(
        graph: &Graph,
        roots: &[NodeId],
        assumptions: &Assumptions,
        hoisted: bool,
    ) -> (Self, Graph, Vec<NodeId>) {
        if !hoisted {
            let assumed = assumptions.parameters.clone();
            let uniforms = Self { graph: Graph::new(), nodes: Vec::new(), assumed };
            return (uniforms, graph.clone(), roots.to_vec());
        }
        let hoisted = hoist(graph, roots, assumptions.parameters.len() as u32);
        let nodes: Vec<NodeId> = hoisted.uniforms.iter().map(|(_, node)| *node).collect();
        let (needed, nodes) = compact(graph, &nodes);
        let all = enclose_inputs(&needed, &nodes, &assumptions.parameters);
        let assumed = all.iter().map(|(bounds, _)| *bounds).collect();
        (Self { graph: needed, nodes, assumed }, hoisted.graph, hoisted.roots)
    }

    /// Assumed bounds of all inputs: parameters, then uniforms.
    pub fn assumed(&self) -> &[Interval] {
        &self.assumed
    }

    /// The inputs of the tape for these parameter values. `None` if the tape is not valid for them:
    /// an input is outside its assumed bounds, or a uniform may be undefined. In the second case,
    /// code without uniforms can be used: the uniform may belong to an untaken branch.
    ///
    /// # Panics
    /// If a parameter has no value.
    pub fn values(&self, parameters: &[Interval]) -> Option<Vec<Interval>> {
        let holds = |((value, facts), assumed): ((Interval, Facts), &Interval)| {
            let inside = assumed.lo <= value.lo && value.hi <= assumed.hi;
            (inside && facts.has(Facts::DEFINED)).then_some(value)
        };
        let all = enclose_inputs(&self.graph, &self.nodes, parameters);
        all.into_iter().zip(&self.assumed).map(holds).collect()
    }
}

/// Bounds and facts of the parameters, and then of `nodes`.
fn enclose_inputs(
    graph: &Graph,
    nodes: &[NodeId],
    parameters: &[Interval],
) -> Vec<(Interval, Facts)> {
    let assumptions =
        Assumptions { domain: [Interval::ENTIRE; 3], parameters: parameters.to_vec() };
    let computed = zeroset_eval::enclose_all(graph, nodes, &assumptions);
    parameters.iter().map(|bounds| (*bounds, Facts::TOTAL)).chain(computed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    const fn point(value: f64) -> Interval {
        Interval { lo: value, hi: value }
    }

    /// The uniforms of a formula with one parameter r, assumed to be in [0, 4].
    fn split(formula: &str) -> Uniforms {
        let document = read(&format!("r = 2\n{formula}"), &Options::default()).expect("reads");
        let range = Interval { lo: 0.0, hi: 4.0 };
        let assumptions = Assumptions { domain: [Interval::ENTIRE; 3], parameters: vec![range] };
        Uniforms::split(&document.graph, &[document.surfaces[0].root], &assumptions, true).0
    }

    #[test]
    fn values_are_computed_from_parameters_within_what_is_assumed() {
        let uniforms = split("x*sin(r) + y");
        let values = uniforms.values(&[point(3.0)]).expect("within");
        assert!(values.len() == 2 && values[1].contains(3.0_f64.sin()), "{values:?}");
        assert!(uniforms.values(&[point(5.0)]).is_none());
        assert!(uniforms.assumed()[1].hi >= 1.0);
    }

    #[test]
    fn a_value_that_no_longer_exists_needs_other_steps() {
        let uniforms = split("x*sqrt(r-1) + y");
        assert!(uniforms.values(&[point(1.5)]).is_some());
        assert!(uniforms.values(&[point(0.5)]).is_none());
    }
}
