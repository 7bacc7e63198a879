//! Compiling and dropping kernels leaks no memory, and a picture's memory does not grow with the
//! number of its translucent surfaces.

use super::alone;
use std::fmt::Write as _;
use std::fs;
use zeroset_eval::Boxes;
use zeroset_interval::Interval;
use zeroset_render::model::render;
use zeroset_render::picture::Settings;
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::gallery::examples;
use zeroset_scene::program::Program;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::Pattern;
use zeroset_syntax::{Document, Options, read};

const CYCLES: usize = 1000;
const ALLOWED_KILOBYTES: i64 = 512;

const SPHERES: usize = 100;
const ALLOWED_PEAK_KILOBYTES: i64 = 100 << 10;

/// The number after `name` in the process's status.
fn kilobytes(name: &str) -> i64 {
    let status = fs::read_to_string("/proc/self/status").expect("readable");
    let line = status.lines().find_map(|line| line.strip_prefix(name)).expect("a size");
    line.trim().trim_end_matches("kB").trim().parse().expect("a number")
}

/// Compiles all kernels of a document, runs one and drops all. Returns the size of their code.
fn cycle(document: &Document) -> usize {
    let program = Program::new(document, [Interval { lo: -2.0, hi: 2.0 }; 3]).expect("simplifies");
    let kernels = program.kernels::<f32>(0);
    kernels.values().expect("compiles");
    kernels.gradients().expect("compiles");
    kernels.gradient_bounds().expect("compiles");
    kernels.cleared().expect("compiles");
    kernels.zeros().expect("compiles");
    kernels.bounds().expect("compiles").eval_all(&Boxes::around(&[[Interval::ONE; 3]]));
    program.made().iter().map(|made| made.bytes).sum()
}

#[test]
fn a_thousand_cycles_leave_resident_memory_within_half_a_megabyte() {
    alone("kernels::a_thousand_cycles_leave_resident_memory_within_half_a_megabyte", repeat_cycles);
}

fn repeat_cycles() {
    let read = |text: &str| read(text, &Options::default()).expect("reads");
    let documents: Vec<Document> = examples().iter().map(|example| read(example.text)).collect();
    // The first passes fill tables and the allocator's pools, whose pages the system may take back
    // while they are seldom used.
    let warm: usize = documents.iter().chain(&documents).map(cycle).sum();
    let before = kilobytes("VmRSS:");
    let code: usize = (0..CYCLES).map(|n| cycle(&documents[n % documents.len()])).sum();
    let grown = kilobytes("VmRSS:") - before;
    println!("{warm} and {code} bytes of code; {before} kB resident, {grown} kB more at the end");
    let seen = 2 * 1024 * ALLOWED_KILOBYTES as usize;
    assert!(code > seen, "a leak of the code would not be seen");
    assert!(grown <= ALLOWED_KILOBYTES, "{grown} kB more than {before} kB");
}

#[test]
fn a_hundred_translucent_spheres_need_no_more_than_a_hundred_megabytes() {
    let name = "kernels::a_hundred_translucent_spheres_need_no_more_than_a_hundred_megabytes";
    alone(name, draw_spheres);
}

/// Each of the spheres has a front and a back that cover much of the picture.
fn draw_spheres() {
    let mut text = "opacity 5%\ndomain 2\n".to_owned();
    for n in 1..=SPHERES {
        let place = n as f64;
        let [x, y, z] = [1.0, 1.7, 2.3].map(|pace| 0.4 * (pace * place).sin());
        writeln!(text, "(x-{x:.3})^2+(y-{y:.3})^2+(z-{z:.3})^2=2").expect("a string");
    }
    let document = read(&text.replace("--", "+"), &Options::default()).expect("reads");
    let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
    let camera = camera::camera(&CameraChoice::typed(&document), &region).expect("a camera");
    let antialias = Pattern::of(16).expect("a pattern");
    let settings = Settings { width: 256, height: 256, antialias, ..Settings::default() };
    let before = kilobytes("VmHWM:");
    let picture = render(&document, &region, &camera, &settings).expect("compiles");
    assert!(picture.statistics.edge_rays > 0);
    let grown = kilobytes("VmHWM:") - before;
    println!("{SPHERES} spheres: {grown} kB more than {before} kB");
    assert!(grown <= ALLOWED_PEAK_KILOBYTES, "{grown} kB more than {before} kB");
}
