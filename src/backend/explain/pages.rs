//! The page of each diagnostic, as part of the program: the file FAMILY/NAME.md of docs/diagnostics for the code
//! `vib::FAMILY::NAME`. A new code needs a new file there and its name here; tests compare both with the codes of the
//! sources.

/// The page that `vibc explain CODE` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page {
    /// `vib::unit::mismatch`.
    pub code: &'static str,
    /// The unchanged Markdown file.
    pub markdown: &'static str,
}

macro_rules! pages {
    ($($family:ident: $($name:ident)+;)+) => {
        &[$($(Page {
            code: concat!("vib::", stringify!($family), "::", stringify!($name)),
            markdown: include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/docs/diagnostics/", stringify!($family), "/", stringify!($name), ".md"
            )),
        },)+)+]
    };
}

/// All pages, in alphabetical order.
pub const PAGES: &[Page] = pages! {
    base: no_motion;
    belt: no_disk overlap slack;
    body: freedom given_twice no_freedom no_place;
    component: dimension duplicate forbidden inner motion_name recursion unknown;
    couple: motions;
    damper: negative;
    damping: base large negative;
    direction: zero;
    element: direction_unknown equal_ends no_end_turns torsion_along zero_length;
    equations: defect no_form too_large;
    field: duplicate missing unknown value;
    file: not_utf8;
    freedom: loose no_inertia none;
    function: arguments unknown;
    index: not_whole too_many;
    inertia: missing too_small;
    initial: undetermined;
    input: direction_unknown no_effect;
    joint: direction ends_apart equal_ends no_place;
    law: and_coefficient force_at_rest kink no_tangent table tangent undefined;
    limit: depth loops loss massless modes range repeat signal states tolerance transfer values;
    loop: conflict rank_drop redundant;
    mass: indefinite missing singular;
    measure: arguments input mode output unknown value;
    minimise: circle end_of_range never_met no_value plateau twice unstable;
    motion: impossible non_linear none still unknown unsettled;
    name: duplicate index reserved unknown;
    noise: density emit frequency left_out reading realisation road;
    number: division_by_zero domain overflow root_of_negative;
    parameter: cycle;
    part: kind unknown;
    place: duplicate mirrored missing position solved turned_input unknown vector;
    position: unknown;
    reaction: damped undetermined;
    repeat: reversed;
    require: fails form no_value still undetermined;
    rest: not_found unbalanced unproven;
    scene: empty more_findings;
    setting: duplicate form not_a_parameter solved toml unknown;
    shape: size unknown;
    signal: arguments base_impulse constant_rate cut cycle delayed differ many_motions period times unknown;
    solve: independent no_root no_value range several_roots singular twice unsettled unstable;
    spectrum: damping emit input left_out points;
    spring: free_length_and_preload negative no_length;
    syntax: character more_errors stray too_deep too_large unclosed unclosed_string unexpected unknown_keyword;
    table: drift first_column heading order row scale too_short unit units_differ unreadable;
    tolerance: correlation outside width;
    unbalance: emit speed;
    unit: ambiguous cycles exponent frequency malformed mismatch missing unknown;
    unused: element gravity input parameter point property signal;
    use: cycle unreadable;
    value: comparison components kind motion negative;
};
