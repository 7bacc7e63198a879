//! Affine forms along rays (Knoll, Hijazi, Kensler, Schott, Hansen, Hagen: "Fast Ray Tracing of
//! Arbitrary Implicit Surfaces with Interval and Affine Arithmetic", Computer Graphics Forum 28,
//! 2009). A form has one symbol: a ray's position in a slab. A slab whose form does not reach 0 is
//! empty.
//!
//! The method only tests whether a form reaches 0. Slabs are halved, not narrowed as in `affine`.

use super::slabs::{Slab, SlabTest, Slabs};
use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Task, Tracer};
use crate::options;
use crate::packet::Packet;
use crate::scalar::Scalar;
use fearless_simd::Simd;
use zeroset_eval::{
    Boxes, ContractSegments, Contractions, FindZeros, Kernel, KernelError, Lanes, Segments, Zeros,
};

pub(crate) const METHOD: Method = Method {
    name: "raa",
    help: "affine forms along packets of rays, halved (Knoll et al. 2009); proves misses only",
    proves: Proves::Misses,
    reads: &[options::PRECISION, options::DEPTH, options::TOLERANCE],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    let kernels = T::kernels(task.surface);
    // Intervals decide whether the function is bounded in a slab. An unbounded form does not prove
    // that the function is unbounded.
    let bounded = if task.options.is_solid { None } else { kernels.zeros().ok() };
    let test = FormTest { kernel: kernels.segments()?, bounded };
    Ok(Box::new(Slabs::new(test, task)))
}

struct FormTest<'a, T: Scalar> {
    kernel: &'a dyn Kernel<ContractSegments, T>,
    bounded: Option<&'a dyn Kernel<FindZeros, T>>,
}

/// Batches that kernels read and write.
#[derive(Default)]
struct FormBuffers<T: Scalar> {
    segments: Segments<T>,
    out: Contractions<T>,
    boxes: Boxes<T>,
}

impl<T: Scalar> SlabTest<T> for FormTest<'_, T> {
    type Buffers = FormBuffers<T>;

    #[inline(always)]
    fn begin<S: Simd>(&self, simd: S, packet: &Packet<T>, batch: &mut FormBuffers<T>) {
        packet.lines(simd, &mut batch.segments);
    }

    #[inline(always)]
    fn eval<S: Simd>(
        &self,
        simd: S,
        packet: &Packet<T>,
        slab: &Slab<T>,
        batch: &mut FormBuffers<T>,
        work: &mut KernelStats,
    ) -> Zeros {
        let Slab { planes, rays, is_last } = *slab;
        work.segments.called(rays.count_ones());
        let segments = &mut batch.segments;
        (segments.near, segments.far) = (Lanes::splat(planes[0]), Lanes::splat(planes[1]));
        segments.count = u16::BITS - rays.leading_zeros();
        self.kernel.eval(&batch.segments, &mut batch.out);
        let mut result = Zeros { possible: batch.out.possible, ..Zeros::default() };
        if let Some(kernel) = self.bounded
            && is_last
            && result.possible & rays != 0
        {
            work.interval.called(rays.count_ones());
            packet.boxes(simd, planes, rays, &mut batch.boxes);
            let mut zeros = Zeros::default();
            kernel.eval_clipped(&batch.boxes, &mut zeros);
            result.unbounded = zeros.unbounded;
        }
        result
    }
}
