//! The report that `zeroset render --json` prints.

use super::subject::Subject;
use serde_json::{Map, Number, Value, json};
use std::time::Duration;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::domain::AutoDomain;
use zeroset_space::{Camera, Projection, Region};
use zeroset_trace::{Count, Fallback, OPTIONS, UndecidedReason};

/// A time in milliseconds.
pub fn ms(time: Duration) -> Value {
    (time.as_secs_f64() * 1e3).into()
}

/// Returns times, counts, camera and domain of a picture.
pub fn object(
    subject: &Subject,
    region: &Region,
    searched: Option<AutoDomain>,
    camera: &Camera,
    settings: &Settings,
    picture: &Picture,
) -> Value {
    let statistics = &picture.statistics;
    let count = |count: Count| json!({"calls": count.calls, "lanes": count.lanes});
    let (low, high) = (region.low(), region.high());
    let echoes: Vec<&str> = subject.document.drawn_surfaces().map(|one| one.echo).collect();
    let (projection, value) = match camera.projection() {
        Projection::Perspective { fov } => ("fov", fov),
        Projection::Orthographic { height } => ("ortho", height),
    };
    let kernels: Vec<Value> = statistics
        .kernels
        .iter()
        .map(|made| {
            json!({
                "surface": made.surface,
                "question": made.question,
                "form": made.form.to_string(),
                "precision": made.floats(),
                "bytes": made.bytes,
                "vector_bytes": made.vector_bytes,
                "reason": made.reason(),
            })
        })
        .collect();
    let reasons: Map<String, Value> = UndecidedReason::ALL
        .iter()
        .zip(statistics.open.reasons)
        .map(|(reason, count)| (reason.name().to_owned(), count.into()))
        .collect();
    let mut report = json!({
        "surfaces": echoes,
        "method": picture.method.name,
        "budget": settings.limit.budget.map(|budget| budget.as_secs_f64()),
        "look": picture.look.name,
        "antialias": settings.antialias.count(),
        "size": [settings.width, settings.height],
        "ms": {
            "parse": ms(subject.parse),
            "simplify": ms(statistics.times.simplify),
            "compile": ms(statistics.times.compile),
            "trace": ms(statistics.times.trace),
            "shade": ms(statistics.times.shade),
            "occlude": ms(statistics.times.occlude),
            "antialias": ms(statistics.times.antialias),
        },
        "pixels": {
            "hit": statistics.pixels.hit,
            "miss": statistics.pixels.miss,
            "undecided": statistics.pixels.undecided,
        },
        "undecided": reasons,
        "work": {
            "tile": count(statistics.work.tiles),
            "segment": count(statistics.work.segments),
            "interval": count(statistics.work.interval),
            "point": count(statistics.work.point),
            "gradient": count(statistics.work.gradient),
            "given_up": statistics.work.given_up,
        },
        "edge_rays": statistics.edge_rays,
        "code_bytes": statistics.code_bytes,
        "kernels": kernels,
        "nodes": {"before": statistics.nodes.0, "after": statistics.nodes.1},
        "camera": {
            "eye": camera.eye().to_array(),
            "target": camera.target().to_array(),
            "up": camera.up().to_array(),
            (projection): value,
        },
        "domain": [low.x, high.x, low.y, high.y, low.z, high.z],
        "stretch": region.stretch().to_array(),
        "domain_found": searched.map(|found| found.describe()),
        "clip": region.clip().map(|clip| {
            [clip.normal.x, clip.normal.y, clip.normal.z, clip.offset]
        }),
        "ball": region.ball().map(|ball| {
            [ball.centre.x, ball.centre.y, ball.centre.z, ball.radius]
        }),
    });
    for option in OPTIONS.iter().filter(|option| !option.key.is_empty()) {
        let value = (option.get)(&settings.options);
        report[option.key] = value.parse::<Number>().map_or(json!(value), Value::Number);
    }
    if !picture.fallbacks.is_empty() {
        let fallback = |(surface, fallback): &(usize, Fallback)| json!({"surface": surface, "method": fallback.method.name, "why": fallback.why});
        report["fallbacks"] = picture.fallbacks.iter().map(fallback).collect();
    }
    report
}
