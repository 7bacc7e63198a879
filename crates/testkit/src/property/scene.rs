//! Random scenes: a text, a region and a camera.

use crate::certified::{Function, Line};
use crate::random::{random_limit, random_seam};
use crate::{
    Adversarial, Case, Defined, GraphOptions, Oracle, Rng, hexadecimal, point_in_box, typed,
};
use std::fmt;
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, NodeId};
use zeroset_ops::{Notation, Op, TABLE};
use zeroset_syntax::{Document, Options, Surface, SurfaceKind, read};

/// Numbers that are in no simple relation.
const SHIFTS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];

/// A text with surfaces, and the bounded region in which they are drawn.
#[derive(Clone, Debug)]
pub struct Formula {
    /// The text as typed.
    pub text: String,
    /// The document that the text describes. It has at least one surface, and no hidden ones.
    pub document: Document,
    /// The region: per axis, a lower end and a greater upper end.
    pub region: [[f64; 2]; 3],
    /// A point of the region, mostly close to a zero.
    pub aim: [f64; 3],
}

impl Formula {
    /// Returns a random formula, mostly with a zero near a point of the region. `None` if the
    /// random graph cannot be typed as one surface.
    ///
    /// # Panics
    /// If the parser refuses the printed text.
    pub fn random(rng: &mut Rng, largest: u32) -> Option<Self> {
        let ops = TABLE.iter().filter(|row| row.notation != Notation::Internal).map(|row| row.op);
        let options = GraphOptions {
            size: rng.u32(1..=largest),
            parameters: rng.u32(0..=1),
            adversarial: rng.u32(0..8) == 0,
            ops: ops.collect(),
        };
        let mut case = Case::random(rng, &options);
        for value in &mut case.parameters {
            // A text gives each parameter one value.
            *value = Interval { lo: value.lo, hi: value.lo };
        }
        let values = case.random_values(rng);
        let region = random_region(rng);
        let aim = match rng.u32(0..4) {
            0 => point_in_box(rng, &region),
            _ => region.map(|[low, high]| low + (high - low) * f64::uniform(rng)),
        };
        if rng.bool() {
            case.root = sloped(&mut case.graph, case.root, rng);
        }
        if rng.u32(0..4) > 0 {
            case.root = through(&mut case.graph, case.root, aim, &values);
        }
        let text = typed(&case.graph, case.root, &values)?;
        let document = read(&text, &Options::default())
            .unwrap_or_else(|errors| panic!("{}", errors.render(None, &text, false)));
        (document.surfaces.len() == 1).then_some(Self { text, document, region, aim })
    }

    /// Returns a formula with seams (jumps, quotients and waves of angles), mostly with a zero at a
    /// point of the region. `None` if the text is refused, as one without a coordinate is.
    pub fn seamed(rng: &mut Rng) -> Option<Self> {
        let seam = random_seam(rng);
        let region = random_region(rng);
        let aim = random_simple_point(rng, &region);
        let levelled = if rng.u32(0..4) > 0 { level_at(&seam, aim) } else { None };
        let function = levelled.map_or(seam.clone(), |level| format!("{seam} - ({level:?})"));
        let text = match rng.u32(0..8) {
            0 => format!("{function} <= 0"),
            1 => format!("{function} >= 0"),
            2 => format!("{function} <= 0 and {}", random_limit(rng)),
            3 => format!("{function} = 0 {{{}}}", random_limit(rng)),
            _ => format!("{function} = 0"),
        };
        Some(Self { aim, ..Self::from_text(&text, region)? })
    }

    /// Returns a point of the region, often one at which functions with simple numbers are 0.
    pub fn random_point(&self, rng: &mut Rng) -> [f64; 3] {
        match rng.u32(0..8) {
            0 => self.aim,
            1 => point_in_box(rng, &self.region),
            _ => random_simple_point(rng, &self.region),
        }
    }

