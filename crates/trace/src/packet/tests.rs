//! Compares boxes and ranges of τ with exact points of exact rays.

use super::*;
use crate::painted::ones;
use fearless_simd::Level;
use num_bigint::BigInt;
use num_rational::BigRational;
use zeroset_eval::dispatch;
use zeroset_space::{HalfSpace, Ray};
use zeroset_testkit::simd::levels;

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A random number, uniform in [−1, 1].
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, scale: f64) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * scale
    }

    /// A random power of ten from 10^−3 to 10^`most`.
    fn scale(&mut self, most: i32) -> f64 {
        10_f64.powi((self.next() % (most + 4) as u64) as i32 - 3)
    }
}

pub(crate) fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("finite")
}

/// A random region, and rays from near and very far that meet its box. A clipping plane or a ball
/// may cut the region.
fn scene(random: &mut Random) -> (Region, Vec<Segment>) {
    let size = random.scale(3);
    let away = size * random.scale(2);
    let centre = random.vector(away);
    let half = DVec3::new(random.unit(), random.unit(), random.unit()).abs() * size
        + DVec3::splat(size * 0.01);
    let mut region = Region::new(centre - half, centre + half).expect("a box");
    if random.next().is_multiple_of(3) {
        let normal = random.vector(1.0) + DVec3::splat(0.01);
        let offset = normal.dot(centre + half * random.unit() * 0.5);
        region = region.with_clip(HalfSpace { normal, offset }).expect("a plane");
    }
    if random.next().is_multiple_of(3) {
        region = region.with_ball();
    }
    let away = size * random.scale(7);
    let origin = centre + random.vector(away);
    let target = centre + half * random.vector(1.0);
    let spread = match random.next() % 3 {
        0 => 0.0,
        1 => 1e-3,
        _ => 0.3,
    };
    let count = [1, 4, 7, PACKET_RAYS][random.next() as usize % 4];
    let mut segment = || {
        let aim = target + half * random.vector(spread);
        let direction = (aim - origin) * random.scale(2);
        let to = if random.next().is_multiple_of(4) { 0.9 } else { f64::INFINITY };
        Segment { ray: Ray { origin, direction }, to, pixel: [0.0; 2] }
    };
    let segments = (0..count).map(|_| segment()).collect();
    (region, segments)
}

/// Returns whether a point is in the region, in exact arithmetic.
pub(crate) fn inside(region: &Region, point: &[BigRational; 3]) -> bool {
    let in_box = (0..3).all(|axis| {
        exact(region.low()[axis]) <= point[axis] && point[axis] <= exact(region.high()[axis])
    });
    let kept = region.clip().is_none_or(|half| {
        let dot: BigRational = (0..3).map(|axis| exact(half.normal[axis]) * &point[axis]).sum();
        dot <= exact(half.offset)
    });
    let in_ball = region.ball().is_none_or(|ball| {
        let square = |value: BigRational| &value * &value;
        let far: BigRational =
            (0..3).map(|axis| square(&point[axis] - exact(ball.centre[axis]))).sum();
        far <= square(exact(ball.radius))
    });
    in_box && kept && in_ball
}

#[test]
fn points_of_rays_lie_in_their_boxes_and_ranges() {
    points_lie_in_boxes::<f32>(0x5eed_7001);
    points_lie_in_boxes::<f64>(0x5eed_7002);
}

