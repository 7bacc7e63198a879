//! Checks a picture's claims about its rays by the certified tracer.

use super::scene::{Scene, describe};
use crate::certified::{BoxEntry, Certificate, Function, Line};
use crate::suite::{Failure, Tally};

/// A picture's claim about one ray. Distances are multiples of the line's direction. For a solid,
/// points where its inside meets the region's faces count as zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RayClaim {
    /// There is no zero.
    Miss,
    /// The first zero lies between these distances.
    Hit([f64; 2]),
    /// There is no zero before this distance.
    Undecided(f64),
}

/// A pixel's ray, and the claim about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Column and row of the pixel.
    pub place: [usize; 2],
    /// The pixel's ray.
    pub line: Line,
    /// The picture's claim about the ray.
    pub claimed: RayClaim,
    /// For a hit: the number of the painted surface, and the bracket of the hit's distance.
    pub hit: Option<(usize, [f64; 2])>,
}

/// Evaluations per ray. A ray that needs more remains undecided.
const BUDGET: u32 = 4000;

/// Returns the tolerance τ: a distance d in world units may be off by τ·(d + 1). It allows for a
/// few roundings in the picture's precision.
fn rounding(scene: &Scene) -> f64 {
    if scene.precision == "f64" { 1e-12 } else { 1e-6 }
}

/// Proven statements about a surface on a ray.
#[derive(Debug)]
struct SurfaceCertificate {
    /// The zeros of the function.
    zeros: Certificate,
    /// For a solid: the place where the ray enters the region.
    face: Option<BoxEntry>,
    /// False if it is uncertain whether the ray enters the region inside the solid.
    known: bool,
}

impl SurfaceCertificate {
    fn of((function, solid): &(Function, bool), region: &[[f64; 2]; 3], line: &Line) -> Self {
        let face = solid.then(|| function.entry(line, region)).flatten();
        let known = !solid || face.is_some_and(|face| face.below.is_some());
        Self { zeros: function.trace(line, region, BUDGET), face, known }
    }

    /// Returns bounds of the distance at which the ray enters the region, if the entry is certainly
    /// inside the solid.
    fn capped(&self) -> Option<(f64, f64)> {
        self.face.filter(|face| face.below == Some(true)).map(|face| face.distance)
    }

    /// Returns a distance before which the ray certainly does not meet the surface.
    fn first(&self) -> f64 {
        let beyond = if self.known { self.zeros.first() } else { f64::NEG_INFINITY };
        self.capped().map_or(beyond, |(near, _)| near)
    }

    /// Returns a distance before which the ray certainly meets the surface.
    fn last(&self) -> f64 {
        let crossing = self.zeros.crossing.map_or(f64::INFINITY, |crossing| crossing.far);
        self.capped().map_or(crossing, |(_, far)| far)
    }
}

/// Draws `scene` by `draw`, which returns the pixels, or `None` if nothing can be drawn. Checks
/// each pixel's claim by the certified tracer. In the tally, `defined` counts rays with a certain
/// crossing.
///
/// # Errors
/// The first false claim.
pub fn picture(
    scene: &Scene,
    draw: &dyn Fn(&Scene) -> Option<Vec<Pixel>>,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let Some(pixels) = draw(scene) else { return Ok(tally) };
    let (functions, region) = (scene.formula.functions(), &scene.formula.region);
    for pixel in &pixels {
        let of = |function| SurfaceCertificate::of(function, region, &pixel.line);
        let certain: Vec<SurfaceCertificate> = functions.iter().map(of).collect();
        tally.compared += 1;
        tally.defined += u64::from(certain.iter().any(|one| one.zeros.crossing.is_some()));
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

fn contradiction(
    scene: &Scene,
    pixel: &Pixel,
    certain: &[SurfaceCertificate],
) -> Option<&'static str> {
    let Pixel { line, claimed, hit, .. } = *pixel;
    let unit = line.direction.iter().fold(0.0_f64, |length, part| length.hypot(*part)).recip();
    let slack = |distance: f64| rounding(scene) * (unit + distance);
    let is_before = |near: f64, far: f64| near + slack(near) < far;
    let is_behind = |near: f64, far: f64| near > far + slack(far);
    let first = certain.iter().map(SurfaceCertificate::first).fold(f64::INFINITY, f64::min);
    let last = certain.iter().map(SurfaceCertificate::last).fold(f64::INFINITY, f64::min);
    match claimed {
        RayClaim::Miss if last < f64::INFINITY => return Some("a false miss"),
        RayClaim::Hit(_) if first == f64::INFINITY => return Some("a false hit"),
        RayClaim::Hit([_, at]) if is_before(at, first) => return Some("a hit before any zero"),
        RayClaim::Hit([at, _]) | RayClaim::Undecided(at) if is_behind(at, last) => {
            return Some("a zero passed over");
        }
        RayClaim::Miss | RayClaim::Hit(_) | RayClaim::Undecided(_) => {}
    }
    let (surface, [near, far]) = hit?;
    let Some(painted) = certain.get(surface) else { return Some("no such surface") };
    let is_there = !is_before(far, painted.first()) && !is_behind(near, painted.last());
    (!is_there).then_some("another surface is painted")
}
