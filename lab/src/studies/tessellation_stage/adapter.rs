//! Pairs of patches through all passes of the stage on the adapter.

use super::cpu::Sharing;
use super::functions::TAGGED;
use super::pairs::{Pair, TESSELLATORS, layout, pair, tessellator};
use super::seam::{Bits, Seams};
use super::tally::{Kind, Tallies};
use dolomite_tessellation::shape::Shape;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{Domain, Drawing, PatchLayout, PatchMesh, Tessellator};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::random::Random;
use dolomite_testkit::stage::{Emitted, StageError, StagePasses, StageRun};
use std::sync::Arc;
use std::time::Instant;
use thiserror::Error;

/// Pairs of a run: the numbers of their patches fit 15 bits.
const TOGETHER: usize = 512;

/// Of so many pairs one is also tried apart.
const APART: usize = 8;

/// Why the adapter has no answer.
#[derive(Debug, Error)]
pub enum AdapterError {
    /// The stage did not run.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// Patches that no mesh can have.
    #[error("pairs of patches were refused: {0}")]
    Mesh(#[from] dolomite_tessellation::PatchMeshError),
    /// The pools of the run were too small, so that levels were lowered.
    #[error("the pools of a run did not hold its patches")]
    Lowered,
}

/// Control points of a pair's patches, two of levels behind those that span them.
const fn with_levels(domain: Domain) -> PatchLayout {
    let mut layout = layout(domain);
    layout.points += 2;
    layout
}

/// Puts the pairs through the stage, as many of each tessellator.
///
/// # Errors
/// [`AdapterError`].
pub fn run(gpu: &Gpu, seed: u32, pairs: usize) -> Result<Tallies, AdapterError> {
    let mut tallies = Tallies::default();
    let mut random = Random::new(seed ^ 0x5eed);
    let (start, each) = (Instant::now(), pairs.div_ceil(TESSELLATORS));
    for place in 0..TESSELLATORS {
        let tessellator = tessellator(place);
        let passes = StagePasses::with_functions(gpu, tessellator, Drawing::Stored, TAGGED)?;
        let mut done = 0;
        while done < each {
            let count = TOGETHER.min(each - done);
            let some: Vec<Pair> = (0..count)
                .map(|_| pair(&mut random, tessellator.domain))
                .collect();
            let few = &some[..count.div_ceil(APART)];
            let equal: Vec<Pair> = few.iter().map(|p| p.clone().with_equal_levels()).collect();
            for (kind, sharing, some) in [
                (Kind::Shared, Sharing::Shared, some.as_slice()),
                (Kind::Apart, Sharing::Apart, few),
                (Kind::ApartEqual, Sharing::Apart, &equal),
            ] {
                let emitted = emit(gpu, &passes, tessellator, some, sharing)?;
                for seam in seams(&emitted, some, sharing).found(some.len()) {
                    tallies.of(kind).add(place, seam);
                }
            }
            done += count;
        }
        eprintln!(
            "tessellation-stage: cracks on the adapter, {} of {} pairs, {} open, {:.0} s",
            (place + 1) * each,
            TESSELLATORS * each,
            tallies.of(Kind::Shared).open_pairs,
            start.elapsed().as_secs_f64()
        );
    }
    tallies.finish();
    Ok(tallies)
}

fn emit(
    gpu: &Gpu,
    passes: &StagePasses,
    tessellator: Tessellator,
    pairs: &[Pair],
    sharing: Sharing,
) -> Result<Emitted, AdapterError> {
    let mesh = mesh(tessellator.domain, pairs, sharing)?;
    // An edge's level may rise to its neighbour's: twice what each patch asks for is enough.
    let sizes = pairs.iter().flat_map(|pair| &pair.levels).map(|levels| {
        let Tessellator {
            domain,
            spacing,
            mode,
            ..
        } = tessellator;
        let shape = Shape::new(levels, domain, spacing, mode);
        shape.map_or([0; 2], |shape| [shape.vertices(), shape.primitives()])
    });
    let [vertices, primitives] =
        sizes.fold([0; 2], |sum, size| [sum[0] + size[0], sum[1] + size[1]]);
    let pools = [2 * vertices + 1024, 2 * primitives + 1024];
    let layout = mesh.layout();
    let entities = [(Arc::new(mesh), Instance::IDENTITY)];
    let run = StageRun::new(gpu, passes, layout, &entities, pools)?;
    run.tessellate(1)?;
    let emitted = run.read()?;
    if emitted.head.lowered > 0 {
        return Err(AdapterError::Lowered);
    }
    Ok(emitted)
}

/// All pairs in one mesh; those of a shared edge have its two points in common.
fn mesh(domain: Domain, pairs: &[Pair], sharing: Sharing) -> Result<PatchMesh, AdapterError> {
    let layout = with_levels(domain);
    let spanning = layout.points - 2;
    let (mut points, mut indices) = (Vec::new(), Vec::new());
    for pair in pairs {
        for which in 0..2 {
            let first = points.len() as u32;
            points.extend_from_slice(&pair.points[which]);
            points.push(pair.levels[which].outer);
            let [u, v] = pair.levels[which].inner;
            points.push([u, v, 0.0, 0.0]);
            let mut own: Vec<u32> = (first..first + layout.points).collect();
            if which == 1 && sharing == Sharing::Shared {
                let [a, b] = [0, 1].map(|which| layout.sides[pair.sides[which]]);
                let ends = if pair.along {
                    [a[0], a[1]]
                } else {
                    [a[1], a[0]]
                };
                for (own_place, other) in b.iter().zip(ends) {
                    own[*own_place as usize] = first - spanning - 2 + other;
                }
            }
            indices.extend(own);
        }
    }
    Ok(PatchMesh::new(layout, points, indices)?)
}

/// The edges along the common sides, from vertices that say which patch was evaluated and where.
fn seams(emitted: &Emitted, pairs: &[Pair], sharing: Sharing) -> Seams {
    // (pair, position, whether on the common side) of each vertex.
    let vertices: Vec<(u32, Bits, bool)> = emitted
        .vertices
        .iter()
        .map(|[x, y, z, _, uv]| {
            let (patch, sides) = (uv & 0x7fff, (uv >> 16) & 0x7fff);
            let pair = patch / 2;
            let own = pairs
                .get(pair as usize)
                .map_or(0, |pair| pair.sides[patch as usize % 2]);
            // Both zeros are one place.
            let bits = [x, y, z].map(|word| (f32::from_bits(*word) + 0.0).to_bits());
            // All of a shared side is the first patch's; what the second evaluates there is a vertex of
            // its next side, which may lie where the common one ends to the unit of coordinates.
            let owned = sharing == Sharing::Apart || patch.is_multiple_of(2);
            (pair, bits, owned && sides >> own & 1 == 1)
        })
        .collect();
    let mut seams = Seams::default();
    for triangle in emitted.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|k| vertices[triangle[k] as usize]);
        seams.add(corners[0].0, corners.map(|(_, bits, on)| (bits, on)));
    }
    seams
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_shared_sides_are_closed_and_others_are_not() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let mut tallies = run(&gpu, 5, 40 * TESSELLATORS).expect("pairs");
        let shared = tallies.of(Kind::Shared).clone();
        assert_eq!((shared.pairs, shared.open_pairs), (40 * TESSELLATORS, 0));
        // Two ends each, and what lies between.
        assert!(shared.vertices > 10 * shared.pairs, "{}", shared.vertices);
        let apart = tallies.of(Kind::Apart).clone();
        assert!(
            apart.pairs == 5 * TESSELLATORS && apart.open_pairs > apart.pairs / 2,
            "{apart:?}"
        );
        let equal = tallies.of(Kind::ApartEqual);
        assert!(equal.open_pairs > equal.pairs / 8, "{equal:?}");
    }

    #[test]
    fn gpu_a_missing_triangle_is_seen() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let mut random = Random::new(8);
        let tessellator = tessellator(1);
        let pairs: Vec<Pair> = (0..6)
            .map(|_| pair(&mut random, tessellator.domain))
            .collect();
        let passes = StagePasses::with_functions(&gpu, tessellator, Drawing::Stored, TAGGED);
        let passes = passes.expect("passes");
        let mut emitted = emit(&gpu, &passes, tessellator, &pairs, Sharing::Shared).expect("a run");
        let open = |emitted: &Emitted| -> usize {
            let found = seams(emitted, &pairs, Sharing::Shared).found(pairs.len());
            found.iter().map(|seam| seam.open).sum()
        };
        assert_eq!(open(&emitted), 0);
        let all = emitted.indices.clone();
        let seen = (0..all.len() / 3).any(|k| {
            emitted.indices = [&all[..3 * k], &all[3 * k + 3..]].concat();
            open(&emitted) > 0
        });
        assert!(seen);
    }
}
