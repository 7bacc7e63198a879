//! A binary STL file as any other program reads it, and the flaws of its mesh.
//!
//! The format has no vertices: corners with the same 32 bits in each coordinate become one. No
//! distance is small enough to merge others. This file knows nothing of how meshes are made.

use crate::crossings;
use std::collections::{HashMap, HashSet};

/// Length of the header, which ends with the number of triangles.
const HEADER: usize = 84;

/// Length of a triangle's record: a normal, three corners and an unused number.
const RECORD: usize = 50;

/// A mesh as read from a file.
#[derive(Clone, Debug)]
pub struct Stl {
    /// The places of the vertices.
    pub vertices: Vec<[f64; 3]>,
    /// The vertices of the triangles, counterclockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The normals of the triangles, as the file states them.
    normals: Vec<[f64; 3]>,
}

/// Numbers of places at which a mesh is not the oriented boundary of a solid. Only `close` and
/// `normal` are decided with rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flaws {
    /// Triangles whose corners are on one line.
    pub flat: usize,
    /// Triangles that have the corners of an earlier one.
    pub duplicate: usize,
    /// Edges of one triangle.
    pub open: usize,
    /// Edges of two or more triangles, not as many in one direction as in the other.
    pub turned: usize,
    /// Edges of more than two triangles.
    pub crowded: usize,
    /// Vertices whose triangles are not one fan, each counted once for every fan but the first.
    pub pinched: usize,
    /// Pairs of triangles that meet in more than their shared corners.
    pub crossing: usize,
    /// Vertices that are another one to eight decimals. Programs that merge those, as trimesh does
    /// by its defaults, read another mesh.
    pub close: usize,
    /// Triangles with an area whose normal in the file is no unit vector, or points inward.
    pub normal: usize,
}

/// Numbers that describe a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Number of vertices, less that of edges, plus that of triangles.
    pub euler: i64,
    /// Number of parts that no shared edge joins.
    pub pieces: usize,
    /// Volume inside, below 0 if the triangles face inward.
    pub volume: f64,
    /// Sum of the areas of all triangles.
    pub area: f64,
}

