//! Duplicate links.

use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{CoordinateId, Expr, Graph};
use crate::model::{Link, Model, Term};

/// Checks that no two links of one stretch have the same kind of linear term. A spring beside a damper is usual, but
/// two parallel springs are one spring.
pub fn links_are_distinct(model: &Model, graph: &Graph) -> Vec<Diagnostic> {
    let mut graph = graph.clone();
    let mut found = Vec::new();
    for (index, link) in model.links.iter().enumerate() {
        let opposite: Stretch = link.stretch.iter().map(|&(id, c)| (id, graph.neg(c))).collect();
        let same = |other: &&Link| is_same(&other.stretch, &link.stretch) || is_same(&other.stretch, &opposite);
        let repeated = model.links[..index]
            .iter()
            .filter(same)
            .find_map(|other| shared(other, link));
        if let Some((first, kind)) = repeated {
            let places = (link.declared.span, first.declared.span);
            found.push(structure::duplicate_link(places, &link.name, &first.name, kind));
        }
    }
    found
}

type Stretch = Vec<(CoordinateId, Expr)>;

fn is_same(a: &Stretch, b: &Stretch) -> bool {
    a.len() == b.len() && a.iter().all(|part| b.contains(part))
}

fn shared<'a>(first: &'a Link, second: &Link) -> Option<(&'a Link, &'static str)> {
    let kind = |term: &Term| match term {
        Term::Spring(_) => Some("spring"),
        Term::Damper(_) => Some("damper"),
        Term::Inerter(_) => Some("inerter"),
        Term::Force(_) => None,
    };
    let of_second: Vec<_> = second.law.terms.iter().filter_map(kind).collect();
    let both = first
        .law
        .terms
        .iter()
        .filter_map(kind)
        .find(|kind| of_second.contains(kind));
    both.map(|kind| (first, kind))
}
