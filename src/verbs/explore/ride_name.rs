//! `--rides`: cleats and speeds.

use std::str::FromStr;

use qcar_runtime::campaign::Declared;
use qcar_runtime::error::InputError;
use qcar_runtime::simulate::Standard;

use crate::failure::flag;

/// `standard`, or a height and a speed such as `20mm@30km/h`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RideName {
    /// The twelve runs of the thesis.
    Standard,
    /// A cleat: height in m, and speed in m/s.
    Cleat(f64, f64),
}

impl FromStr for RideName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "standard" {
            return Ok(RideName::Standard);
        }
        let wrong = || format!("expected `standard`, or HEIGHT@SPEED such as 20mm@30km/h, found `{text}`");
        let (height, speed) = text.split_once('@').ok_or_else(wrong)?;
        let positive = |text: &str, unit: &str| {
            let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            let quantity = || Declared::quantity(text).filter(|(_, own)| own.is_like(unit));
            let value = number.or_else(|| Some(quantity()?.0));
            value.filter(|value| *value > 0.0).ok_or_else(wrong)
        };
        Ok(RideName::Cleat(positive(height, "m")?, positive(speed, "m/s")?))
    }
}

/// The rides.
///
/// # Errors
/// Fails if a height makes no cleat, or if a ride is named twice.
pub(super) fn rides(wanted: &[RideName]) -> Result<Vec<Standard>, InputError> {
    let mut rides = Vec::new();
    for (at, own) in wanted.iter().enumerate() {
        if wanted[..at].contains(own) {
            let remedy = "leave one of them out";
            return Err(flag("--rides", "a ride twice", "each ride once", remedy).into());
        }
        match own {
            RideName::Standard => rides.extend(Standard::all().expect("the standard cleats are roads")),
            RideName::Cleat(height, speed) => rides.push(Standard::over(*height, *speed).map_err(|error| {
                let remedy = "choose another height, such as 20mm";
                flag("--rides", error, "a cleat to drive over", remedy)
            })?),
        }
    }
    Ok(rides)
}

#[cfg(test)]
mod tests {
    use super::RideName;

    #[test]
    fn heights_and_speeds_have_units() {
        assert_eq!("20mm@36km/h".parse(), Ok(RideName::Cleat(0.02, 10.0)));
        assert_eq!("0.02@10".parse(), Ok(RideName::Cleat(0.02, 10.0)));
        assert_eq!("standard".parse(), Ok(RideName::Standard));
        for text in ["", "20mm", "20mm@", "20kg@10", "0@10", "20mm@-3", "fast"] {
            assert!(text.parse::<RideName>().is_err(), "{text}");
        }
    }
}
