//! Each part of the bound beside what it bounds, at its worst: sums of powers in closed form, norms beside all vectors of a circle, and the
//! roundings of a step, which numbers count that know their size and their error while they go through the step as it is emitted.

use super::tests::{advance, cell};
use super::*;
use std::ops::{Add, Mul};

/// Between what is to be bounded and this much more.
fn is_bound(bound: f64, truth: f64, over: f64) -> bool {
    bound >= truth * (1.0 - 1e-14) && bound <= truth * (1.0 + over) + f64::MIN_POSITIVE
}

/// The roundings of the bound itself.
const OVER: f64 = 1e-4;

/// Vectors all around.
fn circle() -> impl Iterator<Item = [f64; 2]> {
    (0..2000).map(|i| f64::from(i) * std::f64::consts::PI / 1000.0).map(|angle| [angle.cos(), angle.sin()])
}

/// How large a number and its error may be, in units of the roundoff, by coefficients, products and sums: each is rounded, but that a
/// factor of one or a sum with nothing is exact.
#[derive(Clone, Copy)]
struct Rounded {
    size: f64,
    error: f64,
    /// A coefficient of one, by which nothing is multiplied.
    is_one: bool,
}

impl From<f64> for Rounded {
    fn from(x: f64) -> Rounded {
        let is_one = x.abs() == 1.0;
        Rounded { size: x.abs(), error: if x == 0.0 || is_one { 0.0 } else { x.abs() }, is_one }
    }
}

impl Add for Rounded {
    type Output = Rounded;
    fn add(self, b: Rounded) -> Rounded {
        let size = self.size + b.size;
        // The sum with nothing is exact.
        let own = if self.size == 0.0 || b.size == 0.0 { 0.0 } else { size };
        Rounded { size, error: self.error + b.error + own, is_one: false }
    }
}

impl Mul for Rounded {
    type Output = Rounded;
    fn mul(self, b: Rounded) -> Rounded {
        let size = self.size * b.size;
        let is_exact = [self, b].iter().any(|x| x.size == 0.0 || x.is_one);
        let own = if is_exact { 0.0 } else { size };
        Rounded { size, error: self.size * b.error + b.size * self.error + own, is_one: false }
    }
}

/// An error of a part of the output that grows with it, and parts that add up: e = b (1 + e).
#[test]
fn errors_of_states_and_sums_add_up() {
    let cell = |step: f64| CellRounding { name: "a".into(), step, growth: Growth::Geometric(0.0), felt: None };
    for (output, step, truth) in [(0.25, 0.25, 1.0), (0.5, 0.0625, 9.0 / 7.0), (1e-3, 2e-3, 3.0 / 997.0)] {
        let rounding = Rounding { output, cells: vec![cell(0.5 * step), cell(step)] };
        assert!(is_bound(rounding.error_after(1).value(), truth, OVER), "{output} {step}");
        let each: Vec<f64> = rounding.errors_after(1).map(|(_, bound)| bound.value()).collect();
        assert!(is_bound(each[1], truth, OVER) && is_bound(each[0], 1.0 / (1.0 / (output + 0.5 * step) - 1.0), OVER));
    }
    for (output, step) in [(0.5, 0.5), (1.0, 0.0), (0.0, 3.0)] {
        assert_eq!(Rounding { output, cells: vec![cell(step)] }.error_after(1).value(), f64::INFINITY);
    }
}

/// Of the latest 1024 steps what an output feels, of those before all that is kept of them, and never more than all of all steps.
#[test]
fn errors_of_the_latest_steps_and_of_those_before() {
    let sums: Vec<f64> = (0..=FOLLOWED).map(|i| 0.25 * (i + 1) as f64).collect();
    let of = |step: f64, kept: f64, steps: u64| {
        let felt = Some(Felt { sums: sums.clone(), kept });
        CellRounding { name: String::new(), step, growth: Growth::Geometric(0.0), felt }.after(steps)
    };
    for (steps, latest) in [(1, 0), (2, 1), (3, 2), (4, 2), (5, 3), (1000, 10), (1024, 10)] {
        assert_eq!(of(3.0, 0.5, steps), sums[latest], "{steps}");
    }
    for (steps, before) in [(1025, 1.0), (1030, 6.0), (5000, 3976.0)] {
        assert!(is_bound(of(3.0, 0.5, steps), sums[10] + 3.0 * 0.5 * before, OVER), "{steps}");
        assert!(is_bound(of(0.25, 0.5, steps), sums[10] + 0.25 * 0.5 * before, OVER), "{steps}");
    }
    // All errors together are less than what is felt of them in the worst case.
    assert_eq!(of(1e-3, 2.0, 100), 0.1);
    assert_eq!(of(1e-3, 3.0, 2000), 2.0);
}

