//! The clipping plane and its commands. Knows no keys.

use super::reply::{Refusal, Reply, refused, say};
use super::session::Live;
use super::undo::Gesture;
use glam::DVec3;
use zeroset_scene::view::{ClipChoice, typed_clip};
use zeroset_space::{HalfSpace, Region};

impl Live {
    /// Adds a clipping plane, or removes it if there is one. A new plane passes through the
    /// camera's target, faces the eye, and cuts away the near half. Returns whether there is a
    /// plane afterwards. Does nothing before the first picture.
    pub fn toggle_cut(&self) -> bool {
        let Some(seen) = self.snapshot().rendering else { return false };
        let mut cuts = false;
        self.change(|request| {
            let own = typed_clip(&seen.document);
            cuts = request.clip.or(own).is_none();
            request.clip = if cuts {
                // Of the plane that faces the eye in the displayed space.
                let (camera, stretch) = (seen.camera.displayed(), seen.camera.stretch());
                let normal = (stretch * (camera.eye() - camera.target())).normalize();
                let offset = normal.dot(seen.camera.target());
                ClipChoice::Plane(HalfSpace { normal, offset })
            } else {
                none(own)
            };
        });
        cuts
    }

    /// Moves the clipping plane along its normal. Positive `steps` cut away less. A step is a
    /// fiftieth of the region's half extent. Does nothing without a plane.
    pub fn move_cut(&self, steps: f64) {
        let Some(seen) = self.snapshot().rendering else { return };
        let step = seen.model.region().half_extent() / 50.0;
        self.change_by(Some(Gesture::Clip), |request| {
            if let Some(mut plane) = request.clip.or(typed_clip(&seen.document)) {
                plane.offset += steps * step * plane.normal.length();
                request.clip = ClipChoice::Plane(plane);
            }
        });
    }
}

/// The choice that shows no plane. It has to be `Off` only if the document sets a plane.
fn none(own: Option<HalfSpace>) -> ClipChoice {
    if own.is_some() { ClipChoice::Off } else { ClipChoice::Document }
}

/// Sets or removes the clipping plane. For an empty `text`, reports it. Returns `None` if `text` is
/// neither a plane nor `off`.
pub(super) fn clip(live: &Live, text: &str) -> Option<Result<Reply, Refusal>> {
    let request = live.request();
    let own = || request.read().ok().and_then(|document| typed_clip(&document));
    if text.is_empty() {
        return Some(say(match request.clip.or(own()) {
            Some(HalfSpace { normal: n, offset }) => {
                format!("kept is {}*x + {}*y + {}*z <= {offset}", n.x, n.y, n.z)
            }
            None => "nothing is cut away".to_owned(),
        }));
    }
    let clip = match text.parse().ok()? {
        ClipChoice::Document | ClipChoice::Off => none(own()),
        ClipChoice::Plane(clip) => {
            let anywhere = Region::new(DVec3::NEG_ONE, DVec3::ONE);
            if let Err(error) = anywhere.and_then(|region| region.with_clip(clip)) {
                return Some(refused(error.to_string()));
            }
            ClipChoice::Plane(clip)
        }
    };
    live.change(|request| request.clip = clip);
    Some(Ok(Reply::Done))
}
