//! The solution space of an axle, judged by a hundred thousand designs inside it.

use models::axle_d::AxleD;
use qcar_runtime::campaign::RoleNames;
use qcar_runtime::metric::Ground;
use qcar_runtime::model::Model;
use qcar_runtime::progress::NO_PROGRESS;
use qcar_runtime::random::SplitMix;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::sensitivity::Chance;
use qcar_runtime::target::{Axle, DesignVariable, Limit, Move, Sense, Space, SpaceSettings, Task, space};
use rayon::prelude::*;

use super::cleat;

/// What may move, by a fifth.
const VARIABLES: [&str; 6] = ["k_wheel_z", "c_wheel_z", "k_tire", "m_wheel", "k_pwt_z", "c_pwt_z"];

/// Metrics that need no ride, and what they may be of today's values.
const LIMITS: [(&str, Sense, f64); 5] = [
    ("mode.1.frequency", Sense::AtMost, 1.02),
    ("mode.1.damping", Sense::AtLeast, 0.95),
    ("mode.2.damping", Sense::AtLeast, 0.93),
    ("mode.3.damping", Sense::AtLeast, 0.93),
    ("mode.3.frequency", Sense::AtMost, 1.03),
];

/// Inside, as many designs are good as were asked for; and the box is no smaller than that needs.
#[test]
fn a_hundred_thousand_designs_in_the_space_of_an_axle_are_as_good_as_it_says() {
    const WANTED: f64 = 0.95;
    let values = cleat::parameters();
    let mut ground = Ground::new(&AxleD, &values, &RoleNames::default(), None, Vec::new());
    let places = LIMITS.map(|(name, ..)| {
        let own = ground.metrics().iter().position(|metric| metric.name == name);
        own.expect("the axle has this metric")
    });
    ground.choose(places.iter().flat_map(|&at| ground.readings_of(at)).collect());
    let today = ground.measure(&values).expect("it is measured");
    let task_of = |axle| task(axle, &values, &today);
    let axle = Axle {
        ground: &ground,
        values: values.clone(),
        moves: moves(),
        variables: VARIABLES.len(),
        means: Vec::new(),
        chance: Chance::default(),
    };
    let found = space(&task_of(&axle), &[], SpaceSettings::default(), NO_PROGRESS).expect("there are good designs");
    assert!(found.at_least >= WANTED, "{found:?}");
    let share = good_inside(&task_of(&axle), &found, 100_000);
    println!("{share}");
    assert!((WANTED..0.975).contains(&share), "{share} of {found:?}");
}

fn place(name: &str) -> usize {
    let own = AxleD.about().parameters.iter().position(|own| own.name == name);
    own.expect("the axle has this parameter")
}

fn moves() -> Vec<Move> {
    let own = |(variable, name): (usize, &&str)| Move {
        variable,
        parameter: place(name),
        factor: 1.0,
        constant: 0.0,
    };
    VARIABLES.iter().enumerate().map(own).collect()
}

fn task<'a>(axle: &'a Axle<'a>, values: &Values, today: &[f64]) -> Task<'a> {
    let variable = |name: &&str| {
        let own = values.as_slice()[place(name)];
        DesignVariable {
            name: name.to_string(),
            lower: 0.8 * own,
            upper: 1.2 * own,
            today: own,
            step: None,
            cost: 1.0,
        }
    };
    let limit = |(result, (_, sense, part)): (usize, &(&str, Sense, f64))| Limit {
        result,
        sense: *sense,
        value: part * today[result],
        wish: None,
        margin: 0.0,
    };
    Task {
        designs: axle,
        variables: VARIABLES.iter().map(variable).collect(),
        limits: LIMITS.iter().enumerate().map(limit).collect(),
        couplings: Vec::new(),
    }
}

/// The share of good ones of so many designs that are spread evenly over a box.
fn good_inside(task: &Task<'_>, of: &Space, count: u64) -> f64 {
    let is_good = |number: &u64| {
        let mut random = SplitMix::stream(31, *number);
        let design = of
            .intervals
            .iter()
            .map(|[low, high]| low + (high - low) * random.uniform());
        task.is_good(&design.collect::<Vec<_>>())
    };
    (0..count).into_par_iter().filter(is_good).count() as f64 / count as f64
}
