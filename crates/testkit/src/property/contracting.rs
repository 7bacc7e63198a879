//! Checks of kernels that narrow segments and tiles of rays. If a kernel reports no zero, there
//! must be none. A tile's plane must be as close to the function as reported.

use super::KernelKind;
use super::tile::{Probe, Tile, pack_segments, pack_tiles};
use crate::suite::Failure;
use crate::{Adversarial, Case, Claim, Defined, Oracle, Place, Rng, minimise};
use std::fmt::Debug;
use zeroset_eval::{
    Binding, ContractSegments, ContractTiles, Kernel, LANES, Planes, Query, Reference, Tape,
};
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_jit::Native;
use zeroset_ops::Op;

/// Number of points checked in each tile.
const PROBES: usize = 8;
/// Number of points per case at which the function is given a root.
const ROOTS: usize = 2;

/// Counts of the checks done by [`check_contraction`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ContractionTally {
    /// Number of checked points.
    pub points: u64,
    /// Number of points at which the function's value was compared with a plane.
    pub planes: u64,
    /// Number of checked roots. A root counts once for a tile and once for a segment.
    pub roots: u64,
    /// Number of roots whose tile or segment was narrowed to less than half its length.
    pub narrowed: u64,
    /// Number of tiles reported to have a zero on each ray.
    pub crossings: u64,
}

impl ContractionTally {
    /// Adds the counts of `other`.
    pub fn add(&mut self, other: Self) {
        self.points += other.points;
        self.planes += other.planes;
        self.roots += other.roots;
        self.narrowed += other.narrowed;
        self.crossings += other.crossings;
    }
}

/// Options for creating a kernel.
#[derive(Clone, Copy, Debug)]
pub struct KernelOptions {
    /// Whether the function is simplified first.
    pub simple: bool,
    /// The evaluator of the kernel.
    pub engine: Engine,
}

/// An evaluator of kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// The reference evaluator.
    Reference,
    /// Native code.
    Native,
}

/// A source of kernels for [`check_contraction_by`].
pub trait PathKernels<T: Adversarial>: Debug {
    /// Returns a kernel for a case, or `None` to skip the case.
    fn kernel<Q: Query>(&self, case: &Case) -> Option<Box<dyn Kernel<Q, T>>>;

    /// Returns the kernels that show whether a root is lost. They must give the same bits.
    #[must_use]
    fn for_roots(&self) -> Self;
}

impl<T: Adversarial> PathKernels<T> for KernelOptions {
    fn kernel<Q: Query>(&self, case: &Case) -> Option<Box<dyn Kernel<Q, T>>> {
        let tape: Tape<T> = KernelKind::Tiles.tape(self.simple, case)?;
        let binding = Binding::new(&case.parameters);
        Some(match self.engine {
            Engine::Reference => Box::new(Reference::new(tape, binding)),
            Engine::Native => Box::new(Native::new(tape, binding).expect("compiles")),
        })
    }

    /// The reference evaluator gives the same bits as native code, and needs no compiling.
    fn for_roots(&self) -> Self {
        Self { engine: Engine::Reference, ..*self }
    }
}

/// Checks `batches` batches of random tiles, and segments in them. The oracle's bounds at points of
/// a tile must overlap the tile's plane. If the kernel reports crossings, the function must not
/// have the same sign at both ends of a ray. Then the function's value at a point is subtracted
/// from the function, which makes the point a root. No narrowing may lose this root.
///
/// # Errors
/// The first contradiction, shrunk.
pub fn check_contraction<T: Adversarial>(
    kernel_options: KernelOptions,
    case: &Case,
    rng: &mut Rng,
    batches: usize,
) -> Result<ContractionTally, Failure> {
    check_contraction_by::<T, _>(&kernel_options, case, rng, batches)
}

