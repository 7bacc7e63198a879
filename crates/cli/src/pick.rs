//! The surface point under the pointer, and its description.

use super::source;
use glam::DVec3;
use serde_json::json;
use std::fmt::Write as _;
use zeroset_interval::Interval;
use zeroset_live::{Rendering, Request, quote};
use zeroset_render::model::{Located, true_digits};
use zeroset_render::picture::Precision;
use zeroset_scene::number::nearest;
use zeroset_space::Ray;
use zeroset_syntax::{Document, Parameter, ParameterKind};
use zeroset_trace::{Proves, RayGrid, Status, UndecidedReason};

/// A pixel of a rendering, and the surface point that is visible in it.
pub struct Pick<'a> {
    rendering: &'a Rendering,
    pixel: usize,
    /// Approximate error of the point, in world units.
    reach: f64,
    /// The visible surface point; `None` where the background is visible.
    pub point: Option<DVec3>,
    ray: Ray,
}

impl<'a> Pick<'a> {
    /// Returns the pixel at a position in a window of the given size; `None` outside the window.
    pub fn at(rendering: &'a Rendering, place: (f64, f64), window: (usize, usize)) -> Option<Self> {
        let buffer = &rendering.picture.buffer;
        let scaled = |at: f64, size: usize, of: usize| {
            let inside = at >= 0.0 && at < size as f64;
            inside.then(|| ((at * of as f64 / size as f64) as usize).min(of - 1))
        };
        let column = scaled(place.0, window.0, buffer.width)?;
        let row = scaled(place.1, window.1, buffer.height)?;
        let pixel = row * buffer.width + column;
        let rays = RayGrid::new(&rendering.camera, buffer.width, buffer.height);
        let ray = rays.ray_of(pixel);
        let distance = buffer.drawn[pixel];
        let point = distance.is_finite().then(|| ray.at(ray.parameter(distance)));
        let Rendering { model, picture, request, .. } = rendering;
        let reach = model.reach(picture, &rays, &request.settings, pixel);
        Some(Self { rendering, pixel, reach, point, ray })
    }

    /// The visible point, located as closely as `f64` can prove. `None` if the pixel is no hit, or
    /// shows a cap.
    fn located(&self) -> Option<Located> {
        let Rendering { model, picture, camera, request, .. } = self.rendering;
        let rays = RayGrid::new(camera, picture.buffer.width, picture.buffer.height);
        model.locate_pixel(picture, &rays, &request.settings, self.pixel)
    }

    /// Returns the coordinates in one line. Adds the surface's number if there are several
    /// surfaces, and says whether the pixel is undecided.
    pub fn coordinates(&self) -> Option<String> {
        let p = self.point?;
        let digits = self.digits();
        let buffer = &self.rendering.picture.buffer;
        let surface = match self.rendering.document.drawn_surfaces().count() {
            0 | 1 => String::new(),
            _ => format!("surface {}  ", buffer.surface[self.pixel] + 1),
        };
        let is_open = buffer.status[self.pixel] == Status::Undecided
            && buffer.reason(self.pixel) != UndecidedReason::Unproven;
        let open = if is_open { "  undecided" } else { "" };
        Some(format!("{surface}x {:.digits$}  y {:.digits$}  z {:.digits$}{open}", p.x, p.y, p.z))
    }

    /// Number of decimals to show for the point: all before the first digit of the error.
    fn digits(&self) -> usize {
        digits(self.reach).saturating_sub(1)
    }

