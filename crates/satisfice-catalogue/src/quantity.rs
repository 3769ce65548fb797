//! Times, counts and settings as they are written on a command line and in a suite.

use std::time::Duration;

use satisfice::Budget;

/// Units of time, in seconds.
const UNITS: [(&str, f64); 9] = [
    ("ns", 1e-9),
    ("us", 1e-6),
    ("µs", 1e-6),
    ("μs", 1e-6),
    ("ms", 1e-3),
    ("s", 1.0),
    ("min", 60.0),
    ("h", 3600.0),
    ("d", 86400.0),
];

/// The greatest number of threads: more is a typing error.
const MOST_THREADS: usize = 1024;

/// The greatest width of a ring in edges: more is a typing error.
const MOST_EDGES: usize = 1000;

/// A time: a positive number with a unit, `100ms`, `1.5s`, `3min`.
///
/// # Errors
/// A message with an example, for any other text.
pub fn time(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let end = text
        .find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E')
        .unwrap_or(text.len());
    let (number, unit) = (text[..end].trim(), text[end..].trim());
    let Ok(number) = number.parse::<f64>() else {
        return Err("a time is a number with a unit, such as 100ms, 1.5s or 3min".to_owned());
    };
    if unit.is_empty() && number > 0.0 {
        return Err(format!("a time needs a unit: write {number}ms or {number}s"));
    }
    // No unit makes a time of a number that is not positive.
    let unit = if unit.is_empty() { "s" } else { unit };
    let Some((_, seconds)) = UNITS.iter().find(|(name, _)| *name == unit) else {
        return Err(format!("the unit `{unit}` is none of ns, us, ms, s, min, h, d"));
    };
    match Duration::try_from_secs_f64(number * seconds) {
        Ok(time) if !time.is_zero() => Ok(time),
        Ok(_) => Err("a time must be at least 1ns".to_owned()),
        Err(_) if number < 0.0 => Err("a time must be positive".to_owned()),
        Err(_) => Err("a time must be finite and less than 500 billion years".to_owned()),
    }
}

/// A whole number, also as `1e6` or `1_000_000`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole and between 0 and 2^53"
)]
fn number(text: &str) -> Option<u64> {
    let plain = text.trim().replace('_', "");
    plain.parse::<u64>().ok().or_else(|| {
        let number = plain.parse::<f64>().ok()?;
        (number.fract() == 0.0 && (0.0..=9e15).contains(&number)).then_some(number as u64)
    })
}

/// A whole number of at least 1, also as `1e6` or `1_000_000`.
///
/// # Errors
/// Any other text.
pub fn count(text: &str) -> Result<u64, String> {
    match number(text) {
        None if text
            .trim()
            .replace('_', "")
            .parse::<f64>()
            .is_ok_and(|number| number > 9e15) =>
        {
            Err("must be at most 9e15".to_owned())
        }
        Some(0) => Err("must be at least 1".to_owned()),
        Some(number) => Ok(number),
        None => Err("must be a whole number of at least 1, such as 5000 or 1e6".to_owned()),
    }
}

/// A whole number within bounds, also as `1e3`.
///
/// # Errors
/// Any other text, with the bounds.
pub fn whole<N: TryFrom<u64>>(text: &str, least: u64, most: u64) -> Result<N, String> {
    number(text)
        .filter(|number| (least..=most).contains(number))
        .and_then(|number| N::try_from(number).ok())
        .ok_or_else(|| format!("must be a whole number from {least} to {most}"))
}

/// Any seed.
///
/// # Errors
/// Any other text.
pub fn seed(text: &str) -> Result<u64, String> {
    text.trim()
        .parse()
        .map_err(|_| "must be a whole number from 0 to 2^64 - 1".to_owned())
}

/// A number of threads, 0 for as many as there are cores.
///
/// # Errors
/// Any other text.
pub fn threads(text: &str) -> Result<usize, String> {
    checked_threads(text.trim().parse().unwrap_or(usize::MAX))
}