impl Stl {
    /// Reads a file.
    ///
    /// # Errors
    /// If its length is not that of its triangles, or a coordinate is not finite.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let count = bytes.get(HEADER - 4..HEADER).ok_or("the header is cut off")?;
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
        let (records, rest) = bytes[HEADER..].as_chunks::<RECORD>();
        if records.len() != count || !rest.is_empty() {
            return Err(format!("{count} triangles are announced in {} bytes", bytes.len()));
        }
        if bytes.starts_with(b"solid") {
            return Err("the header is one of a text".to_owned());
        }
        let mut mesh = Self { vertices: vec![], triangles: vec![], normals: vec![] };
        let mut numbers = HashMap::new();
        for record in records {
            let (floats, _) = record.as_chunks::<4>();
            let mut floats = floats.iter().map(|bytes| f32::from_le_bytes(*bytes));
            let mut point = || [0; 3].map(|_| floats.next().unwrap_or(f32::NAN));
            let (normal, corners) = (point(), [point(), point(), point()]);
            if corners.iter().flatten().chain(&normal).any(|along| !along.is_finite()) {
                return Err("a coordinate is not finite".to_owned());
            }
            let number = |corner: [f32; 3]| {
                *numbers.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                    mesh.vertices.push(corner.map(f64::from));
                    mesh.vertices.len() as u32 - 1
                })
            };
            mesh.triangles.push(corners.map(number));
            mesh.normals.push(normal.map(f64::from));
        }
        Ok(mesh)
    }

    fn corners(&self, number: usize) -> [[f64; 3]; 3] {
        self.triangles[number].map(|vertex| self.vertices[vertex as usize])
    }

    /// The flaws of the mesh. Triangles of fewer than three vertices count as flat, and are left
    /// out of all else.
    pub fn flaws(&self) -> Flaws {
        let used = self.used();
        let mut flaws = Flaws::default();
        let mut seen = HashSet::new();
        for triangle in &used {
            let mut corners = *triangle;
            corners.sort_unstable();
            flaws.duplicate += usize::from(!seen.insert(corners));
        }
        let edges = edges(&used);
        for edge in edges.chunk_by(Edge::is_same) {
            let forward = edge.iter().filter(|edge| edge.is_forward).count();
            flaws.open += usize::from(edge.len() == 1);
            flaws.turned += usize::from(edge.len() > 1 && 2 * forward != edge.len());
            flaws.crowded += usize::from(edge.len() > 2);
        }
        flaws.pinched = fans(&used, &edges).count() - count_vertices(&used);
        let found = crossings(&self.vertices, &self.triangles);
        flaws.flat = found.flat.len();
        flaws.crossing = found.pairs.len();
        let rounded = |vertex: &[f64; 3]| vertex.map(|along| (along * 1e8).round() as i64);
        let places: HashSet<[i64; 3]> = self.vertices.iter().map(rounded).collect();
        flaws.close = self.vertices.len() - places.len();
        let with_area = |number: &usize| found.flat.binary_search(number).is_err();
        for number in (0..self.triangles.len()).filter(with_area) {
            let ([a, b, c], normal) = (self.corners(number), self.normals[number]);
            let toward = dot(cross(minus(b, a), minus(c, a)), normal);
            let is_unit = (dot(normal, normal) - 1.0).abs() < 1e-5;
            flaws.normal += usize::from(!is_unit || toward <= 0.0);
        }
        flaws
    }

    /// Numbers that describe the mesh, without its triangles of fewer than three vertices.
    pub fn figures(&self) -> Figures {
        let used = self.used();
        let edges = edges(&used);
        let edge_count = edges.chunk_by(Edge::is_same).count();
        let mut parts = fans(&used, &edges);
        for number in 0..used.len() {
            parts.join(3 * number, 3 * number + 1);
            parts.join(3 * number, 3 * number + 2);
        }
        // Near the mesh, the sum loses fewer digits.
        let origin = self.vertices.first().copied().unwrap_or_default();
        let (mut volume, mut area) = (0.0, 0.0);
        for number in 0..self.triangles.len() {
            let [a, b, c] = self.corners(number);
            let across = cross(minus(b, a), minus(c, a));
            volume += dot(minus(a, origin), across) / 6.0;
            area += dot(across, across).sqrt() / 2.0;
        }
        Figures {
            euler: count_vertices(&used) as i64 - edge_count as i64 + used.len() as i64,
            pieces: parts.count(),
            volume,
            area,
        }
    }

    /// The triangles that have three vertices.
    fn used(&self) -> Vec<[u32; 3]> {
        let is_used = |[a, b, c]: &&[u32; 3]| a != b && b != c && c != a;
        self.triangles.iter().filter(is_used).copied().collect()
    }
}

impl Flaws {
    /// The kinds of flaws that the mesh has, each with its number.
    pub fn kinds(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let Self { flat, duplicate, open, turned, crowded, pinched, crossing, close, normal } =
            *self;
        [
            ("flat", flat),
            ("duplicate", duplicate),
            ("open", open),
            ("turned", turned),
            ("crowded", crowded),
            ("pinched", pinched),
            ("crossing", crossing),
            ("close", close),
            ("normal", normal),
        ]
        .into_iter()
        .filter(|(_, number)| *number > 0)
    }
}

/// One side of a triangle.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// The two vertices, the smaller number first.
    ends: [u32; 2],
    /// True if the triangle goes from the first to the second.
    is_forward: bool,
    /// The places of both ends among the corners of all triangles.
    corners: [usize; 2],
}

impl Edge {
    fn is_same(&self, other: &Self) -> bool {
        self.ends == other.ends
    }
}

/// The sides of all triangles. Those of one edge are neighbors.
fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let side = |number: usize, k: usize| {
        let [from, to] = [k, (k + 1) % 3];
        let (triangle, corner) = (triangles[number], |k: usize| 3 * number + k);
        let is_forward = triangle[from] < triangle[to];
        let [first, last] = if is_forward { [from, to] } else { [to, from] };
        let corners = [corner(first), corner(last)];
        Edge { ends: [triangle[first], triangle[last]], is_forward, corners }
    };
    let sides = |number: usize| [0, 1, 2].map(|k| side(number, k));
    let mut edges: Vec<Edge> = (0..triangles.len()).flat_map(sides).collect();
    edges.sort_unstable();
    edges
}

fn count_vertices(triangles: &[[u32; 3]]) -> usize {
    triangles.as_flattened().iter().collect::<HashSet<_>>().len()
}

/// The corners of all triangles. Two at one vertex are together if a fan of triangles, each with a
/// side in common with the next, joins them.
fn fans(triangles: &[[u32; 3]], edges: &[Edge]) -> Classes {
    let mut classes = Classes((0..3 * triangles.len()).collect());
    for edge in edges.chunk_by(Edge::is_same) {
        for [one, other] in edge.array_windows() {
            classes.join(one.corners[0], other.corners[0]);
            classes.join(one.corners[1], other.corners[1]);
        }
    }
    classes
}

