//! A Functional Mock-up Unit: the model's C99, the functions of the interface around it, and the description of both.
//!
//! Equal models and values give equal bytes, except for the library of the C compiler.

// Text and attributes of XML.
mod xml;
// The rolling tyre as C data.
mod tyre;
// The variables of the unit.
mod variables;
// The variables on which each result depends.
mod dependencies;
// modelDescription.xml.
mod description;
// The shared library, compiled where there is a C compiler.
mod library;

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{File, Subject, c};
use description::{fmi2, fmi3};
use variables::{Variable, Variables};

pub use library::Library;
pub use tyre::OnTyre;

/// Relative tolerance of Co-Simulation.
const TOLERANCE: f64 = 1e-9;

/// Sources that are the same in every unit.
const SOURCES: [(&str, &str); 5] = [
    ("motion.h", include_str!("fmu/motion.h")),
    ("core.h", include_str!("fmu/core.h")),
    ("core.c", include_str!("fmu/core.c")),
    ("advance.c", include_str!("fmu/advance.c")),
    ("interface.h", include_str!("fmu/interface.h")),
];

/// The version of the interface.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Version {
    /// 2.0
    Two,
    /// 3.0
    Three,
}

impl Version {
    /// The functions of the interface.
    fn source(self) -> (&'static str, &'static str) {
        match self {
            Version::Two => ("fmi2.c", include_str!("fmu/fmi2.c")),
            Version::Three => ("fmi3.c", include_str!("fmu/fmi3.c")),
        }
    }
}

/// A unit, and the result of compiling its library.
pub struct Unit {
    /// The bytes of the `.fmu` file.
    pub archive: Vec<u8>,
    /// Result of compiling the library.
    pub library: Library,
}

/// Packs a model: on an effective road, or with a tyre that rolls over a profile.
///
/// # Errors
/// Fails with the message of the C compiler if it cannot compile the model.
pub fn pack(subject: Subject, version: Version, tyre: Option<&OnTyre>) -> Result<Unit, String> {
    let name = &subject.compiled.about.name;
    let variables = Variables::of(subject, tyre);
    let mut sources = sources(subject, &variables, version, tyre);
    let compiled: Vec<String> = names(&sources)
        .filter(|name| name.ends_with(".c"))
        .map(String::from)
        .collect();
    let token = token(&sources);
    let definition = format!("\n#define TOKEN \"{token}\"\n\n#endif\n");
    if let Some(own) = sources.iter_mut().find(|file| file.name == MODEL_HEADER) {
        own.content.extend(definition.bytes());
    }
    let library = library::compile(name, &sources, &compiled, version)?;
    let description = match version {
        Version::Two => fmi2::description(subject, &variables, &token, &compiled),
        Version::Three => fmi3::description(subject, &variables, &token),
    };
    let mut entries = vec![("modelDescription.xml".to_string(), description.into_bytes())];
    entries.extend(
        sources
            .into_iter()
            .map(|file| (format!("sources/{}", file.name), file.content)),
    );
    if version == Version::Three {
        let build = fmi3::build_description(name, &compiled).into_bytes();
        entries.push(("sources/buildDescription.xml".into(), build));
    }
    entries.push((format!("resources/{name}.axle"), subject.compiled.model.text().into()));
    if let Library::Compiled { place, bytes, .. } = &library {
        entries.push((place.clone(), bytes.clone()));
    }
    Ok(Unit {
        archive: archive(&entries),
        library,
    })
}

/// Definitions of the model for `core.h`.
const MODEL_HEADER: &str = "fmu_model.h";

fn sources(subject: Subject, variables: &Variables, version: Version, tyre: Option<&OnTyre>) -> Vec<File> {
    let motion = match tyre {
        None => ("effective.c", include_str!("fmu/effective.c")),
        Some(_) => ("rolling.c", include_str!("fmu/rolling.c")),
    };
    let file = |(name, text): (&str, &str)| File {
        name: name.into(),
        content: text.into(),
    };
    let fixed = SOURCES.into_iter().chain([motion, version.source()]).map(file);
    let header = model_header(subject, variables, tyre);
    let profile = tyre.map(OnTyre::profile);
    let own = [(MODEL_HEADER, header)]
        .into_iter()
        .chain(profile.map(|text| ("road.h", text)));
    let own = own.map(|(name, text)| file((name, &text))).collect::<Vec<_>>();
    let model = c::files(subject, &subject.compiled.about.name);
    fixed.chain(own).chain(model).collect()
}

fn names(files: &[File]) -> impl Iterator<Item = &str> {
    files.iter().map(|file| file.name.as_str())
}

/// Sizes and names without the name of the model; token and end are added when they are known.
fn model_header(subject: Subject, variables: &Variables, tyre: Option<&OnTyre>) -> String {
    let about = &subject.compiled.about;
    let upper = about.name.to_uppercase();
    let sizes = [
        "PARAMETERS",
        "INPUTS",
        "STATES",
        "OUTPUTS",
        "CONSTANTS",
        "MATRICES",
        "PARAMETER_JACOBIAN",
        "KINKS",
    ];
    let added = tyre.map(|tyre| tyre.added(about));
    let size = |size: &str| match added.iter().flatten().find(|(of, _)| *of == size) {
        Some((_, more)) => {
            format!("#define MODEL_{size} {upper}_{size}\n#define {size} ({upper}_{size} + {more})\n")
        }
        None => format!("#define {size} {upper}_{size}\n"),
    };
    let sizes = sizes.map(size).concat();
    let nominals = variables.all.iter().filter_map(Variable::nominal).chain([1.0]);
    let nominals: Vec<String> = nominals.map(|nominal| format!("{nominal:?}")).collect();
    let tyre = tyre.map_or_else(String::new, |tyre| tyre.definitions(about));
    format!(
        "/* Names and sizes of the model. */\n#ifndef FMU_MODEL_H\n#define FMU_MODEL_H\n\n#include \"{name}.h\"\n\n\
         #define MODEL(name) {name}_##name\n{sizes}{tyre}#define TOLERANCE {TOLERANCE:?}\n#define NOMINALS {{{nominals}}}",
        name = about.name,
        nominals = nominals.join(", "),
    )
}

/// A hash of the sources as an identifier: two hashes of 64 bits, as 8-4-4-4-12 digits.
fn token(sources: &[File]) -> String {
    let bytes = || {
        sources
            .iter()
            .flat_map(|file| file.name.bytes().chain(file.content.iter().copied()))
    };
    let digits = format!("{:016x}{:016x}", fnv1a(bytes()), fnv1a(bytes().chain(*b"second half")));
    let parts = [0..8, 8..12, 12..16, 16..20, 20..32].map(|part| &digits[part]);
    format!("{{{}}}", parts.join("-"))
}

/// The 64-bit FNV-1a hash (Fowler, Noll and Vo).
fn fnv1a(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A zip file without dates of its entries.
fn archive(entries: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .unix_permissions(0o644);
    for (name, content) in entries {
        let written = writer
            .start_file(name.as_str(), options)
            .and_then(|()| Ok(writer.write_all(content)?));
        written.expect("memory takes what is written to it");
    }
    let finished = writer.finish().expect("memory takes what is written to it");
    finished.into_inner()
}
