//! Sliders: values that can be moved by hand or by the clock, and their ranges. Moving a slider
//! edits the document. Knows no window and no mouse.

use super::draft::with_value;
use super::edit::base;
use super::pipeline::Rendering;
use super::session::Live;
use super::undo::{Checkpoint, Dragged, Gesture};
use super::values::{format_value, right_side};
use std::f64::consts::TAU;
use std::sync::Arc;
use zeroset_scene::number::nearest;
use zeroset_scene::view;
use zeroset_syntax::{Parameter, ParameterKind};

/// A movable value of the document that a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Slider {
    /// Name of the parameter in the document.
    pub name: String,
    /// Current value.
    pub value: f64,
    /// Lower end of the range.
    pub low: f64,
    /// Upper end of the range, above the lower end.
    pub high: f64,
    /// True for the slider of the time `t`, which the clock also moves.
    pub is_time: bool,
}

impl Slider {
    fn of(parameter: &Parameter) -> Self {
        let value = nearest(&parameter.value);
        let is_time = parameter.kind == ParameterKind::Time;
        let (low, high) = match &parameter.range {
            Some((low, high)) => (nearest(low), nearest(high)),
            None if is_time => (0.0, TAU),
            None => default_range(value),
        };
        // A value from the command line may lie outside the range.
        let (low, high) = (low.min(value), high.max(value));
        Self { name: parameter.name.clone(), value, low, high, is_time }
    }

    /// The line that defines the value with its range.
    pub fn definition(&self) -> String {
        let [value, low, high] = [self.value, self.low, self.high].map(format_value);
        format!("{} = {value} in [{low}, {high}]", self.name)
    }

    /// Returns whether the range has a positive width that is a finite float.
    fn is_usable(&self) -> bool {
        let width = self.high - self.low;
        width > 0.0 && width.is_finite()
    }

    /// Returns `value`, clamped to the range, or the slider's current value if `value` is NaN.
    fn within(&self, value: f64) -> f64 {
        let value = if value.is_nan() { self.value } else { value };
        value.max(self.low).min(self.high)
    }

    /// Clamps `value` to the range. Rounds it to as few digits as distinguish values that differ by
    /// `step`.
    pub fn rounded(&self, value: f64, step: f64) -> f64 {
        let value = self.within(value);
        let digits = self.digits(step);
        let text = if digits > 0 {
            format!("{value:.places$}", places = digits as usize)
        } else {
            let unit = 10_f64.powi(-digits);
            ((value / unit).round() * unit).to_string()
        };
        // The text is a formatted float, so parsing cannot fail.
        self.within(text.parse().unwrap_or(value))
    }

    /// Number of decimal places needed to distinguish values that differ by `step`. Negative
    /// numbers stand for tens (-1), hundreds (-2), and so on.
    fn digits(&self, step: f64) -> i32 {
        let step = step.max((self.high - self.low) * 1e-12).max(f64::MIN_POSITIVE);
        (-step.log10().floor()).clamp(-300.0, 17.0) as i32
    }

    /// The value as text, with as many decimals as `step` needs, up to 9. Very large and very small
    /// values have an exponent.
    pub fn shown(&self, step: f64) -> String {
        let value = self.value;
        let is_plain = value == 0.0 || (1e-4..1e6).contains(&value.abs());
        if !is_plain {
            return format!("{value:.3e}");
        }
        format!("{value:.places$}", places = self.digits(step).clamp(0, 9) as usize)
    }
}

/// The default range of a value: from 0 to twice the value, or [-1, 1] around 0.
fn default_range(value: f64) -> (f64, f64) {
    if value == 0.0 {
        (-1.0, 1.0)
    } else {
        let far = (2.0 * value).clamp(f64::MIN, f64::MAX);
        (far.min(0.0), far.max(0.0))
    }
}

impl Rendering {
    /// The sliders, in document order. The time has a slider if a surface depends on it.
    pub fn sliders(&self) -> Vec<Slider> {
        let document = &self.document;
        let moves =
            |one: &&Parameter| one.kind == ParameterKind::Slider || view::depends_on_time(document);
        document.parameters.iter().filter(moves).map(Slider::of).filter(Slider::is_usable).collect()
    }
}

impl Live {
    /// Sets the slider's value as dragging does, clamped to the slider's range. Returns the latest
    /// revision. If an edit blocks moves, the value is set after the edit. A definition without a
    /// range gets the slider's range, so that code is compiled once for all values.
    ///
    /// Consecutive calls are one step of [`Live::undo`].
    pub fn drag(&self, slider: &Slider, value: f64) -> u64 {
        self.request_value(slider, &format_value(slider.within(value)), true)
    }

