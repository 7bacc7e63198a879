//! Compares native enclosures of one-variable functions with correctly rounded values, at every
//! float.
//!
//! The kernel under test is used as in pictures: it is compiled from a tape, evaluates batches of
//! sixteen floats, and rounds to +∞. The reference values come from `core-math` alone.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use zeroset_eval::{Assumptions, Binding, Boxes, Enclose, Enclosures, Kernel, LANES, Tape};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Axis, Graph};
use zeroset_jit::Native;
use zeroset_ops::Op;

/// Number of floats that a thread takes at a time.
const CHUNK: u64 = 1 << 16;
/// Greatest angle with tight enclosures. Beyond it, an enclosure is the function's whole range.
const ANGLE_LIMIT: f32 = 8_388_608.0;
/// If the code may assume that angles are within this bound, it reduces them in fewer steps.
const COMMON_LIMIT: f32 = 1_048_576.0;
/// If the code may assume that angles are within this bound, it uses a rule for angles near 0.
const NEAR_LIMIT: f32 = 192.0;

/// A function of one variable, with its reference values.
pub struct Function {
    /// The operation.
    pub op: Op,
    truth: fn(f32) -> ReferenceValue,
    /// Lower and upper bound of all values of the function.
    range: [f64; 2],
    limit: f32,
    /// The code may assume that operands are within this bound. Floats beyond it are not checked.
    pub within: Option<f32>,
}

/// Reference value of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ReferenceValue {
    /// The function is undefined.
    Undefined,
    /// The value is this number.
    Exactly(f64),
    /// The value is not a float, and this is the nearest `f64`.
    Near(f64),
    /// The value is within an error of the first number. Widths count in units in the last place of
    /// the third, the amplitude of a wave.
    Wave { value: f64, error: f64, amplitude: f64 },
}