/// Numbers that are joined to classes: each has another number of its class, or itself.
struct Classes(Vec<usize>);

impl Classes {
    fn first(&mut self, mut number: usize) -> usize {
        while self.0[number] != number {
            self.0[number] = self.0[self.0[number]];
            number = self.0[number];
        }
        number
    }

    fn join(&mut self, one: usize, other: usize) {
        let [one, other] = [one, other].map(|number| self.first(number));
        self.0[one] = other;
    }

    fn count(&self) -> usize {
        self.0.iter().enumerate().filter(|(number, next)| number == *next).count()
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [1, 2, 0].map(|y| {
        let z = (y + 1) % 3;
        a[y] * b[z] - a[z] * b[y]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    type Triangle = [[f32; 3]; 3];

    /// A file of these triangles, with normals computed from the corners.
    fn bytes(triangles: &[Triangle]) -> Vec<u8> {
        let mut bytes = vec![b' '; HEADER - 4];
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| corner.map(f64::from));
            let across = cross(minus(b, a), minus(c, a));
            let length = dot(across, across).sqrt().max(f64::MIN_POSITIVE);
            let normal = across.map(|along| (along / length) as f32);
            let floats = normal.iter().chain(corners.as_flattened());
            bytes.extend(floats.flat_map(|along| along.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn read(triangles: &[Triangle]) -> Stl {
        Stl::read(&bytes(triangles)).expect("a mesh")
    }

    /// A tetrahedron with three edges of length 1 along the axes, seen from a place.
    fn tetrahedron([x, y, z]: [f32; 3]) -> Vec<Triangle> {
        let [o, a, b, c] = [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z], [x, y, z + 1.0]];
        vec![[o, b, a], [o, c, b], [o, a, c], [a, b, c]]
    }

    fn flaws(triangles: &[Triangle]) -> Vec<(&'static str, usize)> {
        read(triangles).flaws().kinds().collect()
    }

    #[test]
    fn a_sound_mesh_has_no_flaw() {
        let mesh = read(&tetrahedron([5.0, 6.0, 7.0]));
        assert_eq!(mesh.flaws(), Flaws::default());
        let Figures { euler, pieces, volume, area } = mesh.figures();
        assert_eq!((euler, pieces), (2, 1));
        assert!((volume - 1.0 / 6.0).abs() < 1e-12, "{volume}");
        assert!((area - (1.5 + 0.75_f64.sqrt())).abs() < 1e-12, "{area}");
        let two = [tetrahedron([0.0; 3]), tetrahedron([2.0, 0.0, 0.0])].concat();
        let Figures { euler, pieces, volume, .. } = read(&two).figures();
        assert_eq!((flaws(&two), euler, pieces), (vec![], 4, 2));
        assert!((volume - 1.0 / 3.0).abs() < 1e-12, "{volume}");
    }

    #[test]
    fn a_ring_has_the_euler_number_0() {
        let place = |i: usize, j: usize| {
            let [u, v] = [i, j].map(|k| std::f64::consts::TAU / 5.0 * (k % 5) as f64);
            let r = 2.0 + v.cos();
            [r * u.cos(), r * u.sin(), v.sin()].map(|along| along as f32)
        };
        let mut ring = Vec::new();
        for (i, j) in (0..25).map(|k| (k / 5, k % 5)) {
            let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
            ring.extend([[a, b, c], [a, c, d]]);
        }
        let mesh = read(&ring);
        assert_eq!(mesh.flaws(), Flaws::default());
        assert_eq!((mesh.figures().euler, mesh.figures().pieces), (0, 1));
        assert!(mesh.figures().volume > 10.0);
    }

    /// Each mesh has one flaw, and the flaws that follow from it.
    #[test]
    fn each_flaw_is_found() {
        let sound = tetrahedron([0.0; 3]);
        let [o, a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut missing = sound.clone();
        missing.pop();
        assert_eq!(flaws(&missing), [("open", 3)]);

        let mut turned = sound.clone();
        turned[3].swap(0, 1);
        assert_eq!(flaws(&turned), [("turned", 3)]);
        let inward: Vec<Triangle> = sound.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
        assert!(flaws(&inward).is_empty() && read(&inward).figures().volume < 0.0);

        let doubled = [&sound[..], &[[b, c, a]]].concat();
        let expected = [("duplicate", 1), ("turned", 3), ("crowded", 3), ("crossing", 1)];
        assert_eq!(flaws(&doubled), expected);

        // The corner d lies on the edge from a to b, so the face a, b, d has no area. The other
        // faces at d meet the one below in half an edge.
        let d = [0.5, 0.5, 0.0];
        let flat = [[o, b, a], [o, c, b], [o, a, c], [a, d, c], [d, b, c], [a, b, d]];
        assert_eq!(flaws(&flat), [("flat", 1), ("crossing", 2)]);
        let collapsed = [&sound[..], &[[a, a, b]]].concat();
        assert_eq!(flaws(&collapsed), [("flat", 1)]);
        assert_eq!(read(&collapsed).figures(), read(&sound).figures());

        let through = [sound.clone(), tetrahedron([0.25, 0.25, 0.125])].concat();
        let found = flaws(&through);
        assert!(matches!(found[..], [("crossing", pairs)] if pairs > 1), "{found:?}");
        // Two faces in one plane, one within the other.
        let touching = [sound.clone(), tetrahedron([0.25, 0.25, -1.0])].concat();
        assert!(matches!(flaws(&touching)[..], [("crossing", _)]));

        // Another tetrahedron behind the corner o.
        let opposite = |[x, y, z]: [f32; 3]| [0.0 - x, 0.0 - y, 0.0 - z];
        let mirrored: Vec<Triangle> =
            sound.iter().map(|[p, q, r]| [*q, *p, *r].map(opposite)).collect();
        let pinched = [sound.clone(), mirrored].concat();
        assert_eq!(flaws(&pinched), [("pinched", 1)]);
        assert_eq!(read(&pinched).figures().pieces, 2);

        // Another tetrahedron on the other side of the edge from o to c.
        let behind = |[x, y, z]: [f32; 3]| [0.0 - x, 0.0 - y, z];
        let crowded: Vec<Triangle> = sound.iter().map(|corners| corners.map(behind)).collect();
        assert_eq!(flaws(&[sound.clone(), crowded].concat()), [("crowded", 1)]);
    }

    #[test]
    fn places_are_equal_only_if_their_bits_are() {
        let mut moved = tetrahedron([1.0; 3]);
        moved[0][0][0] = 1.0_f32.next_up();
        assert!(flaws(&moved).contains(&("open", 4)), "{:?}", flaws(&moved));
        let mut signed = tetrahedron([0.0; 3]);
        signed[0][0][0] = -0.0;
        assert!(flaws(&signed).contains(&("open", 4)), "{:?}", flaws(&signed));
    }

    #[test]
    fn vertices_that_are_nearly_one_are_found() {
        let shrunk = |by: f32| -> Vec<Triangle> {
            let small = |corner: [f32; 3]| corner.map(|along| by * along);
            tetrahedron([0.0; 3]).iter().map(|corners| corners.map(small)).collect()
        };
        assert_eq!(flaws(&shrunk(1e-8)), []);
        assert_eq!(flaws(&shrunk(1e-9)), [("close", 3)]);
    }

    #[test]
    fn normals_are_unit_vectors_that_point_outward() {
        let sound = bytes(&tetrahedron([0.0; 3]));
        for (byte, value) in [(HEADER + 11, 0x3f), (HEADER + 10, 0), (HEADER + RECORD + 3, 0x3f)] {
            let mut wrong = sound.clone();
            wrong[byte] = value;
            assert_ne!(wrong, sound);
            let found: Vec<_> = Stl::read(&wrong).expect("a mesh").flaws().kinds().collect();
            assert_eq!(found, [("normal", 1)]);
        }
    }

    #[test]
    fn broken_files_are_refused() {
        let sound = bytes(&tetrahedron([0.0; 3]));
        let mut infinite = sound.clone();
        infinite[HEADER + 12..HEADER + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
        let mut text = sound.clone();
        text[..5].copy_from_slice(b"solid");
        for (file, message) in [
            (&sound[..50], "the header is cut off"),
            (&sound[..sound.len() - 1], "4 triangles are announced in 283 bytes"),
            (&[&sound[..], &[0; RECORD]].concat(), "4 triangles are announced in 334 bytes"),
            (&infinite, "a coordinate is not finite"),
            (&text, "the header is one of a text"),
        ] {
            assert_eq!(Stl::read(file).expect_err(message), message);
        }
    }
}
