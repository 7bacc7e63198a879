//! `zeroset render --frames`: many pictures, in separate files or in one.

use super::animation::{Animation, AnimationFormat};
use super::arguments::{OutputArgs, RenderArgs, SequenceArgs};
use super::array::{Arrays, Beginning};
use super::files::Files;
use super::output::{OutputFile, print};
use super::png_file::PictureOrigin;
use super::progress::Progress;
use super::subject::{self, Subject};
use super::{UNDECIDED, interrupt, notes, report};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use zeroset_parser::{ErrorKind, Errors};
use zeroset_render::model::Model;
use zeroset_render::overlay::{Overlay, PictureView};
use zeroset_render::picture::{ColorDepth, Picture, Settings};
use zeroset_render::png_file::PngFormat;
use zeroset_render::sequence::{Sequence, Stage, Sweep};
use zeroset_scene::number::number;
use zeroset_scene::{proportions, view};
use zeroset_space::Camera;
use zeroset_syntax::Options;
use zeroset_trace::{Method, RayGrid};

/// Largest number of frames. An hour at 60 frames per second has less than a quarter as many.
const MOST_FRAMES: usize = 1_000_000;

const WHOLE_TURN: f64 = 360.0;

/// A requested sequence, and the shard of it that this process renders.
pub struct SequenceRequest {
    sequence: Sequence,
    /// Number of the shard, counted from 0, and the total number of shards.
    shard: (usize, usize),
}

/// Returns the requested sequence, if there is one.
///
/// # Errors
/// If an argument is missing or wrong.
pub fn asked(arguments: &RenderArgs) -> Result<Option<SequenceRequest>> {
    let SequenceArgs { frames, sweep, turntable, is_loop, fps, shard, resume } =
        &arguments.sequence;
    let time = arguments.document.values.time.as_deref().filter(|time| time.contains(".."));
    let mut sweeps = sweep.iter().map(|text| swept(text)).collect::<Result<Vec<_>>>()?;
    if let Some(time) = time {
        let (from, to) = parse_range(time).with_context(|| format!("--time '{time}'"))?;
        sweeps.insert(0, Sweep { name: "t".to_owned(), from, to });
    }
    let moves = !sweeps.is_empty() || turntable.is_some();
    let Some(frames) = *frames else {
        let odd = [
            (moves, "a sequence"),
            (*is_loop, "--loop"),
            (*resume, "--resume"),
            (shard.is_some(), "--shard"),
        ];
        if let Some((_, what)) = odd.iter().find(|(given, _)| *given) {
            bail!("{what} needs --frames N, which says how many pictures there are");
        }
        return Ok(None);
    };
    ensure!((1..=MOST_FRAMES).contains(&frames), "--frames must be between 1 and {MOST_FRAMES}");
    ensure!(
        moves,
        "--frames needs something that moves: --time A..B, --sweep NAME=A..B or --turntable"
    );
    ensure!((1..=1000).contains(fps), "--fps must be between 1 and 1000");
    let whole = |degrees: f64| degrees != 0.0 && degrees % WHOLE_TURN == 0.0;
    if let Some(degrees) = turntable {
        ensure!(degrees.is_finite(), "--turntable {degrees}: no such angle");
    }
    let is_loop = *is_loop || sweeps.is_empty() && turntable.is_some_and(whole);
    for (index, sweep) in sweeps.iter().enumerate() {
        let twice = sweeps[..index].iter().any(|other| other.name == sweep.name);
        ensure!(!twice, "'{}' is swept twice", sweep.name);
    }
    let defined = arguments.document.values.overrides()?;
    if let Some((name, _)) = defined.iter().find(|(name, _)| sweeps.iter().any(|s| s.name == *name))
    {
        bail!("'{name}' is both set by -D and swept");
    }
    let shard = shard.as_deref().map_or(Ok((0, 1)), |text| {
        part(text).with_context(|| format!("--shard '{text}' is not of the form I/N, as 1/8"))
    })?;
    Ok(Some(SequenceRequest {
        sequence: Sequence { frames, sweeps, turn: *turntable, is_loop },
        shard,
    }))
}