fn points_lie_in_boxes<T: Scalar>(seed: u64) {
    println!("seed {seed:#x}");
    let (mut random, levels) = (Random(seed), levels());
    let mut checked = 0_u32;
    let mut refused = 0_u32;
    for _ in 0..1_000 {
        let (region, segments) = scene(&mut random);
        let mut packet = Packet::<T>::new(&region);
        // A random width of vectors, so that each width is tested.
        let level = levels[random.next() as usize % levels.len()];
        if !dispatch!(level, simd => packet.take(simd, &segments, &RayLanes::new(&segments), &region))
        {
            refused += 1;
            continue;
        }
        let SlabAxis { k, start, extent, .. } = packet.planes;
        let any_inside = dispatch!(level, simd => packet.inside(simd));
        for _ in 0..6 {
            let depth = random.next() % u64::from(T::MAX_DEPTH - 4);
            let count = 1_u64 << (depth + 1);
            // A range of τ that is too short shows in the first or last slabs, so these are chosen
            // often.
            let index = match random.next() % 8 {
                0 => 0,
                1 => count - 2,
                _ => (random.next() % count) & !1,
            };
            let at = |i: u64| T::nearest(i as f64 / count as f64);
            let planes = [at(index), at(index + 1), at(index + 2)];
            for half in 0..2 {
                let (mut boxes, mut ways) = (Boxes::default(), Segments::<T>::default());
                let slab = [planes[half], planes[half + 1]];
                // Either some of the rays are wanted, or all.
                let some = packet.rays() & random.next() as u16 | 1;
                let asked = if random.next().is_multiple_of(2) { some } else { packet.rays() };
                let meets = dispatch!(level, simd => {
                    packet.boxes(simd, slab, asked, &mut boxes);
                    packet.lines(simd, &mut ways);
                    packet.meets(simd, slab[0], slab[1])
                });
                assert_eq!(boxes.count, 16 - asked.leading_zeros());
                // The share, a value of τ, is at an end of the slab or anywhere between.
                let share = match random.next() % 4 {
                    0 => exact(planes[half].into()),
                    1 => exact(planes[half + 1].into()),
                    _ => {
                        let part =
                            BigRational::new((random.next() % 1000).into(), BigInt::from(1000));
                        let width = exact(planes[half + 1].into() - planes[half].into());
                        exact(planes[half].into()) + part * width
                    }
                };
                for lane in ones(asked) {
                    let segment = &segments[lane];
                    // `extent` is end − start, rounded. Any plane between the exact end planes will
                    // do.
                    let plane = exact(start) + &share * exact(extent);
                    let t =
                        (&plane - exact(segment.ray.origin[k])) / exact(segment.ray.direction[k]);
                    let point: [BigRational; 3] = std::array::from_fn(|axis| {
                        exact(segment.ray.origin[axis]) + &t * exact(segment.ray.direction[axis])
                    });
                    let reached =
                        t >= exact(0.0) && (segment.to.is_infinite() || t <= exact(segment.to));
                    if !reached || !inside(&region, &point) {
                        continue;
                    }
                    checked += 1;
                    assert!(
                        meets >> lane & 1 == 1,
                        "out of range: {segment:?} {region:?} {planes:?}"
                    );
                    assert!(any_inside >> lane & 1 == 1, "{segment:?}");
                    for (axis, point) in point.iter().enumerate() {
                        let lo = exact(-boxes.neg_lo[axis][lane].into());
                        let hi = exact(boxes.hi[axis][lane].into());
                        assert!(
                            lo <= *point && *point <= hi,
                            "axis {axis} of {segment:?} in {region:?} at {planes:?}"
                        );
                        // The segment's point at τ must be near the exact point. Some of `error`
                        // must be left for the rounding in kernels.
                        let [o, d, error]: [f64; 3] = [&ways.origin, &ways.direction, &ways.error]
                            .map(|part| part[axis][lane].into());
                        let off = exact(o) + &share * exact(d) - point;
                        let room = exact(error) - exact(T::PATH_ERROR * (o.abs() + d.abs()));
                        assert!(
                            -&room <= off && off <= room,
                            "axis {axis} of {segment:?} in {region:?}"
                        );
                    }
                }
            }
        }
    }
    println!("{checked} points checked, {refused} packets refused");
    assert!(checked > 10_000, "{checked}");
}

