use std::path::Path;

use truearm_host::Result;
use truearm_host::files::ToWrite;
use truearm_host::page::{Next, Page, commands};

/// A page and, where they are asked for, its figures beside it: with the feature `png` each
/// as two.
pub fn page_files(path: &Path, page: &Page, figures: bool) -> Result<Vec<ToWrite>> {
    let mut files = vec![(path.to_owned(), page.html().into_bytes())];
    for figure in page.figures().filter(|_| figures) {
        let (path, svg) = (path.with_file_name(format!("{}.svg", figure.name)), figure.svg());
        #[cfg(feature = "png")]
        files.push(png(path.with_extension("png"), &svg)?);
        files.push((path, svg.into_bytes()));
    }
    Ok(files)
}

#[cfg(feature = "png")]
fn png(path: std::path::PathBuf, svg: &str) -> Result<ToWrite> {
    let drawn = truearm_host::plot::png::png(svg);
    let drawn = drawn.map_err(|why| truearm_host::Error::io(&path, std::io::Error::other(why)))?;
    Ok((path, drawn))
}

/// The command that comes next, for the end of what is said.
pub fn next_line(
    verb: &str,
    next: &Next,
    alternatives: &[truearm_host::diagnose::Alternative],
) -> String {
    let all = commands(verb, alternatives, next);
    all.first().map_or(String::new(), |(what, line)| format!("next, {what}:\n  {line}\n"))
}
