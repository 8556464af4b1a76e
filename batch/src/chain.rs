//! The chain as its user sees it.

use thiserror::Error;
use truearm::{Chain, Link, MAX_JOINTS, Pose};

use crate::cpu::Cpu;
use crate::lanes::Lanes;
use crate::walk::{Batch, Constants};

/// A serial chain ready for many poses at once: base, 1 to [`MAX_JOINTS`] links, tool.
#[derive(Debug, Clone)]
pub struct BatchChain<T> {
    constants: Constants<T>,
    cpu: Cpu,
}

/// Tool points, m, in the frame the base is given in: a slice a coordinate, as long
/// as those of the joints.
#[derive(Debug)]
pub struct Positions<'a, T> {
    /// x of every pose, m.
    pub x: &'a mut [T],
    /// y of every pose, m.
    pub y: &'a mut [T],
    /// z of every pose, m.
    pub z: &'a mut [T],
}

/// Tool poses in the frame the base is given in.
#[derive(Debug)]
pub struct Poses<'a, T> {
    /// The points.
    pub positions: Positions<'a, T>,
    /// `rotation[row][column]`: that entry of the rotation matrix of every pose; the
    /// columns are the axes of the tool.
    pub rotation: [[&'a mut [T]; 3]; 3],
}

/// Why a batch was not computed. Nothing was written then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BatchError {
    /// A chain has 1 to [`MAX_JOINTS`] joints.
    #[error("an arm has 1 to {MAX_JOINTS} joints, not {0}")]
    Joints(usize),
    /// Another number of slices of joint values than of joints.
    #[error("joint values of {found} joints for an arm with {expected}")]
    Columns {
        /// Joints of the chain.
        expected: usize,
        /// Slices that were given.
        found: usize,
    },
    /// A slice of joint values or results that is not as long as the first joint's.
    #[error("a slice of {found} numbers beside {expected} values of the first joint")]
    Length {
        /// Values of the first joint.
        expected: usize,
        /// Numbers in the other slice.
        found: usize,
    },
}

/// `BatchChain::of` for a number of joints known only now.
macro_rules! by_number {
    ($links:expr, $base:expr, $tool:expr, $($n:literal)*) => {
        match $links.len() {
            $($n => <&[Link<T>; $n]>::try_from($links)
                .map_or(Err(BatchError::Joints($n)), |links| {
                    Ok(Self::of(&Chain::new(links, $base, $tool)))
                }),)*
            other => Err(BatchError::Joints(other)),
        }
    };
}

impl<T: Lanes> BatchChain<T> {
    /// Folds `links`, the pose of the robot base and the pose of the tool in the last
    /// frame, as [`Chain::new`] does.
    ///
    /// # Errors
    /// [`BatchError::Joints`]: no link, or more than [`MAX_JOINTS`].
    pub fn new(links: &[Link<T>], base: Pose<T>, tool: Pose<T>) -> Result<Self, BatchError> {
        by_number!(links, base, tool, 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
    }

    /// The same poses as `chain`'s. Of an identified arm that is
    /// [`truearm::Arm::real`].
    #[must_use]
    pub fn of<const N: usize>(chain: &Chain<T, N>) -> Self {
        const { assert!(N >= 1 && N <= MAX_JOINTS, "an arm has 1 to 16 joints") };
        let walk = chain.walk();
        let constants = Constants { tip: walk.tip, steps: walk.steps.to_vec(), root: walk.root };
        Self { constants, cpu: Cpu::best() }
    }

    /// The same chain by other instructions, for tests and timings.
    #[must_use]
    pub fn on(self, cpu: Cpu) -> Self {
        Self { cpu, ..self }
    }

    /// The instructions it is computed with.
    #[must_use]
    pub fn cpu(&self) -> Cpu {
        self.cpu
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.constants.steps.len()
    }

    /// Tool points at joint values `q`: a slice a joint, the first joint first, rad
    /// (revolute) or m (prismatic). NaN where a joint value is none or, in `f32`,
    /// 8192 rad and more, as in [`Chain::forward`].
    ///
    /// # Errors
    /// [`BatchError::Columns`], [`BatchError::Length`]: shapes that do not agree.
    pub fn positions(&self, q: &[&[T]], out: Positions<'_, T>) -> Result<(), BatchError> {
        let out = [out.x, out.y, out.z];
        self.check(q, &out)?;
        self.cpu.run(Batch { constants: &self.constants, q, out });
        Ok(())
    }

    /// Tool points and orientations; the rest as in [`Self::positions`].
    ///
    /// # Errors
    /// [`BatchError::Columns`], [`BatchError::Length`]: shapes that do not agree.
    pub fn poses(&self, q: &[&[T]], out: Poses<'_, T>) -> Result<(), BatchError> {
        let Positions { x, y, z } = out.positions;
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = out.rotation;
        let out = [x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz];
        self.check(q, &out)?;
        self.cpu.run(Batch { constants: &self.constants, q, out });
        Ok(())
    }

    fn check(&self, q: &[&[T]], out: &[&mut [T]]) -> Result<(), BatchError> {
        if q.len() != self.joints() {
            return Err(BatchError::Columns { expected: self.joints(), found: q.len() });
        }
        let expected = q.first().map_or(0, |q| q.len());
        let lengths = q.iter().map(|q| q.len()).chain(out.iter().map(|out| out.len()));
        match lengths.into_iter().find(|found| *found != expected) {
            Some(found) => Err(BatchError::Length { expected, found }),
            None => Ok(()),
        }
    }
}
