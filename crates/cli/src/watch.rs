//! Watches a file for changes, however an editor saves it.
//!
//! The directory is watched instead of the file, so that a replaced, deleted or renamed file is
//! found again. This module does not interpret the text.

use super::source::{self, Source};
use anyhow::{Context, Result, anyhow};
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

/// The file is read when there was no event for this long, since editors save in several steps.
const QUIET: Duration = Duration::from_millis(25);
/// During a steady stream of events, the file is read at this interval.
const RESTLESS: Duration = Duration::from_millis(200);
/// Interval at which the file is checked without events, since some file systems report none.
const POLL: Duration = Duration::from_secs(1);

/// A change of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// The file's new text, perhaps incomplete.
    Text(String),
    /// The file cannot be read any more, for this reason.
    Lost(String),
    /// The file can be read again. If its text is another one, that is reported next.
    Found,
}

enum Message {
    Event,
    Stop,
}

/// A running watch. Dropping it ends the watch.
pub struct Watch {
    // Held only because dropping it ends the events.
    _watcher: Option<RecommendedWatcher>,
    stop: Sender<Message>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Calls `report` on a new thread whenever the file's text has changed. At first, the file's
    /// text is compared with `text`. An empty file is ignored, since some editors empty a file
    /// before writing it.
    ///
    /// # Errors
    /// If the file's directory cannot be named.
    pub fn start(
        path: &Path,
        text: &str,
        report: impl FnMut(Change) + Send + 'static,
    ) -> Result<Self> {
        let path = std::path::absolute(path).context("cannot name the file's directory")?;
        let directory = path.parent().context("the file has no directory")?.to_owned();
        let (stop, messages) = channel();
        let events = stop.clone();
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            // Reading the file causes an event, which must not cause another read.
            if event.map_or(true, |event| !event.kind.is_access() || is_close(&event)) {
                let _ = events.send(Message::Event);
            }
        });
        // If events are not available, the regular checks remain.
        let watcher = watcher.ok().and_then(|mut watcher| {
            watcher.watch(&directory, RecursiveMode::NonRecursive).ok()?;
            Some(watcher)
        });
        let mut watched =
            WatchedFile { path, text: text.to_owned(), lost: None, stamp: None, report };
        let thread = std::thread::spawn(move || watched.run(&messages));
        Ok(Self { _watcher: watcher, stop, thread: Some(thread) })
    }
}

