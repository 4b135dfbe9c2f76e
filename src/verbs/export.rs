//! `qcar export`: a model with its values as files for other tools.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use qcar_dsl::modelica;
use qcar_dsl::response::Wanted;
use qcar_dsl::show::{Stage, show};
use qcar_runtime::response::parameters::Values;

use super::ModelArguments;
use crate::catalogue::{self, Loaded};
use crate::export::fmu::Library;
use crate::export::{File, Subject, c, fmu, javascript, matlab};
use crate::failure::{Failure, flag};
use crate::files::{must_be_free, put};
use crate::json;
use crate::parameters;
use crate::roads;
use crate::state_space::{StateSpace, state_space, without_sensitivities};
use crate::table::noted;

// The tyre and road of an FMU whose tyre rolls.
mod on_tyre;

/// Write a model with its values for other tools: C99, FMU, MATLAB, Modelica, JavaScript, tables
///
/// Every parameter starts with the given value, and can be changed later where the tool allows it. Existing files are
/// never overwritten.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar export quarter_car --as c --out quarter_car.c\n  qcar export axle_a --params models/campaigns/axle_a_rig --as fmu --out axle_a.fmu\n  qcar export axle_a --params models/campaigns/axle_a_rig --as fmu --road C@80km/h:10s --out axle_a_on_road.fmu"
)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// The kind of file
    #[arg(long = "as", value_enum, value_name = "KIND")]
    kind: Kind,
    /// Version of the Functional Mock-up Interface of an FMU; default: 2
    #[arg(long, value_enum, value_name = "VERSION")]
    fmi: Option<Fmi>,
    /// For an FMU: roll over this road on the tyre of the vehicle in --params; a class of ISO 8608 such as C@80km/h, or
    /// a profile such as cleat.csv@30km/h or road.crg#v=0.5@50km/h. Without it the effective road is an input
    #[arg(long, value_name = "ROAD@SPEED")]
    road: Option<roads::RequestedRoad>,
    /// The file to write, with the ending of its kind
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Kinds of output.
#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// FILE.c and a header: equations, matrices, Jacobians, responses
    C,
    /// FILE.fmu: Model Exchange and Co-Simulation, with C99 sources
    Fmu,
    /// FILE.m: a function of MATLAB and Octave, [A, B, C, D, names] = FILE(p)
    Matlab,
    /// FILE.mat: A, B, C, D, names, units and values, MAT version 5
    Mat,
    /// FILE.mat: the same in MAT version 7.3, which is HDF5
    #[value(name = "mat73")]
    Mat73,
    /// FILE.mo: a flat model of Modelica
    Modelica,
    /// FILE.js: an object with the functions of the model, for a page or Node
    Js,
    /// FILE.json: A, B, C, D and their derivatives, as `qcar matrices` prints them
    Json,
    /// FILE.csv: A, B, C and D, one entry per line
    Csv,
    /// FILE.tex: equations and matrices, as `qcar show` prints them
    Latex,
}

/// A version of the Functional Mock-up Interface.
#[derive(Clone, Copy, ValueEnum)]
enum Fmi {
    /// 2.0
    #[value(name = "2")]
    Two,
    /// 3.0
    #[value(name = "3")]
    Three,
}

impl From<Fmi> for fmu::Version {
    fn from(fmi: Fmi) -> Self {
        match fmi {
            Fmi::Two => fmu::Version::Two,
            Fmi::Three => fmu::Version::Three,
        }
    }
}

impl Kind {
    fn extension(self) -> &'static str {
        match self {
            Kind::C => "c",
            Kind::Fmu => "fmu",
            Kind::Matlab => "m",
            Kind::Mat | Kind::Mat73 => "mat",
            Kind::Modelica => "mo",
            Kind::Js => "js",
            Kind::Json => "json",
            Kind::Csv => "csv",
            Kind::Latex => "tex",
        }
    }

    /// What it prints of responses: only code for calling has functions of them.
    fn wants(self) -> Wanted<'static> {
        match self {
            Kind::C | Kind::Js => Wanted::Jacobian,
            _ => Wanted::Nothing,
        }
    }
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let stem = stem(&arguments.out, arguments.kind.extension())?;
    let version = version(arguments)?;
    let ModelArguments { model, params, set } = &arguments.model;
    let (loaded, compiled) = catalogue::load_and_compile(model, arguments.kind.wants())?;
    let values = parameters::resolve(loaded.about(), params.as_deref(), set)?;
    parameters::require_in_range(loaded.about(), set)?;
    loaded.check_inertias(values.as_slice())?;
    let subject = Subject {
        compiled: &compiled,
        values: values.as_slice(),
    };
    let roll = |road| on_tyre::on_tyre(road, (&loaded, &values), params.as_deref());
    let unit = UnitOf {
        version,
        tyre: arguments.road.as_ref().map(roll).transpose()?,
    };
    let (files, note) = files((arguments.kind, &unit), subject, (&loaded, &values), &stem)?;
    let folder = arguments.out.parent().unwrap_or("".as_ref());
    let paths: Vec<PathBuf> = files.iter().map(|file| folder.join(&file.name)).collect();
    paths.iter().try_for_each(|path| must_be_free(path))?;
    for file in &files {
        put(folder, &file.name, &file.content)?;
    }
    let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    Ok(format!(
        "{} written to {}\n{note}{}",
        compiled.about.name,
        paths.join(" and "),
        noted(&parameters::out_of_range(loaded.about(), values.as_slice()))
    ))
}

