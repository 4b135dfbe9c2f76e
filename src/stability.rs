//! Parameter values at which a model is unstable.

use qcar_runtime::free_motions::{MOST_STATES, growing};
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;

use crate::table::number;

/// A sentence for a model whose motion at rest grows, or which has too many states for this check; `None` if it is
/// stable.
pub fn unstable(model: &dyn Model, values: &Values) -> Option<String> {
    let about = model.about();
    if about.states.len() > MOST_STATES {
        return Some(format!(
            "whether model {} is stable was not checked, since it has {} states, more than {MOST_STATES}; `qcar modes` lists \
             each of its motions and says which grow",
            about.name,
            about.states.len()
        ));
    }
    let root = growing(model, values)?;
    let oscillation = if root.im == 0.0 {
        String::new()
    } else {
        format!(" ± {}i", number(root.im.abs(), 4))
    };
    Some(format!(
        "model {} is unstable at these values: it has the eigenvalue {}{oscillation} 1/s, so a motion grows until the \
         model no longer holds; check the signs of its stiffnesses and dampings, and the gains and delays of active links",
        about.name,
        number(root.re, 4)
    ))
}
