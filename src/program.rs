//! A document made ready to run: simplified over a domain, parameters bound, kernels compiled as asked for.

use crate::enclosure;
use thiserror::Error;
use zeroset_eval::{Assumptions, Binding, Tape};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Graph, IrError, NodeId, gradient, rewrite, simplify};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};
use zeroset_syntax::Document;

/// The surfaces of a document over one domain.
#[derive(Clone, Debug)]
pub struct Program {
    graph: Graph,
    roots: Vec<NodeId>,
    /// Before constants are folded to bounds, so that derivatives simplify as well as the functions.
    symbolic: (Graph, Vec<NodeId>),
    assumptions: Assumptions,
    binding: Binding,
    /// Nodes as typed.
    nodes_before: usize,
    undefined: Vec<bool>,
}

/// Why a document cannot be drawn, though it reads well.
#[derive(Debug, Error)]
pub enum ProgramError {
    /// A formula is the same at every point.
    #[error("'{echo}' is constant: {value}, so it has no surface")]
    Constant {
        /// How the formula was read.
        echo: String,
        /// What is known of its value.
        value: String,
    },
    /// A formula has no value anywhere.
    #[error("'{echo}' is defined nowhere: it has no value at any point, so it has no surface")]
    Nowhere {
        /// How the formula was read.
        echo: String,
    },
    /// The graph is too large.
    #[error(transparent)]
    Graph(#[from] IrError),
    /// No code can be made.
    #[error(transparent)]
    Code(#[from] zeroset_jit::Error),
}

impl Program {
    /// Simplifies all surfaces of `document` over `domain`, for its parameters' values.
    ///
    /// # Errors
    /// If a formula is too large, depends on no coordinate, or is defined nowhere.
    pub fn new(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        let program = Self::unchecked(document, domain)?;
        for (surface, &root) in document.surfaces.iter().zip(&program.roots) {
            let side = surface.echo.strip_suffix(" = 0");
            let echo = || side.unwrap_or(&surface.echo).to_owned();
            let (bounds, facts) = enclosure::enclose(&program.graph, root, &program.assumptions);
            if facts.has(Facts::NOWHERE) {
                // Undefined on this domain; the formula as typed tells whether that is so everywhere.
                let anywhere = Assumptions {
                    domain: [Interval::ENTIRE; 3],
                    parameters: program.assumptions.parameters.clone(),
                };
                let typed = enclosure::enclose(&document.graph, surface.root, &anywhere);
                if typed.1.has(Facts::NOWHERE) {
                    return Err(ProgramError::Nowhere { echo: echo() });
                }
            } else if !enclosure::coordinates(&program.graph, root).contains(&true) {
                let value = describe(bounds, side.is_some());
                return Err(ProgramError::Constant { echo: echo(), value });
            }
        }
        Ok(program)
    }

    /// As [`Program::new`], but takes constant and undefined formulas too: they can be evaluated, if not drawn.
    ///
    /// # Errors
    /// If a formula is too large.
    pub fn unchecked(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        let parameters: Vec<Interval> =
            document.parameters.iter().map(|parameter| parameter.value.bounds()).collect();
        let bound: Vec<_> = parameters.iter().map(|bounds| (*bounds, Facts::TOTAL)).collect();
        let typed: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
        let symbolic = rewrite(&document.graph, &typed, &domain, &parameters)?;
        let (graph, roots) = simplify(&symbolic.0, &symbolic.1, &domain, &parameters)?;
        let assumptions = Assumptions { domain, parameters };
        let undefined = roots
            .iter()
            .map(|&root| enclosure::enclose(&graph, root, &assumptions).1.has(Facts::NOWHERE))
            .collect();
        Ok(Self {
            graph,
            roots,
            symbolic,
            assumptions,
            binding: Binding::new(&bound),
            nodes_before: count(&document.graph, &typed),
            undefined,
        })
    }

    /// The simplified graph of all surfaces.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The function of each surface in the graph.
    pub fn roots(&self) -> &[NodeId] {
        &self.roots
    }

    /// The parameters' values.
    pub fn binding(&self) -> &Binding {
        &self.binding
    }

    /// Nodes as typed and after simplification, all surfaces together.
    pub fn nodes(&self) -> (usize, usize) {
        (self.nodes_before, count(&self.graph, &self.roots))
    }

    /// Whether a surface's function is proven to have no value on the whole domain.
    pub fn is_undefined(&self, surface: usize) -> bool {
        self.undefined[surface]
    }

    /// The steps that compute a surface's function.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn tape(&self, surface: usize) -> Tape {
        Tape::new(&self.graph, &[self.roots[surface]], &self.assumptions)
    }

    /// The steps that compute a surface's function and its three derivatives.
    ///
    /// # Errors
    /// If the derivatives are too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn gradient_tape(&self, surface: usize) -> Result<Tape, ProgramError> {
        let (mut graph, root) = (self.symbolic.0.clone(), self.symbolic.1[surface]);
        let [x, y, z] = gradient(&mut graph, root);
        let Assumptions { domain, parameters } = &self.assumptions;
        let (graph, roots) = simplify(&graph, &[root, x, y, z], domain, parameters)?;
        Ok(Tape::new(&graph, &roots, &self.assumptions))
    }

