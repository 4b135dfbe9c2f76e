//! Reads a campaign as a data set.

use super::dataset::Evidence;
use crate::campaign::{Axis, Campaign, Run, Side, Test};
use crate::discover::numbers::Numbers;
use crate::error::{InputError, Place, Problem};
use crate::model::About;

impl Evidence {
    /// Reads the runs of a campaign for a model.
    ///
    /// Sensors at places that the model lacks are left out with a notice, so that all variants of this model are
    /// compared on the same evidence.
    ///
    /// # Errors
    /// Fails if a file cannot be read, a sweep has no reference sensor, or no run has a sensor at a place of the model.
    pub fn from_campaign(campaign: &Campaign, about: &About) -> Result<Self, InputError> {
        let mut evidence = Evidence {
            runs: Vec::new(),
            series: Vec::new(),
            two_sided: campaign.channels.iter().any(|channel| channel.side == Side::Right),
            notices: Vec::new(),
            numbers: Numbers::default(),
            held_out_judge: true,
        };
        for run in &campaign.runs {
            evidence.add(campaign, about, run)?;
        }
        if evidence.series.is_empty() {
            let mut remedy = "add a run with sensors at places of the model".to_owned();
            evidence
                .notices
                .iter()
                .for_each(|notice| remedy = format!("{remedy}; {notice}"));
            let found = "no run that says anything of the model";
            return Err(Problem::new(campaign.manifest(), Place::File, found, "measured responses", remedy).into());
        }
        Ok(evidence)
    }

    fn add(&mut self, campaign: &Campaign, about: &About, run: &Run) -> Result<(), InputError> {
        match &run.test {
            Test::Sweep(sweep) => self.add_sweep(campaign, about, run, sweep),
            Test::TimeHistory(recording) => self.add_history(campaign, about, run, recording),
            Test::Cleat { .. } => self.add_cleat(campaign, about, run),
            Test::Bounce => self.add_travel(campaign, about, run, Axis::Z),
            Test::Longitudinal => self.add_travel(campaign, about, run, Axis::X),
            Test::DynamicBounce {
                peak_velocity,
                amplitude,
            } => self.add_sine(campaign, about, run, (*amplitude, *peak_velocity)),
            Test::Dynamometer(test) => self.add_dynamometer(campaign, about, run, test),
        }
    }
}
