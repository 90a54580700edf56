//! A system whose damping couples its modes, as one block for each pole: eta_j' = s_j eta_j + x_j . f / Lambda_j, two
//! real states for a conjugate pair. In: the system and the coordinates of its poles. Out: blocks, or nothing if the
//! vectors are not known to enough digits or are so close to each other that blocks would cancel. See
//! docs/method/emit.md#blocks.

use crate::analysis::discrete::block::{Block, DirectSums, NOTHING, Split, product, without_derivatives};
use crate::analysis::poles::coordinates::PoleCoordinates;
use crate::base::{Ball, Dd, Number};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, LinearSystem};

/// Coefficients need some twenty digits.
const DIGITS: f64 = 1e-21;
/// The sum of the blocks may be smaller than each of them by this factor: two digits of the target.
const MOST_CANCELLED: f64 = 100.0;

/// The blocks of a system.
pub fn split(system: &LinearSystem, of: &PoleCoordinates) -> Option<Split> {
    let slowest = of.pairs.iter().map(|pair| pair.s.to_f64().abs()).fold(f64::INFINITY, f64::min);
    if !(of.cancellation <= MOST_CANCELLED && of.coupling <= DIGITS * slowest && is_precise(of)) {
        return None;
    }
    let [m, c] = [&system.m, &system.c].map(Squares::of_form);
    let seen = system.outputs.iter().map(|output| {
        [0, 1, 2].map(|power: usize| {
            let row: Vec<(usize, Ball)> = output.p[power].iter().map(|(i, p)| (i.index(), p.to_ball())).collect();
            (!row.is_empty()).then(|| of.sees(&row))
        })
    });
    let maker = Maker { system, of, m, c, seen: seen.collect() };
    let mut direct = DirectSums::none(system);
    let blocks = (0..of.pairs.len()).map(|j| maker.block(j, &mut direct)).collect();
    let mut split = Split {
        blocks,
        direct: super::direct_of(system),
        method: "a block of real states for each pole or complex pair",
    };
    direct.add_to(&mut split.direct);
    Some(split)
}

/// Whether the excitations by the inputs are known to enough digits of the largest one.
fn is_precise(of: &PoleCoordinates) -> bool {
    of.inputs.iter().flatten().flatten().all(|list| {
        let largest = list.iter().map(|z| z.magnitude()).fold(0.0, f64::max);
        list.iter().all(|z| z.re.rad.max(z.im.rad) <= DIGITS * largest)
    })
}

struct Maker<'a> {
    system: &'a LinearSystem,
    of: &'a PoleCoordinates,
    m: Squares,
    c: Squares,
    /// By output and power of s: p . x_j.
    seen: Vec<[Option<Vec<Complex<Ball>>>; 3]>,
}

