//! The command `zeroset render`.

mod abandoned;

use super::arguments::{KernelArgs, RenderArgs, TracingArgs};
use super::array::Beginning;
use super::files::Files;
use super::long_work::LongWork;
use super::output::print;
use super::png_file::PictureOrigin;
use super::progress::Progress;
use super::subject::{self, Subject};
use super::vector::Size;
use super::{INTERRUPTED, UNDECIDED, interrupt, notes, report, sequence};
use abandoned::within;
use anyhow::{Context, Result, anyhow, ensure};
use glam::DVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use zeroset_render::drawing::draw;
use zeroset_render::framing;
use zeroset_render::limit::Limit;
use zeroset_render::model::Model;
use zeroset_render::picture::{ColorDepth, Picture, Precision, Settings, UndecidedStatistics};
use zeroset_render::png_file::PngFormat;
use zeroset_render::progress::Listener;
use zeroset_scene::blank::Blank;
use zeroset_scene::curves::UNPROVEN;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::proportions;
use zeroset_scene::view::{self, Clipping, DomainChoice};
use zeroset_shade::Pattern;
use zeroset_space::Region;
use zeroset_style::RAYS;
use zeroset_syntax::{Background, Document};
use zeroset_trace::{DEPTH, RayGrid, check_depth};

/// Half the side of the cube that is drawn if the search for a domain runs out of time.
const FALLBACK_HALF_SIDE: f64 = 2.0;

pub fn run(arguments: &RenderArgs) -> Result<ExitCode> {
    let settings = settings(arguments)?;
    interrupt::listen("nothing is written")?;
    if let Some(sequence) = sequence::asked(arguments)? {
        let threads = arguments.tracing.threads;
        return in_threads(threads, || sequence::run(arguments, &sequence, &settings));
    }
    let choice = arguments.camera.choice();
    let cut = arguments.cut();
    let files = Files::create(&arguments.outputs)?;
    let subject = Subject::read(&arguments.document)?;
    subject.show_notes();

    let around = arguments.overlay(&subject.document);
    let document = &subject.document;
    let threads = arguments.tracing.threads;
    let begun = Instant::now();
    let (region, searched) = chosen(&subject, cut, &settings, threads)?;
    let domain = begun.elapsed();
    let (model, pool) = modeled(document, &region, &settings, threads)?;
    let make = || -> Result<_> {
        let begun = Instant::now();
        let camera = framing::camera(&model, &choice, &settings, around.axes)?;
        let view = begun.elapsed();
        interrupt::defer_first();
        let bar = Progress::new(100, "tracing");
        let follow = |now| bar.follow(now);
        let listener: Listener<'_> = if bar.is_seen() { Some(&follow) } else { None };
        let origin = PictureOrigin::typed(&subject.source.text);
        let size = [settings.width, settings.height];
        let has_alpha = model.is_transparent(&settings);
        let format = PngFormat { has_alpha, depth: settings.depth };
        let precision = settings.options.precision;
        let text = &subject.source.text;
        let beginning = Beginning { size, precision, text, document, region: &region };
        let mut files = files.begin(&beginning, format, &origin)?;
        let rays = RayGrid::new(&camera, settings.width, settings.height);
        let mut write_time = Duration::ZERO;
        let mut write = |top: usize, picture: &mut Picture| -> Result<()> {
            let begun = Instant::now();
            let rows = top..top + picture.buffer.height;
            files.add(picture, &rays.part(0..settings.width, rows))?;
            write_time += begun.elapsed();
            Ok(())
        };
        let picture = draw(&model, &camera, &settings, &around, listener, &mut write)?;
        let is_stopped = settings.limit.is_stopped();
        let begun = Instant::now();
        let held = interrupt::hold();
        files.finish()?;
        drop(held);
        write_time += begun.elapsed();
        Ok((camera, picture, is_stopped, [("view", view), ("write", write_time)]))
    };
    let (camera, picture, is_stopped, times) = pool.install(make)?;

    if let Some(found) = searched {
        notes::note(&subject::describe_domain(&found, &region));
    }
    if let Some(stretched) = proportions::description(&region) {
        notes::note(&stretched);
    }
    if is_stopped {
        notes::note("stopped by Ctrl-C: this is the picture so far");
    }
    let has_curves = !model.curves().is_empty();
    remark(&subject, &region, &settings, &picture, (searched, has_curves));
    let has_data = arguments.outputs.json || !arguments.outputs.arrays.0.is_empty();
    if has_curves && has_data {
        notes::note(UNPROVEN);
    }
    if arguments.outputs.json {
        let mut object = report::object(&subject, &region, searched, &camera, &settings, &picture);
        for (phase, time) in [("domain", domain)].into_iter().chain(times) {
            object["ms"][phase] = report::ms(time);
        }
        print(&format!("{object}\n"))?;
    }
    let undecided = picture.statistics.pixels.undecided > 0;
    Ok(if is_stopped {
        ExitCode::from(INTERRUPTED)
    } else if arguments.strict && undecided {
        ExitCode::from(UNDECIDED)
    } else {
        ExitCode::SUCCESS
    })
}

