//! The cases, and the roots stored with them.

use super::SIDE;
use crate::error::ChartError;
use crate::reference::{RootReference, Sampling};
use crate::surfaces::ChartSurface;
use crate::truth::{Root, Truth};
use crate::views::View;
use glam::DVec3;
use serde::Deserialize;
use std::path::Path;
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_space::{Camera, Projection, Region};
use zeroset_testkit::npy::{read_f64, read_u8};

/// A formula with its domain and camera.
#[derive(Clone, Debug, Deserialize)]
pub struct Case {
    /// Name of the case.
    pub slug: String,
    formula: String,
    /// The difficulty of the formula.
    pub hazard: String,
    domain: [f64; 6],
    eye: Option<[f64; 3]>,
    #[serde(default)]
    target: [f64; 3],
    #[serde(default)]
    up: [f64; 3],
    #[serde(default)]
    fov: f64,
    /// The case's index among those with stored roots; `None` if it has no stored roots.
    #[serde(skip)]
    place: Option<usize>,
}

macro_rules! data {
    ($name:literal) => {
        include_bytes!(concat!("../../../../tests/data/stability/", $name))
    };
}

/// Evaluations per ray. A small budget suffices, since stored roots decide the rays left open.
const BUDGET: u32 = 1000;

/// Flags of a stored pixel.
const CROSSES: u8 = 1;
const TOUCHES: u8 = 2;
const OPEN: u8 = 4;

/// All cases, those with stored roots first.
///
/// # Errors
/// If the embedded lists are damaged.
pub fn cases() -> Result<Vec<Case>, ChartError> {
    let read = |bytes: &[u8]| {
        let refuse = ChartError::of_content(Path::new("tests/data/stability"));
        serde_json::from_slice::<Vec<Case>>(bytes).map_err(refuse)
    };
    let mut cases = read(data!("index.json"))?;
    for (place, case) in cases.iter_mut().enumerate() {
        case.place = Some(place);
    }
    cases.extend(read(data!("others.json"))?);
    cases.extend(read(data!("further.json"))?);
    Ok(cases)
}

/// The cases with these names, in this order; all cases if there are no names.
///
/// # Errors
/// If there is no such case.
pub fn named(names: &[String]) -> Result<Vec<Case>, ChartError> {
    let all = cases()?;
    if names.is_empty() {
        return Ok(all);
    }
    let named = |name: &String| {
        let found = all.iter().find(|case| case.slug == *name);
        found.cloned().ok_or_else(|| ChartError::UnknownCase(name.clone()))
    };
    names.iter().map(named).collect()
}

/// The stored truth about each pixel of a case.
fn stored(place: usize) -> Result<Vec<Truth>, ChartError> {
    let refuse = ChartError::of_file(Path::new("tests/data/stability"));
    let kinds = read_u8(&data!("pixels.npy")[..]).map_err(&refuse)?.data;
    let mut crossings = read_f64(&data!("crossing.npy")[..]).map_err(&refuse)?.data.into_iter();
    let mut touching = read_f64(&data!("touching.npy")[..]).map_err(&refuse)?.data.into_iter();
    let mut truths = Vec::new();
    let pixels = SIDE * SIDE;
    // The distances of all cases are stored in sequence. Those of earlier cases are skipped.
    for (index, kind) in kinds.into_iter().take((place + 1) * pixels).enumerate() {
        let crossing = if kind & CROSSES == 0 { None } else { crossings.next() };
        let first = if kind & TOUCHES == 0 { crossing } else { touching.next() };
        if index >= place * pixels {
            truths.push(match first {
                _ if kind & OPEN != 0 => Truth::Open,
                None => Truth::Miss,
                Some(at) => Truth::Root(Root { pieces: vec![[at, at]], next: None, normal: None }),
            });
        }
    }
    Ok(truths)
}

impl Case {
    /// The surface, and the view that it is drawn from.
    ///
    /// # Errors
    /// If the formula is refused.
    pub fn view(&self) -> Result<(ChartSurface, View), ChartError> {
        let [x0, x1, y0, y1, z0, z1] = self.domain;
        let region = Region::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
        let region = region.map_err(ChartError::of_surface(&self.slug))?;
        let surface = ChartSurface::of(&self.slug, &self.formula, Some(region))?;
        let camera = match self.eye {
            Some(eye) => {
                let [eye, target, up] = [eye, self.target, self.up].map(DVec3::from_array);
                Camera::new(eye, target, up, Projection::Perspective { fov: self.fov })
            }
            None => camera::camera(&CameraChoice::typed(&surface.document), &surface.region),
        };
        let camera = camera.map_err(ChartError::of_surface(&self.slug))?;
        Ok((surface, View { name: "stability".to_owned(), camera }))
    }

    /// The truth about each pixel, read from `directory` or computed and stored there.
    ///
    /// # Errors
    /// If the formula is refused, or the directory cannot be written.
    pub fn reference(&self, directory: &Path) -> Result<RootReference, ChartError> {
        let (surface, view) = self.view()?;
        let sampling = Sampling { size: SIDE, samples: 0, seed: 0, budget: BUDGET };
        let mut reference = RootReference::kept(directory, &surface, &view, sampling)?;
        if let Some(place) = self.place {
            for ((_, truth), stored) in reference.pixels.iter_mut().zip(stored(place)?) {
                if *truth == Truth::Open {
                    *truth = stored;
                }
            }
        }
        Ok(reference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_trace::RayGrid;

    #[test]
    fn stored_roots_are_those_of_their_case() {
        let cases = cases().expect("part of the program");
        assert_eq!(cases.len(), 52);
        // Two spheres of radius 1 about the origin, on which f touches 0. The certified tracer
        // leaves their rays open, so their roots are stored.
        for slug in ["double-sphere", "abs-sphere"] {
            let case = cases.iter().find(|case| case.slug == slug).expect("there");
            let (_, view) = case.view().expect("a view");
            let rays = RayGrid::new(&view.camera, SIDE, SIDE);
            let stored = stored(case.place.expect("stored")).expect("valid");
            let mut roots = 0;
            for (pixel, truth) in stored.iter().enumerate() {
                if let Truth::Root(root) = truth {
                    let ray = rays.ray_of(pixel);
                    let point = ray.at(ray.parameter(root.pieces[0][0]));
                    assert!((point.length() - 1.0).abs() < 1e-9, "{slug}, {pixel}: {point}");
                    roots += 1;
                }
            }
            assert_eq!(roots, 400);
        }
    }
}
