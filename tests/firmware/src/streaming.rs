//! What streaming identification costs.

use core::cell::RefCell;
use core::hint::black_box;

use truearm::solve::{LambdaChoice, Memory, SolveError, StreamingTikhonov};

use crate::measure::Counter;
use crate::stack;

/// Unknowns of the measured identification.
const UNKNOWNS: usize = 30;
type Columns = [[f32; 3]; UNKNOWNS];
type Stream = StreamingTikhonov<f32, UNKNOWNS>;

/// Figures of an identification that has seen many points: the mean of 64
/// different ones, 16 rounds.
pub struct Figures {
    /// Tenths of instructions for one point of three rows.
    pub push: u64,
    /// Bytes of stack for one point.
    pub push_stack: usize,
    /// Tenths of instructions to choose lambda.
    pub choose: u64,
    /// Bytes of stack to choose lambda.
    pub choose_stack: usize,
    /// Bytes of stack to solve with all points and their variances.
    pub solve_stack: usize,
}

/// Measures; `None` when the crate refuses what it is given here or takes more
/// stack than it states.
#[inline(never)]
pub fn measure(counter: &mut Counter) -> Option<Figures> {
    let mut seed = 1_u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut points = [([[0.0; 3]; UNKNOWNS], [0.0; 3]); 64];
    for (columns, rhs) in &mut points {
        *columns = [[0; 3]; UNKNOWNS].map(|column| column.map(|_| next()));
        *rhs = [0; 3].map(|_| next());
    }
    // Holding one point in five out would hide a part of the cost.
    let stream = RefCell::new(Stream::new(0, 1.0).ok()?);
    let work = |(columns, rhs): &(Columns, [f32; 3])| {
        if let Ok(mut stream) = stream.try_borrow_mut() {
            let _ = push(black_box(&mut *stream), columns, rhs);
        }
    };
    points.iter().for_each(work);
    let push_stack = stack::used(&mut || points.iter().take(1).for_each(work));
    let push = counter.tenths_per_call(16, &points, work);
    let mut judged = Stream::new(5, 1.0).ok()?;
    for (columns, rhs) in &points {
        judged.push(columns, rhs).ok()?;
    }
    let choose_stack = stack::used(&mut || {
        let _ = black_box(choose(black_box(&mut judged)));
    });
    let solve_stack = stack::used(&mut || {
        let _ = black_box(solve(black_box(&mut judged)));
    });
    // The figure that truearm states.
    if choose_stack.max(solve_stack) > Memory::of(UNKNOWNS, 4).workspace {
        return None;
    }
    let judged = RefCell::new(judged);
    let choose = counter.tenths_per_call(1, &[&judged], |judged| {
        if let Ok(mut judged) = judged.try_borrow_mut() {
            let _ = black_box(choose(&mut judged));
        }
    });
    Some(Figures { push, push_stack, choose, choose_stack, solve_stack })
}

#[inline(never)]
fn push(stream: &mut Stream, columns: &Columns, rhs: &[f32; 3]) -> Result<bool, SolveError> {
    stream.push(columns, rhs)
}

#[inline(never)]
fn choose(stream: &mut Stream) -> Result<LambdaChoice<f32>, SolveError> {
    stream.choose(&[1.0; UNKNOWNS])
}

#[inline(never)]
fn solve(stream: &mut Stream) -> Result<[f32; UNKNOWNS], SolveError> {
    let all = stream.all()?;
    let solution = all.solve(1.0, &[1.0; UNKNOWNS])?;
    let variances = all.variances(1.0, &[1.0; UNKNOWNS])?;
    black_box(&variances);
    Ok(solution.x)
}
