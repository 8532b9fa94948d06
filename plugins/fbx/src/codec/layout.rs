//! What a buffer view of the extension says of itself.

/// How elements are arranged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Mode {
    /// Elements of `stride` bytes, each beside the one before it.
    Attributes,
    /// Three indices a triangle; triangles may come back turned.
    Triangles,
    /// Indices in any order.
    Indices,
}

/// What is done to elements once they are decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Filter {
    /// Nothing.
    None,
    /// Unit vectors by two numbers.
    Octahedral,
    /// Unit quaternions by their three smaller numbers, to 16-bit integers.
    Quaternion,
    /// Floats as a whole number of 24 bits times a power of two.
    Exponential,
}

impl Mode {
    /// As the extension calls it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Attributes => "ATTRIBUTES",
            Self::Triangles => "TRIANGLES",
            Self::Indices => "INDICES",
        }
    }

    pub(crate) fn of(name: &str) -> Option<Self> {
        [Self::Attributes, Self::Triangles, Self::Indices]
            .into_iter()
            .find(|mode| mode.name() == name)
    }
}

impl Filter {
    /// As the extension calls it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => "NONE",
            Self::Octahedral => "OCTAHEDRAL",
            Self::Quaternion => "QUATERNION",
            Self::Exponential => "EXPONENTIAL",
        }
    }

    pub(crate) fn of(name: &str) -> Option<Self> {
        [
            Self::None,
            Self::Octahedral,
            Self::Quaternion,
            Self::Exponential,
        ]
        .into_iter()
        .find(|filter| filter.name() == name)
    }
}

/// Elements of a buffer view, described as the extension does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) mode: Mode,
    pub(crate) filter: Filter,
    /// Bytes an element.
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

/// Elements that a coded byte may stand for: 64 where nothing changes, and what a short end is padded by.
const MOST_ELEMENTS_A_BYTE: usize = 80;

impl Layout {
    /// What the extension and the decoder ask for.
    pub(super) fn fault(&self, coded: usize) -> Option<&'static str> {
        let Self {
            mode,
            filter,
            stride,
            count,
        } = *self;
        let sound = match mode {
            Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            Mode::Triangles => (stride == 2 || stride == 4) && count.is_multiple_of(3),
            Mode::Indices => stride == 2 || stride == 4,
        };
        let filtered = match filter {
            Filter::None => true,
            Filter::Octahedral => mode == Mode::Attributes && (stride == 4 || stride == 8),
            Filter::Quaternion => mode == Mode::Attributes && stride == 8,
            Filter::Exponential => mode == Mode::Attributes,
        };
        if !sound {
            return Some("a stride or a count that its mode does not have");
        }
        if !filtered {
            return Some("a filter that its stride does not have");
        }
        if count > coded.saturating_mul(MOST_ELEMENTS_A_BYTE) {
            return Some("more elements than its bytes can hold");
        }
        None
    }
}
