//! The stability of the rest, from modes and poles: unstable if anything certainly grows; neutral if a rigid motion is
//! left; stable if it is proved that nothing grows; undetermined otherwise. In: the system, its certified modes and
//! poles. Out: a verdict that only a proof makes. See docs/method/poles.md#kinds-and-stability.

use crate::analysis::answer::{ModeKind, Modes, Pole, PoleKind, Poles};
use crate::analysis::modes::parts::{Part, independent};
use crate::analysis::poles::exact::half_planes_of;
use crate::analysis::poles::passive::{is_semidefinite, takes_energy};
use crate::analysis::poles::proportional::proportional;
use crate::base::Number;
use crate::system::{Form, LinearSystem, Losses};

/// The fate of a small disturbance of the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stability {
    Stable,
    /// A rigid-body mode remains, whose motion neither returns nor diverges.
    Neutral,
    Unstable,
    /// The certified bounds do not decide whether something grows.
    Undetermined,
}

/// A verdict and its reason. Only the analysis of stability makes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    kind: Stability,
    reason: Reason,
}

/// The reason for a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// A pole or a mode certainly grows.
    Growth,
    /// No term of M, C or K supplies energy: M > 0, K >= 0, C >= 0.
    Energy,
    /// Every pole is enclosed in a region where nothing grows, and Routh's count confirms it if the numbers are exact.
    Poles,
    /// The enclosure of a mode or pole leaves open whether it grows.
    Sign,
    /// Some damper feeds energy in, and the poles that would decide are not computed.
    NotComputed,
    /// Some damper feeds energy in, and it is not proved that all poles were found.
    NotCounted,
    /// Routh's count and the poles contradict each other.
    Contradiction,
    /// It is not proven that the linearisation point is a rest.
    Rest,
    /// Some springs have a loss factor, with which poles are not computed.
    Loss,
    /// A motion without stiffness is subject to a law whose tangent is zero, which decides it beyond first order.
    Tangent,
}

impl Verdict {
    pub fn kind(self) -> Stability {
        self.kind
    }

    pub fn reason(self) -> Reason {
        self.reason
    }

    /// The verdict for a rest at which some law has no tangent: motions without stiffness may be held by it, or driven away.
    pub fn with_flat_law(self) -> Verdict {
        match self.kind {
            Stability::Neutral => Verdict { kind: Stability::Undetermined, reason: Reason::Tangent },
            _ => self,
        }
    }

    /// The verdict for a point that is a rest only if that is proven.
    pub fn of_rest(self, proven: bool) -> Verdict {
        if proven { self } else { Verdict { kind: Stability::Undetermined, reason: Reason::Rest } }
    }

    /// A verdict for tests of reports, without an analysis.
    #[cfg(test)]
    pub fn sample(kind: Stability, reason: Reason) -> Verdict {
        Verdict { kind, reason }
    }
}

impl PartialEq<Stability> for Verdict {
    fn eq(&self, kind: &Stability) -> bool {
        self.kind == *kind
    }
}

/// The verdict. Its kind is certain or `Undetermined`; it never relies on the midpoint of an enclosure.
pub fn stability(system: &LinearSystem, modes: &Modes, poles: &Poles) -> Verdict {
    verdict(system, modes, poles, false)
}

/// Like [`stability`], with a damping ratio of each oscillation that C does not contain, and that may feed energy in.
pub fn stability_by_ratio(system: &LinearSystem, modes: &Modes, poles: &Poles, ratio: &Number) -> Verdict {
    verdict(system, modes, poles, !takes_energy(ratio))
}

/// Whether no term of M, C or K supplies energy, so that no motion grows: a proof that needs neither modes nor poles.
pub fn is_passive(system: &LinearSystem) -> bool {
    let feeds = |losses: &Losses| losses.h.terms().any(|term| term.weight.is_negative());
    if system.losses.as_deref().is_some_and(feeds) {
        return false;
    }
    let whole = Part::whole(system);
    is_semidefinite(&system.m, &whole.m) && is_semidefinite(&system.c, &whole.c) && is_semidefinite(&system.k, &whole.k)
}

