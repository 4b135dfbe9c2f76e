//! The periodic response of a nonlinear model to a sine: harmonic balance.
//!
//! Every state that the excitation reaches is a Fourier series; the equations of motion hold in their first harmonics,
//! found by sampling the laws over a period (T. M. Cameron and J. H. Griffin, "An alternating frequency/time domain
//! method", J. Appl. Mech. 56, 1989). Newton's method solves them with the model's own matrices, and the same
//! factorisation gives every parameter derivative.

// Small matrices.
mod product;
// Fourier series in terms of their samples.
mod basis;
// A model evaluated at the samples of one period.
mod period;
// The nonlinear part of the balance's Jacobian.
mod factors;
// The harmonic balance at one excitation, and its solution.
mod balance;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use crate::model::{InputKind, Matrix, Model, Quantity};
use balance::{Balance, Found};
use basis::Basis;

/// The periodic responses of a model to one excitation.
pub struct Periodic<'m> {
    model: &'m dyn Model,
    excitation: usize,
    /// The states that depend on the excitation.
    states: Vec<usize>,
    basis: Arc<Basis>,
}

/// A sine: `Re A exp(jωt)` of the excitation itself or one of its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Amplitude of the measured derivative of the excitation.
    pub amplitude: f64,
    /// Order of the derivative of the excitation that is measured: 2 for an acceleration.
    pub power: i32,
}

/// Which way the frequency of a sweep goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// From low to high frequencies.
    Rising,
    /// From high to low frequencies.
    Falling,
}

/// A periodic response.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Fourier coefficients of the states, from which the next search may start.
    pub coefficients: Vec<f64>,
    /// False if the search did not converge; the response is then that of its best point.
    pub converged: bool,
    /// The requested outputs, in ascending order.
    outputs: Vec<usize>,
    /// Amplitudes of their harmonics, a column for each output, and after these for each of their derivatives.
    harmonics: DMatrix<Complex<f64>>,
}

/// Results for outputs, given by their positions in `y`.
///
/// # Panics
/// If the output was not requested.
impl Cycle {
    /// Amplitudes of the harmonics from 0, relative in phase to the excitation.
    pub fn output(&self, output: usize) -> &[Complex<f64>] {
        self.column(0, output)
    }

    /// Derivatives of these amplitudes along a group of parameters.
    pub fn slope(&self, group: usize, output: usize) -> &[Complex<f64>] {
        self.column(1 + group, output)
    }

    /// Derivatives of these amplitudes by the logarithm of the drive's amplitude, if there are groups of parameters.
    pub fn louder(&self, output: usize) -> &[Complex<f64>] {
        self.column(self.harmonics.ncols() / self.outputs.len() - 1, output)
    }

    fn column(&self, along: usize, output: usize) -> &[Complex<f64>] {
        let place = self.outputs.partition_point(|&own| own < output);
        assert!(self.outputs.get(place) == Some(&output), "an output that was asked for");
        let (first, rows) = (along * self.outputs.len() + place, self.harmonics.nrows());
        &self.harmonics.as_slice()[first * rows..][..rows]
    }
}

impl<'m> Periodic<'m> {
    /// Prepares for responses in which states have `harmonics` harmonics.
    pub fn new(model: &'m dyn Model, excitation: usize, harmonics: usize) -> Self {
        Self {
            model,
            excitation,
            states: moved(model, excitation),
            basis: Basis::shared(harmonics),
        }
    }

    /// The response of `outputs` (positions in `y`) for the parameters `p`. It is differentiated along each of
    /// `groups`, which are parameters that change together.
    ///
    /// Searches from `start`, or from rest; if that fails, through a series of smaller amplitudes.
    pub fn cycle(
        &self,
        p: &[f64],
        drive: &Drive,
        outputs: &[usize],
        groups: &[Vec<usize>],
        start: Option<&[f64]>,
    ) -> Cycle {
        let mut balance = self.balance(p);
        let found = self.settled(&mut balance, drive, start);
        self.response(&mut balance, found, &each_once(outputs), groups)
    }

