//! What a study of dirty sets leaves: every claim and every hidden effect, one a line,
//! and the reliability diagram.

use std::path::Path;
use std::{fs, io};

use truearm_host::diagnose::Doubt;

use super::reliability::{bins, diagram};
use super::score::{Claimed, Judged, Truth, claims};
use super::truth::Place;

/// Writes claims.csv, effects.csv and reliability.svg; the diagram is of `dirty` sets alone.
///
/// # Errors
/// The file system's.
pub fn tables(folder: &Path, dirty: &[&Judged], clean: &[&Judged]) -> io::Result<()> {
    let place = |(name, joints): &Place| {
        let joints: Vec<String> = joints.iter().map(usize::to_string).collect();
        format!("{name},{}", joints.join(" "))
    };
    let mut said =
        "seed,rows,unlisted,name,joints,probability,named,doubt,worth,alike\n".to_owned();
    let mut effects =
        "seed,rows,unlisted,name,joints,floors,from_nothing,sure,named,told\n".to_owned();
    for j in dirty.iter().chain(clean) {
        let set = format!("{},{},{}", j.seed, j.rows, j.unlisted.unwrap_or_default());
        for Claimed { place: at, probability, named, doubt, worth, alike } in &j.claims {
            let (at, doubt) = (place(at), doubt.map_or("", Doubt::words));
            said += &format!("{set},{at},{probability:.6},{named},{doubt},{worth:?},{alike}\n");
        }
        for Truth { place: at, floors, from_nothing, sure, named, told, .. } in &j.truths {
            let sizes = format!("{floors:.4},{from_nothing:.3},{sure:.3}");
            effects += &format!("{set},{},{sizes},{named},{told}\n", place(at));
        }
    }
    fs::create_dir_all(folder)?;
    fs::write(folder.join("claims.csv"), said)?;
    fs::write(folder.join("effects.csv"), effects)?;
    fs::write(folder.join("reliability.svg"), diagram(&bins(&claims(dirty))).svg())
}