/// Returns every function to be checked.
pub fn functions() -> Vec<Function> {
    const REALS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    const UNIT: [f64; 2] = [-1.0, 1.0];
    let all = |op, range, limit, truth| Function { op, truth, range, limit, within: None };
    let wave = |op, range, truth, within| Function { within, ..all(op, range, ANGLE_LIMIT, truth) };
    let sin = |x: f32| where_defined(true, core_math::sin(f64::from(x)), x == 0.0);
    let cos = |x: f32| where_defined(true, core_math::cos(f64::from(x)), x == 0.0);
    let tan = |x: f32| where_defined(true, core_math::tan(f64::from(x)), x == 0.0);
    vec![
        wave(Op::Sin, UNIT, sin, None),
        wave(Op::Sin, UNIT, sin, Some(COMMON_LIMIT)),
        wave(Op::Sin, UNIT, sin, Some(NEAR_LIMIT)),
        wave(Op::Cos, UNIT, cos, None),
        wave(Op::Cos, UNIT, cos, Some(COMMON_LIMIT)),
        wave(Op::Cos, UNIT, cos, Some(NEAR_LIMIT)),
        wave(Op::Tan, REALS, tan, None),
        wave(Op::Tan, REALS, tan, Some(COMMON_LIMIT)),
        all(Op::Sqrt, [0.0, f64::INFINITY], f32::MAX, |x| {
            let root = f64::from(x).sqrt();
            let is_exact = f64::from(root as f32) == root && root * root == f64::from(x);
            where_defined(x >= 0.0, root, is_exact)
        }),
        all(Op::Cbrt, REALS, f32::MAX, |x| {
            let root = core_math::cbrt(f64::from(x));
            // A root of 24 bits has an exact square. So the fused product is 0 only if root³ = x.
            let is_short = f64::from(root as f32) == root;
            let is_exact = is_short && (root * root).mul_add(root, -f64::from(x)) == 0.0;
            where_defined(true, root, is_exact)
        }),
        // By Lindemann's theorem, functions like exp are irrational at all rationals but one.
        all(Op::Exp, [0.0, f64::INFINITY], f32::MAX, |x| {
            where_defined(true, core_math::exp(f64::from(x)), x == 0.0)
        }),
        all(Op::Ln, REALS, f32::MAX, |x| {
            where_defined(x > 0.0, core_math::log(f64::from(x)), x == 1.0)
        }),
        all(Op::Log2, REALS, f32::MAX, |x| {
            let value = core_math::log2(f64::from(x));
            // An integer power of 2 is a normal f64 whose fraction bits are 0.
            let is_power = f64::from(x).to_bits() << 12 == 0;
            where_defined(x > 0.0, value, is_power)
        }),
        all(Op::Log10, REALS, f32::MAX, |x| {
            let value = core_math::log10(f64::from(x));
            // 10¹⁰ is the last power of 10 that is an f32: 5¹⁰ fits into 24 bits, and 5¹¹ does not.
            let is_power = (0..=10).any(|n| f64::from(x) == 10_f64.powi(n));
            where_defined(x > 0.0, value, is_power)
        }),
        all(Op::Asin, REALS, f32::MAX, |x| {
            where_defined(x.abs() <= 1.0, core_math::asin(f64::from(x)), x == 0.0)
        }),
        all(Op::Acos, REALS, f32::MAX, |x| {
            where_defined(x.abs() <= 1.0, core_math::acos(f64::from(x)), x == 1.0)
        }),
        all(Op::Atan, REALS, f32::MAX, |x| {
            where_defined(true, core_math::atan(f64::from(x)), x == 0.0)
        }),
        all(Op::Sinh, REALS, f32::MAX, |x| {
            where_defined(true, core_math::sinh(f64::from(x)), x == 0.0)
        }),
        all(Op::Cosh, [1.0, f64::INFINITY], f32::MAX, |x| {
            where_defined(true, core_math::cosh(f64::from(x)), x == 0.0)
        }),
        all(Op::Tanh, UNIT, f32::MAX, |x| {
            where_defined(true, core_math::tanh(f64::from(x)), x == 0.0)
        }),
        all(Op::Asinh, REALS, f32::MAX, |x| {
            where_defined(true, core_math::asinh(f64::from(x)), x == 0.0)
        }),
        all(Op::Acosh, REALS, f32::MAX, |x| {
            where_defined(x >= 1.0, core_math::acosh(f64::from(x)), x == 1.0)
        }),
        all(Op::Erf, UNIT, f32::MAX, |x| {
            where_defined(true, core_math::erf(f64::from(x)), x == 0.0)
        }),
        wave(Op::BesselJ0, UNIT, |x| bessel(0, x), None),
        wave(Op::BesselJ1, UNIT, |x| bessel(1, x), None),
        wave(Op::BesselJ2, UNIT, |x| bessel(2, x), None),
        wave(Op::BesselJ3, UNIT, |x| bessel(3, x), None),
        wave(Op::BesselJ0, UNIT, |x| bessel(0, x), Some(NEAR_LIMIT)),
        wave(Op::BesselJ3, UNIT, |x| bessel(3, x), Some(11.0)),
        all(Op::Atanh, REALS, f32::MAX, |x| {
            where_defined(x.abs() < 1.0, core_math::atanh(f64::from(x)), x == 0.0)
        }),
    ]
}

/// A Bessel function by `libm`, which errs by a few units in the last place of 1, and of the angle.
fn bessel(order: i32, x: f32) -> ReferenceValue {
    if x == 0.0 {
        return ReferenceValue::Exactly(if order == 0 { 1.0 } else { 0.0 });
    }
    let x = f64::from(x);
    let value = libm::jn(order, x);
    let swing = if x.abs() < 2.0 { 0.0 } else { (0.6 / x.abs()).sqrt() };
    let amplitude = swing.max(value.abs());
    ReferenceValue::Wave { value, error: 16.0 * f64::EPSILON * amplitude, amplitude }
}

