//! Own sine and cosine: the stated bound, and where the crate's maths comes from.

use truearm::Scalar;

/// Every exponent below the limit, several thousand mantissas each, both signs.
#[test]
fn f32_sine_and_cosine_keep_their_bound() {
    let mut worst = 0.0_f64;
    let mut count = 0_u64;
    let mut bits = 0_u32;
    while f32::from_bits(bits) < 8192.0 {
        for x in [f32::from_bits(bits), -f32::from_bits(bits)] {
            let (s, c) = x.sin_cos_pair();
            let exact = f64::from(x).sin_cos();
            worst = worst.max((f64::from(s) - exact.0).abs()).max((f64::from(c) - exact.1).abs());
            count += 1;
        }
        bits += 397;
    }
    println!("f32 sin_cos: {count} angles, largest error {worst:.2e}");
    assert!(worst < 1e-7, "{worst:e}");
}

#[test]
fn f32_sine_and_cosine_refuse_what_they_cannot_reduce() {
    for x in [8192.0_f32, -8192.0, 1e6, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        let (s, c) = x.sin_cos_pair();
        assert!(s.is_nan() && c.is_nan(), "{x}: {s} {c}");
    }
}

trait Pair {
    fn sin_cos_pair(self) -> (f32, f32);
}
impl Pair for f32 {
    /// The crate's function, not the inherent one of std.
    fn sin_cos_pair(self) -> (f32, f32) {
        <f32 as Scalar>::sin_cos(self)
    }
}

/// No file of the crate but scalar.rs takes a sine, a root or the like.
#[test]
fn elementary_functions_come_from_scalar_rs_only() {
    fn files(dir: &std::path::Path, out: &mut Vec<std::path::PathBuf>) {
        for entry in std::fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                files(&path, out);
            } else if path.extension().is_some_and(|e| e == "rs") {
                out.push(path);
            }
        }
    }
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Vec::new();
    files(&root, &mut sources);
    assert!(sources.len() > 10);
    let forbidden = [
        "libm::",
        ".sin()",
        ".cos()",
        ".tan()",
        ".powi(",
        ".powf(",
        ".norm()",
        ".normalize()",
        ".magnitude()",
        ".exp()",
        ".ln()",
        "num_traits",
        "mul_add",
        "RealField",
        "ComplexField",
    ];
    for path in sources {
        if path.ends_with("src/scalar.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("//") {
                continue;
            }
            for word in forbidden {
                assert!(!line.contains(word), "{}:{}: {word}", path.display(), number + 1);
            }
        }
    }
}
