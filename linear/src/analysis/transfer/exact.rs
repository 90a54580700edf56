//! The transfer function at a frequency at which Q(s) is exactly singular, in rational arithmetic: at s = 0 with rigid
//! motions, and at an undamped natural frequency whose square is rational.
//!
//! Stiffnesses are often written for a frequency, as k = (2 pi f)^2 m. Then s is pi times a variable in which everything is
//! rational, but for a power of pi that is a factor of Q, of an input or of an output.
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
    let Some((place, pencil)) = Place::of(frequency, system) else { return };
    let load = |&input: &usize| place.powers(&system.inputs[input].b, system.n(), |i| i.index())?.if_even();
    let loads: Vec<Option<Powers>> = inputs.iter().map(load).collect();
    let Some(series) = pencil.series(&loads.iter().flatten().map(|load| &load.even).collect::<Vec<_>>()) else {
        return;
    };
    let known = gains.iter_mut().zip(inputs).zip(&loads).filter_map(|(asked, load)| Some((asked, load.as_ref()?)));
    for (((gains, &input), load), x) in known.zip(&series) {
        for (&output, gain) in outputs.iter().zip(gains) {
            let output = &system.outputs[output];
            let own = output.d.each_ref().map(|d| d.iter().filter(|(of, _)| *of as usize == input).cloned().collect());
            let p = place.powers(&output.p, system.n(), |i| i.index());
            let d = place.powers(&own, 1, |_| 0);
            if let (Some(p), Some(d)) = (p, d) {
                *gain = limit(&place, x, load.of_pi - pencil.of_pi, [&p, &d]);
            }
        }
    }
}

/// The limit of p x + d; x is its series times a power of pi.
fn limit(place: &Place, x: &Series, of_pi: i32, [p, d]: [&Powers; 2]) -> Gain {
    let value = |p_row: &[Row; 3], d_row: &[Row; 3]| -> Option<Number> {
        let moved = Number::from(x.limit(p_row)?).times_power_of_pi(of_pi + p.of_pi);
        Some(&moved + &Number::from(d_row[0][0].clone()).times_power_of_pi(d.of_pi))
    };
    match (value(&p.even, &d.even), value(&p.odd, &d.odd)) {
        (Some(even), Some(odd)) => {
            let odd = &odd * &place.omega;
            Gain::Finite(Disc::of(Complex { re: even.to_ball(), im: odd.to_ball() }))
        }
        _ => Gain::Infinite,
    }
}

/// The frequency about which everything is expanded, s = i `omega` pi^`unit`, in powers of z: of s / pi^`unit` at rest, and
/// of its square plus omega^2 at a resonance.
struct Place {
    omega: Number,
    /// omega^2
    square: Rational,
    unit: i32,
}

/// A polynomial in s / pi^`unit` as (even + odd s / pi^`unit`) pi^`of_pi`. At rest there is no odd part: z is the variable
/// itself.
struct Powers {
    even: [Row; 3],
    odd: [Row; 3],
    of_pi: i32,
}

impl Powers {
    fn if_even(self) -> Option<Powers> {
        self.odd.iter().all(|row| is_zero(row)).then_some(self)
    }
}

/// Numbers that are all rational times the same power of pi, and the power.
fn rational<'n>(numbers: impl Iterator<Item = &'n Number>) -> Option<(Row, i32)> {
    let mut of_pi = None;
    let one = |number: &Number| {
        let (factor, power) = number.rational_and_power_of_pi()?;
        (factor.is_zero() || *of_pi.get_or_insert(power) == power).then(|| factor.clone())
    };
    let row: Option<Row> = numbers.map(one).collect();
    Some((row?, of_pi.unwrap_or(0)))
}

impl Place {
    /// The place and Q there; `None` if Q is too large, does not depend on powers of z alone, or has numbers that are not
    /// rational in any unit of time.
    fn of(frequency: &Frequency, system: &LinearSystem) -> Option<(Place, Pencil)> {
        let omega = frequency.exact()?;
        let square = omega.square();
        let (square, power) = square.rational_and_power_of_pi()?;
        if system.n() > MOST_COORDINATES || !(square.is_zero() || system.c.is_empty()) {
            return None;
        }
        let units = if square.is_zero() { 0..=1 } else { power / 2..=power / 2 };
        units.into_iter().find_map(|unit| {
            let place = Place { omega: omega.times_power_of_pi(-unit), square: square.clone(), unit };
            let pencil = place.pencil(system)?;
            Some((place, pencil))
        })
    }

    fn is_rest(&self) -> bool {
        self.square.is_zero()
    }

