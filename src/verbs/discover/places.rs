//! The places of a model at which a change would explain the residuals of the sweeps, and the kind of change.

use qcar_dsl::expr::{Expr, Symbol};
use qcar_dsl::model::{CoordinateKind, Link, Model, Term};
use qcar_runtime::discover::locate::{Shape, shape};
use qcar_runtime::discover::{Kappa, Place};
use serde::Serialize;

use super::Answer;

/// Places that are listed.
const LISTED: usize = 5;

/// A place, as effects call it.
#[derive(PartialEq, Serialize)]
pub(crate) struct Site {
    /// The link, mass or sensor location.
    pub at: String,
    /// The axis of a sensor: its signal, not the model, would be wrong.
    pub sensor: Option<&'static str>,
}

/// A place, with what is missing if it is missing there.
#[derive(Serialize)]
pub(crate) struct Missing {
    /// Where.
    #[serde(flatten)]
    pub site: Site,
    /// Share of the squared gap that the best κ there explains: what no effect there can exceed.
    pub explains: f64,
    /// The dynamic stiffness that would have to be added, run by run.
    kappa: Vec<Stiffness>,
    /// The coarse law of it.
    pub shape: Shape,
}

impl Site {
    /// In words.
    pub fn name(&self) -> String {
        match self.sensor {
            Some(axis) => format!("the sensor of {} along {axis}", self.at),
            None => self.at.clone(),
        }
    }
}

/// κ at a frequency: N/m; of a sensor the factor on its signal, less 1.
#[derive(Serialize)]
struct Stiffness {
    hz: f64,
    re: f64,
    im: f64,
    /// Standard deviation of both parts together.
    sigma: f64,
    /// Of the run.
    level: f64,
}

/// The places that explain most, the best first.
pub(crate) fn places(of: &Answer) -> Vec<Missing> {
    let missing = |(site, kappa): (Site, &Kappa)| Missing {
        site,
        explains: kappa.ceiling,
        kappa: stiffness(kappa),
        shape: shape(kappa),
    };
    sites(of).into_iter().take(LISTED).map(missing).collect()
}

/// Every place once, by what explains most there, the best first.
pub(crate) fn sites(of: &Answer) -> Vec<(Site, &Kappa)> {
    let mut found: Vec<(Site, &Kappa)> = Vec::new();
    for kappa in &of.sweeps.places {
        let site = site(&of.base, &kappa.place);
        if found.iter().all(|(other, _)| *other != site) {
            found.push((site, kappa));
        }
    }
    found
}

/// Of what any effect at a place could explain of the sweeps, the share that all that was found explains; `None` where
/// nothing says so.
pub(crate) fn of_ceiling(of: &Answer, place: &str) -> Option<f64> {
    let there = of
        .sweeps
        .places
        .iter()
        .find(|kappa| site(&of.base, &kappa.place).at == place)?;
    let explained = of.sweeps.explained_by(&of.discovery.after.gap, &of.evidence)?;
    Some(explained / there.ceiling)
}

fn stiffness(kappa: &Kappa) -> Vec<Stiffness> {
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
            sensor: Some(point.axis.name()),
        },
        Place::Parameter(parameter) => Site {
            at: owner(model, *parameter),
            sensor: None,
        },
    }
}

/// The link or mass that a parameter belongs to: the one that depends on the fewest others.
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
