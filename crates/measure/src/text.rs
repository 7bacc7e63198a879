//! Measures as lines of text.

use crate::{Inertia, Measured, Measures};
use std::fmt::Write;
use zeroset_interval::Interval;

/// The measures of one surface: a label of at most nine letters, and a value, as text. `relative`
/// is the requested width of the volume's bounds, as a share of the volume.
fn rows(measures: &Measures, relative: f64) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let point = |of: &[Interval; 3]| of.map(digits).join(", ");
    if let Some(solid) = &measures.solid {
        let volume = solid.volume;
        let is_wide = volume.width() > 1.01 * relative * volume.lo;
        let rest = if is_wide { " (not narrower, with a million boxes)" } else { "" };
        rows.push(("volume", format!("{}{rest}", digits(volume))));
        if let Some(Inertia { centroid, moments, products }) = solid.inertia() {
            rows.push(("centroid", point(&centroid)));
            rows.push(("inertia", format!("xx, yy, zz: {}", point(&moments))));
            rows.push(("", format!("products yz, zx, xy: {}", point(&products))));
        }
    }
    match &measures.ends {
        Some([low, high]) => {
            rows.push(("from", point(low)));
            rows.push(("to", point(high)));
        }
        None => rows.push(("from, to", "not proven".to_owned())),
    }
    let Measures { area, area_change, unproven, .. } = measures;
    let Some(counts) = measures.counts() else {
        rows.push(("area", "not estimated: the mesh has no triangle".to_owned()));
        let cells = format!("{unproven} cells may hold a point of the surface");
        rows.push(("shape", format!("not known: {cells}, which may be thinner than these")));
        return rows;
    };
    let area = Interval { lo: area - area_change, hi: area + area_change };
    rows.push(("area", format!("{}, estimated by two meshes", digits(area))));
    let shape = describe(measures, counts);
    rows.push((
        "shape",
        match unproven {
            0 => format!("{shape}: proven"),
            cells => format!("{shape} in a mesh, not proven in {cells} cells"),
        },
    ));
    rows
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
    /// The measures as lines of text. `relative` is as for `measures`.
    pub fn text(&self, relative: f64) -> String {
        let mut text = String::new();
        for (number, (name, measures)) in self.surfaces.iter().enumerate() {
            if self.surfaces.len() > 1 {
                let gap = if number > 0 { "\n" } else { "" };
                _ = writeln!(text, "{gap}{name}");
            }
            for (label, value) in rows(measures, relative) {
                _ = writeln!(text, "{label:<12}{value}");
            }
        }
        text
    }
}
