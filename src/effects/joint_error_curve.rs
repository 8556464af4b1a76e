//! A smooth error of a joint's angle over a turn, `theta += f(q)`: what of gears,
//! bearings and encoders follows no order. A curve is a table of nodes, borrowed
//! from the blob that carries it and not copied into an arm.
//!
//! A node is a coefficient of a uniform periodic cubic B-spline (de Boor, *A Practical
//! Guide to Splines*, 1978): nodes stand at `2 pi k / n`, and between the nodes `k`
//! and `k + 1` four count, `k - 1` to `k + 2`, with weights that are not negative and
//! sum to one. So a curve stays between its smallest and its largest node, rounding
//! the nodes to a step changes it by half a step at most, and its slope and curvature
//! have no jumps, which joints would follow.
//!
//! Error of 256 nodes, relative to the standard deviation of a random smooth curve of
//! the length scale 2 degrees (`tests/kinematics/error_curves.rs`); a spline takes 93 instructions of a
//! tick on a Cortex-M4F, its slope included:
//!
//! | between nodes | nodes from samples | nodes by least squares |
//! |---|---|---|
//! | lines | 7.4 % | 4.4 % |
//! | cubics through the nodes (Catmull-Rom) | 3.1 % | 2.5 % |
//! | cubic B-spline | 1.2 % | 0.9 % |

use crate::scalar::Scalar;

/// Bytes of a curve before its nodes: joint, exponent of the number of nodes, whether it
/// has [`Gaps`], one of 0, step and band.
pub(crate) const HEAD: usize = 12;
/// Powers of two that a number of nodes may be.
pub(crate) const EXPONENTS: core::ops::RangeInclusive<u8> = 5..=9;

/// Nodes that count between two of them.
const TAPS: usize = 4;
const TURNS_PER_RADIAN: f64 = 0.5 * core::f64::consts::FRAC_1_PI;

/// The error of one joint's angle over a turn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Curve<'t> {
    head: &'t [u8; HEAD],
    nodes: &'t [[u8; 2]],
    gaps: Option<Gaps<'t>>,
}

/// Where between its nodes a curve is guessed and not known: no measured angle was near.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gaps<'t> {
    band: [u8; 4],
    known: &'t [u8],
}

impl<'t> Gaps<'t> {
    /// With this standard deviation where nothing is known, rad, and a bit for each stretch
    /// between two nodes, the lowest of the first byte for the one behind node 0: set where
    /// the curve is known.
    #[must_use]
    pub const fn new(band: f32, known: &'t [u8]) -> Self {
        Self { band: band.to_le_bytes(), known }
    }

    /// One standard deviation of the curve where it is not known, rad.
    #[must_use]
    pub const fn band(&self) -> f32 {
        f32::from_le_bytes(self.band)
    }

    /// The bits, see [`Self::new`].
    #[must_use]
    pub const fn known(&self) -> &'t [u8] {
        self.known
    }
}

/// All of an arm's curves, at most one a joint, as the bytes of the blob that carries
/// them.
///
/// Without the feature `curves` there are none: a blob that has some is refused, and
/// no controller pays for what its arm does not have.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub struct Curves<'t> {
    bytes: &'t [u8],
}

impl<'t> Curve<'t> {
    /// What the effect is called in reports and files.
    pub const NAME: &'static str = "joint-error-curve";
    /// Nodes of a turn, unless there is a reason for others: a length scale of 2 to 4
    /// degrees, as gears have it, needs them.
    pub const USUAL_NODES: usize = 256;

    /// The joint, counted from 0.
    #[must_use]
    pub const fn joint(&self) -> u8 {
        self.head[0]
    }

    /// What one unit of a node is, rad.
    #[must_use]
    pub const fn step(&self) -> f32 {
        let [_, _, _, _, a, b, c, d, ..] = *self.head;
        f32::from_le_bytes([a, b, c, d])
    }

    /// One standard deviation of the curve where it is known, rad.
    #[must_use]
    pub const fn band(&self) -> f32 {
        let [_, _, _, _, _, _, _, _, a, b, c, d] = *self.head;
        f32::from_le_bytes([a, b, c, d])
    }

