//! What the paper prints.

/// A column of Table 9, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printed {
    /// Method.
    pub name: &'static str,
    /// Largest position error.
    pub max_mm: f64,
    /// Mean position error.
    pub mean_mm: f64,
    /// Standard deviation.
    pub sd_mm: f64,
    /// Table 10: reduction of the mean, percent.
    pub mae_reduction: Option<f64>,
    /// Table 10: reduction of the standard deviation, percent.
    pub sd_reduction: Option<f64>,
}

const fn column(name: &'static str, nine: [f64; 3], ten: Option<[f64; 2]>) -> Printed {
    let [max_mm, mean_mm, sd_mm] = nine;
    let (mae_reduction, sd_reduction) = match ten {
        Some([mae, sd]) => (Some(mae), Some(sd)),
        None => (None, None),
    };
    Printed { name, max_mm, mean_mm, sd_mm, mae_reduction, sd_reduction }
}

/// No calibration.
pub const NC: Printed = column("NC", [5.168, 2.533, 0.778], None);
/// Least squares.
pub const LSM: Printed = column("LSM", [1.694, 1.445, 0.039], Some([42.942, 94.987]));
/// The paper's method.
pub const RPIM: Printed = column("RPIM", [0.583, 0.472, 0.026], Some([81.331, 95.704]));
/// Gradient descent.
pub const GD: Printed = column("GD", [2.024, 1.353, 0.234], Some([46.591, 69.922]));
/// Gauss-Newton.
pub const GN: Printed = column("GN", [1.204, 0.956, 0.111], Some([62.261, 85.730]));
/// Tables 9 and 10 in the order of the claim: NC > LSM > GD > GN > RPIM.
pub const TABLE: [Printed; 5] = [NC, LSM, GD, GN, RPIM];

/// Means of Fig. 11 (52 points) and Fig. 14 (18 points), mm, from the text.
pub const MEANS: [(&str, Option<f64>, f64); 5] = [
    ("NC", Some(2.307), 3.199),
    ("LSM", Some(1.449), 1.435),
    ("GD", None, 1.353),
    ("GN", None, 0.956),
    ("RPIM", Some(0.475), 0.468),
];

/// Corner and final lambda of section VI.
pub const LAMBDAS: [f64; 2] = [3.063e-11, 3.063e-14];
/// Eq. 24.
pub const CONDITION: f64 = 1.157e21;
/// Mean error by axis before calibration, mm, and its reduction in percent.
pub const AXES: [(&str, f64, f64); 3] =
    [("x", 0.671, 39.404), ("y", 1.244, 88.489), ("z", 2.815, 99.796)];
