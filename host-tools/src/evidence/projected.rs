//! Candidates with geometry projected out.

use nalgebra::{DMatrix, DVector};

use super::geometry::Geometry;
use super::gram::{Gram, lower_product};
use super::noise::Noise;

/// Share of a column's square that must survive the projection; below it is
/// the rounding of the projection and the column counts as one of geometry's.
const SEEN: f64 = 1e-8;

/// Candidates and residual with geometry projected out, in units of the noise
/// scale k: `C = Z'PZ`, `b = Z'Py`, `s = y'Py`, `P = I - G H^-1 G'`.
#[derive(Debug, Clone)]
pub struct Projected {
    /// `Z'PZ`.
    pub c: DMatrix<f64>,
    /// `Z'Py`.
    pub b: DVector<f64>,
    /// `y'Py`.
    pub s: f64,
    /// Diagonal of `Z'Z`, before the projection.
    pub full: DVector<f64>,
    /// How much a sum of squares left over says.
    pub noise: Noise,
    /// Noise scale k that everything is divided by.
    pub scale: f64,
}

impl Projected {
    /// The same without some columns, of which none stands twice.
    #[must_use]
    pub fn without(self, columns: &[usize]) -> Self {
        let mut gone = columns.to_vec();
        gone.sort_unstable();
        Self {
            c: self.c.remove_columns_at(&gone).remove_rows_at(&gone),
            b: self.b.remove_rows_at(&gone),
            full: self.full.remove_rows_at(&gone),
            ..self
        }
    }
}

impl Gram {
    /// Everything projected off geometry.
    #[must_use]
    pub fn project(&self, geometry: &Geometry) -> Projected {
        self.projected((geometry, self.noise(geometry)), (&self.gz, &self.zz), &self.zy)
    }

    /// Some columns, in this order, projected off geometry; the noise is told apart, as it
    /// takes longer than a few columns do.
    #[must_use]
    pub fn project_some(&self, of: (&Geometry, Noise), columns: &[usize]) -> Projected {
        let gz = self.gz.select_columns(columns);
        let own = |i: usize, j: usize| self.product(columns[i], columns[j]);
        let zz = DMatrix::from_fn(columns.len(), columns.len(), own);
        self.projected(of, (&gz, &zz), &self.zy.select_rows(columns))
    }

    fn projected(
        &self,
        (geometry, noise): (&Geometry, Noise),
        (gz, zz): (&DMatrix<f64>, &DMatrix<f64>),
        zy: &DVector<f64>,
    ) -> Projected {
        let k2 = geometry.scale * geometry.scale;
        let v = geometry.whiten(gz);
        let vy = geometry.whiten(&DMatrix::from_column_slice(self.gy.len(), 1, self.gy.as_slice()));
        let vy = vy.column(0);
        let mut c = zz / k2;
        lower_product(&mut c, -1.0, v.transpose().as_view(), v.as_view());
        c.fill_upper_triangle_with_lower_triangle();
        let mut b = zy / k2 - v.tr_mul(&vy);
        let full = zz.diagonal() / k2;
        for j in 0..c.ncols() {
            if c[(j, j)] <= SEEN * full[j] {
                c.column_mut(j).fill(0.0);
                c.row_mut(j).fill(0.0);
                b[j] = 0.0;
            }
        }
        Projected {
            c,
            b,
            s: (self.yy / k2 - vy.norm_squared()).max(0.0),
            full,
            noise,
            scale: geometry.scale,
        }
    }
}
