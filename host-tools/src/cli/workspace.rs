use clap::Args;
use nalgebra::Vector3;
use truearm::JointKind;
use truearm_host::model::{Robot, Sight, Workspace};
use truearm_host::units::joint_from_file;
use truearm_host::{Error, Result};

use super::warn;

/// No joint goes farther, degrees or mm, as in robot.toml.
const FARTHEST: f64 = 1e5;

/// Where poses may be. Lengths in mm, in the frame that `[base]` of robot.toml is stated in.
#[derive(Args)]
pub struct Where {
    /// Keep the target between two corners
    #[arg(long = "box", value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    corners: Option<String>,
    /// Joint limits instead of those of robot.toml, degrees (mm for prismatic
    /// joints), one low:high a joint; one that is held has twice the same
    #[arg(long, value_name = "LOW:HIGH,...", allow_hyphen_values = true)]
    limits: Option<String>,
    /// Keep the target in sight of a tracker that stands here
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    tracker: Option<String>,
    /// Direction the target faces, in the frame of `[tool]`; without its
    /// rpy_deg the last frame
    #[arg(
        long,
        value_name = "X,Y,Z",
        requires = "tracker",
        default_value = "0,0,1",
        allow_hyphen_values = true
    )]
    target_axis: String,
    /// Half angle of the cone in which the target can be seen; a reflector in
    /// its ball has about 30, one that is turned to the tracker by hand 90
    #[arg(long, value_name = "DEG", requires = "tracker", default_value_t = 90.0)]
    cone_deg: f64,
}

impl Where {
    /// The workspace of a robot.
    pub fn of(&self, robot: &Robot) -> Result<Workspace> {
        let limits = self.limits.as_deref().map(|text| limits(text, robot)).transpose()?;
        let mut workspace = Workspace::new(robot, limits)?;
        if let Some(text) = &self.corners {
            let [x0, y0, z0, x1, y1, z1] = numbers("--box", text)?;
            workspace.corners = Some([Vector3::new(x0, y0, z0), Vector3::new(x1, y1, z1)])
                .map(|corners| corners.map(|c| c * 1e-3));
        }
        if let Some(text) = &self.tracker {
            let axis = Vector3::from(numbers("--target-axis", &self.target_axis)?);
            if axis.norm() == 0.0 {
                return Err(Error::usage("--target-axis 0,0,0", "give a direction, such as 0,0,1"));
            }
            if !(self.cone_deg > 0.0 && self.cone_deg <= 180.0) {
                return Err(Error::usage(
                    format!("--cone-deg {}", self.cone_deg),
                    "give half the opening angle, above 0 and up to 180 degrees",
                ));
            }
            workspace.sight = Some(Sight {
                tracker: Vector3::from(numbers("--tracker", text)?) * 1e-3,
                axis,
                cone: self.cone_deg.to_radians(),
            });
        }
        Ok(workspace)
    }
}

fn limits(text: &str, robot: &Robot) -> Result<Vec<[f64; 2]>> {
    let wrong = || {
        Error::usage(
            format!("--limits {text}"),
            "give low:high for every joint, separated by commas, such as -170:170,-90:120",
        )
    };
    let ranges: Vec<&str> = text.split(',').collect();
    if ranges.len() != robot.joints.len() {
        return Err(Error::usage(
            format!(
                "--limits of {} joints, but the robot has {}",
                ranges.len(),
                robot.joints.len()
            ),
            "give low:high for every joint, separated by commas",
        ));
    }
    let range = |(joint, range): (usize, &str)| {
        let (low, high) = range.split_once(':').ok_or_else(wrong)?;
        let value = |cell: &str| match cell.trim().parse::<f64>() {
            Ok(x) if x.abs() <= FARTHEST => Ok(x),
            _ => Err(wrong()),
        };
        let (low, high) = (value(low)?, value(high)?);
        if low > high {
            return Err(Error::usage(
                format!("--limits {low}:{high} of joint {}", joint + 1),
                "give the lower limit first",
            ));
        }
        Ok([low, high].map(|limit| joint_from_file(robot.joints[joint].link.kind, limit)))
    };
    let limits: Vec<[f64; 2]> = ranges.into_iter().enumerate().map(range).collect::<Result<_>>()?;
    let turning = robot.joints.iter().zip(&limits);
    let mut turning =
        turning.filter(|(joint, _)| joint.link.kind == JointKind::Revolute).peekable();
    let narrow = |[low, high]: &[f64; 2]| low.abs().max(high.abs()) < NARROW && low < high;
    if turning.peek().is_some() && turning.all(|(_, limits)| narrow(limits)) {
        let what = format!("--limits {text}: all within 7 degrees, are they radians?");
        warn(&[what + " Degrees are expected"]);
    }
    Ok(limits)
}

/// All joints of an arm may turn by less, and then somebody meant radians, rad.
const NARROW: f64 = 7.0 * std::f64::consts::PI / 180.0;

fn numbers<const N: usize>(option: &str, text: &str) -> Result<[f64; N]> {
    let cells: Vec<f64> = text
        .split(',')
        .filter_map(|c| c.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    let right = (text.split(',').count() == N).then_some(cells);
    right.and_then(|cells| cells.try_into().ok()).ok_or_else(|| {
        Error::usage(
            format!("{option} {text}"),
            format!("give {N} numbers separated by commas, in mm where they are lengths"),
        )
    })
}
