//! An order that the simulator cannot make is refused.

use qcar_blind::hidden::Hidden;
use qcar_blind::{Order, make};

#[test]
fn a_law_at_a_place_where_the_simulator_does_not_have_it_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let slips = [("f_slip", 60.0), ("k_stick", 200e3)];
    let order = Order {
        effects: vec![Hidden::new("rubber_slip", "subframe_mount", &slips)],
        ..Order::clean("d", 1)
    };
    let message = make(order, folder.path()).expect_err("it acts at the powertrain's mount");
    assert_eq!(
        message,
        "rubber_slip at subframe_mount: the simulator has this law only at powertrain_mount"
    );
}