/// Parses `NAME=A..B`.
fn swept(text: &str) -> Result<Sweep> {
    let (name, range) = text
        .split_once('=')
        .with_context(|| format!("--sweep '{text}' is not of the form name=a..b"))?;
    let (from, to) = parse_range(range).with_context(|| format!("--sweep '{text}'"))?;
    Ok(Sweep { name: name.trim().to_owned(), from, to })
}

/// Parses `A..B`.
fn parse_range(text: &str) -> Result<(f64, f64)> {
    let (from, to) = text.split_once("..").context("two values are written a..b, as 0..2pi")?;
    let finite = |text: &str| {
        number(text).with_context(|| format!("'{}' is not a finite number", text.trim()))
    };
    Ok((finite(from)?, finite(to)?))
}

/// Parses `I/N`, and returns I - 1 and N.
fn part(text: &str) -> Option<(usize, usize)> {
    let (one, of) = text.split_once('/')?;
    let (one, of) = (one.trim().parse::<usize>().ok()?, of.trim().parse::<usize>().ok()?);
    (1..=of).contains(&one).then(|| (one - 1, of))
}

/// Renders the frames and writes them.
///
/// # Errors
/// If a frame cannot be rendered or written. Files of earlier frames stay.
pub fn run(
    arguments: &RenderArgs,
    asked: &SequenceRequest,
    settings: &Settings,
) -> Result<ExitCode> {
    let wanted = &arguments.outputs;
    wanted.check()?;
    let format = one_file(wanted, arguments.sequence.fps)?;
    let has_bytes = matches!(format, Some(AnimationFormat::Gif | AnimationFormat::Raw));
    ensure!(
        settings.depth == ColorDepth::Bytes || !has_bytes,
        "--bits 16 is for PNG files: a GIF and frames on standard output have 8 bits per channel"
    );
    wanted.size.held_whole()?;
    let sequence = &asked.sequence;
    ensure!(
        format.is_none() || asked.shard == (0, 1) && !arguments.sequence.resume,
        "--shard and --resume need a file for each frame: -o frame-%04d.png"
    );
    let maker = FrameRenderer::new(arguments, sequence, settings)?;
    let count = match format {
        None => maker.files(wanted, asked.shard, arguments.sequence.resume)?,
        Some(format) => {
            let path = wanted.output.as_deref().unwrap_or(Path::new("-"));
            maker.animation(format, path, arguments.sequence.fps)?
        }
    };
    count.remark();
    let undecided = arguments.strict && count.undecided > 0;
    Ok(if undecided { ExitCode::from(UNDECIDED) } else { ExitCode::SUCCESS })
}

/// Returns the format if one file holds all frames; `None` if each frame has its own files.
fn one_file(wanted: &OutputArgs, fps: u16) -> Result<Option<AnimationFormat>> {
    if let Some(path) = &wanted.output
        && numbered(path, 0)?.is_none()
    {
        let format = AnimationFormat::of(path, [wanted.size.width, wanted.size.height], fps)?;
        let flag = wanted.arrays.0.first().map(|(row, _)| format!("--{}", row.flag));
        let flag = flag.or(wanted.json.then(|| "--json".to_owned()));
        if let Some(flag) = flag {
            bail!("{flag} is about one frame: write each to a file, -o frame-%04d.png");
        }
        return Ok(Some(format));
    }
    for (_, path) in &wanted.arrays.0 {
        let (numbered, path) = (numbered(path, 0)?.is_some(), path.display());
        ensure!(numbered, "'{path}' would be written by every frame: use a name with %04d");
    }
    Ok(None)
}

