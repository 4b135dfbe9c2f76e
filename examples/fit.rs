//! A model fitted to the rig runs of a campaign, with standard errors.
//!
//! ```text
//! cargo run --release --example fit -- models/campaigns/axle_a_rig
//! ```

use std::error::Error;
use std::path::Path;

use qcar::verbs::fit::{Choices, fit};

/// Fits the given campaign, or a small one by default.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).filter(|argument| Path::new(argument).is_dir());
    let folder = folder.unwrap_or("models/campaigns/axle_c_study".into());
    let fitted = fit(Path::new(&folder), &Choices::of_model(None))?;
    println!(
        "{}: {}",
        fitted.fit.model,
        if fitted.fit.converged {
            "converged"
        } else {
            "did not converge"
        }
    );
    for own in fitted.fit.parameters.iter().filter(|own| own.fitted) {
        match own.stderr {
            Some(error) => println!("  {} = {:.4e} ± {error:.1e} {}", own.name, own.value, own.unit),
            None => println!(
                "  {} = {:.4e} {}, which the runs do not determine",
                own.name, own.value, own.unit
            ),
        }
    }
    Ok(())
}
