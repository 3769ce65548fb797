//! Rows of numbers of which many are alike, as those of points of a lattice are.

use std::collections::BTreeMap;

use super::{Reader, Saved, State};
use crate::error::Error;
use crate::scalar::Real;

/// A column: the number of each value among its different ones, or the values themselves, where there are more than 256.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(bound(deserialize = "S: Real"))]
enum Column<S> {
    Few(Vec<S>, Vec<u8>),
    Many(Vec<S>),
}

/// Appends rows of `width` numbers column by column: a byte for each number where a column has at most 256 different ones. A width of
/// zero is for no rows.
pub(crate) fn write_rows<S: Real>(state: &mut State, rows: &[S], width: usize) {
    let columns: Vec<Column<S>> = (0..width)
        .map(|column| of(rows.iter().skip(column).step_by(width)))
        .collect();
    state.write(&columns);
}

fn of<'a, S: Real>(values: impl Iterator<Item = &'a S> + Clone) -> Column<S> {
    let mut different = Vec::<S>::new();
    let mut known = BTreeMap::<u64, u8>::new();
    let mut numbers = Vec::new();
    for &value in values.clone() {
        let word = value.to_word();
        let number = match (known.get(&word), u8::try_from(different.len())) {
            (Some(&number), _) => number,
            (None, Ok(number)) => {
                known.insert(word, number);
                different.push(value);
                number
            }
            (None, Err(_)) => return Column::Many(values.copied().collect()),
        };
        numbers.push(number);
    }
    Column::Few(different, numbers)
}

/// Reads what [`write_rows`] has written.
///
/// # Errors
/// [`Error::State`] if the next bytes are no such rows.
pub(crate) fn read_rows<S: Real>(from: &mut Reader<'_>) -> Result<Vec<S>, Error> {
    let columns: Vec<Column<S>> = Saved::restore(from)?;
    let damaged = || Error::State("its rows of numbers do not fit each other".to_owned());
    let mut values = Vec::with_capacity(columns.len());
    for column in columns {
        values.push(match column {
            Column::Many(values) => values,
            Column::Few(different, numbers) => numbers
                .iter()
                .map(|&number| different.get(usize::from(number)).copied())
                .collect::<Option<Vec<S>>>()
                .ok_or_else(damaged)?,
        });
    }
    let height = values.first().map_or(0, Vec::len);
    if values.iter().any(|column| column.len() != height) {
        return Err(damaged());
    }
    Ok((0..height)
        .flat_map(|row| values.iter().map(move |column| column[row]))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_bits_whether_they_are_few_or_many() {
        let rows: Vec<f64> = (0..3000_u32)
            .flat_map(|i| {
                [
                    f64::from(i % 7),
                    f64::from(i).sqrt(),
                    if i == 5 { -0.0 } else { 0.0 },
                ]
            })
            .collect();
        let mut state = State::default();
        write_rows(&mut state, &rows, 3);
        write_rows::<f64>(&mut state, &[], 2);
        write_rows::<f64>(&mut state, &[], 0);
        assert!(state.0.len() < 3000 * 11, "{}", state.0.len());
        let mut reader = Reader::new(&state);
        let back: Vec<f64> = read_rows(&mut reader).unwrap();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&rows));
        for _ in 0..2 {
            assert!(read_rows::<f64>(&mut reader).unwrap().is_empty());
        }
        reader.finish().unwrap();
    }

    #[test]
    fn the_256th_value_is_one_of_few_and_the_257th_of_many() {
        for (count, bytes) in [(256_u32, 256 * 9..256 * 9 + 20), (257, 257 * 8..257 * 8 + 20)] {
            let mut state = State::default();
            write_rows(&mut state, &(0..count).map(f64::from).collect::<Vec<_>>(), 1);
            assert!(bytes.contains(&state.0.len()), "{count}: {}", state.0.len());
            let back: Vec<f64> = read_rows(&mut Reader::new(&state)).unwrap();
            assert_eq!(back.len(), count as usize);
        }
    }

    #[test]
    fn rows_that_do_not_fit_are_refused() {
        let refused = |columns: &[Column<f32>]| {
            let mut state = State::default();
            state.write(columns);
            read_rows::<f32>(&mut Reader::new(&state)).is_err()
        };
        assert!(refused(&[Column::Few(vec![1.0], vec![0, 1])]));
        assert!(refused(&[Column::Few(vec![1.0], vec![0]), Column::Many(vec![])]));
        assert!(!refused(&[
            Column::Few(vec![1.0], vec![0]),
            Column::Many(vec![2.0])
        ]));
    }
}
