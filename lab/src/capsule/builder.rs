//! Puts a capsule together.

use std::collections::HashMap;

use naga::back::wgsl::{WriterFlags, write_string};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use super::CapsuleError;
use super::format::{
    BindingKind, BufferOf, Capsule, Command, Field, From, Group, Header, Module, Pipeline, Span,
    Step, TextureOf,
};

/// A capsule that is being made. What is the same is stored once.
#[derive(Debug, Default)]
pub struct Builder {
    header: Header,
    data: Vec<u8>,
    known: HashMap<Vec<u8>, Span>,
}

impl Builder {
    /// An empty one.
    #[must_use]
    pub fn new(name: &str, about: &str) -> Self {
        Self {
            header: Header {
                name: name.to_owned(),
                about: about.to_owned(),
                ..Default::default()
            },
            ..Default::default()
        }
    }

    /// Stores bytes.
    pub fn data(&mut self, bytes: &[u8]) -> Span {
        if let Some(span) = self.known.get(bytes) {
            return *span;
        }
        self.data.resize(self.data.len().next_multiple_of(16), 0);
        let span = Span {
            at: self.data.len() as u64,
            length: bytes.len() as u64,
        };
        self.data.extend_from_slice(bytes);
        self.known.insert(bytes.to_vec(), span);
        span
    }

    /// Adds a composed module, as WGSL that plain WebGPU takes.
    ///
    /// # Errors
    /// If naga does not accept it without extras, or does not write it.
    pub fn module(
        &mut self,
        name: &str,
        defs: &[&str],
        module: &naga::Module,
    ) -> Result<u32, CapsuleError> {
        let refused = |reason: String| CapsuleError::Written {
            module: name.to_owned(),
            reason,
        };
        // naga counts `pack2x16float` and its inverse, which plain WebGPU has, as an extra.
        let granted = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        let info = Validator::new(ValidationFlags::all(), granted)
            .validate(module)
            .map_err(|fault| refused(format!("{:?}", fault.into_inner())))?;
        let wgsl = write_string(module, &info, WriterFlags::empty())
            .map_err(|fault| refused(fault.to_string()))?;
        let wgsl = self.data(wgsl.as_bytes());
        let added = Module {
            name: name.to_owned(),
            defs: defs.iter().map(|def| (*def).to_owned()).collect(),
            wgsl,
        };
        Ok(push(&mut self.header.modules, added))
    }

    /// Adds a bind group layout.
    pub fn layout(&mut self, kinds: &[BindingKind]) -> u32 {
        push(&mut self.header.layouts, kinds.to_vec())
    }

    /// Adds a pipeline.
    pub fn pipeline(&mut self, module: u32, entry: &str, layouts: &[u32]) -> u32 {
        let added = Pipeline {
            module,
            entry: entry.to_owned(),
            layouts: layouts.to_vec(),
        };
        push(&mut self.header.pipelines, added)
    }

    /// Adds a buffer that holds these bytes.
    pub fn buffer(&mut self, name: &str, bytes: &[u8]) -> u32 {
        let data = Some(self.data(bytes));
        let size = bytes.len() as u64;
        let name = name.to_owned();
        push(
            &mut self.header.buffers,
            BufferOf {
                name,
                size,
                fill: 0,
                data,
            },
        )
    }

    /// Adds a buffer of so many bytes, which begins with these and is 0 behind them.
    pub fn begun(&mut self, name: &str, size: u64, bytes: &[u8]) -> u32 {
        let data = Some(self.data(bytes));
        let name = name.to_owned();
        let made = BufferOf {
            name,
            size,
            fill: 0,
            data,
        };
        push(&mut self.header.buffers, made)
    }

    /// Adds a texture of depths, as 65535ths, row by row.
    pub fn depths(&mut self, name: &str, [width, height]: [u32; 2], depths: &[u16]) -> u32 {
        let data = self.data(bytemuck::cast_slice(depths));
        let name = name.to_owned();
        let made = TextureOf {
            name,
            width,
            height,
            data,
        };
        push(&mut self.header.textures, made)
    }

    /// Adds a buffer each of whose bytes is `fill`.
    pub fn filled(&mut self, name: &str, size: u64, fill: u8) -> u32 {
        let name = name.to_owned();
        push(
            &mut self.header.buffers,
            BufferOf {
                name,
                size,
                fill,
                data: None,
            },
        )
    }

    /// Adds a bind group.
    pub fn group(&mut self, layout: u32, buffers: &[u32]) -> u32 {
        let buffers = buffers.to_vec();
        push(&mut self.header.groups, Group { layout, buffers })
    }

    /// Adds a command.
    pub fn command(&mut self, command: Command) {
        self.header.commands.push(command);
    }

    /// Adds a pass of one dispatch, whose workgroups are known.
    pub fn dispatch(&mut self, pipeline: u32, groups: &[u32], workgroups: [u32; 3]) {
        let step = Step {
            pipeline,
            groups: groups.to_vec(),
            dispatch: Some(workgroups),
            indirect: None,
        };
        self.command(Command::Pass { steps: vec![step] });
    }

    /// Compares records of `stride` bytes of a buffer, from the byte `offset` on.
    pub fn check(
        &mut self,
        name: &str,
        at: (u32, u64, u64),
        fields: Vec<Field>,
        expected: &[u8],
        from: From,
    ) {
        self.compare(name, at, fields, expected, from, false);
    }

    /// The same, where records may stand in any order.
    pub fn check_unordered(
        &mut self,
        name: &str,
        at: (u32, u64, u64),
        fields: Vec<Field>,
        expected: &[u8],
        from: From,
    ) {
        self.compare(name, at, fields, expected, from, true);
    }

    fn compare(
        &mut self,
        name: &str,
        (buffer, offset, stride): (u32, u64, u64),
        fields: Vec<Field>,
        expected: &[u8],
        from: From,
        unordered: bool,
    ) {
        let data = self.data(expected);
        self.command(Command::Check {
            name: name.to_owned(),
            buffer,
            offset,
            stride,
            count: expected.len() as u64 / stride,
            fields,
            expected: data,
            from,
            unordered,
        });
    }

    /// The capsule.
    #[must_use]
    pub fn finish(self) -> Capsule {
        Capsule {
            header: self.header,
            data: self.data,
        }
    }
}

fn push<T>(list: &mut Vec<T>, item: T) -> u32 {
    list.push(item);
    list.len() as u32 - 1
}
