//! An effect as it is reported, and how its order is said.

use schemars::JsonSchema;
use serde::Serialize;

use super::policy::POLICY;
use super::weigh::Doubt;

/// An effect that the model has.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Effect {
    /// Name.
    pub name: &'static str,
    /// Joints, counted from 1; coupling is source, target; empty where it does
    /// not apply.
    pub joints: Vec<usize>,
    /// Cycles a turn of a periodic effect.
    pub order: Option<f64>,
    /// One standard deviation of it, where it was found from the data and not from a gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order_sigma: Option<f64>,
    /// Orders that look the same at the angles at which its joint stood, evenly spaced or of a
    /// part of a turn: it may be any of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub orders_alike: Vec<f64>,
    /// Thermal expansion: time constant with which the arm follows the temperature that was
    /// read, s; none where it does at once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_constant_s: Option<f64>,
    /// One standard deviation of it, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_constant_sigma_s: Option<f64>,
    /// Its coefficients.
    pub coefficients: Vec<Coefficient>,
    /// That the arm has it, given the data and all that was looked at.
    pub probability: f64,
    /// 1 - RMS with over RMS without it of either half of the poses, at random,
    /// when all coefficients are fitted to the other half.
    pub half_gain: [f64; 2],
    /// Why it is suspected, not named, however probable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<Doubt>,
    /// 1 - RMS with over RMS without it, on held-out poses.
    pub holdout_gain: f64,
}

/// A blob holds orders in 1/64 of a cycle: less doubt than this is none.
const LEAST_DOUBT: f64 = 1.0 / 64.0;

impl Effect {
    /// What speaks against its name, in words: where it would be named otherwise, and where a few
    /// waves are why a curve is no more probable.
    #[must_use]
    pub fn suspicion(&self) -> Option<&'static str> {
        let why = |doubt: &Doubt| self.probability >= POLICY.named || *doubt == Doubt::Waves;
        self.doubt.filter(why).map(Doubt::words)
    }

    /// Its order where the data leave it open: `82 +- 2`, or `52 or 56, 160`.
    #[must_use]
    pub fn order_left_open(&self) -> Option<String> {
        let doubt = self.doubt_of_order();
        if let Some([order, others]) = self.said_alike() {
            let each = doubt.map(|(sigma, digits)| format!(", each +- {sigma:.digits$}"));
            return Some(format!("{order} or {others}{}", each.unwrap_or_default()));
        }
        let (order, (sigma, digits)) = self.order.zip(doubt)?;
        Some(format!("{order:.digits$} +- {sigma:.digits$}"))
    }

    /// Where other orders look the same: it, and the first of them.
    #[must_use]
    pub fn said_alike(&self) -> Option<[String; 2]> {
        let order = self.order.filter(|_| !self.orders_alike.is_empty())?;
        Some([whole(order), some(&self.orders_alike)])
    }

    /// One standard deviation of the order and the digits that it is said with, where it is
    /// worth a word.
    fn doubt_of_order(&self) -> Option<(f64, usize)> {
        let sigma = self.order_sigma.filter(|sigma| *sigma > LEAST_DOUBT)?;
        // One digit of the doubt, and no more digits of what is doubtful.
        Some((sigma, usize::try_from(-sigma.log10().floor() as i32).unwrap_or(0)))
    }
}

/// Of orders that look alike, the first ones.
fn some(orders: &[f64]) -> String {
    let first: Vec<String> = orders.iter().take(SOME).map(|n| whole(*n)).collect();
    format!("{}{}", first.join(", "), if orders.len() > SOME { " and others" } else { "" })
}

/// Whole, or with one digit more.
fn whole(order: f64) -> String {
    let digits = usize::from((order - order.round()).abs() > 0.05);
    format!("{order:.digits$}")
}

/// So many of them are said.
const SOME: usize = 8;

/// One coefficient.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Coefficient {
    /// Joint, counted from 1.
    pub joint: Option<usize>,
    /// Which one, where there are several: cos, sin, x, y...
    pub part: &'static str,
    /// Value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// One standard deviation.
    pub sigma: f64,
    /// Backlash: friction torque above which gravity takes the side, N m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_nm: Option<f64>,
    /// The same of a joint that slides, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_n: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(order: f64, order_sigma: Option<f64>, orders_alike: &[f64]) -> Option<String> {
        let effect = Effect {
            name: "joint-periodic-error",
            joints: vec![2],
            order: Some(order),
            order_sigma,
            orders_alike: orders_alike.to_vec(),
            time_constant_s: None,
            time_constant_sigma_s: None,
            coefficients: Vec::new(),
            probability: 1.0,
            half_gain: [0.0; 2],
            doubt: None,
            holdout_gain: 0.0,
        };
        effect.order_left_open()
    }

    #[test]
    fn an_order_has_the_digits_that_are_known() {
        let of = |order: f64, sigma: Option<f64>| said(order, sigma, &[]);
        assert_eq!(of(128.0, None), None);
        assert_eq!(of(80.015625, Some(0.01)), None);
        assert_eq!(of(80.015625, Some(0.04)), Some("80.02 +- 0.04".to_owned()));
        assert_eq!(of(81.6, Some(0.7)), Some("81.6 +- 0.7".to_owned()));
        assert_eq!(of(81.6, Some(2.4)), Some("82 +- 2".to_owned()));
        assert_eq!(of(81.6, Some(24.0)), Some("82 +- 24".to_owned()));
    }

    #[test]
    fn of_orders_that_look_alike_none_is_said_to_be_it() {
        let of = |order: f64, sigma, alike: &[f64]| said(order, sigma, alike).unwrap();
        assert_eq!(some(&[56.0, 160.0]), "56, 160");
        assert_eq!(some(&[8.5, 37.5]), "8.5, 37.5");
        let many: Vec<f64> = (1..20).map(f64::from).collect();
        assert_eq!(some(&many), "1, 2, 3, 4, 5, 6, 7, 8 and others");
        assert_eq!(of(350.0, Some(0.51), &[161.0, 180.0]), "350 or 161, 180, each +- 0.5");
        assert_eq!(of(52.0, None, &[56.0]), "52 or 56");
    }
}
