//! Looks, backgrounds and lines of pictures that `zeroset render` writes.

use crate::cli_support::Sandbox;

const SPHERE: &str = "x^2+y^2+z^2 = 1";

#[test]
fn a_background_has_a_name_or_a_number() {
    let place = Sandbox::new();
    let ground = |color: &str| {
        let all = ["render", "x^2+y^2+z^2=1", "--size", "8", "-o", "p.png", "--background", color];
        place.run(&all).ok();
        place.picture("p.png").get_pixel(0, 0).0
    };
    assert_eq!([ground("navy"), ground("Orange")], [[0, 0, 128], [255, 165, 0]]);
    assert_eq!(ground("navy"), ground("000080"));
}

#[test]
fn a_picture_without_a_background_has_opacities() {
    let place = Sandbox::new();
    let drawn = |more: &[&str]| {
        let fixed = ["render", SPHERE, "--size", "64", "-o", "p.png"];
        place.run(&[&fixed[..], more].concat()).ok();
        image::open(place.path("p.png")).expect("a picture")
    };
    let clear = drawn(&["--background", "transparent", "--axes"]);
    assert_eq!(clear.color(), image::ColorType::Rgba8);
    let clear = clear.into_rgba8();
    assert_eq!((clear.get_pixel(0, 0).0[3], clear.get_pixel(32, 32).0[3]), (0, 255));
    // Lines and letters of the axes are opaque, or nearly so.
    let is_ink =
        |pixel: &&image::Rgba<u8>| pixel.0[3] > 128 && pixel.0[..3].iter().all(|c| *c < 80);
    assert!(clear.pixels().filter(is_ink).count() > 60);
    // Flags override the document.
    let text = format!("background transparent; {SPHERE}");
    place.run(&["render", &text, "--size", "8", "-o", "p.png"]).ok();
    assert!(image::open(place.path("p.png")).expect("a picture").color().has_alpha());
    place.run(&["render", &text, "--size", "8", "-o", "p.png", "--background", "white"]).ok();
    assert!(!image::open(place.path("p.png")).expect("a picture").color().has_alpha());
    let refused = place.run(&["render", &format!("background tranparent; {SPHERE}"), "--json"]);
    assert!(refused.stderr.contains("did you mean `transparent`?"), "{}", refused.stderr);
    let refused = place.run(&["render", SPHERE, "--json", "--background", "reddish"]);
    assert!(refused.stderr.contains("neither a color such as white"), "{}", refused.stderr);
}

#[test]
fn sixteen_bits_are_the_same_picture_with_finer_steps() {
    let place = Sandbox::new();
    let sphere = "title Ball; domain 1.2; x^2+y^2+z^2 = 1";
    let drawn = |text: &str, bits: &str, more: &[&str]| {
        let fixed = ["render", text, "--size", "96", "-o", "p.png", "--bits", bits];
        place.run(&[&fixed[..], more].concat()).ok();
        image::open(place.path("p.png")).expect("a picture")
    };
    for (text, more, color) in [
        (sphere, &[][..], image::ColorType::Rgb16),
        (sphere, &["--aa", "1", "--look", "night"], image::ColorType::Rgb16),
        (sphere, &["--ground", "--outlines", "--axes", "--haze", "0.7"], image::ColorType::Rgb16),
        (sphere, &["--ground", "--background", "transparent"], image::ColorType::Rgba16),
        ("opacity 40%; material glass; x^4+y^4+z^4 = 1", &["--ground"], image::ColorType::Rgb16),
        ("color viridis(z); contours; z = x y", &["--legend"], image::ColorType::Rgb16),
    ] {
        let [coarse, fine] = ["8", "16"].map(|bits| drawn(text, bits, more));
        assert_eq!(fine.color(), color, "{text} {more:?}");
        let channels = fine.as_bytes().as_chunks::<2>().0.iter().map(|n| u16::from_ne_bytes(*n));
        let channels: Vec<u16> = channels.collect();
        assert_eq!(channels.len(), coarse.as_bytes().len());
        let off = |(n, m): (usize, &u8)| {
            // The color of a pixel that is nearly transparent depends on the steps.
            let opacity = n / 4 * 4 + 3;
            let is_seen = !color.has_alpha() || n == opacity || coarse.as_bytes()[opacity] > 127;
            let off = f64::from(channels[n]) / 257.0 - f64::from(*m);
            if is_seen { off.abs() } else { 0.0 }
        };
        let off: Vec<f64> = coarse.as_bytes().iter().enumerate().map(off).collect();
        // Light is mixed from floats in one picture, and from bytes in the other.
        let largest = off.iter().fold(0.0_f64, |most, off| most.max(*off));
        let far = off.iter().filter(|off| **off > 0.6).count();
        assert!(largest < 2.0 && 40 * far < off.len(), "{text} {more:?}: {largest}, {far}");
        // A byte has no steps in between.
        let between = channels.iter().filter(|n| **n % 257 != 0).count();
        assert!(10 * between > channels.len(), "{text} {more:?}: {between}");
    }
    let refused = place.run(&["render", sphere, "-o", "p.png", "--bits", "12"]);
    assert!(
        refused.code == Some(2) && refused.stderr.contains("must be 8 or 16"),
        "{}",
        refused.stderr
    );
    let turning =
        ["render", sphere, "--turntable", "--frames", "3", "--size", "32", "--bits", "16"];
    let refused = place.run(&[&turning[..], &["-o", "t.gif"]].concat());
    assert!(refused.stderr.contains("--bits 16 is for PNG files"), "{}", refused.stderr);
    place.run(&[&turning[..], &["-o", "t.png"]].concat()).ok();
    assert_eq!(image::open(place.path("t.png")).expect("frames").color(), image::ColorType::Rgb16);
    place.run(&[&turning[..], &["-o", "t-%d.png"]].concat()).ok();
    assert_eq!(
        image::open(place.path("t-1.png")).expect("frames").color(),
        image::ColorType::Rgb16
    );
}

