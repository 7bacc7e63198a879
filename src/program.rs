//! A document made ready to run: simplified over a domain, parameters bound, kernels compiled as asked for.

use crate::enclosure;
use crate::uniforms::{Bound, Uniforms};
use crate::zeros::ZeroKernel;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;
use zeroset_eval::{Assumptions, Binding, Real, Tape};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{
    Constant, Graph, IrError, NodeId, clear, compact, fix_exponents, gradient, rewrite, simplify,
};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};
use zeroset_syntax::{Document, Parameter, ParameterKind, SurfaceKind};

/// The surfaces of a document over one domain.
#[derive(Clone, Debug)]
pub struct Program {
    shared: Arc<Simplified>,
    /// The parameters' values, within what is assumed.
    values: Vec<Interval>,
    undefined: Vec<bool>,
}

/// What does not depend on the parameters' values, as long as they are within what is assumed.
#[derive(Debug)]
struct Simplified {
    graph: Graph,
    roots: Vec<NodeId>,
    /// Before constants are folded to bounds, so that derivatives simplify as well as the functions.
    symbolic: (Graph, Vec<NodeId>),
    /// As typed, but for exponents: what all of the above was made from.
    typed: (Graph, Vec<NodeId>),
    assumptions: Assumptions,
    /// Nodes as typed.
    nodes_before: usize,
    /// Per surface, whether it bounds a solid.
    solid: Vec<bool>,
}

/// Time is expected to stay within this of 0 if nobody says otherwise: beyond it code is compiled anew.
const TIME: f64 = 16.0;

/// Steps to run, and the parameters' values as these steps read them.
#[derive(Clone, Debug)]
pub struct Routine<T: Real = f32> {
    /// The steps.
    pub tape: Tape<T>,
    /// The values.
    pub binding: Binding<T>,
    /// How other values are bound.
    pub uniforms: Uniforms,
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
    /// All surfaces together need too much code, though each alone does not.
    #[error(
        "all surfaces together need more than {limit} bytes of code; draw some of them at a time"
    )]
    TooMuchCode {
        /// Bytes allowed.
        limit: usize,
    },
}

/// Machine code of all kernels of a document, at most: so much takes about a second to make, and the largest single surfaces
/// that kernels hold need half of it.
const CODE_BYTES: usize = 8 << 20;

/// How much machine code has been made for one document, from any thread.
#[derive(Debug, Default)]
pub(crate) struct CodeSize(AtomicUsize);

impl CodeSize {
    /// Adds the code of one surface, or of none: an error once all together are too long.
    pub(crate) fn add(&self, bytes: usize) -> Result<(), ProgramError> {
        let all = bytes + self.0.fetch_add(bytes, Ordering::Relaxed);
        if all > CODE_BYTES { Err(ProgramError::TooMuchCode { limit: CODE_BYTES }) } else { Ok(()) }
    }
}

impl Program {
    /// Simplifies all surfaces of `document` over `domain`, for its parameters' values.
    ///
    /// # Errors
    /// If a formula is too large, depends on no coordinate, or is defined nowhere.
    pub fn new(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        let program = Self::unchecked(document, domain)?;
        program.check(document)?;
        Ok(program)
    }

    /// As [`Program::new`], but takes constant and undefined formulas too: they can be evaluated, if not drawn.
    ///
    /// # Errors
    /// If a formula is too large.
    pub fn unchecked(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        let typed = typed(document);
        let parameters: Vec<Interval> = document.parameters.iter().map(assumed).collect();
        let symbolic = rewrite(&typed.0, &typed.1, &domain, &parameters)?;
        let (graph, roots) = simplify(&symbolic.0, &symbolic.1, &domain, &parameters)?;
        let assumptions = Assumptions { domain, parameters };
        let before: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
        let nodes_before = count(&document.graph, &before);
        let solid = solid(document);
        let shared = Simplified { graph, roots, symbolic, typed, assumptions, nodes_before, solid };
        Ok(Self { shared: Arc::new(shared), values: Vec::new(), undefined: Vec::new() }
            .with(values(document)))
    }

