//! What a streaming update costs.

use core::hint::black_box;

use truearm::solve::Triangle;

use crate::measure::Counter;

/// Unknowns of the measured triangle.
const UNKNOWNS: usize = 30;
type Columns = [[f32; 3]; UNKNOWNS];

/// Tenths of instructions for one tracker point into a triangle that has seen
/// many: the mean over 64 different points, 16 rounds.
pub fn push(counter: &mut Counter) -> u64 {
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
    let triangle = core::cell::RefCell::new(Triangle::new());
    let mut work = |(columns, rhs): &(Columns, [f32; 3])| {
        if let Ok(mut triangle) = triangle.try_borrow_mut() {
            let _ = push_one(black_box(&mut *triangle), columns, rhs);
        }
    };
    points.iter().for_each(&mut work);
    counter.tenths_per_call(16, &points, work)
}

#[inline(never)]
fn push_one(
    triangle: &mut Triangle<f32, UNKNOWNS>,
    columns: &Columns,
    rhs: &[f32; 3],
) -> Result<(), truearm::solve::SolveError> {
    triangle.push(columns, rhs)
}
