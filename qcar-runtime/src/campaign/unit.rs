//! Coherent SI units as campaigns write them: `N s/m`, `N*s/m`, `kg m^2`, `m/s^2`, `1`.

/// Exponents of kilogram, metre and second. The radian counts as 1.
pub type Dimension = [i32; 3];

/// The dimension of a unit, or `None` where it is not a coherent SI unit (`N/mm`, `g`, `bar`, `deg`).
///
/// Everything after the one `/` divides: `N s/m`, `m/s^2`; another needs parentheses, `N/(m/s)`.
pub fn dimension(unit: &str) -> Option<Dimension> {
    let spaced = unit.replace('*', " ").replace(" ^ ", "^");
    let Some((above, below)) = spaced.split_once('/') else {
        return product(&spaced);
    };
    let below = match below.trim().strip_prefix('(') {
        Some(rest) => dimension(rest.strip_suffix(')')?)?,
        None => product(below)?,
    };
    let above = product(above)?;
    Some(std::array::from_fn(|i| above[i] - below[i]))
}

fn product(text: &str) -> Option<Dimension> {
    let mut factors = text.split_whitespace().peekable();
    factors.peek()?;
    factors.try_fold([0; 3], |sum, factor| {
        let (symbol, exponent) = match factor.split_once('^') {
            Some((symbol, exponent)) => (symbol, exponent.parse().ok()?),
            None => (factor, 1),
        };
        let base = base(symbol)?;
        Some(std::array::from_fn(|i| sum[i] + exponent * base[i]))
    })
}

fn base(symbol: &str) -> Option<Dimension> {
    Some(match symbol {
        "1" | "rad" => [0, 0, 0],
        "kg" => [1, 0, 0],
        "m" => [0, 1, 0],
        "s" => [0, 0, 1],
        "Hz" => [0, 0, -1],
        "N" => [1, 1, -2],
        "Pa" => [1, -1, -2],
        "J" => [1, 2, -2],
        "W" => [1, 2, -3],
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::dimension;

    #[test]
    fn spellings_of_one_unit_agree() {
        let damping = dimension("N s/m");
        assert_eq!(damping, Some([1, 0, -1]));
        for spelling in ["N*s/m", "N s / m", "N/(m/s)", "kg/s", "s N/m"] {
            assert_eq!(dimension(spelling), damping, "{spelling}");
        }
        assert_eq!(dimension("m/s^2"), Some([0, 1, -2]));
        assert_eq!(dimension("1"), Some([0, 0, 0]));
    }

    #[test]
    fn what_is_not_coherent_has_no_dimension() {
        for unit in ["N/mm", "g", "", "/m", "N//m", "m^x", "deg", "N s/", "kN", "m/s/s"] {
            assert_eq!(dimension(unit), None, "{unit}");
        }
    }
}
