//! Vehicle data at rest that contradict each other: the load of the tyre, the mass on it, and its deflection.

use crate::campaign::{Campaign, dimension};
use crate::model::About;
use crate::proportion::is_alike;
use crate::shown::{rounded, shown};

/// Standard gravity, m/s^2, where a campaign gives none.
pub const GRAVITY: f64 = 9.80665;
/// Dimension of a stiffness, N/m.
const STIFFNESS: [i32; 3] = [1, 0, -2];

/// A sentence for each contradiction by a factor above 2 or below 1/2, most often because of a unit. A load of 0 is that
/// of models without weight, and contradicts nothing.
pub fn contradictions(about: &About, campaign: &Campaign) -> Vec<String> {
    let load = campaign.vehicle("static_tire_load").filter(|load| *load > 0.0);
    let Some(load) = load else { return Vec::new() };
    let of_mass = with_mass(campaign, load);
    let of_stiffness = with_stiffness(about, campaign, load);
    of_mass.into_iter().chain(of_stiffness).collect()
}

/// The load is the weight of the mass that the tyre carries.
fn with_mass(campaign: &Campaign, load: f64) -> Option<String> {
    let mass = campaign.vehicle("m_corner")?;
    let weight = mass * campaign.vehicle("gravity").unwrap_or(GRAVITY);
    let factor = load / weight;
    (weight > 0.0 && !is_alike(factor)).then(|| {
        format!(
            "static_tire_load = {} is {} times the weight of m_corner = {}, {}; correct one of them or its unit",
            shown(load, "N"),
            rounded(factor, 3),
            shown(mass, "kg"),
            shown(weight, "N")
        )
    })
}

/// Load over deflection is about the stiffness of the tyre: that of a stiffening tyre is up to twice as large.
fn with_stiffness(about: &About, campaign: &Campaign, load: f64) -> Option<String> {
    let deflection = campaign.vehicle("static_tire_def").filter(|own| *own > 0.0)?;
    let (name, (low, high)) = stiffness(about, campaign)?;
    let secant = load / deflection;
    let nearest = secant.clamp(low, high);
    let factor = secant / nearest;
    (!is_alike(factor)).then(|| {
        format!(
            "static_tire_load over static_tire_def is {}, {} times `{name}` = {}; correct one of them or its unit",
            shown(secant, "N/m"),
            rounded(factor, 3),
            shown(nearest, "N/m")
        )
    })
}

/// The one stiffness of the tyre, with its range or its value in the campaign, otherwise with its range in the model.
fn stiffness<'a>(about: &'a About, campaign: &Campaign) -> Option<(&'a str, (f64, f64))> {
    let link = &about.links[usize::from(about.contact.as_ref()?.link)];
    let parameters = link
        .parameters
        .iter()
        .map(|&place| &about.parameters[usize::from(place)]);
    let mut stiffnesses = parameters.filter(|own| dimension(&own.unit) == Some(STIFFNESS));
    let own = stiffnesses.next().filter(|_| stiffnesses.next().is_none())?;
    let stated = campaign.parameter(&own.name);
    let stated = stated.map(|stated| stated.range.unwrap_or((stated.value, stated.value)));
    let known = campaign.vehicle(&own.name).map(|value| (value, value));
    let range = stated.or(known).or(own.range)?;
    (range.0 > 0.0).then_some((&*own.name, range))
}
