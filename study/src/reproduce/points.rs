//! The report's tables of single points and parameters: 2 to 5, 7 and 8.

use std::fmt::Write;

use super::example::Example;
use super::markdown::{number, table};
use super::section_v::{NinePoses, corrections};
use super::study::SHOWN;

/// Tables 2 to 5.
pub fn section_v(nine: &NinePoses) -> String {
    let mut out = format!(
        "## Section V: Tables 2 to 5\n\nNine poses of cell (a), seed {SHOWN}: 27 equations for 30 \
         parameters, base and tool held at their registration for RPIM-P, fitted for RPIM.\n\n"
    );
    let degrees =
        |q: &[f64]| q.iter().map(|q| format!("{:.2}", q.to_degrees())).collect::<Vec<_>>();
    let mm = |p: &nalgebra::Vector3<f64>| {
        p.iter().map(|x| format!("{:.3}", x * 1e3)).collect::<Vec<_>>()
    };
    let data = nine.cell.nine.rows.iter().zip(&nine.reference).enumerate();
    let rows: Vec<Vec<String>> = data
        .map(|(i, (row, reference))| {
            let error = format!("{:.3}", (row.measured.point() - reference).norm() * 1e3);
            [
                vec![(i + 1).to_string()],
                degrees(&row.q),
                mm(reference),
                mm(&row.measured.point()),
                vec![error],
            ]
            .concat()
        })
        .collect();
    out += "Joint angles (degrees), reference and measured point in the tracker's frame (mm), error \
            (Tables 2, 3):\n\n";
    out += &table(
        &["", "t1", "t2", "t3", "t4", "t5", "t6", "x", "y", "z", "x'", "y'", "z'", "error"],
        &rows,
    );
    let before = &nine.methods[0].2;
    let rows: Vec<Vec<String>> = (0..before.len())
        .map(|i| {
            let errors = nine.methods.iter().map(|m| format!("{:.3}", m.2[i]));
            std::iter::once((i + 1).to_string()).chain(errors).collect()
        })
        .collect();
    let names: Vec<&str> =
        std::iter::once("pose").chain(nine.methods.iter().map(|m| m.0)).collect();
    out += "Error of the nine points before and after, mm (Table 5):\n\n";
    out += &table(&names, &rows);
    let exact: Vec<String> = nine
        .methods
        .iter()
        .map(|m| format!("{} {}", m.0, m.3.map_or("-".to_owned(), |s| number(s.mean_mm))))
        .collect();
    let _ = writeln!(
        out,
        "The nine points are the fitted ones: with as many parameters as equations their error says \
         nothing. MAE on 250 other, noise-free poses, mm: {}.\n",
        exact.join(", ")
    );
    out += "Identified geometric errors (Table 4), lengths in mm, angles in mrad:\n\n";
    let nominal = nine.cell.arm.robot.nominal();
    let truth = corrections(&nine.cell.arm.truth, &nominal);
    let found: Vec<_> = nine.methods[1..].iter().map(|m| corrections(&m.1, &nominal)).collect();
    out + &parameter_table(&["true", "RPIM-P", "RPIM"], &truth, &found)
}

fn parameter_table(
    names: &[&str],
    truth: &[(String, f64)],
    found: &[Vec<(String, f64)>],
) -> String {
    let rows: Vec<Vec<String>> = truth
        .iter()
        .enumerate()
        .map(|(k, (name, value))| {
            let values = found.iter().map(|f| number(f[k].1));
            [name.clone(), number(*value)].into_iter().chain(values).collect()
        })
        .collect();
    let head: Vec<&str> = std::iter::once("parameter").chain(names.iter().copied()).collect();
    table(&head, &rows)
}

/// Table 7.
pub fn parameters(example: &Example) -> String {
    let nominal = example.cell.arm.robot.nominal();
    let truth = corrections(&example.cell.arm.truth, &nominal);
    let of = |name: &str| {
        let found = example.held.methods.iter().find(|o| o.name == name);
        found.and_then(|o| o.state.as_ref()).map(|s| corrections(s, &nominal))
    };
    let named: Vec<(&str, Vec<(String, f64)>)> = ["LSM", "GN", "RPIM-P", "RPIM"]
        .into_iter()
        .filter_map(|name| Some((name, of(name)?)))
        .collect();
    let names: Vec<&str> = std::iter::once("true").chain(named.iter().map(|n| n.0)).collect();
    let found: Vec<_> = named.iter().map(|n| n.1.clone()).collect();
    format!(
        "## Table 7\n\nIdentified parameters of cell (b), seed {SHOWN}, base and tool held (RPIM: \
         fitted), lengths in mm, angles in mrad. Combinations of them move no point: no method can \
         find these, and columns may differ there and fit alike.\n\n{}",
        parameter_table(&names, &truth, &found)
    )
}

/// Table 8.
pub fn validation(example: &Example) -> String {
    let rows = &example.cell.validation.rows;
    let one = |i: usize| {
        let row = &rows[i];
        let joints = row.q.iter().map(|q| format!("{:.3}", q.to_degrees()));
        let point = row.measured.iter().map(|x| format!("{:.3}", x * 1e3));
        let error = |name: &str| {
            let of = example.held.methods.iter().find(|o| o.name == name);
            let r = of.and_then(|o| o.validation_residuals.get(i));
            r.map_or("-".to_owned(), |r| format!("{:.3}", r.norm() * 1e3))
        };
        let errors = ["NC", "RPIM-P", "RPIM"].map(error);
        std::iter::once((i + 1).to_string()).chain(joints).chain(point).chain(errors).collect()
    };
    let rows: Vec<Vec<String>> = (0..rows.len()).map(one).collect();
    format!(
        "## Table 8\n\nThe 18 validation poses of cell (b), seed {SHOWN}: joints (degrees), measured point \
         (mm, tracker), error (mm). The paper's own Table 8 is in `tests/data/seed-table-8` and a test.\n\n{}",
        table(
            &["", "t1", "t2", "t3", "t4", "t5", "t6", "x", "y", "z", "NC", "RPIM-P", "RPIM"],
            &rows,
        )
    )
}