fn where_defined(defined: bool, value: f64, exact: bool) -> ReferenceValue {
    match (defined, exact) {
        (false, _) => ReferenceValue::Undefined,
        (true, true) => ReferenceValue::Exactly(value),
        (true, false) => ReferenceValue::Near(value),
    }
}

/// Results of a sweep.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Number of floats checked.
    pub tried: u64,
    /// Number of enclosures that miss the value or report other facts than expected.
    pub violations: u64,
    /// Operand of one violation.
    pub violation: Option<f32>,
    /// Number of floats beyond the function's limit. For these, only containment is checked.
    pub beyond: u64,
    /// Number of enclosures with an infinite end although the value is within the range of `f32`.
    pub unbounded: u64,
    /// Operand of smallest magnitude that `unbounded` counts.
    pub first_unbounded: Option<f32>,
    /// Number of bounded enclosures that are wider than the function's row in the table allows.
    pub wide: u64,
    /// Operand of smallest magnitude that `wide` counts.
    pub first_wide: Option<f32>,
    /// Greatest number of ulps by which a bounded enclosure is wider than the tightest.
    pub worst: u64,
    /// Operand of an enclosure that is `worst` ulps too wide.
    pub worst_at: Option<f32>,
    /// Total number of ulps by which the measured enclosures are wider than the tightest.
    pub excess: u64,
    /// Number of enclosures whose width was measured.
    pub measured: u64,
}

impl Report {
    fn add(&mut self, other: &Self) {
        self.tried += other.tried;
        self.violations += other.violations;
        self.violation = self.violation.or(other.violation);
        self.beyond += other.beyond;
        self.unbounded += other.unbounded;
        self.first_unbounded = smaller(self.first_unbounded, other.first_unbounded);
        self.wide += other.wide;
        self.first_wide = smaller(self.first_wide, other.first_wide);
        if other.worst > self.worst || self.worst_at.is_none() {
            (self.worst, self.worst_at) = (other.worst, other.worst_at);
        }
        self.excess += other.excess;
        self.measured += other.measured;
    }

    /// Returns the mean number of ulps by which enclosures are wider than the tightest.
    pub fn mean(&self) -> f64 {
        self.excess as f64 / self.measured.max(1) as f64
    }

    fn violate(&mut self, x: f32) {
        self.violations += 1;
        self.violation = Some(x);
    }
}

/// Returns the operand of smaller magnitude.
fn smaller(a: Option<f32>, b: Option<f32>) -> Option<f32> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a.abs() <= b.abs() { a } else { b }),
        (a, b) => a.or(b),
    }
}

impl Function {
    /// Returns the function's name, with the bound of its operand if there is one.
    pub fn name(&self) -> String {
        let name = self.op.row().name;
        self.within.map_or(name.to_owned(), |limit| format!("{name}-{limit}"))
    }

