//! What each keyword declares, for people: `vibc explain spring` and the editor's hover. The whole language is in `spec.md`.

/// The manual's entry for a keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    pub keyword: &'static str,
    /// How it is written, one example a line.
    pub forms: &'static str,
    /// What it declares, in one sentence.
    pub summary: &'static str,
    /// The rules, as Markdown paragraphs.
    pub rules: &'static str,
    /// The heading of `spec.md` with the whole story.
    pub heading: &'static str,
}

impl Entry {
    /// The entry as a Markdown page.
    pub fn markdown(&self) -> String {
        format!("# {}\n\n{}\n\n```vib\n{}\n```\n\n{}\n", self.keyword, self.summary, self.forms, self.rules)
    }
}

/// The entry for a keyword of the language.
pub fn entry(keyword: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.keyword == keyword)
}

const fn entry_of(
    keyword: &'static str,
    heading: &'static str,
    forms: &'static str,
    summary: &'static str,
    rules: &'static str,
) -> Entry {
    Entry { keyword, forms, summary, rules, heading }
}

/// All entries, in the order of [`KEYWORDS`](super::words::KEYWORDS).
pub const ENTRIES: [Entry; 22] = [
    entry_of(
        "model",
        "Scene",
        "model cart",
        "Names the model; reports and emitted code use the name.",
        "Without it the model has the name of its file. Stands at most once in a model.",
    ),
    entry_of(
        "param",
        "Parameters",
        "param k = 10 N/m",
        "Declares a number that the command line may replace: `--set k=12N/m`.",
        "Order does not matter: a parameter may use names that are declared further down. A circle of parameters that \
         need each other is an error. The value given from outside must have the dimension of the declared one.",
    ),
    entry_of(
        "let",
        "Parameters",
        "let w = sqrt(k / m)",
        "Names a number or a vector that follows from others; the command line cannot replace it.",
        "Order does not matter: it may use names that are declared further down.",
    ),
    entry_of(
        "gravity",
        "Scene",
        "gravity 9.81 m/s^2\ngravity (0, -9.81 m/s^2)",
        "Switches gravity on. A single number points along -y.",
        "Without this line there is no gravity. Stands at most once in a model.",
    ),
    entry_of(
        "point",
        "Places and directions",
        "point A = (0, 1 m)",
        "Names a place in the drawing.",
        "All places are coordinates (x, y) of one drawing, whatever part they belong to: x to the right, y upwards.",
    ),
    entry_of(
        "body",
        "Bodies",
        "body block { mass = 1 kg, moves x }\nbody rod { mass = 0.5 kg, shape = rod(A, (0, -2 m)) }",
        "Declares a rigid body.",
        "Its freedom clause says how it moves against the ground: `moves x`, `moves y`, `moves x y`, \
         `moves along (1, 1)`, `turns`, or `free` for all three. A body without one gets its degrees of freedom from \
         its joints; a body with neither is an error.\n\n\
         `mass`, `at` (the centre of mass), `inertia` and `shape` are needed only where a degree of freedom uses them. \
         `inertia = 0.8 kg*m^2` is about the centre of mass, `inertia = 0.8 kg*m^2 about A` about a point. Centre and \
         inertia follow from `shape = rod(A, B)`; the inertia alone follows from `disk(r)`, `ring(r)` and `box(w, h)`.",
    ),
    entry_of(
        "pivot",
        "Joints",
        "pivot p: block@A -- rod",
        "Pins two parts together: they share a point and turn freely about it.",
        "One end names the point and the other end coincides there; if both ends name a point, or neither does, both \
         places must be known and equal. A pivot that closes a loop becomes a constraint, never a stiff spring.",
    ),
    entry_of(
        "slide",
        "Joints",
        "slide g: arm -- slug along (1, 0)",
        "A prismatic joint: the second part slides on the first along one direction and does not turn against it.",
        "The direction is fixed to the first part and is given as drawn. A slide that closes a loop becomes a constraint.",
    ),
    entry_of(
        "weld",
        "Joints",
        "weld w: block -- box",
        "Fixes two parts to each other, as drawn.",
        "Two points written for a weld must coincide. A weld that closes a loop becomes a constraint.",
    ),
    entry_of(
        "couple",
        "Couplings",
        "couple r: wheel.angle = -block.x / 0.3 m",
        "Ties motions by a linear relation: gears, racks, rolling wheels, pulleys, levers.",
        "Both sides are sums of displacements and angles of bodies and bases, each times or divided by a number, or a \
         bare zero. The relation holds for the deviations from the drawing.",
    ),
    entry_of(
        "spring",
        "Springs and dampers",
        "spring s: ground -- block { k = 10 N/m }\nspring t: ground -- rod { k = 3 N*m/rad }",
        "A linear spring between two parts; torsional if its stiffness is in N*m/rad.",
        "It acts in the fixed direction `along = x`, if that is given. Otherwise it acts on the line between its ends, with \
         the geometry of large displacements, where the ends have different known places; and otherwise along the one \
         line on which both parts can move.\n\n\
         `free_length` or `preload` (the tension as drawn, pull positive) may be given, not both. With neither the \
         spring is unstretched as drawn. A negative stiffness is allowed and noted.",
    ),
    entry_of(
        "damper",
        "Springs and dampers",
        "damper d: ground -- block { c = 5 N*s/m }\ndamper t: ground -- rod { c = 2 N*m*s/rad }",
        "A viscous damper between two parts; torsional if its coefficient is in N*m*s/rad.",
        "It acts in the fixed direction `along = x`, if that is given. Otherwise it acts on the line between its ends where \
         they have different known places, and otherwise along the one line on which both parts can move.",
    ),
    entry_of(
        "base",
        "Bases",
        "base floor { moves y }\nbase floor { moves y } = harmonic(1 mm, 30 Hz)",
        "A support whose motion is prescribed: an input.",
        "`moves ...` and `turns` say which motions are prescribed; each is an input. A signal after the braces is a \
         displacement or an angle and needs a base with a single motion.",
    ),
    entry_of(
        "force",
        "Forces and torques",
        "force F: block@A along x\nforce F: block along x = harmonic(10 N, 1.5 Hz)\nforce F: a -- b",
        "A force on a part, or between two parts: an input.",
        "`force F: a -- b` acts between its ends and is positive where it pushes them apart; with `along` it acts on b in \
         that direction and on a the other way. A signal may follow; without one the force is an input for transfer \
         functions and emitted code.",
    ),
    entry_of(
        "torque",
        "Forces and torques",
        "torque T: rod\ntorque T: rod = step(1 N*m, 0 s)\ntorque T: a -- b",
        "A torque on a part, or between two parts: an input, positive counter-clockwise.",
        "`torque T: a -- b` acts on b, and on a the other way. One end must be able to turn. A signal may follow.",
    ),
    entry_of(
        "initial",
        "Initial state",
        "initial block { x = 16 mm, vx = 0.375 m/s }",
        "Where a body starts, measured from rest.",
        "`x`, `y`, `angle`, `vx`, `vy`, `omega` are motions of the body's own place at t = 0; those not given are zero. \
         One declaration for each body.",
    ),
    entry_of(
        "output",
        "Outputs",
        "output theta = rod.angle\noutput tip = rod@(0, -2 m).x\noutput pull = s.force",
        "Names a quantity to be reported: a linear combination of motions.",
        "Motions of a body, a base or a point of either: `x y angle`, `vx vy omega`, `ax ay alpha`; of a spring or \
         damper: `force` and `stretch`. All are deviations from rest.",
    ),
    entry_of(
        "damping",
        "Damping of the whole scene",
        "damping modal 2 %\ndamping rayleigh(0.1 /s, 1e-4 s)",
        "Damping of the whole scene, added to the dampers.",
        "`modal` gives every oscillation the same damping ratio; `rayleigh(a, b)` adds a M + b K. Both act against the \
         ground. Stands at most once in a model.",
    ),
    entry_of(
        "rest",
        "Scene",
        "rest as drawn",
        "Declares that the drawing is the static equilibrium.",
        "Springs without `preload` and `free_length` get the tensions that make it so: the smallest ones, where several \
         sets do. Stands at most once in a model.",
    ),
    entry_of(
        "repeat",
        "Repetition",
        "repeat i in 2..100 {\n    body m[i] { mass = 1 kg, moves x }\n}",
        "Declares its body once for each value of an index, bounds included.",
        "The names declared inside need the index, as in `m[i]`. Inside, `i` is a plain number. What is declared is \
         known everywhere in the model.",
    ),
    entry_of(
        "solve",
        "Solving for parameters",
        "solve fn in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB",
        "Finds the value of a parameter in a range at which a measure has a given value.",
        "The rest of the model uses the value found. No root in the range, or more than one, is reported with the values \
         that the measure took. Measures: `frequency(i)`, `damping(i)`, `gain(input -> output, f)`, \
         `phase(input -> output, f)`, `amplitude(output)`, `static(output)`, `peak(output)`, `rms(output)`.",
    ),
    entry_of(
        "require",
        "Requirements",
        "require frequency(1) > 2 Hz\nrequire stable",
        "A check of the model: a measure compared with a value, or `stable`.",
        "`vibc check` and `vibc analyze` print each requirement with its margin, and exit with status 1 if one fails.",
    ),
];

#[cfg(test)]
mod tests {
    use super::super::words::KEYWORDS;
    use super::*;

    #[test]
    fn every_keyword_has_an_entry() {
        assert_eq!(ENTRIES.map(|entry| entry.keyword), KEYWORDS);
    }

    #[test]
    fn every_form_starts_with_its_keyword() {
        for entry in ENTRIES {
            let starts = |line: &str| line.starts_with(&format!("{} ", entry.keyword));
            assert!(entry.forms.lines().any(starts), "{}", entry.keyword);
        }
    }
}
