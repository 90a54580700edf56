//! Every declaration: its keyword, how it is written, its pieces and fields, and its page in the manual.

use super::functions::{DISPLACEMENT_SIGNAL, FORCE_SIGNAL, TORQUE_SIGNAL};
use super::motions::INITIAL_FIELDS;
use super::piece::{Content, Naming, Piece, Space};
use super::{ElementId, JointId};
use crate::base::{Dimension, Expected, Field, Manual, Takes};
use crate::{elements, joints};

/// A kind of declaration.
#[derive(Clone, Copy, Debug)]
pub struct Declaration {
    pub keyword: &'static str,
    /// Its form in the grammar and in the tree.
    pub shape: Shape,
    /// An example to show and to type.
    pub form: &'static str,
    pub manual: Manual,
    /// Its names in other languages and textbooks.
    pub synonyms: &'static [&'static str],
    pub pieces: &'static [Piece],
    pub fields: &'static [Field],
}

/// The form of a declaration in the grammar; elements and joints share one each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Model,
    Param,
    Let,
    Gravity,
    Point,
    Body,
    Base,
    Element(ElementId),
    Joint(JointId),
    Couple,
    Force,
    Torque,
    Unbalance,
    Initial,
    Output,
    Damping,
    Rest,
    Repeat,
    Solve,
    Minimise,
    Maximise,
    Require,
    Correlate,
    Component,
    Place,
    Use,
}

impl PartialEq for Declaration {
    /// Each keyword has one declaration.
    fn eq(&self, other: &Declaration) -> bool {
        self.keyword == other.keyword
    }
}

impl Eq for Declaration {}

impl Declaration {
    /// Whether it connects ends.
    pub fn has_ends(&self) -> bool {
        self.pieces.iter().any(|piece| matches!(piece, Piece::End(_)))
    }

    /// Whether a direction may follow its ends.
    pub fn has_along(&self) -> bool {
        self.pieces.iter().any(|piece| matches!(piece, Piece::Along))
    }

    /// The dimensions of its signal, if it can have one.
    pub fn signal(&self) -> Option<&'static super::SignalKind> {
        self.pieces.iter().find_map(|piece| match piece {
            Piece::Signal(kind) => Some(*kind),
            _ => None,
        })
    }

    /// The role of the name after its keyword.
    pub fn naming(&self) -> Option<Naming> {
        self.pieces.iter().find_map(|piece| match piece {
            Piece::Word(naming, _) | Piece::Name(naming, _) | Piece::Path(naming, _) => Some(*naming),
            _ => None,
        })
    }

    pub fn is_element(&self) -> bool {
        matches!(self.shape, Shape::Element(_))
    }

    /// The contents of its expressions.
    pub fn contents(&self) -> impl Iterator<Item = Content> + use<> {
        let inner = |piece: &'static Piece| match piece {
            Piece::OneOf(_, _, choices) => choices.iter().flat_map(|pieces| pieces.iter()).collect(),
            piece => vec![piece],
        };
        self.pieces.iter().flat_map(inner).filter_map(|piece| match piece {
            Piece::Value(_, content) => Some(*content),
            _ => None,
        })
    }

    /// Its page in the manual, as Markdown.
    pub fn page(&self) -> String {
        let Manual { forms, summary, rules, .. } = self.manual;
        format!("# {}\n\n{summary}\n\n```vib\n{forms}\n```\n\n{rules}\n", self.keyword)
    }

    pub fn field(&self, name: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.name == name)
    }
}

const fn declaration(
    shape: Shape,
    keyword: &'static str,
    form: &'static str,
    manual: Manual,
    pieces: &'static [Piece],
) -> Declaration {
    Declaration { keyword, shape, form, manual, synonyms: &[], pieces, fields: &[] }
}