/// The note on a search for a domain that takes long.
const LONG: &str = "the surface is being looked for; --domain 2 looks within x, y, z in -2..2 alone, \
                    and --budget 60 ends the work after a minute";

/// The region of a picture, and the result of the search for it. If the search finds no region
/// within a quarter of the budget, a cube about the origin.
fn chosen(
    subject: &Subject,
    cut: Clipping,
    settings: &Settings,
    threads: Option<usize>,
) -> Result<(Region, Option<AutoDomain>)> {
    let domain = subject.domain;
    let left = settings.limit.time_left().filter(|_| view::needs_search(&subject.document, domain));
    let pool = thread_pool(threads)?;
    let _long = LongWork::begin(LONG);
    let Some(left) = left else {
        return Ok(pool.install(|| view::region(&subject.document, domain, cut))?);
    };
    let (document, wanted) = (subject.document.clone(), settings.limit.wanted_to_choose());
    let search = move || Ok(view::region_while(&mut None, &document, domain, cut, &wanted)?);
    if let Some((Some(found), _)) = within(left / 4, pool, search)? {
        return Ok(found);
    }
    let [low, high] = [-FALLBACK_HALF_SIDE, FALLBACK_HALF_SIDE];
    notes::note(&format!(
        "no domain was found in time: x, y, z in {low}..{high} are drawn; --domain says where to \
         look"
    ));
    let anywhere = DomainChoice::Bounds([low, high, low, high, low, high]);
    Ok(view::region(&subject.document, anywhere, cut)?)
}

/// The model of a picture, and threads to draw it. If the budget ends before the kernels are
/// compiled, the model is interpreted. Its picture then has only rays that were not reached, as
/// with an empty budget.
fn modeled(
    document: &Document,
    region: &Region,
    settings: &Settings,
    threads: Option<usize>,
) -> Result<(Model, ThreadPool)> {
    let pool = thread_pool(threads)?;
    let mut model = pool.install(|| Model::simplified(document, region, region, settings))?;
    let Some(left) = settings.limit.time_left() else {
        pool.install(|| model.compile(settings, &|| true))?;
        return Ok((model, pool));
    };
    let (late, own) = (model.interpreted(document), settings.clone());
    let compile = move || Ok(model.compile(&own, &own.limit.wanted())?.then_some(model));
    match within(left, pool, compile)? {
        Some((Some(model), pool)) => Ok((model, pool)),
        Some((None, _)) | None => Ok((late, thread_pool(threads)?)),
    }
}

/// Runs `work` with this many threads, or as many as there are processors.
///
/// # Errors
/// If the threads cannot be started, or `work` fails.
pub fn in_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    if threads.is_none() { work() } else { thread_pool(threads)?.install(work) }
}

/// This many threads, or as many as there are processors.
fn thread_pool(threads: Option<usize>) -> Result<ThreadPool> {
    let is_valid = threads.is_none_or(|threads| (1..=1024).contains(&threads));
    ensure!(is_valid, "--threads must be between 1 and 1024");
    // Zero stands for as many as there are processors.
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    pool.context("cannot start the threads")
}

/// Returns default settings with this method and its options.
///
/// # Errors
/// If an option is invalid.
pub fn kernel_settings(kernels: &KernelArgs) -> Result<Settings> {
    let (method, options) = (kernels.method, kernels.options()?);
    Ok(Settings { method, options, ..Settings::default() })
}

/// Returns the settings with antialiasing and ambient occlusion added.
pub fn with_effects(settings: &Settings) -> Settings {
    let antialias = Pattern::of(RAYS).expect("one of them");
    Settings { occlusion: true, antialias, ..settings.clone() }
}

/// Returns settings from the flags of the method, at a given size and with default shading.
///
/// # Errors
/// If an option is invalid.
pub fn method_settings(method: &TracingArgs, Size { width, height }: Size) -> Result<Settings> {
    let settings = kernel_settings(&method.kernels)?;
    let shadow_depth = method.shadow_depth;
    if let Some(depth) = shadow_depth {
        check_depth(depth, settings.options.precision)
            .map_err(|why| anyhow!("--shadow-depth {depth}: {why}"))?;
    }
    Ok(Settings {
        width,
        height,
        shadow_depth,
        choices: method.choices.0,
        normals: Some(method.normals),
        ..settings
    })
}

