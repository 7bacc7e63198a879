//! Tests of clipping and narrowing against exact points of exact rays. Pictures and tiles are
//! random. They have all sizes, and are seen from near and far.
//!
//! A long run: `ZEROSET_CASES=100000 cargo test --release -p zeroset-trace exact -- --nocapture`.

use crate::grid::RayGrid;
use crate::methods::affine::frame::RayFrame;
use crate::methods::affine::plane::PlaneLanes;
use crate::methods::affine::screens::outward;
use crate::packet::tests::{exact, inside};
use crate::scalar::Scalar;
use fearless_simd::Level;
use glam::DVec3;
use num_rational::BigRational;
use zeroset_eval::dispatch;
use zeroset_eval::{LANES, Lanes, Planes, Segments, Tiles};
use zeroset_space::{Camera, Projection, Ray, Region};
use zeroset_testkit::simd::levels;
use zeroset_testkit::{Adversarial, Effort, Ends, Rng};

/// Number of columns, and of rows, of a picture.
const SIDE: u32 = 48;

/// Checks a random case with vectors of one width. Returns how many checks of each kind the case
/// made, or a description of the failure.
type Property<const N: usize> = fn(&mut Rng, Level) -> Result<[u32; N], String>;

/// Checks random cases of a property, in `f32` or `f64`. Returns the sums of the properties'
/// counts, and the number of cases.
fn attack<const N: usize>(
    seed: u64,
    cases: u64,
    [single, double]: [Property<N>; 2],
) -> ([u64; N], u64) {
    let Effort { seed, cases } = Effort::from_environment(seed, cases);
    let (levels, mut all) = (levels(), [0; N]);
    for case in seed..seed + cases {
        let rng = &mut Rng::with_seed(case);
        let level = levels[rng.u32(0..levels.len() as u32) as usize];
        let property = if rng.bool() { single } else { double };
        let counts = property(rng, level).unwrap_or_else(|wrong| {
            panic!(
                "{wrong}\nZEROSET_SEED={case:#x} ZEROSET_CASES=1 cargo test --release -p zeroset-trace exact"
            )
        });
        for (all, count) in all.iter_mut().zip(counts) {
            *all += u64::from(count);
        }
    }
    println!("{all:?}");
    (all, cases)
}

/// A random number, uniform in [−1, 1].
fn signed(rng: &mut Rng) -> f64 {
    f64::uniform(rng) * 2.0 - 1.0
}

fn vector(rng: &mut Rng) -> DVec3 {
    DVec3::new(signed(rng), signed(rng), signed(rng))
}

/// A random power of two: mostly of moderate size, sometimes with an exponent of up to `extreme`.
fn size(rng: &mut Rng, extreme: i32) -> f64 {
    let most = if rng.u32(0..8) == 0 { extreme } else { 8 };
    2_f64.powi(rng.i32(-most..=most))
}

/// Returns `number` itself, or moved at random: by a few roundings, or by up to `size` / 8.
fn perturbed(number: f64, size: f64, rng: &mut Rng) -> f64 {
    match rng.u32(0..4) {
        0 => number,
        _ => number + signed(rng) * size * 2_f64.powi(-rng.i32(3..=54)),
    }
}

/// A random region, the rays of a picture and their frame. `None` if the random camera is invalid.
fn picture(rng: &mut Rng) -> Option<(Region, RayGrid, RayFrame)> {
    let size = size(rng, 55);
    let away = [0.0, 1.0, 1e4][rng.u32(0..3) as usize];
    let centre = vector(rng) * size * away;
    let half = vector(rng).abs() * size + DVec3::splat(0.01 * size);
    let mut region = Region::new(centre - half, centre + half).ok()?;
    if rng.u32(0..3) == 0 {
        region = region.with_ball();
    }
    let distance = size * 10_f64.powi(rng.i32(-2..=7));
    let mut way = vector(rng);
    if rng.u32(0..3) == 0 {
        // The view is along an axis, so that rays may be parallel to faces.
        let axis = rng.u32(0..3) as usize;
        way = DVec3::AXES[axis] * way[axis];
    }
    let mut eye = centre + distance * way;
    if rng.u32(0..6) == 0 {
        // The eye is in the region, or in one of its faces.
        eye = centre + half * vector(rng);
        let axis = rng.u32(0..3) as usize;
        if rng.bool() {
            eye[axis] = region.low()[axis];
        }
    }
    let target = if rng.bool() { centre } else { centre + half * vector(rng) };
    let wide = 2.0 * size / eye.distance(target);
    let projection = match rng.u32(0..3) {
        0 => Projection::Orthographic { height: size * 10_f64.powi(rng.i32(-2..=1)) },
        1 => Projection::Perspective { fov: wide.atan().to_degrees() },
        _ => Projection::Perspective { fov: 170.0 * f64::uniform(rng) },
    };
    let up = [DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, -1.0)][rng.u32(0..3) as usize];
    let camera = Camera::new(eye, target, up, projection).ok()?;
    let rays = RayGrid::new(&camera, SIDE as usize, SIDE as usize);
    let frame = RayFrame::new(&rays, &region);
    Some((region, rays, frame))
}