/// 1 + r + .. + r^(N-1), added one by one.
#[test]
fn sums_of_powers_are_those_of_the_series() {
    let sum = |r: f64, n: u64| (0..n).fold((0.0, 1.0), |(sum, power), _| (sum + power, power * r));
    for lost in [0.5, 0.25, 1e-3, 1e-9, 0.0, -1e-9, -1e-3, -0.25] {
        let growth = Growth::Geometric(lost);
        for n in [1, 2, 3, 10, 60] {
            let (truth, found) = (sum(1.0 - lost, n).0, growth.after(n));
            assert!(found >= truth * (1.0 - 1e-12), "{lost} {n}: {found} {truth}");
            // Of a motion that decays it is at most that of all steps, or of one that does not.
            let most = if lost > 0.0 { (n as f64).min(1.0 / lost) } else { truth };
            assert!(is_bound(found, most, OVER), "{lost} {n}: {found} {most}");
        }
        let ([last, most], truth) = (growth.powers(), sum(1.0 - lost, 1024).1);
        assert!(is_bound(last, truth, OVER) && is_bound(most, truth.max(1.0), OVER), "{lost}");
    }
    // One state: sums of any length, and the last power.
    for r in [0.0f64, 0.5, -0.75, 0.999, -1.0, 1.0, 1.001] {
        let growth = Growth::Doubling(powers(Matrix::fill_with(1, 1, r)));
        for i in 0..=12 {
            let truth = sum(r.abs(), 1 << i).0;
            assert!(is_bound(growth.after(1 << i), truth, 2e-4), "{r} {i}: {} {truth}", growth.after(1 << i));
            assert!(growth.after((1 << i) + 1) >= truth + r.abs().powi(1 << i));
        }
        let ([last, most], truth) = (growth.powers(), sum(r.abs(), 1024).1);
        assert!(last >= truth && last <= truth * (1.0 + OVER) + 3e-5 && most >= truth.max(1.0), "{r}: {last} {truth}");
        assert!(growth.after(1 << 40).is_finite() || r > 1.0);
        assert_eq!(growth.after((1 << 40) + 1), f64::INFINITY);
    }
    // [1 1; 0 1]^j = [1 j; 0 1], whose norm is (j + sqrt(j^2 + 4)) / 2, and a rotation, whose powers have the norm one.
    let shear = powers(Matrix::from_fn(2, 2, |i, j| if i <= j { 1.0 } else { 0.0 }));
    for (i, bound) in shear.iter().enumerate().take(8) {
        let truth: f64 = (0..1u32 << i).map(f64::from).map(|j| 0.5 * (j + (j * j + 4.0).sqrt())).sum();
        assert!(*bound >= truth, "{i}");
        assert!(i != 1 || is_bound(*bound, truth, OVER), "{i}");
    }
    let turn = powers(Matrix::from_fn(2, 2, |i, j| [[0.6, 0.8], [-0.8, 0.6]][i][j]));
    assert!((0..=20).all(|i| is_bound(turn[i], (1u64 << i) as f64, 1e-3)));
}

