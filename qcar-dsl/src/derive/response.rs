//! Frequency response by sparse elimination at compile time.
//!
//! The unknowns are the amplitudes of all coordinates that are not prescribed, Z(ω) = K + jωC - ω²M is symmetric, and
//! one factorisation gives every response H and, by its adjoint, every parameter derivative. For the dynamic stiffness
//! κ of a link with stretch s, `∂H(y,u)/∂κ = -H(y,F) H(s,u)`: the response of the output to a pair of forces on the
//! link's ends, times the stretch that the excitation causes. A large model with fewer parameters than outputs is
//! solved for the derivative of all amplitudes by each parameter instead.

// Loads by force inputs.
mod load;
// Derivatives of the dynamic stiffness by a parameter.
mod change;
// Outputs as linear functions of the amplitudes.
mod functional;
// Amplitudes under unit loads.
mod compliance;

use std::collections::BTreeMap;

use crate::check::Checked;
use crate::derive::complex::Complex;
use crate::derive::elimination::{Scalar, Symmetric, outer};
use crate::derive::motion::directions;
use crate::derive::stiffness::{self, Stiffness};
use crate::derive::vectors::ExcitationSource;
use crate::expr::{CoordinateId, Expr, Graph, LinkId, Symbol};
use crate::model::CoordinateKind;

use change::{Change, LinkChange, change, inertia};
use compliance::Compliance;
use functional::{Functional, along};
use load::{Load, load, through_load};

/// The response of the outputs to one excitation of unit amplitude, nonzeros only.
#[derive(Clone, Debug)]
pub struct Response {
    /// What is excited.
    pub source: ExcitationSource,
    /// Place of the output, response.
    pub outputs: Vec<(u16, Complex)>,
    /// Place in `outputs`, parameter, derivative.
    pub jacobian: Vec<(u16, u16, Complex)>,
}

/// Wanted parts of a response.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Wanted<'a> {
    /// No response.
    Nothing,
    /// Values only, without the Jacobian.
    Values,
    /// Values of all outputs, and the derivatives of those at these places by the parameters.
    JacobianOf(&'a [u16]),
    /// Values and derivatives by the parameters.
    Jacobian,
}

impl Wanted<'_> {
    /// True if the derivatives of an output by the parameters are wanted.
    fn has_jacobian_of(self, output: u16) -> bool {
        match self {
            Wanted::Nothing | Wanted::Values => false,
            Wanted::JacobianOf(outputs) => outputs.contains(&output),
            Wanted::Jacobian => true,
        }
    }
}

/// The response of a linear model to each of its excitations.
pub fn responses(model: &Checked, graph: &mut Graph, wanted: Wanted) -> Vec<Response> {
    if wanted == Wanted::Nothing {
        return Vec::new();
    }
    let system = System::assemble(model, graph, wanted);
    sources(model)
        .into_iter()
        .map(|source| system.respond(graph, source))
        .collect()
}

/// Excitations of a model: in each direction its prescribed motions, then its forces.
pub fn sources(model: &Checked) -> Vec<ExcitationSource> {
    let coordinate = |c: CoordinateId| &model.coordinates[c.0 as usize];
    let mut sources = Vec::new();
    for direction in directions(model) {
        let all = (0..model.coordinates.len() as u16).map(CoordinateId);
        let prescribed = all.filter(|&c| {
            coordinate(c).direction == direction
                && matches!(coordinate(c).kind, CoordinateKind::Road | CoordinateKind::Motion)
        });
        sources.extend(prescribed.map(ExcitationSource::Motion));
        let forces = model.forces.iter().enumerate();
        let forces = forces.filter(|(_, force)| force.direction == direction);
        sources.extend(forces.map(|(i, _)| ExcitationSource::Force(i as u16)));
    }
    sources
}

/// The model at one frequency.
struct System<'a> {
    model: &'a Checked,
    links: Vec<Stiffness>,
    /// Over all coordinates, prescribed ones included.
    impedance: Symmetric<Complex>,
    compliance: Compliance,
    /// Effect of each force input on the coordinates.
    loads: Vec<Load>,
    /// Changes by each parameter; empty if no derivatives are wanted.
    changes: Vec<Change>,
    wanted: Wanted<'a>,
}

impl<'a> System<'a> {
    fn assemble(model: &'a Checked, g: &mut Graph, wanted: Wanted<'a>) -> Self {
        let links = (0..model.links.len()).map(|l| stiffness::of_link(model, g, LinkId(l as u16)));
        let links: Vec<Stiffness> = links.collect();
        let impedance = impedance(model, g, &links);
        let outputs = 0..model.outputs.len() as u16;
        let differentiated = outputs.filter(|&output| wanted.has_jacobian_of(output)).count();
        let parameters = if differentiated == 0 { 0 } else { model.parameters.len() };
        let adjoints = if parameters > differentiated { differentiated } else { 0 };
        let compliance = Compliance::of(model, g, &impedance, adjoints);
        let loads: Vec<Load> = (0..model.forces.len())
            .map(|i| load(model, g, &links, i as u16))
            .collect();
        let changes = (0..parameters)
            .map(|p| change(model, g, &links, &loads, p as u16))
            .collect();
        System {
            model,
            links,
            impedance,
            compliance,
            loads,
            changes,
            wanted,
        }
    }

