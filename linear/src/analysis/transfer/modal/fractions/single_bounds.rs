//! Each bound by itself, of one to three modes whose truth is known in closed form. What a basis is off by is large here, up to what is
//! allowed, so that terms of the second order are seen beside their roundings.

use super::*;
use crate::analysis::transfer::Frequency;
use crate::analysis::transfer::modal::OffDiagonal;
use crate::base::{Number, Rational};
use crate::kernel::dense::Matrix;

type Square = Vec<Vec<f64>>;

fn of(x: f64) -> Dd {
    Dd::from(x)
}

fn unit(n: usize) -> Square {
    diagonal(&vec![1.0; n])
}

fn diagonal(entries: &[f64]) -> Square {
    let n = entries.len();
    (0..n).map(|i| (0..n).map(|j| if i == j { entries[i] } else { 0.0 }).collect()).collect()
}

/// Modes with these k and c, the first ones rigid, whose M and K are others.
fn modal(k: &[f64], c: &[f64], [m, stiffness]: [&Square; 2], rigid: usize) -> ModalSum {
    let n = k.len();
    let beside = |square: &Square, about: &Square| -> Vec<f64> {
        let size = |i: usize, j: usize| (square[i][j] - about[i][j]).powi(2);
        (0..n).map(|j| (0..n).map(|i| size(i, j)).sum::<f64>().sqrt() * (1.0 + 1e-15)).collect()
    };
    let [k_mid, c_mid] = [k, c].map(|list| list.iter().map(|&x| of(x)).collect::<Vec<Dd>>());
    ModalSum {
        shapes: Matrix::from_fn(n, n, |i, j| if i == j { Dd::ONE } else { Dd::ZERO }),
        omega: k_mid.iter().map(|k| if k.hi > 0.0 { k.sqrt() } else { Dd::ZERO }).collect(),
        k: k_mid,
        c: c_mid,
        epsilon: 0.0,
        k_size: k.iter().map(|k| k.abs()).collect(),
        c_size: c.iter().map(|c| c.abs()).collect(),
        off: OffDiagonal { m: beside(m, &unit(n)), c: vec![0.0; n], k: beside(stiffness, &diagonal(k)) },
        rigid: (0..n).map(|i| i < rigid).collect(),
        is_undragged: true,
        ratio: None,
    }
}

fn sees(sum: &ModalSum, p: &[Ball], b: &[Ball]) -> ModalPair {
    ModalPair { residues: vec![sum.residues(0, p, b)], feed_through: [Ball::ZERO; 3] }
}

fn balls(list: &[f64]) -> Vec<Ball> {
    list.iter().map(|&x| Ball::from(x)).collect()
}

/// Whether a ball holds a number that is known to double-double, and how much of its radius that needs.
fn part_of_bound(found: Ball, truth: Dd, facts: &str) -> f64 {
    let off = (found.mid - truth).abs().to_f64();
    assert!(off <= found.rad * (1.0 + 1e-13) + 1e-29 * truth.hi.abs(), "{facts}: {off:e} {found:?}");
    off / found.rad
}

/// A pole with its residue in a list: the root of a true lambda, and the product p b of its mode.
fn check(given: &Given, x: Dd, product: Dd, facts: &str) -> [f64; 2] {
    let root = x.abs().sqrt();
    let (place, residue, found) = match x.hi > 0.0 {
        true => (given.s.im, -product / (of(2.0) * root), given.products[0].im),
        false => (given.s.re, product / (of(2.0) * root), given.products[0].re),
    };
    [part_of_bound(Ball::new(place, given.loose), root, facts), part_of_bound(found, residue, facts)]
}

