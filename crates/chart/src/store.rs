//! A directory of results. `rows.csv` repeats the rows of `rows.json`.

use crate::error::ChartError;
use crate::files::{write, write_csv};
use crate::row::Row;
use std::fs;
use std::path::{Path, PathBuf};

/// A directory of results.
#[derive(Clone, Debug)]
pub struct Store {
    directory: PathBuf,
    /// The rows so far.
    pub rows: Vec<Row>,
}

impl Store {
    /// Opens the results in `directory`. If it has no file of rows, there are no results.
    ///
    /// # Errors
    /// If the rows cannot be read.
    pub fn open(directory: &Path) -> Result<Self, ChartError> {
        if directory.join(ROWS).exists() {
            return Self::existing(directory);
        }
        Ok(Self { directory: directory.to_owned(), rows: Vec::new() })
    }

    /// Opens the results in `directory`, which must have some.
    ///
    /// # Errors
    /// If there are no results, or they cannot be read.
    pub fn existing(directory: &Path) -> Result<Self, ChartError> {
        let path = directory.join(ROWS);
        let bytes = fs::read(&path).map_err(ChartError::of_file(&path))?;
        let rows = serde_json::from_slice(&bytes).map_err(ChartError::of_content(&path))?;
        Ok(Self { directory: directory.to_owned(), rows })
    }

    /// Path of a file in the directory.
    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    /// The commands that produced the results, one per line.
    pub fn commands(&self) -> String {
        fs::read_to_string(self.path(COMMANDS)).unwrap_or_default()
    }

    /// Adds a command to the list, unless the list has it.
    ///
    /// # Errors
    /// If the list cannot be written.
    pub fn keep_command(&self, command: &str) -> Result<(), ChartError> {
        let mut commands = self.commands();
        if !commands.lines().any(|line| line == command) {
            commands += command;
            commands += "\n";
        }
        write(&self.path(COMMANDS), commands.as_bytes())
    }

    /// Writes all rows.
    ///
    /// # Errors
    /// If they cannot be written.
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
