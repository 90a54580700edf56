//! The reduced form: Lagrange's equations without multipliers. In: the equations with their multipliers, the
//! constraints, and the choice of independent coordinates. Out: the velocities of the dependent coordinates in terms of
//! the independent ones, and one equation for each of these.
//!
//! Constraints g(q, u) = 0 hold G_d q_d' + G_i q_i' + G_u u' = 0, so q_d' = N_i q_i' + N_u u' with N = -G_d^-1 G, by
//! Cramer's rule for each group of constraints that share dependent coordinates. With E the left side minus the right,
//! E_i + N_i^T E_d contains no multiplier. If a row of N is constant, the coordinate itself is substituted.

use super::constraint::Constraint;
use super::elimination::solve;
use super::energy::is_motion;
use super::lagrange::{Equation, Line};
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use crate::base::{Number, OrderBy};
use crate::symbols::{Lengths, Sum, Symbol};

/// Maximum number of dependent coordinates that are solved for at once, and of terms of a result.
pub const MOST_TOGETHER: usize = 4;
pub const MOST_TERMS: usize = 60;

/// The equations of motion over the independent coordinates.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The relation for each dependent coordinate.
    pub follows: Vec<Follow>,
    /// The constraints that this follows from; the others follow from them.
    pub held: Vec<usize>,
    pub equations: Vec<Equation>,
}

/// The relation for a dependent coordinate: its velocity is the sum of these ratios times velocities.
#[derive(Clone, Debug)]
pub struct Follow {
    /// Index of the coordinate of the motion.
    pub coordinate: usize,
    pub ratios: Vec<Ratio>,
}

/// A velocity ratio.
#[derive(Clone, Debug)]
pub struct Ratio {
    /// The independent or prescribed coordinate.
    pub by: usize,
    pub form: Sum,
    /// Its name, if it changes with the motion.
    pub name: Option<Symbol>,
}

impl Ratio {
    /// The ratio as written in equations.
    pub fn short(&self) -> Sum {
        self.name.map_or_else(|| self.form.clone(), Sum::name)
    }
}

impl Follow {
    pub fn is_constant(&self) -> bool {
        self.ratios.iter().all(|ratio| ratio.name.is_none())
    }

    fn ratio(&self, by: usize) -> Sum {
        self.ratios.iter().find(|ratio| ratio.by == by).map_or(Sum::ZERO, Ratio::short)
    }

    /// The coordinate, its velocity or its acceleration, if it is proportional to others.
    pub fn in_proportion(&self, motion: &Motion, order: usize) -> Option<Sum> {
        let term = |ratio: &Ratio| &ratio.form * &Sum::name(motion.coordinates[ratio.by].symbols[order]);
        self.is_constant().then(|| self.ratios.iter().fold(Sum::ZERO, |sum, ratio| &sum + &term(ratio)))
    }
}

/// Why equations keep their multipliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// More coordinates depend on each other than are solved for at once; their number.
    Together { dependent: usize },
    /// A velocity ratio would have this many terms.
    Long { terms: usize },
    /// The constraints are not proved to be independent of each other at rest.
    Undecided,
}

/// The relations of all dependent coordinates, and the constraints that give them.
pub fn follows(
    motion: &Motion,
    constraints: &[Constraint],
    independent: &[usize],
    names: &mut Names,
) -> Result<(Vec<Follow>, Vec<usize>), Kept> {
    let dependent: Vec<usize> = (0..motion.free).filter(|index| !independent.contains(index)).collect();
    let columns: Vec<usize> = independent.iter().copied().chain(motion.free..motion.coordinates.len()).collect();
    let slopes: Vec<Vec<Sum>> = constraints.iter().map(|constraint| slopes(motion, constraint)).collect();
    let (mut follows, mut held) = (Vec::new(), Vec::new());
    for (rows, own) in groups(&slopes, &dependent) {
        let is_constant = rows.iter().all(|row| !slopes[*row].iter().any(|slope| slope.mentions(&is_motion)));
        if is_constant {
            follows.extend(in_proportion(&slopes, &rows, &own, &columns, names).ok_or(Kept::Undecided)?);
            held.extend(rows);
            continue;
        }
        if own.len() > MOST_TOGETHER {
            return Err(Kept::Together { dependent: own.len() });
        }
        let rows = independent_rows(&slopes, &rows, &own, names).ok_or(Kept::Undecided)?;
        follows.extend(solve_cramer(&slopes, &rows, &own, &columns)?);
        held.extend(rows);
    }
    follows.order_by_key(|follow| follow.coordinate);
    if follows.len() < dependent.len() {
        return Err(Kept::Undecided);
    }
    name_ratios(&mut follows, motion, names);
    Ok((follows, held))
}

