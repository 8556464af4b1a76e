use std::path::Path;

use truearm_host::Result;
use truearm_host::files::write;
use truearm_host::page::{Next, Page, commands};

/// Writes a page and, where they are asked for, its figures beside it.
pub fn write_page(path: &Path, page: &Page, figures: bool) -> Result<()> {
    write(path, page.html().as_bytes())?;
    if figures {
        write_figures(path.parent().unwrap_or(Path::new("")), page)?;
    }
    Ok(())
}

/// Writes every figure of a page as a file of its own, with the feature `png` as two.
pub fn write_figures(folder: &Path, page: &Page) -> Result<()> {
    page.figures().try_for_each(|figure| {
        let (path, svg) = (folder.join(format!("{}.svg", figure.name)), figure.svg());
        #[cfg(feature = "png")]
        write_png(&path.with_extension("png"), &svg)?;
        write(&path, svg.as_bytes())
    })
}

#[cfg(feature = "png")]
fn write_png(path: &Path, svg: &str) -> Result<()> {
    let drawn = truearm_host::plot::png::png(svg);
    let drawn = drawn.map_err(|why| truearm_host::Error::io(path, std::io::Error::other(why)))?;
    write(path, &drawn)
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
