//! Rays of ordinary and extreme cameras, compared with real geometry in exact arithmetic.

use super::*;
use fearless_simd::Level;
use num_bigint::BigInt;
use num_rational::BigRational;
use zeroset_eval::dispatch;
use zeroset_space::CameraError;
use zeroset_testkit::Adversarial;

type Exact = [BigRational; 3];

/// Number of binary places to which irrational numbers, such as lengths and tangents, are computed.
const BITS: usize = 400;

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("finite")
}

fn vector(v: DVec3) -> Exact {
    v.to_array().map(exact)
}

fn dot(a: &Exact, b: &Exact) -> BigRational {
    (0..3).map(|k| &a[k] * &b[k]).sum()
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn sum(a: &Exact, b: &Exact, factor: &BigRational) -> Exact {
    std::array::from_fn(|k| &a[k] + &b[k] * factor)
}

/// Rounds a number toward zero to [`BITS`] binary places.
fn rounded(value: &BigRational) -> BigRational {
    let one = BigInt::from(1) << BITS;
    BigRational::new((value * BigRational::from(one.clone())).to_integer(), one)
}

/// Scales a vector to length 1, up to an error of a few 2^−`BITS`.
fn unit(v: &Exact) -> Exact {
    // First the largest component becomes 1, so that short vectors keep their digits.
    let largest = v.iter().max_by_key(|c| (*c).max(&-*c).clone()).expect("three").clone();
    let v = v.clone().map(|c| c / &largest);
    let square = dot(&v, &v) * BigRational::from(BigInt::from(1) << (2 * BITS));
    let length = BigRational::new(square.to_integer().sqrt(), BigInt::from(1) << BITS);
    let sign = BigRational::from(BigInt::from(if largest < exact(0.0) { -1 } else { 1 }));
    v.map(|c| rounded(&(c * &sign / &length)))
}

/// The square of the sine of the angle between two vectors.
fn sine_squared(a: &Exact, b: &Exact) -> BigRational {
    let crossed = cross(a, b);
    dot(&crossed, &crossed) / (dot(a, a) * dot(b, b))
}

/// The tangent of half an angle in degrees, from the series of sine and cosine.
fn tangent(degrees: f64) -> BigRational {
    let digits =
        "314159265358979323846264338327950288419716939937510582097494459230781640628620899";
    let pi = BigRational::new(digits.parse().expect("digits"), BigInt::from(10).pow(80));
    let x = exact(degrees) * pi / exact(360.0);
    let mut term = exact(1.0);
    let mut series = [exact(0.0), exact(0.0)];
    for n in 0..120 {
        let sign = exact(if n % 4 < 2 { 1.0 } else { -1.0 });
        series[n % 2] += &term * sign;
        term = rounded(&(term * &x / exact((n + 1) as f64)));
    }
    let [cosine, sine] = series;
    sine / cosine
}

/// The exact axes of a camera's picture: forward, right and up.
fn ideal(eye: DVec3, target: DVec3, up: DVec3) -> [Exact; 3] {
    let way = sum(&vector(target), &vector(eye), &exact(-1.0));
    let right = cross(&way, &vector(up));
    let upward = cross(&right, &way);
    [unit(&way), unit(&right), unit(&upward)]
}

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

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }

    fn scale(&mut self, least: i32, most: i32) -> f64 {
        10_f64.powi(least + (self.next() % (most - least + 1) as u64) as i32)
    }

    /// A random eye, target and up vector, of any magnitude. The target may be next to the eye, and
    /// `up` may be along the view.
    fn view(&mut self) -> [DVec3; 3] {
        let eye = match self.next() % 4 {
            0 => DVec3::ZERO,
            1 => DVec3::AXES[(self.next() % 3) as usize] * self.scale(-99, 99),
            _ => self.vector() * self.scale(-99, 99),
        };
        let target = match self.next() % 4 {
            0 => DVec3::ZERO,
            1 => eye + self.vector() * self.scale(-307, -99),
            2 => eye + eye * self.vector() * self.scale(-16, 0),
            _ => self.vector() * self.scale(-5, 5),
        };
        let along = (target - eye) / (target - eye).abs().max_element().max(f64::MIN_POSITIVE);
        let up = match self.next() % 4 {
            0 => DVec3::AXES[(self.next() % 3) as usize],
            1 => self.vector() * self.scale(-300, 99),
            _ => along + self.vector() * self.scale(-9, 0),
        };
        [eye, target, up]
    }
}

