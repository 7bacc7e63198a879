//! End-to-end tests of `zeroset render`, `gallery` and `explain`.

use crate::cli_support::Sandbox;
use glam::DVec3;
use serde_json::Value;
use std::time::Instant;
use zeroset_trace::UndecidedReason;

const SPHERE: &str = "x^2+y^2+z^2 = 1";

/// A power-8 Mandelbulb of two iterations, in polar form.
pub const BULB: &str = "\
    r = sqrt(x^2+y^2+z^2); a = 8.1 acos(z/r); b = 8.1 atan2(y, x)\n\
    u = r^8 sin(a) cos(b) + x; v = r^8 sin(a) sin(b) + y; w = r^8 cos(a) + z\n\
    s = sqrt(u^2+v^2+w^2); c = 8.1 acos(w/s); d = 8.1 atan2(v, u)\n\
    (s^8 sin(c) cos(d) + x)^2 + (s^8 sin(c) sin(d) + y)^2 + (s^8 cos(c) + z)^2 = 4\n";

fn array<T: npyz::Deserialize>(place: &Sandbox, name: &str) -> (Vec<u64>, Vec<T>) {
    let bytes = std::fs::read(place.path(name)).expect("written");
    let array = npyz::NpyFile::new(&bytes[..]).expect("an array");
    (array.shape().to_vec(), array.into_vec().expect("of this type"))
}

#[test]
fn a_formula_becomes_a_picture() {
    let place = Sandbox::new();
    let run = place.run(&["render", SPHERE, "-o", "sphere.png", "--size", "64x48"]).ok();
    assert!(run.stdout.is_empty());
    assert_eq!(place.files(), ["sphere.png"]);
    let sphere = place.picture("sphere.png");
    assert_eq!(sphere.dimensions(), (64, 48));
    // The outside, f > 0, has a warm color. The corner shows the background.
    let [red, _, blue] = sphere.get_pixel(32, 24).0;
    assert!(red > blue + 50, "{:?}", sphere.get_pixel(32, 24));
    assert_eq!(sphere.get_pixel(0, 0).0, [244, 244, 246]);
}

/// Cameras near the limits of floats. Each camera is either rejected, or rays that certainly meet
/// the surface are no misses.
#[test]
fn no_extreme_camera_hides_what_its_rays_meet() {
    let place = Sandbox::new();
    let render = |formula: &str, camera: &str, method: &str| {
        let fixed = ["render", formula, "--domain", "2", "--status", "status.npy"];
        let method = ["--method", method];
        place.run(&[&fixed[..], &method, &camera.split(' ').collect::<Vec<_>>()].concat())
    };
    let status = |formula: &str, camera: &str, [column, row]: [usize; 2]| {
        let by = |method: &str| {
            render(formula, camera, method).ok();
            let (shape, status) = array::<u8>(&place, "status.npy");
            status[row * shape[1] as usize + column]
        };
        assert_ne!(by("affine"), 0, "{camera}");
        by("knoll")
    };
    // Along an axis even rays from very far are exact: 101 of 17² rays meet the ball.
    for eye in ["3e38", "4e38", "1e100"] {
        for precision in ["f32", "f64"] {
            let camera = format!(
                "--eye {eye},0,0 --target 0,0,0 --up 0,0,1 --ortho 3 --size 17 --precision {precision}"
            );
            assert_eq!(status(SPHERE, &camera, [8, 8]), 2, "{camera}");
            for method in ["affine", "knoll"] {
                render(SPHERE, &camera, method).ok();
                let (_, status) = array::<u8>(&place, "status.npy");
                let met = status.iter().filter(|&&status| status != 0).count();
                assert_eq!(met, 101, "{camera}, {method}");
            }
        }
    }
    // The middle ray passes through the origin exactly. The camera's numbers overflow in `f32`.
    for eye in ["1e60,1e60,1e60", "-9e99,9e99,-9e99"] {
        let camera = format!("--eye={eye} --target 0,0,0 --up 0,0,1 --fov 40 --size 17");
        assert_eq!(status(SPHERE, &camera, [8, 8]), 2, "{camera}");
        let parallel = camera.replace("--fov 40", "--ortho 3");
        let refused = render(SPHERE, &parallel, "affine");
        assert_eq!(refused.code, Some(2), "{parallel}");
        assert!(refused.stderr.contains("can tell the rays apart"), "{}", refused.stderr);
    }
    // The squares of the camera's numbers are subnormal.
    let ball = "(x-1)^2+(y-0.9)^2+(z-0.8)^2=0.01";
    let close = "--eye 0,0,0 --target 2.6e-162,1.4e-162,4e-163 --up 0,0,1 --fov 90 --size 65";
    assert_eq!(status(ball, close, [25, 16]), 2);
    // The product forward × up loses ten digits to cancellation.
    let speck = "(x+0.13391258274386464)^2+(y-0.77058820789075788)^2+(z-0.65331571406091693)^2\
                 -(2e-12)^2";
    let upright = "--eye 3,2,9 --target 0,0,0 --up 3.00007,1.99997,9.00011 --fov 20 --size 64 \
                   --precision f64 --max-depth 40";
    assert_eq!(status(speck, upright, [31, 46]), 2);
}

