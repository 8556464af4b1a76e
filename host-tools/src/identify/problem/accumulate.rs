//! Sums over rows, in chunks and on all cores. Chunks and the order in which
//! they are added depend on the rows alone, so that the last bit of a result
//! does not depend on how many threads there are.

/// Rows of a chunk: their equations stay in the processor's cache.
pub const CHUNK: usize = 128;

/// `join` over a balanced tree of chunks of `size` rows, `leaf` of each chunk.
pub fn tree<T: Send>(
    rows: &[usize],
    size: usize,
    leaf: &(impl Fn(&[usize]) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    if rows.len() <= size {
        return leaf(rows);
    }
    let chunks = rows.len().div_ceil(size);
    let (first, second) = rows.split_at(size * chunks.div_ceil(2));
    let (first, second) =
        rayon::join(|| tree(first, size, leaf, join), || tree(second, size, leaf, join));
    join(first, second)
}
