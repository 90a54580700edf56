//! One law for elements that are alike, and one matter for bodies. In: what each of them has, in order. Out: the same, shared where
//! a recent one has an equal one.

use super::scene::{Freedom, Geometry, Law, Matter};
use crate::base::Number;
use std::sync::Arc;

/// Items that are remembered, each in the place that its numbers give: written-out networks have a few sizes of bodies, springs and
/// dampers, in any order.
const REMEMBERED: usize = 64;

/// What many parts of a scene have in common.
pub trait Shared {
    /// The numbers that most likely tell it from others.
    fn numbers(&self) -> impl Iterator<Item = &Number>;

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
        let recent = &mut self.recent[place(item.numbers())];
        match recent.as_ref().filter(|known| known.is_like(&item)) {
            Some(known) => known.clone(),
            None => recent.insert(Arc::new(item)).clone(),
        }
    }
}

/// Where an item with these numbers is remembered. Fibonacci hashing: the highest bits of a product depend on all bits of the number
/// (Knuth, The Art of Computer Programming 3, 6.4).
fn place<'a>(numbers: impl Iterator<Item = &'a Number>) -> usize {
    let product = numbers.filter_map(Number::exact).fold(0u64, |product, value| {
        (product.rotate_left(5) ^ value.to_f64().to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    (product >> (64 - REMEMBERED.ilog2())) as usize
}

impl Shared for Law {
    fn numbers(&self) -> impl Iterator<Item = &Number> {
        let along = match &self.geometry {
            Geometry::Along(direction) => Some([&direction.x, &direction.y]),
            _ => None,
        };
        std::iter::once(&self.coefficient).chain(along.into_iter().flatten())
    }

    /// The same linear law without a loss, along the same line; others are rare and not compared.
    fn is_like(&self, other: &Law) -> bool {
        let has_same_geometry = match (&self.geometry, &other.geometry) {
            (Geometry::Line, Geometry::Line) | (Geometry::Torsion, Geometry::Torsion) => true,
            (Geometry::Along(a), Geometry::Along(b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        let is_plain = |law: &Law| law.curve.is_none() && law.loss.is_none();
        has_same_geometry
            && std::ptr::eq(self.kind, other.kind)
            && self.coefficient == other.coefficient
            && self.rest == other.rest
            && is_plain(self)
            && is_plain(other)
    }
}

impl Shared for Matter {
    fn numbers(&self) -> impl Iterator<Item = &Number> {
        self.mass.iter()
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
        let (geometry, coefficient) = (Geometry::Line, Number::from(coefficient));
        Law { kind, geometry, coefficient, rest: SpringRest::AsDrawn, curve: None, loss: None }
    }

    #[test]
    fn bodies_and_elements_stay_small() {
        // A scene of a million of each is 136 MB.
        assert!(std::mem::size_of::<Body>() <= 48);
        assert!(std::mem::size_of::<Element>() <= 88);
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
        let along = |line: &Arc<Vec3>| Law { geometry: Geometry::Along(line.clone()), ..law(k, 1) };
        let (one, same_values) = (Arc::new(Vec3::X), Arc::new(Vec3::X));
        let others = [along(&same_values), along(&Arc::new(Vec3::Y)), Law { geometry: Geometry::Torsion, ..law(k, 1) }];
        for other in others {
            let straight = laws.share(along(&one));
            assert!(Arc::ptr_eq(&laws.share(along(&one)), &straight));
            assert!(!Arc::ptr_eq(&laws.share(other), &straight));
        }
        // The same coefficient along two lines in turn, as in a net of springs.
        let other = Arc::new(Vec3::Y);
        let net = [&one, &other, &one, &other].map(|line| laws.share(along(line)));
        assert!(Arc::ptr_eq(&net[0], &net[2]) && Arc::ptr_eq(&net[1], &net[3]));
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
