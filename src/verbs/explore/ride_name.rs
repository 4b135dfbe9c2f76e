//! `--rides`: cleats and speeds.

use std::str::FromStr;

use qcar_runtime::error::InputError;
use qcar_runtime::shown::shown;
use qcar_runtime::simulate::Standard;

use crate::failure::flag;
use crate::roads::{check_speed, quantity};

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
        let wrong = || {
            format!("expected `standard`, or HEIGHT@SPEED with the units of both, such as 20mm@30km/h, found `{text}`")
        };
        let (height, speed) = text.split_once('@').ok_or_else(wrong)?;
        let height = quantity(height, "m").filter(|height| *height > 0.0);
        let (height, speed) = height.zip(quantity(speed, "m/s")).ok_or_else(wrong)?;
        Ok(RideName::Cleat(height, speed))
    }
}

/// The rides of a tyre with this radius (m).
///
/// # Errors
/// Fails if a height makes no cleat over which the tyre can roll, if a ride is too slow or too fast, or if a ride is
/// named twice.
pub(super) fn rides(wanted: &[RideName], radius: f64) -> Result<Vec<Standard>, InputError> {
    let mut rides = Vec::new();
    for (at, own) in wanted.iter().enumerate() {
        if wanted[..at].contains(own) {
            let remedy = "leave one of them out";
            return Err(flag("--rides", "a ride twice", "each ride once", remedy).into());
        }
        match own {
            RideName::Standard => rides.extend(Standard::all().expect("the standard cleats are roads")),
            RideName::Cleat(height, speed) => rides.push(over(*height, *speed, radius)?),
        }
    }
    Ok(rides)
}

fn over(height: f64, speed: f64, radius: f64) -> Result<Standard, InputError> {
    check_speed(speed, |found, expected, remedy| {
        flag("--rides", found, expected, remedy)
    })?;
    let remedy = "choose another height, such as 20mm";
    // A wheel is stopped by a step that reaches its axis.
    if height >= radius {
        let found = format!("a cleat of {}", shown(height, "m"));
        let expected = format!("a cleat lower than the radius of the tyre, {}", shown(radius, "m"));
        return Err(flag("--rides", found, &expected, remedy).into());
    }
    let over = Standard::over(height, speed);
    Ok(over.map_err(|error| flag("--rides", &error, &error.expected(), remedy))?)
}

#[cfg(test)]
mod tests {
    use super::RideName;

    #[test]
    fn heights_and_speeds_have_units() {
        assert_eq!("20mm@36km/h".parse(), Ok(RideName::Cleat(0.02, 10.0)));
        assert_eq!("0.02 m@10 m/s".parse(), Ok(RideName::Cleat(0.02, 10.0)));
        assert_eq!("standard".parse(), Ok(RideName::Standard));
        for text in [
            "",
            "20mm",
            "20mm@",
            "20@30km/h",
            "20mm@30",
            "0.02@10",
            "20kg@10m/s",
            "0mm@10m/s",
            "fast",
        ] {
            assert!(text.parse::<RideName>().is_err(), "{text}");
        }
    }
}