/// Random tiles of `side` × `side` pixels: their first pixels, centers and half extents.
struct SixteenTiles {
    side: usize,
    first: [[usize; 2]; LANES],
    centre: [Lanes<f64>; 2],
    half: [Lanes<f64>; 2],
}

impl SixteenTiles {
    fn random(rays: &RayGrid, side: u32, rng: &mut Rng) -> Self {
        let first = [(); LANES].map(|()| [(); 2].map(|()| rng.u32(0..=SIDE - side) as usize));
        let side = side as usize;
        let mut centre = [Lanes::splat(0.0); 2];
        for (lane, [column, row]) in first.into_iter().enumerate() {
            let middle = rays.screen(2 * column + side - 1, 2 * row + side - 1);
            [centre[0][lane], centre[1][lane]] = middle;
        }
        let half = [Lanes::splat((side - 1) as f64 * rays.unit); 2];
        Self { side, first, centre, half }
    }

    /// Returns the rays of the corners of the tile in a lane.
    fn corners(&self, rays: &RayGrid, lane: usize) -> [Ray; 4] {
        let ([column, row], last) = (self.first[lane], self.side - 1);
        [[0, 0], [last, 0], [0, last], [last, last]].map(|[i, j]| rays.ray(column + i, row + j))
    }
}

/// Returns the range of s in which a ray is in the region's box. `None` if it misses the box.
fn in_box(region: &Region, ray: &Ray, start: f64) -> Option<[BigRational; 2]> {
    let mut ends: Option<[BigRational; 2]> = None;
    for axis in 0..3 {
        let [o, d, low, high] =
            [ray.origin, ray.direction, region.low(), region.high()].map(|v| exact(v[axis]));
        if d == exact(0.0) {
            if o < low || high < o {
                return None;
            }
            continue;
        }
        let at = |face: BigRational| (face - &o) / &d - exact(start);
        let (a, b) = (at(low), at(high));
        let new = if a < b { [a, b] } else { [b, a] };
        ends = Some(match ends {
            None => new,
            Some([near, far]) => {
                let [first, last] = new;
                [near.max(first), far.min(last)]
            }
        });
    }
    ends.filter(|[near, far]| near <= far)
}

fn at(ray: &Ray, s: f64, start: f64) -> [BigRational; 3] {
    let t = exact(s) + exact(start);
    [0, 1, 2].map(|axis| exact(ray.origin[axis]) + &t * exact(ray.direction[axis]))
}

/// Returns whether `left` contains the intersection of `asked` and the range from `first` to
/// `last`. `None` if that intersection is empty.
fn keeps(asked: [f64; 2], left: [f64; 2], [first, last]: &[BigRational; 2]) -> Option<bool> {
    let (first, last) = (first.max(&exact(asked[0])).clone(), last.min(&exact(asked[1])).clone());
    (first <= last).then(|| exact(left[0]) <= first && last <= exact(left[1]))
}

