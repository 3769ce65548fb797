//! After the first frames of a motion nothing allocates: counted by an allocator.

#![allow(clippy::unwrap_used, reason = "a test")]

use allocation_counter::measure;
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::{FeatureTree, PointGrid, TreeJoin};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, World};
use satisfice_collision::{Mesh, Placement, generate};

/// All is done on the thread that is counted: to be called before anything else, since whoever asks first for the pool of all
/// tests gets one of all cores, whose queue grows now and then.
fn on_one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let _ = pool.build_global(); // by the first test for all
    assert_eq!(rayon::current_num_threads(), 1);
}

/// Allocations of each of `N` frames, after a motion has gone to and fro `before` times. `frame` gets 0 and 1 in turn.
fn allocations<const N: usize>(before: usize, mut frame: impl FnMut(usize)) -> [u64; N] {
    (0..2 * before).for_each(|n| frame(n % 2));
    core::array::from_fn(|n| measure(|| frame(n % 2)).count_total)
}

/// Two teapots, the spout of one through the handle of the other, in two places: so many points that all is used that is made
/// for many.
fn teapots() -> (Mesh, [Placement; 2]) {
    let pot = generate::teapot(40).unwrap();
    let places = [4.5, 4.49].map(|by| Placement::from_translation([by, 0.0, 0.0]).unwrap());
    (pot, places)
}

fn threshold() -> Threshold {
    Threshold::new(0.05).unwrap()
}

#[test]
fn grids_allocate_nothing() {
    on_one_thread();
    // so many that the cull is used
    let ball = generate::icosphere(1.0, 6).unwrap();
    let frames = [0.3, 0.31].map(|by| {
        let place = Placement::from_translation([by, 0.0, 0.0]).unwrap();
        place.place(&ball).unwrap()
    });
    let mut grid = PointGrid::new();
    let between = allocations(4, |n| {
        let pairs = grid.between(ball.vertices(), frames[n].vertices(), threshold());
        assert!(pairs.unwrap().len() > 1000);
        assert!(grid.work().isolated > 1000);
    });
    let mut grid = PointGrid::new();
    let within = allocations(4, |n| {
        let pairs = grid.within(frames[n].vertices(), threshold()).unwrap();
        assert!(pairs.len() > 1000);
    });
    assert_eq!([between, within], [[0; 8], [0; 8]]);
}

#[test]
fn trees_allocate_nothing() {
    on_one_thread();
    let (pot, places) = teapots();
    let frames = places.map(|place| place.place(&pot).unwrap());
    let rest = &Placement::IDENTITY;
    for kind in [FeatureKind::Vertex, FeatureKind::Edge, FeatureKind::Triangle] {
        let fixed = FeatureTree::new(&pot, kind);
        let mut tree = FeatureTree::new(&pot, kind);
        let mut join = TreeJoin::new();
        let between = allocations(4, |n| {
            tree.refit(frames[n].vertices()).unwrap();
            let pairs = join.between((&fixed, rest), (&tree, rest), threshold(), None);
            assert!(pairs.unwrap().len() > 1000);
        });
        assert_eq!(between, [0; 8], "{kind:?}");
    }
    let mut tree = FeatureTree::new(&pot, FeatureKind::Vertex);
    let mut join = TreeJoin::new();
    let within = allocations(4, |n| {
        tree.refit(frames[n].vertices()).unwrap();
        assert!(join.within(&tree, threshold(), None).len() > 1000);
    });
    assert_eq!(within, [0; 8]);
}

/// What a world answers is the caller's: some lists per frame, however long they are.
#[test]
fn worlds_allocate_their_answers_only() {
    on_one_thread();
    let (pot, places) = teapots();
    let frames = places.map(|place| place.place(&pot).unwrap());
    for (kind, is_rigid) in [
        (PairKind::VertexVertex, true),
        (PairKind::VertexVertex, false),
        (PairKind::TriangleTriangle, true),
    ] {
        let mut world = World::new(kind, threshold());
        world.add(Body::fixed(pot.clone())).unwrap();
        let body = match is_rigid {
            true => Body::rigid(pot.clone()),
            false => Body::deforming(pot.clone()),
        };
        let body = world.add(body).unwrap();
        let counts: [u64; 20] = allocations(5, |n| {
            match is_rigid {
                true => world.place(body, places[n]).unwrap(),
                false => world.deform(body, frames[n].vertices()).unwrap(),
            }
            assert!(world.frame().unwrap().contacts.len() > 1000);
        });
        // now and then a list of neighbours is rebuilt
        let more = counts.iter().filter(|&&count| count > 12).count();
        assert!(more <= 1, "{kind}, rigid: {is_rigid}: {counts:?}");
    }
}
