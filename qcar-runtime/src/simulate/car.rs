//! A model on its tyre.

use super::equilibrium::Unbalanced;
use super::failure::SimulateError;
use crate::campaign::RoleNames;
use crate::model::{ContactAbout, Model};
use crate::roles::{RoleError, Roles};
use crate::tyre::{Geometry, Tyre};

/// A model with its parameters and its tyre.
pub struct Car<'a, M: ?Sized> {
    /// A model with a tyre link between a mass and a road.
    pub model: &'a M,
    /// A value for each parameter of the model, SI.
    pub parameters: &'a [f64],
    /// Radius, static deflection and geometry of the tyre.
    pub tyre: Tyre,
    /// Static load that the tyre carries, N.
    pub load: f64,
    /// Variant of the model.
    pub variant: Variant,
}

/// The variants of thesis section 3.6.3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Variant {
    /// All of the model.
    #[default]
    Complete,
    /// The wheel and all other masses move along the road at constant speed.
    LongitudinallyLocked,
    /// Longitudinally locked, and the tyre responds only to the road height below the wheel centre.
    PureVertical,
}

impl<M: Model + ?Sized> Car<'_, M> {
    /// The tyre link, or why the model cannot roll.
    pub(super) fn contact(&self) -> Result<&ContactAbout, SimulateError> {
        let about = self.model.about();
        let (found, expected) = (self.parameters.len(), about.parameters.len());
        if found != expected {
            return Err(SimulateError::Count {
                name: "the parameter set",
                found,
                expected,
            });
        }
        let model = about.name.to_string();
        Roles::of(about, &RoleNames::default())?;
        let contact = about.contact.as_ref();
        contact.ok_or(SimulateError::Role(RoleError::NoTyre { model }))
    }

    /// The tyre of the variant.
    pub(super) fn rolling_tyre(&self) -> Tyre {
        match self.variant {
            Variant::PureVertical => self.tyre.with_geometry(Geometry::Point),
            Variant::Complete | Variant::LongitudinallyLocked => self.tyre,
        }
    }

    /// Indices of the states that the variant fixes: all those along the axis of rolling.
    pub(super) fn locked(&self, contact: &ContactAbout) -> Vec<usize> {
        let free = self.variant == Variant::Complete;
        let Some(rolling) = contact.axes.get(1).filter(|_| !free) else {
            return Vec::new();
        };
        let states = self.model.about().states.iter().enumerate();
        states
            .filter(|(_, state)| state.axis == rolling.axis)
            .map(|(place, _)| place)
            .collect()
    }

    /// The constants of the parameter set.
    pub(super) fn constants(&self) -> Vec<f64> {
        let mut constants = vec![0.0; self.model.about().constants];
        self.model.prepare(self.parameters, &mut constants);
        constants
    }

    pub(super) fn unbalanced(&self, unbalanced: &Unbalanced) -> SimulateError {
        let about = self.model.about();
        SimulateError::NoEquilibrium {
            model: about.name.to_string(),
            state: about.states[unbalanced.state].name.to_string(),
            rate: unbalanced.rate,
        }
    }
}
