// What all error ratios are divided by so that the vertices fit, one thread: 1 where they do as they are.

#import dolomite::detail::types::APPEARS
#import dolomite::detail::bindings::{counts, BINS, COARSENING, HISTOGRAM, STEPS_AN_OCTAVE, WITHOUT_ROOM}
#import dolomite::detail::room::room

@compute @workgroup_size(1)
fn fit() {
    let most = room();
    var above = 0u;
    var coarsening = 1.0;
    for (var k = BINS; k > 0u; k--) {
        above += atomicLoad(&counts[HISTOGRAM + k - 1u]);
        if above > most {
            coarsening = exp2(f32(k) / STEPS_AN_OCTAVE);
            break;
        }
    }
    // Cells whose quarters could not be looked at are not drawn, hence nothing that needs the quarters.
    let without_room = bitcast<f32>(atomicLoad(&counts[WITHOUT_ROOM]));
    coarsening = max(coarsening, without_room / APPEARS * 1.000001);
    atomicStore(&counts[COARSENING], bitcast<u32>(coarsening));
}
