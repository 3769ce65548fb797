//! Problems behind a pointer.

use super::SatisficingProblem;
use crate::capability::{Bounds, Components, Encoding, Neighbourhood};
use crate::description::Description;
use crate::space::Space;

/// A problem behind a pointer. A search is compiled once for each type of solution, not once for each problem: a call through the
/// pointer costs a few nanoseconds, and a copy of the search takes seconds to build.
pub(crate) type AnyProblem<'p, S, T> = dyn SatisficingProblem<Scalar = S, Solution = T> + 'p;

/// A reference to a problem is the same problem.
impl<P: SatisficingProblem + ?Sized> SatisficingProblem for &P {
    type Scalar = P::Scalar;
    type Solution = P::Solution;

    fn space(&self) -> &Space<Self::Scalar> {
        (**self).space()
    }
    fn decode(&self, values: &[Self::Scalar]) -> Self::Solution {
        (**self).decode(values)
    }
    fn fitness(&self, solution: &Self::Solution) -> Self::Scalar {
        (**self).fitness(solution)
    }
    fn threshold(&self) -> Self::Scalar {
        (**self).threshold()
    }
    fn decode_into(&self, values: &[Self::Scalar], solution: &mut Self::Solution) {
        (**self).decode_into(values, solution);
    }
    fn fitness_all(&self, solutions: &[Self::Solution], fitness: &mut [Self::Scalar]) {
        (**self).fitness_all(solutions, fitness);
    }
    fn encoding(&self) -> Option<&dyn Encoding<Self::Scalar, Self::Solution>> {
        (**self).encoding()
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<Self::Solution>> {
        (**self).neighbourhood()
    }
    fn bounds(&self) -> Option<&dyn Bounds<Self::Scalar>> {
        (**self).bounds()
    }
    fn components(&self) -> Option<&dyn Components<Self::Scalar, Self::Solution>> {
        (**self).components()
    }
    fn canonical(&self, hit: &Self::Solution) -> Option<Self::Solution> {
        (**self).canonical(hit)
    }
    fn description(&self) -> Description {
        (**self).description()
    }
}
