//! The modes of linkages: deep open chains, whose M is kept as chained rows (docs/method/system.md#deep-trees).
//!
//! In the angles q of the links, every link is coupled to every one above it. In the displacements of the points by
//! which the links are held, each is coupled to its neighbours only: if a chained motion is that of the carrier plus
//! one link's own contribution, z = z' + a q, then z can replace q = (z - z') / a as a coordinate. A motion that hangs
//! on a link by a second point, or in a second direction, keeps a row over these coordinates; of several chained
//! motions of one link, the one that carries most others is taken, so that rows stay short (compare the heavy paths of
//! a tree: Sleator and Tarjan, J. Comput. Syst. Sci. 26 (1983) 362). For the last link of a row, the motion of its
//! centre is taken. The change of coordinates is exact, and so are the terms: no eigenvalue changes.
//!
//! In: a system with chained rows. Out: M, C and K over the new coordinates, if their rows are short; modes in the
//! angles. See docs/method/modes.md#linkages.

use crate::analysis::answer::Modes;
use crate::analysis::error::{AnalysisError, place};
use crate::analysis::modes::request::Request;
use crate::analysis::modes::{MAX_DENSE, modes_as, shape};
use crate::base::{Number, OrderBy, Power};
use crate::system::chain::ChainedRow;
use crate::system::{CoordinateId, Form, LinearSystem};

/// With more entries per coordinate than this, the rows are not short: the links do not hang in one line.
const MOST_ENTRIES: usize = 24;
/// Maximum number of entries of M, C and K together that are written out if no other method applies.
const MOST_WRITTEN_OUT: u64 = 5_000_000;

/// A linkage in the new coordinates.
pub struct Linkage {
    /// M, C and K over the new coordinates; without inputs and outputs.
    pub system: LinearSystem,
    places: Places,
}

impl Linkage {
    /// `None` if no coordinates are found in which the rows are short.
    pub fn of(system: &LinearSystem) -> Option<Linkage> {
        let places = Places::of(system)?;
        Some(Linkage { system: places.system(system)?, places })
    }

    /// Converts the modes of [`Self::system`] into modes of the original system.
    pub fn in_angles(&self, system: &LinearSystem, modes: Modes) -> Modes {
        self.places.in_angles(system, modes)
    }
}

/// The requested modes of a system with chained rows.
pub fn modes(system: &LinearSystem, request: &Request) -> Result<Modes, AnalysisError> {
    match Linkage::of(system) {
        Some(linkage) => modes_as(&linkage.system, request).map(|modes| linkage.in_angles(system, modes)),
        None => modes_as(&write_out_rows(system)?, request),
    }
}

/// Rewrites the system with rows over coordinates alone, if no faster method applies and the rows are not too long.
pub fn write_out_rows(system: &LinearSystem) -> Result<LinearSystem, AnalysisError> {
    let (count, limit, at) = (system.n(), MAX_DENSE, place(system, 0));
    system.clone().into_flat(MOST_WRITTEN_OUT).map_err(|_| AnalysisError::NotSparse { count, limit, at })
}

/// Coordinates q and chained motions z as rows over new coordinates p.
struct Places {
    q: Vec<ChainedRow>,
    z: Vec<ChainedRow>,
}

