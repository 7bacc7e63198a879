//! Descriptions of a picture: status text, and the command that reproduces it.

use super::pipeline::{Rendering, Snapshot};
use glam::DVec3;
use std::fmt::Write as _;
use std::time::Duration;
use zeroset_interval::Interval;
use zeroset_render::names::Named;
use zeroset_render::picture::Settings;
use zeroset_scene::coordinate::coordinate;
use zeroset_scene::proportions;
use zeroset_scene::view::{self, ClipChoice, DomainChoice};
use zeroset_shade::UndecidedStyle;
use zeroset_space::Projection;
use zeroset_style::CHOICES;
use zeroset_trace::{MethodOption, OPTIONS};

/// Note on a picture whose function may be 0 everywhere.
pub const FLAT: &str =
    "a function could not be distinguished from 0 at any sampled point: it may be 0 everywhere";

/// Several lines about the visible picture.
pub(super) fn describe(snapshot: &Snapshot) -> String {
    let mut text = String::new();
    if let Some(fault) = &snapshot.fault {
        let _ = writeln!(text, "error       {}", fault.message());
    }
    let Some(rendering) = &snapshot.rendering else {
        return text + "there is no picture yet";
    };
    for surface in rendering.document.drawn_surfaces() {
        let _ = writeln!(text, "surface     {}", surface.echo);
    }
    for curve in &rendering.document.curves.all {
        let _ = writeln!(text, "curve       {}", curve.echo);
    }
    let (region, statistics) = (rendering.model.region(), &rendering.picture.statistics);
    let [x, y, z] = view::bounds(region).map(|ends| [ends.lo, ends.hi].map(coordinate).join(".."));
    let found = rendering.searched.map_or(String::new(), |found| found.describe());
    let _ = writeln!(text, "domain      x {x}, y {y}, z {z}  {found}");
    if let Some(stretched) = proportions::description(region) {
        let _ = writeln!(text, "note        {stretched}");
    }
    let settings = &rendering.request.settings;
    let options: Vec<String> = read_options(rendering)
        .filter(|option| option.short(&settings.options).is_some())
        .map(|option| (option.describe)(&settings.options))
        .collect();
    let method = rendering.picture.traced_by(settings.method);
    let _ = writeln!(text, "method      {method}, {}", options.join(", "));
    let pixels = statistics.pixels;
    let _ = writeln!(
        text,
        "pixels      {}x{}: {} misses, {} hits, {} undecided{}",
        rendering.picture.buffer.width,
        rendering.picture.buffer.height,
        pixels.miss,
        pixels.hit,
        pixels.undecided,
        if rendering.coarse { " (coarse)" } else { "" },
    );
    if let Some(why) = rendering.picture.why_undecided() {
        let _ = writeln!(text, "undecided   {why}");
    }
    if let Some(why) = rendering.why_blank() {
        let _ = writeln!(text, "note        {why}");
    }
    for note in rendering.picture.fallback_notes(settings.method) {
        let _ = writeln!(text, "note        {note}");
    }
    for remark in &rendering.picture.remarks {
        let _ = writeln!(text, "note        {remark}");
    }
    if rendering.picture.flat {
        let _ = writeln!(text, "note        {FLAT}");
    }
    let times = &statistics.times;
    let made = if rendering.model.is_rebound() {
        "not compiled again".to_owned()
    } else {
        format!("simplify {}, compile {}", ms(times.simplify), ms(times.compile))
    };
    let _ = write!(
        text,
        "time        read {}, {made}, trace {}, shade {}, look {}",
        ms(rendering.parse),
        ms(times.trace),
        ms(times.shade),
        ms(times.occlude + times.antialias)
    );
    text
}

/// The options of a picture's method and of its fallback methods, in the order of [`OPTIONS`].
fn read_options(rendering: &Rendering) -> impl Iterator<Item = &'static MethodOption> + '_ {
    let fallbacks = rendering.picture.fallbacks.iter().map(|(_, fallback)| fallback.method);
    let methods: Vec<_> = fallbacks.chain([rendering.request.settings.method]).collect();
    OPTIONS.iter().filter(move |option| methods.iter().any(|one| one.reads.contains(option)))
}

