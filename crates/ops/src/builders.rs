//! Builders: functions that make solids, and functions that move, copy and change them.
//!
//! A solid is a function of x, y and z that is below 0 inside. A primitive is a formula in x, y and
//! z. A move evaluates the function of a solid at another point. Both are written in the language
//! itself. Nothing here computes anything.

use crate::op::Op;

/// The values that an argument of a builder may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A function of x, y and z.
    Shape,
    /// A function of x, y and z whose value is a distance. The value of every builder is a
    /// distance. Any other function is divided by the length of its gradient.
    Distance,
    /// Three numbers: a vector, or three arguments.
    Vector,
    /// Three numbers that are not all 0.
    Direction,
    /// Three numbers above 0.
    Sizes,
    /// Three numbers of which none is below 0 and one is above 0.
    Cells,
    /// A number above 0.
    Size,
    /// A number.
    Number,
    /// A constant whole number above 0.
    Count,
}

impl Role {
    /// Returns whether the argument has three components.
    pub fn is_vector(self) -> bool {
        matches!(self, Self::Vector | Self::Direction | Self::Sizes | Self::Cells)
    }
}

/// Relation of a builder's value to the distance from the surface of the solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distance {
    /// The value is the distance, negative inside.
    Exact,
    /// The value changes no faster than the distance. So its magnitude is at most the distance.
    Bound,
    /// Exact if every argument is exact; a bound if some arguments are only bounds.
    Same,
    /// A bound, whether the arguments are exact or bounds.
    StaysBound,
    /// As for `StaysBound`, on a condition that the line of help states.
    Conditional,
}

impl Distance {
    /// The words for tables and help.
    pub fn words(self) -> &'static str {
        match self {
            Self::Exact => "exact distance",
            Self::Bound => "bound of the distance",
            Self::Same => "as exact as its solid",
            Self::StaysBound => "bound of the distance, if its solid has one",
            Self::Conditional => "bound of the distance, on its condition",
        }
    }
}

/// A builder. Builders of the same name differ in their parameters.
#[derive(Debug)]
pub struct Builder {
    /// The name by which formulas call the builder.
    pub name: &'static str,
    /// Other names that formulas may use for the builder.
    pub aliases: &'static [&'static str],
    /// Names of the parameters, as `place` and `body` use them, and their roles.
    pub parameters: &'static [(&'static str, Role)],
    /// The point at which the function of the solid is evaluated, in place of the point (x, y, z);
    /// empty if they are the same. In copies, `i` is the number of the copy, from 0.
    pub place: &'static str,
    /// The value. The name of the solid stands for its function at `place`.
    pub body: &'static str,
    /// The operation that joins copies. The parameter with the role [`Role::Count`] is the number
    /// of copies. `None` for a builder that makes no copies.
    pub join: Option<Op>,
    /// Relation of the value to the distance from the surface.
    pub distance: Distance,
    /// An example of how the builder is used.
    pub usage: &'static str,
    /// One line of help about the builder.
    pub doc: &'static str,
}

impl Builder {
    /// The smallest number of arguments.
    pub fn least(&self) -> usize {
        self.parameters.len()
    }

    /// Returns whether a call may have `count` arguments. Three numbers may stand for a vector. A
    /// primitive without vectors among its parameters may have its center as one more argument.
    pub fn takes(&self, count: usize) -> bool {
        let vectors = self.parameters.iter().filter(|(_, role)| role.is_vector()).count();
        let center = usize::from(self.has_center());
        (0..=vectors).any(|spread| {
            let given = self.least() + 2 * spread;
            given == count || given + center == count
        })
    }

    /// Returns whether a vector after all other arguments is the center of the solid.
    pub fn has_center(&self) -> bool {
        let elsewhere = [Role::Shape, Role::Distance, Role::Vector, Role::Direction];
        !self.parameters.iter().any(|(_, role)| elsewhere.contains(role))
    }

    /// The call with the names of its parameters, as in `box(a, b, c)`.
    pub fn signature(&self) -> String {
        let names: Vec<&str> = self.parameters.iter().map(|(name, _)| *name).collect();
        format!("{}({})", self.name, names.join(", "))
    }
}

