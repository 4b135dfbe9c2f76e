//! Linear systems that forces drive, in steps of one length: an exponential Adams method.
//!
//! In `dx/dt = A x + B f(t, x)` what is linear is integrated exactly, however fast it decays or vibrates. The forces are
//! taken from the polynomial through their past; one evaluation at the end of a step tells how far that is off, which
//! corrects the step and judges it. M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19 (2010),
//! section 2.5, with the correction of the predictor-corrector pairs in Hairer, Nørsett, Wanner, III.1.

use std::array;

use super::matrix::{Lanes, Matrix, Panel};
use crate::vectors::{Loops, widest};

/// A linear system `dx/dt = A x + B f(t, x)`, and the forces `f` that drive it.
pub trait Driven<const F: usize> {
    /// Writes `dx = A x + B force`.
    fn rate(&self, x: &[f64], force: [f64; F], dx: &mut [f64]);

    /// The forces at time `t`; none where they are not smooth any more.
    fn force(&mut self, t: f64, x: &[f64]) -> Option<[f64; F]>;
}

/// The forces at so many points of the past make the polynomial that extrapolates them.
pub const PAST: usize = 5;

/// The integrator, with the state and the past of the forces.
pub struct ExponentialAdams<const F: usize> {
    /// What the next state is of each entry of `from`: columns of four rows, block of rows by block of rows.
    propagator: Vec<Lanes>,
    /// How each state is corrected for a unit of each force that was not foreseen.
    corrections: [Vec<f64>; F],
    /// How much of that is by the last point of the past, without which the polynomial would be one order lower: the
    /// error that is judged.
    errors: [Vec<f64>; F],
    /// The state, and behind it the forces, those of the last point first.
    from: Vec<f64>,
    /// The next state, as it is foreseen.
    ahead: Vec<f64>,
    states: usize,
}

impl<const F: usize> ExponentialAdams<F> {
    /// For steps of `step` (s) of a system of `states` states. None where a system moves so much within a step that the
    /// series of its exponential is of no use.
    pub fn new(system: &impl Driven<F>, states: usize, step: f64) -> Option<Self> {
        widest(Construction::<_, F> { system, states, step })
    }

    #[inline(always)]
    fn build(system: &impl Driven<F>, states: usize, step: f64) -> Option<Self> {
        const { assert!(F <= 4, "the forces are the lanes of one panel") };
        let matrix = matrix(system, states, step);
        let panels = matrix.exponential()?;
        let [_, means @ ..]: [_; PAST + 2] = matrix.means(answers(system, states, step))?;
        let weighted = |polynomial: &Polynomial, force: usize, state: usize| -> f64 {
            let terms = polynomial.iter().zip(&means);
            terms.map(|(weight, mean)| weight * mean[state][force]).sum()
        };
        let of_states = |polynomial, force| (0..states).map(|state| weighted(polynomial, force, state)).collect();
        let columns = (states + F * PAST).next_multiple_of(4);
        let entry = |row: usize, column: usize| match column.checked_sub(states) {
            _ if row >= states => 0.0,
            None => panels[column / 4][row][column % 4],
            Some(past) if past < F * PAST => weighted(&THROUGH[past / F], past % F, row),
            Some(_) => 0.0,
        };
        let block = |first| (0..columns).map(move |column| array::from_fn(|lane| entry(first + lane, column)));
        Some(Self {
            propagator: (0..states).step_by(4).flat_map(block).collect(),
            corrections: array::from_fn(|force| of_states(&UNFORESEEN, force)),
            errors: array::from_fn(|force| of_states(&LAST_ORDER, force)),
            from: vec![0.0; columns],
            ahead: vec![0.0; states.next_multiple_of(4)],
            states,
        })
    }

    /// Begins at state `x` with the forces of points a step apart, the present ones last.
    pub fn begin(&mut self, x: &[f64], past: &[[f64; F]; PAST]) {
        let (state, forces) = self.from.split_at_mut(self.states);
        state.copy_from_slice(x);
        for (known, force) in forces.chunks_exact_mut(F).zip(past.iter().rev()) {
            known.copy_from_slice(force);
        }
    }

    /// Steps to time `t`, and says whether it did: where the forces are not smooth, or the error is more than `relative`
    /// of a state and `absolute`, all stays as it was.
    #[inline(always)]
    pub fn advance(&mut self, system: &mut impl Driven<F>, t: f64, relative: f64, absolute: &[f64]) -> bool {
        widest(Product {
            blocks: &self.propagator,
            by: &self.from,
            result: &mut self.ahead,
        });
        let ahead = &mut self.ahead[..self.states];
        let Some(force) = system.force(t, ahead) else {
            return false;
        };
        let past = &self.from[self.states..];
        let off: [f64; F] = array::from_fn(|f| {
            let foreseen = EXTRAPOLATION
                .iter()
                .enumerate()
                .map(|(point, weight)| weight * past[point * F + f]);
            force[f] - foreseen.sum::<f64>()
        });
        let n = ahead.len();
        let (absolute, corrections) = (&absolute[..n], self.corrections.each_ref().map(|c| &c[..n]));
        let errors = self.errors.each_ref().map(|e| &e[..n]);
        let mut missed = 0.0;
        for i in 0..n {
            let by = |weights: [&[f64]; F]| (0..F).fold(0.0, |sum, f| sum + weights[f][i] * off[f]);
            // What is not a number is not within the tolerance either.
            let within = by(errors).abs() <= absolute[i] + relative * ahead[i].abs();
            missed += if within { 0.0 } else { 1.0 };
            ahead[i] += by(corrections);
        }
        let good = missed == 0.0;
        if good {
            let last = self.states + F * PAST;
            self.from.copy_within(self.states..last - F, self.states + F);
            self.from[..self.states].copy_from_slice(ahead);
            self.from[self.states..][..F].copy_from_slice(&force);
        }
        good
    }

