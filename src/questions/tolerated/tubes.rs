//! Eigenvalues and poles over a box of parameters. In: their enclosures, each followed from the middle of the box. Out: which of them
//! are certainly those of the least size, and which may be the one asked for. See docs/method/studies.md#tolerances.

use crate::base::number::jet;
use crate::base::{Ball, Dd, Jet, Number, up};
use crate::questions::range_enclosure::{Centre, Moved, ratio_slope};

/// Sizes that are tried as the border of the lowest.
const BORDERS: usize = 2;

/// The eigenvalues, or the poles with im s >= 0, ascending in size in the middle of a box.
pub(super) struct Tubes {
    /// `None` where one may not be simple.
    pub list: Vec<Option<Tube>>,
    /// So many of the first ones are certainly those of the least size, wherever the others are.
    pub lowest: usize,
}

/// Where an eigenvalue or a pole is for all values in a box, with its derivatives there.
pub(super) struct Tube {
    pub centre: Centre,
    pub moved: Vec<Moved>,
    /// A simple pole that is real stays so, and one that is not stays that.
    pub is_real: bool,
    /// Of a pole that is not real: its energies, with the derivatives by each parameter.
    pub energies: Vec<Option<[Number; 3]>>,
}

impl Tubes {
    /// `middles`: the sizes in the middle of the box; `is_free`: whether certainly none has a size, wherever the parameters are.
    pub fn of(list: Vec<Option<Tube>>, middles: &[Ball], is_free: impl Fn(f64) -> bool) -> Tubes {
        if list.iter().all(Option::is_some) {
            return Tubes { lowest: list.len(), list };
        }
        let upper = |ball: Ball| ball.mid.hi + ball.rad;
        let first = list.iter().map_while(Option::as_ref).map(|tube| upper(tube.size()));
        let reach: Vec<f64> =
            first.scan(0.0, |most: &mut f64, upper| Some(most.max(upper)).inspect(|all| *most = *all)).collect();
        // As no size is that of the border, so many are less everywhere as in the middle.
        let is_border = |&count: &usize| {
            let inside = reach[count - 1];
            let outside = middles[count..].iter().map(|size| size.mid.hi - size.rad).fold(f64::INFINITY, f64::min);
            let border = (inside * outside).sqrt();
            inside * up::THOUSANDS < border && border * up::THOUSANDS < outside && is_free(border)
        };
        let lowest = (1..=reach.len()).rev().take(BORDERS).find(is_border).unwrap_or(0);
        Tubes { list, lowest }
    }

    pub fn lowest(&self) -> Vec<&Tube> {
        self.list.iter().take(self.lowest).flatten().collect()
    }

    pub fn all(&self) -> Option<Vec<&Tube>> {
        self.list.iter().map(Option::as_ref).collect()
    }
}

impl Tube {
    /// The size by which they are in order: omega^2, or |s|^2.
    pub fn size(&self) -> Ball {
        match self.centre {
            Centre::Eigenvalue(square) => square,
            Centre::Pole(re, im) => jet::square(re) + jet::square(im),
            Centre::None => Ball::new(Dd::ZERO, f64::INFINITY),
        }
    }

    /// omega^2, or the real or the imaginary part of a pole.
    pub fn part(&self, own: usize, imaginary: bool) -> Option<Jet> {
        let known = self.raw(own, imaginary)?;
        let better = || {
            let [m, c, _] = self.energies.get(own)?.as_ref()?;
            Some(Jet::of(&-&c.checked_div(&(&Number::from(2) * m))?))
        };
        Some(if imaginary { known } else { better().map_or(known.clone(), |other| narrower(known, other)) })
    }

    /// The same as it was followed.
    pub fn raw(&self, own: usize, imaginary: bool) -> Option<Jet> {
        let (value, slope) = match (self.centre, *self.moved.get(own)?) {
            (Centre::Eigenvalue(square), Moved::Eigenvalue(slope)) => (square, slope),
            (Centre::Pole(_, im), Moved::Pole(_, slope)) if imaginary => (im, slope),
            (Centre::Pole(re, _), Moved::Pole(slope, _)) => (re, slope),
            _ => return None,
        };
        Some(Jet { value, slope })
    }

    pub fn ratio(&self, own: usize) -> Option<Jet> {
        let (Centre::Pole(re, im), Moved::Pole(re_slope, im_slope)) = (self.centre, *self.moved.get(own)?) else {
            return None;
        };
        if self.is_real {
            return re.is_negative().then_some(Jet { value: Ball::ONE, slope: Ball::ZERO });
        }
        let value = -re / self.size().sqrt();
        let known = Jet { value, slope: ratio_slope((re, im), (re_slope, im_slope)) };
        let better = || {
            let [m, c, k] = self.energies.get(own)?.as_ref()?;
            Some(Jet::of(&c.checked_div(&(&Number::from(2) * &(k * m).sqrt()?))?))
        };
        Some(better().map_or(known.clone(), |other| narrower(known, other)))
    }
}

/// Those that may be the ones asked for, of things in ascending order of sizes that are enclosed: `counts` are added up along the order,
/// and `fits` says of a sum up to and with a thing, and of its own count, whether that is the one.
pub(super) fn candidates(
    sizes: &[Ball],
    counts: &[usize],
    fits: impl Fn(usize, usize) -> bool,
) -> impl Iterator<Item = usize> {
    let mut list = Vec::new();
    for (i, (size, own)) in sizes.iter().zip(counts).enumerate() {
        let others = |before: &dyn Fn(Ball) -> bool| -> usize {
            let all = (0..sizes.len()).filter(|&j| j != i && before(sizes[j] - *size));
            all.map(|j| counts[j]).sum()
        };
        let (least, most) = (others(&|apart| apart.is_negative()), others(&|apart| !apart.is_positive()));
        if (least + own..=most + own).any(|sum| fits(sum, *own)) {
            list.push(i);
        }
    }
    list.into_iter()
}

