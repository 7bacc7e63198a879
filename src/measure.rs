//! Measures of scenes, and their settings.

use crate::error::Error;
use crate::settings::Domain;
use crate::text::Text;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use zeroset_interval::Interval;
use zeroset_measure::{MeasureError, Quantity, RELATIVE, Request, measures};
use zeroset_render::limit::{Limit, StopFlag};
use zeroset_scene::view::Clipping;

/// A measure that can be asked for, such as `"volume".parse::<Measure>()`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Measure(Quantity);

impl Measure {
    /// Returns all measures.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        Quantity::ALL.into_iter().map(Self)
    }

    /// Returns the name.
    pub fn name(self) -> &'static str {
        self.0.name()
    }
}

/// Parses a name. The error for an unknown name lists all names.
impl FromStr for Measure {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Quantity::named(name).map(Self).ok_or_else(|| {
            let names = Self::all().map(Self::name).collect::<Vec<_>>().join(", ");
            Error::argument(format!("'{name}' is not a measure: {names}"))
        })
    }
}

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
    density: Option<String>,
    only: Option<Vec<Measure>>,
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

    /// Sets the density of solids: a formula, in which names mean what they mean in the scene's
    /// text. It weights the mass, the centroid and the moments of inertia. Default: 1, and no mass.
    ///
    /// ```
    /// let ball = zeroset::Scene::read("x^2+y^2+z^2 <= 1")?;
    /// let settings = zeroset::MeasureSettings::new().density("x^2+y^2+z^2").relative(0.01);
    /// let mass = ball.measure(&settings.only(["mass".parse()?]))?[0].mass.clone();
    /// assert!(mass.expect("a solid").contains(&2.51327));
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn density(mut self, formula: impl Into<String>) -> Self {
        self.density = Some(formula.into());
        self
    }

    /// Computes these measures only; the others are `None`. Default: all.
    ///
    /// ```
    /// let volume = zeroset::MeasureSettings::new().only(["volume".parse()?]);
    /// let ball = zeroset::Scene::read("x^2+y^2+z^2 <= 1")?.measure(&volume)?;
    /// assert!(ball[0].volume.is_some() && ball[0].area.is_none());
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn only(mut self, measures: impl IntoIterator<Item = Measure>) -> Self {
        self.only = Some(measures.into_iter().collect());
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

/// The measures of one surface. Ranges are proven to hold the exact number. A measure that was not
/// [asked for](MeasureSettings::only) is `None`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Measures {
    /// The surface's formula as it was read, in one line.
    pub name: String,
    /// The volume, if the surface bounds a solid.
    pub volume: Option<RangeInclusive<f64>>,
    /// The mass, if there is a [density](MeasureSettings::density). Where this has no value, it
    /// counts as 0.
    pub mass: Option<RangeInclusive<f64>>,
    /// The centroid, if the volume or the mass is proven not to be 0.
    pub centroid: Option<[RangeInclusive<f64>; 3]>,
    /// The moments of inertia about the axes through the centroid along x, y and z. The density is
    /// 1 unless it is set.
    pub moments: Option<[RangeInclusive<f64>; 3]>,
    /// The least and the greatest coordinates along x, y and z. `None` if they are not proven.
    pub ends: Option<[[RangeInclusive<f64>; 3]; 2]>,
    /// The area, if [`MeasureSettings::only`] names it. The end is infinite if nothing bounds the
    /// area from above. `None` if the function has too many parts.
    pub area_bounds: Option<RangeInclusive<f64>>,
    /// The area of a mesh: an estimate, not a proof. `None` if the mesh has no triangle, and the
    /// surface is not proven empty.
    pub area: Option<f64>,
    /// The difference from the area of a coarser mesh.
    pub area_change: Option<f64>,
    /// The genus of each piece of a mesh, or `None` for one with a rim.
    pub genus: Option<Vec<Option<u32>>>,
    /// True if the surface is proven to have the pieces of the mesh.
    pub is_shape_proven: Option<bool>,
}

pub(crate) fn measured(text: &Text, settings: &MeasureSettings) -> Result<Vec<Measures>, Error> {
    let relative = settings.relative.unwrap_or(RELATIVE);
    if !(relative > 0.0 && relative.is_finite()) {
        return Err(Error::argument("relative must be a finite number above 0"));
    }
    let quantities: Vec<Quantity> = match &settings.only {
        Some(only) => only.iter().map(|measure| measure.0).collect(),
        None => Quantity::ALL.to_vec(),
    };
    let density = match &settings.density {
        Some(formula) => Some(text.expression(formula)?),
        None if settings.only.is_some() && quantities.contains(&Quantity::Mass) => {
            return Err(Error::argument("a mass needs a density"));
        }
        None => None,
    };
    let request = Request {
        quantities: &quantities,
        relative,
        density: density.as_ref(),
        has_area_bounds: settings.only.is_some(),
    };
    let wanted = settings.limit.wanted();
    let found =
        measures(&text.document, settings.domain.choice(), Clipping::default(), &request, &wanted);
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
        let solid = |quantity| of.solid.as_ref().filter(|_| request.has(quantity));
        let weighted = of.weighted.as_ref().filter(|_| request.has(Quantity::Mass));
        let inertia = |quantity| of.inertia().filter(|_| request.has(quantity));
        let ends = of.ends.filter(|_| request.has(Quantity::Ends));
        let has_area = request.has(Quantity::Area) && of.counts().is_some();
        let has_shape = request.has(Quantity::Shape);
        let genus = || of.shape.pieces.iter().map(|piece| piece.genus).collect();
        Measures {
            name,
            volume: solid(Quantity::Volume).map(|solid| range(solid.volume)),
            mass: weighted.map(|solid| range(solid.volume)),
            centroid: inertia(Quantity::Centroid).map(|inertia| inertia.centroid.map(range)),
            moments: inertia(Quantity::Inertia).map(|inertia| inertia.moments.map(range)),
            ends: ends.map(|ends| ends.map(|end| end.map(range))),
            area_bounds: of.area_bounds.map(|area| area.low..=area.high),
            area: has_area.then_some(of.area),
            area_change: has_area.then_some(of.area_change),
            genus: has_shape.then(genus),
            is_shape_proven: has_shape.then_some(of.unproven == 0),
        }
    });
    Ok(measures.collect())
}