/// Replaces `%d` or `%04d` in a path by the number of a frame, and `%%` by `%`. Returns `None` if
/// the path has no place for the number.
///
/// # Errors
/// If it has several such places, or `%` is followed by something else.
fn numbered(path: &Path, frame: usize) -> Result<Option<PathBuf>> {
    let Some(text) = path.to_str() else { return Ok(None) };
    let (mut name, mut rest, mut places) = (String::new(), text, 0);
    while let Some((before, after)) = rest.split_once('%') {
        name.push_str(before);
        if let Some(after) = after.strip_prefix('%') {
            name.push('%');
            rest = after;
            continue;
        }
        let digits = after.len() - after.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (width, after) = after.split_at(digits);
        let width =
            if width.is_empty() { Some(0) } else { width.parse().ok().filter(|w| *w <= 20) };
        let place = width.zip(after.strip_prefix('d'));
        let (width, after) = place.with_context(|| {
            format!("'{text}': a frame's number is written %d or %04d, and % is written %%")
        })?;
        let _ = write!(name, "{frame:0width$}");
        places += 1;
        rest = after;
    }
    ensure!(places <= 1, "'{text}': the frame's number can stand in one place only");
    name.push_str(rest);
    Ok((places == 1).then(|| name.into()))
}

/// Counts of frames: rendered ones, ones that existed already, ones with undecided pixels, without
/// a visible surface, and with each note on a surface that another method traced.
#[derive(Default)]
struct FrameCounts {
    made: usize,
    kept: usize,
    undecided: usize,
    blank: usize,
    fallbacks: BTreeMap<String, usize>,
}

impl FrameCounts {
    fn add(&mut self, picture: &Picture, requested: &Method) {
        let pixels = picture.statistics.pixels;
        self.made += 1;
        self.undecided += usize::from(pixels.undecided > 0);
        self.blank += usize::from(pixels.hit + pixels.undecided == 0);
        for note in picture.fallback_notes(requested) {
            *self.fallbacks.entry(note).or_default() += 1;
        }
    }

    fn remark(&self) {
        let Self { made, kept, undecided, blank, ref fallbacks } = *self;
        if kept > 0 {
            notes::note(&format!("{kept} frames were there already, {made} were made"));
        }
        if undecided > 0 {
            notes::note(&format!("{undecided} of {made} frames have undecided pixels"));
        }
        if blank > 0 {
            notes::note(&format!("nothing is seen in {blank} of {made} frames"));
        }
        for (note, count) in fallbacks {
            notes::note(&format!("in {count} of {made} frames {note}"));
        }
    }
}

/// Returns a swept parameter that does not occur in the text, if there is one.
fn unknown_sweep(errors: &Errors, sequence: &Sequence) -> Option<String> {
    errors.iter().find_map(|error| match &error.kind {
        ErrorKind::UnknownOverride { name } => {
            sequence.sweeps.iter().any(|sweep| sweep.name == *name).then(|| name.clone())
        }
        _ => None,
    })
}

/// Renders frames one after another.
struct FrameRenderer<'a> {
    subject: Subject,
    overrides: Vec<(String, String)>,
    time: Option<f64>,
    sequence: &'a Sequence,
    settings: &'a Settings,
    stage: Stage,
    /// The model of the last frame, whose kernels serve the next one.
    last: Option<Model>,
    around: Overlay,
    progress: Progress,
}

