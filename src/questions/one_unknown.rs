//! One unknown and its measure: every root in the range, and a proof that there is no other. In: a `solve` line and the
//! text. Out: the value, and whether there may be others; or an error with the evaluations that were made. See
//! docs/method/measures.md.

use super::answer::Others;
use super::cover::{Cover, Covered, Part, Rest, merge_parts};
use super::error::AskedError;
use super::search::{
    Crossing, Difference, Evaluation, Root, SearchResult, narrow, search, sign, size_of_zero, to_fraction,
};
use super::unknowns::{Unknowns, constant, shortest};
use crate::base::{Ball, Dd, Number, OrderBy, two_to, up};
use std::cmp::Ordering;

/// Rounds of searching for roots that were missed.
const MOST_ROUNDS: usize = 6;
/// What is this near to a root, relative to it, is not told from it: open parts, and other roots.
const AT_A_ROOT: f64 = 1e-12;

/// A search and its results so far.
struct Search<'a, 'b> {
    unknowns: &'a Unknowns<'b>,
    equation: usize,
    unknown: usize,
    seen: SearchResult,
    rest: Rest,
}

impl Unknowns<'_> {
    /// Solves one equation for one unknown.
    pub fn solve_one(&mut self, equation: usize, unknown: usize) -> Result<(), Vec<AskedError>> {
        let mut search =
            Search { unknowns: self, equation, unknown, seen: SearchResult::default(), rest: Rest::Unknown };
        search.run();
        let (seen, others) = search.judge().map_err(|error| vec![*error])?;
        self.take(equation, unknown, &seen.roots[0], seen.count, others);
        Ok(())
    }
}

impl Search<'_, '_> {
    fn measure(&self, at: &Number) -> Difference {
        self.unknowns.difference(self.equation, self.unknown, at)
    }

    fn ends(&self) -> (&Number, &Number) {
        let solve = &self.unknowns.solves[self.unknown];
        (&solve.low, &solve.high)
    }

    /// What is this near to a root is not told from it.
    fn at(&self, root: Dd) -> f64 {
        let (low, high) = self.ends();
        AT_A_ROOT * root.hi.abs().max(size_of_zero(low, high))
    }

    /// Searches for roots, then tries to prove that there are no others; roots that the proof reveals are searched for.
    fn run(&mut self) {
        let (low, high) = (self.ends().0.clone(), self.ends().1.clone());
        let whole = Part { low: low.enclosure().mid, high: high.enclosure().mid };
        let monotone = self.unknowns.enclose_over(self.equation, self.unknown, whole.ball()).is_monotone();
        self.seen = if monotone { narrow(&low, &high, &|at| self.measure(at)) } else { SearchResult::default() };
        if self.seen.roots.is_empty() && !(monotone && self.lies_on_one_side()) {
            self.seen = search(&low, &high, &|at| self.measure(at));
        }
        if constant(&self.seen.evaluations) {
            return;
        }
        self.settle_touches();
        self.keep_within_range();
        for _ in 0..MOST_ROUNDS {
            let covered = self.cover(whole);
            self.seen.count += covered.evaluations;
            let before = self.seen.roots.len();
            for part in &covered.missed {
                let found = narrow(&to_fraction(part.low), &to_fraction(part.high), &|at| self.measure(at));
                self.seen.count += found.count;
                self.seen.jumps.extend(found.jumps);
                found.roots.into_iter().for_each(|root| self.seen.add(root));
            }
            self.keep_within_range();
            self.seen.roots.order_by(|a, b| a.near.hi.total_cmp(&b.near.hi));
            self.rest = covered.rest;
            if covered.missed.is_empty() {
                return;
            }
            if self.seen.roots.len() == before {
                // A jump: it is not a root, and nothing more is known about these parts.
                let parts = match std::mem::replace(&mut self.rest, Rest::Unknown) {
                    Rest::Open(parts) => parts,
                    Rest::Empty(_) | Rest::Unknown => Vec::new(),
                };
                self.rest = Rest::Open([parts, covered.missed].concat());
                return;
            }
        }
        self.rest = Rest::Unknown;
    }

    /// Whether the measure lies on the same side at all evaluations.
    fn lies_on_one_side(&self) -> bool {
        let sides: Vec<_> = self.seen.evaluations.iter().map(|evaluation| sign(&evaluation.difference)).collect();
        sides.iter().all(|side| side.is_some_and(|side| side.is_ne()) && *side == sides[0])
    }

