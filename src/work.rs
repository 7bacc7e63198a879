//! Counting what kernels are asked to do.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicU64, Ordering};
use zeroset_eval::{
    BoxPacket, EnclosurePacket, GradientKernel, GradientPacket, IntervalKernel, LANES, PointKernel,
    PointPacket, Real, ValuePacket,
};

/// Calls of one kind of kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// How often it was called.
    pub calls: u64,
    /// How many of the lanes it computed were wanted.
    pub lanes: u64,
}

/// Calls of kernels by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Enclosures over boxes.
    pub interval: Count,
    /// Values at points.
    pub point: Count,
    /// Values and gradients at points.
    pub gradient: Count,
    /// Rays given up after [`zeroset_trace::STEPS`].
    pub given_up: u64,
}

impl Work {
    /// Adds what a traversal asked for.
    pub fn add_traversal(&mut self, done: &zeroset_trace::Work) {
        self.interval += Count { calls: done.interval_calls, lanes: done.interval_lanes };
        self.given_up += done.given_up;
    }
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Self) {
        self.calls += other.calls;
        self.lanes += other.lanes;
    }
}

/// A kernel whose calls are counted. Made for calls of many packets: the counters are shared by all threads.
pub(crate) struct Counted<'a, K> {
    kernel: &'a K,
    calls: AtomicU64,
    packets: AtomicU64,
}

impl<'a, K> Counted<'a, K> {
    pub(crate) fn new(kernel: &'a K) -> Self {
        Self { kernel, calls: AtomicU64::new(0), packets: AtomicU64::new(0) }
    }

    pub(crate) fn count(&self) -> Count {
        let lanes = LANES as u64 * self.packets.load(Ordering::Relaxed);
        Count { calls: self.calls.load(Ordering::Relaxed), lanes }
    }

    fn called(&self, packets: usize) {
        self.calls.fetch_add(1, Ordering::Relaxed);
        self.packets.fetch_add(packets as u64, Ordering::Relaxed);
    }
}

impl<T: Real, K: IntervalKernel<T>> IntervalKernel<T> for Counted<'_, K> {
    fn enclose(&self, boxes: &[BoxPacket<T>], out: &mut [EnclosurePacket<T>]) {
        self.called(boxes.len());
        self.kernel.enclose(boxes, out);
    }
}

impl<T: Real, K: PointKernel<T>> PointKernel<T> for Counted<'_, K> {
    fn sample(&self, points: &[PointPacket<T>], out: &mut [ValuePacket<T>]) {
        self.called(points.len());
        self.kernel.sample(points, out);
    }
}

impl<T: Real, K: GradientKernel<T>> GradientKernel<T> for Counted<'_, K> {
    fn gradient(&self, points: &[PointPacket<T>], out: &mut [GradientPacket<T>]) {
        self.called(points.len());
        self.kernel.gradient(points, out);
    }
}
