//! What is to be seen: outputs and channels.

use super::declare::declared;
use super::law::force_unit;
use super::names::Thing;
use super::{Known, Placed, Reported, Resolver};
use crate::diagnostic::{names, units as mistakes};
use crate::expr::CoordinateId;
use crate::model::{Channel, CoordinateKind, Output, Quantity, Signal};
use crate::syntax::{Dotted, Name, Statement};
use crate::units::Unit;

/// A signal with its unit and its full name, `z_body_acceleration`.
struct Seen {
    signal: Signal,
    unit: Unit,
    name: String,
}

const QUANTITIES: [(&str, Quantity); 3] = [
    ("position", Quantity::Position),
    ("velocity", Quantity::Velocity),
    ("acceleration", Quantity::Acceleration),
];

impl Resolver<'_> {
    /// Declared outputs, or the acceleration of every mass.
    pub fn outputs(&mut self, placed: &[Placed]) {
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
            if let Some(first) = self.model.outputs.iter().find(|output| output.name == name.text) {
                let mistake = names::duplicate_name(span, first.declared.span, &name.text, "the outputs");
                self.report(mistake);
                continue;
            }
            let declared = declared(&name, statement);
            self.model.outputs.push(Output {
                name: name.text,
                signal: seen.signal,
                unit: seen.unit,
                declared,
            });
        }
        if !self.declares_outputs {
            self.default_outputs();
        }
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
    }

    /// Ratios of signals.
    pub fn channels(&mut self, placed: &[Placed]) {
        for (direction, statement) in placed {
            let Statement::Channel(name, numerator, denominator) = statement else {
                continue;
            };
            if let Some(first) = self.model.channels.iter().find(|channel| channel.name == name.text) {
                let mistake = names::duplicate_name(name.span, first.declared.span, &name.text, "the channels");
                self.report(mistake);
            }
            let (above, below) = (self.signal(numerator, direction), self.signal(denominator, direction));
            let (Ok(above), Ok(below)) = (above, below) else {
                continue;
            };
            if let (Signal::Motion(_, a), Signal::Motion(_, b)) = (&above.signal, &below.signal)
                && a != b
            {
                let span = numerator.span().join(denominator.span());
                self.report(mistakes::channel_units_differ(
                    span,
                    quantity_name(*a),
                    quantity_name(*b),
                ));
            }
            self.model.channels.push(Channel {
                name: name.text.clone(),
                numerator: above.signal,
                denominator: below.signal,
                declared: declared(name, statement),
            });
        }
    }

    /// `body.acceleration`, or with its direction `z.body.acceleration`.
    fn signal(&mut self, path: &Dotted, direction: &str) -> Known<Seen> {
        const EXAMPLE: &str = "body.acceleration` or `damper.force";
        let Some((quantity, owner)) = path.names.split_last().filter(|(_, owner)| !owner.is_empty()) else {
            let text = path.to_string();
            let mistake = names::wrong_kind(
                path.span(),
                &text,
                "a name alone",
                "something to see",
                &format!("{text}.acceleration"),
            );
            return Err(self.report(mistake));
        };
        let owner = Dotted { names: owner.to_vec() };
        if direction.is_empty() {
            self.unambiguous(&owner)?;
        }
        match self.names.find(&owner, direction) {
            Some((_, Thing::Coordinate(coordinate))) => self.motion_signal(coordinate, quantity, &owner),
            Some((_, Thing::Link(link))) => self.link_signal(link, quantity, &owner),
            Some((_, Thing::Broken)) => Err(Reported),
            _ => Err(self.no_thing(&owner, direction, "a point or link", EXAMPLE)),
        }
    }

    fn motion_signal(&mut self, coordinate: CoordinateId, quantity: &Name, owner: &Dotted) -> Known<Seen> {
        let Some((_, derivative)) = QUANTITIES.into_iter().find(|(name, _)| *name == quantity.text) else {
            let known = QUANTITIES.map(|(name, _)| name);
            let mistake = names::unknown_quantity(quantity.span, &quantity.text, &owner.to_string(), &known);
            return Err(self.report(mistake));
        };
        let moving = &self.model.coordinates[usize::from(coordinate.0)];
        let name = format!("{}_{}_{}", moving.direction.0, moving.name, quantity.text);
        let unit = motion_unit(moving.angle, derivative);
        Ok(Seen {
            signal: Signal::Motion(coordinate, derivative),
            unit,
            name,
        })
    }

    fn link_signal(&mut self, id: crate::expr::LinkId, quantity: &Name, owner: &Dotted) -> Known<Seen> {
        let link = &self.model.links[usize::from(id.0)];
        let name = format!("{}_{}_{}", link.direction.0, link.name, quantity.text);
        match quantity.text.as_str() {
            "force" => Ok(Seen {
                signal: Signal::LinkForce(id),
                unit: force_unit(link.unit),
                name,
            }),
            "stretch" => Ok(Seen {
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

fn quantity_name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position => "position",
        Quantity::Velocity => "velocity",
        Quantity::Acceleration => "acceleration",
    }
}
