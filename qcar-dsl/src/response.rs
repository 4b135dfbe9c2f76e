//! Frequency response by sparse elimination at compile time.
//!
//! The unknowns are the amplitudes of all coordinates that are not prescribed, Z(ω) = K + jωC - ω²M is symmetric, and
//! one factorisation gives every response H and, by its adjoint, every parameter derivative. For the dynamic stiffness
//! κ of a link with stretch s, `∂H(y,u)/∂κ = -H(y,F) H(s,u)`: the response of the output to a pair of forces on the
//! link's ends, times the stretch that the excitation causes.

use crate::about::Source;
use crate::check::Checked;
use crate::combination::combine;
use crate::complex::Complex;
use crate::elimination::{Factors, Scalar, Symmetric, outer};
use crate::expr::{CoordinateId, Differential, Expr, Graph, LinkId, Symbol};
use crate::model::{CoordinateKind, Quantity, Signal};
use crate::motion::directions;
use crate::stiffness::{self, Stiffness};

/// The response of the outputs to one excitation of unit amplitude, nonzeros only.
#[derive(Clone, Debug)]
pub struct Response {
    /// What is excited.
    pub source: Source,
    /// Place of the output, response.
    pub outputs: Vec<(u16, Complex)>,
    /// Place in `outputs`, parameter, derivative.
    pub jacobian: Vec<(u16, u16, Complex)>,
}

/// The response of a linear model to each of its excitations.
pub fn responses(model: &Checked, graph: &mut Graph) -> Vec<Response> {
    let system = System::assemble(model, graph);
    sources(model)
        .into_iter()
        .map(|source| system.respond(graph, source))
        .collect()
}

/// What excites a model: of each direction its prescribed motions, then its forces.
pub fn sources(model: &Checked) -> Vec<Source> {
    let coordinate = |c: CoordinateId| &model.coordinates[c.0 as usize];
    let mut sources = Vec::new();
    for direction in directions(model) {
        let all = (0..model.coordinates.len() as u16).map(CoordinateId);
        let prescribed = all.filter(|&c| {
            coordinate(c).direction == direction
                && matches!(coordinate(c).kind, CoordinateKind::Road | CoordinateKind::Motion)
        });
        sources.extend(prescribed.map(Source::Motion));
        let forces = model.forces.iter().enumerate();
        let forces = forces.filter(|(_, force)| force.direction == direction);
        sources.extend(forces.map(|(i, _)| Source::Force(i as u16)));
    }
    sources
}

/// The model at one frequency.
struct System<'a> {
    model: &'a Checked,
    links: Vec<Stiffness>,
    /// Over all coordinates, prescribed ones included.
    impedance: Symmetric<Complex>,
    /// The amplitude of each coordinate for a unit force on each; zero for prescribed ones.
    compliance: Vec<Vec<Complex>>,
    /// What each force input does to the coordinates.
    loads: Vec<Load>,
    /// What changes with each parameter.
    changes: Vec<Change>,
}

/// The force on each coordinate for a unit of a force input, while nothing moves.
type Load = Vec<(usize, Complex)>;

/// What changes with one parameter.
struct Change {
    links: Vec<LinkChange>,
    inertias: Vec<(usize, Expr)>,
    /// The loads of the force inputs.
    loads: Vec<Load>,
}

/// How a link changes with a parameter.
struct LinkChange {
    link: usize,
    stiffness: Complex,
    stretch: Vec<(CoordinateId, Expr)>,
    /// Of the forces that force inputs have in its law.
    inputs: Vec<(u16, Complex)>,
}

/// An output: a factor times a combination of amplitudes.
struct Functional {
    /// (jω)ⁿ or the dynamic stiffness of a link.
    factor: Complex,
    combination: Vec<(CoordinateId, Expr)>,
    /// The link whose stretch the combination is.
    stretch_of: Option<usize>,
    /// True where the factor is the dynamic stiffness of that link.
    is_force: bool,
}

impl<'a> System<'a> {
    fn assemble(model: &'a Checked, g: &mut Graph) -> Self {
        let links = (0..model.links.len()).map(|l| stiffness::of_link(model, g, LinkId(l as u16)));
        let links: Vec<Stiffness> = links.collect();
        let impedance = impedance(model, g, &links);
        let compliance = compliance(model, g, &impedance);
        let loads: Vec<Load> = (0..model.forces.len())
            .map(|i| load(model, g, &links, i as u16))
            .collect();
        let changes = (0..model.parameters.len())
            .map(|p| change(model, g, &links, &loads, p as u16))
            .collect();
        System {
            model,
            links,
            impedance,
            compliance,
            loads,
            changes,
        }
    }

