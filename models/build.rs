//! Compiles every file of `axles/` to a module, and lists them. A new file there needs no other change.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use qcar_dsl::disk::{FromDisk, compile_file};
use qcar_dsl::rust::{module, type_name};

fn main() {
    println!("cargo::rerun-if-changed=axles");
    let mut code = String::new();
    let mut entries = String::new();
    for file in model_files() {
        let Some((text, entry)) = compile(&file) else { continue };
        code += &text;
        entries += &entry;
    }
    write!(code, "\nstatic SHIPPED: &[Shipped] = &[\n{entries}];\n").expect("a string takes all");
    let out = std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    std::fs::write(Path::new(&out).join("models.rs"), code).expect("OUT_DIR can be written");
}

/// The model files, by name.
fn model_files() -> Vec<PathBuf> {
    let folder = std::fs::read_dir("axles").expect("this package has a folder of axles");
    let paths = folder.filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "axle"))
        .collect();
    files.sort();
    files
}

/// A model's module and its entry in the list; mistakes go to cargo.
fn compile(file: &Path) -> Option<(String, String)> {
    let path = file.display().to_string();
    let from_disk = match compile_file(Path::new(""), &path) {
        Ok(from_disk) => from_disk,
        Err(reason) => {
            println!("cargo::error={path}: {reason}");
            return None;
        }
    };
    from_disk
        .read
        .iter()
        .for_each(|read| println!("cargo::rerun-if-changed={}", read.source.name));
    match &from_disk.compiled {
        Ok(compiled) => Some((module(compiled), entry(&compiled.about.name, &from_disk))),
        Err(report) => {
            report
                .compact()
                .lines()
                .for_each(|line| println!("cargo::error={line}"));
            eprintln!("{report}");
            None
        }
    }
}

/// `Shipped { … }`: the module's type, and the texts that it comes from.
fn entry(name: &str, from_disk: &FromDisk) -> String {
    let included = |path: &str| {
        format!(
            "include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {:?}))",
            format!("/{path}")
        )
    };
    let mut texts = from_disk
        .read
        .iter()
        .map(|read| (&read.written, included(&read.source.name)));
    let (file, text) = texts.next().expect("the model file itself was read");
    let families: String = texts
        .map(|(written, text)| format!("({written:?}, {text}), "))
        .collect();
    let model = format!("&{name}::{}", type_name(name));
    format!(
        "    Shipped {{ name: {name:?}, file: {file:?}, text: {text}, families: &[{families}], model: {model} }},\n"
    )
}
