//! Surfaces as far as a part of space is concerned: kernels of the steps that matter there.

use std::sync::{Arc, OnceLock};
use zeroset_eval::{
    Binding, Boxes, ContractSegments, ContractTiles, Enclose, FindZeros, Input, Kernel,
    KernelError, KernelResult, Kernels, PartSurface, Planes, Query, Real, Sample, SampleForward,
    Selection, Shortener, SurfaceKernels, Tape, Tiles,
};
use zeroset_interval::Interval;
use zeroset_jit::{TapeConstants, Threaded};

/// Least number of steps whose bounds decide what can be dropped. A formula with fewer has a kernel
/// of its own that is faster than stencils.
const LEAST_DECIDING: usize = 32;
/// Least number of steps of a function whose parts get kernels of their own.
const LEAST_STEPS: usize = 256;
/// A selection is used if it has at most this share of the steps.
const WORTHWHILE: f64 = 0.8;

/// The steps of a function in both precisions, with bound parameters. Both tapes have the same
/// steps.
pub(crate) struct WholeFunction {
    single: WholeTape<f32>,
    double: WholeTape<f64>,
}

/// The steps of a function in one precision, with bound parameters.
pub(crate) struct WholeTape<T: Real> {
    pub tape: Tape<T>,
    binding: Binding<T>,
    pools: Pools<T>,
    bounds: OnceThreaded<Enclose, T>,
}

impl<T: Real> WholeTape<T> {
    fn new(tape: Tape<T>, values: &[Interval]) -> Self {
        let binding = Binding::new(values);
        Self { tape: tape.coarse(), binding, pools: Pools::default(), bounds: OnceLock::new() }
    }

    /// The constants for one query.
    fn constants<Q: Query>(
        &self,
        pool: impl Fn(&Pools<T>) -> &OncePool<Q, T>,
    ) -> Result<&Arc<TapeConstants<Q, T>>, KernelError> {
        let make = || {
            let constants = TapeConstants::new(&self.tape, &self.binding).map(Arc::new);
            constants.map_err(|error| Arc::new(error) as _)
        };
        pool(&self.pools).get_or_init(make).as_ref().map_err(Arc::clone)
    }
}

impl WholeFunction {
    pub fn new(single: Tape<f32>, double: Tape<f64>, values: &[Interval]) -> Self {
        Self { single: WholeTape::new(single, values), double: WholeTape::new(double, values) }
    }

    /// Returns whether the function has so many choices that parts of space can do with far fewer
    /// steps.
    pub fn is_worth_shortening(tape: &Tape<f32>) -> bool {
        tape.steps().len() >= LEAST_STEPS && Shortener::new(tape).deciding().len() >= LEAST_DECIDING
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
type OnceThreaded<Q, T> = OnceLock<Result<Threaded<Q, T>, KernelError>>;

/// Returns a kernel, or the error of its creation.
fn known<Q: Query, T: Real>(once: &Result<Threaded<Q, T>, KernelError>) -> KernelResult<'_, Q, T> {
    once.as_ref().map(|kernel| kernel as _).map_err(Arc::clone)
}

/// The constants of a whole function for one query.
type OncePool<Q, T> = OnceLock<Result<Arc<TapeConstants<Q, T>>, KernelError>>;

/// The constants of a whole function, for each query that needs them.
#[derive(Default)]
struct Pools<T: Real> {
    zeros: OncePool<FindZeros, T>,
    bounds: OncePool<Enclose, T>,
    segments: OncePool<ContractSegments, T>,
    tiles: OncePool<ContractTiles, T>,
    values: OncePool<Sample, T>,
    forward: OncePool<SampleForward, T>,
}

/// The surface in a part of space.
pub(crate) struct ShortSurface {
    single: ShortKernels<f32>,
    double: ShortKernels<f64>,
}

impl ShortSurface {
    /// The surface with a selection of the steps; `None` stands for all.
    pub fn new(whole: &Arc<WholeFunction>, selection: Option<Selection>) -> Self {
        let selection = Arc::new(selection);
        Self {
            single: ShortKernels::new(whole, &selection),
            double: ShortKernels::new(whole, &selection),
        }
    }
}

impl SurfaceKernels for ShortSurface {
    fn single(&self) -> &dyn Kernels<f32> {
        &self.single
    }

    fn double(&self) -> &dyn Kernels<f64> {
        &self.double
    }
}

/// The kernels of a [`ShortSurface`] in one precision.
pub(crate) struct ShortKernels<T: WholeFloat> {
    whole: Arc<WholeFunction>,
    selection: Arc<Option<Selection>>,
    tape: OnceLock<Tape<T>>,
    zeros: OnceThreaded<FindZeros, T>,
    segments: OnceThreaded<ContractSegments, T>,
    tiles: OnceThreaded<ContractTiles, T>,
    values: OnceThreaded<Sample, T>,
    forward: OnceThreaded<SampleForward, T>,
    shortener: OnceLock<Shortener>,
    /// Kernels that also trace bounds.
    traced_tiles: OnceThreaded<ContractTiles, T>,
    traced_boxes: OnceThreaded<Enclose, T>,
}

impl<T: WholeFloat> ShortKernels<T> {
    pub fn new(whole: &Arc<WholeFunction>, selection: &Arc<Option<Selection>>) -> Self {
        Self {
            whole: Arc::clone(whole),
            selection: Arc::clone(selection),
            tape: OnceLock::new(),
            zeros: OnceLock::new(),
            segments: OnceLock::new(),
            tiles: OnceLock::new(),
            values: OnceLock::new(),
            forward: OnceLock::new(),
            shortener: OnceLock::new(),
            traced_tiles: OnceLock::new(),
            traced_boxes: OnceLock::new(),
        }
    }

