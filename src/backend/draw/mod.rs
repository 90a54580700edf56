//! A figure as SVG: one group per glyph, with the line of the model that it represents. See docs/draw.md.

pub(super) mod path;

use super::decimal::certain;
use crate::analysis::derived::hertz;
use crate::analysis::{Mode, ModeKind, Share};
use crate::base::readable::visible;
use crate::base::{FileId, LineIndex, Name, Sources, Span};
use crate::picture::figure::Hold;
use crate::picture::{Figure, Glyph, Item, Label, Pen, Ride, Stroke};
use crate::system::Source;
use path::{Tenths, path, put_pair};
use std::fmt::{self, Write};

/// Colours follow the page (`currentColor`) or, in a standalone figure, the preference of the viewer.
const STYLE: &str = "\
.vibc-figure{color:#1c2128;font:12px Verdana,'DejaVu Sans',sans-serif}
.vibc-figure path,.vibc-figure circle{fill:none;stroke:currentColor;stroke-width:1.4;stroke-linejoin:round;stroke-linecap:round}
.vibc-figure .b{fill:#e9edf2;stroke-width:1.8}
.vibc-figure .p{fill:#fff}
.vibc-figure .t{stroke-width:.9}
.vibc-figure .d{stroke-dasharray:5 4}
.vibc-figure .f{stroke-dasharray:2 2;opacity:.6}
.vibc-figure .s{fill:currentColor;stroke-width:.5}
.vibc-figure .leader path{opacity:.55;stroke-width:.7}
.vibc-figure .ghost{opacity:.28}
.vibc-figure text{fill:currentColor;stroke:none}
.vibc-figure .note{opacity:.8}
@media (prefers-color-scheme:dark){.vibc-figure{color:#e3e7ed}.vibc-figure .b{fill:#2b323c}.vibc-figure .p{fill:#14171b}}
";

/// The whole file. `model` is the file whose lines the spans refer to.
pub fn svg(figure: &Figure, sources: &Sources, model: FileId) -> String {
    let lines = Lines { model, index: LineIndex::new(sources.text(model)) };
    let mut text = String::new();
    let (width, height) = (Tenths::of(figure.width), Tenths::of(figure.height));
    put(
        &mut text,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"vibc-figure\" role=\"img\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\" style=\"max-width:100%;height:auto\">\n\
             <title>{}</title>\n<style>\n{STYLE}</style>\n",
            escape(&figure.name),
        ),
    );
    let mut glyphs = figure.glyphs.iter().peekable();
    if glyphs.peek().is_some_and(|glyph| glyph.ghost) {
        text.push_str("<g class=\"ghost\" aria-hidden=\"true\">\n");
        while let Some(behind) = glyphs.next_if(|glyph| glyph.ghost) {
            strokes(&mut text, &behind.strokes);
            text.push('\n');
        }
        text.push_str("</g>\n");
    }
    for shown in glyphs {
        glyph(&mut text, shown, &lines);
    }
    for shown in &figure.labels {
        label(&mut text, shown, lines.attribute(shown.span), &Ride::Still);
    }
    for note in &figure.notes {
        let (x, y) = (Tenths::of(note.at.x), Tenths::of(note.at.y + BASELINE));
        put(&mut text, format_args!("<text class=\"note\" x=\"{x}\" y=\"{y}\">{}</text>\n", escape(&note.text)));
    }
    text.push_str("</svg>\n");
    text
}

/// The figure as an element of a page that has the style. Each stroke names the parts that it moves with: `data-with` a
/// part; `data-at` a point that follows a point of a part, or `data-between` two of them, each `part x y x y`.
pub fn element(figure: &Figure, line: impl Fn(Option<Span>) -> Option<usize>) -> String {
    let (width, height) = (Tenths::of(figure.width), Tenths::of(figure.height));
    let mut text = String::new();
    put(
        &mut text,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"vibc-figure\" role=\"img\" aria-label=\"figure of {}\" \
             width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n",
            escape(&figure.name)
        ),
    );
    for shown in &figure.glyphs {
        let (class, line, title) = (shown.kind.class(), DataLine(line(shown.span)), escape(&shown.title));
        let item = match shown.item {
            Some(Item::Body(body)) => format!(" data-item=\"b{body}\""),
            Some(Item::Element(element)) => format!(" data-item=\"e{element}\""),
            None => String::new(),
        };
        put(&mut text, format_args!("<g class=\"glyph {class}\"{line}{item}><title>{title}</title>"));
        let ends = shown.rides.iter().skip(1).map(|(start, _)| *start).chain([shown.strokes.len()]);
        let still = shown.rides.first().map_or(shown.strokes.len(), |(start, _)| *start);
        strokes(&mut text, &shown.strokes[..still]);
        for ((start, ride), end) in shown.rides.iter().zip(ends) {
            text.push_str("<g");
            rides(&mut text, ride);
            text.push('>');
            strokes(&mut text, &shown.strokes[*start..end]);
            text.push_str("</g>");
        }
        text.push_str("</g>\n");
    }
    for shown in &figure.labels {
        label(&mut text, shown, DataLine(line(shown.span)), &shown.ride);
    }
    text.push_str("</svg>\n");
    text
}

/// The attribute that says what a stroke moves with; nothing for one that stands still.
fn rides(text: &mut String, ride: &Ride) {
    match ride {
        Ride::Still => {}
        Ride::With(part) => put(text, format_args!(" data-with=\"{part}\"")),
        Ride::At(at) => {
            text.push_str(" data-at=\"");
            hold(text, at);
            text.push('"');
        }
        Ride::Between([a, b]) => {
            text.push_str(" data-between=\"");
            hold(text, a);
            text.push(';');
            hold(text, b);
            text.push('"');
        }
    }
}

fn hold(text: &mut String, hold: &Hold) {
    put(text, format_args!("{}", hold.part));
    for point in [hold.of, hold.at] {
        put_pair(text, ' ', Tenths::of(point.x), Tenths::of(point.y));
    }
}

/// `mode 2: 0.5964 Hz (3.747 rad/s)`; without digits about a rest that is not proven.
pub fn mode_caption(number: u32, mode: &Mode, proven: bool) -> String {
    const DIGITS: usize = 4;
    if !proven {
        return format!("mode {number}, about a rest that is not proven");
    }
    let omega = certain(&mode.omega, DIGITS);
    match mode.kind {
        ModeKind::Oscillation => {
            format!("mode {number}: {} Hz ({omega} rad/s)", certain(&hertz(mode.omega), DIGITS))
        }
        ModeKind::Rigid => format!("mode {number}: rigid"),
        ModeKind::Divergence => format!("mode {number}: diverges at {omega} 1/s"),
        ModeKind::Undetermined => format!("mode {number}: undetermined (oscillates or diverges)"),
    }
}

/// The share of a part in a mode's energy, of the kind that the part has.
pub fn energy_of(mode: &Mode, name: Name) -> Option<String> {
    let share = |shares: &[Share<Source>]| {
        let found = shares.iter().find(|share| share.of.name == name);
        found.map(|share| share.part.0)
    };
    let percent = |part: f64| format!("{:.0} %", 100.0 * part);
    let kinetic = share(&mode.kinetic).map(|part| format!("{} of the kinetic energy", percent(part)));
    kinetic.or_else(|| share(&mode.strain).map(|part| format!("{} of the strain energy", percent(part))))
}

/// Distance from the middle of a line of text down to its baseline, px.
const BASELINE: f64 = 4.4;

struct Lines {
    model: FileId,
    index: LineIndex,
}

impl Lines {
    /// The line of an object; none for one from another file.
    fn attribute(&self, span: Option<Span>) -> DataLine {
        DataLine(span.filter(|span| span.file() == self.model).map(|span| self.index.line(span.start()) + 1))
    }
}

/// ` data-line="17"`, counted from 1; empty without a line.
struct DataLine(Option<usize>);

impl fmt::Display for DataLine {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(f, " data-line=\"{line}\""))
    }
}

