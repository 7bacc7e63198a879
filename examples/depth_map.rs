//! Traces a grid of parallel rays to a depth map, and writes it as a gray picture.
//!
//! `cargo run --example depth_map [DIRECTORY]` writes `depth.pgm`.

use std::path::PathBuf;
use zeroset::{Function, Ray, RayResult};

/// Number of rays in a row, and number of rows.
const SIDE: usize = 128;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let directory = PathBuf::from(std::env::args().nth(1).unwrap_or(".".to_owned()));
    let clebsch = Function::parse(
        "81*(x^3+y^3+z^3) - 189*(x^2*y+x^2*z+y^2*x+y^2*z+z^2*x+z^2*y) + 54*x*y*z \
         + 126*(x*y+x*z+y*z) - 9*(x^2+y^2+z^2) - 9*(x+y+z) + 1",
    )?;
    // The rays start above the domain and look down on the square from -2 to 2.
    let coordinate = |pixel: usize| 4.0 * (pixel as f64 + 0.5) / SIDE as f64 - 2.0;
    let pixels = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (column, row)));
    let rays: Vec<Ray> = pixels
        .map(|(column, row)| Ray {
            origin: [coordinate(column), -coordinate(row), 3.0],
            direction: [0.0, 0.0, -1.0],
        })
        .collect();
    let settings = zeroset::TraceSettings::new().domain([-2.0..=2.0, -2.0..=2.0, -2.0..=2.0]);
    let results = clebsch.trace_with(&rays, &settings)?;

    let (mut hits, mut misses, mut undecided) = (0, 0, 0);
    let mut widest = 0.0_f64;
    // The top of the domain is at t = 1 and white. Its bottom is at t = 5 and black.
    let gray = |t: f64| (255.0 * (5.0 - t) / 4.0).clamp(0.0, 255.0) as u8;
    let shades = results.iter().map(|result| match *result {
        RayResult::Hit { t, bracket: [near, far], .. } => {
            hits += 1;
            widest = widest.max(far - near);
            gray(t)
        }
        RayResult::Undecided { t, reason, .. } => {
            undecided += 1;
            eprintln!("undecided: {reason}");
            t.map_or(0, gray)
        }
        _ => {
            misses += 1;
            0
        }
    });
    let mut file = format!("P5 {SIDE} {SIDE} 255\n").into_bytes();
    file.extend(shades);
    std::fs::write(directory.join("depth.pgm"), file)?;
    println!("{hits} hits, {misses} misses, {undecided} undecided");
    println!("every zero is known to {widest:.0e} of the way");
    Ok(())
}
