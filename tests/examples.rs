//! The examples run as they stand, without arguments.

#[path = "../examples/discover.rs"]
mod discover;
#[path = "../examples/fit.rs"]
mod fit;
#[path = "../examples/inline.rs"]
mod inline;
#[path = "../examples/jacobians.rs"]
mod jacobians;
#[path = "../examples/model_file.rs"]
mod model_file;
#[path = "../examples/ride.rs"]
mod ride;

/// A test of each example; `main` of one that fails says why.
macro_rules! run {
    ($($(#[$attribute:meta])* $name:ident)*) => {
        $(
            #[test]
            $(#[$attribute])*
            fn $name() {
                if let Err(error) = super::$name::main() {
                    panic!("{error}");
                }
            }
        )*
    };
}

mod runs {
    run!(
        #[ignore = "a whole search; .ci/run runs it"] discover
        fit inline jacobians model_file ride
    );
}
