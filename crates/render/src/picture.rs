//! From a document to a picture: simplify, compile, trace, shade, and account for all of it.

use crate::overlay::Legend;
use glam::DVec3;
use std::ops::AddAssign;
use std::time::{Duration, Instant};
use zeroset_scene::kernels::Made;
use zeroset_shade::{LinearRgb, Pattern, UndecidedStyle, hand_back_colors};
use zeroset_style::Look;
use zeroset_trace::{
    Fallback, GBuffer, KernelStats, Method, PixelCounts, Proves, Status, TraceOptions,
    UndecidedReason,
};

pub use zeroset_trace::Precision;

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // choices that have nothing to do with each other
pub struct Settings {
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// How surfaces are found.
    pub method: &'static Method,
    /// The options of the method.
    pub options: TraceOptions,
    /// Whether another picture follows: places that are hard to decide are painted, and left
    /// undecided, sooner.
    pub is_preview: bool,
    /// Whether the brackets of hits are kept.
    pub brackets: bool,
    /// Whether normals are kept that no further step needs. A picture without them is made faster,
    /// but has to be traced again to be relit or settled.
    pub keeps_normals: bool,
    /// How long surfaces may be looked for: what was not reached by then is undecided and not
    /// painted.
    pub budget: Option<Duration>,
    /// When the budget's time began; `None` if it begins with the picture.
    pub begun: Option<Instant>,
    /// The same depth for shadow rays; `None` for no shadows.
    pub shadow_depth: Option<u32>,
    /// Where normals come from; `None` if neither colors nor normals are wanted.
    pub normals: Option<Normals>,
    /// How undecided pixels are drawn.
    pub undecided: UndecidedStyle,
    /// Lighting and background; `None` for what the document says, else the
    /// first of the looks.
    pub look: Option<&'static Look>,
    /// Whether what is near takes light away, if the look has that.
    pub occlusion: bool,
    /// Over which rays the color of a pixel with an edge is a mean. What is known of pixels is
    /// about the ray through their centre in any case.
    pub antialias: Pattern,
    /// The light's place; `None` for far above and left of the camera.
    pub light: Option<DVec3>,
    /// Share of the light that comes from everywhere, within [0, 1]; `None` for the look's.
    pub ambient: Option<f32>,
    /// Shown where there is nothing; `None` for what the document says, else the look's.
    pub background: Option<LinearRgb>,
}

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// The exact derivative.
    Gradient,
    /// Differences of values, as in Knoll et al. 2007.
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
            budget: None,
            begun: None,
            shadow_depth: None,
            normals: Some(Normals::Gradient),
            undecided: UndecidedStyle::Shade,
            light: None,
            look: None,
            occlusion: false,
            antialias: Pattern::ONE,
            ambient: None,
            background: None,
        }
    }
}

impl Settings {
    /// Halvings of a shadow ray's way, unless told otherwise: one fewer than of a ray from the eye.
    pub fn usual_shadow_depth(&self) -> u32 {
        self.options.depth.saturating_sub(1).max(1)
    }

    /// The same with all of the budget's time from now on.
    #[must_use]
    pub fn begin(&self) -> Self {
        Self { begun: Some(Instant::now()), ..self.clone() }
    }

    /// Tells whether there is time left for a picture, of which this is the beginning if it was
    /// not begun before.
    pub fn has_time(&self) -> impl Fn() -> bool + Sync + use<> {
        self.has_time_for(1.0)
    }

    /// Tells whether there is time left to choose where to look, or from where: each may take as
    /// much as a quarter of what is left now, so that most of it is the picture's.
    pub fn has_time_to_choose(&self) -> impl Fn() -> bool + Sync + use<> {
        self.has_time_for(0.25)
    }

    fn has_time_for(&self, share: f64) -> impl Fn() -> bool + Sync + use<> {
        let now = Instant::now();
        let end = self.budget.and_then(|budget| self.begun.unwrap_or(now).checked_add(budget));
        let end = end.map(|end| now + end.saturating_duration_since(now).mul_f64(share));
        move || end.is_none_or(|end| Instant::now() < end)
    }

    /// The same with the light and the finish of others.
    #[must_use]
    pub fn lit_as(&self, others: &Self) -> Self {
        Self {
            shadow_depth: others.shadow_depth,
            undecided: others.undecided,
            look: others.look,
            occlusion: others.occlusion,
            antialias: others.antialias,
            light: others.light,
            ambient: others.ambient,
            background: others.background,
            ..self.clone()
        }
    }

