qcar_derive::axle_file!("../../../tmp/refused.axle");

fn main() {}