/// `fed`: whether something other than the terms of C may feed energy in.
fn verdict(system: &LinearSystem, modes: &Modes, poles: &Poles, fed: bool) -> Verdict {
    if system.losses.is_some() {
        return with_losses(system, poles);
    }
    let pole = |is: fn(PoleKind) -> bool| poles.list.iter().any(|pole| is(pole.kind));
    let mode = |kind: ModeKind| modes.before.contains_kind(kind) || modes.list.iter().any(|mode| mode.kind == kind);
    let positive = |of: fn(&LinearSystem) -> &Form, terms: fn(&Part) -> &[u32]| {
        let whole = Part::whole(system);
        is_semidefinite(of(system), terms(&whole))
            || independent(system).iter().all(|part| is_semidefinite(of(system), terms(part)))
    };
    let dissipative = !fed && positive(|system| &system.c, |part| &part.c);
    // Q(s) is K at s = 0 and positive for large s, whatever the dampers are, so for each negative omega^2 one of its
    // eigenvalues vanishes in between: a growing pole. Motions without inertia may hide it behind a damper that feeds
    // energy in.
    let diverges = mode(ModeKind::Divergence) && (modes.infinite == 0 || dissipative);
    if diverges || pole(|kind| matches!(kind, PoleKind::Divergence | PoleKind::Flutter)) {
        return Verdict { kind: Stability::Unstable, reason: Reason::Growth };
    }
    if pole(|kind| kind == PoleKind::Undetermined) || mode(ModeKind::Undetermined) {
        return Verdict { kind: Stability::Undetermined, reason: Reason::Sign };
    }
    let held = !mode(ModeKind::Divergence) && (modes.infinite == 0 || positive(|system| &system.k, |part| &part.k));
    let inertial = positive(|system| &system.m, |part| &part.m);
    let passive = dissipative || (!fed && is_classical(system));
    let reason = if held && inertial && passive { Reason::Energy } else { count_reason(system, poles, fed) };
    let rigid = mode(ModeKind::Rigid) || pole(|kind| kind == PoleKind::Rigid);
    let kind = match reason {
        Reason::Energy | Reason::Poles if rigid => Stability::Neutral,
        Reason::Energy | Reason::Poles => Stability::Stable,
        _ => Stability::Undetermined,
    };
    Verdict { kind, reason }
}

/// The verdict with loss factors, by the poles above the real axis and their mirror images.
fn with_losses(system: &LinearSystem, poles: &Poles) -> Verdict {
    let pole = |is: fn(&Pole) -> bool| poles.list.iter().any(is);
    let undetermined = |reason: Reason| Verdict { kind: Stability::Undetermined, reason };
    if !poles.is_complete() {
        return undetermined(Reason::Loss);
    }
    if pole(|pole| matches!(pole.kind, PoleKind::Divergence | PoleKind::Flutter)) {
        return Verdict { kind: Stability::Unstable, reason: Reason::Growth };
    }
    let decays = |pole: &Pole| pole.kind == PoleKind::Rigid || pole.re.is_negative();
    let reason = match is_passive(system) {
        true => Reason::Energy,
        false if poles.list.iter().all(decays) => Reason::Poles,
        false => return undetermined(Reason::Sign),
    };
    let is_neutral = pole(|pole| pole.kind == PoleKind::Rigid);
    Verdict { kind: if is_neutral { Stability::Neutral } else { Stability::Stable }, reason }
}

/// The reason if no known pole grows: whether the poles are complete, and whether Routh's count, which uses only C,
/// agrees.
fn count_reason(system: &LinearSystem, poles: &Poles, fed: bool) -> Reason {
    if poles.left_out > 0 {
        return Reason::NotComputed;
    }
    if !poles.is_complete() {
        return Reason::NotCounted;
    }
    if fed || agrees_with_count(system, poles) { Reason::Poles } else { Reason::Contradiction }
}

