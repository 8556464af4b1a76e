//! `cargo xtask counts`: instructions that valgrind counts of the kernels, for [`POSES`] poses
//! each. What it prints is held against `counts.toml`. Arm, poses and room for results are made
//! before anything is counted.

#![allow(missing_docs, reason = "what the macros write has no words")]

use core::hint::black_box;

use gungraun::Callgrind;
use gungraun::prelude::*;
use truearm::Chain;
use truearm_batch::{BatchChain, Lanes, Poses, Positions};

mod arm;

use arm::{POSES, chain, joints};

/// An arm and poses, one by one.
type Single = (Chain<f64, 6>, Vec<[f64; 6]>);

fn single() -> Single {
    let columns = joints();
    (chain(), (0..POSES).map(|k| columns.each_ref().map(|q| q[k])).collect())
}

/// An arm, a slice a joint, and room for positions and rotations.
type Batch<T> = (BatchChain<T>, [Vec<T>; 6], [Vec<T>; 12]);

/// On the path that the chain chooses by itself: valgrind says of a processor with AVX-512 that it
/// has none.
fn room<T: Lanes>() -> Batch<T> {
    let chain = BatchChain::of(&chain());
    assert_eq!(chain.cpu().name(), "AVX2", "the budgets are of the AVX2 path");
    (chain, joints(), [(); 12].map(|()| vec![T::ZERO; POSES]))
}

/// Aligns the stack where it is, and so all that is called from there.
#[repr(align(64))]
struct Line;

/// Large results are copied, and the C library copies by other steps to another place within a
/// line of the cache: where the stack begins there goes with the length of the program's path.
#[inline(always)]
fn each<R>(poses: &[[f64; 6]], kernel: impl Fn(&[f64; 6]) -> R) {
    let line = Line;
    black_box(&line);
    for q in poses {
        black_box(&kernel(black_box(q)));
    }
}

// All return what they were given, so that its memory is freed uncounted.

#[library_benchmark]
#[bench::f64(single())]
fn forward((chain, poses): Single) -> Single {
    each(&poses, |q| chain.forward(q));
    (chain, poses)
}

#[library_benchmark]
#[bench::f64(single())]
fn jacobian((chain, poses): Single) -> Single {
    each(&poses, |q| chain.jacobian(q));
    (chain, poses)
}

#[library_benchmark]
#[bench::f64(single())]
fn columns((chain, poses): Single) -> Single {
    let turns = chain.link_turns();
    each(&poses, |q| chain.identification_jacobian_with(&turns, q));
    (chain, poses)
}

#[library_benchmark]
#[bench::avx2_f64(room::<f64>())]
#[bench::avx2_f32(room::<f32>())]
fn batch<T: Lanes>((chain, q, mut out): Batch<T>) -> Batch<T> {
    let [x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz] = out.each_mut().map(|out| &mut out[..]);
    let rotation = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]];
    let results = Poses { positions: Positions { x, y, z }, rotation };
    let done = chain.poses(black_box(&q.each_ref().map(|q| &q[..])), results);
    assert!(black_box(done).is_ok());
    (chain, q, out)
}

library_benchmark_group!(
    name = kernels;
    benchmarks = forward, jacobian, columns, batch
);

main!(
    config = LibraryBenchmarkConfig::default().tool(Callgrind::with_args(["--cache-sim=no"]));
    library_benchmark_groups = kernels
);
