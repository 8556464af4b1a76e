//! Arms of the kinds that are in factories, as a `robot.toml` describes them.
//! The sigma of the measurement and the direction of gravity are a set's own.

/// All of them.
pub const ALL: [&str; 6] = [UR10, PUMA, ELBOW, OFFSET_WRIST, SEVEN_JOINTS, RAIL];

const UR10: &str = r#"
name = "three parallel axes, 1.3 m"
tool.xyz_mm = [60.0, -25.0, 110.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 127.3, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 101 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 121 },
  { alpha_deg = 0, a_mm = -612, d_mm = 0, theta_offset_deg = 0, limits_deg = [-155, 155], gear_ratio = 101 },
  { alpha_deg = 0, a_mm = -572.3, d_mm = 163.941, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 81 },
  { alpha_deg = 90, a_mm = 0, d_mm = 115.7, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 81 },
  { alpha_deg = -90, a_mm = 0, d_mm = 92.2, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 51 },
]
links = [
  { mass_kg = 7.8, com_mm = [21, 0, -27] },
  { mass_kg = 12.9, com_mm = [-380, 0, 158] },
  { mass_kg = 3.9, com_mm = [-240, 0, 68] },
  { mass_kg = 2.0, com_mm = [0, 7, 18] },
  { mass_kg = 2.0, com_mm = [0, -7, 18] },
  { mass_kg = 0.4, com_mm = [0, 0, -26] },
]
"#;

const PUMA: &str = r#"
name = "spherical wrist, 0.9 m"
tool.xyz_mm = [55.0, 30.0, 95.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 672, theta_offset_deg = 0, limits_deg = [-160, 160], gear_ratio = 62.6 },
  { alpha_deg = -90, a_mm = 0, d_mm = 243.5, theta_offset_deg = 0, limits_deg = [-215, 35], gear_ratio = 107.8 },
  { alpha_deg = 0, a_mm = 431.8, d_mm = -93.4, theta_offset_deg = 0, limits_deg = [-45, 225], gear_ratio = 53.7 },
  { alpha_deg = 90, a_mm = -20.3, d_mm = 433.1, theta_offset_deg = 0, limits_deg = [-110, 170], gear_ratio = 76.0 },
  { alpha_deg = -90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-100, 100], gear_ratio = 71.9 },
  { alpha_deg = 90, a_mm = 0, d_mm = 56, theta_offset_deg = 0, limits_deg = [-170, 170], gear_ratio = 76.7 },
]
links = [
  { mass_kg = 13.0, com_mm = [0, 12, -60] },
  { mass_kg = 17.4, com_mm = [68, 6, -16] },
  { mass_kg = 4.8, com_mm = [10, -70, 14] },
  { mass_kg = 0.8, com_mm = [0, 0, -19] },
  { mass_kg = 0.4, com_mm = [0, 0, 0] },
  { mass_kg = 0.1, com_mm = [0, 0, 32] },
]
"#;

const ELBOW: &str = r#"
name = "elbow arm, 0.8 m"
tool.xyz_mm = [45.0, -30.0, 120.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 352, theta_offset_deg = 0, limits_deg = [-170, 170], gear_ratio = 121 },
  { alpha_deg = -90, a_mm = 70, d_mm = 0, theta_offset_deg = -90, limits_deg = [-85, 105], gear_ratio = 141 },
  { alpha_deg = 0, a_mm = 360, d_mm = 0, theta_offset_deg = 0, limits_deg = [-200, 45], gear_ratio = 101 },
  { alpha_deg = -90, a_mm = 0, d_mm = 380, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 81 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-110, 110], gear_ratio = 81 },
  { alpha_deg = -90, a_mm = 0, d_mm = 65, theta_offset_deg = 180, limits_deg = [-175, 175], gear_ratio = 51 },
]
links = [
  { mass_kg = 27.0, com_mm = [35, 5, -80] },
  { mass_kg = 22.0, com_mm = [160, 0, 45] },
  { mass_kg = 19.0, com_mm = [15, 40, 10] },
  { mass_kg = 6.5, com_mm = [0, 5, -110] },
  { mass_kg = 2.2, com_mm = [0, -10, 0] },
  { mass_kg = 0.4, com_mm = [0, 0, -12] },
]
"#;

const OFFSET_WRIST: &str = r#"
name = "offset wrist, 1.1 m"
tool.xyz_mm = [70.0, 20.0, 100.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 400, theta_offset_deg = 0, limits_deg = [-168, 168], gear_ratio = 120 },
  { alpha_deg = -90, a_mm = 25, d_mm = 0, theta_offset_deg = 0, limits_deg = [-185, 30], gear_ratio = 160 },
  { alpha_deg = 0, a_mm = 560, d_mm = 0, theta_offset_deg = -90, limits_deg = [-115, 150], gear_ratio = 120 },
  { alpha_deg = -90, a_mm = 35, d_mm = 515, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 100 },
  { alpha_deg = 90, a_mm = 0, d_mm = 75, theta_offset_deg = 0, limits_deg = [-120, 120], gear_ratio = 100 },
  { alpha_deg = -90, a_mm = 40, d_mm = 90, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 50 },
]
links = [
  { mass_kg = 16.0, com_mm = [12, 3, -70] },
  { mass_kg = 14.0, com_mm = [250, -10, 60] },
  { mass_kg = 8.0, com_mm = [20, 60, -15] },
  { mass_kg = 5.0, com_mm = [0, 8, -150] },
  { mass_kg = 2.0, com_mm = [5, 10, 25] },
  { mass_kg = 0.5, com_mm = [0, 0, -20] },
]
"#;

