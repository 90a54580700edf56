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

impl Tenths {
    /// Its digits. They are made by hand, from the last to the first, since a figure has thousands of numbers.
    fn write_digits(self, digits: &mut [u8; 24]) -> &str {
        let mut at = digits.len();
        let mut put = |byte: u8| {
            at -= 1;
            digits[at] = byte;
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
        std::str::from_utf8(&digits[at..]).unwrap_or_default()
    }

    /// Writes the number without the formatter's machinery.
    fn put(self, text: &mut String) {
        text.push_str(self.write_digits(&mut [0; 24]));
    }
}

impl fmt::Display for Tenths {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.write_digits(&mut [0; 24]))
    }
}

/// A line in the syntax of `<path d="...">`: its start, then relative steps.
pub fn path(text: &mut String, points: &[Point], closed: bool) {
    let mut rounded = points.iter().map(|point| (Tenths::of(point.x), Tenths::of(point.y)));
    let Some((mut x, mut y)) = rounded.next() else { return };
    put_pair(text, 'M', x, y);
    for (next_x, next_y) in rounded {
        match (next_x.minus(x), next_y.minus(y)) {
            (Tenths(0), Tenths(0)) => {}
            (Tenths(0), dy) => {
                text.push('v');
                dy.put(text);
            }
            (dx, Tenths(0)) => {
                text.push('h');
                dx.put(text);
            }
            (dx, dy) => put_pair(text, 'l', dx, dy),
        }
        (x, y) = (next_x, next_y);
    }
    if closed {
        text.push('z');
    }
}

/// `before`, then two numbers.
pub fn put_pair(text: &mut String, before: char, x: Tenths, y: Tenths) {
    text.push(before);
    x.put(text);
    text.push(' ');
    y.put(text);
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
