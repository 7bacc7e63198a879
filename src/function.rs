//! One function of x, y and z: values, bounds, and rays.

use crate::error::{Diagnostic, Error};
use crate::ray::{Ray, RayResult};
use crate::settings::{Domain, TraceSettings};
use crate::text::{Parameter, Text};
use rayon::prelude::*;
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, PoisonError};
use zeroset_eval::{Boxes, Enclosures, Kernel, LANES, Lanes, Points, Query, Values};
use zeroset_interval::{Facts, Interval};
use zeroset_scene::program::Program;
use zeroset_scene::view::{ClipChoice, ClipShape, Clipping, bounds, region};
use zeroset_space::Region;
use zeroset_syntax::{Document, SurfaceKind};
use zeroset_trace::TraceOptions;

/// Least number of batches that a thread takes: some microseconds of work.
const BATCHES: usize = 32;

/// Returns whether all numbers are finite. Sums in lanes, so that the compiler uses vectors.
fn are_finite(numbers: &[f64]) -> bool {
    let (batches, rest) = numbers.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for batch in batches {
        // The product is NaN unless the number is finite.
        sums.iter_mut().zip(batch).for_each(|(sum, number)| *sum += number * 0.0);
    }
    !sums.iter().any(|sum| sum.is_nan()) && rest.iter().all(|number| number.is_finite())
}

/// A real function of x, y and z, compiled.
///
/// [`eval`](Self::eval) samples the function, [`enclose`](Self::enclose) bounds it over boxes, and
/// [`trace`](Self::trace) finds where rays first meet its zeros. The text is an expression such as
/// `x^2+y^2+z^2-1` or an equation. An equation stands for the difference of its two sides. The text
/// may also have definitions, as the [language](crate#the-language) allows.
///
/// A function can be shared between threads. Calls use the threads of the current `rayon` pool.
pub struct Function {
    text: Text,
    /// The function as typed, compiled for all of space, so that every box is allowed.
    typed: Program,
    /// Whether the function is proven to be defined at every point of space.
    is_total: bool,
    /// Box and program of the last call that traced rays.
    traced: Mutex<Option<Arc<(Region, Program)>>>,
}

/// Bounds of a function over a box, with facts about the function on the box.
///
/// A fact that is `true` is proven. A fact that is `false` claims nothing.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Enclosure {
    /// Bounds of the function's values at all real points of the box. They are rounded outward and
    /// may be infinite. Points without a value are left out. The range is empty, from +∞ to −∞, if
    /// the function is [`undefined`](Self::undefined).
    pub bounds: RangeInclusive<f64>,
    /// The function has a value at no point of the box.
    pub undefined: bool,
    /// The function has a value at every point of the box.
    pub defined: bool,
    /// The function is defined and continuous on the whole box.
    pub continuous: bool,
}

impl Enclosure {
    /// Returns whether the box may hold a zero. `false` is a proof that it holds none.
    pub fn may_vanish(&self) -> bool {
        self.bounds.contains(&0.0)
    }

    fn of(enclosures: &Enclosures<f64>, lane: usize) -> Self {
        let facts = enclosures.facts(lane);
        let undefined = facts.has(Facts::NOWHERE);
        // Add each bound to 0, so that no bound is −0.
        let (low, high) = (0.0 - enclosures.neg_lo[lane], 0.0 + enclosures.hi[lane]);
        Self {
            bounds: if undefined { f64::INFINITY..=f64::NEG_INFINITY } else { low..=high },
            undefined,
            defined: facts.has(Facts::DEFINED),
            continuous: facts.has(Facts::CONTINUOUS),
        }
    }
}

