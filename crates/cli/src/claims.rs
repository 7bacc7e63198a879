//! The files of `--claims`: all that a picture or a mesh claims to prove, for programs that check
//! it.
//!
//! The file of a picture has a JSON object on each line. The first has the surfaces as lists of
//! steps, which are the operations as typed, and the domain. Each further line is a pixel with its
//! ray. The decimals are those of floats, so both are exact. The file of a mesh has one object, and
//! the triangles are in the file of the mesh.

use super::array::{Beginning, NewRowWriter, RowWriter};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::{self, Write};
use zeroset_export::{Meshes, Object};
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId};
use zeroset_mesh::Edges;
use zeroset_render::picture::Picture;
use zeroset_space::Region;
use zeroset_syntax::{Document, Patch, Surface, SurfaceKind};
use zeroset_trace::{RayGrid, Status};

/// The first line's `format`.
const FORMAT: &str = "zeroset claims 2";

/// The `format` of the claims of a mesh.
const MESH_FORMAT: &str = "zeroset mesh claims 1";

/// Returns the claims of a mesh in a file. Those that are not proven are null.
pub fn of_mesh(
    object: &Object,
    found: &Meshes,
    document: &Document,
    text: &str,
    file: &str,
) -> Value {
    let mesh = &object.mesh;
    let (surfaces, steps) = functions(document);
    let edges = Edges::of(&mesh.triangles);
    let [vertices, faces, edge_count] =
        [mesh.vertices.len(), mesh.triangles.len(), edges.count].map(|count| count as i64);
    let is_embedded = mesh.crossings.map_or(mesh.is_proven(), |found| found.is_none());
    // Triangles without a proven area count in no pair.
    let counted = mesh.crossings.filter(|found| found.flat == 0);
    let crossing = counted.map(|found| found.crossing);
    json!({
        "format": MESH_FORMAT,
        "text": text,
        "file": file,
        "domain": domain(&found.region),
        "surfaces": surfaces,
        "steps": steps,
        "vertices": vertices,
        "triangles": faces,
        "closed": mesh.is_closed,
        "oriented": edges.has_sides,
        "euler": vertices - edge_count + faces,
        "crossing": crossing.or_else(|| is_embedded.then_some(0)),
        "embedded": is_embedded.then_some(true),
        "distance": mesh.is_proven().then_some(found.tolerance),
    })
}

/// Begins the file of a picture.
pub fn begin(mut out: Box<dyn Write>, picture: &Beginning<'_>) -> NewRowWriter {
    let Beginning { size: [width, height], document, region, .. } = *picture;
    let (surfaces, steps) = functions(document);
    let header = json!({
        "format": FORMAT,
        "text": picture.text,
        "size": [width, height],
        "domain": domain(region),
        "surfaces": surfaces,
        "steps": steps,
    });
    writeln!(out, "{header}")?;
    Ok(Box::new(Claims { out, width, row: 0 }))
}

/// The box, the half-space and the ball of which the region is the intersection.
fn domain(region: &Region) -> Value {
    let mut domain = json!({
        "low": region.low().to_array(),
        "high": region.high().to_array(),
    });
    if let Some(clip) = region.clip() {
        domain["clip"] = json!({"normal": clip.normal.to_array(), "offset": clip.offset});
    }
    if let Some(ball) = region.ball() {
        domain["ball"] = json!({"center": ball.centre.to_array(), "radius": ball.radius});
    }
    domain
}

/// The surfaces in the order of their numbers, and then all steps. Hidden surfaces have numbers,
/// too. A step follows those that it uses. Sliders have their values.
fn functions(document: &Document) -> (Vec<Value>, Vec<Value>) {
    let mut steps = Vec::new();
    let roots: Vec<NodeId> = document.surfaces.iter().map(|surface| surface.root).collect();
    let variable = |axis: Axis| json!([axis.name()]);
    let places = add_steps(&mut steps, document, (&document.graph, &roots), variable);
    let equation = |surface: &Surface| {
        let kind = match surface.kind {
            SurfaceKind::Equation => "equation",
            SurfaceKind::Solid => "solid",
        };
        json!({
            "read": surface.line(),
            "kind": kind,
            "hidden": surface.hidden,
            "step": places[&surface.root],
        })
    };
    let mut surfaces: Vec<Value> = document.surfaces.iter().map(equation).collect();
    let patches = &document.patches;
    let roots: Vec<NodeId> = patches.all.iter().flat_map(Patch::roots).collect();
    let parameter = |axis: Axis| json!(["parameter", axis as usize]);
    let places = add_steps(&mut steps, document, (&patches.graph, &roots), parameter);
    let parametric = |patch: &Patch| {
        json!({
            "read": patch.line(),
            "kind": "parametric",
            "hidden": patch.hidden,
            "parameters": patch.names,
            "ranges": patch.ends.map(|ends| ends.map(|end| places[&end])),
            "steps": patch.at.map(|coordinate| places[&coordinate]),
        })
    };
    surfaces.extend(patches.all.iter().map(parametric));
    (surfaces, steps)
}

/// Appends the nodes that `roots` need, and returns their places among all steps.
fn add_steps(
    steps: &mut Vec<Value>,
    document: &Document,
    (graph, roots): (&Graph, &[NodeId]),
    variable: impl Fn(Axis) -> Value,
) -> HashMap<NodeId, usize> {
    let mut places = HashMap::new();
    for id in graph.needed(roots) {
        places.insert(id, steps.len());
        steps.push(match graph.node(id) {
            Node::Variable(axis) => variable(*axis),
            Node::Parameter(number) => slider(document, *number),
            Node::Constant(number) => constant(number),
            Node::Apply(op, operands) => {
                let operands = operands.iter().map(|id| json!(places[id]));
                [json!(op.row().name)].into_iter().chain(operands).collect()
            }
        });
    }
    places
}

/// The value of a slider.
fn slider(document: &Document, number: u32) -> Value {
    let found = document.parameters.iter().find(|parameter| parameter.number == number);
    found.map_or_else(|| json!(["unknown"]), |parameter| constant(&parameter.value))
}

fn constant(constant: &Constant) -> Value {
    match constant {
        Constant::Exact(value) => json!(["number", value.to_string()]),
        Constant::Named(name) => json!([name.name()]),
        Constant::Enclosed(_) => {
            let bounds = constant.bounds();
            json!(["between", bounds.lo, bounds.hi])
        }
    }
}

struct Claims {
    out: Box<dyn Write>,
    width: usize,
    /// Number of rows that are written.
    row: usize,
}

impl RowWriter for Claims {
    fn add(&mut self, picture: &Picture, rays: &RayGrid) -> io::Result<()> {
        let buffer = &picture.buffer;
        for (pixel, status) in buffer.status.iter().enumerate() {
            let ray = rays.ray_of(pixel);
            let mut claim = json!({
                "pixel": [pixel % self.width, self.row + pixel / self.width],
                "origin": ray.origin.to_array(),
                "direction": ray.direction.to_array(),
                "status": match status {
                    Status::Miss => "miss",
                    Status::Hit => "hit",
                    Status::Undecided => "undecided",
                },
            });
            if *status == Status::Hit {
                claim["surface"] = json!(buffer.surface[pixel]);
                claim["bracket"] = json!(buffer.bracket[pixel]);
            }
            writeln!(self.out, "{claim}")?;
        }
        self.row += buffer.height;
        Ok(())
    }

    fn end(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}
