//! Pictures in sequence: values that move from frame to frame, or an eye that goes around.
//!
//! Every frame depends on its number alone, so that frames can be made in any order and on
//! different machines. All have the same domain and the same camera, but for its turning: both are
//! chosen for samples of the whole sequence.

use crate::framing;
use crate::model::Model;
use crate::picture::Settings;
use glam::{DQuat, DVec3};
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view::{self, CameraChoice, Cut, DomainChoice, SceneError};
use zeroset_space::Region;
use zeroset_syntax::{Document, Errors, Options};
use zeroset_trace::{Camera, CameraError};

/// So many frames, evenly spread, are looked at to choose domain and camera.
const SAMPLES: usize = 33;

/// A value that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The parameter's name; `t` for the time.
    pub name: String,
    /// Its value in the first frame.
    pub from: f64,
    /// Its value in the last frame, or after it in a loop.
    pub to: f64,
}

/// What moves, and in how many frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// How many frames there are, at least 1.
    pub frames: usize,
    /// The values that move.
    pub sweeps: Vec<Sweep>,
    /// By how many degrees the eye goes around what it looks at; seen from above,
    /// counter-clockwise.
    pub turn: Option<f64>,
    /// Whether the end is left out, because it shows what the start shows.
    pub is_loop: bool,
}

/// Where a sequence takes place.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The domain of all frames.
    pub region: Region,
    /// What was found if it was searched for.
    pub searched: Option<AutoDomain>,
    /// The camera of the first frame.
    camera: Camera,
}

/// Why there is no sequence.
#[derive(Debug, thiserror::Error)]
pub enum SequenceError {
    /// The text cannot be read with the values of this frame.
    #[error("frame {frame}: {errors}")]
    Text {
        /// The frame's number, from 0.
        frame: usize,
        /// What is wrong.
        errors: Errors,
    },
    /// The frame cannot be looked at.
    #[error("frame {frame}: {error}")]
    Scene {
        /// The frame's number, from 0.
        frame: usize,
        /// What is wrong.
        error: SceneError,
    },
}

impl Sequence {
    /// How far the sequence has come at a frame, counted from 0: from 0 to 1.
    fn share(&self, frame: usize) -> f64 {
        let steps = if self.is_loop { self.frames } else { self.frames.saturating_sub(1) };
        frame as f64 / steps.max(1) as f64
    }

    /// The moving values at a frame, counted from 0.
    pub fn values(&self, frame: usize) -> impl Iterator<Item = (&str, f64)> {
        let share = self.share(frame);
        self.sweeps
            .iter()
            .map(move |sweep| (sweep.name.as_str(), sweep.from * (1.0 - share) + sweep.to * share))
    }

    /// The document at a frame, counted from 0. Its moving parameters have the sweep for their
    /// range, so that kernels serve for all of it.
    ///
    /// # Errors
    /// What is wrong with the text or with a value.
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
            // Values are typed in decimals, and may lie an ulp beyond the floats that these were
            // read as.
            let low = sweep.from.min(sweep.to).next_down();
            let high = sweep.from.max(sweep.to).next_up();
            let mut parameters = document.parameters.iter_mut();
            if let Some(moving) = parameters.find(|parameter| parameter.name == sweep.name) {
                moving.range = point(low).zip(point(high));
            }
        }
        Ok(document)
    }

    /// Domain and camera for all frames. A frame that has no surface is passed over. The camera
    /// shows all of the domain's box if `shows_domain`, or if the time to find what is visible ran
    /// out, else what is visible.
    ///
    /// # Errors
    /// If the text is wrong, if no frame has a surface, or if domain or camera are impossible.
    ///
    /// # Panics
    /// Never: there is at least one sample.
    pub fn stage(
        &self,
        text: &str,
        options: &Options<'_>,
        (domain, cut): (DomainChoice, Cut),
        choice: &CameraChoice,
        shows_domain: bool,
        settings: &Settings,
    ) -> Result<Stage, SequenceError> {
        let (samples, last) = (self.frames.clamp(1, SAMPLES), self.frames.saturating_sub(1));
        let mut seen: Vec<Document> = Vec::new();
        let mut found: Option<(Region, Option<AutoDomain>)> = None;
        let mut refused = None;
        for sample in 0..samples {
            let frame = sample * last / (samples - 1).max(1);
            let text = self.document(text, options, frame);
            let document = text.map_err(|errors| SequenceError::Text { frame, errors })?;
            match view::region(&document, domain, cut) {
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
            // What has no surface is said when its frame is made.
            models.extend(made);
        }
        let models: Vec<&Model> = models.iter().collect();
        let is_turned = self.turn.is_some();
        // Of nothing all is seen that is written around it.
        let visible = if shows_domain { &[] } else { &*models };
        let camera = if shows_domain && !is_turned {
            framing::of_domain(&region, &seen[0], choice, settings).map(Some)
        } else {
            let (document, wanted) = (&seen[0], &settings.has_time_to_choose());
            framing::camera_over(visible, document, choice, settings, &region, is_turned, wanted)
        };
        let whole = || framing::whole(&region, &seen[0], choice, settings);
        let camera = camera.and_then(|camera| camera.map_or_else(whole, Ok)).map_err(at_start)?;
        Ok(Stage { region, searched, camera })
    }

    /// The camera of a frame, counted from 0.
    ///
    /// # Errors
    /// If there can be none: too near to what it looks at, for example.
    pub fn camera(&self, stage: &Stage, frame: usize) -> Result<Camera, CameraError> {
        let camera = &stage.camera;
        match self.turn {
            None => Ok(*camera),
            Some(degrees) => turned(camera, degrees * self.share(frame)),
        }
    }
}

/// The camera with its eye gone around the upright axis through its target, by so many degrees.
fn turned(camera: &Camera, degrees: f64) -> Result<Camera, CameraError> {
    let up = camera.up();
    // Whole turns end exactly where they began.
    let angle = (degrees % 360.0).to_radians();
    let around = DQuat::from_axis_angle(up.normalize_or(DVec3::Z), angle);
    let eye = camera.target() + around * (camera.eye() - camera.target());
    let eye = if angle == 0.0 { camera.eye() } else { eye };
    Camera::new(eye, camera.target(), up, camera.projection())
}

/// What holds two domains.
fn both(
    (one, found): &(Region, Option<AutoDomain>),
    (other, found_too): &(Region, Option<AutoDomain>),
) -> (Region, Option<AutoDomain>) {
    let (low, high) = (one.low().min(other.low()), one.high().max(other.high()));
    let is_round = one.ball().is_some() && other.ball().is_some();
    let region = view::clipped(low, high, is_round, one.clip()).unwrap_or(*one);
    let searched = found.zip(*found_too).map(|(one, other)| AutoDomain {
        low: low.to_array(),
        high: high.to_array(),
        finding: one.finding.max(other.finding),
        work: one.work + other.work,
    });
    (region, searched)
}
