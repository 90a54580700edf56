//! Scenes whose poles are known in closed form, compared with the report: every pole is there exactly once, and nothing
//! that grows is called stable.
//!
//! With rows t_j of a regular matrix and Q(s) = sum (m_j s² + c_j s + k_j) t_j t_j^T the determinant is a constant
//! times the product of the quadratics, so their roots are the poles. The roots are computed here in rational numbers.

use super::systems::{Builder, Random, number};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use vibc::analysis::{self, Pole, PoleKind, Poles, Stability, Verdict};
use vibc::base::{Ball, Number, Rational};
use vibc::system::{LinearSystem, Nature};

/// m s² + c s + k
#[derive(Clone, Debug)]
struct Quadratic {
    m: BigRational,
    c: BigRational,
    k: BigRational,
}

/// A root to 260 digits; im is zero for a real one.
#[derive(Clone, Debug)]
struct Root {
    re: BigRational,
    im: BigRational,
}

fn whole(n: i64) -> BigRational {
    BigRational::from_integer(n.into())
}

fn ten_to_minus(digits: u32) -> BigRational {
    BigRational::new(BigInt::one(), BigInt::from(10).pow(digits))
}

/// The square root to a relative 10^-260, or exactly.
fn square_root(x: &BigRational) -> BigRational {
    let scale = BigInt::from(10).pow(300);
    let (n, d) = (x.numer().sqrt(), x.denom().sqrt());
    if &(&n * &n) == x.numer() && &(&d * &d) == x.denom() {
        return BigRational::new(n, d);
    }
    BigRational::new((x * BigRational::from_integer(&scale * &scale)).to_integer().sqrt(), scale)
}

impl Quadratic {
    fn new(m: i64, c: BigRational, k: BigRational) -> Quadratic {
        Quadratic { m: whole(m), c, k }
    }

    fn with_roots(a: &BigRational, b: &BigRational) -> Quadratic {
        Quadratic { m: whole(1), c: -(a + b), k: a * b }
    }

    fn roots(&self) -> Vec<Root> {
        let zero = BigRational::zero();
        if self.m.is_zero() {
            return if self.c.is_zero() { Vec::new() } else { vec![Root { re: -&self.k / &self.c, im: zero }] };
        }
        let twice = &self.m * whole(2);
        let discriminant = &self.c * &self.c - whole(4) * &self.m * &self.k;
        let (middle, spread) = (-&self.c / &twice, square_root(&discriminant.abs()) / &twice);
        if discriminant.is_negative() {
            vec![Root { re: middle.clone(), im: -&spread }, Root { re: middle, im: spread }]
        } else {
            // The root that cancels is the product of both, divided by the other.
            let far = if middle.is_positive() { &middle + &spread } else { &middle - &spread };
            let near = if far.is_zero() { zero.clone() } else { &self.k / &self.m / &far };
            vec![Root { re: far, im: zero.clone() }, Root { re: near, im: zero }]
        }
    }
}

/// A scene and its truth.
struct Scene {
    system: LinearSystem,
    roots: Vec<Root>,
    infinite: usize,
}

fn exact(x: &BigRational) -> Number {
    Number::from(Rational::from(x.clone()))
}

impl Scene {
    /// Multiplies each row by a factor, which changes no pole.
    fn of(quadratics: &[Quadratic], rows: &[Vec<i64>], factor: &Number) -> Scene {
        let mut builder = Builder::numbered(quadratics.len());
        for (q, row) in quadratics.iter().zip(rows) {
            let entries = row.iter().enumerate().filter(|(_, a)| **a != 0);
            let row: Vec<(usize, Number)> = entries.map(|(i, &a)| (i, &Number::from(a) * factor)).collect();
            if !q.m.is_zero() {
                builder.inertia(&exact(&q.m), &row);
            }
            if !q.c.is_zero() {
                builder.dashpot(&exact(&q.c), &row);
            }
            if !q.k.is_zero() {
                builder.stiffness("k", Nature::Property, &exact(&q.k), &row);
            }
        }
        let roots: Vec<Root> = quadratics.iter().flat_map(Quadratic::roots).collect();
        let infinite = 2 * quadratics.len() - roots.len();
        Scene { system: builder.finish(), roots, infinite }
    }

    fn grows(&self) -> bool {
        self.roots.iter().any(|root| root.re.is_positive())
    }