/// m x'' + k x: a mode alone, whose m, k, input and output lie at the ends of what is known of them, held and unstable.
#[test]
fn one_mode_at_the_ends_of_what_is_known() {
    let mut most = [0.0f64; 2];
    for k in [4.0f64, -4.0] {
        for (mass, stiffness, unsure) in [(9e-4, 0.0, 0.0), (0.0, 0.5, 0.0), (9e-4, 0.25, 0.0), (0.0, 0.0, 1e-3)] {
            for sign in [1.0, -1.0] {
                let truth = [vec![vec![1.0 - sign * mass]], vec![vec![k + sign * stiffness * k.signum()]]];
                let sum = modal(&[k], &[0.0], [&truth[0], &truth[1]], 0);
                let input = Ball::new(Dd::ONE, unsure);
                let (list, _) = sum.of_true_modes(&sees(&sum, &[input], &[Ball::ONE]), None).expect("a mode");
                let x = of(truth[1][0][0]) / of(truth[0][0][0]);
                let product = of(1.0 + sign * unsure) / of(truth[0][0][0]);
                let (_, reach) = sum.reach().expect("small");
                assert!((x - of(k)).abs().hi <= reach[0] * (1.0 + 1e-14), "{k} {mass} {stiffness} {sign}: {reach:?}");
                let facts = format!("{k} {mass} {stiffness} {unsure} {sign}");
                // The roots of the ends of an interval are not as far from that of its middle.
                let needed = check(&list[0], x, product, &facts);
                assert!(list[0].loose < 1.0, "{facts}");
                most = [most[0].max(needed[0]), most[1].max(needed[1])];
                assert_eq!(list.len(), if k > 0.0 { 1 } else { 2 });
                if let Some(other) = list.get(1) {
                    assert!(needed.iter().all(|x| x.is_finite()) && (other.s.re + list[0].s.re).is_zero());
                    assert!((other.products[0].re.mid + list[0].products[0].re.mid).is_zero(), "{facts}");
                }
            }
        }
    }
    assert!(most.iter().all(|most| *most > 0.4), "{most:?}");
}

/// Two modes far and near, held and unstable, with entries of M and K off by much.
#[test]
fn two_modes_far_from_those_of_the_basis() {
    let mut most = 0.0f64;
    for k in [[1.0, 4.0], [4.0, 1.0], [1.0, 1024.0], [-1.0, 4.0], [1.0, -4.0], [-4.0, -1.0]] {
        let least = k.iter().map(|k: &f64| k.abs()).fold(f64::INFINITY, f64::min);
        for (mass, stiffness) in [(4e-4, 0.0), (0.0, 0.125), (0.0, 1e-3), (4e-4, 0.0625)] {
            for ends in 1..27i32 {
                for side in [1.0, 0.0625] {
                    let [a, b, c] = [1, 3, 9].map(|digit| f64::from((ends / digit + 1) % 3 - 1));
                    let entries = |about: [f64; 2], off: f64| {
                        let beside = off * c * side;
                        vec![vec![about[0] + off * a, beside], vec![beside, about[1] + off * b]]
                    };
                    let [m, s] = [entries([1.0; 2], mass), entries(k, -stiffness * least)];
                    let sum = modal(&k, &[0.0; 2], [&m, &s], 0);
                    // (s_00 - x m_00) (s_11 - x m_11) = (s_01 - x m_01)^2
                    let ([m0, mc, m1], [s0, sc, s1]) =
                        ([m[0][0], m[0][1], m[1][1]].map(of), [s[0][0], s[0][1], s[1][1]].map(of));
                    let (two, four) = (of(2.0), of(4.0));
                    let (p, q, r) = (m0 * m1 - mc * mc, s0 * m1 + s1 * m0 - two * sc * mc, s0 * s1 - sc * sc);
                    let root = (q * q - four * p * r).sqrt();
                    let ends_of = [(q - root) / (two * p), (q + root) / (two * p)];
                    for (sees_p, sees_b) in [
                        ([1.0, 0.0], [1.0, 0.0]),
                        ([0.0, 1.0], [0.0, 1.0]),
                        ([1.0, 0.0], [0.0, 1.0]),
                        ([1.0, 2.0], [1.0, -1.0]),
                    ] {
                        let pair = sees(&sum, &balls(&sees_p), &balls(&sees_b));
                        let Some((list, _)) = sum.of_true_modes(&pair, None) else { continue };
                        let mut at = 0;
                        for i in 0..2 {
                            let x = ends_of[usize::from(k[i] > k[1 - i])];
                            // What S - x M takes to nothing, by the row that is not small.
                            let y = match i {
                                0 => [s1 - x * m1, x * mc - sc],
                                _ => [x * mc - sc, s0 - x * m0],
                            };
                            let size = m0 * y[0] * y[0] + two * mc * y[0] * y[1] + m1 * y[1] * y[1];
                            let seen = |sees: [f64; 2]| of(sees[0]) * y[0] + of(sees[1]) * y[1];
                            let facts =
                                format!("{k:?} {mass} {stiffness} {a} {b} {c} {side} {sees_p:?} {sees_b:?} {i}");
                            let product = seen(sees_p) * seen(sees_b) / size;
                            most = most.max(check(&list[at], x, product, &facts)[1]);
                            at += if k[i] > 0.0 { 1 } else { 2 };
                        }
                        assert_eq!(list.len(), at);
                    }
                }
            }
        }
    }
    assert!(most > 0.9, "{most}");
}

