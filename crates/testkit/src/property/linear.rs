//! Affine forms of single operations must enclose the operations' values.

use super::dot::dot;
use crate::suite::Failure;
use crate::{Adversarial, Defined, Ends, Oracle, Rng, hexadecimal, random_constant};
use std::f64::consts::FRAC_PI_2;
use zeroset_eval::{LANES, Lanes};
use zeroset_interval::{
    Enclosure, Exponent, Facts, Form, FormOperand, Interval, Machine, Software,
    Vector128 as Vector, fold, linearise,
};
use zeroset_ir::{Axis, Constant, Graph};
use zeroset_ops::Op;

/// Number of symbols of an affine form.
const SYMBOLS: usize = 3;
/// Points checked in each lane.
const POINTS: usize = 8;

/// Counts of the checks done by [`linear`].
#[derive(Clone, Copy, Debug, Default)]
pub struct FormTally {
    /// Number of compared values. Each is at a point where the operation is defined, and in a lane
    /// where the form's error is finite.
    pub compared: u64,
    /// Number of lanes in which values were compared.
    pub finite: u64,
    /// Number of lanes counted by `finite` whose form depends on a symbol.
    pub slanted: u64,
    /// Number of all lanes.
    pub lanes: u64,
    /// Sum of the errors of the lanes counted by `finite`, as logarithms.
    pub errors: f64,
}

impl FormTally {
    /// Adds the counts of `other`.
    pub fn add(&mut self, other: Self) {
        self.compared += other.compared;
        self.finite += other.finite;
        self.slanted += other.slanted;
        self.lanes += other.lanes;
        self.errors += other.errors;
    }
}

/// The kind of an operand, for all lanes.
enum OperandKind {
    /// An affine form c + Σ s·ε ± e.
    Varying,
    /// A value known only by bounds.
    Between,
    /// One number.
    Fixed(Constant),
}

/// One operand in one lane.
#[derive(Clone, Copy, Debug, Default)]
struct OperandLane {
    centre: f64,
    slopes: [f64; SYMBOLS],
    error: f64,
    bounds: [f64; 2],
}

/// An operand: its lanes, its assumed range, and its values at the points of each lane.
struct RandomOperand {
    kind: OperandKind,
    range: Interval,
    lanes: Vec<OperandLane>,
    values: Vec<[f64; POINTS]>,
}

/// Values of the symbols at the points of a lane.
type Symbols = [[f64; SYMBOLS]; POINTS];

/// Checks the form of `op` over `rounds` vectors of random operands. At points of each lane the
/// oracle's bounds of the operation must overlap the form.
///
/// # Errors
/// The first contradiction.
pub fn linear<T: Adversarial>(op: Op, rng: &mut Rng, rounds: usize) -> Result<FormTally, Failure> {
    linear_on::<T, Software>(op, rng, rounds, &|software| software)
}

/// Runs [`linear`] on another machine, which `machine` creates in place of a software machine.
///
/// # Errors
/// The first contradiction.
pub fn linear_on<T: Adversarial, M: Machine<V = Vector>>(
    op: Op,
    rng: &mut Rng,
    rounds: usize,
    machine: &dyn Fn(Software) -> M,
) -> Result<FormTally, Failure> {
    let mut form_tally = FormTally::default();
    for _ in 0..rounds {
        let symbols: Vec<Symbols> = (0..T::VECTOR_LANES).map(|_| random_symbols(rng)).collect();
        let inner = random_inner(op, rng);
        let fixed = rng.u32(0..2 * op.arity() as u32) as usize;
        let made_of = inner.map_or(0, Op::arity);
        let mut operands: Vec<RandomOperand> = (0..made_of)
            .map(|_| RandomOperand::random::<T>(rng, OperandKind::Varying, &symbols))
            .collect();
        operands.extend((made_of.min(1)..op.arity()).map(|place| {
            let kind = match rng.u32(0..4) {
                // The exponent of a power is mostly a constant.
                _ if op == Op::Pow && place == 1 && fixed > 0 => OperandKind::Fixed(exponent(rng)),
                0 if op.arity() > 1 && fixed == place => {
                    OperandKind::Fixed(random_constant(rng, true))
                }
                1 if op.arity() > 1 && fixed == place => OperandKind::Between,
                _ => OperandKind::Varying,
            };
            RandomOperand::random::<T>(rng, kind, &symbols)
        }));
        let machine = machine(Software::BOTH[usize::from(rng.bool())]);
        form_tally.add(compare::<T, M>(machine, op, inner, &symbols, &operands)?);
    }
    Ok(form_tally)
}

