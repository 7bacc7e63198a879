//! Colors of meshes: the colors of pictures, without light.
//!
//! A surface in a picture has a color on each side. A mesh has only the color of the outer side.

use crate::normals::means;
use crate::scene::Object;
use rayon::prelude::*;
use zeroset_ir::Constant;
use zeroset_mesh::Mesh;
use zeroset_scene::number::nearest;
use zeroset_scene::point_value::{Place, PointValues};
use zeroset_shade::{LinearRgb, SurfaceColors};
use zeroset_syntax::{Document, DrawnSurface, MappedColor, SurfaceColor};

/// If values spread over less than this share of the largest of them, they count as one value:
/// rounding explains the spread.
const LEAST_RANGE: f64 = 1e-9;
/// Number of vertices that a thread takes at once.
const PART: usize = 256;

/// The color of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Color {
    /// The color, as sRGB bytes. With a color map, the color of vertices without a value.
    pub rgb: [u8; 3],
    /// Opacity from 0 to 1.
    pub opacity: f64,
    /// The colors that a color map gives to vertices, if there is one.
    pub points: Option<PointColors>,
}

/// Values at the vertices of a mesh, and the colors that show them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointColors {
    /// The value at each vertex; NaN if it has no value.
    pub values: Vec<f64>,
    /// The color of each vertex, as sRGB bytes.
    pub colors: Vec<[u8; 3]>,
}

impl Color {
    /// The color of a surface by its number, without a color map.
    pub fn of(number: usize, surface: &DrawnSurface<'_>) -> Self {
        let rgb = match surface.color {
            Some(SurfaceColor::Plain(color)) => color.rgb,
            Some(SurfaceColor::Mapped(_)) | None => {
                SurfaceColors::default_for(number).positive.to_srgb()
            }
        };
        Self { rgb, opacity: surface.opacity, points: None }
    }

    /// The color of a vertex, as sRGB bytes.
    pub fn at(&self, vertex: usize) -> [u8; 3] {
        self.points.as_ref().map_or(self.rgb, |points| points.colors[vertex])
    }

    /// The opacity as a byte.
    pub fn alpha(&self) -> u8 {
        (255.0 * self.opacity).round() as u8
    }
}

/// The amounts of light of a color: its linear components.
pub fn linear(rgb: [u8; 3]) -> [f32; 3] {
    LinearRgb::from_srgb(rgb).0
}

/// Colors the vertices of surfaces with color maps. `surfaces` has the number of each object's
/// surface.
pub fn map_colors(document: &Document, surfaces: &[usize], objects: &mut [Object]) {
    let parameters: Vec<f64> =
        document.parameters.iter().map(|parameter| nearest(&parameter.value)).collect();
    let styles: Vec<DrawnSurface<'_>> = document.drawn_surfaces().collect();
    let mapped: Vec<Option<&MappedColor>> = surfaces
        .iter()
        .map(|surface| match styles[*surface].color {
            Some(SurfaceColor::Mapped(mapped)) => Some(mapped),
            Some(SurfaceColor::Plain(_)) | None => None,
        })
        .collect();
    let all: Vec<Vec<f64>> = mapped
        .iter()
        .zip(&*objects)
        .map(|(mapped, object)| {
            mapped.map_or_else(Vec::new, |m| values(m, &parameters, &object.mesh))
        })
        .collect();
    for (number, own) in mapped.iter().enumerate() {
        let Some(own) = own else { continue };
        // Surfaces with the same color map and value share a scale.
        let is_same = |other: &MappedColor| {
            (own.map, &own.value.echo, &own.range) == (other.map, &other.value.echo, &other.range)
        };
        let found = || {
            let shared = mapped.iter().zip(&all).filter(|(m, _)| m.is_some_and(is_same));
            let finite = shared.flat_map(|(_, all)| all).filter(|value| value.is_finite());
            finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(*value), high.max(*value)]
            })
        };
        let given = |ends: &[Constant; 2]| ends.each_ref().map(nearest);
        let [low, high] = own.range.as_ref().map_or_else(found, given);
        let is_range = high - low > LEAST_RANGE * low.abs().max(high.abs());
        let color = |value: &f64| match (value.is_nan(), is_range) {
            (true, _) => objects[number].color.rgb,
            (false, true) => own.map.bytes((value - low) / (high - low)),
            // A single value has the middle color.
            (false, false) => own.map.bytes(0.5),
        };
        let colors = all[number].iter().map(color).collect();
        objects[number].color.points = Some(PointColors { values: all[number].clone(), colors });
    }
}

/// The values that a color map shows, at the vertices of a mesh.
fn values(mapped: &MappedColor, parameters: &[f64], mesh: &Mesh) -> Vec<f64> {
    let evaluated = PointValues::new(&mapped.value, parameters);
    let normals = means(mesh);
    let place = |vertex: usize| {
        let [nx, ny, nz] = normals[vertex].as_dvec3().to_array();
        // There is no eye to be distant from.
        Place {
            at: mesh.vertices[vertex].to_array(),
            own: [nx, ny, nz, f64::NAN],
            parameters: [f64::NAN; 2],
        }
    };
    let mut values = vec![f64::NAN; mesh.vertices.len()];
    values.par_chunks_mut(PART).enumerate().for_each(|(part, values)| {
        let mut room = evaluated.room();
        for (number, values) in values.chunks_mut(2).enumerate() {
            let first = part * PART + 2 * number;
            let both = [first, first + values.len() - 1].map(place);
            values.copy_from_slice(&evaluated.pair(&mut room, both)[..values.len()]);
        }
    });
    values
}
