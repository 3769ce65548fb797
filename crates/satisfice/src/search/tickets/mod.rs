//! A slice whose evaluations happen elsewhere and are answered in any order.

mod agenda;
mod contents;
mod eager;
mod lane;
mod log;
mod ordered;
mod out;
mod saved;
mod ticket;

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use super::Search;
use crate::archive::Archive;
use crate::budget::Budget;
use crate::error::Error;
use crate::identity::Identity;
use crate::problem::{AnyProblem, SatisficingProblem};
use crate::report::{Counts, Report};
use crate::scalar::Real;

use eager::Eager;
use log::ValueBits;
use ordered::Ordered;

pub(super) use contents::SavedTickets;
pub use log::{TicketEvent, TicketLog};
pub use ticket::{Asked, Order, Ticket, TicketCounts, Told};

/// Coordinates of all open points: half a gigabyte of numbers, and there are a few copies.
const MOST_COORDINATES: usize = 1 << 26;

/// A slice whose evaluations happen elsewhere: on other machines, in a simulator, in another language. It gives out solutions
/// under tickets ([`ask`](Tickets::ask)) and takes their fitness in any order ([`tell`](Tickets::tell)).
///
/// It owns its search and its problem, so that it can be kept in a structure, moved to another thread, or held by another
/// language; `P` may be a `dyn SatisficingProblem`. A problem without a fitness is made by
/// [`evaluated_elsewhere`](crate::problem::evaluated_elsewhere). The fitness of a problem that has one is not called, except
/// for [canonical](SatisficingProblem::canonical) hits.
///
/// There are two orders:
///
/// - [`ordered`](Tickets::ordered): answers are kept until the batch they belong to is complete. The report is that of
///   [`Search::run`], but for times, whatever the number of workers and the order of their answers. Engines that propose few
///   points at once keep few workers busy; several [islands](Search::islands) have as many batches out.
/// - [`eager`](Tickets::eager): each answer is entered as soon as it is told, and there is always more to ask for. An engine
///   that takes answers [in any order](crate::engine::Answers) is asked for more while some are awaited. Of others, several work
///   side by side, each on a batch; a batch of which half is answered is closed when more is asked for, and its engine is told
///   the rest later. The report depends on the order of the answers: the [log](Tickets::log) replays it.
///
/// A pool of workers:
///
/// ```
/// use std::sync::mpsc;
/// use satisfice::{from_fn, Budget, SatisficingProblem, Search, Space, Tickets};
///
/// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
/// let mut tickets = Tickets::eager(Search::new(), problem.clone(), &Budget::evaluations(3000))?;
/// let (send, answers) = mpsc::channel();
/// let workers: Vec<_> = (0..4)
///     .map(|_| {
///         let (work, jobs) = mpsc::channel::<satisfice::Asked<_>>();
///         let (send, problem) = (send.clone(), problem.clone());
///         let thread = std::thread::spawn(move || {
///             for job in jobs {
///                 let value = problem.fitness(&job.solution); // minutes, on another machine
///                 let _ = send.send((job.ticket, value));
///             }
///         });
///         (work, thread)
///     })
///     .collect();
/// let mut turn = workers.iter().cycle();
/// loop {
///     for job in tickets.ask(8 - tickets.open()) {
///         let (work, _) = turn.next().expect("there are workers");
///         work.send(job).expect("they wait for work");
///     }
///     if tickets.open() == 0 {
///         break; // the slice is over
///     }
///     let (ticket, value) = answers.recv().expect("somebody works");
///     tickets.tell(ticket, value)?;
/// }
/// for (work, thread) in workers {
///     drop(work);
///     thread.join().expect("workers do not panic");
/// }
/// assert_eq!(tickets.finish().hit_count(), 6);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct Tickets<P: SatisficingProblem + ?Sized> {
    search: Search<P>,
    problem: Arc<P>,
    state: Inner<P>,
    next: u64,
    /// Open tickets of a slice that was saved, to be asked again.
    again: VecDeque<u64>,
    /// Whether there was nothing more to ask for, and nothing was told since.
    waits: bool,
    forgotten: BTreeSet<u64>,
    counts: TicketCounts,
    log: TicketLog<P::Solution>,
}

/// The slice in one order or the other.
enum Inner<P: SatisficingProblem + ?Sized> {
    Ordered(Ordered<P::Scalar, P::Solution>),
    Eager(Eager<P::Scalar, P::Solution>),
}