#[test]
fn arrays_hold_what_the_picture_shows() {
    let place = Sandbox::new();
    let arguments = [
        "render",
        SPHERE,
        "--size",
        "20x10",
        "--domain",
        "2",
        "--eye",
        "0,0,5",
        "--up",
        "0,1,0",
        "--tolerance",
        "0.01",
        "--distance",
        "distance.npy",
        "--status",
        "status.npy",
        "--normal",
        "normal.npy",
        "--bracket",
        "bracket.npy",
        "--surface-id",
        "surface.npy",
    ];
    place.run(&arguments).ok();
    let (shape, distance) = array::<f64>(&place, "distance.npy");
    assert_eq!(shape, [10, 20]);
    let (shape, bracket) = array::<f64>(&place, "bracket.npy");
    assert_eq!(shape, [10, 20, 2]);
    let (shape, surface) = array::<i16>(&place, "surface.npy");
    assert_eq!(shape, [10, 20]);
    let (shape, status) = array::<u8>(&place, "status.npy");
    assert_eq!(shape, [10, 20]);
    let (shape, normal) = array::<f32>(&place, "normal.npy");
    assert_eq!(shape, [10, 20, 3]);
    for pixel in 0..200 {
        assert_eq!(status[pixel] == 0, distance[pixel].is_infinite(), "{pixel}");
        assert_eq!(status[pixel] == 0, normal[3 * pixel..][..3] == [0.0; 3], "{pixel}");
        assert_eq!(status[pixel] == 1, bracket[2 * pixel].is_finite(), "{pixel}");
        assert_eq!(surface[pixel], if status[pixel] == 0 { -1 } else { 0 }, "{pixel}");
        if status[pixel] == 1 {
            let [near, far] = [bracket[2 * pixel], bracket[2 * pixel + 1]];
            assert!(near <= distance[pixel] && distance[pixel] <= far && far - near < 0.01);
        }
    }
    // The ray of the pixel at row 4, column 10 leaves (0, 0, 5) with slopes 0.05·s and 0.1·s.
    let s = 20.0_f64.to_radians().tan();
    let (a, b) = (0.1 * s, 0.1 * s);
    let direction = [a, b, -1.0].map(|c: f64| c / (a * a + b * b + 1.0).sqrt());
    let along = -5.0 * direction[2];
    let exact = along - (along * along - 24.0).sqrt();
    let found = distance[4 * 20 + 10];
    // The tolerance is a hundredth of a pixel.
    assert!((found - exact).abs() < 0.003, "{found} is not {exact}");
    let [near, far] = [0, 1].map(|end| bracket[2 * (4 * 20 + 10) + end]);
    assert!(near <= exact && exact <= far, "{exact} is not from {near} to {far}");
    // At the hit, x and y are about 4 · 0.1 · s, which gives the normal's third component.
    assert!((normal[3 * (4 * 20 + 10) + 2] - 0.978).abs() < 0.005);
}

/// Programs that know nothing of this one check the file: `examples/python/check_claims.py`.
#[test]
fn claims_hold_formula_domain_rays_and_proofs() {
    let place = Sandbox::new();
    let text =
        "r = 0.1 in [0, 1]; domain ball 2; max(x^2 + y^2, abs(z)) - pi*r <= 0; hidden; z = 1/3";
    let size = ["--size", "20x30", "--clip", "1,0,0,0.25"];
    let files = ["--claims", "c.jsonl", "--status", "s.npy", "--bracket", "b.npy"];
    place.run(&[&["render", text], &size[..], &files].concat()).ok();
    let lines = std::fs::read_to_string(place.path("c.jsonl")).expect("written");
    let lines: Vec<serde_json::Value> =
        lines.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let (header, claims) = lines.split_first().expect("a first line");
    assert_eq!(header["text"], text);
    assert_eq!(header["size"], serde_json::json!([20, 30]));
    let domain = serde_json::json!({
        "low": [-2.0, -2.0, -2.0],
        "high": [2.0, 2.0, 2.0],
        "ball": {"center": [0.0, 0.0, 0.0], "radius": 2.0},
        "clip": {"normal": [1.0, 0.0, 0.0], "offset": 0.25},
    });
    assert_eq!(header["domain"], domain);
    let surfaces = header["surfaces"].as_array().expect("a list");
    let kinds: Vec<_> = surfaces.iter().map(|one| [&one["kind"], &one["hidden"]]).collect();
    assert_eq!(serde_json::json!(kinds), serde_json::json!([["solid", false], ["equation", true]]));
    let steps = header["steps"].as_array().expect("a list");
    for step in [&["pi"][..], &["number", "1/10"], &["number", "3"], &["x"]] {
        assert!(steps.contains(&serde_json::json!(step)), "{step:?}");
    }
    assert!(steps[surfaces[1]["step"].as_u64().expect("a number") as usize][0] == "sub");
    let (_, status) = array::<u8>(&place, "s.npy");
    let (_, bracket) = array::<f64>(&place, "b.npy");
    assert_eq!(claims.len(), 600);
    for (pixel, claim) in claims.iter().enumerate() {
        assert_eq!(claim["pixel"], serde_json::json!([pixel % 20, pixel / 20]));
        assert_eq!(claim["status"], ["miss", "hit", "undecided"][status[pixel] as usize]);
        let ends = &bracket[2 * pixel..][..2];
        let is_same = claim.get("bracket").map(|found| *found == serde_json::json!(ends));
        assert_eq!(is_same, (status[pixel] == 1).then_some(true), "{claim}");
        assert!(claim["origin"][0].is_f64() && claim["direction"][2].is_f64(), "{claim}");
    }
    let hits = claims.iter().filter(|claim| claim["status"] == "hit").count();
    assert!((20..500).contains(&hits), "{hits} hits");
}

/// The formula is that of docs/command-line.md.
#[test]
fn points_follow_from_distances_as_the_manual_says() {
    let place = Sandbox::new();
    let perspective = ["--eye", "3,-4,2", "--target", "0.1,0.2,-0.1", "--up", "0.2,0,1"];
    for camera in [&[&perspective[..], &["--fov", "30"]].concat(), &[][..], &["--ortho", "3"]] {
        let files = ["--distance", "d.npy", "--points", "p.npy", "--status", "s.npy"];
        let fixed = ["render", "x^2+y^2+z^2 = 1", "--size", "37x20", "--json"];
        let report = place.run(&[&fixed[..], &files, camera].concat()).ok().json();
        let (shape, points) = array::<f64>(&place, "p.npy");
        assert_eq!(shape, [20, 37, 3]);
        let (_, distance) = array::<f64>(&place, "d.npy");
        let (_, status) = array::<u8>(&place, "s.npy");
        let vector = |key: &str| {
            let numbers = report["camera"][key].as_array().expect("a vector");
            DVec3::from([0, 1, 2].map(|axis| numbers[axis].as_f64().expect("a number")))
        };
        let eye = vector("eye");
        let forward = (vector("target") - eye).normalize();
        let right = forward.cross(vector("up")).normalize();
        let up = right.cross(forward);
        let fov = report["camera"]["fov"].as_f64();
        let scale = match fov {
            Some(fov) => (fov.to_radians() / 2.0).tan(),
            None => report["camera"]["ortho"].as_f64().expect("a height") / 2.0,
        };
        let mut hits = 0;
        for (pixel, point) in points.as_chunks::<3>().0.iter().enumerate() {
            assert_eq!(status[pixel] == 0, point[0].is_nan(), "{pixel}");
            if status[pixel] != 1 {
                continue;
            }
            let (i, j) = ((pixel % 37) as f64, (pixel / 37) as f64);
            let a = (2.0 * i + 1.0 - 37.0) / 20.0 * scale;
            let b = (20.0 - 1.0 - 2.0 * j) / 20.0 * scale;
            let aside = a * right + b * up;
            let (origin, direction) =
                if fov.is_some() { (eye, forward + aside) } else { (eye + aside, forward) };
            let expected = origin + distance[pixel] * direction.normalize();
            let off = (expected - DVec3::from(*point)).length();
            assert!(off < 1e-14, "{pixel} of {camera:?}: {expected} and {point:?}");
            // A hit is drawn within half a pixel of the sphere.
            assert!((DVec3::from(*point).length() - 1.0).abs() < 0.1, "{pixel}: {point:?}");
            hits += 1;
        }
        assert!(hits > 50, "{hits} hits");
    }
}

