//! What a reader of a kind gives.

use crate::about::{About, FileKind, NumberType};
use crate::georeference::Georeference;
use crate::grid::Settled;

/// Samples of a file and what it is.
#[derive(Clone, Debug)]
pub struct Elevation {
    /// What the file says.
    pub about: About,
    /// Columns and rows of the samples.
    pub size: [u32; 2],
    /// Where the samples lie, where the file tells it.
    pub georeference: Option<Georeference>,
    /// Samples in the file's unit after its own scale, rows from north to south, NaN where there is no data.
    pub samples: Vec<f32>,
}

impl Elevation {
    /// Distance of the samples, metres; `None` where the file does not tell it.
    #[must_use]
    pub fn spacing(&self) -> Option<[f64; 2]> {
        self.georeference.as_ref()?.spacing(self.size)
    }

    /// Puts together what a reader found.
    pub(crate) fn new(
        file: &str,
        settled: Settled,
        parts: (FileKind, [u32; 2], NumberType),
    ) -> Self {
        let (kind, size, number) = parts;
        Self {
            about: About {
                file: file.to_owned(),
                kind,
                size,
                number,
                packing: "none".to_owned(),
                bands: 1,
                nodata: settled.nodata,
                scale: 1.0,
                offset: 0.0,
                unit_metres: None,
                georeference: None,
                holes: settled.holes,
                range: settled.range,
                notes: settled.notes,
            },
            size: settled.size,
            georeference: None,
            samples: settled.samples,
        }
    }

    /// Where the file says that its samples lie; those that are kept lie farther apart.
    pub(crate) fn lies_at(&mut self, georeference: Georeference, every: u32) {
        let mut kept = georeference.clone();
        kept.step = kept.step.map(|step| step * f64::from(every.max(1)));
        self.georeference = Some(kept);
        self.about.georeference = Some(georeference);
    }
}