    /// Evaluates the measure at short numbers near the places where it turns or touches: if it is exactly the target
    /// there, that is a root.
    fn settle_touches(&mut self) {
        let unit = self.unknowns.solves[self.unknown].parameter.unit.factor.clone();
        let touches = self.seen.turns.iter().chain(self.seen.roots.iter().filter(|root| root.proof.is_none()));
        let touches: Vec<Root> = touches.copied().collect();
        for touch in touches {
            let short =
                shortest(&Root { within: touch.within.max(1e-12 * touch.near.hi.abs()), ..touch }, unit.as_ref());
            self.seen.count += 1;
            let meets = match self.measure(&short) {
                Difference::Known(ball) if ball.is_zero() => true,
                Difference::Known(ball) => {
                    ball.contains_zero() && self.unknowns.meets(self.equation, self.unknown, &short)
                }
                _ => false,
            };
            if meets {
                let near = short.enclosure().mid;
                self.seen.roots.retain(|root| root.proof.is_some() || (root.near - near).hi.abs() > touch.within * 4.0);
                let rounding = near.hi.abs() * two_to(-100);
                self.seen.add(Root { near, within: rounding, proof: Some(Crossing::exact()) });
            }
        }
        self.seen.roots.order_by(|a, b| a.near.hi.total_cmp(&b.near.hi));
    }

    /// Of roots whose bracket reaches over an end of the range, keeps those that lie in it: the measure is exactly at its target at the
    /// end, or on different sides there and at the bracket's end within the range. Where its side at the end is not known, the root
    /// counts as in the range if the bracket reaches hardly further.
    fn keep_within_range(&mut self) {
        let [low, high] = [self.ends().0.clone(), self.ends().1.clone()];
        let roots = std::mem::take(&mut self.seen.roots);
        for root in roots {
            let [left, right] = [-1.0, 1.0].map(|side| to_fraction(root.near + Dd::from(side * root.within)));
            let over_low = (&left - &low).is_negative();
            let (end, inner) = match (over_low, (&high - &right).is_negative()) {
                (false, false) => {
                    self.seen.roots.push(root);
                    continue;
                }
                (true, false) => (&low, &right),
                // Over both ends: the far one is as good.
                (_, true) => (&high, if over_low { &low } else { &left }),
            };
            self.seen.count += 2;
            let [at_end, within] = [end, inner].map(|at| self.measure(at));
            let (at, other) = (end.enclosure().mid, inner.enclosure().mid);
            let exact = match &at_end {
                Difference::Known(ball) if ball.is_zero() => true,
                Difference::Known(ball) => {
                    ball.contains_zero() && self.unknowns.meets(self.equation, self.unknown, end)
                }
                _ => false,
            };
            let kept = match (sign(&at_end), sign(&within)) {
                _ if exact => {
                    Some(Root { near: at, within: at.hi.abs() * two_to(-100), proof: Some(Crossing::exact()) })
                }
                (Some(a), Some(b)) if a != Ordering::Equal && a == b.reverse() => {
                    let half = (at - other).abs().to_f64() * 0.5;
                    let rounding = at.hi.abs() * two_to(-100);
                    Some(Root { near: (at + other).scale(0.5), within: (half + rounding) * up::FEW, ..root })
                }
                (Some(a), Some(b)) if a != Ordering::Equal && a == b => None,
                _ => (root.within <= self.at(root.near)).then(|| {
                    let away = (root.near - at).abs().to_f64();
                    Root { near: at, within: (root.within + away) * up::FEW, ..root }
                }),
            };
            self.seen.roots.extend(kept);
        }
    }

    /// The brackets of roots, within the range, that are not known to contain one number only at which the measure is at its target.
    fn wide_brackets(&self, whole: Part) -> Vec<Part> {
        let bracket = |root: &Root| Part {
            low: if root.near - Dd::from(root.within) > whole.low {
                root.near - Dd::from(root.within)
            } else {
                whole.low
            },
            high: if root.near + Dd::from(root.within) < whole.high {
                root.near + Dd::from(root.within)
            } else {
                whole.high
            },
        };
        let is_wide = |root: &&Root| root.proof.is_some() && root.within > self.at(root.near);
        let is_one = |part: &Part| self.unknowns.enclose_over(self.equation, self.unknown, part.ball()).is_strict();
        self.seen.roots.iter().filter(is_wide).map(bracket).filter(|part| !is_one(part)).collect()
    }

