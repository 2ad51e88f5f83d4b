//! The number of directions in which a robot leaves an equilibrium that contacts without friction hold, eq. (20).

use whipcord_numerics::{DenseLu, Mat3, Vec3, rank_one_terms};

use crate::statics::eigenvalue::REGULARISATION;

/// Terms of the geometric stiffness below this part of its greatest entry are rounding.
const TERM: f64 = 1e-12;

/// A contact that pushes, linearised; wrenches and motions are those of its cross-section in the base frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PushingContact {
    /// Place of its cross-section among those of the compliance.
    pub place: usize,
    /// Its moment in N·m.
    pub moment: Vec3,
    /// `G`: how its wrench changes with the motion of its cross-section.
    pub geometric: [[f64; 6]; 6],
    /// `w`: its wrench at a normal force of 1 N.
    pub normal: [f64; 6],
}

/// Memory of the count.
#[derive(Clone, Debug, Default)]
pub(super) struct ConstrainedStability {
    compliance: Vec<f64>,
    matrix: Vec<f64>,
    lu: DenseLu,
    moves: Vec<Vec<f64>>,
    /// `U` and `B`, by columns: the place of each, its wrench and what stands on the diagonal.
    columns: Vec<Column>,
    schur: Vec<f64>,
}

/// A direction of wrenches on one cross-section.
#[derive(Clone, Copy, Debug)]
struct Column {
    contact: usize,
    wrench: [f64; 6],
    /// `1/γ` of a term of the geometric stiffness; `None` of a normal.
    inverse: Option<f64>,
}

impl ConstrainedStability {
    /// The number of unstable directions that the contacts admit, from that of the robot `alone` whose wrenches stay as they are, where
    /// dead moments count by the symmetric part of their tangent. `compliance` is that of `places` cross-sections by rows, in a
    /// scene of this length; `None` where it is singular.
    pub fn unstable_directions(
        &mut self,
        alone: usize,
        (places, compliance): (usize, &[f64]),
        contacts: &[PushingContact],
        length: f64,
    ) -> Option<usize> {
        self.gather((places, compliance), contacts, length)?;
        self.border(contacts, length);
        let terms = self.columns.iter().filter_map(|column| column.inverse);
        let negative_terms = terms.filter(|&inverse| inverse < 0.0).count();
        let negative = self.negative_directions(6 * contacts.len())?;
        (alone + negative).checked_sub(negative_terms + contacts.len())
    }

    /// The compliance of the cross-sections of the contacts, relative to the length, with the symmetric part of the
    /// moments.
    fn gather(
        &mut self,
        (places, compliance): (usize, &[f64]),
        contacts: &[PushingContact],
        length: f64,
    ) -> Option<()> {
        let n = 6 * contacts.len();
        let unit = |a: usize| if a < 3 { 1.0 / length } else { 1.0 };
        let row = |i: usize| 6 * contacts[i / 6].place + i % 6;
        let Self { compliance: own, matrix, lu, moves, .. } = self;
        own.clear();
        own.extend((0..n * n).map(|k| {
            let (i, j) = (k / n, k % n);
            compliance[row(i) * 6 * places + row(j)] * unit(i % 6) * unit(j % 6)
        }));
        if contacts.iter().any(|contact| contact.moment != Vec3::ZERO) {
            // (C⁻¹ + ½[m×])⁻¹ = (I + ½ C [m×])⁻¹ C
            matrix.clear();
            matrix.resize(n * n, 0.0);
            for i in 0..n {
                matrix[i * n + i] = 1.0;
                for (k, contact) in contacts.iter().enumerate() {
                    let at = i * n + 6 * k + 3;
                    let by = Vec3::new(own[at], own[at + 1], own[at + 2]);
                    // A row c times [m×] is (c × m)ᵀ.
                    let turned = by.cross(contact.moment) * 0.5;
                    for (b, x) in <[f64; 3]>::from(turned).into_iter().enumerate() {
                        matrix[at + b] += x;
                    }
                }
            }
            lu.factor(n, matrix).ok()?;
            moves.resize_with(n, Vec::new);
            for (j, column) in moves.iter_mut().enumerate() {
                column.clear();
                column.extend((0..n).map(|i| own[i * n + j]));
            }
            lu.solve_columns(moves);
            for (k, x) in own.iter_mut().enumerate() {
                *x = moves[k % n][k / n];
            }
        }
        own.iter().all(|x| x.is_finite()).then_some(())
    }

