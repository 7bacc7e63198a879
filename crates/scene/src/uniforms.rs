//! How code is given other parameter values without being compiled again.
//!
//! Code reads parameters, and values computed from parameters alone. It holds for parameters within
//! assumed ranges; this computes what it reads from the parameters' present values, and tells when
//! the code does not hold for them. Knows neither documents nor what the code computes.

use crate::enclosure;
use zeroset_eval::Assumptions;
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Graph, NodeId, compact, hoist};

/// What some steps read beside coordinates: the parameters, then values computed from them.
#[derive(Clone, Debug)]
pub struct Uniforms {
    /// The expressions computed beforehand.
    graph: Graph,
    nodes: Vec<NodeId>,
    /// Bounds of all that the steps read, as assumed.
    assumed: Vec<Interval>,
}

impl Uniforms {
    /// Splits `roots` into what is computed beforehand from parameters and a graph with what is
    /// left to the steps; all is left to them unless `hoisted`. The steps hold wherever the
    /// parameters are within `assumptions`.
    ///
    /// # Panics
    /// If a parameter has no assumption.
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
        let all = known(&needed, &nodes, &assumptions.parameters);
        let assumed = all.iter().map(|(bounds, _)| *bounds).collect();
        (Self { graph: needed, nodes, assumed }, hoisted.graph, hoisted.roots)
    }

    /// Bounds of all that the steps read, as assumed.
    pub fn assumed(&self) -> &[Interval] {
        &self.assumed
    }

    /// All that the steps read when the parameters have these values, or `None` if the steps do not
    /// hold for them: where one is beyond what was assumed, or what is computed beforehand may be
    /// undefined. A choice between branches need not reach that, so it must stay where it is.
    ///
    /// # Panics
    /// If a parameter has no value.
    pub fn values(&self, parameters: &[Interval]) -> Option<Vec<Interval>> {
        let holds = |((value, facts), assumed): ((Interval, Facts), &Interval)| {
            let inside = assumed.lo <= value.lo && value.hi <= assumed.hi;
            (inside && facts.has(Facts::DEFINED)).then_some(value)
        };
        let all = known(&self.graph, &self.nodes, parameters);
        all.into_iter().zip(&self.assumed).map(holds).collect()
    }
}

/// What is known of the parameters, and then of `nodes`.
fn known(graph: &Graph, nodes: &[NodeId], parameters: &[Interval]) -> Vec<(Interval, Facts)> {
    let assumptions =
        Assumptions { domain: [Interval::ENTIRE; 3], parameters: parameters.to_vec() };
    let computed = enclosure::enclose_all(graph, nodes, &assumptions);
    parameters.iter().map(|bounds| (*bounds, Facts::TOTAL)).chain(computed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    const fn point(value: f64) -> Interval {
        Interval { lo: value, hi: value }
    }

    /// What the steps of a formula with one parameter r read when made for r in [0, 4].
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