/// Z (Z^T M Z)^-1 Z^T between two vectors, of one column or two.
fn between(z: &[Vec<f64>], m: &Square, p: &[Dd], b: &[Dd]) -> Dd {
    let dot = |a: &[f64], b: &[Dd]| a.iter().zip(b).fold(Dd::ZERO, |sum, (&a, &b)| sum + of(a) * b);
    let times = |a: &[f64]| -> Vec<Dd> {
        m.iter().map(|row| row.iter().zip(a).fold(Dd::ZERO, |sum, (&m, &a)| sum + of(m) * of(a))).collect()
    };
    let gram = |i: usize, j: usize| dot(&z[i], &times(&z[j]));
    let [p, b] = [p, b].map(|of| z.iter().map(|z| dot(z, of)).collect::<Vec<Dd>>());
    match z.len() {
        1 => p[0] * b[0] / gram(0, 0),
        _ => {
            let (g, h, both) = (gram(0, 0), gram(1, 1), gram(0, 1));
            (p[0] * b[0] * h + p[1] * b[1] * g - (p[0] * b[1] + p[1] * b[0]) * both) / (g * h - both * both)
        }
    }
}

/// Free systems of two or three modes with K = W k W^T in closed form: the first modes, in number, are rigid up to small parts in the rest.
struct Free {
    m: Square,
    stiffness: Square,
    /// The motions that K takes to nothing.
    z: Vec<Vec<f64>>,
    k: Vec<f64>,
    facts: String,
}

fn free_systems() -> Vec<Free> {
    let mut list = Vec::new();
    let masses = [[0.0; 3], [9e-4, 0.0, 0.0], [0.0, 4e-4, 0.0], [0.0, 0.0, 4e-4], [3e-4, 3e-4, 3e-4]];
    let slight = [-16, -10].map(|exponent| (0, 2f64.powi(exponent)));
    let others = [(0, 0.0), (0, 0.03125), (0, 0.25), (1, 0.03125), (2, 0.03125), (3, 0.03125), (3, 0.125)];
    for (which, off) in slight.into_iter().chain(others) {
        for [own, beside, last] in masses {
            for (sign, other) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                for k in [0.5, 4.0] {
                    let e = off * sign;
                    // The rows of W^T.
                    let w = match which {
                        0 => vec![vec![e, 1.0]],
                        1 => vec![vec![e, 1.0, 0.0], vec![0.0, 0.0, 1.0]],
                        2 => vec![vec![e, 1.0, 0.0], vec![-e, 0.0, 1.0]],
                        _ => vec![vec![e, -0.5 * e, 1.0]],
                    };
                    let n = w[0].len();
                    let rigid = n - w.len();
                    let z = match which {
                        0 => vec![vec![1.0, -e]],
                        1 => vec![vec![1.0, -e, 0.0]],
                        2 => vec![vec![1.0, -e, e]],
                        _ => vec![vec![1.0, 0.0, -e], vec![0.0, 1.0, 0.5 * e]],
                    };
                    let own_k = [k, 9.0];
                    let entry = |i: usize, j: usize| (0..w.len()).map(|l| own_k[l] * w[l][i] * w[l][j]).sum::<f64>();
                    let stiffness = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
                    let mut m = unit(n);
                    m[0][0] += other * own;
                    (m[0][1], m[1][0]) = (other * beside, other * beside);
                    (m[0][n - 1], m[n - 1][0]) = (m[0][n - 1] + other * last, m[0][n - 1] + other * last);
                    let about = [vec![0.0; rigid], own_k[..w.len()].to_vec()].concat();
                    let facts = format!("{which} {e} {own} {beside} {last} {other} {k}");
                    list.push(Free { m, stiffness, z, k: about, facts });
                }
            }
        }
    }
    list
}

