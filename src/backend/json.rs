//! The modal report for programs: one JSON object. SI units, angles in radians, numbers in full double precision in the
//! shortest form that reads back the same; `null` for infinite or unknown values. Fields may be added, never renamed.
//! See docs/method/report.md.

use super::decimal::{certain, certain_digits};
use super::json_number::{Bounds, JsonNumber};
use super::json_questions::{
    JsonOptimised, JsonRequirement, JsonSensitivity, JsonSolved, json_optimised, json_requirement, json_sensitivity,
    json_solved,
};
use super::json_spectra::JsonSpectral;
use super::tolerated::JsonTolerated;
use super::{ReportOptions, SCHEMA};
use crate::analysis::transfer::Disc;
use crate::analysis::{
    Buckling, DampedShape, Excitation, Mode, Net, Noisy, Normalise, Peak, Pole, Share, Split, Spread, Stability, nets,
    normalise, parts_of_modes, splits,
};
use crate::answers::report::at_outputs;
use crate::answers::{ModalAnswer, by_name};
use crate::base::{Ball, Bound, Number, Unproven};
use crate::lower::{Remark, ShapeNode};
use crate::system::{CoordinateKind, LinearSystem};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::borrow::Cow;

/// Matrices of more coordinates are shown only on request.
const MATRICES_UP_TO: usize = 200;

/// One JSON object, followed by a line feed.
pub fn json(answer: &ModalAnswer, options: &ReportOptions) -> String {
    super::json_text(&Modal { answer, options }) + "\n"
}

/// The report as a value to write. Shapes, of which a large scene has millions of numbers, are made mode by mode while it is
/// written.
pub struct Modal<'a> {
    pub answer: &'a ModalAnswer,
    pub options: &'a ReportOptions,
}

impl Serialize for Modal<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Modal { answer, options } = self;
        let mut names = answer.system.coordinate_names();
        let dependent = &answer.rest.dependent;
        names.extend(dependent.iter().map(|dependent| answer.system.display(dependent.coordinate.name)));
        report(answer, options, &names).serialize(serializer)
    }
}

#[derive(serde::Serialize)]
struct Report<'a> {
    vibc: &'static str,
    schema: u32,
    model: &'a str,
    coordinates: &'a [String],
    /// Coordinates that follow from the others through closed loops and couplings.
    dependent_coordinates: &'a [String],
    rest: Rest<'a>,
    matrices: Option<Matrices>,
    normalisation: &'static str,
    not_computed: NotComputed,
    modes: JsonModes<'a>,
    splits: Vec<JsonSplit>,
    poles: Vec<JsonPole>,
    buckling: Option<JsonBuckling<'a>>,
    parts: Vec<JsonPart>,
    explained: Option<Explained<'a>>,
    solved: Vec<JsonSolved<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    optimised: Vec<JsonOptimised<'a>>,
    requirements: Vec<JsonRequirement<'a>>,
    /// Outputs under noise.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    noise: Vec<JsonNoisy>,
    #[serde(skip_serializing_if = "Option::is_none")]
    response_spectra: Option<JsonSpectral>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    sensitivities: Vec<JsonSensitivity<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerances: Option<JsonTolerated<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    damped_shapes: Vec<JsonDampedShape<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    base_excitation: Vec<JsonExcitation>,
}

#[derive(serde::Serialize)]
struct Rest<'a> {
    stable: bool,
    kind: &'static str,
    displacement: ByName<'a>,
    displacement_error_bound: ByName<'a>,
    distance: Distance,
    residual: JsonNumber,
    proven: bool,
    steps: u32,
    tensions: Named,
    /// Absolute bounds, as for the displacements.
    tensions_error_bound: Named,
}

/// Coordinates that are coupled with each other and with nothing else.
#[derive(serde::Serialize)]
struct JsonPart {
    form: &'static str,
    coordinates: Vec<String>,
    modes: Vec<usize>,
}

