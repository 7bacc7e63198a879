//! The kernels of surfaces. A kernel is compiled once, at its first request, for all values of the
//! parameters. The size of its code is counted.
//!
//! Simplification and parameter values come from other modules. This module does not depend on what
//! kernels compute.

use crate::box_tree::BoxTree;
use crate::shortened::{LEAST_STEPS, ShortSurface, WholeFloat, WholeFunction};
use crate::simplified::{KernelSource, ProgramError, Simplified};
use crate::uniforms::Uniforms;
use rayon::prelude::*;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use zeroset_eval::{
    Binding, BoundPatches, BranchTest, ContractSegments, ContractTiles, Enclose, EncloseGradient,
    FindZeros, FindZerosInBranch, Kernel, KernelError, KernelFloat, KernelResult, Kernels,
    PartSurface, Query, Real, Reference, Sample, SampleGradient, SideTest, SurfaceKernels, Tape,
    TileTest, Tiles, ZeroTest,
};
use zeroset_interval::{Format, Interval};
use zeroset_ir::NodeId;
use zeroset_jit::{Compiled, Threaded};

/// Surfaces get kernels of their own until the functions of earlier surfaces have this many nodes
/// together. The kernels of so many nodes take about a second to compile. The decision depends on
/// the document alone, so that statuses do not depend on the order in which kernels are requested.
const COMPILED_NODES: usize = 4_000;

/// The evaluator that runs kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Evaluator {
    /// Native code.
    #[default]
    Native,
    /// Native code of whole functions only: parts of space do not get the steps that matter there.
    Whole,
    /// The reference evaluator: equal results bit for bit, but some hundred times slower.
    Reference,
}

/// Stands for the query of a kernel if a surface is drawn by stencils, not by kernels of its own.
const STENCILS: &str = "stencils";

/// A record of a compiled kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompiledKernel {
    /// Index of the kernel's surface.
    pub surface: usize,
    /// Name of the query that the kernel answers.
    pub question: &'static str,
    /// Form of the surface's function in the kernel.
    pub form: KernelSource,
    /// Floating-point format of the kernel.
    pub format: Format,
    /// Size of the machine code in bytes; 0 for stencils and for the reference evaluator.
    pub bytes: usize,
    /// Size in bytes of one vector of the kernel; 0 for stencils and for the reference evaluator.
    pub vector_bytes: usize,
}

impl CompiledKernel {
    /// The name of the kernel's floating-point format.
    pub fn floats(&self) -> &'static str {
        match self.format {
            Format::F32 => "f32",
            Format::F64 => "f64",
        }
    }

    /// The reason why a picture needs the kernel.
    pub fn reason(&self) -> &'static str {
        match (self.form, self.question) {
            (_, STENCILS) => "for the steps that matter in each part of space",
            (_, question) if question == ContractTiles::NAME => "to find the surface, tile by tile",
            (_, question) if question == ContractSegments::NAME => {
                "to find the surface, ray by ray"
            }
            (KernelSource::Function, question) if question == FindZeros::NAME => {
                "to find the surface"
            }
            (KernelSource::Function, question) if question == Sample::NAME => {
                "for places between samples, or normals by differences"
            }
            (KernelSource::Function, _) => "to tell one side from the other",
            (KernelSource::Numerator, question) if question == FindZeros::NAME => {
                "to prove that there is nothing at poles"
            }
            (KernelSource::Numerator | KernelSource::Denominator, _) => "for the cleared form",
            (KernelSource::Branches, _) => "to prove that there is nothing at jumps",
            (KernelSource::Gradient, question) if question == SampleGradient::NAME => "for normals",
            (KernelSource::Gradient, _) => "for proofs by slopes",
            (KernelSource::Coordinates, _) => "to find the surface, cell by cell",
        }
    }
}

impl fmt::Display for CompiledKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { question, form, bytes, .. } = self;
        write!(f, "{question} of {form}, {}, {bytes} bytes, {}", self.floats(), self.reason())
    }
}

