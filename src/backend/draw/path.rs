//! Coordinates of a figure in tenths of a pixel: integers, so that the same figure has the same bytes.

use crate::picture::geometry::Point;
use std::fmt;

/// A coordinate, rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tenths(i64);

impl Tenths {
    pub fn of(x: f64) -> Tenths {
        Tenths((x * 10.0).round() as i64)
    }

    fn minus(self, o: Tenths) -> Tenths {
        Tenths(self.0 - o.0)
    }
}

impl fmt::Display for Tenths {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // Digits from the last to the first; written by hand, since a figure has thousands of numbers.
        let (mut text, mut at) = ([0; 24], 24);
        let mut put = |byte: u8| {
            at -= 1;
            text[at] = byte;
        };
        let size = self.0.unsigned_abs();
        let (mut whole, tenths) = (size / 10, (size % 10) as u8);
        if tenths > 0 {
            put(b'0' + tenths);
            put(b'.');
        }
        while whole > 0 {
            put(b'0' + (whole % 10) as u8);
            whole /= 10;
        }
        if size == 0 {
            put(b'0');
        }
        if self.0 < 0 {
            put(b'-');
        }
        f.write_str(std::str::from_utf8(&text[at..]).unwrap_or_default())
    }
}

/// A line in the syntax of `<path d="...">`: its start, then relative steps.
pub fn path(text: &mut String, points: &[Point], closed: bool) {
    use std::fmt::Write;
    let mut rounded = points.iter().map(|point| (Tenths::of(point.x), Tenths::of(point.y)));
    let Some((mut x, mut y)) = rounded.next() else { return };
    // Writing to a string cannot fail.
    let _ = write!(text, "M{x} {y}");
    for (next_x, next_y) in rounded {
        let (dx, dy) = (next_x.minus(x), next_y.minus(y));
        let _ = match (dx, dy) {
            (Tenths(0), Tenths(0)) => Ok(()),
            (Tenths(0), dy) => write!(text, "v{dy}"),
            (dx, Tenths(0)) => write!(text, "h{dx}"),
            (dx, dy) => write!(text, "l{dx} {dy}"),
        };
        (x, y) = (next_x, next_y);
    }
    if closed {
        text.push('z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_short_and_exact() {
        let mut text = String::new();
        let points = [(0.04, 10.0), (5.26, 10.0), (5.26, 9.6), (4.0, 8.0)].map(|(x, y)| Point::new(x, y));
        path(&mut text, &points, true);
        assert_eq!(text, "M0 10h5.3v-.4l-1.3 -1.6z");
    }
}
