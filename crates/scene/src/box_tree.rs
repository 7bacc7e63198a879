//! Boxes within boxes, each with the steps of a function that matter in it. Points are evaluated by
//! the kernel of the smallest box around them.

use crate::shortened::{PartSelection, ShortKernels, WholeFloat, WholeFunction};
use std::sync::{Arc, OnceLock};
use zeroset_eval::{
    Boxes, Gradients, Kernel, KernelError, LANES, LaneSet, Points, SampleGradient, Selection,
};
use zeroset_interval::Interval;

/// A box is divided into this many parts along its longest axis, and in two along the others: one
/// for each lane of a batch.
const ALONG: usize = 4;

/// Gradients of a function over its domain.
pub(crate) struct BoxTree<T: WholeFloat>(TreeNode<T>);

/// A box, and the function in it.
struct TreeNode<T: WholeFloat> {
    bounds: [Interval; 3],
    kernels: ShortKernels<T>,
    /// The parts of the box, created when a point in it is first evaluated. Empty if they need
    /// nearly as many steps.
    parts: OnceLock<Vec<Self>>,
}

impl<T: WholeFloat> BoxTree<T> {
    /// Creates the tree of a function.
    ///
    /// # Errors
    /// If the function has no kernel for gradients.
    pub fn new(whole: &Arc<WholeFunction>) -> Result<Self, KernelError> {
        let domain = T::whole(whole).tape.assumptions().domain;
        let root = TreeNode::new(whole, whole.all(), domain);
        root.kernels.forward().map(|_| ())?;
        Ok(Self(root))
    }
}

impl<T: WholeFloat> TreeNode<T> {
    fn new(whole: &Arc<WholeFunction>, selection: &Arc<Selection>, bounds: [Interval; 3]) -> Self {
        let kernels = ShortKernels::new(whole, selection);
        Self { bounds, kernels, parts: OnceLock::new() }
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        self.bounds.iter().zip(point).all(|(bounds, at)| bounds.contains(at))
    }

    /// Returns the smallest box around a point of this box.
    fn around(&self, point: [f64; 3]) -> &Self {
        let mut node = self;
        while let Some(part) =
            node.parts.get_or_init(|| node.divided()).iter().find(|part| part.contains(point))
        {
            node = part;
        }
        node
    }

    /// Divides the box into a part for each lane. Parts that need nearly as many steps as the box
    /// are left out. An unbounded box cannot be divided evenly, so it has no parts.
    fn divided(&self) -> Vec<Self> {
        if self.bounds.iter().any(|range| !range.lo.is_finite() || !range.hi.is_finite()) {
            return Vec::new();
        }
        let longest = (0..3)
            .max_by(|&a, &b| self.bounds[a].width().total_cmp(&self.bounds[b].width()))
            .unwrap_or_default();
        let mut parts = vec![self.bounds];
        for axis in 0..3 {
            let count = if axis == longest { ALONG } else { 2 };
            let Interval { lo, hi } = self.bounds[axis];
            let end = |k: usize| match k {
                0 => lo,
                _ if k == count => hi,
                _ => T::nearest(lo + (hi - lo) * k as f64 / count as f64).into().clamp(lo, hi),
            };
            let split = |part: &[Interval; 3]| {
                let mut part = *part;
                (0..count)
                    .map(|k| {
                        part[axis] = Interval { lo: end(k), hi: end(k + 1) };
                        part
                    })
                    .collect::<Vec<_>>()
            };
            parts = parts.iter().flat_map(split).collect();
        }
        debug_assert!(parts.len() == LANES, "a part for each lane");
        let Some(selections) = self.kernels.in_boxes(&Boxes::around(&parts)[0], |_| LaneSet::MAX)
        else {
            return Vec::new();
        };
        let node = |(bounds, selection): ([Interval; 3], PartSelection)| match selection {
            PartSelection::Short(short) => Some(Self::new(self.kernels.whole(), &short, bounds)),
            PartSelection::Empty | PartSelection::Same => None,
        };
        parts.into_iter().zip(selections).filter_map(node).collect()
    }
}

impl<T: WholeFloat> Kernel<SampleGradient, T> for BoxTree<T> {
    fn eval(&self, points: &Points<T>, out: &mut Gradients<T>) {
        let mut rest: Vec<usize> = (0..points.count as usize).collect();
        let mut some = Gradients::default();
        let at = |lane: usize| points.at.each_ref().map(|axis| axis[lane].into());
        // Each round evaluates the first remaining point with the kernel of its box. The results of
        // the other points in that box are kept, too.
        while let Some(&first) = rest.first() {
            let point = at(first);
            if point.iter().any(|at| !at.is_finite()) {
                rest.remove(0);
                out.value[first] = T::nearest(f64::NAN);
                out.gradient.iter_mut().for_each(|axis| axis[first] = T::nearest(f64::NAN));
                continue;
            }
            let node = if self.0.contains(point) { self.0.around(point) } else { &self.0 };
            let root = || self.0.kernels.forward();
            let kernel = node.kernels.forward().or_else(|_| root()).expect("created with the tree");
            kernel.eval(points, &mut some);
            rest.retain(|&lane| {
                let is_other = lane != first && !node.contains(at(lane));
                if !is_other {
                    out.value[lane] = some.value[lane];
                    for axis in 0..3 {
                        out.gradient[axis][lane] = some.gradient[axis][lane];
                    }
                }
                is_other
            });
        }
    }
}
