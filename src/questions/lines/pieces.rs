//! Lines along which M and K change in any smooth way: with lengths, places and angles, with the rest, or by weights that are not linear.
//! On each of a few pieces of the line both matrices are polynomials in the parameter, with a bound of what these leave out. See
//! docs/method/studies.md#pieces.

use super::steps::{Range, Steps};
use super::{FEW, Of, PER_TURN};
use crate::base::number::jet;
use crate::base::number::series::{ORDER, Series};
use crate::base::{Ball, Jet, Number, up};
use crate::kernel::bounded::Bounded;
use crate::kernel::pencils::{self, Eigenvalues};
use crate::model::Points;
use crate::questions::cases::Study;
use crate::system::Form;

/// Neighbouring cases with one polynomial for each matrix.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The first and the last place on the line.
    places: [u64; 2],
    /// From the value in the middle.
    steps: Steps,
    /// The largest distance from it, SI.
    reach: f64,
    pencils: pencils::Line,
    /// Whether the polynomials leave out no more than roundings do.
    is_fine: bool,
}

/// The pieces of a line, in ascending order.
#[derive(Clone, Debug)]
pub struct Pieces {
    pub n: usize,
    list: Vec<Piece>,
}

/// What a polynomial may leave out of an entry, relative to the diagonal, so that roundings weigh as much.
const FINE: f64 = 1e-15;

/// The part of a range that is taken as near to a value: narrower than all steps but the smallest of a search.
const NEAR: f64 = 1e-6;

/// Coefficients below this share of the diagonal are left out with the rest.
const NEGLIGIBLE: f64 = 1e-18;

