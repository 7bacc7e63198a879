//! The grid of configurations: each method, with each value of each option that it reads.

use std::fmt;
use zeroset_render::names::Named;
use zeroset_render::picture::Settings;
use zeroset_trace::{
    DEPTH, Method, MethodOption, PRECISION, Precision, STEPS, TOLERANCE, TraceOptions,
};

/// The values to measure for each option.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// Depths.
    pub depths: Vec<u32>,
    /// Tolerances, in pixels.
    pub tolerances: Vec<f64>,
    /// Numbers of steps along a ray.
    pub steps: Vec<u32>,
    /// Names of precisions.
    pub precisions: Vec<String>,
}

/// A method with some of its options set. An option that the method does not read is `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    /// The method.
    pub method: &'static Method,
    /// Precision of the kernels.
    pub precision: Option<Precision>,
    /// Number of times that the region is halved.
    pub depth: Option<u32>,
    /// Greatest error of a hit, in pixels.
    pub tolerance: Option<f64>,
    /// Number of steps along a ray.
    pub steps: Option<u32>,
}

/// The options of a method that the grid varies. On-off switches are left to `benches/frame.rs`. If
/// a method reads depth or steps, the tolerance only refines hits, so it is not varied.
fn varied(method: &'static Method) -> impl Iterator<Item = MethodOption> {
    let has_other = method.reads.iter().any(|option| [DEPTH, STEPS].contains(option));
    let is_varied = move |option: &MethodOption| {
        !option.axis.is_empty() && (*option != TOLERANCE || !has_other)
    };
    method.reads.iter().copied().filter(is_varied)
}

/// Every combination of the methods' varied options.
pub fn configurations(methods: &[&'static Method], values: &Values) -> Vec<Configuration> {
    let mut all = Vec::new();
    for method in methods {
        let plain = Configuration::plain(method);
        let mut of_method = vec![plain];
        for option in varied(method) {
            of_method =
                of_method.into_iter().flat_map(|one| one.with_each(option, values)).collect();
        }
        // A depth beyond the precision's limit gives the same picture as the limit.
        of_method.retain(|one| one.depth <= one.precision.map(Precision::max_depth).or(one.depth));
        all.extend(of_method);
    }
    all
}

impl Configuration {
    /// The method with default options.
    pub fn plain(method: &'static Method) -> Self {
        Self { method, precision: None, depth: None, tolerance: None, steps: None }
    }

    /// Copies of the configuration, one for each value of an option.
    fn with_each(self, option: MethodOption, values: &Values) -> Vec<Self> {
        let Values { depths, tolerances, steps, precisions } = values;
        if option == PRECISION {
            let precisions = precisions.iter().filter_map(|name| Precision::named(name));
            precisions.map(|value| Self { precision: Some(value), ..self }).collect()
        } else if option == DEPTH {
            depths.iter().map(|value| Self { depth: Some(*value), ..self }).collect()
        } else if option == STEPS {
            steps.iter().map(|value| Self { steps: Some(*value), ..self }).collect()
        } else if option == TOLERANCE {
            tolerances.iter().map(|value| Self { tolerance: Some(*value), ..self }).collect()
        } else {
            unreachable!("results have no column for {option:?}, which must have no axis")
        }
    }

    /// The value of a numeric option, if the configuration has one.
    pub fn number(&self, option: MethodOption) -> Option<f64> {
        self.numbers().find(|(other, ..)| *other == option).map(|(.., number)| number)
    }

    /// The numeric options that are set, with their names and values.
    fn numbers(&self) -> impl Iterator<Item = (MethodOption, &'static str, f64)> {
        let Self { method: _, precision: _, depth, tolerance, steps } = *self;
        let numbers = [
            (DEPTH, "depth", depth.map(f64::from)),
            (TOLERANCE, "tolerance", tolerance),
            (STEPS, "steps", steps.map(f64::from)),
        ];
        numbers.into_iter().filter_map(|(option, word, number)| Some((option, word, number?)))
    }

    /// The numeric options as text: d and the depth, t and the tolerance, s and the number of
    /// steps.
    pub fn label(&self) -> String {
        let numbers = self.numbers().map(|(_, word, number)| format!("{}{number}", &word[..1]));
        numbers.collect::<Vec<_>>().join(" ")
    }

    /// Settings of a square picture with this many pixels per side.
    pub fn settings(&self, size: usize) -> Settings {
        let plain = TraceOptions::default();
        let options = TraceOptions {
            precision: self.precision.unwrap_or(plain.precision),
            depth: self.depth.unwrap_or(plain.depth),
            tolerance: self.tolerance.unwrap_or(plain.tolerance),
            steps: self.steps.unwrap_or(plain.steps),
            ..plain
        };
        let method = self.method;
        Settings { width: size, height: size, method, options, ..Settings::default() }
    }

    /// The flags of `zeroset render` for this configuration.
    pub fn flags(&self) -> String {
        let flag = |option: MethodOption, value: String| format!(" --{} {value}", option.name);
        let precision = self.precision.map(|p| flag(PRECISION, p.to_string()));
        let numbers = self.numbers().map(|(option, _, number)| flag(option, number.to_string()));
        let flags: String = precision.into_iter().chain(numbers).collect();
        format!("--method {}{flags}", self.method.name)
    }
}

impl fmt::Display for Configuration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.method.name)?;
        for (_, word, number) in self.numbers() {
            write!(f, " {word} {number}")?;
        }
        self.precision.map_or(Ok(()), |precision| write!(f, " {precision}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_trace::METHODS;

    #[test]
    fn only_what_a_method_reads_is_varied() {
        let values = Values {
            depths: vec![6, 8, 10],
            tolerances: vec![1.0, 0.1],
            steps: vec![16, 64],
            precisions: vec!["f32".to_owned(), "auto".to_owned()],
        };
        for method in &METHODS {
            let all = configurations(&[method], &values);
            let number = |option| if option == DEPTH { 3 } else { 2 };
            let expected: usize = varied(method).map(number).product();
            assert_eq!(all.len(), expected, "{}", method.name);
            for one in all {
                let reads = |option| varied(method).any(|varied| varied == option);
                assert_eq!(one.depth.is_some(), reads(DEPTH));
                assert_eq!(one.tolerance.is_some(), reads(TOLERANCE));
                assert_eq!(one.steps.is_some(), reads(STEPS));
                assert_eq!(one.settings(32).method.name, method.name);
            }
        }
    }

    #[test]
    fn a_precision_is_not_asked_for_depths_beyond_it() {
        let knoll = Method::named("knoll").expect("a row");
        let values = Values {
            depths: vec![10, 30],
            tolerances: vec![],
            steps: vec![],
            precisions: vec!["f32".to_owned(), "f64".to_owned()],
        };
        assert_eq!(configurations(&[knoll], &values).len(), 3);
    }
}
