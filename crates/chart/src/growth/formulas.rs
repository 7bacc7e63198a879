//! Formulas of every size: those of the gallery, and generated sums and products.

use crate::error::ChartError;
use crate::surfaces::ChartSurface;
use crate::views::rng;
use fastrand::Rng;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use zeroset_scene::gallery::examples;
use zeroset_space::Region;

/// Origin of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FormulaSource {
    /// An example of the gallery.
    Gallery,
    /// A sum of squares of linear functions.
    Sum,
    /// A product of linear functions.
    Product,
}

/// Nodes per term of a sum: four numbers, three products, three sums, a square, and a sum of terms.
const NODES: usize = 12;
/// Ratio of successive sizes.
const STEP: f64 = 1.5;

/// The gallery's formulas, and sums and products of up to about `nodes` nodes.
///
/// # Errors
/// If an example has no domain.
pub fn all(nodes: usize, seed: u64) -> Result<Vec<(FormulaSource, ChartSurface)>, ChartError> {
    let mut all = Vec::new();
    for example in examples() {
        all.push((FormulaSource::Gallery, ChartSurface::read(example.slug, example.text, None)?));
    }
    let (mut terms, most) = (1, (nodes / NODES).max(1));
    loop {
        for source in [FormulaSource::Sum, FormulaSource::Product] {
            all.push((source, generated(source, terms, seed)?));
        }
        if terms == most {
            return Ok(all);
        }
        terms = ((terms as f64 * STEP).ceil() as usize).min(most);
    }
}

/// A sum or product of `terms` different linear functions. Their values on the domain are within
/// [−1, 1], so that no bounds of a product become infinite.
fn generated(source: FormulaSource, terms: usize, seed: u64) -> Result<ChartSurface, ChartError> {
    let name = format!("{source:?}-{terms}").to_lowercase();
    let mut rng = rng(&format!("{seed} {name}"));
    let linear: Vec<String> = (0..terms).map(|_| format!("({})", linear(&mut rng))).collect();
    let text = match source {
        FormulaSource::Sum => format!("{}^2 - {terms}/8", linear.join("^2 + ")),
        FormulaSource::Product | FormulaSource::Gallery => linear.join("*"),
    };
    let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0))
        .map_err(ChartError::of_surface(&name))?;
    ChartSurface::read(&name, &text, Some(region))
}

/// A random linear function whose values on the cube from −1 to 1 are within [−1, 1].
fn linear(rng: &mut Rng) -> String {
    let mut part = || format!("0.{}", rng.u32(100_000..=250_000));
    let (a, b, c, d) = (part(), part(), part(), part());
    let mut sign = || if rng.bool() { "+" } else { "-" };
    let (first, second, third) = (sign(), sign(), sign());
    format!("{a}*x {first} {b}*y {second} {c}*z {third} {d}")
}
