//! Normals of vertices, as means over the triangles around them.
//!
//! The weights are those of Max, "Weights for computing vertex normals from facet normals", Journal
//! of Graphics Tools 4(2), 1999: exact on spheres. On three other surfaces the mean error is a
//! fifth of that of weights by angles.

use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_6;
use zeroset_mesh::Mesh;

/// Triangles that meet at a larger angle form an edge.
const SMOOTH: f64 = FRAC_PI_6;
/// Triangles of less than this share of the largest area do not form edges.
const SLIGHT: f64 = 1.0 / 16.0;

/// The corners of triangles, joined at vertices where the surface is smooth. A vertex at an edge
/// has several.
pub struct Corners {
    /// The vertex of each corner.
    pub vertices: Vec<u32>,
    /// The unit normal at each corner.
    pub normals: Vec<Vec3>,
    /// The corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// The unit normal at each vertex.
pub fn means(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.vertices.len()];
    for triangle in &mesh.triangles {
        for (k, vertex) in triangle.iter().enumerate() {
            sums[*vertex as usize] += weighted(mesh, triangle, k);
        }
    }
    sums.into_iter().map(unit).collect()
}

impl Corners {
    /// Joins the corners of triangles.
    pub fn of(mesh: &Mesh) -> Self {
        let areas = areas(mesh);
        let mut corners = Self {
            vertices: Vec::with_capacity(mesh.vertices.len()),
            normals: Vec::with_capacity(mesh.vertices.len()),
            triangles: vec![[0; 3]; mesh.triangles.len()],
        };
        // Triangles around each vertex, one vertex after the other.
        let mut starts = vec![0; mesh.vertices.len() + 1];
        for vertex in mesh.triangles.iter().flatten() {
            starts[*vertex as usize + 1] += 1;
        }
        for vertex in 0..mesh.vertices.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut ends = starts.clone();
        let mut around = vec![(0_u32, 0_u8); 3 * mesh.triangles.len()];
        for (number, triangle) in (0..).zip(&mesh.triangles) {
            for (k, vertex) in (0..).zip(triangle) {
                let end = &mut ends[*vertex as usize];
                around[*end] = (number, k);
                *end += 1;
            }
        }
        let mut star = Star::default();
        for (vertex, ends) in (0..).zip(starts.windows(2)) {
            let around = &around[ends[0]..ends[1]];
            star.join(mesh, &areas, around);
            let first = corners.vertices.len();
            for sum in &star.sums {
                corners.vertices.push(vertex);
                corners.normals.push(unit(*sum));
            }
            for ((triangle, k), group) in around.iter().zip(&star.groups) {
                let corner = &mut corners.triangles[*triangle as usize][usize::from(*k)];
                *corner = (first + group) as u32;
            }
        }
        corners
    }
}

/// The triangles around a vertex, in groups within which the surface is smooth.
#[derive(Default)]
struct Star {
    /// The group of each triangle.
    groups: Vec<usize>,
    /// A vector for each group. While groups are formed, it is the sum of the triangles' areas as
    /// vectors. In the end, it is the sum of the triangles' weighted normals.
    sums: Vec<DVec3>,
    /// The two neighbors of the vertex in each triangle, each with the triangle's place in
    /// `groups`.
    beside: Vec<(u32, usize)>,
}

impl Star {
    fn join(&mut self, mesh: &Mesh, areas: &[DVec3], around: &[(u32, u8)]) {
        let Self { groups, sums, beside } = self;
        let area = |place: usize| areas[around[place].0 as usize];
        groups.clear();
        groups.extend(0..around.len());
        beside.clear();
        for (place, (triangle, k)) in around.iter().enumerate() {
            let triangle = mesh.triangles[*triangle as usize];
            for step in 1..3 {
                beside.push((triangle[(usize::from(*k) + step) % 3], place));
            }
        }
        beside.sort_unstable();
        for edge in beside.chunk_by(|one, other| one.0 == other.0) {
            for (number, (_, one)) in edge.iter().enumerate() {
                for (_, other) in &edge[number + 1..] {
                    if is_smooth(area(*one), area(*other)) {
                        merge(groups, *one, *other);
                    }
                }
            }
        }
        sums.clear();
        sums.resize(around.len(), DVec3::ZERO);
        for (place, group) in groups.iter().enumerate() {
            sums[*group] += area(place);
        }
        // A thin triangle may have any direction. It is no group of its own, and separates no
        // groups.
        let largest = sums.iter().map(|sum| sum.length()).fold(0.0, f64::max);
        let is_slight = |sum: DVec3| sum.length() <= SLIGHT * largest;
        let kept: Vec<usize> = (0..around.len())
            .filter(|group| groups[*group] == *group && !is_slight(sums[*group]))
            .collect();
        for (number, one) in kept.iter().enumerate() {
            for other in &kept[number + 1..] {
                if is_smooth(sums[*one], sums[*other]) {
                    merge(groups, *one, *other);
                }
            }
        }
        for place in 0..groups.len() {
            let own = sums[groups[place]];
            if is_slight(own) {
                let turn = |group: &&usize| own.angle_between(sums[**group]);
                let nearest = kept.iter().min_by(|one, other| turn(one).total_cmp(&turn(other)));
                groups[place] = nearest.map_or(0, |group| groups[*group]);
            }
        }
        // Number the groups without gaps.
        let mut numbers: Vec<usize> = groups.clone();
        numbers.sort_unstable();
        numbers.dedup();
        sums.clear();
        sums.resize(numbers.len(), DVec3::ZERO);
        for (place, group) in groups.iter_mut().enumerate() {
            *group = numbers.partition_point(|number| number < group);
            let (triangle, k) = around[place];
            sums[*group] += weighted(mesh, &mesh.triangles[triangle as usize], usize::from(k));
        }
    }
}

