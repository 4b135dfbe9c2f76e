qcar_derive::axle_file!("axles/refused.axle");

fn main() {}