const FOV_40: Projection = Projection::Perspective { fov: 40.0 };

fn camera(projection: Projection) -> Camera {
    Camera::new(DVec3::new(4.0, 3.0, 6.0), DVec3::ZERO, DVec3::Y, projection).expect("valid")
}

#[test]
fn rays_follow_the_stated_formula() {
    // The formula in scalar arithmetic, for one pixel off the axes of symmetry.
    let (i, j, width, height) = (5.0, 11.0, 64.0, 48.0);
    let norm = |v: [f64; 3]| {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| c / length)
    };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let forward = norm([-4.0, -3.0, -6.0]);
    let right = norm(cross(forward, [0.0, 1.0, 0.0]));
    let up = cross(right, forward);
    let s = (20.0_f64).to_radians().tan();
    let a = (2.0 * (i + 0.5) / width - 1.0) * s * (width / height);
    let b = (1.0 - 2.0 * (j + 0.5) / height) * s;
    let expected = norm([0, 1, 2].map(|k| forward[k] + a * right[k] + b * up[k]));
    let ray = RayGrid::new(&camera(FOV_40), 64, 48).ray(5, 11);
    assert!((ray.direction.normalize() - DVec3::from(expected)).length() < 1e-15);
    assert_eq!(ray.origin, DVec3::new(4.0, 3.0, 6.0));
}

#[test]
fn row_0_is_on_top_and_column_0_on_the_left() {
    let camera =
        Camera::new(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, FOV_40).expect("valid");
    let corner = RayGrid::new(&camera, 8, 8).ray(0, 0).direction;
    assert!(corner.x < 0.0 && corner.z > 0.0 && corner.y > 0.0);
}

#[test]
fn orthographic_rays_are_parallel_and_span_the_height() {
    let camera = camera(Projection::Orthographic { height: 3.0 });
    let rays = RayGrid::new(&camera, 4, 6);
    let (top, bottom) = (rays.ray(2, 0), rays.ray(2, 5));
    assert_eq!(top.direction, bottom.direction);
    // Six rows have a height of half a unit each, so the outer rows' centers are 2.5 apart.
    assert!(((top.origin - bottom.origin).length() - 2.5).abs() < 1e-14);
}

#[test]
fn axes_are_those_of_real_geometry() {
    let mut random = Random(0x5eed_7003);
    println!("seed {:#x}", random.0);
    let largest = exact(2_f64.powi(-51)).pow(2);
    let (mut checked, mut along) = (0, 0);
    for _ in 0..500 {
        let [eye, target, up] = random.view();
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = match Camera::new(eye, target, up, projection) {
            Ok(camera) => camera,
            Err(CameraError::EyeIsTarget) => {
                assert_eq!(eye, target);
                continue;
            }
            Err(CameraError::UpAlongView) => {
                // Only a camera whose `up` is almost along the view may be refused.
                let way = sum(&vector(target), &vector(eye), &exact(-1.0));
                assert!(sine_squared(&way, &vector(up)) < exact(1.001e-18));
                along += 1;
                continue;
            }
            Err(error) => panic!("{eye} to {target}, up {up}: {error}"),
        };
        let Basis { forward, right, up: upward } = camera.basis();
        let stored = [forward, right, upward];
        for (stored, ideal) in stored.iter().zip(ideal(eye, target, up)) {
            let error = sine_squared(&vector(*stored), &ideal);
            let same_way = dot(&vector(*stored), &ideal) > exact(0.0);
            assert!(same_way && error < largest, "{eye:?} to {target:?}, up {up:?}: {stored:?}");
            assert!((stored.length() - 1.0).abs() < 1e-15);
        }
        checked += 1;
    }
    println!("{checked} checked, {along} refused");
    assert!(checked > 300 && along > 10);
}