/// Inputs and outputs that see one mode, or several with either sign.
fn weights_of(n: usize) -> Vec<Vec<f64>> {
    let mut list: Vec<Vec<f64>> =
        (0..n).map(|own| (0..n).map(|i| if i == own { 1.0 } else { 0.0 }).collect()).collect();
    list.extend([1.0, -1.0].map(|side| (0..n).map(|i| if i == 0 { 0.5 } else { side }).collect::<Vec<f64>>()));
    list
}

/// Factors of input and output: a product may be more or less than a sum.
const SCALES: [(f64, f64); 4] =
    [(1.0, 1.0), (1048576.0, 1048576.0), (1.0 / 1048576.0, 1048576.0), (1048576.0, 1.0 / 1048576.0)];

fn times(factor: f64, list: &[f64]) -> Vec<f64> {
    list.iter().map(|x| factor * x).collect()
}

/// The sum over the rigid motions, how much of them input and output see, and how much of them is in a column of the basis.
#[test]
fn rigid_motions_in_closed_form_are_within_what_is_known_of_a_basis() {
    let mut most = [0.0f64; 3];
    for case in free_systems() {
        let (n, rigid) = (case.k.len(), case.z.len());
        let sum = modal(&case.k, &vec![0.0; n], [&case.m, &case.stiffness], rigid);
        let (mu, reach) = sum.reach().expect("small");
        let along = sum.along_rigid(&reach, mu).expect("apart");
        for (d, along) in along.iter().enumerate() {
            let column: Vec<Dd> = case.m.iter().map(|row| of(row[d])).collect();
            let truth = between(&case.z, &case.m, &column, &column).hi.max(0.0).sqrt();
            assert!(d < rigid || truth <= *along, "{} {d}: {truth} {along}", case.facts);
            assert!(d >= rigid || *along == 0.0);
            if d >= rigid && truth > 0.0 {
                most[0] = most[0].max(truth / along);
            }
        }
        for p in weights_of(n) {
            for b in weights_of(n) {
                for (unsure, (p_scale, b_scale)) in
                    [(0.0, SCALES[0]), (1e-3, SCALES[0]), (0.0, SCALES[1]), (0.0, SCALES[2]), (0.0, SCALES[3])]
                {
                    let (p, b) = (times(p_scale, &p), times(b_scale, &b));
                    let known =
                        |of: &[f64]| of.iter().map(|&x| Ball::new(Dd::from(x), unsure * x.abs())).collect::<Vec<_>>();
                    let pair = sees(&sum, &known(&p), &balls(&b));
                    let [p, b] = [(&p, 1.0 + unsure), (&b, 1.0)]
                        .map(|(list, scale)| list.iter().map(|&x| of(x) * of(scale)).collect::<Vec<Dd>>());
                    let seen = [sizes(&pair.residues[0])];
                    let (free, norms) = sum.all_free(&pair, &seen, &reach, mu).expect("apart");
                    let facts = format!("{} {p:?} {b:?}", case.facts);
                    let needed = part_of_bound(free[0], between(&case.z, &case.m, &p, &b), &facts);
                    if unsure == 0.0 && needed.is_finite() {
                        most[1] = most[1].max(needed);
                    }
                    for (norm, of) in norms[0].into_iter().zip([&p, &b]) {
                        let truth = between(&case.z, &case.m, of, of).hi.max(0.0).sqrt();
                        assert!(truth <= norm * (1.0 + 1e-15), "{facts}: {truth} {norm}");
                        if norm > 0.0 {
                            most[2] = most[2].max(truth / norm);
                        }
                    }
                }
            }
        }
    }
    assert!(most.iter().all(|most| *most > 0.99), "{most:?}");
}

