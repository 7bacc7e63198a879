//! The clipboard: copies and pastes the typed line, and pastes whole documents.

use super::Window;
use arboard::{Clipboard, Error};

/// The system's clipboard. It is opened when it is first used.
#[derive(Default)]
pub struct LazyClipboard(Option<Clipboard>);

impl LazyClipboard {
    fn open(&mut self) -> Result<&mut Clipboard, Error> {
        match &mut self.0 {
            Some(clipboard) => Ok(clipboard),
            empty => Ok(empty.insert(Clipboard::new()?)),
        }
    }

    fn set(&mut self, text: String) -> Result<(), Error> {
        self.open()?.set_text(text)
    }

    /// The text to paste. On X11, `selected` asks for the text that is selected in some window.
    fn text(&mut self, selected: bool) -> Result<String, Error> {
        let clipboard = self.open()?;
        #[cfg(all(unix, not(target_os = "macos")))]
        if selected {
            use arboard::{GetExtLinux, LinuxClipboardKind};
            return clipboard.get().clipboard(LinuxClipboardKind::Primary).text();
        }
        let _ = selected;
        clipboard.get_text()
    }
}

impl Window {
    /// Copies the selection, or else the whole line; without a line, the document. `cut` also takes
    /// it out of the line.
    pub(super) fn copy(&mut self, cut: bool) {
        let (text, what) = match &mut self.line {
            None => (self.session.live.text(), "the document"),
            Some(line) => {
                let is_whole = line.selection().is_empty();
                let text = if is_whole { line.text() } else { line.selected() }.to_owned();
                if cut {
                    if is_whole {
                        line.select_all();
                    }
                    line.delete();
                    self.follow_typing();
                }
                (text, "")
            }
        };
        match self.clipboard.set(text) {
            Ok(()) if what.is_empty() => {}
            Ok(()) => self.say(&format!("copied {what}")),
            Err(error) => self.say(&format!("nothing was copied: {error}")),
        }
    }

    /// Pastes one line into the typed line. Several lines are a document, which replaces the
    /// present one. With `selected`, pastes the text that is selected in any window, if the system
    /// knows it.
    pub(super) fn paste(&mut self, selected: bool) {
        let text = match self.clipboard.text(selected) {
            Ok(text) => text,
            Err(Error::ContentNotAvailable) => return self.say("there is no text to paste"),
            Err(error) => return self.say(&format!("nothing was pasted: {error}")),
        };
        let text = text.trim();
        if text.is_empty() {
            return self.say("there is no text to paste");
        }
        self.has_typed = true;
        if text.lines().count() == 1 {
            self.open_line().insert_text(text);
            return self.follow_typing();
        }
        self.put_line_away();
        self.sliders.pause();
        self.session.paste(text);
        self.say("pasted as a document: Ctrl-Z brings the last one back");
    }
}
