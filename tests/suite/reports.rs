//! Reports of the most important cases: each kind of motion, and each verdict on the rest.

use vibc::backend::{ReportOptions, report};
use vibc::base::{SourceFile, Sources};
use vibc::model::Overrides;

fn text(name: &str, model: &str) -> String {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(format!("{name}.vib"), model));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    report::text(&outcome.answer.expect("a model without errors"), &ReportOptions::default())
}

macro_rules! shows {
    ($($(#[$doc:meta])* $name:ident: $model:literal)*) => {$(
        #[test]
        $(#[$doc])*
        fn $name() {
            insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
                insta::assert_snapshot!(concat!("report_", stringify!($name)), text(stringify!($name), $model));
            });
        }
    )*};
}

shows! {
    overdamped: "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\ndamper d: ground -- a { c = 10 N*s/m }\n"

    /// A double pole, reported as one.
    critically_damped: "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\ndamper d: ground -- a { c = 2 N*s/m }\n"

    /// A negative damper feeds energy into the oscillation.
    flutter: "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\ndamper d: ground -- a { c = -0.1 N*s/m }\n"

    /// The damping slows the fall: the growth is that of the pole.
    falling_with_damping: "gravity 9.81 m/s^2\nbody rod { mass = 1 kg, shape = rod((0, 0), (0, 1 m)) }\npivot p: ground@(0, 0) -- rod\nspring t: ground -- rod { k = 2 N*m/rad }\ndamper d: ground -- rod { c = 0.1 N*m*s/rad }\n"

    /// One motion diverges, another oscillates.
    half_unstable: "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: a -- b { k = 1 N/m }\nspring t: ground -- a { k = -1e-3 N/m }\n"

    /// Friction without a restoring force.
    coasting: "body sledge { mass = 1 kg, moves x }\ndamper snow: ground -- sledge { c = 1 N*s/m }\n"

    /// The same frequency in both directions.
    repeated: "body a { mass = 1 kg, moves x y }\nspring s: ground -- a { k = 1 N/m, along = x }\nspring t: ground -- a { k = 1 N/m, along = y }\n"

    /// Frequencies thirty decades apart, in one table.
    far_apart: "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1e20 N/m }\nbody b { mass = 1e20 kg, moves x }\nspring t: a -- b { k = 1e-20 N/m }\ndamper d: a -- b { c = 1e-25 N*s/m }\n"

    /// Names in Greek keep their columns.
    greek: "param ω = 2 rad/s\nbody μαζα { mass = 1 kg, moves x }\nspring κ: ground -- μαζα { k = 1 kg * ω^2 }\n"
}
