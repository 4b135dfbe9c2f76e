//! Text to the graph of a model: read as a tree, its options taken, its elements expanded, its names resolved.

pub mod syntax;
// Comes after the tree that it builds.
pub mod parse;
// The tree as canonical text.
pub mod print;
// Tree to graph: options taken, elements expanded, names resolved, units checked.
pub mod resolve;
// One member of a family as a file of its own.
pub mod canonical;