impl Places {
    fn of(system: &LinearSystem) -> Option<Places> {
        let n = system.n();
        let stands_for = stands_for(system);
        let mut places = Places { q: vec![ChainedRow::new(); n], z: Vec::with_capacity(system.chain.len()) };
        // p_j is q_j if no motion replaces it.
        for (j, row) in places.q.iter_mut().enumerate() {
            if stands_for.of_coordinate[j] == Motion::Itself {
                row.push((CoordinateId(j as u32), Number::ONE));
            }
        }
        let mut entries = 0;
        for (place, row) in system.chain.iter().enumerate() {
            let own = stands_for.by_row[place];
            places.follow(row, own, system, &stands_for)?;
            let z = match own {
                Some(j) => vec![(CoordinateId(j), Number::ONE)],
                None => places.over_reduced(row, n)?,
            };
            entries += z.len();
            places.z.push(z);
            if let Some(j) = own {
                places.solve(j as usize, row, n)?;
            }
            if entries > MOST_ENTRIES * n {
                return None;
            }
        }
        for j in 0..n {
            if let Motion::OfTerm(t) = stands_for.of_coordinate[j] {
                places.solve(j, &system.m.row(system.m.term(t as usize)).to_vec(), n)?;
            }
        }
        let entries: usize = places.q.iter().map(Vec::len).sum();
        let known = places.q.iter().all(|row| !row.is_empty());
        (known && entries <= MOST_ENTRIES * n).then_some(places)
    }

    /// Solves first for those coordinates of a row, other than its own, whose motion comes later.
    fn follow(
        &mut self,
        row: &[(CoordinateId, Number)],
        own: Option<u32>,
        system: &LinearSystem,
        stands_for: &StandsFor,
    ) -> Option<()> {
        let n = system.n();
        for (j, _) in row.iter().filter(|(i, _)| i.index() < n) {
            if Some(j.0) != own && self.q[j.index()].is_empty() {
                let row = match stands_for.of_coordinate[j.index()] {
                    Motion::OfRow(place) => system.chain[place as usize].clone(),
                    Motion::OfTerm(t) => system.m.row(system.m.term(t as usize)).to_vec(),
                    Motion::Itself => continue,
                };
                self.solve(j.index(), &row, n)?;
            }
        }
        Some(())
    }

    /// Solves for q_j = (p_j - rest) / a from the row p_j = rest + a q_j.
    fn solve(&mut self, j: usize, row: &[(CoordinateId, Number)], n: usize) -> Option<()> {
        let (_, a) = row.iter().find(|(i, _)| i.index() == j)?;
        let factor = a.recip()?;
        let rest: ChainedRow = row.iter().filter(|(i, _)| i.index() != j).cloned().collect();
        let mut solved: ChainedRow =
            self.over_reduced(&rest, n)?.into_iter().map(|(i, x)| (i, -&(&x * &factor))).collect();
        solved.push((CoordinateId(j as u32), factor));
        self.q[j] = sum_terms(solved);
        Some(())
    }

    /// Rewrites a row over q and z as one over p; `None` if it refers to rows that are not known yet.
    fn over_reduced(&self, row: &[(CoordinateId, Number)], n: usize) -> Option<ChainedRow> {
        let mut own = ChainedRow::new();
        for (i, value) in row {
            let part = match i.index().checked_sub(n) {
                None => &self.q[i.index()],
                Some(place) => self.z.get(place)?,
            };
            if part.is_empty() {
                return None;
            }
            own.extend(part.iter().map(|(k, factor)| (*k, factor * value)));
        }
        Some(sum_terms(own))
    }

    /// The system over the coordinates p, without inputs and outputs.
    fn system(&self, system: &LinearSystem) -> Option<LinearSystem> {
        Some(LinearSystem {
            words: system.words.clone(),
            coordinates: system.coordinates.clone(),
            m: self.form(&system.m, system.n())?,
            c: self.form(&system.c, system.n())?,
            k: self.form(&system.k, system.n())?,
            chain: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            initial: Vec::new(),
            losses: None,
        })
    }

    fn form(&self, form: &Form, n: usize) -> Option<Form> {
        let mut result = Form::new();
        for source in 0..form.source_count() {
            result.source(form.source_of(source as u32));
        }
        let mut entries = 0;
        for term in form.terms() {
            let row = self.over_reduced(&form.row(term).to_vec(), n)?;
            entries += row.len();
            if entries > MOST_ENTRIES * n.max(form.terms().len()) {
                return None;
            }
            let (weight, row) = with_signs(term.weight, row);
            result.push(term.source, term.nature, weight, row);
        }
        Some(result)
    }

