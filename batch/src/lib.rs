//! Forward kinematics of [`truearm`] for many poses at once, by the SIMD
//! instructions of the processor it runs on.
//!
//! Joint values are a structure of arrays, one slice a joint; so are the
//! results. Every pose gets **the same bits as [`truearm::Chain::forward`]**, on
//! every processor and wherever it stands among the others: products are never
//! fused, sums never reordered, and sine and cosine are those of the crate's
//! [`truearm::Scalar`] (of `libm` in `f64`), operation by operation. So the error
//! bounds of the scalar crate are those of the batch, and nothing that uses the
//! one may tell it from the other. (The sign of a NaN, and of a zero where a joint
//! value *and* its constant angle are both -0.0, are left open.)
//!
//! ```
//! use truearm::{Chain, Link, Pose};
//! use truearm_batch::{BatchChain, Positions};
//!
//! # fn main() -> Result<(), truearm_batch::BatchError> {
//! let links = [
//!     Link::revolute(0.0, 0.0, 0.0, 0.4, 0.0),
//!     Link::revolute(1.5, 0.1, 0.2, 0.0, 0.001),
//!     Link::prismatic(-0.5, 0.3, 0.0, 0.1, 0.0),
//! ];
//! let tool = Pose::translation(0.0, 0.0, 0.2);
//! let batch = BatchChain::new(&links, Pose::identity(), tool)?;
//! let q: [&[f64]; 3] = [&[0.1, 0.2, 0.3], &[-1.0, 0.0, 1.0], &[0.05, 0.10, 0.15]];
//! let [mut x, mut y, mut z] = [[0.0; 3]; 3];
//! batch.positions(&q, Positions { x: &mut x, y: &mut y, z: &mut z })?;
//!
//! let alone = Chain::new(&links, Pose::identity(), tool).forward(&[0.2, 0.0, 0.10]);
//! assert_eq!([x[1], y[1], z[1]], [alone.translation.x, alone.translation.y, alone.translation.z]);
//! # Ok(())
//! # }
//! ```
//!
//! # What it covers
//!
//! The rigid chain: MD-H links with identified corrections added (see
//! [`truearm::Link::corrected`]), revolute and prismatic joints, base and tool.
//! [`BatchChain::of`] takes the folded chain of an arm as it is, [`truearm::Arm::real`].
//! Of what terms and curves do to an arm ([`truearm::kinematics::Deflection`]):
//!
//! * a bend of joints is added to the joint values before
//!   ([`truearm::kinematics::Deflection::deflected`]);
//! * the growth of links at one temperature is a chain with longer links;
//! * a tilt of the base or of a joint's axis that changes from pose to pose is not covered.

#![forbid(unsafe_code)]

mod chain;
mod cpu;
mod double;
mod lanes;
mod single;
mod vectors;
mod walk;
mod wide;

pub use chain::{BatchChain, BatchError, Poses, Positions};
pub use cpu::Cpu;
pub use lanes::Lanes;
