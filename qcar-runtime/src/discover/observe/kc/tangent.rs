//! Forces of a K&C rig and their derivatives by parameters.
//!
//! The free states x of an instant solve `r(x, x_last, p) = 0`, an implicit Euler step. So their derivatives follow
//! from those of the last instant by the implicit function theorem, `-∂r/∂x dx = ∂r/∂x_last dx_last + ∂r/∂p`, with the
//! matrix of Newton's method at the solution.

use std::rc::Rc;

use nalgebra::DVector;

use super::bench::{Bench, Drive, Factor, Instant, Slope};
use crate::model::Model;

/// How often the way between two instants is halved at most: down to a thousandth of it. A choice.
const MOST_HALVINGS: usize = 10;
/// Relative change of a parameter for the derivative of the rig's mobility, a ratio of masses: the error of a central
/// difference is its square.
const SMALL: f64 = 1e-5;

impl Bench {
    /// Force on the wheel (N) at each instant of `path` that is read, and in further rows its derivatives along some
    /// directions: parameters that change together. The path begins at rest. The forces are NaN from the first instant
    /// whose states cannot be found, so that a fit rejects these parameters. `None` if a force on the wheel accelerates
    /// nothing.
    pub fn forces(
        &self,
        model: &dyn Model,
        p: &[f64],
        directions: &[Vec<usize>],
        path: &[Instant],
    ) -> Option<Vec<Vec<f64>>> {
        let mut drive = Drive::new(self, model, p)?;
        let tangents = directions.iter().map(|own| Tangent::new(&drive, own));
        let mut tangents = tangents.collect::<Option<Vec<Tangent>>>()?;
        let mut by_parameter = vec![0.0; model.about().parameter_jacobian.len()];
        let mut forces = vec![Vec::with_capacity(path.len()); 1 + directions.len()];
        let mut read = |drive: &mut Drive<'_>, part: &Instant| {
            let force = drive.force();
            if part.is_read {
                forces[0].push(force);
            }
            if tangents.is_empty() {
                return;
            }
            model.matrices(p, &drive.x, &drive.u, &mut drive.nonzeros);
            model.parameter_jacobian(p, &drive.x, &drive.u, &mut by_parameter);
            let factor = drive.factor(part.step);
            for (tangent, forces) in tangents.iter_mut().zip(&mut forces[1..]) {
                let slope = tangent.follow(drive, factor.as_ref(), &by_parameter, part.step);
                if part.is_read {
                    forces.push(slope);
                }
            }
        };
        let mut before = Instant::default();
        let is_followed = path.iter().all(|instant| {
            let before = std::mem::replace(&mut before, *instant);
            drive.advance(&before, instant, MOST_HALVINGS, &mut read)
        });
        if !is_followed {
            let count = path.iter().filter(|instant| instant.is_read).count();
            forces.iter_mut().for_each(|forces| forces.resize(count, f64::NAN));
        }
        Some(forces)
    }
}

/// Derivatives along one direction.
struct Tangent {
    /// Nonzeros of `∂f/∂p` of this direction in the row of each free state, and in that of the wheel: the state and the
    /// nonzero.
    of_free: Vec<(usize, usize)>,
    of_wheel: Vec<usize>,
    /// Derivatives of [`Bench::share`] for each free state, and of [`Bench::wheel_of`].
    shares: Vec<f64>,
    wheel_of_unit: f64,
    /// Derivatives of the free states.
    x: DVector<f64>,
}

impl Tangent {
    /// `None` if a force on the wheel accelerates nothing.
    fn new(drive: &Drive<'_>, direction: &[usize]) -> Option<Self> {
        let (bench, p) = (drive.bench, drive.p);
        let jacobian = drive.model.about().parameter_jacobian.iter().enumerate();
        let own = jacobian.filter(|(_, (is_output, _, by))| !is_output && direction.contains(&usize::from(*by)));
        let own: Vec<(usize, usize)> = own.map(|(nonzero, (_, row, _))| (usize::from(*row), nonzero)).collect();
        let of_row = |row: usize| own.iter().filter(move |own| own.0 == row).map(|own| own.1);
        let of_state = |(state, b): (usize, &super::bench::FreeState)| of_row(b.row()).map(move |own| (state, own));
        let change = SMALL * direction.iter().map(|&k| p[k].abs()).fold(0.0, f64::max);
        let moved = |by: f64| {
            let mut moved = p.to_vec();
            direction.iter().for_each(|&k| moved[k] += by);
            bench.of_unit_force(drive.model, &moved)
        };
        let (up, down) = (moved(change)?, moved(-change)?);
        let slope = |of: &dyn Fn(&[f64]) -> f64| match change {
            0.0 => 0.0,
            change => (of(&up) - of(&down)) / (2.0 * change),
        };
        Some(Self {
            of_free: bench.free.iter().enumerate().flat_map(of_state).collect(),
            of_wheel: of_row(bench.wheel_speed).collect(),
            shares: bench
                .free
                .iter()
                .map(|b| slope(&|of_unit| bench.share(of_unit, b)))
                .collect(),
            wheel_of_unit: slope(&|of_unit| bench.wheel_of(of_unit)),
            x: DVector::zeros(bench.free.len()),
        })
    }

    /// Moves the derivatives of the free states over `h` s, and returns that of the rig's force.
    fn follow(&mut self, drive: &Drive<'_>, factor: Option<&Rc<Factor>>, by_parameter: &[f64], h: f64) -> f64 {
        let bench = drive.bench;
        // A change that the states keep from the last instant shifts both ends of the step, so it changes no speed.
        let mut rates = DVector::zeros(bench.free.len());
        for of in bench.slopes.iter().filter(|of| !of.of_speed) {
            rates[of.row] += drive.nonzeros[of.entry] * self.x[of.column];
        }
        for &(state, nonzero) in &self.of_free {
            rates[state] += by_parameter[nonzero];
        }
        let of_places = |of: &Slope| drive.nonzeros[of.entry] * self.x[of.column];
        let places = bench.of_wheel.iter().filter(|of| !of.of_speed).map(of_places);
        let parameters = self.of_wheel.iter().map(|&nonzero| by_parameter[nonzero]);
        let of_wheel: f64 = places.chain(parameters).sum();
        let wheel = drive.dx[bench.wheel_speed];
        for ((b, rate), share) in bench.free.iter().zip(&mut rates).zip(&self.shares) {
            *rate = match b.speed {
                Some(_) => bench.share(&drive.of_unit, b) * of_wheel + share * wheel - *rate,
                None => h * *rate,
            };
        }
        let step = factor.and_then(|factor| factor.solve(rates));
        let step = step.unwrap_or_else(|| DVector::zeros(bench.free.len()));
        self.x += &step;
        let of_step = |of: &Slope| drive.nonzeros[of.entry] * step[of.column] * if of.of_speed { 1.0 / h } else { 1.0 };
        let of_wheel = of_wheel + bench.of_wheel.iter().map(of_step).sum::<f64>();
        let by_unit = drive.wheel_of_unit();
        (wheel * self.wheel_of_unit / by_unit - of_wheel) / by_unit
    }
}
