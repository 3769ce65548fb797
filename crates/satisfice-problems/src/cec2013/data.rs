//! The suite's own data: shifts and rotations of the composition functions, from a folder given by the user.

use std::path::Path;

use satisfice::Error;

pub(super) const WHERE: &str = "the folder `data` of https://github.com/mikeagn/CEC2013";

/// Shifts and rotations of one composition function.
#[derive(Debug, Clone, PartialEq)]
pub struct SuiteData {
    /// The place of the optimum of each basic function.
    pub shifts: Vec<Vec<f64>>,
    /// The rotation of each basic function, row by row; none for functions that are not rotated.
    pub rotations: Vec<Vec<Vec<f64>>>,
}

impl SuiteData {
    /// Reads the data of CF`function` in `dimension` dimensions: `optima.dat`, and `CF3_M_D2.dat` and the like.
    pub(super) fn read(
        folder: &str,
        function: usize,
        parts: usize,
        dimension: usize,
        rotated: bool,
    ) -> Result<Self, Error> {
        let mut shifts = table(folder, "optima.dat", parts, dimension)?;
        shifts.truncate(parts);
        for shift in &mut shifts {
            shift.truncate(dimension);
        }
        let rotations = if rotated {
            let name = format!("CF{function}_M_D{dimension}.dat");
            let rows = table(folder, &name, parts * dimension, dimension)?;
            rows.chunks(dimension).take(parts).map(<[_]>::to_vec).collect()
        } else {
            Vec::new()
        };
        Ok(Self { shifts, rotations })
    }

    /// Whether the shapes fit.
    pub(super) fn check(&self, parts: usize, dimension: usize, rotated: bool) -> Result<(), Error> {
        let square = |m: &Vec<Vec<f64>>| m.len() == dimension && m.iter().all(|row| row.len() == dimension);
        let fits = self.shifts.len() == parts
            && self.shifts.iter().all(|shift| shift.len() == dimension)
            && self.rotations.len() == if rotated { parts } else { 0 }
            && self.rotations.iter().all(square);
        let numbers = self
            .shifts
            .iter()
            .chain(self.rotations.iter().flatten())
            .flatten();
        if fits && numbers.clone().all(|x| x.is_finite()) {
            return Ok(());
        }
        let rotations = if rotated { parts } else { 0 };
        let allowed = format!("{parts} shifts and {rotations} rotations of dimension {dimension}, finite");
        Err(Error::parameter("data", "given", allowed))
    }
}

/// A file of numbers, with at least `rows` rows of at least `columns` columns.
fn table(folder: &str, name: &str, rows: usize, columns: usize) -> Result<Vec<Vec<f64>>, Error> {
    let path = Path::new(folder).join(name);
    let bad = |reason: String| Error::parameter("data", path.display(), format!("{reason}; it is {WHERE}"));
    let text = std::fs::read_to_string(&path).map_err(|error| Error::File {
        path: path.display().to_string(),
        reason: format!("{error}; it is of {WHERE}"),
    })?;
    let parse = |line: &str| -> Result<Vec<f64>, Error> {
        let words = line.split_whitespace();
        let number = |word: &str| word.parse::<f64>().ok().filter(|x| x.is_finite());
        words
            .map(|word| number(word).ok_or_else(|| bad(format!("numbers, not `{word}`"))))
            .collect()
    };
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let table = lines.map(parse).collect::<Result<Vec<_>, _>>()?;
    if table.len() < rows || table.iter().any(|row| row.len() < columns) {
        return Err(bad(format!(
            "a table of at least {rows} rows and {columns} columns"
        )));
    }
    Ok(table)
}
