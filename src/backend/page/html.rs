//! The page itself: its sections in order, its security policy, its style and its script.

use super::payload::payload;
use super::tables::{self, Lines};
use super::{Answers, MotionShown, Page, Text, TransferShown};
use crate::answers::ModalAnswer;
use crate::answers::report::{self, Block, Options, Report, Section};
use crate::backend::draw::{self, escape};
use crate::backend::plain;
use crate::base::{Diagnostic, Severity};
use crate::questions::answer::Sensitivity;
use sha2::{Digest, Sha256};
use std::sync::LazyLock;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Hashes of the style and the script, for the security policy.
static HASHES: LazyLock<[String; 2]> = LazyLock::new(|| [STYLE, SCRIPT].map(hash));

/// The whole file.
pub fn page(page: &Page) -> String {
    let title = escape(page.name);
    // A page read from a file requests nothing; a page that is served asks its server for newer versions of itself.
    let (connect, live) = match page.version {
        Some(version) => ("connect-src 'self'; ", format!(" data-live=\"{version}\"")),
        None => ("", String::new()),
    };
    let policy = format!(
        "default-src 'none'; {connect}style-src 'sha256-{}'; script-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
        HASHES[0], HASHES[1]
    );
    let (main, payload) = (main(page), payload(page));
    let mut text = String::with_capacity(STYLE.len() + SCRIPT.len() + main.len() + payload.len() + 2048);
    for part in [
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"",
        &policy,
        "\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
        &title,
        "</title>\n<style>",
        STYLE,
        "</style>\n</head>\n<body",
        &live,
        ">\n",
        &main,
        "<script type=\"application/json\" id=\"payload\">",
        &payload,
        "</script>\n<script>",
        SCRIPT,
        "</script>\n</body>\n</html>\n",
    ] {
        text += part;
    }
    text
}

/// The hash of a security policy: SHA-256 in base 64.
fn hash(text: &str) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes = Sha256::digest(text.as_bytes());
    let mut encoded = String::new();
    for group in bytes.chunks(3) {
        let bits = group.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - group.len()));
        for place in 0..4 {
            let digit = (bits >> (18 - 6 * place)) & 63;
            encoded.push(if place <= group.len() { DIGITS[digit as usize] as char } else { '=' });
        }
    }
    encoded
}

fn main(page: &Page) -> String {
    let mut text = String::from("<main id=\"page\">\n");
    text += &findings(page);
    let lines = Lines::of(page.of.sources, page.of.model);
    match &page.answers {
        Some(answers) => text += &sections(answers, &lines),
        None => text += &format!("<h1>{}</h1>\n", escape(page.name)),
    }
    if page.shows_text {
        text += &model(&page.text, page.findings);
    }
    text + "</main>\n"
}

/// The sections in the order of a reader's questions.
fn sections(of: &Answers, lines: &Lines) -> String {
    let report = of.report;
    let mut text = format!("<h1>{}</h1>\n", tables::line(&report.title, lines));
    text += &figure(of, lines);
    let (before, after): (Vec<&Section>, Vec<&Section>) =
        report.sections.iter().partition(|section| !matches!(section.heading, "Sensitivities" | "Independent parts"));
    for section in before {
        text += &section_heading(section, lines, of);
        match section.heading {
            "Equations of motion" => text += &of.equations.map_or(String::new(), symbols),
            "Damped motion" => text += &poles(of),
            _ => {}
        }
    }
    text += &of.transfer.map_or(String::new(), |shown| transfer(of, shown, lines));
    text += &of.motion.map_or(String::new(), |shown| motion(of, shown, lines));
    for section in after {
        text += &section_heading(section, lines, of);
        if section.heading == "Sensitivities" {
            text += &slopes(of.sensitivities);
        }
    }
    text
}

/// Too long for most readers: collapsed until it is opened.
fn symbols(equations: &str) -> String {
    format!(
        "<details>\n<summary>In the model's own symbols</summary>\n<div class=\"wide\" tabindex=\"0\" role=\"group\" \
         aria-label=\"equations in symbols\">\n{equations}</div>\n</details>\n"
    )
}

fn section_heading(section: &Section, lines: &Lines, of: &Answers) -> String {
    // A first line that only repeats the heading is left out.
    let repeats = |block: &Block| match block {
        Block::Line(line) => plain::line(line).eq_ignore_ascii_case(section.heading),
        _ => false,
    };
    let blocks = section.blocks.iter().skip_while(|block| repeats(block));
    format!("<h2>{}</h2>\n{}", escape(section.heading), tables::blocks(blocks, lines, of.entries))
}

