//! The Pareto front of some results: designs that meet all limits, of which none is better in every one of these
//! results.
//!
//! NSGA-II (Deb, Pratap, Agarwal and Meyarivan, IEEE Trans. Evol. Comp. 6, 2002) with its constrained domination.

use super::task::{Sense, TOLERANCE, Task};
use crate::progress::OnProgress;
use crate::random::SplitMix;

/// The effort of the search for the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Designs in a generation, even.
    pub population: usize,
    /// Generations.
    pub generations: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            population: 48,
            generations: 40,
            seed: 1,
        }
    }
}

/// A design on the front.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// A value for each design variable.
    pub design: Vec<f64>,
    /// All results.
    pub values: Vec<f64>,
    /// Its cost.
    pub cost: f64,
}

/// A front, in the order of its first result.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    /// The points; empty if no design meets all limits.
    pub points: Vec<Point>,
    /// Number of evaluated designs.
    pub evaluated: usize,
}

/// The spread of children about parents and of mutations, as in the paper's experiments with real numbers.
const SPREAD: f64 = 20.0;

/// A design with its results.
#[derive(Clone)]
struct Member {
    places: Vec<f64>,
    values: Vec<f64>,
    /// Objectives to be minimised.
    aims: Vec<f64>,
    /// Sum of all violations of limits.
    broken: f64,
    rank: usize,
    room: f64,
}

/// The front of the results at the given positions. Lower results are better, or higher ones for [`Sense::AtLeast`].
/// The search starts from `known` designs and from random ones over the whole ranges.
pub fn front(
    task: &Task<'_>,
    aims: &[(usize, Sense)],
    known: &[Vec<f64>],
    settings: Settings,
    on_progress: OnProgress<'_>,
) -> Front {
    let mut random = SplitMix::new(settings.seed);
    let mut points: Vec<Vec<f64>> = known.iter().map(|design| task.places(design)).collect();
    points.extend(random.hypercube(settings.population, task.variables.len()));
    let mut members = evaluated(task, aims, &points);
    let mut count = settings.population + known.len();
    sort(&mut members);
    for generation in 0..settings.generations {
        on_progress(generation, settings.generations);
        members.truncate(settings.population);
        if members.len() < 2 {
            break;
        }
        let children = (0..settings.population / 2).flat_map(|_| {
            let parents = [0, 1].map(|_| tournament(&members, &mut random));
            pair(parents.map(|at| &members[at].places), &mut random)
        });
        let children: Vec<Vec<f64>> = children.collect();
        count += children.len();
        members.extend(evaluated(task, aims, &children));
        sort(&mut members);
    }
    on_progress(settings.generations, settings.generations);
    Front {
        points: points_of(task, members),
        evaluated: count,
    }
}

fn evaluated(task: &Task<'_>, aims: &[(usize, Sense)], points: &[Vec<f64>]) -> Vec<Member> {
    let designs: Vec<Vec<f64>> = points
        .iter()
        .map(|places| task.available(&task.design(places)))
        .collect();
    let results = task.designs.values_of_all(&designs);
    let member = |(design, values): (Vec<f64>, Option<Vec<f64>>)| {
        let values = values?;
        let excess = task.excesses(&design, &values);
        let aim = |(result, sense): &(usize, Sense)| match sense {
            Sense::AtMost => values[*result],
            Sense::AtLeast => -values[*result],
        };
        Some(Member {
            aims: aims.iter().map(aim).collect(),
            broken: task.broken(&excess, &vec![-TOLERANCE; excess.len()]),
            places: task.places(&design),
            values,
            rank: 0,
            room: 0.0,
        })
    };
    designs.into_iter().zip(results).filter_map(member).collect()
}

