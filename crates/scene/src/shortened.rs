//! Surfaces as far as a part of space is concerned: kernels of the steps that matter there.

use std::sync::{Arc, OnceLock};
use zeroset_eval::{
    Binding, ContractSegments, ContractTiles, Enclose, FindZeros, Kernel, KernelError,
    KernelResult, Kernels, LANES, PartSurface, Planes, Query, Real, Sample, Selection,
    SurfaceKernels, Tape, Tiles,
};
use zeroset_jit::Threaded;

/// Least number of steps whose bounds decide what can be dropped. A formula with fewer has a kernel
/// of its own that is faster than stencils.
const LEAST_DECIDING: usize = 24;
/// A selection is used if it has at most this share of the steps.
const WORTHWHILE: f64 = 0.8;

/// The steps of a function in both precisions, with bound parameters. Both tapes have the same
/// steps.
pub(crate) struct WholeFunction {
    pub single: (Tape<f32>, Binding<f32>),
    pub double: (Tape<f64>, Binding<f64>),
}

impl WholeFunction {
    /// Returns whether the function has so many choices that parts of space can do with far fewer
    /// steps.
    pub fn is_worth_shortening(tape: &Tape<f32>) -> bool {
        tape.deciding_steps().len() >= LEAST_DECIDING
    }
}

/// A float type with a tape of a [`WholeFunction`].
pub(crate) trait WholeFloat: Real {
    fn whole(function: &WholeFunction) -> &(Tape<Self>, Binding<Self>);
}

impl WholeFloat for f32 {
    fn whole(function: &WholeFunction) -> &(Tape<Self>, Binding<Self>) {
        &function.single
    }
}

impl WholeFloat for f64 {
    fn whole(function: &WholeFunction) -> &(Tape<Self>, Binding<Self>) {
        &function.double
    }
}

/// A kernel that is created when it is first requested.
type Once<Q, T> = OnceLock<Result<Threaded<Q, T>, KernelError>>;

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
    zeros: Once<FindZeros, T>,
    bounds: Once<Enclose, T>,
    segments: Once<ContractSegments, T>,
    tiles: Once<ContractTiles, T>,
    values: Once<Sample, T>,
    /// The kernel that also traces bounds.
    traced: Once<ContractTiles, T>,
}

impl<T: WholeFloat> ShortKernels<T> {
    fn new(whole: &Arc<WholeFunction>, selection: &Arc<Option<Selection>>) -> Self {
        Self {
            whole: Arc::clone(whole),
            selection: Arc::clone(selection),
            tape: OnceLock::new(),
            zeros: OnceLock::new(),
            bounds: OnceLock::new(),
            segments: OnceLock::new(),
            tiles: OnceLock::new(),
            values: OnceLock::new(),
            traced: OnceLock::new(),
        }
    }

    fn tape(&self) -> &Tape<T> {
        self.tape.get_or_init(|| {
            let (tape, _) = T::whole(&self.whole);
            match &*self.selection {
                Some(selection) => tape.select(selection),
                None => tape.clone(),
            }
        })
    }

    fn kernel<'a, Q: Query>(&self, once: &'a Once<Q, T>) -> KernelResult<'a, Q, T> {
        let make = || {
            let (_, binding) = T::whole(&self.whole);
            Threaded::new(self.tape().clone(), binding).map_err(|error| Arc::new(error) as _)
        };
        match once.get_or_init(make) {
            Ok(kernel) => Ok(kernel),
            Err(error) => Err(Arc::clone(error)),
        }
    }

    /// The surface in the part of space of each tile.
    fn parts(&self, tiles: &Tiles<T>) -> Option<Vec<PartSurface>> {
        let tape = self.tape();
        let make = || {
            let (_, binding) = T::whole(&self.whole);
            Threaded::traced(tape.clone(), binding, &tape.deciding_steps())
                .map_err(|error| Arc::new(error) as KernelError)
        };
        let traced = self.traced.get_or_init(make).as_ref().ok()?;
        let most = (tape.steps().len() as f64 * WORTHWHILE) as usize;
        let mut planes = Planes::default();
        let parts = traced.eval_traced(tiles, &mut planes, |trace| {
            let part = |lane: usize| {
                let short = tape.shortened(&trace.lane(lane)).filter(|short| short.len() <= most);
                short.map(|short| match &*self.selection {
                    Some(outer) => short.from_outer(outer),
                    None => short,
                })
            };
            (0..(tiles.count as usize).min(LANES)).map(part).collect::<Vec<_>>()
        });
        let surface = |(lane, selection): (usize, Option<Selection>)| match selection {
            _ if std::env::var("NOEMPTY").is_err() && planes.possible >> lane & 1 == 0 => {
                PartSurface::Empty
            }
            Some(short) if std::env::var("NOSHORT").is_err() => {
                PartSurface::Short(Box::new(ShortSurface::new(&self.whole, Some(short))))
            }
            _ => PartSurface::Same,
        };
        Some(parts.into_iter().enumerate().map(surface).collect())
    }
}

impl<T: WholeFloat> Kernels<T> for ShortKernels<T> {
    fn zeros(&self) -> KernelResult<'_, FindZeros, T> {
        self.kernel(&self.zeros)
    }

    fn bounds(&self) -> KernelResult<'_, Enclose, T> {
        self.kernel(&self.bounds)
    }

    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }

    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        self.kernel(&self.segments)
    }

    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        self.kernel(&self.tiles)
    }

    fn values(&self) -> KernelResult<'_, Sample, T> {
        self.kernel(&self.values)
    }

    fn in_tiles(&self, tiles: &Tiles<T>) -> Vec<PartSurface> {
        if self.tape().deciding_steps().len() < LEAST_DECIDING {
            return Vec::new();
        }
        self.parts(tiles).unwrap_or_default()
    }
}