impl Maker<'_> {
    /// The block of a pole; its direct effects go to the sums.
    fn block(&self, j: usize, direct: &mut DirectSums) -> Block {
        let pair = &self.of.pairs[j];
        let (s, is_real) = (pair.s, pair.is_real());
        let size = if is_real { 1 } else { 2 };
        let a = Matrix::from_fn(size, size, |i, k| match (i, k) {
            (0, 1) => -s.im,
            (1, 0) => s.im,
            _ => s.re,
        });
        let length = (0..self.system.n()).map(|i| pair.x.entry(i).to_f64().abs()).fold(0.0, f64::max);
        let norm = self.of.scale[j] * self.of.norms[j].magnitude();
        let force = |power: usize| {
            Matrix::from_fn(size, self.system.inputs.len(), |i, input| {
                let Some(b) = &self.of.inputs[input][power] else { return Dd::ZERO };
                let most = size_of(&self.system.inputs[input].b[power]);
                let is_nothing = b[j].magnitude() * norm <= NOTHING * length * most;
                if is_nothing { Dd::ZERO } else { [b[j].re.mid, b[j].im.mid][i] }
            })
        };
        let forces = [force(0), force(1), force(2)];
        // A pair adds twice the real part.
        let factor = Dd::from(self.of.scale[j] * if is_real { 1.0 } else { 2.0 });
        let row = |z: Complex<Dd>, i: usize| if i == 0 { z.re * factor } else { -z.im * factor };
        let mid = |z: Complex<Ball>| Complex::new(z.re.mid, z.im.mid);
        let at = |output: usize, power: usize| {
            let Some(seen) = &self.seen[output][power] else { return Complex::ZERO };
            let most = size_of(&self.system.outputs[output].p[power]);
            if seen[j].magnitude() <= NOTHING * length * most { Complex::ZERO } else { mid(seen[j]) }
        };
        let outputs = self.system.outputs.len();
        // p0 q + p1 q' + p2 q'', where the accelerations are sums of s_j x_j eta_j'.
        let c =
            Matrix::from_fn(outputs, size, |output, i| row(at(output, 0) + (at(output, 1) + at(output, 2) * s) * s, i));
        let of_rates = Matrix::from_fn(outputs, size, |output, i| row(at(output, 2) * s, i));
        let at_once = [0, 1, 2].map(|power: usize| product(&of_rates, &forces[power]));
        let (b, [e0, e1]) = without_derivatives(&a, forces);
        let (to, back) = (self.to(j), self.to_coordinates(j, &row));
        direct.add(&at_once, &[e0, e1], &c, &back);
        let number = |x: Dd| format!("{:.5e}", x.to_f64());
        let name = match is_real {
            true => format!("pole {} 1/s", number(s.re)),
            false => format!("pole {} +- {}i 1/s", number(s.re), number(s.im.abs())),
        };
        Block { name, rate: s.to_f64().abs(), a, b, c, to, back }
    }

    /// zeta_j = x_j . (C q + M q' + s_j M q) / (g_j Lambda_j): a row over displacements, then velocities.
    fn to(&self, j: usize) -> Matrix<Dd> {
        let (pair, n) = (&self.of.pairs[j], self.system.n());
        let part = |entry: fn(Complex<Dd>) -> Dd| (0..n).map(|i| entry(pair.x.entry(i))).collect::<Vec<Dd>>();
        let of_both = |squares: &Squares| {
            let [re, im] = [part(|z| z.re), part(|z| z.im)].map(|x| image(squares, &x));
            re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect::<Vec<Complex<Dd>>>()
        };
        let (mx, cx) = (of_both(&self.m), of_both(&self.c));
        let norm = self.of.norms[j];
        let inverse = Complex::real(Ball::from(1.0 / self.of.scale[j])) / norm;
        let inverse = Complex::new(inverse.re.mid, inverse.im.mid);
        let size = if pair.is_real() { 1 } else { 2 };
        let entry = |k: usize| inverse * if k < n { cx[k] + pair.s * mx[k] } else { mx[k - n] };
        let row: Vec<Complex<Dd>> = (0..2 * n).map(entry).collect();
        Matrix::from_fn(size, 2 * n, |i, k| if i == 0 { row[k].re } else { row[k].im })
    }

    /// Displacements and velocities: x_j eta_j and s_j x_j eta_j.
    fn to_coordinates(&self, j: usize, row: &dyn Fn(Complex<Dd>, usize) -> Dd) -> Matrix<Dd> {
        let (pair, n) = (&self.of.pairs[j], self.system.n());
        let size = if pair.is_real() { 1 } else { 2 };
        let of = |k: usize| if k < n { pair.x.entry(k) } else { pair.s * pair.x.entry(k - n) };
        Matrix::from_fn(2 * n, size, |k, i| row(of(k), i))
    }
}

/// The largest entry of a sparse column.
fn size_of(column: &[(CoordinateId, Number)]) -> f64 {
    column.iter().map(|(_, value)| value.to_ball().magnitude()).fold(0.0, f64::max)
}

