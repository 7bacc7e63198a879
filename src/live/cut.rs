//! The clipping plane: what is in front of it is cut away. Knows no keys.

use super::command::{refused, say};
use super::edit::Refusal;
use super::session::{Live, Reply};
use super::undo::Gesture;
use crate::scene::numbers;
use glam::DVec3;
use zeroset_trace::{HalfSpace, Region};

impl Live {
    /// Cuts away what lies between the eye and the middle of what is looked at, or, if something is
    /// cut away already, nothing any more; tells whether something is now. Nothing happens before
    /// there is a picture.
    pub fn toggle_cut(&self) -> bool {
        let seen = self.snapshot().rendering;
        let mut cuts = false;
        self.change(|request| {
            request.clip = match (request.clip, &seen) {
                (None, Some(seen)) => {
                    let normal = (seen.camera.eye() - seen.camera.target()).normalize();
                    Some(HalfSpace { normal, offset: normal.dot(seen.camera.target()) })
                }
                (Some(_), _) | (None, None) => None,
            };
            cuts = request.clip.is_some();
        });
        cuts
    }

    /// Moves the clipping plane along its normal, away from what is kept if `steps` is positive: a
    /// step is a fiftieth of half the domain's extent. Nothing happens without a plane.
    pub fn move_cut(&self, steps: f64) {
        let Some(seen) = self.snapshot().rendering else { return };
        let step = seen.model.region().half_extent() / 50.0;
        self.change_by(Some(Gesture::Clip), |request| {
            if let Some(HalfSpace { normal, offset }) = &mut request.clip {
                *offset += steps * step * normal.length();
            }
        });
    }
}

/// Sets the plane, takes it away, or tells which it is; `None` if what is given is no plane.
pub(super) fn clip(live: &Live, text: &str) -> Option<Result<Reply, Refusal>> {
    let clip = match text {
        "" => {
            return Some(say(match live.request().clip {
                Some(HalfSpace { normal: n, offset }) => {
                    format!("kept is {}*x + {}*y + {}*z <= {offset}", n.x, n.y, n.z)
                }
                None => "nothing is cut away".to_owned(),
            }));
        }
        "off" => None,
        _ => {
            let [a, b, c, offset] = numbers(text).ok()?[..] else { return None };
            let clip = HalfSpace { normal: DVec3::new(a, b, c), offset };
            let anywhere = Region::new(DVec3::NEG_ONE, DVec3::ONE);
            if let Err(error) = anywhere.and_then(|region| region.with_clip(clip)) {
                return Some(refused(error.to_string()));
            }
            Some(clip)
        }
    };
    live.change(|request| request.clip = clip);
    Some(Ok(Reply::Done))
}