/// A time in milliseconds, with one decimal below 10 ms.
pub(super) fn ms(time: Duration) -> String {
    let ms = time.as_secs_f64() * 1e3;
    if ms < 10.0 { format!("{ms:.1} ms") } else { format!("{ms:.0} ms") }
}

impl Rendering {
    /// Why the picture is blank, with a command that helps. `None` if it is not blank.
    pub fn why_blank(&self) -> Option<String> {
        Some(self.blank?.describe(&|ends| format!(":domain {ends}")))
    }

    /// A short line with time, size, method, method options, undecided pixels and compile time. For
    /// a blank picture, the reason instead.
    pub fn summary(&self) -> String {
        if let Some(why) = self.why_blank() {
            return why;
        }
        let statistics = &self.picture.statistics;
        let (width, height) = (self.picture.buffer.width, self.picture.buffer.height);
        let undecided = statistics.pixels.undecided;
        let times = &statistics.times;
        let made = if self.model.is_rebound() {
            "not compiled again".to_owned()
        } else {
            format!("compiled in {}", ms(times.simplify + times.compile))
        };
        let settings = &self.request.settings;
        let values: Vec<String> =
            read_options(self).filter_map(|option| option.short(&settings.options)).collect();
        format!(
            "{} · {width}x{height} · {} {} · {undecided} undecided · {made}{}",
            ms(times.trace + times.shade),
            self.picture.traced_by(settings.method),
            values.join(" "),
            if self.picture.flat { " · 0 everywhere?" } else { "" },
        )
    }

    /// The shell command that writes this picture, at its full size, to the file `output`. With
    /// `axes`, it also draws axes. The function `word` returns the shell's word for a text.
    pub fn command(&self, output: &str, axes: bool, word: impl Fn(&str) -> String) -> String {
        let request = &self.request;
        let settings = &request.settings;
        let point = |p: DVec3| format!("{},{},{}", p.x, p.y, p.z);
        let says_axes = self.document.picture.choices.axes == Some(true);
        // No option takes away axes that the document asks for.
        let against = if says_axes && !axes { "\naxes off" } else { "" };
        let mut command = format!("zeroset render {}", word(&format!("{}{against}", request.text)));
        for (name, value) in &request.overrides {
            let _ = write!(command, " -D {}", quote(&format!("{name}={value}")));
        }
        if let Some(time) = request.time {
            let _ = write!(command, " --time {time}");
        }
        match request.domain {
            // State the domain, since an automatic domain may depend on the one shown before.
            DomainChoice::Document | DomainChoice::Auto if self.searched.is_some() => {
                let [x, y, z] = view::bounds(self.model.region())
                    .map(|Interval { lo, hi }| [lo, hi].map(coordinate).join(","));
                let _ = write!(command, " --domain {x},{y},{z}");
                if self.model.region().ball().is_some() {
                    command.push_str(" --clip-to ball");
                }
            }
            DomainChoice::Document => {}
            DomainChoice::Auto => command.push_str(" --domain auto"),
            DomainChoice::Bounds(bounds) => {
                let bounds: Vec<String> = bounds.into_iter().map(coordinate).collect();
                let _ = write!(command, " --domain {}", bounds.join(","));
            }
        }
        match request.clip {
            ClipChoice::Document => {}
            ClipChoice::Off => command.push_str(" --clip off"),
            ClipChoice::Plane(clip) => {
                let _ = write!(command, " --clip {},{}", point(clip.normal), clip.offset);
            }
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
        let _ = write!(command, " --size {}x{}", settings.width, settings.height);
        let usual = Settings::default();
        if settings.method != usual.method {
            let _ = write!(command, " --method {}", settings.method.name);
        }
        for flag in read_options(self).filter_map(|option| option.flag(&settings.options)) {
            let _ = write!(command, " {flag}");
        }
        if settings.undecided != UndecidedStyle::Shade {
            let _ = write!(command, " --undecided {}", settings.undecided.name());
        }
        if let Some(look) = settings.look {
            let _ = write!(command, " --look {}", look.name);
        }
        for flag in CHOICES.iter().filter_map(|row| row.typed_flag(&settings.choices)) {
            let _ = write!(command, " {flag}");
        }
        if axes && !says_axes {
            command.push_str(" --axes");
        }
        let _ = write!(command, " -o {}", quote(output));
        command
    }
}

/// `text` as one word of a POSIX shell.
pub fn quote(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}
