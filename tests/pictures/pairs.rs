//! Surfaces that have parameters and an equation.

/// A surface by parameters, by an equation, and half the side of a cube in which both have the same
/// points.
pub const PAIRS: [[&str; 3]; 10] = [
    [
        "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]",
        "x^2 + y^2 + z^2 = 1",
        "1.5",
    ],
    [
        "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]",
        "(x^2 + y^2 + z^2 + 3)^2 = 16 (x^2 + y^2)",
        "3.5",
    ],
    ["(v cos u, v sin u, u) for u in [-3, 3], v in [-3, 3]", "x sin z = y cos z", "2"],
    [
        "(sin u cos v sin v, cos u cos v sin v, sin u cos u cos(v)^2) for u in [0, 2pi], v in [-pi/2, pi/2]",
        "x^2 y^2 + y^2 z^2 + z^2 x^2 = x y z",
        "0.6",
    ],
    ["(u v, u, v^2) for u in [-2, 2], v in [-2, 2]", "x^2 = y^2 z", "1"],
    [
        "(u - u^3/3 + u v^2, -v - u^2 v + v^3/3, u^2 - v^2) for u in [-3, 3], v in [-3, 3]",
        "((y^2 - x^2)/2 + 2/9 z^3 + 2/3 z)^3 = 6 z ((y^2 - x^2)/4 - z/4 (x^2 + y^2 + 8/9 z^2) + 2/9 z)^2",
        "1",
    ],
    ["(v cos u, v sin u, v) for u in [0, 2pi], v in [-2, 2]", "x^2 + y^2 = z^2", "1"],
    [
        "(cosh v cos u, cosh v sin u, sinh v) for u in [0, 2pi], v in [-2, 2]",
        "x^2 + y^2 - z^2 = 1",
        "1.5",
    ],
    [
        "w(u, v) = 2 - cos u cos v; (((3/2) (1 - 2 cos u cos v) + 3 cos u)/w(u, v), sqrt(3) sin(u) (2 - 1.5 cos v)/w(u, v), sqrt(3) sin(v) (cos u - 1.5)/w(u, v)) for u in [0, 2pi], v in [0, 2pi]",
        "(x^2 + y^2 + z^2 + 3 - 9/4)^2 = 4 (2 x - 3/2)^2 + 12 y^2",
        "4",
    ],
    [
        "(cosh v cos u, cosh v sin u, v) for u in [0, 2pi], v in [-2, 2]",
        "x^2 + y^2 = cosh(z)^2",
        "1.5",
    ],
];
