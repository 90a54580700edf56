//! The transfer function at a frequency at which Q(s) is exactly singular, in rational arithmetic: at s = 0 with rigid
//! motions, and at an undamped natural frequency that is a rational number of rad/s.
//!
//! x = Q^-1 B is expanded in powers of the distance z from that frequency: z = s at rest, z = s^2 + omega^2 at a resonance
//! (nothing damps there, so Q depends on s^2 alone). H is infinite if a negative power of z is left in it; otherwise it is
//! the constant term. See docs/method/transfer.md.

use crate::analysis::transfer::{Disc, Frequency, Gain};
use crate::base::{Number, Rational};
use crate::kernel::complex::Complex;
use crate::kernel::dense::echelon::{Rationals, null_vectors, reduce};
use crate::system::LinearSystem;

/// For more coordinates than this, exact elimination takes too long.
const MOST_COORDINATES: usize = 40;

/// Rows of fractions.
type Matrix = Vec<Vec<Rational>>;
type Row = Vec<Rational>;

/// Replaces unknown gains by exact ones if all numbers needed are rational.
pub(in crate::analysis) fn solve(
    system: &LinearSystem,
    frequency: &Frequency,
    inputs: &[usize],
    outputs: &[usize],
    gains: &mut [Vec<Gain>],
) {
    let Some(place) = Place::of(frequency, system) else { return };
    let Some(pencil) = place.pencil(system) else { return };
    let load = |&input: &usize| place.powers(&system.inputs[input].b, system.n(), |i| i.index())?.if_even();
    let loads: Vec<Option<[Row; 3]>> = inputs.iter().map(load).collect();
    let Some(series) = pencil.series(&loads.iter().flatten().collect::<Vec<_>>()) else { return };
    let known = gains.iter_mut().zip(inputs).zip(&loads).filter(|(_, load)| load.is_some());
    for (((gains, &input), _), x) in known.zip(&series) {
        for (&output, gain) in outputs.iter().zip(gains) {
            let output = &system.outputs[output];
            let p = place.powers(&output.p, system.n(), |i| i.index());
            let d = place.powers(&output.d, system.inputs.len(), |input| *input as usize);
            let limit = |p: &[Row; 3], d: &[Row; 3]| x.limit(p, &d[0][input]);
            if let (Some(p), Some(d)) = (p, d) {
                *gain = match (limit(&p.even, &d.even), limit(&p.odd, &d.odd)) {
                    (Some(even), Some(odd)) => finite(&even, &(&odd * place.omega())),
                    _ => Gain::Infinite,
                };
            }
        }
    }
}

fn finite(re: &Rational, im: &Rational) -> Gain {
    Gain::Finite(Disc::of(Complex { re: re.to_ball(), im: im.to_ball() }))
}

/// The frequency about which everything is expanded.
enum Place {
    /// s = 0; powers of z = s.
    Rest,
    /// s = i `omega`, and powers of z = s^2 + omega^2.
    Resonance { omega: Rational },
}

/// A polynomial in s as even + s odd. At rest there is no odd part: z is s itself.
struct Powers {
    even: [Row; 3],
    odd: [Row; 3],
}

impl Powers {
    fn if_even(self) -> Option<[Row; 3]> {
        self.odd.iter().all(|row| is_zero(row)).then_some(self.even)
    }
}

impl Place {
    /// `None` if Q is too large, or does not depend on powers of z alone.
    fn of(frequency: &Frequency, system: &LinearSystem) -> Option<Place> {
        let omega = frequency.exact()?.exact()?.clone();
        let place = if omega.is_zero() { Place::Rest } else { Place::Resonance { omega } };
        let is_even = matches!(place, Place::Rest) || system.c.is_empty();
        (is_even && system.n() <= MOST_COORDINATES).then_some(place)
    }

    fn omega(&self) -> &Rational {
        match self {
            Place::Rest => &Rational::ZERO,
            Place::Resonance { omega } => omega,
        }
    }

    /// `None` if a number is not rational.
    fn pencil(&self, system: &LinearSystem) -> Option<Pencil> {
        let n = system.n();
        let [m, c, k] = [&system.m, &system.c, &system.k].map(|form| form.rational_entries(n));
        let q = match self {
            Place::Rest => [k?, c?, m?],
            Place::Resonance { omega } => {
                let (m, mut q) = (m?, k?);
                let square = -&(omega * omega);
                q.iter_mut().zip(&m).for_each(|(q, m)| add(q, &square, m));
                [q, m, vec![vec![Rational::ZERO; n]; n]]
            }
        };
        Some(Pencil { q })
    }