/// A frame of two modes beside all vectors of length one: each number is the largest that any of them has.
#[test]
fn norms_are_those_of_the_worst_vector() {
    let frames = [
        Norm::Euclidean,
        Norm::Modal { k: 2.0, mu: [0.5, 1.5] },
        Norm::Modal { k: -0.25, mu: [3.0, 0.5] },
        Norm::Modal { k: 4.0, mu: [-0.125, 0.0625] },
    ];
    for norm in &frames {
        let unit = |[a, b]: [f64; 2]| match norm {
            Norm::Euclidean => [a, b],
            // k x + mu v = a + i b
            Norm::Modal { k, mu } => [(a - mu[0] * b / mu[1]) / k, b / mu[1]],
        };
        assert!(circle().map(unit).all(|w| (norm.length(&w) - 1.0).abs() < 1e-12));
        let largest = |c: [f64; 2]| circle().map(unit).map(|w| (c[0] * w[0] + c[1] * w[1]).abs()).fold(0.0, f64::max);
        for c in [[1.0, 0.0], [0.0, 1.0], [1.0, -2.0], [3.0, 0.5], [-0.25, -4.0]] {
            assert!(is_bound(norm.dual(&c), largest(c), 1e-5), "{c:?}: {} {}", norm.dual(&c), largest(c));
            let signs = largest([c[0], -c[1]]).max(largest(c));
            assert!(is_bound(norm.largest_dual(&c.map(f64::abs)), signs, 1e-5), "{c:?}: {signs}");
            let box_of = norm.length(&[c[0].abs(), c[1].abs()]).max(norm.length(&[c[0].abs(), -c[1].abs()]));
            let longest = norm.longest(&c.map(f64::abs));
            assert!(longest >= box_of * (1.0 - 1e-14) && longest <= 1.5 * box_of, "{c:?}: {longest} {box_of}");
        }
    }
    // |k x| + |mu v|, of which the second is nearly real.
    let norm = Norm::Modal { k: 2.0, mu: [3.0, 1e-6] };
    assert!(is_bound(norm.longest(&[0.5, 0.25]), 1.75, 1e-9));
    // Matrices of two rows, and of three, whose norm is that of all ones.
    for f in [
        [1.0, 0.0, 0.0, 1.0],
        [3.0, 4.0, 0.0, 5.0],
        [0.6, 0.8, -0.8, 0.6],
        [1.0, -2.0, 0.5, 7.0],
        [0.0, 1e3, 1e-3, 0.0],
    ] {
        let f = Matrix::from_fn(2, 2, |i, j| f[2 * i + j]);
        let of = |w: [f64; 2]| hypotenuse(f[(0, 0)] * w[0] + f[(0, 1)] * w[1], f[(1, 0)] * w[0] + f[(1, 1)] * w[1]);
        assert!(is_bound(norm_of(&f), circle().map(of).fold(0.0, f64::max), 2e-5), "{f:?}");
    }
    assert!(is_bound(norm_of(&Matrix::fill_with(3, 3, -1.0)), 3.0, OVER));
}

fn norm_of(f: &Matrix<f64>) -> f64 {
    super::norm(f)
}

