//! Whole patches from their levels: the captures of another tessellator, and random tuples. The output of ten
//! thousand is too large for a file, so hashes stand in it.

use bytemuck::cast_slice;
use dolomite_tessellation::{Levels, Primitives, Tessellator};

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From, Step, digest};
use crate::studies::tessellation::wgsl::{COLUMNS, CaseRecord, record};

/// Records of 16 bytes in each output buffer: 4 MiB, several rounds of some dozens of patches.
const ELEMENTS: u32 = 1 << 18;

/// Patches of one dispatch.
struct Round {
    records: Vec<CaseRecord>,
    counts: Vec<[u32; 2]>,
    /// First word and words of each patch, and the hash of the words.
    vertices: Vec<([u32; 2], u32)>,
    primitives: Vec<([u32; 2], u32)>,
    used: [u32; 2],
}

impl Round {
    const EMPTY: Self = Self {
        records: Vec::new(),
        counts: Vec::new(),
        vertices: Vec::new(),
        primitives: Vec::new(),
        used: [0; 2],
    };

    /// Adds a patch; false where there is no room.
    fn add(&mut self, tessellator: &Tessellator, levels: &Levels) -> bool {
        let (coordinates, joined) = tessellator.tessellate_fixed(levels);
        let [v, p] = [coordinates.len() as u32, joined.len() as u32];
        let [first_vertex, first_primitive] = self.used;
        if first_vertex + v > ELEMENTS || first_primitive + p > ELEMENTS {
            return false;
        }
        let places = coordinates.iter().flat_map(|[u, v, w]| [*u, *v, *w, 0]);
        self.vertices
            .push(([4 * first_vertex, 4 * v], digest(places)));
        let hash = match &joined {
            Primitives::Triangles(all) => digest(all.iter().flat_map(|[a, b, c]| [*a, *b, *c, 0])),
            Primitives::Segments(all) => digest(all.iter().flat_map(|[a, b]| [*a, *b, *b, 0])),
        };
        self.primitives.push(([4 * first_primitive, 4 * p], hash));
        self.counts.push([v, p]);
        self.records
            .push(record(tessellator, levels, first_vertex, first_primitive));
        self.used = [first_vertex + v, first_primitive + p];
        true
    }
}

/// The tessellation of `patches` by `stage/probe.wgsl`.
///
/// # Errors
/// If the shader is wrong.
pub fn capsule(
    name: &str,
    about: &str,
    patches: &[(Tessellator, Levels)],
) -> Result<Capsule, CapsuleError> {
    let mut rounds = vec![Round::EMPTY];
    for (tessellator, levels) in patches {
        let last = rounds.len() - 1;
        if !rounds[last].add(tessellator, levels) {
            let mut next = Round::EMPTY;
            next.add(tessellator, levels);
            rounds.push(next);
        }
    }
    let mut builder = Builder::new(name, about);
    let module = dolomite_shaders::compose("stage/probe.wgsl", &[])?;
    let module = builder.module("stage/probe.wgsl", &[], &module)?;
    let write = BindingKind::Storage;
    let layout = builder.layout(&[BindingKind::ReadOnlyStorage, write, write, write]);
    let pipeline = builder.pipeline(module, "probe", &[layout]);
    let size = u64::from(ELEMENTS) * 16;
    let coordinates = builder.filled("coordinates", size, 0);
    let primitives = builder.filled("primitives", size, 0);
    for (number, round) in rounds.iter().enumerate() {
        let cases = builder.buffer("cases", cast_slice(&round.records));
        let counts = builder.filled("counts", round.counts.len() as u64 * 8, 0xAB);
        let group = builder.group(layout, &[cases, counts, coordinates, primitives]);
        for buffer in [coordinates, primitives] {
            builder.command(Command::Clear {
                buffer,
                offset: 0,
                size,
            });
        }
        let groups = round.records.len() as u32;
        let steps = vec![Step {
            pipeline,
            groups: vec![group],
            dispatch: Some([groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1]),
            indirect: None,
        }];
        builder.command(Command::Pass { steps });
        let fields = vec![Field {
            name: "vertices and primitives".to_owned(),
            at: 0,
            count: 2,
            ty: FieldType::U32,
        }];
        builder.check(
            &format!("counts of round {number}"),
            (counts, 0, 8),
            fields,
            cast_slice(&round.counts),
            From::CpuReference,
        );
        for (what, buffer, hashes, used) in [
            ("coordinates", coordinates, &round.vertices, round.used[0]),
            ("primitives", primitives, &round.primitives, round.used[1]),
        ] {
            let ranges: Vec<[u32; 2]> = hashes.iter().map(|(range, _)| *range).collect();
            let expected: Vec<u32> = hashes.iter().map(|(_, hash)| *hash).collect();
            hashed(
                &mut builder,
                (&format!("{what} of round {number}"), buffer),
                &ranges,
                &expected,
                From::CpuReference,
            );
            let behind = [4 * used, 4 * (ELEMENTS - used)];
            let zeros = digest((0..behind[1]).map(|_| 0));
            hashed(
                &mut builder,
                (&format!("behind the {what} of round {number}"), buffer),
                &[behind],
                &[zeros],
                From::Untouched,
            );
        }
    }
    Ok(builder.finish())
}

fn hashed(
    builder: &mut Builder,
    (name, buffer): (&str, u32),
    ranges: &[[u32; 2]],
    expected: &[u32],
    from: From,
) {
    let command = Command::Digest {
        name: name.to_owned(),
        buffer,
        ranges: builder.data(cast_slice(ranges)),
        expected: builder.data(cast_slice(expected)),
        from,
    };
    builder.command(command);
}
