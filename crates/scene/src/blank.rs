//! Why a picture shows nothing, and where there is something to see.
//!
//! This module depends neither on flags nor on commands: the caller supplies the text that sets a
//! domain.

use crate::coordinate::coordinate;
use crate::domain::{AutoDomain, REACH};
use crate::view;
use zeroset_space::Region;
use zeroset_syntax::Document;

/// Advice for distance estimators.
const NO_ZERO: &str = "; a distance estimator may stay above 0: subtract 0.001 from its result";

/// The reason why a picture shows nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blank {
    /// The document hides every surface and every curve.
    Hidden,
    /// The document has no surface, and no curve is in the region.
    NoCurve,
    /// The function has no value anywhere in the domain.
    Undefined,
    /// The region lies within ±[`REACH`], where the surface is proven to have no point.
    Empty {
        /// As in [`Self::Missed`].
        is_estimator: bool,
    },
    /// The surface is proven to lie in this domain, which does not meet the region.
    Elsewhere(AutoDomain),
    /// Every ray misses the surface: because of the camera, because the surface is small or thin,
    /// or because it has no point in the region.
    Missed {
        /// A domain that may show more of it.
        found: Option<AutoDomain>,
        /// True if the function may be a distance estimator, which comes near 0 and has no zero.
        is_estimator: bool,
    },
}

impl Blank {
    /// Finds out why nothing of `document` is visible in `region`. `undefined` is true if the
    /// function has no value in the region. `searched` is the result of an earlier search for a
    /// domain, if there was such a search.
    pub fn find(
        document: &Document,
        region: &Region,
        undefined: bool,
        searched: Option<AutoDomain>,
    ) -> Self {
        let mut curves = document.curves.all.iter();
        let mut surfaces = document.drawn_surfaces();
        if surfaces.all(|surface| surface.hidden) && curves.all(|one| one.hidden) {
            return Self::Hidden;
        }
        if document.surfaces.is_empty() && document.patches.is_empty() {
            return Self::NoCurve;
        }
        if undefined {
            return Self::Undefined;
        }
        let within = region.low().abs().max(region.high().abs()).max_element() <= REACH;
        // Programs of shaders have y as upward direction.
        let is_estimator = document.is_y_up;
        match searched.or_else(|| view::search(document).ok()) {
            Some(found) if found.finding.is_empty() && within => Self::Empty { is_estimator },
            Some(found) if found.finding.is_bounded() && is_apart(&found, region) => {
                Self::Elsewhere(found)
            }
            Some(found) if !found.finding.is_empty() && differs(&found, region) => {
                Self::Missed { found: Some(found), is_estimator: false }
            }
            _ => Self::Missed { found: None, is_estimator },
        }
    }

    /// Describes the reason in one phrase, with advice if there is any. `domain` turns bounds of x,
    /// y and z into the text that sets them.
    pub fn describe(&self, domain: &dyn Fn(&str) -> String) -> String {
        match self {
            Self::Hidden => "nothing is seen: every surface is hidden".to_owned(),
            Self::NoCurve => "nothing is seen: no curve and no point is in the domain".to_owned(),
            Self::Undefined => {
                "nothing is seen: the function has no value anywhere in the domain".to_owned()
            }
            Self::Empty { is_estimator } => {
                let advice = if *is_estimator { NO_ZERO } else { "" };
                format!("nothing is seen: the surface is proven empty up to ±1e12{advice}")
            }
            Self::Elsewhere(found) => {
                let place = domain(&ends(found));
                format!("nothing is seen here; the surface lies elsewhere: try {place}")
            }
            Self::Missed { found, is_estimator } => {
                let advice = found.map(|found| format!("; try {}", domain(&ends(&found))));
                let or_else = if *is_estimator { NO_ZERO } else { "" };
                let advice = advice.as_deref().unwrap_or(or_else);
                format!("nothing is seen: every ray is proven to miss{advice}")
            }
        }
    }
}

/// The six bounds of a domain, with commas between.
pub fn ends(found: &AutoDomain) -> String {
    let range = |axis: usize| [found.low[axis], found.high[axis]].map(coordinate).join(",");
    [0, 1, 2].map(range).join(",")
}

/// Returns whether the found domain has no point in common with the region.
fn is_apart(found: &AutoDomain, region: &Region) -> bool {
    let (low, high) = (region.low(), region.high());
    (0..3).any(|axis| found.high[axis] < low[axis] || found.low[axis] > high[axis])
}

/// Returns whether the found domain reaches beyond the region, or is so small that its contents may
/// fall between pixels.
fn differs(found: &AutoDomain, region: &Region) -> bool {
    let (low, high) = (region.low(), region.high());
    let beyond = (0..3).any(|axis| found.low[axis] < low[axis] || found.high[axis] > high[axis]);
    let largest = (0..3).map(|axis| found.high[axis] - found.low[axis]).fold(0.0, f64::max);
    beyond || largest < LOST * (high - low).max_element()
}

/// A domain is small if its longest side is below this share of the region's.
const LOST: f64 = 1.0 / 64.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{DomainChoice, region};
    use zeroset_syntax::{Options, read};

    fn why(text: &str, half: f64) -> String {
        let document = read(text, &Options::default()).expect("reads");
        let bounds = DomainChoice::Bounds([-half, half, -half, half, -half, half]);
        let (region, _) = region(&document, bounds, None).expect("valid");
        Blank::find(&document, &region, false, None).describe(&|ends| format!("--domain {ends}"))
    }

    #[test]
    fn a_blank_picture_says_why_and_where_there_is_something() {
        let far = why("(x-300)^2+y^2+z^2=1", 2.0);
        assert!(far.contains("--domain 298.") && far.contains(",301."), "{far}");
        assert!(far.contains("the surface lies elsewhere"), "{far}");
        assert!(why("hidden\nz=1", 2.0).contains("every surface is hidden"));
        assert!(why("z=5", 2.0).contains("4,6"), "{}", why("z=5", 2.0));
        assert!(why("z=12345.678", 2.0).contains("12344.68,12346.68"));
        assert!(why("x^2+y^2+z^2=-1", 2.0).contains("proven empty"));
        assert!(why("x^2+y^2+z^2=1", 2.0).ends_with("every ray is proven to miss"));
        let estimator = "float map(vec3 p) { return sqrt(dot(p, p) + 0.0001) * 0.5; }";
        assert!(why(estimator, 2.0).ends_with("subtract 0.001 from its result"));
        let touching = "float map(vec3 p) { return length(p); }";
        assert!(why(touching, 2.0).contains("subtract 0.001"), "{}", why(touching, 2.0));
    }

    /// A surface lies elsewhere only if that is proven.
    #[test]
    fn a_surface_that_may_be_in_the_region_lies_nowhere_else() {
        for text in ["x^2+y^2+z^2=1e-8", "(z-0.001)*(z-0.002)=0", "x*y*z=1", "x*y*z=9", "z=5"] {
            let said = why(text, 2.0);
            assert!(said.contains("every ray is proven to miss; try --domain "), "{text}: {said}");
        }
        // The box of the sphere only touches the region.
        let said = why("(x-3)^2+y^2+z^2=1", 2.0);
        assert!(!said.contains("elsewhere"), "{said}");
    }
}