/// The columns of a step, without inputs.
fn columns(form: &Form, n: usize) -> Vec<Vec<f64>> {
    let cell = cell(form.clone(), n);
    (0..n).map(|j| advance(&cell, &(0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>(), 0.0)).collect()
}

fn forms() -> Vec<Form> {
    let pair = |turned: bool, decay: Decay, k: f64, p: f64| Form::Pair(Lift { turned, decay, k, p });
    let dense = |turned: bool, rows: [[f64; 2]; 2]| Form::Dense { turned, rows: rows.map(Vec::from).to_vec() };
    vec![
        pair(false, Decay::Lose(0.125), 0.5, 0.75),
        pair(true, Decay::Lose(0.125), 0.5, 1.0),
        pair(false, Decay::Lose(-0.0625), 0.25, 0.5),
        pair(true, Decay::Keep(0.375), 0.75, 1.25),
        pair(false, Decay::Lose(0.0), 0.0625, 3.0),
        pair(false, Decay::Keep(0.5), 3.0, 1.0),
        dense(false, [[-0.125, 0.25], [-0.5, -0.0625]]),
        dense(true, [[0.125, 0.25], [-0.5, 0.375]]),
        dense(false, [[-0.5, 0.25], [0.125, -0.75]]),
        dense(true, [[0.5, 4.0], [0.0, 0.25]]),
    ]
}

/// In its norm, a step makes no vector of length one longer than its growth says, and some as long; an input adds no more than what is
/// said; and no state of a vector of length one is larger than what is said of it.
#[test]
fn a_frame_bounds_all_states_of_a_step() {
    let (mut modal, mut doubling) = (0, 0);
    for form in forms() {
        let (frame, columns) = (Frame::of(&cell(form.clone(), 2)), columns(&form, 2));
        let step = |w: [f64; 2]| [0, 1].map(|i| columns[0][i] * w[0] + columns[1][i] * w[1]);
        let unit = |w: [f64; 2]| w.map(|x| x / frame.norm.length(&w));
        // A root of a difference of squares in a norm of two rows has few digits: a ten-thousandth is left to them.
        let longest = circle().map(unit).map(|w| frame.norm.length(&step(w))).fold(0.0, f64::max);
        match &frame.growth {
            Growth::Geometric(lost) => {
                modal += 1;
                assert!((1.0 - longest - lost).abs() < 1e-12, "{form:?}: {lost} {longest}");
            }
            Growth::Doubling(sums) => {
                doubling += 1;
                assert!(is_bound(sums[1], 1.0 + longest, OVER), "{form:?}: {} {longest}", sums[1]);
            }
        }
        assert!(is_bound(frame.added, 1.0 + longest, OVER), "{form:?}: {} {longest}", frame.added);
        for i in 0..2 {
            let most = circle().map(unit).map(|w| w[i].abs()).fold(0.0, f64::max);
            assert!(is_bound(frame.most[i], most, OVER), "{form:?} {i}: {} {most}", frame.most[i]);
        }
    }
    assert!(modal > 3 && doubling > 1, "{modal} {doubling}");
    // Three states have no modal coordinate.
    let rows = vec![vec![-0.5, 0.25, 0.0], vec![-0.25, -0.5, 0.0], vec![0.0, 0.0, -0.125]];
    let frame = Frame::of(&cell(Form::Dense { turned: false, rows }, 3));
    assert!(frame.added >= 1.875 && frame.most.iter().all(|most| is_bound(*most, 1.0, OVER)), "{:?}", frame.most);
    assert!(matches!(&frame.growth, Growth::Doubling(sums) if is_bound(sums[1], 1.875, 0.1)), "{:?}", frame.growth);
    for (form, r) in [(Form::Keep(-0.25), 0.25), (Form::Lose(0.125), 0.875), (Form::Lose(-0.25), 1.25)] {
        let frame = Frame::of(&cell(form.clone(), 1));
        assert!(is_bound(frame.added, 1.0 + r, OVER) && is_bound(frame.most[0], 1.0, OVER), "{form:?}");
        assert!(frame.growth.after(2) >= 1.0 + r, "{form:?}");
    }
}

/// The modulus of the poles of a dense pair is a root of its determinant, whose roundings are in what the growth says.
#[test]
fn roundings_of_a_determinant_are_in_the_growth() {
    let mut bits = 88_172_645_463_325_252u64;
    let mut next = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (bits >> 11) as f64 / (1u64 << 53) as f64
    };
    for _ in 0..500 {
        let [a, d, b, c] = [-0.1 * next(), -0.1 * next(), 0.5 + next(), -0.1 - 0.1 * next()];
        let frame = Frame::of(&cell(Form::Dense { turned: false, rows: vec![vec![a, b], vec![c, d]] }, 2));
        let Growth::Geometric(lost) = frame.growth else { panic!("{a} {b} {c} {d}") };
        let square = (Dd::ONE + Dd::from(a)) * (Dd::ONE + Dd::from(d)) - Dd::from(b) * Dd::from(c);
        let truth = (Dd::ONE - square.sqrt()).to_f64();
        assert!(lost <= truth && lost >= truth - 1e-14, "{a} {b} {c} {d}: {lost} {truth}");
    }
}

