//! Compiles every file of `axles/` to a module, and lists them and the files of `effects/` and `laws/`. A new file in
//! any of these folders needs no other change.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use qcar_dsl::diagnostic::Report;
use qcar_dsl::disk::{CompiledFile, compile_file};
use qcar_dsl::patch::Patch;
use qcar_dsl::rust::{module, type_name};
use qcar_dsl::source::Source;

fn main() {
    println!("cargo::rerun-if-changed=axles");
    println!("cargo::rerun-if-changed=effects");
    println!("cargo::rerun-if-changed=laws");
    let mut code = String::new();
    let mut entries = String::new();
    for file in files("axles") {
        let Some((text, entry)) = compile(&file) else { continue };
        code += &text;
        entries += &entry;
    }
    write!(code, "\nstatic SHIPPED: &[Shipped] = &[\n{entries}];\n").expect("a string takes all");
    for (folder, list) in [("effects", "EFFECTS"), ("laws", "LAWS")] {
        let effects: String = files(folder).iter().filter_map(|file| effect(file)).collect();
        write!(code, "\nstatic {list}: &[ShippedEffect] = &[\n{effects}];\n").expect("a string takes all");
    }
    let out = std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    std::fs::write(Path::new(&out).join("models.rs"), code).expect("OUT_DIR can be written");
}

/// The files of a folder, by name.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = std::fs::read_dir(folder).expect("this package has folders of axles, effects and laws");
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
    let compiled_file = match compile_file(Path::new(""), &path) {
        Ok(compiled_file) => compiled_file,
        Err(reason) => {
            println!("cargo::error={path}: {reason}");
            return None;
        }
    };
    compiled_file
        .read
        .iter()
        .for_each(|read| println!("cargo::rerun-if-changed={}", read.source.name));
    match &compiled_file.compiled {
        Ok(compiled) => Some((module(compiled), entry(&compiled.about.name, &compiled_file))),
        Err(report) => {
            refuse(report);
            None
        }
    }
}

/// `Shipped { … }`: the module's type, and its source texts.
fn entry(name: &str, compiled_file: &CompiledFile) -> String {
    let mut texts = compiled_file
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

/// The text of a file of this package, as an expression.
fn included(path: &str) -> String {
    let below = format!("/{path}");
    format!("include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {below:?}))")
}

/// `ShippedEffect { … }`: a valid effect; mistakes go to cargo.
fn effect(file: &Path) -> Option<String> {
    let name = file.display().to_string();
    let text = std::fs::read_to_string(file).expect("a file that was listed can be read");
    match Patch::read(Source {
        name: name.clone(),
        text,
    }) {
        Ok(patch) => {
            let effect = &patch.effect().name.text;
            let text = included(&name);
            Some(format!(
                "    ShippedEffect {{ name: {effect:?}, file: {name:?}, text: {text} }},\n"
            ))
        }
        Err(report) => {
            refuse(&report);
            None
        }
    }
}

/// Prints a report, as lines for cargo and in full.
fn refuse(report: &Report) {
    report
        .compact()
        .lines()
        .for_each(|line| println!("cargo::error={line}"));
    eprintln!("{report}");
}
