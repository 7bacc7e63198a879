//! Normals from gradients, for sixteen pixels of a window at a time. Colors are computed while the
//! normals are in registers.

use super::at_roots::REACH;
use super::{BandNormals, NormalSource, OpenPixel};
use crate::shade::{ColoredRows, ShadingInput, ViewAndNormals};
use fearless_simd::{Level, f32x16, mask32x16, prelude::*, u8x16, u32x16};
use zeroset_eval::dispatch;
use zeroset_eval::{Gradients, Kernel, LANES, Lanes, Points, Real, SampleGradient};
use zeroset_interval::Format;
use zeroset_trace::painted::{PixelWindow, bits};
use zeroset_trace::{KernelStats, RayDirections, RayGrid, Status};

/// Number of windows that each step processes together. This avoids two delays. Setting the
/// rounding mode for a kernel waits for all earlier arithmetic. Reading a kernel's output right
/// away is slow.
const TOGETHER: usize = 8;

/// Greatest turn of the normal between the painted point and a point nearer to the zero, as 1 less
/// its cosine. If it turns no more, the normal at the zero is not sought.
const TURN: f32 = 1.0 / 2048.0;

impl<T: Real> NormalSource<'_, T> {
    /// Sets the normals of some rows where the gradient exists, except on caps, which have normals
    /// already. Returns the pixels without a gradient. A window is painted on the canvas if all its
    /// normals are found.
    pub(super) fn of_band(
        &self,
        seen: &ShadingInput<'_>,
        normals: &mut BandNormals<'_>,
        rays: &RayGrid,
        windows: &[PixelWindow],
        canvas: Option<&mut ColoredRows<'_>>,
        work: &mut KernelStats,
    ) -> Vec<OpenPixel> {
        if let Self::Refined { double, everywhere: true, .. } = self
            && let Ok(kernel) = double.gradients()
        {
            let (places, open) = (Places::Painted, Vec::new());
            return BandGradients { kernel, places, rays, seen, normals, canvas, open, work }
                .found(windows);
        }
        if let Self::Parametric(kernel) = *self {
            let (places, open) = (Places::Parameters, Vec::new());
            return BandGradients { kernel, places, rays, seen, normals, canvas, open, work }
                .found(windows);
        }
        if let Self::Gradient(kernel) | Self::Refined { kernel, .. } = *self {
            let (places, open) = (Places::Painted, Vec::new());
            return BandGradients { kernel, places, rays, seen, normals, canvas, open, work }
                .found(windows);
        }
        if let Some(canvas) = canvas {
            canvas.left.extend(windows);
        }
        let mut open = Vec::new();
        for &window in windows {
            let missing = PixelWindow { wanted: window.wanted & !caps(seen, window), ..window };
            normals.wait(missing, || [[0.0; 3]; LANES], &mut open);
        }
        open
    }
}

/// The lanes of a window that are on a cap.
#[inline(always)]
fn caps(seen: &ShadingInput<'_>, window: PixelWindow) -> u32 {
    if seen.columns.cap.is_empty() {
        return 0;
    }
    let cap = *window.load(seen.columns.cap, &mut [false; LANES]);
    bits(|lane| cap[lane])
}

/// Where a kernel is evaluated.
#[derive(Clone, Copy, PartialEq)]
enum Places {
    /// At painted points.
    Painted,
    /// At u and v of painted points.
    Parameters,
}

struct BandGradients<'a, 'c, 'n, T: Real> {
    kernel: &'a dyn Kernel<SampleGradient, T>,
    places: Places,
    rays: &'a RayGrid,
    /// All quantities of the rows except their normals.
    seen: &'a ShadingInput<'a>,
    normals: &'a mut BandNormals<'n>,
    canvas: Option<&'a mut ColoredRows<'c>>,
    open: Vec<OpenPixel>,
    work: &'a mut KernelStats,
}