    /// `None` if a number is not rational.
    fn pencil(&self, system: &LinearSystem) -> Option<Pencil> {
        let n = system.n();
        let mut entries = Vec::with_capacity(3 * n * n);
        for (power, form) in [&system.k, &system.c, &system.m].into_iter().enumerate() {
            let scaled = |entry: &Number| entry.times_power_of_pi(self.unit * power as i32);
            entries.extend(form.entries(n).iter().flatten().map(scaled));
        }
        let (entries, of_pi) = rational(entries.iter())?;
        let mut rows = entries.chunks(n.max(1)).map(<[Rational]>::to_vec);
        let [mut k, c, m] = [(); 3].map(|()| rows.by_ref().take(n).collect::<Matrix>());
        if self.is_rest() {
            return Some(Pencil { q: [k, c, m], of_pi });
        }
        let square = -&self.square;
        k.iter_mut().zip(&m).for_each(|(k, m)| add(k, &square, m));
        Some(Pencil { q: [k, m, vec![vec![Rational::ZERO; n]; n]], of_pi })
    }

    /// v_0 + s v_1 + s^2 v_2 in powers of z, as dense vectors; `None` if a number is not rational.
    fn powers<Index>(
        &self,
        sparse: &[Vec<(Index, Number)>; 3],
        length: usize,
        place: impl Fn(&Index) -> usize,
    ) -> Option<Powers> {
        let mut dense = vec![Number::ZERO; 3 * length];
        for (power, entries) in sparse.iter().enumerate() {
            for (index, value) in entries {
                let entry = &mut dense[power * length + place(index)];
                *entry = &*entry + &value.times_power_of_pi(self.unit * power as i32);
            }
        }
        let (dense, of_pi) = rational(dense.iter())?;
        let [mut v0, v1, v2] = [0, 1, 2].map(|power| dense[power * length..(power + 1) * length].to_vec());
        let zero = || vec![Rational::ZERO; length];
        if self.is_rest() {
            return Some(Powers { even: [v0, v1, v2], odd: [zero(), zero(), zero()], of_pi });
        }
        add(&mut v0, &-&self.square, &v2);
        Some(Powers { even: [v0, v2, zero()], odd: [v1, zero(), zero()], of_pi })
    }
}

/// Q = (q_0 + z q_1 + z^2 q_2) pi^`of_pi`
struct Pencil {
    q: [Matrix; 3],
    of_pi: i32,
}

/// The first powers of x = Q^-1 B for one input: those of z^-2, z^-1 and 1.
struct Series([Row; 3]);

impl Series {
    /// The limit of p x at z = 0; `None` if it is infinite.
    fn limit(&self, p: &[Row; 3]) -> Option<Rational> {
        let Series([x2, x1, x0]) = self;
        let is_finite = dot(&p[0], x2).is_zero() && (&dot(&p[0], x1) + &dot(&p[1], x2)).is_zero();
        is_finite.then(|| &(&dot(&p[0], x0) + &dot(&p[1], x1)) + &dot(&p[2], x2))
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
                force.iter_mut().zip(q).for_each(|(row, q)| subtract(row, &combine(q, motion)));
            }
            requirements.extend(statics.left_null.iter().map(|vector| combine(vector, &force)));
            if step + 1 < LAST {
                motions.push(statics.answer(&force, step * nullity));
            } else {
                requirements.extend(self.last_requirements(&statics, &force, &motions, loads));
            }
        }
        let amplitudes = settle(requirements, needed, unknowns)?;
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
            let (seen, before) = (combine(vector, q1), combine(vector, q2));
            let mut row = vec![Rational::ZERO; force[0].len()];
            row.iter_mut().skip(first).zip(loads).for_each(|(entry, load)| *entry = dot(vector, &load[2]));
            subtract(&mut row, &combine(&statics.seen_of_answers(&seen), force));
            for (amplitude, vector) in row[first - statics.null.len()..].iter_mut().zip(&statics.null) {
                *amplitude = &*amplitude - &dot(&seen, vector);
            }
            if let Some(motion) = motions.last() {
                subtract(&mut row, &combine(&before, motion));
            }
            row
        };
        statics.left_null.iter().map(of_vector).collect()
    }
}

/// The static response of q_0 to forces.
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
        combine(&seen, &rows)
    }

    /// The motions under forces that the left null vectors do not see, and null motions whose amplitudes begin at `first`.
    fn answer(&self, force: &Matrix, first: usize) -> Matrix {
        let width = force.first().map_or(0, Vec::len);
        let mut motion = vec![vec![Rational::ZERO; width]; force.len()];
        for (coordinate, factors) in &self.inverse {
            motion[*coordinate] = combine(factors, force);
        }
        for (number, vector) in self.null.iter().enumerate() {
            motion.iter_mut().zip(vector).for_each(|(row, v)| row[first + number] = v.clone());
        }
        motion
    }
}

/// For each load, the unknowns that make all requirements zero, if the first `needed` are determined; those after them may
/// not be, and are zero.
fn settle(mut requirements: Matrix, needed: usize, unknowns: usize) -> Option<Matrix> {
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
fn combine(factors: &[Rational], rows: &Matrix) -> Row {
    let mut sum = vec![Rational::ZERO; rows.first().map_or(0, Vec::len)];
    for (factor, row) in factors.iter().zip(rows).filter(|(factor, _)| !factor.is_zero()) {
        add(&mut sum, factor, row);
    }
    sum
}
