//! Columns of a table on the terminal, as wide as what stands in them.

/// Rows of cells under a head: the first column to the left, the others to the
/// right.
#[derive(Debug, Clone)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// With a head.
    #[must_use]
    pub fn new<const N: usize>(head: [&str; N]) -> Self {
        Self { rows: vec![head.map(str::to_owned).to_vec()] }
    }

    /// One more row; cells that are missing at its end stay blank.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Another row of a name and numbers with four decimals.
    pub fn numbers(&mut self, name: &str, numbers: impl IntoIterator<Item = f64>) {
        let cells = numbers.into_iter().map(|x| format!("{x:.4}"));
        self.row(std::iter::once(name.to_owned()).chain(cells));
    }
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for row in &self.rows {
            let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, width))| match k {
                0 => format!("{cell:width$}"),
                _ => format!("  {cell:>width$}"),
            });
            writeln!(f, "{}", cells.collect::<String>().trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_cells() {
        let mut table = Table::new(["error, mm", "mean", "RMS"]);
        table.numbers("nominal", [1.25, 12.5]);
        table.row(["none".to_owned()]);
        let text = "error, mm    mean      RMS\nnominal    1.2500  12.5000\nnone\n";
        assert_eq!(table.to_string(), text);
    }
}
