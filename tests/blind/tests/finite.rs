//! Every number of a campaign is one, however stiff its laws are.

use std::fs;

use qcar_blind::hidden::Hidden;
use qcar_blind::programme::Programme;
use qcar_blind::{Order, make};

#[test]
fn a_damper_that_is_hard_at_the_ends_of_its_travel_has_a_curve() {
    let folder = tempfile::tempdir().expect("a folder");
    let order = Order {
        cleats: false,
        programme: Programme::fast(),
        effects: vec![Hidden::new("position_damper", "damper", &[("travel", 0.01)])],
        ..Order::clean("c", 4711)
    };
    make(order, folder.path()).expect("a campaign");
    let text = fs::read_to_string(folder.path().join("kc/bounce.csv")).expect("a curve");
    let mut cells = text.lines().skip(1).flat_map(|line| line.split(','));
    assert!(cells.all(|cell| cell.parse::<f64>().is_ok_and(f64::is_finite)));
}