    /// v_0 + s v_1 + s^2 v_2 in powers of z, as dense vectors; `None` if a number is not rational.
    fn powers<Index>(
        &self,
        sparse: &[Vec<(Index, Number)>; 3],
        length: usize,
        place: impl Fn(&Index) -> usize,
    ) -> Option<Powers> {
        let dense = |entries: &[(Index, Number)]| -> Option<Row> {
            let mut dense = vec![Rational::ZERO; length];
            for (index, value) in entries {
                let entry = &mut dense[place(index)];
                *entry = &*entry + value.exact()?;
            }
            Some(dense)
        };
        let zero = || vec![Rational::ZERO; length];
        let [mut v0, v1, v2] = [dense(&sparse[0])?, dense(&sparse[1])?, dense(&sparse[2])?];
        Some(match self {
            Place::Rest => Powers { even: [v0, v1, v2], odd: [zero(), zero(), zero()] },
            Place::Resonance { omega } => {
                add(&mut v0, &-&(omega * omega), &v2);
                Powers { even: [v0, v2, zero()], odd: [v1, zero(), zero()] }
            }
        })
    }
}

/// Q = q_0 + z q_1 + z^2 q_2
struct Pencil {
    q: [Matrix; 3],
}

/// The first powers of x = Q^-1 B for one input: those of z^-2, z^-1 and 1.
struct Series([Row; 3]);

impl Series {
    /// The limit of p x + d at z = 0; `None` if it is infinite.
    fn limit(&self, p: &[Row; 3], d: &Rational) -> Option<Rational> {
        let Series([x2, x1, x0]) = self;
        let is_finite = dot(&p[0], x2).is_zero() && (&dot(&p[0], x1) + &dot(&p[1], x2)).is_zero();
        is_finite.then(|| &(&dot(&p[0], x0) + &dot(&p[1], x1)) + &(&dot(&p[2], x2) + d))
    }
}

impl Pencil {
    /// The series of each input; `None` if q_0 is regular, Q is singular everywhere, or Q^-1 has a pole of a higher order
    /// than two.
    ///
    /// Comparing powers of z in Q x = B gives q_0 x_t = b_t - q_1 x_(t-1) - q_2 x_(t-2) for t = -2, -1, ... Each of these
    /// determines x_t but for null vectors of q_0, with amplitudes a_t, and requires that the left null vectors see nothing
    /// of its right-hand side. The requirements of t = -1 to 2 are solved for a_-2 to a_1. If they leave x_-2, x_-1 or x_0
    /// open, there is an x that begins with one of these powers while Q x begins with z^3: Q^-1 has a pole of the third
    /// order or higher. If not, the solution is Q^-1 B, which satisfies them all.
    fn series(&self, loads: &[&[Row; 3]]) -> Option<Vec<Series>> {
        const LAST: usize = 4;
        let n = self.q[0].len();
        let statics = Statics::of(&self.q[0]);
        let nullity = statics.null.len();
        let (needed, unknowns) = (3 * nullity, LAST * nullity);
        if nullity == 0 {
            return None;
        }
        // The entries of forces and motions are affine: a column for each amplitude, and one for each load.
        let mut motions: Vec<Matrix> = Vec::new();
        let mut requirements: Matrix = Vec::new();
        for step in 0..LAST {
            let mut force = vec![vec![Rational::ZERO; unknowns + loads.len()]; n];
            for (column, load) in loads.iter().enumerate().filter(|_| step >= 2) {
                force.iter_mut().zip(&load[step - 2]).for_each(|(row, b)| row[unknowns + column] = b.clone());
            }
            for (q, motion) in self.q[1..].iter().zip(motions.iter().rev()) {
                force.iter_mut().zip(q).for_each(|(row, q)| subtract(row, &combined(q, motion)));
            }
            requirements.extend(statics.left_null.iter().map(|vector| combined(vector, &force)));
            if step + 1 < LAST {
                motions.push(statics.answer(&force, step * nullity));
            } else {
                requirements.extend(self.last_requirements(&statics, &force, &motions, loads));
            }
        }
        let amplitudes = settled(requirements, needed, unknowns)?;
        let value = |row: &Row, load: usize| &dot(row, &amplitudes[load]) + &row[unknowns + load];
        let power = |load: usize, step: usize| motions[step].iter().map(|row| value(row, load)).collect();
        Some((0..loads.len()).map(|load| Series([0, 1, 2].map(|step| power(load, step)))).collect())
    }

