//! All poles of a system in which the weights of a few squares change. In: a system and the change. Out: the enclosed poles for many
//! values of the parameter. See docs/method/studies.md#one-weight-and-all-poles and #a-few-weights-and-all-poles.

use super::updates::{self, Changing, Part, ROUNDING_OF_CHANGE};
use crate::analysis::{self, Feedback, Request, WeighedRow, separate};
use crate::base::Ball;
use crate::kernel::low_rank::LowRank;
use crate::kernel::rank_one::{self, Eigenvalue, Factor, RankOne};
use crate::system::LinearSystem;

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// A system near one of its cases.
#[derive(Clone, Debug)]
pub struct PoleUpdates {
    /// Parts in which weights change.
    parts: Vec<Moving>,
    /// The poles of all others.
    still: Vec<Eigenvalue>,
}

/// A part that nothing couples with others.
#[derive(Clone, Debug)]
struct Moving {
    /// What a change of the parameter is as a factor: that of a weight of this matrix with this slope.
    part: Part,
    slope: Ball,
    /// For a weight of M, what the acceleration feeds back at once for a weight of 1.
    direct: Ball,
    matrix: Matrix,
}

/// By the number of rows that are weighed.
#[derive(Clone, Debug)]
enum Matrix {
    One(RankOne),
    Two(LowRank<2>),
    Three(LowRank<3>),
    Four(LowRank<4>),
}

impl PoleUpdates {
    /// `end` is the change of the parameter with the largest magnitude, and all changes have its sign. `None` if more rows of a part
    /// change than a few, or the poles at the base are not known well enough.
    pub fn of(base: &LinearSystem, changing: &[Changing], end: f64) -> Option<PoleUpdates> {
        if base.losses.is_some() || base.is_chained() || changing.is_empty() {
            return None;
        }
        let mut found = PoleUpdates { parts: Vec::new(), still: Vec::new() };
        let mut placed = 0;
        for (coordinates, part) in separate(base) {
            let local = |row: &[(usize, Ball)]| {
                let place = |(at, a): &(usize, Ball)| coordinates.binary_search(&(*at as u32)).ok().map(|at| (at, *a));
                row.iter().map(place).collect::<Option<Vec<(usize, Ball)>>>()
            };
            let mut rows: Vec<(usize, WeighedRow)> = Vec::new();
            for of in changing {
                let Some(entries) = local(&of.row) else { continue };
                placed += 1;
                let at = rows.iter().position(|(number, _)| *number == of.number).unwrap_or_else(|| {
                    rows.push((of.number, WeighedRow { entries, slopes: [Ball::ZERO; 3] }));
                    rows.len() - 1
                });
                let slope = &mut rows[at].1.slopes[power(of.part)];
                *slope = if slope.is_zero() { of.slope } else { *slope + of.slope };
            }
            let rows: Vec<WeighedRow> = rows.into_iter().map(|(_, row)| row).collect();
            match rows.is_empty() {
                true => found.still.extend(poles_of(&part)?),
                false => found.parts.push(Moving::of(&part, rows, end)?),
            }
        }
        // A row over several parts couples them.
        (placed == changing.len()).then_some(found)
    }

    /// The change up to which relative bounds are at most `accuracy`, where that was tried.
    pub fn reach(&self, accuracy: f64) -> f64 {
        let reach = |part: &Moving| part.reach(accuracy);
        let least = |a: f64, b: f64| if a.abs() < b.abs() { a } else { b };
        self.parts.iter().map(reach).reduce(least).unwrap_or(0.0)
    }

    /// The poles for each change of the parameter in the order of `analyze`; `None` where they are not all enclosed. A change may have
    /// an error of [`ROUNDING_OF_CHANGE`].
    pub fn poles(&self, changes: &[f64]) -> Vec<Option<Vec<Eigenvalue>>> {
        let mut all = self.parts.iter().map(|part| part.poles(changes));
        let mut found = all.next().unwrap_or_default();
        if self.parts.len() == 1 && self.still.is_empty() {
            return found;
        }
        for list in all {
            for (found, more) in found.iter_mut().zip(list) {
                *found = found.take().zip(more).map(|(found, more)| [found, more].concat());
            }
        }
        for list in found.iter_mut().flatten() {
            list.extend(&self.still);
            rank_one::sort(list);
        }
        found
    }
}

