//! Native code must give the same bits as the reference evaluator. Here −0 equals +0, and NaN
//! equals NaN. Pictures use only the processor's widest vectors. These checks use all widths.

use super::tile::{Tile, pack_segments, pack_tiles};
use crate::suite::{Failure, Tally};
use crate::{Adversarial, Case, Ends, Place, Rng, minimise, pack_boxes};
use std::fmt::Debug;
use std::sync::Arc;
use zeroset_eval::{
    Assumptions, Binding, BoundPatches, Boxes, ContractSegments, ContractTiles, Enclose,
    EncloseGradient, FindZeros, FindZerosInBranch, Input, Kernel, LANES, Lanes, Output, Points,
    Query, Real, Reference, Sample, SampleForward, SampleGradient, Segments, Shortener, Tape,
    Tiles, branch_bindings,
};
use zeroset_ir::{gradient, rewrite, simplify};
use zeroset_jit::{Compiled, Threaded, vector_widths};

/// Functions of this many nodes or more are skipped. Compile time grows faster than linearly.
const LONGEST: usize = 400;

/// The query that a kernel answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelKind {
    /// Enclosures over boxes.
    Bounds,
    /// Values at points.
    Values,
    /// Values and derivatives at points.
    Gradients,
    /// Values and derivatives at points, propagated forward.
    Forward,
    /// Whether a function may have a zero in a box.
    Zeros,
    /// Whether a branch may have a zero in a box. Functions without jumps are skipped.
    Branches,
    /// Enclosures of a function and its derivatives over boxes.
    GradientBounds,
    /// Narrowed segments of rays.
    Segments,
    /// Narrowed tiles of rays, and their planes.
    Tiles,
    /// Approximations of three coordinates over cells of x and y. The coordinates are the function
    /// and its derivatives with respect to x and y.
    Patches,
}

impl KernelKind {
    /// All kinds of kernels.
    pub const ALL: [Self; 10] = [
        Self::Bounds,
        Self::Values,
        Self::Gradients,
        Self::Zeros,
        Self::Branches,
        Self::GradientBounds,
        Self::Segments,
        Self::Tiles,
        Self::Forward,
        Self::Patches,
    ];

    /// Whether the kernel computes derivatives.
    pub fn is_differentiated(self) -> bool {
        matches!(self, Self::Gradients | Self::GradientBounds | Self::Patches)
    }

    /// Returns the tape of this kernel for a case. The function is as typed or, if `simple`,
    /// rewritten and simplified as in programs. `None` if the graph is too large, or if the tape
    /// for [`Self::Branches`] has no branches.
    pub fn tape<T: Real>(self, simple: bool, case: &Case) -> Option<Tape<T>> {
        let Assumptions { domain, parameters } = &case.assumptions;
        let (mut graph, mut root) = (case.graph.clone(), case.root);
        if simple {
            let (simpler, roots) = rewrite(&graph, &[root], domain, parameters).ok()?;
            (graph, root) = (simpler, roots[0]);
        }
        let mut roots = vec![root];
        if self.is_differentiated() {
            roots.extend(gradient(&mut graph, root));
        }
        if self == Self::Patches {
            roots.truncate(3);
        }
        if simple {
            (graph, roots) = simplify(&graph, &roots, domain, parameters).ok()?;
        }
        if graph.reachable(&roots).iter().filter(|needed| **needed).count() >= LONGEST {
            None
        } else if self == Self::Branches {
            Tape::branches(&graph, &roots, &case.assumptions)
        } else {
            Some(Tape::new(&graph, &roots, &case.assumptions))
        }
    }
}

