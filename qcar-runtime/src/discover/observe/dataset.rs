//! What a campaign holds, as series of measured values with their uncertainty.

use super::run::Run;
use super::sensor::is_known;
use super::series::Series;
use crate::campaign::Role;
use crate::discover::numbers::Numbers;
use crate::model::About;
use crate::transmissibility::Point;

/// What a campaign holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// In the order of the campaign, without those that add nothing.
    pub runs: Vec<Run>,
    /// The series of all runs, run after run.
    pub series: Vec<Series>,
    /// Whether the two sides of a car are measured, and taken for one.
    pub two_sided: bool,
    /// What was left out, and why, as sentences for the engineer.
    pub notices: Vec<String>,
    /// What a search assumes of it.
    pub numbers: Numbers,
}

impl Evidence {
    /// The series of the runs of one role, with their places.
    pub fn of_role(&self, role: Role) -> impl Iterator<Item = (usize, &Series)> {
        let series = self.series.iter().enumerate();
        series.filter(move |(_, series)| self.runs[series.run].role == role)
    }

    /// The sensors of a run, each once.
    pub fn sensors(&self, run: usize) -> Vec<&Point> {
        let mut sensors: Vec<&Point> = Vec::new();
        for series in self.series.iter().filter(|series| series.run == run) {
            if !sensors.contains(&&series.sensor) {
                sensors.push(&series.sensor);
            }
        }
        sensors
    }

    /// Of the sensors of a run, those at places that the model has.
    pub(super) fn known(&mut self, about: &About, run: &str, points: Vec<Point>) -> Vec<Point> {
        let (known, unknown): (Vec<_>, Vec<_>) = points.into_iter().partition(|point| is_known(about, point));
        for point in unknown {
            let notice = format!(
                "{run}: the model has no `{}` along {}; that sensor is left out",
                point.location,
                point.axis.name()
            );
            self.notices.push(notice);
        }
        known
    }
}
