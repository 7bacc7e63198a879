//! The automatic camera: as near as the visible points allow, on the side from which more is seen,
//! and no edge-on view of flat surfaces.
//!
//! The visible points come from a small picture of the whole region. Hidden points lie within the
//! same outline, so only the visible points have to fit. Nothing here is a proof, and nothing
//! depends on the picture's method or on threads.

use crate::model::Model;
use crate::picture::Settings;
use glam::{DQuat, DVec3};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::view::SceneError;
use zeroset_shade::Light;
use zeroset_space::{Basis, Camera, CameraError, Projection, Region};
use zeroset_trace::{RayGrid, TraceOptions};

/// Rows and columns of the small picture.
const SIDE: usize = 64;

/// Share of the picture's shorter side that the visible points fill.
const FILLED: f64 = 0.86;

/// Share of the picture's width or height that the box fills. The margin is for axis labels.
const FILLED_BY_DOMAIN: f64 = 0.8;

/// Radius around a visible point that must also be in the picture, in pixels of the small picture.
const SPOT_RADIUS: f64 = 0.75;

/// Least number of visible points. With fewer, the camera shows the whole region.
const LEAST: usize = 8;

/// A surface is flat if its thickness is below `THIN` of its width. A flat surface is viewed from a
/// direction whose angle to the surface has at least the sine `LEAST_SINE`.
const THIN: f64 = 0.15;
const LEAST_SINE: f64 = 0.55;

/// For a camera that turns around its target: number of sides from which small pictures are taken,
/// and number of camera positions from which the points in these pictures must fit.
const ROUND_SIDES: usize = 4;
const ROUND_STEPS: usize = 24;

/// The camera turns to another side only if `MORE` times as much of the surface is visible from
/// there. Undersides count as `UNDERSIDE` of their area.
const MORE: f64 = 1.15;
const UNDERSIDE: f64 = 0.25;

/// A plane is vertical if the vertical part of its unit normal is below this.
const VERTICAL: f64 = 0.05;

/// Number of sides among which the camera chooses. They are a quarter turn apart.
const TURNS: usize = 4;

/// Shadows need not fit into the picture if the direction to the light rises less than this.
const LEAST_RISE: f64 = 0.5;

/// Neighboring visible points lie on one part of a surface if they are at most this many pixels of
/// the small picture apart.
const JOINED: f64 = 8.0;

/// Directions from which flat surfaces are viewed, in order of preference.
const SIDES: [DVec3; 5] = [
    DVec3::new(2.0, -3.0, 2.6),
    DVec3::new(3.0, 2.0, 2.6),
    DVec3::new(-2.0, -3.0, 2.6),
    DVec3::new(2.0, -3.0, 6.0),
    DVec3::new(-3.0, 2.0, 2.6),
];

/// The camera for pictures of `model`. Camera settings in `choice` or the model's document are
/// kept. If neither sets an eye, a target, a scale, or a view other than the default, the visible
/// points are fitted into the picture. With `axes`, the region's whole box and its labels are
/// fitted instead. Returns `None` once `wanted` returns false.
///
/// # Errors
/// If eye and target coincide, if the up direction is parallel to the view, or if a number is out
/// of range.
pub fn camera_while(
    model: &Model,
    choice: &CameraChoice,
    settings: &Settings,
    axes: bool,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Camera>, SceneError> {
    let framing = Framing { region: model.region(), choice, typed: model.camera(), settings };
    if axes { framing.of_domain(&[model], wanted) } else { framing.over(&[model], false, wanted) }
}

/// The camera that shows the whole region, unless the caller or the document sets another one.
///
/// # Errors
/// If the choices do not describe a camera.
pub fn whole(model: &Model, choice: &CameraChoice) -> Result<Camera, SceneError> {
    Ok(camera::camera(&choice.or(*model.camera()), model.region())?)
}

/// Like [`camera_while`], within a part of the settings' time budget. When that time is over, the
/// camera shows the whole region.
///
/// # Errors
/// As [`camera_while`].
pub fn camera(
    model: &Model,
    choice: &CameraChoice,
    settings: &Settings,
    axes: bool,
) -> Result<Camera, SceneError> {
    let wanted = settings.limit.wanted_to_choose();
    match camera_while(model, choice, settings, axes, &wanted)? {
        Some(camera) => Ok(camera),
        None => whole(model, choice),
    }
}

/// The region, the choices and the settings from which a camera is made.
pub(crate) struct Framing<'a> {
    /// The region of the pictures.
    pub region: &'a Region,
    /// The caller's choice.
    pub choice: &'a CameraChoice,
    /// The document's choice.
    pub typed: &'a CameraChoice,
    /// The settings of the pictures.
    pub settings: &'a Settings,
}

