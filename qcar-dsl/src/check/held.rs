//! Support of masses: every mass is held by a link, and against gravity by a spring.

use super::Scratch;
use super::rank::{null_space, support};
use super::sample::{Kind, Point, Values};
use super::stiffness::dynamic_stiffness;
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::CoordinateId;
use crate::model::{Coordinate, CoordinateKind, Direction, Model};

/// Number of motions at which a law is tested for a static load, since a stop may be out of reach in one of them.
const MOTIONS: u64 = 8;

/// An angular frequency near zero, rad/s, at which springs carry a load and dampers do not.
const NEARLY_STATIC: f64 = 1e-9;
/// Largest dynamic stiffness at that frequency, N/m, of a link that carries no load.
const NEARLY_NOTHING: f64 = 1e-3;

/// Masses that move freely. A complete direction without road and ground may float, as the longitudinal chain of a
/// vehicle does; a part of it may not.
pub fn masses_are_held(scratch: &Scratch) -> Vec<Diagnostic> {
    let model = scratch.model;
    let mut found = Vec::new();
    let free = free(model);
    let all = vec![true; model.links.len()];
    let loose = loose(scratch, &free, &all, |direction| floats(model, direction));
    if !loose.is_empty() {
        found.push(structure::mass_not_held(&named(&loose)));
        return found;
    }
    let pulled = |coordinate: &&Coordinate| {
        let gravity = model
            .gravities
            .iter()
            .any(|gravity| gravity.direction == coordinate.direction);
        gravity && !coordinate.angle
    };
    let sinking = self::loose(scratch, &free, &carrying(scratch), |_| false);
    let sinking: Vec<&Coordinate> = sinking.into_iter().filter(pulled).collect();
    if !sinking.is_empty() {
        found.push(structure::mass_sinks(&named(&sinking)));
    }
    found
}

fn named<'a>(coordinates: &[&'a Coordinate]) -> Vec<(crate::source::Span, &'a str)> {
    coordinates
        .iter()
        .map(|coordinate| (coordinate.declared.span, coordinate.name.as_str()))
        .collect()
}

/// Masses and nodes.
fn free(model: &Model) -> Vec<CoordinateId> {
    let moves = |id: &CoordinateId| {
        let kind = model.coordinates[usize::from(id.0)].kind;
        matches!(kind, CoordinateKind::Mass(_) | CoordinateKind::Node)
    };
    (0..model.coordinates.len() as u16)
        .map(CoordinateId)
        .filter(moves)
        .collect()
}

/// True for a direction without prescribed motion and without gravity, whose position is undetermined.
fn floats(model: &Model, direction: &Direction) -> bool {
    let prescribed = |coordinate: &Coordinate| {
        coordinate.direction == *direction && matches!(coordinate.kind, CoordinateKind::Road | CoordinateKind::Motion)
    };
    !model.coordinates.iter().any(prescribed) && !model.gravities.iter().any(|g| g.direction == *direction)
}

/// Links whose force keeps growing with a constant stretch.
fn carrying(scratch: &Scratch) -> Vec<bool> {
    let mut carries = vec![false; scratch.slopes.len()];
    for seed in 0..MOTIONS {
        let kind = if seed % 2 == 0 { Kind::Plain } else { Kind::Declared };
        let point = Point::new(scratch.model, kind, seed);
        let leaf = |symbol| point.leaf(symbol);
        let values = Values::new(&scratch.graph, &leaf);
        for (carries, slopes) in carries.iter_mut().zip(&scratch.slopes) {
            let stiffness = dynamic_stiffness(slopes, &|e| values.of(e), NEARLY_STATIC).norm();
            *carries |= stiffness.is_nan() || stiffness > NEARLY_NOTHING;
        }
    }
    carries
}

/// Masses that can move without stretching any holding link, except in floating directions.
fn loose<'a>(
    scratch: &Scratch<'a>,
    free: &[CoordinateId],
    holds: &[bool],
    floats: impl Fn(&Direction) -> bool,
) -> Vec<&'a Coordinate> {
    let point = Point::new(scratch.model, Kind::Plain, 1);
    let leaf = |symbol| point.leaf(symbol);
    let values = Values::new(&scratch.graph, &leaf);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (link, _) in scratch.model.links.iter().zip(holds).filter(|(_, holds)| **holds) {
        let coefficient = |id: &CoordinateId| link.stretch.iter().find(|(other, _)| other == id);
        rows.push(
            free.iter()
                .map(|id| coefficient(id).map_or(0.0, |(_, c)| values.of(*c)))
                .collect(),
        );
    }
    rows.extend(tethers(scratch.model, free, floats));
    let null = null_space(rows, free.len());
    let coordinate = |column: usize| &scratch.model.coordinates[usize::from(free[column].0)];
    let is_mass = |coordinate: &&Coordinate| matches!(coordinate.kind, CoordinateKind::Mass(_));
    support(&null).into_iter().map(coordinate).filter(is_mass).collect()
}

/// A row for each floating direction that fixes its largest connected group; smaller groups are separate.
fn tethers(model: &Model, free: &[CoordinateId], floats: impl Fn(&Direction) -> bool) -> Vec<Vec<f64>> {
    let direction = |id: &CoordinateId| &model.coordinates[usize::from(id.0)].direction;
    let mut rows: Vec<(&Direction, Vec<f64>)> = Vec::new();
    for group in groups(model, free) {
        let Some(home) = group.first().map(direction).filter(|home| floats(home)) else {
            continue;
        };
        let along = |id| {
            f64::from(u8::from(
                group.contains(id) && !model.coordinates[usize::from(id.0)].angle,
            ))
        };
        let row: Vec<f64> = free.iter().map(along).collect();
        match rows.iter_mut().find(|(other, _)| *other == home) {
            Some((_, known)) if known.iter().sum::<f64>() >= row.iter().sum() => {}
            Some((_, known)) => *known = row,
            None => rows.push((home, row)),
        }
    }
    rows.into_iter().map(|(_, row)| row).collect()
}

/// Groups of coordinates that links connect.
fn groups(model: &Model, free: &[CoordinateId]) -> Vec<Vec<CoordinateId>> {
    let mut groups: Vec<Vec<CoordinateId>> = free.iter().map(|&id| vec![id]).collect();
    for link in &model.links {
        let touches = |group: &Vec<CoordinateId>| link.stretch.iter().any(|(id, _)| group.contains(id));
        let (touched, mut others): (Vec<_>, Vec<_>) = groups.into_iter().partition(touches);
        if !touched.is_empty() {
            others.push(touched.concat());
        }
        groups = others;
    }
    groups
}
