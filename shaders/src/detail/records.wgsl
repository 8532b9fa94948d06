#define_import_path dolomite::detail::records

// What the height of a vertex depends on, by its number: share of its way to the ground, surface where it
// is done with its geomorph; and during its geomorph the two vertices in whose middle it lies. Behind all of them the
// numbers of those on their way.

const RECORD: u32 = 4u;

@group(1) @binding(2) var<storage, read_write> records: array<u32>;