    fn solved(&self) -> Option<(Poles, Verdict)> {
        let modes = analysis::modes(&self.system).ok()?;
        let poles = analysis::poles(&self.system, &modes).ok()?;
        let verdict = analysis::stability(&self.system, &modes, &poles);
        Some((poles, verdict))
    }
}

fn rational(x: f64) -> BigRational {
    Rational::from_f64(x).expect("finite").to_big()
}

fn holds(ball: Ball, truth: &BigRational) -> bool {
    let mid = rational(ball.mid.hi) + rational(ball.mid.lo);
    (mid - truth).abs() <= rational(ball.rad) + ten_to_minus(250)
}

/// Assigns a pole to the root, moving other roots if possible.
fn seat(root: usize, candidates: &[Vec<usize>], owner: &mut [Option<usize>], seen: &mut [bool]) -> bool {
    for &pole in &candidates[root] {
        if !std::mem::replace(&mut seen[pole], true)
            && owner[pole].is_none_or(|other| seat(other, candidates, owner, seen))
        {
            owner[pole] = Some(root);
            return true;
        }
    }
    false
}

/// Whether each root can be assigned its own pole whose enclosure contains it (augmenting paths).
fn are_matched(roots: &[Root], poles: &[Pole]) -> bool {
    let is_bounded = |pole: &Pole| pole.re.rad.is_finite() && pole.im.rad.is_finite();
    let candidates = |root: &Root| -> Vec<usize> {
        let fits = |pole: &Pole| is_bounded(pole) && holds(pole.re, &root.re) && holds(pole.im, &root.im);
        (0..poles.len()).filter(|&i| fits(&poles[i])).collect()
    };
    let candidates: Vec<Vec<usize>> = roots.iter().map(candidates).collect();
    let mut owner: Vec<Option<usize>> = vec![None; poles.len()];
    roots.len() == poles.len()
        && (0..roots.len()).all(|root| seat(root, &candidates, &mut owner, &mut vec![false; poles.len()]))
}

/// Statistics over many scenes.
#[derive(Debug, Default)]
struct Seen {
    counted: usize,
    stable: usize,
    unstable: usize,
    undetermined: usize,
    refused: usize,
}

impl Seen {
    /// Checks that a count is that of the determinant, that its poles are the roots, and that a verdict is true.
    fn check(&mut self, scene: &Scene, name: &str) {
        let Some((poles, verdict)) = scene.solved() else {
            self.refused += 1;
            return;
        };
        if let Some(count) = poles.count {
            self.counted += 1;
            assert_eq!((count.finite(), count.infinite()), (scene.roots.len(), scene.infinite), "{name}");
            assert!(are_matched(&scene.roots, &poles.list), "{name}: {:#?} {:#?}", poles.list, scene.roots);
            let growing =
                poles.list.iter().filter(|pole| matches!(pole.kind, PoleKind::Divergence | PoleKind::Flutter));
            let truth = scene.roots.iter().filter(|root| root.re.is_positive()).count();
            let doubtful = poles.list.iter().filter(|pole| pole.kind == PoleKind::Undetermined).count();
            let growing = growing.count();
            assert!(growing <= truth && truth <= growing + doubtful, "{name}: {growing} of {truth} grow");
            let alone = poles.list.iter().filter(|pole| pole.cluster.is_none());
            let real = alone.clone().filter(|pole| pole.im.is_zero()).count();
            let truth = scene.roots.iter().filter(|root| root.im.is_zero()).count();
            assert!(
                real <= truth && truth <= real + poles.list.len() - alone.count(),
                "{name}: {real} of {truth} are real"
            );
        }
        match verdict.kind() {
            Stability::Stable | Stability::Neutral => {
                assert!(!scene.grows(), "{name}: {verdict:?}");
                self.stable += 1;
            }
            Stability::Unstable => {
                assert!(scene.grows(), "{name}: {verdict:?}");
                self.unstable += 1;
            }
            Stability::Undetermined => self.undetermined += 1,
        }
    }
}

/// Small integer rows of a regular matrix: a lower triangle with unit diagonal times an upper one.
fn rows(n: usize, random: &mut Random) -> Vec<Vec<i64>> {
    let mut entry = |i: usize, j: usize| match i.cmp(&j) {
        std::cmp::Ordering::Equal => 1,
        _ => random.below(3) as i64 - 1,
    };
    let lower: Vec<Vec<i64>> = (0..n).map(|i| (0..n).map(|j| if j > i { 0 } else { entry(i, j) }).collect()).collect();
    let upper: Vec<Vec<i64>> = (0..n).map(|i| (0..n).map(|j| if j < i { 0 } else { entry(i, j) }).collect()).collect();
    (0..n).map(|i| (0..n).map(|j| (0..n).map(|l| lower[i][l] * upper[l][j]).sum()).collect()).collect()
}

