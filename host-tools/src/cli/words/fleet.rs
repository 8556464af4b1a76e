use truearm_host::error::count;
use truearm_host::report::{FleetArm, FleetParameter, FleetReport};
use truearm_host::table::Table;

/// A chance as it is read; what rounding cannot tell from none is said to be small.
fn chance(p: f64) -> String {
    if p < 1e-12 { "< 1e-12".to_owned() } else { format!("{p:.1e}") }
}

/// A fleet: its arms, what they share, the tolerances of the next.
pub fn fleet(report: &FleetReport) -> String {
    let judged = report.arms.iter().filter_map(|arm| arm.judgement.as_ref());
    let (all, apart) = (judged.clone().count(), judged.filter(|j| j.differs).count());
    let mut out = format!(
        "{}: {} in {}, {apart} of them not as the others; noise {:.2} times the stated\n\n",
        report.robot,
        count(all, "arm"),
        count(report.arms.len(), "folder"),
        report.noise_over_stated
    );
    out += &arms(report);
    out += &common(report);
    out + &tolerances(&report.parameters)
}

fn arms(report: &FleetReport) -> String {
    let head = ["arm", "poses", "held out, mm", "noise", "farthest off", "sigmas", "chance"];
    let mut table = Table::new(head);
    let mut said = String::new();
    for FleetArm { name, poses, cross_validated_rms_mm, judgement, failure } in &report.arms {
        if let Some(j) = judgement {
            let rms = cross_validated_rms_mm.map_or("-".to_owned(), |rms| format!("{rms:.4}"));
            let far = format!("{} {:+.4} {}", j.farthest, j.deviation, j.unit);
            let noise = format!("{:.2}", j.noise_over_others);
            let sigmas = format!("{:.1}", j.sigmas.abs());
            let cells = [poses.to_string(), rms, noise, far, sigmas, chance(j.chance)];
            table.row(std::iter::once(name.clone()).chain(cells));
            if j.differs {
                said += &format!("{name} differs: the type is learned without it\n");
            }
        }
        if let Some(failure) = failure {
            said += &format!("{name} is not identified: {failure}\n");
        }
    }
    format!(
        "{table}{said}chance: of any arm so far off in a fleet in which none differs; below \
         {:.2} it is named\n\n",
        report.error_rate
    )
}

fn common(report: &FleetReport) -> String {
    let of = |p: &FleetParameter| {
        let chance = chance(p.chance?);
        Some(format!("  {} {:+.4} {} (chance {chance})\n", p.name, p.expected, p.unit))
    };
    let all: String = report.parameters.iter().filter_map(of).collect();
    if all.is_empty() {
        return "no correction is common to the arms\n\n".to_owned();
    }
    format!("common to the arms, so that the drawing is wrong and not the arm:\n{all}\n")
}

fn tolerances(parameters: &[FleetParameter]) -> String {
    let head =
        ["tolerance of the next arm", "alpha, deg", "a, mm", "theta, deg", "d, mm", "beta, deg"];
    let mut table = Table::new(head);
    for (i, joint) in parameters.chunks(5).enumerate() {
        // A star where the usual tolerance and not the arms speak.
        let open = |p: &FleetParameter| if p.determined_by_arms < 1.0 { "*" } else { " " };
        let cells = joint.iter().map(|p| format!("{:.4}{}", p.tolerance, open(p)));
        table.row(std::iter::once(format!("  joint {}", i + 1)).chain(cells));
    }
    let star = parameters.iter().any(|p| p.determined_by_arms < 1.0);
    let remark = if star { "*: the measurements hardly say\n" } else { "" };
    format!("{table}{remark}")
}