    /// The directions of the terms of the geometric stiffness, and of the normals.
    fn border(&mut self, contacts: &[PushingContact], length: f64) {
        let unit = |a: usize| if a < 3 { length } else { 1.0 };
        self.columns.clear();
        for (k, contact) in contacts.iter().enumerate() {
            let PushingContact { moment, geometric, .. } = contact;
            // ½[m×]
            let half_skew = Mat3::skew(*moment * 0.5);
            let entry = |a: usize, b: usize| {
                let own = if a >= 3 && b >= 3 { half_skew.column(b - 3)[a - 3] } else { 0.0 };
                (geometric[a][b] + own) * unit(a) * unit(b)
            };
            let mut symmetric: [f64; 36] =
                core::array::from_fn(|i| 0.5 * (entry(i / 6, i % 6) + entry(i % 6, i / 6)));
            let columns = &mut self.columns;
            rank_one_terms(6, &mut symmetric, TERM, |gamma, u| {
                let wrench = core::array::from_fn(|a| u[a]);
                columns.push(Column { contact: k, wrench, inverse: Some(1.0 / gamma) });
            });
        }
        for (k, contact) in contacts.iter().enumerate() {
            let wrench = core::array::from_fn(|a| contact.normal[a] * unit(a));
            self.columns.push(Column { contact: k, wrench, inverse: None });
        }
    }