impl<P: SatisficingProblem + ?Sized> core::fmt::Debug for Tickets<P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Tickets")
            .field("search", &self.search)
            .field("order", &self.order())
            .field("counts", &self.counts)
            .finish_non_exhaustive()
    }
}

impl<P: SatisficingProblem + ?Sized> Tickets<P> {
    /// Begins a slice whose report is that of [`Search::run`], but for times.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn ordered(search: Search<P>, problem: impl Into<Arc<P>>, budget: &Budget) -> Result<Self, Error> {
        Self::begin(search, problem, budget, Order::Ordered)
    }

    /// Begins a slice that waits for no answer as long as there are others.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn eager(search: Search<P>, problem: impl Into<Arc<P>>, budget: &Budget) -> Result<Self, Error> {
        Self::begin(search, problem, budget, Order::Eager)
    }

    /// Begins a slice in this order.
    ///
    /// # Errors
    /// As [`Search::run`].
    pub fn begin(
        mut search: Search<P>,
        problem: impl Into<Arc<P>>,
        budget: &Budget,
        order: Order,
    ) -> Result<Self, Error> {
        let problem = problem.into();
        let kept = &mut search.kept;
        let state = match order {
            Order::Ordered => Inner::Ordered(Ordered::new(kept.start(&&*problem, budget)?)),
            Order::Eager => Inner::Eager(Eager::begin(kept, &&*problem, budget)?),
        };
        Ok(Self::new(search, problem, state))
    }

    fn new(search: Search<P>, problem: Arc<P>, state: Inner<P>) -> Self {
        Self {
            search,
            problem,
            state,
            next: 0,
            again: VecDeque::new(),
            waits: false,
            forgotten: BTreeSet::new(),
            counts: TicketCounts::default(),
            log: TicketLog::default(),
        }
    }

    /// In what order answers are taken.
    #[must_use]
    pub fn order(&self) -> Order {
        match self.state {
            Inner::Ordered(_) => Order::Ordered,
            Inner::Eager(_) => Order::Eager,
        }
    }

    /// At most `n` solutions to evaluate. Fewer where others have to be answered first or where the budget is all given out;
    /// none while none is [open](Tickets::open) means that the slice is over.
    ///
    /// In [eager](Tickets::eager) order at most 65,536 tickets are open at a time, fewer in a space of more than 1,024 axes.
    ///
    /// After [`resume`](Tickets::resume), the tickets that were open come first, under their numbers.
    pub fn ask(&mut self, n: usize) -> Vec<Asked<P::Solution>> {
        let mut asked = Vec::new();
        while asked.len() < n {
            let Some(number) = self.again.pop_front() else {
                break;
            };
            if let Some(solution) = self.solution(Ticket(number)) {
                asked.push(Asked {
                    ticket: Ticket(number),
                    solution: solution.clone(),
                });
            }
        }
        let repeated = asked.len();
        if self.waits || repeated == n {
            return asked;
        }
        let mut wanted = n - repeated;
        if let Inner::Eager(eager) = &mut self.state {
            let room = most_open(self.problem.space().dimension()).saturating_sub(eager.open());
            wanted = wanted.min(room);
            if wanted == 0 {
                return asked;
            }
            eager.slice.ledger.at_once = eager.open() + wanted;
        }
        let n = repeated + wanted;
        while asked.len() < n {
            let (kept, problem) = (&self.search.kept, &&*self.problem);
            let solution = match &mut self.state {
                Inner::Ordered(ordered) => ordered.next(self.next, problem, &kept.previous),
                Inner::Eager(eager) => eager.next(self.next, problem, kept),
            };
            let Some(solution) = solution else { break };
            let ticket = Ticket(self.next);
            self.next += 1;
            asked.push(Asked { ticket, solution });
        }
        let given = (asked.len() - repeated) as u64;
        self.counts.asked += given;
        self.waits = asked.len() < n;
        self.log.push(TicketEvent::Asked {
            wanted: wanted as u64,
            given,
        });
        asked
    }

    /// Tells the fitness of a solution that was [asked](Tickets::ask). NaN and infinite values are counted as such, and are
    /// never a hit. Where the evaluation itself has failed, tell NaN and count it with
    /// [`RunReport::set_failed`](crate::RunReport::set_failed), for a proof takes NaN for no hit. A value for a ticket that has one or that was forgotten is counted and dropped. What else may become of it, [`Told`]
    /// says.
    ///
    /// # Errors
    /// [`Error::Ticket`] for a ticket that was never given out.
    pub fn tell(&mut self, ticket: Ticket, value: P::Scalar) -> Result<Told, Error> {
        let told = self.take(ticket, value)?;
        self.waits &= told != Told::Taken;
        *match told {
            Told::Taken => &mut self.counts.taken,
            Told::Again => &mut self.counts.again,
            Told::Late => &mut self.counts.late,
            Told::Over => &mut self.counts.over,
        } += 1;
        let value = ValueBits::of(value);
        self.log.push(TicketEvent::Told { ticket, value });
        Ok(told)
    }

    fn take(&mut self, ticket: Ticket, value: P::Scalar) -> Result<Told, Error> {
        self.check(ticket)?;
        let (problem, previous) = (&&*self.problem, &self.search.kept.previous);
        let taken = match &mut self.state {
            Inner::Ordered(ordered) => ordered.tell(ticket.0, Some(value), problem, previous),
            Inner::Eager(eager) => eager.tell(ticket.0, Some(value), problem, previous),
        };
        Ok(match taken {
            Some(told) => told,
            None if self.forgotten.contains(&ticket.0) => Told::Late,
            None => Told::Again,
        })
    }

    /// Gives up a solution whose evaluation was lost; returns whether its ticket was open. It uses up no budget.
    ///
    /// # Errors
    /// [`Error::Ticket`] for a ticket that was never given out.
    pub fn forget(&mut self, ticket: Ticket) -> Result<bool, Error> {
        self.check(ticket)?;
        let (problem, previous) = (&&*self.problem, &self.search.kept.previous);
        let was_open = match &mut self.state {
            Inner::Ordered(ordered) => ordered.tell(ticket.0, None, problem, previous),
            Inner::Eager(eager) => eager.tell(ticket.0, None, problem, previous),
        }
        .is_some();
        if was_open {
            self.waits = false;
            self.forgotten.insert(ticket.0);
            self.counts.forgotten += 1;
        }
        self.log.push(TicketEvent::Forgotten { ticket });
        Ok(was_open)
    }

    /// Enters a fitness that is known from elsewhere. It is counted as [informed](Counts::informed) and uses up no budget. A
    /// hit enters the archive; engines learn of it if the problem has an [encoding](SatisficingProblem::encoding). In order, it
    /// is entered before the next batch is proposed.
    ///
    /// # Errors
    /// [`Error::Solution`] if the values that encode the solution are not in the space.
    pub fn inform(&mut self, solution: &P::Solution, value: P::Scalar) -> Result<(), Error> {
        let (problem, previous) = (&&*self.problem, &self.search.kept.previous);
        let position = position_of(problem, solution)?;
        match &mut self.state {
            Inner::Ordered(ordered) => ordered.inform(problem, previous, solution, value, position),
            Inner::Eager(eager) => eager.inform(problem, previous, solution, value, &position),
        }
        self.waits = false;
        let value = ValueBits::of(value);
        let solution = solution.clone();
        self.log.push(TicketEvent::Informed { solution, value });
        Ok(())
    }

    fn check(&self, ticket: Ticket) -> Result<(), Error> {
        if ticket.0 < self.next {
            Ok(())
        } else {
            Err(Error::Ticket(ticket.0))
        }
    }

    /// Number of open tickets: given out, neither told nor forgotten.
    #[must_use]
    pub fn open(&self) -> usize {
        match &self.state {
            Inner::Ordered(ordered) => ordered.open(),
            Inner::Eager(eager) => eager.open(),
        }
    }

    /// The open tickets, ascending.
    #[must_use]
    pub fn pending(&self) -> Vec<Ticket> {
        let numbers = match &self.state {
            Inner::Ordered(ordered) => ordered.pending(),
            Inner::Eager(eager) => eager.pending(),
        };
        numbers.into_iter().map(Ticket).collect()
    }

    /// The solution of an open ticket.
    #[must_use]
    pub fn solution(&self, ticket: Ticket) -> Option<&P::Solution> {
        match &self.state {
            Inner::Ordered(ordered) => ordered.solution(ticket.0),
            Inner::Eager(eager) => eager.solution(ticket.0),
        }
    }

    /// The hits so far; ordered, with several lanes, those of their last exchange.
    #[must_use]
    pub fn hits(&self) -> &Archive<P::Solution> {
        self.slice().ledger.archive.all()
    }

    /// What was counted so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.slice().counts()
    }

    /// What happened to the tickets so far.
    #[must_use]
    pub fn ticket_counts(&self) -> TicketCounts {
        let unused = match &self.state {
            Inner::Ordered(ordered) => ordered.unused,
            Inner::Eager(_) => 0,
        };
        TicketCounts {
            unused,
            ..self.counts
        }
    }

    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &P {
        &self.problem
    }

    /// Everything that was asked and told, in that order.
    #[must_use]
    pub fn log(&self) -> &TicketLog<P::Solution> {
        &self.log
    }

    /// Repeats what a log says on a slice that has just begun: with the same search, problem and budget of evaluations, the
    /// state is then the one that the log was taken from.
    ///
    /// # Errors
    /// [`Error::State`] if the log does not fit; [`Error::Ticket`], [`Error::Solution`].
    pub fn replay(&mut self, log: &TicketLog<P::Solution>) -> Result<(), Error> {
        for event in log.events() {
            match event {
                TicketEvent::Asked { wanted, given } => {
                    let wanted = usize::try_from(*wanted).unwrap_or(usize::MAX);
                    let now = self.ask(wanted).len() as u64;
                    if now != *given {
                        return Err(Error::State(format!(
                            "its log gave out {given} tickets where there are {now}"
                        )));
                    }
                }
                TicketEvent::Told { ticket, value } => {
                    self.tell(*ticket, value.value())?;
                }
                TicketEvent::Forgotten { ticket } => {
                    self.forget(*ticket)?;
                }
                TicketEvent::Informed { solution, value } => self.inform(solution, value.value())?,
            }
        }
        Ok(())
    }

    /// The report as it is now. A slice that is not over counts as cancelled, or as out of time if its time is over. Cost: a copy of the hits.
    #[must_use]
    pub fn report(&self) -> Report<P::Solution> {
        let slice = self.slice();
        let mut report = self
            .search
            .kept
            .describe(&&*self.problem, slice, slice.ledger.times_so_far());
        let evaluations = report.counts.evaluations;
        match &self.state {
            Inner::Ordered(ordered) => {
                let lanes = ordered.running.lanes.iter();
                report
                    .sources
                    .record(evaluations, lanes.map(|lane| lane.lane.engine.sources()));
            }
            Inner::Eager(eager) => {
                let lanes = eager.lanes.iter();
                report
                    .sources
                    .record(evaluations, lanes.map(|lane| lane.lane.engine.sources()));
            }
        }
        let mut archive = slice.ledger.archive.all().clone();
        archive.rest();
        report.archive = Arc::new(archive);
        report
    }

    /// Ends the slice and reports. One that is not over counts as cancelled; answers that wait for others are entered.
    #[must_use]
    pub fn finish(self) -> Report<P::Solution> {
        self.finish_slice().0
    }

    /// [`finish`](Tickets::finish), with the search for the next slice.
    #[must_use]
    pub fn finish_slice(self) -> (Report<P::Solution>, Search<P>) {
        let Self {
            mut search,
            problem,
            state,
            ..
        } = self;
        let running = match state {
            Inner::Ordered(ordered) => ordered.finish(&&*problem, &search.kept.previous),
            Inner::Eager(eager) => eager.finish(),
        };
        (search.kept.report(&&*problem, running), search)
    }

    fn slice(&self) -> &super::slice::Slice<P::Scalar, P::Solution> {
        match &self.state {
            Inner::Ordered(ordered) => ordered.running.reported(),
            Inner::Eager(eager) => &eager.slice,
        }
    }
}

/// So many tickets are open at most: as many as evaluations can go on at once, and so few that memory holds their points.
fn most_open(dimension: usize) -> usize {
    (MOST_COORDINATES / dimension.max(1)).clamp(1, Budget::MOST_PARALLEL)
}

/// Position of a solution, empty if the problem does not encode it.
fn position_of<S: Real, T: Identity + Clone + Send + Sync>(
    problem: &AnyProblem<'_, S, T>,
    solution: &T,
) -> Result<Vec<S>, Error> {
    let space = problem.space();
    let mut position = vec![num_traits::Zero::zero(); space.dimension()];
    let Some(encoding) = problem.encoding() else {
        return Ok(Vec::new());
    };
    if !encoding.encode(solution, &mut position) {
        return Err(Error::Solution("it has no values".to_owned()));
    }
    space.check_values(&position)?;
    space.positions(&mut position);
    Ok(position)
}
