//! The method of Knoll, Hijazi, Hansen, Wald and Hagen (UUSCI-2007-002). The rays of a packet cross
//! slabs, which are halved down to a fixed depth. Intervals bound the function over boxes around
//! the rays.

use super::slabs::{Slab, SlabTest, Slabs};
use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Task, Tracer};
use crate::options;
use crate::packet::Packet;
use crate::scalar::Scalar;
use fearless_simd::Simd;
use zeroset_eval::{Boxes, FindZeros, Kernel, KernelError, Zeros};

pub(crate) const METHOD: Method = Method {
    name: "knoll",
    help: "packets of rays in slabs of the dominant axis (Knoll et al. 2007); proves misses only",
    proves: Proves::Misses,
    reads: &[options::PRECISION, options::DEPTH, options::TOLERANCE],
    prepare: [prepare::<f32>, prepare::<f64>],
};

pub(super) fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    let test = IntervalTest { kernel: T::kernels(task.surface).zeros()? };
    Ok(Box::new(Slabs::new(test, task)))
}

struct IntervalTest<'a, T: Scalar> {
    kernel: &'a dyn Kernel<FindZeros, T>,
}

impl<T: Scalar> SlabTest<T> for IntervalTest<'_, T> {
    type Buffers = Boxes<T>;

    #[inline(always)]
    fn eval<S: Simd>(
        &self,
        simd: S,
        packet: &Packet<T>,
        slab: &Slab<T>,
        boxes: &mut Boxes<T>,
        work: &mut KernelStats,
    ) -> Zeros {
        let Slab { planes, rays, .. } = *slab;
        work.interval.called(rays.count_ones());
        packet.boxes(simd, planes, rays, boxes);
        let mut zeros = Zeros::default();
        self.kernel.eval_clipped(boxes, &mut zeros);
        zeros
    }
}
