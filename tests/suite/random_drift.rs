//! Noise where motions have no springs, and outputs that do not move: the verdict that a mean square is infinite beside what the
//! transfer function does at 0 Hz, far above all poles and at poles on the axis. See docs/method/random.md#direct-paths.

use super::random::{answer, under_noise};
use std::f64::consts::PI;
use vibc::Spread;

const SHAKEN: &str = "base q { moves x } = noise(white 1 m^2/(rad/s))\n";
const RATE: &str = "base q { moves x } = noise(white 1 m^2/s^2/(rad/s))\n";

/// x/q = s / (s^3 + 3 s^2 + 2 s + 1): the pole of b at 0 cancels, and by Lyapunov's equation the mean square is pi / 10.
#[test]
fn a_body_on_dampers_is_not_driven_at_rest() {
    let text = format!(
        "{SHAKEN}body a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\ndamper d: q -- a {{ c = 1 N*s/m }}\n\
         spring s: ground -- a {{ k = 1 N/m }}\ndamper e: a -- b {{ c = 1 N*s/m }}\noutput x = b.x\n"
    );
    is_square_root_of(&under_noise(&text)[0].0, PI / 10.0);
}

/// To a few units of binary64.
fn is_square_root_of(found: &Spread, square: f64) {
    let Spread::Finite(found) = found else { panic!("{found:?}") };
    let apart = found.square().to_f64() - square;
    assert!(apart.abs() <= 1e-15 * square && found.relative_error() < 1e-20, "{found:?} {square}");
}

/// The force pulls both bodies apart: their sum does not move.
#[test]
fn an_output_that_is_zero_is_not_infinite() {
    let text = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- a { k = 4 N/m }\n\
                spring t: a -- b { k = 4 N/m }\nspring u: ground -- b { k = 4 N/m }\n\
                force F: a -- b along x = noise(white 2 N^2/Hz)\noutput y = a.x + b.x\noutput z = a.x - b.x\n";
    let found = under_noise(text);
    assert!(matches!(&found[0].0, Spread::Finite(rms) if rms.is_zero()), "{found:?}");
    assert!(matches!(found[1].0, Spread::Infinite(_)), "{found:?}");
}

