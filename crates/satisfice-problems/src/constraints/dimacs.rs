//! The DIMACS formats: clauses (`cnf`) and graphs (`edge`).

use core::fmt::Display;
use std::fs::File;
use std::io::Read;

use satisfice::Error;

/// Larger formulas and graphs are refused: a point of them would not fit in memory.
const LARGEST: usize = 100_000;

/// Reads `path`.
pub(super) fn read(path: &str) -> Result<String, Error> {
    let bad = |reason: String| Error::File {
        path: path.to_owned(),
        reason,
    };
    let mut text = String::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST).read_to_string(&mut text));
    match read.map_err(|error| bad(error.to_string()))? as u64 {
        LONGEST => Err(bad(format!("it has {LONGEST} bytes or more"))),
        _ => Ok(text),
    }
}

/// Longer files are refused: devices and pipes may have no end.
const LONGEST: u64 = 1 << 28;

/// The line `p KIND N M`.
#[derive(Clone, Copy)]
struct Sizes {
    line: usize,
    /// Variables or vertices.
    n: usize,
    /// Clauses or edges.
    m: usize,
}

struct Reader<'a> {
    path: &'a str,
    kinds: &'a [&'a str],
    sizes: Option<Sizes>,
}

impl<'a> Reader<'a> {
    fn new(path: &'a str, kinds: &'a [&'a str]) -> Self {
        Self {
            path,
            kinds,
            sizes: None,
        }
    }

    fn bad(&self, line: usize, wanted: &str) -> Error {
        Error::parameter(
            "file",
            self.path,
            format!("DIMACS text; line {} has to be {wanted}", line + 1),
        )
    }

    /// The file is not what it announces.
    fn differs(&self, sizes: Sizes, what: &str, found: impl Display) -> Error {
        let Sizes { line, m, .. } = sizes;
        let line = line + 1;
        Error::parameter(
            "file",
            self.path,
            format!("a whole DIMACS file; line {line}: {m} {what} announced, {found}"),
        )
    }

    /// Reads the problem line `p KIND N M`, of which there is one.
    fn read_sizes(&mut self, line: usize, text: &str) -> Result<(), Error> {
        if self.sizes.is_some() {
            return Err(self.bad(line, "no second line that begins with p"));
        }
        let wanted = || {
            self.bad(
                line,
                &format!("`p {} N M` with N from 1 to {LARGEST}", self.kinds[0]),
            )
        };
        let mut words = text.split_whitespace().skip(1);
        let kind = words.next().ok_or_else(wanted)?;
        let mut size = || words.next().and_then(|word| word.parse::<usize>().ok());
        match (size(), size()) {
            (Some(n @ 1..=LARGEST), Some(m)) if self.kinds.contains(&kind) => {
                self.sizes = Some(Sizes { line, n, m });
                Ok(())
            }
            _ => Err(wanted()),
        }
    }

    /// The sizes, on a line that comes after theirs.
    fn sizes_before(&self, line: usize) -> Result<Sizes, Error> {
        self.sizes
            .ok_or_else(|| self.bad(line, &format!("after the line `p {} N M`", self.kinds[0])))
    }

    /// The sizes, at the end.
    fn sizes(&self) -> Result<Sizes, Error> {
        self.sizes
            .ok_or_else(|| self.bad(0, &format!("a line `p {} N M`", self.kinds[0])))
    }
}

/// The number of variables and the clauses of a `cnf` file: literals +-(1 + variable).
///
/// There must be as many clauses as announced. The last one may end with its line instead of a 0, as in the definition of the
/// format; where the text ends within that line, it has been cut.
pub(super) fn clauses(path: &str, text: &str) -> Result<(usize, Vec<Vec<i32>>), Error> {
    let mut reader = Reader::new(path, &["cnf"]);
    let (mut clauses, mut clause) = (Vec::new(), Vec::new());
    let mut last = 0;
    for (number, line) in text.lines().enumerate() {
        match line.trim_start().as_bytes().first() {
            None | Some(b'c') => {}
            Some(b'%') => break, // the end mark of the SATLIB files
            Some(b'p') => reader.read_sizes(number, line)?,
            _ => {
                let Sizes { n, .. } = reader.sizes_before(number)?;
                last = number;
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
    let sizes = reader.sizes()?;
    if !clause.is_empty() {
        if last + 1 == text.lines().count() && !text.ends_with('\n') {
            return Err(reader.bad(last, "the end of a clause, a 0: the file may be cut"));
        }
        clauses.push(clause);
    }
    if clauses.len() != sizes.m {
        return Err(reader.differs(sizes, "clauses", format!("{} found", clauses.len())));
    }
    Ok((sizes.n, clauses))
}

/// The number of vertices and the edges of an `edge` file, vertices counted from 0.
///
/// There must be as many lines `e A B` as announced. Some known files list each edge once and announce twice the number, or list
/// each edge in both directions and announce the number of edges; these are read as well.
pub(super) fn edges(path: &str, text: &str) -> Result<(usize, Vec<[usize; 2]>), Error> {
    let mut reader = Reader::new(path, &["edge", "edges", "col"]);
    let mut edges = Vec::new();
    for (number, line) in text.lines().enumerate() {
        match line.trim_start().as_bytes().first() {
            Some(b'p') => reader.read_sizes(number, line)?,
            Some(b'e') => {
                let Sizes { n, .. } = reader.sizes_before(number)?;
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
    let sizes = reader.sizes()?;
    let (lines, announced) = (edges.len(), sizes.m);
    if lines != announced {
        let mut different: Vec<_> = edges.iter().map(|&[a, b]| (a.min(b), a.max(b))).collect();
        different.sort_unstable();
        different.dedup();
        let different = different.len();
        let is_once = different == lines && announced.checked_sub(lines) == Some(lines);
        let is_twice = different == announced && lines.checked_sub(announced) == Some(announced);
        if !is_once && !is_twice {
            let repeated = match lines - different {
                0 => String::new(),
                repeated => format!(", {repeated} of them again"),
            };
            return Err(reader.differs(sizes, "edges", format!("{lines} found{repeated}")));
        }
    }
    Ok((sizes.n, edges))
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
    fn a_file_that_is_cut_is_refused() {
        let whole = "c uf\np cnf 12 2\n 1 -2 11 0\n-3 10 12 0\n%\n0\n\n";
        let last = whole.find(" 0\n%").unwrap() + 2;
        for end in 0..whole.len() {
            let read = clauses("x.cnf", &whole[..end]);
            assert_eq!(read.is_ok(), end >= last, "{:?}: {read:?}", &whole[..end]);
        }
        for (text, says) in [
            (
                "p cnf 20 91\n1 2 3 0\n",
                "file = x.cnf is not allowed: a whole DIMACS file; line 1: 91 clauses announced, 1 found",
            ),
            ("p cnf 3 1\n1 0\n2 0\n", "line 1: 1 clauses announced, 2 found"),
            ("p cnf 3 1\n1 2", "line 2 has to be the end of a clause, a 0"),
            ("p cnf 3 1\n1 0\np cnf 3 1\n", "line 3 has to be no second line"),
        ] {
            let error = clauses("x.cnf", text).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
        // The example of the definition of the format has no 0 at its end.
        assert!(clauses("x", "p cnf 4 3\n1 3 -4 0\n4 0 2\n-3\n").is_ok());
    }

    #[test]
    fn graphs_list_each_edge_once_or_twice() {
        for text in [
            "p edge 3 2\ne 1 2\ne 2 3\n",
            "p edge 3 4\ne 1 2\ne 2 3\n",
            "p edge 3 4\ne 1 2\ne 2 3\ne 2 1\ne 3 2\n",
            "p col 3 2\ne 1 2\ne 2 1\ne 2 3\ne 3 2\n",
            "p edge 3 0\n",
        ] {
            assert!(edges("x", text).is_ok(), "{text}");
        }
        for (text, says) in [
            ("p edge 3 5\ne 1 2\n", "line 1: 5 edges announced, 1 found"),
            ("p edge 3 1\ne 1 2\ne 2 3\n", "line 1: 1 edges announced, 2 found"),
            (
                "p edge 3 4\ne 1 2\ne 2 1\n",
                "line 1: 4 edges announced, 2 found, 1 of them again",
            ),
            ("p edge 3 2\n", "line 1: 2 edges announced, 0 found"),
        ] {
            let error = edges("x", text).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
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
