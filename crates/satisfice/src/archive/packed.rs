//! In a text, a checkpoint has its hits as packed columns, which are much shorter than their list.

use core::borrow::Borrow;

use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Archive, Identity};
use crate::error::Error;
use crate::state::{Reader, State, read_rows, write_rows};

/// A solution that can be written and read back.
pub(crate) trait Packable: Serialize + DeserializeOwned + Identity {}

impl<T: Serialize + DeserializeOwned + Identity> Packable for T {}

/// What a text holds.
#[derive(Serialize)]
#[serde(rename_all = "snake_case", bound(serialize = "T: Serialize"))]
enum WrittenHits<'a, T> {
    Packed(State),
    List(&'a Archive<T>),
}

#[derive(Deserialize)]
#[serde(
    rename_all = "snake_case",
    bound(deserialize = "T: DeserializeOwned + Identity")
)]
enum ReadHits<T> {
    Packed(State),
    List(Archive<T>),
}

/// Writes an archive: packed in a text, if it can be read back so, and otherwise as its list.
pub(crate) fn serialize<T, A, S>(archive: &A, serializer: S) -> Result<S::Ok, S::Error>
where
    T: Packable,
    A: Borrow<Archive<T>>,
    S: Serializer,
{
    let archive = archive.borrow();
    if !serializer.is_human_readable() {
        return archive.serialize(serializer);
    }
    pack(archive)
        .map_or(WrittenHits::List(archive), WrittenHits::Packed)
        .serialize(serializer)
}

/// Reads what [`serialize`] has written.
pub(crate) fn deserialize<'de, T, A, D>(deserializer: D) -> Result<A, D::Error>
where
    T: Packable,
    A: From<Archive<T>>,
    D: Deserializer<'de>,
{
    let archive = if deserializer.is_human_readable() {
        match ReadHits::deserialize(deserializer)? {
            ReadHits::Packed(state) => unpack(&state).map_err(D::Error::custom)?,
            ReadHits::List(archive) => archive,
        }
    } else {
        Archive::deserialize(deserializer)?
    };
    Ok(archive.into())
}

fn encoded<T: Serialize>(value: &T) -> postcard::Result<Vec<u8>> {
    postcard::to_extend(value, Vec::new())
}

/// The columns, or `None` if solutions are not read back as they are: serde's attributes `untagged`, `flatten` and
/// `skip_serializing_if` need a format that names its fields.
fn pack<T: Packable>(archive: &Archive<T>) -> Option<State> {
    let mut state = State(encoded(&archive.solutions).ok()?);
    let solutions: Vec<T> = postcard::from_bytes(&state.0).ok()?;
    let is_same = solutions.len() == archive.len()
        && solutions.iter().zip(&archive.solutions).all(|(a, b)| a.same(b))
        && encoded(&solutions).is_ok_and(|bytes| bytes == state.0);
    if !is_same {
        return None;
    }
    let mut before = 0;
    let steps = archive.evaluations.iter().map(|&evaluation| {
        let step = evaluation.wrapping_sub(before);
        before = evaluation;
        step
    });
    state.write(&steps.collect::<Vec<u64>>());
    write_rows(&mut state, &archive.fitness, 1);
    write_rows(&mut state, &archive.seconds, 1);
    Some(state)
}

