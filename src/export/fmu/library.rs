//! The library of an FMU for this machine, compiled with the C compiler of the system.

use std::env::consts::{ARCH, OS};
use std::path::Path;
use std::process::{Command, Output};
use std::{env, fs, io};

use super::Version;
use crate::export::File;

/// Result of compiling the library.
pub enum Library {
    /// The library is in the unit.
    Compiled {
        /// Path in the unit.
        place: String,
        /// Name of the compiler.
        compiler: String,
        /// The library.
        bytes: Vec<u8>,
    },
    /// The unit has sources only, with the reason.
    Absent(String),
}

/// Folder and extension of libraries on this machine.
fn platform(version: Version) -> Option<(String, &'static str)> {
    let (old, new, extension) = match OS {
        "linux" => ("linux", "linux", "so"),
        "macos" => ("darwin", "darwin", "dylib"),
        "windows" => ("win", "windows", "dll"),
        _ => return None,
    };
    match (version, ARCH) {
        (Version::Two, "x86_64") => Some((format!("{old}64"), extension)),
        (Version::Three, "x86_64" | "aarch64") => Some((format!("{ARCH}-{new}"), extension)),
        _ => None,
    }
}

/// Compiles the sources of a unit.
///
/// # Errors
/// Fails with the message of the compiler or the error of the system.
pub fn compile(model: &str, sources: &[File], compiled: &[String], version: Version) -> Result<Library, String> {
    let Some((folder, extension)) = platform(version) else {
        let why = format!("this version of FMI has no name for libraries of {OS} on {ARCH}");
        return Ok(Library::Absent(why));
    };
    let Some(compiler) = compiler() else {
        return Ok(Library::Absent(
            "no C compiler was found (cc, gcc or clang; CC names another)".into(),
        ));
    };
    let work = Folder::new().map_err(|error| format!("no folder to compile in: {error}"))?;
    let name = format!("{model}.{extension}");
    let built = build(&compiler, &work.0, sources, compiled, &name);
    let bytes = built.map_err(|error| format!("{compiler} could not be run: {error}"))?;
    Ok(Library::Compiled {
        place: format!("binaries/{folder}/{name}"),
        bytes: bytes.map_err(|message| format!("{compiler} could not compile the model: {message}"))?,
        compiler,
    })
}

fn build(
    compiler: &str,
    folder: &Path,
    sources: &[File],
    compiled: &[String],
    name: &str,
) -> io::Result<Result<Vec<u8>, String>> {
    for source in sources {
        fs::write(folder.join(&source.name), &source.content)?;
    }
    let Output { status, stderr, .. } = Command::new(compiler)
        .args(FLAGS)
        .args(compiled)
        .args(["-o", name, "-lm"])
        .current_dir(folder)
        .output()?;
    match status.success() {
        true => fs::read(folder.join(name)).map(Ok),
        false => Ok(Err(String::from_utf8_lossy(&stderr).into_owned())),
    }
}

/// Fastest options that keep the bits of the evaluator.
const FLAGS: [&str; 6] = [
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-fPIC",
    "-fvisibility=hidden",
    "-shared",
];

fn compiler() -> Option<String> {
    let wished = env::var("CC").ok().filter(|name| !name.is_empty());
    let candidates = wished.into_iter().chain(["cc", "gcc", "clang"].map(String::from));
    let answers = |name: &String| {
        Command::new(name)
            .arg("--version")
            .output()
            .is_ok_and(|ran| ran.status.success())
    };
    candidates.into_iter().find(answers)
}

/// A temporary folder, removed when it is dropped.
struct Folder(std::path::PathBuf);

impl Folder {
    fn new() -> io::Result<Folder> {
        let folder = env::temp_dir().join(format!("qcar-fmu-{}", std::process::id()));
        fs::create_dir_all(&folder).map(|()| Folder(folder))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder that cannot be removed stays among the temporary files.
        let _ = fs::remove_dir_all(&self.0);
    }
}