    fn respond(&self, g: &mut Graph, source: Source) -> Response {
        let amplitudes = self.amplitudes(g, source);
        let (mut outputs, mut jacobian) = (Vec::new(), Vec::new());
        for (y, output) in self.model.outputs.iter().enumerate() {
            let functional = self.functional(g, &output.signal);
            let scaled: Vec<Complex> = amplitudes.iter().map(|a| functional.factor.mul(g, *a)).collect();
            let moved = along(g, &functional.combination, &scaled);
            let value = match functional.input(&self.links, source) {
                Some(force) => moved.add(g, force),
                None => moved,
            };
            if value.is_zero(g) {
                continue;
            }
            let adjoint = self.adjoint(g, &functional);
            for (p, change) in self.changes.iter().enumerate() {
                let indirect = self.derivative(g, &adjoint, &scaled, change);
                let direct = functional.derivative(g, source, &amplitudes, &scaled, change);
                let mut derivative = indirect.add(g, direct);
                if let Source::Force(i) = source {
                    let loaded = through_load(g, &adjoint, &change.loads[i as usize]).mul(g, functional.factor);
                    derivative = derivative.add(g, loaded);
                }
                if !derivative.is_zero(g) {
                    jacobian.push((outputs.len() as u16, p as u16, derivative));
                }
            }
            outputs.push((y as u16, value));
        }
        Response {
            source,
            outputs,
            jacobian,
        }
    }

    fn amplitudes(&self, g: &mut Graph, source: Source) -> Vec<Complex> {
        let all = 0..self.compliance.len();
        match source {
            Source::Force(i) => {
                let load = &self.loads[i as usize];
                self.compliance.iter().map(|row| through_load(g, row, load)).collect()
            }
            Source::Motion(CoordinateId(r)) => {
                let r = r as usize;
                let forces: Vec<_> = all
                    .clone()
                    .filter_map(|c| Some((c, self.impedance.get(c, r)?)))
                    .collect();
                let mut amplitudes = Vec::with_capacity(self.compliance.len());
                for c in all {
                    let start = if c == r { Complex::one(g) } else { Complex::zero(g) };
                    amplitudes.push(forces.iter().fold(start, |sum, &(k, force)| {
                        let share = self.compliance[c][k].mul(g, force);
                        sum.sub(g, share)
                    }));
                }
                amplitudes
            }
        }
    }

    fn functional(&self, g: &mut Graph, signal: &Signal) -> Functional {
        let stretch = |l: LinkId| self.model.links[l.0 as usize].stretch.clone();
        let one = Complex::one(g);
        match *signal {
            Signal::Motion(c, quantity) => {
                let combination = vec![(c, one.re)];
                Functional {
                    factor: order(g, quantity),
                    combination,
                    stretch_of: None,
                    is_force: false,
                }
            }
            Signal::LinkStretch(l) => {
                let stretch_of = Some(l.0 as usize);
                Functional {
                    factor: one,
                    combination: stretch(l),
                    stretch_of,
                    is_force: false,
                }
            }
            Signal::LinkForce(l) => {
                let (factor, stretch_of) = (self.links[l.0 as usize].total, Some(l.0 as usize));
                Functional {
                    factor,
                    combination: stretch(l),
                    stretch_of,
                    is_force: true,
                }
            }
        }
    }

    /// The combination's response to a unit force on each coordinate.
    fn adjoint(&self, g: &mut Graph, functional: &Functional) -> Vec<Complex> {
        self.compliance
            .iter()
            .map(|row| along(g, &functional.combination, row))
            .collect()
    }

    /// How the scaled amplitudes under the adjoint change because links and inertias do.
    fn derivative(&self, g: &mut Graph, adjoint: &[Complex], scaled: &[Complex], change: &Change) -> Complex {
        let mut sum = Complex::zero(g);
        for link in &change.links {
            let term = self.through_link(g, adjoint, scaled, link);
            sum = sum.add(g, term);
        }
        let omega = g.symbol(Symbol::Frequency);
        let square = g.powi(omega, 2);
        for &(c, inertia) in &change.inertias {
            let acceleration = scaled[c].scale(g, square);
            let response = adjoint[c].mul(g, acceleration);
            let term = response.scale(g, inertia);
            sum = sum.add(g, term);
        }
        sum
    }

