//! Rays that meet regions, and invalid regions.

use super::*;

fn cube() -> Region {
    Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("valid")
}

fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray { origin: origin.into(), direction: DVec3::from(direction).normalize() }
}

#[test]
fn a_ray_through_the_box_enters_and_leaves() {
    let along = ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let (near, far) = cube().span(&along).expect("meets");
    assert!(near < 2.0 && 2.0 - near < 1e-14 && far > 4.0 && far - 4.0 < 1e-14);
    let entry = cube().entry(&along).expect("from outside");
    assert!(entry.certain && entry.normal == DVec3::NEG_X);
    assert!(entry.t.0 < 2.0 && entry.t.1 > 2.0);
    assert_eq!(cube().span(&ray([-3.0, 0.0, 0.0], [-1.0, 0.0, 0.0])), None);
    assert_eq!(cube().span(&ray([-3.0, 1.5, 0.0], [1.0, 0.0, 0.0])), None);
}

#[test]
fn an_eye_inside_starts_at_0_and_enters_nowhere() {
    let inside = ray([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let (near, far) = cube().span(&inside).expect("meets");
    assert!(near == 0.0 && far >= 0.5);
    assert_eq!(cube().entry(&inside), None);
}

#[test]
fn a_ray_inside_a_face_is_kept() {
    assert!(cube().span(&ray([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0])).is_some());
    assert!(cube().span(&ray([-3.0, 1.0_f64.next_up(), 0.0], [1.0, 0.0, 0.0])).is_none());
}

#[test]
fn a_half_space_cuts_either_end() {
    let keep_left = HalfSpace { normal: DVec3::X * 2.0, offset: 0.5 };
    let region = cube().with_clip(keep_left).expect("valid");
    let (near, far) = region.span(&ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0])).expect("meets");
    assert!((near - 2.0).abs() < 1e-12 && far > 3.25 && far - 3.25 < 1e-12);
    let back = ray([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
    let (near, _) = region.span(&back).expect("meets");
    assert!(near <= 2.75 && near > 2.75 - 1e-12);
    assert_eq!(region.entry(&back).expect("from outside").normal, DVec3::X);
    // Two rays parallel to the plane, one on each side.
    assert!(region.span(&ray([0.0, -3.0, 0.0], [0.0, 1.0, 0.0])).is_some());
    assert!(region.span(&ray([0.5, -3.0, 0.0], [0.0, 1.0, 0.0])).is_none());
}

#[test]
fn no_point_inside_is_lost() {
    // Each ray passes through a known point of the region, which the ray's span must contain. All
    // numbers are small integers over powers of two, so o + t·d is exact.
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    println!("seed {state:#x}");
    let mut random = |range: i64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % (2 * range + 1) as u64) as i64 - range
    };
    for _ in 0..20_000 {
        let direction = DVec3::new(random(9) as f64, random(9) as f64, random(9) as f64);
        if direction == DVec3::ZERO {
            continue;
        }
        let point = DVec3::new(random(16) as f64, random(16) as f64, random(16) as f64) / 16.0;
        let t = random(64).unsigned_abs() as f64 / 8.0;
        let ray = Ray { origin: point - direction * t, direction };
        let normal = DVec3::new(random(3) as f64, random(3) as f64, 1.0);
        let clip = HalfSpace { normal, offset: normal.dot(point) };
        let region = cube().with_clip(clip).expect("valid");
        let (near, far) = region.span(&ray).unwrap_or_else(|| panic!("lost: {ray:?} at {t}"));
        assert!(near <= t && t <= far, "{ray:?} at {t}: {near} to {far}");
    }
}

#[test]
fn a_ball_cuts_corners() {
    let region = cube().with_ball();
    assert_eq!(region.ball(), Some(Ball { centre: DVec3::ZERO, radius: 1.0 }));
    let (near, far) = region.span(&ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0])).expect("meets");
    assert!((2.0 - near).abs() < 1e-13 && near <= 2.0 && (4.0..4.0 + 1e-13).contains(&far));
    // One ray crosses a corner of the cube outside the ball. The other misses the ball by 1e-12.
    assert_eq!(region.span(&ray([-3.0, 0.9, 0.9], [1.0, 0.0, 0.0])), None);
    assert_eq!(region.span(&ray([-3.0, 1.0 + 1e-12, 0.0], [1.0, 0.0, 0.0])), None);
    // A tangent has a span, but none of its points is proven to be in the ball.
    let tangent = ray([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    assert!(region.span(&tangent).is_some_and(|(near, far)| near <= 3.0 && far >= 3.0));
    let [first, last] = region.inner(&tangent);
    assert!(first > last);
    assert!(region.entry(&tangent).is_none_or(|entry| !entry.certain));
    let entry = region.entry(&ray([-3.0, 0.6, 0.0], [1.0, 0.0, 0.0])).expect("from outside");
    assert!(entry.certain && entry.normal.distance(DVec3::new(-0.8, 0.6, 0.0)) < 1e-12);
    assert!(entry.t.0 <= 2.2 && entry.t.1 >= 2.2 && entry.t.1 - entry.t.0 < 1e-13);
}

#[test]
fn what_overflows_is_not_cut_away() {
    let region = cube().with_ball();
    let far = Ray { origin: DVec3::X * -1e200, direction: DVec3::X };
    let (near, end) = region.span(&far).expect("meets the box");
    assert!(near <= 1e200 && end >= 1e200);
    assert!(region.ball().is_some_and(|ball| ball.chord(&far).is_some()));
    let [first, last] = region.inner(&far);
    assert!(first > last);
}

#[test]
fn boxes_in_a_ball_are_told() {
    let ball = cube().with_ball().ball().expect("one");
    let half = 1.0 / 3.0_f64.sqrt();
    assert!(ball.holds(DVec3::splat(-half + 1e-12), DVec3::splat(half - 1e-12)));
    assert!(!ball.holds(DVec3::splat(-half - 1e-12), DVec3::ZERO));
}

#[test]
fn impossible_regions_are_refused() {
    let low = DVec3::splat(-1.0);
    let bound = |x: f64| Region::new(low, DVec3::new(1.0, x, 1.0));
    assert!(matches!(bound(-1.0), Err(RegionError::Empty { axis: 'y', .. })));
    assert!(matches!(bound(f64::NAN), Err(RegionError::Bound { axis: 'y', .. })));
    assert!(matches!(bound(f64::INFINITY), Err(RegionError::Bound { axis: 'y', .. })));
    let plane = |normal: DVec3, offset| cube().with_clip(HalfSpace { normal, offset });
    assert_eq!(plane(DVec3::ZERO, 0.0), Err(RegionError::Plane));
    assert_eq!(plane(DVec3::X, f64::NAN), Err(RegionError::Plane));
}