/// The equations of the independent coordinates without multipliers.
pub fn reduce(
    motion: &Motion,
    equations: &[Equation],
    independent: &[usize],
    (follows, held): (Vec<Follow>, Vec<usize>),
) -> Reduced {
    let equations = independent.iter().map(|index| project(*index, equations, &follows, motion)).collect();
    Reduced { follows, held, equations }
}

/// The derivative of a constraint by every coordinate.
fn slopes(motion: &Motion, constraint: &Constraint) -> Vec<Sum> {
    let none = Lengths::default();
    motion.coordinates.iter().map(|c| constraint.equation.derivative(c.symbols[0], &none)).collect()
}

/// Groups of constraints that share dependent coordinates, with these coordinates.
fn groups(slopes: &[Vec<Sum>], dependent: &[usize]) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut groups: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    for (row, slopes) in slopes.iter().enumerate() {
        let mut own: Vec<usize> = dependent.iter().copied().filter(|index| !slopes[*index].is_zero()).collect();
        let mut rows = vec![row];
        for group in std::mem::take(&mut groups) {
            if group.1.iter().any(|index| own.contains(index)) {
                rows.extend(group.0);
                own.extend(group.1);
            } else {
                groups.push(group);
            }
        }
        own.sort_unstable();
        own.dedup();
        rows.sort_unstable();
        groups.push((rows, own));
    }
    groups
}

/// Coordinates that linear constraints tie to others.
fn in_proportion(
    slopes: &[Vec<Sum>],
    rows: &[usize],
    own: &[usize],
    columns: &[usize],
    names: &Names,
) -> Option<Vec<Follow>> {
    let left = |row: &usize| own.iter().map(|index| slopes[*row][*index].clone()).collect();
    let right = |row: &usize| columns.iter().map(|index| -&slopes[*row][*index]).collect();
    let solved = solve(rows.iter().map(|row| (left(row), right(row))).collect(), own.len(), names).ok()?;
    let ratio = |(by, form): (&usize, Sum)| (!form.is_zero()).then_some(Ratio { by: *by, form, name: None });
    let follow = |(coordinate, row): (&usize, Vec<Sum>)| {
        let ratios = columns.iter().zip(row).filter_map(ratio).collect();
        Follow { coordinate: *coordinate, ratios }
    };
    Some(own.iter().zip(solved).map(follow).collect())
}

/// Cramer's rule.
fn solve_cramer(slopes: &[Vec<Sum>], rows: &[usize], own: &[usize], columns: &[usize]) -> Result<Vec<Follow>, Kept> {
    let matrix: Vec<Vec<Sum>> =
        rows.iter().map(|row| own.iter().map(|index| slopes[*row][*index].clone()).collect()).collect();
    let inverse = determinant(&matrix).inverse().ok_or(Kept::Undecided)?;
    let mut follows = Vec::new();
    for (place, coordinate) in own.iter().enumerate() {
        let mut ratios = Vec::new();
        for by in columns {
            let mut replaced = matrix.clone();
            for (entries, row) in replaced.iter_mut().zip(rows) {
                entries[place] = -&slopes[*row][*by];
            }
            let form = (&determinant(&replaced) * &inverse).simplify();
            if form.terms().len() > MOST_TERMS {
                return Err(Kept::Long { terms: form.terms().len() });
            }
            if !form.is_zero() {
                ratios.push(Ratio { by: *by, form, name: None });
            }
        }
        follows.push(Follow { coordinate: *coordinate, ratios });
    }
    Ok(follows)
}