    /// `-d(κ s sᵀ)` between adjoint and amplitudes. What does not hold the adjoint is common to all outputs.
    fn through_link(&self, g: &mut Graph, adjoint: &[Complex], scaled: &[Complex], change: &LinkChange) -> Complex {
        let stretch = &self.model.links[change.link].stretch;
        let opening = along(g, stretch, adjoint);
        let pull = along(g, stretch, scaled).neg(g);
        if change.stretch.is_empty() {
            return opening.mul(g, pull).mul(g, change.stiffness);
        }
        let total = self.links[change.link].total;
        let force = total.mul(g, pull);
        let turned = along(g, &change.stretch, scaled).mul(g, total);
        let stiffened = pull.mul(g, change.stiffness).sub(g, turned);
        let first = along(g, &change.stretch, adjoint).mul(g, force);
        let second = opening.mul(g, stiffened);
        first.add(g, second)
    }
}

impl Functional {
    /// What a force input adds to the force of a link by itself.
    fn input(&self, links: &[Stiffness], source: Source) -> Option<Complex> {
        let link = self.stretch_of.filter(|_| self.is_force)?;
        by_source(&links[link].inputs, source)
    }

    /// How the output changes because its own factor and combination do.
    fn derivative(
        &self,
        g: &mut Graph,
        source: Source,
        amplitudes: &[Complex],
        scaled: &[Complex],
        change: &Change,
    ) -> Complex {
        let Some(own) = change.links.iter().find(|link| Some(link.link) == self.stretch_of) else {
            return Complex::zero(g);
        };
        let turned = along(g, &own.stretch, scaled);
        if !self.is_force {
            return turned;
        }
        let stiffened = along(g, &self.combination, amplitudes).mul(g, own.stiffness);
        let moved = turned.add(g, stiffened);
        match by_source(&own.inputs, source) {
            Some(pushed) => moved.add(g, pushed),
            None => moved,
        }
    }
}

/// The entry of a force input.
fn by_source(inputs: &[(u16, Complex)], source: Source) -> Option<Complex> {
    let found = inputs.iter().find(|(input, _)| Source::Force(*input) == source);
    found.map(|&(_, value)| value)
}

/// `Σ value(coordinate) force`
fn through_load(g: &mut Graph, values: &[Complex], load: &Load) -> Complex {
    let zero = Complex::zero(g);
    load.iter().fold(zero, |sum, &(c, force)| {
        let share = values[c].mul(g, force);
        sum.add(g, share)
    })
}

/// What an input pushes by itself, less what the laws resist that it drives.
fn load(model: &Checked, g: &mut Graph, links: &[Stiffness], input: u16) -> Load {
    let pushed = model.forces[input as usize].on.iter();
    let mut load: Load = pushed
        .map(|&(c, share)| (c.0 as usize, Complex::real(g, share)))
        .collect();
    for (link, parts) in model.links.iter().zip(links) {
        let Some(force) = by_source(&parts.inputs, Source::Force(input)) else {
            continue;
        };
        for &(c, coefficient) in &link.stretch {
            let push = force.scale(g, coefficient).neg(g);
            match load.iter_mut().find(|(other, _)| *other == c.0 as usize) {
                Some((_, sum)) => *sum = sum.add(g, push),
                None => load.push((c.0 as usize, push)),
            }
        }
    }
    load
}

/// (jω)ⁿ
fn order(g: &mut Graph, quantity: Quantity) -> Complex {
    let omega = g.symbol(Symbol::Frequency);
    let (zero, square) = (g.constant(0.0), g.powi(omega, 2));
    match quantity {
        Quantity::Position => Complex::one(g),
        Quantity::Velocity => Complex { re: zero, im: omega },
        Quantity::Acceleration => Complex {
            re: g.neg(square),
            im: zero,
        },
    }
}

/// `Σ coefficient value(coordinate)`
fn along(g: &mut Graph, combination: &[(CoordinateId, Expr)], values: &[Complex]) -> Complex {
    let terms = combination
        .iter()
        .map(|&(c, coefficient)| (coefficient, values[c.0 as usize]));
    combine(g, terms)
}

