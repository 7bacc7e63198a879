//! The proportions in which graphs are displayed. The heights of a graph z = f(x, y) may have
//! another unit than x and y. With one scale for all axes, it would then look like a plane or like
//! a needle.

use crate::domain::{GraphShape, differ};
use glam::DVec3;
use zeroset_space::Region;
use zeroset_syntax::{Document, Surface, SurfaceKind};

/// The displayed height of a stretched graph, as a share of its ground.
const HEIGHT: f64 = 0.4;

/// Largest number of surfaces in a document that is stretched.
const SURFACES: usize = 16;

/// Equations other than graphs are stretched if the extents of the domain differ by more than this
/// factor. Their true proportions would then be those of a needle.
const NEEDLE: f64 = 20.0;

/// Returns whether `document` consists of graphs z = f(x, y), and does not ask for equal axes.
pub fn may_stretch(document: &Document) -> bool {
    !document.picture.is_equal && are_graphs(document)
}

/// Returns whether `document` consists of equations, does not ask for equal axes, and would look
/// like a needle or like a plane in `region`.
pub fn is_needle(document: &Document, region: &Region) -> bool {
    let size = region.high() - region.low();
    let is_equation = |surface: &Surface| surface.kind == SurfaceKind::Equation;
    size.max_element() > NEEDLE * size.min_element()
        && !document.picture.is_equal
        && !document.surfaces.is_empty()
        && document.surfaces.iter().all(is_equation)
}

/// Returns whether the surfaces of `document` are graphs z = f(x, y).
pub fn are_graphs(document: &Document) -> bool {
    let is_graph = |surface: &Surface| {
        let shape = || GraphShape::of(&document.graph, surface.root, &[]);
        surface.kind == SurfaceKind::Equation && shape().is_over_ground()
    };
    (1..=SURFACES).contains(&document.surfaces.len()) && document.surfaces.iter().all(is_graph)
}

/// The factors by which lengths along the axes are multiplied for display: powers of two. All are 1
/// unless the extents of `region` differ much, and the document may be stretched.
pub fn stretch(region: &Region, may_stretch: impl FnOnce() -> bool) -> DVec3 {
    let size = region.high() - region.low();
    let ground = size.x.max(size.y);
    let is_uneven = differ(size.x, size.y) || differ(size.z, ground);
    if !is_uneven || region.ball().is_some() || !may_stretch() {
        return DVec3::ONE;
    }
    let mut stretch = DVec3::ONE;
    if differ(size.x, size.y) {
        let [x, y] = [size.x, size.y].map(|side| power_of_two(ground / side));
        (stretch.x, stretch.y) = (x, y);
    }
    if differ(size.z, ground) {
        stretch.z = power_of_two(HEIGHT * ground / size.z);
    }
    stretch
}

/// The power of two nearest to a positive ratio.
fn power_of_two(ratio: f64) -> f64 {
    ratio.log2().round().exp2()
}

