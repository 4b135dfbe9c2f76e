//! Outputs and channels.

use super::declare::declared;
use super::law::force_unit;
use super::names::DirectionName;
use super::{Reported, Resolved, Resolver, StatementOfDirection};
use crate::diagnostic::names;
use crate::expr::CoordinateId;
use crate::front::syntax::{Dotted, Name, Statement};
use crate::model::{Channel, CoordinateKind, Declaration, Output, Quantity, Reference, Signal};
use crate::units::Unit;

/// A signal with its unit and its full name, `z_body_acceleration`.
struct ResolvedSignal {
    signal: Signal,
    unit: Unit,
    name: String,
}

/// What a channel is compared with.
enum Denominator {
    Signal(ResolvedSignal),
    Force(u16),
}

impl Denominator {
    fn reference(&self) -> Reference {
        match self {
            Denominator::Signal(seen) => Reference::Signal(seen.signal.clone()),
            Denominator::Force(place) => Reference::Force(*place),
        }
    }
}

const QUANTITIES: [(&str, Quantity); 3] = [
    ("position", Quantity::Position),
    ("velocity", Quantity::Velocity),
    ("acceleration", Quantity::Acceleration),
];

impl Resolver<'_> {
    /// Declared outputs, or the acceleration of every mass and of every point that several coordinates move.
    pub fn outputs(&mut self, placed: &[StatementOfDirection]) {
        for (direction, statement) in placed {
            let Statement::Output(name, signal) = statement else {
                continue;
            };
            self.declares_outputs = true;
            let Ok(seen) = self.signal(signal, direction) else {
                continue;
            };
            let span = name.as_ref().map_or(signal.span(), |name| name.span);
            let name = Name {
                text: name.as_ref().map_or(seen.name, |name| name.text.clone()),
                span,
            };
            let seen = ResolvedSignal {
                name: name.text.clone(),
                ..seen
            };
            self.add_output(seen, declared(&name, statement));
        }
        if !self.declares_outputs {
            self.default_outputs();
        }
    }

    fn add_output(&mut self, ResolvedSignal { name, signal, unit }: ResolvedSignal, declared: Declaration) {
        if let Some(first) = self.model.outputs.iter().find(|output| output.name == name) {
            let mistake = names::duplicate_name(declared.span, first.declared.span, &name, "the outputs");
            self.report(mistake);
            return;
        }
        self.model.outputs.push(Output {
            name,
            signal,
            unit,
            declared,
        });
    }

    fn default_outputs(&mut self) {
        for (index, coordinate) in self.model.coordinates.iter().enumerate() {
            if !matches!(coordinate.kind, CoordinateKind::Mass(_)) {
                continue;
            }
            self.model.outputs.push(Output {
                name: format!("{}_{}_acceleration", coordinate.direction.0, coordinate.name),
                signal: Signal::Motion(CoordinateId(index as u16), Quantity::Acceleration),
                unit: motion_unit(coordinate.angle, Quantity::Acceleration),
                declared: coordinate.declared.clone(),
            });
        }
        for (index, point) in self.model.points.iter().enumerate() {
            self.model.outputs.push(Output {
                name: format!("{}_{}_acceleration", point.direction.0, point.name),
                signal: Signal::Point(index as u16, Quantity::Acceleration),
                unit: motion_unit(point.angle, Quantity::Acceleration),
                declared: point.declared.clone(),
            });
        }
    }

    /// Ratios of signals.
    pub fn channels(&mut self, placed: &[StatementOfDirection]) {
        for (direction, statement) in placed {
            let Statement::Channel(name, numerator, denominator) = statement else {
                continue;
            };
            if let Some(first) = self.model.channels.iter().find(|channel| channel.name == name.text) {
                let mistake = names::duplicate_name(name.span, first.declared.span, &name.text, "the channels");
                self.report(mistake);
            }
            let (above, below) = (
                self.signal(numerator, direction),
                self.reference(denominator, direction),
            );
            let (Ok(above), Ok(below)) = (above, below) else {
                continue;
            };
            let declared = declared(name, statement);
            let channel = Channel {
                name: name.text.clone(),
                numerator: above.signal.clone(),
                denominator: below.reference(),
                declared: declared.clone(),
            };
            self.model.channels.push(channel);
            self.show(above, &declared);
            if let Denominator::Signal(below) = below {
                self.show(below, &declared);
            }
        }
    }

    /// What a channel compares is an output, unless it is an input or follows from an output.
    fn show(&mut self, seen: ResolvedSignal, declared: &Declaration) {
        let follows = |output: &Output| match (&output.signal, &seen.signal) {
            (Signal::Motion(known, _), Signal::Motion(wanted, _)) => known == wanted,
            (Signal::Point(known, _), Signal::Point(wanted, _)) => known == wanted,
            (known, wanted) => known == wanted,
        };
        let prescribed = |coordinate: CoordinateId| {
            let kind = self.model.coordinates[usize::from(coordinate.0)].kind;
            matches!(kind, CoordinateKind::Road | CoordinateKind::Motion)
        };
        let is_input = matches!(seen.signal, Signal::Motion(coordinate, _) if prescribed(coordinate));
        if !is_input && !self.model.outputs.iter().any(follows) {
            self.add_output(seen, declared.clone());
        }
    }

    /// A signal, or `f_wheel_z.force` for a force input.
    fn reference(&mut self, path: &Dotted, direction: &str) -> Resolved<Denominator> {
        if let Some((quantity, owner)) = path.names.split_last()
            && quantity.text == "force"
            && let Some((_, DirectionName::Force(place))) =
                self.names.find(&Dotted { names: owner.to_vec() }, direction)
        {
            return Ok(Denominator::Force(place));
        }
        self.signal(path, direction).map(Denominator::Signal)
    }

    /// `body.acceleration`, or with its direction `z.body.acceleration`.
    fn signal(&mut self, path: &Dotted, direction: &str) -> Resolved<ResolvedSignal> {
        const EXAMPLE: &str = "body.acceleration` or `damper.force";
        let Some((quantity, owner)) = path.names.split_last().filter(|(_, owner)| !owner.is_empty()) else {
            let text = path.to_string();
            let mistake = names::wrong_kind(
                path.span(),
                &text,
                "a name without a quantity",
                "a signal",
                &format!("{text}.acceleration"),
            );
            return Err(self.report(mistake));
        };
        let owner = Dotted { names: owner.to_vec() };
        if direction.is_empty() {
            self.unambiguous(&owner)?;
        }
        match self.names.find(&owner, direction) {
            Some((_, DirectionName::Coordinate(coordinate))) => {
                let moving = &self.model.coordinates[usize::from(coordinate.0)];
                let (angle, name) = (moving.angle, format!("{}_{}", moving.direction.0, moving.name));
                self.motion_signal(quantity, &owner, angle, &name, |q| Signal::Motion(coordinate, q))
            }
            Some((_, DirectionName::Point(place))) => {
                let point = &self.model.points[usize::from(place)];
                let (angle, name) = (point.angle, format!("{}_{}", point.direction.0, point.name));
                self.motion_signal(quantity, &owner, angle, &name, |q| Signal::Point(place, q))
            }
            Some((_, DirectionName::Link(link))) => self.link_signal(link, quantity, &owner),
            Some((_, DirectionName::Broken)) => Err(Reported),
            _ => Err(self.no_thing(&owner, direction, "a point or link", EXAMPLE)),
        }
    }

    fn motion_signal(
        &mut self,
        quantity: &Name,
        owner: &Dotted,
        angle: bool,
        name: &str,
        signal: impl Fn(Quantity) -> Signal,
    ) -> Resolved<ResolvedSignal> {
        let Some((_, derivative)) = QUANTITIES.into_iter().find(|(name, _)| *name == quantity.text) else {
            let known = QUANTITIES.map(|(name, _)| name);
            let mistake = names::unknown_quantity(quantity.span, &quantity.text, &owner.to_string(), &known);
            return Err(self.report(mistake));
        };
        Ok(ResolvedSignal {
            signal: signal(derivative),
            unit: motion_unit(angle, derivative),
            name: format!("{name}_{}", quantity.text),
        })
    }

    fn link_signal(&mut self, id: crate::expr::LinkId, quantity: &Name, owner: &Dotted) -> Resolved<ResolvedSignal> {
        let link = &self.model.links[usize::from(id.0)];
        let name = format!("{}_{}_{}", link.direction.0, link.name, quantity.text);
        match quantity.text.as_str() {
            "force" => Ok(ResolvedSignal {
                signal: Signal::LinkForce(id),
                unit: force_unit(link.unit),
                name,
            }),
            "stretch" => Ok(ResolvedSignal {
                signal: Signal::LinkStretch(id),
                unit: link.unit,
                name,
            }),
            _ => {
                let known = ["force", "stretch"];
                let mistake = names::unknown_quantity(quantity.span, &quantity.text, &owner.to_string(), &known);
                Err(self.report(mistake))
            }
        }
    }
}

fn motion_unit(angle: bool, quantity: Quantity) -> Unit {
    let position = if angle { Unit::ONE } else { Unit::METER };
    match quantity {
        Quantity::Position => position,
        Quantity::Velocity => position.per(Unit::SECOND),
        Quantity::Acceleration => position.per(Unit::SECOND).per(Unit::SECOND),
    }
}
