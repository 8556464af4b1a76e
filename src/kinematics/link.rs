use crate::scalar::Scalar;

/// What a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum JointKind {
    /// Turns about its z axis; the joint value is an angle in rad.
    #[default]
    Revolute,
    /// Slides along its z axis; the joint value is a length in m.
    Prismatic,
}

/// One of the five MD-H parameters of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkParameter {
    /// Link twist alpha_{i-1}, rad.
    Alpha,
    /// Link length a_{i-1}, m.
    A,
    /// Joint offset theta_i (revolute) or the fixed joint angle (prismatic), rad.
    Theta,
    /// Link offset d_i, m; for a prismatic joint added to the joint value.
    D,
    /// Hayati's rotation beta_i about y, rad.
    Beta,
}

impl LinkParameter {
    /// All five, in the order of every parameter vector of the crate.
    pub const ALL: [Self; 5] = [Self::Alpha, Self::A, Self::Theta, Self::D, Self::Beta];

    /// True for the two lengths (m), false for the three angles (rad).
    #[must_use]
    pub const fn is_length(self) -> bool {
        matches!(self, Self::A | Self::D)
    }

    /// Name as in files and messages: `alpha`, `a`, `theta_offset`, `d`, `beta`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Alpha => "alpha",
            Self::A => "a",
            Self::Theta => "theta_offset",
            Self::D => "d",
            Self::Beta => "beta",
        }
    }
}

/// The five numbers of one MD-H link, SI units: a nominal link or a correction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MdhParameters<T> {
    /// Link twist alpha_{i-1} about x, rad.
    pub alpha: T,
    /// Link length a_{i-1} along x, m.
    pub a: T,
    /// Joint offset about z, rad.
    pub theta: T,
    /// Link offset d_i along z, m.
    pub d: T,
    /// Hayati's rotation beta_i about y, rad.
    pub beta: T,
}

impl<T: Scalar> MdhParameters<T> {
    /// As `[alpha, a, theta, d, beta]`, the order of [`LinkParameter::ALL`].
    #[must_use]
    pub const fn to_array(&self) -> [T; 5] {
        [self.alpha, self.a, self.theta, self.d, self.beta]
    }

    /// From `[alpha, a, theta, d, beta]`.
    #[must_use]
    pub const fn from_array([alpha, a, theta, d, beta]: [T; 5]) -> Self {
        Self { alpha, a, theta, d, beta }
    }

    /// Element-wise sum: nominal parameters plus identified corrections.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            alpha: self.alpha + other.alpha,
            a: self.a + other.a,
            theta: self.theta + other.theta,
            d: self.d + other.d,
            beta: self.beta + other.beta,
        }
    }
}

/// One link of the modified Denavit-Hartenberg convention with Hayati's beta:
/// `A_i = Rx(alpha) Tx(a) Rz(theta + q) Tz(d) Ry(beta)`, or `Tz(d + q)` for a
/// prismatic joint (paper Eq. 1).
///
/// Eq. 2 of the paper prints this product with two wrong entries: row 3,
/// column 1 reads `s_alpha c_beta s_t - c_alpha c_beta` where the product gives
/// `s_alpha c_beta s_t - c_alpha s_beta`, and row 3, column 4 reads
/// `d s_alpha` where it gives `d c_alpha`. truearm builds from Eq. 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Link<T> {
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// The five lengths and angles.
    pub parameters: MdhParameters<T>,
}

impl<T: Scalar> Link<T> {
    /// A revolute link.
    #[must_use]
    pub const fn revolute(alpha: T, a: T, theta: T, d: T, beta: T) -> Self {
        Self { kind: JointKind::Revolute, parameters: MdhParameters { alpha, a, theta, d, beta } }
    }

    /// A prismatic link; `theta` is its fixed angle, `d` its offset at q = 0.
    #[must_use]
    pub const fn prismatic(alpha: T, a: T, theta: T, d: T, beta: T) -> Self {
        Self { kind: JointKind::Prismatic, parameters: MdhParameters { alpha, a, theta, d, beta } }
    }

    /// Adds corrections to each link. Of slices, whose length the optimiser does
    /// not know: what is done once is not unrolled.
    #[inline(never)]
    pub(crate) fn correct(links: &mut [Self], corrections: &[MdhParameters<T>]) {
        for (link, correction) in links.iter_mut().zip(corrections) {
            *link = link.corrected(correction);
        }
    }

    /// The same joint with identified corrections added.
    #[must_use]
    pub fn corrected(&self, correction: &MdhParameters<T>) -> Self {
        Self { kind: self.kind, parameters: self.parameters.plus(correction) }
    }
}
