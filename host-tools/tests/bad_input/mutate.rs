//! Ways to break a file.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What stands in files by mistake, and what means something to some reader.
const WORDS: [&[u8]; 40] = [
    b"NaN",
    b"-inf",
    b"1e308",
    b"-1e-308",
    b"1e999",
    b"99999999999999999999",
    b"-",
    b"+",
    b".",
    b"0",
    b"-1",
    b"\"",
    b"\"\"",
    b"'",
    b"\n",
    b"\r",
    b"\r\n",
    b"\t",
    b",",
    b",,,,",
    b";",
    b"#",
    b"[",
    b"[[",
    b"]",
    b"{",
    b"}",
    b"=",
    b"<",
    b"/>",
    b"<!--",
    b"&amp;",
    b"\0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\xe2\x88\x92",
    b"\xf0\x9f\xa6\xbe",
    b"pi",
    b"q1_deg",
    b"1/0",
];

/// The bytes with one to five mistakes, the same for the same number.
pub fn mutated(bytes: &[u8], number: u64) -> Vec<u8> {
    let mut rng = ChaCha8Rng::seed_from_u64(number);
    let mut out = bytes.to_vec();
    for _ in 0..rng.random_range(1..=5) {
        let at = if out.is_empty() { 0 } else { rng.random_range(0..out.len()) };
        let end = (at + rng.random_range(1..=24)).min(out.len());
        match rng.random_range(0..9) {
            0 if at < out.len() => out[at] ^= 1 << rng.random_range(0..8),
            1 if at < out.len() => out[at] = rng.random_range(0..=255),
            2 => drop(out.drain(at..end)),
            3 => {
                let copy = out[at..end].to_vec();
                let to = rng.random_range(0..=out.len());
                out.splice(to..to, copy);
            }
            4 => {
                let word = WORDS[rng.random_range(0..WORDS.len())];
                out.splice(at..at, word.iter().copied());
            }
            5 => {
                let word = WORDS[rng.random_range(0..WORDS.len())];
                out.splice(at..end, word.iter().copied());
            }
            6 if number.is_multiple_of(7) => out.truncate(at),
            7 => number_for_a_number(&mut out, at, &mut rng),
            _ => line_for_a_line(&mut out, &mut rng),
        }
    }
    out
}

/// Another number in the place of the one at or behind a byte.
fn number_for_a_number(out: &mut Vec<u8>, at: usize, rng: &mut ChaCha8Rng) {
    let part = |b: &u8| b.is_ascii_digit() || b".-+e".contains(b);
    let Some(begin) = out[at..].iter().position(u8::is_ascii_digit).map(|n| at + n) else { return };
    let end = out[begin..].iter().position(|b| !part(b)).map_or(out.len(), |n| begin + n);
    let numbers: [&[u8]; 12] = [
        b"0",
        b"-0.0",
        b"1e300",
        b"-1e300",
        b"1e-300",
        b"nan",
        b"inf",
        b"360.0",
        b"1e5",
        b"3.5e4",
        b"4294967296",
        b"0.5",
    ];
    out.splice(begin..end, numbers[rng.random_range(0..numbers.len())].iter().copied());
}

/// A line twice, gone, or in another place.
fn line_for_a_line(out: &mut Vec<u8>, rng: &mut ChaCha8Rng) {
    let mut lines: Vec<Vec<u8>> =
        out.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    if lines.is_empty() {
        return;
    }
    let (from, to) = (rng.random_range(0..lines.len()), rng.random_range(0..lines.len()));
    match rng.random_range(0..3) {
        0 => lines.swap(from, to),
        1 => drop(lines.remove(from)),
        _ => lines.insert(to, lines[from].clone()),
    }
    *out = lines.concat();
}
