//! Figures of all seeds.

use super::super::study::{Study, spread};
use super::super::trial::{SWEEP, Sweep};
use truearm_host::methods::ink;
use truearm_host::plot::{Axis, Panel, Series, grid};

pub fn seeds(study: &Study) -> String {
    let contests = [
        ("(a) geometry, base and tool fitted", 0),
        ("(a) geometry, base and tool held", 1),
        ("(b) springs and gears, base and tool fitted", 2),
        ("(b) springs and gears, base and tool held", 3),
    ];
    let panels: Vec<Panel> = contests
        .iter()
        .map(|(title, which)| {
            let of = |t: usize| {
                let trial = &study.trials[t];
                match which {
                    0 | 1 => &trial.geometric[*which],
                    _ => &trial.beyond[which - 2],
                }
            };
            let names: Vec<&str> = of(0).scores.iter().map(|s| s.method).collect();
            let mut points = Vec::new();
            for t in 0..study.trials.len() {
                let aside = (t as f64 / study.trials.len() as f64 - 0.5) * 0.6;
                for (k, score) in of(t).scores.iter().enumerate() {
                    if let Some(stats) = score.exact {
                        points.push((k as f64 + 1.0 + aside, stats.mean_mm));
                    }
                }
            }
            Panel {
                title: (*title).to_owned(),
                x: Axis::names(names.iter().map(|n| (*n).to_owned()).collect()),
                y: Axis::log("MAE of 250 noise-free points, mm"),
                series: vec![Series::points("", points)],
                ..Panel::default()
            }
        })
        .collect();
    grid(&panels, 2)
}

pub fn sweep(study: &Study) -> String {
    let panel = |title: &str, of: fn(&Sweep) -> &[Option<f64>], which: usize| {
        let series = study.trials[0].sweep.iter().enumerate().map(|(m, first)| {
            let at = |c: usize| {
                let all = study.trials.iter().map(|t| of(&t.sweep[m])[c].unwrap_or(f64::NAN));
                spread(&all.collect::<Vec<_>>())[which]
            };
            let points = SWEEP.iter().enumerate().map(|(c, n)| (*n as f64, at(c)));
            Series::line(first.method, points.collect()).ink(ink(first.method))
        });
        Panel {
            title: format!("(a) {title}"),
            x: Axis::linear("poses fitted"),
            y: Axis::log("RMS of 250 noise-free points, mm"),
            series: series.collect(),
            ..Panel::default()
        }
    };
    let panels = [
        panel("from the catalogue, median", |s| &s.catalogue_mm, 0),
        panel("from the catalogue, worst seed", |s| &s.catalogue_mm, 3),
        panel("calibrated before, median", |s| &s.calibrated_before_mm, 0),
        panel("calibrated before, worst seed", |s| &s.calibrated_before_mm, 3),
        panel("poses alike, median", |s| &s.narrow_mm, 0),
        panel("poses alike, worst seed", |s| &s.narrow_mm, 3),
    ];
    grid(&panels, 2)
}

pub fn efficiency(study: &Study) -> String {
    let ratios = study.trials.iter().map(|t| (t.seed as f64, t.rms_mm / t.cramer_rao_mm));
    Panel {
        title: "(a) RMS on 250 noise-free points over the Cramer-Rao bound of each seed".to_owned(),
        x: Axis::linear("seed"),
        y: Axis::linear("ratio"),
        series: vec![Series::points("", ratios.collect())],
        ..Panel::default()
    }
    .svg()
}
