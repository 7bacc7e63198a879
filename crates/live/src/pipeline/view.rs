//! The camera of a picture: the user's orbit, or a camera fitted to the surface. A fitted camera
//! holds still while values are moved, and then glides to the next one.

use super::glide::Glide;
use super::worker::{Asked, Framed, Made, Shot, Worker, coarser};
use super::{NextView, Reason, Request};
use std::sync::Arc;
use zeroset_render::framing;
use zeroset_scene::view::SceneError;
use zeroset_trace::Camera;

impl Worker {
    /// The camera for a request, after the pictures of a glide if one is due. `None` if the request
    /// is no longer wanted.
    pub fn camera(&mut self, shot: &Shot<'_>) -> Result<Option<Camera>, Reason> {
        if let Some(orbit) = &shot.job.request.orbit {
            return Ok(Some(orbit.camera(&shot.made.seat)?));
        }
        let before = self.framed.as_ref().map(|one| (one.formula, one.asked, one.camera));
        let Some(camera) = self.framed(shot)? else { return Ok(None) };
        if let (Some(framed), Some((formula, asked, from))) = (&self.framed, before)
            && (framed.formula, framed.asked) == (formula, asked)
            && let Some(glide) = Glide::new(from, camera)
            && self.shared.lock().next_view == NextView::Glides
            && !self.glide(shot, &glide)?
        {
            return Ok(None);
        }
        let mut state = self.shared.lock();
        if state.next_view == NextView::Glides {
            state.next_view = NextView::Unmoved;
        }
        Ok(Some(camera))
    }

    /// Draws coarse pictures along a glide. Returns whether the request is still wanted.
    fn glide(&mut self, shot: &Shot<'_>, glide: &Glide) -> Result<bool, Reason> {
        let full = &shot.job.request.settings;
        let settings = coarser(full, self.pace.first(full.width * full.height)).plain();
        let wanted = |_| self.shared.wanted(shot.job);
        while let Some(camera) = glide.camera() {
            let picture = shot.made.model.trace(&camera, &settings, &wanted)?;
            if !wanted(0) {
                // The next glide starts from the visible camera.
                if let Some(framed) = &mut self.framed {
                    (framed.camera, framed.arrived) = (camera, false);
                }
                return Ok(false);
            }
            self.publish(Arc::new(shot.rendering(camera, picture, true)));
            self.rest(shot.job, glide.pause());
        }
        Ok(wanted(0))
    }

    /// The automatic camera: fitted once per model, and kept while only parameters move.
    fn framed(&mut self, shot: &Shot<'_>) -> Result<Option<Camera>, SceneError> {
        let Shot { job, document, made: Made { model, formula, .. }, .. } = shot;
        let formula = *formula;
        let Request { choice, settings, axes, .. } = &*job.request;
        let axes = axes.are_shown(document);
        let asked = Asked { choice: *choice, size: (settings.width, settings.height), axes };
        if let Some(framed) = self.framed.as_ref().filter(|framed| framed.asked == asked) {
            let is_fitted = framed.arrived
                && (std::ptr::eq(framed.model.as_ptr(), Arc::as_ptr(model))
                    || model.is_rebound()
                        && framed.formula == formula
                        && framed.region == *model.region());
            let mut state = self.shared.lock();
            let stays = state.moving && framed.formula == formula;
            if stays && !is_fitted {
                state.next_view = NextView::Outgrown;
            }
            if is_fitted || stays {
                return Ok(Some(framed.camera));
            }
        }
        let wanted = || self.shared.wanted(job);
        let region = model.region();
        let camera = if axes {
            Some(framing::of_domain(region, document, choice, settings)?)
        } else {
            framing::camera_while(model, document, choice, settings, &wanted)?
        };
        let (model, region) = (Arc::downgrade(model), *region);
        let framed = |camera| Framed { model, region, formula, asked, camera, arrived: true };
        self.framed = camera.map(framed);
        Ok(camera)
    }
}
