//! Simplified surfaces, and the tapes that are built from them.
//!
//! This module depends neither on which tapes are requested nor on what they are used for.

use crate::uniforms::Uniforms;
use std::fmt;
use std::sync::OnceLock;
use thiserror::Error;
use zeroset_eval::{Assumptions, KernelError, Real, Tape};
use zeroset_ir::{Graph, IrError, NodeId, clear, compact, gradient, simplify};

/// The simplified surfaces of a program. They are valid for all parameter values within the assumed
/// bounds.
pub(crate) struct Simplified {
    pub graph: Graph,
    pub roots: Vec<NodeId>,
    /// Graph and roots before constants are folded to bounds. Derivatives are taken of this form,
    /// so that they simplify as well as the functions.
    pub symbolic: (Graph, Vec<NodeId>),
    /// Graph and roots as typed, with fixed exponents. The graphs above were built from them.
    pub typed: (Graph, Vec<NodeId>),
    pub assumptions: Assumptions,
    /// Number of nodes as typed.
    pub nodes_before: usize,
    /// For each surface, whether it bounds a solid.
    pub solid: Vec<bool>,
    /// For each surface, whether its solid holds the points at which its function is 0.
    pub holds_zeros: Vec<Option<bool>>,
    /// Whether the function of each surface was replaced by another with the same zeros or, for a
    /// solid, the same boundary of the interior.
    pub reduced: Vec<bool>,
    /// Whether quotients in the function of a solid were replaced by their continuous extensions.
    pub filled: Vec<bool>,
    /// The rational form of each surface's function, if it has one.
    pub cleared: Vec<OnceLock<Result<Option<ClearedGraph>, IrError>>>,
}

/// Numerator and denominator of a function, and the function itself, in one graph.
#[derive(Clone, Debug)]
pub struct ClearedGraph {
    /// The graph.
    pub graph: Graph,
    /// The numerator, which is 0 where the function is 0.
    pub numerator: NodeId,
    /// The denominator, which is 0 at the poles.
    pub denominator: NodeId,
    /// The function.
    pub function: NodeId,
    /// Product of the factors by which numerator and denominator were divided, if there are any.
    pub removed: Option<NodeId>,
}

/// The form of a surface's function that a kernel computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum KernelSource {
    /// The function.
    Function,
    /// The numerator of the function's rational form.
    Numerator,
    /// The denominator of the function's rational form.
    Denominator,
    /// The function, and the numerator of its rational form if it has one, evaluated branch by
    /// branch. Only for a function that may jump.
    Branches,
    /// The function and its three partial derivatives.
    Gradient,
    /// The functions of all surfaces of the program: the coordinates of a parametric surface.
    Coordinates,
}

impl fmt::Display for KernelSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Function => "the function",
            Self::Numerator => "the numerator",
            Self::Denominator => "the denominator",
            Self::Branches => "the branches",
            Self::Gradient => "function and derivatives",
            Self::Coordinates => "the coordinates",
        })
    }
}

/// The reason why a document that parses cannot be drawn.
#[derive(Debug, Error)]
pub enum ProgramError {
    /// A formula has the same value at every point.
    #[error("'{echo}' is constant: {value}, so it has no surface")]
    Constant {
        /// The formula as it was understood.
        echo: String,
        /// The value, in words.
        value: String,
    },
    /// A formula has no value anywhere.
    #[error("'{echo}' is defined nowhere: it has no value at any point, so it has no surface")]
    Nowhere {
        /// The formula as it was understood.
        echo: String,
    },
    /// The graph is too large.
    #[error(transparent)]
    Graph(#[from] IrError),
    /// The range of a surface's parameter has no finite ends in order.
    #[error("'{echo}' needs ranges with two finite ends, the smaller one first")]
    Range {
        /// The surface as it was understood.
        echo: String,
    },
    /// A kernel cannot be compiled.
    #[error(transparent)]
    Code(#[from] zeroset_jit::Error),
    /// A kernel is not available.
    #[error(transparent)]
    Kernel(#[from] KernelError),
}

impl Simplified {
    /// The tape of a form, and the uniforms that it reads. With `hoisted`, values that depend on
    /// parameters alone become uniforms. `None` if the surface has no such form.
    pub fn steps<T: Real>(
        &self,
        surface: usize,
        form: KernelSource,
        hoisted: bool,
    ) -> Result<Option<(Tape<T>, Uniforms)>, ProgramError> {
        let function = || compact(&self.graph, &[self.roots[surface]]);
        let (graph, roots) = match form {
            KernelSource::Function => function(),
            KernelSource::Coordinates => compact(&self.graph, &self.roots),
            KernelSource::Gradient => {
                let (mut graph, root) = self.symbolic(surface);
                let [x, y, z] = gradient(&mut graph, root);
                self.simplify(&graph, &[root, x, y, z])?
            }
            KernelSource::Branches if self.solid[surface] => function(),
            KernelSource::Branches => match self.cleared(surface)? {
                Some(cleared) => (cleared.graph.clone(), vec![cleared.function, cleared.numerator]),
                None => function(),
            },
            KernelSource::Numerator | KernelSource::Denominator => {
                let Some(cleared) = self.cleared(surface)? else { return Ok(None) };
                let is_above = form == KernelSource::Numerator;
                let root = if is_above { cleared.numerator } else { cleared.denominator };
                (cleared.graph.clone(), vec![root])
            }
        };
        let (uniforms, graph, roots) = Uniforms::split(&graph, &roots, &self.assumptions, hoisted);
        let parameters = uniforms.assumed().to_vec();
        let assumptions = Assumptions { domain: self.assumptions.domain, parameters };
        let tape = if form == KernelSource::Branches {
            Tape::branches(&graph, &roots, &assumptions)
        } else {
            Some(Tape::new(&graph, &roots, &assumptions))
        };
        Ok(tape.map(|tape| (tape, uniforms)))
    }

    pub fn cleared(&self, surface: usize) -> Result<Option<&ClearedGraph>, ProgramError> {
        let make = || {
            let (mut graph, function) = self.symbolic(surface);
            let Some(cleared) = clear(&mut graph, function) else { return Ok(None) };
            let mut typed = vec![cleared.numerator, cleared.denominator, function];
            typed.extend(cleared.removed);
            let (graph, roots) = self.simplify(&graph, &typed)?;
            let [numerator, denominator, function] = [roots[0], roots[1], roots[2]];
            let removed = roots.get(3).copied();
            Ok(Some(ClearedGraph { graph, numerator, denominator, function, removed }))
        };
        let cleared = self.cleared[surface].get_or_init(make);
        Ok(cleared.as_ref().map_err(Clone::clone)?.as_ref())
    }

    /// A surface's function before constants are folded. Its graph holds no other surface, which
    /// would only cost time.
    pub fn symbolic(&self, surface: usize) -> (Graph, NodeId) {
        let (graph, roots) = &self.symbolic;
        let (graph, roots) = compact(graph, &[roots[surface]]);
        (graph, roots[0])
    }

    fn simplify(&self, graph: &Graph, roots: &[NodeId]) -> Result<(Graph, Vec<NodeId>), IrError> {
        simplify(graph, roots, &self.assumptions.domain, &self.assumptions.parameters)
    }
}
