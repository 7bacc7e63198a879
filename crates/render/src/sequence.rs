//! Sequences of pictures, in which values move or the camera turns.
//!
//! A frame depends only on its number, so frames can be drawn in any order and on different
//! machines. All frames share one region, and one camera apart from its turning. Both are chosen
//! from samples of the whole sequence.

use crate::framing::Framing;
use crate::model::Model;
use crate::picture::Settings;
use glam::{DQuat, DVec3};
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_parser::Errors;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view::{self, Clipping, DomainChoice, SceneError};
use zeroset_space::{Camera, CameraError, Region};
use zeroset_syntax::{Document, Options, ParameterKind};

/// Number of frames, spread evenly over the sequence, from which region and camera are chosen.
const SAMPLES: usize = 33;

/// A parameter that moves from one value to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Name of the parameter; `t` is the time.
    pub name: String,
    /// Value in the first frame.
    pub from: f64,
    /// Value in the last frame. In a loop, it is reached one frame after the last.
    pub to: f64,
}

/// The motion of a sequence, and its number of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// Number of frames, at least 1.
    pub frames: usize,
    /// The values that move.
    pub sweeps: Vec<Sweep>,
    /// Degrees by which the camera turns around its target, counter-clockwise seen from above.
    pub turn: Option<f64>,
    /// Set to leave out the end of the motion, since it looks like the start.
    pub is_loop: bool,
}

/// Region and camera of a sequence.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The region of all frames.
    pub region: Region,
    /// The automatic domain, if the region was searched for.
    pub searched: Option<AutoDomain>,
    /// Camera of the first frame.
    camera: Camera,
}

/// The reason why a sequence cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum SequenceError {
    /// With this frame's values, the document has errors.
    #[error("frame {frame}: {errors}")]
    Text {
        /// Number of the frame, from 0.
        frame: usize,
        /// The errors.
        errors: Errors,
    },
    /// The frame has no valid region or camera.
    #[error("frame {frame}: {error}")]
    Scene {
        /// Number of the frame, from 0.
        frame: usize,
        /// The error.
        error: SceneError,
    },
}

impl Sequence {
    /// Returns whether all frames show the same document, from other sides.
    pub fn is_still(&self) -> bool {
        self.sweeps.is_empty()
    }

    /// Progress of the motion at a frame, from 0 to 1. Frames count from 0.
    fn share(&self, frame: usize) -> f64 {
        let steps = if self.is_loop { self.frames } else { self.frames.saturating_sub(1) };
        frame as f64 / steps.max(1) as f64
    }

    /// Names and values of the moving parameters at a frame. Frames count from 0.
    pub fn values(&self, frame: usize) -> impl Iterator<Item = (&str, f64)> {
        let share = self.share(frame);
        self.sweeps
            .iter()
            .map(move |sweep| (sweep.name.as_str(), sweep.from * (1.0 - share) + sweep.to * share))
    }

    /// The document at a frame, counted from 0. The range of a moving parameter is its whole sweep,
    /// so that the same kernels serve all frames.
    ///
    /// # Errors
    /// If the text or a value has errors.
    pub fn document(
        &self,
        text: &str,
        options: &Options<'_>,
        frame: usize,
    ) -> Result<Document, Errors> {
        let values =
            self.values(frame).map(|(name, value)| (name.to_owned(), format!("{value:?}")));
        let overrides: Vec<_> = options.overrides.iter().cloned().chain(values).collect();
        let mut document =
            zeroset_syntax::read(text, &Options { overrides: &overrides, ..*options })?;
        let point = |value: f64| Interval::point(value).map(Constant::enclosed);
        for sweep in &self.sweeps {
            // A value is passed as decimal text, which may be read as one ulp beyond the sweep's
            // ends.
            let low = sweep.from.min(sweep.to).next_down();
            let high = sweep.from.max(sweep.to).next_up();
            let mut parameters = document.parameters.iter_mut();
            if let Some(moving) = parameters.find(|parameter| parameter.name == sweep.name) {
                moving.range = point(low).zip(point(high));
            }
        }
        Ok(document)
    }

