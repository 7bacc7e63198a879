//! Pictures by the reference evaluator equal pictures by native code bit for bit.

use glam::DVec3;
use zeroset_jit::vector_widths;
use zeroset_render::picture::Precision;
use zeroset_scene::gallery::examples;
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::Program;
use zeroset_scene::view::{DomainChoice, bounds, region};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Driver, GBuffer, METHODS, RayGrid, TraceOptions};

/// A picture of this size has tiles of both sizes, and incomplete tiles.
const SIZE: [usize; 2] = [22, 18];

#[test]
fn the_reference_evaluator_draws_the_same_pictures() {
    let (mut hits, mut kernels) = (0, 0);
    for (number, example) in examples().into_iter().enumerate() {
        let document = read(example.text, &Options::default()).expect(example.slug);
        let (region, _) = region(&document, DomainChoice::Document, None).expect(example.slug);
        let program = Program::new(&document, bounds(&region)).expect(example.slug);
        let half = (region.high() - region.low()) / 2.0;
        let eye = region.centre() + DVec3::new(2.0, 1.5, 3.0) * half;
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(eye, region.centre(), DVec3::Y, projection).expect(example.slug);
        let rays = RayGrid::new(&camera, SIZE[0], SIZE[1]);
        // The default method runs in all precisions. Each other method runs in one, which changes
        // from example to example.
        let precisions = [Precision::Auto, Precision::F32, Precision::F64];
        let runs = METHODS.iter().flat_map(|method| {
            let all = if method.name == "affine" { 0..3 } else { number % 3..number % 3 + 1 };
            precisions[all].iter().map(move |precision| (method, *precision))
        });
        for (method, precision) in runs {
            let options =
                TraceOptions { precision, depth: 7, tolerance: 0.1, ..TraceOptions::default() };
            let [native, software] = [Evaluator::Native, Evaluator::Reference].map(|evaluator| {
                let program = program.on(evaluator);
                let mut buffer = GBuffer::new(SIZE[0], SIZE[1], 0).with_brackets();
                let tracer =
                    method.prepare(program.surface(0), &region, options).expect(method.name);
                let advance = |_| true;
                let driver = Driver { rays: &rays, tracer: &*tracer, advance: &advance };
                let work = driver.picture(&mut buffer);
                for made in program.made().iter().filter(|made| made.bytes > 0) {
                    assert_eq!(
                        Some(made.vector_bytes),
                        vector_widths().next(),
                        "{}: {made}",
                        example.slug
                    );
                    kernels += 1;
                }
                (buffer, work)
            });
            hits += native.0.counts().hit;
            // A bracket whose ends are NaN is no bracket, and the bits of NaN may differ.
            let brackets = |buffer: &GBuffer| -> Vec<[u64; 2]> {
                buffer
                    .bracket
                    .iter()
                    .map(|ends| ends.map(|end| if end.is_nan() { 0 } else { end.to_bits() }))
                    .collect()
            };
            let what = (example.slug, method.name, precision);
            assert_eq!(native.0.status, software.0.status, "{what:?}");
            for pixel in 0..native.0.status.len() {
                let told = |buffer: &GBuffer| (buffer.reason(pixel), buffer.distance(pixel));
                assert_eq!(told(&native.0), told(&software.0), "{what:?}");
            }
            assert_eq!(native.0.drawn, software.0.drawn, "{what:?}");
            assert_eq!(brackets(&native.0), brackets(&software.0), "{what:?}");
            assert_eq!(native.1, software.1, "{what:?}");
        }
    }
    assert!(hits > 20_000, "{hits}");
    assert!(kernels > 1200, "{kernels}");
}
