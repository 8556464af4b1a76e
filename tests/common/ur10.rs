//! A UR10 with the errors of a real one, for tests and for what is timed.

const H: f64 = core::f64::consts::FRAC_PI_2;

/// Link twist, link length, joint offset, link offset and beta of every link: rad, m.
pub const UR10: [[f64; 5]; 6] = [
    [0.0, 0.0, 0.001, 0.1273, 0.0],
    [H + 0.0007, 0.0004, -0.0012, 0.0, 0.0003],
    [0.0002, -0.612, 0.0004, 0.0003, -0.0008],
    [-0.0011, -0.5723, 0.002, 0.163_941, 0.0006],
    [H, 0.0001, 0.0, 0.1157, 0.0],
    [-H, 0.0, -0.0003, 0.0922, 0.0002],
];