    /// Chooses region and camera for all frames. Frames without a surface are skipped. The camera
    /// fits the visible points. It fits the whole box instead if `shows_domain` is true, or if the
    /// time for choosing runs out. `first` is the document of the first frame. If all frames show
    /// the same document, also returns its model.
    ///
    /// # Errors
    /// If the text has errors, if no frame has a surface, or if region or camera are not valid.
    ///
    /// # Panics
    /// Never: there is at least one sample.
    pub fn stage(
        &self,
        (first, text): (&Document, &str),
        options: &Options<'_>,
        (domain, cut): (DomainChoice, Clipping),
        choice: &CameraChoice,
        shows_domain: bool,
        settings: &Settings,
    ) -> Result<(Stage, Option<Model>), SequenceError> {
        let samples = if self.is_still() { 1 } else { self.frames.clamp(1, SAMPLES) };
        let last = self.frames.saturating_sub(1);
        let mut seen: Vec<Document> = Vec::new();
        let mut found: Option<(Region, Option<AutoDomain>)> = None;
        let mut refused = None;
        for sample in 0..samples {
            let frame = sample * last / (samples - 1).max(1);
            let read = match frame {
                0 => Ok(first.clone()),
                _ => self.document(text, options, frame),
            };
            let document = read.map_err(|errors| SequenceError::Text { frame, errors })?;
            match view::region(&at_its_time(&document), domain, cut) {
                Ok(one) => {
                    found = Some(found.map_or(one, |before| both(&before, &one)));
                    seen.push(document);
                }
                Err(error) => refused = refused.or(Some(SequenceError::Scene { frame, error })),
            }
        }
        let Some((region, searched)) = found else {
            return Err(refused.expect("there is a frame"));
        };
        let at_start = |error| SequenceError::Scene { frame: 0, error };
        let mut models: Vec<Model> = Vec::new();
        for document in &seen {
            let rebound = models.first().and_then(|model| model.rebound(document, &region));
            let made = rebound.unwrap_or_else(|| Model::new(document, &region, settings));
            // Frames without a surface are reported later, when they are drawn.
            models.extend(made);
        }
        let all: Vec<&Model> = models.iter().collect();
        let is_turned = self.turn.is_some();
        let typed = &CameraChoice::typed(&seen[0]);
        let framing = Framing { region: &region, choice, typed, settings };
        // Without models, the camera shows the whole box.
        let visible = if shows_domain { &[] } else { &*all };
        let wanted = settings.limit.wanted_to_choose();
        let camera = if shows_domain && !is_turned {
            framing.of_domain(&all[..all.len().min(1)], &wanted)
        } else {
            framing.over(visible, is_turned, &wanted)
        };
        let camera = camera.and_then(|camera| camera.map_or_else(|| framing.whole(), Ok));
        let camera = camera.map_err(at_start)?;
        let model = models.into_iter().next().filter(|_| self.is_still());
        Ok((Stage { region, searched, camera }, model))
    }

    /// The camera of a frame, counted from 0.
    ///
    /// # Errors
    /// If the camera is not valid, for example too near its target.
    pub fn camera(&self, stage: &Stage, frame: usize) -> Result<Camera, CameraError> {
        let camera = &stage.camera;
        match self.turn {
            None => Ok(*camera),
            Some(degrees) => turned(camera, degrees * self.share(frame)),
        }
    }
}

/// The camera with its eye turned by this many degrees about the upright axis through its target.
fn turned(camera: &Camera, degrees: f64) -> Result<Camera, CameraError> {
    let (given, camera) = (camera, camera.displayed());
    let up = camera.up();
    // A whole number of turns ends exactly at the start.
    let angle = (degrees % 360.0).to_radians();
    let around = DQuat::from_axis_angle(up.normalize_or(DVec3::Z), angle);
    let eye = camera.target() + around * (camera.eye() - camera.target());
    if angle == 0.0 {
        return Ok(*given);
    }
    let turned = Camera::new(eye, camera.target(), up, camera.projection())?;
    Ok(turned.in_stretched(given.stretch()))
}

/// The document at its present time alone: the samples stand for the others.
fn at_its_time(document: &Document) -> Document {
    let mut document = document.clone();
    let times = document.parameters.iter_mut().filter(|one| one.kind == ParameterKind::Time);
    times.for_each(|time| time.range = None);
    document
}

/// The smallest region that contains both regions, and the result of both searches.
fn both(
    (one, found): &(Region, Option<AutoDomain>),
    (other, found_too): &(Region, Option<AutoDomain>),
) -> (Region, Option<AutoDomain>) {
    let (low, high) = (one.low().min(other.low()), one.high().max(other.high()));
    let is_round = one.ball().is_some() && other.ball().is_some();
    let region = view::clipped(low, high, is_round, one.clip()).unwrap_or(*one);
    let region = region.with_stretch(one.stretch());
    let searched = found.zip(*found_too).map(|(one, other)| AutoDomain {
        low: low.to_array(),
        high: high.to_array(),
        finding: one.finding.max(other.finding),
        cut: [0, 1, 2].map(|axis| {
            let reaches = |found: AutoDomain, side: usize| {
                let ends = [found.low[axis] == low[axis], found.high[axis] == high[axis]];
                found.cut[axis][side] && ends[side]
            };
            [0, 1].map(|side| reaches(one, side) || reaches(other, side))
        }),
    });
    (region, searched)
}
