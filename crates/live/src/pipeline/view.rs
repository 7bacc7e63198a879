//! The camera of a picture: the user's orbit, or a camera fitted to the surface. A fitted camera
//! holds still while values are moved. Afterwards it glides to its new place.

use super::glide::Glide;
use super::worker::{AnchoredModel, FitKey, FittedCamera, JobContext, Worker, coarser};
use super::{FaultReason, NextView, Request};
use std::sync::Arc;
use std::time::{Duration, Instant};
use zeroset_render::framing;
use zeroset_render::progress::Done;
use zeroset_scene::view::SceneError;
use zeroset_space::Camera;

/// If a camera takes longer to fit than this, and longer than all work before it, a coarse picture
/// of the whole region comes first.
const FRAMING: Duration = Duration::from_millis(100);

impl Worker {
    /// Returns the camera for a request. If a glide is due, draws its pictures first. `None` if the
    /// request is obsolete.
    pub fn camera(&mut self, context: &JobContext<'_>) -> Result<Option<Camera>, FaultReason> {
        if let Some(orbit) = &context.job.request.orbit {
            return Ok(Some(orbit.camera(&context.made.view_anchor)?));
        }
        let before = self.framed.as_ref().map(|one| (one.formula, one.key, one.camera));
        let Some(camera) = self.framed(context)? else { return Ok(None) };
        if let (Some(framed), Some((formula, key, from))) = (&self.framed, before)
            && (framed.formula, framed.key) == (formula, key)
            && let Some(glide) = Glide::new(from, camera)
            && self.shared.lock().next_view == NextView::Gliding
            && !self.glide(context, &glide)?
        {
            return Ok(None);
        }
        let mut state = self.shared.lock();
        if state.next_view == NextView::Gliding {
            state.next_view = NextView::Immediate;
        }
        Ok(Some(camera))
    }

    /// Draws coarse pictures along a glide. Returns whether the request is still wanted.
    fn glide(&mut self, context: &JobContext<'_>, glide: &Glide) -> Result<bool, FaultReason> {
        let full = &context.job.request.settings;
        let settings = coarser(full, self.pace.first(full.width * full.height)).plain();
        let wanted = |_| self.shared.wanted(context.job);
        while let Some(camera) = glide.camera() {
            let picture = context.made.model.trace(&camera, &settings, &wanted)?;
            if !wanted(Done::NOTHING) {
                // Begin the next glide at this camera, whose picture is visible.
                if let Some(framed) = &mut self.framed {
                    (framed.camera, framed.arrived) = (camera, false);
                }
                return Ok(false);
            }
            self.publish(Arc::new(context.rendering(camera, picture, true)));
            self.rest(context.job, glide.pause());
        }
        Ok(wanted(Done::NOTHING))
    }

    /// The automatic camera. It is fitted once per model, and kept while parameters are moving.
    fn framed(&mut self, context: &JobContext<'_>) -> Result<Option<Camera>, SceneError> {
        let JobContext { job, document, made: AnchoredModel { model, formula, .. }, .. } = context;
        let formula = *formula;
        let Request { choice, settings, axes, .. } = &*job.request;
        let axes = axes.are_shown(document);
        let key = FitKey { choice: *choice, size: (settings.width, settings.height), axes };
        if let Some(framed) = self.framed.as_ref().filter(|framed| framed.key == key) {
            let is_fitted = framed.arrived
                && (std::ptr::eq(framed.model.as_ptr(), Arc::as_ptr(model))
                    || model.is_rebound()
                        && framed.formula == formula
                        && framed.region == *model.region());
            let mut state = self.shared.lock();
            // A clock's region holds its whole movement, which the view shows from the start.
            let is_played = state.played.is_some() && framed.region != *model.region();
            let stays = state.moving && framed.formula == formula && !is_played;
            if stays && !is_fitted {
                state.next_view = NextView::Deferred;
            }
            if is_fitted || stays {
                return Ok(Some(framed.camera));
            }
        }
        let wanted = || self.shared.wanted(job);
        let begun = Instant::now();
        let patience = FRAMING.max(job.requested.elapsed());
        let soon = || wanted() && begun.elapsed() < patience;
        let mut camera = framing::camera_while(model, choice, settings, axes, &soon)?;
        if camera.is_none() && wanted() {
            self.shared.begin("framing");
            let whole = framing::whole(model, choice)?;
            let small = coarser(settings, self.pace.first(settings.width * settings.height));
            let picture = model.trace(&whole, &small.plain(), &|_| wanted())?;
            if !wanted() {
                return Ok(None);
            }
            self.publish(Arc::new(context.rendering(whole, picture, true)));
            camera = framing::camera_while(model, choice, settings, axes, &wanted)?;
        }
        let (model, region) = (Arc::downgrade(model), *model.region());
        let framed = |camera| FittedCamera { model, region, formula, key, camera, arrived: true };
        self.framed = camera.map(framed);
        Ok(camera)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Live, Request};
    use std::thread;
    use std::time::{Duration, Instant};
    use zeroset_render::framing;
    use zeroset_render::picture::Settings;

    /// A Mandelbulb of two rounds. Tracing it from several sides to fit a camera takes long.
    const SLOW: &str = "domain 1.2\n\
        r = sqrt(x^2+y^2+z^2); a = 8.1 acos(z/r); b = 8.1 atan2(y, x)\n\
        u = r^8 sin(a) cos(b) + x; v = r^8 sin(a) sin(b) + y; w = r^8 cos(a) + z\n\
        s = sqrt(u^2+v^2+w^2); c = 8.1 acos(w/s); d = 8.1 atan2(v, u)\n\
        (s^8 sin(c) cos(d) + x)^2 + (s^8 sin(c) sin(d) + y)^2 + (s^8 cos(c) + z)^2 = 4";

    #[test]
    fn a_camera_that_takes_long_to_fit_is_not_waited_for() {
        let settings = Settings { width: 40, height: 30, ..Settings::default() };
        let live = Live::new(Request { text: SLOW.into(), settings, ..Request::default() });
        let begun = Instant::now();
        let next = |is_wanted: &dyn Fn(&zeroset_space::Camera) -> bool| {
            loop {
                let seen = live.snapshot().rendering;
                if let Some(seen) = seen.filter(|seen| is_wanted(&seen.camera)) {
                    return seen;
                }
                assert!(begun.elapsed() < Duration::from_mins(1), "no picture");
                thread::sleep(Duration::from_millis(1));
            }
        };
        let first = next(&|_| true);
        let whole = framing::whole(&first.model, &first.request.choice).expect("a camera");
        assert!(first.coarse && first.camera == whole, "{:?}", first.camera);
        next(&|camera| *camera != whole);
    }
}
