//! OpenCRG, the road format of ASAM: heights on a grid along a reference line (u) and across it (v, positive to the
//! left).
//!
//! Each longitudinal section becomes a channel, named after its position such as `v=-1.5`, whose samples are heights
//! over the channel `u`. They are the sum of the grid, the height of the reference line and its banking. Source: ASAM
//! OpenCRG 1.2, data format.

// The text above the data.
mod header;
// The meaning of the data columns.
mod columns;
// The grid of heights.
mod grid;
// Distance, height and banking of the reference line.
mod line;

use crate::bytes::text;
use crate::error::{Place, Read};
use crate::signal::{Recording, Signal, Source, TimeBase};

use columns::{Column, Kind, columns, places};
use grid::Grid;
use header::{Header, RECORD, section};
use line::Line;

/// Number of bytes in which the format is recognised.
const HEAD: usize = 1 << 16;

/// True if the beginning of a file has a section of road parameters.
pub(crate) fn is_crg(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let mut lines = head.split(|&byte| byte == b'\n');
    lines.any(|line| section(&text(&line[..line.len().min(RECORD)])).as_deref() == Some("ROAD_CRG"))
}

/// Reads a road.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let header = Header::read(bytes)?;
    header.refuse_references_and_modifiers()?;
    let columns = columns(&header)?;
    let grid = Grid::read(&bytes[header.end..], columns.len(), &header)?;
    let line = Line::of(&header, &columns, &grid.columns)?;
    let places = places(&header, &columns)?;
    let mut recording = Recording::new(format!("OpenCRG {}", grid.format));
    recording.signals.push(along(
        "u",
        line.u.clone(),
        Place::Item("REFERENCE_LINE_INCREMENT".into()),
    ));
    for (at, v) in places {
        let heights = line.height.iter().zip(&line.banking).zip(&grid.columns[at]);
        let heights = heights.map(|((height, banking), z)| height + v * banking + z).collect();
        recording
            .signals
            .push(along(&format!("v={v}"), heights, Place::Line(columns[at].line)));
    }
    for Column { line, name, .. } in columns.iter().filter(|column| column.kind == Kind::Other) {
        recording.pass_over(name, Place::Line(*line), "no height of the road");
    }
    Ok(recording)
}

/// A channel of lengths along the road.
fn along(name: &str, samples: Vec<f64>, place: Place) -> Signal {
    Signal {
        name: name.into(),
        unit: "m".into(),
        time: TimeBase::Unknown,
        samples: samples.into(),
        labels: Vec::new(),
        source: Source {
            group: String::new(),
            place,
        },
    }
}
