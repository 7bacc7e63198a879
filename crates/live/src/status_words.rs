//! The window's status line in plain words, and what the words mean.

use super::equivalents;
use super::pipeline::Rendering;
use super::status::ms;
use zeroset_render::picture::Settings;
use zeroset_trace::{METHODS, Proves, UndecidedReason};

/// Placeholder in [`WORDS`] for the name of the first method that proves hits and misses.
const PROVER: &str = "{prover}";

/// Words of the status line and their explanations.
const WORDS: [(&str, &str); 14] = [
    ("every pixel proven", "each pixel's ray is proven to meet the surface, or to miss it"),
    (
        "3 pixels undecided",
        "for these neither is proven; what is most likely is drawn, and F8 marks them",
    ),
    ("touching", "f comes as close to 0 there as can be computed, and no change of sign is proven"),
    ("perhaps undefined", "f may have no value there, as beyond the edge of sqrt(x)"),
    ("perhaps a jump", "f may jump past 0 there without meeting it, as floor(x) does"),
    ("out of time", "the budget for a ray was spent"),
    ("too steep", "no bound of f's slope is known there, which this method needs"),
    ("not examined", "a ray was left out, which is a flaw in this program: please report it"),
    (
        "only misses proven",
        "this method draws what it cannot prove: the method {prover} proves both",
    ),
    (
        "nothing proven",
        "this method samples and may miss thin parts: the method {prover} proves all",
    ),
    ("200x150 of 800x600 so far", "a coarse picture; the full one is being made"),
    (
        "90 pixels to be decided",
        "everything is drawn; the proof for these pixels takes longer, and is under way",
    ),
    ("tracing 40 %", "the stage of a picture that is late, and how much of the stage is done"),
    ("24 ms", "the time to find the surface and to color it"),
];

/// The explanation of the status line, and the table of equivalents in other programs.
pub fn status_words() -> String {
    format!("{}\n\nComing from another program\n{}", explained(), equivalents::listed())
}

/// The words of the status line, explained.
pub(super) fn explained() -> String {
    let mut provers = METHODS.iter().filter(|method| method.proves == Proves::HitsAndMisses);
    let prover = provers.next().map_or("", |method| method.name);
    let line = |(word, says): &(&str, &str)| format!("{word}\n  {says}").replace(PROVER, prover);
    let lines: Vec<String> = WORDS.iter().map(line).collect();
    format!("What the status line says\n{}", lines.join("\n"))
}

/// A short reason for undecided pixels.
fn why(reason: UndecidedReason) -> &'static str {
    match reason {
        UndecidedReason::None => "no reason known",
        UndecidedReason::Touching => "touching",
        UndecidedReason::Undefined => "perhaps undefined",
        UndecidedReason::Discontinuous => "perhaps a jump",
        UndecidedReason::Budget => "out of time",
        UndecidedReason::Unproven => "not proven",
        UndecidedReason::Steep => "too steep",
        UndecidedReason::Unseen => "not examined",
    }
}

impl Rendering {
    /// A short line in plain words: the progress, or else what is proven, with time and size. Names
    /// a method other than the default. For a blank picture, gives the reason.
    pub fn in_words(&self) -> String {
        if let Some(why) = self.why_blank() {
            return why;
        }
        let (buffer, full) = (&self.picture.buffer, &self.request.settings);
        let statistics = &self.picture.statistics;
        let size = format!("{}x{}", buffer.width, buffer.height);
        let mut parts = Vec::new();
        if !self.is_full() {
            parts.push(format!("{size} of {}x{} so far", full.width, full.height));
        } else if self.coarse {
            let open = self.picture.left_open();
            parts.push(format!("{open} pixel{} to be decided", if open == 1 { "" } else { "s" }));
        } else {
            parts.push(self.proven());
            parts.push(ms(statistics.times.trace + statistics.times.shade));
            parts.push(size);
        }
        if self.picture.flat {
            parts.insert(0, "f may be 0 everywhere".to_owned());
        }
        if !self.picture.fallbacks.is_empty() || full.method != Settings::default().method {
            parts.push(format!("method {}", self.picture.traced_by(full.method)));
        }
        parts.join(" · ")
    }

