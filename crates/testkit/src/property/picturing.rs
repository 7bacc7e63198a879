//! What a picture claims of its rays is true, by the certified tracer.

use super::scene::{Scene, describe};
use crate::certified::{Certificate, Entry, Function, Line};
use crate::suite::{Failure, Tally};

/// What a picture says of one ray. Distances are multiples of the line's direction. A solid also
/// has zeros where its inside meets the region's faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Claimed {
    /// There is no zero.
    Miss,
    /// The first zero lies between these distances.
    Hit([f64; 2]),
    /// There is no zero before this distance.
    Undecided(f64),
}

/// A pixel's ray, and what is claimed of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Column and row.
    pub place: [usize; 2],
    /// The ray.
    pub line: Line,
    /// The claim.
    pub claimed: Claimed,
}

/// Evaluations per ray: what takes more remains undecided.
const BUDGET: u32 = 4000;

/// Parts by which a distance in world units, plus 1, may be off: by a few roundings of the floats
/// in which it was computed.
fn rounding(scene: &Scene) -> f64 {
    if scene.double { 1e-12 } else { 1e-6 }
}

/// What is certain of a ray.
#[derive(Debug)]
struct Certain {
    /// Of the function's zeros.
    zeros: Certificate,
    /// Of the region's face, for a solid.
    face: Option<Entry>,
}

impl Certain {
    fn of(function: &Function, scene: &Scene, line: &Line) -> Self {
        let region = &scene.formula.region;
        let face = scene.formula.solid.then(|| function.entry(line, region)).flatten();
        Self { zeros: function.trace(line, region, BUDGET), face }
    }
}

/// Draws `scene` by `draw`, which gives the pixels or `None` if nothing can be drawn, and holds
/// each claim against what is certain of that ray. `defined` counts rays with a certain crossing.
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
    for pixel in &pixels {
        let certain = Certain::of(&function, scene, &pixel.line);
        tally.compared += 1;
        tally.defined += u64::from(certain.zeros.crossing.is_some());
        let Some(what) = contradiction(scene, pixel, &certain) else { continue };
        let [i, j] = pixel.place;
        return Err(Failure::new(format!(
            "{what}: {:?}, but {certain:?}\n{scene}\ncolumn {i}, row {j}: {}",
            pixel.claimed,
            describe(&pixel.line),
        )));
    }
    Ok(tally)
}

fn contradiction(scene: &Scene, pixel: &Pixel, certain: &Certain) -> Option<&'static str> {
    let Pixel { line, claimed, .. } = *pixel;
    let unit = line.direction.iter().fold(0.0_f64, |length, part| length.hypot(*part)).recip();
    let room = |distance: f64| rounding(scene) * (unit + distance);
    let passes = |at: f64, far: f64| at > far + room(far);
    if let Some(Entry { distance: (near, far), below: Some(true) }) = certain.face {
        return match claimed {
            Claimed::Miss => Some("a solid denied"),
            Claimed::Hit([at, _]) | Claimed::Undecided(at) if passes(at, far) => {
                Some("a solid passed over")
            }
            Claimed::Hit([_, at]) if at + room(at) < near => Some("a hit before the solid"),
            Claimed::Hit(_) | Claimed::Undecided(_) => None,
        };
    }
    let far = certain.zeros.crossing.map(|crossing| crossing.far);
    // Whether the face is part of the solid is known, or else does not matter.
    let known = !scene.formula.solid || certain.face.is_some_and(|face| face.below.is_some());
    match claimed {
        Claimed::Miss if far.is_some() => Some("a false miss"),
        Claimed::Hit(_) if known && certain.zeros.is_miss() => Some("a false hit"),
        Claimed::Hit([_, at]) if known && at + room(at) < certain.zeros.first() => {
            Some("a hit before any zero")
        }
        Claimed::Hit([at, _]) | Claimed::Undecided(at)
            if far.is_some_and(|far| passes(at, far)) =>
        {
            Some("a zero passed over")
        }
        Claimed::Miss | Claimed::Hit(_) | Claimed::Undecided(_) => None,
    }
}
