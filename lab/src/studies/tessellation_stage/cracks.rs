//! Cracks: do both patches beside an edge use vertices of the same bits there?

use super::cpu::{Sharing, compare};
use super::pairs::{Pair, TESSELLATORS, pair, tessellator};
use super::report::{Section, figure};
use super::seam::Seam;
use super::tally::{Kind, Tallies};
use crate::study::Options;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::random::Random;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Pairs that are held at once.
const BATCH: usize = 12_288;

/// Of so many shared pairs one is also tried apart.
const APART: usize = 16;

/// Pairs on the adapter: one for so many on the CPU.
const ADAPTER: usize = 16;

/// Time between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(3);

/// The pairs of the run, on the CPU and on the adapter if there is one.
pub fn run(options: &Options, gpu: Option<&Gpu>) -> Section {
    let mut section = Section::open(
        "cracks",
        "0 of 10^6 pairs of patches have other bits along the edge that they share",
    );
    let cpu = on_cpu_reference(options);
    let adapter = gpu.map(|gpu| {
        let pairs = (options.samples / ADAPTER).max(4 * TESSELLATORS);
        let tallies = super::adapter::run(gpu, options.seed, pairs);
        (gpu, tallies)
    });
    section.rows = cpu.rows("CPU");
    let mut curves = named(&cpu, "CPU");
    let mut details = json!({ "cpu": device(&cpu) });
    let mut open = cpu.0[0].open_pairs + cpu.0[0].other_places.unwrap_or(0);
    match adapter {
        Some((gpu, Ok(found))) => {
            open += found.0[0].open_pairs;
            section.rows.extend(found.rows(&gpu.name));
            curves.extend(named(&found, "adapter"));
            details["adapter"] = device(&found);
        }
        Some((_, Err(reason))) => {
            section
                .notes
                .push(format!("The adapter is left out: {reason}"));
        }
        None => section
            .notes
            .push("The adapter is left out: there is none.".into()),
    }
    section.reached = json!(open);
    section.holds = Some(open == 0);
    section.details = details;
    section.figures.push(figure(
        "tessellation_cracks",
        "Pairs of patches whose triangles do not meet bit by bit along their common side, over the \
         number of pairs that were tried: with a shared edge none, hence no line. Not shared: the \
         same pairs with control points of their own, as a check that the comparison sees cracks; \
         with equal levels what is left is the rounding of positions from two sides."
            .into(),
        [
            "Cracks: pairs with other bits along their edge",
            "pairs of patches",
            "pairs with other bits",
        ],
        curves,
    ));
    section.notes.extend(standing_notes());
    section
}

fn standing_notes() -> [String; 2] {
    [
        "Triangles and quads, every spacing, winding and mode in turn; levels as in the study \
         `tessellation`, none of which discards; any side of each patch, in either direction; the \
         edge lies up to 100 of its lengths from the origin. Triangles of both patches are compared \
         as sets of edges between positions, by the bits of the positions."
            .into(),
        "On the CPU the CPU reference emits both patches with the topology of their mesh as the passes do. \
         pairs_with_other_places: each patch's own coordinates along the side name other places, as \
         integers of 2^-24. On the adapter all passes run and vertices and indices are read back."
            .into(),
    ]
}

fn named(tallies: &Tallies, device: &str) -> Vec<(String, Vec<(f64, f64)>)> {
    Kind::ALL
        .into_iter()
        .zip(&tallies.0)
        .map(|(kind, tally)| (format!("{device}: {}", kind.name()), tally.curve.clone()))
        .collect()
}

fn device(tallies: &Tallies) -> Value {
    let [shared, apart, equal] = &tallies.0;
    json!({
        "shared": shared.json(),
        "not_shared_own_levels": apart.json(),
        "not_shared_equal_levels": equal.json(),
    })
}

fn on_cpu_reference(options: &Options) -> Tallies {
    let mut tallies = Tallies::default();
    let mut random = Random::new(options.seed);
    let (start, mut told) = (Instant::now(), Instant::now());
    let mut done = 0;
    while done < options.samples {
        let count = BATCH.min(options.samples - done);
        let batch: Vec<(usize, Pair)> = (done..done + count)
            .map(|place| (place, pair(&mut random, tessellator(place).domain)))
            .collect();
        let found = on_all_cores(&batch, |(place, pair)| {
            let tessellator = tessellator(*place);
            let shared = compare(tessellator, pair, Sharing::Shared);
            // Rounds of the tessellators are taken whole, so that none is left out.
            let also = (place / TESSELLATORS).is_multiple_of(APART);
            let apart = also.then(|| {
                let equal = pair.clone().with_equal_levels();
                [pair, &equal].map(|pair| compare(tessellator, pair, Sharing::Apart))
            });
            (shared, apart)
        });
        for ((place, _), (shared, apart)) in batch.iter().zip(found) {
            let found = [shared]
                .into_iter()
                .chain(apart.into_iter().flatten())
                .zip(Kind::ALL);
            for (found, kind) in found {
                let tally = tallies.of(kind);
                match found {
                    Some(found) => {
                        tally.add(*place, found.seam);
                        let other = tally.other_places.get_or_insert(0);
                        *other += usize::from(!found.places);
                    }
                    // A pair that is not emitted has not been shown to be closed.
                    None => tally.add(
                        *place,
                        Seam {
                            vertices: 0,
                            open: 1,
                        },
                    ),
                }
            }
        }
        done += count;
        if told.elapsed() > PROGRESS || done == options.samples {
            told = Instant::now();
            eprintln!(
                "tessellation-stage: cracks, {done} of {} pairs, {} open, {:.0} s",
                options.samples,
                tallies.0[0].open_pairs,
                start.elapsed().as_secs_f64()
            );
        }
    }
    tallies.finish();
    tallies
}