    /// Converts modes with shapes over p into modes of the system.
    fn in_angles(&self, system: &LinearSystem, mut modes: Modes) -> Modes {
        let q = Rows::of(&self.q);
        let masses = Masses::of(system);
        let translates = shape::translates(system);
        for mode in &mut modes.list {
            let places = std::mem::take(&mut mode.shape);
            let mut shape = q.times(&places);
            // The shape is mass-normalised: the total kinetic energy is 1.
            let carried = masses.energy(|i| if translates(i) { shape[i] } else { 0.0 });
            mode.leading = shape::lead(&mut shape, carried, &translates);
            mode.shape = shape;
            mode.precise = None;
        }
        modes
    }
}

/// The motion that a new coordinate represents.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Itself,
    /// The motion of a chained row.
    OfRow(u32),
    /// The motion of the row of a term of M.
    OfTerm(u32),
}

/// For each coordinate the motion that replaces it, and for each chained row the coordinate that it replaces.
struct StandsFor {
    of_coordinate: Vec<Motion>,
    by_row: Vec<Option<u32>>,
}

fn stands_for(system: &LinearSystem) -> StandsFor {
    let n = system.n();
    let followers = followers(system);
    let mut found = StandsFor { of_coordinate: vec![Motion::Itself; n], by_row: vec![None; system.chain.len()] };
    for (place, row) in system.chain.iter().enumerate() {
        let Some(j) = own_coordinate(row, n) else { continue };
        let better = match found.of_coordinate[j as usize] {
            Motion::OfRow(other) => followers[place] > followers[other as usize],
            _ => true,
        };
        if better {
            if let Motion::OfRow(other) = found.of_coordinate[j as usize] {
                found.by_row[other as usize] = None;
            }
            found.of_coordinate[j as usize] = Motion::OfRow(place as u32);
            found.by_row[place] = Some(j);
        }
    }
    for (t, term) in system.m.terms().enumerate() {
        let row = system.m.row(term).to_vec();
        if let Some(j) = own_coordinate(&row, n).filter(|_| row.len() > 1)
            && found.of_coordinate[j as usize] == Motion::Itself
        {
            found.of_coordinate[j as usize] = Motion::OfTerm(t as u32);
        }
    }
    found
}

/// The coordinate whose own contribution a row adds to its carrier's motion: the last one, because carriers come first.
fn own_coordinate(row: &[(CoordinateId, Number)], n: usize) -> Option<u32> {
    let (j, a) = row.iter().filter(|(i, _)| i.index() < n).max_by_key(|(i, _)| *i)?;
    a.exact().is_some().then_some(j.0)
}

/// For each chained motion, how many others hang on it, directly or indirectly.
fn followers(system: &LinearSystem) -> Vec<u32> {
    let n = system.n();
    let mut followers = vec![0u32; system.chain.len()];
    for (place, row) in system.chain.iter().enumerate().rev() {
        for carrier in row.iter().filter_map(|(i, _)| i.index().checked_sub(n)) {
            followers[carrier] = followers[carrier].saturating_add(followers[place] + 1);
        }
    }
    followers
}

/// Sorted, each coordinate once, without zeros.
fn sum_terms(mut row: ChainedRow) -> ChainedRow {
    row.order_by_key(|(i, _)| *i);
    row.dedup_by(|(i, value), (last, sum)| {
        let same = i == last;
        if same {
            *sum = &*sum + &*value;
        }
        same
    });
    row.retain(|(_, value)| !value.is_zero());
    row
}

