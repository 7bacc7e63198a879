//! A document made ready to run: simplified over a domain, parameters bound, kernels compiled as asked for.

use crate::enclosure;
use crate::zeros::ZeroKernel;
use thiserror::Error;
use zeroset_eval::{Assumptions, Binding, Tape};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{
    Constant, Graph, IrError, NodeId, clear, fix_exponents, gradient, hoist, rewrite, simplify,
};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};
use zeroset_syntax::{Document, Kind};

/// The surfaces of a document over one domain.
#[derive(Clone, Debug)]
pub struct Program {
    graph: Graph,
    roots: Vec<NodeId>,
    /// Before constants are folded to bounds, so that derivatives simplify as well as the functions.
    symbolic: (Graph, Vec<NodeId>),
    assumptions: Assumptions,
    /// Nodes as typed.
    nodes_before: usize,
    undefined: Vec<bool>,
    /// Per surface, whether it bounds a solid.
    solid: Vec<bool>,
}

/// Steps to run, and the parameters' values as these steps read them.
#[derive(Clone, Debug)]
pub struct Routine {
    /// The steps.
    pub tape: Tape,
    /// The values.
    pub binding: Binding,
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
        let typed: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
        let values: Vec<Constant> =
            document.parameters.iter().map(|parameter| parameter.value.clone()).collect();
        let (exact, surfaces) = fix_exponents(&document.graph, &typed, &values);
        let symbolic = rewrite(&exact, &surfaces, &domain, &parameters)?;
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
            nodes_before: count(&document.graph, &typed),
            undefined,
            solid: document.surfaces.iter().map(|surface| surface.kind == Kind::Solid).collect(),
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

    /// Nodes as typed and after simplification, all surfaces together.
    pub fn nodes(&self) -> (usize, usize) {
        (self.nodes_before, count(&self.graph, &self.roots))
    }

    /// Whether a surface's function is proven to have no value on the whole domain.
    pub fn is_undefined(&self, surface: usize) -> bool {
        self.undefined[surface]
    }

