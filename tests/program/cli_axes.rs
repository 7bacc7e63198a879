//! Axes and legends drawn over pictures, by flags and by lines of the document.

use crate::cli_support::Sandbox;

const DOCUMENT: &str = "color viridis(z)\nx^2+y^2+z^2 = 1";

fn bytes(place: &Sandbox, name: &str) -> Vec<u8> {
    let image = image::open(place.path(name)).expect("a picture");
    image.to_rgb8().into_raw()
}

#[test]
fn axes_and_legends_are_drawn_where_they_are_asked_for() {
    let place = Sandbox::new();
    let render = |text: &str, flags: &[&str]| {
        let fixed = ["render", text, "-o", "out.png", "--size", "200x160", "--status", "s.npy"];
        place.run(&[&fixed[..], flags].concat()).ok();
        (bytes(&place, "out.png"), std::fs::read(place.path("s.npy")).expect("written"))
    };
    let plain = render(DOCUMENT, &[]);
    let (axes, legend) = (render(DOCUMENT, &["--axes"]), render(DOCUMENT, &["--legend"]));
    assert!(axes.0 != plain.0 && legend.0 != plain.0 && axes.0 != legend.0);
    // A legend does not change the picture's scale. Axes shrink the picture to make room.
    assert!(legend.1 == plain.1 && axes.1 != plain.1);
    assert_eq!(render(&format!("axes\n{DOCUMENT}"), &[]), axes);
    assert_eq!(render(&format!("legend on\n{DOCUMENT}"), &[]), legend);
    assert_eq!(render(&format!("axes off\n{DOCUMENT}"), &[]), plain);
    // Axes come with a legend, unless the legend is off.
    let without = render(&format!("legend off\n{DOCUMENT}"), &["--axes"]);
    assert!(without.0 != axes.0 && without.1 == axes.1);
    // Without values shown as colors, there is no legend.
    let sphere = "x^2+y^2+z^2 = 1";
    assert_eq!(render(sphere, &["--legend"]), render(sphere, &[]));
}

#[test]
fn a_domain_is_clipped_as_asked_and_the_note_says_how() {
    let place = Sandbox::new();
    let render = |text: &str, flags: &[&str]| {
        let fixed = ["render", text, "--json", "--size", "32"];
        let run = place.run(&[&fixed[..], flags].concat()).ok();
        let said: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        (said["ball"].clone(), run.stderr)
    };
    let cubic = "x*y*z = 1";
    let (ball, notes) = render(cubic, &[]);
    assert_eq!(ball, serde_json::json!([0.0, 0.0, 0.0, 2.5]));
    assert!(notes.contains("unbounded, clipped to a ball; domain x, y, z in -2.5..2.5"), "{notes}");
    let (ball, notes) = render(cubic, &["--clip-to", "box"]);
    assert!(ball.is_null() && notes.contains("unbounded, clipped to a box"), "{notes}");
    assert!(render("z = x*y", &[]).0.is_null());
    assert_eq!(render("z = x*y", &["--clip-to", "ball", "--domain", "3"]).0[3], 3.0);
    assert_eq!(render("domain ball 3/2\nz = x*y", &[]).0[3], 1.5);
}

#[test]
fn a_saved_picture_has_what_its_document_draws_around_it() {
    let place = Sandbox::new();
    place.write("wave.zset", "axes\ncolor turbo(z, -1, 1)\nz = x*y\n");
    let run = place.run_with(&["--preview", "wave.zset"], b":png seen.png\n").ok();
    let said = String::from_utf8_lossy(&run.stdout).into_owned() + &run.stderr;
    let command = said.split_once("zeroset ").expect("the command that reproduces it").1;
    let options = command.lines().next().expect("a line").replace("seen.png", "again.png");
    let words: Vec<&str> = options.split_whitespace().collect();
    assert!(words.starts_with(&["render", "wave.zset"]), "{options}");
    place.run(&words).ok();
    let pixels = |name: &str| image::open(place.path(name)).expect("a picture").to_rgb8();
    let (seen, again) = (pixels("seen.png"), pixels("again.png"));
    assert!(seen == again, "{options}");
    // The right margin holds the legend only: a column of its bar has many bright colors.
    let colors = |column: u32| {
        let pixels = (0..seen.height()).map(|row| seen.get_pixel(column, row).0);
        let is_bright = |[r, g, b]: &[u8; 3]| r.max(g).max(b) - r.min(g).min(b) > 60;
        pixels.filter(is_bright).collect::<std::collections::BTreeSet<_>>().len()
    };
    let most = (seen.width() - 70..seen.width()).map(colors).max();
    assert!(most > Some(50), "{most:?} colors");
}