    /// Checks the native enclosure at each finite float whose bits are a multiple of `stride`. Uses
    /// all processors.
    ///
    /// # Panics
    /// If the processor is not supported or `stride` is 0.
    pub fn sweep(&self, stride: u64) -> Report {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let root = graph.apply(self.op, &[x]);
        let mut assumptions = Assumptions::none(0);
        if let Some(limit) = self.within {
            assumptions.domain = [Interval { lo: -f64::from(limit), hi: f64::from(limit) }; 3];
        }
        let tape = Tape::new(&graph, &[root], &assumptions);
        let kernel = Native::new(tape, Binding::empty()).expect("compiles");
        let count = (1_u64 << 32).div_ceil(stride);
        let (next, total) = (AtomicU64::new(0), Mutex::new(Report::default()));
        let threads = thread::available_parallelism().map_or(1, usize::from);
        thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    let mut report = Report::default();
                    loop {
                        let first = next.fetch_add(CHUNK, Ordering::Relaxed);
                        if first >= count {
                            break;
                        }
                        let bits = (first..count.min(first + CHUNK)).map(|i| (i * stride) as u32);
                        self.check(&kernel, bits.map(f32::from_bits), &mut report);
                    }
                    total.lock().expect("no thread panics").add(&report);
                });
            }
        });
        total.into_inner().expect("no thread panics")
    }

    fn check(
        &self,
        kernel: &dyn Kernel<Enclose>,
        xs: impl Iterator<Item = f32>,
        report: &mut Report,
    ) {
        let xs: Vec<f32> = xs.filter(|x| x.abs() <= self.within.unwrap_or(f32::MAX)).collect();
        let (mut boxes, mut out) = (Boxes::default(), Enclosures::default());
        for xs in xs.chunks(LANES) {
            boxes.count = xs.len() as u32;
            for (lane, x) in xs.iter().enumerate() {
                (boxes.neg_lo[0][lane], boxes.hi[0][lane]) = (-x, *x);
            }
            kernel.eval(&boxes, &mut out);
            for (lane, &x) in xs.iter().enumerate() {
                self.judge(x, -out.neg_lo[lane], out.hi[lane], out.facts(lane), report);
            }
        }
    }

    fn judge(&self, x: f32, lo: f32, hi: f32, facts: Facts, report: &mut Report) {
        report.tried += 1;
        let truth = (self.truth)(x);
        let (value, exact) = match truth {
            ReferenceValue::Undefined => {
                // The function must be reported as undefined outside its domain of definition.
                if facts != Facts::NOWHERE {
                    report.violate(x);
                }
                return;
            }
            ReferenceValue::Exactly(value) => (value, true),
            ReferenceValue::Near(value) | ReferenceValue::Wave { value, .. } => (value, false),
        };
        // Bounds of the exact value. If `value` is rounded, they are the floats next to it.
        let claim = if exact {
            [value; 2]
        } else if let ReferenceValue::Wave { error, .. } = truth {
            // The least normal number covers results that `libm` lets underflow.
            let error = error.max(f64::MIN_POSITIVE);
            [(value - error).max(self.range[0]), (value + error).min(self.range[1])]
        } else {
            [value.next_down().max(self.range[0]), value.next_up().min(self.range[1])]
        };
        let holds = f64::from(lo) <= claim[0] && claim[1] <= f64::from(hi);
        if !holds || facts.has(Facts::NOWHERE) {
            report.violate(x);
            return;
        }
        if x.abs() > self.limit {
            report.beyond += 1;
            return;
        }
        let is_float = value.abs() <= f64::from(f32::MAX);
        if is_float && (lo.is_infinite() || hi.is_infinite()) {
            report.unbounded += 1;
            report.first_unbounded = smaller(report.first_unbounded, Some(x));
            return;
        }
        if facts != Facts::TOTAL {
            report.violate(x); // the function is continuous here, but the facts deny it
            return;
        }
        let tightest = u64::from(!exact || f64::from(value as f32) != value);
        let excess = match truth {
            ReferenceValue::Wave { amplitude, .. } => {
                let ulp = (amplitude as f32).next_up() - amplitude as f32;
                (((hi - lo) / ulp).ceil() as u64).saturating_sub(1)
            }
            _ => place(hi).abs_diff(place(lo)) - tightest,
        };
        report.measured += 1;
        report.excess += excess;
        if excess > report.worst || report.worst_at.is_none() {
            (report.worst, report.worst_at) = (excess, Some(x));
        }
        if excess > self.op.row().excess.map_or(0, |[in_f32, _]| in_f32) {
            report.wide += 1;
            report.first_wide = smaller(report.first_wide, Some(x));
        }
    }
}

/// Returns the number of floats between 0 and `x`, with the sign of `x`.
fn place(x: f32) -> i64 {
    let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
    if x.is_sign_negative() { -magnitude } else { magnitude }
}