/// Runs [`check_contraction`] with kernels from another source.
///
/// # Errors
/// The first contradiction, shrunk.
pub fn check_contraction_by<T: Adversarial, K: PathKernels<T>>(
    kernels: &K,
    case: &Case,
    rng: &mut Rng,
    batches: usize,
) -> Result<ContractionTally, Failure> {
    let mut all = ContractionTally::default();
    let Some(kernel) = kernels.kernel::<ContractTiles>(case) else { return Ok(all) };
    let oracle = Oracle::new(&case.graph, &[case.root]);
    let mut known = Vec::new();
    for _ in 0..batches {
        let mut lanes = Vec::new();
        while lanes.len() < LANES {
            let mut tile = Tile::random::<T>(case, rng);
            let probes = tile.random_probes::<T>(case, rng, PROBES);
            lanes.push((tile, probes));
        }
        let tiles: Vec<Tile> = lanes.iter().map(|(tile, _)| *tile).collect();
        let planes = &kernel.eval_all(&[pack_tiles::<T>(&tiles)])[0];
        for (lane, (tile, probes)) in lanes.iter().enumerate() {
            let values = case.random_values(rng);
            let claims: Vec<_> =
                probes.iter().map(|probe| oracle.at(probe.at, &values)[0]).collect();
            let plane = Plane::of(planes, lane);
            all.points += claims.len() as u64;
            let defined = claims.iter().filter(|claim| claim.defined == Defined::Yes).count();
            all.planes += if plane.error.is_finite() { defined as u64 } else { 0 };
            all.crossings += u64::from(plane.crossing && defined > 0);
            if plane.contradiction(tile, probes, &claims).is_some() {
                return Err(explain::<T, K>(kernels, case, tile, probes, &values));
            }
            for (probe, claim) in probes.iter().zip(claims) {
                if is_narrow(claim) {
                    known.push((*tile, *probe, claim, values.clone()));
                }
            }
        }
    }
    for _ in 0..ROOTS {
        if known.is_empty() {
            break;
        }
        let (tile, probe, claim, values) = &known[rng.u32(0..known.len() as u32) as usize];
        let tiles: Vec<Tile> = (0..LANES).map(|_| tile.narrower::<T>(rng, probe)).collect();
        let kernels = &kernels.for_roots();
        if let Some(lost) = lost_root::<T, K>(kernels, case, &tiles, probe, *claim, &mut all) {
            return Err(explain_root::<T, K>(kernels, case, &tiles[lost], probe, values));
        }
    }
    Ok(all)
}

/// Returns `case` with a number within the bounds of `claim` subtracted from its function.
fn with_root(case: &Case, claim: Claim) -> Case {
    let mut case = case.clone();
    let value = case.graph.constant(Constant::enclosed(Interval { lo: claim.lo, hi: claim.hi }));
    case.root = case.graph.apply(Op::Sub, &[case.root, value]);
    case
}

/// Makes a probe a root by `with_root`. Returns the index of the first tile that loses this root.
fn lost_root<T: Adversarial, K: PathKernels<T>>(
    kernels: &K,
    case: &Case,
    tiles: &[Tile],
    probe: &Probe,
    claim: Claim,
    all: &mut ContractionTally,
) -> Option<usize> {
    let case = with_root(case, claim);
    let planes = &kernels.kernel::<ContractTiles>(&case)?.eval_all(&[pack_tiles(tiles)])[0];
    let segments = pack_segments::<T>(tiles, probe);
    let ends = &kernels.kernel::<ContractSegments>(&case)?.eval_all(&[segments])[0];
    (0..tiles.len()).find(|&lane| {
        let [near, far] = tiles[lane].span;
        let mut lost = false;
        for (possible, from, to) in [
            (planes.possible, planes.near[lane].into(), planes.far[lane].into()),
            (ends.possible, ends.near[lane].into(), ends.far[lane].into()),
        ] {
            lost |= possible >> lane & 1 == 0 || !(from <= probe.t && probe.t <= to);
            all.roots += 1;
            all.narrowed += u64::from(to - from < 0.5 * (far - near));
        }
        lost
    })
}

fn explain_root<T: Adversarial, K: PathKernels<T>>(
    kernels: &K,
    case: &Case,
    tile: &Tile,
    probe: &Probe,
    values: &[(f64, f64)],
) -> Failure {
    let value_of = |case: &Case| Oracle::new(&case.graph, &[case.root]).at(probe.at, values)[0];
    let mut loses = |case: &Case| {
        let claim = value_of(case);
        is_narrow(claim)
            && lost_root::<T, K>(
                kernels,
                case,
                &[*tile],
                probe,
                claim,
                &mut ContractionTally::default(),
            )
            .is_some()
    };
    let least = minimise(case, &mut loses);
    let claim = value_of(&least);
    let case = with_root(&least, claim).describe::<T>(&Place::At(probe.at));
    Failure::new(format!("{kernels:?} loses the root at {probe:?} of {tile:?}\n{case}"))
}

/// Whether a value is known precisely enough for `with_root`.
fn is_narrow(claim: Claim) -> bool {
    let size = claim.hi.abs().max(claim.lo.abs());
    claim.defined == Defined::Yes && size.is_finite() && claim.hi - claim.lo <= size * 1e-9
}

