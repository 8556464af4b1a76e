//! What these data cannot show: a mistake that base and tool take up.

use nalgebra::{DMatrix, DVector};
use truearm::LinkParameter;

use super::mistake::Mistake;
use super::scene::Scene;
use super::search::{Found, Search};
use crate::model::arm::RowInputs;

/// A parameter whose points move by less than this part of what base and tool
/// cannot take up, is taken up.
const UNSEEN: f64 = 1e-6;

/// One a mistake; joints are counted from 1.
pub(super) fn by_base_or_tool(search: &Search, nothing: &Found, ranked: &[Found]) -> Vec<String> {
    let mut said = numbers(search, nothing);
    // Alike to the last digit: the hypothesis changed nothing that is seen.
    let same = |f: &&Found| {
        f.changes.len() == 1
            && (f.fitted.misfit - nothing.fitted.misfit).abs() < 1e-3
            && (f.fitted.prior - nothing.fitted.prior).abs() < 1e-2
    };
    let words = |f: &Found| match f.changes.as_slice() {
        [Mistake::Sense(joint)] => Some(format!("sense of joint {}", joint + 1)),
        [Mistake::Hand] => Some("handedness of the tracker".to_owned()),
        [Mistake::Order(order)] => {
            let order: Vec<_> = order.iter().map(|j| (j + 1).to_string()).collect();
            Some(format!("order of the joints, {}", order.join(" ")))
        }
        _ => None,
    };
    said.extend(ranked.iter().filter(same).filter_map(words));
    said
}

/// Numbers of the robot file whose columns base and tool span.
fn numbers(search: &Search, nothing: &Found) -> Vec<String> {
    let scene = Scene::new(search.links, search.tool, search.sample, &[]);
    let state = &nothing.fitted.state;
    let (stations, markers) = (state.bases.len(), state.markers.len());
    let frames = 6 * stations + 3 * markers;
    let mut spanned = DMatrix::zeros(3 * scene.sights.len(), frames);
    let mut columns =
        vec![[(); 4].map(|()| DVector::zeros(3 * scene.sights.len())); search.links.len()];
    for (i, sight) in scene.sights.iter().enumerate() {
        let d = state.chain(sight.station, sight.marker).derivatives(
            &sight.q,
            &[],
            &RowInputs::default(),
        );
        for k in 0..6 {
            spanned.fixed_view_mut::<3, 1>(3 * i, 6 * sight.station + k).copy_from(&d.base[k]);
        }
        for k in 0..3 {
            let at = 6 * stations + 3 * sight.marker + k;
            spanned.fixed_view_mut::<3, 1>(3 * i, at).copy_from(&d.tool[k]);
        }
        for (columns, link) in columns.iter_mut().zip(&d.links) {
            for (column, p) in columns.iter_mut().zip(LinkParameter::ALL) {
                column.fixed_view_mut::<3, 1>(3 * i, 0).copy_from(link.get(p));
            }
        }
    }
    let Some(u) = orthonormal(&spanned) else { return Vec::new() };
    let mut said = Vec::new();
    for (joint, columns) in columns.iter().enumerate() {
        // Four of the five: nobody types a beta.
        for (column, p) in columns.iter().zip(LinkParameter::ALL) {
            let left = column - &u * (u.transpose() * column);
            if left.norm() <= UNSEEN * column.norm().max(1e-3) {
                said.push(format!("{} of joint {}", p.name(), joint + 1));
            }
        }
    }
    said
}

/// An orthonormal basis of what the columns span.
fn orthonormal(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let svd = a.clone().svd(true, false);
    let u = svd.u?;
    let most = svd.singular_values.max();
    let rank = svd.singular_values.iter().filter(|s| **s > 1e-9 * most).count();
    Some(u.columns(0, rank).into_owned())
}
