//! `cargo bench -p truearm-batch`: one pose, with Jacobian, with all parameter columns,
//! and batches by every class of instructions that the processor has.

use core::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use truearm::Scalar;
use truearm_batch::{BatchChain, Cpu, Lanes, Poses, Positions};

mod arm;

use arm::{POSES, chain, joints};

fn batches<T: Lanes>(criterion: &mut Criterion, name: &str) {
    let q = joints::<T>();
    let q = q.each_ref().map(|q| &q[..]);
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(POSES as u64));
    for cpu in Cpu::all() {
        let wide = BatchChain::of(&chain::<T>()).on(cpu);
        let mut out = [(); 12].map(|()| vec![T::ZERO; POSES]);
        group.bench_function(format!("poses, {cpu}"), |bencher| {
            bencher.iter(|| {
                let [x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz] =
                    out.each_mut().map(|out| &mut out[..]);
                let rotation = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]];
                wide.poses(black_box(&q), Poses { positions: Positions { x, y, z }, rotation })
            });
        });
        group.bench_function(format!("points, {cpu}"), |bencher| {
            bencher.iter(|| {
                let [x, y, z, ..] = out.each_mut().map(|out| &mut out[..]);
                wide.positions(black_box(&q), Positions { x, y, z })
            });
        });
    }
    group.finish();
}

fn single<T: Scalar>(criterion: &mut Criterion, name: &str) {
    let (chain, columns) = (chain::<T>(), joints::<T>());
    let mut at = 0;
    // Another pose every time: the branches of a sine are not to be guessed.
    let mut next = move || {
        at = (at + 1) % POSES;
        columns.each_ref().map(|q| q[at])
    };
    let mut group = criterion.benchmark_group(name);
    group.bench_function("forward", |b| b.iter(|| chain.forward(&next())));
    group.bench_function("with Jacobian", |b| b.iter(|| chain.jacobian(&next())));
    group.bench_function("all 39 parameter columns", |b| {
        let turns = chain.link_turns();
        b.iter(|| chain.identification_jacobian_with(&turns, &next()));
    });
    group.finish();
}

fn all(criterion: &mut Criterion) {
    single::<f64>(criterion, "one pose, f64");
    single::<f32>(criterion, "one pose, f32");
    batches::<f64>(criterion, "1024 poses, f64");
    batches::<f32>(criterion, "1024 poses, f32");
}

criterion_group!(benches, all);
criterion_main!(benches);
