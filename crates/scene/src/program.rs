//! A document prepared for evaluation: simplified over a domain, with parameters bound, its kernels
//! compiled on request.

use crate::kernels::{BoundSurface, CodeStore, CompiledKernel, Evaluator};
use crate::patches::PatchSurface;
use crate::simplified::Simplified;
use num_rational::BigRational;
use std::sync::{Arc, OnceLock};
use zeroset_eval::{
    Assumptions, BoundPatches, Kernel, KernelError, KernelFloat, Kernels, SampleGradient,
    SurfaceKernels, Tape,
};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{
    Constant, Graph, Node, NodeId, algebraic_angles, bounded_logarithms, fix_exponents,
    quadratic_blends, radical, regularize, rewrite, same_sign, simplify, without_gaps,
};
use zeroset_syntax::{Document, Parameter, ParameterKind, SurfaceKind};

pub use crate::simplified::{ClearedGraph, KernelSource, ProgramError};

/// The surfaces of a document over one domain.
pub struct Program {
    store: Arc<CodeStore>,
    /// The parameters' values, within their assumed ranges.
    values: Arc<[Interval]>,
    /// The parameters' values, where they are known exactly. It may be empty.
    pub(crate) exact: Arc<[Option<BigRational>]>,
    surfaces: Vec<BoundSurface>,
    /// Bounds and facts of each surface's function.
    enclosures: Vec<(Interval, Facts)>,
    /// The parametric surfaces, if the program [has](Self::with_patches) them. Their numbers follow
    /// those of the surfaces.
    patches: Option<Vec<PatchSurface>>,
}

/// Time without a range is assumed to stay within ±`TIME`. For other times, code is compiled again.
const TIME: f64 = 16.0;

impl Program {
    /// Simplifies all surfaces of `document` over `domain`, for its parameters' values.
    ///
    /// # Errors
    /// If a formula is too large, depends on no coordinate, or is defined nowhere.
    pub fn new(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        let program = Self::drawn(document, domain)?;
        program.check(document)?;
        Ok(program)
    }

    /// The same program with the parametric surfaces of its document, which only pictures need.
    ///
    /// # Errors
    /// If a formula is too large, or a range of a parametric surface has no value.
    pub fn with_patches(self, document: &Document) -> Result<Self, ProgramError> {
        let patches = 0..document.patches.all.len();
        let patches = patches.map(|index| PatchSurface::new(document, index));
        Ok(Self { patches: Some(patches.collect::<Result<_, _>>()?), ..self })
    }

    /// As [`Program::new`], but also accepts constant and undefined formulas.
    ///
    /// # Errors
    /// If a formula is too large.
    pub fn drawn(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        Self::build(document, domain, true)
    }

    /// As [`Program::drawn`], but with the functions as typed, so that their values can be queried.
    /// [`Program::new`] may replace a function by another with the same zeros.
    ///
    /// # Errors
    /// If a formula is too large.
    pub fn unchecked(document: &Document, domain: [Interval; 3]) -> Result<Self, ProgramError> {
        Self::build(document, domain, false)
    }

