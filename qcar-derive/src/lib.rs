//! The macros of the axle compiler, for a model in the text of a program or in a file of its package.
//!
//! Both expand to the module that `qcar_dsl::rust` prints; the crate that uses them depends on `qcar-runtime`.

use std::path::PathBuf;

use proc_macro2::TokenStream;
use qcar_dsl::compile::compile_tokens;
use qcar_dsl::disk::{Files, LoadedFile, compile_file};
use qcar_dsl::rust::module;
use quote::{quote, quote_spanned};
use syn::{LitStr, parse_macro_input};

/// Compiles an axle that is written inline; the path of a family is relative to the package.
///
#[doc = concat!("```\n", include_str!("axle_example.txt"), "```")]
#[proc_macro]
pub fn axle(tokens: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let files = Files::new(&package());
    let expanded = match compile_tokens(tokens.into(), &|asking, written| files.load(asking, written)) {
        Ok(compiled) => rust(&module(&compiled)),
        Err(errors) => errors,
    };
    let watched = watch(&files.finish());
    quote!(#expanded #watched).into()
}

/// Compiles a model file; its path is relative to the package.
///
#[doc = concat!("```\n", include_str!("axle_file_example.txt"), "```")]
#[proc_macro]
pub fn axle_file(tokens: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let literal = parse_macro_input!(tokens as LitStr);
    let path = literal.value();
    let error = |message: String| quote_spanned!(literal.span()=> ::core::compile_error!(#message););
    let compiled_file = match compile_file(&package(), &path) {
        Ok(compiled_file) => compiled_file,
        Err(reason) => {
            return error(format!(
                "{path}: {reason}; write the path of a model file in this package"
            ))
            .into();
        }
    };
    let expanded = match compiled_file.compiled {
        Ok(compiled) => rust(&module(&compiled)),
        Err(report) => error(format!("{}\n{report}", report.compact())),
    };
    let watched = watch(&compiled_file.read);
    quote!(#expanded #watched).into()
}

/// The folder of the package that is being compiled.
fn package() -> PathBuf {
    std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default().into()
}

fn rust(text: &str) -> TokenStream {
    text.parse().expect("a generated module is Rust")
}

/// Makes rustc watch the files: it compiles again if a file of an `include_bytes!` changes.
fn watch(read: &[LoadedFile]) -> TokenStream {
    let files = read
        .iter()
        .map(|read| package().join(&read.source.name).display().to_string());
    quote!(#(const _: &[u8] = ::core::include_bytes!(#files);)*)
}
