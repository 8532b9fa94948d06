//! A history as a line.

use bevy_egui::egui;

/// Draws values over time, `[seconds, value]`, the oldest first, in a field of this size, with 0 in its range. Without two
/// values it is empty.
pub(super) fn line(ui: &mut egui::Ui, values: &[[f64; 2]], size: egui::Vec2) -> egui::Response {
    let (response, painter) = ui.allocate_painter(size, egui::Sense::hover());
    let field = response.rect;
    painter.rect_filled(field, 2.0, ui.visuals().extreme_bg_color);
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return response;
    };
    let (low, high) = ends(values);
    let seconds = last[0] - first[0];
    if seconds <= 0.0 || values.len() < 2 {
        return response;
    }
    let inner = field.shrink(2.0);
    let points = values.iter().map(|[time, value]| {
        let x = ((time - first[0]) / seconds) as f32;
        let y = ((value - low) / (high - low)) as f32;
        egui::pos2(
            egui::lerp(inner.x_range(), x),
            egui::lerp(inner.y_range(), 1.0 - y),
        )
    });
    let colour = ui.visuals().hyperlink_color;
    painter.line(points.collect(), egui::Stroke::new(1.0, colour));
    let text = format!("{} to {} in {seconds:.1} s", short(low), short(high));
    response.on_hover_text(text)
}

/// The range that is drawn; never empty.
fn ends(values: &[[f64; 2]]) -> (f64, f64) {
    let low = values.iter().fold(0.0, |low: f64, [_, v]| low.min(*v));
    let high = values.iter().fold(0.0, |high: f64, [_, v]| high.max(*v));
    if high > low {
        (low, high)
    } else {
        (low, low + 1.0)
    }
}

/// A number for a small place: four digits, and k, M or G.
pub(super) fn short(value: f64) -> String {
    let (scaled, letter) = match value.abs() {
        size if size >= 1e9 => (value / 1e9, "G"),
        size if size >= 1e6 => (value / 1e6, "M"),
        size if size >= 1e4 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    let digits = match scaled.abs() {
        size if size >= 100.0 || scaled.fract() == 0.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 => 2,
        _ => 3,
    };
    format!("{scaled:.digits$}{letter}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_a_small_place() {
        for (value, text) in [
            (0.0, "0"),
            (0.01234, "0.012"),
            (7.0, "7"),
            (3.456, "3.46"),
            (34.56, "34.6"),
            (345.6, "346"),
            (9999.0, "9999"),
            (12_345.0, "12.3k"),
            (-2_500_000.0, "-2.50M"),
            (7e9, "7G"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(ends(&[[0.0, 3.0], [1.0, 5.0]]), (0.0, 5.0));
        assert_eq!(ends(&[[0.0, -3.0], [1.0, -5.0]]), (-5.0, 0.0));
        assert_eq!(ends(&[[0.0, 0.0], [1.0, 0.0]]), (0.0, 1.0));
    }
}