/// One step as it is emitted, of states that are this large, with an input of this size: what each new state is off by, without what x
/// takes over from v. The last sum of a state is the state itself, which is no larger than it may be.
fn roundings_of_a_step(cell: &Cell, most: &[f64], u: f64) -> Vec<f64> {
    let w: Vec<Rounded> = most.iter().map(|&size| Rounded { size, error: 0.0, is_one: false }).collect();
    let with_inputs = |sum: Rounded, state: usize| {
        cell.input[state]
            .iter()
            .fold(sum, |sum, &(_, g)| sum + Rounded::from(g) * Rounded { size: u, error: 0.0, is_one: false })
    };
    let none = || Rounded::from(0.0);
    let new_state = |a: Rounded, b: Rounded, state: usize| a.error + b.error + most[state];
    match &cell.form {
        Form::Keep(r) => vec![with_inputs(Rounded::from(*r) * w[0], 0).error],
        Form::Lose(d) => vec![new_state(with_inputs(none(), 0) + Rounded::from(*d) * w[0], w[0], 0)],
        Form::Dense { rows, .. } => {
            let change = |(i, row): (usize, &Vec<f64>)| {
                let sum = row.iter().zip(&w).fold(with_inputs(none(), i), |sum, (&e, &w)| sum + Rounded::from(e) * w);
                new_state(sum, w[i], i)
            };
            rows.iter().enumerate().map(change).collect()
        }
        Form::Pair(lift) => {
            let kept = match lift.decay {
                Decay::Lose(0.0) => w[1],
                // What is left is known to be less than the sum of both sizes.
                Decay::Lose(c) => {
                    let size = (1.0 - c).abs() * most[1];
                    Rounded { size, error: (Rounded::from(c) * w[1]).error + size, is_one: false }
                }
                Decay::Keep(r) => Rounded::from(r) * w[1],
            };
            let v = new_state(with_inputs(kept, 1), Rounded::from(lift.k) * w[0], 1);
            vec![with_inputs(w[0] + Rounded::from(lift.p) * w[1], 0).error, v]
        }
    }
}

/// The roundings of a step as it is emitted, of states of any sizes. Inputs are as large as the states that they cause allow: these are
/// two in length at most, of an input that acts on v with what x takes over from it.
#[test]
fn every_rounding_of_a_step_is_counted() {
    let forms = forms().into_iter().map(|form| (form, 2));
    let single = [Form::Keep(0.375), Form::Keep(-0.75), Form::Lose(0.125), Form::Lose(-0.25)];
    for (form, n) in forms.chain(single.map(|form| (form, 1))) {
        for (most, state, g) in [
            ([1.5, 2.5], 0, 0.0),
            ([1.5, 2.5], 0, 0.75),
            ([0.75, 4.0], 1, 0.625),
            ([3.0, 0.5], 1, 1.0),
            ([1.0; 2], 0, 3.0),
        ] {
            let (most, state) = if n == 1 { (&[1.0][..], 0) } else { (&most[..], state) };
            let mut cell = cell(form.clone(), n);
            if g != 0.0 {
                cell.input[state] = vec![(Operand::Input(0), g)];
            }
            let along = if let (Form::Pair(lift), 1) = (&form, state) { lift.p } else { 0.0 };
            let u = if g == 0.0 { 0.0 } else { 2.0 / (g * hypotenuse(1.0, along)) };
            let frame =
                Frame { norm: Norm::Euclidean, growth: Growth::Geometric(0.0), added: 2.0, most: most.to_vec() };
            let (errors, truth) = (frame.errors(&cell), roundings_of_a_step(&cell, most, u));
            // A row of many terms counts each of its sums as large as the last one.
            let over = if matches!(form, Form::Dense { .. }) { 0.8 } else { OVER };
            for (i, (found, truth)) in errors.iter().zip(&truth).enumerate() {
                assert!(is_bound(*found, *truth, over), "{form:?} {most:?} {state} {g} {i}: {found} {truth}");
            }
            let (norm, step) = (&frame.norm, frame.step(&cell));
            let own = match (&form, &truth[..]) {
                (Form::Pair(lift), [x, v]) => norm.length(&[x + lift.p * v, *v]),
                (_, all) => norm.length(all),
            };
            assert!(step >= own * (1.0 - 1e-12) && step <= 1.6 * own, "{form:?} {state} {g}: {step} {own}");
        }
    }
    // All of them zero: nothing is multiplied, and an input that is added to nothing is as it is.
    let frame = Frame { norm: Norm::Euclidean, growth: Growth::Geometric(0.0), added: 2.0, most: vec![1.0] };
    assert_eq!(frame.errors(&cell(Form::Keep(0.0), 1)), [0.0]);
    assert_eq!(frame.errors(&cell(Form::Lose(0.0), 1)), [1.0]);
}

