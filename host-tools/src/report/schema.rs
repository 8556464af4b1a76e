//! The JSON schemas of all reports.

use schemars::JsonSchema;

use super::{
    CheckReport, CompareReport, CompensateReport, DiagnoseReport, DiffReport, EvaluateReport,
    ExportReport, FkReport, FleetReport, GramReport, IdentifyReport, IkReport, ImportReport,
    InspectReport, PackReport, PlanReport, SeparationReport, UnpackReport, VerifyReport,
};

/// Name and text of every schema, as they stand in `docs/schemas`.
#[must_use]
pub fn all() -> Vec<(&'static str, String)> {
    vec![
        (IdentifyReport::SCHEMA, of::<IdentifyReport>()),
        (DiagnoseReport::SCHEMA, of::<DiagnoseReport>()),
        (EvaluateReport::SCHEMA, of::<EvaluateReport>()),
        (ExportReport::SCHEMA, of::<ExportReport>()),
        (FleetReport::SCHEMA, of::<FleetReport>()),
        (GramReport::SCHEMA, of::<GramReport>()),
        (CheckReport::SCHEMA, of::<CheckReport>()),
        (CompareReport::SCHEMA, of::<CompareReport>()),
        (ImportReport::SCHEMA, of::<ImportReport>()),
        (PlanReport::SCHEMA, of::<PlanReport>()),
        (SeparationReport::SCHEMA, of::<SeparationReport>()),
        (VerifyReport::SCHEMA, of::<VerifyReport>()),
        (FkReport::SCHEMA, of::<FkReport>()),
        (IkReport::SCHEMA, of::<IkReport>()),
        (CompensateReport::SCHEMA, of::<CompensateReport>()),
        (PackReport::SCHEMA, of::<PackReport>()),
        (InspectReport::SCHEMA, of::<InspectReport>()),
        (DiffReport::SCHEMA, of::<DiffReport>()),
        (UnpackReport::SCHEMA, of::<UnpackReport>()),
    ]
}

/// As the report is written, so that what is always there is required.
fn of<R: JsonSchema>() -> String {
    let settings = schemars::generate::SchemaSettings::draft2020_12().for_serialize();
    super::to_json(&settings.into_generator().into_root_schema_for::<R>())
}
