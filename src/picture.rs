//! A finished picture: its colors, and what is proven about each pixel.

use crate::error::{Error, ErrorKind};
use crate::ray::{Ray, Reason};
use crate::settings::Method;
use std::fmt;
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::Path;
use zeroset_interval::Interval;
use zeroset_render::atomic_file::AtomicFile;
use zeroset_render::picture;
use zeroset_render::pixels::samples;
use zeroset_render::png_file::{PngFormat, check_png, write_png};
use zeroset_scene::view::bounds;
use zeroset_space::{Projection, Region};
use zeroset_trace::{PixelCounts, RayGrid, UndecidedReason};

/// A claim about the ray through a pixel's center, with its proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Status {
    /// Proven: the ray meets no zero in the domain.
    Miss,
    /// Proven: the ray meets a zero in the domain.
    Hit,
    /// Neither a hit nor a miss is proven.
    Undecided,
}

/// Number of pixels with each [`Status`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Pixels that are proven misses.
    pub miss: usize,
    /// Pixels that are proven hits.
    pub hit: usize,
    /// Pixels for which neither a hit nor a miss is proven.
    pub undecided: usize,
}

/// The view from which a picture was taken. Coordinates are in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Viewpoint {
    /// Position of the eye.
    pub eye: [f64; 3],
    /// The point in the middle of the picture.
    pub target: [f64; 3],
    /// A direction that points up in the picture. It need not be perpendicular to the view.
    pub up: [f64; 3],
    /// The angle of view from the lowest to the highest edge, in degrees. `None` for a parallel
    /// projection.
    pub fov: Option<f64>,
    /// The height of the picture, for a parallel projection only.
    pub orthographic: Option<f64>,
}

impl From<zeroset_space::Camera> for Viewpoint {
    fn from(camera: zeroset_space::Camera) -> Self {
        let (fov, orthographic) = match camera.projection() {
            Projection::Perspective { fov } => (Some(fov), None),
            Projection::Orthographic { height } => (None, Some(height)),
        };
        let [eye, target, up] = [camera.eye(), camera.target(), camera.up()].map(Into::into);
        Self { eye, target, up, fov, orthographic }
    }
}

/// A finished picture.
///
/// Arrays have one value per pixel, row by row from the top. The pixel in column `i` of row `j` is
/// at `j * width + i`. Distances are measured along the pixel's ray, in world units. They begin at
/// the eye, or for parallel rays at the plane through the eye.
///
/// ```
/// use zeroset::{Scene, Settings, Status};
/// let picture = Scene::read("x^2+y^2+z^2 = 1")?.render(&Settings::new(65, 65))?;
/// let middle = 32 * picture.width() + 32;
/// assert_eq!(picture.status()[middle], Status::Hit);
/// let [near, far] = picture.brackets()[middle];
/// assert!(near <= picture.depth()[middle] && picture.depth()[middle] <= far);
/// # Ok::<(), zeroset::Error>(())
/// ```
#[derive(Clone)]
pub struct Picture {
    camera: zeroset_space::Camera,
    rays: RayGrid,
    domain: [Interval; 3],
    rows: PictureArrays,
    /// Statistics, method and remarks of the picture.
    whole: picture::Picture,
}

/// Arrays of a picture, for the rows finished so far, from the top.
#[derive(Clone, Default)]
pub(crate) struct PictureArrays {
    rgb: Vec<u8>,
    alpha: Vec<u8>,
    light: Vec<[f32; 4]>,
    status: Vec<Status>,
    reason: Vec<UndecidedReason>,
    depth: Vec<f64>,
    bracket: Vec<[f64; 2]>,
    normal: Vec<[f32; 3]>,
    surface: Vec<u16>,
}

impl PictureArrays {
    /// Appends the next rows.
    pub fn add(&mut self, part: &picture::Picture) {
        let buffer = &part.buffer;
        let pixels = || 0..buffer.status.len();
        let status = |status: &zeroset_trace::Status| match status {
            zeroset_trace::Status::Miss => Status::Miss,
            zeroset_trace::Status::Hit => Status::Hit,
            zeroset_trace::Status::Undecided => Status::Undecided,
        };
        // The buffer may still hold an earlier picture's normals in pixels of the background.
        let normal = |n: usize| if buffer.is_drawn(n) { buffer.normal[n] } else { [0.0; 3] };
        self.rgb.extend(&part.rgb);
        self.alpha.extend(&part.alpha);
        self.light.extend(&part.light);
        self.status.extend(buffer.status.iter().map(status));
        self.reason.extend(pixels().map(|n| buffer.reason(n)));
        self.depth.extend(&buffer.drawn);
        self.bracket.extend(&buffer.bracket);
        self.normal.extend(pixels().map(normal));
        self.surface.extend(pixels().map(|n| buffer.surface[n]));
    }
}

impl Picture {
    /// Makes a picture from its finished rows. Statistics, method and remarks are those of `whole`.
    pub(crate) fn new(
        camera: zeroset_space::Camera,
        rays: RayGrid,
        region: &Region,
        rows: PictureArrays,
        whole: picture::Picture,
    ) -> Self {
        Self { camera, rays, domain: bounds(region), rows, whole }
    }

    /// Returns the number of pixels in a row.
    pub fn width(&self) -> usize {
        self.rays.width()
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.rays.height()
    }

    /// Returns the colors: red, green and blue bytes (sRGB) of each pixel.
    pub fn rgb(&self) -> &[u8] {
        &self.rows.rgb
    }

    /// Returns the opacity of each pixel: 0 is transparent, and 255 is opaque. Empty unless the
    /// background is transparent. Colors are not multiplied by opacities.
    pub fn alpha(&self) -> &[u8] {
        &self.rows.alpha
    }