#[test]
fn a_fallback_is_named_with_its_reason() {
    let place = Sandbox::new();
    // From so far away, affine forms cannot tell where a ray is within the domain.
    let far = ["--eye", "1e14,0,0", "--target", "0,0,0", "--up", "0,0,1", "--ortho", "2.5"];
    let far = place.run(&[&["render", SPHERE, "--json", "--size", "16"], &far[..]].concat()).ok();
    let object = far.json();
    assert_eq!(
        (&object["method"], &object["fallbacks"][0]["surface"]),
        (&"knoll".into(), &0.into())
    );
    assert!(far.stderr.contains("surface 1 was traced by knoll, not affine: "), "{}", far.stderr);
    assert!(far.stderr.contains("knoll proves misses, and hits only"), "{}", far.stderr);
    // Without a fallback, the JSON object lists none.
    assert!(
        place.run(&["render", SPHERE, "--json", "--size", "8"]).json().get("fallbacks").is_none()
    );
}

#[test]
fn one_json_object_tells_times_counts_and_what_was_used() {
    let place = Sandbox::new();
    let begun = Instant::now();
    let arguments = ["--json", "--size", "32", "--threads", "1", "--status", "s.npy"];
    let run = place.run(&[&["render", SPHERE], &arguments[..]].concat());
    let taken = begun.elapsed().as_secs_f64() * 1e3;
    let run = run.ok();
    let object = run.json();
    let mut sum = 0.0;
    for stage in ["parse", "domain", "simplify", "compile", "view", "trace", "shade", "write"] {
        let ms = object["ms"][stage].as_f64().expect("a time");
        // Nothing is colored.
        assert!(ms > 0.0 || stage == "shade", "{stage}: {ms}");
        sum += ms;
    }
    assert!(sum <= taken, "{sum} of {taken} ms: {}", object["ms"]);
    let count = |path: &str| object.pointer(path).and_then(Value::as_u64).expect("a count");
    let pixels = ["/pixels/hit", "/pixels/miss", "/pixels/undecided"].map(count);
    assert_eq!(pixels.iter().sum::<u64>(), 32 * 32);
    assert!(pixels[2] == 0 && pixels[0] > 0, "all is proven: {pixels:?}");
    assert!(count("/work/tile/calls") > 0 && count("/work/tile/lanes") > 0);
    assert!(count("/work/segment/calls") > 0 && count("/work/segment/lanes") > 0);
    assert_eq!((&object["method"], &object["precision"]), (&"affine".into(), &"auto".into()));
    assert_eq!((&object["tolerance"], &object["budget"]), (&0.5.into(), &Value::Null));
    let reasons = UndecidedReason::ALL.map(UndecidedReason::name);
    assert!(reasons.contains(&"touching") && reasons.contains(&"unseen"), "{reasons:?}");
    for reason in reasons {
        assert_eq!(object["undecided"][reason], 0, "{reason}");
    }
    assert_eq!((&object["max_depth"], &object["steps"]), (&10.into(), &256.into()));
    // A run without colors compiles and calls no gradient kernel.
    assert_eq!(count("/work/gradient/calls"), 0);
    assert!(count("/code_bytes") > 0 && count("/nodes/before") >= count("/nodes/after"));
    assert_eq!(object["camera"]["fov"], 40.0);
    assert_eq!(object["domain"].as_array().map(Vec::len), Some(6));
    assert!(object["domain_found"].as_str().is_some_and(|found| found.starts_with("bounded")));
}

#[test]
fn rays_that_stay_undecided_are_given_up_with_a_reason() {
    let place = Sandbox::new();
    // (x - 1)^7 + 1e-9: near x = 1 its terms cancel, so even very thin slabs stay undecided.
    let formula = "x^7 - 7x^6 + 21x^5 - 35x^4 + 35x^3 - 21x^2 + 7x - 1 + 0*y + 1e-9";
    let render = |depth: &str| {
        let knoll = ["--method", "knoll"];
        let arguments =
            [&["render", formula, "--domain", "2", "--size", "8", "--json"], &knoll[..]];
        let arguments = arguments.concat();
        place.run(&[&arguments[..], &["--max-depth", depth]].concat()).ok()
    };
    let deep = render("20");
    let given_up = deep.json()["work"]["given_up"].as_u64().expect("a number");
    assert!(given_up > 0 && deep.stderr.contains("given up after 32768 steps"), "{}", deep.stderr);
    let calls = deep.json()["work"]["interval"]["calls"].as_u64().expect("a number");
    // The picture has four packets of sixteen rays, each with at most 32768 calls.
    assert!(calls <= 4 * 32768, "{calls}");
    let shallow = render("10");
    assert_eq!(shallow.json()["work"]["given_up"], 0);
    assert!(!shallow.stderr.contains("given up"));
}

#[test]
fn depth_has_three_names_and_changes_the_work() {
    let place = Sandbox::new();
    let lanes = |flag: &str, depth: &str| {
        let knoll = ["--method", "knoll"];
        let arguments = [&["render", SPHERE, "--json", "--size", "32", flag, depth], &knoll[..]];
        let arguments = arguments.concat();
        place.run(&arguments).ok().json()["work"]["interval"]["lanes"].clone()
    };
    let eight = lanes("--max-depth", "8");
    assert_eq!(eight, lanes("--depth", "8"));
    assert_eq!(eight, lanes("--dstop", "8"));
    assert_ne!(eight, lanes("--max-depth", "10"));
}

