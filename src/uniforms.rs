//! How code is given other parameter values without being compiled again.
//!
//! Code reads parameters, and values computed from parameters alone. It holds for parameters within assumed ranges; this
//! computes what it reads from the parameters' present values, and tells when the code does not hold for them. Knows
//! neither documents nor what the code computes.

use crate::enclosure;
use zeroset_eval::{Assumptions, Binding, Real};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Graph, NodeId, compact, hoist};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};

/// What some steps read beside coordinates: the parameters, then values computed from them.
#[derive(Clone, Debug)]
pub struct Uniforms {
    /// The expressions computed beforehand.
    graph: Graph,
    nodes: Vec<NodeId>,
    /// Whether the steps read their values, or compute them.
    hoisted: bool,
    /// Bounds of all that the steps read, as assumed.
    assumed: Vec<Interval>,
}

impl Uniforms {
    /// Splits `roots` into what is computed beforehand from parameters with these `values` and a graph with what is left
    /// to the steps. The steps hold wherever the parameters are within `assumptions`.
    ///
    /// # Panics
    /// If a parameter has no value or no assumption.
    pub fn split(
        graph: &Graph,
        roots: &[NodeId],
        assumptions: &Assumptions,
        values: &[Interval],
    ) -> (Self, Graph, Vec<NodeId>) {
        let parameters = assumptions.parameters.len();
        let hoisted = hoist(graph, roots, parameters as u32);
        let nodes: Vec<NodeId> = hoisted.uniforms.iter().map(|(_, node)| *node).collect();
        let (needed, nodes) = compact(graph, &nodes);
        let all = known(&needed, &nodes, &assumptions.parameters);
        let assumed = all.iter().map(|(bounds, _)| *bounds).collect();
        let mut uniforms = Self { graph: needed, nodes, hoisted: true, assumed };
        if uniforms.values(values).is_some() {
            return (uniforms, hoisted.graph, hoisted.roots);
        }
        // A value that may be undefined stays where it is: a choice between branches need not reach it.
        uniforms.hoisted = false;
        (uniforms, graph.clone(), roots.to_vec())
    }

    /// Bounds of all that the steps read, as assumed.
    pub fn assumed(&self) -> Vec<(Interval, Facts)> {
        let read = if self.hoisted { self.assumed.len() } else { self.parameters() };
        self.assumed[..read].iter().map(|bounds| (*bounds, Facts::TOTAL)).collect()
    }

    /// All that the steps read when the parameters have these values, or `None` if other steps are needed for them.
    ///
    /// # Panics
    /// If a parameter has no value.
    pub fn values(&self, parameters: &[Interval]) -> Option<Vec<(Interval, Facts)>> {
        let mut all = known(&self.graph, &self.nodes, parameters);
        let inside = |(value, assumed): (&(Interval, Facts), &Interval)| {
            assumed.lo <= value.0.lo && value.0.hi <= assumed.hi
        };
        let base = self.parameters();
        let given = all.iter().zip(&self.assumed);
        if !given.take(base).all(inside) {
            return None;
        }
        let computed = all.iter().zip(&self.assumed).skip(base);
        let total =
            computed.clone().all(|((_, facts), _)| facts.has(Facts::DEFINED)) && { computed }
                .all(inside);
        // Whether values are computed beforehand depends on the parameters alone, not on what they were before: the same
        // document always gives the same picture.
        if total != self.hoisted {
            return None;
        }
        if !self.hoisted {
            all.truncate(base);
        }
        Some(all)
    }

    fn parameters(&self) -> usize {
        self.assumed.len() - self.nodes.len()
    }
}

/// What is known of the parameters, and then of `nodes`.
fn known(graph: &Graph, nodes: &[NodeId], parameters: &[Interval]) -> Vec<(Interval, Facts)> {
    let assumptions =
        Assumptions { domain: [Interval::ENTIRE; 3], parameters: parameters.to_vec() };
    let computed = nodes.iter().map(|node| enclosure::enclose(graph, *node, &assumptions));
    parameters.iter().map(|bounds| (*bounds, Facts::TOTAL)).chain(computed).collect()
}

/// A kernel, and how it is given other parameter values.
#[derive(Clone)]
pub(crate) struct Bound<K> {
    pub kernel: K,
    uniforms: Uniforms,
}

impl<K: Bind> Bound<K> {
    pub fn new(kernel: K, uniforms: Uniforms) -> Self {
        Self { kernel, uniforms }
    }

    /// Whether both run the same code, compiled once.
    pub fn shares_code(&self, other: &Self) -> bool {
        self.kernel.shares(&other.kernel)
    }

    /// The same code for other values, or `None` if it does not hold for them.
    pub fn with(&self, parameters: &[Interval]) -> Option<Self> {
        let binding = Binding::new(&self.uniforms.values(parameters)?);
        Some(Self { kernel: self.kernel.bound(&binding), uniforms: self.uniforms.clone() })
    }
}

/// Code that other values can be bound to.
pub(crate) trait Bind {
    type Real: Real;

    fn bound(&self, binding: &Binding<Self::Real>) -> Self;

    fn shares(&self, other: &Self) -> bool;
}

macro_rules! bind {
    ($($kernel:ident),*) => {$(
        impl<T: Real> Bind for $kernel<T> {
            type Real = T;

            fn bound(&self, binding: &Binding<T>) -> Self {
                self.bind(binding)
            }

            fn shares(&self, other: &Self) -> bool {
                self.shares_code(other)
            }
        }
    )*};
}

bind!(NativeInterval, NativePoint, NativeGradient);

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    const fn point(value: f64) -> Interval {
        Interval { lo: value, hi: value }
    }

    /// What the steps of a formula with one parameter r read when made for r = 2 in [0, 4].
    fn split(formula: &str) -> Uniforms {
        let document = read(&format!("r = 2\n{formula}"), &Options::default()).expect("reads");
        let range = Interval { lo: 0.0, hi: 4.0 };
        let assumptions = Assumptions { domain: [Interval::ENTIRE; 3], parameters: vec![range] };
        Uniforms::split(&document.graph, &[document.surfaces[0].root], &assumptions, &[point(2.0)])
            .0
    }

    #[test]
    fn values_are_computed_from_parameters_within_what_is_assumed() {
        let uniforms = split("x*sin(r) + y");
        let values = uniforms.values(&[point(3.0)]).expect("within");
        assert!(values.len() == 2 && values[1].0.contains(3.0_f64.sin()), "{values:?}");
        assert!(uniforms.values(&[point(5.0)]).is_none());
        assert!(uniforms.assumed()[1].0.hi >= 1.0);
    }

    #[test]
    fn a_value_that_no_longer_exists_needs_other_steps() {
        let uniforms = split("x*sqrt(r-1) + y");
        assert!(uniforms.values(&[point(1.5)]).is_some());
        assert!(uniforms.values(&[point(0.5)]).is_none());
        // And the other way round.
        let computed = split("x*sqrt(r-3) + y");
        assert_eq!(computed.values(&[point(1.5)]).map(|values| values.len()), Some(1));
        assert!(computed.values(&[point(3.5)]).is_none());
    }
}