impl<T: Real> BandGradients<'_, '_, '_, T> {
    /// Computes the normals of all pixels that have a gradient. Returns the pixels without one.
    fn found(mut self, windows: &[PixelWindow]) -> Vec<OpenPixel> {
        dispatch!(Level::new(), simd => self.compute_normals(simd, windows));
        self.open
    }

    #[inline(always)]
    fn compute_normals<S: Simd>(&mut self, simd: S, windows: &[PixelWindow]) {
        let mut points: [Points<T>; TOGETHER] = Default::default();
        let mut gradients: [Gradients<T>; TOGETHER] = Default::default();
        let zero = [f32x16::splat(simd, 0.0); 3];
        let mut eyes = [zero; TOGETHER];
        for some in windows.chunks(TOGETHER) {
            // Lanes that are not on a cap.
            let mut open = [0; TOGETHER];
            for (k, (&window, to_eye)) in some.iter().zip(&mut eyes).enumerate() {
                let ways = self.rays.ways(simd, window);
                *to_eye = ways.to_eye;
                open[k] = window.wanted & !caps(self.seen, window);
                let window = PixelWindow { wanted: open[k], ..window };
                if window.wanted != 0 {
                    self.place(simd, window, &ways, &mut points[k]);
                }
            }
            for (k, wanted) in open.into_iter().enumerate().take(some.len()) {
                if wanted != 0 {
                    self.work.gradient.called(wanted.count_ones());
                    self.kernel.eval(&points[k], &mut gradients[k]);
                }
            }
            for (k, (&window, &to_eye)) in some.iter().zip(&eyes).enumerate() {
                let (mut units, mut found) = (zero, 0);
                if open[k] != 0 {
                    (units, found) = self::units(simd, &gradients[k].gradient);
                    found &= open[k];
                    let uneven = found & self.uneven(simd, window);
                    if uneven != 0 {
                        found &= !uneven;
                        let at = (&mut points[k], &mut gradients[k]);
                        let (nearer, steady) =
                            self.nearer_zeros(simd, window, uneven, &to_eye, units, at);
                        let is_steady = mask32x16::from_bitmask(simd, steady.into());
                        for (unit, nearer) in units.iter_mut().zip(nearer) {
                            *unit = is_steady.select(nearer, *unit);
                        }
                        found |= steady;
                    }
                }
                self.finish(simd, window, open[k], (to_eye, units), found);
            }
        }
    }

    /// The lanes of a window whose gradients may change near the painted point.
    #[inline(always)]
    fn uneven<S: Simd>(&self, simd: S, window: PixelWindow) -> u32 {
        let mut spare = [false; LANES];
        let uneven = window.load(self.seen.columns.uneven, &mut spare);
        let mut bytes = [0; LANES];
        for (byte, uneven) in bytes.iter_mut().zip(uneven) {
            *byte = u8::from(*uneven);
        }
        lanes(simd, bytes)
    }

    /// Takes a step of Newton's method along the rays of hits among the `uneven` lanes, whose
    /// normals at the painted points are `units`. Returns the normals after the step, and the lanes
    /// in which the step hardly turned them. There the zero has the same normal. The batches hold
    /// the painted points and their gradients, and are overwritten.
    #[inline(always)]
    fn nearer_zeros<S: Simd>(
        &mut self,
        simd: S,
        window: PixelWindow,
        uneven: u32,
        to_eye: &[f32x16<S>; 3],
        units: [f32x16<S>; 3],
        (points, samples): (&mut Points<T>, &mut Gradients<T>),
    ) -> ([f32x16<S>; 3], u32) {
        if self.rays.is_stretched() {
            return (units, 0);
        }
        let mut spare = ([Status::Miss; LANES], [0.0; LANES]);
        let status = window.load(self.seen.columns.status, &mut spare.0);
        let drawn = window.load(self.seen.columns.drawn, &mut spare.1);
        let mut ways = [[0.0; LANES]; 3];
        for (way, to_eye) in ways.iter_mut().zip(to_eye) {
            to_eye.store_slice(way);
        }
        let ([x, y, z], values) = (&samples.gradient, &samples.value);
        let (mut steps, mut within) = ([0.0; LANES], [0_u8; LANES]);
        for lane in 0..LANES {
            let slope = x[lane].into() * f64::from(ways[0][lane])
                + y[lane].into() * f64::from(ways[1][lane])
                + z[lane].into() * f64::from(ways[2][lane]);
            // Toward the eye. If the slope is 0, the step is infinite or NaN.
            let step = values[lane].into() / slope;
            let is_near = step.abs() <= REACH * self.rays.footprint(drawn[lane]);
            steps[lane] = if is_near { step } else { 0.0 };
            within[lane] = u8::from(status[lane] == Status::Hit) & u8::from(is_near);
        }
        let reached = uneven & self::lanes(simd, within);
        if reached == 0 {
            return (units, 0);
        }
        for (coordinates, way) in points.at.iter_mut().zip(&ways) {
            for lane in 0..LANES {
                let moved = coordinates[lane].into() - steps[lane] * f64::from(way[lane]);
                coordinates[lane] = T::nearest(moved);
            }
        }
        self.work.gradient.called(reached.count_ones());
        self.kernel.eval(points, samples);
        let (nearer, found) = self::units(simd, &samples.gradient);
        let ([x, y, z], [a, b, c]) = (nearer, units);
        let cosine = z.mul_add(c, y.mul_add(b, x * a));
        let same = cosine.simd_ge(1.0 - TURN).to_bitmask() as u32;
        (nearer, reached & found & same)
    }

    /// Stores the normals of the lanes in `found`. The lanes in `open` need a normal. Paints the
    /// window on the canvas if all normals were found.
    #[inline(always)]
    fn finish<S: Simd>(
        &mut self,
        simd: S,
        window: PixelWindow,
        open: u32,
        faced: ViewAndNormals<S>,
        found: u32,
    ) {
        let is_faced = found == window.wanted;
        if open != 0 && self.normals.is_kept() {
            PixelWindow { wanted: found, ..window }.store(by_lane(&faced.1), self.normals.kept);
        }
        if !is_faced {
            let missing = PixelWindow { wanted: open & !found, ..window };
            self.normals.wait(
                missing,
                #[inline(always)]
                || by_lane(&faced.1),
                &mut self.open,
            );
        }
        if let Some(canvas) = &mut self.canvas {
            if is_faced {
                canvas.paint(simd, self.seen, window, faced);
            } else {
                canvas.left.push(window);
            }
        }
    }

    /// Writes the points at which gradients are taken.
    #[inline(always)]
    fn place<S: Simd>(
        &self,
        simd: S,
        window: PixelWindow,
        ways: &RayDirections<S>,
        points: &mut Points<T>,
    ) {
        points.count = window.count();
        if self.places == Places::Parameters {
            let mut spare = [[0.0; 2]; LANES];
            let parameters = window.load(self.seen.columns.parameters, &mut spare);
            for (lane, [u, v]) in parameters.iter().enumerate() {
                points.at[0][lane] = T::nearest(f64::from(*u));
                points.at[1][lane] = T::nearest(f64::from(*v));
            }
            return;
        }
        let mut spare = ([Status::Miss; LANES], [0.0; LANES]);
        let status = window.load(self.seen.columns.status, &mut spare.0);
        let mut distances = window.load(self.seen.columns.drawn, &mut spare.1);
        let moved;
        let is_open = |status: &Status| u8::from(*status == Status::Undecided);
        // The maximum tests all lanes at once.
        if status.iter().map(is_open).max() == Some(1) {
            moved = before(self.rays, status, *distances);
            distances = &moved;
        }
        match T::FORMAT {
            Format::F32 if !self.rays.is_stretched() => {
                write(&self.rays.points_along(simd, ways, distances), points);
            }
            Format::F32 | Format::F64 => write(&self.rays.points(simd, window, distances), points),
        }
    }
}

