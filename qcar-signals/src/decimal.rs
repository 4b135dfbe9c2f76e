//! Decimal numbers in fixed columns and cells, faster than `str::parse` and with the same bits.

/// Powers of ten that a double holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// Up to this integer, a double holds every integer exactly.
const LARGEST: u64 = 1 << f64::MANTISSA_DIGITS;
/// As many digits never overflow a `u64`.
const MOST_DIGITS: usize = 19;

/// A decimal number between spaces, if its digits and its power of ten are exact doubles: then the one product or quotient is
/// rounded correctly, as `str::parse` rounds. `None` for other numbers, and for any other text.
///
/// `point` is the decimal sign, and an exponent follows one of the letters in `exponents`.
///
/// Source: Clinger, "How to read floating point numbers accurately", 1990, section 3.
#[inline]
pub(crate) fn exact(text: &[u8], point: u8, exponents: &[u8]) -> Option<f64> {
    let (negative, text) = signed(text.trim_ascii());
    let (mut mantissa, mut rest) = digits(text, 0)?;
    let mut count = text.len() - rest.len();
    let mut power = 0;
    if let [sign, fraction @ ..] = rest
        && *sign == point
    {
        (mantissa, rest) = digits(fraction, mantissa)?;
        let places = fraction.len() - rest.len();
        count += places;
        power -= places as i64;
    }
    if let [letter, exponent @ ..] = rest
        && exponents.contains(letter)
    {
        let (falls, exponent) = signed(exponent);
        let (size, beyond) = digits(exponent, 0)?;
        let size = u32::try_from(size).ok().filter(|_| !exponent.is_empty())?;
        power += i64::from(size) * if falls { -1 } else { 1 };
        rest = beyond;
    }
    if !rest.is_empty() || !(1..=MOST_DIGITS).contains(&count) || mantissa > LARGEST {
        return None;
    }
    let factor = POWERS.get(power.unsigned_abs() as usize)?;
    let size = match power < 0 {
        true => mantissa as f64 / factor,
        false => mantissa as f64 * factor,
    };
    Some(if negative { -size } else { size })
}

/// Whether a minus sign stands in front, and what follows the sign.
fn signed(text: &[u8]) -> (bool, &[u8]) {
    match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    }
}

/// The integer of the leading digits, appended to those of `number`, and what follows them. `None` for more than
/// [`MOST_DIGITS`].
fn digits(text: &[u8], mut number: u64) -> Option<(u64, &[u8])> {
    let mut rest = text;
    while let Some((eight, beyond)) = rest.split_first_chunk()
        && let Some(value) = eight_digits(*eight)
    {
        number = number.wrapping_mul(100_000_000).wrapping_add(value);
        rest = beyond;
    }
    while let [digit @ b'0'..=b'9', beyond @ ..] = rest {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        rest = beyond;
    }
    (text.len() - rest.len() <= MOST_DIGITS).then_some((number, rest))
}

/// The number of eight digits, from three products: of neighbouring digits, of neighbouring pairs, and of both halves.
///
/// Source: Lemire, "Number parsing at a gigabyte per second", 2021, section 3.
fn eight_digits(digits: [u8; 8]) -> Option<u64> {
    const TENS: u64 = u64::from_le_bytes([b'0'; 8]);
    const HIGH: u64 = u64::from_le_bytes([0xf0; 8]);
    const PAIR: u64 = 0x0000_00ff_0000_00ff;
    let text = u64::from_le_bytes(digits);
    let above_nine = text.wrapping_add(u64::from_le_bytes([6; 8]));
    if text & HIGH != TENS || above_nine & HIGH != TENS {
        return None;
    }
    let pairs = (text - TENS).wrapping_mul((10 << 8) + 1) >> 8;
    let first_and_third = (pairs & PAIR).wrapping_mul((1_000_000 << 32) + 100);
    let second_and_fourth = (pairs >> 16 & PAIR).wrapping_mul((10_000 << 32) + 1);
    Some(first_and_third.wrapping_add(second_and_fourth) >> 32)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{eight_digits, exact};

    /// As the reader of UFF does: `D` and `E` before exponents.
    fn fast(text: &str) -> Option<f64> {
        exact(text.as_bytes(), b'.', b"eEdD")
    }

    fn slow(text: &str) -> Option<f64> {
        text.trim_ascii().replace(['d', 'D'], "e").parse().ok()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn numbers_of_any_size_have_the_bits_of_the_standard_library(bits: u64, precision in 0_usize..19) {
            let number = f64::from_bits(bits);
            for text in [format!("{number:>20.precision$E}"), format!("{number:.precision$}")] {
                if let Some(own) = fast(&text) {
                    prop_assert_eq!(Some(own.to_bits()), slow(&text).map(f64::to_bits), "{}", text);
                }
            }
        }

        #[test]
        fn numbers_in_the_columns_of_uff_take_the_fast_path(mantissa in 1_f64..9.9, power in -9_i32..10, sign in prop::sample::select(vec![-1.0, 1.0])) {
            let number = sign * mantissa * 10_f64.powi(power);
            for text in [format!("{number:>13.5E}"), format!("{number:>20.12E}")] {
                prop_assert_eq!(fast(&text).map(f64::to_bits), slow(&text).map(f64::to_bits), "{}", text);
            }
        }

        #[test]
        fn a_text_is_a_number_only_if_the_standard_library_reads_it(text in " {0,2}[-+]?[0-9]{0,20}[.,]?[0-9]{0,9}([eEdDx][-+]?[0-9]{0,3})?[ .]{0,2}") {
            if let Some(own) = fast(&text) {
                prop_assert_eq!(Some(own.to_bits()), slow(&text).map(f64::to_bits), "{}", text);
            }
        }

        #[test]
        fn eight_bytes_are_a_number_only_if_all_are_digits(text in "[0-9]{8}|[/0-9:]{8}", byte: u8, place in 0_usize..8) {
            let mut bytes: [u8; 8] = text.as_bytes().try_into().unwrap();
            prop_assert_eq!(eight_digits(bytes), text.parse().ok());
            bytes[place] = byte;
            let all = bytes.iter().all(u8::is_ascii_digit);
            prop_assert_eq!(eight_digits(bytes).is_some(), all);
        }
    }
}
