//! Gravity: one arrow beside the scene, with `g`.

use super::{Of, Sheet, arrow};
use crate::picture::Detail;
use crate::picture::figure::{Kind, Pen};
use crate::picture::geometry::{Bounds, Point};
use crate::picture::layout::straight;

const LENGTH: f64 = 38.0;

pub fn draw(sheet: &mut Sheet, bounds: Bounds) {
    let gravity = &sheet.scene.gravity;
    if gravity.is_zero() {
        return;
    }
    let [x, y] = straight(gravity);
    let along = Point::new(x, -y);
    let middle = Point::new(bounds.high.x + 26.0 + LENGTH / 2.0 * along.x.abs(), bounds.low.y + LENGTH / 2.0 + 4.0);
    let size = gravity.dot(gravity);
    let size = size.sqrt().unwrap_or(size);
    let of = Of { title: format!("gravity, {} m/s^2", (sheet.request.digits)(&size)), span: sheet.scene.gravity_span };
    let strokes = arrow::single(middle.towards(along, -LENGTH / 2.0), middle.towards(along, LENGTH / 2.0), Pen::Normal);
    let text = match sheet.request.values {
        true => format!("g = {} m/s^2", (sheet.request.digits)(&size)),
        false => "g".into(),
    };
    let span = sheet.scene.gravity_span;
    sheet.push(Kind::Gravity, of, strokes);
    if sheet.detail == Detail::Full {
        let half = Point::new(along.x.abs() * LENGTH / 2.0 + 4.0, along.y.abs() * LENGTH / 2.0 + 4.0);
        sheet.label(text, span, middle, half, &[along.across().times(-1.0), along.across()]);
    }
}
