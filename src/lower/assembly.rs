//! The matrices about a rest, as sums of signed squares. In: a scene, its kinematics and a state. Out: the linear system.
//! See docs/method/linearisation.md and docs/method/system.md.
//!
//! Rows run over all coordinates, including the prescribed motions u of bases. A square w r r^T with r = (r_q, r_u) adds
//! w r_q r_q^T to its matrix and -w r_q r_u^T to the input columns of the same order: K to B0, C to B1, M to B2. In a
//! scene with constraints, every row is first written in terms of the independent coordinates, and the curvature of the
//! constraints, weighted by their multipliers, adds to K.

mod effects;
pub mod losses;
mod released;

pub use effects::Idle;
pub use released::{Carried, released_reactions};

use super::chain::{self, Chain};
use super::constraints::{Constraints, Reduction, equation};
use super::error::LowerError;
use super::initial;
use super::kinematics::{End, Index, Kinematics, Path, PathEvaluation, State};
use super::law;
use super::loads::{self, EndPath};
use super::rest::{Held, Slack};
use crate::base::{Dimension, Name, Number, Words};
use crate::elements::stretch::over_length;
use crate::elements::{Order, Stretch, Stretched, Vector};
use crate::model::scene::{Attachment, Element, Geometry, Input, InputKind, Motion, Output, Scene};
use crate::system::chain::ChainedRow;
use crate::system::{self, Coordinate, CoordinateId, Form, Label, LinearSystem, Nature, Origin, Source};

/// A row over all coordinates, free and prescribed.
pub type Row = Vec<(Index, Number)>;

type Sparse = Vec<(CoordinateId, Number)>;

/// Knowledge of tensions beyond the state.
#[derive(Clone, Copy)]
pub struct Tensions<'a> {
    /// The tensions found for `rest as drawn`.
    pub held: Option<&'a Held>,
    /// The springs without tension.
    pub slack: &'a Slack,
}

/// Whether the terms of a system are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terms {
    Kept,
    /// Each is dropped once it is known what it acts on, which is all that a check without numbers needs. The system is then
    /// without terms and coordinates.
    Dropped,
}

/// The linear system about a state, which must be a rest.
pub fn assemble(
    scene: &Scene,
    kinematics: &Kinematics,
    constraints: &Constraints,
    reduction: &Reduction,
    state: &State<Number>,
    tensions: Tensions,
    terms: Terms,
) -> Result<(LinearSystem, Vec<Idle>), Vec<LowerError>> {
    let mut assembly = Assembly::new(scene, kinematics, reduction, state, tensions);
    match terms {
        Terms::Kept => {
            assembly.m.reserve(scene.bodies.len(), reduction.n());
            assembly.k.reserve(scene.elements.len(), 2 * scene.elements.len());
        }
        Terms::Dropped => assembly.felt = Some([(); 3].map(|()| vec![false; reduction.n()])),
    }
    assembly.inertia();
    assembly.gravity();
    for (number, element) in scene.elements.iter().enumerate() {
        assembly.element(number, element);
    }
    if !assembly.faults.is_empty() {
        return Err(std::mem::take(&mut assembly.faults));
    }
    assembly.reactions(constraints);
    assembly.every_freedom_is_determined()?;
    for (index, input) in scene.inputs.iter().enumerate() {
        assembly.constant_load(index, input);
    }
    for (index, input) in scene.inputs.iter().enumerate() {
        assembly.input(index, input);
    }
    let outputs = scene.outputs.iter().map(|output| assembly.output(output)).collect();
    let initial = initial::initial(scene, &mut assembly)?;
    let idle = assembly.idle_parts();
    Ok((assembly.finish(outputs, initial), idle))
}

/// Additional outputs of a scene whose system has been assembled: rows over its coordinates at the rest.
pub fn outputs<'a>(
    scene: &Scene,
    kinematics: &Kinematics,
    reduction: &Reduction,
    state: &State<Number>,
    outputs: impl IntoIterator<Item = &'a Output>,
) -> Vec<system::Output> {
    let tensions = Tensions { held: None, slack: &Slack::default() };
    let mut assembly = Assembly::new(scene, kinematics, reduction, state, tensions);
    outputs.into_iter().map(|output| assembly.output(output)).collect()
}

