//! The axle models that qcar ships, compiled: a module for each file of `axles/`, and a list of them. And the texts of the
//! effects that may be missing in a model: the files of `effects/`, and, of no cause in particular, those of `laws/`.

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

/// All laws that name no cause, by name: curves of travel, speed or frequency whose coefficients are free, for where no
/// effect explains what a model leaves.
pub fn laws() -> &'static [ShippedEffect] {
    LAWS
}
