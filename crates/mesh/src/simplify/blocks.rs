//! Removing edges in many blocks of space at once.
//!
//! In a block, only triangles change that are strictly inside, and all that they sweep is inside,
//! too. Blocks do not overlap. So the changes of two blocks have nothing in common.

use crate::index::Bounds;
use crate::simplify::reduction::Reduction;
use crate::simplify::triangulation::Triangulation;
use glam::I64Vec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Number of triangles from which on a block is divided.
const LARGE: usize = 12_000;

/// A part of a mesh, with the numbers that its vertices and triangles have in the whole.
struct Part {
    mesh: Triangulation,
    vertices: Vec<u32>,
    triangles: Vec<u32>,
}

/// Removes edges within blocks. Few edges are left, but for those near blocks' faces.
pub fn reduce(whole: &mut Reduction<'_>, wanted: &(dyn Fn() -> bool + Sync)) -> Option<()> {
    let all: Vec<(u32, Bounds)> =
        whole.mesh.present().map(|one| (one, whole.mesh.bounds(one))).collect();
    if all.len() <= LARGE {
        return Some(());
    }
    let setting = whole.setting;
    let mut blocks = Vec::new();
    let everything = Bounds { low: I64Vec3::splat(-1), high: I64Vec3::splat(i64::MAX / 2) };
    divide(all, everything, &mut blocks);
    let parts: Option<Vec<Part>> = blocks
        .into_par_iter()
        .map(|(block, numbers)| {
            let Part { mesh, vertices, triangles } = part(&whole.mesh, numbers);
            let mut reduction = Reduction::new(setting, mesh);
            reduction.within = Some(block);
            reduction.pass(wanted)?;
            Some(Part { mesh: reduction.mesh, vertices, triangles })
        })
        .collect();
    let mesh = &mut whole.mesh;
    for Part { mesh: part, vertices, triangles } in parts? {
        for (number, vertex) in vertices.iter().enumerate().filter(|(k, _)| part.stamps[*k] > 0) {
            mesh.places[*vertex as usize] = part.places[number];
            mesh.quadrics[*vertex as usize] = part.quadrics[number];
            mesh.shares[*vertex as usize] = part.shares[number];
        }
        for number in part.changed() {
            let corners = part.corners(number);
            let corners = part.has(number).then(|| corners.map(|one| vertices[one as usize]));
            mesh.replace(triangles[number as usize], corners);
        }
    }
    mesh.connect();
    Some(())
}

/// Divides a block at the middle triangle, again and again.
fn divide(mut triangles: Vec<(u32, Bounds)>, block: Bounds, blocks: &mut Vec<(Bounds, Vec<u32>)>) {
    if triangles.len() <= LARGE {
        blocks.push((block, triangles.into_iter().map(|(number, _)| number).collect()));
        return;
    }
    let all = triangles.iter().flat_map(|(_, bounds)| [bounds.low, bounds.high]);
    let around = Bounds::of(all);
    let spans = around.high.min(block.high) - around.low.max(block.low);
    let axis = (0..3).max_by_key(|axis| spans[*axis]).unwrap_or(0);
    let middle = triangles.len() / 2;
    let (_, (_, at), _) = triangles.select_nth_unstable_by_key(middle, |(_, one)| one.low[axis]);
    let cut = at.low[axis];
    let (mut left, mut right) = (block, block);
    (left.high[axis], right.low[axis]) = (cut, cut);
    let within = |block: &Bounds| -> Vec<(u32, Bounds)> {
        triangles.iter().filter(|(_, bounds)| bounds.meets(block)).copied().collect()
    };
    let halves = [within(&left), within(&right)];
    // Triangles may be as large as the block.
    if halves.iter().any(|half| half.len() as f64 > 0.9 * triangles.len() as f64) {
        blocks.push((block, triangles.into_iter().map(|(number, _)| number).collect()));
        return;
    }
    for (half, block) in halves.into_iter().zip([left, right]) {
        divide(half, block, blocks);
    }
}

/// A part of a mesh.
fn part(mesh: &Triangulation, triangles: Vec<u32>) -> Part {
    let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
    let mut vertices = Vec::new();
    let corners = triangles.iter().map(|triangle| {
        mesh.corners(*triangle).map(|vertex| {
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                (vertices.len() - 1) as u32
            })
        })
    });
    let corners = corners.collect();
    let places = vertices.iter().map(|vertex| mesh.place(*vertex)).collect();
    let mut part = Triangulation::new(places, corners);
    part.quadrics = vertices.iter().map(|vertex| mesh.quadrics[*vertex as usize]).collect();
    part.shares = vertices.iter().map(|vertex| mesh.shares[*vertex as usize]).collect();
    Part { mesh: part, vertices, triangles }
}
