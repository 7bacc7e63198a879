//! Tips for whoever is new: each is shown once in the window. How many were is kept in a file.

#[cfg(feature = "window")]
use super::data::data_directory;
use super::data::keep;

/// One line each, the most useful first.
pub const TIPS: &[&str] = &[
    "Tip: type / and a formula such as x^2+y^2 = z; the picture follows every key (:tips off ends tips)",
    "Tip: `r = 1 in [0, 5]` makes a slider: drag it, with Shift for fine steps; a double click puts it back",
    "Tip: K cuts open what faces you, and Ctrl with the wheel moves the cut",
    "Tip: use t in a formula, and the key T plays it; G shows a gallery to choose from",
    "Tip: Ctrl-Z takes back whatever you did; click a point to have its coordinates in the terminal",
];

/// The name under which it is kept how many were shown.
const KEPT: &str = "tips";

#[cfg(feature = "window")]
/// The next tip that was not shown yet, which then was.
pub fn next() -> Option<&'static str> {
    // Without a place to note it in, a tip would come every time.
    let shown = match std::fs::read_to_string(data_directory()?.join(KEPT)) {
        Ok(text) => text.trim().parse().unwrap_or(TIPS.len()),
        Err(_) => 0,
    };
    let tip = TIPS.get(shown)?;
    keep(KEPT, &(shown + 1).to_string());
    Some(tip)
}

/// Shows no tips any more, or all of them again.
pub fn switch(wanted: bool) {
    keep(KEPT, &(if wanted { 0 } else { TIPS.len() }).to_string());
}
