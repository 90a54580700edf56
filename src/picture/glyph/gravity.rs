//! Gravity: one arrow beside the scene, with `g`.

use super::{Sheet, Subject, arrow};
use crate::picture::figure::{Kind, Pen};
use crate::picture::geometry::{Bounds, Point};
use crate::picture::layout::straight;
use crate::picture::occupied::Occupied;

const LENGTH: f64 = 38.0;

pub fn draw(sheet: &mut Sheet, bounds: Bounds, room: &mut Occupied) {
    let gravity = &sheet.scene.gravity;
    if gravity.is_zero() {
        return;
    }
    let [x, y] = straight(gravity);
    let along = Point::new(x, -y);
    // Beside the scene, or further away if there is a name already.
    let tries = arrow::offsets(26.0).map(|off| {
        let x = bounds.high.x + off + LENGTH / 2.0 * along.x.abs();
        let middle = Point::new(x, bounds.low.y + LENGTH / 2.0 + 4.0);
        arrow::single(middle.towards(along, -LENGTH / 2.0), middle.towards(along, LENGTH / 2.0), Pen::Normal)
    });
    let tries = tries.collect();
    let size = gravity.dot(gravity);
    let size = size.sqrt().unwrap_or(size);
    let of =
        Subject { title: format!("gravity, {} m/s^2", (sheet.request.digits)(&size)), span: sheet.scene.gravity_span };
    let text = match sheet.request.values {
        true => format!("g = {} m/s^2", (sheet.request.digits)(&size)),
        false => "g".into(),
    };
    let span = sheet.scene.gravity_span;
    if let Some(bounds) = sheet.choose(Kind::Gravity, of, tries, room) {
        sheet.label_beside(text, span, bounds, &[along.perpendicular().times(-1.0), along.perpendicular()]);
    }
}