impl JsonPart {
    fn of(net: &Net, names: &[String]) -> JsonPart {
        let coordinates = net.coordinates.iter().map(|i| names[i.index()].clone()).collect();
        JsonPart { form: net.form.name(), coordinates, modes: Vec::new() }
    }
}

/// The parts of the model that were kept, and those that were left out.
#[derive(serde::Serialize)]
struct Explained<'a> {
    kept: Vec<JsonRemark<'a>>,
    left_out: Vec<JsonRemark<'a>>,
}

#[derive(serde::Serialize)]
struct JsonRemark<'a> {
    what: &'a str,
    why: &'a str,
}

impl JsonRemark<'_> {
    fn of(remark: &Remark) -> JsonRemark<'_> {
        JsonRemark { what: &remark.what, why: &remark.why }
    }
}

/// The distance of the rest from the drawing: the largest displacements of coordinates.
#[derive(serde::Serialize)]
struct Distance {
    translation_m: JsonNumber,
    rotation_rad: JsonNumber,
    translation_error_bound: JsonNumber,
    rotation_error_bound: JsonNumber,
}

/// An object with a number for each name.
struct Named(Vec<(String, JsonNumber)>);

impl Serialize for Named {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// The results that a request or the size of the model left out.
#[derive(serde::Serialize)]
struct NotComputed {
    modes_below: usize,
    modes_above: usize,
    poles: usize,
    /// Whether other poles may lie between the listed ones.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    poles_between: bool,
    /// Facts that are not proved, without which the list of poles or the verdict on the rest is not certain.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    not_proved: Vec<&'static str>,
    matrices: bool,
}

#[derive(serde::Serialize)]
struct Matrices {
    m: Vec<Vec<JsonNumber>>,
    c: Vec<Vec<JsonNumber>>,
    k: Vec<Vec<JsonNumber>>,
    error_bound: MatrixBounds,
}

/// Absolute bounds, of the least accurate entry.
#[derive(serde::Serialize)]
struct MatrixBounds {
    m: JsonNumber,
    c: JsonNumber,
    k: JsonNumber,
}

/// Every mode, each made when it is written.
struct JsonModes<'a> {
    answer: &'a ModalAnswer,
    options: &'a ReportOptions,
    names: &'a [String],
    bounds: Bounds,
}

impl Serialize for JsonModes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let JsonModes { answer, options, names, bounds } = *self;
        let nodes = |place: usize| answer.nodes.get(place).map_or(&[][..], Vec::as_slice);
        let modes = answer.modes.with_numbers().enumerate();
        serializer.collect_seq(modes.map(|(place, mode)| json_mode(answer, options, names, mode, nodes(place), bounds)))
    }
}

#[derive(serde::Serialize)]
struct JsonMode<'a> {
    mode: usize,
    kind: &'static str,
    omega: JsonNumber,
    frequency_hz: JsonNumber,
    growth_rate: JsonNumber,
    omega_error_bound: JsonNumber,
    shape: ByName<'a>,
    /// At outputs of displacements, if all entries were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    outputs: Option<OutputsByName>,
    /// Points of turning bodies that stay in place, if all entries were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    nodes: Option<Vec<JsonNode>>,
    kinetic: Vec<JsonShare>,
    strain: Vec<JsonShare>,
    cluster: Option<u32>,
    input_condition: JsonNumber,
    route: &'static str,
    /// Decimals with as many digits as requested, as far as they are certain.
    #[serde(skip_serializing_if = "Option::is_none")]
    omega_digits: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequency_hz_digits: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    growth_rate_digits: Option<String>,
}

/// Two neighbouring modes that are close, and how far apart they are.
#[derive(serde::Serialize)]
struct JsonSplit {
    modes: [usize; 2],
    omega: JsonNumber,
    frequency_hz: JsonNumber,
    error_bound: JsonNumber,
    #[serde(skip_serializing_if = "Option::is_none")]
    omega_digits: Option<String>,
}

#[derive(serde::Serialize)]
struct JsonBuckling<'a> {
    load_factor: JsonNumber,
    error_bound: JsonNumber,
    /// The factor minus one, which has digits of its own.
    margin: JsonNumber,
    margin_error_bound: JsonNumber,
    shape: ByName<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    load_factor_digits: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    margin_digits: Option<String>,
}