pub(super) fn sizes(tubes: &[&Tube]) -> Vec<Ball> {
    tubes.iter().map(|tube| tube.size()).collect()
}

/// Two enclosures of one number: the better of each part.
pub(super) fn narrower(a: Jet, b: Jet) -> Jet {
    let pick = |a: Ball, b: Ball| if b.is_finite() && !(a.is_finite() && a.rad <= b.rad) { b } else { a };
    Jet { value: pick(a.value, b.value), slope: pick(a.slope, b.slope) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    fn ball_between(low: f64, high: f64) -> Ball {
        let middle = 0.5 * (low + high);
        Ball::from(middle).widen(high - middle)
    }

    fn tubes(list: &[Option<[f64; 2]>]) -> Vec<Option<Tube>> {
        let tube = |[low, high]: [f64; 2]| Tube {
            centre: Centre::Eigenvalue(ball_between(low, high)),
            moved: Vec::new(),
            is_real: true,
            energies: Vec::new(),
        };
        list.iter().map(|ends| ends.map(tube)).collect()
    }

    /// Of eigenvalues that are followed and of some that are not, the lowest are told from the others by a size that none has: it
    /// lies above all that are counted, wherever they are, and below the middles of the rest.
    #[test]
    fn the_lowest_are_those_below_a_size_that_none_has() {
        let asked = RefCell::new(Vec::new());
        let lowest = |list: &[Option<[f64; 2]>], middles: &[f64], is_free: &dyn Fn(f64) -> bool| {
            asked.borrow_mut().clear();
            let middles: Vec<Ball> = middles.iter().copied().map(Ball::from).collect();
            let is_free = |border: f64| {
                asked.borrow_mut().push(border);
                is_free(border)
            };
            Tubes::of(tubes(list), &middles, is_free).lowest
        };
        let list = [Some([0.5, 1.5]), Some([1.0, 4.0]), None, Some([9.0, 11.0]), None];
        let middles = [1.0, 2.0, 8.0, 10.0, 12.0];
        assert_eq!(lowest(&list, &middles, &|border| border > 4.0), 2);
        assert!(asked.borrow().iter().all(|border| (4.0..8.0).contains(border)), "{asked:?}");
        // No size is free, or only one below what the second may reach.
        assert_eq!(lowest(&list, &middles, &|_| false), 0);
        assert_eq!(lowest(&list, &middles, &|border| border < 4.0), 1);
        // The second may be above what is not followed, and the first too.
        assert_eq!(lowest(&[Some([0.5, 1.5]), Some([1.0, 8.5]), None], &[1.0, 2.0, 8.0], &|border| border > 1.8), 0);
        assert_eq!(lowest(&[Some([0.5, 9.0]), Some([1.0, 2.0]), None], &[1.0, 2.0, 8.0], &|_| true), 0);
        // What is not followed is the first in the middle.
        assert_eq!(lowest(&[None, Some([3.0, 4.0])], &[1.0, 3.5], &|_| true), 0);
        assert_eq!(lowest(&[Some([0.5, 9.0]), Some([1.0, 2.0])], &[1.0, 2.0], &|_| panic!("all are followed")), 2);
    }

    /// Whatever places things take in their ranges, the one whose count is reached there is among the candidates; and each candidate
    /// is that one for some places.
    #[test]
    fn candidates_are_those_that_some_places_make_the_one() {
        let ends = [[0.0, 1.0], [0.9, 2.1], [2.0, 3.0], [2.4, 2.6], [4.0, 5.0], [4.5, 6.0]];
        let counts = [1, 2, 2, 1, 2, 1];
        let sizes: Vec<Ball> = ends.iter().map(|[low, high]| ball_between(*low, *high)).collect();
        // Places that meet in no two ranges, next to the ends and in the middle.
        let places = |i: usize| {
            let [low, high] = ends[i];
            let off = 1e-3 * (1.0 + i as f64);
            [low + off, 0.5 * (low + high) + off, high - off]
        };
        for rank in 1..=9 {
            let mut possible = [false; 6];
            for choice in 0..3usize.pow(6) {
                let at: Vec<f64> = (0..6).map(|i| places(i)[choice / 3usize.pow(i as u32) % 3]).collect();
                let mut order: Vec<usize> = (0..6).collect();
                order.sort_by(|a, b| at[*a].total_cmp(&at[*b]));
                let mut sum = 0;
                let first = order.into_iter().find(|&i| {
                    sum += counts[i];
                    sum >= rank
                });
                possible[first.expect("nine in all")] = true;
            }
            let found: Vec<usize> = candidates(&sizes, &counts, |sum, own| (rank..rank + own).contains(&sum)).collect();
            let truth: Vec<usize> = (0..6).filter(|&i| possible[i]).collect();
            assert!(truth.iter().all(|i| found.contains(i)), "{rank}: {found:?} {truth:?}");
            // Sums that no subset of the others reaches are not told apart.
            assert!(found.len() <= truth.len() + 1, "{rank}: {found:?} {truth:?}");
        }
    }
}
