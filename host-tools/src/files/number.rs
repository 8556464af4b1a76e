/// A number as a person would write it: the shortest decimal within a few
/// roundings of it, so that 0.1273 m become 127.3 mm and not
/// 127.30000000000001. Nothing that a measurement or a drawing knows is lost.
#[must_use]
pub fn number(value: f64) -> String {
    let close = |digits: usize| {
        let short: f64 = format!("{value:.digits$e}").parse().ok()?;
        ((short - value).abs() <= 4.0 * f64::EPSILON * value.abs()).then_some(short)
    };
    // Adding zero takes the sign from a zero.
    format!("{:?}", (0..17).find_map(close).unwrap_or(value) + 0.0)
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn short_where_they_can_be() {
        for (value, text) in [
            (0.1273 * 1e3, "127.3"),
            (-0.0, "0.0"),
            (std::f64::consts::FRAC_PI_2.to_degrees(), "90.0"),
            (90.000000011753, "90.000000011753"),
            (4.2595e-8, "4.2595e-8"),
            (1.0 / 3.0, "0.3333333333333333"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    proptest::proptest! {
        #[test]
        fn within_four_roundings(value in proptest::num::f64::NORMAL) {
            let back: f64 = number(value).parse().unwrap();
            proptest::prop_assert!((back - value).abs() <= 4.0 * f64::EPSILON * value.abs());
        }
    }
}
