//! Finds the effect that the model of a campaign lacks, and prints the model with it.
//!
//! ```text
//! cargo run --release --example discover -- models/campaigns/axle_c_study
//! ```

use std::error::Error;
use std::path::Path;

use qcar::verbs::discover::discover;
use qcar_runtime::discover::numbers::Numbers;

/// Searches in the given campaign, or in a small one by default.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).filter(|argument| Path::new(argument).is_dir());
    let folder = folder.unwrap_or("models/campaigns/axle_c_study".into());
    let answer = discover(Path::new(&folder), None, None, Numbers::default())?;
    for found in &answer.discovery.findings {
        println!("{} at {}", found.effect, found.at);
        for (name, value, error) in &found.parameters {
            println!("  {name} = {value:.4e} ± {error:.1e}");
        }
    }
    if let Some(text) = answer.model_text() {
        println!("\n{text}");
    }
    Ok(())
}
