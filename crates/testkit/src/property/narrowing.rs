//! Checks the narrowing of segments to the zeros of linear functions by exact rationals.

use crate::suite::{Failure, Tally};
use crate::{Adversarial, Ends, Rng};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_eval::{LANES, Lanes, Real};
use zeroset_interval::{Form, Machine, Software, Vector128, contract};

/// One lane: c + Σ s·ε ± e for t from `near` to `far`. The last symbol ε is (t − middle)/half.
#[derive(Clone, Copy, Debug)]
struct LinearLane<const N: usize> {
    centre: f64,
    slopes: [f64; N],
    error: f64,
    middle: f64,
    half: f64,
    near: f64,
    far: f64,
}

/// Result of [`contract`] in one lane.
#[derive(Clone, Copy, Debug)]
struct QueryResult {
    near: f64,
    far: f64,
    possible: bool,
    crossing: bool,
}

/// Checks the narrowing of random segments to the zeros of random linear functions of `N` symbols.
/// In the tally, `defined` counts segments that are narrowed and may have a zero.
///
/// # Errors
/// The first result that loses a zero, reports a false crossing, or narrows too little.
pub fn check_narrowing<T: Adversarial, const N: usize>(
    rng: &mut Rng,
    vectors: usize,
) -> Result<Tally, Failure> {
    check_narrowing_on::<T, Software, N>(rng, vectors, &|software| software)
}

/// Runs [`check_narrowing`] on another machine, which `machine` creates in place of a software
/// machine.
///
/// # Errors
/// The first result that loses a zero, reports a false crossing, or narrows too little.
pub fn check_narrowing_on<T: Adversarial, M: Machine<V = Vector128>, const N: usize>(
    rng: &mut Rng,
    vectors: usize,
    machine: &dyn Fn(Software) -> M,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    for _ in 0..vectors {
        let lanes: Vec<LinearLane<N>> =
            (0..T::VECTOR_LANES).map(|_| LinearLane::random::<T>(rng)).collect();
        let mut machine = machine(Software::BOTH[usize::from(rng.bool())]);
        for (lane, answer) in lanes.iter().zip(answers::<T, M, N>(&mut machine, &lanes)) {
            tally.compared += 1;
            let wrong = lane.contradiction::<T>(answer);
            if let Some(what) = wrong {
                return Err(Failure::new(format!(
                    "{what} in {:?}: {answer:?} of {lane:?}",
                    T::FORMAT
                )));
            }
            let narrower = answer.near > lane.near || answer.far < lane.far;
            tally.defined += u64::from(answer.possible && narrower);
        }
    }
    Ok(tally)
}

fn answers<T: Adversarial, M: Machine<V = Vector128>, const N: usize>(
    m: &mut M,
    lanes: &[LinearLane<N>],
) -> Vec<QueryResult> {
    let load = |number: &dyn Fn(&LinearLane<N>) -> f64| {
        let mut loaded = Lanes::<T>::default();
        for (to, lane) in loaded.iter_mut().zip(lanes) {
            *to = T::nearest(number(lane));
        }
        T::load(&loaded, 0)
    };
    let slopes: [_; N] = std::array::from_fn(|k| load(&|lane| lane.slopes[k]));
    let form = Form::coordinate(load(&|lane| lane.centre), slopes, load(&|lane| lane.error));
    let [middle, half] = [load(&|lane| lane.middle), load(&|lane| lane.half)];
    let ends = [load(&|lane| lane.near), load(&|lane| lane.far)];
    let new = contract(m, T::FORMAT, &form, [middle, half], ends);
    let [near, far] = [new.near, new.far].map(|vector| {
        let mut numbers = Lanes::<T>::default();
        T::store(vector, 0, &mut numbers);
        numbers
    });
    let masks = [new.possible, new.crossing].map(|fact| T::bits(fact.mask(m, T::FORMAT)));
    (0..lanes.len())
        .map(|lane| {
            let [possible, crossing] = masks.map(|mask| mask >> lane & 1 == 1);
            QueryResult { near: near[lane].into(), far: far[lane].into(), possible, crossing }
        })
        .collect()
}

/// Returns a float's value, or `None` if it is not finite.
fn exact(x: f64) -> Option<BigRational> {
    BigRational::from_float(x)
}

