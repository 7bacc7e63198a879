//! Parametric surfaces, prepared for evaluation: their rectangles, kernels and boxes.
//!
//! A surface's coordinates are three functions of u and v. They are simplified and compiled as the
//! functions of a document with three equations would be, over the rectangle of u and v.

mod normals;

use crate::curves::functions::{kernel, with_constants};
use crate::curves::moments;
use crate::program::{Program, ProgramError, constants};
use glam::DVec3;
use normals::Normals;
use std::sync::{Arc, OnceLock};
use zeroset_eval::{Assumptions, Kernel, KernelError, SampleGradient, SurfaceKernels, enclose_all};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::fix_exponents;
use zeroset_space::{PatchCell, PatchTree};
use zeroset_syntax::{Document, Patch, Patches, Surface};

/// The reason why measures leave out parametric surfaces.
pub const NO_MEASURE: &str = "parametric surfaces are drawn and meshed, but measures leave them out: they are for equations \
     and solids";

/// Number of levels of cells from whose bounds a surface's box is made.
const BOX_DEPTH: u32 = 2;

/// A parametric surface of a document.
pub struct PatchSurface {
    /// The three coordinates as functions of x and y, which stand for u and v.
    coordinates: Program,
    rectangle: Rectangle,
    tree: OnceLock<Result<PatchTree, KernelError>>,
    normals: OnceLock<Result<Normals, KernelError>>,
}

/// The rectangle of a surface's parameters, between floats.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rectangle {
    /// A rectangle that contains the exact one.
    outer: PatchCell,
    /// A rectangle that the exact one contains.
    inner: PatchCell,
}

impl PatchSurface {
    /// Simplifies the coordinates of a surface for the present values of the parameters.
    ///
    /// # Errors
    /// If a range of the surface has no value, or a formula is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub(crate) fn new(document: &Document, index: usize) -> Result<Self, ProgramError> {
        let rectangle = rectangle(document, &document.patches.all[index])?;
        let coordinates = Program::unchecked(&coordinates(document, index), domain(&rectangle))?;
        Ok(Self::of(coordinates, rectangle))
    }

    fn of(coordinates: Program, rectangle: Rectangle) -> Self {
        Self { coordinates, rectangle, tree: OnceLock::new(), normals: OnceLock::new() }
    }

    /// The same surface for the parameters' values of another document. `None` if the code does not
    /// serve it.
    pub(crate) fn rebound(&self, document: &Document, index: usize) -> Option<Self> {
        let rectangle = rectangle(document, &document.patches.all[index]).ok()?;
        if rectangle != self.rectangle {
            return None;
        }
        let coordinates = self.coordinates.rebound_unchecked(&coordinates(document, index))?;
        Some(Self::of(coordinates, rectangle))
    }

    /// The three coordinates as functions of x and y.
    pub fn coordinates(&self) -> &Program {
        &self.coordinates
    }

    /// The ranges of both parameters, in floats.
    pub fn ranges(&self) -> PatchCell {
        self.rectangle.outer
    }

    /// The program of the coordinates, with its kernels run by another evaluator.
    pub(crate) fn on(&self, evaluator: crate::kernels::Evaluator) -> Self {
        Self::of(self.coordinates.on(evaluator), self.rectangle)
    }

    /// The surface's cells.
    ///
    /// # Errors
    /// If the kernel fails to compile.
    pub fn tree(&self) -> Result<&PatchTree, KernelError> {
        let Rectangle { outer, inner } = self.rectangle;
        let make = || Ok(PatchTree::new(self.coordinates.patch_kernel()?, outer, inner));
        self.tree.get_or_init(make).as_ref().map_err(Arc::clone)
    }

    /// A kernel whose gradient at the point (u, v, 0) is the unit normal; NaN if the surface has no
    /// normal there.
    ///
    /// # Errors
    /// If a kernel fails to compile.
    pub fn normals(&self) -> Result<&dyn Kernel<SampleGradient, f64>, KernelError> {
        let make = || Normals::new(&self.coordinates, self.rectangle.outer);
        let normals = self.normals.get_or_init(make);
        normals.as_ref().map(|normals| normals as _).map_err(Arc::clone)
    }
}

/// No kernel finds a surface's points, or has values beside them: its cells do the work.
impl SurfaceKernels for PatchSurface {}

/// The document of a surface's three coordinates.
fn coordinates(document: &Document, index: usize) -> Document {
    let patch = &document.patches.all[index];
    let surface = |root| Surface::equation(root, patch.span, patch.echo.clone());
    Document {
        graph: document.patches.graph.clone(),
        surfaces: patch.at.map(surface).to_vec(),
        patches: Patches::default(),
        curves: zeroset_syntax::Curves::default(),
        ..document.clone()
    }
}

fn rectangle(document: &Document, patch: &Patch) -> Result<Rectangle, ProgramError> {
    let (roots, values) = (patch.ends.as_flattened(), constants(document));
    let (graph, roots) = fix_exponents(&document.patches.graph, roots, &values);
    let parameters = document.parameters.iter().map(|one| one.value.bounds()).collect();
    let assumptions = Assumptions { domain: [Interval::ENTIRE; 3], parameters };
    let ends = enclose_all(&graph, &roots, &assumptions);
    let range = |[(low, known), (high, also_known)]: [(Interval, Facts); 2]| {
        let is_valid = known.has(Facts::DEFINED)
            && also_known.has(Facts::DEFINED)
            && low.lo.is_finite()
            && high.hi.is_finite()
            && low.hi < high.lo;
        is_valid.then_some(([low.lo, high.hi], [low.hi, high.lo]))
    };
    let invalid = || ProgramError::Range { echo: patch.echo.clone() };
    let u = range([ends[0], ends[1]]).ok_or_else(invalid)?;
    let v = range([ends[2], ends[3]]).ok_or_else(invalid)?;
    Ok(Rectangle { outer: [u.0, v.0], inner: [u.1, v.1] })
}

/// The rectangle as a domain of x, y and z.
fn domain(rectangle: &Rectangle) -> [Interval; 3] {
    let [u, v] = rectangle.outer.map(|[lo, hi]| Interval { lo, hi });
    [u, v, Interval { lo: 0.0, hi: 0.0 }]
}

/// A box that holds all parametric surfaces for the present values of the parameters, and at
/// several times in the range of the time. Cells whose bounds are infinite are left out. `None` if
/// no other is left.
pub(crate) fn extent(document: &Document) -> Option<[DVec3; 2]> {
    if document.patches.is_empty() {
        return None;
    }
    let moments = moments(document).unwrap_or_default();
    moments.iter().chain([document]).filter_map(extent_now).reduce(hull)
}

/// The box of both boxes, as corners.
pub(crate) fn hull([low, high]: [DVec3; 2], [other_low, other_high]: [DVec3; 2]) -> [DVec3; 2] {
    [low.min(other_low), high.max(other_high)]
}

/// The box of [`extent`] at the present time.
fn extent_now(document: &Document) -> Option<[DVec3; 2]> {
    let boxes = document.patches.all.iter().map(|patch| {
        let rectangle = rectangle(document, patch).ok()?;
        let values = constants(document);
        let (graph, roots) = with_constants(&document.patches.graph, &patch.at, &values)?;
        let Rectangle { outer, inner } = rectangle;
        let tree = PatchTree::new(kernel(&graph, &roots, domain(&rectangle)), outer, inner);
        let [x, y, z] = tree.finite_bounds(BOX_DEPTH)?;
        Some([DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1])])
    });
    boxes.flatten().reduce(hull)
}
