//! Checks native enclosures of functions of one variable at all finite floats. Prints a table.
//!
//! `cargo run --release -p zeroset-testkit --example exhaustive` takes some minutes per function.
//! With `-- --stride 65537 sin cos` it checks two functions, at every 65537th float.

mod sweep;

use std::process::ExitCode;
use std::time::Instant;
use sweep::{Function, functions};

const USAGE: &str = "usage: exhaustive [--stride N] [FUNCTION...]";

fn main() -> ExitCode {
    let (stride, chosen) = match arguments() {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("{message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    println!(
        "{:8}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}{:>10}{:>10}",
        "",
        "floats",
        "violations",
        "beyond 2^23",
        "unbounded",
        "too wide",
        "worst",
        "mean",
        "seconds"
    );
    let mut violations = 0;
    for function in chosen {
        let start = Instant::now();
        let report = function.sweep(stride);
        println!(
            "{:8}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}{:>10.4}{:>10.1}",
            function.name(),
            report.tried,
            report.violations,
            report.beyond,
            report.unbounded,
            report.wide,
            report.worst,
            report.mean(),
            start.elapsed().as_secs_f64(),
        );
        let places = [
            ("violation at", report.violation),
            ("worst at", report.worst_at),
            ("first wider than its row allows at", report.first_wide),
            ("first unbounded at", report.first_unbounded),
        ];
        for (what, place) in places {
            if let Some(x) = place {
                println!("        {what} {x:e} (bits {:#010x})", x.to_bits());
            }
        }
        violations += report.violations;
    }
    ExitCode::from(u8::from(violations > 0))
}

/// Returns the stride and the functions given on the command line.
fn arguments() -> Result<(u64, Vec<Function>), String> {
    let (mut stride, mut names) = (1, Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--stride" {
            let text = arguments.next().ok_or("--stride needs a number")?;
            stride = text.parse().map_err(|error| format!("--stride {text}: {error}"))?;
            if stride == 0 {
                return Err("--stride must be at least 1".into());
            }
        } else {
            names.push(argument);
        }
    }
    let mut all = functions();
    if let Some(name) = names.iter().find(|name| all.iter().all(|f| f.name() != **name)) {
        let known: Vec<_> = all.iter().map(|function| function.name()).collect();
        return Err(format!("no function {name}; there are {}", known.join(" ")));
    }
    all.retain(|function| names.is_empty() || names.iter().any(|n| *n == function.name()));
    Ok((stride, all))
}
