//! Damping that is declared for the whole system: Rayleigh's C = alpha M + beta K, and one ratio for all modes, C = sum
//! 2 zeta omega_i (M x_i)(M x_i)^T over the oscillations. In: a system. Out: its C with these terms added. See
//! docs/method/response.md.

use crate::analysis::AnalysisError;
use crate::analysis::answer::{Mode, ModeKind, Modes, PRECISE};
use crate::analysis::following::static_solution;
use crate::analysis::forms::apply;
use crate::analysis::modes::condense::condense;
use crate::analysis::modes::form::{ModalForm, gram, kinds, shapes};
use crate::analysis::modes::parts::{Part, choose_terms, independent_undamped};
use crate::analysis::modes::structure;
use crate::base::{Ball, Dd, Name, Number, up};
use crate::kernel::dense::Matrix;
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, Form, LinearSystem, Nature, Origin, Source};
use std::collections::BTreeMap;

/// Sums of magnitudes are rounded upwards.
const UP: f64 = up::MILLIONS;

/// What is known of the damping of motion relative to a base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relative {
    /// It acts on motion relative to what follows the base.
    Known,
    /// So it does, but for motions that K does not restrain: it acts on these relative to the ground.
    RigidAgainstGround,
    /// What follows the base is not known: it acts against the ground, or its part alpha M does.
    Unknown,
}

/// Lets the damping alpha M + beta K act on motion relative to an input that moves a base: beta on the rates of the strains, which
/// the base has its part in, alpha on q' - r u', K r = b0, where r has no part in motions that K does not restrain.
pub fn rayleigh_relative_to(system: &mut LinearSystem, alpha: &Number, beta: &Number, input: usize) -> Relative {
    let mut column: BTreeMap<CoordinateId, Number> = BTreeMap::new();
    let mut add = |i: CoordinateId, value: Number| {
        let entry = column.entry(i).or_insert(Number::ZERO);
        *entry = &*entry + &value;
    };
    system.inputs[input].b[0].iter().for_each(|(i, b)| add(*i, beta * b));
    let mut found = Relative::Known;
    if !alpha.is_zero() {
        match carried_coordinates(system, input) {
            None => found = Relative::Unknown,
            Some(Carried { follows, is_unique }) => {
                for (i, momentum) in apply(&system.m, &follows).into_iter().enumerate() {
                    add(CoordinateId(i as u32), alpha * &momentum);
                }
                if !is_unique {
                    found = Relative::RigidAgainstGround;
                }
            }
        }
    }
    let of = &mut system.inputs[input];
    // Of any other r than the one above, something is left where motions are not restrained.
    of.undamped = (found == Relative::Known).then(|| of.b[1].clone());
    add_to(&mut of.b[1], column);
    found
}

/// Adds entries to a column; zeros are left out.
fn add_to(column: &mut Vec<(CoordinateId, Number)>, entries: BTreeMap<CoordinateId, Number>) {
    for (i, value) in entries.into_iter().filter(|(_, value)| !value.is_zero()) {
        match column.iter_mut().find(|(at, _)| *at == i) {
            Some((_, known)) => *known = &*known + &value,
            None => column.push((i, value)),
        }
    }
}

/// Adds alpha M + beta K, term by term; exact if the terms are.
pub fn rayleigh(system: &mut LinearSystem, alpha: &Number, beta: &Number) {
    let (m, k) = (system.m.clone(), system.k.clone());
    let source = source(system);
    for (form, factor) in [(&m, alpha), (&k, beta)] {
        add_scaled(&mut system.c, source, form, factor);
    }
}

fn source(system: &mut LinearSystem) -> u32 {
    let name = Name::plain(system.words.intern("damping"));
    system.c.source(Source { name, origin: Origin::Damping })
}

fn add_scaled(c: &mut Form, source: u32, form: &Form, factor: &Number) {
    for term in form.terms() {
        c.push(source, term.nature, factor * term.weight, form.row(term).copies());
    }
}