    /// Settles the gaps between the brackets of the roots, and brackets that may hold several. An unsettled part beside a root is added
    /// to the root's bound.
    fn cover(&mut self, whole: Part) -> Covered {
        let mut parts = Vec::new();
        let mut from = whole.low;
        for root in &self.seen.roots {
            let (low, high) = (root.near - Dd::from(root.within), root.near + Dd::from(root.within));
            if low > from {
                parts.push(Part { low: from, high: low });
            }
            from = if high > from { high } else { from };
        }
        if whole.high > from {
            parts.push(Part { low: from, high: whole.high });
        }
        let over = |range: Ball| self.unknowns.enclose_over(self.equation, self.unknown, range);
        let side = |at: Dd| sign(&self.measure(&to_fraction(at)));
        let most = self.unknowns.effort();
        let mut covered = Cover { over: &over, side: &side, most }.settle(parts);
        let zero = size_of_zero(self.ends().0, self.ends().1);
        if let Rest::Open(open) = &mut covered.rest {
            let roots = &mut self.seen.roots;
            open.retain(|part| {
                let near = |root: &&mut Root| part.reach(root.near) <= AT_A_ROOT * root.near.hi.abs().max(zero);
                match roots.iter_mut().find(near) {
                    Some(root) => {
                        root.within = root.within.max(part.reach(root.near));
                        false
                    }
                    None => true,
                }
            });
        }
        covered.rest = match (covered.rest.or_proof(), self.wide_brackets(whole)) {
            (Rest::Unknown, _) => Rest::Unknown,
            (rest, wide) if wide.is_empty() => rest,
            (Rest::Open(parts), wide) => Rest::Open(merge_parts([parts, wide].concat())),
            (Rest::Empty(_), wide) => Rest::Open(wide),
        };
        covered
    }

    /// The value, or the error.
    fn judge(self) -> Result<(SearchResult, Others), Box<AskedError>> {
        let Search { unknowns, equation, unknown, seen, rest } = self;
        let proven = matches!(rest, Rest::Empty(_));
        if constant(&seen.evaluations) {
            return Err(Box::new(unknowns.no_root(equation, unknown, &seen, proven)));
        }
        let touch = seen.roots.iter().find(|root| root.proof.is_none());
        let solve = &unknowns.solves[unknown];
        let part_texts = |parts: &[Part]| -> Vec<(String, String)> {
            parts
                .iter()
                .map(|part| {
                    (
                        unknowns.value_text(unknown, &to_fraction(part.low)),
                        unknowns.value_text(unknown, &to_fraction(part.high)),
                    )
                })
                .collect()
        };
        let several = || AskedError::SeveralRoots {
            span: solve.span,
            measure: unknowns.measure(&unknowns.solves[equation].question),
            target: unknowns.target(equation),
            name: solve.parameter.name.clone(),
            roots: seen
                .roots
                .iter()
                .filter(|root| root.proof.is_some())
                .map(|root| unknowns.value_text(unknown, &to_fraction(root.near)))
                .collect(),
            all: proven && touch.is_none(),
        };
        let certain = seen.roots.iter().filter(|root| root.proof.is_some()).count();
        if certain > 1 {
            return Err(Box::new(several()));
        }
        if let Some(touch) = touch {
            return Err(Box::new(AskedError::Touches {
                span: solve.span,
                measure: unknowns.measure(&unknowns.solves[equation].question),
                target: unknowns.target(equation),
                name: solve.parameter.name.clone(),
                at: unknowns.value_text(unknown, &to_fraction(touch.near)),
            }));
        }
        if certain == 0 {
            return Err(Box::new(match &rest {
                Rest::Open(parts) if seen.jumps.is_empty() => AskedError::NothingSettled {
                    span: solve.span,
                    measure: unknowns.measure(&unknowns.solves[equation].question),
                    target: unknowns.target(equation),
                    name: solve.parameter.name.clone(),
                    parts: part_texts(parts),
                },
                _ => unknowns.no_root(equation, unknown, &seen, proven),
            }));
        }
        let others = match rest {
            Rest::Empty(proof) => Others::None(proof),
            Rest::Open(parts) => Others::Unsettled(part_texts(&parts)),
            Rest::Unknown => Others::Unknown,
        };
        Ok((seen, others))
    }
}

/// The evaluations with the least and the largest difference, for messages.
pub fn extremes(evaluations: &[Evaluation]) -> Option<(&Evaluation, &Evaluation)> {
    let size = |evaluation: &&Evaluation| match &evaluation.difference {
        Difference::Known(ball) => ball.to_f64(),
        Difference::Infinite => f64::INFINITY,
        Difference::None(_) => f64::NAN,
    };
    let known = || evaluations.iter().filter(|evaluation| !size(evaluation).is_nan());
    let least = known().min_by(|a, b| size(a).total_cmp(&size(b)))?;
    let largest = known().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some((least, largest))
}
