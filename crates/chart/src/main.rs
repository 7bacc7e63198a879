//! The command `zeroset-chart`: all that knows arguments and a terminal.

use anyhow::Result;
use clap::Parser;
use std::path::Path;
use std::process::ExitCode;
use zeroset_chart::arguments::{Arguments, Command};
use zeroset_chart::charts::draw_all;
use zeroset_chart::check::check;
use zeroset_chart::growth::growth;
use zeroset_chart::page::write_page;
use zeroset_chart::rays::rays;
use zeroset_chart::rigour::rigour;
use zeroset_chart::run::run;
use zeroset_chart::stability::stability;
use zeroset_chart::store::Store;

/// What was counted differs.
const DIFFERS: u8 = 1;
/// What was asked for cannot be done as asked.
const USER_ERROR: u8 = 2;

fn main() -> ExitCode {
    dispatch(&Arguments::parse()).unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(USER_ERROR)
    })
}

/// The line that started this.
fn command() -> String {
    let words: Vec<String> = std::env::args().skip(1).collect();
    format!("zeroset-chart {}", words.join(" "))
}

fn draw(directory: &Path) -> Result<()> {
    let store = Store::existing(directory)?;
    let charts = store.path("charts");
    println!("{} charts are in {}", draw_all(&store.rows, &charts)?, charts.display());
    println!("everything is on {}", write_page(&store)?.display());
    Ok(())
}

fn dispatch(arguments: &Arguments) -> Result<ExitCode> {
    match &arguments.command {
        Command::Run(arguments) => {
            let new = run(arguments)?;
            println!("{new} rows are new in {}", arguments.output.display());
            Store::existing(&arguments.output)?.keep_command(&command())?;
            draw(&arguments.output)?;
        }
        Command::Stability(arguments) => print!("{}", stability(arguments)?),
        Command::Rigour(arguments) => print!("{}", rigour(arguments)?),
        Command::Compile(arguments) => print!("{}", growth(arguments)?),
        Command::Rays(arguments) => print!("{}", rays(arguments)?),
        Command::Draw { directory } => draw(directory)?,
        Command::Check { directory } => {
            let found = check(directory)?;
            for line in &found.counts {
                println!("differs: {line}");
            }
            for line in &found.times {
                println!("slower or faster: {line}");
            }
            let (rows, counts, times) = (found.rows, found.counts.len(), found.times.len());
            println!(
                "{rows} rows measured again: {counts} counts or hashes and {times} times differ"
            );
            if counts > 0 {
                return Ok(ExitCode::from(DIFFERS));
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}
