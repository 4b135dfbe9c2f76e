//! The harmonic responses of a model about a point, with their derivatives by the parameters, by dense elimination.

use std::collections::BTreeMap;

use super::Scratch;
use super::dual::{Complex, Dual, solve};
use super::sample::{Kind, Point, Values};
use super::slopes::Slopes;
use super::stiffness::{coupled, driven, dynamic_stiffness};
use crate::expr::{CoordinateId, Expr, LinkId};
use crate::model::{CoordinateKind, Quantity, Reference, Signal};

/// Angular frequencies for numbers near 1.
const PLAIN: [f64; 6] = [0.3, 0.7, 1.1, 1.9, 3.1, 5.3];
/// Angular frequencies for declared values, rad/s.
const DECLARED: [f64; 6] = [5.0, 11.0, 23.0, 47.0, 80.0, 160.0];

/// Responses below this part of the largest are roundoff.
const ROUNDOFF: f64 = 1e-12;

/// How something that can be seen changes with the estimated parameters.
pub struct Seen {
    /// Its size.
    pub value: f64,
    /// Its derivatives; empty where it depends on none.
    pub gradient: Vec<Complex>,
}

impl Seen {
    fn new(dual: Dual) -> Seen {
        Seen {
            value: dual.value.abs().max(f64::MIN_POSITIVE),
            gradient: dual.gradient,
        }
    }
}

/// Everything that can be seen of a model at one parameter set: responses of outputs and channels to each input, and
/// for laws that are not linear the change of the force itself, in so many motions. The parameters are in order.
pub fn sensitivities(scratch: &Scratch, point: Point, motions: u64, estimated: &[u16]) -> Vec<Seen> {
    let is_nonlinear = scratch.slopes.iter().any(|slopes| slopes.nonlinear);
    let has_clock = scratch.model.parameters.iter().any(|parameter| parameter.clock);
    let motions = if is_nonlinear || has_clock { motions } else { 1 };
    let frequencies = if point.kind == Kind::Plain { PLAIN } else { DECLARED };
    let mut seen = Vec::new();
    for motion in 0..motions {
        let point = point.moved(motion);
        let leaf = |symbol| point.leaf(symbol);
        let values = Values::new(&scratch.graph, &leaf);
        let at = At {
            scratch,
            values: &values,
            estimated,
        };
        for frequency in frequencies {
            at.look(frequency, &mut seen);
        }
    }
    seen
}

/// A model at a point.
struct At<'a> {
    scratch: &'a Scratch<'a>,
    values: &'a Values<'a>,
    estimated: &'a [u16],
}

/// The motion of every coordinate, and what each link does, under one input.
struct Excited {
    coordinates: Vec<Dual>,
    points: Vec<Dual>,
    stretches: Vec<Dual>,
    forces: Vec<Dual>,
}

