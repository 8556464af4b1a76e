//! Points that do not move, and what an instrument adds to lengths to them.

use toml::Spanned;
use truearm::Pose;

use super::Gathered;
use super::keys::AnchorFile;
use super::read::{Reader, stated};
use crate::error::Result;
use crate::model::{Form, Instrument};
use crate::units::from_mm;

impl Reader<'_> {
    pub(super) fn anchor(&self, file: &Spanned<AnchorFile>, book: &mut Gathered) -> Result<()> {
        let own = file.get_ref();
        if own.xyz_mm.is_none() && own.zero.is_none() && own.zero_mm.is_none() {
            let message = format!("nothing is said of anchor \"{}\"", own.label);
            let help = "give xyz_mm, where it is, or zero, what is added to its lengths";
            return Err(self.source.at(file.span(), message, help));
        }
        if let Some(xyz) = &own.xyz_mm {
            let place = Pose { translation: self.point(xyz)?, ..Pose::identity() };
            let found = stated(Instrument::unknown(Form::Anchor, &own.label), place, own.guess);
            book.list.push(found);
        }
        book.list.extend(self.zero(own)?);
        let reach = self.reach(own.reach_mm.as_ref())?;
        book.ranges.extend(reach.map(|reach| (Form::Anchor, own.label.clone(), reach)));
        Ok(())
    }

    /// What is added to every length to an anchor, where something is said of it.
    fn zero(&self, file: &AnchorFile) -> Result<Option<Instrument>> {
        let free = match file.zero.as_ref().map(|z| (z, z.get_ref().as_str())) {
            None | Some((_, "known")) => false,
            Some((_, "free")) => true,
            Some((key, other)) => {
                let help = "write \"free\", or \"known\" where zero_mm is what is added to every \
                            length, or nothing is";
                return Err(self.source.at(key.span(), format!("zero = \"{other}\""), help));
            }
        };
        if file.zero.is_none() && file.zero_mm.is_none() {
            return Ok(None);
        }
        let mut zero = Instrument::unknown(Form::Zero, &file.label);
        if let Some(added) = &file.zero_mm {
            self.finite(added.span(), &[*added.get_ref()])?;
            zero.numbers[0] = from_mm(*added.get_ref());
        }
        Ok(Some(stated(zero, Pose::identity(), free)))
    }
}
