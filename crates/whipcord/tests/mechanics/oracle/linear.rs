//! Six equations in six unknowns.

use whipcord::{Mat3, Vec3};

pub type Vector6 = [f64; 6];

/// By rows. On the heap, with run-time bounds: unrolled code for matrices of a fixed 6×6 is what
/// compilers have got wrong.
pub type Matrix6 = Vec<Vec<f64>>;

pub fn norm(x: &Vector6) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

pub fn from_columns(columns: &[Vector6; 6]) -> Matrix6 {
    (0..6).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
}

pub fn diagonal(upper: Vec3, lower: Vec3) -> Matrix6 {
    let mut matrix = vec![vec![0.0; 6]; 6];
    for i in 0..3 {
        matrix[i][i] = upper[i];
        matrix[3 + i][3 + i] = lower[i];
    }
    matrix
}

pub fn add_block(matrix: &mut Matrix6, row: usize, column: usize, block: &Mat3) {
    for i in 0..3 {
        for j in 0..3 {
            matrix[row + i][column + j] += block.rows[i][j];
        }
    }
}

/// By Gaussian elimination with row exchanges; `None` when singular.
pub fn solve(matrix: &Matrix6, right: &Vector6) -> Option<Vector6> {
    let n = matrix.len();
    let mut a: Matrix6 = matrix.clone();
    let mut x: Vec<f64> = right.to_vec();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        a.swap(k, pivot);
        x.swap(k, pivot);
        if a[k][k] == 0.0 || !a[k][k].is_finite() {
            return None;
        }
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= factor * a[k][j];
            }
            x[i] -= factor * x[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            x[k] -= a[k][j] * x[j];
        }
        x[k] /= a[k][k];
    }
    x.try_into().ok()
}
