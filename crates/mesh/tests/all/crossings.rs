//! Triangles of a proven mesh meet in corners and edges that they share, and nowhere else.

use crate::mesh_with;
use glam::DVec3;
use zeroset_space::Region;
use zeroset_testkit::{Effort, Rng, Solid, crossings, random_solid};

/// Limits the time of a case.
const MOST_CELLS: usize = 20_000;

#[test]
fn triangles_of_proven_meshes_do_not_cross() {
    let Effort { seed, cases } = Effort::from_environment(0x7e7a, 150);
    let (mut proven, mut crossing, mut flat, mut empty) = (0, 0, 0, 0);
    for case in seed..seed + cases {
        let Solid { text, half, tolerance } = random_solid(&mut Rng::with_seed(case));
        let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a region");
        let mesh = mesh_with(&text, region, tolerance, MOST_CELLS);
        empty += u64::from(mesh.triangles.is_empty());
        if !mesh.is_proven() {
            continue;
        }
        proven += 1;
        let vertices: Vec<[f64; 3]> = mesh.vertices.iter().map(|at| at.to_array()).collect();
        let found = crossings(&vertices, &mesh.triangles);
        if !found.pairs.is_empty() || !found.flat.is_empty() {
            let (pairs, flat) = (found.pairs.len(), found.flat.len());
            println!(
                "seed {case:#x}: {pairs} pairs cross, {flat} flat of {}: zeroset mesh '{text}' \
                 --domain={half} --tolerance {tolerance} --strict -o a.ply",
                mesh.triangles.len()
            );
        }
        crossing += u64::from(!found.pairs.is_empty());
        flat += u64::from(!found.flat.is_empty());
    }
    println!("{cases} solids, {empty} empty, {proven} proven, {crossing} cross, {flat} flat");
    assert_eq!((crossing, flat), (0, 0));
    assert!(3 * proven > 2 * cases, "{proven} of {cases} meshes are proven");
}
