//! Figures as PNG: with the workspace, or by `cargo test -p truearm-host --features png --test png`.

#![cfg(feature = "png")]

use std::fs;
use std::path::{Path, PathBuf};

use resvg::tiny_skia::Pixmap;
use truearm_host::plot::png::{SCALE, png};
use truearm_host::plot::{Axis, Panel, Series, numbered};

/// The share of a box, in units of the figure, that is not the ground.
fn inked(pixels: &Pixmap, [x0, y0, x1, y1]: [u32; 4]) -> f64 {
    let scale = SCALE as u32;
    let ground = pixels.pixel(0, 0).unwrap();
    let rows = y0 * scale..y1 * scale;
    let all: Vec<_> = rows.flat_map(|y| (x0 * scale..x1 * scale).map(move |x| (x, y))).collect();
    let drawn = all.iter().filter(|(x, y)| pixels.pixel(*x, *y).unwrap() != ground).count();
    drawn as f64 / all.len() as f64
}

fn panel(title: &str, values: &[f64]) -> Pixmap {
    let series = vec![Series::line("a", numbered(values))];
    let panel = Panel::new(title, Axis::linear("row"), Axis::linear("mm"), series);
    Pixmap::decode_png(&png(&panel.svg()).unwrap()).unwrap()
}

/// Ground, frame and line come from the style, the title from the font.
#[test]
fn a_panel_has_its_size_and_all_that_is_in_it() {
    let titled = panel("Title: \u{b0} \u{3bc} \u{2212}", &[1.0, 3.0, 2.0]);
    assert_eq!((titled.width(), titled.height()), (560 * SCALE as u32, 360 * SCALE as u32));
    let ground = titled.pixel(0, 0).unwrap();
    assert_eq!((ground.red(), ground.green(), ground.blue(), ground.alpha()), (255, 255, 255, 255));
    let title = [14, 8, 100, 26];
    let (with, without) = (inked(&titled, title), inked(&panel("", &[1.0, 3.0, 2.0]), title));
    assert!(with > 0.05 && without < 0.5 * with, "{with} {without}");
    let line = |pixels: &Pixmap| {
        let blue = pixels.pixels().iter().filter(|p| p.blue() > 150 && p.red() < 50);
        blue.count()
    };
    let (long, flat) = (line(&titled), line(&panel("", &[1.0, 1.0, 1.0])));
    assert!(flat > 500 && long > flat, "{long} {flat}");
}

#[test]
fn every_figure_is_written_twice() {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8");
    let mut identify = std::process::Command::new(env!("CARGO_BIN_EXE_truearm"));
    identify.current_dir(&folder).arg("identify");
    identify.arg(data.join("robot.toml")).arg(data.join("measurements.csv"));
    assert!(identify.args(["--out", "out", "--figures"]).output().unwrap().status.success());
    let files = fs::read_dir(folder.path().join("out")).unwrap();
    let files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    let of = |end: &str| {
        let mut all: Vec<&PathBuf> =
            files.iter().filter(|p| p.extension().is_some_and(|e| e == end)).collect();
        all.sort();
        all
    };
    let (svg, drawn) = (of("svg"), of("png"));
    assert!(drawn.len() >= 3, "{files:?}");
    assert_eq!(svg.len(), drawn.len());
    for (svg, drawn) in svg.iter().zip(drawn) {
        assert_eq!(svg.file_stem(), drawn.file_stem());
        let pixels = Pixmap::load_png(drawn).unwrap();
        let all = [0, 0, pixels.width() / SCALE as u32, pixels.height() / SCALE as u32];
        assert!(inked(&pixels, all) > 0.005, "{} is blank", drawn.display());
    }
}