/// That of the derivative which a weight is of.
fn power(part: Part) -> usize {
    match part {
        Part::Stiffness => 0,
        Part::Damping => 1,
        Part::Mass => 2,
    }
}

/// All poles of a part in which nothing changes, if they are proved to be all.
fn poles_of(part: &LinearSystem) -> Option<Vec<Eigenvalue>> {
    let modes = analysis::modes_as(part, &Request::default().without_shares()).ok()?;
    let poles = analysis::poles(part, &modes).ok()?;
    let are_all = poles.count.is_some() && poles.left_out == 0 && poles.list.len() == 2 * part.n();
    are_all.then(|| poles.list.iter().map(|pole| Eigenvalue::of(pole.re, pole.im)).collect())
}

impl Moving {
    fn of(system: &LinearSystem, mut rows: Vec<WeighedRow>, end: f64) -> Option<Moving> {
        let count = rows.len();
        let (mut part, mut slope) = (Part::Stiffness, Ball::ONE);
        if let [row] = &mut rows[..] {
            // One row has one factor: that of its mass, which feeds itself back, or else of what it has.
            let of = [Part::Mass, Part::Stiffness, Part::Damping];
            part = of.into_iter().find(|part| !row.slopes[power(*part)].is_zero())?;
            slope = row.slopes[power(part)];
            for (at, own) in row.slopes.iter_mut().enumerate().filter(|(_, own)| !own.is_zero()) {
                *own = if at == power(part) { Ball::ONE } else { *own / slope };
            }
        }
        let feedback = Feedback::of(system, &rows, end.signum())?;
        let direct = if count == 1 { feedback.direct[0][0] } else { Ball::ZERO };
        let end = factor(slope, direct, part, end).0;
        let columns = &feedback.columns;
        let matrix = match count {
            1 => {
                let (b, w) = (columns.b[0].iter(), columns.w[0].iter());
                let poles =
                    columns.poles.iter().zip(b.zip(w)).map(|(s, (b, v))| rank_one::Pole { s: *s, b: *b, v: *v });
                let off = [columns.off.always, columns.off.once];
                Matrix::One(RankOne::new(&poles.collect::<Vec<_>>(), off, end)?)
            }
            2 => Matrix::Two(LowRank::new(columns, end)?),
            3 => Matrix::Three(LowRank::new(columns, end)?),
            4 => Matrix::Four(LowRank::new(columns, end)?),
            _ => return None,
        };
        Some(Moving { part, slope, direct, matrix })
    }

    fn reach(&self, accuracy: f64) -> f64 {
        let rho = match &self.matrix {
            Matrix::One(matrix) => matrix.reach(accuracy),
            Matrix::Two(matrix) => matrix.reach(accuracy),
            Matrix::Three(matrix) => matrix.reach(accuracy),
            Matrix::Four(matrix) => matrix.reach(accuracy),
        };
        let weight = match self.part {
            Part::Stiffness | Part::Damping => rho,
            Part::Mass => rho / (1.0 - rho * self.direct.to_f64()),
        };
        weight / self.slope.to_f64()
    }

    fn poles(&self, changes: &[f64]) -> Vec<Option<Vec<Eigenvalue>>> {
        let of = |change: &f64| {
            let (rho, error) = factor(self.slope, self.direct, self.part, *change);
            Factor::new(rho, error)
        };
        let factors: Vec<Factor> = changes.iter().map(of).collect();
        match &self.matrix {
            Matrix::One(matrix) => matrix.eigenvalues(&factors),
            Matrix::Two(matrix) => matrix.eigenvalues(&factors),
            Matrix::Three(matrix) => matrix.eigenvalues(&factors),
            Matrix::Four(matrix) => matrix.eigenvalues(&factors),
        }
    }
}

/// The factor in the equation of the poles, and a bound of its relative error.
fn factor(slope: Ball, direct: Ball, part: Part, change: f64) -> (f64, f64) {
    let weight = change * slope.to_f64();
    let error = slope.relative_error() + 2.0 * U + ROUNDING_OF_CHANGE + 2.0 * U;
    match part {
        Part::Stiffness | Part::Damping => (weight, error),
        // M falls by the negative of the weight.
        Part::Mass => {
            let (rho, error) = updates::of_mass(-weight, error, direct);
            (-rho, error)
        }
    }
}
