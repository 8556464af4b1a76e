//! The temperature that an arm has, where it follows the one that was read late.
//!
//! It depends on all readings of a session up to a row, so that a row knows its session,
//! whichever rows are looked at.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, PoisonError, RwLock};

use truearm::ThermalLag;

use super::Row;

/// Where in a session of readings a row is.
#[derive(Debug, Clone)]
pub struct Warming {
    session: Arc<Session>,
    at: usize,
}

/// The readings of a session in the order of time.
#[derive(Debug)]
struct Session {
    /// s and degrees Celsius.
    readings: Vec<[f64; 2]>,
    /// By how much the arm is ahead of each, K, by the bits of the time constant: found
    /// once for all rows, in one pass.
    ahead: RwLock<BTreeMap<u64, Arc<[f64]>>>,
}

impl Session {
    fn ahead(&self, time_constant: f64) -> Arc<[f64]> {
        let key = time_constant.to_bits();
        let known = self.ahead.read().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        known.unwrap_or_else(|| {
            let mut lag = ThermalLag::new(time_constant);
            let mut before = f64::NAN;
            let step = |[time, reading]: &[f64; 2]| {
                let arm = lag.step(time - before, *reading);
                before = *time;
                arm - reading
            };
            let found: Arc<[f64]> = self.readings.iter().map(step).collect();
            let mut all = self.ahead.write().unwrap_or_else(PoisonError::into_inner);
            all.entry(key).or_insert(found).clone()
        })
    }
}

impl Warming {
    /// By how much an arm of this time constant, s, is warmer than what was read at the
    /// row, K. At the first reading of a session it is as warm as that says.
    #[must_use]
    pub fn ahead(&self, time_constant: f64) -> f64 {
        self.session.ahead(time_constant)[self.at]
    }

    /// Whether both are readings of one session.
    #[must_use]
    pub fn goes_on(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.session, &other.session)
    }

    /// From the first reading of the session to this one, s.
    #[must_use]
    pub fn passed(&self) -> f64 {
        self.session.readings[self.at][0] - self.session.readings[0][0]
    }

    /// From the reading before to this one, s; none at the first.
    #[must_use]
    pub fn step(&self) -> Option<f64> {
        let before = self.session.readings[self.at.checked_sub(1)?][0];
        Some(self.session.readings[self.at][0] - before)
    }
}

impl Row {
    /// Degrees Celsius of an arm that follows the temperature with this time constant, s,
    /// which is what was read where it is 0 or the row is in no session.
    #[must_use]
    pub fn temperature_of_arm(&self, time_constant: f64) -> Option<f64> {
        let ahead = match &self.warming {
            Some(warming) if time_constant > 0.0 => warming.ahead(time_constant),
            _ => 0.0,
        };
        self.temperature.map(|read| read + ahead)
    }
}

/// The same place among the same readings.
impl PartialEq for Warming {
    fn eq(&self, other: &Self) -> bool {
        self.at == other.at
            && (Arc::ptr_eq(&self.session, &other.session)
                || self.session.readings == other.session.readings)
    }
}

/// Tells the rows of a file, those with a time and a temperature, where in a session they are.
///
/// A series whose clock goes back at its first row begins a session of its own: nothing is
/// known of the arm before it. A series that goes on with the clock goes on with the session,
/// for what was re-seated is the target and not the arm. Rows are taken in the order of their
/// times, whatever that of the file.
pub fn find_sessions(rows: &mut [Row]) {
    let mut own: HashMap<Option<String>, usize> = HashMap::new();
    let mut sessions: Vec<Vec<usize>> = Vec::new();
    let mut last: Option<(f64, usize)> = None;
    for (index, row) in rows.iter().enumerate() {
        let (Some(time), Some(_)) = (row.time, row.temperature) else { continue };
        let session = *own.entry(row.series.clone()).or_insert_with(|| match last {
            Some((before, session)) if time >= before => session,
            _ => {
                sessions.push(Vec::new());
                sessions.len() - 1
            }
        });
        sessions[session].push(index);
        last = Some((time, session));
    }
    for mut session in sessions {
        let time = |row: usize| rows[row].time.unwrap_or_default();
        session.sort_by(|a, b| time(*a).total_cmp(&time(*b)).then(a.cmp(b)));
        let read = |row: &usize| [time(*row), rows[*row].temperature.unwrap_or_default()];
        let readings = session.iter().map(read).collect();
        let whole = Arc::new(Session { readings, ahead: RwLock::default() });
        for (at, row) in session.into_iter().enumerate() {
            rows[row].warming = Some(Warming { session: Arc::clone(&whole), at });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of these series, times and temperatures.
    fn rows(of: &[(&str, f64, f64)]) -> Vec<Row> {
        let row = |(series, time, temperature): &(&str, f64, f64)| Row {
            series: Some((*series).to_owned()).filter(|s| !s.is_empty()),
            time: Some(*time),
            temperature: Some(*temperature),
            ..Row::at(vec![0.0])
        };
        let mut rows: Vec<Row> = of.iter().map(row).collect();
        find_sessions(&mut rows);
        rows
    }

    fn arm(row: &Row, tau: f64) -> f64 {
        row.temperature.unwrap() + row.warming.as_ref().unwrap().ahead(tau)
    }

    /// After a reading of 20 degrees a long time at 30, by way of a step of one second.
    #[test]
    fn rows_in_any_order_follow_their_times() {
        let sorted = rows(&[("", 0.0, 20.0), ("", 1.0, 30.0), ("", 601.0, 30.0)]);
        let mixed = rows(&[("", 601.0, 30.0), ("", 0.0, 20.0), ("", 1.0, 30.0)]);
        for tau in [60.0_f64, 600.0, 6000.0] {
            let expected = 30.0 - 10.0 * (-600.0 / tau).exp();
            assert!((arm(&sorted[2], tau) - expected).abs() < 10.0 / tau, "{tau}");
            assert_eq!(arm(&sorted[2], tau), arm(&mixed[0], tau));
            assert_eq!(arm(&mixed[1], tau), 20.0);
        }
    }

    #[test]
    fn a_series_begins_anew_where_its_clock_does() {
        let one_clock = rows(&[("a", 0.0, 20.0), ("a", 300.0, 30.0), ("b", 400.0, 30.0)]);
        assert!(arm(&one_clock[2], 600.0) < 29.0);
        let two_clocks = rows(&[("a", 0.0, 20.0), ("a", 300.0, 30.0), ("b", 0.0, 30.0)]);
        assert_eq!(arm(&two_clocks[2], 600.0), 30.0);
        // By turns on one clock.
        let by_turns =
            rows(&[("a", 0.0, 20.0), ("b", 300.0, 30.0), ("a", 400.0, 30.0), ("b", 500.0, 30.0)]);
        let alone =
            rows(&[("", 0.0, 20.0), ("", 300.0, 30.0), ("", 400.0, 30.0), ("", 500.0, 30.0)]);
        assert_eq!(arm(&by_turns[3], 600.0), arm(&alone[3], 600.0));
    }

    #[test]
    fn a_row_without_time_or_temperature_is_in_no_session() {
        let mut rows = rows(&[("", 0.0, 20.0), ("", 300.0, 30.0)]);
        rows[1].time = None;
        rows[1].warming = None;
        find_sessions(&mut rows);
        assert!(rows[0].warming.is_some() && rows[1].warming.is_none());
        assert_eq!(rows[0].warming.as_ref().unwrap().passed(), 0.0);
    }
}