const NEW_PART: Naming = Naming::New(Space::Parts);
const NEW_VALUE: Naming = Naming::New(Space::Values);
const EQUALS: &str = "=";
const PART: Piece = Piece::Name(NEW_PART, "the part");
const COLON: Piece = Piece::Sign(":", "after the part's name");
const FIRST_END: Piece = Piece::End("the part at the first end");
const DASHES: Piece = Piece::Sign("--", "between the two ends");
const SECOND_END: Piece = Piece::End("the part at the second end");
const LOADED_END: Piece = Piece::End("the part that is loaded");
const OTHER_END: Piece = Piece::OtherEnd("the part at the second end");
const IN: Piece = Piece::Marker("in", "before the range");
const LOW: Piece = Piece::Value("the lower bound", Content::Any);
const DOTS: Piece = Piece::Sign("..", "between the bounds");
const HIGH: Piece = Piece::Value("the upper bound", Content::Any);
const OPTIMUM: [Piece; 6] = [
    Piece::Apart,
    Piece::Value("a measure", Content::Measures),
    Piece::Marker("over", "before the parameters"),
    Piece::Blank,
    Piece::Varied,
    Piece::Limits,
];

/// The fields of a body.
pub const BODY_FIELDS: [Field; 7] = [
    Field::number("mass", Expected::new("a mass", Dimension::MASS, "mass = 1 kg"), "The body's mass, kg."),
    Field::new(
        "moves",
        Takes::Motions,
        "moves x",
        "The motions of the body relative to the ground: `x`, `y`, `x y`, or `along (1, 1)`.",
    ),
    Field::new("at", Takes::Position, "at = (0, 0)", "The centre of mass in the drawing."),
    Field::new(
        "shape",
        Takes::Shape,
        "shape = rod((0, 0), (0, 1 m))",
        "`rod(A, B)`, `disk(r)`, `ring(r)` or `box(w, h)`: centre and inertia follow.",
    ),
    Field::new("turns", Takes::Nothing, "turns", "The body turns about its place on the ground."),
    Field::number(
        "inertia",
        Expected::new("a moment of inertia", Dimension::INERTIA, "inertia = 0.8 kg*m^2"),
        "The moment of inertia about the centre, kg*m^2; `about A` about a point.",
    ),
    Field::new("free", Takes::Nothing, "free", "The body moves along x and y and turns."),
];

/// The fields of a base.
pub const BASE_FIELDS: [Field; 3] = [
    Field::new(
        "moves",
        Takes::Motions,
        "moves y",
        "The motion that is prescribed: `x`, `y`, `x y`, or `along (1, 1)`.",
    ),
    Field::new("at", Takes::Position, "at = (0, 0)", "The place of the base in the drawing; it turns about it."),
    Field::new("turns", Takes::Nothing, "turns", "The base turns as prescribed."),
];

/// The fields of an unbalance.
pub const UNBALANCE_FIELDS: [Field; 3] = [
    Field::number(
        "me",
        Expected::new("an unbalance", Dimension::UNBALANCE, "me = 0.01 kg*m"),
        "The unbalance, kg*m: the mass that is off the axis times its distance.",
    ),
    Field::number(
        "speed",
        Expected::new("a speed of rotation", Dimension::FREQUENCY, "speed = 3000 rpm"),
        "The speed of rotation, of which motions in time are computed; a transfer function has its own frequency.",
    ),
    Field::new("clockwise", Takes::Nothing, "clockwise", "The rotor turns clockwise."),
];