    /// Returns a point of the region with as many digits as floats have. Bytes alike do not make
    /// its coordinates alike.
    pub fn point_anywhere(&self, rng: &mut Rng) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let [low, high] = self.region[axis];
            low + (high - low) * (f64::uniform(rng) + SHIFTS[axis]).fract()
        })
    }

    /// Returns the formula of `text`. `None` if it is refused, draws nothing or hides surfaces.
    pub fn from_text(text: &str, region: [[f64; 2]; 3]) -> Option<Self> {
        let document = read(text, &Options::default()).ok()?;
        let surfaces = &document.surfaces;
        if surfaces.is_empty() || surfaces.iter().any(|surface| surface.hidden) {
            return None;
        }
        let aim = region.map(|[low, high]| low.midpoint(high));
        Some(Self { text: text.to_owned(), document, region, aim })
    }

    /// Returns the solid in which the function is at most 0.
    ///
    /// # Panics
    /// If the parser refuses the text as a side of an inequality.
    #[must_use]
    pub fn filled(self) -> Self {
        let text = format!("{} <= 0", self.text);
        let document = read(&text, &Options::default())
            .unwrap_or_else(|errors| panic!("{}", errors.render(None, &text, false)));
        Self { text, document, ..self }
    }

    /// Returns each surface's function as typed, for certified tracing. The flag tells whether the
    /// surface is a solid. Inside a solid the function is below 0.
    pub fn functions(&self) -> Vec<(Function, bool)> {
        let Document { graph, parameters, surfaces, .. } = &self.document;
        let values: Vec<Constant> =
            parameters.iter().map(|parameter| parameter.value.clone()).collect();
        let function = |surface: &Surface| {
            let function = Function::new(graph, surface.root, &values);
            (function, surface.kind == SurfaceKind::Solid)
        };
        surfaces.iter().map(function).collect()
    }

    fn random_target(&self, rng: &mut Rng) -> [f64; 3] {
        if rng.u32(0..4) == 0 { point_in_box(rng, &self.region) } else { self.aim }
    }

    /// Returns a line to a point of the region, from inside or outside the region.
    pub fn random_line(&self, rng: &mut Rng) -> Line {
        let eye = random_eye(rng, &self.region);
        let target = self.random_target(rng);
        let mut direction = [0, 1, 2].map(|axis| target[axis] - eye[axis]);
        if direction == [0.0; 3] {
            direction = [1.0, 0.0, 0.0];
        }
        Line { eye, direction }
    }
}

/// Quotes `text` as one word of a shell command.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}

impl fmt::Display for Formula {
    /// Prints arguments of `zeroset render`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ends: Vec<String> =
            self.region.iter().flatten().map(|end| format!("{end:?}")).collect();
        write!(f, "{} --domain={}", quoted(&self.text), ends.join(","))
    }
}

/// Returns a point of the region. Some coordinates are multiples of a quarter, if there are any in
/// the region, and some are equal.
fn random_simple_point(rng: &mut Rng, region: &[[f64; 2]; 3]) -> [f64; 3] {
    let mut last = 0.0;
    region.map(|[low, high]| {
        let anywhere = low + (high - low) * f64::uniform(rng);
        let quarter = (4.0 * anywhere).round() / 4.0;
        let at = match rng.u32(0..8) {
            0..=3 => quarter,
            4 => last,
            5 => -last,
            _ => anywhere,
        };
        last = if (low..=high).contains(&at) { at } else { anywhere };
        last
    })
}

/// Returns the value of an expression at a point. `None` if it has none, or none that is finite.
fn level_at(expression: &str, point: [f64; 3]) -> Option<f64> {
    let Document { graph, surfaces, .. } = read(expression, &Options::default()).ok()?;
    let claim = Oracle::new(&graph, &[surfaces.first()?.root]).at(point, &[])[0];
    let level = claim.lo.midpoint(claim.hi);
    (claim.defined == Defined::Yes && level.is_finite()).then_some(level)
}