/// Checks Routh's count, which uses no value of a pole, in the small parts with exact numbers: it must find no growing
/// pole, no more poles on the axis than may be there, and, if all parts are of this kind, as many as are reported.
fn agrees_with_count(system: &LinearSystem, poles: &Poles) -> bool {
    let parts = independent(system);
    let mut local = vec![0u32; system.n()];
    for part in &parts {
        part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
    }
    let counts: Vec<_> = parts.iter().filter_map(|part| half_planes_of(system, part, &local)).collect();
    let [left, axis, right] = counts
        .iter()
        .fold([0; 3], |[left, axis, right], count| [left + count.left, axis + count.axis, right + count.right]);
    let near_axis = poles.list.iter().filter(|pole| pole.re.contains_zero()).count();
    let all = counts.len() < parts.len() || left + axis == poles.list.len();
    right == 0 && axis <= near_axis && all
}

/// Whether C = alpha M + beta K with neither factor negative: then it is positive if M and K are.
fn is_classical(system: &LinearSystem) -> bool {
    proportional(system, &Part::whole(system))
        .is_some_and(|damping| !damping.alpha.is_negative() && !damping.beta.is_negative())
}

impl Stability {
    /// The name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Stability::Stable => "stable",
            Stability::Neutral => "neutral",
            Stability::Unstable => "unstable",
            Stability::Undetermined => "undetermined",
        }
    }
}

