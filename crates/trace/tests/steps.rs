//! A packet takes a bounded number of steps, whatever the depth, and what it does not reach is called undecided.

use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};
use zeroset_eval::{BoxPacket, EnclosurePacket, IntervalKernel, LANES};
use zeroset_interval::Facts;
use zeroset_trace::{Camera, GBuffer, Knoll, Projection, RayGrid, Region, STEPS, Status, Work};

/// A function of z that vanishes nowhere below `top`, as is seen only of slabs no thicker than `finest`; above, it is 0.
struct Stubborn {
    top: f32,
    finest: f32,
    calls: AtomicU64,
}

impl Stubborn {
    fn new(top: f32, finest: f32) -> Self {
        Self { top, finest, calls: AtomicU64::new(0) }
    }
}

impl IntervalKernel for Stubborn {
    fn enclose(&self, boxes: &[BoxPacket], out: &mut [EnclosurePacket]) {
        self.calls.fetch_add(1, Ordering::Relaxed);
        for (packet, out) in boxes.iter().zip(out) {
            for lane in 0..LANES {
                let (low, high) = (-packet.neg_lo[2][lane], packet.hi[2][lane]);
                let empty = high < self.top && high - low <= self.finest;
                out.neg_lo[lane] = if empty { -1.0 } else { 1.0 };
                out.hi[lane] = 1.0;
                out.facts[lane] = Facts::TOTAL.bits();
            }
        }
    }
}

const SIZE: usize = 4;
/// 2×2 packets.
const PACKETS: u64 = (SIZE * SIZE / 4) as u64;

/// Looks up along z.
fn frame() -> RayGrid {
    let parallel = Projection::Orthographic { height: 1.0 };
    let camera = Camera::new(DVec3::Z * -5.0, DVec3::ZERO, DVec3::Y, parallel);
    camera.expect("valid").rays(SIZE, SIZE)
}

fn trace(kernel: &Stubborn, depth: u32) -> (GBuffer, Work) {
    let region = Region::new(-DVec3::ONE, DVec3::ONE).expect("valid");
    let knoll = Knoll { depth, ..Knoll::default() };
    knoll.trace::<_, f32>(&frame(), &region, kernel, &|_| true)
}

#[test]
fn steps_are_bounded_whatever_the_depth() {
    for depth in [17, 20] {
        let kernel = Stubborn::new(2.0, 2.1e-5);
        let (buffer, work) = trace(&kernel, depth);
        assert!(work.interval_calls <= PACKETS * STEPS, "{depth}: {work:?}");
        assert_eq!(kernel.calls.into_inner(), work.interval_calls);
        assert_eq!(work.given_up, (SIZE * SIZE) as u64);
        for pixel in 0..SIZE * SIZE {
            assert_eq!(buffer.status[pixel], Status::Undecided);
            // So far the way is proven empty, and no farther.
            let distance = buffer.distance[pixel];
            assert!(!buffer.is_drawn(pixel) || buffer.drawn[pixel] == distance);
            assert!((4.0..6.0).contains(&distance) && distance > 4.1, "{distance}");
        }
    }
}

#[test]
fn a_way_that_is_proven_empty_within_the_steps_is_a_miss() {
    let kernel = Stubborn::new(2.0, 1.7e-4);
    let (buffer, work) = trace(&kernel, 20);
    assert_eq!(work.given_up, 0);
    assert!(work.interval_calls > PACKETS * STEPS / 4, "the test must need many: {work:?}");
    assert!(buffer.status.iter().all(|status| *status == Status::Miss));
}

#[test]
fn what_lies_in_front_is_found_as_before() {
    let kernel = Stubborn::new(-0.875, 2.1e-5);
    let (buffer, work) = trace(&kernel, 20);
    assert_eq!(work.given_up, 0);
    assert!((0..SIZE * SIZE).all(|pixel| (buffer.drawn[pixel] - 4.125).abs() < 1e-3));
}