    /// The same program for the parameter values of another document, or `None` if that differs in more than values, or if
    /// these are beyond what was assumed. A slider is assumed to stay within its range.
    ///
    /// # Errors
    /// If a formula depends on no coordinate or is defined nowhere.
    pub fn rebound(&self, document: &Document) -> Option<Result<Self, ProgramError>> {
        let Simplified { typed: before, assumptions, solid: solids, .. } = &*self.shared;
        let assumed = document.parameters.iter().map(assumed);
        let same = assumed.eq(assumptions.parameters.iter().copied())
            && solid(document) == *solids
            && typed(document) == *before;
        if !same {
            return None;
        }
        let program = self.with(values(document));
        Some(program.check(document).map(|()| program))
    }

    /// The same program for all values together that the document's sliders can be set to: what it says holds for each.
    #[must_use]
    pub fn over_ranges(&self, document: &Document) -> Self {
        let parameters = document.parameters.iter().zip(&self.shared.assumptions.parameters);
        let range = |(parameter, assumed): (&Parameter, &Interval)| match parameter.range {
            Some(_) => *assumed,
            None => parameter.value.bounds(),
        };
        self.with(parameters.map(range).collect())
    }

    fn with(&self, values: Vec<Interval>) -> Self {
        let Simplified { graph, roots, assumptions, .. } = &*self.shared;
        let assumptions = Assumptions { parameters: values.clone(), ..assumptions.clone() };
        let enclosures = enclosure::enclose_all(graph, roots, &assumptions);
        let undefined = enclosures.iter().map(|(_, facts)| facts.has(Facts::NOWHERE)).collect();
        Self { shared: Arc::clone(&self.shared), values, undefined }
    }

    /// Refuses what has no surface.
    fn check(&self, document: &Document) -> Result<(), ProgramError> {
        let parameters = self.values.clone();
        let here = Assumptions { domain: self.shared.assumptions.domain, parameters };
        let anywhere = Assumptions { domain: [Interval::ENTIRE; 3], ..here.clone() };
        let enclosures = enclosure::enclose_all(self.graph(), self.roots(), &here);
        let varies = enclosure::varies(self.graph(), self.roots());
        for ((surface, (bounds, facts)), varies) in
            document.surfaces.iter().zip(enclosures).zip(varies)
        {
            let side = surface.echo.strip_suffix(" = 0");
            let echo = || side.unwrap_or(&surface.echo).to_owned();
            if facts.has(Facts::NOWHERE) {
                // Undefined on this domain; the formula as typed tells whether that is so everywhere.
                let (graph, root) = own(&document.graph, surface.root);
                let typed = enclosure::enclose(&graph, root, &anywhere);
                if typed.1.has(Facts::NOWHERE) {
                    return Err(ProgramError::Nowhere { echo: echo() });
                }
            } else if !varies {
                let value = describe(bounds, side.is_some());
                return Err(ProgramError::Constant { echo: echo(), value });
            }
        }
        Ok(())
    }

    /// The simplified graph of all surfaces.
    pub fn graph(&self) -> &Graph {
        &self.shared.graph
    }

    /// The function of each surface in the graph.
    pub fn roots(&self) -> &[NodeId] {
        &self.shared.roots
    }

    /// Nodes as typed and after simplification, all surfaces together.
    pub fn nodes(&self) -> (usize, usize) {
        (self.shared.nodes_before, count(self.graph(), self.roots()))
    }

    /// Whether a surface's function is proven to have no value on the whole domain.
    pub fn is_undefined(&self, surface: usize) -> bool {
        self.undefined[surface]
    }