    /// The state.
    pub fn state(&self) -> &[f64] {
        &self.from[..self.states]
    }
}

/// The matrix A times the step.
fn matrix<const F: usize>(system: &impl Driven<F>, states: usize, step: f64) -> Matrix {
    let columns: Vec<Vec<f64>> = (0..states)
        .map(|i| {
            let (mut unit, mut rate) = (vec![0.0; states], vec![0.0; states]);
            unit[i] = step;
            system.rate(&unit, [0.0; F], &mut rate);
            rate
        })
        .collect();
    Matrix::new(states, |row, column| columns[column][row])
}

/// The matrix B times the step, a column for each force.
fn answers<const F: usize>(system: &impl Driven<F>, states: usize, step: f64) -> Panel {
    let rest = vec![0.0; states];
    let columns: [Vec<f64>; F] = array::from_fn(|force| {
        let mut rate = vec![0.0; states];
        system.rate(
            &rest,
            array::from_fn(|f| if f == force { step } else { 0.0 }),
            &mut rate,
        );
        rate
    });
    let row = |row: usize| array::from_fn(|lane| columns.get(lane).map_or(0.0, |column| column[row]));
    (0..states).map(row).collect()
}

/// Coefficients of the powers of the part of a step that is over.
type Polynomial = [f64; PAST + 1];

/// One at a point of the past and zero at all others; they lie at 0, -1, -2, ….
const THROUGH: [Polynomial; PAST] = through();
/// What the forces turn out to be more than foreseen: zero at the points of the past and one at the end of the step.
const UNFORESEEN: Polynomial = rising(0.0);
/// By how much it would be less if the last point of the past were left out of the polynomial.
const LAST_ORDER: Polynomial = rising(-1.0);

const fn through() -> [Polynomial; PAST] {
    let mut all = [[0.0; PAST + 1]; PAST];
    let mut point = 0;
    while point < PAST {
        all[point][0] = 1.0;
        let mut other = 0;
        while other < PAST {
            if other != point {
                all[point] = times(&all[point], other as f64, other as f64 - point as f64);
            }
            other += 1;
        }
        point += 1;
    }
    all
}

/// `(s + first) (s + first + 1) … / PAST!` of as many factors.
const fn rising(first: f64) -> Polynomial {
    let mut product = [0.0; PAST + 1];
    product[0] = 1.0;
    let mut i = 0;
    while i < PAST {
        product = times(&product, first + i as f64, (i + 1) as f64);
        i += 1;
    }
    product
}

/// A polynomial times `(s + root) / over`.
const fn times(polynomial: &Polynomial, root: f64, over: f64) -> Polynomial {
    let mut product = [0.0; PAST + 1];
    let mut i = 0;
    while i <= PAST {
        let shifted = if i == 0 { 0.0 } else { polynomial[i - 1] };
        product[i] = (shifted + root * polynomial[i]) / over;
        i += 1;
    }
    product
}

/// How the polynomial through the past goes on for a step: binomial coefficients with alternating signs.
const EXTRAPOLATION: [f64; PAST] = [5.0, -10.0, 10.0, -5.0, 1.0];

/// The construction with its arguments: its sums gain by wide vectors.
struct Construction<'a, D, const F: usize> {
    system: &'a D,
    states: usize,
    step: f64,
}

impl<D: Driven<F>, const F: usize> Loops for Construction<'_, D, F> {
    type Result = Option<ExponentialAdams<F>>;

    #[inline(always)]
    fn run(self) -> Self::Result {
        ExponentialAdams::build(self.system, self.states, self.step)
    }
}

/// A matrix in blocks times a vector, whose length is a multiple of four.
struct Product<'a> {
    blocks: &'a [Lanes],
    by: &'a [f64],
    result: &'a mut [f64],
}

impl Loops for Product<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let factors = self.by.as_chunks::<4>().0;
        let blocks = self.blocks.chunks_exact(self.by.len());
        for (result, block) in self.result.as_chunks_mut::<4>().0.iter_mut().zip(blocks) {
            // Four sums, none of which waits for the others.
            let mut sums = [[0.0; 4]; 4];
            for (columns, factors) in block.as_chunks::<4>().0.iter().zip(factors) {
                for k in 0..4 {
                    for lane in 0..4 {
                        sums[k][lane] += columns[k][lane] * factors[k];
                    }
                }
            }
            *result = array::from_fn(|lane| (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]));
        }
    }
}