/// Returns a cube as a user might type it, or any box of moderate size.
fn random_region(rng: &mut Rng) -> [[f64; 2]; 3] {
    let whole = f64::from(rng.u32(1..=8));
    match rng.u32(0..3) {
        0 => [[-whole, whole]; 3],
        1 => [[-whole / 10.0, whole / 10.0]; 3],
        _ => [(); 3].map(|()| {
            let low = f64::uniform(rng) * 8.0 - 6.0;
            [low, low + 0.0625 + f64::uniform(rng) * whole]
        }),
    }
}

/// Returns a point in the region, or outside of it by at most 3.5 times its extent.
fn random_eye(rng: &mut Rng, region: &[[f64; 2]; 3]) -> [f64; 3] {
    if rng.u32(0..4) == 0 {
        return point_in_box(rng, region);
    }
    region.map(|[low, high]| {
        let share = match rng.u32(0..4) {
            0 => [0.0, 0.5, 1.0, 4.0][rng.u32(0..4) as usize],
            _ => f64::uniform(rng) * 8.0 - 3.5,
        };
        low + (high - low) * share
    })
}

/// Returns `root` plus a multiple of each coordinate. Without these terms, many random formulas are
/// flat or depend on few coordinates.
fn sloped(graph: &mut Graph, root: NodeId, rng: &mut Rng) -> NodeId {
    Axis::ALL.into_iter().fold(root, |sum, axis| {
        let factor = graph.integer(i64::from(rng.i32(-3..=3)));
        let coordinate = graph.variable(axis);
        let term = graph.apply(Op::Mul, &[factor, coordinate]);
        graph.apply(Op::Add, &[sum, term])
    })
}

/// Returns `root` minus its value at `point`, or `root` itself if it is undefined there.
fn through(graph: &mut Graph, root: NodeId, point: [f64; 3], values: &[(f64, f64)]) -> NodeId {
    let claim = Oracle::new(graph, &[root]).at(point, values)[0];
    let level = claim.lo.midpoint(claim.hi);
    if claim.defined != Defined::Yes || !level.is_finite() {
        return root;
    }
    let level = graph.constant(Constant::enclosed(Interval { lo: level, hi: level }));
    graph.apply(Op::Sub, &[root, level])
}

/// A formula, and the camera that views it.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The surfaces and their region.
    pub formula: Formula,
    /// Position of the camera.
    pub eye: [f64; 3],
    /// The point that the camera looks at.
    pub target: [f64; 3],
    /// The upward direction.
    pub up: [f64; 3],
    /// Vertical angle of view in degrees, or else the height of an orthographic picture.
    pub fov: Result<f64, f64>,
    /// Numbers of columns and rows.
    pub size: [usize; 2],
    /// Greatest number of times that a ray's segment is halved.
    pub depth: u32,
    /// Allowed error of hits, in pixels.
    pub tolerance: f64,
    /// Precision of the kernels: `f32`, `f64`, or `auto`.
    pub precision: &'static str,
}

impl Scene {
    /// Returns a small scene, or `None` if its formula cannot be typed. The camera may be invalid.
    pub fn random(rng: &mut Rng) -> Option<Self> {
        /// Greatest number of operations in a formula.
        const LARGEST: u32 = 10;
        let formula = Formula::random(rng, LARGEST)?;
        Some(Self::viewed(formula, rng, false))
    }

    /// Returns a small scene with [seams](Formula::seamed), or `None` if its formula is refused.
    /// The camera may be invalid.
    pub fn seamed(rng: &mut Rng) -> Option<Self> {
        let formula = Formula::seamed(rng)?;
        Some(Self::viewed(formula, rng, true))
    }

