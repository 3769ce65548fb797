//! An archive is written as the list of its hits and read back in that order.

use super::{Archive, Identity};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Deserialize)]
struct Row<T> {
    solution: T,
    fitness: f64,
    evaluation: u64,
    seconds: f64,
}

impl<T: Serialize> Serialize for Archive<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl<'de, T: Deserialize<'de> + Identity> Deserialize<'de> for Archive<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows = Vec::<Row<T>>::deserialize(deserializer)?;
        let mut archive = Self::default();
        for row in rows {
            archive.insert(row.solution, row.fitness, row.evaluation, row.seconds);
        }
        Ok(archive)
    }
}