/// Writes a square whose entries all have one magnitude with a row of signs, and moves the magnitude to the weight.
fn with_signs(weight: &Number, row: ChainedRow) -> (Number, ChainedRow) {
    let Some((_, first)) = row.first().cloned() else { return (weight.clone(), row) };
    let opposite = -&first;
    let sign = |x: &Number| match x.exact()? {
        x if Some(x) == first.exact() => Some(Number::ONE),
        x if Some(x) == opposite.exact() => Some(-&Number::ONE),
        _ => None,
    };
    match row.iter().map(|(i, x)| Some((*i, sign(x)?))).collect() {
        Some(signs) => (weight * &first.square(), signs),
        None => (weight.clone(), row),
    }
}

/// Rows in binary64.
struct Rows {
    starts: Vec<u32>,
    entries: Vec<(u32, f64)>,
}

impl Rows {
    fn of(rows: &[ChainedRow]) -> Rows {
        let mut result = Rows { starts: vec![0], entries: Vec::with_capacity(2 * rows.len()) };
        for row in rows {
            result.entries.extend(row.iter().map(|(i, value)| (i.0, value.to_f64())));
            result.starts.push(result.entries.len() as u32);
        }
        result
    }

    fn row(&self, i: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        let dot = |i: usize| self.row(i).iter().map(|(j, a)| a * x[*j as usize]).sum();
        (0..self.starts.len() - 1).map(dot).collect()
    }
}

/// M through the chained rows.
struct Masses {
    weights: Vec<f64>,
    terms: Rows,
    chain: Rows,
    coordinates: usize,
}

impl Masses {
    fn of(system: &LinearSystem) -> Masses {
        let rows: Vec<ChainedRow> = system.m.terms().map(|term| system.m.row(term).to_vec()).collect();
        let weights = system.m.terms().map(|term| term.weight.to_f64()).collect();
        Masses { weights, terms: Rows::of(&rows), chain: Rows::of(&system.chain), coordinates: system.n() }
    }

