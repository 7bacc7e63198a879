//! Moves of the vertex in the middle of eight cubes, some of which are solid.

use super::*;
use std::collections::HashMap;
use zeroset_testkit::{Crossings, crossings};

/// Length of a cube's edge, in units.
const EDGE: i64 = 1 << 20;
/// Steps of a move: all places on the way are whole numbers.
const ON_THE_WAY: i64 = 8;
/// The cubes whose boundary has parts that face left and right at the middle, and is a surface.
const STAIRCASE: u8 = 0b1010_1100;

/// The boundary of some of the eight cubes, with the number of the vertex in the middle. Each
/// vertex but this one is moved by up to `jitter`. Another triangle may be near the middle.
fn boundary(
    cubes: u8,
    jitter: i64,
    other: Option<[I64Vec3; 3]>,
    random: &mut fastrand::Rng,
) -> (Triangulation, u32) {
    let (mut places, mut numbers, mut triangles) = (Vec::new(), HashMap::new(), Vec::new());
    let is_solid = |at: I64Vec3| {
        at.min_element() >= 0 && at.max_element() < 2 && {
            cubes >> (at.x + 2 * at.y + 4 * at.z) & 1 == 1
        }
    };
    let mut number = |at: I64Vec3| {
        *numbers.entry(at).or_insert_with(|| {
            let some = if at == I64Vec3::ONE { 0 } else { jitter };
            let aside = [(); 3].map(|()| random.i64(-some..=some));
            places.push(at * EDGE + I64Vec3::from_array(aside) * ON_THE_WAY);
            places.len() as u32 - 1
        })
    };
    for k in 0..8 {
        let at = I64Vec3::new(k & 1, k >> 1 & 1, k >> 2);
        for axis in (0..3).filter(|_| is_solid(at)) {
            let unit = I64Vec3::AXES[axis];
            let (u, v) = (I64Vec3::AXES[(axis + 1) % 3], I64Vec3::AXES[(axis + 2) % 3]);
            for (is_high, next) in [(false, at - unit), (true, at + unit)] {
                if is_solid(next) {
                    continue;
                }
                let low = if is_high { next } else { at };
                let mut corners = [low, low + u, low + u + v, low + v].map(&mut number);
                if !is_high {
                    corners.reverse();
                }
                let [a, b, c, d] = corners;
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let middle = number(I64Vec3::ONE);
    if let Some(other) = other {
        triangles.push([0, 1, 2].map(|k| places.len() as u32 + k));
        places.extend(other.map(|aside| places[middle as usize] + aside * ON_THE_WAY));
    }
    (Triangulation::new(places, triangles), middle)
}

/// The flaws of the triangles, with the vertex at a place.
fn flaws(mesh: &Triangulation, vertex: u32, place: I64Vec3) -> Crossings {
    let mut places: Vec<[f64; 3]> =
        mesh.places.iter().map(|place| place.as_dvec3().to_array()).collect();
    places[vertex as usize] = place.as_dvec3().to_array();
    let triangles: Vec<[u32; 3]> = mesh.present().map(|one| mesh.corners(one)).collect();
    crossings(&places, &triangles)
}

fn is_proven(mesh: &Triangulation, vertex: u32, to: I64Vec3) -> bool {
    Change::moved(mesh, vertex, to)
        .is_some_and(|change| change.is_proven(f64::INFINITY, 0.0, &|_| true))
}

/// At a corner of a staircase, triangles are a graph along no direction. The vertex may move along
/// an edge, in a face and anywhere else, if that is not far.
#[test]
fn corners_of_staircases_may_move() {
    let random = &mut fastrand::Rng::with_seed(1);
    let (mesh, middle) = boundary(STAIRCASE, 0, None, random);
    for k in 0..27 {
        let aside = I64Vec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        for far in [1, 1000] {
            let to = mesh.place(middle) + far * aside;
            assert!(is_proven(&mesh, middle, to), "{far} times {aside}");
        }
        let beyond = mesh.place(middle) + 2 * EDGE * aside;
        assert!(k == 13 || !is_proven(&mesh, middle, beyond), "far along {aside}");
    }
}

#[test]
fn triangles_never_meet_on_the_way() {
    const SEED: u64 = 0x57a1;
    println!("seed {SEED:#x}");
    let random = &mut fastrand::Rng::with_seed(SEED);
    let (mut proven, mut refused, mut wrong) = ([0; 2], 0, 0);
    for _ in 0..4000 {
        let cubes = if random.bool() { STAIRCASE } else { random.u8(..) };
        let jitter = [0, EDGE / 64, EDGE / 40][random.usize(..3)];
        let mut near = || {
            let size = EDGE / 2 / ON_THE_WAY;
            I64Vec3::from_array([(); 3].map(|()| random.i64(-size..=size)))
        };
        let other = [near(), near(), near()];
        let (mesh, middle) = boundary(cubes, jitter, Some(other), random);
        let is_closed = mesh.link(middle).is_some_and(|link| link.rim.is_none());
        let place = mesh.place(middle);
        if !is_closed || flaws(&mesh, middle, place) != Crossings::default() {
            continue;
        }
        let size = (2 * EDGE) >> random.u32(..6);
        let flat = random.usize(..6);
        let step = [0, 1, 2].map(|axis| {
            let along = random.i64(-size..=size) / ON_THE_WAY;
            if axis == flat { 0 } else { along }
        });
        let step = I64Vec3::from_array(step);
        if !is_proven(&mesh, middle, place + ON_THE_WAY * step) {
            refused += 1;
            continue;
        }
        proven[usize::from(cubes == STAIRCASE)] += 1;
        let on_the_way = |k: i64| flaws(&mesh, middle, place + k * step);
        wrong += usize::from((1..=ON_THE_WAY).any(|k| on_the_way(k) != Crossings::default()));
    }
    println!("{proven:?} proven, {refused} refused, {wrong} wrong");
    assert_eq!(wrong, 0);
    assert!(proven[0].min(proven[1]).min(refused) > 100);
}
