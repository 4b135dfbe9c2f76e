//! Means and root mean squares. Without values they are zero, except [`rms_or_nan`].

use std::borrow::Borrow;

/// The mean.
pub fn mean(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    let add = |(sum, count): (f64, usize), value: f64| (sum + value, count + 1);
    let values = values.into_iter().map(|value| *value.borrow());
    let (sum, count) = values.fold((0.0, 0), add);
    sum / count.max(1) as f64
}

/// The mean of the squares.
pub fn mean_square(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    mean(values.into_iter().map(|value| value.borrow() * value.borrow()))
}

/// The root mean square.
pub fn rms(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    mean_square(values).sqrt()
}

/// The root mean square; NaN without values.
pub fn rms_or_nan(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    let mut values = values.into_iter().peekable();
    match values.peek() {
        Some(_) => rms(values),
        None => f64::NAN,
    }
}

/// The root mean square about the mean.
pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    rms(values.iter().map(|value| value - mean))
}

/// Quantile of ascending values, interpolated between neighbours; there must be a value.
pub fn quantile(ascending: &[f64], share: f64) -> f64 {
    let place = share * (ascending.len() - 1) as f64;
    let below = place as usize;
    let above = (below + 1).min(ascending.len() - 1);
    ascending[below] + (place - below as f64) * (ascending[above] - ascending[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_has_no_deviation_and_nothing_no_size() {
        assert_eq!((rms([3.0, -3.0]), deviation(&[3.0, 3.0])), (3.0, 0.0));
        assert_eq!((mean([1.0, 2.0, 6.0]), deviation(&[-1.0, 1.0])), (3.0, 1.0));
        assert_eq!(rms([0.0; 0]), 0.0);
        assert!(rms_or_nan([0.0; 0]).is_nan());
    }
}
