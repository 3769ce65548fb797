//! Times, counts and settings as they are written on a command line.

use std::time::Duration;

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

/// More threads than that are a slip of the keyboard.
const MOST_THREADS: usize = 1024;

/// Wider rings than that are a slip of the keyboard, too.
const MOST_EDGES: usize = 1000;

/// A time: a positive number with a unit, `100ms`, `1.5s`, `3min`.
pub(crate) fn time(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let end = text
        .find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E')
        .unwrap_or(text.len());
    let (number, unit) = (text[..end].trim(), text[end..].trim());
    let Ok(number) = number.parse::<f64>() else {
        return Err("a time is a number with a unit, such as 100ms, 1.5s or 3min".to_owned());
    };
    if unit.is_empty() {
        return Err(format!("a time needs a unit: write {number}ms or {number}s"));
    }
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

/// A whole number of at least 1, also as `1e6` or `1_000_000`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole and between 1 and 2^53"
)]
pub(crate) fn count(text: &str) -> Result<u64, String> {
    let plain = text.trim().replace('_', "");
    let number = plain.parse::<u64>().ok().or_else(|| {
        let number = plain.parse::<f64>().ok()?;
        (number.fract() == 0.0 && (0.0..=9e15).contains(&number)).then_some(number as u64)
    });
    match number {
        Some(0) => Err("must be at least 1".to_owned()),
        Some(number) => Ok(number),
        None => Err("must be a whole number of at least 1, such as 5000 or 1e6".to_owned()),
    }
}

/// Any seed.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.trim()
        .parse()
        .map_err(|_| "must be a whole number from 0 to 2^64 - 1".to_owned())
}

/// A number of threads, 0 for as many as there are cores.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(threads) if threads <= MOST_THREADS => Ok(threads),
        _ => Err(format!(
            "must be a whole number from 0 (all cores) to {MOST_THREADS}"
        )),
    }
}

/// A number of edges, 0 included.
pub(crate) fn width(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(width) if width <= MOST_EDGES => Ok(width),
        _ => Err(format!("must be a whole number of edges from 0 to {MOST_EDGES}")),
    }
}

/// `name=value`.
pub(crate) fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("a setting is name=value, such as n=6".to_owned()),
    }
}

/// A share of the evaluations for probes.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(share) if (0.0..=0.5).contains(&share) => Ok(share),
        _ => Err("must be a number from 0 to 0.5".to_owned()),
    }
}

/// A positive, finite number.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a positive, finite number".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