    /// Where it is not known; `None` where no stretch of a turn is said to be so.
    #[must_use]
    pub const fn gaps(&self) -> Option<Gaps<'t>> {
        self.gaps
    }

    /// Whether it is known at encoder reading `q`, rad, of any number of turns that leaves an
    /// angle: one that has gaps is known nowhere beyond 2^22 nodes (in `f32`; 1e5 rad of 256 a
    /// turn), nor at what is no number.
    #[must_use]
    #[inline(never)]
    pub fn knows<T: Scalar>(&self, q: T) -> bool {
        let Some(gaps) = &self.gaps else { return true };
        let place = q * per_radian(self.nodes.len());
        let (below, _) = place.floor_and_rest();
        // Where its low bits mean something; a NaN is not below, either.
        let within = place.abs() < T::from_f32(0.5) / T::EPSILON;
        let stretch = below as usize & self.nodes.len().wrapping_sub(1);
        within && gaps.known.get(stretch / 8).is_some_and(|bits| bits >> (stretch % 8) & 1 != 0)
    }

    /// One standard deviation of the curve at encoder reading `q`, rad.
    #[must_use]
    pub fn band_at<T: Scalar>(&self, q: T) -> f32 {
        match &self.gaps {
            Some(gaps) if !self.knows(q) => gaps.band(),
            _ => self.band(),
        }
    }

    /// Nodes of a turn, the first at angle 0, in steps.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = i16> + use<'t> {
        self.nodes.iter().map(|node| i16::from_le_bytes(*node))
    }

    /// What is added to the joint's angle at encoder reading `q`, rad; of any number
    /// of turns within 2^22 nodes in `f32` (1e5 rad of 256 a turn), 2^51 in `f64`. Without meaning
    /// beyond.
    #[must_use]
    pub fn at<T: Scalar>(&self, q: T) -> T {
        let [value, _] = self.value_and_slope(q);
        value
    }

    /// Which nodes count at encoder reading `q` (rad) of a table of so many nodes, a
    /// power of two, and with which weights: the derivative of the curve to its nodes.
    #[must_use]
    pub fn weights<T: Scalar>(nodes: usize, q: T) -> [(usize, T); TAPS] {
        let (below, x) = (q * per_radian(nodes)).floor_and_rest();
        let place = |offset: u32| below.wrapping_add(offset) as usize & nodes.wrapping_sub(1);
        let sixth = |value: T| value * T::from_f64(1.0 / 6.0);
        let c = T::from_f32;
        let y = T::ONE - x;
        [
            (place(u32::MAX), sixth(y * y * y)),
            (place(0), sixth(c(4.0) + x * x * (c(3.0) * x - c(6.0)))),
            (place(1), sixth(c(4.0) + y * y * (c(3.0) * y - c(6.0)))),
            (place(2), sixth(x * x * x)),
        ]
    }

    /// The curve at `q` and how it changes with `q`.
    #[inline]
    fn value_and_slope<T: Scalar>(&self, q: T) -> [T; 2] {
        let per_radian = per_radian(self.nodes.len());
        let (below, x) = (q * per_radian).floor_and_rest();
        let node = |offset: u32| {
            let place = below.wrapping_add(offset) as usize & self.nodes.len().wrapping_sub(1);
            self.nodes.get(place).map_or(0, |node| i32::from(i16::from_le_bytes(*node)))
        };
        let [a, b, c, d] = [node(u32::MAX), node(0), node(1), node(2)];
        // Six times the cubic's coefficients, below 2^19: exact.
        let whole = |value: i32| T::from_f32(value as f32);
        let constant = whole(a + 4 * b + c);
        let linear = whole(3 * (c - a));
        let square = whole(3 * (a - 2 * b + c));
        let cube = whole(d - a + 3 * (b - c));
        let sixth = T::from_f32(self.step()) * T::from_f64(1.0 / 6.0);
        // Horner's rule, and once more over what it gives on the way.
        let steep = x * cube;
        let inner = square + steep;
        let outer = linear + x * inner;
        let value = constant + x * outer;
        let slope = outer + x * (inner + steep);
        [value * sixth, slope * (sixth * per_radian)]
    }
}

