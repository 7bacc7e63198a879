//! If kernels are compiled while a picture is traced, no thread may wait for itself.

use glam::DVec3;
use std::sync::mpsc;
use std::time::Duration;
use zeroset_eval::{
    ContractSegments, ContractTiles, Contractions, Enclose, Kernel, KernelError, KernelResult,
    Kernels, Planes, Real, Segments, SurfaceKernels, Tiles,
};
use zeroset_space::{Camera, Projection, Region};
use zeroset_trace::{Driver, GBuffer, Method, Precision, RayGrid, Status, TraceOptions};

/// A function without zeros, whose kernels take time to compile.
struct SlowKernels;

impl<T: Real> Kernel<ContractTiles, T> for SlowKernels {
    fn eval(&self, _: &Tiles<T>, out: &mut Planes<T>) {
        *out = Planes::default();
    }
}

impl<T: Real> Kernel<ContractSegments, T> for SlowKernels {
    fn eval(&self, _: &Segments<T>, out: &mut Contractions<T>) {
        *out = Contractions::default();
    }
}

impl<T: Real> Kernels<T> for SlowKernels {
    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }
    // Compiling takes time, in which threads that need the kernels wait for each other.
    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        std::thread::sleep(Duration::from_millis(30));
        Ok(self)
    }
    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        std::thread::sleep(Duration::from_millis(10));
        Ok(self)
    }
}

impl SurfaceKernels for SlowKernels {
    fn single(&self) -> &dyn Kernels<f32> {
        self
    }
    fn double(&self) -> &dyn Kernels<f64> {
        self
    }
}

#[test]
fn bands_do_not_wait_for_each_other() {
    const SIZE: usize = 512;
    let (done, finished) = mpsc::channel();
    // Eight threads, perhaps more than processors: one must wait while others have bands left.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(8).build().expect("threads");
    pool.spawn(move || {
        let region = Region::new(-DVec3::ONE, DVec3::ONE).expect("valid");
        let parallel = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::Z * -5.0, DVec3::ZERO, DVec3::Y, parallel);
        let rays = RayGrid::new(&camera.expect("valid"), SIZE, SIZE);
        // The tolerance is so small that all rays are followed in `f64`.
        let options =
            TraceOptions { precision: Precision::Auto, tolerance: 1e-6, ..TraceOptions::default() };
        for _ in 0..10 {
            let affine = Method::named("affine").expect("a row");
            let tracer = affine.prepare(&SlowKernels, &region, options).expect("kernels");
            let mut buffer = GBuffer::new(SIZE, SIZE, 0);
            Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
            assert!(buffer.status.iter().all(|status| *status == Status::Miss));
        }
        done.send(()).expect("somebody who waits");
    });
    finished.recv_timeout(Duration::from_mins(1)).expect("a thread waits for itself");
}