/// Returns the approximate s at which a ray enters and leaves the region, within the frame's span.
fn about(region: &Region, ray: &Ray, frame: &RayFrame) -> [f64; 2] {
    let [mut near, mut far] = frame.span;
    for axis in 0..3 {
        let at = |face: f64| (face - ray.origin[axis]) / ray.direction[axis] - frame.start;
        let (a, b) = (at(region.low()[axis]), at(region.high()[axis]));
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    [near, far]
}

/// Returns segments to clip: all of the frame's span, or segments that end near the region's faces.
fn segments(
    tiles: &SixteenTiles,
    (region, rays, frame): &(Region, RayGrid, RayFrame),
    rng: &mut Rng,
) -> [Lanes<f64>; 2] {
    let mut asked = frame.span.map(Lanes::splat);
    if rng.u32(0..3) > 0 {
        let [nears, fars] = &mut asked;
        for (lane, (from, to)) in nears.iter_mut().zip(fars.iter_mut()).enumerate() {
            let corner = tiles.corners(rays, lane)[rng.u32(0..4) as usize];
            let [near, far] = about(region, &corner, frame)
                .map(|end| perturbed(end, frame.size(), rng).clamp(frame.span[0], frame.span[1]));
            (*from, *to) = (near, far.max(near));
        }
    }
    asked
}

/// Clips tiles and rays. Counts rays with a part left, segments that were shortened, tiles called
/// inside the region, and rays called between its faces.
fn clipped<T: Scalar>(rng: &mut Rng, level: Level) -> Result<[u32; 4], String> {
    let mut counts = [0; 4];
    let Some(picture) = picture(rng) else { return Ok(counts) };
    let side = [1, 4, 16][rng.u32(0..3) as usize];
    let tiles = SixteenTiles::random(&picture.1, side, rng);
    let asked = segments(&tiles, &picture, rng);
    let (region, rays, frame) = &picture;
    let (mut left, mut alone) = (asked, asked);
    let mut batch = Tiles::<T>::default();
    let (inside_bits, certain): (u16, [Lanes<T>; 2]) = dispatch!(level, simd => {
        for (axis, ends) in tiles.centre.iter().zip(&tiles.half).enumerate() {
            let ends = [f64::wide(simd, ends.0), f64::wide(simd, ends.1)];
            frame.place_tiles(axis, ends, &mut batch);
        }
        let screens = (&batch.centre, Some(&batch.half));
        frame.clip(simd, screens, region, &mut left);
        let certain =
            frame.clip_rays(simd, &tiles.centre, region, frame.size(), &mut alone);
        let ends = asked.each_ref().map(|ends| f64::wide(simd, ends));
        (frame.inside(simd, screens, region, ends), certain)
    });
    for lane in 0..LANES {
        let of = |ends: &[Lanes<f64>; 2]| ends.each_ref().map(|lanes| lanes[lane]);
        let (asked, left, alone) = (of(&asked), of(&left), of(&alone));
        counts[1] += u32::from(left != asked);
        for ray in tiles.corners(rays, lane) {
            let [first, last]: [f64; 2] = certain.each_ref().map(|ends| ends[lane].into());
            let wrong = |what: &str| {
                let s = (asked, left, alone, [first, last]);
                Err(format!("{what}: {s:?} of {ray:?} from {} in {region:?}", frame.start))
            };
            let ends = in_box(region, &ray, frame.start);
            if let Some(ends) = &ends {
                let ahead = [ends[0].clone().max(exact(-frame.start)), ends[1].clone()];
                let everywhere = [f64::MIN, f64::MAX];
                if keeps(everywhere, frame.span, &ahead) == Some(false) {
                    return wrong("the frame leaves out a part");
                }
                let kept = keeps(asked, left, &ahead);
                counts[0] += u32::from(kept.is_some());
                if kept == Some(false) {
                    return wrong("a tile is clipped too far");
                }
                if side == 1 && keeps(asked, alone, &ahead) == Some(false) {
                    return wrong("a ray is clipped too far");
                }
            }
            if inside_bits >> lane & 1 == 1 {
                counts[2] += 1;
                let is_ahead = asked[0] >= -frame.start;
                if !is_ahead || !asked.iter().all(|s| inside(region, &at(&ray, *s, frame.start))) {
                    return wrong("not inside");
                }
            }
            if side == 1 && first <= last {
                counts[3] += 1;
                let is_in = |s: f64| {
                    let s = exact(s);
                    ends.as_ref().is_some_and(|[near, far]| *near <= s && s <= *far)
                };
                if first < -frame.start || !(is_in(first) && is_in(last)) {
                    return wrong("not between the faces");
                }
            }
        }
    }
    Ok(counts)
}

#[test]
fn no_exact_point_of_the_region_is_clipped_away_and_none_outside_is_called_inside() {
    let ([kept, shorter, inside, certain], cases) =
        attack(0x5eed_0780, 600, [clipped::<f32>, clipped::<f64>]);
    assert!(kept > 8 * cases && shorter > cases, "{kept} {shorter}");
    assert!(inside > cases && certain > cases, "{inside} {certain}");
}

/// A random form on a segment of half length `half_way`: its value and slopes, and its error.
fn random_form<T: Scalar + Adversarial>(rng: &mut Rng, half_way: f64) -> ([f64; 4], f64) {
    let number = |x: f64| -> f64 { T::nearest(x).into() };
    let extreme = if T::UNIT > 1e-10 { 140 } else { 1000 };
    let mut scale = size(rng, extreme);
    if rng.u32(0..8) == 0 {
        // The form is so small that the change of t per unit of its value overflows.
        scale = half_way * 2_f64.powi(-extreme + rng.i32(-8..=16));
    }
    let depth = number(scale * signed(rng));
    let share = if rng.bool() { signed(rng) * 1.25 } else { f64::from(rng.i32(-1..=1)) };
    let small = |rng: &mut Rng, most: i32| match rng.u32(0..3) {
        0 => 0.0,
        // The function may be steeper across the tile than along its rays.
        _ => number(depth * signed(rng) * 2_f64.powi(rng.i32(-most..=2))),
    };
    let mut form = [number(depth * share), small(rng, 6), small(rng, 6), depth];
    let mut error = small(rng, 28).abs();
    if rng.u32(0..8) == 0 {
        let any: f64 = T::adversarial(rng, Ends::Infinite).into();
        match rng.u32(0..5) {
            4 => error = any.abs(),
            k => form[k as usize] = any,
        }
        // A form has infinite numbers only after an overflow. Then its error is not finite either.
        if form.iter().any(|number| !number.is_finite()) {
            error = if rng.bool() { f64::INFINITY } else { f64::NAN };
        }
    }
    (form, error)
}

/// Returns the exact range of s in which a form may be 0 on the ray at these symbols, if any.
fn zeros_of(
    form: [f64; 4],
    error: f64,
    symbols: &[BigRational; 2],
    [middle, half_way]: [f64; 2],
    asked: [f64; 2],
) -> Option<[BigRational; 2]> {
    let [value, across, upward, depth] = form.map(exact);
    let value = value + across * &symbols[0] + upward * &symbols[1];
    if depth == exact(0.0) {
        let is_zero = value <= exact(error) && value >= exact(-error);
        return is_zero.then(|| asked.map(exact));
    }
    let at = |level: f64| exact(middle) + exact(half_way) * (exact(level) - &value) / &depth;
    let (a, b) = (at(error), at(-error));
    Some(if a < b { [a, b] } else { [b, a] })
}

/// Narrows the segments of sixteen parts of a random tile, by the plane near which the tile's form
/// may be 0. Fails if a zero is dropped, or a hit is off the plane. Counts kept zeros, shortened
/// segments and hits.
fn narrowed<T: Scalar + Adversarial>(rng: &mut Rng, level: Level) -> Result<[u32; 3], String> {
    let number = |x: f64| -> f64 { T::nearest(x).into() };
    // The tile is rounded as when it is written to a batch.
    let reach = size(rng, 60);
    let mut tile = Tiles::<T> { count: 1, ..Tiles::default() };
    let mut out = Planes::<T>::default();
    let centre = [(); 2].map(|()| 0.8 * reach * signed(rng));
    let half = [(); 2].map(|()| 0.2 * reach * 2_f64.powi(-rng.i32(0..=24)));
    for axis in 0..2 {
        tile.centre[axis][0] = T::nearest(centre[axis]);
        tile.half[axis][0] = T::nearest(half[axis] + T::PATH_ERROR * reach);
    }
    // The segment is random, and the form may have zeros on it.
    let length = size(rng, 60);
    let near = number(length * signed(rng));
    let far: f64 = T::above(near + length * 2_f64.powi(-rng.i32(0..=20))).into();
    let middle = number(near.midpoint(far));
    let half_way: f64 = T::above((far - middle).max(middle - near)).into();
    let (form, error) = random_form::<T>(rng, half_way);
    let lane = |lanes: &mut Lanes<T>, number: f64| lanes[0] = T::nearest(number);
    lane(&mut out.value, form[0]);
    (0..3).for_each(|axis| lane(&mut out.slope[axis], form[axis + 1]));
    lane(&mut out.error, error);
    lane(&mut out.middle, middle);
    lane(&mut out.half, half_way);

    // The parts of the tile are smaller tiles, or rays.
    let are_rays = rng.bool();
    let [mut centres, mut halves] = [[Lanes::splat(0.0); 2]; 2];
    let [mut places, mut reaches] = [[Lanes::splat(T::default()); 2]; 2];
    for axis in 0..2 {
        for lane in 0..LANES {
            let part = if are_rays { 0.0 } else { 2_f64.powi(-rng.i32(0..=4)) };
            let aside = if rng.bool() { signed(rng) } else { f64::from(rng.i32(-1..=1)) };
            let at = centre[axis] + half[axis] * (1.0 - part) * aside;
            // The exact screen coordinates of rays need not be floats of `T`.
            centres[axis][lane] = if are_rays { at } else { number(at) };
            halves[axis][lane] = number(half[axis] * part);
            places[axis][lane] = T::nearest(at);
            reaches[axis][lane] = T::nearest(halves[axis][lane]);
        }
    }
    let rays = (&places, (!are_rays).then_some(&reaches));
    let mut left = [near, far].map(|end| Lanes::splat(T::nearest(end)));
    let [nears, fars] = &mut left;
    let aside = [0, 1].map(|axis| centre[axis].abs() + half[axis]);
    let mut plane_at = Lanes::splat(0.0);
    let (any, reach): (u16, f64) = dispatch!(level, simd => {
        let mut planes = PlaneLanes::default();
        planes.find(simd, &tile, &out, aside);
        let plane = planes.of(&tile, 0);
        f64::narrow(plane.at(centres.each_ref().map(|lanes| f64::wide(simd, lanes))), &mut plane_at);
        (plane.narrow(simd, rays, [&mut *nears, &mut *fars]), plane.reach.into())
    });

    let mut counts = [0; 3];
    for lane in 0..LANES {
        let (asked, left) = ([near, far], left.each_ref().map(|lanes| lanes[lane].into()));
        assert_eq!(any >> lane & 1 == 1, left[0] <= left[1]);
        counts[1] += u32::from(left != asked && left[0] <= left[1]);
        let wrong = |what: &str, at: &[BigRational; 2]| {
            Err(format!("{what}: {left:?} of {asked:?}, {form:?} ± {error:?} at {at:?}"))
        };
        if form.iter().any(|number| !number.is_finite()) || !error.is_finite() {
            if left != asked {
                return wrong("bounded by what is no number", &[exact(0.0), exact(0.0)]);
            }
            continue;
        }
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let symbols = [0, 1].map(|axis| {
                let way = exact(signs[axis]) * exact(halves[axis][lane]);
                let off = exact(centres[axis][lane]) + way - exact(tile.centre[axis][0].into());
                off / exact(tile.half[axis][0].into())
            });
            if symbols.iter().any(|symbol| *symbol > exact(1.0) || *symbol < exact(-1.0)) {
                continue;
            }
            let along = [middle, half_way];
            let Some(zeros) = zeros_of(form, error, &symbols, along, asked) else { continue };
            match keeps(asked, left, &zeros) {
                Some(true) => counts[0] += 1,
                Some(false) => return wrong("a zero is left out", &symbols),
                None => {}
            }
            // If the form proves a zero on each ray, a hit is written at the plane. So each zero
            // must be near the plane.
            let [value, across, upward, depth] = form.map(f64::abs);
            if are_rays && (value + across + upward + error) * (1.0 + 1e-9) < depth {
                counts[2] += 1;
                let near_plane = |zero: &BigRational| {
                    let off = zero - exact(plane_at[lane]);
                    exact(-reach) <= off && off <= exact(reach)
                };
                let is_finite = plane_at[lane].is_finite() && reach.is_finite();
                if !is_finite || !zeros.iter().all(near_plane) {
                    return wrong("a hit is off the plane", &symbols);
                }
            }
        }
    }
    Ok(counts)
}

