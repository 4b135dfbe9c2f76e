//! The solution space: the largest box of design variables' intervals in which all limits hold with a stated
//! probability.
//!
//! Zimmermann and von Hoessle, "Computing solution spaces for robust design", Int. J. Numer. Meth. Engng 94 (2013)
//! 290–307. A box grows to all sides, designs are drawn in it, and parts with bad designs are cut off so that as few
//! good ones as possible are lost. At the end it grows as long as enough designs in it are good. The probability of a
//! good design in the box is then estimated from designs that were not used to find it.
//!
//! If results are uncertain, the box is searched with certain results and the margins of the limits, and judged by
//! random results: the probability is then that over designs and results together.

use super::task::{Task, is_met};
use crate::progress::OnProgress;
use crate::random::SplitMix;

/// The requirements on a box, and the effort of the search for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Probability of a good design, for a uniform distribution over the box.
    pub probability: f64,
    /// Designs drawn at a time.
    pub samples: usize,
    /// Rounds of growth.
    pub rounds: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            probability: 0.95,
            samples: 100,
            rounds: 50,
            seed: 1,
        }
    }
}

/// A box of intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// The interval of each design variable.
    pub intervals: Vec<[f64; 2]>,
    /// Share of good designs among those that judge it.
    pub probability: f64,
    /// Lower bound of the probability with 95 % confidence.
    pub at_least: f64,
    /// Share of designs that meet each limit, then each coupling.
    pub each: Vec<f64>,
    /// Its volume, relative to that of the whole ranges.
    pub volume: f64,
    /// Number of evaluated designs.
    pub evaluated: usize,
}

/// Growth of each side in the first round, relative to the range; a tenth of it in the last round.
const GROWTH: f64 = 0.08;
/// Good designs from which cuts are tried.
const ANCHORS: usize = 16;
/// Largest number of final rounds of growth. This and the other sizes of steps and rounds below are choices: they
/// affect the time of the search and the size of the box, not whether it is confirmed.
const FINAL_ROUNDS: usize = 8;
/// Growth of a final round at each end of each interval, relative to its length.
const SURROUNDINGS: f64 = 0.05;
/// Number of steps in which that growth is examined.
const STEPS: usize = 20;
/// Number of designs that confirm a box, relative to the smallest number that could. With fewer designs a larger share
/// of them must be good, so the box becomes smaller.
const CONFIRMING: usize = 8;
/// Level of significance: a worse box would give as many good designs by chance once in twenty times.
const BY_CHANCE: f64 = 0.05;
/// Shrinkage of a box that is not confirmed, at each end of each interval, relative to its length.
const SHRINKAGE: f64 = 0.01;
/// Growth of a confirmed box, in the same way.
const FURTHER: f64 = 0.015;
/// Largest number of boxes that are judged until one is confirmed.
const CONFIRMATIONS: usize = 16;
/// Largest number of larger boxes that are judged after that.
const FURTHER_ONES: usize = 4;

/// A box in positions of the design variables, 0 to 1.
type Sides = Vec<[f64; 2]>;

/// A drawn design.
struct RandomDesign {
    places: Vec<f64>,
    /// Violation of each limit and coupling; `None` without results.
    excess: Option<Vec<f64>>,
    /// True if all constraints hold.
    good: bool,
}

/// The largest box around a good design that was found; `None` if no good design is known or found.
pub fn space(task: &Task<'_>, known: &[Vec<f64>], settings: Settings, on_progress: OnProgress<'_>) -> Option<Space> {
    let mut random = SplitMix::new(settings.seed);
    let real = task.without_margins();
    let start = start(task, known, &mut random, settings.samples);
    let start = start.or_else(|| self::start(&real, known, &mut random, settings.samples))?;
    let sides = start.iter().map(|place| [*place; 2]).collect();
    let rounds = settings.rounds + FINAL_ROUNDS;
    let sides = widened(task, sides, settings, &mut random, &|round| on_progress(round, rounds));
    // The smallest number of good designs without a bad one that shows the probability at 95 % confidence; a multiple
    // of it allows for bad ones.
    let judges = settings
        .samples
        .max((2.0 * 3.0 / (1.0 - settings.probability).max(1e-4)).ceil() as usize);
    let confirming = CONFIRMING * judges;
    let enough = probably_enough(confirming, settings.probability);
    let (sides, evaluated) = adjusted(&real, sides, (confirming, enough), &mut random, &|round| {
        on_progress(settings.rounds + round, rounds);
    });
    on_progress(rounds, rounds);
    Some(confirmed(
        &real,
        sides,
        (settings.probability, confirming),
        (2 + settings.rounds) * settings.samples + evaluated,
        &mut random,
    ))
}