    /// Describes the pixel in several lines: status with its reason, coordinates, value and normal.
    /// The last line is a command that evaluates the point again.
    pub fn describe(&self) -> String {
        let buffer = &self.rendering.picture.buffer;
        let (column, row) = (self.pixel % buffer.width, self.pixel / buffer.width);
        let status = match buffer.status[self.pixel] {
            Status::Miss => "miss: proven, no zero along this ray within the domain".to_owned(),
            Status::Hit => "hit: proven".to_owned(),
            Status::Undecided if buffer.reason(self.pixel) == UndecidedReason::Unproven => {
                let picture = &self.rendering.picture;
                let method = picture.method_of(picture.buffer.surface[self.pixel].into());
                match (method.proves, self.point) {
                    (Proves::Nothing, _) => format!("undecided: {} proves nothing", method.name),
                    (_, None) => format!("undecided: {} proves misses only", method.name),
                    (_, Some(_)) => format!(
                        "undecided: the surface may lie within {:.1e}; {} proves misses only",
                        self.reach, method.name,
                    ),
                }
            }
            Status::Undecided => {
                format!("undecided: a point {}", buffer.reason(self.pixel).describe())
            }
        };
        let mut text = format!("pixel {column}, {row}: {status}");
        let Some(p) = self.point else { return text };
        let surface = usize::from(buffer.surface[self.pixel]);
        let echo = self.rendering.document.drawn_surfaces().nth(surface).map_or("", |s| s.echo);
        let model = &self.rendering.model;
        let precision = model.precision();
        // Values and gradients are those of the picture's floats: show the fewest digits that
        // identify the float.
        let show = |value: f64| match precision {
            Precision::F32 => (value as f32).to_string(),
            Precision::Auto | Precision::F64 => value.to_string(),
        };
        let (p, coordinates, distance) = if let Some(located) = self.located() {
            let [near, far] = located.t.map(|t| self.ray.distance(t));
            let ulps = 4.0 * f64::EPSILON * far;
            let p = self.ray.at(located.t[0].midpoint(located.t[1]));
            let distance = true_digits(Interval { lo: near - ulps, hi: far + ulps });
            (p, located.at.map(true_digits), distance)
        } else {
            let show = |value: f64| format!("{value:.*}", self.digits());
            (p, p.to_array().map(show), show(buffer.drawn[self.pixel]))
        };
        let [x, y, z] = coordinates;
        let _ = write!(text, "\n  {echo}\n  x {x}  y {y}  z {z}  distance {distance}");
        let document = &self.rendering.document;
        let [a, b, c] = buffer.normal[self.pixel];
        let normal = format!("\n  normal {a:.4}, {b:.4}, {c:.4}");
        if surface >= document.surfaces.len() {
            // A parametric surface has no function to evaluate.
            return text + &normal;
        }
        let (value, gradient) = model.sample_typed(document, surface, p);
        let [u, v, w] = gradient.map(show);
        let _ = write!(text, "\n  f = {}  gradient {u}, {v}, {w}{normal}", show(value));
        let towards_eye = -self.ray.direction.dot(DVec3::new(a.into(), b.into(), c.into()));
        if towards_eye != 0.0 {
            let sign = if towards_eye > 0.0 { '>' } else { '<' };
            let _ = write!(text, ", seen from the side where f {sign} 0");
        }
        let (point, precision) = match precision {
            Precision::F32 => (json!(p.as_vec3().to_array()), Precision::F32),
            Precision::Auto | Precision::F64 => (json!(p.to_array()), Precision::F64),
        };
        let precision = precision.to_string();
        let mut question = json!({ "at": point, "precision": precision });
        if document.surfaces.len() > 1 {
            question["surface"] = (surface + 1).into();
        }
        let request = &self.rendering.request;
        let _ = write!(text, "\n  echo '{question}' | {}", evaluation(request, document));
        text
    }
}

/// Number of decimals for a coordinate with the error `reach`: down to the first digit of the
/// error.
fn digits(reach: f64) -> usize {
    (-reach.log10().floor()).clamp(0.0, 17.0) as usize
}

/// The command that evaluates the surfaces of a document at the points of its standard input.
fn evaluation(request: &Request, document: &Document) -> String {
    let mut command = "zeroset eval".to_owned();
    for (name, value) in &request.overrides {
        let _ = write!(command, " -D {}", quote(&format!("{name}={value}")));
    }
    // Unlike a picture, `eval` has no default for the time.
    let is_unset = |one: &&Parameter| one.kind == ParameterKind::Time && one.span.is_none();
    let start = || Some(nearest(&document.parameters.iter().find(is_unset)?.value));
    if let Some(time) = request.time.or_else(start) {
        let _ = write!(command, " --time {time}");
    }
    // The text is last, since it may be long.
    command + " " + &source::shell_word(&request.source, &request.text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::Options;

    #[test]
    fn the_command_of_a_point_names_the_text_as_it_was_entered() {
        let written = |text: &str, time, overrides: &[(&str, &str)]| {
            let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
            let overrides: Vec<_> = overrides.iter().map(owned).collect();
            let options = Options { overrides: &overrides, time, ..Options::default() };
            let document = zeroset_syntax::read(text, &options).expect(text);
            let request = Request { text: text.into(), time, overrides, ..Request::default() };
            evaluation(&request, &document)
        };
        assert_eq!(written("x = 1", None, &[]), "zeroset eval 'x = 1'");
        assert_eq!(written("x = t", None, &[]), "zeroset eval --time 0 'x = t'");
        assert_eq!(written("x = t", Some(0.5), &[]), "zeroset eval --time 0.5 'x = t'");
        let at_two = "t = 2 in [0, 3]\nx = t";
        assert_eq!(written(at_two, None, &[]), format!("zeroset eval '{at_two}'"));
        let at_three = format!("zeroset eval -D t=3 '{at_two}'");
        assert_eq!(written(at_two, None, &[("t", "3")]), at_three);
        let program = "float map(vec3 p) {\n  float d = 0.0;\n  for (int i = 0; i < 99; i++) \
                       d += 0.01*p.x;\n  return d - 0.5;\n}";
        assert_eq!(written(program, None, &[]), format!("zeroset eval '{program}'"));
    }

    #[test]
    fn places_have_the_digits_that_are_known_of_them() {
        let slab = |depth| 4.0 * 0.5_f64.powi(depth);
        assert_eq!([digits(slab(10)), digits(slab(16)), digits(slab(40))], [3, 5, 12]);
        assert_eq!([digits(1e6), digits(0.0), digits(f64::INFINITY)], [0, 17, 0]);
    }
}