#[test]
fn looks_and_edges_change_colors_and_nothing_else() {
    let place = Sandbox::new();
    let render = |more: &[&str]| {
        let fixed = ["render", SPHERE, "--size", "48", "-o", "p.png", "--status", "s.npy"];
        place.run(&[&fixed[..], more].concat()).ok();
        (place.picture("p.png"), std::fs::read(place.path("s.npy")).expect("written"))
    };
    let (usual, status) = render(&[]);
    for (look, corner) in [
        ("studio", [244, 244, 246]),
        ("flat", [255; 3]),
        ("paper", [255; 3]),
        ("night", [13, 15, 21]),
    ] {
        let (lit, same) = render(&["--look", look]);
        assert_eq!(lit.get_pixel(0, 0).0, corner, "{look}");
        assert!(same == status && (lit == usual) == (look == "studio"), "{look}");
    }
    let (sharp, same) = render(&["--aa", "1"]);
    assert!(same == status && sharp != usual);
    assert_eq!(sharp.get_pixel(24, 24), usual.get_pixel(24, 24));
    let refused = place.run(&["render", SPHERE, "-o", "p.png", "--aa", "3"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("must be 1, 4, 16 or 64"));
}

#[test]
fn a_document_says_how_its_picture_looks() {
    let place = Sandbox::new();
    let render = |text: &str, more: &[&str]| {
        let fixed = ["render", text, "--size", "48", "--json", "-o", "p.png"];
        let run = place.run(&[&fixed[..], more].concat()).ok();
        let image = place.picture("p.png");
        (run.json()["look"].as_str().expect("a look").to_owned(), image)
    };
    let corner = |(_, image): &(String, image::RgbImage)| image.get_pixel(0, 0).0;
    let plain = render(SPHERE, &[]);
    let night = render(&format!("{SPHERE}; look night"), &[]);
    assert_eq!((night.0.as_str(), corner(&night)), ("night", [13, 15, 21]));
    let tomato = render(&format!("background tomato; look night; {SPHERE}"), &[]);
    assert_eq!((tomato.0.as_str(), corner(&tomato)), ("night", [255, 99, 71]));
    // Flags override the document.
    let asked = render(
        &format!("background tomato; look night; {SPHERE}"),
        &["--look", "studio", "--background", "#f4f4f6"],
    );
    assert_eq!(asked, plain);
    // A color line after the only surface applies to it.
    let red = render(&format!("{SPHERE}; color red"), &[]);
    assert_eq!(red, render(&format!("color red; {SPHERE}"), &[]));
    assert_ne!(red, plain);
    let refused = place.run(&["render", &format!("look nigt; {SPHERE}"), "-o", "p.png"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("did you mean `night`?"));
}

#[test]
fn lines_haze_and_a_title_are_flags() {
    let place = Sandbox::new();
    let render = |text: &str, more: &[&str]| {
        let fixed = ["render", text, "--size", "96", "-o", "p.png", "--status", "s.npy"];
        place.run(&[&fixed[..], more].concat()).ok();
        (place.picture("p.png"), std::fs::read(place.path("s.npy")).expect("written"))
    };
    let (plain, status) = render(SPHERE, &[]);
    for (flags, line) in [
        (&["--outlines"][..], "outlines"),
        (&["--haze", "0.5"], "haze 50%"),
        (&["--title", "A  ball\n"], "title A ball"),
    ] {
        let (drawn, same) = render(SPHERE, flags);
        assert!(drawn != plain && same == status, "{line}");
        assert!(render(&format!("{line}\n{SPHERE}"), &[]).0 == drawn, "{line}");
    }
    // An empty title removes the document's.
    assert!(render(&format!("title A ball\n{SPHERE}"), &["--title", ""]).0 == plain);
    for share in ["nan", "2", "-0.1"] {
        let refused = place.run(&["render", SPHERE, "-o", "q.png", "--haze", share]);
        assert_eq!((refused.code, place.path("q.png").exists()), (Some(2), false), "{share}");
        let why = "'--haze <on|off|SHARE>': must be on, off, or a share from 0 to 1";
        assert!(refused.stderr.contains(why), "{}", refused.stderr);
    }
}