#[derive(serde::Serialize)]
struct JsonShare {
    of: String,
    share: JsonNumber,
}

#[derive(serde::Serialize)]
struct JsonPole {
    re: JsonNumber,
    im: JsonNumber,
    omega: JsonNumber,
    frequency_hz: JsonNumber,
    damping_ratio: JsonNumber,
    damped_frequency_hz: JsonNumber,
    damped_frequency_error_bound: JsonNumber,
    kind: &'static str,
    error_bound: JsonNumber,
    damping_ratio_error_bound: JsonNumber,
    cluster: Option<u32>,
    defective: bool,
    route: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    re_digits: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    im_digits: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    damping_ratio_digits: Option<String>,
}

/// An output under noise; an infinite or unknown number is `null`, with its reason.
#[derive(serde::Serialize)]
struct JsonNoisy {
    output: String,
    unit: String,
    rms: JsonNumber,
    /// Relative.
    rms_error_bound: JsonNumber,
    rms_reason: Option<String>,
    crossings_hz: JsonNumber,
    crossings_error_bound: JsonNumber,
    crossings_reason: Option<String>,
    modes: Vec<JsonModeShare>,
    /// `null` if they are not known.
    peaks: Option<Vec<JsonPeak>>,
    peaks_reason: Option<String>,
}

/// A peak of a density; bounds are relative.
#[derive(serde::Serialize)]
struct JsonPeak {
    frequency_hz: JsonNumber,
    frequency_error_bound: JsonNumber,
    density: JsonNumber,
    density_error_bound: JsonNumber,
}

/// The share of a mode in a mean square.
#[derive(serde::Serialize)]
struct JsonModeShare {
    mode: usize,
    share: JsonNumber,
}

impl JsonNoisy {
    fn of(noisy: &Noisy, system: &LinearSystem, bounds: Bounds) -> JsonNoisy {
        let output = &system.outputs[noisy.output];
        let parts = |spread: &Spread| match spread {
            Spread::Finite(value) => (JsonNumber::from_enclosure(*value), bounds.relative(*value), None),
            Spread::Infinite(why) => (JsonNumber::NULL, JsonNumber::NULL, Some(why.to_string())),
            Spread::Unknown(why) => (JsonNumber::NULL, JsonNumber::NULL, Some(why.to_string())),
        };
        let (rms, rms_error_bound, rms_reason) = parts(&noisy.rms);
        let (crossings_hz, crossings_error_bound, crossings_reason) = parts(&noisy.crossings);
        let modes =
            noisy.shares.iter().map(|(mode, share)| JsonModeShare { mode: *mode, share: JsonNumber::unproven(*share) });
        JsonNoisy {
            output: system.display(output.name),
            unit: output.unit.clone(),
            rms,
            rms_error_bound,
            rms_reason,
            crossings_hz,
            crossings_error_bound,
            crossings_reason,
            modes: modes.collect(),
            peaks: noisy.peaks.as_ref().ok().map(|peaks| peaks.iter().map(|peak| JsonPeak::of(peak, bounds)).collect()),
            peaks_reason: noisy.peaks.as_ref().err().map(ToString::to_string),
        }
    }
}

impl JsonPeak {
    fn of(peak: &Peak, bounds: Bounds) -> JsonPeak {
        JsonPeak {
            frequency_hz: JsonNumber::from_enclosure(peak.frequency),
            frequency_error_bound: bounds.relative(peak.frequency),
            density: JsonNumber::from_enclosure(peak.density),
            density_error_bound: bounds.relative(peak.density),
        }
    }
}

/// An object with a number for each name, in their order.
struct ByName<'a> {
    names: &'a [String],
    values: Vec<JsonNumber>,
}

