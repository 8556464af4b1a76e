//! An oracle that shares no code with the crate: Eq. 1 as a product of five
//! 4x4 matrices, generic so that dual numbers run through it. And robots.

#![allow(dead_code, reason = "each test file uses a part")]

pub mod ur10;

use num_dual::DualNum;
use truearm::{JointKind, Link, MdhParameters};

/// f64 or a dual number over it.
pub trait Number: DualNum<Primitive = f64> + Copy {}
impl<D: DualNum<Primitive = f64> + Copy> Number for D {}

pub type Matrix<D> = [[D; 4]; 4];

pub fn identity<D: Number>() -> Matrix<D> {
    let mut m = [[D::from(0.0); 4]; 4];
    (0..4).for_each(|i| m[i][i] = D::from(1.0));
    m
}

pub fn product<D: Number>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
    let mut m = [[D::from(0.0); 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            for k in 0..4 {
                m[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    m
}

pub fn rotation<D: Number>(axis: usize, angle: D) -> Matrix<D> {
    let mut m = identity();
    let (s, c) = angle.sin_cos();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    m[j][j] = c;
    m[k][k] = c;
    m[j][k] = -s;
    m[k][j] = s;
    m
}

pub fn translation<D: Number>(v: [D; 3]) -> Matrix<D> {
    let mut m = identity();
    (0..3).for_each(|i| m[i][3] = v[i]);
    m
}

/// Eq. 1 for one link; `p` is alpha, a, theta, d, beta.
pub fn link<D: Number>(kind: JointKind, p: [D; 5], q: f64) -> Matrix<D> {
    let o = D::from(0.0);
    let (theta, d) = match kind {
        JointKind::Revolute => (p[2] + D::from(q), p[3]),
        JointKind::Prismatic => (p[2], p[3] + D::from(q)),
    };
    let mut m = product(&rotation(0, p[0]), &translation([p[1], o, o]));
    m = product(&m, &rotation(2, theta));
    m = product(&m, &translation([o, o, d]));
    product(&m, &rotation(1, p[4]))
}

/// Tool pose of a chain. `x` holds 5 N link parameters, base rotation vector
/// increments (applied about x, then y, then z of the outer frame, which at
/// zero has the derivative of a rotation vector), base translation, tool point.
pub fn forward<D: Number>(
    kinds: &[JointKind],
    base: &Matrix<f64>,
    x: &[D],
    q: &[f64],
) -> Matrix<D> {
    let n = kinds.len();
    let (links, outer) = x.split_at(5 * n);
    let mut turn = rotation(0, outer[0]);
    turn = product(&rotation(1, outer[1]), &turn);
    turn = product(&rotation(2, outer[2]), &turn);
    let mut m = base.map(|row| row.map(D::from));
    let origin = [m[0][3], m[1][3], m[2][3]];
    (0..3).for_each(|i| m[i][3] = D::from(0.0));
    m = product(&turn, &m);
    (0..3).for_each(|i| m[i][3] = origin[i] + outer[3 + i]);
    for i in 0..n {
        let p = core::array::from_fn(|k| links[5 * i + k]);
        m = product(&m, &link(kinds[i], p, q[i]));
    }
    product(&m, &translation([outer[6], outer[7], outer[8]]))
}

fn links<const N: usize>(rows: [[f64; 5]; N]) -> [Link<f64>; N] {
    rows.map(|p| Link { kind: JointKind::Revolute, parameters: MdhParameters::from_array(p) })
}

const H: f64 = core::f64::consts::FRAC_PI_2;

/// UR10 with corrections, three parallel axes.
pub fn ur10() -> [Link<f64>; 6] {
    links(ur10::UR10)
}

/// A spherical-wrist arm of 1 m reach, in the manner of a PUMA 560.
pub fn puma() -> [Link<f64>; 6] {
    links([
        [0.0, 0.0, 0.0, 0.2, 0.0],
        [-H, 0.0, 0.0, 0.1435, 0.0],
        [0.0, 0.4318, 0.0, -0.0934, 0.001],
        [H, -0.0203, 0.0, 0.4331, 0.0],
        [-H, 0.0, 0.0, 0.0, 0.0],
        [H, 0.0, 0.0, 0.056, 0.0],
    ])
}

/// A SCARA: four parallel axes, the third prismatic.
pub fn scara() -> [Link<f64>; 4] {
    let mut arm = links([
        [0.0, 0.0, 0.0, 0.4, 0.001],
        [0.002, 0.35, 0.1, 0.0, 0.0],
        [3.1, 0.3, 0.3, 0.05, -0.002],
        [0.0, 0.01, 0.0, 0.02, 0.0],
    ]);
    arm[2].kind = JointKind::Prismatic;
    arm
}

/// The UR10 on a horizontal rail: seven joints, the first prismatic.
pub fn ur10_on_a_rail() -> [Link<f64>; 7] {
    let rail = [H, 0.05, -0.2, 0.3, 0.0005];
    let [mut first, second, third, fourth, fifth, sixth] = ur10().map(|l| l.parameters.to_array());
    first[0] -= H;
    let mut arm = links([rail, first, second, third, fourth, fifth, sixth]);
    arm[0].kind = JointKind::Prismatic;
    arm
}