/// Settings of an FMU.
struct UnitOf {
    version: fmu::Version,
    tyre: Option<fmu::OnTyre>,
}

/// The version of the interface. Only an FMU has a version and a road.
fn version(arguments: &Arguments) -> Result<fmu::Version, Failure> {
    if arguments.road.is_some() && !matches!(arguments.kind, Kind::Fmu) {
        let remedy = "leave it out, or write --as fmu";
        return Err(flag("--road", "a road", "it with `--as fmu` alone", remedy).into());
    }
    match (arguments.kind, arguments.fmi) {
        (Kind::Fmu, version) => Ok(version.unwrap_or(Fmi::Two).into()),
        (_, None) => Ok(fmu::Version::Two),
        (_, Some(_)) => {
            let remedy = "leave it out, or write --as fmu";
            Err(flag("--fmi", "a version of FMI", "it with `--as fmu` alone", remedy).into())
        }
    }
}

/// The name of a file without its folder and extension.
fn stem(out: &Path, extension: &str) -> Result<String, Failure> {
    let stem = out.file_stem().and_then(|stem| stem.to_str());
    match stem.filter(|_| out.extension().is_some_and(|own| own == extension)) {
        Some(stem) => Ok(stem.into()),
        None => {
            let (found, expected) = (out.display(), format!("a file that ends in .{extension}"));
            // A path such as `.` has no name that could get the ending.
            let ended = match out.file_name() {
                Some(_) => out.with_extension(extension),
                None => out.join(format!("model.{extension}")),
            };
            let remedy = format!("write --out {}", ended.display());
            Err(flag("--out", found, &expected, &remedy).into())
        }
    }
}

/// The files to write, and a message on them.
fn files(
    (kind, unit): (Kind, &UnitOf),
    subject: Subject,
    (model, values): (&Loaded, &Values),
    stem: &str,
) -> Result<(Vec<File>, String), Failure> {
    let own = |content: Vec<u8>| File {
        name: format!("{stem}.{}", kind.extension()),
        content,
    };
    let text = |text: String| (vec![own(text.into_bytes())], String::new());
    Ok(match kind {
        Kind::C => (c::files(subject, stem), String::new()),
        Kind::Fmu => {
            let packed = fmu::pack(subject, unit.version, unit.tyre.as_ref());
            let packed = packed.map_err(|message| cannot_compile(&message))?;
            (vec![own(packed.archive)], library(&packed.library))
        }
        Kind::Matlab => (vec![matlab::program(subject, stem)?], String::new()),
        Kind::Mat | Kind::Mat73 => {
            let matrices = finite(model, without_sensitivities(&**model, values, None))?;
            let file = match kind {
                Kind::Mat => matlab::data(subject, &matrices),
                _ => matlab::data_in_hdf5(subject, &matrices),
            };
            let refused = |said| {
                flag(
                    "--as",
                    said,
                    "variables that MATLAB can hold",
                    "rename one of them in the model",
                )
            };
            (vec![own(file.map_err(refused)?)], String::new())
        }
        Kind::Modelica => text(modelica::model(subject.compiled, subject.values)),
        Kind::Js => (
            vec![javascript::file(subject, model.about(), values, stem)],
            String::new(),
        ),
        Kind::Json => text(json::line(&finite(model, state_space(&**model, values, None))?)),
        Kind::Csv => text(entries(&finite(model, without_sensitivities(&**model, values, None))?)),
        Kind::Latex => text(show(subject.compiled, Stage::Latex)),
    })
}

fn finite(model: &Loaded, matrices: StateSpace) -> Result<StateSpace, Failure> {
    parameters::require_finite(&model.about().name, matrices.matrices.values().flatten().flatten())?;
    Ok(matrices)
}

/// One matrix entry per line.
fn entries(of: &StateSpace) -> String {
    let states: Vec<&str> = of.states.iter().map(|own| &*own.name).collect();
    let inputs: Vec<&str> = of.inputs.iter().map(|own| &*own.variable).collect();
    let outputs: Vec<&str> = of.outputs.iter().map(|own| &*own.name).collect();
    let blocks = [
        ("A", &states, &states),
        ("B", &states, &inputs),
        ("C", &outputs, &states),
        ("D", &outputs, &inputs),
    ];
    let mut text = String::from("matrix,row,column,value\n");
    for (name, rows, columns) in blocks {
        for (row, values) in rows.iter().zip(&of.matrices[name]) {
            let line = |(column, value): (&&str, &f64)| format!("{name},{row},{column},{value:?}\n");
            text.extend(columns.iter().zip(values).map(line));
        }
    }
    text
}

/// Notes for the user on the library of a unit.
fn library(of: &Library) -> String {
    match of {
        Library::Compiled { place, compiler, .. } => format!("{place}: compiled by {compiler}\n"),
        Library::Absent(why) => {
            format!("no library: {why}; the FMU has C99 sources, for importers that compile sources\n")
        }
    }
}

fn cannot_compile(message: &str) -> Failure {
    let remedy = "name a C99 compiler in the environment variable CC, or free some space for temporary files";
    flag("--as fmu", message.trim_end(), "a library of the model", remedy).into()
}