/// All kernels of a program that were compiled so far.
#[derive(Debug, Default)]
pub(crate) struct KernelList(Mutex<Vec<CompiledKernel>>);

impl KernelList {
    /// All kernels compiled so far, sorted by surface.
    pub fn made(&self) -> Vec<CompiledKernel> {
        let mut made = self.list().clone();
        made.sort_by_key(|made| (made.surface, made.form, made.question, made.format as u8));
        made
    }

    /// Adds a kernel. Returns its number.
    fn add(&self, made: CompiledKernel) -> usize {
        let mut list = self.list();
        list.push(made);
        list.len() - 1
    }

    /// Records the size of better code for a kernel.
    fn resize<Q: Query, T: Real>(&self, number: usize, compiled: &Compiled<Q, T>) {
        let made = &mut self.list()[number];
        (made.bytes, made.vector_bytes) = (compiled.code_bytes(), compiled.vector_bytes());
    }

    /// Adds a surface that is drawn by stencils, if it is not listed yet.
    fn add_stencils(&self, surface: usize) {
        let (form, format) = (KernelSource::Function, Format::F32);
        let made =
            CompiledKernel { surface, question: STENCILS, form, format, bytes: 0, vector_bytes: 0 };
        let mut list = self.list();
        if !list.contains(&made) {
            list.push(made);
        }
    }

    fn list(&self) -> MutexGuard<'_, Vec<CompiledKernel>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The code of a kernel before parameter values are bound, and the uniforms that the code reads.
struct UnboundKernel<Q: Query, T: Real> {
    steps: Steps<Q, T>,
    uniforms: Uniforms,
}

/// The code of a kernel, and the values that are to be bound to it.
type ValuedCode<'a, Q, T> = (&'a UnboundKernel<Q, T>, Vec<Interval>);

enum Steps<Q: Query, T: Real> {
    Native(Compiled<Q, T>),
    /// The code is too large to compile, or that of earlier surfaces is.
    Stencils(Tape<T>),
    Reference(Tape<T>),
}

impl<Q: Query, T: Real> Steps<Q, T> {
    fn bind(&self, binding: Binding<T>) -> Result<Bound<Q, T>, KernelError> {
        Ok(match self {
            Self::Native(compiled) => Box::new(compiled.bind(binding)),
            Self::Stencils(tape) => {
                let threaded = Threaded::new(tape.clone(), &binding);
                Box::new(threaded.map_err(|error| Arc::new(error) as KernelError)?)
            }
            Self::Reference(tape) => Box::new(Reference::new(tape.clone(), binding)),
        })
    }
}

/// A kernel of some form in two variants. Each variant is compiled at most once. It holds the error
/// if compiling failed, and `None` if the surface has no such form.
///
/// Slot 0 has code that reads uniforms. Slot 1 has code without uniforms, for parameter values at
/// which a uniform is undefined.
type Slot<Q, T> = [Once<Option<UnboundKernel<Q, T>>>; 2];

/// The code of one surface in one precision.
#[derive(Default)]
struct SurfaceCode<T: Real> {
    zeros: Slot<FindZeros, T>,
    numerator_zeros: Slot<FindZeros, T>,
    branches: Slot<FindZerosInBranch, T>,
    bounds: Slot<Enclose, T>,
    numerator: Slot<Enclose, T>,
    denominator: Slot<Enclose, T>,
    segments: Slot<ContractSegments, T>,
    tiles: Slot<ContractTiles, T>,
    gradient_bounds: Slot<EncloseGradient, T>,
    values: Slot<Sample, T>,
    gradients: Slot<SampleGradient, T>,
    patches: Slot<BoundPatches, T>,
}

/// The code of one surface, in both precisions.
#[derive(Default)]
struct SurfaceCodes {
    single: Arc<SurfaceCode<f32>>,
    double: Arc<SurfaceCode<f64>>,
}

/// Replaces the code of a kernel by better code, and records its size. If that fails, the kernel
/// keeps its code.
type Optimization = Box<dyn Fn(&KernelList) + Send + Sync>;