#[test]
fn text_comes_from_a_file_before_the_gallery_before_the_command_line() {
    let place = Sandbox::new();
    let surfaces = |arguments: &[&str], input: &str| {
        let all = [&["render"], arguments, &["--json", "--size", "8"]].concat();
        place.run_with(&all, input.as_bytes()).ok().json()["surfaces"].clone()
    };
    let standard = surfaces(&["-"], "x + y = z\n");
    assert_eq!(standard[0], "x + y = z");
    let gallery = surfaces(&["ding-dong"], "");
    assert_eq!(gallery, surfaces(&["Ding-dong"], ""));
    // Existing files take precedence over formulas and gallery names.
    place.write("x+y", "z = 1/2");
    place.write("sphere", "y = 1/2");
    assert_eq!(surfaces(&["x+y"], "")[0], "z = 1/2");
    assert_eq!(surfaces(&["sphere"], "")[0], "y = 1/2");
    assert_eq!(surfaces(&["x+z"], "")[0], "x + z = 0");
}

#[test]
fn values_may_begin_with_a_minus() {
    let place = Sandbox::new();
    for arguments in [
        ["-x^2-y^2-z^2+1", "--domain", "-2,2,-2,2,-2,2"],
        ["-sin(x)+y", "--eye", "-3,-4,5"],
        ["-hypot(x, y, z)+1", "--clip", "-1,0,0,0"],
        ["-c*x+y+z", "-D", "c=-2"],
        ["-t*x+y+z", "--time", "-1.5"],
        ["x+y+z", "--light", "-3,-4,5"],
    ] {
        let all = [&["render"], &arguments[..], &["-o", "a.png", "--size", "8"]].concat();
        let run = place.run(&all);
        assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
        // A value that is mistaken for the flag `-h` would print the help.
        assert!(run.stdout.is_empty(), "{}", run.text());
    }
}

#[test]
fn flags_may_come_first_and_hold_their_values() {
    let place = Sandbox::new();
    place.run(&["render", "-oa.png", "-Dr=2", "--size", "8", "sphere"]).ok();
    assert_eq!(place.files(), ["a.png"]);
}

#[test]
fn definitions_and_time_change_the_surface() {
    let place = Sandbox::new();
    let pixels = |arguments: &[&str]| {
        let formula = "r = 1\nx^2+y^2+z^2 = (r+t)^2";
        let camera = ["--domain", "3", "--eye", "6,-9,4.5"];
        let fixed = [&["render", formula, "--json", "--size", "32"], &camera[..]].concat();
        let all = [&fixed[..], arguments].concat();
        place.run(&all).ok().json()["pixels"]["hit"].as_u64().expect("a count")
    };
    let one = pixels(&[]);
    assert!(pixels(&["-D", "r=2"]) > 2 * one);
    assert_eq!(pixels(&["-D", "r=2"]), pixels(&["--time", "1"]));
}

#[test]
fn a_number_means_the_same_wherever_it_is_typed() {
    let place = Sandbox::new();
    let status = |text: &str, arguments: &[&str]| {
        ["affine", "knoll"].map(|method| {
            let fixed = ["render", text, "--status", "s.npy", "--size", "64", "--domain", "1"];
            place.run(&[&fixed[..], &["--method", method], arguments].concat()).ok();
            array::<u8>(&place, "s.npy").1
        })
    };
    let literal = status("x^2+y^2+z^2 = 0.1", &[]);
    assert_eq!(literal, status("a = 1\nx^2+y^2+z^2 = a", &["-D", "a=0.1"]));
    assert_eq!(literal, status("a = 0.1\nx^2+y^2+z^2 = a", &[]));
    assert_eq!(literal, status("x^2+y^2+z^2 = t", &["--time", "0.1"]));
    // Code compiled for the whole range of a slider gives the same result.
    assert_eq!(literal, status("domain 2\na = 0.1 in [-1, 1]\nx^2+y^2+z^2 = a", &[]));
    assert_eq!(literal, status("domain 2\nt = 0.3 in [0, 1]\nx^2+y^2+z^2 = t", &["--time", "0.1"]));
}

#[test]
fn a_solid_is_capped_where_the_domain_or_a_plane_cuts_it() {
    let place = Sandbox::new();
    let run = |arguments: &[&str]| {
        let fixed = ["render", "x^2+y^2+z^2 <= 1", "--size", "32", "--view", "front"];
        place.run(&[&fixed[..], arguments].concat()).ok();
    };
    run(&[
        "--status",
        "s.npy",
        "--distance",
        "d.npy",
        "--clip",
        "0,-1,0,0",
        "--domain",
        "2",
        "-o",
        "cut.png",
    ]);
    let (_, status) = array::<u8>(&place, "s.npy");
    let (_, distance) = array::<f64>(&place, "d.npy");
    // The plane y = 0 cuts the ball. The cap is proven, at a distance of 2·4.25 from the eye.
    let middle = 16 * 32 + 16;
    assert_eq!(status[middle], 1);
    let exact = 8.5;
    assert!((distance[middle] - exact).abs() < 0.01, "{}", distance[middle]);
    let blue = |arguments: &[&str]| {
        run(&[&["-o", "cut.png"], arguments].concat());
        place.picture("cut.png").get_pixel(16, 16).0[2]
    };
    let [whole, cut] = [blue(&[]), blue(&["--clip", "0,-1,0,0"])];
    assert!(cut > whole + 60, "a cut face is lighter than the outside: {cut}, {whole}");
}

#[test]
fn undecided_pixels_can_be_told_apart_and_counted_against() {
    let place = Sandbox::new();
    let render = |style: &str| {
        let name = format!("{style}.png");
        let fixed = ["render", SPHERE, "--size", "32", "-o", &name, "--undecided", style];
        place.run(&[&fixed[..], &["--method", "knoll"]].concat()).ok();
        place.picture(&name)
    };
    let shaded = render("shade");
    assert_ne!(shaded, render("hatch"));
    assert_ne!(shaded, render("tint"));
    assert_eq!(render("miss").get_pixel(16, 16).0, [244, 244, 246]);
    let strict = ["render", SPHERE, "--json", "--size", "16", "--strict"];
    assert_eq!(place.run(&[&strict[..], &["--method", "knoll"]].concat()).code, Some(1));
    let proven = place.run(&strict);
    assert_eq!((proven.code, &proven.json()["pixels"]["undecided"]), (Some(0), &0.into()));
    // The function has zeros, but is nowhere negative.
    let touching = ["render", "cosh(x-y) = 1", "--domain", "2", "--json", "--size", "16"];
    let touching = place.run(&touching);
    let object = touching.ok().json();
    assert_eq!(object["undecided"]["touching"], object["pixels"]["undecided"]);
    assert!(object["pixels"]["undecided"].as_u64() > Some(20), "{object}");
    // A square is replaced by its base, which has the same zeros.
    let square = ["render", "(x-y)^2", "--domain", "2", "--json", "--size", "16", "--strict"];
    assert!(place.run(&square).ok().json()["pixels"]["hit"].as_u64() > Some(20));
    let nothing = ["render", "x^2+y^2+z^2 = -1", "--json", "--size", "16", "--strict"];
    assert_eq!(place.run(&nothing).code, Some(0));
}

