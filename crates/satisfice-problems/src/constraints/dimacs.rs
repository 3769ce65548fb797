//! The DIMACS formats: clauses (`cnf`) and graphs (`edge`).

use std::fs::File;
use std::io::Read;

use satisfice::Error;

/// Larger formulas and graphs are refused: a point of them would not fit in memory.
const LARGEST: usize = 100_000;

/// Reads `path`; errors name the parameter `file`.
pub(super) fn read(path: &str) -> Result<String, Error> {
    let bad = |reason: String| Error::parameter("file", path, format!("a readable file ({reason})"));
    let mut text = String::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST).read_to_string(&mut text));
    match read.map_err(|error| bad(error.to_string()))? as u64 {
        LONGEST => Err(bad(format!("it has {LONGEST} bytes or more"))),
        _ => Ok(text),
    }
}

/// Longer files are refused: devices and pipes may have no end.
const LONGEST: u64 = 1 << 28;

struct Reader<'a> {
    path: &'a str,
}

impl Reader<'_> {
    fn bad(&self, line: usize, wanted: &str) -> Error {
        Error::parameter(
            "file",
            self.path,
            format!("DIMACS text; line {} has to be {wanted}", line + 1),
        )
    }

    /// The two sizes of a problem line `p KIND a b`.
    fn sizes(&self, line: usize, text: &str, kinds: &[&str]) -> Result<[usize; 2], Error> {
        let wanted = || self.bad(line, &format!("`p {} N M` with N from 1 to {LARGEST}", kinds[0]));
        let mut words = text.split_whitespace().skip(1);
        let kind = words.next().ok_or_else(wanted)?;
        let mut size = || words.next().and_then(|word| word.parse::<usize>().ok());
        match (size(), size()) {
            (Some(n @ 1..=LARGEST), Some(m)) if kinds.contains(&kind) => Ok([n, m]),
            _ => Err(wanted()),
        }
    }
}

/// The number of variables and the clauses of a `cnf` file: literals +-(1 + variable).
pub(super) fn clauses(path: &str, text: &str) -> Result<(usize, Vec<Vec<i32>>), Error> {
    let reader = Reader { path };
    let mut variables = None;
    let (mut clauses, mut clause) = (Vec::new(), Vec::new());
    for (number, line) in text.lines().enumerate() {
        match line.trim_start().as_bytes().first() {
            None | Some(b'c') => {}
            Some(b'%') => break, // the end mark of the SATLIB files
            Some(b'p') => variables = Some(reader.sizes(number, line, &["cnf"])?[0]),
            _ => {
                let n = variables.ok_or_else(|| reader.bad(number, "after the line `p cnf N M`"))?;
                for word in line.split_whitespace() {
                    let literal = word
                        .parse::<i32>()
                        .ok()
                        .filter(|l| l.unsigned_abs() as usize <= n);
                    match literal {
                        Some(0) => clauses.push(core::mem::take(&mut clause)),
                        Some(literal) => clause.push(literal),
                        None => return Err(reader.bad(number, &format!("literals from -{n} to {n}"))),
                    }
                }
            }
        }
    }
    if !clause.is_empty() {
        clauses.push(clause);
    }
    let variables = variables.ok_or_else(|| reader.bad(0, "a line `p cnf N M`"))?;
    Ok((variables, clauses))
}

/// The number of vertices and the edges of an `edge` file, vertices counted from 0.
pub(super) fn edges(path: &str, text: &str) -> Result<(usize, Vec<[usize; 2]>), Error> {
    let reader = Reader { path };
    let mut vertices = None;
    let mut edges = Vec::new();
    for (number, line) in text.lines().enumerate() {
        match line.trim_start().as_bytes().first() {
            Some(b'p') => vertices = Some(reader.sizes(number, line, &["edge", "edges", "col"])?[0]),
            Some(b'e') => {
                let n = vertices.ok_or_else(|| reader.bad(number, "after the line `p edge N M`"))?;
                let mut ends = line
                    .split_whitespace()
                    .skip(1)
                    .map(|word| word.parse::<usize>().ok());
                match (ends.next().flatten(), ends.next().flatten()) {
                    (Some(a), Some(b)) if a != b && (1..=n).contains(&a) && (1..=n).contains(&b) => {
                        edges.push([a - 1, b - 1]);
                    }
                    _ => {
                        return Err(
                            reader.bad(number, &format!("`e A B` with different vertices from 1 to {n}"))
                        );
                    }
                }
            }
            _ => {}
        }
    }
    let vertices = vertices.ok_or_else(|| reader.bad(0, "a line `p edge N M`"))?;
    Ok((vertices, edges))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_device_without_end_is_refused() {
        let error = read("/dev/zero").unwrap_err().to_string();
        assert!(error.contains("bytes or more"), "{error}");
    }

    #[test]
    fn clauses_may_span_lines_and_end_without_zero() {
        let text = "c a comment\np cnf 3 3\n1 -2\n0 3 0\n-1 -3\n";
        assert_eq!(
            clauses("x", text),
            Ok((3, vec![vec![1, -2], vec![3], vec![-1, -3]]))
        );
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, says) in [
            ("p cnf 2 1\n1 3 0\n", "line 2 has to be literals from -2 to 2"),
            ("1 0\n", "line 1 has to be after the line `p cnf N M`"),
            ("p cnf 0 1\n", "N from 1"),
            ("", "a line `p cnf N M`"),
        ] {
            assert!(clauses("x", text).unwrap_err().to_string().contains(says));
        }
        for text in [
            "p edge 2 1\ne 1 1\n",
            "p edge 2 1\ne 1 3\n",
            "e 1 2\n",
            "p edge x 1\n",
        ] {
            assert!(edges("x", text).is_err(), "{text}");
        }
        assert_eq!(
            edges("x", "p edge 3 2\ne 1 2\ne 2 3\n"),
            Ok((3, vec![[0, 1], [1, 2]]))
        );
    }
}
