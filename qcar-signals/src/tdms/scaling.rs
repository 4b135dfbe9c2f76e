//! Conversion from raw to physical values by the properties `NI_Scale[…]` of a channel.

use super::metadata::Properties;

/// Number of the input of a scale that takes raw values.
const RAW: u32 = u32::MAX;
/// Largest number of scales of a channel.
const MOST: usize = 32;

/// Scales, each of which takes raw values or the result of an earlier one.
pub(super) struct Scaling {
    /// The scales by their numbers; `None` for the number of a DAQmx scaler.
    scales: Vec<Option<Scale>>,
}

struct Scale {
    input: u32,
    /// Coefficients of 1, x, x² and so on.
    coefficients: Vec<f64>,
}

impl Scaling {
    /// The scales of a channel.
    ///
    /// # Errors
    /// Fails with the reason why they cannot be applied.
    pub(super) fn of(properties: &Properties) -> Result<Scaling, String> {
        let done = properties
            .text("NI_Scaling_Status")
            .is_some_and(|status| status == "scaled");
        let number = properties.number("NI_Number_Of_Scales").unwrap_or(0.0) as usize;
        if number > MOST {
            return Err(format!("{number} scales"));
        }
        let number = if done { 0 } else { number };
        let scales = (0..number).map(|at| scale(properties, &format!("NI_Scale[{at}]_")));
        Ok(Scaling {
            scales: scales.collect::<Result<_, _>>()?,
        })
    }

    /// The result of the last scale.
    ///
    /// # Errors
    /// Fails if the input of a scale does not exist.
    pub(super) fn apply(&self, mut raw: Vec<(Option<u32>, Vec<f64>)>) -> Result<Vec<f64>, String> {
        if raw.is_empty() {
            return Ok(Vec::new());
        }
        let Some(last) = self.scales.len().checked_sub(1) else {
            let (first, further) = (raw.swap_remove(0).1, raw.len());
            return match further {
                0 => Ok(first),
                _ => Err(format!(
                    "{} raw values a sample, and no scale that joins them",
                    further + 1
                )),
            };
        };
        // From the last scale back to the raw values, then forward again.
        let mut chain = Vec::new();
        let mut at = last as u32;
        while let Some(scale) = self.scales.get(at as usize).and_then(Option::as_ref) {
            chain.push(scale);
            if scale.input != RAW && scale.input >= at {
                return Err(format!("scale {at} that takes in scale {}", scale.input));
            }
            at = scale.input;
        }
        let source = raw
            .into_iter()
            .find(|(id, _)| id.is_none() || at == RAW || *id == Some(at));
        let (_, mut values) = source.ok_or_else(|| format!("a scale that takes in {at}, which is not there"))?;
        for scale in chain.iter().rev() {
            values.iter_mut().for_each(|value| *value = scale.of(*value));
        }
        Ok(values)
    }
}

impl Scale {
    fn of(&self, x: f64) -> f64 {
        match self.coefficients.as_slice() {
            &[intercept, slope] => x * slope + intercept,
            all => all.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient),
        }
    }
}

fn scale(properties: &Properties, name: &str) -> Result<Option<Scale>, String> {
    let number = |key: &str| {
        let value = properties.number(&format!("{name}{key}"));
        value.ok_or_else(|| format!("a scale without `{name}{key}`"))
    };
    let input = |key: &str| {
        properties
            .number(&format!("{name}{key}"))
            .map_or(RAW, |input| input as u32)
    };
    match properties.text(&format!("{name}Scale_Type")) {
        None => Ok(None),
        Some("Linear") => Ok(Some(Scale {
            input: input("Linear_Input_Source"),
            coefficients: vec![number("Linear_Y_Intercept")?, number("Linear_Slope")?],
        })),
        Some("Polynomial") => {
            let size = number("Polynomial_Coefficients_Size").unwrap_or(4.0).min(64.0) as usize;
            let coefficients = (0..size).map(|at| number(&format!("Polynomial_Coefficients[{at}]")));
            Ok(Some(Scale {
                input: input("Polynomial_Input_Source"),
                coefficients: coefficients.collect::<Result<_, _>>()?,
            }))
        }
        Some(other) => Err(format!("a scale of kind `{other}`")),
    }
}
