use schemars::JsonSchema;
use serde::Serialize;

use crate::error::Result;
use crate::verify::{COVERAGE_FACTOR, Conformity, KindVerified, Tolerances, Verification};

/// What `verify --json` prints, and its `report.json`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct VerifyReport {
    /// The schema.
    #[schemars(extend("const" = VerifyReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "verify"))]
    pub command: &'static str,
    /// The model that was packed and flashed.
    pub model: String,
    /// Measured with the compensation off.
    pub before: Option<Verification>,
    /// Measured with the compensation on.
    pub after: Verification,
    /// Of the expanded uncertainty.
    pub coverage_factor: f64,
    /// Largest error allowed of what measured points or lengths, mm.
    pub tolerance_mm: Option<f64>,
    /// The same of turns and inclinations, degrees.
    pub tolerance_deg: Option<f64>,
    /// How conformity was decided.
    pub decision_rule: &'static str,
    /// What the tolerances say of the errors: the worst that they say of a kind.
    pub conformity: Option<Conformity>,
    /// What they say of each kind that has one, in the order of `after.kinds`.
    pub judged: Vec<Judged>,
    /// Remarks.
    pub warnings: Vec<String>,
}

/// What a tolerance says of a kind.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Judged {
    /// Its name, as in the column `kind`.
    pub kind: &'static str,
    /// Of the tolerance.
    pub unit: &'static str,
    /// Largest error allowed.
    pub tolerance: f64,
    /// What it says.
    pub conformity: Conformity,
}

impl VerifyReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-verify-1";

    /// Of a model file and its verified measurements, judged by tolerances.
    ///
    /// # Errors
    /// As for [`Tolerances::tell`].
    pub fn new(
        model: String,
        before: Option<Verification>,
        after: Verification,
        tolerances: Tolerances,
        warnings: Vec<String>,
    ) -> Result<Self> {
        tolerances.tell(&after)?;
        let judge = |own: &KindVerified| {
            let tolerance = tolerances.of(own.unit)?;
            let conformity = own.conformity(tolerance);
            Some(Judged { kind: own.kind, unit: own.unit, tolerance, conformity })
        };
        let judged: Vec<Judged> = after.kinds.iter().filter_map(judge).collect();
        Ok(Self {
            schema: Self::SCHEMA,
            command: "verify",
            model,
            coverage_factor: COVERAGE_FACTOR,
            tolerance_mm: tolerances.mm,
            tolerance_deg: tolerances.deg,
            decision_rule: "ISO 14253-1, conformity to be proven, guard band U (k = 2); a fail needs that of the \
                            largest of all rows",
            conformity: judged.iter().map(|j| j.conformity).max(),
            judged,
            before,
            after,
            warnings,
        })
    }
}