/// Returns an operation that computes the first operand of `op`, or `None` to draw that operand
/// directly. An operation may leave its rounding errors to the next operation, so computed operands
/// are checked, too. If `op` has 3 operands, none is computed: then each drawn operand has its own
/// coordinate.
fn random_inner(op: Op, rng: &mut Rng) -> Option<Op> {
    const INNER: [Op; 5] = [Op::Neg, Op::Add, Op::Sub, Op::Mul, Op::Sqr];
    (op.arity() < 3 && rng.bool()).then(|| INNER[rng.u32(0..INNER.len() as u32) as usize])
}

fn compare<T: Adversarial, M: Machine<V = Vector>>(
    mut machine: M,
    op: Op,
    inner: Option<Op>,
    symbols: &[Symbols],
    operands: &[RandomOperand],
) -> Result<FormTally, Failure> {
    let mut form_tally = FormTally::default();
    let mut graph = Graph::new();
    let mut nodes: Vec<_> = operands
        .iter()
        .zip(Axis::ALL)
        .map(|(operand, axis)| match &operand.kind {
            OperandKind::Fixed(value) => graph.constant(value.clone()),
            OperandKind::Varying | OperandKind::Between => graph.variable(axis),
        })
        .collect();
    let mut forms: Vec<_> = operands.iter().map(RandomOperand::operand::<T>).collect();
    if let Some(inner) = inner {
        let node = graph.apply(inner, &nodes[..inner.arity()]);
        nodes.splice(..inner.arity(), [node]);
        let ranges: Vec<_> =
            operands[..inner.arity()].iter().map(|drawn| (drawn.range, Facts::TOTAL)).collect();
        let (Interval { lo, hi }, _) = fold(inner, &ranges);
        let range = Interval { lo: -T::above(-lo).into(), hi: T::above(hi).into() };
        let value = linearise(&mut machine, T::FORMAT, inner, &forms[..inner.arity()]);
        let exponent = Exponent::Real;
        forms.splice(..inner.arity(), [FormOperand { value, range, exponent }]);
    }
    let root = graph.apply(op, &nodes);
    let oracle = Oracle::new(&graph, &[root]);
    let form = linearise(&mut machine, T::FORMAT, op, &forms);
    let numbers = |vector| {
        let mut lanes = Lanes::<T>::default();
        T::store(vector, 0, &mut lanes);
        lanes.map(Into::<f64>::into)
    };
    let centre = numbers(form.centre);
    let slopes = form.slopes.map(|slopes| slopes.map(numbers));
    let error = form.error(&mut machine, T::FORMAT).map_or([0.0; LANES], numbers);
    for lane in 0..T::VECTOR_LANES {
        let slopes = slopes.map_or([0.0; SYMBOLS], |slopes| slopes.map(|slope| slope[lane]));
        let (centre, error) = (centre[lane], error[lane]);
        form_tally.lanes += 1;
        let fail = |what: String| {
            let operands = operands.iter().map(|operand| {
                let constant = match &operand.kind {
                    OperandKind::Fixed(value) => format!("{value:?}"),
                    OperandKind::Varying | OperandKind::Between => String::new(),
                };
                format!("{constant} {:?} in {:?}", operand.lanes[lane], operand.range)
            });
            let operands = operands.collect::<Vec<_>>().join("\n  ");
            let form = format!("{centre:e} + {slopes:?} ± {error:e}");
            let inner = inner.map(|inner| format!(" {inner:?} of")).unwrap_or_default();
            let what = format!("{op:?} in {:?} of{inner}\n  {operands}\n{what}: {form}", T::FORMAT);
            Err(Failure::new(what))
        };
        if error < 0.0 {
            return fail("an error below 0".to_owned());
        }
        if !error.is_finite() {
            continue;
        }
        let is_number = centre.is_finite() && slopes.iter().all(|slope| slope.is_finite());
        let before = form_tally.compared;
        for (index, symbols) in symbols[lane].iter().enumerate() {
            let mut point = [0.0; 3];
            let values = operands.iter().map(|operand| operand.values[lane][index]);
            point.iter_mut().zip(values).for_each(|(coordinate, value)| *coordinate = value);
            let claims_nothing = point.iter().zip(operands).any(|(value, operand)| {
                !matches!(operand.kind, OperandKind::Fixed(_)) && !operand.range.contains(*value)
            });
            let claim = oracle.at(point, &[])[0];
            if claims_nothing || claim.defined != Defined::Yes {
                continue;
            }
            form_tally.compared += 1;
            if !is_number {
                return fail("a form that is no number".into());
            }
            let line = || slopes.into_iter().zip(*symbols).chain([(centre, 1.0)]);
            let above = dot(line().map(|(a, b)| (-a, b)).chain([(claim.lo, 1.0), (-error, 1.0)]));
            let below = dot(line().chain([(-claim.hi, 1.0), (-error, 1.0)]));
            if above.is_positive() || below.is_positive() {
                let at = point.map(hexadecimal);
                return fail(format!("at {at:?}, symbols {symbols:?}, {claim:?} is not within"));
            }
        }
        // A lane counts only if the operation has a certain value at one of its points.
        if form_tally.compared > before {
            form_tally.finite += 1;
            form_tally.errors += error.max(T::LEAST_NORMAL.into()).log2();
            form_tally.slanted += u64::from(slopes.iter().any(|slope| *slope != 0.0));
        }
    }
    Ok(form_tally)
}