/// The system during assembly, with buffers for intermediate results.
pub struct Assembly<'a> {
    scene: &'a Scene,
    kinematics: &'a Kinematics,
    reduction: &'a Reduction,
    state: &'a State<Number>,
    tensions: Tensions<'a>,
    words: Words,
    m: Form,
    c: Form,
    k: Form,
    /// Columns of each input: B0, B1, B2.
    columns: Vec<[Row; 3]>,
    between: EndPath<Number>,
    reach: PathEvaluation<Number>,
    row: Row,
    chain: Vec<ChainedRow>,
    /// Indices of the elements without a term.
    idle: Vec<usize>,
    /// The springs whose law has zero slope at rest.
    flat: Vec<usize>,
    /// Inputs whose constant part changes the stiffness, whether or not the rest drives anything.
    stiffening: Vec<usize>,
    /// The forces on released motions, if there are any.
    released: Option<released::Forces>,
    /// Laws that have no tangent at rest.
    faults: Vec<LowerError>,
    /// If no term is kept: the coordinates that those of M, C and K contained.
    felt: Option<[Vec<bool>; 3]>,
}

impl<'a> Assembly<'a> {
    fn new(
        scene: &'a Scene,
        kinematics: &'a Kinematics,
        reduction: &'a Reduction,
        state: &'a State<Number>,
        tensions: Tensions<'a>,
    ) -> Assembly<'a> {
        Assembly {
            scene,
            kinematics,
            reduction,
            state,
            tensions,
            words: scene.words.clone(),
            m: Form::new(),
            c: Form::new(),
            k: Form::new(),
            columns: vec![Default::default(); scene.inputs.len()],
            between: EndPath::default(),
            reach: PathEvaluation::default(),
            row: Row::new(),
            chain: Vec::new(),
            idle: Vec::new(),
            flat: Vec::new(),
            stiffening: Vec::new(),
            released: None,
            faults: Vec::new(),
            felt: None,
        }
    }

    fn finish(self, outputs: Vec<system::Output>, initial: Vec<(CoordinateId, Number, Number)>) -> LinearSystem {
        let inputs = self.scene.inputs.iter().zip(self.columns);
        let inputs = inputs.map(|(input, columns)| system::Input {
            name: input_label(self.scene, input),
            span: input.span,
            unit: input_unit(input),
            b: columns.map(merge_column),
            undamped: None,
        });
        LinearSystem {
            words: self.words,
            coordinates: (0..if self.felt.is_some() { 0 } else { self.reduction.n() })
                .map(|place| coordinate(self.scene, self.kinematics, self.reduction.at(place)))
                .collect(),
            m: self.m,
            c: self.c,
            k: self.k,
            chain: self.chain,
            inputs: inputs.collect(),
            outputs,
            initial,
            losses: None,
        }
    }

    /// Adds m |du|^2 for every centre of mass and I dtheta^2 for every body that turns.
    fn inertia(&mut self) {
        let mut path = Path::default();
        let chain = self.kinematics.hangs_deep(self.scene).then(|| Chain::new(self.kinematics, self.state));
        for (index, body) in self.scene.bodies.iter().enumerate() {
            let piece = self.kinematics.tree.bodies[index];
            let source = self.m.source(Source { name: body.name, origin: Origin::Body(index as u32) });
            let chained = chain.as_ref().filter(|chain| !chain.is_still(piece));
            let mass = body.mass.as_ref().filter(|mass| !mass.is_zero());
            if let (Some(mass), Some(chain)) = (mass, chained) {
                let (from, to) = (chain::anchor(self.kinematics, piece), End { piece, at: body.centre.as_deref() });
                self.kinematics.path_between(from, to, &mut path);
                self.reach.measure(self.kinematics, self.state, &path);
                for axis in 0..2 {
                    self.m.push(source, Nature::Property, mass.clone(), chain.row(piece, &self.reach, axis));
                }
            } else if let Some(mass) = mass {
                loads::path_from_ground(self.kinematics, End { piece, at: body.centre.as_deref() }, &mut path);
                self.reach.measure(self.kinematics, self.state, &path);
                self.mass(source, mass);
            }
            if let (Some(inertia), Some(angle)) = (&body.inertia, self.kinematics.angle(piece)) {
                self.row.clear();
                self.row.push((angle, Number::ONE));
                self.square(Order::Acceleration, source, Nature::Property, inertia);
            }
            self.drop_terms();
        }
        self.chain = chain.map_or_else(Vec::new, |chain| chain.rows);
    }

    /// m |du|^2: a single square if the centre moves along one direction, otherwise one for each axis.
    fn mass(&mut self, source: u32, mass: &Number) {
        if let [(coordinate, column)] = &self.reach.columns[..] {
            let weight = mass * &column.norm_squared();
            self.row.clear();
            self.row.push((*coordinate, Number::ONE));
            return self.square(Order::Acceleration, source, Nature::Property, &weight);
        }
        for axis in Vector::axes() {
            self.reach.row(&axis, &mut self.row);
            self.square(Order::Acceleration, source, Nature::Property, mass);
        }
    }

    /// The curvature of the paths of all centres of mass under their weights.
    fn gravity(&mut self) {
        if self.scene.gravity.is_zero() {
            return;
        }
        let path = self.kinematics.mass_weighted_path(self.scene, &self.scene.gravity);
        self.reach.measure(self.kinematics, self.state, &path);
        let name = Name::plain(self.words.intern("gravity"));
        let source = self.k.source(Source { name, origin: Origin::Gravity });
        self.curvature(source, &Vector::of(&self.scene.gravity).negate());
    }

    fn element(&mut self, number: usize, element: &Element) {
        let terms = |assembly: &Self| [&assembly.k, &assembly.c, &assembly.m].map(|form| form.terms().len());
        let before = terms(self);
        self.terms_of(number, element);
        if terms(self) == before && self.flat.last() != Some(&number) {
            self.idle.push(number);
        }
        self.drop_terms();
    }

    /// Adds the square of an element to the matrix of its order and, for an elastic element, the contribution of its
    /// tension to K.
    fn terms_of(&mut self, number: usize, element: &Element) {
        let law = &element.law;
        let order = law.kind.order;
        let stretch = self.between.set_ends(self.kinematics, &element.ends, &element.law.geometry);
        let stretched = self.measure_stretch(&stretch);
        let made_by = Source { name: element.name, origin: Origin::Element(number as u32) };
        let source = self.form(order).source(made_by);
        let coefficient = self.tangent(element, &stretch, &stretched);
        if law.kind.is_elastic() && law.curve.is_some() && coefficient.is_zero() {
            self.slope(&stretched);
            self.flat.extend((!self.row.is_empty()).then_some(number));
        }
        self.slope_square(order, source, &coefficient, &stretched);
        if law.kind.is_elastic() && !(self.reach.is_straight() && stretched.is_linear()) {
            let rate = match self.tensions.held.and_then(|held| held.rate(number)) {
                Some(rate) => rate.clone(),
                None if self.tensions.slack.contains(self.kinematics, &self.between) => Number::ZERO,
                None => {
                    let spring = loads::spring_of(stretch, &element.ends, law);
                    stretched.rate(&spring.tension(&stretched))
                }
            };
            self.tension(source, &rate, &stretched);
        }
    }

    /// The coefficient of an element; of a nonlinear spring its tangent at rest, which must have one.
    fn tangent(&mut self, element: &Element, stretch: &Stretch<Number>, stretched: &Stretched<Number>) -> Number {
        if !(element.law.kind.is_elastic() && element.law.curve.is_some()) {
            return element.law.coefficient.clone();
        }
        let spring = loads::spring_of(stretch.clone(), &element.ends, &element.law);
        if let Some(error) = law::fault(self.scene, element, &spring, stretched) {
            self.faults.push(error);
        }
        spring.stiffness(stretched)
    }

    fn form(&mut self, order: Order) -> &mut Form {
        match order {
            Order::Displacement => &mut self.k,
            Order::Velocity => &mut self.c,
            Order::Acceleration => &mut self.m,
        }
    }

    /// The stretch of the path in `between`; leaves its columns in `reach`.
    fn measure_stretch(&mut self, stretch: &Stretch<Number>) -> Stretched<Number> {
        self.reach.measure(self.kinematics, self.state, &self.between.path);
        stretch.at(&self.reach.displacement, &self.between.turn(self.state))
    }

    /// grad e as a row, to be divided by the root of the number returned.
    fn slope(&mut self, stretched: &Stretched<Number>) -> Number {
        loads::slope(stretched, &self.reach, &self.between, &mut self.row)
    }

    /// w (grad e)(grad e)^T.
    fn slope_square(&mut self, order: Order, source: u32, weight: &Number, stretched: &Stretched<Number>) {
        let length_squared = self.slope(stretched);
        if !self.row.is_empty() {
            self.square(order, source, Nature::Property, &(weight / &length_squared));
        }
    }

    /// Adds T grad^2 e: the curvature of the stretch, and of the paths of its ends.
    fn tension(&mut self, source: u32, rate: &Number, stretched: &Stretched<Number>) {
        for square in stretched.tension_squares(rate).into_iter().flatten() {
            self.reach.row(&square.direction, &mut self.row);
            self.square(Order::Displacement, source, Nature::Geometric, &square.weight);
        }
        if let Some(force) = stretched.force(rate).filter(|force| !force.is_zero()) {
            self.curvature(source, &force);
        }
    }

    /// Adds force . grad^2 u of the path in `reach`.
    fn curvature(&mut self, source: u32, force: &Vector<Number>) {
        let mut entries = Vec::new();
        self.reach.curvature(force, |i, j, value| entries.push((i, j, value)));
        for (i, j, value) in entries {
            self.pair(source, i, j, &value);
        }
    }

    /// Adds value (e_i e_j^T + e_j e_i^T) to K, or value e_i e_i^T for i = j: as squares, value/2 ((e_i + e_j)^2 - (e_i -
    /// e_j)^2).
    fn pair(&mut self, source: u32, i: Index, j: Index, value: &Number) {
        if i == j {
            self.row.clear();
            self.row.push((i, Number::ONE));
            return self.square(Order::Displacement, source, Nature::Geometric, value);
        }
        if self.is_driven(i) || self.is_driven(j) {
            return self.drive_pair(i, j, value);
        }
        for sign in [1, -1] {
            self.row.clear();
            self.row.extend([(i, Number::ONE), (j, Number::from(sign))]);
            let weight = value / &Number::from(2 * sign);
            self.square(Order::Displacement, source, Nature::Geometric, &weight);
        }
    }

    /// Whether a coordinate is moved only by prescribed motions.
    fn is_driven(&self, coordinate: Index) -> bool {
        if self.reduction.is_trivial() {
            return coordinate as usize >= self.kinematics.n();
        }
        let mut row = vec![(coordinate, Number::ONE)];
        self.kinematics.unfold(&mut row);
        self.reduction.reduce(&mut row);
        row.iter().all(|(i, _)| *i as usize >= self.kinematics.n())
    }

    /// The part of such a pair that is driven by prescribed motions, which have no place in K.
    fn drive_pair(&mut self, i: Index, j: Index, value: &Number) {
        let [first, second] = [i, j].map(|coordinate| self.to_system_row(vec![(coordinate, Number::ONE)]));
        for (one, other) in [(&first, &second), (&second, &first)] {
            if let Some(released) = &mut self.released {
                released.product(Order::Displacement, value, one, other);
            }
            for (free, left) in one {
                let Some(place) = self.reduction.place(*free) else { continue };
                for (driver, right) in other {
                    if let Some(input) = self.input_of(*driver) {
                        self.columns[input][0].push((place.0, -&(&(value * left) * right)));
                    }
                }
            }
        }
    }

    fn input_of(&self, coordinate: Index) -> Option<usize> {
        let prescribed = (coordinate as usize).checked_sub(self.kinematics.n())?;
        // Released motions are no inputs.
        self.kinematics.prescribed_inputs.get(prescribed).map(|input| *input as usize)
    }

    /// Adds weight row row^T for the current row.
    fn square(&mut self, order: Order, source: u32, nature: Nature, weight: &Number) {
        self.kinematics.unfold(&mut self.row);
        self.reduction.reduce(&mut self.row);
        let weight = self.scale_to_metres(weight);
        self.drive(order, &weight);
        if let Some(released) = &mut self.released {
            released.square(order, &weight, &self.row);
        }
        let reduction = self.reduction;
        let row = self.row.drain(..);
        let row = row.filter_map(|(coordinate, value)| Some((reduction.place(coordinate)?, value)));
        match order {
            Order::Displacement => self.k.push(source, nature, weight, row),
            Order::Velocity => self.c.push(source, nature, weight, row),
            Order::Acceleration => self.m.push(source, nature, weight, row),
        }
    }

    /// Converts from coordinates measured in units of an irrational length to metres. If the whole row is measured in the
    /// same unit, the weight absorbs it and the square stays exact.
    fn scale_to_metres(&mut self, weight: &Number) -> Number {
        if !self.kinematics.has_oblique() {
            return weight.clone();
        }
        let length = |(coordinate, _): &(Index, Number)| self.kinematics.length_squared(*coordinate);
        let first = self.row.first().and_then(length);
        if let Some(first) = first
            && self.row.iter().all(|entry| length(entry) == Some(first))
        {
            return weight / first;
        }
        measure(self.kinematics, &mut self.row);
        weight.clone()
    }

    /// Adds the part of a square that is driven by prescribed motions.
    fn drive(&mut self, order: Order, weight: &Number) {
        for (driver, driving) in &self.row {
            let Some(input) = self.input_of(*driver) else { continue };
            let factor = -&(weight * driving);
            let entries = self.row.iter().filter_map(|(i, value)| Some((self.reduction.place(*i)?.0, value)));
            self.columns[input][order as usize].extend(entries.map(|(place, value)| (place, &factor * value)));
        }
    }

    /// A constant load is part of the rest; only its curvature remains.
    fn constant_load(&mut self, index: usize, input: &Input) {
        let Some(load) = loads::constant(input) else { return };
        let before = self.k.terms().len();
        let source = self.k.source(Source { name: input.name, origin: Origin::Input(index as u32) });
        match &input.kind {
            InputKind::Force { ends, direction } => {
                for (end, force) in ends.iter().zip(loads::opposite_forces(&load, direction)) {
                    let end = self.kinematics.end(end);
                    loads::path_from_ground(self.kinematics, end, &mut self.between.path);
                    self.reach.measure(self.kinematics, self.state, &self.between.path);
                    self.curvature(source, &force.negate());
                }
            }
            InputKind::ForceBetween { ends } => {
                let spring = loads::pushing_spring(self.kinematics, ends, &load, &mut self.between);
                let stretched = self.measure_stretch(&spring.stretch);
                self.tension(source, &stretched.rate(&spring.tension(&stretched)), &stretched);
            }
            InputKind::Torque { .. } | InputKind::Unbalance { .. } | InputKind::Base { .. } => {}
        }
        if self.k.terms().len() > before {
            self.stiffening.push(index);
        }
    }

    /// Adds lambda . grad^2 g of the constraints, with the multipliers lambda that balance all other forces.
    fn reactions(&mut self, constraints: &Constraints) {
        if constraints.is_empty() {
            return;
        }
        let forces = self.slopes();
        let multipliers = self.reduction.multipliers(&forces, constraints.list.len());
        for ((index, constraint), multiplier) in (0..).zip(&constraints.list).zip(&multipliers) {
            if multiplier.is_zero() {
                continue;
            }
            let name = constraint.source.name(self.scene);
            let source = self.k.source(Source { name, origin: Origin::Constraint(index) });
            let mut entries = Vec::new();
            let visit = |i, j, value| entries.push((i, j, value));
            constraint.equation.curvature(self.kinematics, self.state, multiplier, &mut self.reach, visit);
            for (i, j, value) in entries {
                self.pair(source, i, j, &value);
            }
        }
    }

    /// The column of a force or torque: the gradient of the motion through which it does work. An unbalance acts by its
    /// second derivative, the other way.
    fn input(&mut self, index: usize, input: &Input) {
        let mut column = match &input.kind {
            InputKind::Force { ends, direction } => self.force_column(ends, &Vector::of(direction)),
            InputKind::ForceBetween { ends } => {
                let stretch = self.between.set_ends(self.kinematics, ends, &Geometry::Line);
                let stretched = self.measure_stretch(&stretch);
                self.slope_row(&stretched)
            }
            InputKind::Torque { ends } => self.torque_column(ends),
            InputKind::Unbalance { end, direction, .. } => self.force_column(end, &Vector::of(direction)),
            InputKind::Base { .. } => return,
        };
        let mut order = Order::Displacement;
        if matches!(input.kind, InputKind::Unbalance { .. }) {
            order = Order::Acceleration;
            column.iter_mut().for_each(|(_, value)| *value = -&*value);
        }
        if let Some(released) = &mut self.released {
            released.input(index, order, &column);
        }
        let placed = column.drain(..).filter_map(|(i, value)| Some((self.reduction.place(i)?.0, value)));
        self.columns[index][order as usize].extend(placed);
    }

    fn force_column(&mut self, ends: &[Attachment], direction: &Vector<Number>) -> Row {
        let mut column = Row::new();
        for (end, sign) in ends.iter().zip([1, -1]) {
            let row = self.displacement_row(self.kinematics.end(end), direction);
            column.extend(row.into_iter().map(|(coordinate, value)| (coordinate, &value * &Number::from(sign))));
        }
        column
    }

    fn torque_column(&self, ends: &[Attachment]) -> Row {
        let angle = |end: &Attachment| self.kinematics.angle(self.kinematics.tree.piece(end.part));
        let ends = ends.iter().zip([1, -1]);
        self.to_system_row(ends.filter_map(|(end, sign)| Some((angle(end)?, Number::from(sign)))).collect())
    }

    /// The final form of a row over all coordinates: a row over the system's coordinates and the prescribed ones, in m
    /// and rad.
    fn to_system_row(&self, mut row: Row) -> Row {
        self.kinematics.unfold(&mut row);
        self.reduction.reduce(&mut row);
        measure(self.kinematics, &mut row);
        row
    }

    /// Gradient of the displacement of a point along a direction, over all coordinates, in m and rad.
    fn displacement_row(&mut self, end: End, direction: &Vector<Number>) -> Row {
        loads::path_from_ground(self.kinematics, end, &mut self.between.path);
        self.reach.measure(self.kinematics, self.state, &self.between.path);
        self.reach.row(direction, &mut self.row);
        let length_squared = direction.norm_squared();
        let row = self.row.drain(..).map(|(i, value)| (i, over_length(value, &length_squared))).collect();
        self.to_system_row(row)
    }

    /// grad e over all coordinates, in m and rad.
    fn slope_row(&mut self, stretched: &Stretched<Number>) -> Row {
        let length_squared = self.slope(stretched);
        let row = self.row.drain(..).map(|(i, value)| (i, over_length(value, &length_squared))).collect();
        self.to_system_row(row)
    }

    /// A motion as a row and the order of its derivative.
    pub fn motion(&mut self, motion: &Motion) -> (u8, Row) {
        match motion {
            Motion::Point { part, at, direction, derivative } => {
                let end = self.kinematics.point(*part, at.as_deref());
                (*derivative, self.displacement_row(end, &Vector::of(direction)))
            }
            Motion::Turn { part, derivative } => {
                let angle = self.kinematics.angle(self.kinematics.tree.piece(*part));
                (*derivative, self.to_system_row(angle.map(|angle| (angle, Number::ONE)).into_iter().collect()))
            }
            Motion::Force { element } => self.element_force(&self.scene.elements[element.index()]),
            Motion::Stretch { element } => (0, self.element_slope(&self.scene.elements[element.index()])),
            // Added once the rest is known: see `super::reactions`.
            Motion::Reaction(_) => (0, Row::new()),
        }
    }

    /// A motion over the coordinates of the system; bases are at rest.
    pub fn placed_motion(&mut self, motion: &Motion) -> (u8, Row) {
        let (derivative, row) = self.motion(motion);
        let placed = row.into_iter().filter_map(|(i, value)| Some((self.reduction.place(i)?.0, value)));
        (derivative, placed.collect())
    }

    fn element_slope(&mut self, element: &Element) -> Row {
        let stretch = self.between.set_ends(self.kinematics, &element.ends, &element.law.geometry);
        let stretched = self.measure_stretch(&stretch);
        self.slope_row(&stretched)
    }

    /// The change of tension of a spring, or the force of another element: its coefficient times a derivative of its
    /// stretch.
    fn element_force(&mut self, element: &Element) -> (u8, Row) {
        let stretch = self.between.set_ends(self.kinematics, &element.ends, &element.law.geometry);
        let stretched = self.measure_stretch(&stretch);
        let factor = self.tangent(element, &stretch, &stretched);
        let slope = self.slope_row(&stretched);
        (element.law.kind.order as u8, slope.into_iter().map(|(i, value)| (i, &value * &factor)).collect())
    }

    fn output(&mut self, output: &Output) -> system::Output {
        let rows = self.combination(output).map(equation::merge_entries);
        let free = |row: &Row| -> Sparse {
            row.iter().filter_map(|(i, value)| Some((self.reduction.place(*i)?, value.clone()))).collect()
        };
        let driven =
            |row: &Row| row.iter().filter_map(|(i, value)| Some((self.input_of(*i)? as u32, value.clone()))).collect();
        let (p, d) = (rows.each_ref().map(free), rows.each_ref().map(driven));
        system::Output { name: plain(output.name), unit: output_unit(output), p, d }
    }

    /// A linear combination of motions: a row for each derivative.
    fn combination(&mut self, output: &Output) -> [Row; 3] {
        let mut rows: [Row; 3] = Default::default();
        for term in &output.terms {
            let (derivative, row) = self.motion(&term.motion);
            let coefficient = output.coefficient(term);
            let scaled = row.into_iter().map(|(i, value)| (i, &value * &coefficient));
            rows[usize::from(derivative).min(2)].extend(scaled);
        }
        rows
    }
}