const fn primitive(
    name: &'static str,
    aliases: &'static [&'static str],
    parameters: &'static [(&'static str, Role)],
    body: &'static str,
    distance: Distance,
    usage: &'static str,
    doc: &'static str,
) -> Builder {
    Builder { name, aliases, parameters, place: "", body, join: None, distance, usage, doc }
}

const fn change(
    name: &'static str,
    aliases: &'static [&'static str],
    parameters: &'static [(&'static str, Role)],
    (place, body): (&'static str, &'static str),
    distance: Distance,
    usage: &'static str,
    doc: &'static str,
) -> Builder {
    Builder { name, aliases, parameters, place, body, join: None, distance, usage, doc }
}

use Distance::{Bound, Conditional, Exact, Same, StaysBound};
use Role::{Cells, Count, Direction, Number, Shape, Size, Sizes, Vector};

/// Every builder. All lengths of primitives are measured from the center, as a radius is.
#[rustfmt::skip] // one row a line
pub static BUILDERS: &[Builder] = &[
    primitive("sphere", &[], &[("r", Size)], "hypot(x, y, z)-r", Exact, "sphere(1)", "a ball of radius r"),
    primitive("sphere", &[], &[("p", Vector), ("r", Size)], "length(vec3(x, y, z)-p)-r", Exact, "sphere((2, 0, 0), 1)", "a ball of radius r around the point p"),
    primitive("box", &["cuboid"], &[("a", Sizes)], "min(max(abs(x)-a.x, abs(y)-a.y, abs(z)-a.z), 0)+hypot(max(abs(x)-a.x, 0), max(abs(y)-a.y, 0), max(abs(z)-a.z, 0))", Exact, "box(2, 1, 1)", "a box that reaches from -a to a: half its width, depth and height"),
    primitive("box", &[], &[("a", Size)], "box(a, a, a)", Exact, "box(1)", "a cube that reaches from -a to a in each direction"),
    primitive("rounded_box", &[], &[("a", Sizes), ("r", Size)], "box(a-r)-r", Exact, "rounded_box(2, 1, 1, 0.2)", "the box(a), its edges rounded with a radius of r"),
    primitive("rounded_box", &[], &[("a", Size), ("r", Size)], "box(a-r)-r", Exact, "rounded_box(1, 0.2)", "the cube box(a), its edges rounded with a radius of r"),
    primitive("cylinder", &[], &[("r", Size), ("h", Size)], "min(max(hypot(x, y)-r, abs(z)-h), 0)+hypot(max(hypot(x, y)-r, 0), max(abs(z)-h, 0))", Exact, "cylinder(0.5, 1)", "a cylinder of radius r around the z axis, from z = -h to z = h"),
    primitive("cylinder", &[], &[("p", Vector), ("q", Vector), ("r", Size)], "min(max(length(cross(vec3(x, y, z)-p, q-p))/length(q-p)-r, abs(dot(vec3(x, y, z)-(p+q)/2, q-p))/length(q-p)-length(q-p)/2), 0)+hypot(max(length(cross(vec3(x, y, z)-p, q-p))/length(q-p)-r, 0), max(abs(dot(vec3(x, y, z)-(p+q)/2, q-p))/length(q-p)-length(q-p)/2, 0))", Exact, "cylinder((0, 0, 0), (1, 1, 1), 0.2)", "a cylinder of radius r from the point p to the point q"),
    primitive("cone", &[], &[("r", Size), ("h", Size)], "max(((hypot(x, y)-r/2)*2*h+r*z)/hypot(2*h, r), -z-h)", Bound, "cone(0.5, 1)", "a cone with radius r at z = -h and its tip at z = h"),
    primitive("cone", &[], &[("r", Size), ("s", Size), ("h", Size)], "max(((hypot(x, y)-(r+s)/2)*2*h+(r-s)*z)/hypot(2*h, r-s), abs(z)-h)", Bound, "cone(0.5, 0.2, 1)", "a cone with radius r at z = -h and radius s at z = h"),
    primitive("torus", &[], &[("r", Size), ("s", Size)], "hypot(hypot(x, y)-r, z)-s", Exact, "torus(1, 0.3)", "a ring around the z axis: radius r to the middle of the tube, s of the tube"),
    primitive("capsule", &[], &[("r", Size), ("h", Size)], "hypot(x, y, max(abs(z)-h, 0))-r", Exact, "capsule(0.3, 1)", "all points within r of the line from z = -h to z = h"),
    primitive("capsule", &[], &[("p", Vector), ("q", Vector), ("r", Size)], "length(vec3(x, y, z)-p-clamp(dot(vec3(x, y, z)-p, q-p)/dot(q-p, q-p), 0, 1)*(q-p))-r", Exact, "capsule((0, 0, 0), (1, 1, 1), 0.2)", "all points within r of the line from the point p to the point q"),
    primitive("ellipsoid", &[], &[("a", Sizes)], "(hypot(x/a.x, y/a.y, z/a.z)-1)*min(a.x, a.y, a.z)", Bound, "ellipsoid(2, 1, 1)", "an ellipsoid that reaches from -a to a"),
    primitive("halfspace", &["plane"], &[("n", Direction)], "dot(n, vec3(x, y, z))/length(n)", Exact, "halfspace(0, 0, 1)", "all points on the side of the origin that n points away from"),
    primitive("halfspace", &[], &[("n", Direction), ("d", Number)], "dot(n, vec3(x, y, z))/length(n)-d", Exact, "halfspace((0, 0, 1), 0.5)", "all points that go less than d in the direction n"),
    primitive("circle", &[], &[("r", Size)], "hypot(x, y)-r", Exact, "circle(1)", "a disk of radius r in the plane of x and y, for extrude and revolve"),
    primitive("rectangle", &["rect"], &[("a", Size), ("b", Size)], "min(max(abs(x)-a, abs(y)-b), 0)+hypot(max(abs(x)-a, 0), max(abs(y)-b, 0))", Exact, "rectangle(2, 1)", "a rectangle in the plane of x and y that reaches from -a to a and from -b to b"),
    Builder { name: "polygon", aliases: &[], parameters: &[("n", Count), ("r", Size)], place: "", body: "x*cos(tau*i/n)+y*sin(tau*i/n)-r", join: Some(Op::Max), distance: Bound, usage: "polygon(6, 1)", doc: "a regular polygon of n sides in the plane of x and y, each at a distance of r from the center" },
    change("extrude", &[], &[("shape", Shape), ("h", Size)], ("vec3(x, y, 0)", "min(max(shape, abs(z)-h), 0)+hypot(max(shape, 0), max(abs(z)-h, 0))"), Same, "extrude(circle(1), 0.5)", "the shape at z = 0, from z = -h to z = h"),
    change("revolve", &[], &[("shape", Shape)], ("vec3(hypot(x, y), z, 0)", "shape"), StaysBound, "revolve(rectangle(1, 0.5))", "the shape at z = 0 turned around: its x is the distance from the z axis, its y is z"),
    change("revolve", &[], &[("shape", Shape), ("r", Number)], ("vec3(hypot(x, y)-r, z, 0)", "shape"), StaysBound, "revolve(rectangle(0.2, 0.5), 1)", "the shape at z = 0 turned around at a distance of r from the z axis"),
    change("translate", &["move"], &[("shape", Shape), ("v", Vector)], ("vec3(x, y, z)-v", "shape"), Same, "translate(sphere(1), 2, 0, 0)", "the shape moved by the vector v"),
    change("rotate", &[], &[("shape", Shape), ("angle", Number)], ("vec3(x*cos(angle)+y*sin(angle), y*cos(angle)-x*sin(angle), z)", "shape"), Same, "rotate(box(2, 1, 1), 30°)", "the shape turned around the z axis, counterclockwise seen from above"),
    change("rotate", &[], &[("shape", Shape), ("angle", Number), ("axis", Direction)], ("vec3(x, y, z)*cos(angle)-cross(axis, vec3(x, y, z))/length(axis)*sin(angle)+axis*(dot(axis, vec3(x, y, z))/dot(axis, axis)*(1-cos(angle)))", "shape"), Same, "rotate(box(2, 1, 1), 30°, (1, 0, 0))", "the shape turned around an axis through the origin, counterclockwise for one whom it points at"),
    change("scale", &[], &[("shape", Shape), ("k", Size)], ("vec3(x, y, z)/k", "k*shape"), Same, "scale(sphere(1), 2)", "the shape k times as large"),
    change("scale", &[], &[("shape", Shape), ("k", Sizes)], ("vec3(x/k.x, y/k.y, z/k.z)", "min(k.x, k.y, k.z)*shape"), StaysBound, "scale(sphere(1), 2, 1, 1)", "the shape stretched by k along the axes"),
    change("mirror", &[], &[("shape", Shape), ("n", Direction)], ("vec3(x, y, z)-n*(2*dot(n, vec3(x, y, z))/dot(n, n))", "shape"), Same, "mirror(sphere(1, (1, 0, 0)), 1, 0, 0)", "the mirror image of the shape in the plane through the origin across n"),
    Builder { name: "repeat", aliases: &[], parameters: &[("shape", Shape), ("v", Vector), ("n", Count)], place: "vec3(x, y, z)-i*v", body: "shape", join: Some(Op::Min), distance: StaysBound, usage: "repeat(sphere(1), (3, 0, 0), 5)", doc: "the union of n copies, each moved by v from the one before; copies may overlap" },
    change("repeat", &[], &[("shape", Shape), ("cells", Cells)], ("vec3(if(cells.x > 0, x-cells.x*round(x/cells.x), x), if(cells.y > 0, y-cells.y*round(y/cells.y), y), if(cells.z > 0, z-cells.z*round(z/cells.z), z))", "shape"), Conditional, "repeat(sphere(1), 3, 3, 0)", "the part of the shape in a cell around the origin, in all cells of this size; 0 for no repetition; the bound holds for a shape with a mirror plane across each such axis"),
    Builder { name: "ring", aliases: &[], parameters: &[("shape", Shape), ("n", Count)], place: "vec3(x*cos(tau*i/n)+y*sin(tau*i/n), y*cos(tau*i/n)-x*sin(tau*i/n), z)", body: "shape", join: Some(Op::Min), distance: StaysBound, usage: "ring(sphere(1, (3, 0, 0)), 8)", doc: "the union of n copies at equal angles around the z axis; copies may overlap" },
    change("shell", &[], &[("shape", Role::Distance), ("t", Size)], ("", "max(shape, -(shape+t))"), StaysBound, "shell(sphere(1), 0.1)", "a wall of thickness t inside the surface of the shape"),
    change("offset", &[], &[("shape", Role::Distance), ("d", Number)], ("", "shape-d"), StaysBound, "offset(box(1), 0.2)", "the shape grown by d on all sides; d below 0 shrinks it"),
];

