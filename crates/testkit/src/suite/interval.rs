//! Checks of interval kernels: bounds overlap the oracle's bounds, and facts are true.

use super::subjects::{every_op, subjects_of};
use super::{CompileGraph, Failure, Tally};
use crate::{
    Adversarial, Claim, Defined, Ends, GraphOptions, Oracle, Place, Rng, hexadecimal, pack_boxes,
    point_in_box, random_box, random_graph, reproduce_in,
};
use zeroset_eval::{Enclose, Enclosures, LANES, Real};
use zeroset_interval::Facts;
use zeroset_ir::{Graph, NodeId};
use zeroset_ops::Op;

/// Points checked in each box.
const POINTS: u32 = 4;

/// Checks every operation alone over `boxes` random boxes, unbounded ones included.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_interval_ops<T: Adversarial>(
    make: CompileGraph<Enclose, T>,
    seed: u64,
    boxes: u32,
) -> Result<Tally, Failure> {
    check_interval_some_ops(make, &every_op(), seed, boxes)
}

/// Runs [`check_interval_ops`] on these operations only.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_interval_some_ops<T: Adversarial>(
    make: CompileGraph<Enclose, T>,
    ops: &[Op],
    seed: u64,
    boxes: u32,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    for subject in subjects_of(ops) {
        let drawn = check(make, &mut rng, &subject.graph, subject.root, boxes);
        tally.add(drawn.map_err(|failure| seeded(&failure, seed))?);
    }
    Ok(tally)
}

/// Checks `graphs` random graphs without parameters, drawn by `options`, over `boxes` boxes each.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_interval_graphs<T: Adversarial>(
    make: CompileGraph<Enclose, T>,
    seed: u64,
    options: &GraphOptions,
    graphs: u32,
    boxes: u32,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    let options = GraphOptions { parameters: 0, ..options.clone() };
    for _ in 0..graphs {
        let (graph, root) = random_graph(&mut rng, &options);
        let drawn = check(make, &mut rng, &graph, root, boxes);
        tally.add(drawn.map_err(|failure| seeded(&failure, seed))?);
    }
    Ok(tally)
}

fn seeded(failure: &Failure, seed: u64) -> Failure {
    Failure(format!("{failure}\nseed {seed:#x}"))
}

fn check<T: Adversarial>(
    make: CompileGraph<Enclose, T>,
    rng: &mut Rng,
    graph: &Graph,
    root: NodeId,
    boxes: u32,
) -> Result<Tally, Failure> {
    let regions: Vec<_> = (0..boxes).map(|_| random_box::<T>(rng, Ends::Infinite)).collect();
    let enclosures = make(graph, root).eval_all(&pack_boxes(&regions));
    let oracle = Oracle::new(graph, &[root]);
    let mut tally = Tally::default();
    for (index, region) in regions.iter().enumerate() {
        let answer = QueryResult::of(&enclosures[index / LANES], index % LANES);
        let fail = |what: &str| {
            let line = reproduce_in::<T>(graph, root, &[], &Place::over(region));
            Failure(format!("{what}: {answer:?}\n{line}"))
        };
        answer.well_formed().map_err(fail)?;
        for _ in 0..POINTS {
            let point = point_in_box(rng, region);
            let claim = oracle.at(point, &[])[0];
            tally.compared += 1;
            tally.defined += u64::from(claim.defined == Defined::Yes);
            answer.agrees(claim).map_err(|what| {
                let at = point.map(hexadecimal);
                fail(&format!("at {at:?}, {what} {claim:?}"))
            })?;
        }
    }
    Ok(tally)
}

/// One lane of a kernel's result.
#[derive(Debug)]
pub(super) struct QueryResult {
    pub(super) lo: f64,
    pub(super) hi: f64,
    pub(super) facts: Facts,
}

impl QueryResult {
    pub(super) fn of<T: Real>(answers: &Enclosures<T>, lane: usize) -> Self {
        Self {
            lo: -answers.neg_lo[lane].into(),
            hi: answers.hi[lane].into(),
            facts: answers.facts(lane),
        }
    }

    fn claims_defined(&self) -> bool {
        self.facts.has(Facts::DEFINED) || self.facts.has(Facts::CONTINUOUS)
    }

    pub(super) fn well_formed(&self) -> Result<(), &'static str> {
        let nowhere = self.facts.has(Facts::NOWHERE);
        if self.lo.is_nan() || self.hi.is_nan() {
            Err("a bound is NaN")
        } else if self.lo == f64::INFINITY || self.hi == f64::NEG_INFINITY {
            Err("a bound lies beyond all reals")
        } else if nowhere && self.claims_defined() {
            Err("defined and nowhere defined")
        } else if !nowhere && self.lo > self.hi {
            Err("the bounds are not in order")
        } else {
            Ok(())
        }
    }

    pub(super) fn agrees(&self, claim: Claim) -> Result<(), &'static str> {
        let meets = self.lo <= claim.hi && claim.lo <= self.hi;
        match claim.defined {
            Defined::Yes if self.facts.has(Facts::NOWHERE) => Err("called undefined, against"),
            Defined::Yes if !meets => Err("the bounds miss"),
            Defined::No if self.claims_defined() => Err("called defined, against"),
            Defined::Yes | Defined::No | Defined::Unknown => Ok(()),
        }
    }
}
