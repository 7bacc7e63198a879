//! Tips for new users. The window shows each tip once. A file counts the tips shown so far.

#[cfg(feature = "window")]
use super::data::data_directory;
use super::data::store_text;

/// The tips, one line each, the most useful first.
pub const TIPS: &[&str] = &[
    "Tip: type a formula such as x^2+y^2 = z; the picture follows every key (:tips off ends tips)",
    "Tip: `r = 1 in [0, 5]` makes a slider: drag it, with Shift for fine steps; a double click puts it back",
    "Tip: F7 cuts open what faces you, and Ctrl with the wheel moves the cut",
    "Tip: use t in a formula, and F5 plays it; Ctrl-O shows a gallery to choose from",
    "Tip: Ctrl-Z takes back whatever you did, and Ctrl-P saves the picture; click a point to have its coordinates in the terminal",
    "Tip: a surface has a full color where f > 0 and a pale one where f < 0; a line such as `color tomato` gives it one",
];

const COUNT_FILE: &str = "tips";

#[cfg(feature = "window")]
/// Returns the next tip that was not shown yet, and counts it as shown. The first tip says how to
/// type, so it is skipped if the user `has_typed`.
pub fn next(has_typed: bool) -> Option<&'static str> {
    // Without a data directory to keep the count, the first tip would appear every time.
    let shown = match std::fs::read_to_string(data_directory()?.join(COUNT_FILE)) {
        Ok(text) => text.trim().parse().unwrap_or(TIPS.len()),
        Err(_) => 0,
    };
    let shown = shown.max(usize::from(has_typed));
    let tip = TIPS.get(shown)?;
    store_text(COUNT_FILE, &(shown + 1).to_string());
    Some(tip)
}

/// Turns tips off, or on again from the first.
pub fn switch(wanted: bool) {
    store_text(COUNT_FILE, &(if wanted { 0 } else { TIPS.len() }).to_string());
}