    /// What computes a surface's function.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn routine<T: Real>(&self, surface: usize) -> Routine<T> {
        let (graph, root) = own(self.graph(), self.roots()[surface]);
        self.hoisted(&graph, &[root])
    }

    /// A surface's function before constants are folded, alone.
    fn symbolic(&self, surface: usize) -> (Graph, NodeId) {
        let (graph, roots) = &self.shared.symbolic;
        own(graph, roots[surface])
    }

    /// What computes a surface's function and its three derivatives.
    ///
    /// # Errors
    /// If the derivatives are too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn gradient_routine<T: Real>(&self, surface: usize) -> Result<Routine<T>, ProgramError> {
        let (mut graph, root) = self.symbolic(surface);
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
        let (mut graph, root) = self.symbolic(surface);
        let Some(cleared) = clear(&mut graph, root) else { return Ok(None) };
        let typed = [cleared.numerator, cleared.denominator, root];
        let (graph, roots) = self.simplified(&graph, &typed)?;
        Ok(Some((graph, [roots[0], roots[1], roots[2]])))
    }

    /// Native code that encloses a surface's function.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn interval_kernel<T: Real>(
        &self,
        surface: usize,
    ) -> Result<NativeInterval<T>, ProgramError> {
        Ok(interval(self.routine(surface))?.kernel)
    }

    /// Native code that tells where a surface's function may vanish: its enclosures, near poles those of its cleared form,
    /// and at jumps those of its branches.
    ///
    /// The boundary of a solid is also where its function changes sign at a pole or in a jump: there its own enclosures
    /// count.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn zero_kernel<T: Real>(&self, surface: usize) -> Result<ZeroKernel<T>, ProgramError> {
        let function = interval(self.routine(surface))?;
        if self.shared.solid[surface] {
            return Ok(ZeroKernel::new(function, None, None));
        }
        let cleared = self.cleared(surface)?;
        let (numerator, branches) = if let Some((graph, [numerator, _, function])) = &cleared {
            let steps = self.hoisted(graph, &[*numerator]);
            (Some(interval(steps)?), self.branches(graph, &[*function, *numerator]))
        } else {
            let (graph, root) = own(self.graph(), self.roots()[surface]);
            (None, self.branches(&graph, &[root]))
        };
        let branches = branches.map(interval).transpose()?;
        Ok(ZeroKernel::new(function, numerator, branches))
    }

    /// Native code that samples a surface's function.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn point_kernel<T: Real>(&self, surface: usize) -> Result<NativePoint<T>, ProgramError> {
        Ok(self.bound_point(surface)?.kernel)
    }

    pub(crate) fn bound_point<T: Real>(
        &self,
        surface: usize,
    ) -> Result<Bound<NativePoint<T>>, ProgramError> {
        let Routine { tape, binding, uniforms } = self.routine(surface);
        Ok(Bound::new(NativePoint::compile(&tape, &binding)?, uniforms))
    }

    /// Native code that samples a surface's function and its gradient.
    ///
    /// # Errors
    /// If no code can be made.
    pub fn gradient_kernel<T: Real>(
        &self,
        surface: usize,
    ) -> Result<NativeGradient<T>, ProgramError> {
        Ok(self.bound_gradient(surface)?.kernel)
    }

    pub(crate) fn bound_gradient<T: Real>(
        &self,
        surface: usize,
    ) -> Result<Bound<NativeGradient<T>>, ProgramError> {
        let Routine { tape, binding, uniforms } = self.gradient_routine(surface)?;
        Ok(Bound::new(NativeGradient::compile(&tape, &binding)?, uniforms))
    }

    /// The parameters' values.
    pub(crate) fn values(&self) -> &[Interval] {
        &self.values
    }

    fn simplified(
        &self,
        graph: &Graph,
        roots: &[NodeId],
    ) -> Result<(Graph, Vec<NodeId>), ProgramError> {
        let Assumptions { domain, parameters } = &self.shared.assumptions;
        Ok(simplify(graph, roots, domain, parameters)?)
    }

    /// The steps that tell where `roots` may all vanish, branch by branch; `None` if the last does not jump.
    fn branches<T: Real>(&self, graph: &Graph, roots: &[NodeId]) -> Option<Routine<T>> {
        let (tape, binding, uniforms) = self.bind(graph, roots, Tape::branches);
        Some(Routine { tape: tape?, binding, uniforms })
    }

    /// The steps for `roots`, what depends on parameters alone computed beforehand.
    fn hoisted<T: Real>(&self, graph: &Graph, roots: &[NodeId]) -> Routine<T> {
        let (tape, binding, uniforms) = self.bind(graph, roots, Tape::new);
        Routine { tape, binding, uniforms }
    }

    /// What is made of `roots` where what depends on parameters alone has become parameters, and their values.
    ///
    /// # Panics
    /// Never: values are bound only where they are within what is assumed.
    fn bind<T: Real, R>(
        &self,
        graph: &Graph,
        roots: &[NodeId],
        make: impl FnOnce(&Graph, &[NodeId], &Assumptions) -> R,
    ) -> (R, Binding<T>, Uniforms) {
        let assumptions = &self.shared.assumptions;
        let (uniforms, graph, roots) = Uniforms::split(graph, roots, assumptions, &self.values);
        let assumed: Binding<T> = Binding::new(&uniforms.assumed());
        let assumptions =
            Assumptions { domain: assumptions.domain, parameters: assumed.bounds().to_vec() };
        let values = uniforms.values(&self.values).expect("split for these values");
        (make(&graph, &roots, &assumptions), Binding::new(&values), uniforms)
    }
}

