//! Runs the real binary in a temporary directory, with a time limit.

use crate::surroundings::zeroset;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Time limit far above every duration here, even on a slow and busy machine.
const LIMIT: Duration = Duration::from_mins(1);

/// A temporary directory, in which the program runs.
pub struct Sandbox {
    directory: tempfile::TempDir,
    /// A run that takes longer fails the test.
    pub limit: Duration,
}

pub struct Run {
    pub code: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Sandbox {
    pub fn new() -> Self {
        Self { directory: tempfile::tempdir().expect("a temporary directory"), limit: LIMIT }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// The picture in a file.
    pub fn picture(&self, name: &str) -> image::RgbImage {
        image::open(self.path(name)).expect("a picture").to_rgb8()
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        std::fs::write(self.path(name), content).expect("written");
        self.path(name)
    }

    /// The file names in the directory, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.directory.path()).expect("a directory");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Runs `zeroset` with these arguments and this standard input.
    pub fn run_with(&self, arguments: &[impl AsRef<std::ffi::OsStr>], input: &[u8]) -> Run {
        // Standard streams are files, so the test and the program cannot block each other.
        let outside = tempfile::tempdir().expect("a temporary directory");
        let file = |name: &str| outside.path().join(name);
        std::fs::write(file("in"), input).expect("written");
        let create = |path: &Path| std::fs::File::create(path).expect("created");
        let mut child = zeroset(&[], &file("data"))
            .args(arguments)
            .current_dir(self.directory.path())
            .stdin(Stdio::from(std::fs::File::open(file("in")).expect("opened")))
            .stdout(Stdio::from(create(&file("out"))))
            .stderr(Stdio::from(create(&file("err"))))
            .spawn()
            .expect("the program starts");
        let started = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().expect("waited for") {
                break status;
            }
            if started.elapsed() > self.limit {
                child.kill().expect("ended");
                child.wait().expect("waited for");
                panic!("still running after {:?}", self.limit);
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        Run {
            code: status.code(),
            stdout: std::fs::read(file("out")).expect("read"),
            stderr: String::from_utf8(std::fs::read(file("err")).expect("read"))
                .expect("messages are UTF-8"),
        }
    }

    pub fn run(&self, arguments: &[impl AsRef<std::ffi::OsStr>]) -> Run {
        self.run_with(arguments, b"")
    }
}

impl Run {
    /// Returns the run, and asserts that it succeeded.
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).expect("UTF-8")
    }

    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).expect("one JSON object")
    }
}
