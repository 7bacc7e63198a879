//! Settings that choose how zeros are found, and how a picture shows them.

use crate::error::Error;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use zeroset_render::limit::StopFlag;
use zeroset_render::picture::{self, ColorDepth, MOST_PIXELS_HELD};
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::number::number;
use zeroset_scene::view::DomainChoice;
use zeroset_shade::Pattern;
use zeroset_space::{Projection, Region};
use zeroset_style::{ANTIALIAS, BITS, CHOICES, LOOKS, RAYS, StandardView, VIEWS};
use zeroset_syntax::SrgbColor;
use zeroset_trace::{METHODS, TraceOptions};

/// The default of [`TraceSettings::accuracy`], as a share of the domain's largest extent.
const ACCURACY: f64 = 1e-6;

/// The box in which a surface is looked for.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Domain {
    /// The box of the text's `domain` line, or [`Domain::Auto`] without such a line.
    #[default]
    Text,
    /// A box that intervals find. It is around the whole surface if the surface is proven to be
    /// bounded. Otherwise it is a window on a part of the surface.
    Auto,
    /// The box of these ranges of x, y and z. Their ends lie within ±1e18.
    Box([RangeInclusive<f64>; 3]),
}

impl From<[RangeInclusive<f64>; 3]> for Domain {
    fn from(ranges: [RangeInclusive<f64>; 3]) -> Self {
        Self::Box(ranges)
    }
}

impl Domain {
    pub(crate) fn choice(&self) -> DomainChoice {
        match self {
            Self::Text => DomainChoice::Document,
            Self::Auto => DomainChoice::Auto,
            Self::Box([x, y, z]) => {
                let [[a, b], [c, d], [e, f]] =
                    [x, y, z].map(|range| [*range.start(), *range.end()]);
                DomainChoice::Bounds([a, b, c, d, e, f])
            }
        }
    }
}

/// The floats in which kernels compute. Proofs are rigorous in every precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Precision {
    /// 32 bits, then 64 bits for rays that are still undecided.
    #[default]
    Auto,
    /// 32 bits.
    F32,
    /// 64 bits. Pictures take at least twice as long as with 32 bits.
    F64,
}

/// The appearance of undecided pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum UndecidedStyle {
    /// Undecided pixels look like hits.
    #[default]
    Shade,
    /// Undecided pixels look like hits, with stripes.
    Hatch,
    /// Undecided pixels look like hits, with a tint.
    Tint,
    /// Undecided pixels are not drawn, like misses.
    Miss,
}

/// The background of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Background {
    /// One color everywhere, as sRGB bytes.
    Color([u8; 3]),
    /// None: pixels have [opacities](crate::Picture::alpha).
    Transparent,
}

impl From<[u8; 3]> for Background {
    fn from(rgb: [u8; 3]) -> Self {
        Self::Color(rgb)
    }
}

/// Defines a type whose values are rows of a table. A row is chosen by its name.
macro_rules! rows {
    ($(#[$doc:meta])* $name:ident($row:ty), $table:ident, $what:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(pub(crate) &'static $row);

        impl $name {
            /// Returns all values. The first is the default.
            pub fn all() -> impl Iterator<Item = Self> {
                $table.iter().map(Self)
            }

            /// Returns the name of this value.
            pub fn name(self) -> &'static str {
                self.0.name
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self(&$table[0])
            }
        }

        /// Parses a name. The error for an unknown name lists all names.
        impl FromStr for $name {
            type Err = Error;

            fn from_str(name: &str) -> Result<Self, Error> {
                Self::all().find(|one| one.name() == name).ok_or_else(|| {
                    let names = Self::all().map(Self::name).collect::<Vec<_>>().join(", ");
                    Error::argument(format!("'{name}' is not a {}: {names}", $what))
                })
            }
        }
    };
}

rows! {
    /// A method to find where rays meet a surface, such as `"knoll".parse::<Method>()`. The default
    /// method `affine` proves hits and misses.
    Method(zeroset_trace::Method), METHODS, "method"
}

