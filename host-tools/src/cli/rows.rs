//! Measured rows as verbs take and give them.

use truearm_host::files::csv_text;
use truearm_host::identify::RowResult;
use truearm_host::model::{Measurements, Row};
use truearm_host::observations::Residual;

/// What [`residuals`] begin with: of one file, and of several.
pub const RESIDUALS: [&str; 2] = ["row,line,", "row,file,line,"];

/// One line a data row: residuals in mm with nominal geometry, identified, and
/// held out.
pub fn residuals(data: &Measurements, rows: &[RowResult]) -> String {
    // Of every kind that the file has, its components with their unit.
    let named = |r: &Residual| {
        let names = r.components().iter().enumerate();
        names.map(|(c, name)| format!("{name}_{}", r.measure(c).unit())).collect::<Vec<String>>()
    };
    let mut names: Vec<String> = Vec::new();
    for name in rows.iter().flat_map(|r| named(&r.identified)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut header: Vec<String> =
        ["row", "line", "station", "marker", "flagged"].map(str::to_owned).to_vec();
    let several = !data.behind.is_empty();
    if several {
        header.insert(1, "file".to_owned());
    }
    for of in ["nominal_", "", "held_out_"] {
        header.extend(names.iter().map(|name| format!("{of}d{name}")));
    }
    let line = |(i, (row, result)): (usize, (&Row, &RowResult))| {
        let (station, marker) = (&data.stations[row.station], &data.markers[row.marker]);
        let mut cells = vec![(i + 1).to_string(), row.line.to_string()];
        if several {
            cells.insert(1, data.file_of(i).display().to_string());
        }
        cells.extend([station.clone(), marker.clone(), u8::from(result.flagged).to_string()]);
        let own = named(&result.identified);
        let places = names.iter().map(|name| own.iter().position(|c| c == name));
        for v in [Some(result.nominal), Some(result.identified), result.held_out] {
            let values = v.map(|v| v.in_files()).unwrap_or_default();
            let told = |place: Option<usize>| Some(format!("{:.5}", values.get(place?)?));
            cells.extend(places.clone().map(|place| told(place).unwrap_or_default()));
        }
        cells
    };
    csv_text(header.iter().map(String::as_str), data.rows.iter().zip(rows).enumerate().map(line))
}
