//! The command `zeroset-chart`: runs a subcommand, and prints its output or its error.

use anyhow::Result;
use clap::Parser;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;
use zeroset_chart::arguments::{ChartArguments, ChartCommand};
use zeroset_chart::charts::draw_all;
use zeroset_chart::check::check;
use zeroset_chart::page::write_page;
use zeroset_chart::parts::parts;
use zeroset_chart::rays::rays;
use zeroset_chart::run::run;
use zeroset_chart::stability::stability;
use zeroset_chart::store::Store;

/// Exit code of `check` if counts or hashes differ.
const DIFFERS: u8 = 1;
/// Exit code for errors that the user can fix.
const USER_ERROR: u8 = 2;

fn main() -> ExitCode {
    let mut text = String::new();
    let code = dispatch(&ChartArguments::parse(), &mut text).unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(USER_ERROR)
    });
    // A closed pipe is no error.
    let _ = std::io::stdout().write_all(text.as_bytes());
    code
}

/// The command line of this process.
fn command() -> String {
    let words: Vec<String> = std::env::args().skip(1).collect();
    format!("zeroset-chart {}", words.join(" "))
}

fn draw(directory: &Path, text: &mut String) -> Result<()> {
    let store = Store::existing(directory)?;
    let charts = store.path("charts");
    writeln!(text, "{} charts are in {}", draw_all(&store.rows, &charts)?, charts.display())?;
    writeln!(text, "everything is on {}", write_page(&store)?.display())?;
    Ok(())
}

/// Runs the subcommand, and adds its output to `text`.
fn dispatch(arguments: &ChartArguments, text: &mut String) -> Result<ExitCode> {
    match &arguments.command {
        ChartCommand::Run(arguments) => {
            let new = run(arguments)?;
            writeln!(text, "{new} rows are new in {}", arguments.output.display())?;
            Store::existing(&arguments.output)?.keep_command(&command())?;
            draw(&arguments.output, text)?;
        }
        ChartCommand::Stability(arguments) => text.push_str(&stability(arguments)?),
        ChartCommand::Parts(arguments) => text.push_str(&parts(arguments)?),
        ChartCommand::Rays(arguments) => text.push_str(&rays(arguments)?),
        ChartCommand::Draw { directory } => draw(directory, text)?,
        ChartCommand::Check { directory } => {
            let found = check(directory)?;
            for line in &found.counts {
                writeln!(text, "differs: {line}")?;
            }
            for line in &found.times {
                writeln!(text, "slower or faster: {line}")?;
            }
            let (rows, counts, times) = (found.rows, found.counts.len(), found.times.len());
            writeln!(
                text,
                "{rows} rows measured again: {counts} counts or hashes and {times} times differ"
            )?;
            if counts > 0 {
                return Ok(ExitCode::from(DIFFERS));
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}
