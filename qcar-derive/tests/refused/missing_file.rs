qcar_derive::axle_file!("axles/none.axle");

fn main() {}
