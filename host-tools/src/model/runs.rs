//! The order of measurement, and runs of a clock: where the times or numbers of rows begin anew,
//! so that rows of one run are measured after those of the run before, whatever their clocks say.

use super::{Measurements, Row};

impl Row {
    /// What orders it in its run: its time, or its number.
    #[must_use]
    pub fn clock(&self) -> Option<f64> {
        self.time.or(self.order)
    }
}

impl Measurements {
    /// What orders rows by when they were measured: the run of the clock, and in it the time,
    /// the number, or the place in the file.
    #[must_use]
    pub fn when(&self, row: usize) -> (u32, f64) {
        let of = &self.rows[row];
        (of.run, of.clock().unwrap_or(row as f64))
    }

    /// Rows in the order of measurement.
    #[must_use]
    pub fn in_order(&self) -> Vec<usize> {
        let mut out: Vec<usize> = (0..self.rows.len()).collect();
        out.sort_by(|a, b| {
            let ((run, x), (other, y)) = (self.when(*a), self.when(*b));
            run.cmp(&other).then(x.total_cmp(&y)).then(a.cmp(b))
        });
        out
    }

    /// The same with rows numbered as they stand in the file, where no column says when any was
    /// measured.
    #[must_use]
    pub fn numbered(&self) -> Option<Self> {
        if self.rows.iter().any(|row| row.clock().is_some()) {
            return None;
        }
        let mut out = Self { order_from_rows: true, ..self.clone() };
        // What is written twice was measured once.
        let mut numbers = vec![0_u32; self.rows.len()];
        let mut last = 0;
        for (row, first) in self.first_of_copies().into_iter().enumerate() {
            last += u32::from(first == row);
            numbers[row] = if first == row { last } else { numbers[first] };
        }
        out.rows.iter_mut().zip(numbers).for_each(|(row, n)| row.order = Some(f64::from(n)));
        Some(out)
    }

    /// The place of each row in the order of measurement.
    #[must_use]
    pub fn places(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.rows.len()];
        self.in_order().into_iter().enumerate().for_each(|(place, row)| out[row] = place as f64);
        out
    }

    /// The row that was measured just before each of these: none before the first
    /// of a run, a series or a station, and none where the numbers in `order` say that rows
    /// between them are missing.
    #[must_use]
    pub fn before(&self) -> Vec<Option<usize>> {
        let sorted = self.in_order();
        let step = |pair: &[usize]| Some(self.rows[pair[1]].order? - self.rows[pair[0]].order?);
        let steps = sorted.windows(2).filter_map(step).filter(|step| *step > 0.0);
        let usual = steps.fold(f64::INFINITY, f64::min);
        let mut out = vec![None; self.rows.len()];
        for pair in sorted.windows(2) {
            let (a, b) = (&self.rows[pair[0]], &self.rows[pair[1]]);
            let together = (a.run, &a.series, a.station) == (b.run, &b.series, b.station);
            let next = step(pair).is_none_or(|step| (0.0..=1.5 * usual).contains(&step));
            out[pair[1]] = (together && next).then_some(pair[0]);
        }
        out
    }

    /// The row at which the arm stood before it moved to where each of these was measured,
    /// as [`before`](Self::before): readings of a pose one after another are one stand.
    #[must_use]
    pub fn moved_from(&self) -> Vec<Option<usize>> {
        let before = self.before();
        let mut out = before.clone();
        for row in self.in_order() {
            if let Some(last) = before[row].filter(|b| self.rows[*b].pose == self.rows[row].pose) {
                out[row] = out[last];
            }
        }
        out
    }
}