impl Serialize for ByName<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (name, value) in self.names.iter().zip(&self.values) {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

/// `all`: the names of the coordinates, followed by those that depend on them.
fn report<'a>(answer: &'a ModalAnswer, options: &'a ReportOptions, all: &'a [String]) -> Report<'a> {
    let (names, dependent) = all.split_at(answer.system.n());
    let bounds = Bounds::about_rest_of(answer);
    let wanted = options.matrices || answer.system.n() <= MATRICES_UP_TO;
    Report {
        vibc: env!("CARGO_PKG_VERSION"),
        schema: SCHEMA,
        model: &answer.model,
        coordinates: names,
        dependent_coordinates: dependent,
        rest: rest(answer, all, bounds),
        matrices: wanted.then(|| matrices(&answer.system, bounds)),
        normalisation: normalisation(options.normalise),
        not_computed: NotComputed {
            modes_below: answer.modes.before.count(),
            modes_above: answer.modes.after,
            poles: answer.poles.left_out,
            poles_between: answer.poles.followed,
            not_proved: answer.not_proved().collect(),
            matrices: !wanted,
        },
        modes: JsonModes { answer, options, names, bounds },
        splits: splits(&answer.modes).iter().map(|split| json_split(split, options, bounds)).collect(),
        poles: answer.poles.list.iter().map(|pole| json_pole(pole, options, bounds)).collect(),
        buckling: answer.buckling.as_ref().map(|found| json_buckling(found, options, names, bounds)),
        parts: parts(answer, names),
        explained: answer.account.as_ref().map(|account| Explained {
            kept: account.kept.iter().map(JsonRemark::of).collect(),
            left_out: account.left_out.iter().map(JsonRemark::of).collect(),
        }),
        solved: answer.solved.iter().map(|solved| json_solved(solved, bounds)).collect(),
        optimised: answer.optimised.iter().map(|found| json_optimised(found, bounds)).collect(),
        requirements: answer.requirements.iter().map(|asked| json_requirement(asked, bounds)).collect(),
        noise: answer.noisy.iter().map(|noisy| JsonNoisy::of(noisy, &answer.system, bounds)).collect(),
        response_spectra: JsonSpectral::of(answer, bounds),
        sensitivities: answer.sensitivities.iter().map(|found| json_sensitivity(found, bounds)).collect(),
        tolerances: answer.tolerated.as_ref().map(|found| JsonTolerated::of(found, &answer.requirements, bounds)),
        damped_shapes: (answer.damped_shapes.iter())
            .map(|shape| json_damped_shape(answer, shape, names, bounds))
            .collect(),
        base_excitation: (answer.excitations.iter())
            .map(|excitation| json_excitation(answer, excitation, bounds))
            .collect(),
    }
}

/// An object with a number for each output, in their order.
struct OutputsByName(Vec<(String, JsonNumber)>);

impl Serialize for OutputsByName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// The point of a turning body that stays in place in a shape.
#[derive(serde::Serialize)]
struct JsonNode {
    body: String,
    x: JsonNumber,
    y: JsonNumber,
    from_centre: bool,
}

impl JsonNode {
    fn of(node: &ShapeNode, system: &LinearSystem) -> JsonNode {
        let [x, y] = node.at.map(JsonNumber::unproven);
        JsonNode { body: system.words.display(node.body), x, y, from_centre: node.from_centre }
    }
}

/// The shape of a damped motion: for each coordinate and output its complex amplitude.
#[derive(serde::Serialize)]
struct JsonDampedShape<'a> {
    motion: usize,
    /// The reason why there are no numbers.
    not_computed: Option<&'static str>,
    shape: EntriesByName<'a>,
    outputs: EntriesByName<'a>,
}

/// Bounds are of the distance in the complex plane, relative to the magnitude; of a phase in degrees.
#[derive(serde::Serialize)]
struct JsonComplexEntry {
    re: JsonNumber,
    im: JsonNumber,
    magnitude: JsonNumber,
    phase_deg: JsonNumber,
    phase_error_bound: JsonNumber,
    error_bound: JsonNumber,
}

/// An object with a complex number for each name, in their order.
struct EntriesByName<'a>(Vec<(Cow<'a, str>, JsonComplexEntry)>);