    fn build(
        document: &Document,
        domain: [Interval; 3],
        is_drawn: bool,
    ) -> Result<Self, ProgramError> {
        let typed = typed(document);
        let parameters: Vec<Interval> = document.parameters.iter().map(assumed).collect();
        let solid = solid(document);
        let (mut graph, mut roots) = typed.clone();
        if is_drawn {
            // A picture needs only zeros and signs.
            roots = roots.iter().map(|root| same_sign(&mut graph, *root)).collect();
        }
        let (mut symbolic, mut rewritten) = rewrite(&graph, &roots, &domain, &parameters)?;
        if is_drawn {
            // Replaces functions by equal ones with narrower enclosures.
            let narrow = |root: &NodeId| {
                let root = quadratic_blends(&mut symbolic, *root);
                let root = algebraic_angles(&mut symbolic, root);
                bounded_logarithms(&mut symbolic, root)
            };
            let narrow: Vec<NodeId> = rewritten.iter().map(narrow).collect();
            if narrow != rewritten {
                (symbolic, rewritten) = rewrite(&symbolic, &narrow, &domain, &parameters)?;
            }
        }
        // Only the zeros of an equation are drawn, so multiple zeros may be replaced by simple
        // ones, which can be proven. Only the boundary of a solid's interior is drawn, so faces
        // that bound no interior may be dropped, and gaps without interior filled.
        let mut filled = vec![false; solid.len()];
        let drawn =
            |(index, (root, is_solid)): (usize, (&NodeId, &bool))| match (is_drawn, is_solid) {
                (true, false) => radical(&mut symbolic, *root),
                (true, true) => {
                    let without = without_gaps(&mut symbolic, *root, &parameters);
                    filled[index] = without != *root;
                    let holds_zeros = document.surfaces[index].holds_zeros;
                    regularize(&mut symbolic, without, holds_zeros, &domain, &parameters)
                }
                (false, _) => *root,
            };
        let drawn: Vec<NodeId> = rewritten.iter().zip(&solid).enumerate().map(drawn).collect();
        let same = rewritten.iter().zip(&drawn).map(|(before, after)| before == after);
        let same_signs = typed.1.iter().zip(&roots).map(|(before, after)| before == after);
        let reduced = same.zip(same_signs).map(|(zeros, signs)| !(zeros && signs)).collect();
        let (graph, roots) = simplify(&symbolic, &drawn, &domain, &parameters)?;
        let assumptions = Assumptions { domain, parameters };
        let before: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
        let nodes_before = count(&document.graph, &before);
        let simplified = Simplified {
            graph,
            roots,
            symbolic: (symbolic, drawn),
            typed,
            assumptions,
            nodes_before,
            cleared: solid.iter().map(|_| OnceLock::new()).collect(),
            solid,
            holds_zeros: holds_zeros(document),
            reduced,
            filled,
        };
        let store = CodeStore::new(Arc::new(simplified), Evaluator::Native);
        Ok(Self { exact: exact(document), ..Self::of(Arc::new(store), values(document)) })
    }

    /// The same program, run by `evaluator`. The result shares no kernels with `self`, and its list
    /// of kernels starts empty.
    #[must_use]
    pub fn on(&self, evaluator: Evaluator) -> Self {
        let store = CodeStore::new(Arc::clone(&self.store.simplified), evaluator);
        let on =
            |patches: &Vec<PatchSurface>| patches.iter().map(|patch| patch.on(evaluator)).collect();
        let patches = self.patches.as_ref().map(on);
        Self { patches, ..Self::of(Arc::new(store), self.values.to_vec()) }
    }

    /// From now on, kernels are compiled in half the time. Their code runs up to 1.7 times as long,
    /// until [`Program::optimize`] replaces it. Results have the same bits. This also applies to
    /// programs that share the code.
    pub fn hurry(&self) {
        self.store.hurry();
        self.patches().iter().for_each(|patch| patch.coordinates().hurry());
    }

    /// Optimizes the kernels compiled since [`Program::hurry`], in parallel. Later kernels are
    /// optimized when they are first requested. Checks `wanted` between kernels, and returns
    /// whether all are optimized. Kernels may be in use at the same time.
    pub fn optimize(&self, wanted: &(dyn Fn() -> bool + Sync)) -> bool {
        let mut all = self.patches().iter().map(PatchSurface::coordinates).chain([self]);
        all.all(|program| program.store.optimize(wanted))
    }

