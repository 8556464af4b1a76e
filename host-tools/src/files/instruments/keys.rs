//! The keys of an instruments.toml, in file units.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::files::numbers::Numbers;

type Triple = Spanned<Numbers<3>>;

#[derive(Deserialize)]
pub(super) struct InstrumentsFile {
    #[serde(default)]
    pub anchors: Vec<Spanned<AnchorFile>>,
    #[serde(default)]
    pub surfaces: Vec<Spanned<SurfaceFile>>,
    #[serde(default)]
    pub probes: Vec<Spanned<ProbeFile>>,
    #[serde(default)]
    pub plates: Vec<Spanned<PlateFile>>,
    #[serde(default)]
    pub cameras: Vec<Spanned<CameraFile>>,
    #[serde(default)]
    pub rays: Vec<Spanned<RayFile>>,
    #[serde(default)]
    pub markers: Vec<Spanned<MarkerFile>>,
    /// Which way is up in the frame of the station.
    pub up: Option<Triple>,
}

#[derive(Deserialize)]
pub(super) struct AnchorFile {
    pub label: String,
    pub xyz_mm: Option<Triple>,
    #[serde(default)]
    pub guess: bool,
    /// Shortest and longest length that is measured from it.
    pub reach_mm: Option<Spanned<Numbers<2>>>,
    /// What the instrument adds to every length.
    pub zero_mm: Option<Spanned<f64>>,
    /// Whether that is "known" or "free".
    pub zero: Option<Spanned<String>>,
}

#[derive(Deserialize)]
pub(super) struct SurfaceFile {
    pub label: String,
    pub shape: Option<Spanned<String>>,
    pub point_mm: Option<Triple>,
    /// Out of a plane, along a cylinder.
    pub normal: Option<Triple>,
    pub radius_mm: Option<Spanned<f64>>,
    #[serde(default)]
    pub guess: bool,
}

#[derive(Deserialize)]
pub(super) struct ProbeFile {
    #[serde(default)]
    pub marker: String,
    pub radius_mm: Spanned<f64>,
    #[serde(default)]
    pub guess: bool,
}

#[derive(Deserialize)]
pub(super) struct PlateFile {
    pub label: String,
    pub mounted: Option<Spanned<String>>,
    pub xyz_mm: Option<Triple>,
    pub rpy_deg: Option<Triple>,
    #[serde(default)]
    pub guess: bool,
    /// Coordinates in the frame of the plate by label, mm.
    pub holes: BTreeMap<String, Triple>,
}

#[derive(Deserialize)]
pub(super) struct CameraFile {
    pub label: String,
    pub mounted: Option<Spanned<String>>,
    pub xyz_mm: Option<Triple>,
    pub rpy_deg: Option<Triple>,
    #[serde(default)]
    pub guess: bool,
    pub focal_px: Spanned<Numbers<2>>,
    pub centre_px: Spanned<Numbers<2>>,
    /// Width and height of the image.
    pub image_px: Option<Spanned<Numbers<2>>>,
    /// k1, k2, p1, p2, k3
    pub distortion: Option<Spanned<Numbers<5>>>,
    pub intrinsics: Option<Spanned<String>>,
}

#[derive(Deserialize)]
pub(super) struct RayFile {
    #[serde(default)]
    pub marker: String,
    pub origin_mm: Triple,
    pub direction: Triple,
    #[serde(default)]
    pub guess: bool,
    /// Shortest and longest range that is measured along it.
    pub reach_mm: Option<Spanned<Numbers<2>>>,
}

#[derive(Deserialize)]
pub(super) struct MarkerFile {
    #[serde(default)]
    pub marker: String,
    pub xyz_mm: Option<Triple>,
    pub rpy_deg: Option<Triple>,
    #[serde(default)]
    pub guess: bool,
}