/// The declarations before the joints, in the order of spec.md#keywords.
const FIRST: [Declaration; 6] = [
    declaration(
        Shape::Model,
        "model",
        "model cart",
        Manual {
            forms: "model cart",
            summary: "Names the model; reports and emitted code use the name.",
            rules: "Without it the model has the name of its file. At most one per model.",
            heading: "Scene",
        },
        &[Piece::Blank, Piece::Word(Naming::Title, "the model")],
    ),
    Declaration {
        synonyms: &["parameter", "var", "variable"],
        ..declaration(
            Shape::Param,
            "param",
            "param k = 10 N/m",
            Manual {
                forms: "param k = 10 N/m\nparam m = 1 kg within 0.9 kg .. 1.2 kg\nparam c = 5 N*s/m spread 3 % within 10 %",
                summary: "Declares a number that the command line may replace: `--set k=12N/m`.",
                rules: "Order does not matter: a parameter may use names that are declared further down. Parameters that depend on each \
                 other in a cycle are an error. A value from outside must have the dimension of the declared one.\n\n\
                 `within` is a tolerance: a share of the value, a half-width or a range. `spread` is a random distribution: a \
                 standard deviation, `lognormal` with that of the logarithm, or `uniform` with a range.",
                heading: "Parameters",
            },
            &[
                Piece::Blank,
                Piece::Name(NEW_VALUE, "the parameter"),
                Piece::Sign(EQUALS, "between the parameter and its value"),
                Piece::Value("the parameter's value", Content::Any),
                Piece::Tolerance,
            ],
        )
    },
    Declaration {
        synonyms: &["const", "def", "define"],
        ..declaration(
            Shape::Let,
            "let",
            "let w = sqrt(k / m)",
            Manual {
                forms: "let w = sqrt(k / m)",
                summary: "Names a number or a vector that follows from others; the command line cannot replace it.",
                rules: "Order does not matter: it may use names that are declared further down.",
                heading: "Parameters",
            },
            &[
                Piece::Blank,
                Piece::Name(NEW_VALUE, "the quantity"),
                Piece::Sign(EQUALS, "between the name and its value"),
                Piece::Value("a value", Content::Any),
            ],
        )
    },
    Declaration {
        ..declaration(
            Shape::Gravity,
            "gravity",
            "gravity 9.81 m/s^2",
            Manual {
                forms: "gravity 9.81 m/s^2\ngravity (0, -9.81 m/s^2)",
                summary: "Switches gravity on. A single number points along -y.",
                rules: "Without this line there is no gravity. At most one per model.",
                heading: "Scene",
            },
            &[Piece::Apart, Piece::Value("the acceleration of gravity", Content::Number(Dimension::ACCELERATION))],
        )
    },
    Declaration {
        synonyms: &["node"],
        ..declaration(
            Shape::Point,
            "point",
            "point A = (0, 1 m)",
            Manual {
                forms: "point A = (0, 1 m)",
                summary: "Names a place in the drawing.",
                rules: "All places are coordinates (x, y) of one drawing, whatever part they belong to: x to the right, y upwards.",
                heading: "Places and directions",
            },
            &[
                Piece::Blank,
                Piece::Name(NEW_VALUE, "the point"),
                Piece::Sign(EQUALS, "between the point and its place"),
                Piece::Value("a place `(x, y)`", Content::Number(Dimension::LENGTH)),
            ],
        )
    },
    Declaration {
        synonyms: &["mass", "link", "rigid"],
        fields: &BODY_FIELDS,
        ..declaration(
            Shape::Body,
            "body",
            "body block { mass = 1 kg, moves x }",
            Manual {
                forms: "body block { mass = 1 kg, moves x }\nbody rod { mass = 0.5 kg, shape = rod(A, (0, -2 m)) }",
                summary: "Declares a rigid body.",
                rules: "Its freedom clause says how it moves relative to the ground: `moves x`, `moves y`, `moves x y`, \
                 `moves along (1, 1)`, `turns`, or `free` for all three. A body without one gets its degrees of freedom from \
                 its joints; a body with neither is an error.\n\n\
                 `mass`, `at` (the centre of mass), `inertia` and `shape` are only needed if a degree of freedom uses them. \
                 `inertia = 0.8 kg*m^2` is about the centre of mass, `inertia = 0.8 kg*m^2 about A` about a point. Centre and \
                 inertia follow from `shape = rod(A, B)`; the inertia alone follows from `disk(r)`, `ring(r)` and `box(w, h)`.",
                heading: "Bodies",
            },
            &[Piece::Blank, Piece::Name(NEW_PART, "the body"), Piece::Fields],
        )
    },
];

