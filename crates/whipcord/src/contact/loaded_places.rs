//! The cross-sections that contacts push, each once: several contacts may push one.

use core::cmp::Ordering;

use whipcord_numerics::{Twist, Vec3};

/// Where pushes act; `T` is how a model names a cross-section.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedPlaces<T> {
    /// Each once, in order.
    places: Vec<T>,
    /// The number in these of each push.
    of_push: Vec<usize>,
}

impl<T: Copy + PartialOrd> LoadedPlaces<T> {
    /// The places of these pushes; whether they are others than before.
    pub fn set(&mut self, of_pushes: &[T]) -> bool {
        let Self { places, of_push } = self;
        let before = core::mem::take(places);
        places.extend_from_slice(of_pushes);
        // Arc lengths are finite, and nodes are counted: all have an order.
        places.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
        places.dedup();
        of_push.clear();
        of_push.extend(of_pushes.iter().map(|place| places.partition_point(|other| other < place)));
        *places != before
    }

    /// Each place once, in order.
    pub fn places(&self) -> &[T] {
        &self.places
    }

    /// The number in these of each push.
    pub fn of_pushes(&self) -> &[usize] {
        &self.of_push
    }

    /// How the cross-sections of the pushes move with each component of each push, by rows, and how with the step that is
    /// left: from the motion of place i with the component c of a wrench on place j, `by_wrench(6 j + c, i)`, and with the
    /// step.
    pub fn compliance(
        &self,
        by_wrench: impl Fn(usize, usize) -> Twist,
        by_step: impl Fn(usize) -> Twist,
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        let rates = |Twist { linear, angular }: Twist| {
            let parts = [linear, angular].map(<[f64; 3]>::from);
            core::array::from_fn::<f64, 6, _>(|a| parts[a / 3][a % 3])
        };
        let mut columns: Vec<[f64; 6]> = Vec::with_capacity(6 * self.places.len());
        for &place in &self.of_push {
            drift.extend(rates(by_step(place)));
            columns.clear();
            columns
                .extend((0..6 * self.places.len()).map(|wrench| rates(by_wrench(wrench, place))));
            for a in 0..6 {
                for &other in &self.of_push {
                    compliance.extend(columns[6 * other..6 * other + 6].iter().map(|x| x[a]));
                }
            }
        }
    }

    /// The forces that changes of the pushes beyond a place add up to.
    pub fn beyond(&self, place: T, changes: &[[f64; 6]]) -> Vec3 {
        let pushed = self.of_push.iter().zip(changes);
        let beyond = pushed.filter(|(number, _)| self.places[**number] > place);
        beyond.fold(Vec3::ZERO, |sum, (_, [x, y, z, ..])| sum + Vec3::new(*x, *y, *z))
    }

    /// What changes of the pushes add up to, for each component on each place.
    pub fn totals(&self, changes: &[[f64; 6]]) -> Vec<f64> {
        let mut totals = vec![0.0; 6 * self.places.len()];
        for (&place, change) in self.of_push.iter().zip(changes) {
            let of_place = &mut totals[6 * place..6 * place + 6];
            of_place.iter_mut().zip(change).for_each(|(sum, change)| *sum += change);
        }
        totals
    }
}