    /// The states for a drive. The balance may have had another drive before.
    fn settled(&self, balance: &mut Balance, drive: &Drive, start: Option<&[f64]>) -> Found {
        let rest = vec![0.0; self.states.len() * self.basis.terms()];
        self.drive(balance, drive);
        let found = balance.solve(start.unwrap_or(&rest));
        if found.converged {
            return found;
        }
        match self.climb(balance, drive, rest) {
            Some(coefficients) => Found {
                coefficients,
                converged: true,
                is_direct: false,
            },
            None => {
                self.drive(balance, drive);
                found
            }
        }
    }

    /// The response with the states that a search has found.
    fn response(
        &self,
        balance: &mut Balance,
        Found {
            coefficients,
            converged,
            ..
        }: Found,
        outputs: &[usize],
        groups: &[Vec<usize>],
    ) -> Cycle {
        balance.sample(&coefficients);
        let mut series = balance.outputs(outputs).as_slice().to_vec();
        if !groups.is_empty() {
            series.extend_from_slice(balance.slopes(outputs, groups).as_slice());
        }
        Cycle {
            coefficients,
            converged,
            outputs: outputs.to_vec(),
            harmonics: self.basis.harmonics(&series),
        }
    }

    /// The responses to those drives whose positions are in `of`, in ascending order, of drives of increasing frequency.
    /// The search for each drive starts from the response at the next higher frequency.
    ///
    /// At high frequencies masses hardly move and laws are nearly linear, so the search converges there and continues
    /// downwards. From rest, it would often fail at low frequencies. Further drives between them would make it converge
    /// no more often.
    ///
    /// Where several periodic responses exist, as of a hardening spring, those of a falling frequency are found. If
    /// `course` is rising, those of a rising one take their place (A. H. Nayfeh and D. T. Mook, "Nonlinear
    /// Oscillations", section 4.1).
    pub fn walk(
        &self,
        p: &[f64],
        drives: &[Drive],
        course: Course,
        of: &BTreeSet<usize>,
        outputs: &[usize],
        groups: &[Vec<usize>],
    ) -> Vec<Cycle> {
        let (mut balance, outputs) = (self.balance(p), each_once(outputs));
        let mut cycles: BTreeMap<usize, Cycle> = BTreeMap::new();
        let mut jumps = Vec::new();
        for &place in of.iter().rev() {
            let above = cycles.first_key_value().map(|(_, above)| above);
            let start = above.map(|above| above.coefficients.as_slice());
            let found = self.settled(&mut balance, &drives[place], start);
            if !found.is_direct && start.is_some_and(|above| self.has_jumped(&found.coefficients, above)) {
                jumps.push(place);
            }
            cycles.insert(place, self.response(&mut balance, found, &outputs, groups));
        }
        if course == Course::Rising {
            for &place in jumps.iter().rev() {
                self.rise(&mut balance, drives, place, &mut cycles, (&outputs, groups));
            }
        }
        cycles.into_values().collect()
    }

    /// Follows a response to higher drives as long as it exists and differs from those of a falling frequency, which it
    /// replaces. It takes each drive in between, because a response near a resonance changes much from one to the next.
    fn rise(
        &self,
        balance: &mut Balance,
        drives: &[Drive],
        from: usize,
        cycles: &mut BTreeMap<usize, Cycle>,
        (outputs, groups): (&[usize], &[Vec<usize>]),
    ) {
        let mut x = cycles[&from].coefficients.clone();
        for (place, drive) in drives.iter().enumerate().skip(from + 1) {
            self.drive(balance, drive);
            let next = balance.solve(&x);
            if !next.converged {
                return;
            }
            x.clone_from(&next.coefficients);
            if let Some(falling) = cycles.get_mut(&place) {
                if falling.converged && self.is_same(&x, &falling.coefficients) {
                    return;
                }
                *falling = self.response(balance, next, outputs, groups);
            }
        }
    }

    /// True if the amplitude of a state differs by more than a factor of two, as after a jump to another branch. All lines
    /// of a sweep are 2 to 3 % apart, and a linear resonance doubles from one to the next only if its damping ratio is below
    /// 2 %. Those of coarse data are further apart, so resonances pass too, which costs time alone: [`Self::rise`] then
    /// ends at the next compared line.
    fn has_jumped(&self, a: &[f64], b: &[f64]) -> bool {
        let [a, b] = [a, b].map(|x| self.amplitudes(x));
        a.zip(b).any(|(a, b)| a > 2.0 * b || b > 2.0 * a)
    }