/// What the elastic modes are without the rigid motions: x - N N^T M x, in the products, and in the rest beside that of a mode that is seen
/// by itself in a basis that is exact.
#[test]
fn products_of_damped_modes_are_those_without_the_rigid_motions() {
    let mut most = [0.0f64; 2];
    for (number, case) in free_systems().into_iter().enumerate() {
        let (n, rigid) = (case.k.len(), case.z.len());
        // Below critical damping and above it: of k = 4 the roots are -1.5 -+ i 1.32, or -1 and -4.
        for damping in [1.5, 2.5] {
            let c: Vec<f64> = case.k.iter().map(|k| damping * k).collect();
            let sum = modal(&case.k, &c, [&case.m, &case.stiffness], rigid);
            let (mu, reach) = sum.reach().expect("small");
            let along = sum.along_rigid(&reach, mu).expect("apart");
            let most_along = along.iter().fold(0.0, |most: f64, a| most.max(*a));
            let epsilon = 1e-4;
            let sum = ModalSum { epsilon, ..sum };
            // The same, with what the rigid motions add to epsilon.
            let alone = modal(&case.k, &c, [&unit(n), &diagonal(&case.k)], rigid);
            let alone = ModalSum { epsilon: epsilon + most_along * most_along, ..alone };
            for (i, p) in weights_of(n).into_iter().enumerate() {
                for (j, b) in weights_of(n).into_iter().enumerate() {
                    // In turn: all of them for each pair would take two seconds.
                    let (p_scale, b_scale) = SCALES[(number + i + j) % SCALES.len()];
                    let (p, b) = (times(p_scale, &p), times(b_scale, &b));
                    let pair = sees(&sum, &balls(&p), &balls(&b));
                    let Some((list, _)) = sum.of_damped(&pair) else { continue };
                    let mut at = 0;
                    for d in rigid..n {
                        // p . x~ = p . x - (p . N) (N^T M x)
                        let column: Vec<Dd> = case.m.iter().map(|row| of(row[d])).collect();
                        let without = |see: &[f64]| {
                            let see: Vec<Dd> = see.iter().map(|&x| of(x)).collect();
                            see[d] - between(&case.z, &case.m, &see, &column)
                        };
                        let [of_p, of_b] = [without(&p), without(&b)];
                        let (k, c) = (of(case.k[d]), of(c[d]));
                        let below = c * c * of(0.25) - k;
                        let (given, facts) = (&list[at], format!("{} {damping} {p:?} {b:?} {d}", case.facts));
                        // 1 / (s^2 + c s + k) has the residue 1 / (z - z').
                        let apart = below.abs().sqrt() * of(2.0);
                        let (found, truth) = match below.hi < 0.0 {
                            true => (given.products[0].im, -(of_p * of_b) / apart),
                            false => (given.products[0].re, -(of_p * of_b) / apart),
                        };
                        let used = part_of_bound(found, truth, &facts);
                        if used.is_finite() {
                            most[0] = most[0].max(used);
                        }
                        // With one elastic mode the rest is that of its product.
                        if n - rigid == 1 && of_p.hi != 0.0 && of_b.hi != 0.0 {
                            let own: Vec<f64> = (0..n).map(|i| if i == d { 1.0 } else { 0.0 }).collect();
                            let (whole, _) =
                                alone.of_damped(&sees(&alone, &balls(&own), &balls(&own))).expect("damped");
                            let truth = whole[0].rest[0] * (of_p * of_b).hi.abs();
                            assert!(truth <= given.rest[0] * (1.0 + 1e-11), "{facts}: {truth:e} {:e}", given.rest[0]);
                            most[1] = most[1].max(truth / given.rest[0]);
                        }
                        if below.hi > 0.0 {
                            let other = &list[at + 1];
                            assert!(
                                (other.products[0].re.mid + found.mid).is_zero()
                                    && other.products[0].re.rad == found.rad
                            );
                            at += 1;
                        }
                        at += 1;
                    }
                    assert_eq!(at, list.len());
                }
            }
        }
    }
    assert!(most.iter().all(|most| *most > 0.9), "{most:?}");
}

