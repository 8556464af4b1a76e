//! A user's own dialect: `header`, `row`, `footer` and `separator` of a TOML file,
//! with `{q1_deg}` and its like in place of numbers.

use std::path::Path as FilePath;

use serde::Deserialize;
use truearm::{JointKind, Pose};

use super::{Point, points};
use crate::error::{Error, Place, Result};
use crate::model::{Coordinates, Model, Path};
use crate::paths::Compensated;
use crate::paths::rows::pose_numbers;
use crate::units::to_mm;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TemplateFile {
    #[serde(default)]
    header: String,
    row: String,
    #[serde(default)]
    separator: String,
    #[serde(default)]
    footer: String,
}

/// A program with gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct Template {
    path: std::path::PathBuf,
    header: Vec<Piece>,
    row: Vec<Piece>,
    separator: String,
    footer: Vec<Piece>,
}

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Text(String),
    /// Name and digits behind the point.
    Gap(String, Option<usize>),
}

const HELP: &str = "a template is TOML with row and, if needed, header, footer and separator; a \
                    gap is {q1_deg} or {q1_deg:.3}, a brace {{ or }}; docs/paths.md has examples";

impl Template {
    /// Reads a template.
    ///
    /// # Errors
    /// What is wrong in it and where.
    pub fn read(path: &FilePath) -> Result<Self> {
        Self::parse(path, &crate::files::read(path)?)
    }

    /// Like [`Template::read`] from a text.
    ///
    /// # Errors
    /// As for [`Template::read`].
    pub fn parse(path: &FilePath, text: &str) -> Result<Self> {
        let file: TemplateFile = toml::from_str(text).map_err(|e| {
            let place = e.span().map_or(Place::default(), |s| Place::offset(text, s.start));
            Error::file(path, place, e.message(), HELP)
        })?;
        let pieces = |key: &str, text: &str| {
            pieces(text).map_err(|message| {
                Error::file(path, Place::default(), format!("{key}: {message}"), HELP)
            })
        };
        Ok(Self {
            path: path.to_owned(),
            header: pieces("header", &file.header)?,
            row: pieces("row", &file.row)?,
            separator: file.separator,
            footer: pieces("footer", &file.footer)?,
        })
    }

    /// The program of a corrected path.
    ///
    /// # Errors
    /// A gap of a name that there is nothing for; a row that is not reached.
    pub fn fill(&self, model: &Model, path: &Path, found: &Compensated) -> Result<String> {
        let points = points(path, found)?;
        let whole = |name: &str| match name {
            "rows" => Some(Filling::Text(points.len().to_string())),
            "robot" => Some(Filling::Text(model.robot.name.clone())),
            _ => None,
        };
        let rows = points.iter().enumerate().map(|(i, point)| {
            let kinds: Vec<JointKind> = model.robot.joints.iter().map(|j| j.link.kind).collect();
            self.filled(&self.row, "row", |name| match name {
                "row" => Some(Filling::Text((i + 1).to_string())),
                _ => joint(name, point.joints, &kinds)
                    .or_else(|| pose(name, point.believed))
                    .or_else(|| carried(name, path, point))
                    .or_else(|| whole(name)),
            })
        });
        let rows = rows.collect::<Result<Vec<_>>>()?;
        let (header, footer) = (
            self.filled(&self.header, "header", whole)?,
            self.filled(&self.footer, "footer", whole)?,
        );
        Ok(header + &rows.join(&self.separator) + &footer)
    }

    fn filled(
        &self,
        pieces: &[Piece],
        key: &str,
        filling: impl Fn(&str) -> Option<Filling>,
    ) -> Result<String> {
        let mut out = String::new();
        for piece in pieces {
            out += &match piece {
                Piece::Text(text) => text.clone(),
                Piece::Gap(name, digits) => match (filling(name), digits) {
                    (Some(Filling::Number(x)), Some(digits)) => format!("{x:.digits$}"),
                    (Some(Filling::Number(x)), None) => x.to_string(),
                    (Some(Filling::Text(text)), Some(digits)) => match text.parse::<f64>() {
                        Ok(x) if x.is_finite() => format!("{x:.digits$}"),
                        _ => text,
                    },
                    (Some(Filling::Text(text)), None) => text,
                    (None, _) => return Err(self.unknown(key, name)),
                },
            };
        }
        Ok(out)
    }

    fn unknown(&self, key: &str, name: &str) -> Error {
        let known = if key == "row" {
            "a row has q1_deg, q1_rad (q1_mm, q1_m of a joint that slides) and so on, x_mm, y_mm, \
             z_mm, qx, qy, qz, qw, roll_deg, pitch_deg, yaw_deg, row, rows, robot and the other \
             columns of the path"
        } else {
            "header and footer have rows and robot"
        };
        let message = format!("{key}: nothing is called {{{name}}}");
        Error::file(&self.path, Place::default(), message, known)
    }
}

enum Filling {
    Number(f64),
    /// As it stands, but for digits that are asked for.
    Text(String),
}

fn joint(name: &str, joints: &[f64], kinds: &[JointKind]) -> Option<Filling> {
    let (number, unit) = name.strip_prefix('q')?.split_once('_')?;
    let j = number.parse::<usize>().ok()?.checked_sub(1)?;
    let q = *joints.get(j)?;
    let value = match (kinds.get(j)?, unit) {
        (JointKind::Revolute, "deg") => q.to_degrees(),
        (JointKind::Prismatic, "mm") => to_mm(q),
        (JointKind::Revolute, "rad") | (JointKind::Prismatic, "m") => q,
        _ => return None,
    };
    Some(Filling::Number(value))
}

fn pose(name: &str, pose: &Pose<f64>) -> Option<Filling> {
    [Coordinates::Quaternion, Coordinates::Rpy].iter().find_map(|coordinates| {
        let at = coordinates.pose_columns().iter().position(|n| *n == name)?;
        Some(Filling::Number(pose_numbers(pose, *coordinates)[at]))
    })
}

fn carried(name: &str, path: &Path, point: &Point) -> Option<Filling> {
    let at = path.names.iter().position(|n| n == name)?;
    Some(Filling::Text(point.cells.get(at)?.clone()))
}

fn pieces(text: &str) -> std::result::Result<Vec<Piece>, String> {
    let (mut out, mut plain) = (Vec::new(), String::new());
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        plain += &rest[..at];
        rest = &rest[at..];
        if let Some(after) = rest.strip_prefix("{{").or(rest.strip_prefix("}}")) {
            plain += &rest[..1];
            rest = after;
            continue;
        }
        let gap = rest.strip_prefix('{').and_then(|r| r.split_once('}'));
        let (gap, after) = gap.ok_or_else(|| "a brace that belongs to none".to_owned())?;
        let (name, digits) = match gap.split_once(":.") {
            None => (gap, None),
            Some((name, digits)) => match digits.parse::<usize>() {
                Ok(digits) if digits <= 17 => (name, Some(digits)),
                _ => return Err(format!("{{{gap}}} asks for no number of digits up to 17")),
            },
        };
        out.push(Piece::Text(std::mem::take(&mut plain)));
        out.push(Piece::Gap(name.trim().to_owned(), digits));
        rest = after;
    }
    out.push(Piece::Text(plain + rest));
    Ok(out)
}
