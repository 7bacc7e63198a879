//! End-to-end tests of `zeroset render --frames`.

use crate::cli_support::Sandbox;
use serde_json::Value;

const GROWING: &str = "x^2+y^2+z^2 = r^2; r = 1";

fn pixels(place: &Sandbox, name: &str) -> Vec<u8> {
    image::open(place.path(name)).expect("a picture").to_rgb8().into_raw()
}

/// The JSON objects of all frames, one per line.
fn frames(stdout: &str) -> Vec<Value> {
    stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

#[test]
fn each_frame_is_the_picture_of_its_values() {
    let place = Sandbox::new();
    let sweep = ["--sweep", "r=0.3..1.2", "--frames", "4", "--size", "48"];
    let files = ["-o", "f-%02d.png", "--json"];
    let run = place.run(&[&["render", GROWING], &sweep[..], &files].concat()).ok();
    let frames = frames(run.text());
    assert_eq!(frames.len(), 4);
    for (frame, r) in frames.iter().zip([0.3, 0.6, 0.9, 1.2]) {
        let value = frame["values"]["r"].as_f64().expect("a number");
        assert!((value - r).abs() < 1e-12, "{value}");
        // All frames share the domain, the camera and the compilation.
        assert_eq!(frame["domain"], frames[0]["domain"]);
        assert_eq!(frame["camera"], frames[0]["camera"]);
        assert_eq!(frame["ms"]["compile"] == 0.0, frame["frame"] != 0, "{}", frame["ms"]);
        assert!(frame["ms"]["parse"].as_f64() > Some(0.0), "{}", frame["ms"]);
        let list = |value: &Value| {
            let numbers = value.as_array().expect("numbers").iter().map(Value::to_string);
            numbers.collect::<Vec<_>>().join(",")
        };
        let alone = place.run(&[
            "render",
            GROWING,
            "-D",
            &format!("r={value}"),
            &format!("--domain={}", list(&frame["domain"])),
            &format!("--eye={}", list(&frame["camera"]["eye"])),
            &format!("--target={}", list(&frame["camera"]["target"])),
            "--size",
            "48",
            "-o",
            "alone.png",
        ]);
        alone.ok();
        let name = format!("f-{:02}.png", frame["frame"].as_u64().expect("a number"));
        assert_eq!(pixels(&place, &name), pixels(&place, "alone.png"), "{name}");
    }
}

#[test]
fn only_the_first_frame_of_a_turn_reads_and_compiles() {
    let place = Sandbox::new();
    let turn = ["render", "tangle", "--turntable", "--frames", "3", "--size", "32", "--json"];
    let run = place.run(&[&turn[..], &["-o", "f-%d.png"]].concat()).ok();
    for (n, frame) in frames(run.text()).iter().enumerate() {
        for phase in ["parse", "simplify", "compile"] {
            assert_eq!(frame["ms"][phase] == 0.0, n > 0, "{phase} of frame {n}: {}", frame["ms"]);
        }
    }
    assert_ne!(pixels(&place, "f-0.png"), pixels(&place, "f-1.png"));
}

#[test]
fn shards_make_what_one_run_makes_and_resuming_makes_what_is_missing() {
    let place = Sandbox::new();
    let turn = ["render", "tangle", "--turntable", "--frames", "5", "--size", "32", "-o"];
    place.run(&[&turn[..], &["whole-%d.png"]].concat()).ok();
    for shard in ["1/2", "2/2"] {
        place.run(&[&turn[..], &["part-%d.png", "--shard", shard]].concat()).ok();
    }
    let all = |name: &str| (0..5).map(|k| pixels(&place, &format!("{name}-{k}.png"))).collect();
    let whole: Vec<Vec<u8>> = all("whole");
    let parts: Vec<Vec<u8>> = all("part");
    assert!(whole == parts);
    assert_ne!(whole[0], whole[1]);

    let resume = [&turn[..], &["whole-%d.png", "--resume"]].concat();
    std::fs::remove_file(place.path("whole-3.png")).expect("there");
    let run = place.run(&resume).ok();
    assert!(run.stderr.contains("4 frames were there already, 1 were made"), "{}", run.stderr);
    assert!(all("whole") == whole);
    // A frame's file that another command wrote is rendered again.
    std::fs::copy(place.path("part-2.png"), place.path("whole-2.png")).expect("copied");
    let run = place.run(&resume).ok();
    assert!(run.stderr.contains("4 frames were there already, 1 were made"), "{}", run.stderr);
}

#[test]
fn resuming_makes_anew_what_another_sequence_has_written_over() {
    let place = Sandbox::new();
    let turn = |more: &[&str]| {
        let fixed = ["render", "tangle", "--turntable", "--frames", "3", "--size", "16"];
        let arrays = ["--status", "s-%d.npy", "--resume"];
        place.run(&[&fixed[..], &arrays, more].concat()).ok().stderr
    };
    turn(&["-o", "a-%d.png"]);
    let said = turn(&["-o", "a-%d.png"]);
    assert!(said.contains("3 frames were there already"), "{said}");
    let own = std::fs::read(place.path("s-1.npy")).expect("there");
    turn(&["-o", "b-%d.png", "--domain", "1"]);
    assert_ne!(std::fs::read(place.path("s-1.npy")).expect("there"), own);
    let said = turn(&["-o", "a-%d.png"]);
    assert!(!said.contains("there already"), "{said}");
    assert_eq!(std::fs::read(place.path("s-1.npy")).expect("there"), own);
}

#[test]
fn one_file_holds_all_frames() {
    let place = Sandbox::new();
    let sweep = ["render", GROWING, "--sweep", "r=0.5..1", "--frames", "3", "--size", "24x16"];
    let to = |name: &str| place.run(&[&sweep[..], &["-o", name]].concat());
    to("f-%d.png").ok();
    let frames: Vec<Vec<u8>> = (0..3).map(|k| pixels(&place, &format!("f-{k}.png"))).collect();

    to("all.png").ok();
    let file = std::fs::File::open(place.path("all.png")).expect("written");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    assert_eq!(reader.info().animation_control.expect("animated").num_frames, 3);
    for frame in &frames {
        let mut shown = vec![0; 3 * 24 * 16];
        reader.next_frame(&mut shown).expect("a frame");
        assert!(shown == *frame);
    }

    to("all.gif").ok();
    let file = std::fs::File::open(place.path("all.gif")).expect("written");
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(std::io::BufReader::new(file)).expect("a GIF");
    let mut delays = 0;
    for frame in &frames {
        let shown = decoder.read_next_frame().expect("valid").expect("a frame");
        delays += shown.delay;
        // A palette of 256 colors is accurate enough for a small picture.
        let off = shown.buffer.chunks(4).zip(frame.chunks(3));
        let off = off.flat_map(|(a, b)| (0..3).map(move |k| a[k].abs_diff(b[k]))).max();
        assert!(off < Some(24), "{off:?}");
    }
    assert_eq!((delays, decoder.read_next_frame().expect("valid").is_none()), (10, true));

    let raw = to("-").ok().stdout;
    assert!(raw == frames.concat());
}

#[test]
fn frames_without_a_background_have_opacities_if_their_format_has() {
    let place = Sandbox::new();
    let all = ["render", GROWING, "--sweep", "r=0.5..1", "--frames", "2", "--size", "24x16"];
    let to = |name: &str| {
        place.run(&[&all[..], &["-o", name, "--background", "transparent"]].concat()).ok()
    };
    to("f-%d.png");
    let frame = image::open(place.path("f-1.png")).expect("a picture");
    assert!(frame.color().has_alpha());
    to("all.png");
    let file = std::fs::File::open(place.path("all.png")).expect("written");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    let mut shown = vec![0; 4 * 24 * 16];
    for _ in 0..2 {
        reader.next_frame(&mut shown).expect("a frame");
    }
    assert!(shown == frame.into_rgba8().into_raw() && shown[3] == 0);
    // Raw frames have the background of the look.
    assert_eq!(to("-").stdout[..3], [244, 244, 246]);
}

#[test]
fn a_loop_leaves_out_the_end_and_a_whole_turn_is_one() {
    let place = Sandbox::new();
    let values = |more: &[&str]| {
        let sweep = ["render", "x^2+y^2+z^2 = 1+sin(t)^2", "--time", "0..pi", "--frames", "4"];
        let rest = ["--size", "8", "-o", "f-%d.png", "--json"];
        let run = place.run(&[&sweep[..], &rest, more].concat()).ok();
        let values = frames(run.text()).into_iter().map(|frame| frame["values"]["t"].as_f64());
        values.map(|t| t.expect("a number") / std::f64::consts::PI).collect::<Vec<_>>()
    };
    let near = |found: Vec<f64>, wanted: [f64; 4]| {
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    };
    near(values(&[]), [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]);
    near(values(&["--loop"]), [0.0, 0.25, 0.5, 0.75]);
    let turn = ["render", "sphere", "--turntable", "--frames", "4", "--size", "8", "--json"];
    let run = place.run(&turn).ok();
    let turned = frames(run.text());
    let place_of = |frame: usize, what: &str, axis: usize| {
        turned[frame]["camera"][what][axis].as_f64().expect("a number")
    };
    for axis in 0..2 {
        let middle = place_of(0, "eye", axis).midpoint(place_of(2, "eye", axis));
        assert!((middle - place_of(0, "target", axis)).abs() < 1e-9);
    }
    assert!((place_of(0, "eye", 2) - place_of(2, "eye", 2)).abs() < 1e-9);
    assert!((place_of(0, "eye", 0) - place_of(2, "eye", 0)).abs() > 0.5);
}

#[test]
fn what_is_wrong_with_a_sequence_is_said() {
    let place = Sandbox::new();
    let refused = |more: &str, why: &str| {
        let words: Vec<&str> = more.split(' ').collect();
        let run = place.run(&[&["render", GROWING, "--size", "8"], &words[..]].concat());
        assert_eq!(run.code, Some(2), "{more}: {}", run.stderr);
        assert!(run.stderr.contains(why), "{more}: {}", run.stderr);
        assert!(place.files().is_empty(), "{more}: {:?}", place.files());
    };
    refused("--sweep r=0..1 -o f-%d.png", "needs --frames");
    refused("--frames 3 -o f-%d.png", "something that moves");
    refused("--frames 3 --sweep r=0 -o f-%d.png", "a..b");
    refused("--frames 3 --sweep r=0..inf -o f-%d.png", "'inf' is not a finite number");
    refused("--frames 3 --sweep q=0..1 -o f-%d.png", "'q' moves, but does not occur");
    refused("--frames 3 --time 0..1 -o f-%d.png", "'t' moves, but does not occur");
    refused("--frames 3 --sweep r=0..1 --sweep r=1..2 -o f-%d.png", "swept twice");
    refused("--frames 3 --sweep r=0..1 -D r=2 -o f-%d.png", "both set by -D and swept");
    refused("--frames 3 --sweep r=0..1 -o f.jpg", "frame-%04d.png");
    refused("--frames 3 --sweep r=0..1 -o f.png --json", "--json is about one frame");
    refused(
        "--frames 3 --sweep r=0..1 -o f-%d.png --status s.npy",
        "would be written by every frame",
    );
    refused("--frames 3 --sweep r=0..1 -o f.gif --shard 1/2", "need a file for each frame");
    refused("--frames 3 --sweep r=0..1 -o f-%d.png --shard 3/2", "not of the form I/N");
    refused("--frames 3 --sweep r=0..1 -o f.gif --fps 60", "at most 50 frames a second");
    refused("--resume -o f.png", "--resume needs --frames");
}

#[test]
fn frames_that_another_method_drew_say_so() {
    let place = Sandbox::new();
    // From so far away, affine forms cannot tell where a ray is within the domain.
    let far = ["--eye", "1e14,0,0", "--target", "0,0,0", "--up", "0,0,1", "--ortho", "2.5"];
    let sweep = ["--sweep", "r=0.3..1.2", "--frames", "3", "--size", "16", "--json"];
    let run = place.run(&[&["render", GROWING], &far[..], &sweep[..]].concat()).ok();
    for frame in frames(run.text()) {
        assert_eq!(
            (&frame["method"], &frame["fallbacks"][0]["method"]),
            (&"knoll".into(), &"knoll".into())
        );
    }
    let note = "in 3 of 3 frames surface 1 was traced by knoll, not affine: ";
    assert_eq!(run.stderr.matches(note).count(), 1, "{}", run.stderr);
}

/// The domain of a sequence holds the domain of each of its frames.
#[test]
fn what_moves_is_not_cut_in_any_frame() {
    let place = Sandbox::new();
    place.write(
        "turned.glsl",
        "mat2 rot(float a) { float s = sin(a), c = cos(a); return mat2(c, -s, s, c); }\n\
         float map(vec3 p) { p.xz *= rot(iTime*.5); p.xy *= rot(.7); return length(max(abs(p) - \
         .5, 0.)) - .05; }",
    );
    // The ends of x, y and z, in turn.
    let ends = |arguments: &[&str]| -> Vec<f64> {
        let run = place.run(&[&["render"], arguments, &["--size", "16", "--json"]].concat()).ok();
        let ends = frames(run.text())[0]["domain"].as_array().expect("ends").clone();
        ends.iter().map(|end| end.as_f64().expect("a number")).collect()
    };
    for (text, sweep, values) in [
        ("turned.glsl", "--time", ["0", "1", "2", "3"]),
        ("rotate(box(1,0.5,0.3), t) <= 0", "--time", ["0", "1", "2", "3"]),
        ("rotate(torus(1,0.3), t, (1,0,0)) <= 0", "--time", ["0", "1", "2", "3"]),
        ("a = 0 in [0,3]; rotate(box(1,0.5,0.3), a, (1,1,0)) <= 0", "a", ["0", "1", "2", "3"]),
        ("a = 2; x^2 + y^2 + a*z^2 = a^2", "a", ["1", "2", "3", "4"]),
    ] {
        let option = |value: &str| match sweep {
            "--time" => [sweep.to_owned(), value.to_owned()],
            name => ["--sweep".to_owned(), format!("{name}={value}")],
        };
        let [word, motion] = option(&format!("{}..{}", values[0], values[3]));
        for frames in ["4", "40"] {
            let whole = ends(&[text, &word, &motion, "--frames", frames]);
            for value in values {
                let [word, value] = option(value);
                let word = if word == "--sweep" { "-D" } else { &word };
                let one = ends(&[text, word, &value]);
                let mut axes = whole.chunks(2).zip(one.chunks(2));
                let is_within = axes.clone().all(|(a, b)| a[0] <= b[0] && b[1] <= a[1]);
                let is_near = axes.all(|(a, b)| a[1] - a[0] < 12.0 * (b[1] - b[0]));
                assert!(is_within && is_near, "{text} at {value}: {one:?} in {whole:?}");
            }
        }
    }
}