/// The first rounds: the box grows on all sides, and bad designs are cut off.
fn widened(
    task: &Task<'_>,
    mut sides: Sides,
    settings: Settings,
    random: &mut SplitMix,
    on_round: &dyn Fn(usize),
) -> Sides {
    for round in 0..settings.rounds {
        on_round(round);
        let growth = GROWTH * (1.0 - 0.9 * round as f64 / settings.rounds as f64);
        let before = sides.clone();
        grow(&mut sides, growth);
        let drawn = draw(task, &sides, settings.samples, random);
        sides = trimmed(&sides, &drawn).unwrap_or(before);
    }
    sides
}

/// The final rounds: the box becomes the largest one around it in which enough designs are good. Also returns the
/// number of evaluated designs.
fn adjusted(
    task: &Task<'_>,
    mut sides: Sides,
    (count, enough): (usize, f64),
    random: &mut SplitMix,
    on_round: &dyn Fn(usize),
) -> (Sides, usize) {
    for round in 0..FINAL_ROUNDS {
        on_round(round);
        let around = grown(&sides, SURROUNDINGS);
        if around == sides {
            return (sides, round * count);
        }
        let drawn = draw_uncertain(task, &around, count, random);
        match largest_within(&sides, &around, &drawn, enough) {
            Some(STEPS) => sides = around,
            Some(step) => return (between(&sides, &around, step), (round + 1) * count),
            None if task.designs.is_certain() => {
                let inside: Vec<RandomDesign> = drawn.into_iter().filter(|own| holds(&sides, &own.places)).collect();
                sides = trimmed(&sides, &inside).unwrap_or_else(|| shrunk(&sides));
            }
            // A random bad result says little about its position.
            None => sides = shrunk(&shrunk(&sides)),
        }
    }
    (sides, FINAL_ROUNDS * count)
}

/// Judges a box by new designs. If too many are bad, the box shrinks until enough are good; then it grows step by step
/// as long as enough are good. Since growth ends at the first box that is not confirmed, a box below the required
/// probability is returned no more often than the level of significance (Maurer, Hothorn and Lehmacher, "Multiple
/// comparisons in drug clinical trials and preclinical assays: a-priori ordered hypotheses", 1995).
fn confirmed(
    task: &Task<'_>,
    mut sides: Sides,
    (probability, confirming): (f64, usize),
    mut evaluated: usize,
    random: &mut SplitMix,
) -> Space {
    let mut judge = |sides: &Sides| {
        let drawn = draw_uncertain(task, sides, confirming, random);
        evaluated += drawn.len();
        judged(task, sides, &drawn, evaluated)
    };
    let mut best = judge(&sides);
    for _ in 1..CONFIRMATIONS {
        if best.at_least >= probability {
            break;
        }
        sides = shrunk(&sides);
        best = judge(&sides);
    }
    for _ in 0..FURTHER_ONES {
        let further = grown(&sides, FURTHER);
        if best.at_least < probability || further == sides {
            break;
        }
        let next = judge(&further);
        best.evaluated = next.evaluated;
        if next.at_least < probability {
            break;
        }
        (sides, best) = (further, next);
    }
    best
}

/// Share of good designs at which a box will probably be confirmed: one standard deviation above the required share.
fn probably_enough(confirming: usize, probability: f64) -> f64 {
    let scatter = (probability * (1.0 - probability) / confirming as f64).sqrt();
    (needed(confirming, probability) + scatter).min(1.0)
}

/// The last step from a box to a larger one, which contains `drawn`, at which enough of the designs inside are good;
/// `None` if there are not enough in the box itself.
fn largest_within(sides: &Sides, around: &Sides, drawn: &[RandomDesign], enough: f64) -> Option<usize> {
    (0..=STEPS).rev().find(|&step| {
        let sides = between(sides, around, step);
        let inside = || drawn.iter().filter(|own| holds(&sides, &own.places));
        let good = inside().filter(|own| own.good).count();
        good as f64 >= enough * inside().count() as f64
    })
}

fn between(sides: &Sides, around: &Sides, step: usize) -> Sides {
    let part = step as f64 / STEPS as f64;
    let end = |from: f64, to: f64| from + part * (to - from);
    let pairs = sides.iter().zip(around);
    pairs
        .map(|(own, other)| [end(own[0], other[0]), end(own[1], other[1])])
        .collect()
}