/// # Errors
/// [`Error::State`] if these are not such columns, or not of one length.
fn unpack<T: Packable>(state: &State) -> Result<Archive<T>, Error> {
    let mut reader = Reader::new(state);
    let solutions: Vec<T> = reader.read()?;
    let steps: Vec<u64> = reader.read()?;
    let fitness: Vec<f64> = read_rows(&mut reader)?;
    let seconds: Vec<f32> = read_rows(&mut reader)?;
    reader.finish()?;
    if [steps.len(), fitness.len(), seconds.len()] != [solutions.len(); 3] {
        return Err(Error::State("its hits do not fit each other".to_owned()));
    }
    let (mut archive, mut evaluation) = (Archive::default(), 0_u64);
    let numbers = steps.into_iter().zip(fitness).zip(seconds);
    for (solution, ((step, fitness), seconds)) in solutions.into_iter().zip(numbers) {
        evaluation = evaluation.wrapping_add(step);
        archive.insert(solution, fitness, evaluation, f64::from(seconds));
    }
    Ok(archive)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Located;

    #[derive(Serialize, Deserialize)]
    #[serde(bound(serialize = "T: Packable", deserialize = "T: Packable"))]
    struct Kept<T>(#[serde(with = "super")] Archive<T>);

    #[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
    #[serde(untagged)]
    enum CellOrEdge {
        Cell(u32),
        Edge([u32; 2]),
    }

    #[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
    struct Sparse {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        label: Option<u8>,
        value: u8,
    }

    fn archive<T: Identity>(solutions: impl IntoIterator<Item = T>) -> Archive<T> {
        let mut archive = Archive::default();
        for (index, solution) in solutions.into_iter().enumerate() {
            let fitness = if index == 3 { -0.0 } else { 0.1 * index as f64 };
            // The third one was found before the second, as after a warm start.
            let evaluation = if index == 2 { 1 } else { 1 << index };
            archive.insert(solution, fitness, evaluation, 1e-3 * index as f64);
        }
        archive
    }

    /// The text, after all numbers have been compared with those read from it.
    fn through_text<T: Packable + Clone + PartialEq + core::fmt::Debug>(archive: Archive<T>) -> String {
        let rows = |archive: &Archive<T>| -> Vec<(T, [u64; 3])> {
            let hits = archive.iter();
            hits.map(|hit| {
                let numbers = [hit.fitness.to_bits(), hit.evaluation, hit.seconds.to_bits()];
                (hit.solution.clone(), numbers)
            })
            .collect()
        };
        let kept = Kept(archive);
        let text = serde_json::to_string(&kept).unwrap();
        let back: Kept<T> = serde_json::from_str(&text).unwrap();
        assert_eq!(rows(&back.0), rows(&kept.0));
        let bytes = encoded(&kept).unwrap();
        if let Ok(back) = postcard::from_bytes::<Kept<T>>(&bytes) {
            assert_eq!(rows(&back.0), rows(&kept.0));
        }
        text
    }

    #[test]
    fn every_bit_is_kept() {
        for count in [0, 1, 40] {
            let points = (0..count).map(|i| Located::new(&[f64::from(i).sqrt(), f64::from(i) / 3.0], 1e-3));
            let text = through_text(archive(points.collect::<Vec<_>>()));
            assert!(text.starts_with(r#"{"packed":"#), "{text}");
            assert!(through_text(archive((0..count).map(|i| vec![i; 3]))).contains("packed"));
        }
    }

    #[test]
    fn solutions_that_name_their_fields_are_listed() {
        let places = [CellOrEdge::Cell(7), CellOrEdge::Edge([1, 2]), CellOrEdge::Cell(3)];
        assert!(through_text(archive(places)).starts_with(r#"{"list":"#));
        let labels = [Some(1), None, None, Some(0)].into_iter().zip(0..);
        let sparse = labels.map(|(label, value)| Sparse { label, value });
        assert!(through_text(archive(sparse)).starts_with(r#"{"list":"#));
    }

    #[test]
    fn columns_that_do_not_fit_are_refused() {
        let mut state = pack(&archive([[1_u32], [2]])).unwrap();
        assert!(unpack::<[u32; 1]>(&state).is_ok());
        state.0.push(0);
        assert!(unpack::<[u32; 1]>(&state).is_err());
        let mut short = State::default();
        short.write(&vec![[1_u32], [2]]);
        short.write(&vec![1_u64]);
        write_rows(&mut short, &[0.0, 1.0], 1);
        write_rows(&mut short, &[0.0_f32, 1.0], 1);
        let error = unpack::<[u32; 1]>(&short).err().unwrap();
        assert!(error.to_string().contains("do not fit"), "{error}");
    }
}
