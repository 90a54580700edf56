//! One law for elements that are alike. In: the law of each element, in order. Out: the same, shared where a recent
//! element of any kind has an equal one.

use super::scene::Law;
use std::sync::Arc;

/// Laws that are remembered, each in the place that its coefficient gives: written-out networks have a few sizes of springs and dampers,
/// in any order.
const REMEMBERED: usize = 64;

/// The last law of each place.
#[derive(Debug, Default)]
pub struct RecentLaws {
    recent: Vec<Option<Arc<Law>>>,
}

impl RecentLaws {
    pub fn share(&mut self, law: Law) -> Arc<Law> {
        if self.recent.is_empty() {
            self.recent.resize(REMEMBERED, None);
        }
        let recent = &mut self.recent[place(&law)];
        match recent.as_ref().filter(|known| are_alike(known, &law)) {
            Some(known) => known.clone(),
            None => recent.insert(Arc::new(law)).clone(),
        }
    }
}

/// Where a law is remembered. Fibonacci hashing: the highest bits of a product depend on all bits of the number (Knuth, The Art of
/// Computer Programming 3, 6.4).
fn place(law: &Law) -> usize {
    let bits = law.coefficient.exact().map_or(0, |value| value.to_f64().to_bits());
    let product = bits.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (product >> (64 - REMEMBERED.ilog2())) as usize
}

/// Whether two laws are the same linear law without a loss; others are rare and not compared.
fn are_alike(a: &Law, b: &Law) -> bool {
    let is_plain = |law: &Law| law.curve.is_none() && law.loss.is_none();
    std::ptr::eq(a.kind, b.kind) && a.coefficient == b.coefficient && a.rest == b.rest && is_plain(a) && is_plain(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Number;
    use crate::elements::{damper, spring};
    use crate::model::scene::{Body, Element, SpringRest};

    fn law(kind: &'static crate::elements::Kind, coefficient: i64) -> Law {
        Law { kind, coefficient: Number::from(coefficient), rest: SpringRest::AsDrawn, curve: None, loss: None }
    }

    #[test]
    fn bodies_and_elements_stay_small() {
        // A scene of a million of each is 208 MB.
        assert!(std::mem::size_of::<Body>() <= 104);
        assert!(std::mem::size_of::<Element>() <= 104);
    }

    #[test]
    fn equal_laws_are_one_and_others_are_not() {
        let (k, c) = (&spring::KIND, &damper::KIND);
        let mut laws = RecentLaws::default();
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
}