/// The simplified surfaces of a program, and their code, which is compiled on request.
pub(crate) struct CodeStore {
    pub simplified: Arc<Simplified>,
    pub ledger: KernelList,
    evaluator: Evaluator,
    /// True while kernels are compiled [quickly](Compiled::quickly).
    is_hurried: AtomicBool,
    /// The optimizations that are left, one for each kernel that was compiled quickly.
    left: Mutex<Vec<Optimization>>,
    codes: Vec<SurfaceCodes>,
    /// For each surface, whether its kernels may be compiled. Otherwise stencils compute them, as
    /// also if a kernel turns out too large.
    may_compile: Vec<bool>,
}

impl CodeStore {
    pub fn new(simplified: Arc<Simplified>, evaluator: Evaluator) -> Self {
        let codes = simplified.roots.iter().map(|_| SurfaceCodes::default()).collect();
        let mut nodes = 0;
        let compiled = |root: &NodeId| {
            let may_compile = nodes < COMPILED_NODES;
            if may_compile {
                nodes += simplified.graph.needed(&[*root]).len();
            }
            may_compile
        };
        let may_compile = simplified.roots.iter().map(compiled).collect();
        Self {
            simplified,
            ledger: KernelList::default(),
            evaluator,
            is_hurried: AtomicBool::new(false),
            left: Mutex::default(),
            codes,
            may_compile,
        }
    }

    /// From now on, kernels are compiled quickly.
    pub fn hurry(&self) {
        self.is_hurried.store(true, Ordering::Relaxed);
    }

    /// Optimizes the kernels that were compiled quickly, in parallel, while `wanted` returns true.
    /// Returns whether none is left.
    pub fn optimize(&self, wanted: &(dyn Fn() -> bool + Sync)) -> bool {
        self.is_hurried.store(false, Ordering::Relaxed);
        let left = std::mem::take(&mut *self.left());
        let remains = |optimization: &Optimization| {
            let is_wanted = wanted();
            if is_wanted {
                optimization(&self.ledger);
            }
            !is_wanted
        };
        let left: Vec<_> = left.into_par_iter().filter(remains).collect();
        let is_done = left.is_empty();
        self.left().extend(left);
        is_done
    }

    fn left(&self) -> MutexGuard<'_, Vec<Optimization>> {
        self.left.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn make<Q: Query, T: Real>(
        &self,
        surface: usize,
        form: KernelSource,
        steps: Result<Option<(Tape<T>, Uniforms)>, ProgramError>,
    ) -> Result<Option<UnboundKernel<Q, T>>, ProgramError> {
        let Some((tape, uniforms)) = steps? else { return Ok(None) };
        let (question, format) = (Q::NAME, T::FORMAT);
        let mut made =
            CompiledKernel { surface, question, form, format, bytes: 0, vector_bytes: 0 };
        let is_hurried = self.is_hurried.load(Ordering::Relaxed);
        let compile = if is_hurried { Compiled::quickly } else { Compiled::new };
        // A test branch by branch is only an addition to the test of the function.
        let by_stencils = |tape: Tape<T>| (!tape.is_by_branches()).then_some(Steps::Stencils(tape));
        let steps = match self.evaluator {
            Evaluator::Reference => Some(Steps::Reference(tape)),
            Evaluator::Native | Evaluator::Whole if !self.may_compile[surface] => by_stencils(tape),
            Evaluator::Native | Evaluator::Whole => match compile(tape.clone()) {
                Ok(compiled) => {
                    made.bytes = compiled.code_bytes();
                    made.vector_bytes = compiled.vector_bytes();
                    Some(Steps::Native(compiled))
                }
                Err(error) if error.is_of_size() => by_stencils(tape),
                Err(error) => return Err(error.into()),
            },
        };
        let Some(steps) = steps else { return Ok(None) };
        let number = self.ledger.add(made);
        if is_hurried && let Steps::Native(compiled) = &steps {
            let compiled = compiled.clone();
            self.left().push(Box::new(move |ledger| {
                if compiled.optimize().is_ok() {
                    ledger.resize(number, &compiled);
                }
            }));
        }
        Ok(Some(UnboundKernel { steps, uniforms }))
    }
}

