//! `zeroset render`.

use super::arguments::{self, Outputs, Render, Undecided};
use super::notes;
use super::output::{Output, check_png, print, write_png};
use super::progress::Progress;
use super::subject::{self, Subject};
use super::{array, report};
use anyhow::{Context, Result, bail, ensure};
use glam::DVec3;
use std::path::Path;
use std::process::ExitCode;
use zeroset::domain::AutoDomain;
use zeroset::picture::{self, Normals, Picture, Settings};
use zeroset::scene::{self, CameraChoice};
use zeroset_syntax::SrgbColor;
use zeroset_trace::{HalfSpace, LinearRgb, Projection, StandardView, Status, UndecidedStyle};

/// The exit code for undecided pixels under `--strict`.
const UNDECIDED: u8 = 1;

/// Shadow rays are traced this many halvings coarser than the picture.
const SHADOW_COARSENESS: u32 = 1;

pub fn run(arguments: &Render) -> Result<ExitCode> {
    let settings = settings(arguments)?;
    let camera_choice = camera_choice(&arguments.camera)?;
    let files = Files::create(&arguments.outputs)?;
    let subject = Subject::read(&arguments.subject)?;
    subject.show_notes();

    let clip = arguments.camera.clip.map(|plane| {
        let [a, b, c, d] = plane.0;
        HalfSpace { normal: DVec3::new(a, b, c), offset: d }
    });
    let render = || -> Result<_> {
        let document = &subject.document;
        let (region, searched) = scene::region(document, subject.domain, clip)?;
        let camera = scene::camera(document, &region, &camera_choice)?;
        let pixels = settings.width * settings.height * document.surfaces.len();
        let bar = Progress::new(pixels as u64, "tracing");
        let picture = picture::render(document, &region, &camera, &settings, &|done, _| {
            bar.reach(done as u64);
        })?;
        Ok((region, searched, camera, picture))
    };
    let (region, searched, camera, picture) = in_threads(arguments.tracing.threads, render)?;

    if let Some(found) = searched {
        notes::note(&subject::describe_domain(&found));
    }
    remark(&subject, &region, &picture, searched);
    files.finish(&picture)?;
    if arguments.outputs.json {
        let object = report::object(&subject, &region, searched, &camera, &settings, &picture);
        print(&format!("{object}\n"))?;
    }
    let undecided = picture.statistics.pixels.undecided > 0;
    Ok(if arguments.strict && undecided { ExitCode::from(UNDECIDED) } else { ExitCode::SUCCESS })
}

/// Runs `work` with this many threads, or as many as there are processors.
///
/// # Errors
/// If there can be no threads, or as `work`.
pub fn in_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let Some(threads) = threads else {
        return work();
    };
    ensure!((1..=1024).contains(&threads), "--threads must be between 1 and 1024");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.context("cannot start the threads")?.install(work)
}

/// # Errors
/// If slabs would be too thin for floats of this precision, or none.
pub fn check_depth(flag: &str, depth: u32, precision: picture::Precision) -> Result<()> {
    let most = precision.max_depth();
    let hint = match precision {
        picture::Precision::F32 => {
            format!(", or {} with --precision f64", picture::Precision::F64.max_depth())
        }
        picture::Precision::F64 => String::new(),
    };
    ensure!((1..=most).contains(&depth), "{flag} must be between 1 and {most}{hint}");
    Ok(())
}

/// What the method's flags ask for, at a given size and with the default look.
///
/// # Errors
/// If a number is out of range.
pub fn method_settings(method: &arguments::Tracing, size: super::vector::Size) -> Result<Settings> {
    let precision = picture::Precision::from(method.precision);
    check_depth("--max-depth", method.max_depth, precision)?;
    let shadow_depth = method
        .shadow_depth
        .unwrap_or_else(|| method.max_depth.saturating_sub(SHADOW_COARSENESS).max(1));
    check_depth("--shadow-depth", shadow_depth, precision)?;
    Ok(Settings {
        width: size.width,
        height: size.height,
        method: method.method,
        precision,
        max_depth: method.max_depth,
        shadow_depth: method.shadows.then_some(shadow_depth),
        normals: Some(match method.normals {
            arguments::Normals::Gradient => Normals::Gradient,
            arguments::Normals::Central => Normals::Central,
        }),
        ..Settings::default()
    })
}

fn settings(arguments: &Render) -> Result<Settings> {
    let look = &arguments.look;
    ensure!((0.0..=1.0).contains(&look.ambient), "--ambient must be between 0 and 1");
    let background = match &look.background {
        None => None,
        Some(text) => {
            let named = SrgbColor::named(text).map(|color| LinearRgb::from_srgb(color.rgb));
            Some(named.or_else(|| LinearRgb::from_hex(text)).with_context(|| {
                format!("--background '{text}' is not a colour such as white or ffffff")
            })?)
        }
    };
    if let Some(light) = look.light {
        ensure!(light.0.iter().all(|c| c.is_finite()), "--light needs finite numbers");
    }
    let outputs = &arguments.outputs;
    let method = method_settings(&arguments.tracing, outputs.size)?;
    let shaded = outputs.output.is_some() || outputs.normal.is_some();
    Ok(Settings {
        normals: method.normals.filter(|_| shaded),
        undecided: match look.undecided {
            None | Some(Undecided::Shade) => UndecidedStyle::Shade,
            Some(Undecided::Hatch) => UndecidedStyle::Hatch,
            Some(Undecided::Tint) => UndecidedStyle::Tint,
            Some(Undecided::Miss) => UndecidedStyle::Miss,
        },
        light: look.light.map(|place| DVec3::from_array(place.0)),
        ambient: look.ambient,
        background,
        ..method
    })
}

