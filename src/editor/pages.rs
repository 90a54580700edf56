//! Documentation of the words of the language: keywords, fields, functions, motions, units.

use super::shown;
use crate::base::unit::{self, Scale};
use crate::base::{Number, Quantity};
use crate::kinds::motions::{BODY_MOTIONS, ELEMENT_MOTIONS, reactions};
use crate::kinds::{self, Declaration, functions};

/// The page of a keyword.
pub fn keyword(word: &str) -> Option<String> {
    kinds::declaration(word).map(Declaration::page)
}

pub fn field(keyword: &str, word: &str) -> Option<String> {
    let field = kinds::declaration(keyword)?.field(word)?;
    Some(format!("`{}`\n\n{}", field.example, field.meaning))
}

pub fn function(word: &str) -> Option<String> {
    let (_, function) = functions::function(word)?;
    Some(format!("`{}`\n\n{}", function.form, function.meaning))
}

pub fn motion(word: &str) -> Option<&'static str> {
    let bodies = BODY_MOTIONS.iter().map(|motion| (motion.name, motion.meaning));
    let elements = ELEMENT_MOTIONS.iter().map(|(_, name, meaning)| (*name, *meaning));
    bodies.chain(elements).chain(reactions()).find(|(name, _)| *name == word).map(|(_, meaning)| meaning)
}

/// The meaning of the words within declarations.
pub fn word(word: &str) -> Option<&'static str> {
    Some(match word {
        "ground" => "The support that never moves.",
        "pi" => "The circle constant.",
        "stable" => {
            "A measure: whether the rest is stable: no small motion grows, and stiffness restrains every motion."
        }
        "load_factor" => {
            "A measure: the factor by which all loads at rest can grow before some motion loses its stiffness."
        }
        "along" => "A fixed direction: `x`, `y` or a vector, whose length does not matter.",
        "about" => "The reference point of an inertia.",
        "over" => "Before the parameters that `minimise` or `maximise` varies.",
        "while" => "Before the conditions that the values found by `minimise` or `maximise` must meet.",
        "within" => {
            "A tolerance of a `param`: a share of its value, a half-width or a range, which contains the value."
        }
        "spread" => "The random distribution of a `param`: its standard deviation, or `lognormal` or `uniform`.",
        "in" => "Before a range, including its bounds; of an output the unit that it is shown in.",
        "white" => "In `noise`: the density is the same at all frequencies, as in `noise(white 3 N^2/Hz)`.",
        "road" => {
            "In `noise`: a road profile of ISO 8608, `road(16e-6 m^3, 20 m/s)`: its roughness at 0.1 cycles per metre, and the speed."
        }
        "modal" => "The same damping ratio for every mode.",
        "as" | "drawn" => "The drawing is the rest: the tensions that balance it are computed.",
        _ => return kinds::field(word).filter(|field| field.stands_alone()).map(|field| field.meaning),
    })
}

/// All meanings of a word of the language, as Markdown: keyword, function, field, motion, unit. `None` for any other
/// word.
pub fn meanings(asked: &str) -> Option<String> {
    if let Some(page) = keyword(asked) {
        return Some(page);
    }
    let mut meanings: Vec<String> = function(asked).into_iter().collect();
    meanings.extend(fields(asked));
    meanings.extend(motion(asked).map(|meaning| format!("Behind a dot, as in `output`: {meaning}")));
    let is_field = kinds::field(asked).is_some();
    meanings.extend(word(asked).filter(|_| !is_field).map(String::from));
    meanings.extend(unit(asked).map(|meaning| format!("As a unit: {meaning}.")));
    meanings.dedup();
    (!meanings.is_empty()).then(|| format!("# {asked}\n\n{}\n", meanings.join("\n\n")))
}

/// The meanings of a field in all declarations that have it; declarations with the same explanation share an entry.
fn fields(asked: &str) -> Vec<String> {
    let mut entries: Vec<(String, Vec<String>)> = Vec::new();
    for declaration in &kinds::DECLARATIONS {
        let Some(field) = declaration.field(asked) else { continue };
        let entry = format!("`{}`\n\n{}", field.example, field.meaning);
        let keyword = format!("`{}`", declaration.keyword);
        match entries.iter_mut().find(|(known, _)| *known == entry) {
            Some((_, keywords)) => keywords.push(keyword),
            None => entries.push((entry, vec![keyword])),
        }
    }
    let heads =
        entries.into_iter().map(|(entry, keywords)| format!("In {}: {entry}", kinds::enumeration(&keywords, "and")));
    heads.collect()
}

