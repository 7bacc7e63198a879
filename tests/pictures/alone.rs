//! A pixel's result does not depend on which other pixels are traced.

use glam::DVec3;
use zeroset_scene::program::Program;
use zeroset_scene::view::{DomainChoice, bounds, region};
use zeroset_shade::{Light, turn};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Driver, GBuffer, KernelStats, METHODS, Proves, RayGrid, Status, TraceOptions};

const SIZE: [usize; 2] = [96, 80];

#[test]
fn a_pixel_is_the_same_whichever_others_are_followed() {
    let affine = METHODS.iter().find(|method| method.name == "affine").expect("there is one");
    let mut compared = 0;
    // Some rays are traced one by one and not in tiles. In rational forms, these are rays that may
    // meet a pole. With a ball, these are rays at its edge. From the eye `near`, the pixels of some
    // rays in a tile are as narrow as the resolution of `f32`.
    let [inside, near, far] = [[1.02, 0.3, 0.4], [1.3, 0.3, 0.2], [2.4, 1.8, 3.6]];
    for (text, is_ball, eyes, tolerance) in [
        ("x^2+y^2+z^2=1", false, [inside, far], 0.02),
        ("1/x+y=z", false, [inside, far], 0.02),
        ("x*y*z=0.001", false, [inside, far], 0.02),
        ("x^2+y^2+z^2=1", true, [near, far], 0.005),
        ("z^3=0.2*y^2*x", true, [near, inside], 0.01),
    ] {
        let document = read(text, &Options::default()).expect(text);
        let domain = DomainChoice::Bounds([-1.2, 1.2, -1.2, 1.2, -1.2, 1.2]);
        let (mut region, _) = region(&document, domain, None).expect(text);
        if is_ball {
            region = region.with_ball();
        }
        let program = Program::new(&document, bounds(&region)).expect(text);
        for eye in eyes {
            let projection = Projection::Perspective { fov: 80.0 };
            let eye = DVec3::from_array(eye);
            let target = if eye.x == inside[0] { DVec3::new(0.2, -0.6, 0.0) } else { DVec3::ZERO };
            let camera = Camera::new(eye, target, DVec3::Y, projection).expect(text);
            let rays = RayGrid::new(&camera, SIZE[0], SIZE[1]);
            let options = TraceOptions { tolerance, ..TraceOptions::default() };
            let tracer = affine.prepare(program.surface(0), &region, options).expect(text);
            let advance = |_| true;
            let driver = Driver { rays: &rays, tracer: &*tracer, advance: &advance };
            let picture = |only: &[bool]| {
                let mut buffer = GBuffer::new(SIZE[0], SIZE[1], 0).with_brackets();
                driver.picture_where(only, &mut buffer);
                buffer
            };
            let whole = picture(&[]);
            // Every `step`-th pixel is traced: from half of a tile's pixels to few of them.
            for step in [2, 3, 7, 41] {
                let only: Vec<bool> = (0..SIZE[0] * SIZE[1]).map(|n| n % step == 0).collect();
                let part = picture(&only);
                for pixel in (0..only.len()).filter(|&pixel| only[pixel]) {
                    let of = |buffer: &GBuffer| {
                        let bracket = buffer.bracket[pixel].map(f64::to_bits);
                        (buffer.status[pixel], buffer.drawn[pixel], bracket)
                    };
                    assert_eq!(of(&whole), of(&part), "{text}, {eye}, pixel {pixel}, every {step}");
                    compared += usize::from(whole.status[pixel] != Status::Miss);
                }
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}

/// More columns than two to the power of eighteen: the places of their tiles must not mix.
#[test]
fn a_very_wide_picture_is_as_its_parts() {
    const WIDE: [usize; 2] = [(1 << 18) + 200, 4];
    let text = "y^2+z^2 = 0.2+0.1*sin(20*x)";
    let document = read(text, &Options::default()).expect(text);
    let domain = DomainChoice::Bounds([-1.2, 1.2, -1.2, 1.2, -1.2, 1.2]);
    let (region, _) = region(&document, domain, None).expect(text);
    let program = Program::new(&document, bounds(&region)).expect(text);
    let projection = Projection::Orthographic { height: 2.0 * WIDE[1] as f64 / WIDE[0] as f64 };
    // The rays pass the tube's outline, where they are followed one by one.
    let eye = DVec3::new(0.0, -5.0, 0.45);
    let camera = Camera::new(eye, eye + DVec3::Y, DVec3::Z, projection).expect(text);
    let rays = RayGrid::new(&camera, WIDE[0], WIDE[1]);
    for method in METHODS.iter().filter(|method| method.proves == Proves::HitsAndMisses) {
        let tracer = method.prepare(program.surface(0), &region, TraceOptions::default());
        let tracer = tracer.expect(text);
        let picture = |rays: &RayGrid| {
            let mut buffer = GBuffer::new(rays.width(), rays.height(), 0);
            Driver { rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
            buffer
        };
        let whole = picture(&rays);
        let counts = whole.counts();
        assert!(counts.hit > 100_000 && counts.miss > 100_000 && counts.undecided < 100);
        for first in [0, 1 << 17, (1 << 18) - 64, 1 << 18] {
            let columns = first..first + 128;
            let part = picture(&rays.part(columns.clone(), 0..WIDE[1]));
            let seen = whole.seen_in(&columns, &(0..WIDE[1]));
            assert_eq!(seen, (part.status, part.drawn), "{}, column {first}", method.name);
        }
    }
}

/// Two balls above a floor. If one blocks the light, no shadow ray is traced to the other.
#[test]
fn what_is_dark_already_is_followed_to_the_light_no_more() {
    let text = "x^2+y^2+(z-1)^2=0.3; x^2+y^2+(z-1.9)^2=0.2; z=-0.9";
    let document = read(text, &Options::default()).expect(text);
    let domain = DomainChoice::Bounds([-2.5, 2.5, -2.5, 2.5, -2.5, 2.5]);
    let (region, _) = region(&document, domain, None).expect(text);
    let program = Program::new(&document, bounds(&region)).expect(text);
    let projection = Projection::Perspective { fov: 50.0 };
    let eye = DVec3::new(4.0, -6.0, 4.0);
    let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect(text);
    let rays = RayGrid::new(&camera, SIZE[0], SIZE[1]);
    let lights = Light::Positional(DVec3::new(0.5, 0.5, 9.0)).widened(region.centre());
    for method in METHODS {
        let advance = |_| true;
        let tracers = [0, 1, 2].map(|surface| {
            method.prepare(program.surface(surface), &region, TraceOptions::default()).expect(text)
        });
        let drivers = tracers.each_ref().map(|tracer| Driver {
            rays: &rays,
            tracer: &**tracer,
            advance: &advance,
        });
        let mut seen = GBuffer::of_nothing(SIZE[0], SIZE[1]);
        for driver in &drivers {
            let mut layer = GBuffer::new(SIZE[0], SIZE[1], 0);
            driver.picture(&mut layer);
            seen.merge(&layer);
        }
        let shadows = |buffer: &mut GBuffer, surface: usize| -> KernelStats {
            drivers[surface].shadows(
                buffer,
                |pixel, point| lights[turn(pixel)].towards(point),
                0.02,
                &region,
            )
        };
        let alone = [0, 1].map(|surface| {
            let mut buffer = seen.clone();
            let work = shadows(&mut buffer, surface);
            (buffer.shadow, work)
        });
        let mut both = seen.clone();
        let first = shadows(&mut both, 0);
        let second = shadows(&mut both, 1);
        let [(one, work_of_one), (other, work_of_other)] = &alone;
        let either: Vec<u8> = one.iter().zip(other).map(|(one, other)| one | other).collect();
        assert!(both.shadow == either, "{}: other shadows", method.name);
        let dark = |shadow: &[u8]| shadow.iter().filter(|dark| **dark > 0).count();
        assert!(dark(one) > 100 && dark(&either) > dark(one), "{}: {}", method.name, dark(one));
        let lanes = |work: &KernelStats| {
            let KernelStats { interval, tiles, segments, point, gradient, given_up: _ } = work;
            [interval, tiles, segments, point, gradient]
                .map(|count| count.lanes)
                .iter()
                .sum::<u64>()
        };
        assert_eq!(lanes(&first), lanes(work_of_one));
        let (fewer, all) = (lanes(&second), lanes(work_of_other));
        assert!(fewer < all, "{}: {fewer} of {all}", method.name);
    }
}
