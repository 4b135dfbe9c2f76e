//! The compiled axle models that qcar ships: a module for each file of `axles/`, and a list of them. Also the texts of
//! the effects that a model may lack (`effects/`), and of laws without a physical cause (`laws/`).

use qcar_runtime::model::Model;

include!(concat!(env!("OUT_DIR"), "/models.rs"));

/// A model of this package.
#[derive(Clone, Copy)]
pub struct Shipped {
    /// Its name, which is also the name of its module.
    pub name: &'static str,
    /// Its file, relative to this package.
    pub file: &'static str,
    /// The text of that file.
    pub text: &'static str,
    /// The family files that it loads: the path as the model writes it, and the text.
    pub families: &'static [(&'static str, &'static str)],
    /// The compiled model.
    pub model: &'static dyn Model,
}

/// All models, by name.
pub fn all() -> &'static [Shipped] {
    SHIPPED
}

/// The model of a name.
pub fn find(name: &str) -> Option<&'static Shipped> {
    SHIPPED.iter().find(|shipped| shipped.name == name)
}

/// An effect of this package.
#[derive(Clone, Copy)]
pub struct ShippedEffect {
    /// Its name.
    pub name: &'static str,
    /// Its file, relative to this package.
    pub file: &'static str,
    /// The text of that file.
    pub text: &'static str,
}

/// All effects, by name.
pub fn effects() -> &'static [ShippedEffect] {
    EFFECTS
}

/// All laws without a physical cause, by name: curves over travel, speed or frequency with free coefficients, for
/// residuals that no effect explains.
pub fn laws() -> &'static [ShippedEffect] {
    LAWS
}