/// Compares native code with the reference evaluator in the precision `T` on `inputs` random
/// inputs. The function is as typed, or simplified if `simple`. Compares nothing if the function is
/// too long.
///
/// # Errors
/// The first input on which the two differ, with a smaller case that still shows it.
///
/// # Panics
/// If the code of a function of moderate length does not compile.
pub fn agree<T: Adversarial>(
    subject: KernelKind,
    simple: bool,
    case: &Case,
    rng: &mut Rng,
    inputs: usize,
) -> Result<Tally, Failure> {
    let tape = |case: &Case| subject.tape::<T>(simple, case);
    let (boxes, points) = (random_boxes, random_points);
    let (segments, tiles) = (random_segments, random_tiles);
    // The widest vectors are drawn most often.
    let widths: Vec<usize> = vector_widths().collect();
    let width = widths[if rng.bool() { 0 } else { rng.u32(0..widths.len() as u32) as usize }];
    match subject {
        KernelKind::Bounds => {
            compare::<Enclose, T>(case, &tape, &batches(case, rng, inputs, boxes), width)
        }
        KernelKind::Zeros => {
            compare::<FindZeros, T>(case, &tape, &batches(case, rng, inputs, boxes), width)
        }
        KernelKind::Branches => {
            compare::<FindZerosInBranch, T>(case, &tape, &batches(case, rng, inputs, boxes), width)
        }
        KernelKind::GradientBounds => {
            compare::<EncloseGradient, T>(case, &tape, &batches(case, rng, inputs, boxes), width)
        }
        KernelKind::Segments => compare::<ContractSegments, T>(
            case,
            &tape,
            &batches(case, rng, inputs, segments),
            width,
        ),
        KernelKind::Tiles => {
            compare::<ContractTiles, T>(case, &tape, &batches(case, rng, inputs, tiles), width)
        }
        KernelKind::Patches => {
            compare::<BoundPatches, T>(case, &tape, &batches(case, rng, inputs, boxes), width)
        }
        KernelKind::Values => {
            compare::<Sample, T>(case, &tape, &batches(case, rng, inputs, points), width)
        }
        KernelKind::Gradients => {
            compare::<SampleGradient, T>(case, &tape, &batches(case, rng, inputs, points), width)
        }
        KernelKind::Forward => {
            compare::<SampleForward, T>(case, &tape, &batches(case, rng, inputs, points), width)
        }
    }
}

/// Returns random batches that use `inputs` lanes in total. Many batches are not full.
fn batches<I>(
    case: &Case,
    rng: &mut Rng,
    mut inputs: usize,
    draw: fn(&Case, &mut Rng, usize) -> I,
) -> Vec<I> {
    let mut batches = Vec::new();
    while inputs > 0 {
        let count = if rng.bool() { LANES } else { rng.u32(1..=LANES as u32) as usize };
        batches.push(draw(case, rng, count.min(inputs)));
        inputs -= count.min(inputs);
    }
    batches
}

fn random_boxes<T: Adversarial>(case: &Case, rng: &mut Rng, count: usize) -> Boxes<T> {
    let regions: Vec<_> = (0..count).map(|_| case.random_box(rng)).collect();
    pack_boxes(&regions).remove(0)
}

/// Sample kernels assume nothing about the domain, so any point will do, even an infinite one.
fn random_points<T: Adversarial>(_: &Case, rng: &mut Rng, count: usize) -> Points<T> {
    let mut lanes = || Lanes([(); LANES].map(|()| T::adversarial(rng, Ends::Infinite)));
    Points { at: [(); 3].map(|()| lanes()), count: count as u32 }
}

/// Puts arbitrary numbers into some lanes. Evaluators must agree on invalid rays, too.
fn with_arbitrary_numbers<T: Adversarial, B: Input<T>>(mut batch: B, rng: &mut Rng) -> B {
    if rng.u32(0..4) == 0 {
        for number in 0..B::QUANTITIES {
            for lane in &mut batch.quantity_mut(number).0 {
                if rng.u32(0..4) == 0 {
                    *lane = T::adversarial(rng, Ends::Infinite);
                }
            }
        }
    }
    batch
}

fn random_tiles<T: Adversarial>(case: &Case, rng: &mut Rng, count: usize) -> Tiles<T> {
    let tiles: Vec<_> = (0..count).map(|_| Tile::random::<T>(case, rng)).collect();
    with_arbitrary_numbers(pack_tiles(&tiles), rng)
}

fn random_segments<T: Adversarial>(case: &Case, rng: &mut Rng, count: usize) -> Segments<T> {
    let mut tile = Tile::random::<T>(case, rng);
    let probe = tile.random_probes::<T>(case, rng, 4).first().copied().unwrap_or_default();
    let tiles: Vec<_> = (0..count).map(|_| tile.narrower::<T>(rng, &probe)).collect();
    with_arbitrary_numbers(pack_segments(&tiles, &probe), rng)
}