#[test]
fn no_exact_zero_of_a_form_is_outside_of_what_its_plane_leaves() {
    let ([kept, shorter, hit], cases) =
        attack(0x5eed_0781, 2_000, [narrowed::<f32>, narrowed::<f64>]);
    assert!(kept > 8 * cases && shorter > 4 * cases && hit > cases, "{kept} {shorter} {hit}");
}

/// Places rays in a batch. Counts coordinates whose error is small compared with the region.
fn placed<T: Scalar>(rng: &mut Rng, level: Level) -> Result<[u32; 1], String> {
    /// Rounding error of a coordinate in kernels, in units times the sum of its terms' magnitudes.
    const ALONG: f64 = 3.0;
    let Some((region, rays, frame)) = picture(rng) else { return Ok([0]) };
    let pixels = [(); LANES].map(|()| [(); 2].map(|()| rng.u32(0..SIDE) as usize));
    let mut places = [Lanes::splat(T::default()); 2];
    for (lane, [column, row]) in pixels.into_iter().enumerate() {
        let screen = rays.screen(2 * column, 2 * row).map(T::nearest);
        [places[0][lane], places[1][lane]] = screen;
    }
    let mut batch = Segments { error: frame.segments_error(), ..Segments::<T>::default() };
    dispatch!(level, simd => frame.place(simd, &places, &mut batch));
    let mut count = 0;
    for (lane, [column, row]) in pixels.into_iter().enumerate() {
        let ray = rays.ray(column, row);
        for s in [frame.span[0], frame.span[1], frame.size() * signed(rng)] {
            let point = at(&ray, s, frame.start);
            for (axis, point) in point.iter().enumerate() {
                let [o, d, error]: [f64; 3] = [&batch.origin, &batch.direction, &batch.error]
                    .map(|lanes| lanes[axis][lane].into());
                if !error.is_finite() {
                    continue;
                }
                let off = exact(o) + exact(s) * exact(d) - point;
                let kernels = ALONG * T::UNIT * (o.abs() + s.abs() * d.abs());
                let room = exact(error) - exact(kernels);
                if off > room || off < -room {
                    return Err(format!("{o} + {s}·{d} ± {error} on axis {axis} of {ray:?}"));
                }
                let extent = region.high()[axis] - region.low()[axis];
                count += u32::from(error < 1e-5 * extent);
            }
        }
    }
    Ok([count])
}

