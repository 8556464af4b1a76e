use super::link::JointKind;

/// One joint on the way from the tool to the base, and the constant way to the
/// joint behind it: `Rz(angle) T(offset) Rx(twist)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<T> {
    /// Revolute: the angle is `q + theta`. Prismatic: it is `theta`, and the joint
    /// slides by `q` along z.
    pub kind: JointKind,
    /// Constant part of the angle, rad.
    pub theta: T,
    /// Sine and cosine of `theta`: all that a prismatic joint turns.
    pub constant_turn: [T; 2],
    /// Sine and cosine of the twist about x; of the last joint without meaning.
    pub twist: [T; 2],
    /// From this axis to the next, m, in the frame turned with the joint; of the
    /// last joint without meaning.
    pub offset: [T; 3],
}
