//! Charts as SVG text: curves over two axes, logarithmic or linear.
//!
//! Drawn by `plotters` with its SVG backend alone, so that no font of the machine goes into the file
//! and the same numbers make the same bytes everywhere.

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use std::ops::Range;
use thiserror::Error;

/// One method's line.
#[derive(Debug, Clone)]
pub struct Curve {
    /// As the legend says it.
    pub name: String,
    /// Which of the ten colours; the same method takes the same in every chart of a study.
    pub colour: usize,
    /// (x, y), in the order in which they are joined.
    pub points: Vec<(f64, f64)>,
}

/// How numbers lie along both axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// By their logarithm, in whole decades; every point has a ring.
    Logarithmic,
    /// By themselves, from the smallest to the largest; lines alone.
    Linear,
}

/// A chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Above it.
    pub title: String,
    /// With the unit.
    pub x_label: String,
    /// With the unit.
    pub y_label: String,
    /// How numbers lie along both of them.
    pub axes: Axes,
    /// Points that are not finite, and on logarithmic axes those at or below 0, have no place and are
    /// not drawn; a curve without points keeps its line in the legend, with a word that says so.
    pub curves: Vec<Curve>,
}

/// Why there is no chart.
#[derive(Debug, Error)]
pub enum PlotError {
    /// No point of any curve can be drawn.
    #[error(
        "chart `{title}` has no point with both coordinates finite (and above 0 on logarithmic axes)"
    )]
    Empty {
        /// The chart's title.
        title: String,
    },
    /// The drawing library refused.
    #[error("chart `{title}` could not be drawn: {reason}")]
    Drawing {
        /// The chart's title.
        title: String,
        /// In the library's words.
        reason: String,
    },
}

/// Size of a chart, pixels.
const SIZE: (u32, u32) = (960, 600);

/// Ten colours that are told apart by colour-blind readers as well (after Okabe and Ito, 2008, and
/// two greys); more curves than that repeat them.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(150, 140, 20),
    RGBColor(110, 110, 110),
    RGBColor(170, 60, 60),
];

fn drawable(axes: Axes, point: &(f64, f64)) -> bool {
    let fits = |x: f64| x.is_finite() && (x > 0.0 || axes == Axes::Linear);
    fits(point.0) && fits(point.1)
}

/// From the smallest number to the largest; some width in any case.
fn whole(numbers: impl Iterator<Item = f64>) -> Range<f64> {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (least, most) = numbers.fold(ends, |(a, b), x| (a.min(x), b.max(x)));
    let width = (most - least).max(least.abs().max(1.0) * 1e-9);
    least..least + width
}