#[test]
fn exact_rays_are_no_farther_from_those_of_a_batch_than_its_error() {
    let ([close], cases) = attack(0x5eed_0783, 1_000, [placed::<f32>, placed::<f64>]);
    assert!(close > 20 * cases, "{close}");
}

/// Rounds the remaining parts of segments to floats. Counts segments whose two ends both moved.
fn rounded<T: Scalar>(rng: &mut Rng, level: Level) -> Result<[u32; 1], String> {
    let number = |x: f64| -> f64 { T::nearest(x).into() };
    // Segments are far longer than subnormal numbers.
    let reach = size(rng, 60);
    let mut asked = [Lanes::splat(0.0); 2];
    let mut left = asked;
    for lane in 0..LANES {
        let [a, b] = [(); 2].map(|()| number(0.9 * reach * signed(rng)));
        let ends = [a.min(b), a.max(b)];
        for (k, end) in ends.into_iter().enumerate() {
            asked[k][lane] = end;
            left[k][lane] = match rng.u32(0..4) {
                0 => end,
                1 => perturbed(end, reach, rng).clamp(ends[0], ends[1]),
                2 => ends[0].max(0.0).min(ends[1]) * 2_f64.powi(-rng.i32(0..=1000)),
                _ => ends[0] + (ends[1] - ends[0]) * f64::uniform(rng),
            };
        }
    }
    let mut floats = [Lanes::<T>::splat(T::default()); 2];
    let [near, far] = &mut floats;
    let any = dispatch!(level, simd => {
        outward::<_, T>(simd, &asked, &left, reach, [&mut *near, &mut *far])
    });
    let mut count = 0;
    for lane in 0..LANES {
        let of = |ends: &[Lanes<f64>; 2]| ends.each_ref().map(|lanes| lanes[lane]);
        let (asked, left) = (of(&asked), of(&left));
        let [first, last]: [f64; 2] = floats.each_ref().map(|lanes| lanes[lane].into());
        let is_right = (any >> lane & 1 == 1) == (left[0] <= left[1])
            && first <= left[0]
            && left[1] <= last
            && (left[0] != asked[0] || first == asked[0])
            && (left[1] != asked[1] || last == asked[1]);
        if !is_right {
            return Err(format!("[{first}, {last}] for {left:?} of {asked:?} within {reach}"));
        }
        count += u32::from(first != asked[0] && last != asked[1]);
    }
    Ok([count])
}

#[test]
fn what_is_left_is_rounded_outward() {
    let ([shorter], cases) = attack(0x5eed_0782, 1_000, [rounded::<f32>, rounded::<f64>]);
    assert!(shorter > 4 * cases, "{shorter}");
}