/// The function that is negative inside of a solid, for an inequality with two sides.
fn difference(solid: &str) -> Option<String> {
    let (left, rest) = solid.split_once(['<', '>'])?;
    let (left, right) = (left.trim(), rest.trim_start_matches('=').trim());
    if right.contains(['<', '>', '{', '=']) || solid.contains(" and ") || solid.contains(" or ") {
        return None;
    }
    let (more, less) = if solid.contains('<') { (left, right) } else { (right, left) };
    let is_plain = less.chars().all(|c| c.is_ascii_alphanumeric() || c == '.');
    Some(match less {
        "0" => more.to_owned(),
        _ if is_plain => format!("{more} - {less}"),
        _ => format!("{more} - ({less})"),
    })
}

impl Function {
    /// Reads a text and compiles its one formula to native code.
    ///
    /// # Errors
    /// If the text is wrong, or draws several surfaces, a parametric one, or a solid (an
    /// inequality). If the formula is too large to compile.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let text = Text::read(text)?;
        let parametric = text.document.patches.all.len();
        let (wrong, other) = match (&text.document.surfaces[..], parametric) {
            ([surface], 0) if surface.kind == SurfaceKind::Equation => (None, None),
            ([solid], 0) => (Some("an inequality is a solid".to_owned()), difference(&solid.echo)),
            ([], 0) => (Some("these are curves and points".to_owned()), None),
            ([], 1) => (Some("this is a parametric surface".to_owned()), None),
            (several, _) => {
                (Some(format!("these are {} formulas", several.len() + parametric)), None)
            }
        };
        if let Some(wrong) = wrong {
            let other = other.map_or("render a scene".to_owned(), |text| format!("write `{text}`"));
            return Err(Error::formula(format!("{wrong} and not a function: {other}")));
        }
        let (typed, is_total) = compile(&text.document, None)?;
        Ok(Self { text, typed, is_total, traced: Mutex::default() })
    }

    /// Returns the text's parameters, in the order of their definitions.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.text.parameters()
    }

    /// Sets a parameter to exactly `value`. This compiles nothing if the value is within the
    /// parameter's range.
    ///
    /// # Errors
    /// If there is no such parameter, the value is not finite, or the formula with this value is
    /// too large to compile. The function is then unchanged.
    ///
    /// ```
    /// let mut sphere = zeroset::Function::parse("r = 1 in [0, 5]; x^2+y^2+z^2-r^2")?;
    /// sphere.set("r", 3.0)?;
    /// assert_eq!(sphere.eval(&[[0.0, 0.0, 0.0]]), [-9.0]);
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let document = self.text.with(name, value)?;
        (self.typed, self.is_total) = compile(&document, Some(&self.typed))?;
        self.text.document = document;
        let last = self.traced.get_mut().unwrap_or_else(PoisonError::into_inner);
        *last = last.take().and_then(|traced| {
            let (region, program) = &*traced;
            Some(Arc::new((*region, program.rebound(&self.text.document)?.ok()?)))
        });
        Ok(())
    }

    /// Returns notes on how ambiguous parts of the text were read.
    pub fn notes(&self) -> Vec<Diagnostic> {
        self.text.notes()
    }

    /// Samples the function at `points`, given as x, y and z. Returns one value for each point.
    ///
    /// Values are computed in `f64`. They are close, but have no error bound. For a bound,
    /// [`enclose`] a box of one point. A value is NaN where the function is undefined, where a
    /// coordinate is not finite, and where an intermediate result exceeds the floats.
    ///
    /// [`enclose`]: Self::enclose
    ///
    /// # Panics
    /// Never: the code was compiled with the function.
    ///
    /// ```
    /// let function = zeroset::Function::parse("sqrt(x) + y")?;
    /// let values = function.eval(&[[4.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]);
    /// assert_eq!(values[0], 3.0);
    /// assert!(values[1].is_nan());
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn eval(&self, points: &[[f64; 3]]) -> Vec<f64> {
        let kernel = self.typed.kernels::<f64>(0).values().expect("compiled with the function");
        self.sample(kernel, points, f64::NAN, |out, lane| out.value[lane])
    }

    /// Samples the function at the points whose coordinates are in the three slices of `axes`. This
    /// is the fastest way for very many points. Values are those of [`eval`](Self::eval).
    ///
    /// # Errors
    /// If the slices differ in length.
    ///
    /// # Panics
    /// Never: the code was compiled with the function.
    ///
    /// ```
    /// let plane = zeroset::Function::parse("x + 10*y + 100*z")?;
    /// let mut values = [0.0; 2];
    /// plane.eval_axes([&[1.0, 2.0], &[3.0, 4.0], &[5.0, 6.0]], &mut values)?;
    /// assert_eq!(values, [531.0, 642.0]);
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn eval_axes(&self, axes: [&[f64]; 3], values: &mut [f64]) -> Result<(), Error> {
        let lengths = axes.map(<[f64]>::len);
        if lengths != [values.len(); 3] {
            let [x, y, z] = lengths;
            let wrong = format!("{x}, {y} and {z} coordinates for {} values", values.len());
            return Err(Error::argument(wrong));
        }
        let kernel = self.typed.kernels::<f64>(0).values().expect("compiled with the function");
        let work = |batches: &mut [Points<f64>], (number, values): (usize, &mut [f64])| {
            let axes = axes.map(|axis| &axis[number * BATCHES * LANES..][..values.len()]);
            let is_plain = self.is_total && axes.into_iter().all(are_finite);
            let whole = if is_plain { values.len() / LANES } else { 0 };
            let (values, rest) = values.split_at_mut(whole * LANES);
            // All batches are filled before the first one is read: a wide load waits for narrow
            // stores to the same place.
            for (axis, numbers) in axes.iter().enumerate() {
                for (batch, lanes) in batches.iter_mut().zip(numbers.as_chunks::<LANES>().0) {
                    batch.at[axis] = Lanes(*lanes);
                }
            }
            let mut out = Values::<f64>::default();
            for (batch, values) in batches.iter().zip(values.as_chunks_mut::<LANES>().0) {
                kernel.eval(batch, &mut out);
                *values = out.value.0;
            }
            if !rest.is_empty() {
                let point = |n: usize| axes.map(|axis| axis[n]);
                let points: Vec<_> = (whole * LANES..axes[0].len()).map(point).collect();
                rest.copy_from_slice(&self.eval(&points));
            }
        };
        let all = || Points::<f64> { count: LANES as u32, ..Points::default() };
        let chunks = values.par_chunks_mut(BATCHES * LANES).enumerate();
        let scratch = || std::array::from_fn::<_, BATCHES, _>(|_| all());
        chunks.for_each_init(scratch, |batches, chunk| work(batches, chunk));
        Ok(())
    }

    /// Samples the gradient of the function at `points`. Returns one gradient for each point. A
    /// gradient is NaN or infinite where it does not exist. Derivatives are computed by formulas,
    /// not by differences of values. [`eval`](Self::eval) tells how accurate samples are.
    ///
    /// # Errors
    /// If the derivatives are too large to compile.
    pub fn gradient(&self, points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, Error> {
        let kernel = self.typed.kernels::<f64>(0).gradients().map_err(Error::formula)?;
        let gradient = |lanes: &zeroset_eval::Gradients<f64>, lane: usize| {
            lanes.gradient.each_ref().map(|lanes| lanes[lane])
        };
        Ok(self.sample(kernel, points, [f64::NAN; 3], gradient))
    }

    /// Bounds the function over `boxes`, given by closed ranges of x, y and z. Returns one
    /// enclosure for each box. Ends of a range may be infinite.
    ///
    /// # Errors
    /// If a range is reversed, has a NaN end, or holds no real number.
    ///
    /// # Panics
    /// Never: the code was compiled with the function.
    ///
    /// ```
    /// let sphere = zeroset::Function::parse("x^2+y^2+z^2-1")?;
    /// let found = &sphere.enclose(&[[0.0..=0.5, 0.0..=0.5, 2.0..=3.0]])?[0];
    /// assert_eq!(found.bounds, 3.0..=8.5);
    /// assert!(found.continuous && !found.may_vanish());
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn enclose(&self, boxes: &[[RangeInclusive<f64>; 3]]) -> Result<Vec<Enclosure>, Error> {
        let boxes = boxes.iter().enumerate().map(|(number, ranges)| {
            let mut bounds = [Interval::ENTIRE; 3];
            for ((range, bounds), axis) in ranges.iter().zip(&mut bounds).zip(['x', 'y', 'z']) {
                let (low, high) = (*range.start(), *range.end());
                *bounds = Interval::new(low, high).ok_or_else(|| {
                    let range = format!("the {axis} range of box {number}, {low} to {high},");
                    Error::argument(format!("{range} holds no number"))
                })?;
            }
            Ok(bounds)
        });
        let boxes = boxes.collect::<Result<Vec<_>, Error>>()?;
        let batches = boxes.par_chunks(LANES).with_min_len(BATCHES);
        let answer = |boxes: &[[Interval; 3]]| {
            let out = enclosures(&self.typed, boxes);
            (0..boxes.len()).map(move |lane| Enclosure::of(&out, lane))
        };
        Ok(batches.flat_map_iter(answer).collect())
    }

    /// Finds where rays first meet a zero of the function, within the [domain](Self::domain).
    /// Returns one result for each ray.
    ///
    /// # Errors
    /// The same as those of [`trace_with`](Self::trace_with).
    ///
    /// ```
    /// use zeroset::{Function, Ray, RayResult};
    /// let sphere = Function::parse("x^2+y^2+z^2-1")?;
    /// let ray = Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0] };
    /// let RayResult::Hit { bracket: [near, far], .. } = sphere.trace(&[ray])?[0] else {
    ///     panic!("the ray meets the sphere");
    /// };
    /// assert!(near <= 4.0 && 4.0 <= far && far - near < 1e-4);
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn trace(&self, rays: &[Ray]) -> Result<Vec<RayResult>, Error> {
        self.trace_with(rays, &TraceSettings::default())
    }

    /// Does the same as [`trace`](Self::trace), with a domain, a method or a precision of your
    /// choice.
    ///
    /// The first call for a domain compiles kernels for it, which takes some milliseconds. The
    /// kernels are kept until a call for another domain. Sixteen rays are followed together, so
    /// give neighboring rays in a row.
    ///
    /// # Errors
    /// If a ray's direction is zero, or one of its numbers is not within ±1e100. If a setting is
    /// out of range. If the formula is constant, defined nowhere, or too large to compile.
    pub fn trace_with(
        &self,
        rays: &[Ray],
        settings: &TraceSettings,
    ) -> Result<Vec<RayResult>, Error> {
        // Methods measure accuracy in pixels. Make one pixel as wide as the accuracy.
        let options = TraceOptions { tolerance: 1.0, ..settings.options()? };
        let traced = self.traced(self.region(&settings.domain)?)?;
        let (region, program) = &*traced;
        let accuracy = settings.accuracy_in(region)?;
        let tracer = settings.method.0.prepare(program.surface(0), region, options);
        RayResult::follow(&*tracer.map_err(Error::formula)?, rays, accuracy)
    }

    /// Returns the box in which [`trace`](Self::trace) looks for zeros. This is the box of the
    /// text's `domain` line. Without that line, intervals find a box. It holds all zeros if the
    /// zero set is proven to be bounded, else a part of them.
    ///
    /// # Errors
    /// If the `domain` line is impossible. If the formula is constant, defined nowhere, or too
    /// large to compile.
    pub fn domain(&self) -> Result<[RangeInclusive<f64>; 3], Error> {
        let region = self.region(&Domain::Text)?;
        Ok(bounds(&region).map(|Interval { lo, hi }| lo..=hi))
    }

    /// Returns the box of a domain. Ignores lines of the text that only cut a picture.
    fn region(&self, domain: &Domain) -> Result<Region, Error> {
        let clipping = Clipping { plane: ClipChoice::Off, to: ClipShape::Box };
        let found = region(&self.text.document, domain.choice(), clipping);
        Ok(found.map_err(Error::scene)?.0)
    }

    fn traced(&self, region: Region) -> Result<Arc<(Region, Program)>, Error> {
        // Never hold this lock while compiling: the thread may take up work that needs the lock.
        let last = || self.traced.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(traced) = last().as_ref().filter(|traced| traced.0 == region) {
            return Ok(Arc::clone(traced));
        }
        let program = Program::new(&self.text.document, bounds(&region)).map_err(Error::formula)?;
        let traced = Arc::new((region, program));
        *last() = Some(Arc::clone(&traced));
        Ok(traced)
    }

    /// For each point, reads a value from the kernel's output by `read`. Returns `nowhere` for a
    /// point at which the function is undefined or a coordinate is not finite.
    fn sample<Q: Query<Input<f64> = Points<f64>>, V: Copy + Send + Sync>(
        &self,
        kernel: &dyn Kernel<Q, f64>,
        points: &[[f64; 3]],
        nowhere: V,
        read: impl Fn(&Q::Output<f64>, usize) -> V + Sync,
    ) -> Vec<V> {
        let answer = |points: &[[f64; 3]]| {
            let out = kernel.eval_all(&Points::near(points)).swap_remove(0);
            let is_finite = |point: &[f64; 3]| point.iter().all(|c| c.is_finite());
            let mut undefined = 0;
            // Rounding can give a number where the function has no value, for example atan(1/x) at
            // 0.
            if !self.is_total {
                let place = |point: &[f64; 3]| if is_finite(point) { *point } else { [0.0; 3] };
                let place = |point| place(point).map(|c| Interval { lo: c, hi: c });
                let boxes: Vec<_> = points.iter().map(place).collect();
                undefined = enclosures(&self.typed, &boxes).nowhere;
            }
            let value = |(lane, point): (usize, &[f64; 3])| {
                let is_known = is_finite(point) && undefined >> lane & 1 == 0;
                if is_known { read(&out, lane) } else { nowhere }
            };
            points.iter().enumerate().map(value).collect::<Vec<V>>()
        };
        points.par_chunks(LANES).with_min_len(BATCHES).flat_map_iter(answer).collect()
    }
}