fn figure(of: &Answers, lines: &Lines) -> String {
    let (shown, _) = match of.figure {
        Ok(shown) => shown,
        Err(reason) => return format!("<p>no figure: {}</p>\n", escape(reason)),
    };
    let notes: Vec<String> = shown.notes.iter().map(|note| escape(&note.text)).collect();
    let svg = draw::element(shown, |span| lines.line(span));
    let controls = if of.movements.list.is_empty() { String::new() } else { controls(of) };
    format!(
        "<section id=\"figure\" aria-label=\"figure\">\n<figure>\n{svg}<figcaption>{}</figcaption>\n</figure>\n{controls}</section>\n",
        notes.join("; ")
    )
}

fn controls(of: &Answers) -> String {
    let time = of.motion.map(|_| "the motion over time".to_string());
    let captions = of.movements.list.iter().map(|movement| escape(&movement.caption)).chain(time);
    let options: String =
        captions.enumerate().map(|(index, caption)| format!("<option value=\"{index}\">{caption}</option>")).collect();
    format!(
        "<div class=\"controls\">\n<label>motion <select id=\"motion\">{options}</select></label>\n\
         <button type=\"button\" id=\"play\">Play</button>\n<button type=\"button\" id=\"rest\">At rest</button>\n\
         <label>speed <input type=\"range\" id=\"speed\" min=\"0.1\" max=\"3\" step=\"0.1\" value=\"1\"></label>\n\
         <label>amplitude <input type=\"range\" id=\"scale\" min=\"0\" max=\"2\" step=\"0.05\" value=\"1\"></label>\n\
         <label>phase <input type=\"range\" id=\"phase\" min=\"0\" max=\"360\" step=\"1\" value=\"0\"></label>\n\
         </div>\n<p id=\"says\"></p>\n"
    )
}

fn poles(of: &Answers) -> String {
    if of.poles.is_empty() {
        return String::new();
    }
    "<figure>\n<svg id=\"poles\" class=\"chart\" role=\"img\" aria-label=\"poles in the complex plane, with lines of equal damping; the \
     table has their numbers\"></svg>\n<figcaption>poles in the complex plane, with lines of equal damping</figcaption>\n\
     </figure>\n"
        .into()
}

fn slopes(of: &[Sensitivity]) -> String {
    let Some(one) = of.first() else { return String::new() };
    let frequencies = (0..one.frequencies.len()).map(|i| format!("undamped frequency {}", one.first + i));
    let ratios = (0..one.ratios.len()).map(|i| format!("damping ratio {}", i + 1));
    let measures = options(frequencies.chain(ratios));
    format!(
        "<div class=\"controls\"><label>change of <select id=\"slope\">{measures}</select></label></div>\n<figure>\n<svg id=\"bars\" \
         class=\"chart\" role=\"img\" aria-label=\"change in percent for a change of each parameter by one percent; the table has the \
         numbers\"></svg>\n</figure>\n"
    )
}

fn options(names: impl Iterator<Item = String>) -> String {
    names.enumerate().map(|(index, name)| format!("<option value=\"{index}\">{}</option>", escape(&name))).collect()
}

fn transfer(of: &Answers, shown: &TransferShown, lines: &Lines) -> String {
    let (system, table) = (of.system, &shown.table);
    let inputs = options(table.inputs.iter().map(|&i| system.display(system.inputs[i].name)));
    let outputs = options(table.outputs.iter().map(|&o| system.display(system.outputs[o].name)));
    let pair = |(index, report): (usize, &Report)| {
        let (i, o) = (index / table.outputs.len(), index % table.outputs.len());
        let hidden = if index == 0 { "" } else { " hidden" };
        format!("<div data-pair=\"{i} {o}\"{hidden}>\n{}</div>\n", of_report(report, lines))
    };
    let features: String = shown.reports.iter().enumerate().map(pair).collect();
    format!(
        "<h2>Transfer functions</h2>\n<div class=\"controls\">\n<label>from <select id=\"from\">{inputs}</select></label>\n\
         <label>to <select id=\"to\">{outputs}</select></label>\n\
         <label>as <select id=\"view\"><option value=\"bode\">gain and phase</option><option value=\"nyquist\">Nyquist plot</option>\
         </select></label>\n<button type=\"button\" id=\"closer\">Closer</button>\n<button type=\"button\" id=\"wider\">Wider</button>\n\
         <button type=\"button\" id=\"whole\">Whole range</button>\n<output id=\"reading\" for=\"gain\"></output>\n</div>\n\
         <figure>\n<svg id=\"gain\" class=\"chart\" tabindex=\"0\" role=\"application\" aria-label=\"gain over frequency: arrow keys \
         move the cursor, plus and minus zoom, page keys move the window; the table below has peaks and antiresonances\"></svg>\n\
         <svg id=\"phase-plot\" class=\"chart\" role=\"img\" aria-label=\"phase over frequency\"></svg>\n</figure>\n\
         <div id=\"features\">\n{features}</div>\n"
    )
}