    /// What computes a surface's function.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn routine(&self, surface: usize) -> Routine {
        self.hoisted(&self.graph, &[self.roots[surface]])
    }

    /// What computes a surface's function and its three derivatives.
    ///
    /// # Errors
    /// If the derivatives are too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn gradient_routine(&self, surface: usize) -> Result<Routine, ProgramError> {
        let (mut graph, root) = (self.symbolic.0.clone(), self.symbolic.1[surface]);
        let [x, y, z] = gradient(&mut graph, root);
        let (graph, roots) = self.simplified(&graph, &[root, x, y, z])?;
        Ok(self.hoisted(&graph, &roots))
    }

    /// The numerator of a surface's cleared form, the node that is 0 at its poles, and the function itself, in a graph of
    /// their own, or `None` if it has no poles that can be cleared.
    ///
    /// # Errors
    /// If the cleared form is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn cleared(&self, surface: usize) -> Result<Option<(Graph, [NodeId; 3])>, ProgramError> {
        let (mut graph, root) = (self.symbolic.0.clone(), self.symbolic.1[surface]);
        let Some(cleared) = clear(&mut graph, root) else { return Ok(None) };
        let typed = [cleared.numerator, cleared.denominator, root];
        let (graph, roots) = self.simplified(&graph, &typed)?;
        Ok(Some((graph, [roots[0], roots[1], roots[2]])))
    }

    /// Native code that encloses a surface's function.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn interval_kernel(&self, surface: usize) -> Result<NativeInterval, ProgramError> {
        let Routine { tape, binding } = self.routine(surface);
        Ok(NativeInterval::compile(&tape, &binding)?)
    }

    /// Native code that tells where a surface's function may vanish: its enclosures, near poles those of its cleared form,
    /// and at jumps those of its branches.
    ///
    /// The boundary of a solid is also where its function changes sign at a pole or in a jump: there its own enclosures
    /// count.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn zero_kernel(&self, surface: usize) -> Result<ZeroKernel, ProgramError> {
        let function = self.interval_kernel(surface)?;
        if self.solid[surface] {
            return Ok(ZeroKernel::new(function, None, None));
        }
        let compile = |Routine { tape, binding }: Routine| NativeInterval::compile(&tape, &binding);
        let cleared = self.cleared(surface)?;
        let (numerator, branches) = match &cleared {
            Some((graph, [numerator, _, function])) => (
                Some(compile(self.hoisted(graph, &[*numerator]))?),
                self.branches(graph, &[*function, *numerator]),
            ),
            None => (None, self.branches(&self.graph, &[self.roots[surface]])),
        };
        let branches = branches.map(compile).transpose()?;
        Ok(ZeroKernel::new(function, numerator, branches))
    }

    /// Native code that samples a surface's function.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn point_kernel(&self, surface: usize) -> Result<NativePoint, ProgramError> {
        let Routine { tape, binding } = self.routine(surface);
        Ok(NativePoint::compile(&tape, &binding)?)
    }

    /// Native code that samples a surface's function and its gradient.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn gradient_kernel(&self, surface: usize) -> Result<NativeGradient, ProgramError> {
        let Routine { tape, binding } = self.gradient_routine(surface)?;
        Ok(NativeGradient::compile(&tape, &binding)?)
    }

    fn simplified(
        &self,
        graph: &Graph,
        roots: &[NodeId],
    ) -> Result<(Graph, Vec<NodeId>), ProgramError> {
        let Assumptions { domain, parameters } = &self.assumptions;
        Ok(simplify(graph, roots, domain, parameters)?)
    }

    /// The steps that tell where `roots` may all vanish, branch by branch; `None` if the last does not jump.
    fn branches(&self, graph: &Graph, roots: &[NodeId]) -> Option<Routine> {
        let (tape, binding) = self.bind(graph, roots, Tape::branches);
        Some(Routine { tape: tape?, binding })
    }

    /// The steps for `roots`, what depends on parameters alone computed beforehand.
    fn hoisted(&self, graph: &Graph, roots: &[NodeId]) -> Routine {
        let (tape, binding) = self.bind(graph, roots, Tape::new);
        Routine { tape, binding }
    }

    /// What is made of `roots` where what depends on parameters alone has become parameters, and their values.
    fn bind<T>(
        &self,
        graph: &Graph,
        roots: &[NodeId],
        make: impl FnOnce(&Graph, &[NodeId], &Assumptions) -> T,
    ) -> (T, Binding) {
        let Assumptions { domain, parameters } = &self.assumptions;
        let mut known: Vec<_> = parameters.iter().map(|bounds| (*bounds, Facts::TOTAL)).collect();
        let hoisted = hoist(graph, roots, parameters.len() as u32);
        let values = hoisted
            .uniforms
            .iter()
            .map(|(_, node)| enclosure::enclose(graph, *node, &self.assumptions));
        let values: Vec<_> = values.collect();
        // A value that may be undefined stays where it is: a choice between branches need not reach it.
        let (graph, roots) = if values.iter().all(|(_, facts)| facts.has(Facts::DEFINED)) {
            known.extend(values);
            (&hoisted.graph, &hoisted.roots[..])
        } else {
            (graph, roots)
        };
        let binding = Binding::new(&known);
        let parameters = binding.bounds().to_vec();
        let assumptions = Assumptions { domain: *domain, parameters };
        (make(graph, roots, &assumptions), binding)
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
    fn what_depends_on_parameters_alone_is_computed_beforehand() {
        let rolling = program("w = 2\nsin(w)*x + cos(w)*y + z").expect("a surface");
        let Routine { tape, binding } = rolling.routine(0);
        assert_eq!((tape.operations(), binding.values().len()), (4, 3));
        // A value that does not exist is left to the steps, which may not need it.
        let choice = program("w = -2\nstep(0, x)*sqrt(1+w*y) + sqrt(w+y^2)").expect("a surface");
        assert_eq!(choice.routine(0).binding.values().len(), 1);
    }

    #[test]
    fn constants_are_refused_with_their_value() {
        assert_eq!(message("3"), "'3' is constant: it is 3 at every point, so it has no surface");
        assert!(message("1=x-x").contains("differ by 1 at every point"), "{}", message("1=x-x"));
        assert!(message("x-x").contains("every point is a zero"));
        assert!(message("9^9^9^9").contains("is constant"));
    }

    #[test]
    fn a_parameter_in_an_exponent_counts_as_the_number_it_is() {
        let enclosed = |formula: &str| {
            let program = program(formula).expect("a surface");
            let left = [Interval { lo: -2.0, hi: -1.0 }; 3];
            let assumptions = Assumptions { domain: left, ..program.assumptions.clone() };
            enclosure::enclose(&program.graph, program.roots[0], &assumptions)
        };
        assert_eq!(enclosed("n = 3\nx^n - y"), enclosed("x^3 - y"));
        assert_eq!(enclosed("n = 2\nx^(2n) - y"), enclosed("x^4 - y"));
        assert!(enclosed("n = 2.5\nx^n - y").1.has(Facts::NOWHERE));
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
