use truearm::{Link, Pose};

use super::axes::{Axes, Axis};
use super::frames::{about_y, to_axis};
use crate::error::{Error, Result};
use crate::model::{Model, Placement};
use nalgebra::Vector3;

/// The identified arm as rigid geometry, in the coordinates of the files, with
/// the frame taken out that carries it onto the nominal one: what a blob holds,
/// but for its terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// The frame before joint 1.
    pub base: Pose<f64>,
    /// Nominal links plus corrections.
    pub links: Vec<Link<f64>>,
    /// The measured target: its identified point, turned as `[tool]` says.
    pub tool: Pose<f64>,
    /// Which target that is.
    pub marker: String,
}

impl Identified {
    /// Of a model and one of its markers; the one that stands for the tool if none is named.
    ///
    /// # Errors
    /// A marker that the model does not have, or several of which none is named; a tool that the
    /// measurements left open; numbers that are none.
    pub fn of(model: &Model, marker: Option<&str>) -> Result<Self> {
        if marker.is_none() {
            model.clear_tool()?;
        }
        model.told_tool()?;
        let found = match marker {
            None => model.tool_marker().or(model.markers.first()),
            Some(name) => model.markers.iter().find(|(label, _)| label == name),
        };
        let Some((label, point)) = found else {
            let labels: Vec<_> = model.markers.iter().map(|(label, _)| label.as_str()).collect();
            return Err(Error::usage(
                format!("--marker {}: the model does not have it", marker.unwrap_or_default()),
                format!("its markers are {}", labels.join(", ")),
            ));
        };
        let turn = Placement { xyz: Vector3::zeros(), rpy: model.robot.tool_rpy }.pose();
        let frame = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let arm = Self {
            base: model.robot.base.pose().compose(&frame),
            links: model.links(),
            tool: Pose { translation: *point, ..turn },
            marker: label.clone(),
        };
        arm.refuse_nonsense()?;
        Ok(arm)
    }

    /// Nothing is written of numbers that are none.
    fn refuse_nonsense(&self) -> Result<()> {
        let pose = |pose: &Pose<f64>| {
            pose.rotation.iter().chain(&pose.translation).copied().collect::<Vec<f64>>()
        };
        let named =
            [("the base".to_owned(), pose(&self.base)), ("the tool".to_owned(), pose(&self.tool))];
        let links = self.links.iter().enumerate();
        let links =
            links.map(|(i, l)| (format!("joint {}", i + 1), l.parameters.to_array().to_vec()));
        for (name, numbers) in named.into_iter().chain(links) {
            if let Some(x) = numbers.iter().find(|x| !x.is_finite()) {
                return Err(Error::not_finite(&name, *x));
            }
        }
        Ok(())
    }

    /// The frames of the links at joint values zero, each in the one before and
    /// the first in the base: z on the joint's axis, without the beta behind it.
    #[must_use]
    pub fn steps(&self) -> Vec<Pose<f64>> {
        let mut before = self.base;
        let step = |link: &Link<f64>| {
            let step = before.compose(&to_axis(link));
            before = about_y(link.parameters.beta);
            step
        };
        self.links.iter().map(step).collect()
    }

    /// The target in the last of these frames.
    #[must_use]
    pub fn tip(&self) -> Pose<f64> {
        let beta = self.links.last().map_or(0.0, |link| link.parameters.beta);
        about_y(beta).compose(&self.tool)
    }

    /// The same frames, each in the coordinates of the files.
    #[must_use]
    pub fn frames(&self) -> Vec<Pose<f64>> {
        let compose = |at: &mut Pose<f64>, step: Pose<f64>| {
            *at = at.compose(&step);
            Some(*at)
        };
        self.steps().into_iter().scan(Pose::identity(), compose).collect()
    }

    /// Its axes and its target in space.
    #[must_use]
    pub fn axes(&self) -> Axes {
        let frames = self.frames();
        let joints = frames.iter().zip(&self.links).map(|(frame, link)| Axis {
            kind: link.kind,
            point: frame.translation,
            direction: frame.rotation.column(2).into_owned(),
        });
        let last = frames.last().copied().unwrap_or(self.base);
        Axes { joints: joints.collect(), tip: last.compose(&self.tip()) }
    }
}