impl Study<'_> {
    pub(super) fn pieces_of_line(&self, first: u64, range: &Range, of: Of) -> Option<Pieces> {
        if !matches!(range.swept.points, Points::Even { .. }) {
            return None;
        }
        let last = range.count() - 1;
        let mut pieces = Pieces { n: 0, list: Vec::new() };
        let (mut at, mut width, mut in_a_row) = (range.first, range.count() - range.first, 0);
        // Where the narrowest piece fails the next one would most likely fail, too: cases left out, twice as many each time in a row.
        let mut left_out = 0;
        // Making a piece takes as long as some cases.
        for _ in 0..16 + range.count() / 32 {
            if at + FEW > last + 1 {
                break;
            }
            width = width.min(last + 1 - at);
            let halved = width / 2 >= FEW;
            match self.piece(first, range, [at, at + width - 1], of) {
                Some(piece) if piece.is_fine || !halved => {
                    pieces.n = piece.pencils.n;
                    pieces.list.push(piece);
                    at += width;
                    (in_a_row, left_out) = (in_a_row + 1, 0);
                    // As wide as the one before is most likely right again.
                    if in_a_row % 4 == 0 {
                        width *= 2;
                    }
                }
                _ if halved => (width, in_a_row) = (width / 2, 0),
                _ => {
                    left_out = width.max(2 * left_out);
                    at += left_out;
                }
            }
        }
        (!pieces.list.is_empty()).then_some(pieces)
    }

    fn piece(&self, first: u64, range: &Range, places: [u64; 2], of: Of) -> Option<Piece> {
        let points = &range.swept.points;
        // As far as the next piece, so that the step to it is known, too.
        let next = (places[1] + 1).min(range.count() - 1);
        let middle = places[0] + (next - places[0]).div_ceil(2);
        let at = points.value(middle);
        let away = |place: u64| (&points.value(place) - &at).to_ball().magnitude();
        let reach = away(places[0]).max(away(next)) * (1.0 + 32.0 * f64::EPSILON);
        let Polynomials { pencils, is_fine } = self.polynomials(first, (&at, reach), of)?;
        let piece = Piece { places, steps: range.steps_from(&at, Some(middle)), reach, pencils, is_fine };
        let lowest = of.lowest;
        let found = piece.eigenvalues(&[places[0], middle, places[1]]);
        let is_accurate = |i: usize| (0..3).all(|case| self.root(found.pair(i, case), PER_TURN).is_some());
        (0..lowest.min(piece.pencils.n)).all(is_accurate).then_some(piece)
    }

    /// Both matrices about a value of the last parameter, as far as the reach.
    fn polynomials(&self, first: u64, (at, reach): (&Number, f64), of: Of) -> Option<Polynomials> {
        // Poles are those of the frequencies if nothing damps.
        let is_damped = of.poles > 0;
        let along = Jet::of_parameter_in_series(at.to_ball(), reach);
        let over = jet::without_division(|| self.lower_case(first, along, is_damped))??;
        // A search at any of these values has to find the rest that is known along them.
        if over.rest.may_be_elsewhere() {
            return None;
        }
        let system = of.part(over.system)?;
        let n = system.n();
        let fits = (1..=pencils::MOST).contains(&n) && !system.is_chained();
        let fits = fits && !(is_damped && (!system.c.is_empty() || system.losses.is_some() || 2 * n != of.poles));
        let (k, m) = if fits { (matrix(&system.k, n)?, matrix(&system.m, n)?) } else { return None };
        let pencils = pencils::Line::new(n, &k.terms, &m.terms, 1.0)?;
        Some(Polynomials { pencils, is_fine: k.is_fine && m.is_fine })
    }

    /// Whether the matrices of all coordinates or of a class are polynomials about one of two values of the last parameter at all, however
    /// near to it: not where the search might find another rest.
    pub(in crate::questions) fn has_polynomials(&self, [low, high]: [&Number; 2], class: Option<&[u32]>) -> bool {
        let reach = (high - low).to_ball().magnitude() * NEAR;
        let about = |at: &Number| self.polynomials(0, (at, reach), Of { class, lowest: 0, poles: 0 }).is_some();
        about(low) || about(high)
    }

    /// Enclosures of the eigenvalues for all values of the last parameter between two, of all coordinates or of a class.
    pub(in crate::questions) fn eigenvalues_between(
        &self,
        [low, high]: [&Number; 2],
        class: Option<&[u32]>,
    ) -> Option<Eigenvalues> {
        let at = &(low + high) / &Number::from(2);
        let away = |end: &Number| (end - &at).to_ball().magnitude();
        let reach = away(low).max(away(high)) * (1.0 + 32.0 * f64::EPSILON);
        let Polynomials { pencils, .. } = self.polynomials(0, (&at, reach), Of { class, lowest: 0, poles: 0 })?;
        pencils.eigenvalues(&[0.0], &[1.0]).pop()?
    }
}

/// Matrices that are polynomials in a part of a reach.
struct Polynomials {
    pencils: pencils::Line,
    /// Whether they leave out no more than roundings do.
    is_fine: bool,
}

impl Piece {
    fn eigenvalues(&self, places: &[u64]) -> Bounded {
        let x = self.parts_of_reach(places);
        self.pencils.side_by_side(&x, &vec![0.0; x.len()])
    }

    /// Changes of the parameter as parts of the reach, each [`pencils::ROUNDING_OF_D`] off at most.
    fn parts_of_reach(&self, places: &[u64]) -> Vec<f64> {
        self.steps.changes(places).iter().map(|change| change / self.reach).collect()
    }

    /// Enclosures of the eigenvalues over the steps from these places, which lie on the piece, to the next ones.
    fn over_steps(&self, places: &[u64]) -> Bounded {
        let next: Vec<u64> = places.iter().map(|place| place + 1).collect();
        let ends = [places, &next].map(|places| self.parts_of_reach(places));
        let pairs = || ends[0].iter().zip(&ends[1]);
        let middle: Vec<f64> = pairs().map(|(a, b)| 0.5 * (a + b)).collect();
        // Both ends may be off, and the middle and the half are rounded.
        let half = |(a, b): (&f64, &f64)| {
            (0.5 * (b - a).abs() + 2.0 * pencils::ROUNDING_OF_D * a.abs().max(b.abs())) * up::FEW
        };
        let half: Vec<f64> = pairs().map(half).collect();
        self.pencils.side_by_side(&middle, &half)
    }