/// x/q' = -1 / (s + 1), of white noise and of noise from 0 rad/s on; the body itself drifts with its base.
#[test]
fn a_body_on_a_damper_drifts_with_its_base() {
    let body =
        "body a { mass = 1 kg, moves x }\ndamper d: q -- a { c = 1 N*s/m }\noutput x = a.x - q.x\noutput own = a.x\n";
    let band = "base q { moves x } = noise(1 m^2/s^2/(rad/s), 0 rad/s .. 3 rad/s)\n";
    for (base, square) in [(RATE, PI / 2.0), (band, 3f64.atan())] {
        let found = under_noise(&format!("{base}{body}"));
        is_square_root_of(&found[0].0, square);
        assert!(matches!(found[1].0, Spread::Infinite(_)), "{base}{found:?}");
    }
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn square(a: Complex) -> f64 {
    a[0] * a[0] + a[1] * a[1]
}

/// Two bodies of 1 kg: stiffness and damping from the ground to a, from a to b and from the base to a.
struct Pair {
    k: [f64; 3],
    c: [f64; 3],
    derivative: u32,
    /// The upper end of the band of the noise, rad/s; white noise has none.
    top: Option<f64>,
    /// Factors of a, b and q.
    output: [f64; 3],
}

impl Pair {
    /// det (s^2 + C s + K), the coefficients of s^0 .. s^4.
    fn determinant(&self) -> [f64; 5] {
        let [[kg, kab, kq], [cg, cab, cq]] = [self.k, self.c];
        let (a, b) = ([kg + kab + kq, cg + cab + cq, 1.0], [kab, cab, 1.0]);
        let mut product = [0.0; 5];
        for i in 0..3 {
            for j in 0..3 {
                product[i + j] += a[i] * b[j];
            }
        }
        product[0] -= kab * kab;
        product[1] -= 2.0 * kab * cab;
        product[2] -= cab * cab;
        product
    }

    /// |H(s)|^2 from the noise, s = i w but for a small real part.
    fn gain(&self, s: Complex) -> f64 {
        let linear = |k: f64, c: f64| [k + c * s[0], c * s[1]];
        let powers = |list: &[f64]| {
            list.iter().rev().fold([0.0; 2], |sum, x| {
                let sum = times(sum, s);
                [sum[0] + x, sum[1]]
            })
        };
        let det = powers(&self.determinant());
        let drive = linear(self.k[2], self.c[2]);
        // a = drive (s^2 + C_bb s + K_bb) / det, b = drive (c s + k) / det
        let a = times(drive, powers(&[self.k[1], self.c[1], 1.0]));
        let b = times(drive, linear(self.k[1], self.c[1]));
        let [p, r, q] = self.output;
        let sum = [p * a[0] + r * b[0] + q * det[0], p * a[1] + r * b[1] + q * det[1]];
        (0..self.derivative).fold(square(sum) / square(det), |gain, _| gain / square(s))
    }

    fn at(&self, w: f64) -> f64 {
        self.gain([0.0, w])
    }

    /// Whether the integral of |H|^2 over the frequencies of the noise is infinite; `None` for an output that does not move.
    fn is_infinite(&self) -> Option<bool> {
        let largest = [0.3, 0.77, 1.9, 4.1].map(|w| self.at(w)).into_iter().fold(0.0, f64::max);
        if largest < 1e-20 {
            return None;
        }
        // |H|^2 falls by a hundred or more in a decade where the integral exists, and at 0 Hz it does not grow.
        let grows = self.at(1e-5) > 30.0 * self.at(1e-4);
        let stays = self.top.is_none() && self.at(1e5) > 0.03 * self.at(1e4);
        let [a0, a1, a2, a3, a4] = self.determinant();
        let squares = if a3 > 0.0 {
            vec![a1 / a3]
        } else {
            let root = (a2 * a2 - 4.0 * a4 * a0).max(0.0).sqrt();
            vec![(a2 + root) / (2.0 * a4), (a2 - root) / (2.0 * a4)]
        };
        let is_driven = |square: f64| square > 1e-9 && self.top.is_none_or(|top| square < top * top);
        let on_axis = squares.into_iter().filter(|w| is_driven(*w) && (a0 - a2 * w + a4 * w * w).abs() < 1e-9);
        let rings = on_axis.into_iter().any(|square| self.gain([1e-6, square.sqrt()]) > 1e6);
        Some(grows || stays || rings)
    }

    /// By the trapezoidal rule in the logarithm of the frequency.
    fn integral(&self) -> f64 {
        const STEP: f64 = 2e-3;
        let frequencies = (-9000..9000).map(|i| (f64::from(i) * STEP).exp());
        frequencies.filter(|w| self.top.is_none_or(|top| *w < top)).map(|w| self.at(w) * w * STEP).sum()
    }

    fn text(&self) -> String {
        let unit = ["m^2", "m^2/s^2", "m^2/s^4"][self.derivative as usize];
        let density = match self.top {
            None => format!("white 1 {unit}/(rad/s)"),
            Some(top) => format!("1 {unit}/(rad/s), 0 rad/s .. {top} rad/s"),
        };
        let mut text = format!("base q {{ moves x }} = noise({density})\n");
        text += "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n";
        for (place, ends) in ["ground -- a", "a -- b", "q -- a"].iter().enumerate() {
            if self.k[place] > 0.0 {
                text += &format!("spring k{place}: {ends} {{ k = {} N/m }}\n", self.k[place]);
            }
            if self.c[place] > 0.0 {
                text += &format!("damper c{place}: {ends} {{ c = {} N*s/m }}\n", self.c[place]);
            }
        }
        text
    }
}

/// Every choice of springs and dampers between two bodies, a base and the ground, noise of the base's motion, its rate and its
/// acceleration, white and from 0 rad/s to the end of a band, absolute and relative outputs.
#[test]
fn no_verdict_is_against_the_transfer_function() {
    const OUTPUTS: [([f64; 3], &str); 5] = [
        ([1.0, 0.0, 0.0], "a.x"),
        ([0.0, 1.0, 0.0], "b.x"),
        ([-1.0, 1.0, 0.0], "b.x - a.x"),
        ([1.0, 0.0, -1.0], "a.x - q.x"),
        ([0.0, 1.0, -1.0], "b.x - q.x"),
    ];
    let mut counts = [0; 3];
    for choice in 0..64u32 {
        let has = |bit: u32, value: f64| if choice >> bit & 1 == 1 { value } else { 0.0 };
        let (k, c) = ([has(0, 1.0), has(1, 2.0), has(2, 1.5)], [has(3, 0.5), has(4, 1.0), has(5, 0.75)]);
        if k[2] == 0.0 && c[2] == 0.0 {
            continue;
        }
        for (derivative, top) in
            [0, 1, 2].into_iter().flat_map(|derivative| [(derivative, None), (derivative, Some(3.0))])
        {
            let mut text = Pair { k, c, derivative, top, output: [0.0; 3] }.text();
            for (i, (_, output)) in OUTPUTS.iter().enumerate() {
                text += &format!("output y{i} = {output}\n");
            }
            for noisy in answer(&text).noisy {
                let (output, name) = OUTPUTS[noisy.output];
                let pair = Pair { k, c, derivative, top, output };
                match (&noisy.rms, pair.is_infinite()) {
                    (Spread::Infinite(why), is) => {
                        counts[0] += 1;
                        assert_eq!(is, Some(true), "{text}{name}: {why}");
                    }
                    (Spread::Finite(rms), is) => {
                        counts[1] += 1;
                        assert_ne!(is, Some(true), "{text}{name}: {rms:?}");
                        let (found, truth) = (rms.square().to_f64(), pair.integral());
                        assert!((found - truth).abs() <= 5e-3 * truth + 1e-12, "{text}{name}: {found} {truth}");
                    }
                    (Spread::Unknown(_), _) => counts[2] += 1,
                }
            }
        }
    }
    assert!(counts[0] > 150 && counts[1] > 100 && counts[2] < 1, "{counts:?}");
}
