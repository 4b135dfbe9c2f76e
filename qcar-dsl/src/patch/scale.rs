//! Amplitudes of travel, speed and force at a place in a campaign: scales for the ranges of an effect.

use super::angle;
use crate::front::syntax::{Name, Number, Parameter, ParameterDefault, UnitFactor, UnitText};

/// A reference value of a place: its largest amplitude in the runs of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// `l.force_scale`, N.
    Force,
    /// `l.travel_scale`, m: the stretch of a link, the motion of a mass.
    Travel,
    /// `l.speed_scale`, m/s.
    Speed,
    /// `m.acceleration_scale`, m/s².
    Acceleration,
}

impl Scale {
    /// All reference values.
    pub const ALL: [Scale; 4] = [Scale::Force, Scale::Travel, Scale::Speed, Scale::Acceleration];

    /// As written after the dot.
    pub fn word(self) -> &'static str {
        match self {
            Scale::Force => "force_scale",
            Scale::Travel => "travel_scale",
            Scale::Speed => "speed_scale",
            Scale::Acceleration => "acceleration_scale",
        }
    }

    /// The reference value of a word.
    pub fn written(word: &str) -> Option<Scale> {
        Scale::ALL.into_iter().find(|scale| scale.word() == word)
    }

    /// The name of the reference value of a link or mass: `z.damper.force_scale`.
    pub fn name(self, direction: &str, place: &str) -> String {
        format!("{direction}.{place}.{}", self.word())
    }

    /// The reference value of a name such as `z.damper.force_scale`, with the direction and the place.
    pub fn of(name: &str) -> Option<(Scale, &str, &str)> {
        let (owner, word) = name.rsplit_once('.')?;
        let (direction, place) = owner.split_once('.')?;
        Some((Scale::written(word)?, direction, place))
    }

    /// A typical value of an axle on a rig, for a model without measurements, and its unit.
    fn usual(self) -> (f64, &'static [(&'static str, i32)]) {
        match self {
            Scale::Force => (1e3, &[("N", 1)]),
            Scale::Travel => (20e-3, &[("m", 1)]),
            Scale::Speed => (0.5, &[("m", 1), ("s", -1)]),
            Scale::Acceleration => (10.0, &[("m", 1), ("s", -2)]),
        }
    }

    /// The reference value of a place as a parameter of the model, for expressions that use it. If the motion of the place
    /// `turns`, its unit is that of an angle.
    pub fn declaration(self, name: &str, turns: bool) -> Parameter {
        let (value, factors) = self.usual();
        let factor = |&(symbol, numerator): &(&str, i32)| UnitFactor {
            symbol: Name::new(symbol),
            numerator,
            denominator: 1,
        };
        let unit = UnitText {
            factors: factors.iter().map(factor).collect(),
            ..UnitText::default()
        };
        Parameter {
            known: true,
            clock: false,
            name: Name::new(name),
            unit: if turns { angle::unit(&unit) } else { unit },
            default: Some(ParameterDefault::Number(Number::new(value))),
            range: None,
            doc: String::new(),
        }
    }
}
