#define_import_path dolomite::geometry::user_amplify

// What stands where a user's amplify function goes: the primitive itself.

#import dolomite::geometry::amplify_types::StoredVertex

// Vertex `number` of what stands for the primitive (a, b, c); of a segment c is b.
fn amplify(a: StoredVertex, b: StoredVertex, c: StoredVertex, number: u32) -> StoredVertex {
    if number == 0u {
        return a;
    }
    if number == 1u {
        return b;
    }
    return c;
}