const SEVEN_JOINTS: &str = r#"
name = "seven joints, 0.9 m"
tool.xyz_mm = [65.0, 25.0, 90.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 340, theta_offset_deg = 0, limits_deg = [-165, 165], gear_ratio = 160 },
  { alpha_deg = -90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-115, 115], gear_ratio = 160 },
  { alpha_deg = 90, a_mm = 0, d_mm = 400, theta_offset_deg = 0, limits_deg = [-165, 165], gear_ratio = 160 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-115, 115], gear_ratio = 160 },
  { alpha_deg = -90, a_mm = 0, d_mm = 400, theta_offset_deg = 0, limits_deg = [-165, 165], gear_ratio = 100 },
  { alpha_deg = -90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-115, 115], gear_ratio = 160 },
  { alpha_deg = 90, a_mm = 0, d_mm = 126, theta_offset_deg = 0, limits_deg = [-170, 170], gear_ratio = 160 },
]
links = [
  { mass_kg = 4.5, com_mm = [0, -30, -40] },
  { mass_kg = 4.2, com_mm = [0, -60, 40] },
  { mass_kg = 3.2, com_mm = [0, 30, -130] },
  { mass_kg = 2.8, com_mm = [0, 67, 34] },
  { mass_kg = 1.8, com_mm = [0, 21, -140] },
  { mass_kg = 1.9, com_mm = [0, 1, 2] },
  { mass_kg = 0.4, com_mm = [0, 0, -20] },
]
"#;

const RAIL: &str = r#"
name = "elbow arm on a rail"
tool.xyz_mm = [50.0, 30.0, 120.0]
joints = [
  { kind = "prismatic", alpha_deg = 90, a_mm = 0, d_offset_mm = 100, theta_offset_deg = 0, limits_mm = [0, 1500], gear_ratio = 60 },
  { alpha_deg = -90, a_mm = 50, d_mm = 400, theta_offset_deg = 0, limits_deg = [-165, 165], gear_ratio = 110 },
  { alpha_deg = -90, a_mm = 100, d_mm = 0, theta_offset_deg = 0, limits_deg = [-160, 10], gear_ratio = 130 },
  { alpha_deg = 0, a_mm = 450, d_mm = 0, theta_offset_deg = 0, limits_deg = [-170, 60], gear_ratio = 105 },
  { alpha_deg = -90, a_mm = 60, d_mm = 420, theta_offset_deg = 0, limits_deg = [-170, 170], gear_ratio = 85 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-115, 115], gear_ratio = 82 },
  { alpha_deg = -90, a_mm = 0, d_mm = 80, theta_offset_deg = 0, limits_deg = [-175, 175], gear_ratio = 54 },
]
links = [
  { mass_kg = 60.0, com_mm = [0, 0, 0] },
  { mass_kg = 20.0, com_mm = [40, 8, -90] },
  { mass_kg = 15.0, com_mm = [200, 0, 50] },
  { mass_kg = 11.0, com_mm = [25, 35, -5] },
  { mass_kg = 4.5, com_mm = [0, 4, -120] },
  { mass_kg = 1.8, com_mm = [0, -8, 0] },
  { mass_kg = 0.3, com_mm = [0, 0, -15] },
]
"#;

/// A UR10-like arm, tool off the last axis: 27 of 39 parameters identifiable.
pub const UR10_LIKE: &str = r#"
name = "simulated 6R"
measurement_sigma_mm = 0.02
tool.xyz_mm = [60.0, -25.0, 110.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 127.3, theta_offset_deg = 0 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = 0, a_mm = -612, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = 0, a_mm = -572.3, d_mm = 163.941, theta_offset_deg = 0 },
  { alpha_deg = 90, a_mm = 0, d_mm = 115.7, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 0, d_mm = 92.2, theta_offset_deg = 0 },
]
"#;

/// A 6R arm on a linear axis.
pub const ON_RAIL: &str = r#"
name = "simulated 6R on a rail"
measurement_sigma_mm = 0.02
tool.xyz_mm = [40.0, 30.0, 120.0]
joints = [
  { kind = "prismatic", alpha_deg = 90, a_mm = 0, d_offset_mm = 100, theta_offset_deg = 0, limits_mm = [0, 1500] },
  { alpha_deg = -90, a_mm = 50, d_mm = 400, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 100, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = 0, a_mm = 450, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 60, d_mm = 420, theta_offset_deg = 0 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 0, d_mm = 80, theta_offset_deg = 0 },
]
"#;