/// Inputs by the states that they cause: an interpolated one has no earlier sample in the first step, so that it adds less; of two inputs
/// the larger counts, and each is a term; a coefficient of one is not multiplied by.
#[test]
fn inputs_are_as_large_as_what_they_cause() {
    let frame = Frame { norm: Norm::Euclidean, growth: Growth::Geometric(0.0), added: 1.5, most: vec![1.0, 1.0] };
    let is = |driven: &Driven, count: f64, size: f64, multiplied: f64| {
        driven.count == count && is_bound(driven.size, size, 1e-4) && is_bound(driven.multiplied, multiplied, 1e-4)
    };
    let (input, ramped) = (Operand::Input(0), Operand::Ramped(0));
    let mut one = cell(Form::Keep(0.5), 1);
    one.input = vec![vec![(input, 3.0), (ramped, 2.0)]];
    assert!(is(&frame.driven(&one, 0), 2.0, 5.0 * 1.5 / 3.0, 5.0 * 1.5 / 3.0));
    one.input = vec![vec![(input, 1.0), (ramped, -2.0)]];
    assert!(is(&frame.driven(&one, 0), 2.0, 3.0 * 1.5, 2.0 * 1.5));
    one.input = vec![vec![(ramped, -2.0)]];
    assert!(is(&frame.driven(&one, 0), 1.0, 1.5, 1.5));
    one.input =
        vec![vec![(input, 3.0), (Operand::Input(1), 0.5), (Operand::Input(1), 0.25), (Operand::Signal(0), 1.0)]];
    assert!(is(&frame.driven(&one, 0), 4.0, 1.5, 1.5));
    assert_eq!(inputs(&one), [None, Some(0), Some(1)]);
    let mut pair = cell(Form::Pair(Lift { turned: false, decay: Decay::Lose(0.0), k: 0.5, p: 3.0 }), 2);
    pair.input = vec![vec![(input, 0.25)], vec![(input, 0.25)]];
    let length = hypotenuse(0.25 + 3.0 * 0.25, 0.25);
    assert!((0..2).all(|state| is(&frame.driven(&pair, state), 1.0, 0.25 * 1.5 / length, 0.25 * 1.5 / length)));
    let driven = Driven { count: 3.0, size: 0.5, multiplied: 0.25 };
    assert_eq!((driven.error(2.0), Driven { count: 0.0, ..driven }.error(2.0)), (2.0 * 0.25 + 3.0 * 2.5, 0.0));
}

/// The row of an output one step before is that times the columns of a step, and its rounding is not below that of its own operations.
#[test]
fn rows_of_earlier_steps_are_those_of_the_columns() {
    let single = [Form::Keep(0.375), Form::Keep(-0.75), Form::Lose(0.125), Form::Lose(-0.25)];
    for (form, n) in forms().into_iter().map(|form| (form, 2)).chain(single.map(|form| (form, 1))) {
        for c in [[1.0, 0.0], [0.0, 1.0], [0.75, -2.0], [-0.5, -3.0]] {
            let (mut before, mut rounded) = (vec![0.0; n], vec![0.0; n]);
            form.before(&c[..n], &mut before, &mut rounded);
            // The sign of a pair that turns is left out.
            let sign = if let Form::Pair(Lift { turned: true, .. }) = form { -1.0 } else { 1.0 };
            for (j, column) in columns(&form, n).iter().enumerate() {
                let (truth, size) = (0..n)
                    .fold((0.0, 0.0f64), |(sum, size), i| (sum + c[i] * column[i], size.max((c[i] * column[i]).abs())));
                assert!((sign * before[j] - truth).abs() < 1e-14, "{form:?} {c:?} {j}: {} {truth}", before[j]);
                let least = (n as f64 + 3.0) * f64::EPSILON * size;
                assert!(
                    rounded[j] >= 0.9 * least && rounded[j] <= 30.0 * least.max(1e-15),
                    "{form:?} {c:?} {j}: {} {least}",
                    rounded[j]
                );
            }
        }
    }
}