    /// Enclosures of the eigenvalues for all values between two, if both lie on the piece.
    fn eigenvalues_over(&self, ends: [&Number; 2]) -> Option<Eigenvalues> {
        let [a, b] = ends.map(|end| self.steps.distance_of(end) * Ball::from(1.0 / self.reach));
        let middle = ((a + b) * Ball::from(0.5)).to_f64();
        let half = (a - Ball::from(middle)).magnitude().max((b - Ball::from(middle)).magnitude()) * up::FEW;
        // The reciprocal was rounded, and the reach is larger than that of the values by more than this.
        (middle.abs() + half <= 1.0 - 8.0 * f64::EPSILON)
            .then(|| self.pencils.eigenvalues(&[middle], &[half * up::FEW]))
            .and_then(|mut found| found.pop()?)
    }
}

impl Pieces {
    /// Enclosures of the eigenvalues for all values between two, if one piece holds both.
    pub fn eigenvalues_over(&self, ends: [&Number; 2]) -> Option<Eigenvalues> {
        self.list.iter().find_map(|piece| piece.eigenvalues_over(ends))
    }

    /// The eigenvalues at these places, where they are known.
    pub fn eigenvalues(&self, places: &[u64]) -> Bounded {
        self.of_pieces(places, Piece::eigenvalues)
    }

    /// Enclosures of the eigenvalues over the steps from these places to the next ones, where they are known.
    pub fn over_steps(&self, places: &[u64]) -> Bounded {
        self.of_pieces(places, Piece::over_steps)
    }

    fn of_pieces(&self, places: &[u64], of: fn(&Piece, &[u64]) -> Bounded) -> Bounded {
        let piece = |place: &u64| self.list.partition_point(|piece| piece.places[1] < *place);
        let mut found = Bounded::unknown(self.n, places.len());
        let mut at = 0;
        for some in places.chunk_by(|a, b| piece(a) == piece(b)) {
            if let Some(own) = self.list.get(piece(&some[0])) {
                let before = some.iter().take_while(|place| **place < own.places[0]).count();
                found.copy_from(at + before, &of(own, &some[before..]));
            }
            at += some.len();
        }
        found
    }
}

/// A matrix as a polynomial.
struct Matrix {
    /// The first one holds what the polynomial leaves out, too.
    terms: Vec<Vec<Vec<Ball>>>,
    is_fine: bool,
}

/// `None` if an entry is not known as a series.
fn matrix(form: &Form, n: usize) -> Option<Matrix> {
    let rows = form.entries(n);
    let series = |row: &Vec<Number>| row.iter().map(Series::of).collect::<Option<Vec<Series>>>();
    let entries: Vec<Vec<Series>> = rows.iter().map(series).collect::<Option<_>>()?;
    if !entries.iter().flatten().all(Series::is_finite) {
        return None;
    }
    let size = |i: usize, j: usize| (entries[i][i].magnitude() * entries[j][j].magnitude()).sqrt();
    let places = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let is_needed = |at: &usize| places().any(|(i, j)| entries[i][j].terms[*at].magnitude() > NEGLIGIBLE * size(i, j));
    let count = (0..ORDER).rev().find(is_needed).map_or(1, |at| at + 1);
    let left_out = |entry: &Series| {
        let beyond: f64 = entry.terms[count..].iter().map(Ball::magnitude).sum();
        (beyond + entry.rest) * up::DOZENS
    };
    let entry =
        |at: usize, entry: &Series| if at == 0 { entry.terms[0].widen(left_out(entry)) } else { entry.terms[at] };
    let term = |at: usize| entries.iter().map(|row| row.iter().map(|own| entry(at, own)).collect()).collect();
    let is_fine = places().all(|(i, j)| left_out(&entries[i][j]) <= FINE * size(i, j));
    Some(Matrix { terms: (0..count).map(term).collect(), is_fine })
}