/// Makes two groups one. Vertices have few triangles, so that a walk over all of them is quick.
fn merge(groups: &mut [usize], one: usize, other: usize) {
    let (from, to) = (groups[one].max(groups[other]), groups[one].min(groups[other]));
    groups.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
}

fn is_smooth(one: DVec3, other: DVec3) -> bool {
    one.dot(other) >= SMOOTH.cos() * one.length() * other.length()
}

/// A triangle's normal, times its weight for the vertex at its corner `k`.
fn weighted(mesh: &Mesh, triangle: &[u32; 3], k: usize) -> DVec3 {
    let [a, b, c] = [0, 1, 2].map(|step| mesh.vertices[triangle[(k + step) % 3] as usize]);
    let (u, v) = (b - a, c - a);
    let lengths = u.length_squared() * v.length_squared();
    if lengths > 0.0 { u.cross(v) / lengths } else { DVec3::ZERO }
}

/// Twice the area of each triangle, as a vector along its normal.
fn areas(mesh: &Mesh) -> Vec<DVec3> {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize]);
        (b - a).cross(c - a)
    };
    mesh.triangles.iter().map(area).collect()
}

/// The direction of a sum of normals. A sum of 0 gets the direction of z.
fn unit(sum: DVec3) -> Vec3 {
    sum.normalize_or(DVec3::Z).as_vec3().normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube, each face two triangles.
    fn cube() -> Mesh {
        let corner = |n: u32| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64);
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        Mesh {
            vertices: (0..8).map(corner).collect(),
            triangles: quads.into_iter().flat_map(halves).collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn a_corner_of_a_cube_has_three_normals() {
        let corners = Corners::of(&cube());
        assert_eq!(corners.vertices.len(), 24);
        for (triangle, corners_of) in cube().triangles.iter().zip(&corners.triangles) {
            let [a, b, c] = triangle.map(|vertex| cube().vertices[vertex as usize]);
            let normal = (b - a).cross(c - a).normalize().as_vec3();
            for (vertex, corner) in triangle.iter().zip(corners_of) {
                assert_eq!(corners.vertices[*corner as usize], *vertex);
                assert_eq!(corners.normals[*corner as usize], normal);
            }
        }
    }

    #[test]
    fn a_thin_triangle_has_no_normal_of_its_own() {
        // A flat square around a vertex. A thin triangle at it stands upright.
        let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 1e-3]];
        let mut vertices: Vec<DVec3> = places.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        vertices[5].z = 1e-2;
        let mesh = Mesh {
            vertices,
            triangles: vec![[0, 5, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [0, 1, 5]],
            ..Mesh::default()
        };
        let corners = Corners::of(&mesh);
        let of_middle = corners.vertices.iter().filter(|vertex| **vertex == 0).count();
        assert_eq!(of_middle, 1);
        let own: Vec<u32> = corners.triangles.iter().map(|triangle| triangle[0]).collect();
        assert!(own.iter().all(|corner| *corner == own[0]), "{own:?}");
        assert!(corners.normals[own[0] as usize].z > 0.99);
    }

    #[test]
    fn triangles_without_area_have_some_unit_normal() {
        let mesh = Mesh {
            vertices: vec![DVec3::ZERO; 3],
            triangles: vec![[0, 1, 2], [0, 1, 1]],
            ..Mesh::default()
        };
        let corners = Corners::of(&mesh);
        let all = corners.normals.iter().chain(&means(&mesh)).copied().collect::<Vec<_>>();
        assert!(all.iter().all(|normal| normal.is_normalized()), "{all:?}");
    }
}