impl Serialize for EntriesByName<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, entry)| (name, entry)))
    }
}

fn json_damped_shape<'a>(
    answer: &ModalAnswer,
    shape: &DampedShape,
    names: &'a [String],
    bounds: Bounds,
) -> JsonDampedShape<'a> {
    let entry = |disc: &Disc| {
        let (phase, [re, im]) = (disc.phase(), disc.parts().map(JsonNumber::from_enclosure));
        let exact = disc.is_zero();
        JsonComplexEntry {
            re,
            im,
            magnitude: JsonNumber::from_enclosure(disc.gain()),
            phase_deg: JsonNumber::of(phase),
            phase_error_bound: phase.map_or(JsonNumber::NULL, |phase| bounds.absolute(phase)),
            error_bound: if exact { bounds.absolute(disc.gain()) } else { bounds.of(disc.error_bound()) },
        }
    };
    let system = &answer.system;
    let (own, outputs) = match &shape.found {
        Ok(found) => (&found.coordinates[..], &found.outputs[..]),
        Err(_) => (&[][..], &[][..]),
    };
    let own = names.iter().zip(own).map(|(name, disc)| (Cow::Borrowed(name.as_str()), entry(disc)));
    let outputs = system.outputs.iter().zip(outputs);
    let outputs = outputs.map(|(output, disc)| (Cow::Owned(system.display(output.name)), entry(disc)));
    JsonDampedShape {
        motion: shape.number,
        not_computed: shape.found.as_ref().err().copied(),
        shape: EntriesByName(own.collect()),
        outputs: EntriesByName(outputs.collect()),
    }
}

/// Bounds are absolute.
#[derive(serde::Serialize)]
struct JsonExcitation {
    input: String,
    unit: &'static str,
    total: JsonNumber,
    total_error_bound: JsonNumber,
    /// The reason why there are no numbers.
    not_computed: Option<&'static str>,
    modes: Vec<JsonExcited>,
}

#[derive(serde::Serialize)]
struct JsonExcited {
    mode: usize,
    participation: JsonNumber,
    participation_error_bound: JsonNumber,
    effective_mass: JsonNumber,
    effective_mass_error_bound: JsonNumber,
    sum: JsonNumber,
    sum_error_bound: JsonNumber,
}

fn json_excitation(
    answer: &ModalAnswer,
    (input, found): &(usize, Result<Excitation, &'static str>),
    bounds: Bounds,
) -> JsonExcitation {
    let input = &answer.system.inputs[*input];
    let value = |value: Option<Ball>| value.map_or(JsonNumber::NULL, JsonNumber::from_enclosure);
    let bound = |value: Option<Ball>| value.map_or(JsonNumber::NULL, |value| bounds.absolute(value));
    let (total, modes) = match found {
        Ok(excitation) => (Some(excitation.total), &excitation.modes[..]),
        Err(_) => (None, &[][..]),
    };
    JsonExcitation {
        input: answer.system.display(input.name),
        unit: if input.unit == "rad" { "kg*m^2" } else { "kg" },
        total: value(total),
        total_error_bound: bound(total),
        not_computed: found.as_ref().err().copied(),
        modes: (answer.modes.with_numbers().zip(modes))
            .map(|((mode, _), excited)| JsonExcited {
                mode,
                participation: value(excited.participation),
                participation_error_bound: bound(excited.participation),
                effective_mass: value(excited.mass),
                effective_mass_error_bound: bound(excited.mass),
                sum: value(excited.running),
                sum_error_bound: bound(excited.running),
            })
            .collect(),
    }
}

/// The independent parts, each with the numbers of its modes.
fn parts(answer: &ModalAnswer, names: &[String]) -> Vec<JsonPart> {
    let nets = nets(&answer.system);
    let mut parts: Vec<JsonPart> = nets.iter().map(|net| JsonPart::of(net, names)).collect();
    for ((number, _), part) in answer.modes.with_numbers().zip(parts_of_modes(&nets, &answer.modes.list)) {
        parts[part].modes.push(number);
    }
    parts
}

/// The name on the command line.
fn normalisation(normalise: Normalise) -> &'static str {
    match normalise {
        Normalise::Translation => "translation",
        Normalise::Max => "max",
        Normalise::First => "first",
        Normalise::Mass => "mass",
    }
}

