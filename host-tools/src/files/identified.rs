//! What tells a model.toml from a robot.toml.

/// Keys that a model.toml has beyond those of a robot.toml.
pub(super) const MODEL_KEYS: [&str; 16] = [
    "schema",
    "digest",
    "robot_id",
    "orientation_identified",
    "unidentifiable",
    "provenance",
    "gram",
    "frame",
    "corrections",
    "terms",
    "measurement_terms",
    "curves",
    "stations",
    "markers",
    "instruments",
    "covariance",
];

/// Whether a text is that of a model.toml: a list of corrections, whatever became of its schema.
pub(super) fn is_identified(text: &str) -> bool {
    let file: toml::Table = text.parse().unwrap_or_default();
    file.get("corrections")
        .and_then(toml::Value::as_array)
        .is_some_and(|all| !all.is_empty() && all.iter().all(toml::Value::is_table))
}
