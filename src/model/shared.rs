//! One law for elements that are alike, and one matter for bodies. In: what each of them has, in order. Out: the same, shared where
//! a recent one has an equal one.

use super::scene::{Freedom, Law, Matter};
use crate::base::Number;
use std::sync::Arc;

/// Items that are remembered, each in the place that its number gives: written-out networks have a few sizes of bodies, springs and
/// dampers, in any order.
const REMEMBERED: usize = 64;

/// What many parts of a scene have in common.
pub trait Shared {
    /// The number that most likely tells it from others.
    fn number(&self) -> Option<&Number>;

    /// Whether two are certainly the same.
    fn is_like(&self, other: &Self) -> bool;
}

/// The last item of each place.
#[derive(Debug)]
pub struct Recent<T> {
    recent: Vec<Option<Arc<T>>>,
}

impl<T> Default for Recent<T> {
    fn default() -> Recent<T> {
        Recent { recent: Vec::new() }
    }
}

impl<T: Shared> Recent<T> {
    pub fn share(&mut self, item: T) -> Arc<T> {
        if self.recent.is_empty() {
            self.recent.resize(REMEMBERED, None);
        }
        let recent = &mut self.recent[place(item.number())];
        match recent.as_ref().filter(|known| known.is_like(&item)) {
            Some(known) => known.clone(),
            None => recent.insert(Arc::new(item)).clone(),
        }
    }
}

/// Where an item with this number is remembered. Fibonacci hashing: the highest bits of a product depend on all bits of the number
/// (Knuth, The Art of Computer Programming 3, 6.4).
fn place(number: Option<&Number>) -> usize {
    let bits = number.and_then(Number::exact).map_or(0, |value| value.to_f64().to_bits());
    let product = bits.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (product >> (64 - REMEMBERED.ilog2())) as usize
}

impl Shared for Law {
    fn number(&self) -> Option<&Number> {
        Some(&self.coefficient)
    }

    /// The same linear law without a loss; others are rare and not compared.
    fn is_like(&self, other: &Law) -> bool {
        let is_plain = |law: &Law| law.curve.is_none() && law.loss.is_none();
        std::ptr::eq(self.kind, other.kind)
            && self.coefficient == other.coefficient
            && self.rest == other.rest
            && is_plain(self)
            && is_plain(other)
    }
}

impl Shared for Matter {
    fn number(&self) -> Option<&Number> {
        self.mass.as_ref()
    }

    /// The same mass and inertia, without a shape, with one of the usual freedoms; others are not compared.
    fn is_like(&self, other: &Matter) -> bool {
        let has_same_freedom = match (&self.freedom, &other.freedom) {
            (Freedom::FromJoints, Freedom::FromJoints) => true,
            (
                Freedom::OnGround { translations: a, turns: first },
                Freedom::OnGround { translations: b, turns: second },
            ) => Arc::ptr_eq(a, b) && first == second,
            _ => false,
        };
        let is_plain = |matter: &Matter| matter.shape.is_none();
        has_same_freedom
            && is_plain(self)
            && is_plain(other)
            && self.mass == other.mass
            && self.inertia == other.inertia
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Vec3;
    use crate::elements::{damper, spring};
    use crate::model::scene::{Body, Element, Shape, SpringRest, Translation};

    fn law(kind: &'static crate::elements::Kind, coefficient: i64) -> Law {
        Law { kind, coefficient: Number::from(coefficient), rest: SpringRest::AsDrawn, curve: None, loss: None }
    }

    #[test]
    fn bodies_and_elements_stay_small() {
        // A scene of a million of each is 152 MB.
        assert!(std::mem::size_of::<Body>() <= 48);
        assert!(std::mem::size_of::<Element>() <= 104);
    }

    #[test]
    fn equal_laws_are_one_and_others_are_not() {
        let (k, c) = (&spring::KIND, &damper::KIND);
        let mut laws = Recent::default();
        let first = laws.share(law(k, 1));
        assert!(Arc::ptr_eq(&laws.share(law(k, 1)), &first));
        // Some of many others take the place of the first, which is forgotten then: a copy is as good.
        let mut many = (2..1000).map(|coefficient| law(k, coefficient));
        assert!(many.all(|other| laws.share(other.clone()).coefficient == other.coefficient));
        assert!(!Arc::ptr_eq(&laws.share(law(k, 1)), &first));
        let again = laws.share(law(k, 1));
        let others = [law(c, 1), law(k, 2), Law { rest: SpringRest::Preload(Number::ONE), ..law(k, 1) }];
        for other in others {
            assert!(!Arc::ptr_eq(&laws.share(other), &again));
        }
        let again = laws.share(law(k, 1));
        let lossy = Law { loss: Some(Box::new(Number::ONE)), ..law(k, 1) };
        assert!(!Arc::ptr_eq(&laws.share(lossy), &again));
    }

    /// Matters that differ in any of their parts are told apart.
    #[test]
    fn equal_matters_are_one_and_others_are_not() {
        let along = |motion| Arc::new(vec![Translation { direction: Vec3::X, motion }]);
        let x = along("x");
        let on = |translations: &Arc<Vec<Translation>>, turns| Freedom::OnGround {
            translations: translations.clone(),
            turns,
        };
        let (mass, inertia) = (Some(Number::ONE), Some(Box::new(Number::from(2))));
        let matter = || Matter { mass: mass.clone(), inertia: inertia.clone(), shape: None, freedom: on(&x, false) };
        let mut matters = Recent::default();
        let first = matters.share(matter());
        assert!(Arc::ptr_eq(&matters.share(matter()), &first));
        let others = [
            Matter { inertia: None, ..matter() },
            Matter { inertia: mass.clone().map(Box::new), ..matter() },
            Matter { shape: Some(Arc::new(Shape::Disk { radius: Number::ONE })), ..matter() },
            Matter { freedom: Freedom::FromJoints, ..matter() },
            Matter { freedom: on(&x, true), ..matter() },
            Matter { freedom: on(&along("along"), false), ..matter() },
            Matter { mass: None, ..matter() },
            Matter { mass: Some(Number::from(3)), ..matter() },
        ];
        for other in others {
            let known = matters.share(matter());
            assert!(!Arc::ptr_eq(&matters.share(other), &known));
        }
    }
}
