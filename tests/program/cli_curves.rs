//! Curves and points in pictures, sequences and reports.

use crate::cli_support::Sandbox;

fn pixels(place: &Sandbox, name: &str) -> Vec<[u8; 3]> {
    let image = image::open(place.path(name)).expect("a picture");
    image.to_rgb8().pixels().map(|pixel| pixel.0).collect()
}

fn red(pixels: &[[u8; 3]]) -> usize {
    pixels.iter().filter(|[red, green, blue]| *red > 120 && *green < 90 && *blue < 90).count()
}

const HELIX: &str =
    "color lightgray\nx^2+y^2+z^2=1\ncolor red\n(1.2cos t, 1.2sin t, t/6) for t in [-8, 8]";

#[test]
fn curves_are_drawn_and_arrays_leave_them_out() {
    let place = Sandbox::new();
    let fixed = ["-o", "out.png", "--size", "160", "--domain", "2"];
    let render = |text: &str, flags: &[&str]| {
        let run = place.run(&[&["render", text][..], &fixed, flags].concat());
        (pixels(&place, "out.png"), run)
    };
    let plain =
        render("color lightgray\nx^2+y^2+z^2=1", &["--status", "plain.npy", "--eye", "4,-6,3"]);
    let drawn = render(HELIX, &["--status", "drawn.npy", "--eye", "4,-6,3"]);
    assert!(red(&plain.0) == 0 && red(&drawn.0) > 300, "{}", red(&drawn.0));
    let [one, other] =
        ["plain.npy", "drawn.npy"].map(|name| std::fs::read(place.path(name)).expect("written"));
    assert_eq!(one, other);
    assert!(drawn.1.stderr.contains("drawn, not proven"), "{}", drawn.1.stderr);
    assert!(!plain.1.stderr.contains("drawn, not proven"));
}

#[test]
fn a_document_may_have_curves_alone() {
    let place = Sandbox::new();
    for text in [
        "color red\n(cos t, sin t, t/5) for t in [0, 20]",
        "color red\ncurve x^2+y^2=1, z=x",
        "color red\nwidth 8\n(1, 2, 3)",
        "color red\ncurve (x+i y)^3 = z",
    ] {
        let run = place.run(&["render", text, "-o", "out.png", "--size", "160"]);
        run.ok();
        assert!(red(&pixels(&place, "out.png")) > 30, "{text}");
        let explained = place.run(&["explain", text]);
        assert!(explained.ok().text().contains("read as"), "{text}");
    }
    let refused = place.run(&["mesh", "(1, 2, 3)\n(4, 5, 6)", "-o", "part.stl"]);
    assert!(refused.stderr.contains("curves and points alone"), "{}", refused.stderr);
    let refused = place.run(&["measure", "curve x=0, y=0"]);
    assert!(refused.stderr.contains("curves and points alone"), "{}", refused.stderr);
}

#[test]
fn sequences_draw_curves() {
    let place = Sandbox::new();
    let text = "a = 1\ncolor red\n(a cos t, a sin t, 0) for t in [0, 2pi]";
    let fixed = ["--size", "120", "--frames", "3", "--sweep", "a=0.5..1.5", "-o", "f-%d.png"];
    place.run(&[&["render", text][..], &fixed].concat()).ok();
    let counts = ["f-0.png", "f-1.png", "f-2.png"].map(|name| red(&pixels(&place, name)));
    assert!(counts[0] > 30 && counts[1] > counts[0] && counts[2] > counts[1], "{counts:?}");
}

#[test]
fn a_large_picture_has_curves_across_its_strips() {
    let place = Sandbox::new();
    let text = "color red\n(t, 0, t) for t in [-1, 1]";
    let fixed = ["--size", "2200x2200", "-o", "out.png", "--view", "front"];
    place.run(&[&["render", text][..], &fixed].concat()).ok();
    let pixels = pixels(&place, "out.png");
    let rows = (0..2200).filter(|row| red(&pixels[row * 2200..(row + 1) * 2200]) > 0).count();
    assert!(rows > 1000, "{rows}");
    let (first, last) = (0..2200).fold((2200, 0), |(first, last), row| {
        let has = red(&pixels[row * 2200..(row + 1) * 2200]) > 0;
        if has { (first.min(row), last.max(row)) } else { (first, last) }
    });
    assert_eq!(last - first + 1, rows, "no row between is without the line");
}

#[test]
fn the_prompt_shows_curves_in_letters() {
    let lines = b"x^2+y^2+z^2=1\n:add (1.5cos t, 1.5sin t, 0) for t in [0, 2pi]\n:delete\n";
    let run = Sandbox::new().run_with(&["--preview", "curve x^2+y^2=1, z=x"], lines).ok();
    let text = run.text();
    let (letters, blanks) = ("@%#*+=-:", ' ');
    let of_picture = |line: &&str| line.chars().all(|c| c == blanks || letters.contains(c));
    let rows: Vec<&str> = text.lines().filter(of_picture).collect();
    let inked = rows.iter().flat_map(|row| row.chars()).filter(|c| *c != blanks).count();
    let blank = rows.iter().flat_map(|row| row.chars()).filter(|c| *c == blanks).count();
    assert!(rows.len() > 20 && inked > 100 && blank > inked, "{inked} {blank}:\n{text}");
    let listed = "2  (1.5*cos(t), 1.5*sin(t), 0) for t in [0, 2*pi]";
    assert!(text.contains(listed) || run.stderr.contains(listed), "{}", run.stderr);
}