impl Reason {
    /// The part of the proof that is missing, if the verdict is undetermined; empty otherwise.
    pub fn not_proved(self) -> &'static str {
        match self {
            Reason::Growth | Reason::Energy | Reason::Poles => "",
            Reason::Sign => "the bounds of a mode or pole do not decide whether it grows",
            Reason::NotComputed => "some damper adds energy, and the poles that would decide are not computed",
            Reason::NotCounted => "some damper adds energy, and it is not proved that the list of poles is complete",
            Reason::Contradiction => {
                "the poles contradict Routh's count of them: report this model as a defect of vibc"
            }
            Reason::Rest => "it is not proven that the scene rests here",
            Reason::Loss => "a spring has a loss factor, and the poles are not found with it",
            Reason::Tangent => {
                "a law has no tangent here: it may hold the motions without stiffness, or drive them away"
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes;
    use crate::analysis::poles::count::PoleCount;
    use crate::analysis::poles::poles;
    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::base::{Ball, Dd, Number};
    use crate::system::CoordinateId;

    /// An oscillator with a damper that feeds energy in: two growing poles.
    fn oscillator_fed_by_damper() -> LinearSystem {
        let mut system = oscillator("1", "0.1", "4");
        let (term, mut c) = (system.c.term(0), Form::new());
        let source = c.source(system.c.source_of(term.source));
        c.push(source, term.nature, -term.weight, system.c.row(term).copies());
        system.c = c;
        system
    }

    /// If growing poles are missing from the list, the verdict is never stable.
    #[test]
    fn a_list_without_its_growing_poles_proves_nothing() {
        let system = oscillator_fed_by_damper();
        let modes = modes(&system).expect("modes");
        let all = poles(&system, &modes).expect("poles");
        assert_eq!(stability(&system, &modes, &all), Stability::Unstable);
        let reason = |poles: Poles| {
            let verdict = stability(&system, &modes, &poles);
            assert_eq!(verdict.kind(), Stability::Undetermined);
            verdict.reason()
        };
        assert_eq!(reason(Poles::default()), Reason::NotCounted);
        assert_eq!(reason(Poles { left_out: 2, ..Poles::default() }), Reason::NotComputed);
        // A count that belongs to other poles: one more, and the right number of wrong ones.
        assert_eq!(reason(Poles { count: Some(PoleCount::sample(2, 0)), ..Poles::default() }), Reason::NotCounted);
        let decaying = poles(&oscillator("1", "0.1", "4"), &modes).expect("poles");
        assert!(decaying.is_complete());
        assert_eq!(reason(decaying), Reason::Contradiction);
    }

    /// A damping ratio that C does not contain: no term shows the energy that it feeds in, so only all poles could
    /// prove that nothing grows.
    #[test]
    fn a_negative_ratio_dissipates_no_energy() {
        let system = oscillator("1", "0.1", "4");
        let modes = modes(&system).expect("modes");
        let some = Poles { left_out: 2, ..Poles::default() };
        let reason = |ratio: &Number| stability_by_ratio(&system, &modes, &some, ratio).reason();
        assert_eq!(reason(&Number::from("0.1")), Reason::Energy);
        assert_eq!(reason(&-&Number::from("0.1")), Reason::NotComputed);
        assert_eq!(reason(&Number::Ball(Ball::new(Dd::ZERO, 1e-30))), Reason::NotComputed);
    }

    /// Two parallel dampers whose sum dissipates energy: no pole needs to be known.
    #[test]
    fn energy_alone_is_a_proof() {
        let mut system = blank(1);
        push(&mut system.m, "1", 0, None);
        push(&mut system.k, "4", 0, None);
        push(&mut system.c, "0.3", 0, None);
        let fed = oscillator_fed_by_damper();
        let term = fed.c.term(0);
        let source = system.c.source(fed.c.source_of(term.source));
        system.c.push(source, term.nature, term.weight.clone(), fed.c.row(term).copies());
        let verdict = stability(&system, &modes(&system).expect("modes"), &Poles::default());
        assert_eq!((verdict.kind(), verdict.reason()), (Stability::Stable, Reason::Energy));
    }

    /// A damper of -0.1 on one of two masses that a stiff spring joins, and one of 1 on the other: C is indefinite, and
    /// all poles together with Routh's count prove that all of them decay.
    #[test]
    fn all_poles_are_a_proof_where_energy_is_none() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, None);
        }
        push(&mut system.k, "10", 1, Some(0));
        push(&mut system.c, "1", 0, None);
        let (source, nature) = (system.c.term(0).source, system.c.term(0).nature);
        system.c.push(source, nature, -&Number::from("0.1"), [(CoordinateId(1), Number::ONE)]);
        let modes = modes(&system).expect("modes");
        let verdict = stability(&system, &modes, &poles(&system, &modes).expect("poles"));
        assert_eq!((verdict.kind(), verdict.reason()), (Stability::Stable, Reason::Poles));
        assert!(verdict != Stability::Neutral && verdict != Stability::Undetermined);
    }

    /// Routh's count against lists of poles of other systems: each of its three checks alone detects the contradiction.
    #[test]
    fn a_count_can_contradict_uncertain_poles() {
        let list = |c: &str| {
            let system = oscillator("1", c, "4");
            poles(&system, &modes(&system).expect("modes")).expect("poles")
        };
        let damped = oscillator("1", "0.1", "4");
        assert!(agrees_with_count(&damped, &list("0.1")));
        // There are two poles on the axis, and none in the list.
        let mut undamped = oscillator("1", "0.1", "4");
        undamped.c = Form::new();
        assert!(!agrees_with_count(&undamped, &list("0.1")));
        // Two poles more than there are.
        let mut twice = list("0.1");
        twice.list.extend(twice.list.clone());
        assert!(!agrees_with_count(&damped, &twice));
        // Growing poles next to a part whose numbers are not rational, which Routh's count omits.
        let mut system = blank(2);
        push(&mut system.m, "1", 0, None);
        push(&mut system.m, "1", 1, None);
        push(&mut system.k, "4", 0, None);
        let fed = oscillator_fed_by_damper();
        for (form, source, weight) in [(&mut system.c, &fed.c, None), (&mut system.k, &fed.k, Number::from(2).sqrt())] {
            let term = source.term(0);
            let to = form.source(source.source_of(term.source));
            let at = CoordinateId(u32::from(weight.is_some()));
            form.push(to, term.nature, weight.unwrap_or(term.weight.clone()), [(at, Number::ONE)]);
        }
        assert!(!agrees_with_count(&system, &twice));
    }

    /// The conditions of the energy argument: a positive M, a K that restrains motions without inertia, and C = alpha M
    /// + beta K with neither negative.
    #[test]
    fn energy_proves_nothing_without_each_of_its_parts() {
        let (mut light, mut falling) = (blank(1), blank(1));
        for (system, m, k) in [(&mut light, -1, 4), (&mut falling, 1, -4)] {
            let row = || [(CoordinateId(0), Number::ONE)];
            for (form, weight) in [(&mut system.m, m), (&mut system.k, k)] {
                let source = form.source(system.coordinates[0].name);
                form.push(source, crate::system::Nature::Property, Number::from(weight), row());
            }
            push(&mut system.c, "0.1", 0, None);
        }
        let none = |infinite: usize| Modes { infinite, ..Modes::default() };
        assert_eq!(stability(&light, &none(0), &Poles::default()).reason(), Reason::NotCounted);
        assert_eq!(stability(&falling, &none(1), &Poles::default()).reason(), Reason::NotCounted);
        // A negative omega^2 is a growing pole, unless motions without inertia may hide it behind a damper that feeds
        // energy in.
        let mut diverging = modes(&falling).expect("modes");
        assert_eq!(stability(&falling, &diverging, &Poles::default()).reason(), Reason::Growth);
        diverging.infinite = 1;
        assert_eq!(stability(&falling, &diverging, &Poles::default()).reason(), Reason::Growth);
        falling.c = oscillator_fed_by_damper().c;
        assert_ne!(stability(&falling, &diverging, &Poles::default()).reason(), Reason::Growth);
        // C = M / 2 - K / 10
        let mut rayleigh = blank(2);
        for (i, (k, c)) in [("4", "0.1"), ("9", "-0.4")].into_iter().enumerate() {
            push(&mut rayleigh.m, "1", i, None);
            push(&mut rayleigh.k, k, i, None);
            let source = rayleigh.c.source(rayleigh.coordinates[0].name);
            let weight = if i == 0 { Number::from(c) } else { -&Number::from("0.4") };
            rayleigh.c.push(source, crate::system::Nature::Property, weight, [(CoordinateId(i as u32), Number::ONE)]);
        }
        assert!(!is_classical(&rayleigh));
    }

    /// Adds a weight of either sign, or none.
    fn push_signed(form: &mut Form, weight: &str) {
        let size = Number::from(weight.trim_start_matches('-'));
        let weight = if weight.starts_with('-') { -&size } else { size };
        if !weight.is_zero() {
            let source = form.source(blank(1).coordinates[0].name);
            form.push(source, crate::system::Nature::Property, weight, [(CoordinateId(0), Number::ONE)]);
        }
    }

    /// An oscillator with a damper and a loss factor, each of either sign.
    fn lossy(c: &str, k: &str, loss: &str) -> LinearSystem {
        let mut system = blank(1);
        push(&mut system.m, "1", 0, None);
        for (form, weight) in [(&mut system.c, c), (&mut system.k, k)] {
            push_signed(form, weight);
        }
        let mut losses = Losses { b: vec![Vec::new()], p: vec![Vec::new()], d: vec![Vec::new()], ..Losses::default() };
        push_signed(&mut losses.h, loss);
        system.losses = Some(losses.into());
        system
    }

    #[test]
    fn with_loss_factors_all_poles_or_energy_are_a_proof() {
        let verdict = |system: &LinearSystem, poles: &Poles| {
            let verdict = stability(system, &Modes::default(), poles);
            (verdict.kind(), verdict.reason())
        };
        let own = |c: &str, k: &str, loss: &str| {
            let system = lossy(c, k, loss);
            let poles = poles(&system, &modes(&system).expect("modes")).expect("poles");
            (verdict(&system, &poles), is_passive(&system))
        };
        assert_eq!(own("0.1", "4", "1"), ((Stability::Stable, Reason::Energy), true));
        assert_eq!(own("-0.1", "4", "1"), ((Stability::Stable, Reason::Poles), false));
        assert_eq!(own("1", "4", "-0.1"), ((Stability::Stable, Reason::Poles), false));
        assert_eq!(own("-1", "4", "0.1"), ((Stability::Unstable, Reason::Growth), false));
        assert_eq!(own("0.1", "4", "-1"), ((Stability::Unstable, Reason::Growth), false));
        assert!(!own("1", "-4", "1").1);
        assert_eq!(own("1", "0", "0"), ((Stability::Neutral, Reason::Energy), true));
        // Lists that lack a pole, or hold one whose sign is not known.
        let system = lossy("-0.1", "4", "1");
        let found = poles(&system, &modes(&system).expect("modes")).expect("poles");
        assert_eq!(verdict(&system, &Poles { count: None, ..found.clone() }), (Stability::Undetermined, Reason::Loss));
        let mut short = found.clone();
        short.list.truncate(1);
        assert_eq!(verdict(&system, &short), (Stability::Undetermined, Reason::Loss));
        let mut unknown = found.clone();
        (unknown.list[0].re, unknown.list[0].kind) = (Ball::new(Dd::ZERO, 1e-3), PoleKind::Undetermined);
        assert_eq!(verdict(&system, &unknown), (Stability::Undetermined, Reason::Sign));
        // A rigid motion beside one that decays.
        let mut rigid = found;
        (rigid.list[0].re, rigid.list[0].kind) = (Ball::ZERO, PoleKind::Rigid);
        assert_eq!(verdict(&system, &rigid), (Stability::Neutral, Reason::Poles));
    }

    /// A mass that takes energy, or a spring, beside damping that does not.
    #[test]
    fn each_form_has_to_be_passive() {
        for which in 0..4 {
            let mut system = oscillator("1", "0.1", "4");
            let forms = [&mut system.m, &mut system.c, &mut system.k];
            if let Some(form) = forms.into_iter().nth(which) {
                push_signed(form, "-10");
            }
            assert_eq!(is_passive(&system), which == 3, "{which}");
        }
    }

    /// A pole whose sign is not known leaves the verdict open, though all poles are counted; and a motion that is rigid by the modes
    /// alone, or by the poles alone, makes it neutral.
    #[test]
    fn each_pole_and_each_mode_counts_for_the_verdict() {
        let system = lossy("-0.1", "4", "0");
        let system = LinearSystem { losses: None, ..system };
        let decaying = {
            let system = oscillator("1", "0.1", "4");
            poles(&system, &modes(&system).expect("modes")).expect("poles")
        };
        let mut unknown = decaying.clone();
        (unknown.list[0].re, unknown.list[0].kind) = (Ball::new(Dd::ZERO, 1e-3), PoleKind::Undetermined);
        for system in [&system, &oscillator("1", "0.1", "4")] {
            let verdict = stability(system, &Modes::default(), &unknown);
            assert_eq!((verdict.kind(), verdict.reason()), (Stability::Undetermined, Reason::Sign));
        }
        let mut free = blank(1);
        push(&mut free.m, "1", 0, None);
        push(&mut free.c, "1", 0, None);
        let (of_free, rigid) =
            (modes(&free).expect("modes"), poles(&free, &modes(&free).expect("modes")).expect("poles"));
        for (modes, poles) in [(&of_free, &Poles::default()), (&Modes::default(), &rigid), (&of_free, &rigid)] {
            let verdict = stability(&free, modes, poles);
            assert_eq!((verdict.kind(), verdict.reason()), (Stability::Neutral, Reason::Energy));
        }
    }

    /// Two poles on the axis beside two that decay, of which the list holds the latter alone.
    #[test]
    fn poles_on_the_axis_are_in_the_count() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "4", i, None);
        }
        push(&mut system.c, "0.1", 0, None);
        let list = |system: &LinearSystem| poles(system, &modes(system).expect("modes")).expect("poles");
        assert!(agrees_with_count(&system, &list(&system)));
        assert!(!agrees_with_count(&system, &list(&oscillator("1", "0.1", "4"))));
    }
}