pub fn camera_choice(camera: &arguments::Camera) -> Result<CameraChoice> {
    let point = |numbers: Option<super::vector::Numbers<3>>| numbers.map(|n| DVec3::from(n.0));
    let view = match &camera.view {
        None => None,
        Some(name) => Some(StandardView::named(name).with_context(|| format!("no view '{name}'"))?),
    };
    let projection = match (camera.ortho, camera.fov) {
        (Some(height), _) => Some(Projection::Orthographic { height }),
        (None, Some(fov)) => Some(Projection::Perspective { fov }),
        (None, None) => None,
    };
    Ok(CameraChoice {
        view,
        eye: point(camera.eye),
        target: point(camera.target),
        up: point(camera.up),
        projection,
    })
}

/// The files asked for, opened before the work.
struct Files {
    picture: Option<Output>,
    distance: Option<Output>,
    status: Option<Output>,
    normal: Option<Output>,
}

impl Files {
    fn create(outputs: &Outputs) -> Result<Self> {
        let Outputs { output, distance, status, normal, json, size: _ } = outputs;
        let paths = [output, distance, status, normal];
        if paths.iter().all(|path| path.is_none()) && !json {
            bail!(
                "nothing to write: add -o picture.png, or --json, --distance, --status, --normal"
            );
        }
        let standard = paths.iter().filter(|path| path.as_deref() == Some(Path::new("-"))).count();
        ensure!(
            standard + usize::from(*json) <= 1,
            "only one thing can be written to standard output"
        );
        let files: Vec<_> = paths.iter().filter_map(|path| path.as_ref()).collect();
        for (index, path) in files.iter().enumerate() {
            let twice = path.as_path() != Path::new("-") && files[..index].contains(path);
            ensure!(!twice, "'{}' is given for two outputs", path.display());
        }
        if let Some(path) = output {
            check_png(path)?;
        }
        let create =
            |path: &Option<_>| path.as_ref().map(|path: &std::path::PathBuf| Output::create(path));
        Ok(Self {
            picture: create(output).transpose()?,
            distance: create(distance).transpose()?,
            status: create(status).transpose()?,
            normal: create(normal).transpose()?,
        })
    }

    fn finish(self, picture: &Picture) -> Result<()> {
        let buffer = &picture.buffer;
        let (width, height) = (buffer.width, buffer.height);
        if let Some(file) = self.picture {
            file.finish(|out| write_png(out, &picture.rgb, width, height))?;
        }
        if let Some(file) = self.distance {
            let distance = buffer.distance.iter().copied();
            let shape = [height, width];
            match picture.precision {
                // These kernels know no more.
                picture::Precision::F32 => {
                    file.finish(|out| array::write(out, &shape, distance.map(|d| d as f32)))?;
                }
                picture::Precision::F64 => {
                    file.finish(|out| array::write(out, &shape, distance))?;
                }
            }
        }
        if let Some(file) = self.status {
            let bytes = buffer.status.iter().map(|&status| status as u8);
            file.finish(|out| array::write(out, &[height, width], bytes))?;
        }
        if let Some(file) = self.normal {
            let components = buffer.normal.iter().flatten().copied();
            file.finish(|out| array::write(out, &[height, width, 3], components))?;
        }
        Ok(())
    }
}

/// Says what a look at the picture does not tell: why nothing is seen, and how much is undecided.
fn remark(
    subject: &Subject,
    region: &zeroset_trace::Region,
    picture: &Picture,
    searched: Option<AutoDomain>,
) {
    if picture.flat {
        notes::note(zeroset::live::FLAT);
    }
    let pixels = picture.statistics.pixels;
    let seen = pixels.hit + pixels.undecided;
    if seen == 0 {
        notes::note(&subject::why_nothing_is_seen(subject, region, picture.undefined, searched));
    } else if pixels.undecided > 0 {
        notes::note(&format!(
            "{} of {} pixels are undecided: this method proves misses; hits only where the domain cuts a solid",
            pixels.undecided,
            pixels.miss + seen,
        ));
        let passed_over = picture
            .buffer
            .status
            .iter()
            .zip(&picture.buffer.drawn)
            .filter(|(status, drawn)| **status == Status::Undecided && drawn.is_infinite())
            .count();
        if picture.statistics.work.given_up > 0 {
            notes::note(&format!(
                "some rays were given up after {} steps: their slabs stay undecided down to this --max-depth; \
                 a smaller one takes less time, --precision f64 may decide more",
                zeroset_trace::STEPS,
            ));
        } else if passed_over > 0 {
            notes::note(&format!(
                "{passed_over} of these are not drawn: the function has no bounds there in any slab, as near a pole or \
                 beyond the range of floats, and a root would not show; a larger --max-depth or --precision f64 tells \
                 more of them apart"
            ));
        }
    }
}
