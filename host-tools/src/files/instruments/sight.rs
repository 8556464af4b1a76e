//! Cameras, and what an instrument can measure at all.

use toml::Spanned;

use super::keys::CameraFile;
use super::read::{Reader, stated};
use crate::error::Result;
use crate::files::numbers::Numbers;
use crate::model::{Form, Instrument};
use crate::units::from_mm;

impl Reader<'_> {
    pub(super) fn camera(&self, file: &CameraFile) -> Result<Instrument> {
        let mut camera = Instrument::unknown(Form::Camera, &file.label);
        camera.on_flange = self.on_flange(file.mounted.as_ref(), true)?;
        if let Some(place) = self.place(file.xyz_mm.as_ref(), file.rpy_deg.as_ref())? {
            self.whole(&file.label, file.xyz_mm.as_ref(), file.rpy_deg.as_ref(), file.guess)?;
            camera = stated(camera, place, file.guess);
        }
        let [focal, centre] = [&file.focal_px, &file.centre_px];
        for key in [focal, centre] {
            self.finite(key.span(), &**key.get_ref())?;
        }
        if focal.get_ref().iter().any(|f| *f <= 0.0) {
            let help = "give the focal lengths in pixels, such as [1800.0, 1800.0]";
            return Err(self.source.at(focal.span(), "focal_px is not positive", help));
        }
        let pixels = focal.get_ref().iter().chain(centre.get_ref().iter()).map(|px| px * 1e-3);
        let distortion = file.distortion.as_ref().map_or([0.0; 5], |d| **d.get_ref());
        camera.numbers = pixels.chain(distortion).collect();
        let free = match file.intrinsics.as_ref().map(|i| (i, i.get_ref().as_str())) {
            None | Some((_, "known")) => false,
            Some((_, "free")) => true,
            Some((key, other)) => {
                let help = "write \"known\" or \"free\"";
                return Err(self.source.at(key.span(), format!("intrinsics = \"{other}\""), help));
            }
        };
        camera.free[6..].fill(free);
        Ok(camera)
    }

    /// Shortest and longest length, m.
    pub(super) fn reach(&self, file: Option<&Spanned<Numbers<2>>>) -> Result<Option<[f64; 2]>> {
        let Some(file) = file else { return Ok(None) };
        self.finite(file.span(), &**file.get_ref())?;
        let [least, most] = file.get_ref().map(from_mm);
        if !(0.0 <= least && least < most) {
            let help = "give the shortest length and the longest, such as [50.0, 1500.0]";
            let message = format!("reach_mm = {:?}", **file.get_ref());
            return Err(self.source.at(file.span(), message, help));
        }
        Ok(Some([least, most]))
    }

    /// Width and height, px: what is not stated lies evenly about the centre.
    pub(super) fn image(&self, file: &CameraFile) -> Result<[f64; 2]> {
        let Some(image) = &file.image_px else {
            return Ok(file.centre_px.get_ref().map(|half| 2.0 * half));
        };
        if image.get_ref().iter().any(|px| !(px.is_finite() && *px > 0.0)) {
            let help = "give width and height of the image in pixels, such as [1280, 1024]";
            let message = format!("image_px = {:?}", **image.get_ref());
            return Err(self.source.at(image.span(), message, help));
        }
        Ok(**image.get_ref())
    }
}
