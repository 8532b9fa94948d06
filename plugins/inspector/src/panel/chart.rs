//! Charts of the running scene, as they grow: error over time, or time over the setting.

use bevy::ecs::prelude::*;
use bevy_egui::egui;

use super::plot::short;
use crate::chart::{Chart, Charts};

/// Radius of a point.
const DOT: f32 = 3.0;

pub(super) fn show(ui: &mut egui::Ui, world: &mut World) {
    let charts = world.get_resource_or_init::<Charts>().list().to_owned();
    let mut stop = false;
    egui::CollapsingHeader::new(format!("Charts ({})", charts.len()))
        .id_salt("charts")
        .default_open(true)
        .show(ui, |ui| {
            if charts.is_empty() {
                ui.weak("in the console: chart SETTING FROM TO --picture");
            }
            for chart in charts.iter().rev() {
                ui.horizontal_wrapped(|ui| {
                    ui.label(&chart.setting);
                    if !chart.done {
                        ui.weak(format!("{} of {}", chart.points.len(), chart.wanted));
                        stop |= ui.small_button("stop").clicked();
                    }
                });
                draw(ui, chart);
            }
        });
    if stop {
        world.resource_mut::<Charts>().stop();
    }
}

/// What lies across and upwards, and what each is.
fn axes(chart: &Chart) -> (Vec<[f64; 2]>, [&'static str; 2]) {
    let with_error = chart.points.iter().any(|point| point.error.is_some());
    let points = chart.points.iter().filter_map(|point| {
        Some(if with_error {
            [point.time, point.error?]
        } else {
            [point.value, point.time]
        })
    });
    let names = if with_error {
        ["ms", "error"]
    } else {
        ["setting", "ms"]
    };
    (points.collect(), names)
}

/// The range of an axis, and whether powers of ten have equal room: where all values are above 0 and the largest is ten
/// times the smallest.
fn range(values: impl Iterator<Item = f64> + Clone) -> (f64, f64, bool) {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let logarithmic = low > 0.0 && high >= 10.0 * low;
    if high > low {
        (low, high, logarithmic)
    } else {
        (low - 0.5, low + 0.5, false)
    }
}

/// Where a value lies in a range, 0 to 1.
#[expect(clippy::disallowed_methods, reason = "it is only drawn")]
fn share(value: f64, (low, high, logarithmic): (f64, f64, bool)) -> f32 {
    let share = if logarithmic {
        (value / low).ln() / (high / low).ln()
    } else {
        (value - low) / (high - low)
    };
    share as f32
}

fn draw(ui: &mut egui::Ui, chart: &Chart) {
    let (points, [across, up]) = axes(chart);
    let points: Vec<_> = points
        .into_iter()
        .filter(|point| point.iter().all(|value| value.is_finite()))
        .collect();
    let size = egui::vec2(ui.available_width().clamp(120.0, 600.0), 120.0);
    let (response, painter) = ui.allocate_painter(size, egui::Sense::hover());
    let field = response.rect;
    painter.rect_filled(field, 2.0, ui.visuals().extreme_bg_color);
    if points.is_empty() {
        return;
    }
    let x = range(points.iter().map(|point| point[0]));
    let y = range(points.iter().map(|point| point[1]));
    // Room for numbers below and above.
    let inner = field.shrink2(egui::vec2(10.0, 20.0));
    let at = |point: &[f64; 2]| {
        egui::pos2(
            egui::lerp(inner.x_range(), share(point[0], x)),
            egui::lerp(inner.y_range(), 1.0 - share(point[1], y)),
        )
    };
    let places: Vec<_> = points.iter().map(at).collect();
    let colour = ui.visuals().hyperlink_color;
    painter.line(places.clone(), egui::Stroke::new(1.0, colour));
    for place in places {
        painter.circle_filled(place, DOT, colour);
    }
    let font = egui::FontId::monospace(10.0);
    let text = |place, align, text: String| {
        painter.text(place, align, text, font.clone(), ui.visuals().text_color());
    };
    let log = |logarithmic: bool| if logarithmic { ", log" } else { "" };
    text(
        field.left_bottom() + egui::vec2(4.0, -2.0),
        egui::Align2::LEFT_BOTTOM,
        short(x.0),
    );
    text(
        field.right_bottom() + egui::vec2(-4.0, -2.0),
        egui::Align2::RIGHT_BOTTOM,
        format!("{} {across}{}", short(x.1), log(x.2)),
    );
    text(
        field.left_top() + egui::vec2(4.0, 2.0),
        egui::Align2::LEFT_TOP,
        format!("{up} {} to {}{}", short(y.0), short(y.1), log(y.2)),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::Point;

    fn chart(error: Option<f64>) -> Chart {
        let points = [(1.0, 8.0), (4.0, 2.0)].map(|(value, time)| Point {
            value,
            time,
            spread: [time, time],
            error: error.map(|error| error * value),
        });
        Chart {
            points: points.into(),
            ..Chart::default()
        }
    }

    #[test]
    fn error_lies_over_time_and_time_over_the_setting_where_there_is_none() {
        let (points, names) = axes(&chart(Some(0.1)));
        assert_eq!(
            (points, names),
            (vec![[8.0, 0.1], [2.0, 0.4]], ["ms", "error"])
        );
        let (points, names) = axes(&chart(None));
        assert_eq!(
            (points, names),
            (vec![[1.0, 8.0], [4.0, 2.0]], ["setting", "ms"])
        );
    }

    #[test]
    fn ranges_are_never_empty_and_logarithmic_where_that_shows_more() {
        assert_eq!(range([3.0].into_iter()), (2.5, 3.5, false));
        assert_eq!(range([0.0, 100.0].into_iter()), (0.0, 100.0, false));
        let wide = range([1.0, 100.0].into_iter());
        assert_eq!(wide, (1.0, 100.0, true));
        assert!((share(10.0, wide) - 0.5).abs() < 1e-6);
        assert!((share(50.0, (0.0, 100.0, false)) - 0.5).abs() < 1e-6);
    }
}