fn rest<'a>(answer: &ModalAnswer, names: &'a [String], bounds: Bounds) -> Rest<'a> {
    let tensions = answer.rest.tensions.iter();
    let tensions = tensions.map(|found| (answer.system.display(found.spring), JsonNumber::number(&found.tension)));
    let by_name = |of: &dyn Fn(&Number) -> JsonNumber| ByName {
        names,
        values: answer.displacements().map(|(_, q)| of(q)).collect(),
    };
    let bound = |tension: &Number| bounds.absolute(tension.to_ball());
    let tension_bounds =
        (answer.rest.tensions.iter()).map(|found| (answer.system.display(found.spring), bound(&found.tension)));
    Rest {
        stable: answer.stability == Stability::Stable,
        kind: answer.stability.kind().name(),
        displacement: by_name(&JsonNumber::number),
        displacement_error_bound: by_name(&|q| bounds.absolute(q.to_ball())),
        distance: distance(answer, bounds),
        residual: JsonNumber::unproven(Unproven(answer.rest.residual)),
        proven: answer.rest.is_proven(),
        steps: answer.rest.steps,
        tensions: Named(tensions.collect()),
        tensions_error_bound: Named(tension_bounds.collect()),
    }
}

fn distance(answer: &ModalAnswer, bounds: Bounds) -> Distance {
    let largest = |kind: CoordinateKind| {
        let of_kind = answer.displacements().filter(|(coordinate, _)| coordinate.kind == kind);
        of_kind.map(|(_, value)| value.to_ball().abs()).fold(Ball::ZERO, Ball::or_larger)
    };
    let (translation, rotation) = (largest(CoordinateKind::Translation), largest(CoordinateKind::Rotation));
    Distance {
        translation_m: JsonNumber::from_enclosure(translation),
        rotation_rad: JsonNumber::from_enclosure(rotation),
        translation_error_bound: bounds.absolute(translation),
        rotation_error_bound: bounds.absolute(rotation),
    }
}

fn matrices(system: &LinearSystem, bounds: Bounds) -> Matrices {
    let system = &system.clone().into_flat(u64::MAX).expect("as many entries as there may be");
    let [m, c, k] = [&system.m, &system.c, &system.k].map(|form| form.assemble(system.n()));
    let rows = |form: &[Vec<Ball>]| {
        form.iter().map(|row| row.iter().map(|x| JsonNumber::from_enclosure(*x)).collect()).collect()
    };
    let bound = |form: &[Vec<Ball>]| {
        bounds.of(form.iter().flatten().map(|x| Bound::absolute(*x)).fold(Bound::ZERO, Bound::or_larger))
    };
    Matrices {
        error_bound: MatrixBounds { m: bound(&m), c: bound(&c), k: bound(&k) },
        m: rows(&m),
        c: rows(&c),
        k: rows(&k),
    }
}

/// The values that a shape gives to outputs of displacements, which have no bound.
fn at_named_outputs(system: &LinearSystem, shape: &[Unproven]) -> OutputsByName {
    let named = at_outputs(system, shape).into_iter();
    OutputsByName(named.map(|(name, _, value)| (name, JsonNumber::unproven(value))).collect())
}

/// Displacements of a shape, which have no bound.
fn unproven(shape: &[Unproven]) -> Vec<JsonNumber> {
    shape.iter().copied().map(JsonNumber::unproven).collect()
}