    /// Returns a view of a formula. If it is not `seamed`, it may become a solid. No ray lies in
    /// the gaps of a seamed solid, which a picture fills: the eye is beside them.
    fn viewed(formula: Formula, rng: &mut Rng, seamed: bool) -> Self {
        /// Greatest number of pixels on a side.
        const WIDEST: u32 = 6;
        /// Greatest depth. Deeper pictures would cost a fuzzer too much time.
        const DEEPEST: u32 = 12;
        let solid = |surface: &Surface| surface.kind == SurfaceKind::Solid;
        let gapped = seamed && formula.document.surfaces.iter().any(solid);
        let mut eye = random_eye(rng, &formula.region);
        if gapped {
            for (axis, shift) in SHIFTS.into_iter().enumerate() {
                let [low, high] = formula.region[axis];
                eye[axis] += (high - low) * shift / 64.0;
            }
        }
        let target = formula.random_target(rng);
        let up = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 2.0, -1.0]][rng.u32(0..3) as usize];
        let extent = formula.region.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let fov = match rng.u32(0..4) {
            0 => Err(extent * (0.01 + f64::uniform(rng))),
            1 => Ok(0.5 + 179.0 * f64::uniform(rng)),
            _ => Ok(40.0),
        };
        let size = [(); 2].map(|()| rng.u32(1..=WIDEST) as usize);
        let depth = rng.u32(1..=DEEPEST);
        // The number is not used. Without this draw, saved seeds would give other scenes.
        rng.u32(0..3);
        let precision = if rng.bool() { "f64" } else { "auto" };
        let formula = if !seamed && rng.u32(0..4) == 0 { formula.filled() } else { formula };
        let tolerance = 0.5;
        let mut scene = Self { formula, eye, target, up, fov, size, depth, tolerance, precision };
        if rng.u32(0..4) == 1 && !gapped {
            scene.make_extreme(rng);
        }
        scene
    }

    /// Gives the camera numbers at which floats run out of digits or range.
    fn make_extreme(&mut self, rng: &mut Rng) {
        let way = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|axis| to[axis] - from[axis]);
        let power = |rng: &mut Rng, most: i32| 10_f64.powi(rng.i32(1..=most));
        let Self { eye, target, up, fov, .. } = self;
        match rng.u32(0..5) {
            // The eye is far away, and the rays are close enough together to hit the region.
            0 => {
                let (aim, distance) = (self.formula.aim, power(rng, 99));
                let only = rng.u32(0..6) as usize;
                let back = way(*target, *eye);
                for axis in 0..3 {
                    let moves = only > 2 || only == axis;
                    eye[axis] = aim[axis] + if moves { back[axis] * distance } else { 0.0 };
                }
                *target = aim;
                if let Ok(degrees) = fov {
                    *degrees /= distance;
                }
            }
            // The target is next to the eye.
            1 => {
                let distance = power(rng, 300);
                *eye = [0.0; 3];
                *target = target.map(|part| part / distance);
            }
            // The upward direction is almost parallel to the view.
            2 => {
                let share = power(rng, 12);
                let way = way(*eye, *target);
                *up = [0, 1, 2].map(|axis| way[axis] + up[axis] / share);
            }
            // The angle of view is almost zero, or almost 180°.
            3 => *fov = Ok(180.0 / power(rng, 12)),
            _ => {
                *fov = if rng.bool() {
                    Ok(180.0 - 1.0 / power(rng, 14))
                } else {
                    Err(power(rng, 200) / power(rng, 200))
                }
            }
        }
    }
}

impl fmt::Display for Scene {
    /// Prints the command line of `zeroset render`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let point = |v: [f64; 3]| format!("{:?},{:?},{:?}", v[0], v[1], v[2]);
        let [width, height] = self.size;
        write!(
            f,
            "zeroset render {} --eye={} --target={} --up={} {} --size {width}x{height} --max-depth {} --tolerance {:?} --precision {} --json",
            self.formula,
            point(self.eye),
            point(self.target),
            point(self.up),
            match self.fov {
                Ok(degrees) => format!("--fov {degrees:?}"),
                Err(height) => format!("--ortho {height:?}"),
            },
            self.depth,
            self.tolerance,
            self.precision,
        )
    }
}

/// Prints a line's numbers exactly.
pub(super) fn describe(line: &Line) -> String {
    format!("eye {:?}, direction {:?}", line.eye.map(hexadecimal), line.direction.map(hexadecimal))
}
