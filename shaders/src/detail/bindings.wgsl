#define_import_path dolomite::detail::bindings

// What the passes of the terrain LOD are told, and the counts of a view; blocks/bindings.wgsl has the rest of the group.

#import dolomite::detail::types::DetailParams

@group(0) @binding(0) var<uniform> detail: DetailParams;
// Words in which the passes count, see blocks/bindings.wgsl; behind them the map of the horizon.
@group(0) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;

// The map of the horizon, by layers and columns, and whether it is blind: see horizon.wgsl.
const HORIZON: u32 = 128u;