    /// The same program with the parameter values of another document. `None` if that document
    /// differs in more than values, or if the values are outside the assumed bounds. The assumed
    /// bounds of a slider are its range.
    ///
    /// # Errors
    /// If a formula depends on no coordinate or is defined nowhere.
    pub fn rebound(&self, document: &Document) -> Option<Result<Self, ProgramError>> {
        if !self.serves(document) {
            return None;
        }
        let rebound = |patches: &Vec<PatchSurface>| {
            let is_alike = document.patches.all.len() == patches.len();
            let patches = patches.iter().enumerate().filter(|_| is_alike);
            let rebound = patches.map(|(index, patch)| patch.rebound(document, index));
            rebound.collect::<Option<Vec<_>>>().filter(|_| is_alike)
        };
        let patches = match &self.patches {
            Some(patches) => Some(rebound(patches)?),
            None => None,
        };
        let program = Self { exact: exact(document), patches, ..self.with(values(document)) };
        Some(program.check(document).map(|()| program))
    }

    /// As [`Program::rebound`], but for a program that was made by [`Program::unchecked`].
    pub(crate) fn rebound_unchecked(&self, document: &Document) -> Option<Self> {
        let new = || Self { exact: exact(document), ..self.with(values(document)) };
        self.serves(document).then(new)
    }

