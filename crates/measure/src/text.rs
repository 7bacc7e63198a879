//! Measures as lines of text.

use crate::volume::Limit;
use crate::{Area, Inertia, Measured, Measures, Quantity, Request, Solid};
use std::fmt::Write;
use zeroset_interval::Interval;

/// The measures of one surface: a label of at most nine letters, and a value, as text.
fn rows(measures: &Measures, request: &Request<'_>) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let point = |of: &[Interval; 3]| of.map(digits).join(", ");
    let mut of_solid = |quantity: Quantity, label, value: String| {
        if request.has(quantity) {
            rows.push((label, value));
        }
    };
    if let Some(solid) = &measures.solid {
        of_solid(Quantity::Volume, "volume", bounds(solid));
    }
    if let Some(solid) = &measures.weighted {
        let doubt = if solid.may_lack_density {
            "; where the density has no value, it counts as 0"
        } else {
            ""
        };
        of_solid(Quantity::Mass, "mass", format!("{}{doubt}", bounds(solid)));
    }
    if let Some(Inertia { centroid, moments, products }) = measures.inertia() {
        of_solid(Quantity::Centroid, "centroid", point(&centroid));
        of_solid(Quantity::Inertia, "inertia", format!("xx, yy, zz: {}", point(&moments)));
        of_solid(Quantity::Inertia, "", format!("products yz, zx, xy: {}", point(&products)));
    }
    match &measures.ends {
        _ if !request.has(Quantity::Ends) => {}
        Some([low, high]) => {
            rows.push(("from", point(low)));
            rows.push(("to", point(high)));
        }
        None => rows.push(("from, to", "not proven".to_owned())),
    }
    let Measures { area, area_change, unproven, .. } = measures;
    let counts = measures.counts();
    if request.has(Quantity::Area) {
        let area = Interval { lo: area - area_change, hi: area + area_change };
        let estimated = match counts {
            Some(_) => format!("{}, estimated by two meshes", digits(area)),
            None => "not estimated: the mesh has no triangle".to_owned(),
        };
        rows.push((
            "area",
            match &measures.area_bounds {
                Some(bounds) => format!("{}; {estimated}", proven(bounds)),
                None => estimated,
            },
        ));
    }
    if request.has(Quantity::Shape) {
        let shape = counts.map(|counts| describe(measures, counts));
        rows.push((
            "shape",
            match (shape, unproven) {
                (Some(shape), 0) => format!("{shape}: proven"),
                (Some(shape), cells) => format!("{shape} in a mesh, not proven in {cells} cells"),
                (None, cells) => format!(
                    "not known: {cells} cells may hold a point of the surface, which may be \
                     thinner than these"
                ),
            },
        ));
    }
    rows
}

/// The bounds of a volume or a mass, and the reason why they are wider than requested.
fn bounds(solid: &Solid) -> String {
    let rest = match solid.limit {
        None => String::new(),
        Some(Limit::Boxes) => format!(" (not narrower, with {} boxes)", solid.boxes),
        Some(Limit::Rounding) => " (not narrower, because of rounding)".to_owned(),
    };
    format!("{}{rest}", digits(solid.volume))
}

/// The bounds of an area, and the reason why they are wider than requested.
fn proven(area: &Area) -> String {
    if !area.high.is_finite() {
        // Four digits, rounded down.
        let digits = 4 - area.low.max(f64::MIN_POSITIVE).log10().ceil() as i32;
        let unit = 10.0_f64.powi(digits.clamp(0, 18));
        return format!("at least {}", (area.low * unit).floor() / unit);
    }
    let rest = if area.is_limited {
        format!(" (not narrower, with {} boxes)", area.boxes)
    } else {
        String::new()
    };
    format!("{}{rest}", digits(Interval { lo: area.low, hi: area.high }))
}

/// The pieces of a surface and its hollows, in words.
fn describe(measures: &Measures, (solids, hollows): (usize, usize)) -> String {
    let pieces = &measures.shape.pieces;
    let of =
        |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
    let mut shape = of(solids, "piece");
    if hollows > 0 {
        shape = format!("{shape} with {}", of(hollows, "hollow"));
    }
    let genus: Option<Vec<String>> =
        pieces.iter().map(|piece| piece.genus.map(|genus| genus.to_string())).collect();
    match genus {
        Some(genus) if pieces.len() == 1 => format!("{shape}, genus {}", genus[0]),
        Some(genus) if !pieces.is_empty() && pieces.len() <= MOST_LISTED => {
            format!("{shape}, of genus {}", genus.join(", "))
        }
        None => format!("{shape} with a rim"),
        Some(_) => shape,
    }
}

/// Largest number of pieces whose genera are listed.
const MOST_LISTED: usize = 12;

/// The two ends of an interval, with as many digits as tell them apart, rounded outward.
fn digits(interval: Interval) -> String {
    let Interval { lo, hi } = interval;
    let width = hi - lo;
    if !width.is_finite() {
        return format!("{lo}..{hi}");
    }
    let size = lo.abs().max(hi.abs());
    // Two digits of the width. Below this, a digit of a float is no more than rounding.
    let least = width.max(size * 1e-15).max(f64::MIN_POSITIVE);
    let places = (1.0 - least.log10().floor()).clamp(0.0, 300.0) as usize;
    if size >= 1e9 || places > 18 {
        return format!("{lo:e}..{hi:e}");
    }
    let unit = 10.0_f64.powi(places as i32);
    // Adding 0 takes the sign from -0.
    let (lo, hi) = ((lo * unit).floor() / unit + 0.0, (hi * unit).ceil() / unit + 0.0);
    format!("{lo:.places$}..{hi:.places$}")
}

impl Measured {
    /// The measures as lines of text. `request` is the one by which they were computed.
    pub fn text(&self, request: &Request<'_>) -> String {
        let mut text = String::new();
        for (number, (name, measures)) in self.surfaces.iter().enumerate() {
            if self.surfaces.len() > 1 {
                let gap = if number > 0 { "\n" } else { "" };
                _ = writeln!(text, "{gap}{name}");
            }
            for (label, value) in rows(measures, request) {
                _ = writeln!(text, "{label:<12}{value}");
            }
        }
        text
    }
}
