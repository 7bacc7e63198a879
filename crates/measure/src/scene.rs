//! The measures of a document.

use crate::density::DensityFault;
use crate::hint::hint;
use crate::{Measures, Request, measure};
use std::time::{Duration, Instant};
use thiserror::Error;
use zeroset_eval::KernelError;
use zeroset_scene::coordinate::coordinate;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::patches::NO_MEASURE;
use zeroset_scene::program::{Program, ProgramError};
use zeroset_scene::view::{self, Clipping, DomainChoice, SceneError};
use zeroset_space::Region;
use zeroset_syntax::Document;

/// The measures of all visible surfaces of a document.
pub struct Measured {
    /// The statement of each surface, in one line, and its measures.
    pub surfaces: Vec<(String, Measures)>,
    /// The region in which they were measured.
    pub region: Region,
    /// The search that found the domain, if none was given.
    pub searched: Option<AutoDomain>,
    /// Notes on surfaces whose functions are constant in the domain, and on equations if measures
    /// of solids were asked for.
    pub remarks: Vec<String>,
    /// Time that simplifying took.
    pub simplify: Duration,
    /// Time that measuring took.
    pub measure: Duration,
}

/// The reason why a document has no measures.
#[derive(Debug, Error)]
pub enum MeasureError {
    /// There is no domain.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A function cannot be compiled.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A kernel is not available.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// A solid has no mass.
    #[error(transparent)]
    Density(#[from] DensityFault),
    /// A surface may reach beyond any box.
    #[error("the surface is not proven to be bounded, so its measures may be infinite")]
    Unbounded {
        /// A domain as six numbers with commas between.
        ends: String,
    },
    /// There is no surface.
    #[error("nothing to measure: the surface is proven empty up to ±1e12")]
    Empty,
    /// There is no surface.
    #[error("nothing to measure: there are curves and points alone")]
    NoSurface,
    /// There are parametric surfaces alone.
    #[error("nothing to measure: {}", NO_MEASURE)]
    Parametric,
    /// No surface is visible.
    #[error("nothing to measure: every surface is hidden")]
    Hidden,
}

impl MeasureError {
    /// The message, with advice if there is any. `domain` turns bounds of x, y and z into the text
    /// that sets them.
    pub fn advise(&self, domain: &dyn Fn(&str) -> String) -> String {
        match self {
            Self::Unbounded { ends } => {
                format!("{self}: {} measures the part in a box", domain(ends))
            }
            _ => self.to_string(),
        }
    }
}

/// Measures all visible surfaces of a document, as [`measure`] does. Returns `None` once `wanted`
/// returns false.
///
/// # Errors
/// If the domain is not given and a surface is not proven bounded. If no surface is visible or has
/// a point, a function is too large, or the density is at fault.
pub fn measures(
    document: &Document,
    domain: DomainChoice,
    cut: Clipping,
    request: &Request<'_>,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Measured>, MeasureError> {
    if document.surfaces.is_empty() {
        let is_parametric = !document.patches.is_empty();
        return Err(if is_parametric { MeasureError::Parametric } else { MeasureError::NoSurface });
    }
    if document.surfaces.iter().all(|surface| surface.hidden) {
        return Err(MeasureError::Hidden);
    }
    let found = view::region_while(&mut None, document, domain, cut, wanted)?;
    let Some((region, searched)) = found else { return Ok(None) };
    if let Some(found) = searched {
        if found.finding.is_empty() {
            return Err(MeasureError::Empty);
        }
        if !found.finding.is_bounded() {
            let range = |axis: usize| [found.low[axis], found.high[axis]].map(coordinate);
            let ends = [0, 1, 2].map(range).concat().join(",");
            return Err(MeasureError::Unbounded { ends });
        }
    }
    let clock = Instant::now();
    let larger = zeroset_mesh::larger(&region, searched.as_ref());
    let program = Program::new(document, zeroset_mesh::domain(&larger.unwrap_or(region)))?;
    let simplify = clock.elapsed();
    let clock = Instant::now();
    let mut surfaces = Vec::new();
    for (number, surface) in document.surfaces.iter().enumerate() {
        if surface.hidden {
            continue;
        }
        let Some(measures) = measure(&program, number, &region, larger, request, wanted)? else {
            return Ok(None);
        };
        let name = surface.line();
        surfaces.push((name, measures));
    }
    let (mut remarks, measure) = (program.remarks(document), clock.elapsed());
    let has_solid = surfaces.iter().any(|(_, measures): &(String, Measures)| measures.is_solid);
    if !has_solid && request.quantities.iter().any(|one| one.is_of_solid()) {
        let lines: Vec<&str> = surfaces.iter().map(|(name, _)| &**name).collect();
        remarks.push(hint(&lines));
    }
    Ok(Some(Measured { surfaces, region, searched, remarks, simplify, measure }))
}