#[test]
fn an_empty_picture_says_why() {
    let place = Sandbox::new();
    let note = |arguments: &[&str]| {
        let all = [&["render"], arguments, &["--json", "--size", "8"]].concat();
        place.run(&all).ok().stderr
    };
    assert!(note(&["x^2+y^2+z^2+1"]).contains("proven empty"));
    assert!(note(&["sqrt(x-5)+y", "--domain", "2"]).contains("no value anywhere"));
    let elsewhere = note(&["(x-9)^2+y^2+z^2 = 1", "--domain", "2"]);
    assert!(elsewhere.contains("elsewhere: try --domain "), "{elsewhere}");
    let command =
        elsewhere.split("--domain ").nth(1).and_then(|rest| rest.split_whitespace().next());
    let arguments = ["(x-9)^2+y^2+z^2 = 1", "--domain", command.expect("a domain")];
    assert!(!note(&arguments).contains("nothing is seen"));
}

#[test]
fn a_function_that_may_be_0_everywhere_is_remarked_on() {
    let place = Sandbox::new();
    let note = |formula: &str| {
        let run = place.run(&["render", formula, "--domain", "2", "--size", "16", "--json"]).ok();
        run.stderr.contains("0 everywhere")
    };
    assert!(note("sin(x)^2 + cos(x)^2 - 1"));
    assert!(note("(x+y)^2 - x^2 - 2x y - y^2"));
    // Two functions are not reported as 0: a small one, and one that is 0 only on a half-space.
    assert!(!note("1e-20*(x^2+y^2+z^2-1)"));
    assert!(!note("x + abs(x)"));
    assert!(!note("x+y+z"));
}

#[test]
fn output_is_plain_where_nobody_sees_colors() {
    let place = Sandbox::new();
    let run = place.run(&["render", "x+", "-o", "a.png"]);
    assert!(!run.stderr.contains('\x1b'));
}

#[test]
fn a_picture_goes_to_standard_output() {
    let place = Sandbox::new();
    let run = place.run(&["render", SPHERE, "-o", "-", "--size", "8"]).ok();
    assert_eq!(&run.stdout[..8], b"\x89PNG\r\n\x1a\n");
}

#[test]
fn shadows_central_normals_and_parallel_rays() {
    let place = Sandbox::new();
    let render = |name: &str, arguments: &[&str]| {
        let fixed = ["render", "box", "--size", "48", "-o", name];
        place.run(&[&fixed[..], arguments].concat()).ok();
        place.picture(name)
    };
    let plain = render("plain.png", &[]);
    let shadowed = render("shadows.png", &["--shadows", "--light", "0,0,9"]);
    assert_ne!(plain, shadowed);
    let central = render("central.png", &["--normals", "central"]);
    let differing = plain.pixels().zip(central.pixels()).filter(|(a, b)| a != b).count();
    assert!(differing < 48 * 48 / 4, "{differing} pixels differ");
    let parallel = render("parallel.png", &["--ortho", "4", "--view", "front"]);
    // A cube of side 2 takes the middle half of a picture of height 4, viewed from the front.
    let background = [244, 244, 246];
    assert_eq!(parallel.get_pixel(10, 24).0, background);
    assert_ne!(parallel.get_pixel(14, 24).0, background);
}

#[test]
fn every_thread_count_gives_the_same_picture_and_arrays() {
    const ARRAYS: [&str; 7] =
        ["status", "distance", "points", "bracket", "normal", "surface-id", "claims"];

    let place = Sandbox::new();
    place.write("behind.zset", "domain 1.5\nopacity 40%\nx^2+y^2+z^2 = 1\nz = x*y\nx < -1\n");
    place.write("shadows.zset", "domain 2\nx^2+y^2+z^2 = 1/2\nz = -1\n");
    let made = |arguments: &[&str], threads: &str| {
        let mut all =
            vec!["render", "--size", "133x71", "-o", "p.png", "--threads", threads, "--json"];
        let files = ARRAYS.map(|array| (format!("--{array}"), format!("{array}.npy")));
        all.extend(files.iter().flat_map(|(flag, file)| [flag.as_str(), file]));
        all.extend(arguments);
        let object = place.run(&all).ok().json();
        let names = ARRAYS.iter().map(|array| format!("{array}.npy")).chain(["p.png".to_owned()]);
        let files = names.map(|name| std::fs::read(place.path(&name)).expect("written"));
        (files.collect::<Vec<_>>(), object)
    };
    for arguments in [
        &["tangle"][..],
        &["tangle", "--method", "knoll", "--shadows"],
        &["tangle", "--method", "march"],
        &["double-root-sphere", "--aa", "64"],
        &["shadows.zset", "--shadows", "--light", "1,1,9"],
        &["behind.zset", "--shadows", "--look", "night"],
        // Some of these pixels are decided in doubles only.
        &["(x-1000)^2+(y-1000)^2+(z-1000)^2 = 1", "--shadows", "--precision", "auto"],
        &["z = tan(x)", "--normals", "central"],
    ] {
        let (one, object) = made(arguments, "1");
        let kernels = object["kernels"].as_array().expect("kernels");
        let is_double = kernels.iter().any(|kernel| kernel["precision"] == "f64");
        assert!(is_double || !arguments.contains(&"auto"), "{arguments:?}");
        for threads in ["2", "5"] {
            let (other, again) = made(arguments, threads);
            for (number, (one, other)) in one.iter().zip(&other).enumerate() {
                let what = ARRAYS.get(number).unwrap_or(&"picture");
                assert!(one == other, "{arguments:?}, {threads} threads: another {what}");
            }
            assert_eq!(object["edge_rays"], again["edge_rays"], "{arguments:?}");
            assert_eq!(object["undecided"], again["undecided"], "{arguments:?}");
        }
    }
}

