//! The components that come with the program: the files of `library/`, by the name that a `use` gives them.

/// The prefix of the names in `use "std/..."`.
pub const PREFIX: &str = "std/";

/// Names without the prefix, and texts.
const FILES: [(&str, &str); 6] = [
    ("absorber.vib", include_str!("../library/absorber.vib")),
    ("geared_shafts.vib", include_str!("../library/geared_shafts.vib")),
    ("isolator.vib", include_str!("../library/isolator.vib")),
    ("oscillator.vib", include_str!("../library/oscillator.vib")),
    ("quarter_car.vib", include_str!("../library/quarter_car.vib")),
    ("storey.vib", include_str!("../library/storey.vib")),
];

/// The text of a file, by its name without the prefix.
pub fn text(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The names as a `use` writes them.
pub fn names() -> impl Iterator<Item = String> {
    FILES.iter().map(|(name, _)| format!("{PREFIX}{name}"))
}