/// The good design that is furthest inside all limits.
fn start(task: &Task<'_>, known: &[Vec<f64>], random: &mut SplitMix, samples: usize) -> Option<Vec<f64>> {
    let all = vec![[0.0, 1.0]; task.variables.len()];
    let mut drawn = draw(task, &all, 2 * samples, random);
    drawn.extend(known.iter().map(|design| drawn_at(task, task.places(design))));
    let inside = |own: &RandomDesign| {
        let excess = own.excess.as_ref().expect("a good design has results");
        excess.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    };
    let good = drawn.into_iter().filter(|own| own.good);
    good.min_by(|a, b| inside(a).total_cmp(&inside(b)))
        .map(|own| own.places)
}

fn grow(sides: &mut Sides, by: f64) {
    for side in sides {
        *side = [(side[0] - by).max(0.0), (side[1] + by).min(1.0)];
    }
}

/// Each interval extended at both ends by a fraction of its length.
fn grown(sides: &Sides, part: f64) -> Sides {
    let grow = |[low, high]: &[f64; 2]| {
        let by = part * (high - low);
        [(low - by).max(0.0), (high + by).min(1.0)]
    };
    sides.iter().map(grow).collect()
}

fn shrunk(sides: &Sides) -> Sides {
    grown(sides, -SHRINKAGE)
}

/// Random designs in a box.
fn inside(sides: &Sides, count: usize, random: &mut SplitMix) -> Vec<Vec<f64>> {
    let mut points = random.hypercube(count, sides.len());
    for (u, [low, high]) in points.iter_mut().flat_map(|point| point.iter_mut().zip(sides)) {
        *u = low + *u * (high - low);
    }
    points
}

/// Random designs with their certain results.
fn draw(task: &Task<'_>, sides: &Sides, count: usize, random: &mut SplitMix) -> Vec<RandomDesign> {
    let points = inside(sides, count, random);
    let designs: Vec<Vec<f64>> = points.iter().map(|places| task.design(places)).collect();
    let results = points.into_iter().zip(task.designs.values_of_all(&designs));
    results
        .map(|(places, values)| judged_at(task, places, values))
        .collect()
}

/// Random designs with random results.
fn draw_uncertain(task: &Task<'_>, sides: &Sides, count: usize, random: &mut SplitMix) -> Vec<RandomDesign> {
    if task.designs.is_certain() {
        return draw(task, sides, count, random);
    }
    let points = inside(sides, count, random);
    let designs: Vec<(Vec<f64>, u64)> = points
        .iter()
        .map(|places| (task.design(places), random.bits()))
        .collect();
    let results = points.into_iter().zip(task.designs.drawn_of_all(&designs));
    results
        .map(|(places, values)| judged_at(task, places, values))
        .collect()
}

fn drawn_at(task: &Task<'_>, places: Vec<f64>) -> RandomDesign {
    let values = task.designs.values(&task.design(&places));
    judged_at(task, places, values)
}

fn judged_at(task: &Task<'_>, places: Vec<f64>, values: Option<Vec<f64>>) -> RandomDesign {
    let design = task.design(&places);
    let excess = values.map(|values| task.excesses(&design, &values));
    let good = excess.as_ref().is_some_and(|excess| task.holds(excess));
    RandomDesign { places, excess, good }
}

/// The box without the bad designs: of boxes around several good ones, the one with the most good designs and the
/// largest volume. `None` if all are bad.
fn trimmed(sides: &Sides, drawn: &[RandomDesign]) -> Option<Sides> {
    let (good, bad): (Vec<&RandomDesign>, Vec<&RandomDesign>) = drawn.iter().partition(|own| own.good);
    if bad.is_empty() {
        return Some(sides.clone());
    }
    let stride = good.len().div_ceil(ANCHORS).max(1);
    let boxes = good
        .iter()
        .step_by(stride)
        .map(|anchor| without(sides, &anchor.places, &good, &bad));
    boxes.max_by(|a, b| log_volume(a).total_cmp(&log_volume(b)))
}