/// Critical to between 20 and 89 digits, from either side, or with a root that close to those of others.
fn near_critical(random: &mut Random) -> Quadratic {
    let rate = BigRational::new((1 + random.below(4) as i64).into(), (1 + random.below(2) as i64).into());
    let off = ten_to_minus(20 + random.below(70) as u32) * whole([-1, 1][random.below(2)]);
    match random.below(6) {
        0 | 1 => Quadratic::new(1, whole(2) * &rate + off, &rate * &rate),
        2 => Quadratic::with_roots(&(-&rate + off), &(-&rate * whole(3))),
        3 => Quadratic::with_roots(&-&rate, &-(&rate * whole(2))),
        // Exactly critical.
        4 => Quadratic::new(1, whole(2) * &rate, &rate * &rate),
        _ => Quadratic::new(1, whole(2) * &rate + off.clone(), &rate * &rate + off),
    }
}

/// Other kinds of quadratics: growing, without inertia, free, undamped, far away.
fn other(random: &mut Random) -> Quadratic {
    match random.below(9) {
        0 => Quadratic::new(1, whole(-6), whole(3)),
        1 => Quadratic::new(1, -ten_to_minus(30 + random.below(50) as u32), whole(1)),
        2 => Quadratic::new(0, whole(2), whole(2)),
        3 => Quadratic::new(0, whole(0), whole(5)),
        4 => Quadratic::new(1, whole(2), whole(0)),
        5 => Quadratic::new(1, whole(0), whole(4)),
        6 => Quadratic::new(1, whole(1), whole(-2)),
        7 => Quadratic::new(1, whole(1_000_002), whole(1_000_001)),
        _ => Quadratic::new(1, whole(-2) + ten_to_minus(20 + random.below(70) as u32), whole(1)),
    }
}