fn glyph(text: &mut String, glyph: &Glyph, lines: &Lines) {
    let (class, line, title) = (glyph.kind.class(), lines.attribute(glyph.span), escape(&glyph.title));
    put(text, format_args!("<g class=\"glyph {class}\"{line}><title>{title}</title>"));
    strokes(text, &glyph.strokes);
    text.push_str("</g>\n");
}

/// Consecutive lines of one pen become one path.
fn strokes(text: &mut String, strokes: &[Stroke]) {
    let mut open = None;
    for stroke in strokes {
        match stroke {
            Stroke::Line { points, closed, pen } => {
                // A line that covers the objects behind it is a separate path.
                let covers = pen.fills() && *pen != Pen::Solid;
                if open != Some(*pen) || covers {
                    close(text, &mut open);
                    put(text, format_args!("<path class=\"{}\" d=\"", pen.class()));
                    open = Some(*pen);
                }
                path(text, points, *closed);
            }
            Stroke::Circle { centre, radius, pen } => {
                close(text, &mut open);
                let (x, y, r) = (Tenths::of(centre.x), Tenths::of(centre.y), Tenths::of(*radius));
                put(text, format_args!("<circle class=\"{}\" cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>", pen.class()));
            }
        }
    }
    close(text, &mut open);
}

fn close<T>(text: &mut String, open: &mut Option<T>) {
    if open.take().is_some() {
        text.push_str("\"/>");
    }
}

fn label(text: &mut String, label: &Label, line: DataLine, ride: &Ride) {
    put(text, format_args!("<text class=\"label\"{line}"));
    rides(text, ride);
    let (x, y, width) = (Tenths::of(label.at.x), Tenths::of(label.at.y + BASELINE), Tenths::of(label.width()));
    put(
        text,
        format_args!(
            " x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" textLength=\"{width}\" \
             lengthAdjust=\"spacingAndGlyphs\">{}</text>\n",
            escape(&label.text)
        ),
    );
}

/// Escapes text of a user's file for XML: it cannot act as markup or change the direction of text.
pub fn escape(text: &str) -> String {
    let is_plain = |byte: u8| (b' '..0x7f).contains(&byte) && !matches!(byte, b'&' | b'<' | b'>' | b'"' | b'\'');
    if text.bytes().all(is_plain) {
        return text.to_string();
    }
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // These characters are not allowed in XML.
            '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            c => safe.push(visible(c)),
        }
    }
    safe
}

fn put(text: &mut String, arguments: fmt::Arguments) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(arguments);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_name_is_markup() {
        assert_eq!(
            escape("</title><script>alert('1')</script>\u{1b}\u{202e}\"&"),
            "&lt;/title&gt;&lt;script&gt;alert(&#39;1&#39;)&lt;/script&gt;␛\u{fffd}&quot;&amp;"
        );
    }
}