fn settings(arguments: &RenderArgs) -> Result<Settings> {
    let shading = &arguments.shading;
    let background = |text: &String| {
        let hexadecimal = || Background::typed(&format!("#{text}"));
        Background::typed(text).or_else(hexadecimal).with_context(|| {
            format!(
                "--background '{text}' is neither a color such as white or ffffff nor transparent"
            )
        })
    };
    let background = shading.background.as_ref().map(background).transpose()?;
    ensure!(shading.light.is_none_or(DVec3::is_finite), "--light needs finite numbers");
    let outputs = &arguments.outputs;
    let method = method_settings(&arguments.tracing, outputs.size)?;
    let keeps_normals = outputs.arrays.0.iter().any(|(row, _)| row.needs_normals);
    let needs_normals = outputs.output.is_some() || keeps_normals;
    let budget = budget(arguments.budget)?;
    Ok(Settings {
        normals: method.normals.filter(|_| needs_normals),
        keeps_normals,
        brackets: outputs.arrays.0.iter().any(|(row, _)| row.needs_brackets),
        limit: Limit { budget, begun: Some(Instant::now()), stop: Some(interrupt::stop_flag()) },
        undecided: shading.undecided,
        light: shading.light,
        look: shading.look,
        occlusion: true,
        antialias: Pattern::of(shading.aa.unwrap_or(RAYS)).context("--aa")?,
        depth: shading.bits.map_or(ColorDepth::Bytes, ColorDepth::of),
        background,
        ..method
    })
}

/// The time that `--budget` allows.
///
/// # Errors
/// If it is not positive, or too long.
pub fn budget(seconds: Option<f64>) -> Result<Option<Duration>> {
    let time = |seconds: f64| {
        ensure!(
            seconds > 0.0,
            "--budget {seconds}: without time nothing can be found; give seconds above 0"
        );
        Duration::try_from_secs_f64(seconds)
            .with_context(|| format!("--budget {seconds}: no such time"))
    };
    seconds.map(time).transpose()
}

/// Reports why nothing is visible, and how many pixels are undecided and why.
fn remark(
    subject: &Subject,
    region: &Region,
    settings: &Settings,
    picture: &Picture,
    (searched, has_curves): (Option<AutoDomain>, bool),
) {
    picture.remarks.iter().for_each(|remark| notes::note(remark));
    for note in picture.fallback_notes(settings.method) {
        notes::note(&note);
    }
    if picture.flat {
        notes::note(zeroset_live::FLAT);
    }
    let pixels = picture.statistics.pixels;
    let seen = pixels.hit + pixels.undecided;
    if seen == 0 && !has_curves {
        let blank = Blank::find(&subject.document, region, picture.undefined, searched);
        notes::note(&blank.describe(&|ends| format!("--domain {ends}")));
        return;
    }
    if let Some(why) = picture.why_undecided() {
        let all = pixels.miss + seen;
        let are = if pixels.undecided == 1 { "is" } else { "are" };
        notes::note(&format!("{} of {all} pixels {are} undecided: {why}", pixels.undecided));
    }
    let UndecidedStatistics { blank, unreached, .. } = picture.statistics.open;
    if settings.limit.is_stopped() && unreached > 0 {
        notes::note(&format!(
            "{unreached} of these were not reached before Ctrl-C and are not drawn"
        ));
    } else if let Some(budget) = settings.limit.budget.filter(|_| unreached > 0) {
        notes::note(&format!(
            "{unreached} of these were not reached within {} s and are not drawn: a larger --budget \
             shows more",
            budget.as_secs_f64(),
        ));
    }
    let deepens = picture.method.reads.contains(&DEPTH);
    let passed_over = blank - unreached;
    if deepens && picture.statistics.work.given_up > 0 {
        notes::note(&format!(
            "some rays were given up after {} steps and stay undecided: a smaller --max-depth takes \
             less time, --precision f64 may decide more of them",
            zeroset_trace::MOST_STEPS,
        ));
    } else if passed_over > 0 {
        // Advise only options that can still help.
        let advice = match (deepens, settings.options.precision) {
            (true, Precision::F64) => "; a larger --max-depth may decide more of them",
            (true, _) => "; a larger --max-depth or --precision f64 may decide more of them",
            (false, Precision::F32) => "; --precision f64 may decide more of them",
            (false, _) => "",
        };
        notes::note(&format!(
            "{passed_over} of these are not drawn: the function has no bounds along those rays, as near \
             a pole, at a gap or beyond the range of floats, so a root there would not be seen{advice}"
        ));
    }
}