    /// Native code that encloses a surface's function.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn interval_kernel(&self, surface: usize) -> Result<NativeInterval, ProgramError> {
        Ok(NativeInterval::compile(&self.tape(surface), &self.binding)?)
    }

    /// Native code that samples a surface's function.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn point_kernel(&self, surface: usize) -> Result<NativePoint, ProgramError> {
        Ok(NativePoint::compile(&self.tape(surface), &self.binding)?)
    }

    /// Native code that samples a surface's function and its gradient.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn gradient_kernel(&self, surface: usize) -> Result<NativeGradient, ProgramError> {
        Ok(NativeGradient::compile(&self.gradient_tape(surface)?, &self.binding)?)
    }
}

fn count(graph: &Graph, roots: &[NodeId]) -> usize {
    graph.reachable(roots).into_iter().filter(|needed| *needed).count()
}

/// What is known of a constant; `plain` if it was typed as one expression, not as two that are compared.
fn describe(bounds: Interval, plain: bool) -> String {
    let it = if plain { "it is" } else { "its two sides differ by" };
    let value = match bounds.singleton() {
        Some(0.0) => return "every point is a zero".to_owned(),
        Some(value) => format!("{value}"),
        None if bounds.lo == f64::MAX => "more than any number of 64 bits".to_owned(),
        None if bounds.lo > 0.0 || bounds.hi < 0.0 => {
            format!("about {}", bounds.lo.midpoint(bounds.hi))
        }
        None => return "it does not depend on x, y or z".to_owned(),
    };
    format!("{it} {value} at every point")
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    fn program(formula: &str) -> Result<Program, ProgramError> {
        let document = read(formula, &Options::default()).expect("reads");
        Program::new(&document, [Interval { lo: -2.0, hi: 2.0 }; 3])
    }

    fn message(formula: &str) -> String {
        program(formula).expect_err("no surface").to_string()
    }

    #[test]
    fn constants_are_refused_with_their_value() {
        assert_eq!(message("3"), "'3' is constant: it is 3 at every point, so it has no surface");
        assert!(message("1=x-x").contains("differ by 1 at every point"), "{}", message("1=x-x"));
        assert!(message("x-x").contains("every point is a zero"));
        assert!(message("9^9^9^9").contains("is constant"));
    }

    #[test]
    fn what_is_defined_nowhere_is_refused_even_if_it_varies() {
        for formula in ["1/0", "sqrt(-1)", "sqrt(-1-x^2)", "ln(-abs(x))-1"] {
            assert!(message(formula).contains("defined nowhere"), "{formula}");
        }
        // Undefined on this domain only: a note, not an error.
        let elsewhere = program("sqrt(x-5)+y").expect("defined elsewhere");
        assert!(elsewhere.is_undefined(0));
        assert!(!program("sqrt(x)+y").expect("defined").is_undefined(0));
    }
}
