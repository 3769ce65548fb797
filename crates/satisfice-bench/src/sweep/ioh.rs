//! Export for `IOHanalyzer` (<https://iohanalyzer.liacs.nl>) and `iohinspector`: hits against evaluations as the runs of a
//! maximisation, in the format of `IOHexperimenter` 0.3. Read back by `iohinspector` 0.0.8.

use std::fmt::Write;
use std::path::Path;

use serde_json::json;

use super::files::{plain, write};
use super::row::Row;
use super::summary::{Group, rows_of};
use crate::error::Error;

/// Writes one folder per engine with a `.json` and a `.dat` file per problem. The functions are the groups, numbered from 1; the
/// dimension is given as 1, since problems of one number of axes are not alike; the instance is the seed plus 1.
///
/// # Errors
/// [`Error::File`] if a file cannot be written.
pub fn export(folder: &Path, groups: &[Group], rows: &[Row]) -> Result<(), Error> {
    for (number, group) in (1..).zip(groups) {
        for line in &group.lines {
            let function = plain(&format!("{} {}", group.part, group.problem));
            let inner = format!("data_f{number}_{function}");
            let data = format!("{inner}/IOHprofiler_f{number}_DIM1.dat");
            let (mut text, mut runs) = (String::new(), Vec::new());
            for row in rows_of(rows, group, &line.engine) {
                text.push_str("evaluations raw_y\n");
                let mut best = None;
                for moment in &row.curve {
                    if best.is_none_or(|best| moment.2 > best) {
                        best = Some(moment.2);
                        // Writing to a string cannot fail.
                        let _ = writeln!(text, "{} {:.10}", moment.0.max(1), moment.2 as f64);
                    }
                }
                let reached = row.curve.iter().find(|moment| moment.2 == row.report.hits);
                runs.push(json!({
                    "instance": row.report.spec.seed.saturating_add(1),
                    "evals": row.report.counts.evaluations,
                    // the best is a set of hits, not a point; readers expect a list
                    "best": {"evals": reached.map_or(0, |moment| moment.0), "y": row.report.hits as f64, "x": []},
                }));
            }
            let header = json!({
                "version": "0.3.18",
                "suite": "satisfice",
                "function_id": number,
                "function_name": function,
                "maximization": true,
                "algorithm": {"name": line.engine, "info": "distinct hits |C| against evaluations"},
                "attributes": ["evaluations", "raw_y"],
                "scenarios": [{"dimension": 1, "path": data, "runs": runs}],
            });
            let engine = folder.join(plain(&line.engine));
            write(&engine.join(&data), text.as_bytes())?;
            write(
                &engine.join(format!("IOHprofiler_f{number}_{function}.json")),
                &serde_json::to_vec_pretty(&header)?,
            )?;
        }
    }
    Ok(())
}