/// Adds the damping ratio to every oscillation. The rows are enclosures of numbers that give exactly this C: the
/// uncertainty of the modes is in C, and so in every bound that is computed from it.
///
/// The modes keep the shapes that were refined for it: they are those of the damped system too.
pub fn modal(system: &mut LinearSystem, ratio: &Number, modes: &mut Modes) -> Result<(), AnalysisError> {
    let is_alone = system.c.is_empty() && modes.list.iter().all(|mode| mode.kind != ModeKind::Undetermined);
    let mut terms: Vec<Option<Term>> = vec![None; modes.list.len()];
    for part in &independent_undamped(system) {
        let own = of_part(part, &modes.list);
        if !own.iter().any(|&i| modes.list[i].kind == ModeKind::Oscillation) {
            continue;
        }
        let list: Vec<Mode> = own.iter().map(|&i| local(&modes.list[i], part)).collect();
        let unknown = || AnalysisError::uncertain_modes(system, part.coordinates[0] as usize);
        let basis = Basis::of(system, part, &list).ok_or_else(unknown)?;
        for (column, &i) in own.iter().enumerate() {
            let mode = &mut modes.list[i];
            if mode.kind == ModeKind::Oscillation {
                terms[i] = Some(basis.term(column, part));
            }
            if system.n() <= PRECISE
                && let Some(shape) = basis.shape(column)
            {
                let precise = mode.precise.get_or_insert_with(|| vec![Dd::ZERO; mode.shape.len()]);
                part.coordinates.iter().zip(shape).for_each(|(&c, &x)| precise[c as usize] = x);
            }
        }
    }
    let source = source(system);
    for Term { omega, row } in terms.into_iter().flatten() {
        let weight = &(ratio * &Number::from(2)) * &Number::Ball(omega);
        system.c.push(source, Nature::Property, weight, row.into_iter().map(|(i, x)| (i, Number::Ball(x))));
    }
    if is_alone {
        system.c.gives_damping_ratio(ratio.clone());
    }
    Ok(())
}

/// Lets the terms of C from number `first` on act on motion relative to what follows an input statically, if the input is the
/// motion of a base: adds C r u' to its forces, K r = b0. `None`, and nothing is added, if r is not known.
///
/// Motions that K does not restrain get no damping by modes, so r is taken without them.
pub fn relative_to(system: &mut LinearSystem, first: usize, input: usize) -> Option<()> {
    let follows: Vec<Ball> = carried_coordinates(system, input)?.follows.iter().map(Number::to_ball).collect();
    let mut force: BTreeMap<CoordinateId, Ball> = BTreeMap::new();
    for term in system.c.terms().skip(first) {
        let row = || system.c.row(term).iter().map(|(i, a)| (*i, a.to_ball()));
        let along = row().fold(Ball::ZERO, |sum, (i, a)| sum + a * follows[i.index()]);
        let rate = term.weight.to_ball() * along;
        row().for_each(|(i, a)| {
            let entry = force.entry(i).or_insert(Ball::ZERO);
            *entry = *entry + rate * a;
        });
    }
    let of = &mut system.inputs[input];
    of.undamped = Some(of.b[1].clone());
    add_to(&mut of.b[1], force.into_iter().map(|(i, value)| (i, Number::Ball(value))).collect());
    Some(())
}

/// The static response to an input of 1.
struct Carried {
    /// K r = b0, without a part in motions that K does not restrain: v^T M r = 0.
    follows: Vec<Number>,
    /// Whether K restrains every motion of the parts that the input pushes.
    is_unique: bool,
}

/// Limit on the coordinates of one part: one elimination of a full matrix.
const MOST_CARRIED: usize = 2000;