/// The plane of one tile in a kernel's result.
#[derive(Clone, Copy, Debug)]
struct Plane {
    value: f64,
    slopes: [f64; 3],
    error: f64,
    middle: f64,
    half: f64,
    possible: bool,
    crossing: bool,
}

impl Plane {
    fn of<T: Adversarial>(planes: &Planes<T>, lane: usize) -> Self {
        Self {
            value: planes.value[lane].into(),
            slopes: planes.slope.map(|slope| slope[lane].into()),
            error: planes.error[lane].into(),
            middle: planes.middle[lane].into(),
            half: planes.half[lane].into(),
            possible: planes.possible >> lane & 1 == 1,
            crossing: planes.crossing >> lane & 1 == 1,
        }
    }

    /// Returns what is wrong with this plane, given the oracle's claims at the probes.
    fn contradiction(&self, tile: &Tile, probes: &[Probe], claims: &[Claim]) -> Option<String> {
        for (probe, claim) in probes.iter().zip(claims) {
            let is_defined = claim.defined == Defined::Yes;
            if is_defined && !self.possible && claim.lo == 0.0 && claim.hi == 0.0 {
                return Some(format!("a zero denied at {probe:?}"));
            }
            let misses = || {
                tile.misses(
                    probe,
                    (self.value, self.slopes, self.error),
                    [self.middle, self.half],
                    claim,
                )
            };
            if is_defined && self.error.is_finite() && misses() {
                return Some(format!("{claim:?} at {probe:?} is off the plane"));
            }
        }
        // Probes are ordered by ray, with the ends of each ray first.
        let rays = probes.chunk_by(|a, b| a.ray == b.ray).zip(claims_by_ray(probes, claims));
        for (probes, claims) in rays {
            let [near, far] = [0, 1].map(|end| probes.get(end).map(|probe| probe.t));
            if !self.crossing || near != Some(tile.span[0]) || far != Some(tile.span[1]) {
                continue;
            }
            if claims.iter().any(|claim| claim.defined == Defined::No) {
                return Some(format!("undefined on a ray that crosses, {probes:?}"));
            }
            let signs = [claims[0], claims[1]].map(|claim| match claim {
                _ if claim.defined != Defined::Yes => None,
                claim if claim.lo > 0.0 => Some(1),
                claim if claim.hi < 0.0 => Some(-1),
                claim if claim.lo == 0.0 && claim.hi == 0.0 => Some(0),
                _ => None,
            });
            if signs.contains(&Some(0)) || (signs[0].is_some() && signs[0] == signs[1]) {
                return Some(format!("no crossing: {claims:?} at {probes:?}"));
            }
        }
        None
    }
}

fn claims_by_ray<'a>(probes: &[Probe], claims: &'a [Claim]) -> Vec<&'a [Claim]> {
    let mut rest = claims;
    let lengths = probes.chunk_by(|a, b| a.ray == b.ray).map(<[Probe]>::len);
    lengths
        .map(|length| {
            let (first, others) = rest.split_at(length);
            rest = others;
            first
        })
        .collect()
}

fn explain<T: Adversarial, K: PathKernels<T>>(
    kernels: &K,
    case: &Case,
    tile: &Tile,
    probes: &[Probe],
    values: &[(f64, f64)],
) -> Failure {
    let ask = |case: &Case| {
        let kernel = kernels.kernel::<ContractTiles>(case)?;
        let plane = Plane::of(&kernel.eval_all(&[pack_tiles::<T>(&[*tile])])[0], 0);
        let oracle = Oracle::new(&case.graph, &[case.root]);
        let within = |probe: &Probe| {
            probe.at.iter().zip(case.assumptions.domain).all(|(x, range)| range.contains(*x))
        };
        if !probes.iter().all(within) {
            return None;
        }
        let claims: Vec<_> = probes.iter().map(|probe| oracle.at(probe.at, values)[0]).collect();
        let what = plane.contradiction(tile, probes, &claims)?;
        Some(format!("{what}\n{plane:?}\n{tile:?}"))
    };
    let least = minimise(case, &mut |case| ask(case).is_some());
    let what = ask(&least).unwrap_or_else(|| "it depends on the other lanes".to_owned());
    Failure::new(format!("{kernels:?} {what}\n{}", least.describe::<T>(&Place::At(probes[0].at))))
}
