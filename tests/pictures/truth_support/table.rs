//! A text table of the method `knoll`'s results on the gallery.

use super::Truth;
use std::fmt::{Display, Formatter, Result};
use zeroset_trace::{GBuffer, Status};

/// Results of one surface: the number of rays of each kind, and the distances of painted points
/// from first roots.
pub struct Row {
    slug: String,
    counts: [usize; KINDS.len()],
    /// Columns and rows of the rays of each listed kind.
    listed: [Vec<(usize, usize)>; KINDS.len()],
    /// Sorted distances between painted points and first roots, in world units.
    errors: Vec<f64>,
    /// Thickness of a slab: 2^−depth of the domain's largest extent.
    slab: f64,
}

/// The table, with a row for each surface.
pub struct Table<'a>(pub &'a [Row]);

/// A ray's reference, and its result in the picture.
struct Ray {
    open: bool,
    zero: f64,
    crossing: f64,
    status: Status,
    distance: f64,
    drawn: f64,
    /// Greatest distance from the start of a slab to the point painted for it, in world units.
    reach: f64,
}

/// A column of the table.
struct Kind {
    head: &'static str,
    meaning: &'static str,
    /// Whether the rays are listed one by one below the table.
    listed: bool,
    holds: fn(&Ray) -> bool,
}

const KINDS: [Kind; 12] = [
    Kind {
        head: "open",
        meaning: "rays that the reference could not decide; they count in no other column",
        listed: true,
        holds: |ray| ray.open,
    },
    Kind {
        head: "cross",
        meaning: "rays on which f changes sign at a root",
        listed: false,
        holds: |ray| ray.crossing.is_finite(),
    },
    Kind {
        head: "touch",
        meaning: "rays whose first root is one where f keeps its sign",
        listed: false,
        holds: |ray| ray.zero < ray.crossing,
    },
    Kind {
        head: "lost",
        meaning: "rays with a root that are called a miss: each would be a false proof",
        listed: true,
        holds: |ray| ray.rooted() && ray.status == Status::Miss,
    },
    Kind {
        head: "miss",
        meaning: "rays proven to have no root",
        listed: false,
        holds: |ray| ray.status == Status::Miss,
    },
    Kind {
        head: "hit",
        meaning: "rays proven to have a root: this method proves none",
        listed: false,
        holds: |ray| ray.status == Status::Hit,
    },
    Kind {
        head: "paint",
        meaning: "undecided rays on which a point is painted",
        listed: false,
        holds: |ray| ray.status == Status::Undecided && ray.painted(),
    },
    Kind {
        head: "false",
        meaning: "painted rays without a root",
        listed: false,
        holds: |ray| ray.painted() && !ray.rooted(),
    },
    Kind {
        head: "blank",
        meaning: "undecided rays on which nothing is painted: only unbounded slabs, passed over",
        listed: false,
        holds: |ray| ray.status == Status::Undecided && !ray.painted(),
    },
    Kind {
        head: "behind",
        meaning: "painted rays with an unbounded slab, passed over, before the painted point",
        listed: false,
        holds: Ray::is_behind,
    },
    Kind {
        head: "unseen",
        meaning: "the blank rays that do have a root",
        listed: true,
        holds: |ray| ray.rooted() && ray.status == Status::Undecided && !ray.painted(),
    },
    Kind {
        head: "late",
        meaning: "the rays painted behind that have a root before the painted point",
        listed: true,
        holds: |ray| ray.is_behind() && ray.zero < ray.drawn,
    },
];

impl Ray {
    fn rooted(&self) -> bool {
        self.zero.is_finite()
    }

    fn painted(&self) -> bool {
        self.drawn.is_finite()
    }

    /// Whether the painted point is behind the first undecided slab.
    fn is_behind(&self) -> bool {
        self.painted() && self.distance + self.reach < self.drawn
    }
}

