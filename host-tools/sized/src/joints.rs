//! From a number of joints known at run time to one known to the compiler.

/// Calls `$body` with the constant `N` equal to the run-time `$n`.
#[macro_export]
macro_rules! with_joints {
    ($n:expr, $N:ident => $body:expr) => {{
        macro_rules! arm {
            ($count:literal) => {{
                const $N: usize = $count;
                $body
            }};
        }
        match $n {
            1 => arm!(1),
            2 => arm!(2),
            3 => arm!(3),
            4 => arm!(4),
            5 => arm!(5),
            6 => arm!(6),
            7 => arm!(7),
            8 => arm!(8),
            9 => arm!(9),
            10 => arm!(10),
            11 => arm!(11),
            12 => arm!(12),
            13 => arm!(13),
            14 => arm!(14),
            15 => arm!(15),
            16 => arm!(16),
            n => unreachable!("robot files have 1 to 16 joints, not {n}"),
        }
    }};
}

/// A slice whose length the file reader has checked.
///
/// # Panics
/// Of another length than N.
#[must_use]
pub fn fixed<T: Copy, const N: usize>(q: &[T]) -> [T; N] {
    q.try_into().unwrap_or_else(|_| unreachable!("every row has a value for every joint"))
}