/// Compiles the function over all of space, with kernels for values and bounds. Reuses the code of
/// `before` if possible. Also returns whether the function is proven to be defined everywhere.
fn compile(document: &Document, before: Option<&Program>) -> Result<(Program, bool), Error> {
    let again = before.and_then(|before| before.rebound(document)?.ok());
    let anew = || Program::unchecked(document, [Interval::ENTIRE; 3]);
    let typed = again.map_or_else(anew, Ok).map_err(Error::formula)?;
    let kernels = typed.kernels::<f64>(0);
    kernels.values().map_err(Error::formula)?;
    kernels.bounds().map_err(Error::formula)?;
    let is_total = enclosures(&typed, &[[Interval::ENTIRE; 3]]).facts(0).has(Facts::DEFINED);
    Ok((typed, is_total))
}

/// Returns the enclosures over one to [`LANES`] boxes.
fn enclosures(typed: &Program, boxes: &[[Interval; 3]]) -> Enclosures<f64> {
    let kernel = typed.kernels::<f64>(0).bounds().expect("compiled with the function");
    kernel.eval_all(&Boxes::around(boxes)).swap_remove(0)
}

/// Writes the formula as it was read.
impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let echo = &self.text.document.surfaces[0].echo;
        f.write_str(echo.strip_suffix(" = 0").unwrap_or(echo))
    }
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Function({self})")
    }
}