rows! {
    /// Lighting and background of a picture, such as `"studio".parse::<Look>()`.
    Look(zeroset_style::Look), LOOKS, "look"
}

rows! {
    /// A named side from which a picture is seen, such as `"top".parse::<View>()`.
    View(StandardView), VIEWS, "view"
}

impl Method {
    /// Returns one line on what the method does and proves.
    pub fn help(self) -> &'static str {
        self.0.help
    }
}

impl Look {
    /// Returns one line that describes the look.
    pub fn help(self) -> &'static str {
        self.0.help
    }
}

/// Settings of [`Function::trace_with`](crate::Function::trace_with). They choose the domain and
/// how zeros are found.
///
/// ```
/// use zeroset::{Precision, TraceSettings};
/// let settings = TraceSettings::new()
///     .domain([-2.0..=2.0, -2.0..=2.0, -2.0..=2.0])
///     .method("mitchell".parse()?)
///     .precision(Precision::F64)
///     .accuracy(1e-9);
/// # Ok::<(), zeroset::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct TraceSettings {
    pub(crate) domain: Domain,
    pub(crate) method: Method,
    options: TraceOptions,
    accuracy: Option<f64>,
}

/// The camera of a picture. The text's `view` line supplies the values that are not set here.
/// Values set in neither place are chosen so that everything visible fits into the picture.
///
/// ```
/// let camera = zeroset::Camera::new().eye([4.0, -5.0, 3.0]).target([0.0, 0.0, 0.0]).fov(30.0);
/// # let _ = camera;
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Camera {
    pub(crate) choice: CameraChoice,
}

/// Settings of a picture, for [`Scene::render`](crate::Scene::render).
///
/// ```
/// use zeroset::{Camera, Settings};
/// let settings = Settings::new(640, 480)
///     .domain([-2.0..=2.0, -2.0..=2.0, -2.0..=2.0])
///     .camera(Camera::new().view("top".parse()?))
///     .background([255, 255, 255]);
/// # Ok::<(), zeroset::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Settings {
    trace: TraceSettings,
    pub(crate) camera: CameraChoice,
    antialias: usize,
    bits: usize,
    pub(crate) title: Option<String>,
    pub(crate) picture: picture::Settings,
}

