//! What a picture shows and what it took, in words and as the command that makes it again.

use super::pipeline::{Frame, View};
use crate::picture::Precision;
use crate::scene::DomainChoice;
use glam::DVec3;
use std::fmt::Write as _;
use std::time::Duration;
use zeroset_trace::{Projection, UndecidedStyle};

/// What is said of a function that may be 0 everywhere.
pub const FLAT: &str =
    "a function could not be told from 0 at any point looked at: it may be 0 everywhere";

/// Several lines on what can be seen.
pub(super) fn describe(view: &View) -> String {
    let mut text = String::new();
    if let Some(fault) = &view.fault {
        let _ = writeln!(text, "error       {}", fault.message());
    }
    let Some(frame) = &view.frame else {
        return text + "there is no picture yet";
    };
    for surface in &frame.document.surfaces {
        let _ = writeln!(text, "surface     {}", surface.echo);
    }
    let (region, statistics) = (frame.model.region(), &frame.picture.statistics);
    let (low, high) = (region.low(), region.high());
    let found = frame.searched.map_or("", |found| found.finding.describe());
    let _ = writeln!(
        text,
        "domain      x {}..{}, y {}..{}, z {}..{}  {found}",
        low.x, high.x, low.y, high.y, low.z, high.z
    );
    let (depth, precision) = (frame.wish.settings.max_depth, frame.picture.precision);
    let method = frame.picture.method.name;
    let _ = writeln!(text, "method      {method}, depth {depth}, {precision}");
    let pixels = statistics.pixels;
    let _ = writeln!(
        text,
        "pixels      {}x{}: {} misses, {} hits, {} undecided{}",
        frame.picture.buffer.width,
        frame.picture.buffer.height,
        pixels.miss,
        pixels.hit,
        pixels.undecided,
        if frame.coarse { " (coarse)" } else { "" },
    );
    if frame.picture.flat {
        let _ = writeln!(text, "note        {FLAT}");
    }
    let times = &statistics.times;
    let made = if frame.model.is_rebound() {
        "not compiled again".to_owned()
    } else {
        format!("simplify {}, compile {}", ms(times.simplify), ms(times.compile))
    };
    let _ = write!(
        text,
        "time        read {}, {made}, trace {}, shade {}",
        ms(frame.parse),
        ms(times.trace),
        ms(times.shade)
    );
    text
}

/// A time in milliseconds, to two digits or so.
fn ms(time: Duration) -> String {
    let ms = time.as_secs_f64() * 1e3;
    if ms < 10.0 { format!("{ms:.1} ms") } else { format!("{ms:.0} ms") }
}

impl Frame {
    /// One short line: time, size, method with depth and precision, undecided pixels, compile time.
    pub fn summary(&self) -> String {
        let statistics = &self.picture.statistics;
        let (width, height) = (self.picture.buffer.width, self.picture.buffer.height);
        let undecided = statistics.pixels.undecided;
        let times = &statistics.times;
        let made = if self.model.is_rebound() {
            "not compiled again".to_owned()
        } else {
            format!("compiled in {}", ms(times.simplify + times.compile))
        };
        format!(
            "{} · {width}x{height} · {} {} {} · {undecided} undecided · {made}{}",
            ms(times.trace + times.shade),
            self.picture.method.name,
            self.wish.settings.max_depth,
            self.picture.precision,
            if self.picture.flat { " · 0 everywhere?" } else { "" },
        )
    }

    /// The command that makes this picture again, at full size, as `output`. `quote` writes a text as one word of a shell.
    pub fn command(&self, output: &str, quote: impl Fn(&str) -> String) -> String {
        let wish = &self.wish;
        let settings = &wish.settings;
        let point = |p: DVec3| format!("{},{},{}", p.x, p.y, p.z);
        let mut command = format!("zeroset render {}", quote(&wish.text));
        for (name, value) in &wish.overrides {
            let _ = write!(command, " -D {}", quote(&format!("{name}={value}")));
        }
        if let Some(time) = wish.time {
            let _ = write!(command, " --time {time}");
        }
        match wish.domain {
            DomainChoice::Document => {}
            DomainChoice::Auto => command.push_str(" --domain auto"),
            DomainChoice::Bounds(bounds) => {
                let bounds: Vec<String> = bounds.iter().map(ToString::to_string).collect();
                let _ = write!(command, " --domain {}", bounds.join(","));
            }
        }
        if let Some(clip) = wish.clip {
            let _ = write!(command, " --clip {},{}", point(clip.normal), clip.offset);
        }
        let camera = &self.camera;
        let _ = write!(
            command,
            " --eye {} --target {} --up {}",
            point(camera.eye()),
            point(camera.target()),
            point(camera.up())
        );
        let _ = match camera.projection() {
            Projection::Perspective { fov } => write!(command, " --fov {fov}"),
            Projection::Orthographic { height } => write!(command, " --ortho {height}"),
        };
        let _ = write!(
            command,
            " --size {}x{} --max-depth {}",
            settings.width, settings.height, settings.max_depth
        );
        match settings.precision {
            Precision::F32 => {}
            Precision::F64 => command.push_str(" --precision f64"),
        }
        match settings.undecided {
            UndecidedStyle::Shade => {}
            UndecidedStyle::Hatch => command.push_str(" --undecided hatch"),
            UndecidedStyle::Tint => command.push_str(" --undecided tint"),
            UndecidedStyle::Miss => command.push_str(" --undecided miss"),
        }
        let _ = write!(command, " -o {}", quote(output));
        command
    }
}