/// Only the kernels that a picture needs are compiled. The view is given, since the search for a
/// view evaluates kernels, too.
#[test]
fn kernels_are_made_for_what_the_picture_asks() {
    let place = Sandbox::new();
    let ball = "x^2+y^2+z^2 = 1";
    let found = ["the function: segments, f32", "the function: tiles, f32"];
    let [values, gradients] =
        ["the function: values, f32", "function and derivatives: gradients, f32"];
    // Where normals turn within a pixel, they are found in `f64`.
    let both = [gradients, "function and derivatives: gradients, f64"];
    let bounds = "the function: bounds, f32";
    let cleared = [
        "the numerator: bounds, f32",
        "the numerator: segments, f32",
        "the numerator: tiles, f32",
        "the denominator: bounds, f32",
    ];
    let doubles =
        ["the function: segments, f64", "the function: tiles, f64", "the function: zeros, f64"];
    for (formula, flags, expected) in [
        (ball, &["-o", "p.png"][..], &[&found[..], &both].concat()[..]),
        (ball, &["--status", "s.npy"], &found),
        ("z = tan(x)", &["-o", "p.png"], &[&[bounds], &cleared[..], &[gradients]].concat()),
        ("z = tan(x)", &["--status", "s.npy"], &[&[bounds], &cleared[..]].concat()),
        ("x^2+y^2+z^2 < 1", &["-o", "p.png"], &[&[bounds], &found[..], &both].concat()),
        ("x^2+y^2+z^2 < 1", &["--status", "s.npy"], &[&[bounds], &found[..]].concat()),
        (ball, &["-o", "p.png", "--normals", "central"], &[&found[..], &[values]].concat()),
        (ball, &["-o", "p.png", "--no-contract"], &[&found[..], &both].concat()),
        (ball, &["-o", "p.png", "--no-interval"], &[&found[..], &both].concat()),
        (ball, &["-o", "p.png", "--shadows"], &[&found[..], &both].concat()),
        (
            ball,
            &["-o", "p.png", "--precision", "f64"],
            &[&doubles[..], &["function and derivatives: gradients, f64"]].concat(),
        ),
        (
            ball,
            &["-o", "p.png", "--method", "knoll"],
            &[values, "the function: zeros, f32", gradients],
        ),
        (ball, &["-o", "p.png", "--method", "march"], &[values, gradients]),
        (ball, &["-o", "p.png", "--method", "march", "--normals", "central"], &[values]),
        (ball, &["-o", "p.png", "--method", "march", "--shadows"], &[values, gradients]),
    ] {
        let fixed =
            ["render", formula, "--domain", "2", "--view", "front", "--size", "48", "--json"];
        let object = place.run(&[&fixed[..], flags].concat()).ok().json();
        let kernels = object["kernels"].as_array().expect("kernels").iter();
        let one = |kernel: &Value| {
            let word = |name: &str| kernel[name].as_str().expect("a word").to_owned();
            format!("{}: {}, {}", word("form"), word("question"), word("precision"))
        };
        assert_eq!(kernels.map(one).collect::<Vec<_>>(), expected, "{formula} {flags:?}");
    }
}

/// Seconds that a picture gets, until something is drawn.
const BUDGETS: [&str; 6] = ["1", "2", "4", "8", "16", "32"];

/// A Mandelbulb, and tangents that change sign millions of times per pixel, would take minutes.
/// Compiling takes more time on some machines, so the budget grows until something is drawn.
#[test]
fn a_budget_of_time_ends_what_is_hopeless_with_the_picture_so_far() {
    let place = Sandbox::new();
    place.write("bulb.zset", BULB);
    for (formula, domain) in [
        ("bulb.zset", &["--domain", "1.2"][..]),
        ("bulb.zset", &[]),
        ("sum(k = 1..10, tan(k*1e6*x + k*y)) = z", &["--domain", "1"]),
        ("sum(k = 1..10, tan(k*1e6*x + k*y)) = z", &[]),
    ] {
        let render = |budget: &str, more: &[&str]| {
            let fixed = ["render", formula, "--size", "700", "-o", "p.png", "--json"];
            place.run(&[&fixed[..], &["--budget", budget], domain, more].concat())
        };
        let (budget, run, unreached) = BUDGETS
            .into_iter()
            .find_map(|budget| {
                let run = render(budget, &[]).ok();
                let unreached = unreached(&run.json());
                (unreached < 700 * 700).then_some((budget, run, unreached))
            })
            .unwrap_or_else(|| panic!("{formula}: nothing is drawn in 32 s"));
        assert!(0 < unreached, "{formula}: all is drawn in {budget} s");
        let note = format!(
            "of these were not reached within {budget} s and are not drawn: a larger --budget"
        );
        assert!(run.stderr.contains(&note), "{}", run.stderr);
        assert_eq!(place.picture("p.png").width(), 700);
        assert_eq!(render(budget, &["--strict"]).code, Some(1));
    }
}

/// Pixels of a picture of 700² that the budget of time left.
fn unreached(object: &Value) -> u64 {
    let of = |name: &str| object["pixels"][name].as_u64().expect("a count");
    assert_eq!(of("hit") + of("miss") + of("undecided"), 700 * 700);
    object["undecided"]["budget"].as_u64().expect("a count")
}

/// The budget includes the time for choosing the domain and the view.
#[test]
fn a_budget_of_time_is_no_other_for_the_view() {
    let place = Sandbox::new();
    let formula = "sum(k = 1..10, tan(k*1e6*x + k*y)) = z";
    for domain in [&["--domain", "1"][..], &[]] {
        let fixed = ["render", formula, "--size", "64", "--budget", "1e-9", "--json"];
        let run = place.run(&[&fixed[..], domain].concat()).ok();
        let object = run.json();
        assert_eq!(object["undecided"]["budget"], 64 * 64);
        // Compiling is not waited for.
        assert_eq!(object["code_bytes"], 0);
        let note = "no domain was found in time: x, y, z in -2..2 are drawn; --domain says where";
        assert_eq!(run.stderr.contains(note), domain.is_empty(), "{}", run.stderr);
    }
    // Each frame has the full budget.
    let formula = "sum(k = 1..10, tan(k*1e6*x + k*y)) = a*z";
    let frames = |budget: &str| {
        let fixed =
            ["render", formula, "--domain", "1", "--sweep", "a=1..2", "--frames", "3", "--json"];
        let run = place.run(&[&fixed[..], &["--size", "700", "--budget", budget]].concat()).ok();
        let frames = run.text().lines().map(|frame| serde_json::from_str(frame).expect("JSON"));
        frames.map(|frame| unreached(&frame)).collect::<Vec<_>>()
    };
    let drawn = |frame: &u64| *frame < 700 * 700;
    let some = BUDGETS.into_iter().map(frames).find(|all| all.iter().all(drawn));
    let some = some.expect("a part of every frame");
    assert_eq!(some.len(), 3);
    assert!(some.iter().all(|unreached| 0 < *unreached), "{some:?}");
}