fn inertia(model: &Checked, c: usize) -> Option<Expr> {
    match model.coordinates[c].kind {
        CoordinateKind::Mass(inertia) => Some(inertia),
        _ => None,
    }
}

/// K + jωC - ω²M, and what inner states add. K, C and M are summed first: they depend on the parameters alone.
fn impedance(model: &Checked, g: &mut Graph, links: &[Stiffness]) -> Symmetric<Complex> {
    let n = model.coordinates.len();
    let (mut stiffness, mut damping, mut mass) = (Symmetric::new(n), Symmetric::new(n), Symmetric::new(n));
    let mut impedance = Symmetric::new(n);
    for c in 0..n {
        if let Some(inertia) = inertia(model, c) {
            mass.add(g, c, c, inertia);
        }
    }
    for (link, parts) in model.links.iter().zip(links) {
        let held: Vec<(usize, Expr)> = link
            .stretch
            .iter()
            .map(|&(c, coefficient)| (c.0 as usize, coefficient))
            .collect();
        stiffness.add_outer(g, &held, parts.stiffness);
        damping.add_outer(g, &held, parts.damping);
        mass.add_outer(g, &held, parts.inertance);
        for (i, j, incidence) in outer(g, &held) {
            let relaxation = parts.relaxation.scale(g, incidence);
            impedance.add(g, i, j, relaxation);
        }
    }
    let omega = g.symbol(Symbol::Frequency);
    let square = g.powi(omega, 2);
    let zero = g.constant(0.0);
    for (matrix, factor) in [
        (stiffness, Complex::one(g)),
        (
            mass,
            Complex {
                re: g.neg(square),
                im: zero,
            },
        ),
        (damping, Complex { re: zero, im: omega }),
    ] {
        for (i, j, value) in matrix.iter() {
            let entry = factor.scale(g, value);
            impedance.add(g, i, j, entry);
        }
    }
    impedance
}

fn compliance(model: &Checked, g: &mut Graph, impedance: &Symmetric<Complex>) -> Vec<Vec<Complex>> {
    let n = model.coordinates.len();
    let free = |c: &usize| {
        !matches!(
            model.coordinates[*c].kind,
            CoordinateKind::Road | CoordinateKind::Motion
        )
    };
    let unknowns: Vec<usize> = (0..n).filter(free).collect();
    let inverse = Factors::of(g, impedance.restricted(&unknowns)).inverse(g);
    let mut compliance = vec![vec![Complex::zero(g); n]; n];
    for (row, &i) in unknowns.iter().enumerate() {
        for (column, &j) in unknowns.iter().enumerate() {
            compliance[i][j] = inverse[row][column];
        }
    }
    compliance
}

fn change(model: &Checked, g: &mut Graph, links: &[Stiffness], loads: &[Load], parameter: u16) -> Change {
    let mut by = Differential::by(g, Symbol::Parameter(parameter));
    let mut changed = Vec::new();
    for (link, parts) in links.iter().enumerate() {
        let stiffness = parts.total.derivative(g, &mut by);
        let slopes = model.links[link]
            .stretch
            .iter()
            .map(|&(c, coefficient)| (c, by.of(g, coefficient)));
        let mut stretch: Vec<(CoordinateId, Expr)> = slopes.collect();
        stretch.retain(|&(_, slope)| !slope.is_zero(g));
        let slopes = parts.inputs.iter();
        let mut inputs: Vec<_> = slopes
            .map(|&(input, force)| (input, force.derivative(g, &mut by)))
            .collect();
        inputs.retain(|(_, slope)| !slope.is_zero(g));
        if !stiffness.is_zero(g) || !stretch.is_empty() || !inputs.is_empty() {
            changed.push(LinkChange {
                link,
                stiffness,
                stretch,
                inputs,
            });
        }
    }
    let mut inertias = Vec::new();
    for c in 0..model.coordinates.len() {
        if let Some(inertia) = inertia(model, c) {
            inertias.push((c, by.of(g, inertia)));
        }
    }
    inertias.retain(|&(_, slope)| !slope.is_zero(g));
    let mut slope = |load: &Load| -> Load {
        let slopes = load.iter().map(|&(c, force)| (c, force.derivative(g, &mut by)));
        slopes.collect()
    };
    let loads = loads.iter().map(&mut slope).collect();
    Change {
        links: changed,
        inertias,
        loads,
    }
}