/// What outputs feel of the errors of the latest steps, where powers of a step are known: the sum of the sizes over all of them, relative
/// to what the output sees of a state of length one; of two outputs the one that feels more.
#[test]
fn outputs_feel_all_errors_of_the_latest_steps() {
    let (r, unit) = (0.875f64, 0.25);
    let sum = |r: f64, n: f64| (1.0 - r.powf(n)) / (1.0 - r);
    let mut one = cell(Form::Keep(r), 1);
    one.output[0] = vec![(0, -3.0), (1, 0.5), (1, 0.25)];
    let felt = Frame::of(&one).felt_errors(&one, unit).expect("seen");
    for (i, found) in felt.sums.iter().enumerate() {
        assert!(is_bound(*found, 2.0 * r * unit * sum(r, f64::powi(2.0, i as i32)), OVER), "{i}: {found}");
    }
    // A dense turn of a twentieth of a period, seen along one state: |cos| and |sin| of the angles so far.
    let angle = std::f64::consts::PI / 10.0;
    let (cos, sin) = (angle.cos(), angle.sin());
    let mut turn = cell(Form::Dense { turned: false, rows: vec![vec![cos - 1.0, sin], vec![-sin, cos - 1.0]] }, 2);
    turn.output = vec![vec![(0, 2.0), (1, 0.0)], vec![(1, 1e-3)]];
    let frame = Frame::of(&turn);
    let felt = frame.felt_errors(&turn, unit).expect("seen");
    let errors = frame.errors(&turn);
    let whole = frame.most[0];
    for (i, found) in felt.sums.iter().enumerate() {
        let parts =
            (0..1u32 << i).map(|j| f64::from(j) * angle).map(|a| a.cos().abs() * errors[0] + a.sin().abs() * errors[1]);
        let truth = unit * parts.sum::<f64>() / whole;
        assert!(*found >= truth * (1.0 - 1e-12) && *found <= 1.5 * truth, "{i}: {found} {truth}");
    }
    // An error of v reaches x in its own step: [x + p v, v], seen as x.
    let mut pair = cell(Form::Pair(Lift { turned: false, decay: Decay::Lose(0.0), k: 0.0625, p: 3.0 }), 2);
    pair.output[0] = vec![(0, 1.0)];
    let frame = Frame::of(&pair);
    let (errors, felt) = (frame.errors(&pair), frame.felt_errors(&pair, unit).expect("seen"));
    let truth = unit * (errors[0] + 3.0 * errors[1]) / frame.most[0];
    assert!(is_bound(felt.sums[0], truth, OVER), "{} {truth}", felt.sums[0]);
    pair.output[0] = vec![(0, 1e-290)];
    assert!(frame.felt_errors(&pair, unit).is_none());
    pair.output[0] = Vec::new();
    assert!(frame.felt_errors(&pair, unit).is_none());
}

/// An output of several states and cells: a coefficient, a product and a sum for each, of terms that may be larger than what is seen.
#[test]
fn sums_of_outputs_are_rounded_for_each_term() {
    let unit = Precision::Double.unit();
    let of = |cells: &[Cell], direct: usize| {
        let direct = vec![(0..direct).map(|i| (Operand::Input(i), 2.0)).collect()];
        rounding(cells, &direct, Precision::Double).output / unit
    };
    let (mut one, mut two) = (cell(Form::Keep(0.5), 1), cell(Form::Keep(0.25), 1));
    assert_eq!(of(&[one.clone()], 0), 3.0);
    assert_eq!(of(&[one.clone()], 2), 5.0);
    one.output[0] = vec![(0, -3.0)];
    two.output[0] = vec![(0, 7.0)];
    assert!(is_bound(of(&[one.clone(), two], 2), 7.0, 1e-4));
    // Two states that are seen alike: |x| + |v| of a circle is larger than x + v by a root of two at most.
    let mut turn = cell(Form::Dense { turned: false, rows: vec![vec![-0.5, 0.25], vec![0.125, -0.75]] }, 2);
    turn.output = vec![vec![(0, 1.0)], vec![(0, 1.0)]];
    assert!(is_bound(of(&[turn], 0), 5.0 * 2f64.sqrt(), 1e-4));
}
