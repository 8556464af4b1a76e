//! Arms that warm up and cool down during a session, and what may be taken for that.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::effects::Effect::ThermalExpansion;
use truearm_host::diagnose::{DiagnoseOptions, Effect, Outcome, diagnose};
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::effects::{Defect, DefectKind};
use truearm_simulate::warming::Climate;
use truearm_simulate::{normal, vector};

use crate::blind::draft::Draft;
use crate::simulated::{parse, robot, stated};

/// What is hidden in a set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hidden {
    /// Links that follow the thermometer late.
    Late,
    /// At once.
    AtOnce,
    /// What the tracker stands on settles; links keep their lengths.
    Settling,
    /// Nothing, although the temperature changes.
    Nothing,
}

/// A set and its truth.
pub struct WarmSet {
    pub seed: u64,
    pub hidden: Hidden,
    pub robot: Robot,
    pub data: Measurements,
    pub holdout: Measurements,
    pub climate: Climate,
    /// 1/K
    pub growth: f64,
    /// Noise over the stated sigma.
    pub noise: f64,
}

/// What a diagnosis made of it.
pub struct Told {
    pub set: WarmSet,
    pub outcome: Outcome,
}

impl WarmSet {
    /// The seed decides everything but what is hidden.
    pub fn draw(seed: u64, hidden: Hidden) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        loop {
            if let Some(set) = Self::attempt(seed, hidden, &mut rng) {
                return set;
            }
        }
    }

    fn attempt(seed: u64, hidden: Hidden, rng: &mut ChaCha8Rng) -> Option<Self> {
        let (text, mut draft) = Draft::geometry(rng);
        let hours = rng.random_range(2.0..8.0);
        // Between four minutes and two hours, of which a session has at least two.
        let longest = f64::min(7200.0, hours * 1800.0);
        let tau = 240.0 * (longest / 240.0_f64).powf(rng.random_range(0.0..1.0));
        let late = hidden == Hidden::Late;
        let mut climate = Climate::drawn(hours, if late { tau } else { 0.0 }, rng);
        // A third of the arms were used before: nobody knows how warm they were.
        if rng.random_bool(1.0 / 3.0) && late {
            climate.ahead = 1.5 * normal(rng);
        }
        let rows = rng.random_range(40..=250);
        let noise = [0.5, 1.0, 2.0][rng.random_range(0..3)];
        let growth = rng.random_range(8e-6..2.3e-5);
        draft.training = climate.moments(&stated(&draft.robot), rows, rng);
        draft.holdout = climate.moments(&stated(&draft.robot), 40, rng);
        let defects = match hidden {
            Hidden::Late | Hidden::AtOnce => {
                vec![Defect { kind: DefectKind::ThermalExpansion, size: growth }]
            }
            Hidden::Settling => {
                let [shift, turn]: [Vector3<f64>; 2] = [(); 2].map(|()| vector(rng).normalize());
                let hours = hours * rng.random_range(0.1..0.5);
                let kind = DefectKind::MeasurementSettling { shift, turn, hours };
                vec![draft.sized(kind, [2.0, 8.0], rng)?]
            }
            Hidden::Nothing => Vec::new(),
        };
        draft.arm.defects = defects;
        draft.misstate(noise);
        let ([measurements, holdout], _) = draft.sealed(rng);
        let robot = robot(&text);
        let data = parse(&robot, &measurements);
        let holdout = parse(&robot, &holdout);
        Some(Self { seed, hidden, robot, data, holdout, climate, growth, noise })
    }

    /// Has it diagnosed.
    ///
    /// # Errors
    /// The seed, and why it cannot be.
    pub fn diagnosed(self) -> Result<Told, String> {
        let options = DiagnoseOptions::default();
        let found = diagnose(&self.robot, &self.data, Some(&self.holdout), &options, &|_| ());
        match found {
            Ok(found) => Ok(Told { outcome: found.outcome, set: self }),
            Err(error) => Err(format!("seed {}: {error}", self.seed)),
        }
    }
}

impl Told {
    /// Thermal expansion as it was named, or only suspected.
    pub fn thermal(&self) -> Option<&Effect> {
        self.outcome.effects.iter().chain(&self.outcome.suspected).find(|e| is_thermal(e))
    }

    /// Whether it was named.
    pub fn is_named(&self) -> bool {
        self.outcome.effects.iter().any(is_thermal)
    }

    /// Whether an alternative has it where the model has not, or has it late or at once where
    /// the model has it otherwise.
    pub fn is_alternative(&self) -> bool {
        let own = self.thermal().map(|e| e.time_constant_s.is_some());
        self.outcome.alternatives.iter().any(|a| {
            a.effects.iter().any(|(name, _)| *name == ThermalExpansion.name())
                && own != Some(a.time_constant_s.is_some())
        })
    }

    /// Names that are not true, suspected ones apart.
    pub fn false_names(&self) -> Vec<&'static str> {
        let truth = match self.set.hidden {
            Hidden::Late | Hidden::AtOnce => ThermalExpansion.name(),
            Hidden::Settling => "measurement-drift",
            Hidden::Nothing => "",
        };
        let all = self.outcome.effects.iter().map(|e| e.name);
        all.filter(|name| *name != truth).collect()
    }

    /// How far its time constant is off, in its standard deviations and as a logarithm.
    pub fn time_constant_off(&self) -> Option<[f64; 2]> {
        let effect = self.thermal()?;
        let (found, sigma) = (effect.time_constant_s?, effect.time_constant_sigma_s?);
        let tau = self.set.climate.time_constant;
        Some([(found - tau) / sigma, (found / tau).ln()])
    }
}

fn is_thermal(effect: &Effect) -> bool {
    effect.name == ThermalExpansion.name()
}