/// (|s|^2 + c |s| + k) / |s^2 + c s + k| of one mode, of any damping, at all s that are no further from the imaginary axis than half of the
/// distance of the nearest pole there, is no more than the V in the rest.
#[test]
fn a_mode_of_any_damping_has_a_bound_on_the_axis_and_in_discs_about_it() {
    let mut tightest = 0.0f64;
    let eps = 1e-15;
    for omega in [0.125, 1.0, 16.0] {
        for step in -24..=24 {
            let ratio = 2f64.powf(f64::from(step) / 3.0) * 1.01;
            let (k, c) = (omega * omega, 2.0 * ratio * omega);
            let exact = modal(&[k], &[c], [&unit(1), &diagonal(&[k])], 0);
            let sum = ModalSum { epsilon: eps, ..exact };
            let pair = sees(&sum, &[Ball::from(0.125)], &[Ball::from(8.0)]);
            let (list, _) = sum.of_damped(&pair).expect("damped");
            let below = ratio * ratio - 1.0;
            let root = below.abs().sqrt() * omega;
            // epsilon V / (1 - epsilon V) times 2 / |z - z'|
            let rest = list[0].rest[0] * root;
            let found = rest / (1.0 + rest) / eps;
            // Of a part c the whole series is c / (1 - c).
            let part = 0.4;
            let much = ModalSum { epsilon: part / found, ..sum.clone() };
            let (list, _) = much.of_damped(&pair).expect("damped");
            let whole = list[0].rest[0] * root;
            assert!((whole * (1.0 - part) / part - 1.0).abs() < 1e-9, "{omega} {ratio}: {whole}");
            let poles = match below < 0.0 {
                true => [(-0.5 * c, root), (-0.5 * c, -root)],
                false => [(-k / (0.5 * c + root), 0.0), (-0.5 * c - root, 0.0)],
            };
            let mut truth = 0.0f64;
            for place in -80..=80 {
                let at = omega * 2f64.powf(f64::from(place) / 8.0);
                for at in [at, root] {
                    let far = |re: f64, im: f64| poles.map(|(x, y)| (re - x).hypot(im - y));
                    let [one, other] = far(0.0, at);
                    let reach = 0.5 * one.min(other);
                    for turn in 0..16 {
                        let angle = std::f64::consts::PI * f64::from(turn) / 8.0;
                        let (re, im) = (reach * angle.cos(), at + reach * angle.sin());
                        let ([one, other], size) = (far(re, im), re.hypot(im));
                        truth = truth.max((size * size + c * size + k) / (one * other));
                    }
                }
            }
            assert!(truth <= found, "{omega} {ratio}: {truth} {found}");
            tightest = tightest.max(truth / found);
        }
    }
    assert!(tightest > 0.2, "{tightest}");
}