/// (sum w a a^T) x
fn image(squares: &Squares, x: &[Dd]) -> Vec<Dd> {
    let mut image = vec![Dd::ZERO; x.len()];
    for t in 0..squares.len() {
        let tension = (squares.weights[t] * squares.stretch(t, x)).mid;
        let (indices, factors) = squares.row(t);
        indices.iter().zip(factors).for_each(|(&i, a)| image[i as usize] += tension * a.mid);
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::discrete::block::add;
    use crate::analysis::modes;
    use crate::analysis::poles::pole_coordinates;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::transfer::{Frequency, Transfer};
    use crate::kernel::dense::lu::Lu;

    /// A held chain with two dampers, one of which makes poles real; a base that acts by its displacement, rate and acceleration;
    /// displacement, rate and acceleration as outputs.
    fn chain() -> LinearSystem {
        let mut system = blank(5);
        for i in 0..5 {
            push(&mut system.m, "1.3", i, None);
            push(&mut system.k, "7", i, i.checked_sub(1));
        }
        push(&mut system.c, "0.4", 1, Some(0));
        push(&mut system.c, "20", 4, None);
        let at = |value: &str| vec![(CoordinateId(0), Number::from(value))];
        system.inputs[0].b = [at("7"), at("0.4"), at("0.2")];
        system.outputs[1].p.swap(0, 1);
        system.outputs[2].p.swap(0, 2);
        system
    }

    /// The blocks have the transfer functions of the system, which are solved frequency by frequency.
    #[test]
    fn blocks_have_the_transfer_functions_of_the_system() {
        let system = chain();
        let of = pole_coordinates(&system, &modes(&system).expect("modes")).expect("poles");
        assert!(of.pairs.iter().any(|pair| pair.is_real()) && of.pairs.iter().any(|pair| !pair.is_real()));
        let split = split(&system, &of).expect("blocks");
        let transfer = Transfer::of(&system);
        for omega in ["0.3", "1.9", "4.4", "11"] {
            let frequency = Frequency::radians(&Number::from(omega));
            let w = Number::from(omega).to_f64();
            for (input, output) in [(0, 0), (0, 1), (0, 2), (0, 4), (3, 2), (3, 3)] {
                let truth = transfer.between(&frequency, &[input], &[output])[0][0].disc().expect("finite").value;
                let [d0, d1, d2] = [0, 1, 2].map(|k: usize| split.direct.outputs[k][(output, input)].hi);
                let mut sum = Complex::new(d0 - w * w * d2, w * d1);
                let mut size = sum.abs();
                for block in &split.blocks {
                    let n = block.size();
                    let matrix =
                        Matrix::from_fn(n, n, |i, j| Complex::new(-block.a[(i, j)].hi, if i == j { w } else { 0.0 }));
                    let mut x: Vec<Complex<f64>> = (0..n).map(|i| Complex::real(block.b[(i, input)].hi)).collect();
                    Lu::of(matrix).expect("regular").solve(&mut x);
                    let own = (0..n).fold(Complex::ZERO, |own, i| own + x[i].scale(block.c[(output, i)].hi));
                    (sum, size) = (sum + own, size + own.abs());
                }
                let off = (sum - truth.to_f64()).abs();
                assert!(off <= 1e-14 * size, "{omega} {input} {output}: {sum:?} {truth:?}");
            }
        }
    }

    /// A state from displacements and velocities, and back: the identity, to the digits of a double-double.
    #[test]
    fn states_go_to_the_blocks_and_back() {
        let system = chain();
        let of = pole_coordinates(&system, &modes(&system).expect("modes")).expect("poles");
        let split = split(&system, &of).expect("blocks");
        let mut sum = Matrix::zeros(10, 10);
        split.blocks.iter().for_each(|block| add(&mut sum, &product(&block.back, &block.to)));
        for j in 0..10 {
            for i in 0..10 {
                let off = sum[(i, j)] - if i == j { Dd::ONE } else { Dd::ZERO };
                assert!(off.hi.abs() < 1e-26, "{i} {j}: {off:?}");
            }
        }
    }

    /// Poles so near to each other that their blocks would cancel are left to a dense block.
    #[test]
    fn nearly_equal_motions_are_refused() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, ["1", "0.99990098"][i], i, None);
        }
        // Both pairs of poles differ by 2.7e-6: an exceptional point, found by minimising that over c and the second spring.
        push(&mut system.k, "0.01", 1, Some(0));
        push(&mut system.c, "0.01990172", 0, None);
        let of = pole_coordinates(&system, &modes(&system).expect("modes"));
        assert!(of.as_ref().is_none_or(|of| of.cancellation > 100.0), "{of:?}");
        assert!(of.is_none_or(|of| split(&system, &of).is_none()));
    }
}
