//! All mistakes that are tried one at a time.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use truearm::{JointKind, Link, LinkParameter};

use super::mistake::{AngleUnit, Convention, LengthUnit, Mistake, New};

/// Every single mistake that an arm of these links can have.
pub(super) fn all(links: &[Link<f64>]) -> Vec<Mistake> {
    let mut all = vec![Mistake::Step(-1), Mistake::Step(1), Mistake::Hand];
    let has = |kind| links.iter().any(|link| link.kind == kind);
    if has(JointKind::Revolute) {
        all.extend([AngleUnit::Radian, AngleUnit::DegreeTwice].map(Mistake::JointUnit));
    }
    let lengths = [LengthUnit::Metre, LengthUnit::Inch, LengthUnit::Centimetre];
    if has(JointKind::Prismatic) {
        all.extend(lengths.map(Mistake::SlideUnit));
    }
    all.extend(lengths.map(Mistake::PointUnit));
    all.push(Mistake::PointUnit(LengthUnit::Micrometre));
    all.extend(lengths.map(Mistake::RobotUnit));
    let turned = |link: &Link<f64>| link.parameters.alpha != 0.0 || link.parameters.theta != 0.0;
    if links.iter().any(turned) {
        all.push(Mistake::RobotAngles);
    }
    all.push(Mistake::Convention(Convention::Standard));
    all.extend(
        [0.0, FRAC_PI_2, -FRAC_PI_2]
            .map(|alpha| Mistake::Convention(Convention::Shifted(alpha, 0.0))),
    );
    all.extend(orders(links.len()).into_iter().map(Mistake::Order));
    for (joint, link) in links.iter().enumerate() {
        all.push(Mistake::Sense(joint));
        all.extend(values(joint, link));
    }
    all
}

/// Numbers of a link: signs, and starts from where a fit finds any other value.
fn values(joint: usize, link: &Link<f64>) -> Vec<Mistake> {
    let at = |parameter, new| Mistake::Value(joint, parameter, new);
    let mut all = vec![at(LinkParameter::Alpha, New::About(0.0))];
    // A sign of alpha is a half turn or none.
    all.extend([FRAC_PI_2, -FRAC_PI_2, PI].map(|a| at(LinkParameter::Alpha, New::About(a))));
    // A fit finds an angle from within 25 degrees or so. The fixed angle of a
    // slide is as good as an alpha.
    let starts: &[f64] = match link.kind {
        JointKind::Revolute => &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
        JointKind::Prismatic => &[0.0, 2.0, 4.0, 6.0],
    };
    all.extend(starts.iter().map(|k| at(LinkParameter::Theta, New::About(k * FRAC_PI_4))));
    for parameter in [LinkParameter::A, LinkParameter::D] {
        all.push(at(parameter, New::About(0.0)));
        let value =
            if parameter == LinkParameter::A { link.parameters.a } else { link.parameters.d };
        if value != 0.0 {
            all.push(at(parameter, New::Negative));
        }
    }
    all
}

/// Orders of columns that are met: two swapped, three neighbours turned round
/// (ROS sorts elbow, `shoulder_lift`, `shoulder_pan`, wrists: the first and the
/// third swapped), all backwards, the last first or the first last.
fn orders(n: usize) -> Vec<Vec<usize>> {
    let plain: Vec<usize> = (0..n).collect();
    let mut all: Vec<Vec<usize>> = Vec::new();
    let mut add = |order: Vec<usize>| {
        if order != plain && !all.contains(&order) {
            all.push(order);
        }
    };
    for i in 0..n {
        for j in 0..i {
            let mut order = plain.clone();
            order.swap(i, j);
            add(order);
        }
    }
    for i in 2..n {
        for turns in 1..3 {
            let mut order = plain.clone();
            order[i - 2..=i].rotate_left(turns);
            add(order);
        }
    }
    add(plain.iter().rev().copied().collect());
    for turns in [1, n.saturating_sub(1)] {
        let mut order = plain.clone();
        order.rotate_left(turns.min(n));
        add(order);
    }
    all
}

/// What a fitted number was probably meant to be: values that a slip of the
/// hand turns into the stated one.
pub(super) fn plain(joint: usize, parameter: LinkParameter, stated: f64, by: f64) -> Vec<Mistake> {
    let at = |new| Mistake::Value(joint, parameter, new);
    if parameter.is_length() {
        let factors = [10.0, 0.1, 100.0, 0.01, 1e3, 1e-3, 25.4, 1.0 / 25.4, 0.0];
        let mut all = vec![at(New::Negative)];
        all.extend(factors.map(|factor| at(New::Times(factor))));
        all.retain(|c| matches!(c, Mistake::Value(_, _, new) if (new.of(stated) - stated - by).abs() < NEAR));
        return all;
    }
    let quarter = (by / FRAC_PI_2).round() * FRAC_PI_2;
    if quarter != 0.0 && (quarter - by).abs() < NEAR {
        vec![at(New::Plus(quarter))]
    } else {
        Vec::new()
    }
}

/// A plain value is tried where the fitted one is this near, m or rad: what an
/// arm may be off by itself, and as much again for what the fit could not tell.
const NEAR: f64 = 0.03;
