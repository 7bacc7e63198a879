//! Random lines like those that a user types: complete, unfinished or wrong.

/// Pieces that are strung together at random, into meaningless lines.
const PARTS: &[&str] = &[
    "x", "y", "z", "x^2", "y^2", "z^2", "+", "-", "*", "/", "^", "(", ")", "=", "1", "0.5", "sin(",
    "sqrt(", "abs(x)", "r", " ", "<", "and ", "max(x,", "{z>0}", "|", "é", "²", "foo", "2", ",",
    ";",
];

/// Complete lines, to be mixed with meaningless ones.
const LINES: &[&str] = &[
    "x^2+y^2+z^2 = 1",
    "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)",
    "r = 0.7",
    "r = 0.5 in [0, 1]",
    "z = x^2 - y^2",
    "x^2+y^2 < r",
    "domain 2",
    "1/x = y",
    ":add x = z",
    ":view top",
    ":set r = 0.3",
    ":time 0.5",
    ":domain auto",
];

/// An edit: the first `typed` bytes of `line` are typed. If `entered`, the whole line is entered.
pub struct Edit {
    pub line: String,
    pub typed: usize,
    pub entered: bool,
}

/// Draws a random edit.
pub fn edit(random: &mut fastrand::Rng) -> Edit {
    if random.bool() {
        let line = *random.choice(LINES).expect("some");
        let reach = random.usize(0..=line.len());
        let typed = (reach..=line.len()).find(|end| line.is_char_boundary(*end));
        Edit {
            line: line.to_owned(),
            typed: typed.unwrap_or(line.len()),
            entered: random.u8(0..2) == 0,
        }
    } else {
        let parts = random.usize(1..12);
        let line: String = (0..parts).map(|_| *random.choice(PARTS).expect("some")).collect();
        Edit { typed: line.len(), line, entered: random.u8(0..8) == 0 }
    }
}

/// The prefixes of `line` that exist while its first `typed` bytes are typed.
pub fn beginnings(line: &str, typed: usize) -> impl Iterator<Item = &str> {
    (0..=typed).filter(|end| line.is_char_boundary(*end)).map(|end| &line[..end])
}
