//! Finds the change at one place that explains the responses of all sensors best, line by line.
//!
//! A complex change q of a parameter changes each response by its derivative by that parameter times `q / (1 + q h)`,
//! where h is the compliance of the place. This scalar is fitted first, line by line. q follows from it. Unlike the
//! scalar, q is smooth near a mode.

use nalgebra::Complex;

use super::missing_stiffness::{MissingStiffness, Place, RunStiffness};
use super::same_line::same_line;
use super::straight::Straight;
use crate::discover::observe::{Evidence, Kind, Prediction, Series};
use crate::discover::posterior::Refit;
use crate::transmissibility::Point;

/// Lines on each side over which q is fitted by a straight line. A smooth law hardly curves over them, and noise
/// averages out.
const SMOOTH: usize = 2;

/// Direction of the response change.
pub enum Direction {
    /// Derivative by the parameter of this column.
    Slope(usize),
    /// Signal of one sensor.
    Sensor(Point),
}

/// First harmonics of all runs. Within a run, all sensors share one frequency grid.
pub struct Lines {
    runs: Vec<RunLines>,
}

struct RunLines {
    run: usize,
    level: f64,
    frequency: Vec<f64>,
    sensors: Vec<SensorLines>,
}

struct SensorLines {
    sensor: Point,
    sigma: Vec<f64>,
    residual: Vec<Complex<f64>>,
    reading: Vec<Complex<f64>>,
    slopes: Vec<Vec<Complex<f64>>>,
}

/// A value and its standard deviation.
type Estimate = (Complex<f64>, f64);

impl Lines {
    /// Residuals of the first harmonics after a refit; `predictions` are those of the refit.
    pub fn new(refit: &Refit, evidence: &Evidence, predictions: &[Prediction]) -> Self {
        let mut runs: Vec<RunLines> = Vec::new();
        for prediction in predictions {
            let series = &evidence.series[prediction.series];
            if series.kind != Kind::Harmonic(1) {
                continue;
            }
            let sensor = SensorLines::new(refit, evidence, series, prediction);
            match runs.iter_mut().find(|run| run.run == series.run) {
                Some(run) => run.sensors.push(sensor),
                None => runs.push(RunLines {
                    run: series.run,
                    level: evidence.runs[series.run].level,
                    frequency: series.at.clone(),
                    sensors: vec![sensor],
                }),
            }
        }
        Self { runs }
    }

    /// Sum of the squared normalised residuals.
    pub fn squared_residual(&self) -> f64 {
        let of_sensor = |sensor: &SensorLines| {
            let lines = sensor.residual.iter().zip(&sensor.sigma);
            lines
                .map(|(residual, sigma)| residual.norm_sqr() / (sigma * sigma))
                .sum::<f64>()
        };
        self.runs.iter().flat_map(|run| &run.sensors).map(of_sensor).sum()
    }

    /// All sensors, without duplicates.
    pub fn sensors(&self) -> Vec<Point> {
        let all = self.runs.iter().flat_map(|run| &run.sensors);
        let mut sensors: Vec<Point> = all.map(|sensor| sensor.sensor.clone()).collect();
        sensors.sort();
        sensors.dedup();
        sensors
    }

    /// Compliance h of a place for each run and line, from a finite `change` of its parameter.
    pub fn compliance(&self, column: usize, changed: &Lines, change: f64) -> Vec<Vec<Complex<f64>>> {
        let pairs = self.runs.iter().zip(&changed.runs);
        pairs
            .map(|(run, changed)| run.compliance(column, changed, change))
            .collect()
    }

    /// Zero compliance for each run and line.
    pub fn rigid(&self) -> Vec<Vec<Complex<f64>>> {
        self.runs
            .iter()
            .map(|run| vec![Complex::ZERO; run.frequency.len()])
            .collect()
    }

    /// Missing dynamic stiffness at a place; `unit` converts a parameter change to a dynamic stiffness.
    pub fn missing_stiffness(
        &self,
        place: Place,
        direction: &Direction,
        compliance: &[Vec<Complex<f64>>],
        unit: impl Fn(f64) -> Complex<f64>,
    ) -> MissingStiffness {
        let runs = self.runs.iter().zip(compliance);
        let each: Vec<Vec<Estimate>> = runs.map(|(run, h)| run.changes(direction, h)).collect();
        let common = self.mean(&each);
        MissingStiffness {
            place,
            ceiling: self.explained(direction, compliance, &each),
            common: self.explained(direction, compliance, &common),
            runs: self
                .runs
                .iter()
                .zip(&each)
                .map(|(run, changes)| run.missing_stiffness(changes, &unit))
                .collect(),
        }
    }

