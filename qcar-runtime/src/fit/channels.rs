//! Ratios of the measured signals that are fitted.
//!
//! Thesis section 3.5.2.1: "only channels that represent motion across a physical force element (e.g., tire, bushing,
//! damper) and have corresponding measurements". A ratio that is a product of other ratios adds no
//! information, so the ratios form a tree over the measured places. A place that no link connects to the tree gets its
//! ratio to the excitation.

use crate::model::{About, Channel, Excitation, Link, Signal, SignalKind};

/// Ratios to fit, and ratios from the excitation to each place, which are only compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// Across force elements.
    pub fitted: Vec<Channel>,
    /// From the excitation, unless they are fitted.
    pub compared: Vec<Channel>,
}

/// Channels of a model under an excitation for the `measured` signals, which include the excitation.
pub fn across_links(about: &About, excitation: &Excitation, measured: &[Signal]) -> Channels {
    let distance = Distances::new(about, excitation);
    let mut tree = Tree::new(measured);
    let mut links: Vec<&Link> = about.links.iter().collect();
    // A link between two places is one element. A lever between more places acts as several, so it comes later.
    links.sort_by_key(|link| link.ends.len());
    let mut fitted = Vec::new();
    for link in links {
        let Some(mut ends) = measured_ends(link, measured) else {
            continue;
        };
        // The farther end first; at equal distance in the order of the stretch, upper before lower.
        ends.sort_by_key(|&end| std::cmp::Reverse(distance.of(&measured[end])));
        let near = ends[ends.len() - 1];
        fitted.extend(
            ends.iter()
                .filter(|&&far| tree.join(near, far))
                .map(|&far| between(measured, near, far)),
        );
    }
    let Some(source) = measured.iter().position(|signal| is_excitation(excitation, signal)) else {
        return Channels {
            fitted,
            compared: Vec::new(),
        };
    };
    let others = || (0..measured.len()).filter(|&place| place != source);
    fitted.extend(
        others()
            .filter(|&far| tree.join(source, far))
            .map(|far| between(measured, source, far)),
    );
    let from_source = others().map(|far| between(measured, source, far));
    let compared = from_source
        .filter(|channel| fitted.iter().all(|other| other.name != channel.name))
        .collect();
    Channels { fitted, compared }
}

/// The ratio from one place to another, named `near_to_far`.
fn between(measured: &[Signal], near: usize, far: usize) -> Channel {
    let (numerator, denominator) = (measured[far].clone(), measured[near].clone());
    let name = format!("{}_to_{}", denominator.location, numerator.location);
    Channel {
        name: name.into(),
        numerator,
        denominator,
    }
}

/// True if `signal` is the excitation.
pub fn is_excitation(excitation: &Excitation, signal: &Signal) -> bool {
    let kind = match signal.kind {
        SignalKind::Motion(_) => !excitation.force,
        SignalKind::Force => excitation.force,
        SignalKind::Stretch => false,
    };
    kind && signal.location == excitation.name && signal.axis == excitation.axis
}

/// Positions of the ends of a link among the measured signals; `None` if one was not measured or both are the same.
fn measured_ends(link: &Link, measured: &[Signal]) -> Option<Vec<usize>> {
    let place = |end: &str| {
        let here = |signal: &Signal| signal.location == end && signal.axis == link.axis;
        measured
            .iter()
            .position(|signal| here(signal) && matches!(signal.kind, SignalKind::Motion(_)))
    };
    let ends: Vec<usize> = link.ends.iter().map(|end| place(end)).collect::<Option<_>>()?;
    (ends.len() >= 2).then_some(ends)
}

/// Number of links between the excitation and each coordinate.
struct Distances {
    known: Vec<(String, String, usize)>,
}

impl Distances {
    fn new(about: &About, excitation: &Excitation) -> Self {
        let mut known = vec![(excitation.name.to_string(), excitation.axis.to_string(), 0)];
        let mut at = 0;
        while at < known.len() {
            let (location, axis, distance) = known[at].clone();
            let links = about
                .links
                .iter()
                .filter(|link| link.axis == axis && link.ends.iter().any(|e| *e == location));
            for end in links.flat_map(|link| link.ends.iter()) {
                if !known.iter().any(|(other, along, _)| other == end && *along == axis) {
                    known.push((end.to_string(), axis.clone(), distance + 1));
                }
            }
            at += 1;
        }
        Self { known }
    }

    fn of(&self, signal: &Signal) -> usize {
        let here =
            |(location, axis, _): &&(String, String, usize)| *location == signal.location && *axis == signal.axis;
        self.known.iter().find(here).map_or(usize::MAX, |known| known.2)
    }
}

/// Places connected by ratios: a group number for each.
struct Tree {
    group: Vec<usize>,
}

impl Tree {
    fn new(measured: &[Signal]) -> Self {
        Self {
            group: (0..measured.len()).collect(),
        }
    }

    /// Connects two places; false if they are connected already.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (keep, drop) = (self.group[a], self.group[b]);
        for group in &mut self.group {
            if *group == drop {
                *group = keep;
            }
        }
        keep != drop
    }
}