    /// The requirements of z^2 from the force of z^1. The motion under it has long fractions; only what the left null
    /// vectors see of it is computed.
    fn last_requirements(&self, statics: &Statics, force: &Matrix, motions: &[Matrix], loads: &[&[Row; 3]]) -> Matrix {
        let [_, q1, q2] = &self.q;
        let first = force[0].len() - loads.len();
        let of_vector = |vector: &Row| {
            let (seen, before) = (combined(vector, q1), combined(vector, q2));
            let mut row = vec![Rational::ZERO; force[0].len()];
            row.iter_mut().skip(first).zip(loads).for_each(|(entry, load)| *entry = dot(vector, &load[2]));
            subtract(&mut row, &combined(&statics.seen_of_answers(&seen), force));
            for (amplitude, vector) in row[first - statics.null.len()..].iter_mut().zip(&statics.null) {
                *amplitude = &*amplitude - &dot(&seen, vector);
            }
            if let Some(motion) = motions.last() {
                subtract(&mut row, &combined(&before, motion));
            }
            row
        };
        statics.left_null.iter().map(of_vector).collect()
    }
}

/// How q_0 answers forces.
struct Statics {
    null: Matrix,
    left_null: Matrix,
    /// For each coordinate at rest but for null motions, the row of a generalised inverse of q_0; the others stay at zero.
    inverse: Vec<(usize, Row)>,
}

impl Statics {
    fn of(q: &Matrix) -> Statics {
        let n = q.len();
        let unit = |i: usize| (0..n).map(move |j| if i == j { Rational::ONE } else { Rational::ZERO });
        let mut rows: Matrix =
            q.iter().enumerate().map(|(i, row)| row.iter().cloned().chain(unit(i)).collect()).collect();
        let pivots = reduce(&Rationals, &mut rows, n);
        let mut factors = rows.into_iter().map(|row| row[n..].to_vec());
        Statics {
            null: null_vectors(q),
            inverse: pivots.into_iter().zip(&mut factors).collect(),
            left_null: factors.collect(),
        }
    }

    /// The row with which `seen` of an answer depends on the force.
    fn seen_of_answers(&self, seen: &[Rational]) -> Row {
        let (seen, rows): (Row, Matrix) =
            self.inverse.iter().map(|(coordinate, row)| (seen[*coordinate].clone(), row.clone())).unzip();
        combined(&seen, &rows)
    }

    /// The motions under forces that the left null vectors do not see, and null motions whose amplitudes begin at `first`.
    fn answer(&self, force: &Matrix, first: usize) -> Matrix {
        let width = force.first().map_or(0, Vec::len);
        let mut motion = vec![vec![Rational::ZERO; width]; force.len()];
        for (coordinate, factors) in &self.inverse {
            motion[*coordinate] = combined(factors, force);
        }
        for (number, vector) in self.null.iter().enumerate() {
            motion.iter_mut().zip(vector).for_each(|(row, v)| row[first + number] = v.clone());
        }
        motion
    }
}

/// For each load, the unknowns that make all requirements zero, if the first `needed` are determined; those after them may
/// not be, and are zero.
fn settled(mut requirements: Matrix, needed: usize, unknowns: usize) -> Option<Matrix> {
    let width = requirements.first()?.len();
    let pivots = reduce(&Rationals, &mut requirements, unknowns);
    let (determining, rest) = requirements.split_at(pivots.len());
    let is_determined = pivots.get(needed - 1) == Some(&(needed - 1))
        && determining[..needed].iter().all(|row| is_zero(&row[needed..unknowns]));
    if !is_determined || rest.iter().any(|row| !is_zero(&row[unknowns..])) {
        return None;
    }
    let of_load = |column: usize| {
        let mut values = vec![Rational::ZERO; unknowns];
        pivots.iter().zip(determining).for_each(|(&pivot, row)| values[pivot] = -&row[column]);
        values
    };
    Some((unknowns..width).map(of_load).collect())
}

fn is_zero(row: &[Rational]) -> bool {
    row.iter().all(Rational::is_zero)
}

/// The sum of the products of entries, as many as there are in both.
fn dot(a: &[Rational], b: &[Rational]) -> Rational {
    let terms = a.iter().zip(b).filter(|(a, b)| !a.is_zero() && !b.is_zero());
    terms.fold(Rational::ZERO, |sum, (a, b)| &sum + &(a * b))
}

/// row + factor other
fn add(row: &mut [Rational], factor: &Rational, other: &[Rational]) {
    for (entry, other) in row.iter_mut().zip(other).filter(|(_, other)| !other.is_zero()) {
        *entry = &*entry + &(factor * other);
    }
}

fn subtract(row: &mut [Rational], other: &[Rational]) {
    add(row, &-&Rational::ONE, other);
}

/// The sum of rows with factors.
fn combined(factors: &[Rational], rows: &Matrix) -> Row {
    let mut sum = vec![Rational::ZERO; rows.first().map_or(0, Vec::len)];
    for (factor, row) in factors.iter().zip(rows).filter(|(factor, _)| !factor.is_zero()) {
        add(&mut sum, factor, row);
    }
    sum
}