/// Divides by the lengths that are the units of oblique coordinates.
fn measure(kinematics: &Kinematics, row: &mut Row) {
    for (coordinate, value) in row {
        if let Some(length_squared) = kinematics.length_squared(*coordinate) {
            *value = over_length(std::mem::replace(value, Number::ZERO), length_squared);
        }
    }
}

/// A column over coordinates of the system: one entry for each, ascending, without zeros.
fn merge_column(column: Row) -> Sparse {
    equation::merge_entries(column).into_iter().map(|(place, value)| (CoordinateId(place), value)).collect()
}

/// A coordinate of the tree as the system presents it.
pub fn coordinate(scene: &Scene, kinematics: &Kinematics, coordinate: Index) -> Coordinate {
    let body = &scene.bodies[kinematics.free[coordinate as usize].index()];
    let name = Label { name: body.name, motion: kinematics.motion(scene, coordinate) };
    Coordinate { name, kind: kinematics.kind(coordinate), span: body.span }
}

fn plain(name: Name) -> Label {
    Label { name, motion: "" }
}

/// The input of a base with one motion has the base's name; with several, the motion's name as well. So has that of an
/// unbalance by its axis.
fn input_label(scene: &Scene, input: &Input) -> Label {
    let motion = match input.kind {
        InputKind::Base { base, translation } => {
            let base = &scene.bases[base.index()];
            let several = base.translations.len() + usize::from(base.turns) > 1;
            match translation {
                Some(which) if several => base.translations[which].motion,
                None if several => "angle",
                _ => "",
            }
        }
        InputKind::Unbalance { axis, .. } => axis.name(),
        _ => "",
    };
    Label { name: input.name, motion }
}

fn input_unit(input: &Input) -> &'static str {
    match input.kind {
        InputKind::Force { .. } | InputKind::ForceBetween { .. } => "N",
        InputKind::Torque { .. } => "N*m",
        InputKind::Unbalance { .. } => "kg*m",
        InputKind::Base { translation: Some(_), .. } => "m",
        InputKind::Base { translation: None, .. } => "rad",
    }
}

/// The unit given by the model, or the usual one: radians for angles and their derivatives.
fn output_unit(output: &Output) -> String {
    if let Some(unit) = &output.unit {
        return unit.text.clone();
    }
    match (output.is_angle, output.dimension) {
        (true, Dimension::NONE) => "rad".into(),
        (true, Dimension::ANGULAR_VELOCITY) => "rad/s".into(),
        (_, dimension) => dimension.usual_unit(),
    }
}
