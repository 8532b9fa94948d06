#define_import_path dolomite::stage::rules

// The kind's tessellator, compiled in: what it does not use is not in its pipelines.

#import dolomite::stage::types::{Rules, TRIANGLES, QUADS, ISOLINES, EQUAL, FRACTIONAL_EVEN, FRACTIONAL_ODD, EXACT, D3D}

fn stage_rules() -> Rules {
    var rules = Rules(TRIANGLES, EQUAL, EXACT);
#ifdef STAGE_QUADS
    rules.domain = QUADS;
#endif
#ifdef STAGE_ISOLINES
    rules.domain = ISOLINES;
#endif
#ifdef STAGE_FRACTIONAL_EVEN
    rules.spacing = FRACTIONAL_EVEN;
#endif
#ifdef STAGE_FRACTIONAL_ODD
    rules.spacing = FRACTIONAL_ODD;
#endif
#ifdef STAGE_D3D
    rules.mode = D3D;
#endif
    return rules;
}
