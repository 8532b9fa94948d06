//! The file of a capsule.
//!
//! A capsule is little-endian throughout and consists of three parts:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `dolocap1`, ASCII |
//! | 4 | length of the header in bytes, u32, a multiple of 16 |
//! | 4 | 0 |
//! | length | the header: [`Header`] as JSON in UTF-8, filled up with spaces |
//! | rest | the data; each [`Span`] of the header is a part of it, and starts at a multiple of 16 |
//!
//! It is not compressed: WGSL stays readable in the file, git compresses what it stores, and a server that sends
//! one compresses it on the way.
//!
//! A player makes the modules, layouts, pipelines, buffers and groups in the order of their lists (each is named by
//! its place in its list), then carries out `commands` one after the other. A `check` or a `digest` reads a buffer as it
//! is at that place of the list and compares it.

use serde::{Deserialize, Serialize};

use super::CapsuleError;
pub use super::field::{Field, FieldType};

/// How a file begins.
pub const MAGIC: &[u8; 8] = b"dolocap1";

/// A part of the data: bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Span {
    /// Where it begins.
    pub at: u64,
    /// How long it is.
    pub length: u64,
}

/// What a file says before its data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Its name.
    pub name: String,
    /// One sentence on what is run.
    pub about: String,
    /// What the run needs beyond WebGPU's defaults: always empty, for the reader to insist on.
    pub features: Vec<String>,
    /// WGSL.
    pub modules: Vec<Module>,
    /// Bind group layouts: what stands at binding 0, 1, and so on.
    pub layouts: Vec<Vec<BindingKind>>,
    /// Compute pipelines.
    pub pipelines: Vec<Pipeline>,
    /// Buffers.
    pub buffers: Vec<BufferOf>,
    /// Textures of depths.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub textures: Vec<TextureOf>,
    /// Bind groups.
    pub groups: Vec<Group>,
    /// What is done, in order.
    pub commands: Vec<Command>,
}

/// A shader module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Module {
    /// File that it was composed from, below `shaders/src`.
    pub name: String,
    /// Shader definitions that were set.
    pub defs: Vec<String>,
    /// Its text, UTF-8.
    pub wgsl: Span,
}

/// What a binding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BindingKind {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    ReadOnlyStorage,
    /// `var<storage, read_write>`.
    Storage,
    /// `texture_depth_2d`; the group's number is that of a texture.
    DepthTexture,
}

/// A compute pipeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pipeline {
    /// Which module.
    pub module: u32,
    /// Its entry point.
    pub entry: String,
    /// The layouts of its groups, from group 0 on.
    pub layouts: Vec<u32>,
}

/// A buffer. It is given every use that a run may need: `UNIFORM` or `STORAGE` as its bindings say, `INDIRECT`
/// where a dispatch reads it, `COPY_SRC` and `COPY_DST`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BufferOf {
    /// For reports.
    pub name: String,
    /// Bytes, a multiple of 4.
    pub size: u64,
    /// What each of its bytes is before the first command, where no data say otherwise.
    pub fill: u8,
    /// What it holds before the first command, from its start on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<Span>,
}

/// A texture of depths in 16 bits, `depth16unorm`: the one format of depths that WebGPU copies into.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TextureOf {
    /// For reports.
    pub name: String,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Two bytes a pixel, row by row without room between them: the depth times 65535.
    pub data: Span,
}

/// A bind group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// Its layout.
    pub layout: u32,
    /// The whole buffers at binding 0, 1, and so on; textures where the layout has them.
    pub buffers: Vec<u32>,
}

