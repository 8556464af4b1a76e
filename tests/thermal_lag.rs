//! The temperature of an arm that follows its thermometer late, against the equation
//! itself, integrated in steps a thousand times as short.

use proptest::prelude::*;
use truearm::ThermalLag;

/// tau dw/dt = T - w by Heun's method from w = T at time 0, at these times.
fn integrated(tau: f64, temperature: impl Fn(f64) -> f64, times: &[f64]) -> Vec<f64> {
    let (mut t, mut w) = (0.0, temperature(0.0));
    let mut out = Vec::new();
    for end in times {
        let steps = ((end - t) / (tau * 1e-4)).ceil().max(1.0);
        let h = (end - t) / steps;
        for _ in 0..steps as usize {
            let slope = (temperature(t) - w) / tau;
            let ahead = (temperature(t + h) - (w + h * slope)) / tau;
            w += h * (slope + ahead) / 2.0;
            t += h;
        }
        out.push(w);
    }
    out
}

/// Irregular times up to five hours, with a pause of an hour.
fn times() -> Vec<f64> {
    let mut t = 0.0;
    let steps = (0..150).map(|k| if k == 80 { 3600.0 } else { 20.0 + f64::from(k * k * 7 % 160) });
    steps
        .map(|step| {
            t += step;
            t
        })
        .collect()
}

fn by_filter(tau: f64, temperature: impl Fn(f64) -> f64, times: &[f64]) -> Vec<f64> {
    let mut lag = ThermalLag::new(tau);
    let mut before = 0.0;
    assert_eq!(lag.step(0.0, temperature(0.0)), temperature(0.0));
    let step = |t: &f64| {
        let w = lag.step(t - before, temperature(*t));
        before = *t;
        w
    };
    times.iter().map(step).collect()
}

#[test]
fn a_temperature_that_rises_evenly_is_exact_whatever_the_steps() {
    for tau in [30.0, 1500.0, 20_000.0] {
        let rising = |t: f64| 20.0 + t / 600.0;
        let found = by_filter(tau, rising, &times());
        for (t, w) in times().iter().zip(found) {
            let exact = rising(*t) - tau / 600.0 * (1.0 - (-t / tau).exp());
            assert!((w - exact).abs() < 1e-9, "tau {tau} s at {t} s: {w}, not {exact}");
        }
    }
}

#[test]
fn a_session_that_warms_up_and_cools_down_is_followed() {
    for (tau, most) in [(120.0, 0.05), (1500.0, 0.02), (9000.0, 0.02)] {
        let day = |t: f64| 22.0 + 8.0 * (t / 3000.0).sin();
        // The pause is bridged by a straight line: a sine is none.
        let times: Vec<f64> = times().into_iter().take(80).collect();
        let (found, exact) = (by_filter(tau, day, &times), integrated(tau, day, &times));
        let worst = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("tau {tau} s: {worst:.1e} K");
        assert!(worst < most, "tau {tau} s: {worst} K");
    }
}

#[test]
fn ticks_of_a_millisecond_do_in_single_precision_what_seconds_do() {
    let step = |t: f32| if t < 60.0 { 20.0 } else { 30.0 };
    let (mut fast, mut slow) = (ThermalLag::<f32>::new(300.0), ThermalLag::<f64>::new(300.0));
    fast.step(0.0, 20.0);
    slow.step(0.0, 20.0);
    let mut worst = 0.0_f64;
    for second in 1..1200_u16 {
        let t = f32::from(second);
        let mut arm = 0.0;
        for _ in 0..1000 {
            arm = fast.step(0.001, step(t));
        }
        worst = worst.max((f64::from(arm) - slow.step(1.0, f64::from(step(t)))).abs());
    }
    println!("{worst:.1e} K");
    assert!(worst < 0.02, "{worst} K");
}

#[test]
fn what_is_no_reading_lets_time_pass() {
    let mut lag = ThermalLag::<f64>::new(100.0);
    assert!(lag.step(1.0, f64::NAN).is_nan());
    assert_eq!(lag.step(1.0, 20.0), 20.0);
    assert_eq!(lag.step(50.0, f64::NAN), 20.0);
    assert_eq!(lag.step(f64::NAN, f64::INFINITY), 20.0);
    assert_eq!(lag.step(-50.0, f64::NAN), 20.0);
    assert_eq!(lag.step(f64::INFINITY, f64::NAN), 20.0);
    // As if one straight line of 100 s had led here.
    let mut other = ThermalLag::new(100.0);
    other.step(0.0, 20.0);
    assert_eq!(lag.step(50.0, 30.0), other.step(100.0, 30.0));
}

#[test]
fn without_a_time_constant_the_arm_has_what_is_read() {
    for none in [0.0, -5.0, f32::NAN, f32::INFINITY] {
        let mut lag = ThermalLag::new(none);
        assert_eq!(lag.time_constant(), 0.0);
        for reading in [20.0, 31.5, -4.0] {
            assert_eq!(lag.step(0.0, reading), reading, "{none}");
        }
    }
}

/// A thermometer that is dead for a day is told, whatever is kept of it.
#[test]
fn how_long_ago_a_reading_counted_is_known() {
    for tau in [0.0_f32, 1500.0] {
        let mut lag = ThermalLag::new(tau);
        assert_eq!(lag.since(), None);
        lag.step(1.0, f32::NAN);
        assert_eq!(lag.since(), None);
        for _ in 0..100 {
            lag.step(1.0, 20.0);
            assert_eq!(lag.since(), Some(0.0));
        }
        for second in 1..=86_400_u32 {
            lag.step(1.0, f32::NAN);
            assert_eq!(lag.since(), Some(second as f32));
        }
        lag.step(1.0, 21.0);
        assert_eq!(lag.since(), Some(0.0));
        // In ticks of a millisecond, of which not every one makes a step.
        for _ in 0..10_000 {
            lag.step(1e-3, 21.0);
            assert!(lag.since().is_some_and(|since| since <= tau / 16_384.0));
        }
        for _ in 0..14_400_000 {
            lag.step(1e-3, f32::NAN);
        }
        assert!(lag.since().is_some_and(|since| since > 14_000.0), "{:?}", lag.since());
    }
}

proptest! {
    /// Whatever bits a thermometer and a clock have: nothing panics, and from the first
    /// reading on the arm has a temperature, which the first reading and those that are
    /// numbers have between them.
    #[test]
    fn no_bits_take_the_temperature_away(
        tau in any::<f32>(), steps in proptest::collection::vec(any::<(f32, f32)>(), 1..40),
    ) {
        let mut lag = ThermalLag::new(tau);
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for (dt, reading) in steps {
            let arm = lag.step(dt, reading);
            if reading.is_finite() {
                (low, high) = (low.min(reading), high.max(reading));
            }
            if low <= high {
                let rounding = 1e-5 * low.abs().max(high.abs());
                prop_assert!(arm.is_finite() && arm >= low - rounding && arm <= high + rounding,
                    "{arm} of {low} to {high}, tau {tau}");
            }
        }
    }
}