/// The quantity that a unit measures, and its size.
pub fn unit(text: &str) -> Option<String> {
    let unit = unit::parse(text).ok()?;
    let what = unit.dimension.noun().map_or_else(|| unit.dimension.to_string(), str::to_string);
    Some(match unit.scale {
        Scale::Decibel => "a level: the ratio 10^(x/20)".into(),
        Scale::Linear(factor) => {
            let one = Quantity { si: factor, dimension: unit.dimension, angle: unit.angle };
            let base = shown::in_base_units(&one);
            match one.si == Number::ONE && base == format!("1 {text}") {
                true => what,
                false => format!("{what}: 1 {text} = {base}"),
            }
        }
    })
}

/// Units that are proposed.
const UNITS: [&str; 72] = [
    "kg",
    "g",
    "t",
    "lb",
    "slug",
    "m",
    "mm",
    "cm",
    "um",
    "km",
    "inch",
    "ft",
    "s",
    "ms",
    "us",
    "min",
    "h",
    "N",
    "kN",
    "MN",
    "lbf",
    "kip",
    "N/m",
    "kN/m",
    "N/mm",
    "kN/mm",
    "MN/m",
    "lbf/inch",
    "lbf/ft",
    "N*s/m",
    "kN*s/m",
    "N*s/mm",
    "N*m/rad",
    "kN*m/rad",
    "N*m/deg",
    "N*m*s/rad",
    "kN*m*s/rad",
    "N*m",
    "kN*m",
    "N*mm",
    "kg*m^2",
    "g*cm^2",
    "kg*mm^2",
    "m/s",
    "mm/s",
    "km/h",
    "m/s^2",
    "mm/s^2",
    "g0",
    "Hz",
    "kHz",
    "rad/s",
    "rpm",
    "deg/s",
    "/s",
    "rad/s^2",
    "deg/s^2",
    "rad",
    "deg",
    "rev",
    "%",
    "dB",
    "N*s",
    "N*m*s",
    "J",
    "W",
    "kW",
    "Pa",
    "kPa",
    "MPa",
    "GPa",
    "K",
];

/// The units of a dimension, the usual one first; all units if no dimension is given.
pub fn units(wanted: Option<crate::base::Dimension>) -> Vec<&'static str> {
    let fits = |text: &&str| match (wanted, unit::parse(text)) {
        (None, _) => true,
        (Some(wanted), Ok(unit)) => unit.dimension == wanted,
        (Some(_), Err(_)) => false,
    };
    UNITS.iter().copied().filter(fits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dimension;

    /// Words of the models in spec.md.
    fn shown_words() -> Vec<&'static str> {
        let blocks = include_str!("../../spec.md").split("```vib\n").skip(1);
        let models = blocks.filter_map(|rest| rest.split("```").next());
        models.flat_map(|model| model.split(|c: char| !c.is_alphanumeric() && c != '_')).collect()
    }

    #[test]
    fn the_language_page_shows_every_word() {
        let shown = shown_words();
        // All kinds except the one that exists only in unit tests.
        let declarations = || kinds::DECLARATIONS.iter().filter(|declaration| declaration.keyword != "gadget");
        let keywords = declarations().map(|declaration| declaration.keyword);
        let fields = declarations().flat_map(|declaration| declaration.fields).map(|field| field.name);
        let functions = functions::functions().map(|(_, function)| function.name);
        let motions = BODY_MOTIONS.iter().map(|motion| motion.name);
        let motions =
            motions.chain(ELEMENT_MOTIONS.iter().map(|(_, name, _)| *name)).chain(reactions().map(|(name, _)| name));
        let words = keywords.chain(fields).chain(functions).chain(motions);
        let missing: Vec<&str> = words.filter(|word| !shown.contains(word)).collect();
        assert!(missing.is_empty(), "no model of spec.md shows {missing:?}");
    }

    #[test]
    fn every_unit_that_is_offered_is_one() {
        for text in UNITS {
            assert!(unit::parse(text).is_ok(), "{text}");
        }
        assert_eq!(units(Some(Dimension::STIFFNESS)).first(), Some(&"N/m"));
        assert_eq!(unit("kN/m").as_deref(), Some("a stiffness: 1 kN/m = 1000 kg/s^2"));
    }

    #[test]
    fn every_function_of_the_model_has_a_page() {
        for name in crate::model::functions() {
            assert!(function(name).is_some(), "{name}");
        }
    }
}