/// The title of a modal report and its tables of modes and of damped motion, as an element of another page: without links,
/// style or script.
pub fn modal_table(answer: &ModalAnswer, options: &Options) -> String {
    let Report { title, mut sections } = report::modal(answer, options);
    sections.retain(|section| matches!(section.heading, "Undamped modes" | "Damped motion"));
    of_report(&Report { title, sections }, &Lines::none())
}

fn of_report(report: &Report, lines: &Lines) -> String {
    let sections: String = report
        .sections
        .iter()
        .map(|section| format!("<h4>{}</h4>\n{}", escape(section.heading), tables::blocks(&section.blocks, lines, &[])))
        .collect();
    format!("<h3>{}</h3>\n{sections}", tables::line(&report.title, lines))
}

fn motion(of: &Answers, shown: &MotionShown, lines: &Lines) -> String {
    let mut units: Vec<String> = Vec::new();
    for output in &of.system.outputs {
        if !units.contains(&output.unit) {
            units.push(output.unit.clone());
        }
    }
    let choice = match units.len() {
        0 | 1 => String::new(),
        _ => format!(
            "<div class=\"controls\"><label>outputs in <select id=\"unit\">{}</select></label></div>\n",
            options(units.into_iter())
        ),
    };
    let plot = match of.system.outputs.is_empty() {
        true => "",
        false => {
            "<figure>\n<svg id=\"history\" class=\"chart\" role=\"img\" aria-label=\"outputs over time; the table has their extremes\">\
             </svg>\n</figure>\n"
        }
    };
    format!("<h2>Motion</h2>\n{choice}{plot}{}", of_report(&shown.report, lines))
}

/// The errors, with their lines.
fn findings(page: &Page) -> String {
    let errors: Vec<&Diagnostic> = page.findings.iter().filter(|finding| finding.severity == Severity::Error).collect();
    if errors.is_empty() {
        return String::new();
    }
    let lines = Lines::of(page.text.sources, page.text.model);
    let item = |finding: &&Diagnostic| {
        let help: String = finding.help.iter().map(|help| format!("<br>{}", escape(help))).collect();
        let text = format!("{} ({})", escape(&finding.message), escape(finding.code.0));
        match lines.line(Some(finding.primary.span)) {
            Some(line) => format!("<li><a href=\"#L{line}\" data-line=\"{line}\">line {line}</a>: {text}{help}</li>\n"),
            None => format!("<li>{text}{help}</li>\n"),
        }
    };
    let list: String = errors.iter().map(item).collect();
    let rest = if page.answers.is_some() { "<p>Below is what the last version without errors said.</p>\n" } else { "" };
    format!("<section class=\"findings\" role=\"alert\" aria-label=\"errors\">\n<ul>\n{list}</ul>\n{rest}</section>\n")
}

fn model(text: &Text, findings: &[Diagnostic]) -> String {
    let lines = Lines::of(text.sources, text.model);
    let errors = findings.iter().filter(|finding| finding.severity == Severity::Error);
    let wrong: Vec<usize> = errors.filter_map(|finding| lines.line(Some(finding.primary.span))).collect();
    let line = |(number, line): (usize, &str)| {
        let class = if wrong.contains(&number) { " class=\"wrong\"" } else { "" };
        let text = escape(line.trim_end_matches('\r'));
        format!("<li id=\"L{number}\"{class}><a class=\"n\" href=\"#L{number}\">{number}</a><code>{text}</code></li>\n")
    };
    let list: String = (1..).zip(text.sources.text(text.model).lines()).map(line).collect();
    format!("<h2>The model</h2>\n<ol class=\"text\">\n{list}</ol>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-4: SHA-256 of the empty text and of `abc`.
    #[test]
    fn hashes_are_those_of_the_standard() {
        assert_eq!(hash(""), "47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=");
        assert_eq!(hash("abc"), "ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
    }
}
