//! How the points and the state of a model are saved.

use super::local::{Model, outputs};
use super::pool::Pool;
use super::process::Process;
use super::record::Record;
use super::region::TrustRegion;
use super::scales::Scales;
use super::target::Target;
use super::units::Units;
use crate::error::Error;
use crate::state::{Part, Reader, State};

impl Record {
    pub(super) fn save(&self, state: &mut State) {
        let (axes, numbers, lists) = self.saved();
        Part::save(&axes, state);
        numbers.iter().for_each(|numbers| Part::save(numbers, state));
        lists.iter().for_each(|list| Part::save(list, state));
    }

    pub(super) fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        let axes = from.read()?;
        let numbers = [from.read()?, from.read()?, from.read()?];
        *self = Self::restored(axes, numbers, [from.read()?, from.read()?])
            .ok_or_else(|| Error::State("its points do not fit".to_owned()))?;
        Ok(())
    }
}

impl Model {
    pub(super) fn save(&self, state: &mut State) {
        let (candidates, excluded, next) = self.pool.saved();
        Part::save(&self.process.scales.logs, state);
        Part::save(&self.target.delta, state);
        Part::save(&self.target.clip, state);
        Part::save(&self.target.units, state);
        Part::save(&self.target.norm, state);
        Part::save(&self.region.known, state);
        Part::save(&self.region.lower, state);
        Part::save(&self.region.upper, state);
        Part::save(&self.prefix, state);
        Part::save(&self.fitted, state);
        Part::save(&self.taken, state);
        Part::save(&self.reach, state);
        Part::save(&self.radius, state);
        Part::save(&candidates, state);
        Part::save(&excluded, state);
        Part::save(&next, state);
    }

    /// Factors the same points in the same order as the model that was saved, which gives the same bits.
    pub(super) fn restore(record: &Record, units: &Units, from: &mut Reader<'_>) -> Result<Self, Error> {
        let logs: Vec<f64> = from.read()?;
        let scales = Scales {
            logs,
            shapes: units.shapes(),
        };
        let target = Target {
            delta: from.read()?,
            clip: from.read()?,
            units: from.read()?,
            norm: from.read()?,
        };
        let region = TrustRegion {
            known: from.read()?,
            lower: from.read()?,
            upper: from.read()?,
        };
        let [prefix, fitted, taken]: [usize; 3] = from.read()?;
        let reach: Vec<f64> = from.read()?;
        let radius = from.read()?;
        let pool = Pool::restored(
            record.axes(),
            &from.read::<Vec<f64>>()?,
            &from.read::<Vec<bool>>()?,
            from.read()?,
        );
        let axes = [
            region.lower.len(),
            region.upper.len(),
            reach.len(),
            scales.logs.len().wrapping_sub(1),
        ];
        let fits = axes.iter().all(|&axes| axes == record.axes())
            && prefix > 0
            && prefix <= region.known.len()
            && taken <= record.len()
            && target.units.len() == record.component_count()
            && region.known.iter().all(|&i| i < record.len());
        let (true, Some(mut pool)) = (fits, pool) else {
            return Err(Error::State("its model does not fit".to_owned()));
        };
        pool.limits = target.limits();
        let inputs: Vec<&[f64]> = region.known[..prefix].iter().map(|&i| record.point(i)).collect();
        let values = outputs(record, &target, &region.known[..prefix]);
        let mut process = Process::new(scales, &inputs, &values);
        for &i in &region.known[prefix..] {
            process.push(record.point(i), &target.of_point(record, i));
        }
        Ok(Self {
            process,
            target,
            region,
            prefix,
            fitted,
            taken,
            reach,
            radius,
            pool,
        })
    }
}