/// One phrase that says how the axes are displayed. `None` if all are displayed alike.
pub fn description(region: &Region) -> Option<String> {
    let names = ["x", "y", "z"].into_iter().zip(region.stretch().to_array());
    let times = |(name, by): (&str, f64)| {
        let part = by.recip();
        match by {
            1.0 => None,
            by if by > 1.0 => Some(format!("{name} is stretched {by} times")),
            _ => Some(format!("{name} is shrunk to 1/{part}")),
        }
    };
    let all: Vec<String> = names.filter_map(times).collect();
    let phrase =
        || format!("{} for display: `aspect equal` shows true proportions", all.join(", "));
    (!all.is_empty()).then(phrase)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{DomainChoice, region};
    use zeroset_syntax::{Options, read};

    fn shown(text: &str) -> Region {
        let document = read(text, &Options::default()).expect(text);
        region(&document, DomainChoice::Document, None).expect(text).0
    }

    #[test]
    fn tall_and_flat_graphs_are_shown_whole_and_two_fifths_as_high_as_wide() {
        for (text, low, high) in [
            ("z = 1000 sin x", -1000.0, 1000.0),
            ("z = 0.001 x^2", 0.0, 0.004),
            ("z = 1e-6 x*y", -4e-6, 4e-6),
            ("z = 1000x^2 + y^2", 0.0, 4004.0),
            ("z = 100exp(-x^2-y^2)", 0.0335, 100.0),
        ] {
            let region = shown(text);
            let size = region.displayed().high() - region.displayed().low();
            assert!(region.low().z <= low && high <= region.high().z, "{text}: {region:?}");
            let ratio = size.z / size.x.max(size.y);
            assert!((0.28..0.58).contains(&ratio), "{text}: {ratio}");
            let rounded = region.stretch().z.log2();
            assert_eq!(rounded, rounded.round(), "{text}");
        }
    }

    #[test]
    fn most_heights_beside_poles_are_shown() {
        for (text, far) in [
            ("z = tan(40x)", 2.0),
            ("z = tan(1000x)", 2.0),
            ("z = tan(1e6 x)", 2.0),
            ("z = 1/sin(1000x)", 2.0),
            ("z = 1000/(x-0.3)", 100.0),
            ("z = 1000/x", 100.0),
            ("z = tan(50x) + y", 2.0),
            // Every second point of the grid lies at a pole.
            ("z = tan(x + y) + tan(8x + 8y)", 2.0),
            ("z = tan(3x + 3y)", 2.0),
            // All points of the first grid lie at poles.
            ("z = 1/sin(16 pi x)", 1.0),
            ("z = 2/sin(64 pi y)", 2.0),
            ("z = 1/(sin(7x) + sin(7y))", 0.8),
        ] {
            let (low, high) = (shown(text).low().z, shown(text).high().z);
            let is_fit = |end: f64| (far..6.0 * far).contains(&end);
            assert!(is_fit(-low) && is_fit(high), "{text}: {low} to {high}");
        }
    }

    #[test]
    fn other_surfaces_and_equal_axes_are_not_stretched() {
        for text in [
            "aspect equal\nz = 1000 sin x",
            "domain x in [-1, 1], y in [-1, 1], z in [-9, 9]\nx^2+y^2 = 1",
            "domain x in [-1, 1], y in [-1, 1], z in [-9, 9]\nz = x*y*z",
            "z = x^2 + y^2",
            "z = ln(x)",
            "z = 1000 sin x\nx^2+y^2+z^2 = 1",
        ] {
            assert_eq!(shown(text).stretch(), DVec3::ONE, "{text}");
        }
        let tall = "domain x in [-2, 2], y in [-2, 2], z in [-200, 200]\n";
        let needle = DVec3::new(1.0, 1.0, 1.0 / 256.0);
        assert_eq!(shown(&format!("{tall}x*y*z = 1")).stretch(), needle);
        for text in ["aspect equal\nx*y*z = 1", "x^2+y^2 <= 1", "x^2+y^2 = 1\nx^2+y^2 <= 1"] {
            assert_eq!(shown(&format!("{tall}{text}")).stretch(), DVec3::ONE, "{text}");
        }
        // A point does not change how a graph looks.
        let graph = "domain x in [-1, 1], y in [-1, 1], z in [-90, 90]\nz = 80 x y";
        assert_eq!(shown(&format!("{graph}\npoint (0, 0, 9)")).stretch(), shown(graph).stretch());
        let given = shown("domain x in [-1, 1], y in [-1, 1], z in [-90, 90]\nz = 80 x y");
        assert_eq!(given.stretch(), DVec3::new(1.0, 1.0, 1.0 / 256.0));
        assert_eq!(
            description(&given).as_deref(),
            Some("z is shrunk to 1/256 for display: `aspect equal` shows true proportions")
        );
    }
}