#[test]
fn perspective_rays_are_within_the_stated_angle() {
    let mut random = Random(0x5eed_7004);
    println!("seed {:#x}", random.0);
    let largest = exact(2_f64.powi(-49)).pow(2);
    for fov in [1e-7, 1e-3, 40.0, 90.0, 91.0, 179.0, 179.999_999, 180.0 - 2_f64.powi(-44)] {
        let tangent = tangent(fov);
        let mut checked = 0;
        while checked < 8 {
            let [eye, target, up] = random.view();
            let projection = Projection::Perspective { fov };
            let Ok(camera) = Camera::new(eye, target, up, projection) else { continue };
            let [forward, right, up] = ideal(eye, target, up);
            let (width, height) = [(512, 512), (65, 64), (8000, 1), (1, 8000)][checked % 4];
            let (i, j) = (random.next() as usize % width, random.next() as usize % height);
            let ray = RayGrid::new(&camera, width, height).ray(i, j);
            let integer = |n: usize| exact(n as f64);
            let share = |n: usize, of: usize| (exact(2.0) * integer(n) + exact(1.0)) / integer(of);
            let across = (share(i, width) - exact(1.0)) * integer(width) / integer(height);
            let upward = exact(1.0) - share(j, height);
            let direction = sum(&forward, &right, &(across * &tangent));
            let direction = sum(&direction, &up, &(upward * &tangent));
            assert_eq!(ray.origin, eye);
            let error = sine_squared(&vector(ray.direction), &direction);
            let same_way = dot(&vector(ray.direction), &direction) > exact(0.0);
            assert!(same_way && error < largest, "{camera:?}, {fov}°, {i},{j} of {width}×{height}");
            checked += 1;
        }
    }
}

#[test]
fn parallel_rays_are_within_the_stated_share_of_the_height() {
    let mut random = Random(0x5eed_7005);
    println!("seed {:#x}", random.0);
    let (mut checked, mut refused) = (0, 0);
    while checked < 200 {
        let [eye, target, up] = random.view();
        let height = (target - eye).length() * random.scale(-11, 3);
        let projection = Projection::Orthographic { height };
        let camera = match Camera::new(eye, target, up, projection) {
            Ok(camera) => camera,
            Err(error) => {
                refused += u32::from(matches!(error, CameraError::RaysCoincide { .. }));
                continue;
            }
        };
        let [forward, right, up] = ideal(eye, target, up);
        let (i, j) = (random.next() as usize % 64, random.next() as usize % 64);
        let ray = RayGrid::new(&camera, 64, 64).ray(i, j);
        let share = |n: usize| exact((2 * n + 1) as f64 / 128.0 - 0.5) * exact(height);
        let origin = sum(&vector(eye), &right, &share(i));
        let origin = sum(&origin, &up, &-share(j));
        for t in [0.0, (target - eye).length()] {
            let point = sum(&vector(ray.origin), &vector(ray.direction), &exact(t));
            let aside = cross(&sum(&point, &origin, &exact(-1.0)), &forward);
            let largest = (exact(height) * exact(2_f64.powi(-20))).pow(2);
            assert!(dot(&aside, &aside) < largest, "{camera:?}, {i},{j} at {t}");
        }
        checked += 1;
    }
    println!("{checked} checked, {refused} refused");
    assert!(refused > 20);
}

fn points(rays: &RayGrid, window: PixelWindow, distances: &[f64; LANES]) -> [Lanes<f64>; 3] {
    dispatch!(Level::new(), simd => rays.points(simd, window, distances))
}

fn ways_to_eye(rays: &RayGrid, window: PixelWindow) -> [[f32; LANES]; 3] {
    dispatch!(Level::new(), simd => rays.ways(simd, window).to_eye.map(|axis| axis.to_array()))
}

fn points_along(rays: &RayGrid, window: PixelWindow, distances: &[f64; LANES]) -> [Lanes<f32>; 3] {
    dispatch!(Level::new(), simd => {
        let ways = rays.ways(simd, window);
        rays.points_along(simd, &ways, distances)
    })
}

#[test]
fn windows_have_the_rays_of_their_pixels() {
    let perspective = Projection::Perspective { fov: 100.0 };
    for projection in [perspective, Projection::Orthographic { height: 3.0 }] {
        let (eye, target) = (DVec3::new(2.0, -3.0, 1.5), DVec3::new(0.1, 0.2, 0.3));
        let rays =
            RayGrid::new(&Camera::new(eye, target, DVec3::Z, projection).expect("valid"), 37, 5);
        for (column, row) in [(0, 0), (21, 2), (7, 4)] {
            let window = PixelWindow { column, row, index: 0, wanted: 1 };
            let distances = std::array::from_fn(|lane| 1.0 + 0.3 * lane as f64);
            let (points, to_eye) = (points(&rays, window, &distances), ways_to_eye(&rays, window));
            for lane in 0..LANES {
                let ray = rays.ray(column + lane, row);
                let point = ray.at(ray.parameter(distances[lane]));
                assert_eq!([0, 1, 2].map(|axis| points[axis][lane]), point.to_array());
                let way = DVec3::from_array([0, 1, 2].map(|axis| f64::from(to_eye[axis][lane])));
                assert!((way + ray.direction.normalize()).length() < 1e-6, "{way}");
            }
        }
    }
}