/// Defines methods that set one field each.
macro_rules! setters {
    ($($(#[$doc:meta])* $name:ident($value:ident: $type:ty) => $($field:ident).+ = $new:expr;)*) => {
        $(
            $(#[$doc])*
            pub fn $name(mut self, $value: $type) -> Self {
                self.$($field).+ = $new;
                self
            }
        )*
    };
}

/// Defines the setters that [`TraceSettings`] and [`Settings`] have in common.
macro_rules! trace_setters {
    ($($field:ident.)*) => {
        setters! {
            /// Sets the box in which the surface is looked for. Default: [`Domain::Text`].
            domain(domain: impl Into<Domain>) => $($field.)*domain = domain.into();
            /// Sets the method that finds zeros. Default: `affine`.
            method(method: Method) => $($field.)*method = method;
            /// Sets the floats in which kernels compute. Default: [`Precision::Auto`].
            precision(precision: Precision) => $($field.)*options.precision = match precision {
                Precision::Auto => picture::Precision::Auto,
                Precision::F32 => picture::Precision::F32,
                Precision::F64 => picture::Precision::F64,
            };
            /// Sets how often the methods `knoll` and `raa` halve a ray's path through the domain.
            /// Ranges from 1 to 20, or to 40 with [`Precision::F64`]. Default: 10.
            max_depth(halvings: u32) => $($field.)*options.depth = halvings;
            /// Sets the number of samples that `march` takes on a ray's path through the domain,
            /// and the largest number of steps of `sphere`. Ranges from 2 to 2²⁰. Default: 256.
            steps(steps: u32) => $($field.)*options.steps = steps;
        }
    };
}

impl TraceSettings {
    /// Returns the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    trace_setters!();

    setters! {
        /// Sets the largest distance between [`RayResult::Hit::t`](crate::RayResult::Hit::t) and
        /// the zero, in world units. Must be above 0. Does not affect proofs. Default: 10⁻⁶ of the
        /// domain's largest extent.
        accuracy(length: f64) => accuracy = Some(length);
    }

    /// # Errors
    /// If a setting is out of range.
    pub(crate) fn options(&self) -> Result<TraceOptions, Error> {
        self.options.check().map_err(Error::argument)?;
        Ok(self.options)
    }

    /// # Errors
    /// If the accuracy is out of range.
    pub(crate) fn accuracy_in(&self, region: &Region) -> Result<f64, Error> {
        let accuracy = self.accuracy.unwrap_or(2.0 * region.half_extent() * ACCURACY);
        let is_length = accuracy > 0.0 && accuracy.is_finite();
        ensure(is_length, || "accuracy must be a finite length above 0")?;
        Ok(accuracy)
    }
}

fn ensure<D: fmt::Display>(holds: bool, wrong: impl FnOnce() -> D) -> Result<(), Error> {
    if holds { Ok(()) } else { Err(Error::argument(wrong())) }
}

impl Camera {
    /// Returns a camera with no value set.
    pub fn new() -> Self {
        Self::default()
    }

    setters! {
        /// Looks from a named side. This overrides the eye and the upward direction of the text.
        view(view: View) => choice.view = Some(view.0);
        /// Sets the position of the eye. It may lie inside the domain.
        eye(point: [f64; 3]) => choice.eye = Some(point.into());
        /// Sets the point in the middle of the picture. Default: the center of the domain, unless
        /// the camera is fitted to the visible points.
        target(point: [f64; 3]) => choice.target = Some(point.into());
        /// Sets the direction that points up in the picture. Default: z.
        up(direction: [f64; 3]) => choice.up = Some(direction.into());
        /// Sets the vertical field of view for perspective projection, in degrees. Must be at least
        /// 10⁻⁷ and below 180. Default: 40.
        fov(degrees: f64) => choice.projection = Some(Projection::Perspective { fov: degrees });
        /// Chooses parallel projection. The picture is `height` high, in world units.
        orthographic(height: f64) => choice.projection = Some(Projection::Orthographic { height });
    }
}

/// Defines a method for each choice of a whole picture.
macro_rules! choice_setters {
    ($($(#[$doc:meta])+ $word:ident: $type:ty = $row:expr;)*) => {
        impl Settings {
            setters! {
                $($(#[$doc])+ $word($word: $type) => picture.choices.$word = Some($word);)*
            }
        }
    };
}

zeroset_style::choices!(choice_setters);

impl Settings {
    /// Returns default settings for a picture that is `width` pixels wide and `height` pixels high.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            trace: TraceSettings::default(),
            camera: CameraChoice::default(),
            antialias: RAYS,
            bits: 8,
            title: None,
            picture: picture::Settings {
                width,
                height,
                brackets: true,
                occlusion: true,
                ..picture::Settings::default()
            },
        }
    }

    trace_setters!(trace.);

    setters! {
        /// Sets how far the drawn point may be from the zero, in pixels. Must be above 0 and at
        /// most 100. Does not affect proofs. Default: 0.5.
        tolerance(pixels: f64) => trace.options.tolerance = pixels;
        /// Sets the camera. Default: on the side of the view `iso`, as near as possible.
        camera(camera: Camera) => camera = camera.choice;
        /// Sets lighting and background. Default: the look of the text's `look` line, or else the
        /// first look.
        look(look: Look) => picture.look = Some(look.0);
        /// Sets the background: sRGB bytes, or [`Background::Transparent`]. Default: the background
        /// of the text's `background` line, or else the color of the look.
        background(background: impl Into<Background>) => picture.background =
            Some(match background.into() {
                Background::Color(rgb) => zeroset_syntax::Background::Color(SrgbColor { rgb }),
                Background::Transparent => zeroset_syntax::Background::Transparent,
            });
        /// Sets the position of the light. Default: far above and to the left of the camera.
        light(point: [f64; 3]) => picture.light = Some(point.into());
        /// Turns ambient occlusion on or off. It darkens points near other surfaces, if the look
        /// does so. Default: on.
        occlusion(occlusion: bool) => picture.occlusion = occlusion;
        /// Sets how many rays give a pixel on an edge its color: 1, 4, 16 or 64. Default: 16.
        /// Statuses and distances belong to the ray through the pixel's center.
        antialias(rays: usize) => antialias = rays;
        /// Sets the bits per channel of the PNG file: 8 or 16. With 16 bits, the picture also has
        /// the [light](crate::Picture::light) of its pixels. Default: 8.
        bits(bits: usize) => bits = bits;
        /// Sets the appearance of undecided pixels. Default: [`UndecidedStyle::Shade`].
        undecided(style: UndecidedStyle) => picture.undecided = match style {
            UndecidedStyle::Shade => zeroset_shade::UndecidedStyle::Shade,
            UndecidedStyle::Hatch => zeroset_shade::UndecidedStyle::Hatch,
            UndecidedStyle::Tint => zeroset_shade::UndecidedStyle::Tint,
            UndecidedStyle::Miss => zeroset_shade::UndecidedStyle::Miss,
        };
        /// Writes a title at the top of the picture. Default: the text of the text's `title` line.
        title(title: impl Into<String>) => title = Some(title.into());
        /// Limits the time for finding surfaces. Pixels that are not reached in time are undecided
        /// and not drawn. The picture then depends on the machine, but its proofs hold. Default: no
        /// limit.
        budget(time: Duration) => picture.limit.budget = Some(time);
        /// Ends the work once the flag is set. The picture is then unfinished, as with a budget
        /// that is used up. Default: none.
        stop(flag: &'static AtomicBool) => picture.limit.stop = Some(StopFlag(flag));
    }

    /// Sets a setting by its name, as the method of that name does: `on` or `off`, or a number. The
    /// names are those of [`Settings::choices`].
    ///
    /// ```
    /// let settings = zeroset::Settings::new(640, 480).set("haze", "0.5")?.set("ground", "on")?;
    /// assert_eq!(settings, zeroset::Settings::new(640, 480).haze(0.5).ground(true));
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is no such setting, or it does not take the value.
    pub fn set(mut self, name: &str, value: &str) -> Result<Self, Error> {
        let row = CHOICES.iter().find(|row| row.word == name);
        let row = row.ok_or_else(|| Error::argument(format!("there is no setting '{name}'")))?;
        let value = row.values.read(value, number);
        let value = value.map_err(|why| Error::argument(format!("{name} {why}")))?;
        (row.set)(&mut self.picture.choices, value);
        Ok(self)
    }

    /// Returns the name of each setting that [`set`](Self::set) knows, and one line of help with
    /// its values and its default.
    pub fn choices() -> impl Iterator<Item = (&'static str, String)> {
        CHOICES.iter().map(|row| (row.word, row.flag_help()))
    }

    pub(crate) fn domain_choice(&self) -> DomainChoice {
        self.trace.domain.choice()
    }

    /// Converts the settings for rendering. The time of the budget begins here.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub(crate) fn checked(&self) -> Result<picture::Settings, Error> {
        let picture::Settings { width, height, light, .. } = self.picture;
        let has_room = |pixels: usize| (1..=MOST_PIXELS_HELD).contains(&pixels);
        ensure(width.checked_mul(height).is_some_and(has_room), || {
            format!("a picture has from 1 to {MOST_PIXELS_HELD} pixels, and not {width}×{height}")
        })?;
        let is_finite = light.is_none_or(|light| light.is_finite());
        ensure(is_finite, || "the position of the light must be finite")?;
        self.picture.choices.check().map_err(Error::argument)?;
        ANTIALIAS.check(self.antialias as f64).map_err(Error::argument)?;
        BITS.check(self.bits as f64).map_err(Error::argument)?;
        Ok(picture::Settings {
            depth: ColorDepth::of(self.bits),
            method: self.trace.method.0,
            options: self.trace.options()?,
            antialias: Pattern::of(self.antialias).unwrap_or(Pattern::ONE),
            limit: self.picture.limit.begin(),
            ..self.picture.clone()
        })
    }
}