    /// Returns the light of each pixel: red, green and blue (primaries of sRGB, 1 at full), then
    /// the opacity. Light is not multiplied by the opacity. Empty unless
    /// [16 bits per channel](crate::Settings::bits) are set.
    pub fn light(&self) -> &[[f32; 4]] {
        &self.rows.light
    }

    /// Returns the status of each pixel.
    pub fn status(&self) -> &[Status] {
        &self.rows.status
    }

    /// Returns the distance of each pixel's drawn point; +∞ if the pixel shows the background.
    pub fn depth(&self) -> &[f64] {
        &self.rows.depth
    }

    /// Returns each pixel's drawn point; NaN if the pixel shows the background. It lies on the
    /// pixel's [ray](Self::ray), at the distance in [`depth`](Self::depth).
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        self.rays.drawn_points(&self.rows.depth)
    }

    /// Returns the unit normal of the surface drawn in each pixel, toward f > 0. It is 0 if the
    /// pixel shows the background. Normals serve for shading and are not proven.
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.rows.normal
    }

    /// Returns each hit's bracket: two distances between which the first zero is proven to lie.
    /// Brackets of other pixels are NaN.
    pub fn brackets(&self) -> &[[f64; 2]] {
        &self.rows.bracket
    }

    /// Returns why a pixel is undecided. `None` if it is decided or outside the picture.
    pub fn reason(&self, column: usize, row: usize) -> Option<Reason> {
        let pixel = self.pixel(column, row)?;
        let is_open = self.rows.status[pixel] == Status::Undecided;
        is_open.then(|| Reason::of(self.rows.reason[pixel]))
    }

    /// Returns the number of the surface drawn in a pixel, in the order of
    /// [`Scene::surfaces`](crate::Scene::surfaces). `None` if the pixel shows the background or is
    /// outside the picture.
    pub fn surface(&self, column: usize, row: usize) -> Option<usize> {
        let pixel = self.pixel(column, row)?;
        self.rows.depth[pixel].is_finite().then(|| self.rows.surface[pixel].into())
    }

    /// Returns the view from which the picture was taken.
    pub fn viewpoint(&self) -> Viewpoint {
        self.camera.into()
    }

    /// Returns the ray through a pixel's center. Its direction may have any length. `None` if the
    /// pixel is outside the picture.
    pub fn ray(&self, column: usize, row: usize) -> Option<Ray> {
        self.pixel(column, row)?;
        let zeroset_space::Ray { origin, direction } = self.rays.ray(column, row);
        Some(Ray { origin: origin.into(), direction: direction.into() })
    }

    /// Returns the number of pixels with each status.
    pub fn counts(&self) -> Counts {
        let PixelCounts { miss, hit, undecided } = self.whole.statistics.pixels;
        Counts { miss, hit, undecided }
    }

    /// Returns the number of undecided pixels for each reason. Reasons without pixels are left out.
    pub fn undecided(&self) -> impl Iterator<Item = (Reason, usize)> {
        let counts = self.whole.statistics.open.reasons;
        let all = UndecidedReason::ALL.into_iter().zip(counts);
        all.filter(|(_, count)| *count > 0).map(|(reason, count)| (Reason::of(reason), count))
    }

    /// Returns the box in which the surfaces were looked for, as ranges of x, y and z. Lines of the
    /// text may clip the surfaces further.
    pub fn domain(&self) -> [RangeInclusive<f64>; 3] {
        self.domain.map(|Interval { lo, hi }| lo..=hi)
    }

    /// Returns the method that found the surfaces. It differs from the method of the settings if
    /// the latter could find no surface, for example because the formulas are too large for it.
    pub fn method(&self) -> Method {
        Method(self.whole.method)
    }

    /// Returns one line about each formula that is constant in the domain.
    pub fn remarks(&self) -> &[String] {
        &self.whole.remarks
    }

    /// Writes the picture to a PNG file. The file appears whole or not at all. An existing file is
    /// replaced at the end.
    ///
    /// # Errors
    /// If the extension of the path is not `png`, or the file cannot be written.
    ///
    /// ```no_run
    /// use zeroset::{Scene, Settings};
    /// Scene::read("z = x*y {x^2+y^2 < 4}")?.render(&Settings::new(512, 512))?.save("saddle.png")?;
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        check_png(path).map_err(Error::argument)?;
        let save = || {
            let mut file = AtomicFile::create(path)?;
            self.encode(&mut file)?;
            file.commit()
        };
        save().map_err(|error| Error::file(path, &error))
    }

    /// Writes the picture as PNG: sRGB, eight bits per channel, or
    /// [sixteen](crate::Settings::bits). If the background is transparent, the PNG has opacities.
    ///
    /// # Errors
    /// If writing to `out` fails.
    pub fn write_png(&self, out: impl Write) -> Result<(), Error> {
        let failed = |error| Error::new(ErrorKind::File, format!("cannot write the PNG: {error}"));
        self.encode(out).map_err(failed)
    }

    fn encode(&self, out: impl Write) -> std::io::Result<()> {
        let PictureArrays { rgb, alpha, light, .. } = &self.rows;
        let (samples, format) = (samples(rgb, alpha, light), PngFormat::of(alpha, light));
        write_png(out, &samples, format, [self.width(), self.height()], &[])
    }

    /// Returns the index of a pixel in the arrays, if it is in the picture.
    fn pixel(&self, column: usize, row: usize) -> Option<usize> {
        let is_inside = column < self.width() && row < self.height();
        is_inside.then(|| row * self.width() + column)
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Picture({}×{}, {:?})", self.width(), self.height(), self.counts())
    }
}
