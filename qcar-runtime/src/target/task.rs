//! Limits of results, and the design variables that may change to meet them.

use rayon::prelude::*;

/// Results of designs, which have a value for each design variable.
pub trait Designs: Sync {
    /// The results of a design; `None` if it has none.
    fn values(&self, design: &[f64]) -> Option<Vec<f64>>;

    /// The derivatives of each result by each design variable.
    fn slopes(&self, design: &[f64]) -> Option<Vec<Vec<f64>>>;

    /// True if a design's results are certain; otherwise [`Designs::drawn`] gives random draws of them.
    fn is_certain(&self) -> bool {
        true
    }

    /// The results of a design in the draw of this number; `None` if it has none.
    fn drawn(&self, design: &[f64], _number: u64) -> Option<Vec<f64>> {
        self.values(design)
    }

    /// [`Designs::values`] of each of several designs, in parallel.
    fn values_of_all(&self, designs: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        designs.par_iter().map(|design| self.values(design)).collect()
    }

    /// [`Designs::drawn`] of each of several designs with the number of its draw, in parallel.
    fn drawn_of_all(&self, designs: &[(Vec<f64>, u64)]) -> Vec<Option<Vec<f64>>> {
        designs
            .par_iter()
            .map(|(design, number)| self.drawn(design, *number))
            .collect()
    }
}

/// A parameter that may change, or several that change with it.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignVariable {
    /// Name for messages.
    pub name: String,
    /// Lower end of its range.
    pub lower: f64,
    /// Upper end, above the lower one.
    pub upper: f64,
    /// Present value.
    pub today: f64,
    /// Distance of available values, counted from the lower end; `None` if every value is available.
    pub step: Option<f64>,
    /// Cost of a move over the whole range; it grows with the square of the move.
    pub cost: f64,
}

/// A limit of a result.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Index of the result.
    pub result: usize,
    /// The admissible side of the value.
    pub sense: Sense,
    /// The limit, in the unit of the result.
    pub value: f64,
    /// For a wish, the cost of missing it by its own size; `None` for a limit that must hold.
    pub wish: Option<f64>,
    /// Margin for the uncertainty of the result, in its unit.
    pub margin: f64,
}

/// The admissible side of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Results below it.
    AtMost,
    /// Results above it.
    AtLeast,
}

/// A sum of design variables that must not exceed a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Coefficient of each design variable.
    pub factors: Vec<f64>,
    /// Largest value of the sum.
    pub most: f64,
}

/// Relative excess up to which a limit counts as met: it reads like the limit if four digits are printed.
pub const TOLERANCE: f64 = 5e-5;

/// True if an excess counts as none.
pub fn is_met(excess: f64) -> bool {
    excess <= TOLERANCE
}

/// A task: designs with their variables, limits and couplings.
#[derive(Clone)]
pub struct Task<'a> {
    /// The designs.
    pub designs: &'a dyn Designs,
    /// The design variables.
    pub variables: Vec<DesignVariable>,
    /// The limits.
    pub limits: Vec<Limit>,
    /// Couplings between design variables.
    pub couplings: Vec<Coupling>,
}

impl Limit {
    /// Violation of the limit with its margin, relative to the size of the limit; at most zero if it is met.
    pub fn excess(&self, value: f64) -> f64 {
        (self.sign() * (value - self.value) + self.margin) / self.size()
    }

    /// Derivative of the violation.
    pub fn slope(&self, slope: f64) -> f64 {
        self.sign() * slope / self.size()
    }

    /// True if both limits must hold for one result, one as a lower and one as an upper limit.
    fn bounds_from_the_other_side(&self, other: &Limit) -> bool {
        self.result == other.result && self.sense != other.sense && self.wish.is_none() && other.wish.is_none()
    }

    /// 1 if a larger result is worse, -1 if it is better.
    pub fn sign(&self) -> f64 {
        match self.sense {
            Sense::AtMost => 1.0,
            Sense::AtLeast => -1.0,
        }
    }

    fn size(&self) -> f64 {
        if self.value == 0.0 { 1.0 } else { self.value.abs() }
    }
}

impl DesignVariable {
    /// The value at a fraction of the range, 0 to 1.
    pub fn at(&self, place: f64) -> f64 {
        self.lower + place * self.span()
    }

    /// The fraction of the range at which a value lies.
    pub fn place(&self, value: f64) -> f64 {
        ((value - self.lower) / self.span()).clamp(0.0, 1.0)
    }

    /// Length of the range.
    pub fn span(&self) -> f64 {
        self.upper - self.lower
    }

    /// The nearest available value.
    pub fn available(&self, value: f64) -> f64 {
        let last = |step: f64| (self.span() / step + 1e-9).floor();
        let nearest = |step: f64| self.lower + step * ((value - self.lower) / step).round().clamp(0.0, last(step));
        self.step.map_or(value, nearest)
    }
}

