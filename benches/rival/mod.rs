//! Hand-written rivals of native kernels, and a function that times both. The rivals are three
//! interval functions in 128-bit intrinsics. They do the operations that simplification leaves in
//! the formulas. glam's `Vec4` is `__m128`, and each of its operations below is one instruction.
//! The operations round to nearest, so the rivals are not rigorous.

use glam::Vec4;
use std::time::Instant;
use zeroset_eval::{
    Boxes, Enclose, Enclosures, FindZeros, Kernel, KernelResult, Kernels, LANES, SurfaceKernels,
    Zeros,
};

/// Four intervals, stored as (−lo, hi).
#[derive(Clone, Copy)]
pub struct Four {
    neg_lo: Vec4,
    hi: Vec4,
}

impl Four {
    /// Loads the ranges of four boxes along `axis`. The first box is in lane `lane`.
    #[inline]
    fn load(boxes: &Boxes, axis: usize, lane: usize) -> Self {
        Self {
            neg_lo: Vec4::from_slice(&boxes.neg_lo[axis][lane..lane + 4]),
            hi: Vec4::from_slice(&boxes.hi[axis][lane..lane + 4]),
        }
    }

    fn add(self, b: Self) -> Self {
        Self { neg_lo: self.neg_lo + b.neg_lo, hi: self.hi + b.hi }
    }

    fn sub(self, b: Self) -> Self {
        Self { neg_lo: self.neg_lo + b.hi, hi: self.hi + b.neg_lo }
    }

    fn plus(self, c: f32) -> Self {
        Self { neg_lo: self.neg_lo + Vec4::splat(-c), hi: self.hi + Vec4::splat(c) }
    }

    /// Multiplies by a positive number.
    fn times(self, c: f32) -> Self {
        Self { neg_lo: self.neg_lo * Vec4::splat(c), hi: self.hi * Vec4::splat(c) }
    }

    fn sqr(self) -> Self {
        let least = self.neg_lo.min(self.hi).min(Vec4::ZERO);
        let most = self.neg_lo.max(self.hi);
        Self { neg_lo: least * -least, hi: most * most }
    }

    /// Multiplies two nonnegative intervals.
    fn mul_nonneg(self, b: Self) -> Self {
        Self { neg_lo: -self.neg_lo * b.neg_lo, hi: self.hi * b.hi }
    }

    /// Multiplies two intervals. Four products suffice, since rounding to nearest is symmetric.
    fn mul(self, b: Self) -> Self {
        let (p, q) = (self.hi * b.hi, self.neg_lo * b.neg_lo);
        let (r, s) = (self.neg_lo * b.hi, self.hi * b.neg_lo);
        Self { neg_lo: r.max(s).max(-p.min(q)), hi: p.max(q).max(-r.min(s)) }
    }
}

/// A surface whose kernels call a hand-written interval function.
#[derive(Clone, Copy)]
pub struct Rival<F>(pub F);

impl<F: Fn([Four; 3]) -> Four + Send + Sync> Kernel<Enclose> for Rival<F> {
    #[inline]
    fn eval(&self, boxes: &Boxes, answers: &mut Enclosures) {
        // Like a native kernel, evaluates whole registers until all lanes in use are done.
        for lane in (0..LANES).step_by(4).take_while(|lane| *lane < boxes.count as usize) {
            let value = self.0([0, 1, 2].map(|axis| Four::load(boxes, axis, lane)));
            value.neg_lo.write_to_slice(&mut answers.neg_lo[lane..lane + 4]);
            value.hi.write_to_slice(&mut answers.hi[lane..lane + 4]);
        }
        (answers.nowhere, answers.defined, answers.continuous) = (0, u16::MAX, u16::MAX);
    }
}