/// The box around an anchor with each bad design cut off, along the design variable that loses the fewest good designs,
/// then the least volume.
fn without(sides: &Sides, anchor: &[f64], good: &[&RandomDesign], bad: &[&RandomDesign]) -> Sides {
    let mut sides = sides.clone();
    let mut order: Vec<&&RandomDesign> = bad.iter().collect();
    let distance = |own: &RandomDesign| own.places.iter().zip(anchor).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    for bad in order {
        if !holds(&sides, &bad.places) {
            continue;
        }
        let kept: Vec<&&RandomDesign> = good.iter().filter(|own| holds(&sides, &own.places)).collect();
        let cuts = (0..sides.len()).filter(|&k| bad.places[k] != anchor[k]).map(|k| {
            let at = cut_at(&kept, bad.places[k], anchor[k], k);
            let is_lost = |own: &&&&RandomDesign| (own.places[k] - at) * (anchor[k] - at) < 0.0;
            let lost = kept.iter().filter(is_lost).count();
            let [low, high] = sides[k];
            let left = if anchor[k] < at { at - low } else { high - at };
            (lost, -left / (high - low), k, at)
        });
        let best = cuts.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        if let Some((_, _, k, at)) = best {
            sides[k][usize::from(anchor[k] < at)] = at;
        }
    }
    sides
}

/// Position of a cut between a bad design and the good ones on the anchor's side: halfway to the nearest.
fn cut_at(good: &[&&RandomDesign], bad: f64, anchor: f64, variable: usize) -> f64 {
    let inside = good
        .iter()
        .map(|own| own.places[variable])
        .filter(|place| (place - bad) * (anchor - bad) > 0.0);
    let nearest = inside
        .chain([anchor])
        .min_by(|a, b| (a - bad).abs().total_cmp(&(b - bad).abs()));
    0.5 * (bad + nearest.unwrap_or(anchor))
}

fn holds(sides: &Sides, places: &[f64]) -> bool {
    sides
        .iter()
        .zip(places)
        .all(|([low, high], place)| low <= place && place <= high)
}

fn log_volume(sides: &Sides) -> f64 {
    sides.iter().map(|[low, high]| (high - low).max(1e-12).ln()).sum()
}

fn judged(task: &Task<'_>, sides: &Sides, drawn: &[RandomDesign], evaluated: usize) -> Space {
    let count = drawn.len();
    let good = drawn.iter().filter(|own| own.good).count();
    let met = |at: usize| {
        drawn
            .iter()
            .filter(|own| own.excess.as_ref().is_some_and(|excess| is_met(excess[at])))
            .count()
    };
    let each = 0..task.limits.len() + task.couplings.len();
    Space {
        intervals: task
            .variables
            .iter()
            .zip(sides)
            .map(|(variable, side)| side.map(|place| variable.at(place)))
            .collect(),
        probability: good as f64 / count as f64,
        at_least: lower_bound(good, count),
        each: each.map(|at| met(at) as f64 / count as f64).collect(),
        volume: log_volume(sides).exp(),
        evaluated,
    }
}

/// Share of good designs among `count` that shows a probability with 95 % confidence.
fn needed(count: usize, probability: f64) -> f64 {
    let enough = (0..=count)
        .rev()
        .take_while(|&good| tail(good, count, probability) < BY_CHANCE);
    enough.last().unwrap_or(count) as f64 / count as f64
}

/// Lower 95 % confidence bound of the probability for `good` of `count` designs: at this probability, as many or more
/// are found once in twenty times (Clopper and Pearson, Biometrika 26, 1934).
fn lower_bound(good: usize, count: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(good, count, middle) < BY_CHANCE {
            low = middle
        } else {
            high = middle
        }
    }
    low
}

/// Probability of at least `good` of `count`, if each is good with probability `p`.
fn tail(good: usize, count: usize, p: f64) -> f64 {
    let term = |k: usize| log_choose(count, k) + k as f64 * p.ln() + (count - k) as f64 * (-p).ln_1p();
    (good..=count).map(|k| term(k).exp()).sum::<f64>().min(1.0)
}

fn log_choose(n: usize, k: usize) -> f64 {
    (1..=k.min(n - k)).map(|i| ((n + 1 - i) as f64 / i as f64).ln()).sum()
}

#[cfg(test)]
mod tests {
    use super::{lower_bound, needed};

    /// If none is bad, p^n = 0.05.
    #[test]
    fn bounds_are_those_of_the_closed_form_where_all_are_good() {
        for count in [20, 59, 300] {
            let exact = 0.05_f64.powf(1.0 / count as f64);
            assert!((lower_bound(count, count) - exact).abs() < 1e-9);
        }
        assert_eq!(lower_bound(0, 10), 0.0);
    }

    /// The more designs there are, the fewer of them must be good.
    #[test]
    fn what_is_needed_is_just_enough() {
        for (count, probability) in [(480, 0.95), (400, 0.9), (2400, 0.99)] {
            let share = needed(count, probability);
            let good = (share * count as f64).round() as usize;
            assert!(lower_bound(good, count) >= probability && lower_bound(good - 1, count) < probability);
            assert!(share < needed(count / 4, probability));
        }
    }
}