/// What each coordinate follows of an input statically, exactly where that is found.
fn carried_coordinates(system: &LinearSystem, input: usize) -> Option<Carried> {
    let pushed = &system.inputs[input].b[0];
    let mut found = Carried { follows: vec![Number::ZERO; system.n()], is_unique: true };
    let mut place = vec![0u32; system.n()];
    for part in independent_undamped(system) {
        part.coordinates.iter().zip(0..).for_each(|(&c, i)| place[c as usize] = i);
        let n = part.coordinates.len();
        let mut force = vec![Number::ZERO; n];
        for (i, value) in pushed.iter().filter(|(i, _)| part.coordinates.contains(&i.0)) {
            let entry = &mut force[place[i.index()] as usize];
            *entry = &*entry + value;
        }
        if force.iter().all(Number::is_zero) {
            continue;
        }
        if n > MOST_CARRIED {
            return None;
        }
        let k = choose_terms(&system.k, &part.k, &place);
        let free = structure::null_space(&k, n);
        // With K r + sum v (v . r) = b0 and K v = 0, v . b0 = 0 it follows that v . r = 0.
        if !free.exact || free.vectors.len() != free.dimension {
            return None;
        }
        let free: Vec<Vec<Number>> =
            free.vectors.iter().map(|v| v.iter().cloned().map(Number::from).collect()).collect();
        if !free.iter().all(|v| product(v, &force).is_zero()) {
            return None;
        }
        let mut matrix = k.entries(n);
        for v in &free {
            for (i, row) in matrix.iter_mut().enumerate().filter(|(i, _)| !v[*i].is_zero()) {
                row.iter_mut().zip(v).for_each(|(entry, a)| *entry = &*entry + &(&v[i] * a));
            }
        }
        let mut own = static_solution(&matrix, &force)?;
        if !free.is_empty() {
            found.is_unique = false;
            own = without(&choose_terms(&system.m, &part.m, &place), &free, own)?;
        }
        part.coordinates.iter().zip(own).for_each(|(&c, value)| found.follows[c as usize] = value);
    }
    Some(found)
}

fn product(a: &[Number], b: &[Number]) -> Number {
    a.iter().zip(b).fold(Number::ZERO, |sum, (a, b)| &sum + &(a * b))
}

/// r less its part in some motions, so that v^T M r = 0; `None` if these have no inertia.
fn without(m: &Form, motions: &[Vec<Number>], mut r: Vec<Number>) -> Option<Vec<Number>> {
    let momenta: Vec<Vec<Number>> = motions.iter().map(|v| apply(m, v)).collect();
    let matrix: Vec<Vec<Number>> = motions.iter().map(|v| momenta.iter().map(|p| product(p, v)).collect()).collect();
    let shares = static_solution(&matrix, &momenta.iter().map(|p| product(p, &r)).collect::<Vec<_>>())?;
    for (v, share) in motions.iter().zip(shares) {
        r.iter_mut().zip(v).for_each(|(r, v)| *r = &*r - &(&share * v));
    }
    Some(r)
}

/// 2 zeta omega (M x)(M x)^T for a mode, without the factor zeta.
#[derive(Clone)]
struct Term {
    omega: Ball,
    row: Vec<(CoordinateId, Ball)>,
}

/// The modes in which a part moves.
fn of_part(part: &Part, modes: &[Mode]) -> Vec<usize> {
    let moves = |mode: &Mode| part.coordinates.iter().any(|&c| mode.shape[c as usize] != 0.0);
    (0..modes.len()).filter(|&i| moves(&modes[i])).collect()
}

/// A mode in the coordinates of its part.
fn local(mode: &Mode, part: &Part) -> Mode {
    let coordinates = || part.coordinates.iter().map(|&c| c as usize);
    let precise = mode.precise.as_ref().map(|x| coordinates().map(|c| x[c]).collect());
    Mode { shape: coordinates().map(|c| mode.shape[c]).collect(), precise, ..mode.clone() }
}

/// The modes X of a part, and an enclosure of the rows that make up its C.
struct Basis {
    /// On the coordinates of the part that have inertia.
    form: ModalForm,
    /// M (X + X G), for the G of [`ModalForm::uncertainty`].
    momenta: Matrix<Ball>,
}

impl Basis {
    /// `None` if its massless motions are not known exactly, or the modes are not accurate enough for a bound.
    fn of(system: &LinearSystem, part: &Part, modes: &[Mode]) -> Option<Basis> {
        let n = part.coordinates.len();
        let mut place = vec![0u32; system.n()];
        part.coordinates.iter().zip(0..).for_each(|(&c, i)| place[c as usize] = i);
        let (m, k) = (choose_terms(&system.m, &part.m, &place), choose_terms(&system.k, &part.k, &place));
        let masses = Squares::of_form(&m);
        let (form, motions) = if modes.len() == n {
            let form = ModalForm::from_shapes(shapes(modes), &kinds(modes), &masses, &Squares::of_form(&k), gram);
            let motions = form.shapes.clone();
            (form, motions)
        } else {
            without_massless_motions(&m, &k, n, modes)?
        };
        let slack = form.uncertainty(&kinds(modes))?;
        let mut momenta = momenta(&masses, &motions);
        for i in 0..n {
            let size: f64 = (0..modes.len()).map(|j| momenta[(i, j)].magnitude()).sum();
            (0..modes.len()).for_each(|j| momenta[(i, j)] = momenta[(i, j)].widen(slack * size * UP));
        }
        Some(Basis { form, momenta })
    }

