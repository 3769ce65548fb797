//! The links between particles of a swarm with a random topology.

use crate::error::Error;
use crate::seed::SearchRng;
use crate::state::Part;

/// Each of N particles informs itself and K others drawn with replacement; kept by the informed one.
#[derive(Debug)]
pub(super) struct Informants {
    particles: usize,
    informed: usize,
    /// Whom each particle informs, K a particle.
    links: Vec<u32>,
    /// The informants of particle i are `sources[offsets[i]..offsets[i + 1]]`.
    offsets: Vec<u32>,
    sources: Vec<u32>,
}

impl Informants {
    pub(super) fn new(particles: usize, informed: usize) -> Self {
        Self {
            particles,
            informed,
            links: Vec::new(),
            offsets: Vec::new(),
            sources: Vec::new(),
        }
    }

    /// Forgets all links.
    pub(super) fn clear(&mut self) {
        self.offsets.clear();
        self.sources.clear();
    }

    /// Whether nothing has been drawn yet.
    pub(super) fn is_empty(&self) -> bool {
        self.offsets.is_empty()
    }

    /// Draws all links again. Cost: O(N K).
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the tables allow 10^6 particles, each informing 1000: below 2^32"
    )]
    pub(super) fn draw(&mut self, rng: &mut SearchRng) {
        self.links.clear();
        for _ in 0..self.particles * self.informed {
            self.links.push(rng.below(self.particles) as u32);
        }
        // A counting sort by the informed particle.
        self.offsets.clear();
        self.offsets.resize(self.particles + 1, 0);
        for &target in &self.links {
            self.offsets[target as usize + 1] += 1;
        }
        for i in 0..self.particles {
            self.offsets[i + 1] += self.offsets[i];
        }
        self.sources.clear();
        self.sources.resize(self.links.len(), 0);
        for (link, &target) in self.links.iter().enumerate() {
            let place = &mut self.offsets[target as usize];
            self.sources[*place as usize] = (link / self.informed) as u32;
            *place += 1;
        }
        // Filling has moved each offset to the next one's place.
        self.offsets.rotate_right(1);
        self.offsets[0] = 0;
    }

    /// The informants of particle `i`, without itself.
    #[inline]
    pub(super) fn of(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        let range = self.offsets[i] as usize..self.offsets[i + 1] as usize;
        self.sources[range].iter().map(|&j| j as usize)
    }

    fn check(&self) -> Result<(), Error> {
        let fits = match self.offsets.as_slice() {
            [] => self.sources.is_empty(),
            [first, .., last] => {
                self.offsets.len() == self.particles + 1
                    && *first == 0
                    && *last as usize == self.sources.len()
                    && self.offsets.is_sorted()
                    && self.sources.iter().all(|&j| (j as usize) < self.particles)
            }
            [_] => false,
        };
        if fits {
            Ok(())
        } else {
            Err(Error::State("its informants are of another swarm".to_owned()))
        }
    }
}

impl Part for Informants {
    crate::saved_fields!(offsets, sources; check);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_link_is_found_by_the_particle_that_it_informs() {
        let mut rng = SearchRng::new(1);
        for (particles, informed) in [(1, 3), (40, 3), (7, 0)] {
            let mut informants = Informants::new(particles, informed);
            informants.draw(&mut rng);
            let mut from_sources: Vec<(usize, usize)> = (0..particles)
                .flat_map(|i| informants.of(i).map(move |j| (j, i)).collect::<Vec<_>>())
                .collect();
            let mut from_links: Vec<(usize, usize)> = informants
                .links
                .iter()
                .enumerate()
                .map(|(link, &target)| (link / informed, target as usize))
                .collect();
            from_sources.sort_unstable();
            from_links.sort_unstable();
            assert_eq!(from_sources, from_links);
        }
    }
}