    fn respond(&self, g: &mut Graph, source: ExcitationSource) -> Response {
        let amplitudes = self.amplitudes(g, source);
        let moved = self.moved_by_parameters(g, source, &amplitudes);
        let mut scaled = vec![Complex::zero(g); amplitudes.len()];
        let (mut outputs, mut jacobian) = (Vec::new(), Vec::new());
        for (y, output) in self.model.outputs.iter().enumerate() {
            let functional = Functional::of(self.model, g, &self.links, &output.signal);
            self.scale(g, &functional, &amplitudes, &mut scaled);
            let value = along(g, &functional.combination, &scaled);
            let value = match functional.input(&self.links, source) {
                Some(force) => value.add(g, force),
                None => value,
            };
            if value.is_zero(g) {
                continue;
            }
            let changes = match self.wanted.has_jacobian_of(y as u16) {
                true => self.changes.as_slice(),
                false => &[],
            };
            let adjoint = match changes {
                [] => None,
                _ => self.compliance.adjoint(g, &functional.combination),
            };
            for (p, change) in changes.iter().enumerate() {
                let indirect = match &adjoint {
                    Some(adjoint) => self.by_adjoint(g, source, &functional, adjoint, &scaled, change),
                    None => along(g, &functional.combination, &moved[p]).mul(g, functional.factor),
                };
                let direct = functional.derivative(g, source, &amplitudes, &scaled, change);
                let derivative = indirect.add(g, direct);
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

    /// The derivatives of all amplitudes by each parameter, if there are no adjoints of the outputs.
    fn moved_by_parameters(
        &self,
        g: &mut Graph,
        source: ExcitationSource,
        amplitudes: &[Complex],
    ) -> Vec<Vec<Complex>> {
        let moved = |change| self.moved(g, source, amplitudes, change);
        match self.compliance.has_adjoints() {
            true => Vec::new(),
            false => self.changes.iter().map(moved).collect(),
        }
    }

    /// The amplitudes times the factor of an output, as far as they are used: all of them with an adjoint, otherwise
    /// those in outputs.
    fn scale(&self, g: &mut Graph, functional: &Functional, amplitudes: &[Complex], scaled: &mut [Complex]) {
        let mut scale = |g: &mut Graph, c: usize| scaled[c] = functional.factor.mul(g, amplitudes[c]);
        match self.changes.is_empty() || !self.compliance.has_adjoints() {
            true => functional.combination.iter().for_each(|(c, _)| scale(g, c.0 as usize)),
            false => (0..amplitudes.len()).for_each(|c| scale(g, c)),
        }
    }

    fn amplitudes(&self, g: &mut Graph, source: ExcitationSource) -> Vec<Complex> {
        match source {
            ExcitationSource::Force(i) => self.compliance.apply(g, &self.loads[i as usize]),
            ExcitationSource::Motion(CoordinateId(r)) => {
                let r = r as usize;
                let all = 0..self.model.coordinates.len();
                let forces: Load = all.filter_map(|c| Some((c, self.impedance.get(c, r)?))).collect();
                self.compliance.moved_by(g, r, &forces)
            }
        }
    }

    /// The derivative of all amplitudes by a parameter: the motion under the forces by which the balance changes.
    fn moved(&self, g: &mut Graph, source: ExcitationSource, amplitudes: &[Complex], change: &Change) -> Vec<Complex> {
        let mut forces = BTreeMap::new();
        let mut push = |g: &mut Graph, c: usize, force: Complex| {
            let sum = forces.entry(c).or_insert_with(|| Complex::zero(g));
            *sum = sum.add(g, force);
        };
        for link in &change.links {
            let stretch = &self.model.links[link.link].stretch;
            let total = self.links[link.link].total;
            let pull = along(g, stretch, amplitudes);
            let turned = along(g, &link.stretch, amplitudes).mul(g, total);
            let force = pull.mul(g, link.stiffness).add(g, turned).neg(g);
            for &(c, coefficient) in stretch {
                let share = force.scale(g, coefficient);
                push(g, c.0 as usize, share);
            }
            let held = total.mul(g, pull).neg(g);
            for &(c, slope) in &link.stretch {
                let share = held.scale(g, slope);
                push(g, c.0 as usize, share);
            }
        }
        let omega = g.symbol(Symbol::Frequency);
        let square = g.powi(omega, 2);
        for &(c, inertia) in &change.inertias {
            let force = amplitudes[c].scale(g, square).scale(g, inertia);
            push(g, c, force);
        }
        for &(c, force) in change.pushed(source) {
            push(g, c, force);
        }
        let forces: Load = forces.into_iter().filter(|(_, force)| !force.is_zero(g)).collect();
        self.compliance.apply(g, &forces)
    }

    /// The change of an output by the amplitudes, from its adjoint.
    fn by_adjoint(
        &self,
        g: &mut Graph,
        source: ExcitationSource,
        functional: &Functional,
        adjoint: &[Complex],
        scaled: &[Complex],
        change: &Change,
    ) -> Complex {
        let indirect = self.derivative(g, adjoint, scaled, change);
        let loaded = through_load(g, adjoint, change.pushed(source)).mul(g, functional.factor);
        indirect.add(g, loaded)
    }

    /// The change of the scaled amplitudes under the adjoint by links and inertias.
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

    /// `-d(κ s sᵀ)` between adjoint and amplitudes. Parts without the adjoint are common to all outputs.
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

/// K + jωC - ω²M, plus the inner states. K, C and M are summed first, since they depend on the parameters alone.
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
