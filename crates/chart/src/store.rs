//! A directory of results: `rows.json` and the same as `rows.csv`. Files appear whole or not at all.

use crate::charts::charts;
use crate::error::ChartError;
use crate::page::page;
use crate::plot::draw;
use crate::progress::progress;
use crate::row::Row;
use serde::Serialize;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A directory of results.
#[derive(Clone, Debug)]
pub struct Store {
    directory: PathBuf,
    /// What was found so far.
    pub rows: Vec<Row>,
}

/// Writes a file in one step.
///
/// # Errors
/// If that is impossible.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), ChartError> {
    let refuse = ChartError::of_file(path);
    let directory = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(directory).map_err(&refuse)?;
    let mut builder = tempfile::Builder::new();
    // As readable as any other file; a temporary one would be its owner's alone.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(directory).map_err(&refuse)?;
    file.write_all(bytes).map_err(&refuse)?;
    file.persist(path).map_err(|error| refuse(error.error))?;
    Ok(())
}

/// Writes rows as a table with a head, in one step.
///
/// # Errors
/// If that is impossible.
pub fn write_csv<R: Serialize>(
    path: &Path,
    rows: impl IntoIterator<Item = R>,
) -> Result<(), ChartError> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    for row in rows {
        csv.serialize(row).map_err(ChartError::of_content(path))?;
    }
    write(path, &csv.into_inner().map_err(ChartError::of_content(path))?)
}

impl Store {
    /// The results in `directory`, which may be none and need not be there.
    ///
    /// # Errors
    /// If there are some that cannot be read.
    pub fn open(directory: &Path) -> Result<Self, ChartError> {
        let path = directory.join(ROWS);
        let rows = if path.exists() { read(&path)? } else { Vec::new() };
        Ok(Self { directory: directory.to_owned(), rows })
    }

    /// The results in `directory`, where there must be some.
    ///
    /// # Errors
    /// If there are none, or they cannot be read.
    pub fn existing(directory: &Path) -> Result<Self, ChartError> {
        let rows = read(&directory.join(ROWS))?;
        Ok(Self { directory: directory.to_owned(), rows })
    }

    /// Where a file of this name belongs.
    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    /// The commands that results are of, a line each.
    pub fn commands(&self) -> String {
        fs::read_to_string(self.path(COMMANDS)).unwrap_or_default()
    }

    /// Keeps a command, unless it is there already.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep_command(&self, command: &str) -> Result<(), ChartError> {
        let mut commands = self.commands();
        if !commands.lines().any(|line| line == command) {
            commands += command;
            commands += "\n";
        }
        write(&self.path(COMMANDS), commands.as_bytes())
    }

    /// Writes `index.html`, on which everything is.
    ///
    /// # Errors
    /// If something cannot be drawn or written.
    pub fn write_page(&self) -> Result<PathBuf, ChartError> {
        let bar = progress(self.rows.len());
        let advance = |surface: &str| {
            bar.set_message(format!("pictures of {surface}"));
            bar.inc(self.rows.iter().filter(|row| row.surface == surface).count() as u64);
        };
        let path = self.path("index.html");
        write(&path, page(self, &advance)?.as_bytes())?;
        bar.finish_and_clear();
        Ok(path)
    }

    /// Draws all charts that the rows can fill, into the directory `charts`; returns how many.
    ///
    /// # Errors
    /// If one cannot be drawn or written.
    pub fn draw(&self) -> Result<usize, ChartError> {
        let charts = charts(&self.rows);
        for chart in &charts {
            let path = self.path("charts").join(&chart.name).with_extension("svg");
            write(&path, draw(&chart.figure)?.as_bytes())?;
        }
        Ok(charts.len())
    }

    /// Writes all rows.
    ///
    /// # Errors
    /// If that is impossible.
    pub fn save(&self) -> Result<(), ChartError> {
        let path = self.path(ROWS);
        let mut json =
            serde_json::to_vec_pretty(&self.rows).map_err(ChartError::of_content(&path))?;
        json.push(b'\n');
        write(&path, &json)?;
        write_csv(&self.path("rows.csv"), &self.rows)
    }
}

const ROWS: &str = "rows.json";
const COMMANDS: &str = "commands.txt";

fn read(path: &Path) -> Result<Vec<Row>, ChartError> {
    let bytes = fs::read(path).map_err(ChartError::of_file(path))?;
    serde_json::from_slice(&bytes).map_err(ChartError::of_content(path))
}
