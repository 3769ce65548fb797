//! The pairs as CSV.

use std::io::{self, Write};

use satisfice_catalogue::quantity::shown::exact;

use super::pairs::{Line, Pairs};
use super::scene::World;

/// Writes a head line and a line for each pair. Pairs that were not measured have an empty distance. The names of the
/// bodies follow if a file holds several.
pub(super) fn write(pairs: &Pairs, world: &World, out: &mut dyn Write) -> io::Result<()> {
    let names = world.has_scenes();
    write!(out, "a_body,a_feature,b_body,b_feature,distance")?;
    if pairs.witnesses.is_some() {
        write!(out, ",ax,ay,az,bx,by,bz,nx,ny,nz,a_part,b_part")?;
    }
    writeln!(out, "{}", if names { ",a_name,b_name" } else { "" })?;
    for index in 0..pairs.len() {
        let line = pairs.line(index, world);
        let Line { a, b, distance, .. } = &line;
        write!(out, "{},{},{},{},", a.body, a.feature, b.body, b.feature)?;
        if let Some(distance) = distance {
            write!(out, "{}", exact(*distance))?;
        }
        if pairs.witnesses.is_some() {
            witness(&line, out)?;
        }
        if names {
            let name = |body: usize| quoted(&world.bodies[body].name);
            write!(out, ",{},{}", name(a.body), name(b.body))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Two points, the normal and the parts; empty if they are not known.
fn witness(line: &Line, out: &mut dyn Write) -> io::Result<()> {
    let Some(witness) = &line.witness else {
        return write!(out, ",,,,,,,,,,,");
    };
    for c in witness.point_a.iter().chain(&witness.point_b) {
        write!(out, ",{}", exact(*c))?;
    }
    match witness.normal {
        Some([x, y, z]) => write!(out, ",{},{},{}", exact(x), exact(y), exact(z))?,
        None => write!(out, ",,,")?,
    }
    write!(out, ",{},{}", witness.part_a, witness.part_b)
}

/// A field in quotes if it needs them (RFC 4180).
pub(super) fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