    /// Tells in words what is proven about the picture.
    fn proven(&self) -> String {
        let reasons = UndecidedReason::ALL.into_iter().zip(self.picture.buffer.reasons());
        let open: Vec<(UndecidedReason, usize)> = reasons.filter(|(_, count)| *count > 0).collect();
        let count = self.picture.statistics.pixels.undecided;
        let plural = if count == 1 { "" } else { "s" };
        match (&open[..], self.picture.method.proves) {
            ([], _) => "every pixel proven".to_owned(),
            ([(UndecidedReason::Unproven, _)], Proves::Nothing) => "nothing proven".to_owned(),
            ([(UndecidedReason::Unproven, _)], Proves::Misses) => "only misses proven".to_owned(),
            ([(reason, _)], _) => format!("{count} pixel{plural} undecided: {}", why(*reason)),
            (several, _) => {
                let part = |(reason, count): &(UndecidedReason, usize)| {
                    format!("{count} {}", why(*reason))
                };
                let parts: Vec<String> = several.iter().map(part).collect();
                format!("{count} pixels undecided: {}", parts.join(", "))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Live, Reply, Request};
    use glam::DVec3;
    use std::time::Duration;
    use zeroset_scene::camera::CameraChoice;
    use zeroset_space::Projection;

    fn said(text: &str, method: &str) -> String {
        let settings = Settings { width: 40, height: 30, ..Settings::default() };
        let live = Live::new(Request { text: text.into(), settings, ..Request::default() });
        live.enter(&format!(":method {method}")).expect("a method");
        assert!(live.wait(Duration::from_mins(1)));
        live.snapshot().rendering.expect("a picture").in_words()
    }

    #[test]
    fn a_picture_is_told_in_words_that_are_explained() {
        for (text, method, expected) in [
            ("x^2+y^2+z^2 = 1", "affine", "every pixel proven"),
            ("x^2+y^2+z^2 = 1", "knoll", "only misses proven"),
            ("x^2+y^2+z^2 = 1", "march", "nothing proven"),
            ("x^2+y^2+z^2 = 1\nmax(x+y, -x-y) = 0", "affine", "undecided: touching"),
        ] {
            let said = said(text, method);
            assert!(said.contains(expected), "{text} by {method}: {said}");
            assert!(said.contains(" ms · 40x30"), "{said}");
        }
        let all = explained();
        assert!(all.contains("the method affine proves both") && !all.contains('{'), "{all}");
        for reason in UndecidedReason::ALL.into_iter().filter(|one| *one != UndecidedReason::None) {
            assert!(all.contains(why(reason)) || reason == UndecidedReason::Unproven, "{reason:?}");
        }
        let hidden = said("hidden\nx^2+y^2+z^2 = 1", "affine");
        assert_eq!(hidden, "nothing is seen: every surface is hidden");
    }

    #[test]
    fn a_method_that_stands_in_for_another_is_named() {
        // From so far away, affine forms cannot tell where a ray is within the domain.
        let choice = CameraChoice {
            eye: Some(DVec3::new(1e14, 0.0, 0.0)),
            target: Some(DVec3::ZERO),
            up: Some(DVec3::Z),
            projection: Some(Projection::Orthographic { height: 2.5 }),
            ..CameraChoice::default()
        };
        let settings = Settings { width: 40, height: 30, ..Settings::default() };
        let text = "x^2+y^2+z^2 = 1".into();
        let live = Live::new(Request { text, choice, settings, ..Request::default() });
        assert!(live.wait(Duration::from_mins(1)));
        let Ok(Reply::Say(status)) = live.enter(":status") else { panic!("no status") };
        assert!(status.contains("method      knoll instead of affine, "), "{status}");
        assert!(
            status.contains("note        surface 1 was traced by knoll, not affine"),
            "{status}"
        );
        let rendering = live.snapshot().rendering.expect("a picture");
        for line in [rendering.in_words(), rendering.summary()] {
            assert!(line.contains("knoll instead of affine"), "{line}");
        }
        // Two surfaces, of which it stands in for the second.
        let mut picture = rendering.picture.clone();
        let affine = rendering.request.settings.method;
        (picture.method, picture.fallbacks[0].0) = (affine, 1);
        assert_eq!(picture.traced_by(affine), "affine, surface 2 by knoll");
        picture.fallbacks.clear();
        assert_eq!(picture.traced_by(affine), "affine");
    }
}
