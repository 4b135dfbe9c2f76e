//! The macro doors of the axle compiler: a model in the text of a program, or in a file of its package.
//!
//! Both expand to the module that `qcar_dsl::rust` prints; the crate that uses them depends on `qcar-runtime`.

use std::path::Path;

use proc_macro2::TokenStream;
use qcar_dsl::compile::compile_tokens;
use qcar_dsl::disk::{Files, compile_file};
use qcar_dsl::rust::module;
use qcar_dsl::source::Source;
use quote::{quote, quote_spanned};
use syn::{LitStr, parse_macro_input};

/// Compiles an axle that is written in place; the path of a family is relative to the package.
///
/// ```ignore
/// qcar_derive::axle! {
///     axle one_mass {
///         param m: kg;
///         param k: N/m;
///         direction z { road pad; mass body = m; link spring: body - pad { spring k; } }
///     }
/// }
/// let system = one_mass::state_space(&one_mass::Parameters { m: 400.0, k: 20e3 });
/// ```
#[proc_macro]
pub fn axle(tokens: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let files = Files::default();
    let in_package = |_: &str, written: &str| files.load(&package().join("axle!").display().to_string(), written);
    let expanded = match compile_tokens(tokens.into(), &in_package) {
        Ok(compiled) => rust(&module(&compiled)),
        Err(errors) => errors,
    };
    let watched = watch(&files.0.into_inner());
    quote!(#expanded #watched).into()
}

/// Compiles a model file; its path is relative to the package.
///
/// ```ignore
/// qcar_derive::axle_file!("axles/axle_d.axle");
/// ```
#[proc_macro]
pub fn axle_file(tokens: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let path = parse_macro_input!(tokens as LitStr);
    let file = package().join(path.value()).display().to_string();
    let error = |message: String| quote_spanned!(path.span()=> ::core::compile_error!(#message););
    let from_disk = match compile_file(&file) {
        Ok(from_disk) => from_disk,
        Err(reason) => {
            return error(format!(
                "{file}: {reason}; write the path of a model file in this package"
            ))
            .into();
        }
    };
    let expanded = match from_disk.compiled {
        Ok(compiled) => rust(&module(&compiled)),
        Err(report) => error(format!("{}\n{report}", report.compact())),
    };
    let watched = watch(&from_disk.read);
    quote!(#expanded #watched).into()
}

/// The folder of the package that is being compiled.
fn package() -> std::path::PathBuf {
    Path::new(&std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).to_path_buf()
}

fn rust(text: &str) -> TokenStream {
    text.parse().expect("a generated module is Rust")
}

/// rustc knows which files an `include_bytes!` reads, and compiles again when they change.
fn watch(read: &[(String, Source)]) -> TokenStream {
    let files = read.iter().map(|(_, source)| &source.name);
    quote!(#(const _: &[u8] = ::core::include_bytes!(#files);)*)
}
