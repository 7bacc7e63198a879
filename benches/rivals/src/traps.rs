//! Surfaces whose shape samples miss: pieces and Euler numbers of zeroset's meshes and of fidget's,
//! beside the true ones.

use crate::meshes::{Dual, Ours, Triangles, tree_of};
use crate::side::Side;
use crate::surfaces::{Surface, View};
use anyhow::Result;
use clap::Args;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

/// Arguments of `traps`.
#[derive(Args)]
pub struct TrapsArguments {
    /// Depth of fidget's octree
    #[arg(long, default_value_t = 8)]
    depth: u8,
}

/// A surface with its number of pieces and its Euler number.
struct Trap {
    name: &'static str,
    text: &'static str,
    half: f64,
    shape: [i64; 2],
}

const fn trap(name: &'static str, text: &'static str, half: f64, shape: [i64; 2]) -> Trap {
    Trap { name, text, half, shape }
}

/// Sheets are discs, whose Euler number is 1.
const TRAPS: [Trap; 10] = [
    trap("two sheets 1e-4 apart", "(z-0.3)*(z-0.3001) = 0", 1.0, [2, 2]),
    trap("tunnel of radius 1e-3", "max(x^2+y^2+z^2-1, 1e-6-x^2-y^2) <= 0", 1.3, [1, 0]),
    trap("sphere of radius 1e-4", "(x-0.3)^2+(y-0.2)^2+(z-0.1)^2 = 1e-8", 2.0, [1, 2]),
    trap("torus of radius 1e-3", "(sqrt(x^2+y^2)-1)^2+z^2 = 1e-6", 1.3, [1, 0]),
    trap(
        "balls 1e-4 apart",
        "(x-0.50005)^2+y^2+z^2 <= 0.25 or (x+0.50005)^2+y^2+z^2 <= 0.25",
        1.3,
        [2, 4],
    ),
    trap("wall of 1e-4", "abs(x^2+y^2+z^2-0.8) <= 1e-4", 1.3, [2, 4]),
    trap("neck", "(x^2+y^2+z^2)^2-2*(x^2-y^2-z^2) = 1e-5", 1.5, [1, 2]),
    trap("gap", "(x^2+y^2+z^2)^2-2*(x^2-y^2-z^2) = -1e-5", 1.5, [2, 4]),
    trap("pole", "z = 1/x", 2.0, [2, 2]),
    trap(
        "bubble of radius 2e-4",
        "max(x^2+y^2+z^2-1, 4e-8-(x-0.3)^2-(y-0.2)^2-(z-0.1)^2) <= 0",
        1.3,
        [2, 4],
    ),
];

/// Number of pieces, and corners minus edges plus triangles.
fn shape(triangles: &Triangles) -> [i64; 2] {
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let mut edges = HashSet::new();
    let mut parents: Vec<usize> = Vec::new();
    for triangle in &triangles.0 {
        let corners = triangle.map(|corner| {
            let next = numbers.len();
            *numbers.entry(corner.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next)
        });
        parents.extend(parents.len()..numbers.len());
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|corner| corners[corner])) {
            edges.insert([a.min(b), a.max(b)]);
            let (from, to) = (root(&mut parents, a), root(&mut parents, b));
            parents[from] = to;
        }
    }
    let pieces = (0..parents.len()).filter(|number| parents[*number] == *number).count();
    let euler = numbers.len() as i64 - edges.len() as i64 + triangles.0.len() as i64;
    [pieces as i64, euler]
}

fn root(parents: &mut [usize], mut number: usize) -> usize {
    while parents[number] != number {
        parents[number] = parents[parents[number]];
        number = parents[number];
    }
    number
}

/// Meshes all surfaces, and prints a table.
///
/// # Errors
/// If a surface is not valid, or a side makes no mesh.
pub fn run(arguments: &TrapsArguments) -> Result<()> {
    println!(
        "pieces and Euler number; zeroset at its default tolerance, a thousandth of the diagonal\n"
    );
    let dual = format!("fidget {}³", 1_u32 << arguments.depth);
    println!("{:24}{:>8}{:>12}{:>10}{dual:>14}", "surface", "true", "zeroset", "unproven");
    for trap in &TRAPS {
        let surface = Surface {
            name: Cow::Borrowed(trap.name),
            half: trap.half,
            is_cut: false,
            view: View::Oblique,
            text: Cow::Owned(format!("{}\ndomain {}", trap.text, trap.half)),
        };
        let document = surface.document()?;
        let tolerance = 2.0 * trap.half * 3f64.sqrt() / 1000.0;
        let mut ours = Ours::new(&document, &surface, tolerance, false);
        ours.draw()?;
        let mut dual = Dual::new(tree_of(&document)?, trap.half, arguments.depth);
        dual.draw()?;
        let text = |[pieces, euler]: [i64; 2]| format!("{pieces}, {euler}");
        println!(
            "{:24}{:>8}{:>12}{:>10}{:>14}",
            trap.name,
            text(trap.shape),
            text(shape(&ours.mesh)),
            ours.unproven,
            text(shape(&dual.mesh)),
        );
    }
    Ok(())
}
