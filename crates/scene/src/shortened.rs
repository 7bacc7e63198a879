//! The surface in a part of space: kernels that run only the steps that matter there.

use std::sync::{Arc, OnceLock};
use zeroset_eval::{
    Binding, Boxes, Clauses, ContractSegments, ContractTiles, DecidingSteps, Enclose, Enclosures,
    FindZeros, Kernel, KernelError, KernelResult, Kernels, LANES, LaneSet, PartSurface, Query,
    Real, Sample, SampleForward, Selection, Shortener, SurfaceKernels, Tape, Tiles,
};
use zeroset_interval::Interval;
use zeroset_jit::{StencilTape, Threaded};

/// Least number of steps whose bounds decide which steps can be dropped. With fewer, choosing takes
/// longer than it saves. A whole formula with fewer is compiled, which is faster than stencils.
const LEAST_DECIDING: usize = 32;
/// Least number of products that count as choices. By parts, a product of 1,000 planes takes a
/// third of the time, but one of 300 planes a third more time and six times the memory.
const LEAST_PRODUCTS: usize = 500;
/// Least number of steps of a function whose parts get kernels of their own.
pub(crate) const LEAST_STEPS: usize = 256;
/// Least number of clauses that share code. Compiling it takes as long as some thousand evaluations
/// of a clause, step by step.
const LEAST_SHARED: usize = 32;
/// A selection is used if it has at most this share of the steps.
const WORTHWHILE: f64 = 0.8;

/// A function in both precisions, with bound parameters. Both tapes have the same steps.
pub(crate) struct WholeFunction {
    single: WholeTape<f32>,
    double: WholeTape<f64>,
    /// All steps.
    all: Arc<Selection>,
    /// The rules of both tapes. Constants of `f32` have the wider bounds, so they hold for `f64`.
    shortener: Shortener,
}

/// The steps of a function in one precision, with bound parameters.
pub(crate) struct WholeTape<T: Real> {
    pub tape: Arc<Tape<T>>,
    binding: Binding<T>,
    clauses: Arc<Clauses>,
    stencils: Stencils<T>,
    bounds: OnceThreaded<Enclose, T>,
}

impl<T: Real> WholeTape<T> {
    fn new(tape: Tape<T>, values: &[Interval], clauses: &Arc<Clauses>) -> Self {
        Self {
            tape: Arc::new(clauses.coarse(tape)),
            binding: Binding::new(values),
            clauses: Arc::clone(clauses),
            stencils: Stencils::default(),
            bounds: OnceLock::new(),
        }
    }

    /// The stencils for one query.
    fn stencils<Q: Query>(
        &self,
        of: impl Fn(&Stencils<T>) -> &OnceStencils<Q, T>,
    ) -> Result<&Arc<StencilTape<Q, T>>, KernelError> {
        let make = || {
            let stencils = StencilTape::new(&self.tape, &self.binding, &self.clauses).map(Arc::new);
            stencils.map_err(|error| Arc::new(error) as _)
        };
        of(&self.stencils).get_or_init(make).as_ref().map_err(Arc::clone)
    }
}

impl WholeFunction {
    /// Examines the steps of a function. `None` if it has too few choices: then parts of space need
    /// nearly as many steps. `double` makes the tape of 64 bits, if there are enough.
    ///
    /// # Panics
    /// If the tapes differ in their steps.
    pub fn new(
        single: Tape<f32>,
        double: impl FnOnce() -> Option<Tape<f64>>,
        values: &[Interval],
    ) -> Option<Self> {
        let shortener = Shortener::new(&single, values, LEAST_SHARED);
        let products = shortener.products();
        // A product has two factors.
        let others = if products < LEAST_PRODUCTS { 2 * products } else { 0 };
        if shortener.choices() < LEAST_DECIDING + others {
            return None;
        }
        let double = double()?;
        assert!(single.has_steps_of(&double), "one selection is of both tapes");
        let all = shortener.all(&single);
        let clauses = shortener.clauses();
        let single = WholeTape::new(single, values, clauses);
        let double = WholeTape::new(double, values, clauses);
        Some(Self { single, double, all: Arc::new(all), shortener })
    }

    /// All steps of the function.
    pub fn all(&self) -> &Arc<Selection> {
        &self.all
    }
}