#[test]
fn rays_that_do_not_advance_together_are_refused() {
    let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("a box");
    let ray = |direction: DVec3| Segment {
        ray: Ray { origin: DVec3::ZERO, direction },
        to: f64::INFINITY,
        pixel: [0.0; 2],
    };
    let packet = |other| {
        let rays = [ray(DVec3::X), ray(DVec3::X), ray(other)];
        let mut packet = Packet::<f32>::new(&region);
        dispatch!(Level::new(), simd => packet.take(simd, &rays, &RayLanes::new(&rays), &region))
    };
    assert!(packet(DVec3::new(1.0, 0.5, 0.0)));
    assert!(!packet(DVec3::NEG_X));
    assert!(!packet(DVec3::new(0.1, 1.0, 0.0)));
    assert!(!packet(DVec3::NAN));
}

/// Rays go exactly through the region's middle. They start at up to 2³³² times their directions'
/// lengths, where coordinates overflow in `f32`.
#[test]
fn rays_from_very_far_keep_the_point_that_they_meet() {
    from_very_far::<f32>(0x5eed_7006);
    from_very_far::<f64>(0x5eed_7007);
}

fn from_very_far<T: Scalar>(seed: u64) {
    println!("seed {seed:#x}");
    let mut random = Random(seed);
    let cube = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a box");
    for exponent in 0..333 {
        for offset in [None, Some(0.0), Some(0.5), Some(1e300)] {
            let direction = random.vector(1.0);
            let region = offset.map_or(cube, |offset| {
                cube.with_clip(HalfSpace { normal: random.vector(1.0), offset }).expect("a plane")
            });
            let origin = -direction * 2_f64.powi(exponent);
            let segment =
                Segment { ray: Ray { origin, direction }, to: f64::INFINITY, pixel: [0.0; 2] };
            let mut packet = Packet::<T>::new(&region);
            let taken = dispatch!(Level::new(), simd => packet.take(simd, &[segment; 3], &RayLanes::new(&[segment; 3]), &region));
            assert!(taken, "together");
            let half = T::halved(1);
            let (zero, one) = (T::integer(0), T::integer(1));
            let inside = dispatch!(Level::new(), simd => packet.inside(simd));
            assert_eq!(inside, 0b111, "{segment:?} in {region:?}");
            for (from, to) in [(zero, half), (half, one)] {
                let mut boxes = Boxes::default();
                let meets = dispatch!(Level::new(), simd => {
                    packet.boxes(simd, [from, to], packet.rays(), &mut boxes);
                    packet.meets(simd, from, to)
                });
                assert_eq!(meets, 0b111, "{segment:?} in {region:?}");
                let holds =
                    |axis: usize| boxes.neg_lo[axis][2] >= zero && boxes.hi[axis][2] >= zero;
                assert!((0..3).all(holds), "{segment:?} in {region:?}: {boxes:?}");
            }
        }
    }
}

#[test]
fn what_is_certainly_in_the_region_is() {
    let mut random = Random(0x5eed_7003);
    println!("seed 0x5eed7003");
    let mut checked = 0_u32;
    for _ in 0..4_000 {
        let (mut region, segments) = scene(&mut random);
        let ray = segments[0].ray;
        if random.next().is_multiple_of(2) {
            // The clipping plane is almost parallel to the ray.
            let across = ray.direction.cross(random.vector(1.0)).normalize();
            let normal =
                across + ray.direction.normalize() * random.unit() * random.scale(0) * 1e-13;
            let offset = normal.dot(ray.at(1.0));
            region = region.with_clip(HalfSpace { normal, offset }).expect("a plane");
        }
        let [near, far] = region.inner(&ray);
        if near > far {
            continue;
        }
        for t in [near, far].into_iter().filter(|t| t.is_finite()) {
            let point = std::array::from_fn(|axis| {
                exact(ray.origin[axis]) + exact(t) * exact(ray.direction[axis])
            });
            assert!(inside(&region, &point), "{t} of {ray:?} {region:?}");
            checked += 1;
        }
        let (first, last) = region.span(&ray).expect("it is within");
        assert!(first <= near && far <= last);
    }
    assert!(checked > 3_000, "{checked}");
}
