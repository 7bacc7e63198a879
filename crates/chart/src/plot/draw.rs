//! A figure as SVG.

use super::{AxisScale, Figure, MarkShape, PlotMark, PlotSeries};
use crate::error::ChartError;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width and height of the picture, in pixels.
const SIZE: (u32, u32) = (980, 560);
/// Margins around the plot: to the left, above, and to the right, where the legend is.
const LEFT: i32 = 78;
const TOP: i32 = 44;
const LEGEND: i32 = 250;
/// Margin below the plot. If the names below it are vertical, the margin grows by `UPRIGHT` for
/// each letter of the longest name.
const BOTTOM: i32 = 58;
const UPRIGHT: i32 = 6;
/// Sizes of letters.
const TITLE: i32 = 18;
const TEXT: i32 = 13;
const SMALL: i32 = 11;
/// Greatest number of places whose names are horizontal.
const SIDEWAYS: usize = 11;

/// Colors that color-blind readers can distinguish (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(226, 226, 226);
const ZERO: RGBColor = RGBColor(242, 242, 242);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult = Result<(), Box<dyn std::error::Error>>;

struct PlotArea<'a> {
    area: Area<'a>,
    x: AxisScale,
    y: AxisScale,
    bottom: i32,
}

/// The figure as SVG text.
///
/// # Errors
/// If it cannot be written.
pub fn draw(figure: &Figure) -> Result<String, ChartError> {
    let mut svg = String::new();
    let drawn = {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        PlotArea::new(area, figure).draw(figure)
    };
    drawn.map_err(ChartError::of_chart(&figure.title))?;
    // Without a fixed size, the picture fills the available width.
    let fixed = format!("<svg width=\"{}\" height=\"{}\" ", SIZE.0, SIZE.1);
    Ok(svg.replacen(&fixed, "<svg ", 1))
}

fn font(color: RGBColor, size: i32, at: (HPos, VPos)) -> TextStyle<'static> {
    let mut style = TextStyle::from(("sans-serif", size).into_font());
    style.color = color.to_backend_color();
    style.pos(Pos::new(at.0, at.1))
}

/// Style of a Pareto front: wide and pale, so that it is visible behind other lines.
fn front_style() -> ShapeStyle {
    RGBColor(120, 120, 60).mix(0.25).stroke_width(13)
}

impl<'a> PlotArea<'a> {
    fn new(area: Area<'a>, figure: &Figure) -> Self {
        let marks = figure.series.iter().flat_map(|series| &series.marks);
        let thin = figure.series.iter().flat_map(|series| series.behind.iter().flatten());
        let points = marks.clone().map(|mark| mark.at).chain(thin.copied());
        let bars = marks.filter_map(|mark| mark.bar).flatten();
        let y =
            AxisScale::logarithmic(points.clone().map(|at| at[1]).chain(bars).chain(figure.level));
        let x = match figure.places.len() {
            0 => AxisScale::logarithmic(points.map(|at| at[0])),
            places => AxisScale::named(places),
        };
        let letters = figure.places.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        let is_upright = figure.places.len() > SIDEWAYS;
        let room = BOTTOM + if is_upright { UPRIGHT * letters as i32 } else { 0 };
        Self { area, x, y, bottom: SIZE.1 as i32 - room }
    }

    fn right() -> i32 {
        SIZE.0 as i32 - LEGEND
    }

    fn across(place: f64) -> i32 {
        LEFT + (place * f64::from(Self::right() - LEFT)).round() as i32
    }

    fn upward(&self, place: f64) -> i32 {
        self.bottom - (place * f64::from(self.bottom - TOP)).round() as i32
    }

    fn at(&self, [x, y]: [f64; 2]) -> Option<(i32, i32)> {
        Some((Self::across(self.x.place(x)?), self.upward(self.y.place(y)?)))
    }

    fn text(&self, words: &str, at: (i32, i32), style: TextStyle<'static>) -> DrawResult {
        Ok(self.area.draw(&Text::new(words, at, style))?)
    }

    fn path(&self, points: &[[f64; 2]]) -> Vec<(i32, i32)> {
        points.iter().filter_map(|point| self.at(*point)).collect()
    }

    fn draw(&self, figure: &Figure) -> DrawResult {
        self.area.fill(&WHITE)?;
        self.axes(figure)?;
        for series in &figure.series {
            for line in &series.behind {
                let thin = COLORS[series.color % COLORS.len()].mix(0.25).stroke_width(1);
                self.area.draw(&PathElement::new(self.path(line), thin))?;
            }
        }
        // The Pareto front is wide and pale. It lies behind the series.
        if let Some((_, points)) = &figure.front {
            self.area.draw(&PathElement::new(self.path(points), front_style()))?;
        }
        for series in &figure.series {
            self.series(series)?;
        }
        self.legend(figure)?;
        Ok(self.area.present()?)
    }

