//! Space, divided by planes into convex pieces that are inside of a surface or outside.

use super::plane::Points;
use super::polygon::Polygon;
use rustc_hash::FxHashMap;
use zeroset_scene::choices::Choice;

/// The number of pieces that are too many.
const MOST_PIECES: usize = 200_000;
/// Largest number of planes that divide a piece, one after the other.
const DEEPEST: usize = 1000;

/// Pieces of space.
pub enum Tree {
    /// A piece, and whether it is inside.
    Piece(bool),
    Divided {
        /// Where the plane meets the piece, seen from where its function is above 0.
        face: Polygon,
        /// The parts where the plane's function is below 0, and above 0.
        parts: Box<[Tree; 2]>,
    },
}

/// A polygon between two pieces.
pub struct Face {
    pub polygon: Polygon,
    /// For the piece behind the polygon, and for the one before it, whether it is inside.
    pub sides: [bool; 2],
}

/// The sign of a choice in a piece, or the part of the choice that decides it.
enum Known {
    Inside(bool),
    Open(Choice),
}

pub struct Builder<'a> {
    pub points: Points,
    /// The number of pieces so far.
    pub pieces: usize,
    pub wanted: &'a (dyn Fn() -> bool + Sync),
}

impl Builder<'_> {
    /// Divides a piece with these faces until a choice has one sign in each part. `None` if there
    /// are too many pieces, or the work is not wanted.
    pub fn divide(&mut self, faces: Vec<Polygon>, choice: &Choice, depth: usize) -> Option<Tree> {
        let mut corners: Vec<u32> = faces.iter().flat_map(|face| face.corners.clone()).collect();
        corners.sort_unstable();
        corners.dedup();
        let mut sides = FxHashMap::default();
        let choice = match self.known(choice, &corners, &mut sides) {
            Known::Inside(is_inside) => {
                self.pieces += 1;
                let may_go_on = self.pieces < MOST_PIECES && (self.wanted)();
                return may_go_on.then_some(Tree::Piece(is_inside));
            }
            Known::Open(choice) => choice,
        };
        let plane = first(&choice);
        let mut parts = [Vec::with_capacity(faces.len()), Vec::with_capacity(faces.len())];
        for face in faces {
            let split = face.split(plane, &mut self.points);
            for (part, face) in parts.iter_mut().zip(split) {
                part.extend(face);
            }
        }
        let face = self.section(plane, &parts[0]);
        let [mut below, mut above] = parts;
        below.push(face.clone());
        above.push(face.clone().turned());
        if depth == DEEPEST {
            return None;
        }
        let below = self.divide(below, &choice, depth + 1)?;
        let above = self.divide(above, &choice, depth + 1)?;
        Some(Tree::Divided { face, parts: Box::new([below, above]) })
    }

    /// The polygon in which a plane meets a convex body, of whose faces these are on the plane's
    /// negative side.
    fn section(&self, plane: usize, below: &[Polygon]) -> Polygon {
        // Each edge is that of a face, in the other direction.
        let mut edges: FxHashMap<u32, (u32, usize)> = FxHashMap::default();
        for face in below {
            let on = |corner: &u32| self.points.side(plane, *corner) == 0;
            for (k, corner) in face.corners.iter().enumerate() {
                let next = face.corners[(k + 1) % face.corners.len()];
                if on(corner) && on(&next) {
                    edges.insert(next, (*corner, face.plane));
                }
            }
        }
        let mut polygon = Polygon { plane, corners: Vec::new(), edges: Vec::new() };
        let start = *edges.keys().min().expect("a plane that divides the body");
        let mut at = start;
        while let Some((next, edge)) = edges.remove(&at) {
            polygon.corners.push(at);
            polygon.edges.push(edge);
            at = next;
        }
        assert!(at == start && edges.is_empty(), "one polygon");
        polygon
    }

    /// A choice in the convex hull of some corners. Each part keeps a sign there, or is left.
    fn known(
        &self,
        choice: &Choice,
        corners: &[u32],
        sides: &mut FxHashMap<usize, Option<bool>>,
    ) -> Known {
        // Tells whether all points are in the set of a part, or none is.
        let mut side = |part: usize| {
            *sides.entry(part).or_insert_with(|| {
                let (mut is_below, mut is_above) = (false, false);
                for corner in corners {
                    let side = self.points.side(part, *corner);
                    is_below |= side < 0;
                    is_above |= side > 0;
                    if is_below && is_above {
                        return None;
                    }
                }
                Some(is_below)
            })
        };
        match choice {
            Choice::Part(part) => {
                side(*part).map_or_else(|| Known::Open(choice.clone()), Known::Inside)
            }
            Choice::Opposite(part) => side(*part)
                .map_or_else(|| Known::Open(choice.clone()), |inside| Known::Inside(!inside)),
            Choice::Min(all) => self.group(all, true, Choice::Min, corners, sides),
            Choice::Max(all) => self.group(all, false, Choice::Max, corners, sides),
        }
    }

    /// A union or intersection. `decides` is the member's answer that is the answer of the group.
    fn group(
        &self,
        all: &[Choice],
        decides: bool,
        make: fn(Vec<Choice>) -> Choice,
        corners: &[u32],
        sides: &mut FxHashMap<usize, Option<bool>>,
    ) -> Known {
        let mut open = Vec::new();
        for one in all {
            match self.known(one, corners, sides) {
                Known::Inside(is_inside) if is_inside == decides => {
                    return Known::Inside(decides);
                }
                Known::Inside(_) => {}
                Known::Open(one) => open.push(one),
            }
        }
        match open.len() {
            0 => Known::Inside(!decides),
            1 => Known::Open(open.remove(0)),
            _ => Known::Open(make(open)),
        }
    }
}

/// The first part of a choice.
fn first(choice: &Choice) -> usize {
    match choice {
        Choice::Part(part) | Choice::Opposite(part) => *part,
        Choice::Min(all) | Choice::Max(all) => first(&all[0]),
    }
}

impl Tree {
    /// Adds the polygons between pieces.
    pub fn faces(&self, points: &mut Points, faces: &mut Vec<Face>) {
        let Self::Divided { face, parts } = self else { return };
        let [below, above] = &**parts;
        let mut halves = Vec::new();
        below.pieces(face.clone(), points, &mut |polygon, is_inside| {
            halves.push((polygon, is_inside));
        });
        for (polygon, behind) in halves {
            above.pieces(polygon, points, &mut |polygon, before| {
                faces.push(Face { polygon, sides: [behind, before] });
            });
        }
        below.faces(points, faces);
        above.faces(points, faces);
    }

    /// Calls `each` for the part of a polygon in each piece, and whether the piece is inside.
    pub fn pieces(
        &self,
        polygon: Polygon,
        points: &mut Points,
        each: &mut dyn FnMut(Polygon, bool),
    ) {
        match self {
            Self::Piece(is_inside) => each(polygon, *is_inside),
            Self::Divided { face, parts } => {
                for (part, polygon) in parts.iter().zip(polygon.split(face.plane, points)) {
                    if let Some(polygon) = polygon {
                        part.pieces(polygon, points, each);
                    }
                }
            }
        }
    }
}
