use std::collections::HashSet;
use std::path::{Path, PathBuf};

use urdf_rs::JointType;

use crate::error::{Error, Place, Result};
use crate::files;

/// A URDF that has been read, with its text, to show what is wrong in it.
#[derive(Debug, Clone)]
pub struct Document {
    pub(super) path: PathBuf,
    pub(super) text: String,
    pub(super) robot: urdf_rs::Robot,
}

/// Beyond this a length is no length of an arm, m.
const FARTHEST: f64 = 10.0;
/// No frame is turned by more than a turn, rad.
const TURNED: f64 = 6.3;
/// No joint turns farther, rad...
const WIDEST: f64 = 40.0;
/// ...but one without limits, of which some files say a large number.
const UNLIMITED: f64 = 1000.0;

/// A URDF has elements within each other to a depth of six; what it is read by goes down
/// with every one, and has a stack.
const DEEPEST: usize = 100;

/// The line where elements stand too deep within each other.
fn too_deep(text: &str) -> Option<usize> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut depth = 0_usize;
    loop {
        match reader.read_event() {
            Ok(quick_xml::events::Event::Start(_)) => depth += 1,
            Ok(quick_xml::events::Event::End(_)) => depth = depth.saturating_sub(1),
            Ok(quick_xml::events::Event::Eof) | Err(_) => return None,
            Ok(_) => {}
        }
        if depth > DEEPEST {
            let read = usize::try_from(reader.buffer_position()).unwrap_or(text.len());
            return Some(text[..read.min(text.len())].lines().count());
        }
    }
}

impl Document {
    /// Reads a URDF.
    ///
    /// # Errors
    /// A file that cannot be read, is no URDF, or whose numbers are none.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, files::read(path)?)
    }

    /// Like [`Document::read`] from a text.
    ///
    /// # Errors
    /// As for [`Document::read`].
    pub fn parse(path: &Path, text: String) -> Result<Self> {
        let fail =
            |message: String, help: &str| Err(Error::file(path, Place::default(), message, help));
        let bare = without_comments(&text);
        if ["<xacro:", "${", "$("].iter().any(|sign| bare.contains(sign)) {
            let message = "this is xacro, from which a URDF is made".to_owned();
            return fail(
                message,
                "expand it: `xacro FILE > robot.urdf` (package ros-ROSDISTRO-xacro), with the arguments of your robot",
            );
        }
        for (sign, name) in [("<sdf", "SDF"), ("<mujoco", "MuJoCo's MJCF"), ("<COLLADA", "COLLADA")]
        {
            if bare.contains(sign) {
                return fail(
                    format!("this is {name}, not URDF"),
                    "convert it to URDF first, or give a --dh table",
                );
            }
        }
        if !bare.contains("<robot") {
            return fail(
                "no <robot> in it".to_owned(),
                "give a URDF, an XML file whose root is <robot>",
            );
        }
        if let Some(line) = too_deep(&text) {
            return Err(Error::file(
                path,
                Place::line(line),
                format!("elements within each other, more than {DEEPEST} deep"),
                "no URDF is; links and joints stand side by side in <robot>",
            ));
        }
        let robot = match urdf_rs::read_from_string(&text) {
            Ok(robot) => robot,
            Err(e) => {
                return fail(
                    format!("not a URDF: {e}"),
                    "`check_urdf` (liburdfdom-tools) says where",
                );
            }
        };
        let document = Self { path: path.to_owned(), text, robot };
        document.check()?;
        Ok(document)
    }

    /// Whether names are told apart and numbers are numbers.
    fn check(&self) -> Result<()> {
        let mut seen = HashSet::new();
        if let Some(twice) = self.robot.links.iter().find(|l| !seen.insert(&l.name)) {
            return Err(self.at("link", &twice.name, "stands there twice", "rename one"));
        }
        let mut joints = HashSet::new();
        for joint in &self.robot.joints {
            if !joints.insert(&joint.name) {
                return Err(self.at("joint", &joint.name, "stands there twice", "rename one"));
            }
            for end in [&joint.parent.link, &joint.child.link] {
                if !seen.contains(end) {
                    let message = format!("leads to link \"{end}\", which is not there");
                    return Err(self.at(
                        "joint",
                        &joint.name,
                        &message,
                        "add the link or correct its name",
                    ));
                }
            }
            let numbers = joint.origin.xyz.iter().chain(&*joint.origin.rpy).chain(&*joint.axis.xyz);
            if let Some(wrong) = numbers.into_iter().find(|x| !x.is_finite()) {
                let message = format!("has {wrong} in its origin or axis");
                return Err(self.at("joint", &joint.name, &message, "give finite numbers"));
            }
            let limits = [joint.limit.lower, joint.limit.upper];
            let turns = joint.joint_type == JointType::Revolute;
            let wide = |x: &&f64| turns && x.abs() > WIDEST && x.abs() < UNLIMITED;
            let turned = joint.origin.rpy.iter().find(|x| x.abs() > TURNED);
            if let Some(angle) = turned.or(limits.iter().find(wide)) {
                let message = format!("has an angle of {angle} in its rpy or its limits");
                let help = "URDF is in radians; is this in degrees?";
                return Err(self.at("joint", &joint.name, &message, help));
            }
            if joint.origin.xyz.iter().any(|x| x.abs() > FARTHEST) {
                let message = format!("is {FARTHEST} m or more from its parent");
                return Err(self.at(
                    "joint",
                    &joint.name,
                    &message,
                    "URDF is in metres; is this in millimetres?",
                ));
            }
        }
        Ok(())
    }

    /// What is wrong with a link or joint of this name.
    pub(super) fn at(&self, element: &str, name: &str, message: &str, help: &str) -> Error {
        let message = format!("{element} \"{name}\" {message}");
        let quoted = [format!("\"{name}\""), format!("'{name}'")];
        let start = self.text.match_indices(&format!("<{element}")).map(|(at, _)| at).find(|at| {
            let tag = self.text[*at..].split('>').next().unwrap_or("");
            quoted.iter().any(|q| tag.contains(q.as_str()))
        });
        match start {
            Some(start) => {
                let length = self.text[start..].find('>').map_or(1, |end| end + 1);
                Error::file(&self.path, Place::offset(&self.text, start), message, help)
                    .showing(&self.text, start..start + length)
            }
            None => self.whole(message, help),
        }
    }

    /// What is wrong with the file as a whole.
    pub(super) fn whole(&self, message: impl Into<String>, help: impl Into<String>) -> Error {
        Error::file(&self.path, Place::default(), message, help)
    }
}

/// The text without `<!-- ... -->`, where an expanded file may talk of xacro.
fn without_comments(text: &str) -> String {
    let mut parts = text.split("<!--");
    let first = parts.next().unwrap_or("").to_owned();
    parts.fold(first, |out, part| out + part.split_once("-->").map_or("", |(_, rest)| rest))
}