impl Row {
    /// Compares a picture at `depth` with the reference.
    pub fn new(truth: &Truth, buffer: &GBuffer, depth: u32) -> Self {
        let domain = &truth.view.domain;
        let extent = domain.chunks(2).map(|range| range[1] - range[0]).fold(0.0, f64::max);
        let mut row = Self {
            slug: truth.view.slug.clone(),
            counts: [0; KINDS.len()],
            listed: Default::default(),
            errors: Vec::new(),
            slab: extent * 0.5_f64.powi(depth as i32),
        };
        for (index, pixel) in truth.pixels.iter().enumerate() {
            let ray = Ray {
                open: pixel.open,
                zero: pixel.zero,
                crossing: pixel.crossing,
                status: buffer.status[index],
                distance: buffer.distance(index),
                drawn: buffer.drawn[index],
                // Two slabs. A slab is at most four times as long along a ray as along its axis.
                reach: 8.0 * row.slab,
            };
            for (number, kind) in KINDS.iter().enumerate() {
                // Rays that the reference leaves open count only in the first column.
                if (number == 0 || !ray.open) && (kind.holds)(&ray) {
                    row.counts[number] += 1;
                    if kind.listed {
                        row.listed[number].push((index % buffer.width, index / buffer.width));
                    }
                }
            }
            if !ray.open && ray.rooted() && ray.painted() {
                row.errors.push((ray.drawn - ray.zero).abs());
            }
        }
        row.errors.sort_by(f64::total_cmp);
        row
    }

    /// The number of rays in the column named `head`.
    pub fn count(&self, head: &str) -> usize {
        let number = KINDS.iter().position(|kind| kind.head == head);
        self.counts[number.expect("a column")]
    }

    /// The upper median and the largest of the errors; `None` if there are no errors.
    fn error(&self) -> Option<(f64, f64)> {
        Some((*self.errors.get(self.errors.len() / 2)?, *self.errors.last()?))
    }
}

impl Display for Table<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        let rows = self.0;
        writeln!(out, "{TITLE}")?;
        for kind in &KINDS {
            writeln!(out, "  {:8}{}", kind.head, kind.meaning)?;
        }
        writeln!(out, "{ERRORS}")?;

        let width = rows.iter().map(|row| row.slug.len()).max().unwrap_or(0);
        write!(out, "{:width$}", "")?;
        for kind in &KINDS {
            write!(out, " {:>6}", kind.head)?;
        }
        writeln!(out, "   median       max  /slab     max")?;
        for row in rows {
            write!(out, "{:width$}", row.slug)?;
            for count in row.counts {
                write!(out, " {count:6}")?;
            }
            if let Some((median, max)) = row.error() {
                write!(out, "  {median:7.1e}  {max:8.1e}")?;
                write!(out, " {:6.1} {:7.1}", median / row.slab, max / row.slab)?;
            }
            writeln!(out)?;
        }
        write!(out, "{:width$}", "all")?;
        for number in 0..KINDS.len() {
            write!(out, " {:6}", rows.iter().map(|row| row.counts[number]).sum::<usize>())?;
        }
        writeln!(out)?;

        for (number, kind) in KINDS.iter().enumerate().filter(|(_, kind)| kind.listed) {
            writeln!(out, "\n{}, as column,row:", kind.head)?;
            for row in rows.iter().filter(|row| row.counts[number] > 0) {
                write!(out, "  {}", row.slug)?;
                for (column, line) in &row.listed[number] {
                    write!(out, " {column},{line}")?;
                }
                writeln!(out)?;
            }
        }
        Ok(())
    }
}

const TITLE: &str = "\
Pictures of the gallery by the method `knoll`, 64x64 rays, depth 12, compared with exact first roots.
The test `truth` compares this table; ZEROSET_BLESS=1 cargo test --test all truth:: writes it.

Numbers of rays:";

const ERRORS: &str = "
Over all painted rays with a root, how far the painted point is from the first root: median and maximum in world
units, then in slabs of 2^-12 of the domain's largest extent.
";
