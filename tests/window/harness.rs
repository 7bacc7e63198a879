//! A harness for tests that are passed to it. It behaves like libtest, but ignores tests whose
//! programs are missing.

use clap::{CommandFactory, FromArgMatches};
use libtest_mimic::{Arguments, Completion, Trial};
use std::collections::BTreeSet;
use std::process::ExitCode;

/// A program that tests run, with the Debian packages that it needs.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Program {
    name: &'static str,
    packages: &'static str,
}

impl Program {
    /// The X server, with the libraries by which the window speaks to it.
    pub const XVFB: Self = Self { name: "Xvfb", packages: "xvfb libx11-6 libxcursor1" };
    pub const XDOTOOL: Self = Self { name: "xdotool", packages: "xdotool" };
    /// Puts texts on the clipboard, and reads them from there.
    pub const XCLIP: Self = Self { name: "xclip", packages: "xclip" };
    /// A window manager.
    pub const OPENBOX: Self = Self { name: "openbox", packages: "openbox" };
    pub const XPROP: Self = Self { name: "xprop", packages: "x11-utils" };
    pub const SETSID: Self = Self { name: "setsid", packages: "util-linux" };

    fn is_missing(&self) -> bool {
        let path = std::env::var_os("PATH").unwrap_or_default();
        !std::env::split_paths(&path).any(|place| place.join(self.name).is_file())
    }
}

/// Tests with their names, and the programs that each of these tests runs.
pub struct Group {
    pub programs: &'static [Program],
    pub tests: &'static [(&'static str, fn())],
}

/// Returns the arguments and the filters. `libtest_mimic` takes one filter and one spelling of
/// `--no-capture`; libtest takes several filters and both spellings.
fn arguments() -> (Arguments, Vec<String>) {
    let command = Arguments::command()
        .mut_arg("filter", |filter| filter.num_args(0..))
        .mut_arg("nocapture", |flag| flag.alias("no-capture"));
    let mut matches = command.get_matches();
    let filters = matches.remove_many("filter").into_iter().flatten().collect();
    let mut arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let threads = || std::env::var("RUST_TEST_THREADS").ok()?.parse().ok();
    arguments.test_threads = arguments.test_threads.or_else(threads);
    (arguments, filters)
}

/// Runs the tests that the arguments select.
pub fn run(groups: &[Group]) -> ExitCode {
    let (mut arguments, filters) = arguments();
    let is_ci = std::env::var_os("CI").is_some();
    let must_run = is_ci || arguments.ignored || arguments.include_ignored;
    let mut missing = BTreeSet::new();
    let mut trials = Vec::new();
    for group in groups {
        let lacks: Vec<_> = group.programs.iter().filter(|program| program.is_missing()).collect();
        let names: Vec<_> = lacks.iter().map(|program| program.name).collect();
        let reason = (!lacks.is_empty()).then(|| format!("needs {}", names.join(", ")));
        // Runners that list the ignored tests, such as nextest, do not run the listed tests.
        let is_marked = reason.is_some() && !is_ci && (arguments.list || arguments.ignored);
        trials.extend(group.tests.iter().map(|&(name, test)| {
            let reason = reason.clone();
            let trial = Trial::ignorable_test(name, move || match reason {
                Some(reason) if must_run => Err(reason.into()),
                Some(reason) => Ok(Completion::ignored_with(reason)),
                None => {
                    test();
                    Ok(Completion::Completed)
                }
            });
            trial.with_ignored_flag(is_marked)
        }));
        missing.extend(lacks);
    }
    if !filters.is_empty() {
        let is_selected = |trial: &&Trial| {
            filters.iter().any(|filter| {
                let filter = Some(filter.clone());
                !Arguments { filter, ..arguments.clone() }.is_filtered_out(trial)
            })
        };
        let others = trials.iter().filter(|trial| !is_selected(trial));
        let skip = others.map(|trial| trial.name().to_owned()).collect();
        arguments = Arguments { skip, exact: true, ..arguments };
    }
    let conclusion = libtest_mimic::run(&arguments, trials);
    if !missing.is_empty() && conclusion.num_ignored + conclusion.num_failed > 0 {
        let join = |part: fn(&Program) -> &'static str| {
            missing.iter().copied().map(part).collect::<Vec<_>>()
        };
        eprintln!(
            "Tests of the window did not run, since programs are missing: {}. To install them on \
             Debian or Ubuntu:\n\n    apt-get install {}\n",
            join(|program| program.name).join(", "),
            join(|program| program.packages).join(" ")
        );
    }
    conclusion.exit_code()
}