/// Returns the builders with this name or alias, in exact spelling. An alias stands for all
/// builders of its name.
pub fn builders(name: &str) -> impl Iterator<Item = &'static Builder> {
    let own = BUILDERS.iter().find(|row| row.name == name || row.aliases.contains(&name));
    let own = own.map(|row| row.name);
    BUILDERS.iter().filter(move |row| Some(row.name) == own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_made_of_what_they_need() {
        for row in BUILDERS {
            let count = |role| row.parameters.iter().filter(|(_, found)| *found == role).count();
            assert!(count(Role::Shape) <= 1 && count(Role::Count) <= 1, "{}", row.name);
            assert_eq!(row.join.is_some(), count(Role::Count) == 1, "{}", row.name);
            assert!(row.place.is_empty() || count(Role::Shape) == 1, "{}", row.name);
            assert!(row.usage.starts_with(&format!("{}(", row.name)), "{}", row.usage);
            assert!(!row.doc.ends_with('.') && row.doc.len() > 10, "{}", row.doc);
        }
    }

    #[test]
    fn vectors_may_be_spread_and_primitives_have_a_center() {
        let takes = |row: &Builder| (0..9).filter(|count| row.takes(*count)).collect::<Vec<_>>();
        let of = |name| builders(name).map(takes).collect::<Vec<_>>();
        assert_eq!(of("sphere"), [vec![1, 2], vec![2, 4]]);
        assert_eq!(of("cuboid"), [vec![1, 2, 3, 4], vec![1, 2]]);
        assert_eq!(of("move"), [vec![2, 4]]);
        assert_eq!(of("capsule"), [vec![2, 3], vec![3, 5, 7]]);
        assert_eq!(builders("spheres").count(), 0);
    }
}
