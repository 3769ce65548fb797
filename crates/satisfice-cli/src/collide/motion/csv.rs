//! The pairs of a motion as CSV, the earliest first.

use std::io::{self, Write};

use satisfice_catalogue::quantity::shown::exact;

use super::super::csv::quoted;
use super::report::{ImpactLine, MotionReport};

/// Writes a head line and a line for each pair. Pairs whose time was not computed have empty fields. The names of the bodies
/// follow if a file holds several.
pub(super) fn write(report: &MotionReport<'_>, out: &mut dyn Write) -> io::Result<()> {
    let bodies = &report.frames.bodies;
    let names = bodies.len() > report.frames.request.ends.files()[0];
    write!(
        out,
        "kind,a_body,a_feature,b_body,b_feature,time_low,time_high,at_start,ax,ay,az,bx,by,bz,nx,ny,nz"
    )?;
    writeln!(out, "{}", if names { ",a_name,b_name" } else { "" })?;
    for hit in &report.pairs {
        let line = report.line(hit);
        let ImpactLine { kind, a, b, .. } = &line;
        write!(out, "{kind},{},{},{},{},", a.body, a.feature, b.body, b.feature)?;
        match line.time {
            Some([low, high]) => write!(out, "{},{},", exact(low), exact(high))?,
            None => write!(out, ",,")?,
        }
        if let Some(at_start) = line.at_start {
            write!(out, "{at_start}")?;
        }
        for point in [line.point_a, line.point_b, line.normal] {
            match point {
                Some([x, y, z]) => write!(out, ",{},{},{}", exact(x), exact(y), exact(z))?,
                None => write!(out, ",,,")?,
            }
        }
        if names {
            let name = |body: usize| quoted(&bodies[body].name);
            write!(out, ",{},{}", name(a.body), name(b.body))?;
        }
        writeln!(out)?;
    }
    Ok(())
}