    /// True if two responses agree to a thousandth of the amplitude of each state.
    fn is_same(&self, a: &[f64], b: &[f64]) -> bool {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        let differences = self.amplitudes(&difference);
        differences.zip(self.amplitudes(b)).all(|(off, b)| off <= 1e-3 * b)
    }

    /// Largest harmonic coefficient of each state.
    fn amplitudes<'x>(&self, x: &'x [f64]) -> impl Iterator<Item = f64> + use<'x, 'm> {
        let largest = |series: &[f64]| series[1..].iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        x.chunks(self.basis.terms()).map(largest)
    }

    /// Increases the amplitude from a small one, at which every smooth law is linear, to the required one. `None` if the
    /// search fails at one of the amplitudes: at larger ones it then fails too, with few exceptions.
    fn climb(&self, balance: &mut Balance, drive: &Drive, rest: Vec<f64>) -> Option<Vec<f64>> {
        const STEPS: i32 = 12;
        const RATIO: f64 = 2.0;
        (0..=STEPS).rev().try_fold(rest, |mut x, step| {
            let amplitude = drive.amplitude * RATIO.powi(-step);
            // To first order, the response grows with the amplitude.
            x.iter_mut().for_each(|x| *x *= RATIO);
            self.drive(balance, &Drive { amplitude, ..*drive });
            let found = balance.solve(&x);
            found.converged.then_some(found.coefficients)
        })
    }

    fn balance(&self, p: &[f64]) -> Balance<'_> {
        Balance::new(self.model, p, &self.states, &self.basis)
    }

    fn drive(&self, balance: &mut Balance, drive: &Drive) {
        let omega = TAU * drive.frequency;
        let phasor = drive.amplitude / Complex::new(0.0, omega).powi(drive.power);
        balance.drive(omega, self.inputs(phasor, omega));
    }

    /// A row for each sample of a period, a column for each input.
    fn inputs(&self, phasor: Complex<f64>, omega: f64) -> DMatrix<f64> {
        let inputs = &self.model.about().inputs;
        let turns = (0..self.basis.samples()).map(|k| phasor * self.basis.turn(k));
        let turns: Vec<Complex<f64>> = turns.collect();
        let rate = Complex::new(0.0, omega);
        DMatrix::from_fn(turns.len(), inputs.len(), |k, input| match inputs[input].kind {
            InputKind::Force(place) if usize::from(place) == self.excitation => turns[k].re,
            InputKind::Motion(place, quantity) if usize::from(place) == self.excitation => match quantity {
                Quantity::Position => turns[k].re,
                Quantity::Velocity => (turns[k] * rate).re,
                Quantity::Acceleration => (turns[k] * rate * rate).re,
            },
            _ => 0.0,
        })
    }
}

/// The requested outputs in ascending order, without duplicates.
fn each_once(outputs: &[usize]) -> Vec<usize> {
    BTreeSet::from_iter(outputs).into_iter().copied().collect()
}

/// The states that depend on the excitation, by the nonzeros of A and B.
fn moved(model: &dyn Model, excitation: usize) -> Vec<usize> {
    let about = model.about();
    let drives = |column: u16| match about.inputs[usize::from(column)].kind {
        InputKind::Force(place) | InputKind::Motion(place, _) => usize::from(place) == excitation,
        InputKind::Gravity => false,
    };
    let mut moves = vec![false; about.states.len()];
    // After as many rounds as there are states, all dependent states are found.
    for _ in 0..=about.states.len() {
        for entry in about.matrices.iter() {
            let from = match entry.matrix {
                Matrix::A => moves[usize::from(entry.column)],
                Matrix::B => drives(entry.column),
                Matrix::C | Matrix::D => continue,
            };
            moves[usize::from(entry.row)] |= from;
        }
    }
    (0..moves.len()).filter(|&state| moves[state]).collect()
}