impl At<'_> {
    fn dual(&self, e: Expr) -> Dual {
        let mut dual = Dual::constant(Complex::real(self.values.of(e)));
        for &(parameter, derivative) in self.scratch.gradient(e) {
            if let Ok(place) = self.estimated.binary_search(&parameter) {
                dual.gradient.resize(self.estimated.len(), Complex::default());
                dual.gradient[place] = Complex::real(self.values.of(derivative));
            }
        }
        dual
    }

    /// Adds what is seen at a frequency.
    fn look(&self, frequency: f64, seen: &mut Vec<Seen>) {
        let model = self.scratch.model;
        let stiffnesses: Vec<Dual> = self
            .scratch
            .slopes
            .iter()
            .map(|slopes| dynamic_stiffness(slopes, &|e| self.dual(e), frequency))
            .collect();
        for (drive, excited) in self.excite(&stiffnesses, frequency) {
            if let Drive::Inside(link) = drive {
                self.look_at_law(link, &excited, frequency, seen);
                continue;
            }
            let responses = model
                .outputs
                .iter()
                .map(|output| excited.response(&output.signal, frequency));
            add_relative(responses.collect(), seen);
            let ratios = model.channels.iter().filter_map(|channel| {
                let above = excited.response(&channel.numerator, frequency);
                match &channel.denominator {
                    Reference::Signal(signal) => Some(above.over(&excited.response(signal, frequency))),
                    Reference::Force(place) => (drive == Drive::Force(usize::from(*place))).then_some(above),
                }
            });
            add_relative(ratios.collect(), seen);
        }
    }

    /// A law that is not linear is also seen by its force: a parameter of it need not change a slope. What only
    /// shifts the place of rest is seen by nothing but the force itself.
    fn look_at_law(&self, link: usize, excited: &Excited, frequency: f64, seen: &mut Vec<Seen>) {
        let slopes = &self.scratch.slopes[link];
        let outputs = &self.scratch.model.outputs;
        let reached = |signal: &Signal| excited.response(signal, frequency).value.abs() > ROUNDOFF;
        let force = self.with_rates(link, self.dual(slopes.force));
        if outputs.iter().any(|output| is_force_of(&output.signal, link)) {
            seen.push(Seen::new(force));
        } else if slopes.nonlinear && outputs.iter().any(|output| reached(&output.signal)) {
            seen.push(Seen::new(force.minus(&self.dual(slopes.rest))));
        }
    }

    /// A force with what the rates of the inner states do to it.
    fn with_rates(&self, link: usize, force: Dual) -> Dual {
        let inner = &self.scratch.model.links[link].law.inner;
        inner
            .iter()
            .zip(&self.scratch.slopes[link].inner)
            .fold(force, |force, (inner, slopes)| {
                let change = self.dual(inner.rate).scaled(self.dual(slopes.force).value);
                force.plus(&change)
            })
    }

    /// The answers to a unit of each input, and to a unit of force inside each link that asks for it.
    fn excite(&self, stiffnesses: &[Dual], frequency: f64) -> Vec<(Drive, Excited)> {
        let stretches = self.stretches();
        let mut system = System::new(self.free(), self.drives(), &Dual::constant(Complex::default()));
        for (c, coordinate) in self.scratch.model.coordinates.iter().enumerate() {
            if let CoordinateKind::Mass(mass) = coordinate.kind {
                system.add(c, c, &self.dual(mass).scaled(Complex::real(-frequency * frequency)));
            }
        }
        for (link, stretch) in stretches.iter().enumerate() {
            for (c, own) in stretch {
                let pull = own.times(&stiffnesses[link]);
                stretch
                    .iter()
                    .for_each(|(other, coefficient)| system.add(*c, *other, &pull.times(coefficient)));
                system.push(Drive::Inside(link), *c, &own.scaled(Complex::real(-1.0)));
            }
        }
        let coupled = self.coupled(frequency);
        for (link, other, stiffness) in &coupled {
            for (c, own) in &stretches[*link] {
                let pull = own.times(stiffness);
                let others = stretches[*other].iter();
                others.for_each(|(moved, coefficient)| system.add(*c, *moved, &pull.times(coefficient)));
            }
        }
        for (index, force) in self.scratch.model.forces.iter().enumerate() {
            for &(c, share) in &force.on {
                system.push(Drive::Force(index), usize::from(c.0), &self.dual(share));
            }
        }
        let driven: Vec<(usize, usize, Dual)> = self.driven(frequency);
        for (link, input, force) in &driven {
            for (c, own) in &stretches[*link] {
                let resisted = own.times(force).scaled(Complex::real(-1.0));
                system.push(Drive::Force(*input), *c, &resisted);
            }
        }
        let excited = |(drive, mut motion): (Drive, BTreeMap<usize, Dual>)| {
            if let Drive::Motion(own) = drive {
                motion.insert(own, Dual::constant(Complex::real(1.0)));
            }
            let mut excited = self.excited(motion, &stretches, stiffnesses);
            for (link, _, force) in driven.iter().filter(|(_, input, _)| drive == Drive::Force(*input)) {
                excited.forces[*link] = excited.forces[*link].plus(force);
            }
            for (link, other, stiffness) in &coupled {
                let force = stiffness.times(&excited.stretches[*other]);
                excited.forces[*link] = excited.forces[*link].plus(&force);
            }
            (drive, excited)
        };
        system.solve().into_iter().map(excited).collect()
    }

    /// What force inputs do in laws: the link, the input, the force of the link for a unit of it.
    fn driven(&self, frequency: f64) -> Vec<(usize, usize, Dual)> {
        let laws = self.scratch.slopes.iter().enumerate();
        let of = |(link, slopes): (usize, &Slopes)| {
            let forces = driven(slopes, &|e| self.dual(e), frequency).into_iter();
            forces
                .map(move |(input, force)| (link, usize::from(input), force))
                .collect::<Vec<_>>()
        };
        laws.flat_map(of).collect()
    }

    /// What stretches of other links do in laws: the link, the other, the force of the link for a unit of that stretch.
    fn coupled(&self, frequency: f64) -> Vec<(usize, usize, Dual)> {
        let laws = self.scratch.slopes.iter().enumerate();
        let of = |(link, slopes): (usize, &Slopes)| {
            let forces = coupled(slopes, &|e| self.dual(e), frequency).into_iter();
            forces
                .map(move |(other, force)| (link, other, force))
                .collect::<Vec<_>>()
        };
        laws.flat_map(of).collect()
    }

    fn free(&self) -> Vec<usize> {
        (0..self.scratch.model.coordinates.len())
            .filter(|&c| !self.is_prescribed(c))
            .collect()
    }

    fn is_prescribed(&self, coordinate: usize) -> bool {
        let kind = self.scratch.model.coordinates[coordinate].kind;
        matches!(kind, CoordinateKind::Road | CoordinateKind::Motion)
    }

    fn stretches(&self) -> Vec<Stretch> {
        let links = self.scratch.model.links.iter();
        links.map(|link| self.along(&link.stretch)).collect()
    }

    fn along(&self, combination: &[(CoordinateId, Expr)]) -> Stretch {
        let of = |(id, coefficient): &(CoordinateId, Expr)| (usize::from(id.0), self.dual(*coefficient));
        combination.iter().map(of).collect()
    }

    /// The inputs, and the insides of laws that are looked at.
    fn drives(&self) -> Vec<Drive> {
        let model = self.scratch.model;
        let motions = (0..model.coordinates.len())
            .filter(|&c| self.is_prescribed(c))
            .map(Drive::Motion);
        let forces = (0..model.forces.len()).map(Drive::Force);
        let is_seen = |link: &usize| model.outputs.iter().any(|output| is_force_of(&output.signal, *link));
        let looked_at = |link: &usize| self.scratch.slopes[*link].nonlinear || is_seen(link);
        motions
            .chain(forces)
            .chain((0..model.links.len()).filter(looked_at).map(Drive::Inside))
            .collect()
    }

    fn excited(&self, motion: BTreeMap<usize, Dual>, stretches: &[Stretch], stiffnesses: &[Dual]) -> Excited {
        let still = Dual::constant(Complex::default());
        let moved = |c: usize| motion.get(&c).unwrap_or(&still).clone();
        let coordinates: Vec<Dual> = (0..self.scratch.model.coordinates.len()).map(moved).collect();
        let stretch = |parts: &Stretch| {
            parts.iter().fold(still.clone(), |sum, (c, coefficient)| {
                sum.plus(&coefficient.times(&coordinates[*c]))
            })
        };
        let points = self.scratch.model.points.iter();
        let points = points.map(|point| stretch(&self.along(&point.combination)));
        let points = points.collect();
        let stretches: Vec<Dual> = stretches.iter().map(stretch).collect();
        let forces = stretches
            .iter()
            .zip(stiffnesses)
            .map(|(stretch, stiffness)| stretch.times(stiffness))
            .collect();
        Excited {
            coordinates,
            points,
            stretches,
            forces,
        }
    }
}