/// Whether two results are equal in the first `count` lanes.
fn same<T: Real, B: Output<T>>(a: &B, b: &B, count: usize) -> bool {
    let equal = |(a, b): (&T, &T)| a == b || ((*a).into().is_nan() && (*b).into().is_nan());
    let quantities = (0..B::QUANTITIES)
        .all(|number| a.quantity(number).iter().zip(&**b.quantity(number)).take(count).all(equal));
    let unused = LANES - count;
    let used = |batch: &B, number| batch.mask(number) << unused;
    quantities && (0..B::MASKS).all(|number| used(a, number) == used(b, number))
}

/// The results of a kernel, for vectors of some width, and of the reference.
type Pair<Q, T> = [Vec<<Q as Query>::Output<T>>; 2];

/// Returns the results of compiled code and of stencils, each beside the reference.
fn pairs<Q: Query, T: Real>(
    tape: &Tape<T>,
    case: &Case,
    inputs: &[Q::Input<T>],
    width: usize,
) -> Vec<Pair<Q, T>> {
    let compiled = Compiled::<Q, T>::narrow(tape.clone(), width).expect("compiles");
    assert_eq!(compiled.vector_bytes(), width, "{:?}", tape.steps());
    let reference =
        |tape, binding: &Binding<T>| Reference::<Q, T>::new(tape, binding.clone()).eval_all(inputs);
    let native = |binding: &Binding<T>| compiled.bind(binding.clone()).eval_all(inputs);
    if tape.is_by_branches() {
        let bindings = branch_bindings(&case.parameters);
        let pair = |binding| [native(&binding), reference(tape.clone(), &binding)];
        return bindings.map(pair).collect();
    }
    let binding = Binding::new(&case.parameters);
    let compiled = [native(&binding), reference(tape.clone(), &binding)];
    let threaded = |least_shared| {
        let shortener = Shortener::new(tape, &case.parameters, least_shared);
        let tape = Arc::new(shortener.clauses().coarse(tape.clone()));
        let threaded = Threaded::<Q, T>::narrow(&tape, &binding, &shortener, width);
        let found = threaded.expect("stencils are compiled").eval_all(inputs);
        [found, reference(Arc::unwrap_or_clone(tape), &binding)]
    };
    vec![compiled, threaded(usize::MAX), threaded(1)]
}

fn compare<Q: Query, T: Real>(
    case: &Case,
    tape: &dyn Fn(&Case) -> Option<Tape<T>>,
    inputs: &[Q::Input<T>],
    width: usize,
) -> Result<Tally, Failure>
where
    Q::Input<T>: Debug,
    Q::Output<T>: Debug,
{
    /// Returns the index of the first input on which the two evaluators differ.
    fn differing<Q: Query, T: Real>(
        answers: &[Pair<Q, T>],
        inputs: &[Q::Input<T>],
    ) -> Option<usize> {
        answers.iter().find_map(|[kernel, reference]| {
            let mut pairs = kernel.iter().zip(reference).zip(inputs);
            pairs.position(|((a, b), input)| !same::<T, _>(a, b, input.count()))
        })
    }
    let Some(steps) = tape(case) else { return Ok(Tally::default()) };
    let compared = inputs.iter().map(|input| input.count() as u64).sum();
    let Some(at) = differing::<Q, T>(&pairs::<Q, T>(&steps, case, inputs, width), inputs) else {
        return Ok(Tally { compared, defined: compared });
    };
    let input = &inputs[at..=at];
    let answers = |case: &Case| Some(pairs::<Q, T>(&tape(case)?, case, input, width));
    let mut differs =
        |case: &Case| answers(case).is_some_and(|pairs| differing::<Q, T>(&pairs, input).is_some());
    let least = minimise(case, &mut differs);
    let answers = answers(&least);
    let case = least.describe::<T>(&Place::At([0.0; 3]));
    Err(Failure::new(format!(
        "{}, vectors of {width} bytes: {case}\n{input:?}\n{answers:#?}",
        Q::NAME
    )))
}
