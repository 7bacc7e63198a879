//! Settings of a picture, the finished picture, and its statistics.

use crate::legend::Legend;
use crate::limit::Limit;
use crate::pixels::{flattened, samples};
use crate::png_file::PngFormat;
use glam::DVec3;
use std::borrow::Cow;
use std::ops::AddAssign;
use std::time::Duration;
use zeroset_scene::kernels::CompiledKernel;
use zeroset_shade::{Pattern, UndecidedStyle, hand_back_colors};
use zeroset_style::{Choices, Look};
use zeroset_syntax::Background;
use zeroset_trace::{
    Fallback, GBuffer, KernelStats, Method, PixelCounts, Proves, Status, TraceOptions,
    UndecidedReason,
};

pub use zeroset_shade::ColorDepth;
pub use zeroset_trace::Precision;

/// Largest number of pixels of a picture that is held whole. A pixel takes some fifty to a hundred
/// bytes.
pub const MOST_PIXELS_HELD: usize = 1 << 26;

/// Settings of a picture.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // choices that have nothing to do with each other
pub struct Settings {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Method that finds surfaces.
    pub method: &'static Method,
    /// Options of the method.
    pub options: TraceOptions,
    /// Set if a finer picture follows. Rays that are slow to decide then stay undecided, but are
    /// painted.
    pub is_preview: bool,
    /// Set to keep the brackets of hits.
    pub brackets: bool,
    /// Set to keep the picture's normals in any case. A picture without normals is drawn faster,
    /// but [`Model::relight`](crate::model::Model::relight) and `settle` must trace it again.
    pub keeps_normals: bool,
    /// When tracing ends early. Pixels not reached by then are undecided and unpainted.
    pub limit: Limit,
    /// Number of halvings along shadow rays, of pictures with shadows. `None` for the usual number.
    pub shadow_depth: Option<u32>,
    /// Source of normals. `None` if neither colors nor normals are wanted.
    pub normals: Option<Normals>,
    /// The style of undecided pixels.
    pub undecided: UndecidedStyle,
    /// Lighting and background. `None` for the document's look, or else the first of all looks.
    pub look: Option<&'static Look>,
    /// Set to compute ambient occlusion, if the look has it.
    pub occlusion: bool,
    /// Pattern of rays through a pixel on an edge. The pixel gets their mean color. Proofs always
    /// concern the ray through the center of the pixel.
    pub antialias: Pattern,
    /// Position of the light. `None` for a light far above and to the left of the camera.
    pub light: Option<DVec3>,
    /// Choices that override the document's.
    pub choices: Choices,
    /// Background. `None` for the document's, or else the look's color.
    pub background: Option<Background>,
    /// The format in which colors are kept: bytes or floats. With floats, the picture also has
    /// [`Picture::light`].
    pub depth: ColorDepth,
}

/// Source of normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// The exact derivative.
    Gradient,
    /// Central differences of values, as in Knoll et al. 2007.
    Central,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            method: Default::default(),
            options: TraceOptions::default(),
            is_preview: false,
            brackets: false,
            keeps_normals: true,
            limit: Limit::default(),
            shadow_depth: None,
            normals: Some(Normals::Gradient),
            undecided: UndecidedStyle::Shade,
            light: None,
            look: None,
            occlusion: false,
            antialias: Pattern::ONE,
            choices: Choices::default(),
            background: None,
            depth: ColorDepth::Bytes,
        }
    }
}

impl Settings {
    /// Default number of halvings along a shadow ray: one less than along camera rays.
    pub fn usual_shadow_depth(&self) -> u32 {
        self.options.depth.saturating_sub(1).max(1)
    }

    /// Returns whether a picture has a transparent background. `typed` is the document's
    /// background.
    pub fn is_transparent(&self, typed: Option<Background>) -> bool {
        self.background.or(typed) == Some(Background::Transparent)
    }

    /// These settings, with the fields of `other` that only affect how a traced picture is painted:
    /// light, look, background, antialiasing and color format.
    #[must_use]
    pub fn painted_as(&self, other: &Self) -> Self {
        Self {
            shadow_depth: other.shadow_depth,
            undecided: other.undecided,
            look: other.look,
            occlusion: other.occlusion,
            antialias: other.antialias,
            light: other.light,
            choices: other.choices,
            background: other.background,
            depth: other.depth,
            ..self.clone()
        }
    }

    /// The choices without shadows, unless the document has them.
    pub(crate) fn unshadowed(&self) -> Choices {
        Choices { shadows: self.choices.shadows.filter(|on| !on), ..self.choices }
    }

