use crate::blob::arm_terms;
use crate::model::{Model, Path};

/// What a model would use of a path's state and is not told; a remark each.
#[must_use]
pub fn missing_inputs(model: &Model, path: &Path) -> Vec<String> {
    let (file, rows) = (path.data.path.display(), &path.data.rows);
    let terms: Vec<_> = arm_terms(model).collect();
    let mut out = Vec::new();
    let missing = rows.iter().filter(|row| row.directions.iter().all(|d| *d == 0)).count();
    if missing > 0 && terms.iter().any(|t| t.effect.needs_approach()) {
        out.push(format!(
            "{file}: {missing} rows do not say in dir1.. from which side joints come to rest: the \
             middle of the play is taken"
        ));
    }
    let missing = rows.iter().filter(|row| row.temperature.is_none()).count();
    if missing > 0 && terms.iter().any(|t| t.effect.needs_warmth()) {
        out.push(format!(
            "{file}: {missing} rows without temperature_c: {} degrees is taken",
            model.robot.reference_temperature
        ));
    }
    let late = model.terms.iter().any(|t| t.time_constant().is_some());
    let back = rows.windows(2).find(|two| {
        matches!((two[0].time, two[1].time), (Some(before), Some(now)) if now < before)
            && two[0].series == two[1].series
    });
    if let Some(two) = back.filter(|_| late) {
        out.push(format!(
            "{file}: time_s goes back at line {}: the temperature goes on in the order of the times, \
             not of the rows; count on over midnight, or begin another series",
            two[1].line
        ));
    }
    out
}
