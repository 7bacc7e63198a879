//! Checks of interval kernels over a domain and with parameters, as in programs.

use super::interval::QueryResult;
use super::{Failure, Tally};
use crate::{
    Adversarial, Case, Claim, Defined, Effort, GraphOptions, Oracle, Place, Rng, count_claims,
    hexadecimal, minimise, pack_boxes,
};
use zeroset_eval::{Enclose, Kernel, LANES};

/// Compiles a case, with its parameters bound, to a kernel. `None` skips the case.
pub type CompileCase<'a, Q, T = f32> = &'a dyn Fn(&Case) -> Option<Box<dyn Kernel<Q, T>>>;

/// Boxes per kernel, and points per box. They are many, so that compiling takes a small part of the
/// time.
const BOXES: usize = 64;
const POINTS: usize = 6;

/// Checks random cases drawn by `options`, until `effort.cases` points were compared at which the
/// function is certainly defined.
///
/// At each point the oracle encloses the graph as typed, with a value of each parameter within its
/// bounds. The kernel's bounds must overlap that enclosure, and its facts about the box must be
/// true.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn check_interval_cases<T: Adversarial>(
    make: CompileCase<Enclose, T>,
    effort: Effort,
    options: &GraphOptions,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let mut seed = effort.seed;
    while tally.defined < effort.cases {
        let mut rng = Rng::with_seed(seed);
        let case = Case::random(&mut rng, options);
        if let Some(kernel) = make(&case) {
            let drawn = check(make, &case, &*kernel, &mut rng, BOXES);
            tally.add(drawn.map_err(|failure| {
                Failure(format!("{failure}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1 shows it alone"))
            })?);
        }
        seed = seed.wrapping_add(1);
    }
    count_claims(tally.compared);
    Ok(tally)
}

/// Like [`check_interval_cases`], over `boxes` boxes of one case.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn check_interval_case<T: Adversarial>(
    make: CompileCase<Enclose, T>,
    case: &Case,
    rng: &mut Rng,
    boxes: usize,
) -> Result<Tally, Failure> {
    make(case).map_or(Ok(Tally::default()), |kernel| check(make, case, &*kernel, rng, boxes))
}

fn check<T: Adversarial>(
    make: CompileCase<Enclose, T>,
    case: &Case,
    kernel: &dyn Kernel<Enclose, T>,
    rng: &mut Rng,
    boxes: usize,
) -> Result<Tally, Failure> {
    let regions: Vec<_> = (0..boxes).map(|_| case.random_box(rng)).collect();
    let enclosures = kernel.eval_all(&pack_boxes(&regions));
    let oracle = Oracle::new(&case.graph, &[case.root]);
    let mut tally = Tally::default();
    for (index, region) in regions.iter().enumerate() {
        let answer = QueryResult::of(&enclosures[index / LANES], index % LANES);
        for _ in 0..POINTS {
            let point = case.random_point(rng, region);
            let values = case.random_values(rng);
            let claim = oracle.at(point, &values)[0];
            tally.compared += 1;
            tally.defined += u64::from(claim.defined == Defined::Yes);
            if contradicts(&answer, claim).is_some() {
                return Err(explain(make, case, region, point, &values));
            }
        }
    }
    Ok(tally)
}

fn contradicts(answer: &QueryResult, claim: Claim) -> Option<&'static str> {
    answer.well_formed().and_then(|()| answer.agrees(claim)).err()
}

/// Shrinks a failing case. Returns the contradiction that the smallest case shows.
fn explain<T: Adversarial>(
    make: CompileCase<Enclose, T>,
    case: &Case,
    region: &[[T; 2]; 3],
    point: [f64; 3],
    values: &[(f64, f64)],
) -> Failure {
    let ask = |case: &Case| {
        let answer = QueryResult::of(&make(case)?.eval_all(&pack_boxes(&[*region]))[0], 0);
        let claim = Oracle::new(&case.graph, &[case.root]).at(point, values)[0];
        contradicts(&answer, claim).map(|what| format!("{what} {claim:?}: {answer:?}"))
    };
    let least = minimise(case, &mut |case| ask(case).is_some());
    let what = ask(&least).unwrap_or_else(|| "it depends on the other lanes".to_owned());
    let at = point.map(hexadecimal);
    Failure(format!("at {at:?}, {what}\n{}", least.describe::<T>(&Place::over(region))))
}
