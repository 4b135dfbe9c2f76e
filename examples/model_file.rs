//! Compiles a model file at run time and prints its modes.
//!
//! ```text
//! cargo run --example model_file -- models/axles/axle_c.axle
//! ```

use std::error::Error;
use std::path::Path;

use qcar::{catalogue, parameters};
use qcar_runtime::modes::modes;

/// Prints the modes of the given model file, or of a quarter car by default.
pub fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).filter(|argument| argument.ends_with(".axle"));
    let file = file.unwrap_or("models/axles/quarter_car.axle".into());
    let model = catalogue::load(&file)?;
    let values = parameters::resolve(model.about(), Vec::<&Path>::new(), &[])?;
    for mode in modes(&*model, &values) {
        println!("{:.2} Hz, damping ratio {:.3}", mode.frequency, mode.damping);
        for part in mode.shape {
            println!("  {} {}: {:.3}", part.location, part.axis, part.amplitude);
        }
    }
    Ok(())
}