/// A number of threads that is no typing error, 0 for as many as there are cores.
///
/// # Errors
/// More than 1024.
pub fn checked_threads(threads: usize) -> Result<usize, String> {
    if threads <= MOST_THREADS {
        return Ok(threads);
    }
    Err(format!(
        "must be a whole number from 0 (all cores) to {MOST_THREADS}"
    ))
}

/// A number of islands.
///
/// # Errors
/// Any other text.
pub fn islands(text: &str) -> Result<usize, String> {
    whole(text, 1, MOST_THREADS as u64)
}

/// How many evaluations go on at once.
///
/// # Errors
/// Any other text.
pub fn parallel(text: &str) -> Result<usize, String> {
    whole(text, 1, Budget::MOST_PARALLEL as u64)
}

/// How many processes compute values at once.
///
/// # Errors
/// Any other text.
pub fn workers(text: &str) -> Result<u16, String> {
    whole(text, 1, MOST_THREADS as u64)
}

/// How many times something is tried again.
///
/// # Errors
/// Any other text.
pub fn retries(text: &str) -> Result<u32, String> {
    whole(text, 0, u64::from(u32::MAX))
}

/// A number of edges, 0 included.
///
/// # Errors
/// Any other text.
pub fn width(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(width) if width <= MOST_EDGES => Ok(width),
        _ => Err(format!("must be a whole number of edges from 0 to {MOST_EDGES}")),
    }
}

/// `name=value`.
///
/// # Errors
/// Any other text.
pub fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("a setting is name=value, such as n=6".to_owned()),
    }
}

/// A share of the evaluations for probes.
///
/// # Errors
/// Any other text.
pub fn share(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(share) if (0.0..=0.5).contains(&share) => Ok(share),
        _ => Err("must be a number from 0 to 0.5".to_owned()),
    }
}

/// A positive, finite number.
///
/// # Errors
/// Any other text.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a positive, finite number".to_owned()),
    }
}

/// A finite number, 0 or greater.
///
/// # Errors
/// Any other text.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number >= 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a finite number, 0 or greater".to_owned()),
    }
}

/// Quantities as text for people.
pub mod shown {
    /// A count with separated thousands: `1,000,000`.
    #[must_use]
    pub fn count(count: u64) -> String {
        let digits = count.to_string();
        let mut text = String::new();
        for (place, digit) in digits.chars().enumerate() {
            if place > 0 && (digits.len() - place).is_multiple_of(3) {
                text.push(',');
            }
            text.push(digit);
        }
        text
    }