#[test]
fn points_in_f32_are_near_however_far_the_eye_is() {
    let target = DVec3::new(0.1, 0.2, 0.3);
    let way = DVec3::new(2.0, -3.0, 1.5).normalize();
    // At the target, every picture is two units high.
    let of_angle = |fov: f64| {
        let distance = 1.0 / (fov.to_radians() / 2.0).tan();
        (distance, Projection::Perspective { fov })
    };
    let parallel = Projection::Orthographic { height: 2.0 };
    let views = [1e-5, 0.01, 1.0, 40.0, 120.0, 170.0].map(of_angle);
    for (distance, projection) in views.into_iter().chain([(3.0, parallel), (1e6, parallel)]) {
        let camera = Camera::new(target + distance * way, target, DVec3::Z, projection);
        let rays = RayGrid::new(&camera.expect("valid"), 64, 48);
        for (column, row) in [(0, 0), (21, 20), (48, 47)] {
            let window = PixelWindow { column, row, index: 0, wanted: 1 };
            let distances = std::array::from_fn(|lane| {
                let ray = rays.ray(column + lane, row);
                // The distances are near that of the ray's point that is nearest to the target.
                let t = (target - ray.origin).dot(ray.direction) / ray.direction.length_squared();
                ray.distance(t) - 0.5 + 0.06 * lane as f64
            });
            let exact = points(&rays, window, &distances);
            let points = points_along(&rays, window, &distances);
            for lane in 0..LANES {
                for axis in 0..3 {
                    let off = f64::from(points[axis][lane]) - exact[axis][lane];
                    let size = 1.0 + exact.map(|axis| axis[lane].abs()).iter().sum::<f64>();
                    assert!(
                        off.abs() < 3e-7 * size,
                        "{projection:?}, {window:?}: {off:e} of {size}"
                    );
                }
            }
        }
    }
}

#[test]
fn rays_of_a_part_are_those_of_the_picture() {
    for projection in
        [Projection::Perspective { fov: 50.0 }, Projection::Orthographic { height: 3.0 }]
    {
        let eye = DVec3::new(2.0, -5.0, 1.0);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("valid");
        let rays = RayGrid::new(&camera, 61, 40);
        let part = rays.part(7..40, 16..31);
        assert_eq!((part.width(), part.height(), part.reach), (33, 15, rays.reach));
        let whole: [usize; 2] = [7, 16];
        for (i, j) in [(0, 0), (32, 14), (5, 9)] {
            assert_eq!(part.ray(i, j), rays.ray(whole[0] + i, whole[1] + j));
            let doubled = [2 * whole[0] + 2 * i, 2 * whole[1] + 2 * j];
            assert_eq!(part.screen(2 * i, 2 * j), rays.screen(doubled[0], doubled[1]));
        }
        // The point in the middle of a divided pixel's four parts is that pixel's center.
        let finer = rays.finer(2);
        assert_eq!((finer.width(), finer.height()), (122, 80));
        assert_eq!(finer.screen(2 * 7 * 2 + 1, 2 * 16 * 2 + 1), rays.screen(2 * 7, 2 * 16));
        // The rays of a divided part are those of the divided picture.
        let (finer, parts) = (rays.finer(4), part.finer(4));
        assert_eq!((parts.width(), parts.height()), (132, 60));
        for (i, j) in [(0, 0), (131, 59), (17, 40)] {
            assert_eq!(parts.ray(i, j), finer.ray(28 + i, 64 + j));
        }
    }
}

