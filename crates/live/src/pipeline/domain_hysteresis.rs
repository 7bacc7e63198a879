//! Automatic regions that follow sliders. The region changes rarely. So a surface visibly grows and
//! shrinks, and compiled code is reused.

use glam::DVec3;
use zeroset_scene::program::Program;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{HalfSpace, Region, RegionError};
use zeroset_syntax::{Document, Parameter};

/// A newly found region smaller than this share of the shown region replaces the shown region.
const LEAST_SHARE: f64 = 0.25;

/// Margin added where a region grows, as a share of the newly found region's extent.
const MARGIN: f64 = 0.25;

/// Code is compiled for the ranges of at most this many sliders.
const SLIDERS: usize = 4;

/// Code is compiled at most this far beyond the shown region, in half extents of that region.
const FARTHEST: f64 = 64.0;

/// Returns `region` with the clipping plane `clip` in place of its own, or without a plane.
///
/// # Errors
/// If the plane has no normal.
pub fn clipped(region: &Region, clip: Option<HalfSpace>) -> Result<Region, RegionError> {
    let clipped = view::clipped(region.low(), region.high(), region.ball().is_some(), clip)?;
    Ok(clipped.with_stretch(region.stretch()))
}

/// The region to show after `before`, when the values need the region `found`. If `before` has the
/// shape of `found`, contains `found` and is not much larger, the result is `before` with the
/// clipping plane of `found`.
///
/// # Errors
/// If `before` with that plane is not a valid region.
pub fn next_region(before: &Region, found: &Region) -> Result<Region, RegionError> {
    let is_round = found.ball().is_some();
    let enough = is_inside(found, before)
        && is_round == before.ball().is_some()
        && found.half_extent() >= LEAST_SHARE * before.half_extent();
    if enough {
        return clipped(before, found.clip());
    }
    let room = MARGIN * (found.high() - found.low());
    let low = DVec3::select(found.low().cmplt(before.low()), found.low() - room, found.low());
    let high = DVec3::select(found.high().cmpgt(before.high()), found.high() + room, found.high());
    let next = view::clipped(low, high, is_round, found.clip()).unwrap_or(*found);
    Ok(next.with_stretch(found.stretch()))
}

/// The regions found at both ends of the range of the slider `name`.
pub fn ends(
    document: &Document,
    name: &str,
    domain: DomainChoice,
    search: &mut Option<Program>,
    wanted: &dyn Fn() -> bool,
) -> Vec<Region> {
    let played = document.parameters.iter().find(|parameter| parameter.name == name);
    played.map_or_else(Vec::new, |slider| regions_at_ends(document, slider, domain, search, wanted))
}

/// The smallest region of the shape of `region` that holds `region` and `others`.
///
/// # Errors
/// If it is not a valid region.
pub fn with_ends(region: &Region, others: &[Region]) -> Result<Region, RegionError> {
    let low = others.iter().fold(region.low(), |low, other| low.min(other.low()));
    let high = others.iter().fold(region.high(), |high, other| high.max(other.high()));
    let whole = view::clipped(low, high, region.ball().is_some(), region.clip())?;
    Ok(whole.with_stretch(region.stretch()))
}

/// The regions found at both ends of a slider's range. At the very end of a range there may be no
/// surface.
fn regions_at_ends(
    document: &Document,
    parameter: &Parameter,
    domain: DomainChoice,
    search: &mut Option<Program>,
    wanted: &dyn Fn() -> bool,
) -> Vec<Region> {
    let ends = parameter.range.iter().flat_map(|(first, last)| [first, last]);
    let regions = ends.filter_map(|end| {
        let mut there = document.clone();
        there.parameters[parameter.number as usize].value = end.clone();
        let found = view::region_while(search, &there, domain, None, wanted);
        found.ok().flatten().map(|(region, _)| region)
    });
    regions.collect()
}

/// A box around the shown region and the regions found at the ends of sliders' ranges. Code
/// compiled for this box is meant to serve all values of the sliders.
pub fn code_region(
    shown: &Region,
    document: &Document,
    domain: DomainChoice,
    search: &mut Option<Program>,
    wanted: &dyn Fn() -> bool,
) -> Region {
    let moving =
        |parameter: &&Parameter| parameter.range.is_some() && !view::is_idle(document, parameter);
    let (mut low, mut high) = (shown.low(), shown.high());
    for parameter in document.parameters.iter().filter(moving).take(SLIDERS) {
        for region in regions_at_ends(document, parameter, domain, search, wanted) {
            let room = MARGIN * (region.high() - region.low());
            (low, high) = (low.min(region.low() - room), high.max(region.high() + room));
        }
    }
    let far = FARTHEST * shown.half_extent();
    let within = Region::new(low.max(shown.low() - far), high.min(shown.high() + far));
    within.unwrap_or(*shown)
}

fn is_inside(inner: &Region, outer: &Region) -> bool {
    outer.low().cmple(inner.low()).all() && inner.high().cmple(outer.high()).all()
}