/// Whether the event tells that a writer has closed the file.
fn is_close(event: &notify::Event) -> bool {
    use notify::event::{AccessKind, AccessMode, EventKind};
    event.kind == EventKind::Access(AccessKind::Close(AccessMode::Write))
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.stop.send(Message::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct WatchedFile<R> {
    path: PathBuf,
    text: String,
    /// The reason why the file cannot be read, if so.
    lost: Option<String>,
    stamp: Option<(SystemTime, u64)>,
    report: R,
}

impl<R: FnMut(Change)> WatchedFile<R> {
    /// Checks the file after each event and at regular intervals, until a message to stop arrives.
    fn run(&mut self, messages: &Receiver<Message>) {
        // The file may have changed between reading it and the start of the watch.
        self.check_file();
        loop {
            match messages.recv_timeout(POLL) {
                Ok(Message::Event) => {
                    let first = Instant::now();
                    while first.elapsed() < RESTLESS {
                        match messages.recv_timeout(QUIET) {
                            Ok(Message::Event) => {}
                            Err(RecvTimeoutError::Timeout) => break,
                            Ok(Message::Stop) | Err(RecvTimeoutError::Disconnected) => return,
                        }
                    }
                    self.check_file();
                }
                Err(RecvTimeoutError::Timeout) => {
                    if self.stamp() != self.stamp {
                        self.check_file();
                    }
                }
                Ok(Message::Stop) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn stamp(&self) -> Option<(SystemTime, u64)> {
        let found = std::fs::metadata(&self.path).ok()?;
        Some((found.modified().ok()?, found.len()))
    }

    fn check_file(&mut self) {
        self.stamp = self.stamp();
        let read = match std::fs::metadata(&self.path) {
            // Opening a pipe would wait for whoever writes to it.
            Ok(found) if !found.is_file() => {
                Err(anyhow!("'{}' is not a file any more", self.path.display()))
            }
            _ => source::open(&self.path),
        };
        match read {
            Ok(Source { text, .. }) => {
                if self.lost.take().is_some() {
                    (self.report)(Change::Found);
                }
                if text != self.text && !text.trim().is_empty() {
                    self.text.clone_from(&text);
                    (self.report)(Change::Text(text));
                }
            }
            // A file that cannot be read is reported once for each reason.
            Err(error) => {
                let reason = format!("{error:#}");
                if self.lost.as_ref() != Some(&reason) {
                    self.lost = Some(reason.clone());
                    (self.report)(Change::Lost(reason));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::io::Write;
    use std::sync::Arc;
    use zeroset_live::{DocumentSource, Live, Request};
    use zeroset_render::picture::Settings;

    const LIMIT: Duration = Duration::from_secs(30);

    struct WatchedFile {
        directory: tempfile::TempDir,
        live: Arc<Live>,
        _watch: Watch,
    }

    fn watched(text: &str) -> WatchedFile {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("surface.zset");
        std::fs::write(&path, text).expect("written");
        let settings = Settings {
            options: zeroset_trace::TraceOptions { depth: 6, ..Default::default() },
            width: 24,
            height: 24,
            ..Settings::default()
        };
        let live = Live::new(Request { text: text.into(), settings, ..Request::default() });
        let live = Arc::new(live);
        let target = Arc::clone(&live);
        let watch = Watch::start(&path, text, move |change| {
            if let Change::Text(text) = change {
                target.load(DocumentSource::Typed, &text, true);
            }
        });
        WatchedFile { directory, live, _watch: watch.expect("watched") }
    }

    impl WatchedFile {
        fn path(&self) -> PathBuf {
            self.directory.path().join("surface.zset")
        }

        /// Waits until the fine picture of `text` is shown. Asserts that there always is a picture.
        fn follows(&self, text: &str) {
            let until = Instant::now() + LIMIT;
            loop {
                assert!(self.live.wait(LIMIT));
                let seen = self.live.snapshot();
                let frame = seen.rendering.expect("there always is a picture");
                if *frame.request.text == *text && !frame.coarse {
                    assert!(seen.fault.is_none());
                    return;
                }
                assert!(Instant::now() < until, "still {:?}, not {text:?}", frame.request.text);
                std::thread::sleep(Duration::from_millis(2));
            }
        }
    }

    fn overwrite(path: &Path, text: &str) {
        std::fs::write(path, text).expect("written");
    }

    /// Renames a new file over the old one, like vim and many other editors.
    fn rename_over(path: &Path, text: &str) {
        let other = path.with_extension("swp");
        overwrite(&other, text);
        std::fs::rename(other, path).expect("renamed");
    }

    /// Moves the old file away first, like vim with a backup.
    fn move_away(path: &Path, text: &str) {
        let backup = path.with_extension("zset~");
        std::fs::rename(path, &backup).expect("renamed");
        overwrite(path, text);
        std::fs::remove_file(backup).expect("removed");
    }

    /// Writes the text in two halves, with a pause before each. In between, the file is incomplete.
    fn piecemeal(path: &Path, text: &str) {
        let mut file = File::create(path).expect("created");
        for half in [&text[..text.len() / 2], &text[text.len() / 2..]] {
            // Time is what makes pieces of one write.
            std::thread::sleep(QUIET * 2);
            file.write_all(half.as_bytes()).expect("written");
            file.flush().expect("written");
        }
    }

    fn delete_and_return(path: &Path, text: &str) {
        std::fs::remove_file(path).expect("removed");
        // Time is what makes a file gone, and not just replaced.
        std::thread::sleep(QUIET * 2);
        overwrite(path, text);
    }

    #[test]
    fn every_style_of_saving_is_followed() {
        let file = watched("x^2+y^2+z^2 = 1");
        file.follows("x^2+y^2+z^2 = 1");
        file.live.turn(|orbit| orbit.turn(10.0, 5.0, 24));
        file.live.wait(LIMIT);
        let camera = file.live.snapshot().rendering.expect("a picture").camera;
        let styles = [overwrite, rename_over, move_away, piecemeal, delete_and_return];
        for (number, save) in (0..10).zip(styles.into_iter().cycle()) {
            let text = format!("domain 2\nx^2+y^2+(z-{number}/10)^2 = 1 # {number}");
            save(&file.path(), &text);
            file.follows(&text);
        }
        let last = file.live.snapshot().rendering.expect("a picture").camera;
        let turn = |camera: &zeroset_space::Camera| camera.basis().forward;
        assert!((turn(&camera) - turn(&last)).length() < 1e-9, "the view has moved");
    }

    #[test]
    fn a_broken_or_missing_file_keeps_the_picture() {
        let file = watched("x^2+y^2+z^2 = 1");
        file.follows("x^2+y^2+z^2 = 1");
        let good = file.live.snapshot().rendering.expect("a picture").picture.rgb.clone();
        for broken in ["x^2+(", "\u{0}", "domain 2\nx^2+unknown"] {
            overwrite(&file.path(), broken);
            let until = Instant::now() + LIMIT;
            while file.live.snapshot().fault.is_none_or(|fault| *fault.request.text != *broken) {
                assert!(Instant::now() < until, "no error for {broken:?}");
                std::thread::sleep(Duration::from_millis(2));
            }
            assert_eq!(file.live.snapshot().rendering.expect("kept").picture.rgb, good);
        }
        overwrite(&file.path(), "");
        // Nothing tells that a file is not taken over, so time must pass.
        std::thread::sleep(QUIET * 4);
        std::fs::remove_file(file.path()).expect("removed");
        std::thread::sleep(QUIET * 4);
        assert_eq!(file.live.snapshot().rendering.expect("kept").picture.rgb, good);
        overwrite(&file.path(), "x = y");
        file.follows("x = y");
    }

    #[test]
    fn a_file_that_returns_is_reported_whether_its_text_has_changed_or_not() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("surface.zset");
        overwrite(&path, "x = 1");
        let (report, changes) = channel();
        let watch = Watch::start(&path, "x = 1", move |change| {
            report.send(change).expect("the test listens");
        });
        let next = || changes.recv_timeout(LIMIT).expect("a change");
        for text in ["x = 1", "x = 2"] {
            std::fs::remove_file(&path).expect("removed");
            assert!(matches!(next(), Change::Lost(_)));
            overwrite(&path, text);
            assert_eq!(next(), Change::Found);
        }
        assert_eq!(next(), Change::Text("x = 2".to_owned()));
        // A directory takes the file's place.
        std::fs::remove_file(&path).expect("removed");
        assert!(matches!(next(), Change::Lost(_)));
        std::fs::create_dir(&path).expect("created");
        assert!(
            matches!(next(), Change::Lost(reason) if reason.ends_with("is not a file any more"))
        );
        drop(watch.expect("watched"));
        assert!(changes.try_recv().is_err());
    }

    #[test]
    fn a_thousand_saves_end_with_the_last() {
        let file = watched("x = 0.5");
        let styles = [overwrite, rename_over, move_away];
        for (number, save) in (0..1000).zip(styles.into_iter().cycle()) {
            save(&file.path(), &format!("x = {number}/1000"));
        }
        file.follows("x = 999/1000");
    }
}