    fn axes(&self, figure: &Figure) -> DrawResult {
        let (right, middle) = (Self::right(), f64::midpoint);
        if let Some(end) = self.x.band() {
            let corners = [(LEFT, TOP), (Self::across(end), self.bottom)];
            self.area.draw(&Rectangle::new(corners, ZERO.filled()))?;
        }
        if let Some(end) = self.y.band() {
            let corners = [(LEFT, self.upward(end)), (right, self.bottom)];
            self.area.draw(&Rectangle::new(corners, ZERO.filled()))?;
        }
        for (place, label) in self.y.ticks() {
            let y = self.upward(place);
            self.area.draw(&PathElement::new(vec![(LEFT, y), (right, y)], GRID))?;
            self.text(&label, (LEFT - 7, y), font(INK, TEXT, (HPos::Right, VPos::Center)))?;
        }
        let is_upright = figure.places.len() > SIDEWAYS;
        let names = figure.places.iter().enumerate();
        let names = names.filter_map(|(n, name)| Some((self.x.place(n as f64)?, name.clone())));
        let ticks = if figure.places.is_empty() { self.x.ticks() } else { names.collect() };
        for (place, label) in ticks {
            let x = Self::across(place);
            self.area.draw(&PathElement::new(vec![(x, TOP), (x, self.bottom)], GRID))?;
            let style = if is_upright {
                let style = font(INK, SMALL, (HPos::Left, VPos::Center));
                style.transform(FontTransform::Rotate90)
            } else {
                font(INK, TEXT, (HPos::Center, VPos::Top))
            };
            self.text(&label, (x, self.bottom + 7), style)?;
        }
        if let Some(y) = figure.level.and_then(|level| self.y.place(level)) {
            let ends = vec![(LEFT, self.upward(y)), (right, self.upward(y))];
            self.area.draw(&PathElement::new(ends, INK.stroke_width(1)))?;
        }
        let frame = [(LEFT, TOP), (right, self.bottom)];
        self.area.draw(&Rectangle::new(frame, INK.stroke_width(1)))?;
        self.text(&figure.title, (LEFT, 12), font(INK, TITLE, (HPos::Left, VPos::Top)))?;
        let across = middle(f64::from(LEFT), f64::from(right)) as i32;
        let label = font(INK, TEXT, (HPos::Center, VPos::Bottom));
        self.text(&figure.x, (across, SIZE.1 as i32 - 8), label)?;
        let upward = middle(f64::from(TOP), f64::from(self.bottom)) as i32;
        let upright =
            font(INK, TEXT, (HPos::Center, VPos::Center)).transform(FontTransform::Rotate270);
        self.text(&figure.y, (16, upward), upright)
    }

    fn series(&self, series: &PlotSeries) -> DrawResult {
        let color = COLORS[series.color % COLORS.len()];
        if series.is_joined {
            let points: Vec<[f64; 2]> = series.marks.iter().map(|mark| mark.at).collect();
            self.area.draw(&PathElement::new(self.path(&points), color.stroke_width(2)))?;
        }
        for PlotMark { at, bar, label } in &series.marks {
            let Some(place) = self.at(*at) else { continue };
            if let Some([low, high]) = bar {
                let mut ends = self.path(&[[at[0], *low], [at[0], *high]]);
                let width = if series.shape == MarkShape::Bar { 11 } else { 1 };
                // A bar whose ends coincide is lengthened to be visible.
                if let [(_, low), (_, high)] = &mut ends[..]
                    && low == high
                {
                    (*low, *high) = (*low + 2, *high - 2);
                }
                self.area.draw(&PathElement::new(ends, color.stroke_width(width)))?;
            }
            self.mark(place, series.shape, color)?;
            if !label.is_empty() {
                let style = font(color, SMALL, (HPos::Left, VPos::Bottom));
                self.text(label, (place.0 + 5, place.1 - 4), style)?;
            }
        }
        Ok(())
    }

    fn mark(&self, (x, y): (i32, i32), shape: MarkShape, color: RGBColor) -> DrawResult {
        match shape {
            MarkShape::Disc => self.area.draw(&Circle::new((x, y), 4, color.filled()))?,
            MarkShape::Square => {
                let corners = [(x - 4, y - 4), (x + 4, y + 4)];
                self.area.draw(&Rectangle::new(corners, color.filled()))?;
            }
            MarkShape::Triangle => {
                let corners = vec![(x - 5, y + 4), (x + 5, y + 4), (x, y - 5)];
                self.area.draw(&Polygon::new(corners, color.filled()))?;
            }
            MarkShape::Bar => {}
        }
        Ok(())
    }

    fn legend(&self, figure: &Figure) -> DrawResult {
        const STEP: i32 = 22;
        let (left, mut y) = (Self::right() + 16, TOP + 10);
        let label = |x: i32, y: i32, line: &str, size: i32| {
            self.text(line, (x, y), font(INK, size, (HPos::Left, VPos::Center)))
        };
        for series in figure.series.iter().filter(|series| !series.name.is_empty()) {
            let color = COLORS[series.color % COLORS.len()];
            if series.is_joined || series.shape == MarkShape::Bar {
                let width = if series.shape == MarkShape::Bar { 11 } else { 2 };
                let ends = vec![(left, y), (left + 26, y)];
                self.area.draw(&PathElement::new(ends, color.stroke_width(width)))?;
            }
            self.mark((left + 13, y), series.shape, color)?;
            label(left + 34, y, &series.name, TEXT)?;
            y += STEP;
        }
        if let Some((name, _)) = &figure.front {
            self.area.draw(&PathElement::new(vec![(left, y), (left + 26, y)], front_style()))?;
            label(left + 34, y, name, TEXT)?;
            y += STEP;
        }
        y += 6;
        for note in &figure.notes {
            label(left, y, note, SMALL)?;
            y += 16;
        }
        Ok(())
    }
}
