//! The command line: one module per subcommand, and modules that subcommands share.
//!
//! Results go to standard output or files; notes and errors go to standard error. The exit code is
//! 0 for success, 1 if a proof is missing under `--strict`, 2 for a user error, 3 for an internal
//! error and 130 after Ctrl-C.

mod animation;
mod arguments;
mod array;
mod claims;
mod completion;
mod data;
mod eval;
mod explain;
mod files;
mod gallery;
mod graphics;
#[cfg(feature = "window")]
mod help;
mod history;
mod interactive;
mod interrupt;
#[cfg(feature = "window")]
mod line_edit;
mod long_work;
mod measure;
mod mesh;
mod notes;
mod number;
mod output;
#[cfg(feature = "window")]
mod pick;
mod png_file;
mod point_array;
mod preview;
mod progress;
mod prompt;
mod render;
mod report;
mod sequence;
mod session;
mod sheet;
mod source;
mod stage;
mod subject;
mod terminal;
#[cfg(feature = "window")]
mod theme;
mod tips;
mod vector;
mod waiting;
mod watch;
#[cfg(feature = "window")]
mod window;

use anyhow::bail;
use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

/// The exit code for undecided pixels, and for unproven cells of a mesh, under `--strict`.
const UNDECIDED: u8 = 1;
const USER_ERROR: u8 = 2;
const INTERNAL_ERROR: u8 = 3;
/// The exit code after Ctrl-C, as shells have it: 128 and the number of the signal.
const INTERRUPTED: u8 = 130;

/// Runs the command line and returns the process's exit code.
pub fn run() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| {
        eprintln!("internal error: {panic}\nThis is a bug in zeroset, not in your formula.");
    }));
    match std::panic::catch_unwind(dispatch) {
        Ok(Ok(code)) => code,
        Ok(Err(error)) => {
            notes::error(&error);
            if let Some((_, meant)) = meant_command() {
                notes::note(&format!("did you mean the command `zeroset {meant}`?"));
            }
            ExitCode::from(USER_ERROR)
        }
        Err(_) => ExitCode::from(INTERNAL_ERROR),
    }
}

fn dispatch() -> anyhow::Result<ExitCode> {
    let arguments =
        match Arguments::try_parse_from(std::env::args_os().flat_map(split_attached_value)) {
            Ok(arguments) => arguments,
            Err(wrong) if wrong.use_stderr() => {
                if let Some((typed, _)) = meant_command() {
                    bail!("there is no command '{typed}'");
                }
                wrong.exit()
            }
            // Help and version go to standard output like any result.
            Err(help) => {
                output::written(help.print())?;
                return Ok(ExitCode::SUCCESS);
            }
        };
    match arguments.command {
        None => {
            if std::env::args_os().len() == 2
                && let Some((typed, _)) = meant_command()
                && zeroset_syntax::read(&typed, &zeroset_syntax::Options::default()).is_err()
            {
                bail!("'{typed}' is neither a command nor a formula");
            }
            interactive::run(&arguments.interactive)
        }
        Some(Command::Render(arguments)) => render::run(&arguments),
        Some(Command::Eval(arguments)) => eval::run(&arguments),
        Some(Command::Explain(arguments)) => explain::run(&arguments),
        Some(Command::Mesh(arguments)) => mesh::run(&arguments),
        Some(Command::Measure(arguments)) => measure::run(&arguments),
        Some(Command::Gallery(arguments)) => gallery::run(&arguments),
        Some(Command::Completions { shell }) => {
            let mut command = Arguments::command();
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut command, "zeroset", &mut script);
            output::print(&String::from_utf8_lossy(&script))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Writes a manual page for the program and one for each command into a directory.
///
/// # Errors
/// If a page cannot be written.
#[cfg(feature = "man")]
pub fn write_manual(directory: &Path) -> std::io::Result<()> {
    clap_mangen::generate_to(Arguments::command(), directory)
}

/// Writes scripts that complete the program's arguments into a directory, one for each shell, under
/// the name by which the shell finds it.
///
/// # Errors
/// If a script cannot be written.
#[cfg(feature = "man")]
pub fn write_completions(directory: &Path) -> std::io::Result<()> {
    use clap::ValueEnum;
    for shell in clap_complete::Shell::value_variants() {
        clap_complete::generate_to(*shell, &mut Arguments::command(), "zeroset", directory)?;
    }
    Ok(())
}

/// Returns the first argument, and the command that it probably means. `None` if it is a command, a
/// file, or not like any command.
fn meant_command() -> Option<(String, String)> {
    let typed = std::env::args_os().nth(1)?.into_string().ok()?;
    if Path::new(&typed).exists() {
        return None;
    }
    let meant = similar_command(&typed)?;
    Some((typed, meant))
}

/// Returns the command that differs from `typed` in few letters.
fn similar_command(typed: &str) -> Option<String> {
    let arguments = Arguments::command();
    let lower = typed.to_lowercase();
    let names = arguments.get_subcommands().map(clap::Command::get_name);
    let near = names.map(|name| (strsim::damerau_levenshtein(name, &lower), name));
    let (edits, name) = near.min()?;
    (name != typed && 4 * edits <= name.len()).then(|| name.to_owned())
}

/// Splits `-Dname=value` and `-ofile.png` into flag and value. Unsplit, they would be taken for
/// formulas, which may begin with `-`.
fn split_attached_value(argument: OsString) -> Vec<OsString> {
    if let Some(text) = argument.to_str() {
        let attached = |flag: &str| text.strip_prefix(flag).filter(|value| !value.is_empty());
        let is_file = |value: &&str| {
            let path = Path::new(value);
            zeroset_export::Format::of(path).is_ok()
                || path.extension().is_some_and(|e| e == "png" || e == "npy")
        };
        let is_definition = |value: &&str| {
            let name = value.split_once('=').map(|(name, _)| name);
            name.is_some_and(|name| name.bytes().all(|b| b.is_ascii_alphanumeric()))
        };
        let definition = attached("-D").filter(is_definition).map(|value| ("-D", value));
        let parts = definition.or_else(|| Some(("-o", attached("-o").filter(is_file)?)));
        if let Some((flag, value)) = parts {
            return vec![flag.into(), value.into()];
        }
    }
    vec![argument]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_command_is_recognized() {
        for (typed, meant) in [
            ("rendr", Some("render")),
            ("Render", Some("render")),
            ("redner", Some("render")),
            ("evla", Some("eval")),
            ("galery", Some("gallery")),
            ("mesure", Some("measure")),
            ("render", None),
            ("mesh", None),
            ("sphere", None),
            ("x^2+y^2+z^2=1", None),
            ("", None),
        ] {
            assert_eq!(similar_command(typed).as_deref(), meant, "{typed}");
        }
    }
}