    /// How many eigenvalues of `Γ⁻¹ − VᵀCV` are negative. Contacts that depend on one another count as if
    /// each of them held.
    fn negative_directions(&mut self, n: usize) -> Option<usize> {
        let Self { compliance, columns, schur, .. } = self;
        let q = columns.len();
        let product = |one: &Column, other: &Column| -> f64 {
            let rows = (0..6).map(|a| {
                let row = &compliance[(6 * one.contact + a) * n + 6 * other.contact..][..6];
                one.wrench[a] * row.iter().zip(&other.wrench).map(|(c, w)| c * w).sum::<f64>()
            });
            rows.sum()
        };
        schur.clear();
        for one in &*columns {
            schur.extend(
                columns.iter().map(|other| -0.5 * (product(one, other) + product(other, one))),
            );
        }
        // To entries of the order of one, which leaves the signs as they are.
        let sizes: Vec<f64> = (0..q)
            .map(|i| {
                let size = schur[i * q + i].abs() + columns[i].inverse.unwrap_or(0.0).abs();
                if size > 0.0 { size.sqrt() } else { 1.0 }
            })
            .collect();
        for i in 0..q {
            schur[i * q + i] += columns[i].inverse.unwrap_or(0.0);
            for j in 0..q {
                schur[i * q + j] /= sizes[i] * sizes[j];
            }
            if columns[i].inverse.is_none() {
                schur[i * q + i] -= REGULARISATION;
            }
        }
        if !schur.iter().all(|x| x.is_finite()) {
            return None;
        }
        let (mut negative, mut terms) = (0, 0);
        rank_one_terms(q, schur, f64::EPSILON, |gamma, _| {
            terms += 1;
            negative += usize::from(gamma < 0.0);
        });
        (terms == q).then_some(negative)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::random::SplitMix64;
    use whipcord_numerics::{symmetric_eigen, symmetric_eigenvalues};

    /// Of random tangents `K` of twelve coordinates whose cross-sections move with `J`, against the eigenvalues of
    /// `K − Jᵀ G J` on the coordinates that the normals admit.
    #[test]
    fn the_count_is_that_of_the_tangent_on_the_motions_that_are_admitted() {
        const N: usize = 12;
        let mut random = SplitMix64::new(3);
        let mut next = || 2.0 * random.next_part() - 1.0;
        let length = 0.3;
        let mut seen = [0; 4];
        for case in 0..300 {
            let p = 1 + case % 3;
            let m = 6 * p;
            let mut tangent = vec![0.0; N * N];
            for i in 0..N {
                for j in 0..i {
                    let x = 0.3 * next();
                    (tangent[i * N + j], tangent[j * N + i]) = (x, x);
                }
                tangent[i * N + i] = if case % 2 == 0 { 0.8 } else { 3.0 } + next();
            }
            let jacobian: Vec<f64> = (0..m * N).map(|_| next()).collect();
            let contacts: Vec<PushingContact> = (0..p)
                .map(|place| {
                    let moment = Vec3::new(next(), next(), next()) * 0.3;
                    let mut geometric = [[0.0; 6]; 6];
                    let unit = |a: usize| if a < 3 { 1.0 } else { length };
                    for a in 0..6 {
                        for b in 0..=a {
                            let x = 0.2 * next();
                            (geometric[a][b], geometric[b][a]) = (x, x);
                        }
                    }
                    // What makes the sum with the tangent under dead moments symmetric.
                    let half = moment * 0.5;
                    let skew =
                        [[0.0, -half.z, half.y], [half.z, 0.0, -half.x], [-half.y, half.x, 0.0]];
                    for a in 0..3 {
                        for b in 0..3 {
                            geometric[3 + a][3 + b] -= skew[a][b];
                        }
                    }
                    PushingContact {
                        place,
                        moment,
                        geometric,
                        normal: core::array::from_fn(|a| next() * unit(a)),
                    }
                })
                .collect();
            // The tangent under dead moments has the skew part −½ Jᵀ[m×]J.
            let mut exact = tangent.clone();
            let mut total = tangent.clone();
            for (k, contact) in contacts.iter().enumerate() {
                let half = contact.moment * 0.5;
                let skew = [[0.0, -half.z, half.y], [half.z, 0.0, -half.x], [-half.y, half.x, 0.0]];
                for i in 0..N {
                    for j in 0..N {
                        for a in 0..6 {
                            for b in 0..6 {
                                let pair =
                                    jacobian[(6 * k + a) * N + i] * jacobian[(6 * k + b) * N + j];
                                let dead = if a >= 3 && b >= 3 { skew[a - 3][b - 3] } else { 0.0 };
                                exact[i * N + j] -= pair * dead;
                                total[i * N + j] -= pair * (dead + contact.geometric[a][b]);
                            }
                        }
                    }
                }
            }
            let mut lu = DenseLu::default();
            lu.factor(N, &exact).unwrap();
            let mut columns: Vec<Vec<f64>> =
                (0..m).map(|c| (0..N).map(|i| jacobian[c * N + i]).collect()).collect();
            lu.solve_columns(&mut columns);
            let compliance: Vec<f64> = (0..m * m)
                .map(|k| (0..N).map(|i| jacobian[k / m * N + i] * columns[k % m][i]).sum())
                .collect();
            let alone = symmetric_eigenvalues(N, &mut tangent).filter(|&x| x < 0.0).count();
            let mut stability = ConstrainedStability::default();
            let found =
                stability.unstable_directions(alone, (p, &compliance), &contacts, length).unwrap();
            // The tangent with a stiff spring along each normal has as many negative directions as are admitted.
            let mut held = total;
            for (k, contact) in contacts.iter().enumerate() {
                let rate: Vec<f64> = (0..N)
                    .map(|i| {
                        (0..6).map(|a| contact.normal[a] * jacobian[(6 * k + a) * N + i]).sum()
                    })
                    .collect();
                for i in 0..N {
                    for j in 0..N {
                        held[i * N + j] += 1e7 * rate[i] * rate[j];
                    }
                }
            }
            let mut vectors = vec![0.0; N * N];
            let values: Vec<f64> = symmetric_eigen(N, &mut held, &mut vectors).collect();
            let admitted = values.iter().filter(|&&x| x < 0.0).count();
            assert_eq!(found, admitted, "{case}: {values:?}");
            seen[found.min(3)] += 1;
        }
        assert!(seen.iter().take(3).all(|&count| count > 10), "{seen:?}");
    }

    /// Two contacts with the same normal hold as one does.
    #[test]
    fn contacts_that_depend_on_one_another_hold_once() {
        let mut compliance = vec![0.0; 144];
        for i in 0..12 {
            for j in 0..12 {
                let pair = if i % 6 == j % 6 { 1.0 } else { 0.0 };
                compliance[i * 12 + j] = if i % 6 == 0 { -pair } else { pair };
            }
        }
        let contact = |place| PushingContact {
            place,
            moment: Vec3::ZERO,
            geometric: [[0.0; 6]; 6],
            normal: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        let mut stability = ConstrainedStability::default();
        let contacts = [contact(0), contact(1)];
        let found = stability.unstable_directions(1, (2, &compliance), &contacts, 1.0);
        assert_eq!(found, Some(0));
        let found = stability.unstable_directions(1, (2, &compliance), &contacts[..1], 1.0);
        assert_eq!(found, Some(0));
    }
}
