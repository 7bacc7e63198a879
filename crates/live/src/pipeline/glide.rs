//! The animation from one automatic view to the next, so that the eye can follow the change.

use std::time::{Duration, Instant};
use zeroset_space::{Camera, Projection};

const GLIDE_TIME: Duration = Duration::from_millis(240);

/// Shortest time between two pictures of a glide.
const FRAME: Duration = Duration::from_millis(16);

/// A camera that moves from one position to another.
pub struct Glide {
    from: Camera,
    to: Camera,
    since: Instant,
}

impl Glide {
    /// A glide between two cameras. `None` if they are equal or differ in kind of projection.
    pub fn new(from: Camera, to: Camera) -> Option<Self> {
        let is_way = from != to && between(&from, &to, 0.5).is_some();
        is_way.then(|| Self { from, to, since: Instant::now() })
    }

    /// The camera at the present time. `None` once the glide has ended.
    pub fn camera(&self) -> Option<Camera> {
        let share = self.since.elapsed().as_secs_f64() / GLIDE_TIME.as_secs_f64();
        // Start and stop slowly.
        let eased = share * share * (3.0 - 2.0 * share);
        if share < 1.0 { between(&self.from, &self.to, eased) } else { None }
    }

    /// Time until the next picture is due.
    pub fn pause(&self) -> Duration {
        let frame = FRAME.as_nanos();
        let into = self.since.elapsed().as_nanos() % frame;
        Duration::from_nanos((frame - into) as u64)
    }
}

/// The camera at this share of the way, from 0 to 1. `None` if there is no valid camera.
fn between(from: &Camera, to: &Camera, share: f64) -> Option<Camera> {
    let projection = match (from.projection(), to.projection()) {
        (Projection::Perspective { fov: one }, Projection::Perspective { fov: other }) => {
            Projection::Perspective { fov: one + share * (other - one) }
        }
        (Projection::Orthographic { height: one }, Projection::Orthographic { height: other }) => {
            Projection::Orthographic { height: one + share * (other - one) }
        }
        (Projection::Perspective { .. }, Projection::Orthographic { .. })
        | (Projection::Orthographic { .. }, Projection::Perspective { .. }) => return None,
    };
    let stretch = to.stretch();
    let eye = from.eye().lerp(to.eye(), share) * stretch;
    let target = from.target().lerp(to.target(), share) * stretch;
    let up = from.up().lerp(to.up(), share) * stretch;
    Some(Camera::new(eye, target, up, projection).ok()?.in_stretched(stretch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn it_begins_at_one_camera_and_ends_at_the_other() {
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = |far: f64| {
            let eye = far * DVec3::new(1.0, -2.0, 1.0);
            Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("valid")
        };
        let (from, to) = (camera(1.0), camera(3.0));
        assert!(Glide::new(from, from).is_none());
        let flat = Projection::Orthographic { height: 2.0 };
        let other = Camera::new(to.eye(), to.target(), to.up(), flat).expect("valid");
        assert!(Glide::new(from, other).is_none());
        let glide = Glide::new(from, to).expect("a way");
        let mut far = 0.0;
        while let Some(camera) = glide.camera() {
            let now = camera.eye().length();
            assert!(now >= far && now < to.eye().length(), "{now} after {far}");
            far = now;
            std::thread::sleep(glide.pause());
        }
        assert!(far > 2.0 * from.eye().length(), "it ended at {far}");
    }
}
