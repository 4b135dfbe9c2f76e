//! The wheel, its road and the body of a model, to which tests refer independently of names.
//!
//! The **wheel** is the mass on the tyre, the **road** the motion under the tyre. The **body** is the mass that a K&C
//! rig holds while it moves the wheel. It is the only other mass that moves along the tyre's axis; of several, it is
//! the one whose mass is a total minus the wheel and others, as in `m_corner - m_wheel - m_subframe`. A campaign can
//! set other roles in its `[roles]`.

use thiserror::Error;

use crate::campaign::RoleNames;
use crate::model::{About, Link, Mass, StateKind};

/// The parts of a model on one tyre.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Roles {
    /// Axis of the tyre force: `z`.
    pub axis: String,
    /// The mass that the tyre carries; a campaign may name another, such as the hub in a tyre with a belt.
    pub wheel: String,
    /// The prescribed motion under the tyre.
    pub road: String,
    /// The masses along that axis, in the order of the number of links to the road; the mass on the tyre first.
    pub masses: Vec<String>,
    body: Result<String, RoleError>,
}

/// The masses of a model on a K&C rig.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OnRig {
    /// The mass that is moved.
    pub wheel: String,
    /// The mass that is held.
    pub body: String,
}

/// Reasons why a part of a model is unknown.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[expect(missing_docs, reason = "the message says it")]
pub enum RoleError {
    #[error("model `{model}` has no tyre that can roll; give its tyre link between a mass and a road")]
    NoTyre { model: String },
    #[error(
        "model `{model}` has {} tyres ({}), but only one road can be simulated; use a model with one tyre", .tyres.len(), .tyres.join(", ")
    )]
    SeveralTyres { model: String, tyres: Vec<String> },
    #[error("model `{model}` has no mass along {axis} that could be its body, only `{wheel}`")]
    NoBody { model: String, wheel: String, axis: String },
    #[error(
        "the body of model `{model}` does not follow from its structure ({}); name it in campaign.toml: \
         `[roles]` and below it `body = \"{}\"`", .masses.join(", "), .masses[0]
    )]
    OpenBody { model: String, masses: Vec<String> },
    #[error("`{name}` in `[roles]` is no mass of model `{model}` along {axis}; write one of {}", .masses.join(", "))]
    NoSuchMass {
        name: String,
        model: String,
        axis: String,
        masses: Vec<String>,
    },
}

impl Roles {
    /// Determines the roles from the structure of a model and from the names in a campaign.
    ///
    /// # Errors
    /// Fails if the model has no tyre or several, or if a name is none of its masses.
    pub fn of(about: &About, named: &RoleNames) -> Result<Self, RoleError> {
        let model = || about.name.to_string();
        let contact = about.contact.as_ref().filter(|contact| !contact.axes.is_empty());
        let contact = contact.ok_or_else(|| RoleError::NoTyre { model: model() })?;
        one_tyre(about)?;
        let own = &about.states[usize::from(contact.axes[0].position)];
        let link = &about.links[usize::from(contact.link)];
        let masses = outwards(about, &own.location, &own.axis);
        let known = |name: &String| match masses.contains(name) {
            true => Ok(name.clone()),
            false => Err(RoleError::NoSuchMass {
                name: name.clone(),
                model: model(),
                axis: own.axis.to_string(),
                masses: masses.clone(),
            }),
        };
        let wheel = named.wheel.as_ref().map(known).transpose()?;
        let wheel = wheel.unwrap_or_else(|| own.location.to_string());
        let body = match &named.body {
            Some(name) => Ok(known(name)?),
            None => body(about, &wheel, &own.location, &own.axis),
        };
        Ok(Self {
            axis: own.axis.to_string(),
            road: road_of(about, link).unwrap_or_default().to_string(),
            wheel,
            masses,
            body,
        })
    }

    /// The masses along that axis in the order in which a cleat excites them: the wheel, then all others from the tyre
    /// upwards. The first that was measured aligns a record.
    pub fn feeling(&self) -> impl Iterator<Item = &str> {
        let others = self.masses.iter().filter(|mass| **mass != self.wheel);
        std::iter::once(&self.wheel).chain(others).map(String::as_str)
    }