/// A kernel to which parameter values are bound.
type Bound<Q, T> = Box<dyn Kernel<Q, T>>;

/// A value that is created at most once, or the error if its creation failed.
type Once<K> = OnceLock<Result<K, KernelError>>;

/// The kernels of one surface in one precision, bound to the present parameter values.
#[derive(Default)]
struct BoundKernels<T: Real> {
    zeros: Once<Bound<FindZeros, T>>,
    bounds: Once<Bound<Enclose, T>>,
    numerator: Once<Bound<Enclose, T>>,
    denominator: Once<Bound<Enclose, T>>,
    segments: Once<Bound<ContractSegments, T>>,
    tiles: Once<Bound<ContractTiles, T>>,
    gradient_bounds: Once<Bound<EncloseGradient, T>>,
    values: Once<Bound<Sample, T>>,
    gradients: Once<Bound<SampleGradient, T>>,
    /// `None` if the function does not jump.
    branches: Once<Option<Arc<BranchTest<T>>>>,
}

/// The kernels of one surface in one precision, and what is needed to bind them.
struct Bindings<T: WholeFloat> {
    store: Arc<CodeStore>,
    surface: usize,
    values: Arc<[Interval]>,
    codes: Arc<SurfaceCode<T>>,
    bound: BoundKernels<T>,
    /// All steps of the function, for parts of space that can do with fewer of them; `None` if
    /// none can.
    short: Arc<OnceLock<Option<Short>>>,
    /// The gradient by parts of space.
    tree: Once<BoxTree<T>>,
}

/// All steps of a function, and its surface.
struct Short {
    whole: Arc<WholeFunction>,
    surface: ShortSurface,
}

/// A surface with its parameters bound to their present values.
pub(crate) struct BoundSurface {
    single: Bindings<f32>,
    double: Bindings<f64>,
}

impl BoundSurface {
    pub fn new(store: &Arc<CodeStore>, surface: usize, values: &Arc<[Interval]>) -> Self {
        let SurfaceCodes { single, double } = &store.codes[surface];
        let short = Arc::default();
        Self {
            single: Bindings::new(store, surface, values, single, &short),
            double: Bindings::new(store, surface, values, double, &short),
        }
    }
}

impl BoundSurface {
    /// A kernel of its own that approximates the functions of all surfaces of the program over
    /// cells of x and y.
    pub fn patch_kernel(&self) -> Result<Box<dyn Kernel<BoundPatches, f64>>, KernelError> {
        self.double.bind_always(&self.double.codes.patches, KernelSource::Coordinates)
    }

    /// A kernel of its own for the function and its gradient.
    pub fn gradient_kernel(&self) -> Result<Box<dyn Kernel<SampleGradient, f64>>, KernelError> {
        self.double.bind_always(&self.double.codes.gradients, KernelSource::Gradient)
    }
}

// If these were inlined in other crates, all kernels would be compiled there again.
impl SurfaceKernels for BoundSurface {
    #[inline(never)]
    fn single(&self) -> &dyn Kernels<f32> {
        &self.single
    }

    #[inline(never)]
    fn double(&self) -> &dyn Kernels<f64> {
        &self.double
    }
}

impl<T: WholeFloat> Bindings<T> {
    fn new(
        store: &Arc<CodeStore>,
        surface: usize,
        values: &Arc<[Interval]>,
        codes: &Arc<SurfaceCode<T>>,
        short: &Arc<OnceLock<Option<Short>>>,
    ) -> Self {
        let (store, values, codes) = (Arc::clone(store), Arc::clone(values), Arc::clone(codes));
        let short = Arc::clone(short);
        Self {
            store,
            surface,
            values,
            codes,
            bound: BoundKernels::default(),
            short,
            tree: OnceLock::new(),
        }
    }

    fn short(&self) -> Option<&Short> {
        self.short.get_or_init(|| self.find_short()).as_ref()
    }