impl<'a> FrameRenderer<'a> {
    fn new(arguments: &RenderArgs, sequence: &'a Sequence, settings: &'a Settings) -> Result<Self> {
        let values = &arguments.document.values;
        let overrides = values.overrides()?;
        let is_timed = sequence.sweeps.iter().any(|sweep| sweep.name == "t");
        let time = if is_timed { None } else { values.time()? };
        let options = Options { overrides: &overrides, time, ..Options::default() };
        let mut unknown = None;
        let read = |text: &str| {
            let read = sequence.document(text, &options, 0);
            read.inspect_err(|errors| unknown = unknown_sweep(errors, sequence))
        };
        let subject = Subject::read_by(&arguments.document, read);
        if let Some(name) = unknown {
            bail!("'{name}' moves, but does not occur in the formula");
        }
        let subject = subject?;
        subject.show_notes();
        let idle = sequence.sweeps.iter().find(|sweep| {
            let mut parameters = subject.document.parameters.iter();
            let moving = parameters.find(|parameter| parameter.name == sweep.name);
            moving.is_none_or(|moving| view::is_idle(&subject.document, moving))
        });
        if let Some(Sweep { name, .. }) = idle {
            bail!("nothing that is drawn depends on '{name}', so all frames would be the same");
        }
        let around = arguments.overlay(&subject.document);
        let (text, place) = (&subject.source.text, (subject.domain, arguments.cut()));
        let (first, choice) = ((&subject.document, &**text), arguments.camera.choice());
        let (stage, last) =
            sequence.stage(first, &options, place, &choice, around.axes, settings)?;
        if let Some(found) = &stage.searched {
            notes::note(&subject::describe_domain(found, &stage.region));
        }
        if let Some(stretched) = proportions::description(&stage.region) {
            notes::note(&stretched);
        }
        let progress = Progress::new(sequence.frames as u64, "frames");
        Ok(Self { subject, overrides, time, sequence, settings, stage, last, around, progress })
    }

    /// Renders a frame, if possible with the kernels of the last one.
    fn render_frame(&mut self, frame: usize) -> Result<(Camera, Picture)> {
        let Self { overrides, time, sequence, stage, .. } = self;
        let settings = Settings { limit: self.settings.limit.begin(), ..self.settings.clone() };
        let options = Options { overrides, time: *time, ..Options::default() };
        let named = || {
            let values = sequence.values(frame).map(|(name, value)| format!(", {name} = {value}"));
            format!("frame {frame}{}", values.collect::<String>())
        };
        let model = match self.last.take() {
            Some(model) if sequence.is_still() => model,
            last => {
                let begun = Instant::now();
                let document = sequence.document(&self.subject.source.text, &options, frame);
                let document =
                    document.map_err(|errors| anyhow!("{errors}")).with_context(named)?;
                self.subject.parse = begun.elapsed();
                let rebound = last.and_then(|model| model.rebound(&document, &stage.region));
                self.subject.document = document;
                let new = || Model::new(&self.subject.document, &stage.region, &settings);
                rebound.unwrap_or_else(new).with_context(named)?
            }
        };
        let camera = sequence.camera(stage, frame).with_context(named)?;
        let mut picture = model.picture(&camera, &settings).with_context(named)?;
        let size = [settings.width, settings.height];
        let marks = self.around.marks(PictureView::of(&model, &camera, &picture), size);
        marks.mix_into_picture(&mut picture, 0);
        self.last = Some(model.again());
        Ok((camera, picture))
    }