fn points_of(task: &Task<'_>, members: Vec<Member>) -> Vec<Point> {
    let mut first: Vec<Member> = members
        .into_iter()
        .filter(|own| own.rank == 0 && own.broken == 0.0)
        .collect();
    first.sort_by(|a, b| a.aims[0].total_cmp(&b.aims[0]));
    first.dedup_by(|a, b| a.aims == b.aims);
    let point = |own: Member| {
        let design = task.design(&own.places);
        Point {
            cost: task.cost(&design),
            design,
            values: own.values,
        }
    };
    first.into_iter().map(point).collect()
}

/// True if a member dominates another: a smaller violation of limits, or else better in one objective and worse in
/// none.
fn dominates(a: &Member, b: &Member) -> bool {
    if a.broken != b.broken {
        return a.broken < b.broken;
    }
    let pairs = || a.aims.iter().zip(&b.aims);
    pairs().all(|(a, b)| a <= b) && pairs().any(|(a, b)| a < b)
}

/// Ranks members by the number of fronts that dominate them, and sorts them by rank, then by crowding distance.
fn sort(members: &mut [Member]) {
    let mut left: Vec<usize> = (0..members.len()).collect();
    let mut rank = 0;
    while !left.is_empty() {
        let is_first = |at: &usize| !left.iter().any(|other| dominates(&members[*other], &members[*at]));
        let (first, others): (Vec<usize>, Vec<usize>) = left.iter().partition(|at| is_first(at));
        set_crowding_distances(members, &first);
        first.iter().for_each(|&at| members[at].rank = rank);
        (left, rank) = (others, rank + 1);
    }
    members.sort_by(|a, b| a.rank.cmp(&b.rank).then(b.room.total_cmp(&a.room)));
}

/// The crowding distance: the distance between the neighbours on a front, over all objectives.
fn set_crowding_distances(members: &mut [Member], front: &[usize]) {
    front.iter().for_each(|&at| members[at].room = 0.0);
    for aim in 0..front.first().map_or(0, |&at| members[at].aims.len()) {
        let mut order = front.to_vec();
        order.sort_by(|&a, &b| members[a].aims[aim].total_cmp(&members[b].aims[aim]));
        let value = |members: &[Member], at: usize| members[order[at]].aims[aim];
        let span = value(members, order.len() - 1) - value(members, 0);
        for end in [0, order.len() - 1] {
            members[order[end]].room = f64::INFINITY;
        }
        for at in 1..order.len().saturating_sub(1) {
            let gap = value(members, at + 1) - value(members, at - 1);
            members[order[at]].room += gap / span.max(f64::MIN_POSITIVE);
        }
    }
}

/// The better of two members; they stand in their order.
fn tournament(members: &[Member], random: &mut SplitMix) -> usize {
    random.below(members.len()).min(random.below(members.len()))
}

/// Two children by simulated binary crossover and polynomial mutation.
fn pair(parents: [&Vec<f64>; 2], random: &mut SplitMix) -> [Vec<f64>; 2] {
    let mut children = parents.map(Clone::clone);
    let chance = 1.0 / parents[0].len() as f64;
    for k in 0..parents[0].len() {
        let [a, b] = parents.map(|parent| parent[k]);
        if random.uniform() < 0.9 {
            let u = random.uniform();
            let base = if u < 0.5 { 2.0 * u } else { 0.5 / (1.0 - u) };
            let spread = base.powf(1.0 / (SPREAD + 1.0));
            children[0][k] = 0.5 * ((1.0 + spread) * a + (1.0 - spread) * b);
            children[1][k] = 0.5 * ((1.0 - spread) * a + (1.0 + spread) * b);
        }
        for child in &mut children {
            if random.uniform() < chance {
                child[k] += mutation(random.uniform());
            }
            child[k] = child[k].clamp(0.0, 1.0);
        }
    }
    children
}

fn mutation(u: f64) -> f64 {
    let power = 1.0 / (SPREAD + 1.0);
    if u < 0.5 {
        (2.0 * u).powf(power) - 1.0
    } else {
        1.0 - (2.0 * (1.0 - u)).powf(power)
    }
}
