//! Native enclosures of functions of one variable at every float, against correctly rounded values.
//!
//! The kernel under test is the one a picture runs: compiled from a tape, called with the rounding
//! mode set to +∞, sixteen floats a batch. What is true comes from `core-math` alone.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use zeroset_eval::{Assumptions, Binding, Boxes, Enclose, Enclosures, Kernel, LANES, Tape};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::{Axis, Graph};
use zeroset_jit::Native;
use zeroset_ops::Op;

/// Floats that a thread takes at a time.
const CHUNK: u64 = 1 << 16;
/// Angles up to here are enclosed tightly; beyond, an enclosure is the function's range.
const ANGLE_LIMIT: f32 = 8_388_608.0;
/// Angles that never leave these bounds are reduced in fewer steps.
const COMMON_LIMIT: f32 = 1_048_576.0;
/// Sine and cosine have a text of their own for operands that never leave these bounds.
const NEAR_LIMIT: f32 = 192.0;

/// A function of one variable and the truth about it.
pub struct Function {
    /// The operation.
    pub op: Op,
    truth: fn(f32) -> Truth,
    /// Between which numbers all its values lie.
    range: [f64; 2],
    limit: f32,
    /// Bounds that the code may assume of its operand, if any: other floats are not tried then.
    pub within: Option<f32>,
}

/// What is certain of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Truth {
    /// There is none.
    Undefined,
    /// It is this number.
    Exactly(f64),
    /// It is not a float; this is the nearest `f64`.
    Near(f64),
}

/// Every function that is swept.
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
            // The square of 24 bits is exact, and so is what the fused product leaves of the cube.
            let is_short = f64::from(root as f32) == root;
            let is_exact = is_short && (root * root).mul_add(root, -f64::from(x)) == 0.0;
            where_defined(true, root, is_exact)
        }),
        // A rational operand but 0 (1 for a logarithm) has an irrational value under these:
        // Lindemann.
        all(Op::Exp, [0.0, f64::INFINITY], f32::MAX, |x| {
            where_defined(true, core_math::exp(f64::from(x)), x == 0.0)
        }),
        all(Op::Ln, REALS, f32::MAX, |x| {
            where_defined(x > 0.0, core_math::log(f64::from(x)), x == 1.0)
        }),
        all(Op::Log2, REALS, f32::MAX, |x| {
            let value = core_math::log2(f64::from(x));
            // 2 to an integer is a normal f64 with no fraction bits.
            let is_power = f64::from(x).to_bits() << 12 == 0;
            where_defined(x > 0.0, value, is_power)
        }),
        all(Op::Log10, REALS, f32::MAX, |x| {
            let value = core_math::log10(f64::from(x));
            // 5¹⁰ is the last power of five with 24 bits.
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
        all(Op::Atanh, REALS, f32::MAX, |x| {
            where_defined(x.abs() < 1.0, core_math::atanh(f64::from(x)), x == 0.0)
        }),
    ]
}

fn where_defined(defined: bool, value: f64, exact: bool) -> Truth {
    match (defined, exact) {
        (false, _) => Truth::Undefined,
        (true, true) => Truth::Exactly(value),
        (true, false) => Truth::Near(value),
    }
}

/// What a sweep found.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Floats tried.
    pub tried: u64,
    /// Enclosures that do not hold the value, or facts that are not so.
    pub violations: u64,
    /// The operand of one of them.
    pub violation: Option<f32>,
    /// Floats beyond which only the range is claimed.
    pub beyond: u64,
    /// Enclosures with an infinite end where the value is a float.
    pub unbounded: u64,
    /// The operand of smallest magnitude with such an enclosure.
    pub first_unbounded: Option<f32>,
    /// Enclosures wider than the tightest by more ulps than the function's row allows, unbounded
    /// ones apart.
    pub wide: u64,
    /// The operand of smallest magnitude with such an enclosure.
    pub first_wide: Option<f32>,
    /// The most ulps that an enclosure is wider than the tightest, unbounded ones apart.
    pub worst: u64,
    /// The operand with it.
    pub worst_at: Option<f32>,
    /// Sum of those ulps over `measured` enclosures.
    pub excess: u64,
    /// Enclosures measured.
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

    /// The mean number of ulps wider than the tightest.
    pub fn mean(&self) -> f64 {
        self.excess as f64 / self.measured.max(1) as f64
    }

    fn violate(&mut self, x: f32) {
        self.violations += 1;
        self.violation = Some(x);
    }
}

/// The one of smaller magnitude.
fn smaller(a: Option<f32>, b: Option<f32>) -> Option<f32> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a.abs() <= b.abs() { a } else { b }),
        (a, b) => a.or(b),
    }
}

impl Function {
    /// The function's name, and what is assumed of its operand.
    pub fn name(&self) -> String {
        let name = self.op.row().name;
        self.within.map_or(name.to_owned(), |limit| format!("{name}-{limit}"))
    }

    /// Checks the native enclosure at each finite float whose bits are a multiple of `stride`, on
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
        let (value, exact) = match (self.truth)(x) {
            Truth::Undefined => {
                // A point outside the domain is known to be one.
                if facts != Facts::NOWHERE {
                    report.violate(x);
                }
                return;
            }
            Truth::Exactly(value) => (value, true),
            Truth::Near(value) => (value, false),
        };
        // The value, widened by an ulp of f64 within the range of the function.
        let claim = if exact {
            [value; 2]
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
            report.violate(x); // needlessly modest: the function is continuous at this point
            return;
        }
        let tightest = u64::from(!exact || f64::from(value as f32) != value);
        let excess = place(hi).abs_diff(place(lo)) - tightest;
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

/// The number of floats between 0 and `x`, with the sign of `x`.
fn place(x: f32) -> i64 {
    let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
    if x.is_sign_negative() { -magnitude } else { magnitude }
}