/// As many rows as there are unknowns, independent of each other at rest.
fn independent_rows(slopes: &[Vec<Sum>], rows: &[usize], own: &[usize], names: &Names) -> Option<Vec<usize>> {
    let value = |row: usize, index: usize| names.value_of(&without_motion(&slopes[row][index]));
    let mut left: Vec<(usize, Vec<Number>)> = Vec::new();
    for row in rows {
        left.push((*row, own.iter().map(|index| value(*row, *index)).collect::<Option<Vec<_>>>()?));
    }
    let mut chosen = Vec::new();
    for column in 0..own.len() {
        let place = left.iter().position(|(_, values)| !values[column].may_be_zero())?;
        let (row, pivot) = left.remove(place);
        for (_, values) in &mut left {
            let factor = values[column].checked_div(&pivot[column])?;
            for (value, own) in values.iter_mut().zip(&pivot) {
                *value = &*value - &(&factor * own);
            }
        }
        chosen.push(row);
    }
    chosen.sort_unstable();
    Some(chosen)
}

/// The determinant by expansion along the first row: matrices are small.
fn determinant(matrix: &[Vec<Sum>]) -> Sum {
    let Some((first, others)) = matrix.split_first() else { return Sum::one() };
    let mut sum = Sum::ZERO;
    for (column, entry) in first.iter().enumerate().filter(|(_, entry)| !entry.is_zero()) {
        let minor: Vec<Vec<Sum>> = others
            .iter()
            .map(|row| row.iter().enumerate().filter(|(c, _)| *c != column).map(|(_, sum)| sum.clone()).collect())
            .collect();
        let term = entry * &determinant(&minor);
        sum = if column % 2 == 0 { &sum + &term } else { &sum - &term };
    }
    sum
}

/// Names the ratios that change with the motion: h, with the body that follows and, if there are several, the body that
/// it follows.
fn name_ratios(follows: &mut [Follow], motion: &Motion, names: &mut Names) {
    let label = |index: usize, names: &Names| names.label(motion.coordinates[index].symbols[0]);
    let short = |label: &Label| if label.index.is_empty() { label.word.clone() } else { label.index.clone() };
    let shorts: Vec<String> = follows.iter().map(|follow| short(&label(follow.coordinate, names))).collect();
    let is_alone = |text: &String| shorts.iter().filter(|other| *other == text).count() == 1;
    let mut count = 0;
    for (follow, text) in follows.iter_mut().zip(&shorts) {
        let several = follow.ratios.len() > 1;
        for ratio in follow.ratios.iter_mut().filter(|ratio| ratio.form.mentions(&is_motion)) {
            let own = label(follow.coordinate, names);
            let mut index = if is_alone(text) { text.clone() } else { format!("{},{}", own.word, own.index) };
            if several {
                let by = label(ratio.by, names);
                index += &format!(",{}", if by.index.is_empty() { by.word } else { by.index });
            }
            let symbol = Symbol::new(class::RATIO, count);
            count += 1;
            names.set(symbol, Label::new("h", index), None);
            ratio.name = Some(symbol);
        }
    }
}

/// E_i + N_i^T E_d, with proportional coordinates substituted.
fn project(index: usize, equations: &[Equation], follows: &[Follow], motion: &Motion) -> Equation {
    let own = &equations[index];
    let mut projected = Equation { reactions: Vec::new(), lines: Vec::new(), ..own.clone() };
    let mut lines: Vec<Line> = own.lines.clone();
    for follow in follows {
        let ratio = follow.ratio(index);
        if ratio.is_zero() {
            continue;
        }
        let other = &equations[follow.coordinate];
        projected.plain = &projected.plain + &(&ratio * &other.plain);
        projected.forces = &projected.forces + &(&ratio * &other.forces);
        for line in &other.lines {
            let slope = &ratio * &line.slope;
            match lines.iter_mut().find(|known| known.element == line.element) {
                Some(known) => known.slope = &known.slope + &slope,
                None => lines.push(Line { element: line.element, slope }),
            }
        }
    }
    let put_in = |symbol: Symbol| {
        let follow = follows.iter().filter(|follow| follow.is_constant());
        follow.into_iter().find_map(|follow| {
            let order = motion.coordinates[follow.coordinate].symbols.iter().position(|own| *own == symbol)?;
            follow.in_proportion(motion, order)
        })
    };
    lines.retain(|line| !line.slope.is_zero());
    for line in &mut lines {
        line.slope = line.slope.replace(&put_in);
    }
    lines.order_by_key(|line| line.element);
    projected.lines = lines;
    projected.plain = projected.plain.replace(&put_in);
    projected.forces = projected.forces.replace(&put_in);
    projected
}
