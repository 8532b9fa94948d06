#define_import_path dolomite::blocks::lowest

// Below what the drawn surface is nowhere in a cell of a block.

#import dolomite::blocks::bindings::records
#import dolomite::blocks::record::{CELL_LOWS, CORNERS, CORNER_COUNT, CELLS, ERRORS, HEIGHTS, ringed_number}
#import dolomite::detail::bindings::detail

// Where nothing is known.
const NONE: f32 = -3e38;

fn drawn_at(record: u32, at: vec2<u32>) -> f32 {
    return max(bitcast<f32>(records[record + HEIGHTS + at.y * CORNERS + at.x]), detail.sea);
}

// Of a cell whose parent's cell is cut at its centre, above the stage's anchor. Where its own centre is not there its triangles
// end at its corners: at one of the parent's cell, at the centre of that, and at two middles of its sides, which may be on
// their way from the mean of their ends. Else these have arrived, and what is finer is off from the two triangles between
// them by the error of the centre at most, and nowhere below the cell's interval.
fn lowest_of(record: u32, cell: vec2<u32>, has_centre: bool) -> f32 {
    let centre = cell | vec2(1u);
    let corner = cell + (cell & vec2(1u));
    let far = 2u * centre - corner;
    let own = drawn_at(record, corner);
    let above = drawn_at(record, centre);
    let east = drawn_at(record, vec2(centre.x, corner.y));
    let south = drawn_at(record, vec2(corner.x, centre.y));
    let from_east = 0.5 * (own + drawn_at(record, vec2(far.x, corner.y)));
    let from_south = 0.5 * (own + drawn_at(record, vec2(corner.x, far.y)));
    let corners = min(min(own, above), min(min(east, from_east), min(south, from_south)));
    let error = bitcast<f32>(records[record + ERRORS + CORNER_COUNT + cell.y * CELLS + cell.x]);
    let interval = bitcast<f32>(records[record + CELL_LOWS + ringed_number(vec2<i32>(cell))]);
    let lowest = select(corners, min(corners, max(corners - error, interval)), has_centre);
    // Heights that are no numbers are drawn nowhere, and hide nothing.
    let sum = own + above + east + south + from_east + from_south;
    return select(NONE, lowest - detail.anchor_height, abs(sum) < 1e30);
}