/// Nodes of a radian.
#[inline]
fn per_radian<T: Scalar>(nodes: usize) -> T {
    T::from_f64(TURNS_PER_RADIAN) * T::from_f32(nodes as f32)
}

impl<'t> Curves<'t> {
    /// No curves.
    pub const NONE: Self = Self { bytes: &[] };

    /// Of bytes that have been checked.
    pub(crate) const fn of_checked(bytes: &'t [u8]) -> Self {
        Self { bytes }
    }

    /// Whether there is none.
    // Known without the feature: what asks for it is compiled only with it.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        !cfg!(feature = "curves") || self.bytes.is_empty()
    }

    /// The bytes as a blob holds them.
    #[must_use]
    pub const fn as_bytes(&self) -> &'t [u8] {
        self.bytes
    }

    /// One after the other, by joint.
    pub fn iter(&self) -> impl Iterator<Item = Curve<'t>> + use<'t> {
        let mut rest = if self.is_empty() { &[] } else { self.bytes };
        core::iter::from_fn(move || {
            let (curve, behind) = first(rest)?;
            rest = behind;
            Some(curve)
        })
    }

    /// Whether some curve is not known everywhere.
    #[must_use]
    pub fn have_gaps(&self) -> bool {
        self.iter().any(|curve| curve.gaps.is_some())
    }

    /// Whether all curves are known at joint values `q`, rad.
    // Cold: most arms have no gaps.
    #[cold]
    #[inline(never)]
    #[must_use]
    pub fn know<T: Scalar, const N: usize>(&self, q: &[T; N]) -> bool {
        let known = |curve: &Curve| q.get(usize::from(curve.joint())).map(|q| curve.knows(*q));
        self.iter().all(|curve| known(&curve) == Some(true))
    }

    /// The curve of a joint, counted from 0.
    #[must_use]
    pub fn of_joint(&self, joint: u8) -> Option<Curve<'t>> {
        self.iter().find(|curve| curve.joint() == joint)
    }

    /// Adds the curves at joint values `q` to what bends the `joints`, and to `slopes`
    /// by how much they change with their own joint.
    // One copy serves poses and ticks.
    #[inline(never)]
    pub(crate) fn add<T: Scalar, const N: usize>(
        &self,
        q: &[T; N],
        joints: &mut [T; N],
        slopes: &mut [T; N],
    ) {
        for curve in self.iter() {
            let joint = usize::from(curve.joint());
            let places = (joints.get_mut(joint), slopes.get_mut(joint), q.get(joint));
            if let (Some(bend), Some(slope), Some(q)) = places {
                let [value, change] = curve.value_and_slope(*q);
                *bend += value;
                *slope += change;
            }
        }
    }
}

/// The first curve of these bytes and what is behind it; none where they end before it.
#[inline]
pub(crate) fn first(bytes: &[u8]) -> Option<(Curve<'_>, &[u8])> {
    let (head, rest) = bytes.split_first_chunk::<HEAD>()?;
    let nodes = 1_usize.checked_shl(u32::from(head[1]))?;
    let (nodes, mut rest) = rest.split_at_checked(nodes.checked_mul(2)?)?;
    let (nodes, _) = nodes.as_chunks();
    let mut gaps = None;
    if head[2] != 0 {
        let (band, behind) = rest.split_first_chunk()?;
        let (known, behind) = behind.split_at_checked(nodes.len() / 8)?;
        gaps = Some(Gaps { band: *band, known });
        rest = behind;
    }
    Some((Curve { head, nodes, gaps }, rest))
}

impl core::fmt::Debug for Curve<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let mut shown = f.debug_struct("Curve");
        shown.field("joint", &self.joint()).field("nodes", &self.nodes.len());
        shown.field("step", &self.step()).field("band", &self.band());
        shown.field("gaps", &self.gaps.is_some()).finish()
    }
}

impl core::fmt::Debug for Curves<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// What they are, not their nodes.
#[cfg(feature = "defmt")]
impl defmt::Format for Curves<'_> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Curves {{ bytes: {=usize} }}", self.bytes.len());
    }
}
