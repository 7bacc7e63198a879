//! The tetrahedra in which a surface may lie, with bounds of the function and its gradient.

use crate::grid::{Corner, CornerMap, Tetrahedron};
use crate::space::Space;
use rayon::prelude::*;
use zeroset_eval::{Boxes, EncloseGradient, FindZeros, GradientEnclosures, Kernel, LANES, Zeros};
use zeroset_interval::Interval;

/// The kernels of a function that a mesh asks for.
#[derive(Clone, Copy)]
pub struct CellKernels<'a> {
    /// Tests whether boxes may hold a zero.
    pub zeros: &'a dyn Kernel<FindZeros, f64>,
    /// Bounds the function and its gradient.
    pub gradients: &'a dyn Kernel<EncloseGradient, f64>,
}

/// Bounds of a function's gradient over a box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The partial derivatives, at each point where they exist. `None` if the function is not
    /// proven Lipschitz continuous.
    pub gradient: Option<[Interval; 3]>,
}

/// The answer for a box.
#[derive(Clone, Copy, Debug)]
pub enum Answer {
    /// There is no zero in the box. The sign is −1 or 1 if it is the same in the whole box and
    /// proven, else 0.
    Empty(i8),
    /// There may be a zero.
    Open(Bounds),
}

/// Answers for the bounding boxes of tetrahedra, in order.
pub fn ask(kernels: CellKernels<'_>, space: &Space, cells: &[Tetrahedron]) -> Vec<Answer> {
    // Up to six tetrahedra have the same box.
    let mut numbers: CornerMap<(Corner, Corner), usize> = CornerMap::default();
    let mut boxes: Vec<[Interval; 3]> = Vec::new();
    let index: Vec<usize> = cells
        .iter()
        .map(|cell| {
            let bounds = cell.bounds();
            *numbers.entry(bounds.into()).or_insert_with(|| {
                boxes.push(space.between(bounds));
                boxes.len() - 1
            })
        })
        .collect();
    let answers: Vec<Vec<Answer>> =
        boxes.par_chunks(LANES).map(|some| ask_batch(kernels, some)).collect();
    index.into_iter().map(|number| answers[number / LANES][number % LANES]).collect()
}

fn ask_batch(kernels: CellKernels<'_>, boxes: &[[Interval; 3]]) -> Vec<Answer> {
    let batch = &Boxes::around(boxes)[0];
    let (mut zeros, mut bounds) = (Zeros::default(), GradientEnclosures::<f64>::default());
    kernels.zeros.eval(batch, &mut zeros);
    kernels.gradients.eval(batch, &mut bounds);
    let answer = |lane: usize| {
        let value = Interval { lo: -bounds.neg_lo[lane], hi: bounds.hi[lane] };
        let is_lipschitz = bounds.lipschitz >> lane & 1 == 1;
        if zeros.possible >> lane & 1 == 0 || is_lipschitz && (value.lo > 0.0 || value.hi < 0.0) {
            let sign = i8::from(value.lo > 0.0) - i8::from(value.hi < 0.0);
            return Answer::Empty(sign);
        }
        let slopes = || {
            [0, 1, 2].map(|axis| Interval {
                lo: -bounds.gradient_neg_lo[axis][lane],
                hi: bounds.gradient_hi[axis][lane],
            })
        };
        Answer::Open(Bounds { gradient: is_lipschitz.then(slopes) })
    };
    (0..boxes.len()).map(answer).collect()
}
