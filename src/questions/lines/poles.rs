//! The poles of cases on a line: each of a few of them is the base of those behind it, up to where bounds are too wide or poles meet.

use super::FEW;
use super::changing::changing;
use super::steps::{Range, Steps};
use crate::base::Ball;
use crate::kernel::bounded::Bounded;
use crate::kernel::rank_one::Eigenvalue;
use crate::questions::cases::Study;
use crate::questions::pole_updates::PoleUpdates;
use crate::questions::rows::Enclosures;
use crate::questions::updates::Part;

/// What the poles of a line come from.
#[derive(Clone, Debug)]
pub enum OfPoles {
    /// Nothing damps the system of so many coordinates: the frequencies.
    Frequencies(usize),
    /// In ascending order; other cases are computed one by one.
    Stretches(Vec<Stretch>),
}

/// Cases that follow a base.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The first and the last place on the line.
    places: [u64; 2],
    updates: PoleUpdates,
    steps: Steps,
}

/// Limit on the bases of a line, each of which takes longer than a case.
const MOST_BASES: u64 = 16;

impl Study<'_> {
    /// `None` if it is not known what the poles come from.
    pub(super) fn poles_of_line(&self, first: u64, range: &Range) -> Option<OfPoles> {
        let over = self.over(first, range, true)?;
        if over.losses.is_some() || 2 * over.n() != self.sizes.1 {
            return None;
        }
        if over.c.is_empty() {
            return Some(OfPoles::Frequencies(over.n()));
        }
        let parts = [Part::Stiffness, Part::Damping, Part::Mass];
        let last = range.count() - 1;
        let (mut list, mut at, mut gap) = (Vec::new(), range.first, (last / 1000).max(1));
        for _ in 0..(range.count() / FEW).min(MOST_BASES) {
            let Some((base, steps)) = range.base(at) else { break };
            let system = self.system(first, base, true)?;
            let end = range.end_from(&steps);
            let changing = changing(&over, &system, &parts);
            let updates = changing.and_then(|changing| PoleUpdates::of(&system, &changing, end));
            let reach = updates.as_ref().map_or(0.0, |updates| updates.reach(self.accuracy()) / end);
            // In floating point: a case that is beyond is computed by itself.
            let behind = (reach * (last - at) as f64) as u64;
            match updates {
                Some(updates) if behind > 0 => {
                    let end = (at + behind).min(last);
                    list.push(Stretch { places: [at, end], updates, steps });
                    at = end;
                }
                _ => (at, gap) = (at + gap, 4 * gap),
            }
            if at + FEW > last {
                break;
            }
        }
        (!list.is_empty()).then_some(OfPoles::Stretches(list))
    }

    /// Sets the columns of poles from one place on; `known` becomes NaN where not all of them are accurate enough.
    pub(super) fn poles_of(
        &self,
        found: &[Option<Vec<Eigenvalue>>],
        at: usize,
        columns: &mut [Enclosures],
        known: &mut [f64],
    ) {
        for (i, poles) in found.iter().enumerate() {
            let is_accurate = |poles: &&Vec<Eigenvalue>| {
                poles.len() == self.sizes.1 && poles.iter().all(|pole| pole.is_accurate(self.accuracy()))
            };
            let Some(poles) = poles.as_ref().filter(is_accurate) else {
                known[i] = f64::NAN;
                continue;
            };
            let parts = poles.iter().flat_map(|Eigenvalue { s, bounds }| [(s.re, bounds[0]), (s.im, bounds[1])]);
            for (column, (x, bound)) in columns.iter_mut().zip(parts) {
                column.set(at + i, Ball::from(x).widen(bound));
            }
        }
    }

    /// The same from the eigenvalues of systems that nothing damps.
    pub(super) fn undamped_poles(&self, found: &Bounded, at: usize, columns: &mut [Enclosures], known: &mut [f64]) {
        for (i, columns) in columns.chunks_exact_mut(4).enumerate().take(found.count()) {
            let [re, below, re_too, above] = columns else { continue };
            for re in [re, re_too] {
                (at..re.high.len()).for_each(|place| re.set(place, Ball::ZERO));
            }
            found.roots(i, 1.0, self.accuracy(), (&mut above.high[at..], &mut above.radius[at..]));
            above.low[at..].fill(0.0);
            for (i, place) in (at..above.high.len()).enumerate() {
                let omega = above.get(place);
                known[i] += 0.0 * omega.mid.hi;
                below.set(place, if omega.is_zero() { omega } else { -omega });
            }
        }
    }
}

/// The poles of the cases at these places of a line, where they are known.
pub fn poles(list: &[Stretch], places: &[u64]) -> Vec<Option<Vec<Eigenvalue>>> {
    let stretch = |place: &u64| list.partition_point(|stretch| stretch.places[1] < *place);
    let mut found = Vec::with_capacity(places.len());
    for some in places.chunk_by(|a, b| stretch(a) == stretch(b)) {
        match list.get(stretch(&some[0])) {
            Some(Stretch { updates, steps, .. }) => found.extend(updates.poles(&steps.changes(some))),
            None => found.extend(some.iter().map(|_| None)),
        }
    }
    found
}
