//! Pictures that are rendered strip by strip.

use crate::cli_support::Sandbox;

const TEXT: &str = "domain 1.5\ncolor viridis(z)\nx^2+y^2+z^2 <= 1";

/// A picture just too large for one strip looks like a smaller one. Its arrays match its counts.
#[test]
fn a_large_picture_is_written_in_strips() {
    let place = Sandbox::new();
    let render = |name: &str, size: &str, more: &[&str]| {
        let fixed = ["render", TEXT, "-o", name, "--size", size, "--axes", "--shadows", "--json"];
        let run = place.run(&[&fixed[..], more].concat()).ok();
        run.json()
    };
    let arrays = ["--status", "status.npy", "--normal", "normal.npy", "--points", "points.npy"];
    let large = render("large.png", "1680x2560", &arrays);
    let small = render("small.png", "420x640", &[]);
    assert_eq!(large["camera"], small["camera"]);
    let bytes = std::fs::read(place.path("status.npy")).expect("written");
    let status = npyz::NpyFile::new(&bytes[..]).expect("an array");
    assert_eq!(status.shape(), [2560, 1680]);
    let status: Vec<u8> = status.into_vec().expect("bytes");
    for (number, name) in ["miss", "hit", "undecided"].into_iter().enumerate() {
        let count = status.iter().filter(|status| usize::from(**status) == number).count();
        assert_eq!(large["pixels"][name], count, "{name}");
    }
    let bytes = std::fs::read(place.path("normal.npy")).expect("written");
    assert_eq!(npyz::NpyFile::new(&bytes[..]).expect("an array").shape(), [2560, 1680, 3]);
    let bytes = std::fs::read(place.path("points.npy")).expect("written");
    let points = npyz::NpyFile::new(&bytes[..]).expect("an array");
    let points: Vec<f64> = points.into_vec().expect("numbers");
    // Rays of another strip would put the points elsewhere.
    for (point, status) in points.as_chunks::<3>().0.iter().zip(&status) {
        let radius = point.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!(*status != 1 || (radius - 1.0).abs() < 0.01, "{point:?}");
    }
    // Scaled down, the large picture equals the small one. Surface, legend and axes are in their
    // places, and no strip is displaced.
    let (large, small) = (place.picture("large.png"), place.picture("small.png"));
    assert_eq!(large.dimensions(), (1680, 2560));
    let mean = |x: u32, y: u32, part: usize| {
        let parts = (0..16).map(|n| large.get_pixel(4 * x + n % 4, 4 * y + n / 4).0[part]);
        parts.map(u32::from).sum::<u32>() / 16
    };
    let off = |(x, y, pixel): (u32, u32, &image::Rgb<u8>)| {
        (0..3).any(|part| mean(x, y, part).abs_diff(u32::from(pixel.0[part])) > 24)
    };
    let differ = small.enumerate_pixels().filter(|pixel| off(*pixel)).count();
    println!("{differ} of {} pixels differ", 420 * 640);
    assert!(differ < 420 * 640 / 50, "{differ}");
}

#[test]
fn frames_of_a_sequence_are_held_whole() {
    let place = Sandbox::new();
    let arguments =
        ["render", TEXT, "-o", "a.gif", "--turntable", "--frames", "2", "--size", "16384"];
    let run = place.run(&arguments);
    assert!(run.code == Some(2) && run.stderr.contains("held whole"), "{}", run.stderr);
}