/// Tells rows which run of the clock they are of. Those of files, of which each but the first
/// begins at one of these rows, and of series that stand in a file one after another, are of one
/// run where their clocks go past each other, and each of its own where they overlap.
pub fn number_runs(rows: &mut [Row], files: &[usize]) {
    let ends = files.iter().copied().chain([rows.len()]);
    let mut runs = Runs::default();
    let mut first = 0;
    for end in ends {
        let of_series = rows[first..end].chunk_by(|a, b| a.series == b.series);
        let mut series: Vec<_> = of_series.clone().map(|block| &block[0].series).collect();
        let blocks = series.len();
        series.sort_unstable();
        series.dedup();
        // Series in turns are measured in turns, on one clock.
        let lengths: Vec<usize> = match series.len() == blocks {
            true => of_series.map(<[Row]>::len).collect(),
            false => vec![end - first],
        };
        for length in lengths {
            runs.number(&mut rows[first..first + length]);
            first += length;
        }
    }
}

/// The runs so far, and of the last the first and last readings of the clock of its blocks;
/// none of rows without a clock.
#[derive(Default)]
struct Runs {
    count: u32,
    spans: Vec<Option<[f64; 2]>>,
}

impl Runs {
    /// Rows one after another that are of one run.
    fn number(&mut self, block: &mut [Row]) {
        let all: Option<Vec<f64>> = block.iter().map(Row::clock).collect();
        let span = all.map(|all| {
            let [least, most] = [f64::min, f64::max].map(|of| all.iter().copied().reduce(of));
            [least.unwrap_or_default(), most.unwrap_or_default()]
        });
        let goes_on = self.spans.iter().all(|other| match (span, other) {
            (Some(own), Some(other)) => own[0] >= other[1] || own[1] <= other[0],
            (None, None) => true,
            _ => false,
        });
        if !goes_on || self.count == 0 {
            self.count += 1;
            self.spans.clear();
        }
        self.spans.push(span);
        block.iter_mut().for_each(|row| row.run = self.count - 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs of rows of these series and times, of files that begin at these rows.
    fn runs(of: &[(&str, Option<f64>)], files: &[usize]) -> Vec<u32> {
        let row = |(series, time): &(&str, Option<f64>)| Row {
            series: Some((*series).to_owned()).filter(|s| !s.is_empty()),
            time: *time,
            ..Row::at(vec![0.0])
        };
        let mut rows: Vec<Row> = of.iter().map(row).collect();
        number_runs(&mut rows, files);
        rows.iter().map(|row| row.run).collect()
    }

    fn at(series: &str, time: f64) -> (&str, Option<f64>) {
        (series, Some(time))
    }

    #[test]
    fn a_clock_that_begins_anew_begins_a_run() {
        let days = [at("", 0.0), at("", 9.0), at("", 0.0), at("", 8.0)];
        assert_eq!(runs(&days, &[2]), [0, 0, 1, 1]);
        let series = [at("a", 0.0), at("a", 9.0), at("b", 1.0), at("b", 8.0)];
        assert_eq!(runs(&series, &[]), [0, 0, 1, 1]);
    }

    #[test]
    fn a_clock_that_goes_on_is_one() {
        let series = [at("a", 0.0), at("a", 9.0), at("b", 9.0), at("b", 12.0)];
        assert_eq!(runs(&series, &[]), [0; 4]);
        assert_eq!(runs(&series, &[2]), [0; 4]);
        // The afternoon stands before the morning.
        let sorted = [at("b", 9.0), at("b", 12.0), at("a", 0.0), at("a", 9.0)];
        assert_eq!(runs(&sorted, &[]), [0; 4]);
        let in_turns = [at("a", 0.0), at("b", 1.0), at("a", 2.0), at("b", 3.0)];
        assert_eq!(runs(&in_turns, &[]), [0; 4]);
    }

    /// A table that is sorted otherwise has one clock.
    #[test]
    fn rows_without_a_clock_are_in_the_order_of_the_files() {
        assert_eq!(runs(&[("", None), ("", None), ("", None)], &[1, 2]), [0; 3]);
        assert_eq!(runs(&[at("", 3.0), at("", 1.0), ("", None)], &[2]), [0, 0, 1]);
        assert_eq!(runs(&[], &[]), [0; 0]);
    }
}