/// Any l > 0 bounds the root of P B by (l P + B / l) / 2; the best one attains it.
#[test]
fn the_two_sides_of_a_product_are_balanced() {
    let roots = |apart: f64| -> Roots { ([Complex::ZERO; 2], true, Complex::ZERO, apart) };
    let list = [roots(0.25), roots(3.0), roots(0.5)];
    for scale in [1e-3, 1.0, 1e3] {
        let squares = [vec![0.5 * scale, 2.0 * scale, 0.0], vec![3.0, 0.125 / scale, 1.0]];
        let weighed = |of: &[f64]| of.iter().zip(&list).map(|(square, root)| square * root.3).sum::<f64>();
        let [p, b] = [&squares[0], &squares[1]].map(|of| weighed(of));
        let [of_p, of_b] = balance(&squares, &list);
        let product = of_p * of_b;
        assert!((1.0..1.0 + 1e-11).contains(&product), "{scale}: {product}");
        let (found, truth) = (0.5 * (of_p * p + of_b * b), (p * b).sqrt());
        assert!((found - truth).abs() < 1e-11 * truth, "{scale}: {found} {truth}");
    }
    assert_eq!(balance(&[vec![0.0], vec![1.0]], &list[..1]), [0.0; 2]);
    assert_eq!(balance(&[vec![1.0], vec![0.0]], &list[..1]), [0.0; 2]);
}

/// 1 / (s^2 + s + 1) at i, with the ratio 1/2 declared for all: -i. Products that may have lost digits below the range of numbers have no sum.
#[test]
fn a_ratio_below_one_and_products_out_of_range() {
    let sum = ModalSum { ratio: Some(Ball::from(0.5)), ..modal(&[1.0], &[1.0], [&unit(1), &unit(1)], 0) };
    let fractions = |p: f64, b: f64| sum.fractions(&sees(&sum, &[Ball::from(p)], &[Ball::from(b)]));
    let found = fractions(1.0, 1.0).expect("one pair of poles");
    let disc = found.gain(&Frequency::radians(&Number::from(Rational::new(1, 1)))).disc().expect("no pole");
    assert!((disc.value.im.to_f64() + 1.0).abs() <= disc.radius && disc.value.re.to_f64().abs() <= disc.radius);
    assert!(disc.radius < 1e-25, "{disc:?}");
    assert!(fractions(1e-100, 1e-99).is_some() && fractions(1e100, 1e99).is_some());
    assert!(fractions(1e-100, 1e-101).is_none() && fractions(1e100, 1e101).is_none() && fractions(0.0, 1.0).is_none());
}

/// M further from 1 than a thousandth, or not known.
#[test]
fn a_skew_basis_is_refused() {
    for (off, is_small) in [(9.9e-4, true), (1.01e-3, false), (0.5, false), (f64::NAN, false)] {
        let sum = modal(&[4.0], &[0.0], [&vec![vec![1.0 + off]], &vec![vec![4.0]]], 0);
        assert_eq!(sum.reach().is_some(), is_small, "{off}");
    }
}

/// A stiffness that may be zero, beside rigid motions or alone; roots that grow, are one, or have no real part.
#[test]
fn roots_of_which_too_little_is_known_are_refused() {
    let one = |k: f64, c: f64| modal(&[k], &[c], [&unit(1), &vec![vec![k]]], 0);
    let of_damped = |k: f64, c: f64| {
        let sum = one(k, c);
        sum.of_damped(&sees(&sum, &[Ball::ONE], &[Ball::ONE])).is_some()
    };
    let seen = [[4.0, 1.0], [1.0, 4.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, -4.0], [1.0, 2.0], [1.0, 0.0]];
    assert_eq!(seen.map(|[k, c]| of_damped(k, c)), [true, true, false, false, false, false, false, false]);
    for (off, is_known) in [(0.5, true), (1.5, false)] {
        let mut sum = one(1.0, 0.0);
        sum.off.k[0] = off;
        assert_eq!(sum.of_true_modes(&sees(&sum, &[Ball::ONE], &[Ball::ONE]), None).is_some(), is_known, "{off}");
        let mut sum = modal(&[0.0, 1.0], &[0.0, 1.0], [&unit(2), &diagonal(&[0.0, 1.0])], 1);
        sum.off.k[1] = off;
        let (mu, reach) = sum.reach().expect("small");
        let pair = sees(&sum, &[Ball::ONE; 2], &[Ball::ONE; 2]);
        assert_eq!(sum.all_free(&pair, &[sizes(&pair.residues[0])], &reach, mu).is_some(), is_known, "{off}");
        assert_eq!(sum.along_rigid(&reach, mu).is_some(), is_known, "{off}");
    }
}