/// From the power of ten at or below the smallest number to the one at or above the largest, at
/// least one decade.
fn decades(numbers: impl Iterator<Item = f64>) -> Range<f64> {
    let (least, most) = numbers.fold((f64::MAX, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    let power = |exponent: i32| format!("1e{exponent}").parse::<f64>().unwrap_or(f64::MAX);
    // The exponent is read off Rust's own exact scientific notation.
    let exponent = |x: f64| {
        let text = format!("{x:e}");
        let after = text.split_once('e').map_or("0", |(_, digits)| digits);
        after.parse::<i32>().unwrap_or(0)
    };
    let low = exponent(least);
    let mut high = exponent(most);
    if power(high) < most || high == low {
        high += 1;
    }
    power(low)..power(high)
}

/// The chart as the text of an SVG file.
///
/// # Errors
/// [`PlotError`].
pub fn to_svg(chart: &Chart) -> Result<String, PlotError> {
    let points = || {
        chart
            .curves
            .iter()
            .flat_map(|c| c.points.iter())
            .filter(|p| drawable(chart.axes, p))
    };
    if points().next().is_none() {
        return Err(PlotError::Empty {
            title: chart.title.clone(),
        });
    }
    let mut text = String::new();
    let (xs, ys) = (points().map(|p| p.0), points().map(|p| p.1));
    let drawn = match chart.axes {
        Axes::Logarithmic => draw(
            chart,
            decades(xs).log_scale(),
            decades(ys).log_scale(),
            &|v| format!("{v:.0e}"),
            &mut text,
        ),
        Axes::Linear => draw(chart, whole(xs), whole(ys), &|v| format!("{v}"), &mut text),
    };
    drawn.map_err(|error| PlotError::Drawing {
        title: chart.title.clone(),
        reason: error.to_string(),
    })?;
    Ok(text)
}

fn draw<X, Y>(
    chart: &Chart,
    x: X,
    y: Y,
    label: &dyn Fn(&f64) -> String,
    text: &mut String,
) -> Result<(), Box<dyn std::error::Error>>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    // The legend has a column of its own: it never hides a curve.
    let (plot, legend) = root.split_horizontally(680);
    let mut area = ChartBuilder::on(&plot)
        .caption(&chart.title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(48)
        .y_label_area_size(90)
        .build_cartesian_2d(x, y)?;
    area.configure_mesh()
        .x_desc(&chart.x_label)
        .y_desc(&chart.y_label)
        .x_label_formatter(label)
        .y_label_formatter(label)
        .light_line_style(RGBColor(240, 240, 240))
        .draw()?;
    for (i, curve) in chart.curves.iter().enumerate() {
        let colour = COLOURS[curve.colour % COLOURS.len()];
        // Rings of different sizes: where curves lie on each other, each still shows.
        let ring = 3 + 2 * (i as i32 % 4);
        let fits = |point: &(f64, f64)| drawable(chart.axes, point);
        let points: Vec<(f64, f64)> = curve.points.iter().copied().filter(fits).collect();
        area.draw_series(LineSeries::new(
            points.iter().copied(),
            colour.stroke_width(2),
        ))?;
        if chart.axes == Axes::Logarithmic {
            area.draw_series(
                points
                    .iter()
                    .map(|p| Circle::new(*p, ring, colour.stroke_width(2))),
            )?;
        }
        let line = 60 + 22 * i as i32;
        legend.draw(&PathElement::new(
            [(4, line), (28, line)],
            colour.stroke_width(3),
        ))?;
        let name = match points.len() {
            0 => format!("{} (error 0: not drawn)", curve.name),
            _ => curve.name.clone(),
        };
        legend.draw(&Text::new(name, (34, line - 7), ("sans-serif", 14)))?;
    }
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>) -> Chart {
        Chart {
            title: "time against error".into(),
            x_label: "error (m)".into(),
            y_label: "time (ns)".into(),
            axes: Axes::Logarithmic,
            curves: vec![Curve {
                name: "ours & <theirs>".into(),
                colour: 0,
                points,
            }],
        }
    }

    #[test]
    fn a_chart_is_svg_and_the_same_each_time() {
        let chart = chart(vec![
            (1e-6, 10.0),
            (1e-3, 200.0),
            (f64::INFINITY, 1.0),
            (0.0, 5.0),
        ]);
        let svg = to_svg(&chart).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(svg.contains("error (m)") && svg.contains("ours &amp; &lt;theirs&gt;"));
        assert_eq!(
            svg.matches("<circle").count(),
            2,
            "only what has a place on the axes is drawn"
        );
        assert_eq!(svg, to_svg(&chart).unwrap());
    }

    #[test]
    fn a_chart_without_points_is_refused() {
        let refusal = to_svg(&chart(vec![(0.0, 1.0), (f64::NAN, 1.0)])).unwrap_err();
        assert!(matches!(refusal, PlotError::Empty { .. }));
    }

    #[test]
    fn a_linear_chart_has_lines_alone_and_takes_zero() {
        let mut chart = chart(vec![(0.0, -1.0), (1.0, 2.0), (f64::NAN, 1.0)]);
        chart.axes = Axes::Linear;
        let svg = to_svg(&chart).unwrap();
        assert!(!svg.contains("<circle") && svg.contains("<polyline"));
        assert_eq!(whole([3.0, -1.0].into_iter()), -1.0..3.0);
        assert!(!whole([5.0].into_iter()).is_empty());
    }

    #[test]
    fn axes_end_at_powers_of_ten() {
        assert_eq!(decades([2e-7, 3e-4].into_iter()), 1e-7..1e-3);
        assert_eq!(decades([1.0, 1000.0].into_iter()), 1.0..1000.0);
        assert_eq!(decades([5.0].into_iter()), 1.0..10.0);
        assert_eq!(decades([10.0].into_iter()), 10.0..100.0);
    }
}