#[test]
fn rays_of_patches_are_those_of_the_picture() {
    for projection in
        [Projection::Perspective { fov: 50.0 }, Projection::Orthographic { height: 3.0 }]
    {
        let camera = Camera::new(DVec3::new(3.0, -4.0, 2.0), DVec3::ZERO, DVec3::Z, projection);
        let rays = RayGrid::new(&camera.expect("valid"), 40, 24);
        let places = [[8, 4], [0, 0], [36, 20], [5, 3]];
        let patch =
            |[column, row]: [usize; 2]| Patch { column, row, between: [0.0, f64::INFINITY] };
        let patches = rays.patches(places.map(patch).into());
        assert_eq!((patches.width(), patches.height()), (16, 4));
        for (row, [column, top]) in places.into_iter().enumerate() {
            let own: Vec<Ray> = (0..16).map(|n| rays.ray(column + n % 4, top + n / 4)).collect();
            for (n, ray) in own.iter().enumerate() {
                assert_eq!((*ray, *ray), (patches.ray(n, row), patches.ray_of(16 * row + n)));
            }
            // The window begins at the first pixel of a patch, or at the sixth.
            for first in [0, 5] {
                let wanted = 0xffff >> first;
                let window = PixelWindow { column: first, row, index: 16 * row + first, wanted };
                let distances = [4.5; LANES];
                let points = points(&patches, window, &distances);
                let ways = ways_to_eye(&patches, window);
                for (lane, ray) in own[first..].iter().enumerate() {
                    let point = ray.at(ray.parameter(4.5));
                    assert_eq!([0, 1, 2].map(|axis| points[axis][lane]), point.to_array());
                    let way = glam::Vec3::from_array([0, 1, 2].map(|axis| ways[axis][lane]));
                    assert!(way.distance(-ray.direction.normalize().as_vec3()) < 1e-6);
                }
            }
        }
    }
}

#[test]
fn neighbours_are_in_the_picture_and_in_the_patch() {
    let projection = Projection::Orthographic { height: 3.0 };
    let camera = Camera::new(DVec3::NEG_Y, DVec3::ZERO, DVec3::Z, projection).expect("valid");
    let rays = RayGrid::new(&camera, 8, 6);
    assert_eq!(rays.beside(0), [None, Some(1), None, Some(8)]);
    assert_eq!(rays.beside(47), [Some(46), None, Some(39), None]);
    assert_eq!(rays.beside(20), [Some(19), Some(21), Some(12), Some(28)]);
    let patch = Patch { column: 0, row: 0, between: [0.0, f64::INFINITY] };
    let patches = rays.patches([patch; 3].into());
    assert_eq!(patches.beside(16), [None, Some(17), None, Some(20)]);
    assert_eq!(patches.beside(31), [Some(30), None, Some(27), None]);
    assert_eq!(patches.beside(21), [Some(20), Some(22), Some(17), Some(25)]);
}

#[test]
fn a_window_has_all_pixels_whose_rays_may_meet_the_box_and_few_others() {
    let mut rng = zeroset_testkit::Rng::with_seed(0x5eed_0b07);
    let (mut met, mut tight) = (0, 0);
    for case in 0..400 {
        let mut place =
            |size: f64| DVec3::from([(); 3].map(|()| size * (2.0 * f64::uniform(&mut rng) - 1.0)));
        let (eye, target, up, low) = (place(3.0), place(0.5), place(1.0), place(1.0));
        let high = low + place(0.3).abs() + 1e-6;
        let projection = match case % 3 {
            0 => Projection::Orthographic { height: 3.0 },
            1 => Projection::Perspective { fov: 100.0 },
            _ => Projection::Perspective { fov: 30.0 },
        };
        let rays =
            RayGrid::new(&Camera::new(eye, target, up, projection).expect("a camera"), 64, 48);
        // A part of a picture has its part of the window.
        let rays = if case % 2 == 0 { rays } else { rays.part(16..64, 16..48) };
        let region = zeroset_space::Region::new(low, high).expect("a box");
        let window = rays.window(low, high);
        let mut seen = Window { columns: rays.width()..0, rows: rays.height()..0 };
        for pixel in 0..rays.width() * rays.height() {
            let [column, row] = [pixel % rays.width(), pixel / rays.width()];
            let around = rays.rays_within(pixel);
            if around.iter().chain([&rays.ray_of(pixel)]).any(|ray| region.span(ray).is_some()) {
                assert!(window.contains(column, row), "case {case}: pixel {column}, {row}");
                met += 1;
                let add = |range: &mut Range<usize>, at: usize| {
                    *range = range.start.min(at)..range.end.max(at + 1);
                };
                add(&mut seen.columns, column);
                add(&mut seen.rows, row);
            }
        }
        let is_near = |own: &Range<usize>, seen: &Range<usize>| own.len() <= seen.len() + 6;
        tight += usize::from(
            is_near(&window.columns, &seen.columns) && is_near(&window.rows, &seen.rows),
        );
    }
    assert!(met > 3_000 && tight > 300, "{met} pixels, {tight} windows");
}