    /// These settings without shadows, ambient occlusion and antialiasing, which take the most
    /// time.
    #[must_use]
    pub fn plain(&self) -> Self {
        Self {
            choices: self.unshadowed(),
            occlusion: false,
            antialias: Pattern::ONE,
            ..self.clone()
        }
    }
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The results for each pixel.
    pub buffer: GBuffer,
    /// Red, green and blue bytes (sRGB) of each pixel. Empty if no colors were requested.
    pub rgb: Vec<u8>,
    /// Opacity of each pixel; 255 means opaque. Empty unless the background is transparent.
    pub alpha: Vec<u8>,
    /// Red, green and blue light of each pixel (primaries of sRGB, 1 at full), then its opacity.
    /// Empty unless colors are kept as floats.
    pub light: Vec<[f32; 4]>,
    /// The share of the unshadowed light that reaches the ground at each pixel; NaN far from where
    /// the ground is seen. Empty without a ground, and for strips.
    pub(crate) ground: Vec<f32>,
    /// Color of pixels that show no surface, as sRGB bytes. It is the look's if the background is
    /// transparent.
    pub(crate) background: [u8; 3],
    /// The method that traced the surfaces. It is a fallback only if that traced all surfaces.
    pub method: &'static Method,
    /// The surfaces that a fallback method traced, by number, with their fallbacks.
    pub fallbacks: Vec<(usize, Fallback)>,
    /// Precision of the kernels.
    pub precision: Precision,
    /// Lighting and background.
    pub look: &'static Look,
    /// Legends of the color maps. Empty if no color depends on a value.
    pub legends: Vec<Legend>,
    /// Times and counts.
    pub statistics: Statistics,
    /// Set if some surface's function is proven undefined in the whole region.
    pub undefined: bool,
    /// Remarks: one line for each surface whose function is constant in the region, and one if
    /// there was no time to compute the colors of all points.
    pub remarks: Vec<String>,
    /// Set if some surface's function may be 0 everywhere, since it cannot be distinguished from 0
    /// at any sampled point.
    pub flat: bool,
}

impl Picture {
    /// A note for each surface that a fallback traced in the place of the method `requested`.
    pub fn fallback_notes(&self, requested: &Method) -> Vec<String> {
        let note = |(surface, fallback): &(usize, Fallback)| {
            let (method, why) = (fallback.method.name, &fallback.why);
            format!("surface {} was traced by {method}, not {}: {why}", surface + 1, requested.name)
        };
        self.fallbacks.iter().map(note).collect()
    }

    /// The methods that traced the surfaces if the method `requested` was asked for, in a few
    /// words.
    pub fn traced_by(&self, requested: &Method) -> String {
        let (method, asked) = (self.method.name, requested.name);
        if method != asked {
            return format!("{method} instead of {asked}");
        }
        let other = |(surface, fallback): &(usize, Fallback)| {
            format!(", surface {} by {}", surface + 1, fallback.method.name)
        };
        std::iter::once(asked.to_owned()).chain(self.fallbacks.iter().map(other)).collect()
    }

    /// The method that traced the surface with this number.
    pub fn method_of(&self, surface: usize) -> &'static Method {
        let fallback = self.fallbacks.iter().find(|(fallen, _)| *fallen == surface);
        fallback.map_or(self.method, |(_, fallback)| fallback.method)
    }

    /// Colors for a medium that has no opacities: a transparent background becomes the look's
    /// background.
    pub fn opaque_rgb(&self) -> Cow<'_, [u8]> {
        flattened(&self.rgb, &self.alpha, self.background)
    }

    /// The format of the picture's PNG file.
    pub fn png_format(&self) -> PngFormat {
        PngFormat::of(&self.alpha, &self.light)
    }

    /// The channels of the pixels, as a PNG stores them: sixteen bits each if colors are floats, or
    /// else eight.
    pub fn samples(&self) -> Cow<'_, [u8]> {
        samples(&self.rgb, &self.alpha, &self.light)
    }

    /// The same picture without its rows.
    pub(crate) fn without_rows(mut self) -> Self {
        let buffer = GBuffer::new(self.buffer.width, 0, 0);
        std::mem::replace(&mut self.buffer, buffer).hand_back();
        hand_back_colors(std::mem::take(&mut self.rgb));
        self.alpha.clear();
        self.light = Vec::new();
        self.ground = Vec::new();
        self
    }

    /// Adds the statistics of another strip of the same picture.
    pub(crate) fn add(&mut self, other: &Self) {
        let (all, part) = (&mut self.statistics, &other.statistics);
        all.times += part.times;
        let Statistics { pixels, open, .. } = part;
        all.pixels += *pixels;
        all.open.reasons.iter_mut().zip(open.reasons).for_each(|(all, part)| *all += part);
        all.open.blank += open.blank;
        all.open.unreached += open.unreached;
        all.work += part.work;
        all.edge_rays += part.edge_rays;
        // A later strip may have compiled further kernels.
        (all.code_bytes, all.kernels) = (part.code_bytes, part.kernels.clone());
        self.flat |= other.flat;
        let known: Vec<usize> = self.fallbacks.iter().map(|(surface, _)| *surface).collect();
        let is_new = |(surface, _): &&(usize, Fallback)| !known.contains(surface);
        self.fallbacks.extend(other.fallbacks.iter().filter(is_new).cloned());
        let is_new = |remark: &&String| !self.remarks.contains(remark);
        let new: Vec<String> = other.remarks.iter().filter(is_new).cloned().collect();
        self.remarks.extend(new);
    }

    /// Number of pixels that are undecided only because the preview or the budget ended the search.
    pub fn left_open(&self) -> usize {
        self.statistics.open.reasons[UndecidedReason::Budget as usize]
    }

    /// For each pixel, whether it is undecided only because the preview or the budget ended the
    /// search. Row by row from the top.
    pub(crate) fn open_mask(&self) -> impl Iterator<Item = bool> + '_ {
        (0..self.buffer.status.len())
            .map(|pixel| self.buffer.reason(pixel) == UndecidedReason::Budget)
    }

    /// Hands the memory back for later pictures, which are then faster. The memory of up to two
    /// pictures is kept until the process ends.
    pub fn hand_back(self) {
        self.buffer.hand_back();
        hand_back_colors(self.rgb);
    }

    /// The reasons for undecided pixels with their counts, in one line. `None` if every pixel is
    /// decided.
    pub fn why_undecided(&self) -> Option<String> {
        let counts = self.statistics.open.reasons;
        let parts: Vec<(UndecidedReason, usize)> =
            UndecidedReason::ALL.into_iter().zip(counts).filter(|(_, count)| *count > 0).collect();
        if let [(UndecidedReason::Unproven, _)] = parts[..] {
            // Some surfaces may have been traced by a fallback, which then left these pixels
            // undecided.
            let fallback = self.fallbacks.first().map(|(_, fallback)| fallback.method);
            let who = fallback.map_or("this method", |method| method.name);
            let what = match fallback.unwrap_or(self.method).proves {
                Proves::Nothing => {
                    "proves nothing of rays that meet the domain, but where the domain cuts a solid"
                }
                Proves::Misses | Proves::HitsAndMisses => {
                    "proves misses, and hits only where the domain cuts a solid"
                }
            };
            return Some(format!("{who} {what}"));
        }
        let parts: Vec<String> = parts
            .into_iter()
            .map(|(reason, count)| format!("{count} {}", reason.describe()))
            .collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }
}

