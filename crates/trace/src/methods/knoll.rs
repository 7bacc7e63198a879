//! The method of Knoll, Hijazi, Hansen, Wald and Hagen (UUSCI-2007-002): intervals over boxes around the rays of a packet, in
//! slabs that are halved down to a fixed depth.

use super::slabs::{Slab, SlabTest, Slabs};
use crate::method::{Method, MethodOption, Options, Proves, Tracer};
use crate::packet::Packet;
use crate::region::Region;
use crate::scalar::Scalar;
use crate::work::Work;
use fearless_simd::Simd;
use zeroset_eval::{Boxes, FindZeros, Kernel, KernelError, Surface, Zeros};

pub(crate) const METHOD: Method = Method {
    name: "knoll",
    help: "packets of rays in slabs of the dominant axis (Knoll et al. 2007); proves misses only",
    proves: Proves::Misses,
    reads: &[MethodOption::Precision, MethodOption::Depth, MethodOption::Tolerance],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<'a, T: Scalar>(
    surface: &'a dyn Surface,
    region: &'a Region,
    options: Options,
) -> Result<Box<dyn Tracer + 'a>, KernelError> {
    let test = Intervals { kernel: T::kernels(surface).zeros()? };
    Ok(Box::new(Slabs::new(test, surface, region, &options)))
}

struct Intervals<'a, T: Scalar> {
    kernel: &'a dyn Kernel<FindZeros, T>,
}

impl<T: Scalar> SlabTest<T> for Intervals<'_, T> {
    type Batch = Boxes<T>;

    #[inline(always)]
    fn ask<S: Simd>(
        &self,
        simd: S,
        packet: &Packet<T>,
        slab: &Slab<T>,
        boxes: &mut Boxes<T>,
        work: &mut Work,
    ) -> Zeros {
        let Slab { planes, rays, .. } = *slab;
        work.interval.called(rays.count_ones());
        packet.boxes(simd, planes, rays, boxes);
        let mut zeros = Zeros::default();
        self.kernel.ask(boxes, &mut zeros);
        zeros
    }
}
