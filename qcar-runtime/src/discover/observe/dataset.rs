//! The data set: series of measured values with their uncertainty.

use super::run::Run;
use super::sensor::{is_known, missing};
use super::series::Series;
use crate::campaign::Role;
use crate::discover::numbers::Numbers;
use crate::model::About;
use crate::transmissibility::Point;

/// The measured data of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// Runs in the order of the campaign, without runs that contribute nothing.
    pub runs: Vec<Run>,
    /// Series of all runs, run by run.
    pub series: Vec<Series>,
    /// True if both sides of a car are measured and averaged.
    pub two_sided: bool,
    /// Omitted data and the reasons, as sentences for the engineer.
    pub notices: Vec<String>,
    /// Assumptions of a search on this data set.
    pub numbers: Numbers,
    /// False if the held-out runs do not show what the model misses in the fitted ones.
    pub held_out_judge: bool,
}

impl Evidence {
    /// Series of the runs of one role, with their positions.
    pub fn of_role(&self, role: Role) -> impl Iterator<Item = (usize, &Series)> {
        let series = self.series.iter().enumerate();
        series.filter(move |(_, series)| self.runs[series.run].role == role)
    }

    /// Role of the runs that judge a model: held out, or fitted if none is held out or if those do not show what is
    /// missing.
    pub fn judging(&self) -> Role {
        match self.of_role(Role::HeldOut).next() {
            Some(_) if self.held_out_judge => Role::HeldOut,
            _ => Role::Fit,
        }
    }

    /// Sensors of a run, without duplicates.
    pub fn sensors(&self, run: usize) -> Vec<&Point> {
        let mut sensors: Vec<&Point> = Vec::new();
        for series in self.series.iter().filter(|series| series.run == run) {
            if !sensors.contains(&&series.sensor) {
                sensors.push(&series.sensor);
            }
        }
        sensors
    }

    /// Keeps the sensors at places that the model has, and adds a notice for each of the others.
    pub(super) fn keep_known(&mut self, about: &About, run: &str, points: Vec<Point>) -> Vec<Point> {
        let (known, unknown): (Vec<_>, Vec<_>) = points.into_iter().partition(|point| is_known(about, point));
        for point in unknown {
            let [what, remedy] = missing(about, &point);
            self.notices
                .push(format!("{run}: {what}, so that sensor is left out; {remedy}"));
        }
        known
    }
}
