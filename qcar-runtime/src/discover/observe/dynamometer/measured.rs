//! Reads a dynamometer table: the force of a link in the middle of its travel, for each speed there.
//!
//! The load cell is a separate sensor, so its gain is a nuisance parameter beside those of the sensors in the car.

use nalgebra::Complex;

use crate::campaign::{Campaign, Dynamometer, Quantity, Run as Listed};
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::error::{InputError, Place, Problem};
use crate::model::About;
use crate::spelling;
use crate::transmissibility::Point;

impl Evidence {
    pub(in crate::discover::observe) fn add_dynamometer(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &Listed,
        test: &Dynamometer,
    ) -> Result<(), InputError> {
        check_link(campaign, about, run, test)?;
        let table = campaign.force_table(run)?;
        let mut rows: Vec<usize> = (0..table.velocity.len()).collect();
        rows.sort_by(|&a, &b| table.velocity[a].total_cmp(&table.velocity[b]));
        let of = |column: &[f64]| rows.iter().map(|&row| column[row]).collect::<Vec<f64>>();
        self.series.push(Series {
            run: self.runs.len(),
            sensor: Point::new(
                &format!("{}_on_dynamometer", test.link),
                test.axis.clone(),
                Quantity::Force,
            ),
            kind: Kind::Speed,
            at: of(&table.velocity),
            value: of(&table.force).into_iter().map(Complex::from).collect(),
            sigma: of(&table.uncertainty),
            noise: of(&table.uncertainty),
            least_discrepancy: 0.0,
        });
        self.runs.push(Run {
            name: run.name.clone(),
            role: run.role,
            level: table
                .velocity
                .iter()
                .fold(0.0, |most: f64, speed| most.max(speed.abs())),
            stimulus: Stimulus::Dynamometer {
                link: test.link.clone(),
                axis: test.axis.clone(),
                amplitude: test.amplitude,
            },
        });
        Ok(())
    }
}

/// # Errors
/// Fails if the model lacks the link.
fn check_link(campaign: &Campaign, about: &About, run: &Listed, test: &Dynamometer) -> Result<(), InputError> {
    let along = || {
        about
            .links
            .iter()
            .filter(|own| own.axis == test.axis.name())
            .map(|own| &*own.name)
    };
    if along().any(|name| name == test.link) {
        return Ok(());
    }
    let known: Vec<String> = along().map(|name| format!("`{name}`")).collect();
    let found = format!("`{}` in the run {}", test.link, run.name);
    let expected = format!(
        "a link of model `{}` along {}: {}",
        about.name,
        test.axis.name(),
        if known.is_empty() {
            "it has none".into()
        } else {
            known.join(", ")
        }
    );
    let remedy = match spelling::nearest(&test.link, along()) {
        Some(nearest) => format!("did you mean `{nearest}`? Otherwise leave the run out"),
        None => "correct its name, or leave the run out".into(),
    };
    Err(Problem::new(campaign.manifest(), Place::Name("link".into()), found, expected, remedy).into())
}
