//! The places of a model at which a change would explain the residuals of the sweeps, and the kind of change.

use qcar_dsl::expr::{Expr, Symbol};
use qcar_dsl::model::{CoordinateKind, Link, Model, Term};
use qcar_runtime::discover::answer::Verdict;
use qcar_runtime::discover::locate::{Shape, shape};
use qcar_runtime::discover::{MissingStiffness, Place};
use serde::Serialize;

use super::Answer;

/// Number of listed places.
const LISTED: usize = 5;

/// A place, as effect files name it.
#[derive(PartialEq, Serialize)]
pub(crate) struct Site {
    /// The link, mass or sensor location.
    pub at: String,
    /// Axis of the sensor, if the signal of a sensor instead of the model would be wrong; `None` for a link or mass.
    pub sensor: Option<String>,
}

/// A place and the dynamic stiffness that would have to be added there.
#[derive(Serialize)]
pub(crate) struct PlaceStiffness {
    /// The place.
    #[serde(flatten)]
    pub site: Site,
    /// Share of the squared residual that the best κ there explains: the limit for any effect there.
    pub explains: f64,
    /// κ, the dynamic stiffness that would have to be added, run by run.
    kappa: Vec<Stiffness>,
    /// Kind of law that κ resembles.
    pub shape: Shape,
}

impl Site {
    /// As text.
    pub fn name(&self) -> String {
        match &self.sensor {
            Some(axis) => format!("the sensor of {} along {axis}", self.at),
            None => self.at.clone(),
        }
    }
}

impl PlaceStiffness {
    /// A sentence on what a change there could explain, and on its kind.
    pub fn sentence(&self) -> String {
        let (share, at) = (100.0 * self.explains, self.site.name());
        let kind = match self.shape {
            Shape::FrictionLike => "it would act like friction".to_string(),
            Shape::Other => "its kind is not clear".to_string(),
            _ => format!("it would act like {}", self.shape.name()),
        };
        format!("something at {at} could explain {share:.1} % of the residuals of the sweeps; {kind}\n")
    }
}

/// κ at one frequency, N/m; for a sensor, the factor on its signal minus 1.
#[derive(Serialize)]
struct Stiffness {
    hz: f64,
    re: f64,
    im: f64,
    /// Standard deviation of both parts together.
    sigma: f64,
    /// Level of the run.
    level: f64,
}

/// The places that explain most, best first.
pub(crate) fn places(of: &Answer) -> Vec<PlaceStiffness> {
    let missing = |(site, kappa): (Site, &MissingStiffness)| PlaceStiffness {
        site,
        explains: kappa.ceiling,
        kappa: stiffness(kappa),
        shape: shape(kappa),
    };
    sites(of).into_iter().take(LISTED).map(missing).collect()
}

/// Every place of the user's model with its best κ, best first.
pub(crate) fn sites(of: &Answer) -> Vec<(Site, &MissingStiffness)> {
    let mut found: Vec<(Site, &MissingStiffness)> = Vec::new();
    for kappa in &of.sweeps.places {
        let site = site(&of.base, &kappa.place);
        let is_own = !of.added_parts.contains(&site.at);
        if is_own && found.iter().all(|(other, _)| *other != site) {
            found.push((site, kappa));
        }
    }
    found
}

/// Share of the sweeps' residual that the findings explain, relative to the largest share that any effect at `place`
/// could explain; `None` if it is unknown.
pub(crate) fn of_ceiling(of: &Answer, place: &str) -> Option<f64> {
    let there = of
        .sweeps
        .places
        .iter()
        .find(|kappa| site(&of.base, &kappa.place).at == place)?;
    let explained = of.sweeps.explained_by(&of.discovery.after.misfit, &of.evidence)?;
    Some(explained / there.ceiling)
}

fn stiffness(kappa: &MissingStiffness) -> Vec<Stiffness> {
    let mut all = Vec::new();
    for run in &kappa.runs {
        for ((hz, value), sigma) in run.frequency.iter().zip(&run.value).zip(&run.sigma) {
            all.push(Stiffness {
                hz: *hz,
                re: value.re,
                im: value.im,
                sigma: *sigma,
                level: run.level,
            });
        }
    }
    all
}

fn site(model: &Model, place: &Place) -> Site {
    match place {
        Place::Sensor(point) => Site {
            at: point.location.clone(),
            sensor: Some(point.axis.name().into()),
        },
        Place::Parameter(parameter) => Site {
            at: owner(model, *parameter),
            sensor: None,
        },
    }
}

/// The link or mass that a parameter belongs to: of those that depend on it, the one with the fewest parameters.
fn owner(model: &Model, parameter: usize) -> String {
    let links = model.links.iter().map(|link| (&link.name, law(link)));
    let masses = model.coordinates.iter().filter_map(|own| match own.kind {
        CoordinateKind::Mass(inertia) => Some((&own.name, vec![inertia])),
        _ => None,
    });
    let depends = |(name, law): (&String, Vec<Expr>)| {
        let symbols = model.graph.symbols(law);
        let wanted = |symbol: &Symbol| matches!(symbol, Symbol::Parameter(place) if usize::from(*place) == parameter);
        let parameters = symbols.iter().filter(|symbol| matches!(symbol, Symbol::Parameter(_)));
        symbols.iter().any(wanted).then(|| (parameters.count(), name.clone()))
    };
    let owner = links
        .chain(masses)
        .filter_map(depends)
        .min_by_key(|(others, _)| *others);
    owner.map_or_else(|| model.parameters[parameter].name.clone(), |(_, name)| name)
}

fn law(link: &Link) -> Vec<Expr> {
    let of = |term: &Term| match *term {
        Term::Spring(law) | Term::Damper(law) | Term::Inerter(law) | Term::Force(law) => law,
    };
    link.law.terms.iter().map(of).collect()
}

/// Places that explain the residuals; none if the verdict is `None`.
pub(super) fn missing(of: &Answer) -> Vec<PlaceStiffness> {
    match of.discovery.verdict {
        Verdict::None => Vec::new(),
        _ => places(of),
    }
}