    /// A number that need not be whole: rounded from 100 on, with three digits below.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole, from 0 to 1e15"
    )]
    pub fn number(value: f64) -> String {
        if (0.0..1e15).contains(&value) && (value >= 100.0 || value.fract() == 0.0) {
            return count(value.round() as u64);
        }
        match value.abs() {
            v if !v.is_finite() => "-".to_owned(),
            v if v >= 1e15 => format!("{value:.2e}"),
            v if v >= 10.0 => format!("{value:.1}"),
            v if v >= 0.01 => format!("{value:.2}"),
            _ => format!("{value:.1e}"),
        }
    }

    /// A number with all its digits, as short as it can be: `0.5`, `1e-160`.
    #[must_use]
    pub fn exact(value: f64) -> String {
        if value != 0.0 && !(1e-5..1e16).contains(&value.abs()) {
            return format!("{value:e}");
        }
        value.to_string()
    }

    /// A time in a suitable unit, with three digits.
    #[must_use]
    pub fn seconds(seconds: f64) -> String {
        let (value, unit) = match seconds {
            s if s < 1e-6 => (s * 1e9, "ns"),
            s if s < 1e-3 => (s * 1e6, "us"),
            s if s < 1.0 => (s * 1e3, "ms"),
            s if s < 120.0 => (s, "s"),
            s => (s / 60.0, "min"),
        };
        let digits = if value >= 99.95 || (value - value.round()).abs() < 1e-9 {
            0
        } else if value >= 9.995 {
            1
        } else {
            2
        };
        format!("{value:.digits$} {unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_numbers_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (0.1, "0.1"),
            (100.0, "100"),
            (1e-160, "1e-160"),
            (-1e308, "-1e308"),
        ] {
            assert_eq!((shown::exact(x).as_str(), text.parse()), (text, Ok(x)));
        }
    }

    #[test]
    fn times() {
        for (text, expected) in [
            ("100ms", Duration::from_millis(100)),
            ("2s", Duration::from_secs(2)),
            ("1.5s", Duration::from_millis(1500)),
            ("1e-3 s", Duration::from_millis(1)),
            ("3min", Duration::from_secs(180)),
            ("100us", Duration::from_micros(100)),
            ("100µs", Duration::from_micros(100)),
            ("1ns", Duration::from_nanos(1)),
            ("2h", Duration::from_secs(7200)),
        ] {
            assert_eq!(time(text).as_ref(), Ok(&expected), "{text}");
        }
        for (text, says) in [
            ("100", "a time needs a unit: write 100ms or 100s"),
            ("0s", "at least 1ns"),
            ("0", "at least 1ns"),
            ("-1", "must be positive"),
            ("0.1ns", "at least 1ns"),
            ("-1s", "must be positive"),
            ("-0s", "at least 1ns"),
            ("1e300d", "must be finite"),
            ("inf s", "such as 100ms"),
            ("NaNs", "such as 100ms"),
            ("1 fortnight", "the unit `fortnight` is none of"),
            ("s", "such as 100ms"),
            ("", "such as 100ms"),
            ("--json", "such as 100ms"),
        ] {
            assert!(
                time(text).is_err_and(|error| error.contains(says)),
                "{text}: {:?}",
                time(text)
            );
        }
    }

    #[test]
    fn people_can_read_them() {
        for (count, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")] {
            assert_eq!(shown::count(count), text);
        }
        for (number, text) in [
            (0.0, "0"),
            (2.5, "2.50"),
            (31.25, "31.2"),
            (1234.5, "1,235"),
            (3e-4, "3.0e-4"),
        ] {
            assert_eq!(shown::number(number), text);
        }
        for (seconds, text) in [
            (0.1, "100 ms"),
            (0.0123, "12.3 ms"),
            (4.2e-7, "420 ns"),
            (90.0, "90 s"),
            (600.0, "10 min"),
        ] {
            assert_eq!(shown::seconds(seconds), text);
        }
    }

    #[test]
    fn counts() {
        for (text, expected) in [
            ("1", 1),
            ("1e6", 1_000_000),
            ("1_000", 1000),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(count(text), Ok(expected), "{text}");
        }
        for text in ["0", "-1", "1.5", "1e-3", "NaN", "inf", "1e30", "many", ""] {
            assert!(count(text).is_err(), "{text}");
        }
    }

    #[test]
    fn evaluations_at_once_have_the_limit_of_a_budget() {
        assert_eq!((parallel("8"), parallel("65536")), (Ok(8), Ok(65_536)));
        for text in ["0", "65537", "1e12", "-1", "many"] {
            assert_eq!(
                parallel(text),
                Err("must be a whole number from 1 to 65536".to_owned())
            );
        }
    }

    #[test]
    fn numbers_within_bounds_may_have_a_power_of_ten() {
        assert_eq!(
            (workers("1"), workers("1e3"), retries("0")),
            (Ok(1), Ok(1000), Ok(0))
        );
        for text in ["0", "1025", "1e9", "-1", "1.5", "many", ""] {
            assert_eq!(
                workers(text),
                Err("must be a whole number from 1 to 1024".to_owned())
            );
        }
        assert_eq!(
            retries("1e12"),
            Err("must be a whole number from 0 to 4294967295".to_owned())
        );
    }

    #[test]
    fn settings() {
        assert_eq!(setting("n=6"), Ok(("n".to_owned(), "6".to_owned())));
        assert_eq!(setting("file=a=b"), Ok(("file".to_owned(), "a=b".to_owned())));
        assert_eq!(setting("file="), Ok(("file".to_owned(), String::new())));
        for text in ["n6", "=6", ""] {
            assert!(setting(text).is_err(), "{text}");
        }
    }

    #[test]
    fn positive_numbers() {
        assert_eq!(positive("1e-9"), Ok(1e-9));
        for text in ["0", "-1", "NaN", "inf", "wide"] {
            assert!(positive(text).is_err(), "{text}");
        }
    }
}