/// `VIBC_POLE_SCENES` requests more scenes than usual.
fn scenes(usual: usize) -> usize {
    std::env::var("VIBC_POLE_SCENES").ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

#[test]
fn near_critical_poles_are_all_there_once() {
    let (mut random, mut seen) = (Random::new(12), Seen::default());
    let count = scenes(60);
    for index in 0..count {
        let n = 1 + random.below(4);
        let quadratics: Vec<Quadratic> = (0..n)
            .map(|i| if i > 1 && random.below(2) == 0 { other(&mut random) } else { near_critical(&mut random) })
            .collect();
        let rows = if random.below(4) == 0 { identity(n) } else { rows(n, &mut random) };
        seen.check(&Scene::of(&quadratics, &rows, &Number::ONE), &format!("{index}: {quadratics:?}"));
    }
    assert_eq!((seen.counted, seen.refused), (count, 0), "{seen:?}");
}

fn identity(n: usize) -> Vec<Vec<i64>> {
    (0..n).map(|i| (0..n).map(|j| i64::from(i == j)).collect()).collect()
}

/// Numbers that are not rational, for which the polynomial is not available. Poles that cannot be separated form a
/// cluster or have no bound, and then no count is claimed.
#[test]
fn where_numbers_are_not_exact_no_count_is_claimed_that_is_wrong() {
    let (mut random, mut seen) = (Random::new(7), Seen::default());
    let root = Number::from(2).sqrt().expect("positive");
    for index in 0..scenes(200) {
        let n = 2 + random.below(4);
        let quadratics: Vec<Quadratic> = (0..n)
            .map(|_| match random.below(3) {
                0 => near_critical(&mut random),
                1 => other(&mut random),
                _ => Quadratic::new(1, whole(random.below(5) as i64), whole(1 + random.below(9) as i64)),
            })
            .collect();
        let rows = rows(n, &mut random);
        seen.check(&Scene::of(&quadratics, &rows, &root), &format!("{index}: {quadratics:?}"));
    }
    assert!(seen.counted > 0 && seen.counted + seen.refused < scenes(200), "{seen:?}");
}

/// Ordinary scenes, some of them growing, by the method for all poles at once.
#[test]
fn poles_of_larger_parts_are_all_there_once() {
    let (mut random, mut seen) = (Random::new(3), Seen::default());
    let count = scenes(12).min(200);
    for index in 0..count {
        let n = 6 + random.below(10);
        let quadratics: Vec<Quadratic> = (0..n)
            .map(|i| {
                let c = whole(random.below(30) as i64 - if index % 2 == 0 { 0 } else { 2 }) / whole(10);
                Quadratic::new(1, c, whole(1 + 3 * i as i64 + random.below(3) as i64))
            })
            .collect();
        let mut rows = identity(n);
        for i in 1..n {
            rows[i][i - 1] = random.below(3) as i64 - 1;
            rows[i][random.below(i)] += 1;
        }
        seen.check(&Scene::of(&quadratics, &rows, &Number::ONE), &format!("{index}: {quadratics:?}"));
    }
    assert_eq!((seen.counted, seen.refused), (count, 0), "{seen:?}");
}

/// Two or four masses on springs and dampers that are critical except for the last digits.
fn chain(damping: [&str; 3], n: usize, joined: bool) -> LinearSystem {
    let mut chain = Builder::numbered(n);
    let [ground, between, each] = damping.map(number);
    let one = number("1");
    for i in 0..n {
        chain.mass(i, &one);
        if joined || i == 0 {
            chain.spring(None, i, &one);
            chain.damper(None, i, &ground);
        }
        if i > 0 {
            chain.spring(Some(i - 1), i, &one);
            chain.damper(Some(i - 1), i, &between);
        }
        if !each.is_zero() {
            chain.damper(None, i, &each);
        }
    }
    chain.finish()
}

fn solved(system: &LinearSystem) -> (Poles, Verdict) {
    let modes = analysis::modes(system).expect("modes");
    let poles = analysis::poles(system, &modes).expect("poles");
    let verdict = analysis::stability(system, &modes, &poles);
    (poles, verdict)
}

fn is_near(pole: &Pole, re: f64) -> bool {
    (pole.re.to_f64() - re).abs() < 1e-14 * re.abs()
}

/// (s² + 2 s + 1 - ...)(s² - 6 s + 3): the second factor was once lost, and the rest reported as stable.
#[test]
fn growing_poles_near_a_nearly_critical_pair_are_reported() {
    let nines = "1.99999999999999999999999999999999999999999999999999";
    let (poles, verdict) = solved(&chain([nines, "-4", "0"], 2, true));
    assert_eq!((poles.list.len(), poles.infinite()), (4, Some(0)));
    for growth in [3.0 - 6f64.sqrt(), 3.0 + 6f64.sqrt()] {
        let found = poles.list.iter().filter(|pole| is_near(pole, growth) && pole.kind == PoleKind::Divergence);
        assert_eq!(found.count(), 1, "{growth}");
    }
    assert_eq!(verdict, Stability::Unstable);
    // Four masses: +0.0841 and +1.4334 were once missing.
    let nines = "3.999999999999999999999999999999999999999999999999999999";
    let (poles, verdict) = solved(&chain([nines, nines, "-2"], 4, false));
    assert_eq!((poles.list.len(), poles.infinite()), (8, Some(0)));
    let growing: Vec<f64> = poles.list.iter().map(|pole| pole.re.to_f64()).filter(|re| *re > 0.0).collect();
    assert_eq!(growing.len(), 2, "{growing:?}");
    assert!((growing[0] - 0.0841).abs() < 1e-4 && (growing[1] - 1.4334).abs() < 1e-4, "{growing:?}");
    assert_eq!(verdict, Stability::Unstable);
}

/// (s + 1)² up to 1e-30, and (s + 1)(s + 3): -3 was once lost.
#[test]
fn a_pole_near_a_nearly_critical_pair_is_reported() {
    let (poles, verdict) = solved(&chain(["1.999999999999999999999999999999", "1", "0"], 2, true));
    assert_eq!((poles.list.len(), poles.infinite()), (4, Some(0)));
    assert_eq!(poles.list.iter().filter(|pole| is_near(pole, -3.0)).count(), 1);
    assert_eq!(verdict, Stability::Stable);
    let above = "2.0000000000000000000000000000000000000001";
    let (poles, _) = solved(&chain([above, above, "0"], 4, false));
    assert_eq!((poles.list.len(), poles.infinite()), (8, Some(0)));
}

/// Powers of ten near the ends of the range change no pole, or only the unit of time.
#[test]
fn poles_keep_their_bounds_at_the_ends_of_the_range() {
    let system = |unit: &str| {
        let mut chain = Builder::numbered(5);
        let unit = number(unit);
        for i in 0..5 {
            chain.mass(i, &(&unit * &number(&format!("1.0{}", i + 1))));
            chain.spring(if i == 0 { None } else { Some(i - 1) }, i, &unit);
        }
        chain.damper(None, 1, &(&unit * &number("0.1")));
        chain.finish()
    };
    let (truth, _) = solved(&system("1"));
    for unit in ["1e-300", "1e-306", "1e-160", "1e290", "1e305"] {
        let (poles, verdict) = solved(&system(unit));
        assert_eq!(verdict, Stability::Stable, "{unit}");
        assert_eq!(poles.count, truth.count, "{unit}");
        for (pole, truth) in poles.list.iter().zip(&truth.list) {
            let apart = |a: Ball, b: Ball| (a.mid - b.mid).to_f64().abs() <= (a.rad + b.rad) * (1.0 + 1e-10);
            assert!(apart(pole.re, truth.re) && apart(pole.im, truth.im), "{unit}: {pole:?} {truth:?}");
            assert!(pole.relative_error < 1e-27, "{unit}: {pole:?}");
        }
    }
}

/// Equal poles of uncoupled parts are one cluster, like equal frequencies.
#[test]
fn equal_poles_of_different_parts_are_a_cluster() {
    let mut three = Builder::numbered(3);
    for (i, c) in ["0.5", "0.5", "0.7"].into_iter().enumerate() {
        three.mass(i, &number("1"));
        three.spring(None, i, &number("4"));
        three.damper(None, i, &number(c));
    }
    let (poles, _) = solved(&three.finish());
    let clusters: Vec<Option<u32>> = poles.list.iter().map(|pole| pole.cluster).collect();
    let in_cluster = |number: u32| clusters.iter().filter(|cluster| **cluster == Some(number)).count();
    assert_eq!((in_cluster(0), in_cluster(1), clusters.iter().flatten().count()), (2, 2, 4), "{clusters:?}");
    for number in [0, 1] {
        let members: Vec<&Pole> = poles.list.iter().filter(|pole| pole.cluster == Some(number)).collect();
        assert_eq!(members[0].im.mid, members[1].im.mid);
        assert!(!members[0].defective);
    }
}

/// A body that moves on a slant, with a damper across its path, and further declarations.
fn across(more: &str) -> super::ask::Answer {
    super::ask::ask(&format!(
        "param s = sin(20 deg)\nparam c = cos(20 deg)\n\
         point p = (-1 m * c, -1 m * s)\npoint q = (1 m * s, -1 m * c)\n\
         body a {{ mass = 1 kg, at = (0 m, 0 m), moves along (c, s) }}\n\
         damper d: ground@q -- a {{ c = 2 N*s/m }}\n{more}"
    ))
}

/// A damper across the motion has a factor whose ball contains zero: it takes no energy, and cannot feed any in.
#[test]
fn a_damper_across_the_motion_makes_nothing_grow() {
    let verdict =
        |answer: &super::ask::Answer| analysis::stability(&answer.lowered.system, &answer.modes, &answer.poles);
    let held = across("spring f: ground@p -- a { k = 4 N/m }\n");
    assert!(!held.lowered.system.c.is_empty());
    assert!(held.poles.list.iter().all(|pole| pole.kind == PoleKind::Oscillation), "{:?}", held.poles.list);
    assert_eq!(verdict(&held), Stability::Stable);
    assert!(held.poles.is_complete());
    // Without a spring both poles are real, and one of them cannot be distinguished from zero.
    let free = across("");
    assert!(free.poles.list.iter().all(|pole| pole.kind != PoleKind::Undetermined), "{:?}", free.poles.list);
    assert_eq!(verdict(&free), Stability::Neutral);
}

/// Pairs that are critical to 70 digits, each several times, with a node without inertia: the common divisor of the
/// determinant and its derivative has more bits than a dozen primes hold. The scene was once refused as singular.
#[test]
fn repeated_nearly_critical_pairs_with_a_massless_node_are_reported() {
    let off = ten_to_minus(70);
    let pair = Quadratic::new(1, whole(2) + off, whole(1));
    let quadratics = [pair.clone(), pair.clone(), pair.clone(), pair, Quadratic::new(0, whole(1), whole(3))];
    let scene = Scene::of(&quadratics, &rows(5, &mut Random::new(1)), &Number::ONE);
    let mut seen = Seen::default();
    seen.check(&scene, "four pairs and a node");
    assert_eq!((seen.counted, seen.stable), (1, 1), "{seen:?}");
}