    /// Like [`Live::drag`], but for the clock. It records no undo step.
    pub fn pass(&self, slider: &Slider, value: f64) -> u64 {
        self.request_value(slider, &format_value(slider.within(value)), false)
    }

    /// Restores the slider's value from before it was dragged. Returns whether it had been dragged.
    pub fn restore(&self, slider: &Slider) -> bool {
        let before = |one: &Dragged| (one.name == slider.name).then(|| one.value.clone());
        let Some(value) = self.lock().dragged.iter().find_map(before) else { return false };
        self.request_value(slider, &value, true);
        true
    }

    fn request_value(&self, slider: &Slider, value: &str, is_step: bool) -> u64 {
        let (slider, value) = (slider.clone(), value.to_owned());
        self.move_value(Gesture::Value(slider.name.clone()), move |live, gesture| {
            live.apply_value(&slider, &value, is_step, gesture);
        });
        self.revision()
    }

    fn apply_value(&self, slider: &Slider, value: &str, is_step: bool, gesture: Gesture) {
        let Slider { name, low, high, .. } = slider;
        let range = match (slider.is_time, *low, *high) {
            (true, 0.0, TAU) => "[0, 2pi]".to_owned(),
            (_, low, high) => format!("[{}, {}]", format_value(low), format_value(high)),
        };
        let moved = |Checkpoint { request, readable, .. }: &Checkpoint| {
            let base = base(request, readable, "");
            let typed = right_side(&request.text, name);
            Ok(with_value(&base, name, value, &range).map(|new| (new, typed)))
        };
        let _never_refused = self.change_after(moved, |state, moved| {
            let Some((text, typed)) = moved else { return };
            let text: Arc<str> = text.into();
            let before = is_step.then(|| state.checkpoint());
            if state.dragged.iter().all(|other| other.name != *name) {
                let given = state.request.overrides.iter().find(|(other, _)| other == name);
                let time = state.request.time.filter(|_| slider.is_time);
                let (typed, side) =
                    typed.unwrap_or_else(|| (format_value(slider.value), String::new()));
                let value = given.map(|(_, value)| value.clone()).or(time.map(format_value));
                let value = value.unwrap_or(typed);
                state.dragged.push(Dragged { name: name.clone(), value, side });
            }
            let is_typed = state.shown != state.request.text;
            let shown = is_typed.then(|| with_value(&state.shown, name, value, &range)).flatten();
            state.shown = shown.map_or_else(|| Arc::clone(&text), Arc::from);
            state.request.text = Arc::clone(&text);
            state.readable = text;
            state.request.forget_given(std::slice::from_ref(name));
            let before = before.unwrap_or_else(|| state.checkpoint());
            self.record(state, before, Some(gesture));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slider(low: f64, high: f64) -> Slider {
        Slider { name: "r".into(), value: low, low, high, is_time: false }
    }

    #[test]
    fn values_have_the_digits_that_pixels_can_tell_apart() {
        let five = slider(0.0, 5.0);
        assert_eq!(five.rounded(1.234_567, 0.04), 1.23);
        assert_eq!(five.rounded(1.234_567, 0.004), 1.235);
        assert_eq!(five.rounded(9.0, 0.04), 5.0);
        assert_eq!(slider(0.0, 50_000.0).rounded(12_345.0, 400.0), 12_300.0);
        assert_eq!(slider(0.0, 1.0 / 3.0).rounded(0.333_33, 0.002), 0.333);
        assert_eq!(Slider { value: 1.5, ..five.clone() }.shown(0.04), "1.50");
        assert_eq!(five.rounded(f64::NAN, 0.04), 0.0);
        assert_eq!(five.rounded(f64::INFINITY, f64::NAN), 5.0);
        assert_eq!(Slider { value: 2e-9, ..five }.shown(1e-10), "2.000e-9");
        assert!(slider(0.0, 5.0).is_usable() && !slider(1.0, 1.0).is_usable());
        assert!(!slider(-f64::MAX, f64::MAX).is_usable());
    }

    #[test]
    fn a_value_without_a_range_has_room_on_both_sides() {
        assert_eq!(
            [default_range(2.0), default_range(-0.5), default_range(0.0)],
            [(0.0, 4.0), (-1.0, 0.0), (-1.0, 1.0)]
        );
        assert!(default_range(f64::MAX).1.is_finite());
    }
}