    /// The steps of the function in both precisions. `None` if it has few choices, if it may
    /// jump or have poles, or if zeros are those of a numerator.
    fn find_short(&self) -> Option<Short> {
        let (surface, simplified) = (self.surface, &self.store.simplified);
        let (single, uniforms) = simplified.steps(surface, KernelSource::Function, true).ok()??;
        if self.store.evaluator != Evaluator::Native
            || single.steps().len() < LEAST_STEPS
            || single.may_jump()
            || self.without_poles().ok()? != KernelSource::Function
        {
            return None;
        }
        let values = uniforms.values(&self.values)?;
        let double = || {
            let steps = simplified.steps(surface, KernelSource::Function, true).ok()??;
            Some(steps.0)
        };
        let whole = Arc::new(WholeFunction::new(single, double, &values)?);
        self.store.ledger.add_stencils(surface);
        let surface = ShortSurface::new(&whole, whole.all());
        Some(Short { whole, surface })
    }

    /// The code of a form, bound to the present values. `None` if the surface has no such form.
    fn bind<Q: Query>(
        &self,
        slot: &Slot<Q, T>,
        form: KernelSource,
    ) -> Result<Option<Bound<Q, T>>, KernelError> {
        let Some((code, values)) = self.code(slot, form)? else { return Ok(None) };
        Ok(Some(code.steps.bind(Binding::new(&values))?))
    }

    /// The code of a form, and the values of the parameters and uniforms that it reads.
    fn code<'a, Q: Query>(
        &self,
        slot: &'a Slot<Q, T>,
        form: KernelSource,
    ) -> Result<Option<ValuedCode<'a, Q, T>>, KernelError> {
        for (slot, hoisted) in slot.iter().zip([true, false]) {
            if slot.get().is_none() {
                // Code that is not valid for the present values is not even compiled.
                let steps = self.store.simplified.steps(self.surface, form, hoisted);
                if let Ok(Some((_, uniforms))) = &steps
                    && uniforms.values(&self.values).is_none()
                {
                    continue;
                }
                let make = || self.store.make(self.surface, form, steps);
                slot.get_or_init(|| make().map_err(|error| Arc::new(error) as _));
            }
            let code = slot.get().expect("made").as_ref().map_err(Arc::clone)?;
            let Some(code) = code else { return Ok(None) };
            let Some(values) = code.uniforms.values(&self.values) else { continue };
            return Ok(Some((code, values)));
        }
        unreachable!("a program's values are within what it assumes")
    }

    /// The test of a function that jumps, branch by branch. `None` if it does not jump.
    fn branches(&self) -> Result<Option<Arc<BranchTest<T>>>, KernelError> {
        let make = || {
            let code = self.code(&self.codes.branches, KernelSource::Branches)?;
            let Some((code, values)) = code else { return Ok(None) };
            let test =
                BranchTest::new(&values, self.is_solid(), |binding| code.steps.bind(binding));
            Ok(Some(Arc::new(test?)))
        };
        self.bound.branches.get_or_init(make).clone()
    }

    /// As [`Bindings::bind`], but panics if the surface has no such form.
    fn bind_always<Q: Query>(
        &self,
        slot: &Slot<Q, T>,
        form: KernelSource,
    ) -> Result<Bound<Q, T>, KernelError> {
        Ok(self.bind(slot, form)?.expect("a form of the surface"))
    }

    /// The kernel of a form, bound when it is first requested.
    fn kernel<'a, Q: Query>(
        &self,
        bound: &'a Once<Bound<Q, T>>,
        slot: &Slot<Q, T>,
        form: KernelSource,
    ) -> KernelResult<'a, Q, T> {
        known(bound.get_or_init(|| self.bind_always(slot, form)))
    }

    fn zero_test(&self) -> Result<Bound<FindZeros, T>, KernelError> {
        let function = self.bind_always(&self.codes.zeros, KernelSource::Function)?;
        // The boundary of a solid includes the places where its function changes sign at a pole.
        let numerator = if self.is_solid() {
            None
        } else {
            self.bind(&self.codes.numerator_zeros, KernelSource::Numerator)?
        };
        let branches = self.branches()?;
        if numerator.is_none() && branches.is_none() {
            return Ok(function);
        }
        Ok(Box::new(ZeroTest { function, numerator, branches }))
    }

    fn is_solid(&self) -> bool {
        self.store.simplified.solid[self.surface]
    }

    fn has_cleared(&self) -> Result<bool, KernelError> {
        let cleared = self.store.simplified.cleared(self.surface);
        Ok(cleared.map_err(|error| Arc::new(error) as KernelError)?.is_some())
    }

    /// The numerator of the rational form. If there is none, or for a solid, the function.
    fn without_poles(&self) -> Result<KernelSource, KernelError> {
        // The boundary of a solid includes the places where its function changes sign at a pole.
        let is_cleared = !self.is_solid() && self.has_cleared()?;
        Ok(if is_cleared { KernelSource::Numerator } else { KernelSource::Function })
    }
}