    /// Writes each frame to its own files. There are `of` shards, numbered from 0. The one with the
    /// number `shard` renders every `of`-th frame, beginning with frame `shard`.
    fn files(
        mut self,
        wanted: &OutputArgs,
        (shard, of): (usize, usize),
        resume: bool,
    ) -> Result<FrameCounts> {
        let mut count = FrameCounts::default();
        let origin = PictureOrigin::typed(&self.subject.source.text);
        let frames = (shard..self.sequence.frames).step_by(of);
        let all = frames.len();
        for frame in frames {
            interrupt::set_remark(&format!(
                "{} of {all} frames are there",
                count.made + count.kept
            ));
            interrupt::end_if_asked();
            let origin = origin.frame(frame);
            let name = |path: &PathBuf| -> Result<PathBuf> {
                Ok(numbered(path, frame)?.unwrap_or_else(|| path.clone()))
            };
            let arrays = wanted.arrays.0.iter().map(|(row, path)| Ok((*row, name(path)?)));
            let files = OutputArgs {
                output: wanted.output.as_ref().map(name).transpose()?,
                arrays: Arrays(arrays.collect::<Result<_>>()?),
                ..*wanted
            };
            let is_there = |picture: &PathBuf| {
                let written = |path: &Path| path.metadata().and_then(|file| file.modified()).ok();
                let last = written(picture);
                // An array does not record its origin. An array newer than the picture belongs to
                // another sequence.
                let is_of_it = |(_, array): &(_, PathBuf)| {
                    array.is_file() && written(array).is_some_and(|time| Some(time) <= last)
                };
                origin.is_origin_of(picture) && files.arrays.0.iter().all(is_of_it)
            };
            if resume && files.output.as_ref().is_some_and(is_there) {
                count.kept += 1;
                continue;
            }
            let opened = Files::create(&files)?;
            let (camera, picture) = self.render_frame(frame)?;
            let held = interrupt::hold();
            let rays = RayGrid::new(&camera, picture.buffer.width, picture.buffer.height);
            let beginning = Beginning {
                size: [picture.buffer.width, picture.buffer.height],
                precision: picture.precision,
                text: &self.subject.source.text,
                document: &self.subject.document,
                region: &self.stage.region,
            };
            opened.finish(&picture, &rays, &beginning, &origin)?;
            if wanted.json {
                let Stage { region, searched, .. } = &self.stage;
                let settings = self.settings;
                let subject = &self.subject;
                let mut object =
                    report::object(subject, region, *searched, &camera, settings, &picture);
                object["frame"] = frame.into();
                object["values"] = self.sequence.values(frame).collect();
                print(&format!("{object}\n"))?;
            }
            drop(held);
            // The next frame may show the same document.
            self.subject.parse = Duration::ZERO;
            count.add(&picture, self.settings.method);
            picture.hand_back();
            self.progress.reach(frame as u64 + 1);
        }
        Ok(count)
    }

    /// Writes all frames to one file, or to standard output.
    fn animation(mut self, format: AnimationFormat, path: &Path, fps: u16) -> Result<FrameCounts> {
        let output = OutputFile::create(path)?;
        if path != Path::new("-") {
            interrupt::set_remark(
                "nothing is written; with -o frame-%04d.png, frames that are done stay",
            );
        }
        let mut held = None;
        let origin = PictureOrigin::typed(&self.subject.source.text);
        let size = [self.settings.width, self.settings.height];
        let has_alpha = self.settings.is_transparent(self.subject.document.background);
        let pixels = PngFormat { has_alpha, depth: self.settings.depth };
        let frames = self.sequence.frames;
        let (mut count, mut wrong) = (FrameCounts::default(), None);
        let written = output.stream(|out| {
            let mut animation =
                Animation::begin(format, out, size, pixels, (frames, fps), &origin)?;
            for frame in 0..frames {
                let picture = match self.render_frame(frame) {
                    Ok((_, picture)) => picture,
                    Err(error) => {
                        wrong = Some(error);
                        return Err(std::io::ErrorKind::Interrupted.into());
                    }
                };
                animation.add(&picture)?;
                count.add(&picture, self.settings.method);
                picture.hand_back();
                self.progress.reach(frame as u64 + 1);
            }
            animation.end()?;
            held = Some(interrupt::hold());
            Ok(())
        });
        drop(held);
        wrong.map_or(written, Err)?;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_s_number_takes_the_place_of_the_directive() {
        let name = |text: &str| numbered(Path::new(text), 7).expect("valid");
        assert_eq!(name("frame-%04d.png"), Some("frame-0007.png".into()));
        assert_eq!(name("%d/100%%.png"), Some("7/100%.png".into()));
        assert_eq!(name("frame.png"), None);
        for wrong in ["%s.png", "%d-%d.png", "%", "%99d.png", "%-4d.png"] {
            assert!(numbered(Path::new(wrong), 7).is_err(), "{wrong}");
        }
    }

    #[test]
    fn parts_are_counted_from_one() {
        assert_eq!(part("1/8"), Some((0, 8)));
        assert_eq!(part("8/8"), Some((7, 8)));
        for wrong in ["0/8", "9/8", "1", "a/b", "1/0", "-1/8"] {
            assert_eq!(part(wrong), None, "{wrong}");
        }
    }
}