impl<F: Fn([Four; 3]) -> Four + Send + Sync> Kernel<FindZeros> for Rival<F> {
    #[inline]
    fn eval(&self, boxes: &Boxes, zeros: &mut Zeros) {
        *zeros = Zeros::default();
        for lane in (0..LANES).step_by(4).take_while(|lane| *lane < boxes.count as usize) {
            let value = self.0([0, 1, 2].map(|axis| Four::load(boxes, axis, lane)));
            let holds = value.neg_lo.min(value.hi).cmpge(Vec4::ZERO);
            zeros.possible |= (holds.bitmask() as u16) << lane;
        }
    }
}

impl<F: Fn([Four; 3]) -> Four + Send + Sync> Kernels<f32> for Rival<F> {
    fn zeros(&self) -> KernelResult<'_, FindZeros, f32> {
        Ok(self)
    }
}

impl<F: Fn([Four; 3]) -> Four + Send + Sync> SurfaceKernels for Rival<F> {
    fn single(&self) -> &dyn Kernels<f32> {
        self
    }
}

#[inline]
pub fn sphere([x, y, z]: [Four; 3]) -> Four {
    x.sqr().add(y.sqr()).add(z.sqr()).plus(-1.0)
}

#[inline]
pub fn mitchell([x, y, z]: [Four; 3]) -> Four {
    let (x2, yz) = (x.sqr(), y.sqr().add(z.sqr()));
    let squares = x2.plus(-2.5).sqr().add(yz.plus(-2.5).sqr()).times(4.0);
    squares.add(x2.mul_nonneg(yz).times(17.0)).plus(-33.0)
}

#[inline]
pub fn barth([x, y, z]: [Four; 3]) -> Four {
    const PHI_2: f32 = 2.618_034;
    const WEIGHT: f32 = 4.236_068;
    let (x2, y2, z2) = (x.sqr(), y.sqr(), z.sqr());
    let a = y2.sub(x2.times(PHI_2));
    let b = z2.sub(y2.times(PHI_2));
    let c = x2.sub(z2.times(PHI_2));
    let product = a.mul(b).mul(c).times(4.0);
    let ball = x2.add(y2).add(z2).plus(-1.0).sqr().times(WEIGHT);
    let sum = product.add(ball);
    Four { neg_lo: sum.hi, hi: sum.neg_lo }
}

/// Name of each surface, its formula as typed, and half the width of its domain.
pub const SURFACES: [(&str, &str, f64); 3] = [
    ("sphere", "x^2+y^2+z^2-1", 1.2),
    ("mitchell", "4*(x^4+(y^2+z^2)^2)+17*x^2*(y^2+z^2)-20*(x^2+y^2+z^2)+17", 2.0),
    (
        "barth-sextic",
        "4*(phi^2*x^2-y^2)*(phi^2*y^2-z^2)*(phi^2*z^2-x^2)-(1+2*phi)*(x^2+y^2+z^2-1)^2",
        2.0,
    ),
];

/// Times both closures in turn, in `rounds` rounds.
pub fn compare(rounds: usize, mut ours: impl FnMut(), mut theirs: impl FnMut()) -> Comparison {
    let time = |f: &mut dyn FnMut()| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    ours();
    theirs();
    let mut samples: Vec<[f64; 3]> = (0..rounds)
        .map(|round| {
            // Each closure goes first in half of the rounds.
            let (a, b) = if round % 2 == 0 {
                let a = time(&mut ours);
                (a, time(&mut theirs))
            } else {
                let b = time(&mut theirs);
                (time(&mut ours), b)
            };
            [a, b, a / b]
        })
        .collect();
    let mut quantile = |column: usize, share: f64| {
        samples.sort_by(|a, b| a[column].total_cmp(&b[column]));
        samples[((rounds - 1) as f64 * share) as usize][column]
    };
    Comparison {
        ours: quantile(0, 0.5),
        theirs: quantile(1, 0.5),
        ratio: quantile(2, 0.5),
        quartiles: [quantile(2, 0.25), quantile(2, 0.75)],
    }
}

/// Median seconds of two closures, and the median and quartiles of their ratio.
pub struct Comparison {
    pub ours: f64,
    pub theirs: f64,
    pub ratio: f64,
    pub quartiles: [f64; 2],
}