/// A float type with a tape of a [`WholeFunction`].
pub(crate) trait WholeFloat: Real {
    fn whole(function: &WholeFunction) -> &WholeTape<Self>;
}

impl WholeFloat for f32 {
    fn whole(function: &WholeFunction) -> &WholeTape<Self> {
        &function.single
    }
}

impl WholeFloat for f64 {
    fn whole(function: &WholeFunction) -> &WholeTape<Self> {
        &function.double
    }
}

/// A kernel that is created when it is first requested.
type OnceThreaded<Q, T> = OnceLock<Result<Box<Threaded<Q, T>>, KernelError>>;

/// Borrows a kernel, or the error of its creation.
fn borrowed<Q: Query, T: Real>(
    once: &Result<Box<Threaded<Q, T>>, KernelError>,
) -> KernelResult<'_, Q, T> {
    once.as_ref().map(|kernel| &**kernel as _).map_err(Arc::clone)
}

/// Moves a new kernel to the heap, and shares the error of its creation.
fn boxed<Q: Query, T: Real>(
    threaded: Result<Threaded<Q, T>, zeroset_jit::Error>,
) -> Result<Box<Threaded<Q, T>>, KernelError> {
    threaded.map(Box::new).map_err(|error| Arc::new(error) as _)
}

/// The stencils of a whole function for one query.
type OnceStencils<Q, T> = OnceLock<Result<Arc<StencilTape<Q, T>>, KernelError>>;

/// The stencils of a whole function, for each query that needs them.
#[derive(Default)]
struct Stencils<T: Real> {
    zeros: OnceStencils<FindZeros, T>,
    bounds: OnceStencils<Enclose, T>,
    segments: OnceStencils<ContractSegments, T>,
    tiles: OnceStencils<ContractTiles, T>,
    values: OnceStencils<Sample, T>,
    forward: OnceStencils<SampleForward, T>,
}

/// The surface in a part of space.
pub(crate) struct ShortSurface {
    single: ShortKernels<f32>,
    double: ShortKernels<f64>,
}

impl ShortSurface {
    /// The surface with some of its steps.
    pub fn new(whole: &Arc<WholeFunction>, selection: &Arc<Selection>) -> Self {
        Self {
            single: ShortKernels::new(whole, selection),
            double: ShortKernels::new(whole, selection),
        }
    }
}

// If these were inlined in other crates, all kernels would be compiled there again.
impl SurfaceKernels for ShortSurface {
    #[inline(never)]
    fn single(&self) -> &dyn Kernels<f32> {
        &self.single
    }

    #[inline(never)]
    fn double(&self) -> &dyn Kernels<f64> {
        &self.double
    }
}

/// The kernels of a [`ShortSurface`] in one precision.
pub(crate) struct ShortKernels<T: WholeFloat> {
    whole: Arc<WholeFunction>,
    selection: Arc<Selection>,
    /// The steps whose bounds decide what can be dropped; `None` if there are too few.
    deciding: OnceLock<Option<DecidingSteps>>,
    zeros: OnceThreaded<FindZeros, T>,
    bounds: OnceThreaded<Enclose, T>,
    segments: OnceThreaded<ContractSegments, T>,
    tiles: OnceThreaded<ContractTiles, T>,
    values: OnceThreaded<Sample, T>,
    forward: OnceThreaded<SampleForward, T>,
}

impl<T: WholeFloat> ShortKernels<T> {
    pub fn new(whole: &Arc<WholeFunction>, selection: &Arc<Selection>) -> Self {
        Self {
            whole: Arc::clone(whole),
            selection: Arc::clone(selection),
            deciding: OnceLock::new(),
            zeros: OnceLock::new(),
            bounds: OnceLock::new(),
            segments: OnceLock::new(),
            tiles: OnceLock::new(),
            values: OnceLock::new(),
            forward: OnceLock::new(),
        }
    }