#[test]
fn explain_tells_how_a_formula_is_read_and_compiled() {
    let place = Sandbox::new();
    let run = place.run(&["explain", "2x sin y = z^2"]).ok();
    for part in [
        "read as     2*x*sin(y) = z^2",
        "simplified",
        "kernel      zeros of the function, f32, ",
        "bytes, to find the surface\n",
        "bytes, for normals\n",
        "operations",
        "bytes",
    ] {
        assert!(run.text().contains(part), "{part} is not in {}", run.text());
    }
    // Code is listed on request only, after everything else.
    assert!(!run.text().contains("function u0:0"), "{}", run.text());
    let run = place.run(&["explain", "--code", "2x sin y = z^2"]).ok();
    let code = run.text().find("function u0:0").expect("the code");
    assert!(run.text().find("nodes ").expect("the nodes") < code, "{}", run.text());
    let run = place.run(&["explain", "1/x + floor(y) = z"]).ok();
    for part in ["cleared     ", "zeros of the numerator", "zeros of the branches"] {
        assert!(run.text().contains(part), "{part} is not in {}", run.text());
    }
    // Removed factors of quotients are named.
    let run = place.run(&["explain", "z = sin(x*y)/(x*y)"]).ok();
    assert!(run.text().contains("removed     x*y, a factor"), "{}", run.text());
    let run = place.run(&["explain", "z <= sin(x)/x"]).ok();
    assert!(run.text().contains("removed     gaps"), "{}", run.text());
    // Notes on how the text was read are part of the explanation.
    assert!(place.run(&["explain", "1/2x+y+z"]).ok().text().contains("the other reading"));
    // The listed code has the requested precision.
    let code = |precision: &str| {
        place
            .run(&["explain", "x*y = z", "--code", "--precision", precision])
            .ok()
            .text()
            .to_owned()
    };
    assert!(code("f32").contains("f32x4") && !code("f32").contains("f64x2"));
    assert!(code("f64").contains("f64x2") && !code("f64").contains("f32x4"));
    // A constant has no surface. The explanation gives the reason.
    let three = place.run(&["explain", "3"]).ok();
    assert!(three.text().contains("no surface  '3' is constant: it is 3"), "{}", three.text());
    // A parameter is shown as typed, not as the bounds of its value.
    let parameter = place.run(&["explain", "x^2+y^2+z^2=a", "-D", "a=0.3"]).ok();
    assert!(parameter.text().contains("parameter   a = 0.3\n"), "{}", parameter.text());
}

#[test]
fn the_gallery_is_listed_and_rendered_without_a_checkout() {
    let place = Sandbox::new();
    let list = place.run(&["gallery", "--list"]).ok();
    let names: Vec<&str> =
        list.text().lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.len() >= 95 && names.contains(&"klein-bottle"));
    place.run(&["gallery", "-o", "out/pictures", "--size", "24"]).ok();
    // The models are listed behind the gallery, and not rendered with it.
    let (names, models) = names.split_at(names.len() - 5);
    assert_eq!(models, ["bearing", "lattice", "planetary-gear", "rook", "temple"]);
    for name in names {
        let picture = place.picture(&format!("out/pictures/{name}.png"));
        let background = picture.get_pixel(0, 0);
        let painted = picture.pixels().any(|pixel| pixel != background);
        // The needle is thinner than these pixels.
        assert!(painted || *name == "needle", "{name} is empty");
    }
    let sheet = place.picture("out/pictures/contact-sheet.png");
    assert!(sheet.width() > 2000);
}

#[test]
fn completions_are_generated() {
    let place = Sandbox::new();
    for shell in ["bash", "zsh", "fish"] {
        assert!(place.run(&["completions", shell]).ok().text().contains("--max-depth"), "{shell}");
    }
}