fn known<Q, T>(bound: &Result<Bound<Q, T>, KernelError>) -> KernelResult<'_, Q, T> {
    bound.as_deref().map_err(Arc::clone)
}

impl<T: WholeFloat + KernelFloat> Kernels<T> for Bindings<T> {
    fn has_parts(&self) -> bool {
        self.short().is_some()
    }

    fn in_tiles(&self, tiles: &Tiles<T>) -> Vec<PartSurface> {
        self.short().map_or_else(Vec::new, |short| T::kernels(&short.surface).in_tiles(tiles))
    }

    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        if let Some(short) = self.short() {
            return T::kernels(&short.surface).zeros();
        }
        known(self.bound.zeros.get_or_init(|| self.zero_test()))
    }

    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        let make = || {
            let bounds = self.bind_always(&self.codes.bounds, KernelSource::Function)?;
            Ok(match self.branches()? {
                Some(branches) if self.is_solid() => Box::new(SideTest { bounds, branches }),
                Some(_) | None => bounds,
            })
        };
        known(self.bound.bounds.get_or_init(make))
    }

    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        if !self.has_cleared()? {
            return Ok(None);
        }
        let Self { codes, bound, .. } = self;
        let numerator = self.kernel(&bound.numerator, &codes.numerator, KernelSource::Numerator)?;
        let denominator =
            self.kernel(&bound.denominator, &codes.denominator, KernelSource::Denominator)?;
        Ok(Some([numerator, denominator]))
    }

    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        if let Some(short) = self.short() {
            return T::kernels(&short.surface).segments();
        }
        self.kernel(&self.bound.segments, &self.codes.segments, self.without_poles()?)
    }

    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        if let Some(short) = self.short() {
            return T::kernels(&short.surface).tiles();
        }
        let make = || {
            let tiles = self.bind_always(&self.codes.tiles, self.without_poles()?)?;
            Ok(match self.branches()? {
                Some(branches) => {
                    let domain = self.store.simplified.assumptions.domain;
                    Box::new(TileTest { tiles, branches, domain })
                }
                None => tiles,
            })
        };
        known(self.bound.tiles.get_or_init(make))
    }

    fn gradient_bounds(&self) -> KernelResult<'_, EncloseGradient, T> {
        self.kernel(
            &self.bound.gradient_bounds,
            &self.codes.gradient_bounds,
            KernelSource::Gradient,
        )
    }

    fn values(&self) -> KernelResult<'_, Sample, T> {
        self.kernel(&self.bound.values, &self.codes.values, KernelSource::Function)
    }

    fn gradients(&self) -> KernelResult<'_, SampleGradient, T> {
        if let Some(short) = self.short() {
            return match self.tree.get_or_init(|| BoxTree::new(&short.whole)) {
                Ok(tree) => Ok(tree),
                Err(error) => Err(Arc::clone(error)),
            };
        }
        self.kernel(&self.bound.gradients, &self.codes.gradients, KernelSource::Gradient)
    }
}
