//! Where text comes from, and places in it.

/// A place in a source: which source, and the token span within it.
///
/// Within a procedural macro the token span is the compiler's own, so that rustc draws its caret there.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Which source: an index into the list that `compile` was given and loaded.
    pub source: u16,
    /// The token, or the first of several.
    pub token: proc_macro2::Span,
}

/// A text with a name, usually a path as the user wrote it.
#[derive(Clone, Debug)]
pub struct Source {
    /// For messages.
    pub name: String,
    /// Empty for the tokens of an inline macro.
    pub text: String,
}