fn json_mode<'a>(
    answer: &ModalAnswer,
    options: &ReportOptions,
    names: &'a [String],
    (number, mode): (usize, &Mode),
    nodes: &[ShapeNode],
    bounds: Bounds,
) -> JsonMode<'a> {
    let system = &answer.system;
    let (omega, frequency, growth) = (mode.angular_frequency(), mode.frequency(), mode.growth_rate());
    let digits = |value: Option<Ball>| value.and_then(|value| digits(&value, options, bounds));
    JsonMode {
        mode: number,
        kind: mode.kind.name(),
        omega: JsonNumber::of(omega),
        frequency_hz: JsonNumber::of(frequency),
        growth_rate: JsonNumber::of(growth),
        omega_error_bound: bounds.of(mode.error_bound()),
        nodes: options.all_shapes.then(|| nodes.iter().map(|node| JsonNode::of(node, system)).collect()),
        outputs: options.all_shapes.then(|| at_named_outputs(&answer.system, &normalise(mode, options.normalise))),
        shape: ByName { names, values: unproven(&normalise(mode, options.normalise)) },
        kinetic: shares(&mode.kinetic, |of| system.display(of)),
        strain: shares(&by_name(&mode.strain), |of| system.display(of)),
        cluster: mode.cluster,
        input_condition: mode.input_condition.map_or(JsonNumber::NULL, JsonNumber::unproven),
        route: mode.route.name(),
        omega_digits: digits(omega),
        frequency_hz_digits: digits(frequency),
        growth_rate_digits: digits(growth),
    }
}

/// The requested digits that are certain; `None` if none were requested or none are certain.
fn digits(value: &Ball, options: &ReportOptions, bounds: Bounds) -> Option<String> {
    let most = options.digits.filter(|_| bounds.hold())? as usize;
    (value.is_zero() || certain_digits(value) > 0).then(|| certain(value, most))
}

fn json_split(split: &Split, options: &ReportOptions, bounds: Bounds) -> JsonSplit {
    JsonSplit {
        modes: [split.lower, split.lower + 1],
        omega: JsonNumber::from_enclosure(split.omega),
        frequency_hz: JsonNumber::from_enclosure(split.frequency()),
        error_bound: bounds.of(split.error_bound()),
        omega_digits: digits(&split.omega, options, bounds),
    }
}

fn json_buckling<'a>(
    found: &Buckling,
    options: &ReportOptions,
    names: &'a [String],
    bounds: Bounds,
) -> JsonBuckling<'a> {
    let (factor, margin) = (found.load_factor, found.margin());
    JsonBuckling {
        load_factor: JsonNumber::from_enclosure(factor),
        error_bound: bounds.relative(factor),
        margin: JsonNumber::from_enclosure(margin),
        margin_error_bound: bounds.relative(margin),
        shape: ByName { names, values: unproven(&found.shape) },
        load_factor_digits: digits(&factor, options, bounds),
        margin_digits: digits(&margin, options, bounds),
    }
}

fn shares<T: Copy>(shares: &[Share<T>], name: impl Fn(T) -> String) -> Vec<JsonShare> {
    shares.iter().map(|share| JsonShare { of: name(share.of), share: JsonNumber::unproven(share.part) }).collect()
}

fn json_pole(pole: &Pole, options: &ReportOptions, bounds: Bounds) -> JsonPole {
    JsonPole {
        re: JsonNumber::from_enclosure(pole.re),
        im: JsonNumber::from_enclosure(pole.im),
        omega: JsonNumber::from_enclosure(pole.modulus()),
        frequency_hz: JsonNumber::from_enclosure(pole.frequency()),
        damping_ratio: JsonNumber::of(pole.damping_ratio),
        damped_frequency_hz: JsonNumber::from_enclosure(pole.damped_frequency()),
        damped_frequency_error_bound: bounds.relative(pole.damped_frequency()),
        kind: pole.kind.name(),
        error_bound: bounds.of(pole.error_bound()),
        damping_ratio_error_bound: pole.damping_ratio.map_or(JsonNumber::NULL, |value| bounds.relative(value)),
        cluster: pole.cluster,
        defective: pole.defective,
        route: pole.route.name(),
        re_digits: digits(&pole.re, options, bounds),
        im_digits: digits(&pole.im, options, bounds),
        damping_ratio_digits: pole.damping_ratio.as_ref().and_then(|zeta| digits(zeta, options, bounds)),
    }
}