    /// Returns whether a solid holds the points at which its function is 0. `None` if that is not
    /// known, or differs from point to point.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn holds_zeros(&self, surface: usize) -> Option<bool> {
        self.simplified().holds_zeros[surface]
    }

    /// Returns whether the code is valid for `document`. The document may differ from the program's
    /// own document only in parameter values, and only within the assumed bounds.
    pub fn serves(&self, document: &Document) -> bool {
        let Simplified { typed: before, assumptions, solid: solids, holds_zeros: zeros, .. } =
            &*self.store.simplified;
        let assumed = document.parameters.iter().map(assumed);
        assumed.eq(assumptions.parameters.iter().copied())
            && solid(document) == *solids
            && holds_zeros(document) == *zeros
            && typed(document) == *before
    }

    /// The same program for all times in the range of the document's time, if that has a range.
    /// Proofs of the program then hold at each of these times.
    #[must_use]
    pub fn over_time(&self, document: &Document) -> Self {
        match self.times(document) {
            Some((time, range)) => self.during(time, range),
            None => self.with(self.values.to_vec()),
        }
    }

    /// The same program for all values of one parameter in a range. Proofs of the program then hold
    /// at each of these values.
    pub(crate) fn during(&self, parameter: usize, range: Interval) -> Self {
        let mut values = self.values.to_vec();
        values[parameter] = range;
        self.with(values)
    }

    /// The place of the document's time in the list of parameters, and its range, if it has one.
    pub(crate) fn times(&self, document: &Document) -> Option<(usize, Interval)> {
        let has_range = |one: &Parameter| one.kind == ParameterKind::Time && one.range.is_some();
        let time = document.parameters.iter().position(has_range)?;
        Some((time, self.store.simplified.assumptions.parameters[time]))
    }

    fn with(&self, values: Vec<Interval>) -> Self {
        Self::of(Arc::clone(&self.store), values)
    }

    pub(crate) fn simplified(&self) -> &Simplified {
        &self.store.simplified
    }

    pub(crate) fn of(store: Arc<CodeStore>, values: Vec<Interval>) -> Self {
        let Simplified { graph, roots, assumptions, .. } = &*store.simplified;
        let values: Arc<[Interval]> = values.into();
        let assumptions = Assumptions { parameters: values.to_vec(), ..assumptions.clone() };
        let enclosures = zeroset_eval::enclose_all(graph, roots, &assumptions);
        let surface = |index| BoundSurface::new(&store, index, &values);
        let surfaces = (0..roots.len()).map(surface).collect();
        Self { store, values, exact: Arc::from([]), surfaces, enclosures, patches: None }
    }

    /// Refuses a function that is constant or undefined in all of space. [`Program::remarks`]
    /// reports a function that is constant in this domain only.
    fn check(&self, document: &Document) -> Result<(), ProgramError> {
        let surfaces = 0..document.surfaces.len();
        if surfaces.clone().all(|k| !self.is_undefined(k) && self.constant(k).is_none()) {
            return Ok(());
        }
        let everywhere = Self::unchecked(document, [Interval::ENTIRE; 3])?;
        for index in surfaces {
            let (echo, is_equation) = formula(&document.surfaces[index]);
            if everywhere.is_undefined(index) {
                return Err(ProgramError::Nowhere { echo });
            }
            if let Some(bounds) = everywhere.constant(index) {
                return Err(ProgramError::Constant { echo, value: describe(bounds, !is_equation) });
            }
        }
        Ok(())
    }

    /// The value of a surface's function if it is constant on the domain.
    fn constant(&self, surface: usize) -> Option<Interval> {
        let root = self.roots()[surface];
        let is_coordinate = |id: &NodeId| matches!(self.graph().node(*id), Node::Variable(_));
        let varies =
            self.is_undefined(surface) || self.graph().needed(&[root]).iter().any(is_coordinate);
        (!varies).then(|| self.enclosures[surface].0)
    }

    /// One line for each surface whose function is constant on this domain, but not everywhere, and
    /// for each solid that has no interior or is all of space.
    pub fn remarks(&self, document: &Document) -> Vec<String> {
        let remark = |(index, surface): (usize, &zeroset_syntax::Surface)| {
            let value = self.constant(index)?;
            let (echo, is_equation) = formula(surface);
            if surface.kind == SurfaceKind::Solid && self.is_reduced(index) {
                return Some(if value.lo > 0.0 {
                    format!(
                        "'{echo}' has no interior, so nothing of it is drawn; an equation, with '=', draws a surface"
                    )
                } else {
                    format!("'{echo}' is all of the domain, up to faces inside of it")
                });
            }
            let value = describe(value, !is_equation);
            Some(format!("'{echo}' is constant on this domain: {value}"))
        };
        document.surfaces.iter().enumerate().filter_map(remark).collect()
    }

    /// The simplified graph of all surfaces together.
    pub fn graph(&self) -> &Graph {
        &self.store.simplified.graph
    }

    /// The root of each surface's function in the graph.
    pub fn roots(&self) -> &[NodeId] {
        &self.store.simplified.roots
    }

    /// The bounds of x, y and z that the code is valid for.
    pub fn domain(&self) -> [Interval; 3] {
        self.store.simplified.assumptions.domain
    }

    /// The parameters' values, by number.
    pub fn values(&self) -> &[Interval] {
        &self.values
    }

    /// Numbers of nodes of all surfaces together: as typed, and after simplification.
    pub fn nodes(&self) -> (usize, usize) {
        let own = (self.store.simplified.nodes_before, count(self.graph(), self.roots()));
        let patches = self.patches().iter().map(|patch| patch.coordinates().nodes());
        patches.fold(own, |all, patch| (all.0 + patch.0, all.1 + patch.1))
    }

    /// Returns whether the typed function was replaced. The function of an equation is replaced by
    /// one with the same zeros, which are simple or have narrower enclosures. The function of a
    /// solid is replaced by one without zeros on faces inside of the solid and on sheets without
    /// thickness.
    pub fn is_reduced(&self, surface: usize) -> bool {
        self.store.simplified.reduced[surface]
    }

    /// Returns whether a surface is the boundary of a solid, given by an inequality.
    pub fn is_solid(&self, surface: usize) -> bool {
        self.store.simplified.solid[surface]
    }

    /// Returns whether quotients in the function of a solid were replaced by their continuous
    /// extensions.
    pub fn is_filled(&self, surface: usize) -> bool {
        self.store.simplified.filled[surface]
    }

    /// Returns whether a surface's function is proven to have no value on the whole domain.
    pub fn is_undefined(&self, surface: usize) -> bool {
        self.enclosures[surface].1.has(Facts::NOWHERE)
    }

    /// A surface, whose kernels are compiled on request. Programs that differ only in parameter
    /// values share the code. Parametric surfaces follow the others.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn surface(&self, surface: usize) -> &dyn SurfaceKernels {
        match self.patch(surface) {
            Some(patch) => patch,
            None => &self.surfaces[surface],
        }
    }

    /// The parametric surface with this number among all surfaces. `None` for an equation or a
    /// solid.
    pub fn patch(&self, surface: usize) -> Option<&PatchSurface> {
        self.patches().get(surface.checked_sub(self.surfaces.len())?)
    }

    /// The parametric surfaces; none if the program was made without them.
    fn patches(&self) -> &[PatchSurface] {
        self.patches.as_deref().unwrap_or_default()
    }

    /// A kernel of its own for the coordinates of a parametric surface.
    pub(crate) fn patch_kernel(&self) -> Result<Box<dyn Kernel<BoundPatches, f64>>, KernelError> {
        self.surfaces[0].patch_kernel()
    }

    /// A kernel of its own for a surface's function and its gradient.
    pub(crate) fn gradient_kernel(
        &self,
        surface: usize,
    ) -> Result<Box<dyn Kernel<SampleGradient, f64>>, KernelError> {
        self.surfaces[surface].gradient_kernel()
    }

    /// The kernels of a surface that compute in `T`.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn kernels<T: KernelFloat>(&self, surface: usize) -> &dyn Kernels<T> {
        T::kernels(self.surface(surface))
    }

    /// All kernels that were compiled so far, for any values of the parameters.
    pub fn made(&self) -> Vec<CompiledKernel> {
        let mut made = self.store.ledger.made();
        for (index, patch) in self.patches().iter().enumerate() {
            let surface = self.surfaces.len() + index;
            let own = patch.coordinates().made().into_iter();
            made.extend(own.map(|made| CompiledKernel { surface, ..made }));
        }
        made
    }

    /// The tape of a form of a surface's function, or `None` if the function has no such form.
    ///
    /// # Errors
    /// If the form is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn tape<T: KernelFloat>(
        &self,
        surface: usize,
        form: KernelSource,
    ) -> Result<Option<Tape<T>>, ProgramError> {
        Ok(self.store.simplified.steps(surface, form, true)?.map(|(tape, _)| tape))
    }

    /// A surface's rational form, or `None` if it has no poles that can be cleared.
    ///
    /// # Errors
    /// If the rational form is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn cleared(&self, surface: usize) -> Result<Option<&ClearedGraph>, ProgramError> {
        self.store.simplified.cleared(surface)
    }
}

