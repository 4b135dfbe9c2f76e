//! The command line of qcar.

fn main() {}