impl<const N: usize> LinearLane<N> {
    fn random<T: Adversarial>(rng: &mut Rng) -> Self {
        let number = |x: f64| -> f64 { T::nearest(x).into() };
        let any = |rng: &mut Rng| -> f64 { T::adversarial(rng, Ends::Finite).into() };
        let signed = |rng: &mut Rng| f64::uniform(rng) * 2.0 - 1.0;
        let scale = match rng.u32(0..8) {
            0 => 2f64.powi(rng.i32(-140..=120)),
            1 => 2f64.powi(-rng.i32(126..=149)),
            _ => 2f64.powi(rng.i32(-8..=8)),
        };
        let depth = number(signed(rng) * scale);
        // The zero lies at an end or the middle of the segment, or anywhere in or near it.
        let share = match rng.u32(0..4) {
            0 => [1.0, -1.0, 0.0][rng.u32(0..3) as usize],
            _ => signed(rng) * 1.25,
        };
        let mut centre = number(depth * share);
        for _ in 0..rng.u32(0..3) {
            let up: f64 = T::nearest(centre).next_up().into();
            centre = if rng.bool() { up } else { T::nearest(centre).next_down().into() };
        }
        let size = depth.abs() * 2f64.powi(-rng.i32(0..=28));
        let mut slopes = [0.0; N];
        for slope in &mut slopes {
            *slope = if rng.bool() { number(signed(rng) * size) } else { 0.0 };
        }
        slopes[N - 1] = depth;
        let mut error = if rng.bool() { number(size) } else { 0.0 };
        if rng.u32(0..8) == 0 {
            // Sometimes the numbers are arbitrary, including infinities and NaN.
            (centre, error) = (any(rng), any(rng).abs());
            slopes[N - 1] = any(rng);
            match rng.u32(0..16) {
                0 => error = f64::INFINITY,
                1 => (centre, error) = (f64::NAN, f64::NAN),
                2 => (slopes[N - 1], error) = (f64::NEG_INFINITY, f64::INFINITY),
                3 => (centre, error) = (f64::INFINITY, f64::NAN),
                _ => {}
            }
        }
        let near = match rng.u32(0..4) {
            0 => any(rng),
            _ => number(f64::uniform(rng) * 16.0),
        };
        let mut far = near;
        match rng.u32(0..4) {
            0 => (0..rng.u32(0..4)).for_each(|_| far = T::nearest(far).next_up().into()),
            1 => far = number(near + near.abs() * 2f64.powi(-rng.i32(0..=24))),
            _ => far = number(near + f64::uniform(rng) * 4.0),
        }
        let far = far.min(T::LARGEST.into());
        let (middle, half) = middle::<T>(near, far);
        Self { centre, slopes, error, middle, half, near, far }
    }

    fn contradiction<T: Real>(&self, answer: QueryResult) -> Option<&'static str> {
        let keeps_all = answer.possible && answer.near <= self.near && self.far <= answer.far;
        let numbers = || {
            let rest: Option<Vec<_>> =
                self.slopes[..N - 1].iter().map(|s| Some(exact(*s)?.abs())).collect();
            let rest = rest?.into_iter().fold(exact(self.error)?, |sum, size| sum + size);
            Some((exact(self.centre)?, exact(self.slopes[N - 1])?, rest))
        };
        let Some((centre, depth, rest)) = numbers() else {
            return (!keeps_all || answer.crossing)
                .then_some("something claimed of what is no number");
        };
        let ends = [self.near, self.far].map(|t| exact(t).expect("finite"));
        let (middle, half) = (exact(self.middle)?, exact(self.half)?);
        let symbol = |t: &BigRational| {
            if half.is_zero() { BigRational::zero() } else { (t - &middle) / &half }
        };
        let line = |t: &BigRational| &centre + &depth * symbol(t);
        let values = ends.each_ref().map(line);
        // The linear function is within `rest` of 0 only if an end is, or if it changes its sign.
        let apart = |value: &BigRational| value.abs() > rest;
        let opposite = values[0].is_negative() != values[1].is_negative();
        if answer.crossing && !(values.iter().all(apart) && opposite) {
            return Some("a crossing claimed");
        }
        if values.iter().all(apart) && !opposite {
            return None;
        }
        if !answer.possible {
            return Some("a zero denied");
        }
        // `zeros` become the first and the last t at which the function may be 0.
        let root = |side: BigRational| &middle + &half * ((side - &centre) / &depth);
        let mut zeros = ends.clone();
        for (zero, (value, sign)) in zeros.iter_mut().zip(values.iter().zip([1, -1])) {
            if apart(value) {
                let rises = depth.is_positive() == (sign > 0);
                *zero = root(if rises { -rest.clone() } else { rest.clone() });
            }
        }
        let kept = |end: f64| BigRational::from_float(end);
        let low = kept(answer.near).is_none_or(|end| end > zeros[0]);
        let high = kept(answer.far).is_none_or(|end| end < zeros[1]);
        if low || high {
            return Some("a zero left out");
        }
        // Rounding errors may make the result wider than the range of zeros, but nothing else may.
        let unit = BigRational::from_float(match T::FORMAT {
            zeroset_interval::Format::F32 => 2f64.powi(-20),
            zeroset_interval::Format::F64 => 2f64.powi(-49),
        })?;
        let tiny = exact(T::LARGEST.into()).map(|most| BigRational::one() / most)?;
        let size = middle.abs() + &half;
        let slack = &size * &unit + &half * (&rest / depth.abs().max(tiny.clone())) * unit + tiny;
        // If sums may overflow, the result need not be narrow.
        let is_normal = depth.abs() > exact(2f64.powi(-100))?
            && centre.abs() + &rest < exact(T::LARGEST.into())? / BigRational::from_float(4.0)?;
        let wide = kept(answer.near)? < zeros[0].clone() - &slack
            || kept(answer.far)? > zeros[1].clone() + slack;
        (is_normal && wide).then_some("hardly narrowed")
    }
}

/// Returns a segment's middle and its distance to the farther end, rounded as in kernels.
fn middle<T: Adversarial>(near: f64, far: f64) -> (f64, f64) {
    let m = &mut Software::new();
    let lanes = |x: f64| T::load(&Lanes([T::nearest(x); LANES]), 0);
    let (near, far) = (lanes(near), lanes(far));
    let sum = m.add(near, far);
    let half = m.number(T::FORMAT, 0.5);
    let middle = m.mul(sum, half);
    let (after, before) = (m.sub(far, middle), m.sub(middle, near));
    let half = m.max(after, before);
    let first = |vector| {
        let mut numbers = Lanes::<T>::default();
        T::store(vector, 0, &mut numbers);
        numbers[0].into()
    };
    (first(middle), first(half))
}
