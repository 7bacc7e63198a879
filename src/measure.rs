//! Measures of scenes, and their settings.

use crate::error::Error;
use crate::settings::Domain;
use std::ops::RangeInclusive;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use zeroset_interval::Interval;
use zeroset_measure::{MeasureError, RELATIVE, measures};
use zeroset_render::limit::{Limit, StopFlag};
use zeroset_scene::view::Clipping;
use zeroset_syntax::Document;

/// Settings of measures, for [`Scene::measure`](crate::Scene::measure).
///
/// ```
/// let settings = zeroset::MeasureSettings::new().relative(1e-4);
/// # let _ = settings;
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct MeasureSettings {
    domain: Domain,
    relative: Option<f64>,
    limit: Limit,
}

impl MeasureSettings {
    /// Returns the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the box in which the surfaces are measured. Default: [`Domain::Text`]. Without a box in
    /// the text, the surfaces must be proven bounded.
    pub fn domain(mut self, domain: impl Into<Domain>) -> Self {
        self.domain = domain.into();
        self
    }

    /// Sets how narrow the bounds of a volume become, as a share of the volume. Must be above 0.
    /// Default: 0.001.
    pub fn relative(mut self, share: f64) -> Self {
        self.relative = Some(share);
        self
    }

    /// Limits the time. Measures that are not done in time are an error. Default: no limit.
    pub fn budget(mut self, time: Duration) -> Self {
        self.limit.budget = Some(time);
        self
    }

    /// Ends the work once the flag is set, with an error. Default: none.
    pub fn stop(mut self, flag: &'static AtomicBool) -> Self {
        self.limit.stop = Some(StopFlag(flag));
        self
    }
}

/// The measures of one surface. Ranges are proven to hold the exact number.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Measures {
    /// The surface's formula as it was read, in one line.
    pub name: String,
    /// The volume, if the surface bounds a solid.
    pub volume: Option<RangeInclusive<f64>>,
    /// The centroid, if the volume is proven not to be 0.
    pub centroid: Option<[RangeInclusive<f64>; 3]>,
    /// The moments of inertia about the axes through the centroid along x, y and z, for a density
    /// of 1.
    pub moments: Option<[RangeInclusive<f64>; 3]>,
    /// The least and the greatest coordinates along x, y and z. `None` if they are not proven.
    pub ends: Option<[[RangeInclusive<f64>; 3]; 2]>,
    /// The area of a mesh: an estimate, not a proof.
    pub area: f64,
    /// The difference from the area of a coarser mesh.
    pub area_change: f64,
    /// The genus of each piece of a mesh, or `None` for one with a rim.
    pub genus: Vec<Option<u32>>,
    /// True if the surface is proven to have the pieces of the mesh.
    pub is_shape_proven: bool,
}

pub(crate) fn measured(
    document: &Document,
    settings: &MeasureSettings,
) -> Result<Vec<Measures>, Error> {
    let relative = settings.relative.unwrap_or(RELATIVE);
    if !(relative > 0.0 && relative.is_finite()) {
        return Err(Error::argument("relative must be a finite number above 0"));
    }
    let wanted = settings.limit.wanted();
    let found =
        measures(document, settings.domain.choice(), Clipping::default(), relative, &wanted);
    let found = found.map_err(|error| match error {
        MeasureError::Scene(error) => Error::scene(error),
        MeasureError::Unbounded { .. } => {
            Error::argument(error.advise(&|ends| format!("the domain {ends}")))
        }
        error => Error::formula(error),
    })?;
    let Some(found) = found else {
        return Err(Error::unfinished("the measures were", &settings.limit));
    };
    let range = |bounds: Interval| bounds.lo..=bounds.hi;
    let measures = found.surfaces.into_iter().map(|(name, of)| {
        let inertia = of.solid.as_ref().and_then(zeroset_measure::Solid::inertia);
        Measures {
            name,
            volume: of.solid.map(|solid| range(solid.volume)),
            centroid: inertia.map(|inertia| inertia.centroid.map(range)),
            moments: inertia.map(|inertia| inertia.moments.map(range)),
            ends: of.ends.map(|ends| ends.map(|end| end.map(range))),
            area: of.area,
            area_change: of.area_change,
            genus: of.shape.pieces.iter().map(|piece| piece.genus).collect(),
            is_shape_proven: of.unproven == 0,
        }
    });
    Ok(measures.collect())
}