    /// q^T M q.
    fn energy(&self, q: impl Fn(usize) -> f64) -> f64 {
        let mut motions: Vec<f64> = (0..self.coordinates).map(q).collect();
        let dot =
            |row: &[(u32, f64)], motions: &[f64]| -> f64 { row.iter().map(|(i, a)| a * motions[*i as usize]).sum() };
        for place in 0..self.chain.starts.len() - 1 {
            motions.push(dot(self.chain.row(place), &motions));
        }
        let energy = |(t, weight): (usize, &f64)| weight * dot(self.terms.row(t), &motions).power(2);
        self.weights.iter().enumerate().map(energy).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::answer::Route;
    use crate::analysis::modal;
    use crate::analysis::modes::eigen::eigenpairs;
    use crate::analysis::modes::pair::Eigenvalue;
    use crate::analysis::modes::request::Which;
    use crate::analysis::modes::terms::Terms;
    use crate::analysis::modes::tree::{forest::Forest, lowest};
    use crate::analysis::test_systems::{blank, push};
    use crate::system::Nature;

    fn number(i: usize, salt: usize) -> Number {
        Number::from(format!("0.{}", 1000 + (i * 7919 + salt * 104_729) % 9000).as_str())
    }

    /// Uneven rods, each hanging on the one that `carrier` names (none: the ground), at a fraction of that rod's
    /// length.
    fn hanging_links(carriers: &[(usize, &str)]) -> LinearSystem {
        let n = carriers.len();
        hanging_with(carriers, |i| number(i, 2), |i| Number::from(format!("{}.7", 3 * (n - i)).as_str()))
    }

    /// Like `hanging_links`, with these masses and with stiffnesses against the ground.
    fn hanging_with(
        carriers: &[(usize, &str)],
        mass: impl Fn(usize) -> Number,
        held_by: impl Fn(usize) -> Number,
    ) -> LinearSystem {
        let n = carriers.len();
        let mut system = blank(n);
        let source = system.m.source(system.coordinates[0].name);
        let q = |i: usize| CoordinateId(i as u32);
        let place = |row: usize| CoordinateId((n + row) as u32);
        // The row of the point from which each rod hangs.
        let mut held: Vec<Option<usize>> = Vec::new();
        for (i, &(carrier, part)) in carriers.iter().enumerate() {
            let own = held.get(carrier).copied().map(|above| {
                let arm = &number(carrier, 1) * &Number::from(part);
                let row = above.map(|above: usize| (place(above), Number::ONE));
                system.chain.push([(q(carrier), arm)].into_iter().chain(row).collect());
                system.chain.len() - 1
            });
            held.push(own);
            let (length, mass) = (number(i, 1), mass(i));
            let centre = [(q(i), &length / &Number::from(2))];
            let row = own.map(|own| (place(own), Number::ONE));
            system.m.push(source, Nature::Property, mass.clone(), centre.into_iter().chain(row));
            let inertia = &(&mass * &length.square()) / &Number::from(12);
            system.m.push(source, Nature::Property, inertia, [(q(i), Number::ONE)]);
            let source = system.k.source(system.coordinates[0].name);
            system.k.push(source, Nature::Property, held_by(i), [(q(i), Number::ONE)]);
        }
        system
    }

    fn row(n: usize) -> Vec<(usize, &'static str)> {
        (0..n).map(|i| (if i == 0 { usize::MAX } else { i - 1 }, "1")).collect()
    }

    fn inner(system: &LinearSystem) -> LinearSystem {
        Linkage::of(system).expect("short rows").system
    }

    fn dense(system: &LinearSystem) -> Vec<(crate::kernel::triple::Triple, f64)> {
        let flat = system.clone().into_flat(u64::MAX).expect("small");
        let pairs = eigenpairs(&flat.k, &flat.m, flat.n(), 1e-20).expect("a regular system");
        let value = |eigenvalue: Eigenvalue| match eigenvalue {
            Eigenvalue::Near { value, radius, .. } => (value, radius),
            Eigenvalue::Zero => panic!("it is held"),
        };
        pairs.into_iter().map(|pair| value(pair.value)).collect()
    }

    #[test]
    fn a_row_of_rods_is_a_tree_of_springs_and_coupled_inertia() {
        let system = hanging_links(&row(14));
        let inner = inner(&system);
        let (m, k) = (Terms::of(&inner.m), Terms::of(&inner.k));
        let forest = Forest::of(&m, &k, inner.n()).expect("a tree");
        assert!(forest.coupled > 1.0 && forest.coupled < 10.0);
        for tolerance in [1e-12, 1e-27] {
            let found = lowest(&forest, 6, tolerance).expect("modes apart");
            assert_eq!(found.len(), 6);
            for (mode, (value, radius)) in found.iter().zip(dense(&system)) {
                let error = (mode.lambda - value).hi().abs();
                assert!(error <= mode.radius + radius, "{error:e} {:e} {radius:e}", mode.radius);
                assert!(mode.radius <= tolerance * value.hi(), "{:e}", mode.radius / value.hi());
            }
        }
    }

    /// Masses and stiffnesses over many decades, lengths of all sizes: every bound holds, and few are wide.
    #[test]
    fn bounds_hold_for_graded_rows_of_rods() {
        let mut seed = 11u64;
        let mut digits = |decades: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let exponent = (seed >> 40) % (decades + 1);
            format!("{}.{:03}e{}", 1 + (seed >> 33) % 9, (seed >> 35) % 1000, exponent as i64 - decades as i64 / 2)
        };
        let mut ratios = Vec::new();
        for case in 0..40 {
            let (n, decades) = (5 + case % 8, [0, 4, 12, 20][case % 4]);
            let [masses, springs] = [0, 1].map(|_| (0..n).map(|_| digits(decades)).collect::<Vec<String>>());
            let number_of = |list: &[String], i: usize| Number::from(list[i].as_str());
            let system = hanging_with(&row(n), |i| number_of(&masses, i), |i| number_of(&springs, i));
            let inner = inner(&system);
            let (m, k) = (Terms::of(&inner.m), Terms::of(&inner.k));
            let Some(found) = Forest::of(&m, &k, n).and_then(|forest| lowest(&forest, 3, 1e-12)) else { continue };
            for (mode, (value, radius)) in found.iter().zip(dense(&system)) {
                let error = (mode.lambda - value).hi().abs();
                assert!(error <= mode.radius + radius, "case {case}: {error:e} {:e} {radius:e}", mode.radius);
                ratios.push(mode.radius / value.hi());
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(
            ratios.len() > 90 && ratios[ratios.len() / 2] < 1e-12,
            "{} {:e}",
            ratios.len(),
            ratios[ratios.len() / 2]
        );
    }

    /// Shapes and shares in the angles of the links agree with those of the system with rows written out.
    #[test]
    fn modes_are_reported_in_link_angles() {
        let system = hanging_links(&row(9));
        let flat = system.clone().into_flat(u64::MAX).expect("small");
        let request = Request::default();
        let (found, known) = (modes_as(&system, &request).expect("modes"), modes_as(&flat, &request).expect("modes"));
        for (a, b) in found.list.iter().zip(&known.list) {
            assert!((a.omega.mid - b.omega.mid).abs().hi <= a.omega.rad + b.omega.rad);
            assert!(a.shape.iter().zip(&b.shape).all(|(x, y)| (x - y).abs() < 1e-12), "{:?} {:?}", a.shape, b.shape);
            assert_eq!(a.kinetic[0].of, b.kinetic[0].of);
            assert!((a.kinetic[0].part.0 - b.kinetic[0].part.0).abs() < 1e-12);
            assert!((a.strain[0].part.0 - b.strain[0].part.0).abs() < 1e-12);
        }
    }

    /// A damper between two links joins the modes; poles do not depend on the coordinates.
    #[test]
    fn damped_poles_are_those_of_the_rows_written_out() {
        let mut system = hanging_links(&row(9));
        push(&mut system.c, "0.03", 4, Some(5));
        let flat = system.clone().into_flat(u64::MAX).expect("small");
        let of = |system: &LinearSystem| modal(system, &Request::default()).expect("poles").poles.list;
        let (found, known) = (of(&system), of(&flat));
        assert_eq!(found.len(), 18);
        for (a, b) in found.iter().zip(&known) {
            let size = b.re.mid.hi.hypot(b.im.mid.hi);
            let error = (a.re.mid - b.re.mid).hi.hypot((a.im.mid - b.im.mid).hi) / size;
            assert!(error <= a.relative_error + b.relative_error, "{error:e}");
            assert!(a.relative_error < 1e-12);
        }
    }

    /// Rods that carry others at several points, with springs between neighbours: rows stay short.
    #[test]
    fn branches_and_springs_between_links_have_short_rows_too() {
        let n = 130;
        let carriers: Vec<(usize, &str)> =
            (0..n).map(|i| if i == 0 { (usize::MAX, "1") } else { ((i - 1) / 2, ["1", "0.4"][i % 2]) }).collect();
        let mut system = hanging_links(&carriers);
        for i in (5..n).step_by(3) {
            push(&mut system.k, "2.3", i, Some((i - 1) / 2));
        }
        let short = inner(&system);
        let longest = short.m.terms().map(|term| short.m.row(term).len()).max();
        assert!(longest <= Some(10), "{longest:?}");
        let request = Request { which: Which::Lowest(5), ..Request::default() };
        let found = modes_as(&system, &request).expect("modes");
        for (mode, (value, radius)) in found.list.iter().zip(dense(&system)) {
            assert_eq!(mode.route, Route::Sparse);
            let error = (mode.omega_squared.mid - value.dd()).hi.abs();
            assert!(error <= mode.omega_squared.rad + radius, "{error:e}");
            assert!(mode.omega_squared.rad <= 1e-12 * value.hi());
        }
    }
}
