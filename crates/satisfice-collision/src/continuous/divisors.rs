//! Common divisors of forms: common roots, and roots counted once.
//!
//! Only roots with `0 < t < 1` matter here, so a form is read as the polynomial `sum_i c_i x^i` of `x = t / (1 - t)`, which
//! runs from 0 to infinity, and factors `x` are dropped.

use dashu_int::IBig;
use dashu_int::ops::{Abs, Gcd};

use super::deadline::{CutShort, Deadline};
use super::form::{Form, sign};

/// A form with the same roots inside the step, each once.
pub(super) fn squarefree(form: &Form, deadline: Deadline<'_>) -> Result<Form, CutShort> {
    let polynomial = trimmed(form.coefficients());
    let repeated = gcd(polynomial.clone(), derivative(&polynomial), deadline)?;
    Ok(Form::new(quotient(polynomial, &repeated)))
}

/// The roots of `form` inside the step that are no roots of `other`. `form` is square-free.
pub(super) fn without_roots_of(form: &Form, other: &Form, deadline: Deadline<'_>) -> Result<Form, CutShort> {
    let polynomial = trimmed(form.coefficients());
    let common = gcd(polynomial.clone(), trimmed(other.coefficients()), deadline)?;
    Ok(Form::new(quotient(polynomial, &common)))
}

/// A form whose roots with `0 <= t <= 1` are the common ones of all forms; `None` if all are 0 everywhere.
pub(super) fn common(forms: &[Form], deadline: Deadline<'_>) -> Result<Option<Form>, CutShort> {
    let forms = || forms.iter().filter(|form| !form.is_zero());
    let at_the_end = forms()
        .map(|form| {
            form.coefficients()
                .iter()
                .rev()
                .take_while(|c| c.is_zero())
                .count()
        })
        .min();
    let mut polynomials = forms().map(|form| primitive(strip(form.coefficients().to_vec())));
    let (Some(at_the_end), Some(mut common)) = (at_the_end, polynomials.next()) else {
        return Ok(None);
    };
    for polynomial in polynomials {
        common = gcd(common, polynomial, deadline)?;
    }
    common.resize(common.len() + at_the_end, IBig::ZERO);
    Ok(Some(Form::new(common)))
}

/// The sign of `form` at the root of `equation` inside the step, of which there is exactly one: the number of roots at which it is above
/// 0, less those at which it is below, by the signs of a remainder sequence (Tarski; Basu, Pollack and Roy 2006, theorem 2.61).
pub(super) fn sign_at_root(equation: &Form, form: &Form, deadline: Deadline<'_>) -> Result<i32, CutShort> {
    let polynomial = trimmed(equation.coefficients());
    let product = &Form::new(derivative(&polynomial)) * form;
    let mut previous = polynomial.clone();
    let mut next = primitive(pseudo_remainder(product.into_coefficients(), &polynomial));
    let ends = |polynomial: &[IBig]| [sign(&polynomial[0]), sign(&polynomial[polynomial.len() - 1])];
    let (mut last, mut difference) = (ends(&previous), 0);
    while !next.is_empty() {
        deadline.check()?;
        let now = ends(&next);
        // a sign of 0 at the start is passed over
        let now = [if now[0] == 0 { last[0] } else { now[0] }, now[1]];
        difference += i32::from(now[0] != last[0]) - i32::from(now[1] != last[1]);
        last = now;
        let rest = primitive(pseudo_remainder(previous, &next));
        previous = next;
        next = rest.into_iter().map(|c| -c).collect();
    }
    Ok(difference)
}

fn derivative(polynomial: &[IBig]) -> Vec<IBig> {
    let powers = (1..).zip(polynomial.iter().skip(1));
    powers.map(|(power, c)| c * IBig::from(power)).collect()
}

/// Without the factors `x` (roots at the start) and the zero leading coefficients (roots at the end).
fn trimmed(coefficients: &[IBig]) -> Vec<IBig> {
    let zeros = coefficients.iter().take_while(|c| c.is_zero()).count();
    primitive(strip(coefficients[zeros..].to_vec()))
}

/// Without zero leading coefficients.
fn strip(mut coefficients: Vec<IBig>) -> Vec<IBig> {
    while coefficients.last().is_some_and(IBig::is_zero) {
        coefficients.pop();
    }
    coefficients
}

/// Divided by the greatest common divisor of the coefficients.
fn primitive(mut coefficients: Vec<IBig>) -> Vec<IBig> {
    let mut content = IBig::ZERO;
    for c in &coefficients {
        content = if content.is_zero() {
            c.clone().abs()
        } else if c.is_zero() {
            content
        } else {
            IBig::from((&content).gcd(c))
        };
    }
    if content > IBig::ONE {
        for c in &mut coefficients {
            *c /= &content;
        }
    }
    coefficients
}

/// The greatest common divisor, by Euclid's algorithm with primitive pseudo-remainders. Neither argument has zero leading
/// coefficients; the empty one is the zero polynomial.
fn gcd(mut a: Vec<IBig>, mut b: Vec<IBig>, deadline: Deadline<'_>) -> Result<Vec<IBig>, CutShort> {
    if a.len() < b.len() {
        std::mem::swap(&mut a, &mut b);
    }
    while !b.is_empty() {
        deadline.check()?;
        let rest = primitive(pseudo_remainder(a, &b));
        a = b;
        b = rest;
    }
    Ok(primitive(a))
}

