//! A search that holds some variables, against a closed form.

use qcar_runtime::least_squares::{Bounds, minimize_holding};

use super::dual::{Dual, Functions};
use super::{TIGHT, assert_close};

/// With x0 = 2 and x2 = 4 held, (x1 - 1)² + (4 x1 - 8)² is least at 33/17. The Jacobian is that by all variables.
#[test]
fn held_variables_keep_their_start_and_have_derivatives() {
    let mut problem = Functions {
        variables: 3,
        residuals: 2,
        residual: |x: &[Dual], row: usize| match row {
            0 => x[0] + x[1] - Dual::from(3.0),
            _ => x[1] * x[2] - Dual::from(8.0),
        },
    };
    let is_held = [true, false, true];
    let minimum = 33.0 / 17.0;
    let found = minimize_holding(&mut problem, &[2.0, 0.5, 4.0], &is_held, &Bounds::none(3), &TIGHT);
    assert_close(&found.x, &[2.0, minimum, 4.0], 1e-9);
    assert_close(found.jacobian.as_slice(), &[1.0, 0.0, 1.0, 4.0, 0.0, minimum], 1e-9);
    assert_close(found.residual.as_slice(), &[minimum - 1.0, 4.0 * minimum - 8.0], 1e-9);

    let bounds = Bounds {
        lower: vec![1.0, 0.0, 1.0],
        upper: vec![3.0, 1.5, 5.0],
    };
    let found = minimize_holding(&mut problem, &[2.0, 0.5, 4.0], &is_held, &bounds, &TIGHT);
    assert_close(&found.x, &[2.0, 1.5, 4.0], 1e-6);
    assert_eq!(found.at_bound, [0, 1, 0]);
}
