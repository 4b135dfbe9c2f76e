//! From text to the graph of a model: the text is parsed into a tree, options are chosen, elements expanded and names
//! resolved.

pub mod syntax;
// From text to the syntax tree.
pub mod parse;
// From the syntax tree to canonical text.
pub mod print;
// From the syntax tree to the model graph: options, elements, names and units resolved.
pub mod resolve;
// One member of a family as a file of its own.
pub mod canonical;