/// Returns random values of the symbols, mostly −1, 0 or 1.
fn random_symbols(rng: &mut Rng) -> Symbols {
    [(); POINTS].map(|()| {
        [(); SYMBOLS].map(|()| match rng.u32(0..4) {
            0 => -1.0,
            1 => 1.0,
            2 => 0.0,
            _ => f64::uniform(rng) * 2.0 - 1.0,
        })
    })
}

fn exponent(rng: &mut Rng) -> Constant {
    match rng.u32(0..4) {
        0 => random_constant(rng, true),
        1 => Constant::ratio(i64::from(rng.i32(-9..=9)), 4).expect("a ratio"),
        2 => Constant::integer(i64::from(rng.i32(-70..=70))),
        _ => Constant::integer(i64::from(rng.i32(-3..=8))),
    }
}

/// Numbers at which operations have kinks, poles, ends of their domains, or overflow.
const CORNERS: [f64; 12] =
    [0.0, 0.0, 1.0, -1.0, 0.5, FRAC_PI_2, -FRAC_PI_2, 2.0, 88.7, -87.3, 709.0, -3.0];

fn random_centre<T: Adversarial>(rng: &mut Rng) -> f64 {
    let centre = match rng.u32(0..8) {
        0 => T::adversarial(rng, Ends::Finite).into(),
        1 | 2 => CORNERS[rng.u32(0..CORNERS.len() as u32) as usize],
        3 => 2f64.powi(rng.i32(-30..=30)) * (f64::uniform(rng) - 0.5),
        4 => 10f64.powi(rng.i32(-37..=38)) * f64::uniform(rng),
        _ => f64::uniform(rng) * 8.0 - 4.0,
    };
    T::nearest(centre).into()
}

/// Returns how far an operand spreads: 0, 1e-6 to 10, a share of the center, or any number.
fn random_size<T: Adversarial>(rng: &mut Rng, centre: f64) -> f64 {
    let size = match rng.u32(0..8) {
        0 => T::adversarial(rng, Ends::Finite).into().abs(),
        1 => 0.0,
        2 | 3 => centre.abs() * 10f64.powi(-rng.i32(0..=7)),
        _ => 10f64.powi(rng.i32(-6..=1)),
    };
    size.min(T::LARGEST.into() / 8.0)
}

fn random_range<T: Adversarial>(rng: &mut Rng) -> Interval {
    let size: f64 = T::nearest(10f64.powi(rng.i32(-3..=6))).into();
    let (lo, hi) = match rng.u32(0..12) {
        0 => (-size, size),
        1 => (0.0, f64::INFINITY),
        2 => (f64::NEG_INFINITY, 0.0),
        3 => (0.0, size),
        4 => (T::nearest(1e-3).into(), size.max(1.0)),
        5 => (-1.0, 1.0),
        6 => (1.0, f64::INFINITY),
        7 => (-size, 0.0),
        _ => return Interval::ENTIRE,
    };
    Interval { lo, hi }
}

