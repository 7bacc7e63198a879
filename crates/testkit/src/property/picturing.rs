//! What a picture claims of its rays is true, by the certified tracer.

use super::scene::{Scene, describe};
use crate::certified::{Certificate, Function, Line};
use crate::suite::{Failure, Tally};

/// What a picture says of one ray. Distances are multiples of the line's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Claimed {
    /// There is no zero.
    Miss,
    /// There is a zero at this distance, and none before.
    Hit(f64),
    /// There is no zero before this distance.
    Undecided(f64),
}

/// A pixel's ray, and what is claimed of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// The ray.
    pub line: Line,
    /// The claim.
    pub claimed: Claimed,
}

/// Evaluations per ray: what takes more remains undecided.
const BUDGET: u32 = 4000;

/// Distances are `f32`; the rest is room for what was added to them.
const ROUNDING: f64 = 1e-6;

/// Draws `scene` by `draw`, which gives the pixels or `None` if nothing can be drawn, and holds each claim against what
/// is certain of that ray. `defined` counts rays with a certain crossing.
///
/// # Errors
/// The first false claim.
pub fn picture(
    scene: &Scene,
    draw: &dyn Fn(&Scene) -> Option<Vec<Pixel>>,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let Some(pixels) = draw(scene) else { return Ok(tally) };
    let function = scene.formula.function();
    for (index, pixel) in pixels.iter().enumerate() {
        let certificate = function.trace(&pixel.line, &scene.formula.region, BUDGET);
        tally.compared += 1;
        tally.defined += u64::from(certificate.crossing.is_some());
        let Some(what) = contradiction(pixel.claimed, &certificate) else { continue };
        if is_stable(&function, scene, pixel) {
            let (i, j) = (index % scene.size[0], index / scene.size[0]);
            return Err(Failure::new(format!(
                "{what}: {:?}, but {certificate:?}\n{scene}\ncolumn {i}, row {j}: {}",
                pixel.claimed,
                describe(&pixel.line),
            )));
        }
    }
    Ok(tally)
}

fn contradiction(claimed: Claimed, certificate: &Certificate) -> Option<&'static str> {
    let far = certificate.crossing.map(|crossing| crossing.far);
    let room = |distance: f64| ROUNDING * (1.0 + distance);
    let beyond = |distance: f64| far.is_some_and(|far| distance > far + room(far));
    match claimed {
        Claimed::Miss if far.is_some() => Some("a false miss"),
        Claimed::Hit(_) if certificate.is_miss() => Some("a false hit"),
        Claimed::Hit(at) if at + room(at) < certificate.first() => Some("a hit before any zero"),
        Claimed::Hit(at) | Claimed::Undecided(at) if beyond(at) => Some("a zero passed over"),
        Claimed::Miss | Claimed::Hit(_) | Claimed::Undecided(_) => None,
    }
}

/// Whether the claim is false of the neighbouring lines as well: a camera's directions are rounded, and the line that
/// was followed may differ from the one that was told by a rounding of each number.
fn is_stable(function: &Function, scene: &Scene, pixel: &Pixel) -> bool {
    let moves = [f64::next_up, f64::next_down];
    (0..8).all(|which| {
        let mut line = pixel.line;
        for (axis, value) in line.direction.iter_mut().enumerate() {
            // A component that is 0 is so exactly.
            if *value != 0.0 {
                *value = moves[which >> axis & 1](*value);
            }
        }
        let certificate = function.trace(&line, &scene.formula.region, BUDGET);
        contradiction(pixel.claimed, &certificate).is_some()
    })
}