/// A step of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
pub enum Command {
    /// Writes into a buffer.
    Write {
        /// Which.
        buffer: u32,
        /// Byte at which it begins.
        offset: u64,
        /// What.
        data: Span,
    },
    /// Sets bytes to 0.
    Clear {
        /// Of which buffer.
        buffer: u32,
        /// First byte.
        offset: u64,
        /// How many.
        size: u64,
    },
    /// A compute pass.
    Pass {
        /// Its dispatches.
        steps: Vec<Step>,
    },
    /// Compares records of a buffer, field by field.
    Check {
        /// For reports.
        name: String,
        /// Which buffer.
        buffer: u32,
        /// Byte of the first record.
        offset: u64,
        /// Bytes from one record to the next.
        stride: u64,
        /// Records.
        count: u64,
        /// What of each is compared.
        fields: Vec<Field>,
        /// What they hold: `count` · `stride` bytes.
        expected: Span,
        /// Who says so.
        from: From,
        /// Whether records may stand in any order, as threads come to them: then both lists are put in the order of
        /// the fields whose bits have to be the same.
        #[serde(default, skip_serializing_if = "is_false")]
        unordered: bool,
    },
    /// Compares triangles by their corners, wherever vertices and indices stand.
    Triangles {
        /// For reports.
        name: String,
        /// Which buffer holds the vertices: from the first word of each on x, y and z, f32.
        vertices: u32,
        /// Bytes from one vertex to the next.
        stride: u64,
        /// Which buffer holds the indices, three a triangle, from its start on.
        indices: u32,
        /// Triangles.
        count: u64,
        /// Most units in the last place that y may be off, of the greater of |expected| and `scale`. The bits of x and z
        /// are the same.
        ulp: f64,
        /// See `ulp`.
        scale: f32,
        /// Nine f32 a triangle: x, y and z of its corners, counter-clockwise from any of them on.
        expected: Span,
        /// Who says so.
        from: From,
    },
    /// Compares lists whose places stand in records.
    Lists {
        /// For reports.
        name: String,
        /// Which buffer holds records and lists.
        buffer: u32,
        /// Byte of the first record.
        offset: u64,
        /// Bytes from one record to the next.
        stride: u64,
        /// Records.
        count: u64,
        /// Byte within a record: the word of the buffer at which its list begins.
        first: u64,
        /// Byte within a record: how many words its list has.
        length: u64,
        /// Of each record in turn: how many words, then these.
        expected: Span,
        /// Who says so.
        from: From,
    },
    /// Compares ranges of a buffer's words by their hashes: of runs whose output is too large for a file.
    Digest {
        /// For reports.
        name: String,
        /// Which buffer.
        buffer: u32,
        /// Two u32 a range: first word, words.
        ranges: Span,
        /// One u32 a range: [`digest`] of its words.
        expected: Span,
        /// Who says so.
        from: From,
    },
}

/// Who says what is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum From {
    /// The CPU reference of the shader, in Rust.
    CpuReference,
    /// The definition in f64, rounded to f32 once.
    F64,
    /// Nobody computed it: it is what was there before, and must not be written.
    Untouched,
}

/// A dispatch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Which pipeline.
    pub pipeline: u32,
    /// Its groups, from group 0 on.
    pub groups: Vec<u32>,
    /// Workgroups, where they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dispatch: Option<[u32; 3]>,
    /// Where they stand in a buffer, else.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub indirect: Option<Indirect>,
}

/// Arguments of a dispatch in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Indirect {
    /// Which buffer.
    pub buffer: u32,
    /// Byte.
    pub offset: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives it so")]
const fn is_false(value: &bool) -> bool {
    !*value
}

/// Hash of words: FNV-1a with 32 bits (Fowler, Noll and Vo 1991) over words in place of bytes.
#[must_use]
pub fn digest(words: impl IntoIterator<Item = u32>) -> u32 {
    words.into_iter().fold(0x811c_9dc5, |hash, word| {
        (hash ^ word).wrapping_mul(0x0100_0193)
    })
}

/// A header and its data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capsule {
    /// What the file says.
    pub header: Header,
    /// What its spans are parts of.
    pub data: Vec<u8>,
}

impl Capsule {
    /// The bytes of the file.
    ///
    /// # Panics
    /// Never: a header has no value that JSON lacks.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut header = serde_json::to_vec(&self.header).expect("JSON has all that a header has");
        header.resize(header.len().next_multiple_of(16), b' ');
        let mut bytes = Vec::with_capacity(16 + header.len() + self.data.len());
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&(header.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&[0; 4]);
        bytes.extend_from_slice(&header);
        bytes.extend_from_slice(&self.data);
        bytes
    }

    /// What a file's bytes say.
    ///
    /// # Errors
    /// If they are no capsule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CapsuleError> {
        let refused = |reason: &str| CapsuleError::Format(reason.to_owned());
        let (magic, rest) = bytes
            .split_at_checked(8)
            .ok_or_else(|| refused("shorter than 16 bytes"))?;
        if magic != MAGIC {
            return Err(refused("it does not begin with dolocap1"));
        }
        let (length, rest) = rest
            .split_first_chunk::<4>()
            .ok_or_else(|| refused("shorter than 16 bytes"))?;
        let length = u32::from_le_bytes(*length) as usize;
        let (header, data) = rest
            .get(4..)
            .and_then(|rest| rest.split_at_checked(length))
            .ok_or_else(|| refused("it ends within its header"))?;
        let header = serde_json::from_slice(header).map_err(|error| refused(&error.to_string()))?;
        Ok(Self {
            header,
            data: data.to_vec(),
        })
    }

    /// The bytes of a span.
    ///
    /// # Panics
    /// If the data are shorter.
    #[must_use]
    pub fn span(&self, span: Span) -> &[u8] {
        &self.data[span.at as usize..(span.at + span.length) as usize]
    }
}