/// The lanes with a 1, as bits.
#[inline(always)]
fn lanes<S: Simd>(simd: S, ones: [u8; LANES]) -> u32 {
    u8x16::simd_from(simd, ones).simd_eq(1).to_bitmask() as u32
}

/// Writes coordinates, rounded to the nearest float.
#[inline(always)]
fn write<F: Real, T: Real>(at: &[Lanes<F>; 3], points: &mut Points<T>) {
    for (coordinates, at) in points.at.iter_mut().zip(at) {
        for (coordinate, &at) in coordinates.iter_mut().zip(&at.0) {
            *coordinate = T::nearest(at.into());
        }
    }
}

/// Moves undecided points half a pixel toward the eye. In most cases f only touches 0 at the point,
/// so the gradient there is mere rounding error. Nearer to the eye the gradient is larger.
fn before(rays: &RayGrid, status: &[Status; LANES], mut distances: [f64; LANES]) -> [f64; LANES] {
    for (distance, status) in distances.iter_mut().zip(status) {
        if *status == Status::Undecided {
            *distance = (*distance - 0.5 * rays.footprint(*distance)).max(0.5 * *distance);
        }
    }
    distances
}

/// The vectors scaled to length 1, and the lanes in which they are valid. A lane is not valid if
/// its vector has no direction, or its largest component is near the ends of the range of `f32`.
#[inline(always)]
fn units<S: Simd, T: Real>(simd: S, vectors: &[Lanes<T>; 3]) -> ([f32x16<S>; 3], u32) {
    /// The exponent bits of a float.
    const EXPONENT: u32 = 0xff << 23;
    let mut vector = [f32x16::splat(simd, 0.0); 3];
    for (component, lanes) in vector.iter_mut().zip(vectors) {
        let mut narrow = [0.0; LANES];
        (0..LANES).for_each(|lane| narrow[lane] = lanes[lane].into() as f32);
        *component = f32x16::simd_from(simd, narrow);
    }
    let [x, y, z] = vector;
    // If a component is NaN, so is the square of the length.
    let largest = x.abs().max(y.abs()).max(z.abs());
    // Steep gradients overflow when squared. A power of two brings the largest component to [1, 2).
    let exponent: u32x16<S> = largest.to_bits() & EXPONENT;
    let scale = f32x16::from_bits(u32x16::splat(simd, 254 << 23) - exponent);
    let [x, y, z] = [x * scale, y * scale, z * scale];
    let square = z.mul_add(z, y.mul_add(y, x * x));
    let scale = 1.0 / square.sqrt();
    // False for NaN, and where the exponent is too large or too small to be scaled.
    let found = square.simd_ge(1.0) & square.simd_le(12.0);
    ([x * scale, y * scale, z * scale], found.to_bitmask() as u32)
}

/// The vectors of a window, lane by lane.
#[inline(always)]
fn by_lane<S: Simd>(units: &[f32x16<S>; 3]) -> [[f32; 3]; LANES] {
    let mut axes = [[0.0; LANES]; 3];
    for (lanes, unit) in axes.iter_mut().zip(units) {
        unit.store_slice(lanes);
    }
    let mut vectors = [[0.0; 3]; LANES];
    for (lane, vector) in vectors.iter_mut().enumerate() {
        *vector = [axes[0][lane], axes[1][lane], axes[2][lane]];
    }
    vectors
}