    fn term(&self, mode: usize, part: &Part) -> Term {
        let omega = Ball::exact(self.form.k[(mode, mode)].mid).sqrt();
        let row = part.coordinates.iter().zip(self.momenta.column(mode)).filter(|(_, x)| !x.is_zero());
        Term { omega, row: row.map(|(&c, &x)| (CoordinateId(c), x)).collect() }
    }

    /// The refined shape over the coordinates of the part; `None` if some of them have no inertia.
    fn shape(&self, mode: usize) -> Option<&[Dd]> {
        (self.form.shapes.rows() == self.momenta.rows()).then(|| self.form.shapes.column(mode))
    }
}

/// The modes of a part with motions without inertia, on the coordinates that remain after eliminating these exactly;
/// and the motions of the part on which M acts: those of the remaining coordinates, with the others at rest.
fn without_massless_motions(m: &Form, k: &Form, n: usize, modes: &[Mode]) -> Option<(ModalForm, Matrix<Dd>)> {
    let condensed = condense(m, k, n, &structure::null_space(m, n).vectors).ok()?;
    if condensed.kept.len() != modes.len() {
        return None;
    }
    let whole = shapes(modes);
    let left =
        Matrix::from_fn(modes.len(), modes.len(), |i, j| condensed.seen_by_inertia(condensed.kept[i], whole.column(j)));
    let form = ModalForm::from_shapes(
        left,
        &kinds(modes),
        &Squares::of_form(&condensed.m),
        &Squares::of_form(&condensed.k),
        gram,
    );
    let mut moving = Matrix::zeros(n, modes.len());
    for j in 0..modes.len() {
        condensed.kept.iter().zip(form.shapes.column(j)).for_each(|(&i, &x)| moving[(i, j)] = x);
    }
    Some((form, moving))
}

/// M X
fn momenta(m: &Squares, x: &Matrix<Dd>) -> Matrix<Ball> {
    let mut momenta = Matrix::fill_with(x.rows(), x.columns(), Ball::ZERO);
    for j in 0..x.columns() {
        for t in 0..m.len() {
            let weighted = m.weights[t] * m.stretch(t, x.column(j));
            let (indices, values) = m.row(t);
            for (&i, &a) in indices.iter().zip(values) {
                momenta[(i as usize, j)] = momenta[(i as usize, j)] + weighted * a;
            }
        }
    }
    momenta
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::{modes, poles};

    fn chain() -> LinearSystem {
        let mut system = blank(3);
        for i in 0..3 {
            push(&mut system.m, "2", i, None);
            push(&mut system.k, "50", i, i.checked_sub(1));
        }
        system
    }

    #[test]
    fn every_mode_gets_its_ratio() {
        let mut system = chain();
        let mut undamped = modes(&system).expect("modes");
        modal(&mut system, &Number::from("0.02"), &mut undamped).expect("known modes");
        let poles = poles(&system, &undamped).expect("poles");
        assert_eq!(poles.list.len(), 6);
        for pole in &poles.list {
            let zeta = pole.damping_ratio.expect("no pole at zero");
            assert!((zeta.to_f64() - 0.02).abs() < 1e-16, "{zeta:?}");
        }
    }

    /// zeta_i = (alpha / omega_i + beta omega_i) / 2.
    #[test]
    fn rayleigh_damping_has_its_ratios() {
        let mut system = chain();
        let undamped = modes(&system).expect("modes");
        rayleigh(&mut system, &Number::from("0.1"), &Number::from("0.001"));
        let poles = poles(&system, &undamped).expect("poles");
        for (mode, pair) in undamped.list.iter().zip(poles.list.chunks(2)) {
            let omega = mode.omega.to_f64();
            let zeta = pair[0].damping_ratio.expect("no pole at zero").to_f64();
            assert!((zeta - 0.5 * (0.1 / omega + 0.001 * omega)).abs() < 1e-15);
        }
    }
}