    /// Returns the kernel for a query, and creates it if it is the first such request. `of` finds
    /// the stencils of the query.
    fn kernel<'a, Q: Query>(
        &self,
        once: &'a OnceThreaded<Q, T>,
        of: impl Fn(&Stencils<T>) -> &OnceStencils<Q, T>,
    ) -> KernelResult<'a, Q, T> {
        let make = || {
            let stencils = T::whole(&self.whole).stencils(of)?;
            boxed(Threaded::selected(stencils, &self.selection))
        };
        borrowed(once.get_or_init(make))
    }

    /// The kernel that samples the function and propagates its gradient forward.
    pub fn forward(&self) -> KernelResult<'_, SampleForward, T> {
        self.kernel(&self.forward, |stencils| &stencils.forward)
    }

    /// The function of which steps are selected.
    pub fn whole(&self) -> &Arc<WholeFunction> {
        &self.whole
    }

    /// The steps whose bounds decide what can be dropped; `None` if there are too few.
    fn deciding(&self) -> Option<&DecidingSteps> {
        let find = || {
            let deciding = self.whole.shortener.deciding(&self.selection);
            (deciding.positions().len() >= LEAST_DECIDING).then_some(deciding)
        };
        self.deciding.get_or_init(find).as_ref()
    }

    /// The steps that matter in each box. `possible` tells from bounds of the function in which
    /// boxes they are wanted. `None` if the function has too few choices.
    pub fn in_boxes(
        &self,
        boxes: &Boxes<T>,
        possible: impl Fn(&Enclosures<T>) -> LaneSet,
    ) -> Option<Vec<PartSelection>> {
        let (whole, selection) = (T::whole(&self.whole), &self.selection);
        let deciding = self.deciding()?;
        let stencils = whole.stencils(|stencils| &stencils.bounds).ok()?;
        let traced = Threaded::traced(stencils, selection, deciding).ok()?;
        let most = (selection.steps().len() as f64 * WORTHWHILE) as usize;
        let count = boxes.count as usize;
        Some(traced.eval_traced(boxes, &mut Enclosures::default(), |enclosures, bounds| {
            let open = possible(enclosures) & LaneSet::MAX >> (LANES - count);
            let shortener = &self.whole.shortener;
            let chosen = shortener.select(&whole.tape, selection, deciding, bounds, open, most);
            let part = |(lane, short): (usize, Option<Selection>)| match short {
                Some(short) => PartSelection::Short(Arc::new(short)),
                None if open >> lane & 1 == 1 => PartSelection::Same,
                None => PartSelection::Empty,
            };
            chosen.into_iter().take(count).enumerate().map(part).collect()
        }))
    }
}

/// The steps of a function that matter in a part of space.
pub(crate) enum PartSelection {
    /// There is no zero in the part.
    Empty,
    /// Nearly all steps matter.
    Same,
    /// These steps matter.
    Short(Arc<Selection>),
}

impl<T: WholeFloat> Kernels<T> for ShortKernels<T> {
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        self.kernel(&self.zeros, |stencils| &stencils.zeros)
    }

    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        // Brackets of zeros are also sought beyond the part, where its steps prove nothing.
        let whole = T::whole(&self.whole);
        let make = || {
            let stencils = whole.stencils(|stencils| &stencils.bounds)?;
            boxed(Threaded::selected(stencils, &self.whole.all))
        };
        borrowed(whole.bounds.get_or_init(make))
    }

    fn bounds_in_part(&self) -> Option<KernelResult<'_, Enclose, T>> {
        Some(self.kernel(&self.bounds, |stencils| &stencils.bounds))
    }

    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }

    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        self.kernel(&self.segments, |stencils| &stencils.segments)
    }

    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        self.kernel(&self.tiles, |stencils| &stencils.tiles)
    }

    fn values(&self) -> KernelResult<'_, Sample, T> {
        self.kernel(&self.values, |stencils| &stencils.values)
    }

    fn has_parts(&self) -> bool {
        self.deciding().is_some()
    }

    fn in_tiles(&self, tiles: &Tiles<T>) -> Vec<PartSurface> {
        // Bounds over boxes are wider than those of forms, but take far less time.
        let (boxes, inside) = tiles.boxes(&T::whole(&self.whole).tape.assumptions().domain);
        let surface = |selection| match selection {
            PartSelection::Empty => PartSurface::Empty,
            PartSelection::Same => PartSurface::Same,
            PartSelection::Short(short) => {
                PartSurface::Short(Box::new(ShortSurface::new(&self.whole, &short)))
            }
        };
        let selections = self.in_boxes(&boxes, |bounds| inside & bounds.possible());
        selections.into_iter().flatten().map(surface).collect()
    }
}
