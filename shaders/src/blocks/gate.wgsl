#define_import_path dolomite::blocks::gate

// Whether a block can be made: of a map that is read by tiles, those have to be there on which its samples stand. CPU reference:
// plugins/ground/src/blocks/gate.rs.

#import dolomite::blocks::bindings::numbers

fn can_be_made(centre: vec2<u32>, half: u32) -> bool {
    if numbers.levels == 0u {
        return true;
    }
    let step = half / 32u;
    let finer = max(i32(firstLeadingBit(max(step, 1u))) - i32(numbers.shift), 0);
    let there = numbers.readable[min(u32(finer), numbers.levels - 1u)];
    // Three cells around it are looked at too.
    let reach = vec2(i32(half + 12u * step));
    return all(vec2<i32>(centre) - reach >= there.xy) && all(vec2<i32>(centre) + reach <= there.zw);
}
