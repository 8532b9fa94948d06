#define_import_path dolomite::vegetation::stem

// How a blade or a stem stands in some wind, among those who press it aside.

#import dolomite::vegetation::blade::{Curve, curve_of, pushed}
#import dolomite::vegetation::draw_view::view
#import dolomite::vegetation::press::pressed_by
#import dolomite::vegetation::shape::{Shape, own}
#import dolomite::vegetation::types::Record
#import dolomite::vegetation::wind::{WindField, wind_on_blade}

fn stem_curve(shape: Shape, record: Record, field: WindField) -> Curve {
    let air = wind_on_blade(field, record.position.xz, own(record.hash, 9u), (record.hash & 1u) == 1u);
    var lean = pushed(shape.lean, air * shape.give);
    for (var k = 0u; k < view.press_count; k++) {
        lean = pressed_by(view.presses[k], lean, record.position, shape.long);
    }
    return curve_of(shape.long, shape.droop, lean);
}
