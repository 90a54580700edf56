//! The rest for all values in a box of parameters. In: the rest over a box, enclosed, and those found at single places. Out: whether they
//! are one rest that moves with the values. See docs/method/studies.md#rests-over-a-box.
//!
//! A scene may have several rests, and the search for one may end in another one for other values. The rest over the whole box is the one
//! that the declared rest becomes as the values move. Over a part it is the same if at one place of the part both enclosures hold the rest
//! that is found there: in each there is exactly one for all values, and both depend continuously on them.

use super::Corners;
use super::boxes::Point;
use crate::base::number::jet;
use crate::base::{Ball, Diagnostics, Jet, Number};
use crate::dynamics;
use crate::lower::rest::Rest;
use crate::model::Setting;

impl Corners<'_> {
    /// Whether the rest over a part of the box is that over the whole: `there` is the one that is found somewhere in the part.
    pub fn keeps_rest(&self, over: &Rest, there: impl FnOnce() -> Option<Rest>) -> bool {
        let is_kept = || {
            let (whole, there) = (self.rest_over_all()?, there()?);
            Some(over.holds(&there) && whole.holds(&there))
        };
        !over.is_ranged() || is_kept().unwrap_or(false)
    }

    /// Whether the rest found at each place is the one over the whole box, if parameters move it.
    pub fn keeps_rest_at(&self, points: &[Point]) -> bool {
        if !self.is_moved(points) {
            return true;
        }
        let holds = |whole: &Rest| points.iter().all(|point| point.rest().is_some_and(|rest| whole.holds(rest)));
        self.rest_over_all().is_some_and(holds)
    }

    /// Whether some place has another rest than the first one.
    fn is_moved(&self, points: &[Point]) -> bool {
        let displacement = |point: &Point| point.rest().map(|rest| rest.displacement.clone());
        points.iter().any(|point| displacement(point) != points.first().and_then(displacement))
    }

    /// Whether terms move with the rest over the whole box, and it is not proved that the search ends there for all values: what is known
    /// of that rest then proves nothing about what the model does at each of them.
    pub fn follows_rest(&self) -> bool {
        self.rest_over_all().is_some_and(Rest::may_be_elsewhere)
    }

    /// The rest over the whole box; `None` if it is not enclosed.
    pub fn rest_over_all(&self) -> Option<&Rest> {
        let find = || {
            let setting = |(i, [low, high]): (usize, [Number; 2])| {
                let value = super::hull(low.enclosure(), high.enclosure());
                self.setting(i, Number::from(Jet { value, slope: Ball::ZERO }))
            };
            let ranges = self.whole()?.into_iter().enumerate().map(setting);
            let values: Vec<Setting> = self.held.iter().cloned().chain(ranges).collect();
            jet::without_division(|| self.rest(&values)).flatten()
        };
        self.rest.get_or_init(find).as_ref()
    }

    /// The rest at a place.
    pub fn rest_at(&self, place: &[Number]) -> Option<Rest> {
        self.rest(&self.settings(place))
    }

    fn rest(&self, values: &[Setting]) -> Option<Rest> {
        let scene = self.text.scene(values).ok()?.without_damping();
        let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
        lowered.rest.is_proven().then_some(lowered.rest)
    }
}
