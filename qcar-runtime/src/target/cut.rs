//! Slices around a box: good and bad designs in the plane of two design variables.

use super::space::Space;
use super::task::{Task, is_met};
use crate::random::SplitMix;

/// Designs over the whole ranges of two design variables, with all others anywhere in the box.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Positions of the design variables.
    pub variables: [usize; 2],
    /// The designs.
    pub dots: Vec<Dot>,
}

/// A design in the plane of two design variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    /// Values of both design variables.
    pub at: [f64; 2],
    /// Position of the limit or coupling that is exceeded most; `None` if all are met.
    pub broken: Option<usize>,
}

/// Draws `count` designs with random results.
pub fn cut(task: &Task<'_>, space: &Space, variables: [usize; 2], count: usize, seed: u64) -> Cut {
    let points = SplitMix::new(seed).hypercube(count, task.variables.len());
    let task = task.without_margins();
    let design = |(number, point): (usize, Vec<f64>)| {
        let value = |k: usize| match variables.contains(&k) {
            true => task.variables[k].at(point[k]),
            false => space.intervals[k][0] + point[k] * (space.intervals[k][1] - space.intervals[k][0]),
        };
        ((0..point.len()).map(value).collect(), number as u64)
    };
    let designs: Vec<(Vec<f64>, u64)> = points.into_iter().enumerate().map(design).collect();
    let results = task.designs.drawn_of_all(&designs);
    let dot = |((design, _), values): ((Vec<f64>, u64), Option<Vec<f64>>)| {
        let excess = task.excesses(&design, &values?);
        let most = excess
            .iter()
            .enumerate()
            .filter(|(at, _)| task.wish(*at).is_none())
            .max_by(|a, b| a.1.total_cmp(b.1));
        let broken = most.filter(|(_, excess)| !is_met(**excess)).map(|(at, _)| at);
        Some(Dot {
            at: variables.map(|k| design[k]),
            broken,
        })
    };
    Cut {
        variables,
        dots: designs.into_iter().zip(results).filter_map(dot).collect(),
    }
}
