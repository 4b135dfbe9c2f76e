//! Simulated time histories as files: CSV as tables, MAT and MDF for viewers of measurements.

use std::fmt::Write;
use std::path::Path;

use clap::ValueEnum;
use qcar_runtime::error::InputError;
use qcar_signals::mat::write::{Array, v5, v73};
use qcar_signals::mdf::write::{Channel, Group, v4};

use crate::files::put;
use crate::units;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// A table: time and a column for each channel, with units in brackets
    Csv,
    /// MAT version 5: a structure with X (time) and Y, each with Name, Unit and Data
    Mat,
    /// The same in MAT version 7.3 (HDF5), where Y is a cell array
    #[value(name = "mat73")]
    Mat73,
    /// MDF 4.10, uncompressed: one group with the time of the run
    Mdf,
}

/// Samples of one run, SI.
pub struct History {
    /// Name of the run, and of its file.
    pub name: String,
    /// Times, s.
    pub time: Vec<f64>,
    /// Channels, with as many samples as there are times.
    pub channels: Vec<Channel>,
}

impl Kind {
    /// The name of a file of this kind.
    pub fn file(self, name: &str) -> String {
        match self {
            Kind::Csv => format!("{name}.csv"),
            Kind::Mat | Kind::Mat73 => format!("{name}.mat"),
            Kind::Mdf => format!("{name}.mf4"),
        }
    }
}

impl History {
    /// Writes the file into a folder.
    ///
    /// # Errors
    /// Fails if the folder cannot be written to.
    pub fn put(&self, folder: &Path, kind: Kind) -> Result<(), InputError> {
        let file = kind.file(&self.name);
        match kind {
            Kind::Csv => put(folder, &file, &self.csv()),
            Kind::Mat => put(folder, &file, &self.mat(|run| v5("a run simulated by qcar", run))),
            Kind::Mat73 => put(folder, &file, &self.mat(v73)),
            Kind::Mdf => put(folder, &file, &self.mdf()),
        }
    }

    fn csv(&self) -> String {
        let names: String = self
            .channels
            .iter()
            .map(|channel| format!(",{}", units::heading(&channel.name, &channel.unit)))
            .collect();
        let mut out = format!("{}{names}\n", units::heading("time", "s"));
        for (at, time) in self.time.iter().enumerate() {
            let _ = write!(out, "{}", units::value(*time, "s"));
            for channel in &self.channels {
                let _ = write!(out, ",{}", units::value(channel.samples[at], &channel.unit));
            }
            out.push('\n');
        }
        out
    }

    /// A capture as dSPACE writes it, which most viewers recognise as time histories with units.
    fn mat(&self, write: impl FnOnce(&[(String, Array)]) -> Result<Vec<u8>, String>) -> Vec<u8> {
        let fields = || ["Name", "Unit", "Data", "XIndex"].map(String::from).to_vec();
        let element = |name: &str, unit: &str, samples: &[f64]| {
            let data = Array::column(samples.to_vec());
            vec![
                Array::Text(name.into()),
                Array::Text(unit.into()),
                data,
                Array::number(1.0),
            ]
        };
        let channels = self.channels.iter();
        let channels = channels
            .map(|own| element(&own.name, &own.unit, &own.samples))
            .collect();
        let time = vec![element("time", "s", &self.time)];
        let capture = Array::fields(vec![
            ("X".into(), Array::Structs(fields(), time)),
            ("Y".into(), Array::Structs(fields(), channels)),
        ]);
        write(&[(self.name.clone(), capture)]).expect("one variable, and fields of different names")
    }

    fn mdf(&self) -> Vec<u8> {
        let group = Group {
            name: self.name.clone(),
            times: self.time.clone(),
            channels: self.channels.clone(),
        };
        v4("qcar", &[group])
    }
}