/// The declarations between joints and elements.
const MIDDLE: [Declaration; 1] = [Declaration {
    synonyms: &["gear", "rack"],
    ..declaration(
        Shape::Couple,
        "couple",
        "couple r: wheel.angle = -block.x / 0.3 m",
        Manual {
            forms: "couple r: wheel.angle = -block.x / 0.3 m",
            summary: "Couples motions by a linear relation: gears, racks, rolling wheels, pulleys, levers.",
            rules: "Both sides are sums of displacements and angles of bodies and bases, each times or divided by a number, or a \
             bare zero. The relation holds for the deviations from the drawing.",
            heading: "Couplings",
        },
        &[
            Piece::Blank,
            PART,
            COLON,
            Piece::Value("a relation between motions", Content::Motions),
            Piece::Sign(EQUALS, "between the two sides"),
            Piece::Value("the other side", Content::Motions),
        ],
    )
}];

/// The declarations after the elements.
const LAST: [Declaration; 17] = [
    Declaration {
        synonyms: &["support"],
        fields: &BASE_FIELDS,
        ..declaration(
            Shape::Base,
            "base",
            "base floor { moves y }",
            Manual {
                forms: "base floor { moves y }\nbase floor { moves y } = harmonic(1 mm, 30 Hz)",
                summary: "A support whose motion is prescribed: an input.",
                rules: "`moves ...` and `turns` say which motions are prescribed; each is an input. A signal after the braces is a \
                 displacement or an angle and needs a base with a single motion.",
                heading: "Bases",
            },
            &[Piece::Blank, Piece::Name(NEW_PART, "the base"), Piece::Fields, Piece::Signal(&DISPLACEMENT_SIGNAL)],
        )
    },
    Declaration {
        ..declaration(
            Shape::Force,
            "force",
            "force F: block along x = harmonic(10 N, 1.5 Hz)",
            Manual {
                forms: "force F: block@A along x\nforce F: block along x = harmonic(10 N, 1.5 Hz)\nforce F: a -- b",
                summary: "A force on a part, or between two parts: an input.",
                rules: "`force F: a -- b` acts between its ends and is positive if it pushes them apart; with `along` it acts on a in \
                 that direction and on b in the opposite one. A signal may follow; without one the force is an input for transfer \
                 functions and emitted code.",
                heading: "Forces and torques",
            },
            &[Piece::Blank, PART, COLON, LOADED_END, OTHER_END, Piece::Along, Piece::Signal(&FORCE_SIGNAL)],
        )
    },
    Declaration {
        synonyms: &["moment"],
        ..declaration(
            Shape::Torque,
            "torque",
            "torque T: rod",
            Manual {
                forms: "torque T: rod\ntorque T: rod = step(1 N*m, 0 s)\ntorque T: a -- b",
                summary: "A torque on a part, or between two parts: an input, positive counter-clockwise.",
                rules: "`torque T: a -- b` acts on a, and on b in the opposite direction. One end must be able to turn. A signal may follow.",
                heading: "Forces and torques",
            },
            &[Piece::Blank, PART, COLON, LOADED_END, OTHER_END, Piece::Signal(&TORQUE_SIGNAL)],
        )
    },
    Declaration {
        synonyms: &["rotor", "imbalance"],
        fields: &UNBALANCE_FIELDS,
        ..declaration(
            Shape::Unbalance,
            "unbalance",
            "unbalance U: rotor { me = 0.01 kg*m }",
            Manual {
                forms: "unbalance U: rotor { me = 0.01 kg*m }\nunbalance U: frame@A { me = 0.01 kg*m, speed = 3000 rpm, clockwise }",
                summary: "A rotating unbalance on a part: a force m e omega^2 that turns with the frequency.",
                rules: "At t = 0 the heavy spot is at +x; it turns counter-clockwise, or `clockwise`. It is two inputs, \
                 the components `U.x` and `U.y` of the heavy spot's place times its mass, in kg*m. Motions in time need the `speed`.",
                heading: "Unbalance",
            },
            &[Piece::Blank, PART, COLON, LOADED_END, Piece::Fields],
        )
    },
    Declaration {
        fields: &INITIAL_FIELDS,
        ..declaration(
            Shape::Initial,
            "initial",
            "initial block { x = 16 mm, vx = 0.375 m/s }",
            Manual {
                forms: "initial block { x = 16 mm, vx = 0.375 m/s }",
                summary: "The initial state of a body, measured from rest.",
                rules: "`x`, `y`, `angle`, `vx`, `vy`, `omega` are motions of the body at t = 0; those not given are zero. \
                 One declaration for each body.",
                heading: "Initial state",
            },
            &[Piece::Blank, Piece::Path(Naming::Of(Space::Parts), "the body"), Piece::Fields],
        )
    },
    Declaration {
        synonyms: &["sensor"],
        ..declaration(
            Shape::Output,
            "output",
            "output theta = rod.angle",
            Manual {
                forms: "output theta = rod.angle\noutput tip in mm = rod@(0, -2 m).x\noutput pull = s.force",
                summary: "Names a quantity to be reported: a linear combination of motions.",
                rules: "Motions of a body, a base or a point of either: `x y angle`, `vx vy omega`, `ax ay alpha`; of an \
                 element: `force` and `stretch`. All are deviations from rest. `in mm` is the unit that results are shown in; \
                 without it they are in SI units.",
                heading: "Outputs",
            },
            &[
                Piece::Blank,
                Piece::Name(NEW_PART, "the output"),
                Piece::InUnit("the unit that the output is shown in, such as `mm`"),
                Piece::Sign(EQUALS, "between the output and its expression"),
                Piece::Value("the output's expression", Content::Motions),
            ],
        )
    },
    Declaration {
        ..declaration(
            Shape::Damping,
            "damping",
            "damping modal 2 %",
            Manual {
                forms: "damping modal 2 %\ndamping rayleigh(0.1 /s, 1e-4 s)",
                summary: "Damping of the whole scene, added to the dampers.",
                rules: "`modal` gives every mode the same damping ratio; `rayleigh(a, b)` adds a M + b K. Both act on motion \
                 relative to what moving bases carry along. At most one per model.",
                heading: "Damping of the whole scene",
            },
            &[
                Piece::Blank,
                Piece::OneOf(
                    &["modal", "rayleigh"],
                    "after `damping`",
                    &[
                        &[Piece::Apart, Piece::Value("a damping ratio", Content::Number(Dimension::NONE))],
                        &[Piece::Arguments("before the two factors", "a factor")],
                    ],
                ),
            ],
        )
    },
    declaration(
        Shape::Rest,
        "rest",
        "rest as drawn",
        Manual {
            forms: "rest as drawn",
            summary: "Declares that the drawing is the static equilibrium.",
            rules: "Springs without `preload` and `free_length` get the tensions that make it so: the smallest ones, if \
             several sets do. At most one per model.",
            heading: "Scene",
        },
        &[Piece::Blank, Piece::Marker("as", "after `rest`"), Piece::Marker("drawn", "after `rest as`")],
    ),
    Declaration {
        synonyms: &["for"],
        ..declaration(
            Shape::Repeat,
            "repeat",
            "repeat i in 2..100 {",
            Manual {
                forms: "repeat i in 2..100 {\n    body m[i] { mass = 1 kg, moves x }\n}",
                summary: "Declares its body once for each value of an index, bounds included.",
                rules: "The names declared inside need the index, as in `m[i]`. Inside, `i` is a plain number. The declared \
                 names are visible everywhere in the model.",
                heading: "Repetition",
            },
            &[
                Piece::Blank,
                Piece::Word(Naming::Index, "the index"),
                IN,
                Piece::Apart,
                LOW,
                DOTS,
                HIGH,
                Piece::Sign("{", "at the end of the line"),
            ],
        )
    },
    declaration(
        Shape::Solve,
        "solve",
        "solve f in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB",
        Manual {
            forms: "solve fn in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB",
            summary: "Finds the value of a parameter in a range at which a measure has a given value.",
            rules: "The rest of the model uses the value found. No root in the range, or more than one, is reported with the values \
             that the measure took. Measures: `frequency(i)`, `damping(i)`, `gain(input -> output, f)`, \
             `phase(input -> output, f)`, `amplitude(output)`, `static(output)`, `peak(output)`, `rms(output)`.",
            heading: "Solving for parameters",
        },
        &[
            Piece::Blank,
            Piece::Path(Naming::Of(Space::Values), "the parameter"),
            IN,
            Piece::Apart,
            LOW,
            DOTS,
            HIGH,
            Piece::Sign(":", "before the measure"),
            Piece::Value("a measure", Content::Measures),
            Piece::Sign(EQUALS, "between the measure and its value"),
            Piece::Value("the measure's value", Content::Measures),
        ],
    ),
    Declaration {
        synonyms: &["minimize", "optimise", "optimize", "min"],
        ..declaration(
            Shape::Minimise,
            "minimise",
            "minimise peak_gain(floor -> x) over c in 1 N*s/m .. 100 N*s/m, k in 1 N/m .. 50 N/m",
            Manual {
                forms: "minimise peak_gain(floor -> x) over c in 1 N*s/m .. 100 N*s/m, k in 1 N/m .. 50 N/m while peak(y) < 20 mm",
                summary: "Finds the values of parameters in their ranges at which a measure is least.",
                rules: "The rest of the model uses the values found. The report says what shows that no other values are better, or that \
                 this is not proved. `while` lists conditions that the values must meet. A parameter of a `solve` line may depend on \
                 them: it is solved for at each trial.",
                heading: "Optimal parameters",
            },
            &OPTIMUM,
        )
    },
    Declaration {
        synonyms: &["maximize", "max"],
        ..declaration(
            Shape::Maximise,
            "maximise",
            "maximise damping(1) over c in 1 N*s/m .. 100 N*s/m",
            Manual {
                forms: "maximise damping(1) over c in 1 N*s/m .. 100 N*s/m",
                summary: "Finds the values of parameters in their ranges at which a measure is largest.",
                rules: "Like `minimise`.",
                heading: "Optimal parameters",
            },
            &OPTIMUM,
        )
    },
    Declaration {
        synonyms: &["assert", "check"],
        ..declaration(
            Shape::Require,
            "require",
            "require frequency(1) > 2 Hz",
            Manual {
                forms: "require frequency(1) > 2 Hz\nrequire stable",
                summary: "A check of the model: a measure compared with a value, or `stable`.",
                rules: "`vibc check` and `vibc analyze` print each requirement with its margin, and exit with status 1 if one fails.",
                heading: "Requirements",
            },
            &[Piece::Apart, Piece::Value("a condition", Content::Measures)],
        )
    },
    declaration(
        Shape::Correlate,
        "correlate",
        "correlate k, m 0.8",
        Manual {
            forms: "correlate k, m 0.8",
            summary: "The correlation of two parameters that vary at random.",
            rules: "Both have a `spread` or a tolerance. The coefficient lies between -1 and 1; all of a model together are \
             positive definite.",
            heading: "Tolerances",
        },
        &[
            Piece::Blank,
            Piece::Path(Naming::Of(Space::Values), "the first parameter"),
            Piece::Sign(",", "between the two parameters"),
            Piece::Path(Naming::Of(Space::Values), "the second parameter"),
            Piece::Apart,
            Piece::Value("the coefficient of correlation", Content::Number(Dimension::NONE)),
        ],
    ),
    Declaration {
        synonyms: &["class", "block", "subsystem"],
        ..declaration(
            Shape::Component,
            "component",
            "component axle(part chassis, m: kg, k = 150 kN/m) {",
            Manual {
                forms: "component axle(part chassis, m: kg, k = 150 kN/m) {\n    body wheel { mass = m, moves y }\n    \
                 spring s: wheel -- chassis { k = k }\n}",
                summary: "Describes a subassembly once, to be placed as often as needed.",
                rules: "The brackets contain its ports, which are parts of the scene that it connects, and its parameters, each with a unit or a \
                 default. A parameter without a default must be given at every place. Inside, only these and the component's own names \
                 are visible. Coordinates and directions are along its own axes.",
                heading: "Components",
            },
            &[
                Piece::Blank,
                Piece::Word(Naming::New(Space::Components), "the component"),
                Piece::Formals,
                Piece::Sign("{", "at the end of the line"),
            ],
        )
    },
    Declaration {
        synonyms: &["instance", "insert"],
        ..declaration(
            Shape::Place,
            "place",
            "place front = axle(m = 40 kg) at (1.2 m, 0)",
            Manual {
                forms: "place front = axle(chassis = car, m = 40 kg) at (1.2 m, 0)\nplace rear = axle(chassis = car, m = 45 kg) at \
                 (-1.5 m, 0) turned 10 deg\nplace left = axle(chassis = car, m = 40 kg) at (0, 0) mirrored x",
                summary: "Puts a component into the scene; its names are then `front.wheel`, `front.k`.",
                rules: "`at` is the position of the component's origin; without it, nothing in the component may have a position. `mirrored x` \
                 changes the sign of its x, `mirrored y` of its y. It is mirrored first, then turned about its origin, then moved.\n\n\
                 From outside, `front.wheel` is a part or output and `front.k` a parameter, point or `let`; `--set front.k=...` sets a \
                 parameter.",
                heading: "Places of components",
            },
            &[
                Piece::Blank,
                Piece::Name(Naming::New(Space::Places), "the place"),
                Piece::Sign(EQUALS, "between the place and its component"),
                Piece::Word(Naming::Of(Space::Components), "a component"),
                Piece::Actuals,
                Piece::Placing,
            ],
        )
    },
    Declaration {
        synonyms: &["import", "include"],
        ..declaration(
            Shape::Use,
            "use",
            "use \"axles.vib\"",
            Manual {
                forms: "use \"axles.vib\"\nuse \"std/absorber.vib\"",
                summary: "Makes the components of another file known.",
                rules: "The path is relative to this file; `std/...` are the components that come with the program. Components alone come in: \
                 a file may be a model and be used by others. A file is read once, however often it is named.",
                heading: "Components of other files",
            },
            &[Piece::Apart, Piece::Text("a file in quotes, such as `\"axles.vib\"`")],
        )
    },
];