    /// The same without what only makes a picture look better, and takes longer than all else.
    #[must_use]
    pub fn plain(&self) -> Self {
        let antialias = Pattern::ONE;
        Self { shadow_depth: None, occlusion: false, antialias, ..self.clone() }
    }
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What is known of each pixel.
    pub buffer: GBuffer,
    /// Red, green and blue bytes (sRGB) of each pixel; empty if colors were not asked for.
    pub rgb: Vec<u8>,
    /// The method that traced the surfaces: another one than that of the settings if all were traced
    /// by a fallback.
    pub method: &'static Method,
    /// The surfaces, by number, that another method than that of the settings traced.
    pub fallbacks: Vec<(usize, Fallback)>,
    /// What kernels computed in.
    pub precision: Precision,
    /// How it is lit.
    pub look: &'static Look,
    /// What tells which value has which color; empty if no color is that of a value.
    pub legends: Vec<Legend>,
    /// What it took.
    pub statistics: Statistics,
    /// Whether some surface is proven to have no value anywhere in the domain.
    pub undefined: bool,
    /// One line for each surface whose function is constant on the domain.
    pub remarks: Vec<String>,
    /// Whether some surface's function could not be told from 0 wherever it was looked at: it may
    /// be 0 everywhere.
    pub flat: bool,
}

impl Picture {
    /// The same without its rows.
    pub(crate) fn without_rows(mut self) -> Self {
        let buffer = GBuffer::new(self.buffer.width, 0, 0);
        std::mem::replace(&mut self.buffer, buffer).hand_back();
        hand_back_colors(std::mem::take(&mut self.rgb));
        self
    }

    /// Counts what another part of the same picture took.
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
        // A later part may have asked for more of them.
        (all.code_bytes, all.kernels) = (part.code_bytes, part.kernels.clone());
        self.flat |= other.flat;
    }

    /// How many pixels are open only because this is a preview or time was short.
    pub fn left_open(&self) -> usize {
        self.statistics.open.reasons[UndecidedReason::Budget as usize]
    }

    /// Of each pixel, row by row, whether it is open only because this is a preview or time was
    /// short.
    pub(crate) fn unsettled(&self) -> impl Iterator<Item = bool> + '_ {
        (0..self.buffer.status.len())
            .map(|pixel| self.buffer.reason(pixel) == UndecidedReason::Budget)
    }

    /// Leaves the memory to the next pictures, which then are made faster. Up to two pictures' is
    /// kept, until the end of the process.
    pub fn hand_back(self) {
        self.buffer.hand_back();
        hand_back_colors(self.rgb);
    }

    /// Why pixels are undecided, and how many for each reason, in one line; `None` if none are.
    pub fn why_undecided(&self) -> Option<String> {
        let counts = self.statistics.open.reasons;
        let parts: Vec<(UndecidedReason, usize)> =
            UndecidedReason::ALL.into_iter().zip(counts).filter(|(_, count)| *count > 0).collect();
        if let [(UndecidedReason::Unproven, _)] = parts[..] {
            let why = match self.method.proves {
                Proves::Nothing => {
                    "this method proves nothing of rays that meet the domain, but where the domain \
                     cuts a solid"
                }
                Proves::Misses | Proves::HitsAndMisses => {
                    "this method proves misses, and hits only where the domain cuts a solid"
                }
            };
            return Some(why.to_owned());
        }
        let parts: Vec<String> = parts
            .into_iter()
            .map(|(reason, count)| format!("{count} {}", reason.describe()))
            .collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }
}

/// What a picture took to make.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Time to simplify, compile, trace and shade.
    pub times: Times,
    /// Pixels by what is proven.
    pub pixels: PixelCounts,
    /// What is known of undecided pixels.
    pub open: Open,
    /// Calls of kernels and lanes they computed, but for edges.
    pub work: KernelStats,
    /// Further rays that were followed for the colors of pixels with edges.
    pub edge_rays: usize,
    /// Size of all machine code, in bytes.
    pub code_bytes: usize,
    /// The kernels that were made for it, or earlier.
    pub kernels: Vec<Made>,
    /// Nodes of the graph as typed, and after simplification.
    pub nodes: (usize, usize),
}

/// What is known of undecided pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Open {
    /// How many there are for each of [`UndecidedReason::ALL`].
    pub reasons: [usize; UndecidedReason::ALL.len()],
    /// How many are not painted, but for those of which that is said otherwise: rays of a method
    /// that proves nothing, or along which no bound of the slope is known.
    pub blank: usize,
    /// How many of these were not reached in time.
    pub unreached: usize,
}

impl Open {
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
    /// Graph to simplified graph.
    pub simplify: Duration,
    /// Graph to native code.
    pub compile: Duration,
    /// Rays to distances.
    pub trace: Duration,
    /// Distances to normals and colors.
    pub shade: Duration,
    /// What is near to what, and shadows.
    pub occlude: Duration,
    /// Further rays where there are edges.
    pub antialias: Duration,
}

impl AddAssign for Times {
    /// Adds the times that parts of one picture take; kernels are made once.
    fn add_assign(&mut self, part: Self) {
        self.trace += part.trace;
        self.shade += part.shade;
        self.occlude += part.occlude;
        self.antialias += part.antialias;
    }
}