/// Coordinates with their coefficients.
type Stretch = Vec<(usize, Dual)>;

fn is_force_of(signal: &Signal, link: usize) -> bool {
    matches!(signal, Signal::LinkForce(id) if usize::from(id.0) == link)
}

/// The balance of forces of the free coordinates, with a right side for each drive.
struct System {
    free: Vec<usize>,
    matrix: Vec<Vec<Dual>>,
    columns: Vec<(Drive, Vec<Dual>)>,
}

impl System {
    fn new(free: Vec<usize>, drives: Vec<Drive>, zero: &Dual) -> System {
        let column = vec![zero.clone(); free.len()];
        let matrix = vec![column.clone(); free.len()];
        System {
            free,
            matrix,
            columns: drives.into_iter().map(|drive| (drive, column.clone())).collect(),
        }
    }

    fn place(&self, coordinate: usize) -> Option<usize> {
        self.free.iter().position(|&free| free == coordinate)
    }

    /// A coordinate resists the motion of another; where that is prescribed, it is pushed instead.
    fn add(&mut self, coordinate: usize, other: usize, resistance: &Dual) {
        let Some(row) = self.place(coordinate) else { return };
        match self.place(other) {
            Some(column) => self.matrix[row][column] = self.matrix[row][column].plus(resistance),
            None => self.push(
                Drive::Motion(other),
                coordinate,
                &resistance.scaled(Complex::real(-1.0)),
            ),
        }
    }

