//! Tests of the programs in `examples`: the text that they print and the files that they write.
//!
//! `cargo test` builds these programs unless it is told which targets to test.

use super::errors::Sandbox;
use std::path::PathBuf;
use std::process::Command;

/// Runs an example in a new directory. Returns what it prints, and the directory.
fn run(name: &str, arguments: &[&str]) -> (String, Sandbox) {
    let place = Sandbox::new();
    // The test binary is in `deps`, which is beside `examples`.
    let test = std::env::current_exe().expect("this test");
    let built: PathBuf = test.parent().and_then(|deps| deps.parent()).expect("a directory").into();
    let program = built.join("examples").join(name).with_extension(std::env::consts::EXE_EXTENSION);
    assert!(program.exists(), "no {}: run `cargo build --examples`", program.display());
    let arguments = arguments.iter().copied();
    let run = Command::new(program).args(arguments).current_dir(place.path(".")).output();
    let run = run.expect("it starts");
    assert!(run.status.success(), "{name}: {}", String::from_utf8_lossy(&run.stderr));
    (String::from_utf8(run.stdout).expect("UTF-8"), place)
}

fn last_number(line: &str) -> f64 {
    line.rsplit(' ').next().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN)
}

#[test]
fn evaluate_prints_values_for_each_radius() {
    let (printed, _) = run("evaluate", &[]);
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!((lines.len(), lines[0]), (10, "f = (sqrt(x^2 + y^2) - R)^2 + z^2 - 1/4"));
    assert_eq!(lines[4], "R = 2: f[2.0, 0.0, 0.0] = -0.25, gradient [0.0, 0.0, 0.0]");
    assert_eq!(lines[8], "R = 2.5: f[0.0, 2.5, 0.0] = -0.25, gradient [0.0, 0.0, 0.0]");
}

#[test]
fn root_region_narrows_down() {
    let (printed, _) = run("root_region", &[]);
    assert!(printed.starts_with("domain ["), "{printed}");
    let volumes: Vec<f64> = printed.lines().skip(1).map(last_number).collect();
    assert!(volumes.len() == 6 && volumes.is_sorted_by(|one, next| one > next), "{printed}");
    assert!(volumes[5] < volumes[0] / 8.0, "{printed}");
}

#[test]
fn depth_map_writes_a_gray_picture() {
    let (printed, place) = run("depth_map", &[]);
    assert!(printed.contains(" 0 undecided\n"), "{printed}");
    let file = std::fs::read(place.path("depth.pgm")).expect("written");
    let pixels = file.strip_prefix(b"P5 128 128 255\n").expect("a header");
    assert_eq!(pixels.len(), 128 * 128);
    let hits = pixels.iter().filter(|shade| **shade > 0).count();
    let told: usize = printed.split(' ').next().and_then(|n| n.parse().ok()).expect("a number");
    assert!(hits > 8000 && hits.abs_diff(told) < 200, "{hits} are not black; {printed}");
}

#[test]
fn mesh_writes_a_ring() {
    let (printed, place) = run("mesh", &[]);
    assert!(
        printed.contains("triangles, Euler's number 0\nclosed: true, proven: true\n"),
        "{printed}"
    );
    let bytes = std::fs::read(place.path("ring.3mf")).expect("written");
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
    assert!(archive.by_name("3D/3dmodel.model").expect("a model").size() > 10_000);
}

#[test]
fn render_writes_a_picture() {
    let (printed, place) = run("render", &[]);
    assert!(printed.starts_with("Counts { miss: "), "{printed}");
    assert!(printed.contains("the nearest point is 10."), "{printed}");
    let image = image::open(place.path("saddle.png")).expect("a PNG").to_rgb8();
    assert_eq!(image.dimensions(), (640, 480));
    // The sphere is gold.
    let [red, green, blue] = image.get_pixel(320, 140).0;
    assert!(red > 150 && green > 120 && blue < 100, "{red} {green} {blue}");
}

#[test]
fn sweep_writes_a_picture_for_each_value() {
    let (printed, place) = run("sweep", &["."]);
    let names: Vec<String> = (0..8).map(|frame| format!("frame-{frame}.png")).collect();
    assert_eq!(place.files(), names);
    let files = names.iter().map(|name| std::fs::read(place.path(name)).expect("there"));
    let mut files: Vec<Vec<u8>> = files.collect();
    files.dedup();
    assert!(files.len() == 8 && printed.lines().count() == 8, "{printed}");
}

#[test]
fn gallery_lists_and_renders() {
    let (printed, place) = run("gallery", &[]);
    assert_eq!(printed.lines().count(), zeroset::gallery().count());
    assert!(place.files().is_empty());
    let (printed, place) = run("gallery", &["tangle"]);
    assert_eq!((printed.lines().count(), place.files()), (1, vec!["tangle.png".to_owned()]));
}
