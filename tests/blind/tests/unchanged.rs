//! The campaigns of seeds 1 and 2 are those that the first tables are of.

use qcar_blind::matrix::cases;

use super::support::{records, rms};

/// RMS of every channel in a sweep and a drive of `clean d2`, as the simulator made them before it knew any flaw.
const SWEEP: [(&str, f64); 9] = [
    ("pad_left_z", 1.124094),
    ("pad_right_z", 1.108551),
    ("wheel_left_z", 0.975318),
    ("wheel_right_z", 0.977430),
    ("body_left_z", 0.162418),
    ("body_right_z", 0.162222),
    ("sf_front_z", 0.402956),
    ("sf_rear_z", 0.405374),
    ("pwt_centre_z", 0.762442),
];
const DRIVE: [(&str, f64); 9] = [
    ("wheel_left_z", 2.079682),
    ("body_left_z", 0.245578),
    ("sf_front_z", 0.960282),
    ("sf_rear_z", 0.968370),
    ("pwt_centre_z", 1.772523),
    ("wheel_left_x", 1.291332),
    ("body_left_x", 0.107557),
    ("sf_front_x", 0.318345),
    ("pwt_centre_x", 1.140424),
];

#[test]
fn a_campaign_without_flaws_is_what_it_was() {
    let case = cases(1).into_iter().find(|case| case.name == "clean d2 seed 1");
    let mut order = case.expect("a case of the matrix").order;
    order.programme.sweeps.retain(|run| run.level == 25);
    order.programme.kc.clear();
    order.programme.cleats.retain(|run| run.stream() == 10_000);
    let found = records(&order, ["rig/sweep_025.csv.gz", "cleat/v20_h10.csv"]);
    for (record, was) in found.iter().zip([SWEEP, DRIVE]) {
        assert_eq!(record.len(), was.len() + 1);
        for (channel, was) in was {
            let is = rms(&record[channel]);
            assert!((is - was).abs() < 2e-6, "{channel}: {is}, not {was}");
        }
    }
}

#[test]
fn a_case_has_a_name_of_its_own() {
    for seed in [1, 3] {
        let mut names: Vec<String> = cases(seed).into_iter().map(|case| case.name).collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