    fn tape(&self) -> &Tape<T> {
        let whole = T::whole(&self.whole);
        match &*self.selection {
            Some(selection) => self.tape.get_or_init(|| whole.tape.select(selection)),
            None => &whole.tape,
        }
    }

    /// Creates a kernel that also traces the bounds of some steps.
    fn create<Q: Query>(
        &self,
        pool: impl Fn(&Pools<T>) -> &OncePool<Q, T>,
        traced: &[usize],
    ) -> Result<Threaded<Q, T>, KernelError> {
        let constants = T::whole(&self.whole).constants(pool)?;
        let selection = self.selection.as_ref().as_ref();
        Threaded::selected(self.tape().clone(), selection, constants, traced)
            .map_err(|error| Arc::new(error) as _)
    }

    fn kernel<'a, Q: Query>(
        &self,
        once: &'a OnceThreaded<Q, T>,
        pool: impl Fn(&Pools<T>) -> &OncePool<Q, T>,
    ) -> KernelResult<'a, Q, T> {
        known(once.get_or_init(|| self.create(pool, &[])))
    }

    /// The kernel that samples the function and propagates its gradient forward.
    pub fn forward(&self) -> KernelResult<'_, SampleForward, T> {
        self.kernel(&self.forward, |pools| &pools.forward)
    }

    /// The function of which steps are selected.
    pub fn whole(&self) -> &Arc<WholeFunction> {
        &self.whole
    }

    /// The steps that matter in each box.
    pub fn selections_in_boxes(&self, boxes: &Boxes<T>) -> Option<Vec<PartSelection>> {
        self.selections(&self.traced_boxes, |pools| &pools.bounds, boxes, |_| u16::MAX)
    }

    /// The steps that matter in each lane of a batch. `possible` tells from a result in which lanes
    /// there may be a zero. `None` if the function has too few choices.
    fn selections<Q: Query>(
        &self,
        once: &OnceThreaded<Q, T>,
        pool: impl Fn(&Pools<T>) -> &OncePool<Q, T>,
        input: &Q::Input<T>,
        possible: impl Fn(&Q::Output<T>) -> u16,
    ) -> Option<Vec<PartSelection>> {
        let tape = self.tape();
        let shortener = self.shortener.get_or_init(|| Shortener::new(tape));
        if shortener.deciding().len() < LEAST_DECIDING {
            return None;
        }
        let create = || self.create(pool, shortener.deciding());
        let traced = once.get_or_init(create).as_ref().ok()?;
        let most = (tape.steps().len() as f64 * WORTHWHILE) as usize;
        Some(traced.eval_traced(input, &mut Q::Output::default(), |output, trace| {
            let possible = possible(output);
            let part = |lane: usize| {
                if possible >> lane & 1 == 0 {
                    return PartSelection::Empty;
                }
                match shortener.select(tape, &trace.lane(lane)) {
                    Some(short) if short.count() <= most => {
                        PartSelection::Short(match &*self.selection {
                            Some(outer) => short.from_outer(outer),
                            None => short,
                        })
                    }
                    _ => PartSelection::Same,
                }
            };
            (0..input.count()).map(part).collect()
        }))
    }
}

/// The steps of a function that matter in a part of space.
pub(crate) enum PartSelection {
    /// There is no zero in the part.
    Empty,
    /// Nearly all steps matter.
    Same,
    /// These steps of the whole function matter.
    Short(Selection),
}

impl<T: WholeFloat> Kernels<T> for ShortKernels<T> {
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        self.kernel(&self.zeros, |pools| &pools.zeros)
    }

    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        // Brackets of zeros are also sought beyond the part, where its steps prove nothing.
        let whole = T::whole(&self.whole);
        let make = || {
            let constants = whole.constants(|pools| &pools.bounds)?;
            Threaded::selected(whole.tape.clone(), None, constants, &[])
                .map_err(|error| Arc::new(error) as KernelError)
        };
        known(whole.bounds.get_or_init(make))
    }

    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }

    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        self.kernel(&self.segments, |pools| &pools.segments)
    }

    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        // A kernel that also traces gives the same results, so no other has to be created.
        if let Some(Ok(traced)) = self.traced_tiles.get() {
            return Ok(traced);
        }
        self.kernel(&self.tiles, |pools| &pools.tiles)
    }

    fn values(&self) -> KernelResult<'_, Sample, T> {
        self.kernel(&self.values, |pools| &pools.values)
    }

    fn in_tiles(&self, tiles: &Tiles<T>) -> Vec<PartSurface> {
        let possible = |planes: &Planes<T>| planes.possible;
        let surface = |selection| match selection {
            PartSelection::Empty => PartSurface::Empty,
            PartSelection::Same => PartSurface::Same,
            PartSelection::Short(short) => {
                PartSurface::Short(Box::new(ShortSurface::new(&self.whole, Some(short))))
            }
        };
        let selections = self.selections(&self.traced_tiles, |pools| &pools.tiles, tiles, possible);
        selections.into_iter().flatten().map(surface).collect()
    }
}