/// What `root` needs, in a graph of its own: what is done for one surface must not take time for all others.
fn own(graph: &Graph, root: NodeId) -> (Graph, NodeId) {
    let (graph, roots) = compact(graph, &[root]);
    (graph, roots[0])
}

fn interval<T: Real>(routine: Routine<T>) -> Result<Bound<NativeInterval<T>>, ProgramError> {
    let Routine { tape, binding, uniforms } = routine;
    Ok(Bound::new(NativeInterval::compile(&tape, &binding)?, uniforms))
}

/// All surfaces as typed, with parameters in exponents replaced by their values.
fn typed(document: &Document) -> (Graph, Vec<NodeId>) {
    let surfaces: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
    let values: Vec<Constant> =
        document.parameters.iter().map(|parameter| parameter.value.clone()).collect();
    fix_exponents(&document.graph, &surfaces, &values)
}

fn solid(document: &Document) -> Vec<bool> {
    document.surfaces.iter().map(|surface| surface.kind == SurfaceKind::Solid).collect()
}

fn values(document: &Document) -> Vec<Interval> {
    document.parameters.iter().map(|parameter| parameter.value.bounds()).collect()
}

/// Where a parameter is assumed to stay: in its range, if it is there.
fn assumed(parameter: &Parameter) -> Interval {
    let value = parameter.value.bounds();
    let range = match (&parameter.range, parameter.kind) {
        (Some((low, high)), _) => Interval { lo: low.bounds().lo, hi: high.bounds().hi },
        (None, ParameterKind::Time) => Interval { lo: -TIME, hi: TIME },
        (None, ParameterKind::Slider) => value,
    };
    if range.lo <= value.lo && value.hi <= range.hi { range } else { value }
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
        let Routine { tape, binding, .. } = rolling.routine::<f32>(0);
        assert_eq!((tape.operations(), binding.values().len()), (4, 3));
        // A value that does not exist is left to the steps, which may not need it.
        let choice = program("w = -2\nstep(0, x)*sqrt(1+w*y) + sqrt(w+y^2)").expect("a surface");
        assert_eq!(choice.routine::<f32>(0).binding.values().len(), 1);
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
            let parameters = program.values.clone();
            let assumptions = Assumptions { domain: left, parameters };
            enclosure::enclose(program.graph(), program.roots()[0], &assumptions)
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