    /// For each line of each run, the weighted mean of the runs with a line at its frequency.
    fn mean(&self, each: &[Vec<Estimate>]) -> Vec<Vec<Estimate>> {
        let at = |frequency: &f64| {
            let mut sums = Straight::default();
            for (run, changes) in self.runs.iter().zip(each) {
                if let Some(line) = same_line(&run.frequency, *frequency) {
                    let (value, sigma) = changes[line];
                    sums.add(0.0, Complex::ONE, value, sigma);
                }
            }
            sums.solve()
        };
        let of_run = |run: &RunLines| run.frequency.iter().map(at).collect();
        self.runs.iter().map(of_run).collect()
    }

    /// Share of the squared residual that the changes explain.
    fn explained(&self, direction: &Direction, compliance: &[Vec<Complex<f64>>], changes: &[Vec<Estimate>]) -> f64 {
        let (mut left, mut all) = (0.0, 0.0);
        for ((run, h), changes) in self.runs.iter().zip(compliance).zip(changes) {
            for sensor in &run.sensors {
                let along = direction.of(sensor);
                for line in 0..run.frequency.len() {
                    let q = changes[line].0;
                    let explained = along.map_or(Complex::ZERO, |along| along[line] * q / (1.0 + q * h[line]));
                    let weight = sensor.sigma[line].powi(-2);
                    left += (sensor.residual[line] - explained).norm_sqr() * weight;
                    all += sensor.residual[line].norm_sqr() * weight;
                }
            }
        }
        1.0 - left / all
    }
}

impl Direction {
    fn of<'a>(&self, lines: &'a SensorLines) -> Option<&'a [Complex<f64>]> {
        match self {
            Direction::Slope(column) => Some(&lines.slopes[*column]),
            Direction::Sensor(sensor) => (lines.sensor == *sensor).then_some(&lines.reading),
        }
    }
}

impl SensorLines {
    fn new(refit: &Refit, evidence: &Evidence, series: &Series, prediction: &Prediction) -> Self {
        let reading = refit
            .nuisance
            .sensor_output(evidence, series, &prediction.value, &refit.coefficients);
        let through = |slope: &Vec<Complex<f64>>| slope.iter().zip(&reading.factor).map(|(s, f)| s * f).collect();
        let residual = series
            .value
            .iter()
            .zip(&reading.value)
            .map(|(measured, reading)| measured - reading);
        Self {
            sensor: series.sensor.clone(),
            sigma: series.sigma.clone(),
            residual: residual.collect(),
            slopes: prediction.slopes.iter().map(through).collect(),
            reading: reading.value,
        }
    }
}

impl RunLines {
    /// The change at each line that explains all sensors best, smoothed by a straight line through its neighbours.
    fn changes(&self, direction: &Direction, compliance: &[Complex<f64>]) -> Vec<Estimate> {
        let single: Vec<Estimate> = (0..self.frequency.len())
            .map(|line| {
                let (scalar, sigma) = self.scalar(line, direction);
                let less = 1.0 - scalar * compliance[line];
                (scalar / less, sigma / less.norm_sqr())
            })
            .collect();
        let smooth = |centre: usize| {
            let around = centre.saturating_sub(SMOOTH)..(centre + SMOOTH + 1).min(single.len());
            let mut sums = Straight::default();
            for (f, (value, sigma)) in self.frequency[around.clone()].iter().zip(&single[around]) {
                sums.add((f / self.frequency[centre]).ln(), Complex::ONE, *value, *sigma);
            }
            sums.solve()
        };
        (0..single.len()).map(smooth).collect()
    }

    fn scalar(&self, line: usize, direction: &Direction) -> Estimate {
        let mut sums = Straight::default();
        for sensor in &self.sensors {
            let Some(along) = direction.of(sensor) else { continue };
            sums.add(0.0, along[line], sensor.residual[line], sensor.sigma[line]);
        }
        sums.solve()
    }

    /// Compliance of each line: a finite change q makes the scalar `1 / (1/q + h)`.
    fn compliance(&self, column: usize, changed: &RunLines, change: f64) -> Vec<Complex<f64>> {
        let of_line = |line: usize| {
            let mut sums = Straight::default();
            for (sensor, changed) in self.sensors.iter().zip(&changed.sensors) {
                let difference = changed.reading[line] - sensor.reading[line];
                sums.add(0.0, sensor.slopes[column][line], difference, sensor.sigma[line]);
            }
            let scalar = sums.solve().0;
            if scalar == Complex::ZERO {
                Complex::ZERO
            } else {
                scalar.inv() - 1.0 / change
            }
        };
        (0..self.frequency.len()).map(of_line).collect()
    }

    fn missing_stiffness(&self, changes: &[Estimate], unit: impl Fn(f64) -> Complex<f64>) -> RunStiffness {
        let units: Vec<Complex<f64>> = self.frequency.iter().map(|&f| unit(f)).collect();
        RunStiffness {
            run: self.run,
            level: self.level,
            frequency: self.frequency.clone(),
            value: changes
                .iter()
                .zip(&units)
                .map(|((value, _), unit)| value * unit)
                .collect(),
            sigma: changes
                .iter()
                .zip(&units)
                .map(|((_, sigma), unit)| sigma * unit.norm())
                .collect(),
        }
    }
}