const fn of_joint(place: usize) -> Declaration {
    let kind = joints::KINDS[place];
    let pieces: &[Piece] = if kind.slides {
        &[Piece::Blank, PART, COLON, FIRST_END, DASHES, SECOND_END, Piece::Along]
    } else {
        &[Piece::Blank, PART, COLON, FIRST_END, DASHES, SECOND_END]
    };
    let shape = Shape::Joint(JointId(place as u8));
    let declaration = declaration(shape, kind.keyword, kind.form, kind.manual, pieces);
    Declaration { synonyms: kind.synonyms, ..declaration }
}

const fn of_element(place: usize) -> Declaration {
    let kind = elements::KINDS[place];
    let pieces: &[Piece] = &[Piece::Blank, PART, COLON, FIRST_END, DASHES, SECOND_END, Piece::Fields];
    let shape = Shape::Element(ElementId(place as u8));
    let declaration = declaration(shape, kind.keyword, kind.form, kind.manual, pieces);
    Declaration { synonyms: kind.synonyms, fields: kind.fields, ..declaration }
}

const COUNT: usize = FIRST.len() + joints::KINDS.len() + MIDDLE.len() + elements::KINDS.len() + LAST.len();

/// Every declaration, in the order in which they are listed to users.
pub static DECLARATIONS: [Declaration; COUNT] = table();

const fn table() -> [Declaration; COUNT] {
    let mut table = [FIRST[0]; COUNT];
    let mut end = 0;
    let mut place = 0;
    while place < FIRST.len() {
        table[end] = FIRST[place];
        (end, place) = (end + 1, place + 1);
    }
    place = 0;
    while place < joints::KINDS.len() {
        table[end] = of_joint(place);
        (end, place) = (end + 1, place + 1);
    }
    place = 0;
    while place < MIDDLE.len() {
        table[end] = MIDDLE[place];
        (end, place) = (end + 1, place + 1);
    }
    place = 0;
    while place < elements::KINDS.len() {
        table[end] = of_element(place);
        (end, place) = (end + 1, place + 1);
    }
    place = 0;
    while place < LAST.len() {
        table[end] = LAST[place];
        (end, place) = (end + 1, place + 1);
    }
    table
}