impl RandomOperand {
    fn random<T: Adversarial>(rng: &mut Rng, kind: OperandKind, symbols: &[Symbols]) -> Self {
        let range = match &kind {
            OperandKind::Fixed(value) => {
                let Interval { lo, hi } = value.bounds();
                Interval { lo: -T::above(-lo).into(), hi: T::above(hi).into() }
            }
            OperandKind::Varying | OperandKind::Between => random_range::<T>(rng),
        };
        let (mut lanes, mut values) = (Vec::new(), Vec::new());
        for symbols in symbols {
            let (lane, at) = match &kind {
                OperandKind::Varying => varying::<T>(rng, symbols),
                OperandKind::Between => {
                    let mut end = || random_centre::<T>(rng).clamp(range.lo, range.hi);
                    let (a, b) = (end(), end());
                    let bounds = [a.min(b), a.max(b)];
                    let share = f64::uniform(rng);
                    let middle = bounds[0] * share + bounds[1] * (1.0 - share);
                    let at = [bounds[0], bounds[1], middle.clamp(bounds[0], bounds[1])];
                    let at = std::array::from_fn(|index| at[index % 3]);
                    (OperandLane { bounds, ..OperandLane::default() }, at)
                }
                OperandKind::Fixed(_) => (
                    OperandLane { bounds: [range.lo, range.hi], ..OperandLane::default() },
                    [0.0; POINTS],
                ),
            };
            lanes.push(lane);
            values.push(at);
        }
        Self { kind, range, lanes, values }
    }

    fn operand<T: Adversarial>(&self) -> FormOperand<Vector, SYMBOLS> {
        let lanes = |number: &dyn Fn(&OperandLane) -> f64| {
            let mut lanes = Lanes::<T>::default();
            for (to, lane) in lanes.iter_mut().zip(&self.lanes) {
                *to = T::nearest(number(lane));
            }
            T::load(&lanes, 0)
        };
        let value = match self.kind {
            OperandKind::Varying => {
                let slopes = [0, 1, 2].map(|k| lanes(&|lane| lane.slopes[k]));
                let centre = lanes(&|lane| lane.centre);
                Form::coordinate(centre, slopes, lanes(&|lane| lane.error))
            }
            OperandKind::Fixed(_) => Form::constant(&mut Software::new(), T::FORMAT, self.range),
            OperandKind::Between => {
                let (neg_lo, hi) = (lanes(&|lane| -lane.bounds[0]), lanes(&|lane| lane.bounds[1]));
                Form::between(&mut Software::new(), T::FORMAT, &Enclosure::total(neg_lo, hi))
            }
        };
        let exponent = match &self.kind {
            OperandKind::Fixed(value) => value.exponent(),
            OperandKind::Varying | OperandKind::Between => Exponent::Real,
        };
        FormOperand { value, range: self.range, exponent }
    }
}

/// Returns a lane, and a value for each point of `symbols`. The value is near the lane's linear
/// function, or offset from it. The lane's error covers all values.
fn varying<T: Adversarial>(rng: &mut Rng, symbols: &Symbols) -> (OperandLane, [f64; POINTS]) {
    let mut centre = random_centre::<T>(rng);
    let size = random_size::<T>(rng, centre);
    let slopes = [(); SYMBOLS].map(|()| match rng.u32(0..4) {
        0 => 0.0,
        1 => T::nearest(if rng.bool() { size } else { -size }).into(),
        _ => T::nearest((f64::uniform(rng) * 2.0 - 1.0) * size).into(),
    });
    if rng.u32(0..4) == 0 {
        // Moves the center, so that the old center is one end of the range.
        let spread: f64 = slopes.iter().map(|slope: &f64| slope.abs()).sum();
        centre = T::nearest(centre + if rng.bool() { spread } else { -spread }).into();
    }
    let extra = match rng.u32(0..4) {
        0 => size * 10f64.powi(-rng.i32(0..=6)),
        1 => centre.abs() * 2f64.powi(-rng.i32(20..=30)),
        _ => 0.0,
    };
    let line = |symbols: [f64; SYMBOLS]| slopes.into_iter().zip(symbols).chain([(centre, 1.0)]);
    let mut error = 0.0_f64;
    let values = symbols.map(|symbols| {
        let off = [-extra, extra, 0.0][rng.u32(0..3) as usize];
        let value = dot(line(symbols)).value + off;
        error = error.max(dot(line(symbols).chain([(-value, 1.0)])).most());
        value
    });
    let error = T::above(error).into();
    (OperandLane { centre, slopes, error, bounds: [0.0; 2] }, values)
}
