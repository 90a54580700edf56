//! One law for elements that are alike. In: the law of each element, in order. Out: the same, shared where a recent
//! element of any kind has an equal one.

use super::scene::Law;
use std::sync::Arc;

/// The springs and dampers of a repetition alternate, so a few laws are remembered; those of a long list all differ or
/// all agree, so no more are.
const REMEMBERED: usize = 4;

/// The laws of the elements that came last.
#[derive(Debug, Default)]
pub struct RecentLaws {
    recent: Vec<Arc<Law>>,
    /// The one that is forgotten next.
    oldest: usize,
}

impl RecentLaws {
    pub fn share(&mut self, law: Law) -> Arc<Law> {
        if let Some(known) = self.recent.iter().find(|known| are_alike(known, &law)) {
            return known.clone();
        }
        let law = Arc::new(law);
        if self.recent.len() < REMEMBERED {
            self.recent.push(law.clone());
        } else {
            self.recent[self.oldest] = law.clone();
            self.oldest = (self.oldest + 1) % REMEMBERED;
        }
        law
    }
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
        let others = [law(c, 1), law(k, 2), Law { rest: SpringRest::Preload(Number::ONE), ..law(k, 1) }];
        for other in others {
            assert!(!Arc::ptr_eq(&laws.share(other), &first));
        }
        assert!(Arc::ptr_eq(&laws.share(law(k, 1)), &first));
        // Two more, and the first is forgotten: a copy is as good.
        (3..5).for_each(|coefficient| drop(laws.share(law(k, coefficient))));
        let again = laws.share(law(k, 1));
        assert!(!Arc::ptr_eq(&again, &first) && again.coefficient == first.coefficient);
        let lossy = Law { loss: Some(Box::new(Number::ONE)), ..law(k, 1) };
        assert!(!Arc::ptr_eq(&laws.share(lossy), &again));
    }
}
