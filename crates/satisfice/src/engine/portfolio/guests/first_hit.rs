//! Who looks for the first hit beside a model of F.

use super::{GuestKind, Guests, MODELLED, Member};
use crate::context::Context;
use crate::engine::portfolio::credit::Credit;
use crate::engine::portfolio::progress::{Ground, Seeker};
use crate::engine::portfolio::source::{Source, Tag};
use crate::scalar::Real;
use crate::seed::SearchRng;

/// Share of the planned evaluations in which the model and descents look for the first hit.
const FIRST_SHARE: f64 = 0.5;

impl<S: Real> Guests<S> {
    /// Whether a model of the components of F expects no hit of its latest proposals.
    pub(super) fn promises_little(&self) -> bool {
        self.guests.iter().any(|guest| match &guest.engine {
            Member::Model(model) => model.promises_little(),
            Member::Other(_) => false,
        })
    }

    /// What the search for the first hit goes by while a model is at work, and the engines that take part in it beside descents: the model
    /// itself and, last, descents by quadratic models. `None` where nothing leads down, after the first hit, and after its share of the
    /// evaluations.
    pub(in crate::engine::portfolio) fn seekers(
        &self,
        all: &Credit,
        planned: Option<u64>,
    ) -> Option<(Ground, [usize; 2])> {
        let ground = match self.ground? {
            Ground::Components if self.promises_little() => Ground::Smooth,
            ground => ground,
        };
        let most = FIRST_SHARE * planned.map_or(MODELLED, |planned| planned.min(MODELLED)) as f64;
        if !all.is_barren() || all.evaluations() as f64 >= most {
            return None;
        }
        let find = |kind| {
            let mut guests = self.guests.iter();
            guests.position(|guest| guest.kind == kind && guest.is_ready())
        };
        let model = find(GuestKind::Model)?;
        let quadratic = find(GuestKind::Quadratic);
        // Without descents by quadratic models, or while all of them await answers, the model proposes.
        let takes_over = self.in_any_order || ground == Ground::Neighbours;
        let quadratic = quadratic.or(takes_over.then_some(model));
        Some((ground, [model, quadratic?]))
    }

    /// The model, if it expects its next proposal to hit while descents over neighbours look for the first hit.
    pub(in crate::engine::portfolio) fn expects_hit(
        &mut self,
        (ground, [model, _]): (Ground, [usize; 2]),
        context: &dyn Context<S>,
        rng: &mut SearchRng,
    ) -> Option<usize> {
        match &mut self.guests[model].engine {
            Member::Model(engine) if ground == Ground::Neighbours => {
                engine.expects_hit(context, rng).then_some(model)
            }
            _ => None,
        }
    }

    /// What a source is among those that look for the first hit.
    pub(in crate::engine::portfolio) fn seeker(&self, (source, index): Tag) -> Option<Seeker> {
        match source {
            Source::Descent => Some(Seeker::Direct),
            Source::Guest => match self.guests[index].kind {
                GuestKind::Model => Some(Seeker::Model),
                GuestKind::Quadratic => Some(Seeker::Quadratic),
                GuestKind::Cma | GuestKind::Niching | GuestKind::Flood | GuestKind::Regions => None,
            },
            _ => None,
        }
    }
}