impl Coupling {
    /// Violation by a design, relative to the size of the sum.
    pub fn excess(&self, design: &[f64], variables: &[DesignVariable]) -> f64 {
        (self.sum(design) - self.most) / self.size(variables)
    }

    /// The sum for a design.
    pub fn sum(&self, design: &[f64]) -> f64 {
        let pairs = self.factors.iter().zip(design);
        pairs.map(|(factor, value)| factor * value).sum()
    }

    /// Derivative of the violation by a design variable.
    pub fn slope(&self, variable: usize, variables: &[DesignVariable]) -> f64 {
        self.factors[variable] / self.size(variables)
    }

    fn size(&self, variables: &[DesignVariable]) -> f64 {
        let terms = self
            .factors
            .iter()
            .zip(variables)
            .map(|(factor, variable)| (factor * variable.upper).abs().max((factor * variable.lower).abs()));
        terms.fold(f64::MIN_POSITIVE, f64::max)
    }
}

impl Task<'_> {
    /// The same task without margins, for random results.
    #[must_use]
    pub fn without_margins(&self) -> Self {
        let mut own = self.clone();
        own.limits.iter_mut().for_each(|limit| limit.margin = 0.0);
        own
    }

    /// The design at these positions of its variables, 0 to 1.
    pub fn design(&self, places: &[f64]) -> Vec<f64> {
        self.variables
            .iter()
            .zip(places)
            .map(|(variable, place)| variable.at(*place))
            .collect()
    }

    /// Positions of a design's variables in their ranges, 0 to 1.
    pub fn places(&self, design: &[f64]) -> Vec<f64> {
        self.variables
            .iter()
            .zip(design)
            .map(|(variable, value)| variable.place(*value))
            .collect()
    }

    /// The nearest design of available values.
    pub fn available(&self, design: &[f64]) -> Vec<f64> {
        self.variables
            .iter()
            .zip(design)
            .map(|(variable, value)| variable.available(*value))
            .collect()
    }

    /// The present design, moved into the ranges.
    pub fn today(&self) -> Vec<f64> {
        self.variables
            .iter()
            .map(|variable| variable.today.clamp(variable.lower, variable.upper))
            .collect()
    }

    /// Cost of a design.
    pub fn cost(&self, design: &[f64]) -> f64 {
        let moves = self.variables.iter().zip(design);
        moves
            .map(|(variable, value)| variable.cost * ((value - variable.today) / variable.span()).powi(2))
            .sum()
    }

    /// Violation of each limit, then of each coupling, by a design with these results.
    pub fn excesses(&self, design: &[f64], values: &[f64]) -> Vec<f64> {
        let limits = self.limits.iter().map(|limit| limit.excess(values[limit.result]));
        limits
            .chain(
                self.couplings
                    .iter()
                    .map(|coupling| coupling.excess(design, &self.variables)),
            )
            .collect()
    }

    /// True if all limits and couplings that must hold are met.
    pub fn holds(&self, excess: &[f64]) -> bool {
        self.hard(excess).all(|(_, excess)| is_met(excess))
    }

    /// Sum of the violations of all limits and couplings that must hold, each with its margin.
    pub fn broken(&self, excess: &[f64], margins: &[f64]) -> f64 {
        self.hard(excess)
            .map(|(at, excess)| (excess + margins[at]).max(0.0))
            .sum()
    }

    /// Distance inside each limit and coupling at which the search aims: `most`, or half of the room that an opposite
    /// limit leaves.
    pub fn margins(&self, most: f64) -> Vec<f64> {
        let room = |limit: &Limit| {
            let opposite = self
                .limits
                .iter()
                .filter(|other| other.bounds_from_the_other_side(limit));
            let gaps = opposite.map(|other| -limit.excess(other.value));
            gaps.fold(f64::INFINITY, f64::min)
        };
        let limits = self.limits.iter().map(|limit| most.min(0.5 * room(limit).max(0.0)));
        limits.chain(self.couplings.iter().map(|_| most)).collect()
    }

    /// Violations of the limits and couplings that must hold, with their positions.
    fn hard(&self, excess: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let all = excess.iter().copied().enumerate();
        all.filter(|(at, _)| self.wish(*at).is_none())
    }

    /// Cost of missed wishes.
    pub fn missed(&self, excess: &[f64]) -> f64 {
        let wishes = excess
            .iter()
            .enumerate()
            .filter_map(|(at, excess)| Some(self.wish(at)? * excess.max(0.0)));
        wishes.sum()
    }

    /// Cost of missing a limit or coupling by its own size; `None` if it must hold.
    pub fn wish(&self, at: usize) -> Option<f64> {
        self.limits.get(at).and_then(|limit| limit.wish)
    }

    /// True if a design has results and meets all that must hold.
    pub fn is_good(&self, design: &[f64]) -> bool {
        let values = self.designs.values(design);
        values.is_some_and(|values| self.holds(&self.excesses(design, &values)))
    }
}
