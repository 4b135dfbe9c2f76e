//! An axle as a family of designs: its parameters depend on design variables, and readings are its results.

use rayon::prelude::*;

use super::task::Designs;
use crate::mean::mean;
use crate::metric::{Ground, MetricError};
use crate::response::parameters::Values;
use crate::sensitivity::Chance;

/// Effect of a design variable on a parameter: the parameter is the design variable times a factor, plus a constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Position of the design variable.
    pub variable: usize,
    /// Index of the parameter; parameters tied to it follow.
    pub parameter: usize,
    /// The factor.
    pub factor: f64,
    /// The constant.
    pub constant: f64,
}

/// An axle whose parameters follow design variables.
pub struct Axle<'a> {
    /// The metrics.
    pub ground: &'a Ground<'a>,
    /// Values of the parameters that no design variable changes.
    pub values: Values,
    /// Effects of the design variables on the parameters.
    pub moves: Vec<Move>,
    /// Number of design variables.
    pub variables: usize,
    /// Means of readings, given by the positions of these: further results after the readings.
    pub means: Vec<Vec<usize>>,
    /// Uncertainty of the parameters, the same for every design.
    pub chance: Chance,
}

impl Axle<'_> {
    /// The parameters of a design.
    pub fn values_of(&self, design: &[f64]) -> Values {
        let mut values = self.values.clone();
        for own in &self.moves {
            values.set(own.parameter, own.factor * design[own.variable] + own.constant);
        }
        values
    }

    /// The direction of the parameters along which a design variable moves by `size`.
    fn direction(&self, variable: usize, size: f64) -> Vec<f64> {
        let mut direction = vec![0.0; self.values.as_slice().len()];
        for own in self.moves.iter().filter(|own| own.variable == variable) {
            for (at, moved) in direction.iter_mut().enumerate() {
                if self.values.leader(at) == own.parameter {
                    *moved = own.factor * size;
                }
            }
        }
        direction
    }
}

/// Designs whose rides are simulated side by side: more than there are lanes, so that few lanes are empty at the end.
const ABREAST: usize = 12;

impl Axle<'_> {
    /// The results of measured readings; `None` of a design that is unstable, whose metrics mean nothing.
    fn results(&self, design: &Values, measured: Result<Vec<f64>, MetricError>) -> Option<Vec<f64>> {
        let mut values = measured.ok().filter(|_| !self.ground.is_unstable(design))?;
        let means: Vec<f64> = self
            .means
            .iter()
            .map(|of| mean(of.iter().map(|&at| values[at])))
            .collect();
        values.extend(means);
        values.iter().all(|value| value.is_finite()).then_some(values)
    }

    fn results_of(&self, design: &Values) -> Option<Vec<f64>> {
        self.results(design, self.ground.measure(design))
    }

    fn results_of_all(&self, designs: &[Values]) -> Vec<Option<Vec<f64>>> {
        let parts = designs.par_chunks(ABREAST);
        let results = |designs: &[Values]| {
            let measured = self.ground.measure_all(designs).into_iter();
            let own = designs.iter().zip(measured);
            own.map(|(design, measured)| self.results(design, measured))
                .collect::<Vec<_>>()
        };
        parts.flat_map_iter(results).collect()
    }
}

impl Designs for Axle<'_> {
    fn values(&self, design: &[f64]) -> Option<Vec<f64>> {
        self.results_of(&self.values_of(design))
    }

    fn is_certain(&self) -> bool {
        self.chance.is_certain()
    }

    fn drawn(&self, design: &[f64], number: u64) -> Option<Vec<f64>> {
        self.results_of(&self.chance.draw(&self.values_of(design), number))
    }

    fn values_of_all(&self, designs: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        let designs: Vec<Values> = designs.iter().map(|design| self.values_of(design)).collect();
        self.results_of_all(&designs)
    }

    fn drawn_of_all(&self, designs: &[(Vec<f64>, u64)]) -> Vec<Option<Vec<f64>>> {
        let draw = |(design, number): &(Vec<f64>, u64)| self.chance.draw(&self.values_of(design), *number);
        let designs: Vec<Values> = designs.iter().map(draw).collect();
        self.results_of_all(&designs)
    }

    fn slopes(&self, design: &[f64]) -> Option<Vec<Vec<f64>>> {
        // Difference quotients along directions are accurate if these are as large as the parameters.
        let sizes: Vec<f64> = design
            .iter()
            .map(|value| if *value == 0.0 { 1.0 } else { *value })
            .collect();
        let directions: Vec<Vec<f64>> = (0..self.variables)
            .map(|variable| self.direction(variable, sizes[variable]))
            .collect();
        let found = self.ground.measure_with(&self.values_of(design), &directions).ok()?;
        let by_variable = |slopes: &Vec<f64>| slopes.iter().zip(&sizes).map(|(slope, size)| slope / size).collect();
        let mut slopes: Vec<Vec<f64>> = found.slopes.iter().map(by_variable).collect();
        let of_mean = |of: &Vec<usize>| {
            (0..self.variables)
                .map(|variable| mean(of.iter().map(|&at| slopes[at][variable])))
                .collect()
        };
        let means: Vec<Vec<f64>> = self.means.iter().map(of_mean).collect();
        slopes.extend(means);
        Some(slopes)
    }
}