/// All surfaces as typed, with parameters in exponents replaced by their values.
fn typed(document: &Document) -> (Graph, Vec<NodeId>) {
    let surfaces: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
    fix_exponents(&document.graph, &surfaces, &constants(document))
}

/// The values of the document's parameters.
pub(crate) fn constants(document: &Document) -> Vec<Constant> {
    document.parameters.iter().map(|parameter| parameter.value.clone()).collect()
}

fn holds_zeros(document: &Document) -> Vec<Option<bool>> {
    document.surfaces.iter().map(|surface| surface.holds_zeros).collect()
}

fn solid(document: &Document) -> Vec<bool> {
    document.surfaces.iter().map(|surface| surface.kind == SurfaceKind::Solid).collect()
}

fn values(document: &Document) -> Vec<Interval> {
    document.parameters.iter().map(|parameter| parameter.value.bounds()).collect()
}

fn exact(document: &Document) -> Arc<[Option<BigRational>]> {
    document.parameters.iter().map(|parameter| parameter.value.exact().cloned()).collect()
}

/// The range that a parameter is assumed to stay in: its own range if its value is inside, else the
/// value.
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

/// The formula of a surface, and whether it is an equation of two typed sides.
fn formula(surface: &zeroset_syntax::Surface) -> (String, bool) {
    match surface.echo.strip_suffix(" = 0") {
        Some(side) => (side.to_owned(), false),
        None => (surface.echo.clone(), true),
    }
}

