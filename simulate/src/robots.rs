//! Arms of the kinds that are in factories, as a `robot.toml` describes them.
//! The sigma of the measurement and the direction of gravity are a set's own.

/// All of them.
pub const ALL: [&str; 6] = [UR10, PUMA, ELBOW, OFFSET_WRIST, SEVEN_JOINTS, RAIL];

const UR10: &str = include_str!("robots/three-parallel-axes.toml");
const PUMA: &str = include_str!("robots/spherical-wrist.toml");
const ELBOW: &str = include_str!("robots/elbow.toml");
const OFFSET_WRIST: &str = include_str!("robots/offset-wrist.toml");
const SEVEN_JOINTS: &str = include_str!("robots/seven-joints.toml");
const RAIL: &str = include_str!("robots/elbow-on-rail.toml");

/// A UR10-like arm, tool off the last axis: 27 of 39 parameters identifiable.
pub const UR10_LIKE: &str = include_str!("robots/ur10-like.toml");

/// A 6R arm on a linear axis.
pub const ON_RAIL: &str = include_str!("robots/six-joints-on-rail.toml");
