//! The report in Markdown: tables first, then what they mean.

use super::example::Example;
use super::section_v::NinePoses;
use super::study::{CAUTION, SHOWN, Study, contests};
use super::{discussion, points, tables};

/// The whole text, with the figures of these files.
pub fn report(
    study: &Study,
    example: &Example,
    nine: &NinePoses,
    files: &[(String, String)],
) -> String {
    let mut out = format!(
        "{CAUTION}\n\n# The paper's experiment on simulated cells\n\n\
         X. Li et al., IEEE Access 10 (2022), doi 10.1109/ACCESS.2022.3201818, on {} simulated cells (seeds 1 to {}): a 6R arm \
         of reach 1,024 mm, target at the offset of Eq. 23, 0.0304 mm of noise a coordinate \
         (repeatability 0.03 mm, tracker 5 um), 52 poses in an 800 mm cube to identify, 18 to \
         validate, and 250 noise-free ones, which no measurement has, to judge by. Geometric errors \
         are drawn at random and scaled so that no calibration leaves the paper's MAE of 2.533 mm. \
         Cell (a) has nothing else. Cell (b) has springs in joints 2 and 3 and gear transmission \
         errors in joints 1 and 2, scaled so that the best geometric fit leaves the paper's 0.472 mm.\n\n\
         Methods: {}\n\n",
        study.trials.len(),
        study.trials.len(),
        example
            .held
            .methods
            .iter()
            .map(|o| format!("**{}** {}", o.name, o.about))
            .collect::<Vec<_>>()
            .join("; "),
    );
    out += "Errors are 3-D distances: largest (Max), mean (MAE), standard deviation (SD).\n\n";
    out += &tables::summary(study);
    out += &tables::nine_and_ten(study, example);
    for (title, of) in contests() {
        out += &tables::contest(title, &study.trials.iter().map(of).collect::<Vec<_>>());
    }
    out += &tables::sweep(study);
    out += &discussion::text(study, example);
    out += &points::section_v(nine);
    out += &points::parameters(example);
    out += &points::validation(example);
    out += &figures(files);
    out
}

fn figures(files: &[(String, String)]) -> String {
    let mut out = format!(
        "## Figures and files\n\n`figure-04` to `figure-14` are the counterparts of the paper's \
         figures of these numbers, of cell (b), seed {SHOWN}, base and tool held; `table-5.svg` is of section \
         V; `figure-15` shows every seed, `figure-16` the number of poses, `figure-17` the Cramer-Rao \
         ratios. `cell/` holds the robot and the measurements (Table 6 is `cell/identification.csv`): \
         `truearm compare cell/robot.toml cell/identification.csv --validate cell/validation.csv --hold-frames` \
         computes the comparison of that seed again. `report.json` has every seed.\n"
    );
    for (file, _) in files {
        let name = file.trim_end_matches(".svg").replace('-', " ");
        out += &format!("\n![{name}]({file})\n");
    }
    out
}