    /// The masses on a K&C rig.
    ///
    /// # Errors
    /// Fails if the structure does not determine the body and the campaign does not name it.
    pub fn on_rig(&self) -> Result<OnRig, RoleError> {
        let body = self.body.clone()?;
        let wheel = self.wheel.clone();
        Ok(OnRig { wheel, body })
    }
}

/// The road at which a link ends.
fn road_of<'a>(about: &'a About, link: &Link) -> Option<&'a str> {
    let mut roads = about.excitations.iter().filter(|e| e.road && e.axis == link.axis);
    roads
        .find(|road| link.ends.contains(&road.name))
        .map(|road| &*road.name)
}

/// # Errors
/// Fails if links end at different roads, or at different masses on a road.
fn one_tyre(about: &About) -> Result<(), RoleError> {
    let tyres: Vec<&Link> = about.links.iter().filter(|l| road_of(about, l).is_some()).collect();
    let ends = |link: &Link| link.ends.iter().cloned().collect::<std::collections::BTreeSet<_>>();
    if tyres.windows(2).all(|pair| ends(pair[0]) == ends(pair[1])) {
        return Ok(());
    }
    let named = |link: &&Link| format!("`{}` on `{}`", link.name, road_of(about, link).unwrap_or_default());
    Err(RoleError::SeveralTyres {
        model: about.name.to_string(),
        tyres: tyres.iter().map(named).collect(),
    })
}

/// The masses that move along an axis.
fn masses_along<'a>(about: &'a About, axis: &'a str) -> impl Iterator<Item = &'a Mass> {
    let masses = about.masses.iter();
    masses.filter(move |mass| mass.axis == axis && !mass.angle)
}

/// The masses along an axis from `first` on, link by link; masses without a link come last.
fn outwards(about: &About, first: &str, axis: &str) -> Vec<String> {
    let mut reached = vec![first.to_string()];
    let mut at = 0;
    while at < reached.len() {
        let here = reached[at].clone();
        let links = about.links.iter();
        let joined = links.filter(|link| link.axis == axis && link.ends.iter().any(|end| *end == here));
        for end in joined.flat_map(|link| link.ends.iter()) {
            if !reached.iter().any(|known| known == end) {
                reached.push(end.to_string());
            }
        }
        at += 1;
    }
    let place = |mass: &&Mass| {
        reached
            .iter()
            .position(|name| *name == mass.location)
            .unwrap_or(usize::MAX)
    };
    let mut masses: Vec<&Mass> = masses_along(about, axis).collect();
    masses.sort_by_key(place);
    masses.into_iter().map(|mass| mass.location.to_string()).collect()
}

/// # Errors
/// Fails if there is no such mass, or several.
fn body(about: &About, wheel: &str, on_tyre: &str, axis: &str) -> Result<String, RoleError> {
    let of_wheel = masses_along(about, axis).find(|mass| mass.location == wheel);
    let of_wheel: &[u16] = of_wheel.map_or(&[], |mass| &mass.parameters);
    let others = outwards(about, on_tyre, axis).into_iter();
    let others = others.filter(|name| ![wheel, on_tyre].contains(&name.as_str()));
    let others: Vec<&Mass> = others
        .filter_map(|name| masses_along(about, axis).find(|mass| mass.location == name))
        .collect();
    let is_rest = |mass: &&Mass| mass.parameters.iter().any(|parameter| of_wheel.contains(parameter));
    let rest: Vec<&Mass> = others.iter().copied().filter(is_rest).collect();
    match (&others[..], &rest[..]) {
        ([only], _) | (_, [only]) => Ok(only.location.to_string()),
        ([], _) => Err(RoleError::NoBody {
            model: about.name.to_string(),
            wheel: wheel.into(),
            axis: axis.into(),
        }),
        _ => Err(RoleError::OpenBody {
            model: about.name.to_string(),
            masses: others.iter().map(|mass| mass.location.to_string()).collect(),
        }),
    }
}

/// The state of a kind that a mass or node has along an axis.
pub(crate) fn state(about: &About, kind: StateKind, location: &str, axis: &str) -> Option<usize> {
    let is = |state: &crate::model::State| state.kind == kind && state.location == location && state.axis == axis;
    about.states.iter().position(is)
}