/// Times and counts of a picture.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Times of the stages.
    pub times: Times,
    /// Numbers of pixels by status.
    pub pixels: PixelCounts,
    /// Statistics of undecided pixels.
    pub open: UndecidedStatistics,
    /// Evaluations of kernels, except for antialiasing.
    pub work: KernelStats,
    /// Number of rays for antialiasing.
    pub edge_rays: usize,
    /// Total size of machine code, in bytes.
    pub code_bytes: usize,
    /// All kernels compiled so far, for this picture or earlier ones.
    pub kernels: Vec<CompiledKernel>,
    /// Number of nodes in the graph, first as typed and then simplified.
    pub nodes: (usize, usize),
}

/// Statistics of undecided pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UndecidedStatistics {
    /// Number of pixels for each of [`UndecidedReason::ALL`].
    pub reasons: [usize; UndecidedReason::ALL.len()],
    /// Number of undecided pixels that are not painted. Two kinds do not count: pixels that a
    /// method without proofs leaves unproven, and pixels whose rays have no bound of the slope.
    pub blank: usize,
    /// Number of these `blank` pixels that were not reached in time.
    pub unreached: usize,
}

impl UndecidedStatistics {
    pub(crate) fn of(buffer: &GBuffer, proves: Proves) -> Self {
        let blank = |pixel: &usize| {
            let is_said = match buffer.reason(*pixel) {
                UndecidedReason::Unproven => proves == Proves::Nothing,
                reason => reason == UndecidedReason::Steep,
            };
            buffer.status[*pixel] == Status::Undecided && !buffer.is_drawn(*pixel) && !is_said
        };
        let is_unreached = |pixel: &usize| {
            buffer.reason(*pixel) == UndecidedReason::Budget && buffer.distance(*pixel) == 0.0
        };
        let blank: Vec<usize> = (0..buffer.status.len()).filter(blank).collect();
        let unreached = blank.iter().filter(|pixel| is_unreached(pixel)).count();
        Self { reasons: buffer.reasons(), blank: blank.len(), unreached }
    }
}

/// Wall-clock times of the stages.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    /// Simplifying the graph.
    pub simplify: Duration,
    /// Compiling native code for the first picture.
    pub compile: Duration,
    /// Tracing rays.
    pub trace: Duration,
    /// Computing normals and colors.
    pub shade: Duration,
    /// Ambient occlusion and shadows.
    pub occlude: Duration,
    /// Rays for antialiasing.
    pub antialias: Duration,
}

impl AddAssign for Times {
    /// Adds the times of another strip. The strips share simplifying and compiling.
    fn add_assign(&mut self, part: Self) {
        self.trace += part.trace;
        self.shade += part.shade;
        self.occlude += part.occlude;
        self.antialias += part.antialias;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draft_has_no_shadows_that_were_turned_off() {
        let with = |shadows| {
            let choices = Choices { shadows, ..Choices::default() };
            Settings { choices, ..Settings::default() }
        };
        assert_eq!(with(Some(false)).plain(), with(Some(false)));
        assert_eq!(with(Some(true)).plain(), with(None));
    }
}