/// A phrase about a constant function. `plain` is true if the function was typed as one expression,
/// not as two sides of an equation.
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
    use zeroset_eval::Boxes;
    use zeroset_syntax::{Options, read};

    fn program(formula: &str) -> Result<Program, ProgramError> {
        let document = read(formula, &Options::default()).expect("reads");
        Program::new(&document, [Interval { lo: -2.0, hi: 2.0 }; 3])
    }

    fn message(formula: &str) -> String {
        program(formula).err().expect("no surface").to_string()
    }

    #[test]
    fn what_depends_on_parameters_alone_is_computed_beforehand() {
        let rolling = program("w = 2\nsin(w)*x + cos(w)*y + z").expect("a surface");
        let tape =
            rolling.tape::<f32>(0, KernelSource::Function).expect("small").expect("a function");
        assert_eq!((tape.operations(), tape.parameters()), (4, 3));
    }

    /// If a uniform is undefined, code without uniforms is compiled. Later parameter values at
    /// which the uniform is undefined reuse that code.
    #[test]
    fn code_is_made_once_for_values_that_exist_and_once_for_others() {
        let document = |r: f64| {
            let text = format!("r = {r} in [0, 4]\nx*sqrt(r-3) + y");
            read(&text, &Options::default()).expect("reads")
        };
        let domain = [Interval { lo: -2.0, hi: 2.0 }; 3];
        let mut program = Program::unchecked(&document(2.0), domain).expect("small");
        for (r, exists, kernels) in
            [(2.0, false, 1), (3.5, true, 2), (1.0, false, 2), (4.0, true, 2)]
        {
            program = program
                .rebound(&document(r))
                .expect("within its range")
                .unwrap_or_else(|_| program.with(vec![Interval { lo: r, hi: r }]));
            let bounds = program.kernels::<f32>(0).bounds().expect("a kernel");
            let answer = &bounds.eval_all(&Boxes::around(&[[Interval::ONE; 3]]))[0];
            assert_eq!(answer.facts(0).has(Facts::DEFINED), exists, "{r}: {answer:?}");
            assert_eq!(program.made().len(), kernels, "{r}");
        }
    }

    #[test]
    fn what_is_compiled_in_a_hurry_is_compiled_again() {
        let text = "sin(x)*cos(y) + sqrt(x^2 + y^2 + z^2 + 1) - z/(x^2 + 1)";
        let request = |program: &Program| {
            let kernels = program.kernels::<f32>(0);
            assert!(kernels.tiles().is_ok() && kernels.gradients().is_ok());
        };
        let [hurried, patient] = [(); 2].map(|()| program(text).expect("a surface"));
        hurried.hurry();
        [&hurried, &patient].into_iter().for_each(request);
        let quick = hurried.made();
        assert_eq!((quick.len(), patient.made().len()), (2, 2));
        assert!(quick.iter().zip(patient.made()).all(|(one, other)| one.bytes != other.bytes));
        // An optimization that is not wanted is left for later.
        assert!(!hurried.optimize(&|| false));
        assert_eq!(hurried.made(), quick);
        assert!(hurried.optimize(&|| true));
        assert_eq!(hurried.made(), patient.made());
        // Later kernels are optimized at once.
        assert!(hurried.kernels::<f64>(0).tiles().is_ok());
        let before = hurried.made();
        assert!(hurried.optimize(&|| true));
        assert_eq!(hurried.made(), before);
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
            let parameters = program.values.to_vec();
            let assumptions = Assumptions { domain: left, parameters };
            zeroset_eval::enclose(program.graph(), program.roots()[0], &assumptions)
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
        // A formula that is undefined only on this domain is not refused.
        let elsewhere = program("sqrt(x-5)+y").expect("defined elsewhere");
        assert!(elsewhere.is_undefined(0));
        assert!(!program("sqrt(x)+y").expect("defined").is_undefined(0));
    }
}