impl Framing<'_> {
    /// The camera for pictures of these models. If `is_turned`, the camera will turn about its
    /// target, and the points visible from all sides must fit. Returns `None` once `wanted` returns
    /// false.
    pub fn over(
        &self,
        models: &[&Model],
        is_turned: bool,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Camera>, SceneError> {
        let Self { region, settings, .. } = *self;
        let (given, view) = self.usual()?;
        let Some(view) = view else { return Ok(Some(given)) };
        // All fitting is done in the displayed space.
        let (stretch, usual) = (region.stretch(), given.displayed());
        let back = (usual.eye() - usual.target()).normalize();
        let look = |back: DVec3| view.seen(models, back, region, settings, wanted);
        let add_shadows = |back: DVec3, spots: &mut Vec<Spot>| {
            let Some(ground) = ground_height(models, settings) else { return };
            let Ok(camera) = view.fitted(back, spots, FILLED) else { return };
            let light = models[0]
                .key_light(settings, &RayGrid::new(&camera.in_stretched(stretch), SIDE, SIDE));
            spots.extend(shadows(spots, ground * stretch.z, &light));
        };
        if is_turned {
            let look = |back: DVec3| {
                let mut seen = look(back)?;
                if let Some(seen) = &mut seen {
                    add_shadows(back, &mut seen.spots);
                }
                Ok(seen)
            };
            let fitted = view.fitted_around(back, &usual, region, &look)?;
            return Ok(fitted.map(|camera| camera.in_stretched(stretch)));
        }
        let Some((side, seen)) = self.best_side(&view, &usual, &look)? else { return Ok(None) };
        let mut spots = if seen.spots.len() < LEAST { corners(region) } else { seen.spots };
        add_shadows(side, &mut spots);
        let fitted = view.fitted(side, &spots, FILLED);
        // If floats cannot represent the fitted camera, the camera shows the whole region.
        Ok(Some(fitted.unwrap_or(usual).in_stretched(stretch)))
    }

    /// The side from which most is seen, as a direction toward the eye, and all that `look` has
    /// seen from this and other sides. Returns `None` once `look` returns `None`.
    fn best_side(
        &self,
        view: &FreeView,
        usual: &Camera,
        look: &dyn Fn(DVec3) -> Result<Option<Seen>, SceneError>,
    ) -> Result<Option<(DVec3, Seen)>, SceneError> {
        let back = (usual.eye() - usual.target()).normalize();
        let Some(mut seen) = look(back)? else { return Ok(None) };
        let mut side = back;
        if self.is_upright() {
            let flat = flat(&seen.spots);
            let sides = match flat {
                Some(normal) => view.steep(normal, back).into_iter().collect(),
                None => (1..TURNS).map(|n| turned(usual.up(), n, TURNS) * back).collect::<Vec<_>>(),
            };
            for other in sides {
                let Some(mut found) = look(other)? else { return Ok(None) };
                // No point lies outside of the outline, from whatever side it was found.
                found.spots.append(&mut seen.spots);
                seen.spots = found.spots;
                if flat.is_some() || found.area > MORE * seen.area {
                    (side, seen.area) = (other, found.area);
                }
            }
        }
        Ok(Some((side, seen)))
    }

    /// The camera that shows the whole region, unless the caller or the document sets another one.
    pub fn whole(&self) -> Result<Camera, SceneError> {
        Ok(self.usual()?.0)
    }

    /// Fits the region's whole box with its axis labels, seen from the best side. Returns `None`
    /// once `wanted` returns false.
    pub fn of_domain(
        &self,
        models: &[&Model],
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Camera>, SceneError> {
        let Self { region, settings, .. } = *self;
        let (given, view) = self.usual()?;
        let Some(view) = view else { return Ok(Some(given)) };
        let usual = given.displayed();
        let stretch = region.stretch();
        let look = |back: DVec3| view.seen(models, back, region, settings, wanted);
        let Some((back, _)) = self.best_side(&view, &usual, &look)? else { return Ok(None) };
        let slope = FILLED_BY_DOMAIN * view.slope();
        let fitted = view.fitted_within(back, &corners(region), [slope * view.aspect, slope]);
        Ok(Some(fitted.unwrap_or(usual).in_stretched(stretch)))
    }

    /// Returns whether neither the caller nor the document chooses the upward direction.
    fn is_upright(&self) -> bool {
        self.choice.up.is_none() && self.typed.up.is_none()
    }

    /// The camera for the whole region, and data for a fitted camera: `None` if the view is fixed.
    fn usual(&self) -> Result<(Camera, Option<FreeView>), SceneError> {
        let choice = self.choice.or(*self.typed);
        let usual = camera::camera(&choice, self.region)?;
        let view = match usual.projection() {
            Projection::Perspective { fov } if !choice.is_fixed() => {
                let aspect = self.settings.width as f64 / self.settings.height as f64;
                Some(FreeView { fov, up: usual.displayed().up(), aspect })
            }
            Projection::Perspective { .. } | Projection::Orthographic { .. } => None,
        };
        Ok((usual, view))
    }
}

/// The points that are visible from one side.
struct Seen {
    spots: Vec<Spot>,
    /// Approximate area of the visible parts, in which undersides count as [`UNDERSIDE`].
    area: f64,
}

/// A visible point, and a radius around it that must also be in the picture.
#[derive(Clone, Copy)]
struct Spot {
    at: DVec3,
    radius: f64,
}

/// The corners of the region's box as displayed.
fn corners(region: &Region) -> Vec<Spot> {
    camera::corners(&region.displayed()).map(|at| Spot { at, radius: 0.0 }).to_vec()
}

/// The height of the lowest ground of these models. `None` without a ground.
fn ground_height(models: &[&Model], settings: &Settings) -> Option<f64> {
    let grounded = models.iter().filter(|model| model.has_ground(settings));
    grounded.map(|model| model.ground_height()).filter(|height| height.is_finite()).reduce(f64::min)
}

/// The shadows of visible points on a ground of this height. Empty if the light is so low that
/// shadows are too long for a picture.
fn shadows(spots: &[Spot], ground: f64, light: &Light) -> Vec<Spot> {
    let shadow = |spot: &Spot| {
        let (way, _) = light.towards(spot.at);
        let far = (spot.at.z - ground) / way.z;
        (way.z > LEAST_RISE).then_some(Spot { at: spot.at - far * way, radius: spot.radius })
    };
    spots.iter().map(shadow).collect::<Option<_>>().unwrap_or_default()
}

/// Properties of a camera of the displayed space that fitting does not change.
struct FreeView {
    fov: f64,
    up: DVec3,
    /// Aspect ratio: width divided by height.
    aspect: f64,
}

impl FreeView {
    /// The visible points in small pictures of the models, viewed from the direction `back`.
    /// Returns `None` once `wanted` returns false.
    fn seen(
        &self,
        models: &[&Model],
        back: DVec3,
        region: &Region,
        settings: &Settings,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Seen>, SceneError> {
        let camera = self.fitted(back, &corners(region), 1.0)?;
        let small = Settings {
            options: TraceOptions {
                precision: settings.options.precision,
                ..TraceOptions::default()
            },
            width: SIDE,
            height: SIDE,
            is_preview: true,
            normals: None,
            ..Settings::default()
        };
        let stretch = region.stretch();
        let in_space = camera.in_stretched(stretch);
        let rays = RayGrid::new(&in_space, SIDE, SIDE);
        let forward = rays.forward();
        let slope = self.slope();
        let (mut spots, mut area) = (Vec::new(), 0.0);
        for model in models {
            let picture = model.trace(&in_space, &small, &|_| wanted())?;
            if !wanted() {
                return Ok(None);
            }
            let points = rays.drawn_points(&picture.buffer.drawn);
            let points: Vec<_> = points.map(|at| DVec3::from_array(at) * stretch).collect();
            let pixel = |at: DVec3| (at - camera.eye()).dot(forward) * 2.0 * slope / SIDE as f64;
            let spot = |&at: &DVec3| Spot { at, radius: SPOT_RADIUS * pixel(at) };
            spots.extend(points.iter().filter(|at| at.is_finite()).map(spot));
            spots.extend(model.curves().places().map(|at| Spot { at: at * stretch, radius: 0.0 }));
            area += visible_area(&points, &pixel, self.up);
        }
        Ok(Some(Seen { spots, area }))
    }

    /// A camera on the side of `back` whose eye can turn around its target about an upright axis.
    /// It fits the points that `look` finds from all sides. Returns `usual` if that camera is not
    /// valid in floats, and `None` once `look` returns `None`.
    fn fitted_around(
        &self,
        back: DVec3,
        usual: &Camera,
        region: &Region,
        look: &dyn Fn(DVec3) -> Result<Option<Seen>, SceneError>,
    ) -> Result<Option<Camera>, SceneError> {
        let axis = usual.up().normalize();
        let turn = |n, of| turned(axis, n, of);
        let mut seen = Vec::new();
        for side in 0..ROUND_SIDES {
            let back = turn(side, ROUND_SIDES) * back;
            let Some(found) = look(back)? else { return Ok(None) };
            seen.extend(found.spots);
        }
        if seen.len() < LEAST {
            seen = corners(region);
        }
        let least = |a: DVec3, spot: &Spot| a.min(spot.at);
        let most = |a: DVec3, spot: &Spot| a.max(spot.at);
        let low = seen.iter().fold(DVec3::INFINITY, least);
        let high = seen.iter().fold(DVec3::NEG_INFINITY, most);
        let centre = low.midpoint(high);
        let around = |n: usize| {
            let turn = turn(n, ROUND_STEPS);
            let moved = move |spot: &Spot| Spot { at: centre + turn * (spot.at - centre), ..*spot };
            seen.iter().map(moved)
        };
        let everywhere: Vec<Spot> = (0..ROUND_STEPS).flat_map(around).collect();
        let Ok(camera) = self.fitted(back, &everywhere, FILLED) else { return Ok(Some(*usual)) };
        // Move eye and target together, so that the target lies on the upright axis.
        let (eye, target) = (camera.eye(), camera.target());
        let off = (target - centre).reject_from(axis);
        let on_axis = Camera::new(eye - off, target - off, usual.up(), camera.projection());
        Ok(Some(on_axis.unwrap_or(camera)))
    }

    /// The direction from which to view a plane with this normal. `None` if the direction `back`
    /// shows it neither edge-on nor from below.
    fn steep(&self, normal: DVec3, back: DVec3) -> Option<DVec3> {
        // Picks the normal of the upper side, or for a vertical plane that of the visible side.
        let upward = normal.dot(self.up);
        let facing = if upward.abs() < VERTICAL { normal.dot(back) } else { upward };
        let normal = normal * facing.signum();
        if normal.dot(back) >= LEAST_SINE {
            return None;
        }
        // Sides are given for z as upward direction.
        let upright = DQuat::from_rotation_arc(DVec3::Z, self.up.normalize());
        let all = SIDES.map(|side| upright * side.normalize());
        Some(*all.iter().find(|side| normal.dot(**side) >= LEAST_SINE).unwrap_or(&all[0]))
    }

    /// Half of the height that is visible at a distance of 1.
    fn slope(&self) -> f64 {
        (self.fov.to_radians() / 2.0).tan()
    }

    /// The nearest camera on the side of `back` that shows all spots within `share` of the
    /// picture's shorter side.
    fn fitted(&self, back: DVec3, spots: &[Spot], share: f64) -> Result<Camera, CameraError> {
        self.fitted_within(back, spots, [share * self.slope() * self.aspect.min(1.0); 2])
    }

    /// The nearest camera that shows all spots within the slopes `broad` sideways and `high`
    /// upward.
    fn fitted_within(
        &self,
        back: DVec3,
        spots: &[Spot],
        [broad, high]: [f64; 2],
    ) -> Result<Camera, CameraError> {
        let projection = Projection::Perspective { fov: self.fov };
        let middle = spots.iter().map(|spot| spot.at).sum::<DVec3>() / spots.len() as f64;
        let size = spots.iter().map(|spot| (spot.at - middle).length()).fold(0.0, f64::max);
        let trial =
            Camera::new(middle + back * size.max(f64::MIN_POSITIVE), middle, self.up, projection)?;
        let Basis { forward, right, up } = trial.basis();
        // Distance by which a plane through the eye and an edge of the picture must be moved
        // outward to contain all spots.
        let edge = |side: DVec3, slope: f64| {
            let room = (1.0 + slope * slope).sqrt();
            let outside = |spot: &Spot| {
                let way = spot.at - middle;
                way.dot(side) - slope * way.dot(forward) + room * spot.radius
            };
            spots.iter().map(outside).fold(f64::NEG_INFINITY, f64::max)
        };
        let [left, right_edge] = [edge(-right, broad), edge(right, broad)];
        let [bottom, top] = [edge(-up, high), edge(up, high)];
        let distance = ((left + right_edge) / (2.0 * broad)).max((bottom + top) / (2.0 * high));
        let across = right * ((right_edge - left) / 2.0) + up * ((top - bottom) / 2.0);
        let target = middle + across;
        Camera::new(target - forward * distance, target, self.up, projection)
    }
}

/// The n-th of `of` equal turns about an axis.
fn turned(axis: DVec3, n: usize, of: usize) -> DQuat {
    DQuat::from_axis_angle(axis.normalize(), std::f64::consts::TAU * n as f64 / of as f64)
}

/// The approximate visible area of a surface. `points` has the visible point of each pixel of a
/// small picture, or NaN. `pixel` gives the width of a pixel at a point. Undersides count as
/// [`UNDERSIDE`] of their area.
fn visible_area(points: &[DVec3], pixel: &dyn Fn(DVec3) -> f64, up: DVec3) -> f64 {
    let area = |(n, &here): (usize, &DVec3)| {
        let beside = points.get(n + 1).filter(|_| (n + 1) % SIDE != 0);
        let Some((&beside, &below)) = beside.zip(points.get(n + SIDE)) else { return 0.0 };
        let (across, down) = (beside - here, below - here);
        // This is false for NaN, too.
        let is_joined = [across, down].iter().all(|way| way.length() <= JOINED * pixel(here));
        let normal = down.cross(across);
        match (is_joined, normal.dot(up) >= 0.0) {
            (false, _) => 0.0,
            (true, true) => normal.length(),
            (true, false) => UNDERSIDE * normal.length(),
        }
    };
    points.iter().enumerate().map(area).sum()
}

/// The normal of a plane to which all spots are near. `None` if there is no such plane.
fn flat(spots: &[Spot]) -> Option<DVec3> {
    let first = spots.first()?.at;
    let farthest = |distance: &dyn Fn(DVec3) -> f64| {
        let by_distance =
            |one: &&Spot, other: &&Spot| distance(one.at).total_cmp(&distance(other.at));
        spots.iter().max_by(by_distance).map(|spot| spot.at)
    };
    let one = farthest(&|at| (at - first).length())?;
    let other = farthest(&|at| (at - one).length())?;
    let along = (other - one).normalize_or_zero();
    let off = |at: DVec3| (at - one).reject_from(along);
    if along == DVec3::ZERO {
        return None;
    }
    let third = farthest(&|at| off(at).length())?;
    let normal = along.cross(off(third)).normalize_or_zero();
    let heights = spots.iter().map(|spot| (spot.at - one).dot(normal));
    let [low, high] = heights.fold([0.0_f64; 2], |[low, high], h| [low.min(h), high.max(h)]);
    let is_flat = normal != DVec3::ZERO && high - low < THIN * off(third).length();
    is_flat.then_some(normal)
}
