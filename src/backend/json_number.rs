//! Numbers as fields of JSON. A field is made from an enclosure, a bound, or a number marked as unproven; a bare
//! binary64 number is not accepted, so that no result can be written without deciding whether it has a bound
//! (`tests/suite/house.rs` looks for such fields). See docs/method/report.md.

use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound, Number, Rounded, Unproven};
use serde::Serialize;

/// A number, or `null` if it is unknown or infinite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub(super) struct JsonNumber(Option<f64>);

impl JsonNumber {
    pub const NULL: JsonNumber = JsonNumber(None);

    /// The value of an enclosed number; its bound is a separate field.
    pub fn from_enclosure(value: Ball) -> JsonNumber {
        JsonNumber(Rounded::of(value).map(Rounded::value))
    }

    /// `null` if there is no such number.
    pub fn of(value: Option<Ball>) -> JsonNumber {
        value.map_or(JsonNumber::NULL, JsonNumber::from_enclosure)
    }

    /// A number that may be exact.
    pub fn number(value: &Number) -> JsonNumber {
        JsonNumber::from_enclosure(value.to_ball())
    }

    /// A bound of |x - true| / |true| for the x of [`JsonNumber::from_enclosure`].
    pub fn relative_bound(value: Ball) -> JsonNumber {
        JsonNumber::bound(Bound::relative(value))
    }

    /// A bound of |x - true| for the x of [`JsonNumber::from_enclosure`].
    pub fn absolute_bound(value: Ball) -> JsonNumber {
        JsonNumber::bound(Bound::absolute(value))
    }

    /// A number and its absolute bound: `null` both where the bound is at least `nothing`, of which a number says nothing.
    pub fn with_absolute_bound(value: Option<Ball>, nothing: f64) -> [JsonNumber; 2] {
        value.filter(|value| value.rad < nothing).map_or([JsonNumber::NULL; 2], |value| {
            [JsonNumber::from_enclosure(value), JsonNumber::absolute_bound(value)]
        })
    }

    /// A phase in degrees and its absolute bound.
    pub fn phase(value: Option<Ball>) -> [JsonNumber; 2] {
        JsonNumber::with_absolute_bound(value, 180.0)
    }

    /// `null` if nothing is known.
    pub fn bound(bound: Bound) -> JsonNumber {
        JsonNumber(Some(bound.value()).filter(|bound| bound.is_finite()))
    }

    /// A number without a bound; README.md lists them.
    pub fn unproven(Unproven(value): Unproven) -> JsonNumber {
        JsonNumber(Some(value + 0.0).filter(|value| value.is_finite()))
    }

    /// The number, or `null` if the condition does not hold.
    pub fn only_if(self, condition: bool) -> JsonNumber {
        if condition { self } else { JsonNumber::NULL }
    }

    /// Whether the number is unknown or infinite.
    pub fn is_null(&self) -> bool {
        self.0.is_none()
    }

    /// The number in binary64, `missing` for `null`.
    pub fn or(self, missing: f64) -> f64 {
        self.0.unwrap_or(missing)
    }

    /// The number as a field of CSV: empty for `null`.
    pub fn field(self) -> String {
        self.0.map_or(String::new(), |number| serde_json::to_string(&number).expect("a finite number has a JSON form"))
    }

    /// Adds this field to a text.
    pub fn push_field(self, text: &mut Vec<u8>) {
        if let Some(number) = self.0 {
            serde_json::to_writer(text, &number).expect("a finite number has a JSON form");
        }
    }
}

/// The bounds of the modal report, whose numbers refer to the rest. A bound of the linear system there is a bound of
/// the scene only if the rest is proven; otherwise each bound is `null`, because it would be mistaken for one of the
/// scene.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    hold: bool,
}

impl Bounds {
    pub fn about_rest_of(answer: &ModalAnswer) -> Bounds {
        Bounds { hold: answer.rest.is_proven() }
    }

    /// Whether the bounds are bounds of the scene.
    pub fn hold(self) -> bool {
        self.hold
    }

    /// A bound of |x - true| / |true| for the x of [`JsonNumber::from_enclosure`].
    pub fn relative(self, value: Ball) -> JsonNumber {
        JsonNumber::relative_bound(value).only_if(self.hold)
    }

    /// A bound of |x - true| for the x of [`JsonNumber::from_enclosure`].
    pub fn absolute(self, value: Ball) -> JsonNumber {
        JsonNumber::absolute_bound(value).only_if(self.hold)
    }

    pub fn of(self, bound: Bound) -> JsonNumber {
        JsonNumber::bound(bound).only_if(self.hold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dd;

    fn number_text(number: JsonNumber) -> String {
        serde_json::to_string(&number).expect("JSON")
    }

    #[test]
    fn nothing_known_and_infinite_numbers_are_null() {
        for number in [
            JsonNumber::from_enclosure(Ball::new(Dd::ONE, f64::INFINITY)),
            JsonNumber::relative_bound(Ball::new(Dd::ZERO, 1.0)),
            JsonNumber::bound(Bound::UNKNOWN),
            JsonNumber::unproven(Unproven(f64::NAN)),
            JsonNumber::of(None),
        ] {
            assert_eq!(number_text(number), "null");
        }
    }

    #[test]
    fn numbers_are_in_the_shortest_form_without_a_negative_zero() {
        assert_eq!(number_text(JsonNumber::from_enclosure(Ball::from(0.1))), "0.1");
        assert_eq!(number_text(JsonNumber::from_enclosure(-Ball::ZERO)), "0.0");
        assert_eq!(number_text(JsonNumber::unproven(Unproven(-0.0))), "0.0");
        assert_eq!(number_text(JsonNumber::absolute_bound(Ball::ONE)), "0.0");
    }
}
