//! A finished picture: colors, and what is known of each pixel.

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
use zeroset_render::png_file::{check_png, write_png};
use zeroset_scene::view::bounds;
use zeroset_space::Region;
use zeroset_trace::{PixelCounts, RayGrid, UndecidedReason};

/// A claim about the ray through a pixel's center, with its proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Status {
    /// It meets no zero in the domain.
    Miss,
    /// It meets a zero.
    Hit,
    /// Neither is proven.
    Undecided,
}

/// Numbers of pixels by [`Status`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Proven misses.
    pub miss: usize,
    /// Proven hits.
    pub hit: usize,
    /// Pixels of which neither is proven.
    pub undecided: usize,
}

/// A finished picture.
///
/// Arrays have one value per pixel, row by row from the top: the pixel in column `i` of row `j` is
/// at `j * width + i`. Distances are world lengths along the pixel's ray. They begin at the eye, or
/// in a parallel projection at the plane through the eye.
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
    rays: RayGrid,
    domain: [Interval; 3],
    rows: PictureArrays,
    /// The picture without its rows.
    whole: picture::Picture,
}

/// The arrays of a picture, from the top down to the last finished row.
#[derive(Clone, Default)]
pub(crate) struct PictureArrays {
    rgb: Vec<u8>,
    status: Vec<Status>,
    reason: Vec<UndecidedReason>,
    depth: Vec<f64>,
    bracket: Vec<[f64; 2]>,
    normal: Vec<[f32; 3]>,
    surface: Vec<u16>,
}

impl PictureArrays {
    /// Adds the next rows.
    pub fn add(&mut self, part: &picture::Picture) {
        let buffer = &part.buffer;
        let pixels = || 0..buffer.status.len();
        let status = |status: &zeroset_trace::Status| match status {
            zeroset_trace::Status::Miss => Status::Miss,
            zeroset_trace::Status::Hit => Status::Hit,
            zeroset_trace::Status::Undecided => Status::Undecided,
        };
        // Where the background shows, a buffer may hold normals of an earlier picture.
        let normal = |n: usize| if buffer.is_drawn(n) { buffer.normal[n] } else { [0.0; 3] };
        self.rgb.extend(&part.rgb);
        self.status.extend(buffer.status.iter().map(status));
        self.reason.extend(pixels().map(|n| buffer.reason(n)));
        self.depth.extend(&buffer.drawn);
        self.bracket.extend(&buffer.bracket);
        self.normal.extend(pixels().map(normal));
        self.surface.extend(pixels().map(|n| buffer.surface[n]));
    }
}

impl Picture {
    /// A picture whose rows are all there; `whole` tells of all of them.
    pub(crate) fn new(
        rays: RayGrid,
        region: &Region,
        rows: PictureArrays,
        whole: picture::Picture,
    ) -> Self {
        Self { rays, domain: bounds(region), rows, whole }
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

    /// Returns the status of each pixel.
    pub fn status(&self) -> &[Status] {
        &self.rows.status
    }

    /// Returns the distance of the point that is drawn in each pixel; +∞ if the background shows.
    pub fn depth(&self) -> &[f64] {
        &self.rows.depth
    }

    /// Returns the unit normal of the surface that is drawn in each pixel, toward f > 0; 0 if the
    /// background shows. Normals are for looks and not proven.
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.rows.normal
    }

    /// Returns for each hit the distances between which its first zero is proven to lie; NaN for
    /// other pixels.
    pub fn brackets(&self) -> &[[f64; 2]] {
        &self.rows.bracket
    }

    /// Returns why a pixel is undecided; `None` if it is decided, or outside of the picture.
    pub fn reason(&self, column: usize, row: usize) -> Option<Reason> {
        let pixel = self.pixel(column, row)?;
        let is_open = self.rows.status[pixel] == Status::Undecided;
        is_open.then(|| Reason::of(self.rows.reason[pixel]))
    }

    /// Returns the number of the surface that is drawn in a pixel, in the order of
    /// [`Scene::surfaces`](crate::Scene::surfaces); `None` if the background shows, or outside of
    /// the picture.
    pub fn surface(&self, column: usize, row: usize) -> Option<usize> {
        let pixel = self.pixel(column, row)?;
        self.rows.depth[pixel].is_finite().then(|| self.rows.surface[pixel].into())
    }

    /// Returns the ray through a pixel's center; `None` outside of the picture. Its direction may
    /// have any length.
    pub fn ray(&self, column: usize, row: usize) -> Option<Ray> {
        self.pixel(column, row)?;
        let zeroset_space::Ray { origin, direction } = self.rays.ray(column, row);
        Some(Ray { origin: origin.into(), direction: direction.into() })
    }

    /// Counts the pixels of each status.
    pub fn counts(&self) -> Counts {
        let PixelCounts { miss, hit, undecided } = self.whole.statistics.pixels;
        Counts { miss, hit, undecided }
    }

    /// Counts the undecided pixels by reason. Reasons without pixels are left out.
    pub fn undecided(&self) -> impl Iterator<Item = (Reason, usize)> {
        let counts = self.whole.statistics.open.reasons;
        let all = UndecidedReason::ALL.into_iter().zip(counts);
        all.filter(|(_, count)| *count > 0).map(|(reason, count)| (Reason::of(reason), count))
    }

    /// Returns the box of x, y and z in which the surfaces were looked for. The text may cut it
    /// further.
    pub fn domain(&self) -> [RangeInclusive<f64>; 3] {
        self.domain.map(|Interval { lo, hi }| lo..=hi)
    }

    /// Returns the method that found the surfaces. It is another than the settings' if that could
    /// find none of them, for example because the formulas are too large for it.
    pub fn method(&self) -> Method {
        Method(self.whole.method)
    }

    /// Returns remarks on formulas that are constant in the domain, one line each.
    pub fn remarks(&self) -> &[String] {
        &self.whole.remarks
    }

    /// Writes the picture to a PNG file. The file appears whole or not at all: a file that was
    /// there is replaced at the end.
    ///
    /// # Errors
    /// If the path has another extension than `png`, or cannot be written.
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

    /// Writes the picture as PNG (sRGB, eight bits a channel) to a sink.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn write_png(&self, out: impl Write) -> Result<(), Error> {
        let failed = |error| Error::new(ErrorKind::File, format!("cannot write the PNG: {error}"));
        self.encode(out).map_err(failed)
    }

    fn encode(&self, out: impl Write) -> std::io::Result<()> {
        write_png(out, &self.rows.rgb, [self.width(), self.height()], &[])
    }

    /// The index of a pixel, if it is in the picture.
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
