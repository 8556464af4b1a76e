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
        if path.parent().is_some_and(|parent| parent.ends_with("src/scalar")) {
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

#[test]
fn the_square_root_is_that_of_libm_to_the_last_bit() {
    let special = [0.0, -0.0, 1.0, 2.0, 4.0, f32::MAX, f32::MIN_POSITIVE, f32::INFINITY, 1e-45];
    for x in special {
        assert_eq!(Scalar::sqrt(x).to_bits(), x.sqrt().to_bits(), "{x}");
    }
    assert!([f32::NAN, -1.0, f32::NEG_INFINITY, -1e-45].iter().all(|x| Scalar::sqrt(*x).is_nan()));
    // Every 997th number there is, subnormal ones among them.
    for bits in (0..f32::INFINITY.to_bits()).step_by(997) {
        let x = f32::from_bits(bits);
        assert_eq!(Scalar::sqrt(x), x.sqrt(), "{x:e}");
    }
}

#[test]
fn the_angle_of_a_point_is_within_its_bound_and_exact_on_the_axes() {
    let mut worst = 0.0_f64;
    for i in 0..=400_000 {
        let angle = core::f64::consts::PI * (f64::from(i) / 200_000.0 - 1.0);
        for size in [1e-20_f64, 1e-3, 1.0, 1e15] {
            let (y, x) = ((size * angle.sin()) as f32, (size * angle.cos()) as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            worst = worst.max((f64::from(Scalar::atan2(y, x)) - exact).abs());
        }
    }
    println!("atan2: {worst:.1e} rad");
    assert!(worst < 4e-7);
    for (y, x) in
        [(0.0_f32, 1.0_f32), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (-0.0, -1.0), (0.0, 0.0)]
    {
        assert_eq!(Scalar::atan2(y, x).to_bits(), f32::atan2(y, x).to_bits(), "{y} {x}");
    }
    for (y, x) in [(f32::NAN, 1.0), (1.0, f32::NAN), (f32::INFINITY, 1.0)] {
        assert!(Scalar::atan2(y, x).is_nan());
    }
}