    /// A drive pushes a coordinate.
    fn push(&mut self, drive: Drive, coordinate: usize, force: &Dual) {
        let Some(row) = self.place(coordinate) else { return };
        if let Some((_, column)) = self.columns.iter_mut().find(|(own, _)| *own == drive) {
            column[row] = column[row].plus(force);
        }
    }

    /// The motion of the free coordinates under each drive.
    fn solve(self) -> Vec<(Drive, BTreeMap<usize, Dual>)> {
        let (drives, columns): (Vec<Drive>, Vec<Vec<Dual>>) = self.columns.into_iter().unzip();
        let motions = solve(self.matrix, columns).into_iter();
        let named = motions.map(|motion| self.free.iter().copied().zip(motion).collect());
        drives.into_iter().zip(named).collect()
    }
}

/// What moves a model.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Drive {
    /// A prescribed motion.
    Motion(usize),
    /// A force input.
    Force(usize),
    /// A force inside a link, which is none of the inputs.
    Inside(usize),
}

impl Excited {
    fn response(&self, signal: &Signal, frequency: f64) -> Dual {
        match signal {
            Signal::Motion(CoordinateId(c), quantity) => {
                differentiated(&self.coordinates[usize::from(*c)], *quantity, frequency)
            }
            Signal::Point(place, quantity) => differentiated(&self.points[usize::from(*place)], *quantity, frequency),
            Signal::LinkForce(LinkId(l)) => self.forces[usize::from(*l)].clone(),
            Signal::LinkStretch(LinkId(l)) => self.stretches[usize::from(*l)].clone(),
        }
    }
}

fn differentiated(position: &Dual, quantity: Quantity, frequency: f64) -> Dual {
    let rate = Complex::imaginary(frequency);
    match quantity {
        Quantity::Position => position.clone(),
        Quantity::Velocity => position.scaled(rate),
        Quantity::Acceleration => position.scaled(rate * rate),
    }
}

/// Responses relative to their size; what is roundoff against the largest says nothing.
fn add_relative(responses: Vec<Dual>, seen: &mut Vec<Seen>) {
    let finite = |dual: &Dual| dual.value.abs().is_finite();
    let responses: Vec<Dual> = responses.into_iter().filter(finite).collect();
    let largest = responses
        .iter()
        .fold(0.0_f64, |largest, response| largest.max(response.value.abs()));
    let heard = responses
        .into_iter()
        .filter(|response| response.value.abs() > ROUNDOFF * largest);
    seen.extend(heard.map(Seen::new));
}