/// A positive multiple of the remainder of `a / b`.
fn pseudo_remainder(mut a: Vec<IBig>, b: &[IBig]) -> Vec<IBig> {
    let lead = &b[b.len() - 1];
    let (size, is_negative) = (lead.clone().abs(), sign(lead) < 0);
    while a.len() >= b.len() {
        let mut top = a.pop().unwrap_or_default();
        if is_negative {
            top = -top;
        }
        for c in &mut a {
            *c *= &size;
        }
        let offset = a.len() + 1 - b.len();
        for (c, d) in a[offset..].iter_mut().zip(b) {
            *c -= &top * d;
        }
        a = strip(a);
    }
    a
}

/// `a / b` up to a constant, for a divisor `b` of `a`.
fn quotient(mut a: Vec<IBig>, b: &[IBig]) -> Vec<IBig> {
    if b.len() < 2 {
        return a;
    }
    let lead = &b[b.len() - 1];
    let mut result = vec![IBig::ZERO; a.len() + 1 - b.len()];
    for k in (0..result.len()).rev() {
        let top = a.pop().unwrap_or_default();
        for c in a.iter_mut().chain(&mut result[k + 1..]) {
            *c *= lead;
        }
        for (c, d) in a[k..].iter_mut().zip(b) {
            *c -= &top * d;
        }
        result[k] = top;
    }
    primitive(result)
}

#[cfg(test)]
mod tests {
    use super::{Deadline, Form, IBig};

    fn form(coefficients: &[i32]) -> Form {
        Form::new(coefficients.iter().map(|&c| IBig::from(c)).collect())
    }

    fn squarefree(form: &Form) -> Form {
        super::squarefree(form, Deadline::NONE).expect("no deadline")
    }

    fn without_roots_of(form: &Form, other: &Form) -> Form {
        super::without_roots_of(form, other, Deadline::NONE).expect("no deadline")
    }

    fn common(forms: &[Form]) -> Option<Form> {
        super::common(forms, Deadline::NONE).expect("no deadline")
    }

    fn sign_at_root(equation: &Form, form: &Form) -> i32 {
        super::sign_at_root(equation, form, Deadline::NONE).expect("no deadline")
    }

    /// Up to a constant.
    fn proportional(a: &Form, b: &Form) -> bool {
        let (a, b) = (a.coefficients(), b.coefficients());
        a.len() == b.len() && (0..a.len()).all(|k| &a[k] * &b[0] == &a[0] * &b[k])
    }

    #[test]
    fn repeated_roots_are_left_once() {
        let (p, q) = (form(&[-1, 3]), form(&[2, -5]));
        let cubic = &(&p * &p) * &q;
        assert!(proportional(&squarefree(&cubic), &(&p * &q)));
        // A root at the start and one at the end are no roots inside.
        let ends = &(&form(&[0, 1]) * &form(&[1, 0])) * &p;
        assert!(proportional(&squarefree(&ends), &p));
    }

    #[test]
    fn the_sign_at_a_root_is_found() {
        // the root of the first is at x = 7/3, that of 3 x^2 - 7 at sqrt(7/3)
        let (linear, square) = (form(&[-7, 3]), form(&[-7, 0, 3]));
        for (root, is_below_two) in [(&linear, false), (&square, true)] {
            for sign in [1, -1] {
                let root = Form::new(root.coefficients().iter().map(|c| c * IBig::from(sign)).collect());
                assert_eq!(sign_at_root(&root, &form(&[2, -1])) == 1, is_below_two);
                assert_eq!(sign_at_root(&root, &form(&[-2, 1])) == 1, !is_below_two);
                assert_eq!(sign_at_root(&root, &(&root * &form(&[1, 5]))), 0);
                // x (x^2 - 2) (x^2 + 1), 0 at the start
                let quintic = &(&form(&[-2, 0, 1]) * &form(&[1, 0, 1])) * &form(&[0, 1]);
                assert_eq!(sign_at_root(&root, &quintic), 1);
                assert_eq!(sign_at_root(&(&root * &form(&[0, 1])), &quintic), 1);
                assert_eq!(sign_at_root(&root, &form(&[0, 0])), 0);
                assert_eq!(sign_at_root(&root, &form(&[-3])), -1);
            }
        }
    }

    #[test]
    fn common_roots_are_found_and_removed() {
        let (p, q, r) = (form(&[-7, 3]), form(&[2, -5]), form(&[1, 1, -9]));
        let (a, b) = (&(&p * &q) * &r, &(&p * &form(&[4, 1])) * &p);
        assert!(proportional(&without_roots_of(&a, &b), &(&q * &r)));
        assert!(common(&[a.clone(), form(&[0, 0]), b]).is_some_and(|c| proportional(&c, &p)));
        assert_eq!(common(&[form(&[0, 0])]), None);
        let end = common(&[form(&[3, 0]), form(&[-5, 0])]);
        assert!(end.is_some_and(|c| c.sign_at_end() == 0 && c.sign_at_start() != 0));
        assert!(common(&[a, form(&[0, 3, 0])]).is_some_and(|c| c.coefficients().len() == 1));
    }
}