#[test]
fn double_precision_reaches_deeper_and_writes_wider_distances() {
    let place = Sandbox::new();
    // A sphere of radius 10^4. `f32` resolves the squares only to a few units.
    let far = |precision: &str, method: &[&str]| {
        let arguments = [
            "render",
            "x^2+y^2+z^2-1e8",
            "--domain",
            "9990,10010,-10,10,-10,10",
            "--eye",
            "10050,0,0",
            "--target",
            "10000,0,0",
            "--size",
            "9",
            "--precision",
            precision,
            "--distance",
            "far.npy",
            "--json",
        ];
        let run = place.run(&[&arguments[..], method].concat()).ok();
        assert_eq!(run.json()["precision"], precision);
        run.json()["pixels"]["undecided"].as_u64().expect("a count")
    };
    far("f32", &["--method", "knoll", "--max-depth", "20"]);
    let (_, single) = array::<f32>(&place, "far.npy");
    far("f64", &["--method", "knoll", "--max-depth", "36"]);
    let (shape, double) = array::<f64>(&place, "far.npy");
    assert_eq!(shape, [9, 9]);
    let middle = 4 * 9 + 4;
    // By default, `f64` decides the rays that `f32` cannot decide.
    let fine = ["--tolerance", "1e-7"];
    assert_eq!([far("auto", &fine), far("f64", &fine)], [0, 0]);
    let (_, finished) = array::<f64>(&place, "far.npy");
    assert!((finished[middle] - 50.0).abs() < 1e-6, "{}", finished[middle]);
    // In `f32` alone, a hit is proven by signs, and its distance is less accurate.
    far("f32", &fine);
    let (_, coarse) = array::<f32>(&place, "far.npy");
    let off = (f64::from(coarse[middle]) - 50.0).abs();
    assert!((1e-6..0.1).contains(&off), "{off}");
    assert!((double[middle] - 50.0).abs() < 1e-8, "{}", double[middle]);
    assert!((single[middle] - 50.0).abs() < 0.1, "{}", single[middle]);
    let refused = place.run(&["render", "x", "--max-depth", "21", "--json"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("40 in precision f64"), "{}", refused.stderr);
}

#[test]
fn a_time_may_be_a_constant_expression_and_is_noted_where_nothing_depends_on_it() {
    let place = Sandbox::new();
    let json = |time: &str| {
        let all = ["render", "x^2+y^2+z^2 = t", "--size", "8", "--json", "--time", time];
        place.run(&all).ok().json()["domain"].clone()
    };
    assert_eq!(json("1/4"), json("0.25"));
    assert_ne!(json("1/4"), json("3"));
    let note = "note: --time changes nothing: `t` occurs nowhere in the formula";
    let run = place.run(&["render", SPHERE, "--size", "8", "--json", "--time", "3"]).ok();
    assert!(run.stderr.contains(note), "{}", run.stderr);
    let run = place.run(&["render", "x+y = t", "--size", "8", "--json", "--time", "3"]).ok();
    assert!(!run.stderr.contains(note), "{}", run.stderr);
    let run = place.run(&["explain", SPHERE, "--time", "3"]).ok();
    assert!(run.stderr.contains(note), "{}", run.stderr);
}

#[test]
fn the_paper_s_method_proves_misses_only_and_is_accounted_for() {
    let place = Sandbox::new();
    let run = place.run(&["render", SPHERE, "--json", "--size", "32", "--method", "knoll"]).ok();
    let object = run.json();
    let count = |path: &str| object.pointer(path).and_then(Value::as_u64).expect("a count");
    let pixels = ["/pixels/hit", "/pixels/miss", "/pixels/undecided"].map(count);
    assert_eq!(pixels.iter().sum::<u64>(), 32 * 32);
    assert!(pixels[2] > 0 && pixels[0] == 0, "this method proves no hit");
    assert_eq!(count("/undecided/unproven"), pixels[2]);
    assert!(count("/work/interval/calls") > 0 && count("/work/interval/lanes") > 0);
    assert!(run.stderr.contains("this method proves misses, and hits only"), "{}", run.stderr);
}

#[test]
fn a_method_that_proves_nothing_says_so() {
    let place = Sandbox::new();
    let march = ["render", SPHERE, "--json", "--size", "32", "--domain", "1", "--method", "march"];
    let run = place.run(&[&march[..], &["--steps", "64", "--ortho", "1"]].concat()).ok();
    let object = run.json();
    assert_eq!(
        (&object["undecided"]["unproven"], &object["pixels"]["miss"]),
        (&1024.into(), &0.into())
    );
    assert_eq!((&object["steps"], &object["work"]["given_up"]), (&64.into(), &0.into()));
    assert!(run.stderr.contains("this method proves nothing"), "{}", run.stderr);
    assert!(!run.stderr.contains("are not drawn"), "{}", run.stderr);
}

/// A formula without a surface on this domain is skipped, and the other surfaces are drawn. A
/// formula without a surface anywhere is refused.
#[test]
fn what_is_constant_on_this_domain_only_is_noted() {
    let place = Sandbox::new();
    let render = |text: &str, domain: &str| {
        place.write("text.zset", text);
        place.run(&[
            "render",
            "text.zset",
            "--size",
            "24",
            "--domain",
            domain,
            "-o",
            "p.png",
            "--json",
        ])
    };
    let (half, whole) = ("0.1,2,-1,1,-1,1", "-1,2,-1,1,-1,1");
    let run = render("x^2+y^2+z^2 = 1\nsign(x)-1/2", half).ok();
    let note = "note: 'sign(x) - 1/2' is constant on this domain: it is 0.5 at every point";
    assert!(run.stderr.contains(note), "{}", run.stderr);
    assert!(run.json()["pixels"]["hit"].as_u64() > Some(20), "{}", run.json());
    let run = render("x^2+y^2+z^2 = 1\nsign(x)-1/2", whole).ok();
    assert!(!run.stderr.contains("is constant"), "{}", run.stderr);
    let run = render("sign(x)-1/2", half).ok();
    assert!(run.stderr.contains(note) && run.stderr.contains("nothing is seen"), "{}", run.stderr);
    let run = render("x^2+y^2+z^2 = 4\nnot (sqrt(x)<5)", "-2,-1,-2,2,-2,2").ok();
    assert!(run.json()["pixels"]["hit"].as_u64() > Some(20), "{}", run.json());
    let run = render("x^2+y^2+z^2 = 1\nsign(x^2+1)-1/2", half);
    assert!(
        run.code == Some(2) && run.stderr.contains("it is 0.5 at every point"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_picture_tells_which_command_made_it() {
    let place = Sandbox::new();
    place.run(&["render", "x^2+y^2 = z^2 + ½", "--size", "16", "-o", "it.png"]).ok();
    let file = std::fs::File::open(place.path("it.png")).expect("written");
    let reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("valid");
    let texts = &reader.info().utf8_text;
    let comment = texts.iter().find(|text| text.keyword == "Comment").expect("a comment");
    let command = "zeroset render 'x^2+y^2 = z^2 + ½' --size 16 -o it.png";
    assert_eq!(comment.get_text().expect("text"), command);
    assert!(reader.info().srgb.is_some());
}

/// Typing the domain that a note names as `--domain` gives the same picture.
#[test]
fn a_domain_of_multiples_of_pi_is_written_as_such() {
    let place = Sandbox::new();
    let run =
        place.run(&["render", "sin(x)+sin(y)+sin(z) = 0", "--status", "s.npy", "--size", "8"]);
    let run = run.ok();
    let (_, ends) = run.stderr.split_once("domain x, y, z in ").expect("a domain");
    let (low, high) = ends.trim().split_once("..").expect("two ends");
    assert!(low.starts_with('-') && low.ends_with('π') && high.ends_with('π'), "{ends}");
    let found = std::fs::read(place.path("s.npy")).expect("written");
    let domain = [low, high].join(",");
    let domain = [domain.as_str(); 3].join(",");
    let again = ["render", "sin(x)+sin(y)+sin(z) = 0", "--status", "s.npy", "--size", "8"];
    place.run(&[&again[..], &["--domain", &domain]].concat()).ok();
    assert!(found == std::fs::read(place.path("s.npy")).expect("written"));
    let explained = place.run(&["explain", "sin(x)+sin(y) = z", "--domain", "2π"]).ok();
    assert!(explained.text().contains("domain      x in [-2π, 2π], y in"), "{}", explained.text());
}
