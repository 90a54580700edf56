//! A disc that certainly contains exactly one pole, a simple one. In: an approximate pole and its vector, taken as
//! exact numbers, and the frame of the undamped modes. Out: the disc, or nothing if none can be proved. See
//! docs/method/poles.md#poles-followed-from-modes.
//!
//! In the basis (x, X', Y), X' the modes X without the one that x comes from, det Q is a constant times det R^T Q R times
//!
//!   f(s) = x^T Q(s) x - u^T (R^T Q(s) R)^-1 u,   u = R^T Q(s) x,   R = (X', Y).
//!
//! With w = s - s_0: x^T Q(s) x = rho + w d + w^2 x^T M x, and u is R^T (r + w Q'(s_0) x + w^2 M x), small with r and w. If
//! |d w| exceeds the rest on a circle, f has as many zeros in it as a linear function: one (Rouche), and R^T Q R is regular.

use crate::analysis::modes::mesh::network::UP;
use crate::analysis::modes::mesh::residual::Image;
use crate::analysis::poles::discs::PoleEnclosure;
use crate::analysis::poles::pencil::{Application, Pencil};
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::targeted::frame::{Frame, Level};
use crate::base::{Ball, Dd, Power, down, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use crate::kernel::simd::simd;
use crate::kernel::squares::Squares;
use crate::kernel::triple::{Precise, Triple};

/// The most circles that are tried; each is twice as large as the one before.
const MOST_CIRCLES: usize = 40;

/// The disc of a pair that comes from mode `from` of the frame, with a relative radius of about `tolerance` if that
/// takes less time than a smaller one.
pub fn disc(
    frame: &Frame,
    pencil: &Pencil<Precise>,
    pair: &Pair,
    from: usize,
    tolerance: f64,
) -> Option<PoleEnclosure> {
    let applied = pencil.apply(pair.s, &pair.x);
    let s = pair.s.to_f64();
    let slope = Slope::of(pencil, s, &applied);
    let stiffness = frame.stiffness(frame.top, s, 0.0);
    if !(slope.least() > 0.0 && stiffness > 0.0) {
        return None;
    }
    let enough = 0.1 * (tolerance * s.abs() * slope.least() * stiffness).sqrt();
    let found = Found { frame, pair, s, slope, star: Star::of(frame, pencil, pair, &applied, enough)?, from };
    let rho = [applied.energy.re, applied.energy.im];
    // With fewer modes in the frame, damping joins fewer of them to the rest, and mu is nearer.
    let fewer = [1, 2, 4, 8].map(|more| from + more).into_iter().filter(|&count| count < frame.top.count);
    let levels = std::iter::once(Some(frame.top)).chain(fewer.map(|count| frame.level(count)));
    levels.flatten().find_map(|level| found.circle(level, rho))
}

/// The quantities of a pair that the proof needs.
struct Found<'a> {
    frame: &'a Frame<'a>,
    pair: &'a Pair,
    s: Complex<f64>,
    slope: Slope,
    star: Star,
    from: usize,
}

impl Found<'_> {
    /// The smallest of the tried circles on which the slope exceeds the rest.
    fn circle(&self, level: Level, [re, im]: [Precise; 2]) -> Option<PoleEnclosure> {
        let slope = &self.slope;
        // The Rayleigh quotient moves the centre by -rho / d.
        let rho = Complex::new(re, im).to_f64();
        let step = -(rho * slope.value.recip());
        let doubt = Complex::new(re.radius, im.radius).abs() + 1e-15 * rho.abs() + step.abs() * slope.error;
        let misplaced = doubt / slope.least() * UP;
        let offset = step.abs() * UP + misplaced;
        let rest = |reach: f64| Some((reach * reach * slope.inertia + self.share(level, reach)?) * UP);
        let mut radius = (rest(offset)? / slope.least() * 2.0).max(f64::MIN_POSITIVE);
        for _ in 0..MOST_CIRCLES {
            if slope.least() * radius > rest((offset + radius) * UP)? {
                let disc = around(self.pair, step, (radius + misplaced) * UP);
                return disc.filter(|disc| disc.s.im.mid.hi > disc.s.im.rad);
            }
            radius *= 2.0;
        }
        None
    }

    /// A bound of |u^T (R^T Q R)^-1 u| for all s within `reach` of s_0; `None` if R^T Q R may be singular.
    ///
    /// On Y, Q is at least eta (|y^H Q y| >= eta |y|_P^2), so the Schur complement of X' in it differs from A = X'^T Q X' by
    /// E Q_YY^-1 E^T; rows and columns of A are scaled by D = diag |A_ii|.
    fn share(&self, level: Level, reach: f64) -> Option<f64> {
        let (frame, s) = (self.frame, self.s);
        let modes: Vec<usize> = (0..level.count).filter(|&i| i != self.from).collect();
        let eta = frame.stiffness(level, s, reach);
        let size = (s.abs() + reach) * UP;
        let of = |[r, q, m]: [f64; 3]| (r + reach * q + reach * reach * m) * UP;
        let block = Block::of(frame, &modes, s, reach)?;
        let (mut p, mut e) = (0.0, 0.0);
        for (&i, &scale) in modes.iter().zip(&block.scale) {
            p += of(self.star.along[i]).power(2) / scale;
            e += frame.coupling(level, i, size).power(2) / scale;
        }
        let (p, e, q) = ((p * UP).sqrt() * UP, (e * UP).sqrt() * UP, of(self.star.outside));
        bound_of_both_parts([p, q], [block.least, eta], e)
    }
}

/// A bound of |u^T Q^-1 u| where the two parts of u are at most p and q, Q is at least `least` on the first and `eta` on the second one,
/// and couples them by at most e; `None` if Q may be singular.
fn bound_of_both_parts([p, q]: [f64; 2], [least, eta]: [f64; 2], e: f64) -> Option<f64> {
    let rest = least - e * e / eta * UP;
    (eta > 0.0 && rest > 0.0).then(|| (q * q / eta + (p + e * q / eta).power(2) / rest) * UP)
}

/// The disc about s_0 + step; the part of the centre that double-double cannot hold is added to the radius.
fn around(pair: &Pair, step: Complex<f64>, radius: f64) -> Option<PoleEnclosure> {
    let enclose = |s: Dd, step: f64| {
        let (mid, rest) = (Triple::from(s) + Triple::from(step)).split();
        Ball::new(mid, (radius + rest.abs() + mid.hi.abs() * (2.0 * Triple::ERROR)) * UP)
    };
    let s = Complex::new(enclose(pair.s.re, step.re), enclose(pair.s.im, step.im));
    radius.is_finite().then_some(PoleEnclosure { s, clusters: [None; 2] })
}

/// d = x^T Q'(s_0) x, and a bound of |x^T M x|.
struct Slope {
    value: Complex<f64>,
    error: f64,
    inertia: f64,
}

impl Slope {
    fn of(pencil: &Pencil<Precise>, s: Complex<f64>, applied: &Application<Precise>) -> Slope {
        let (m, m_size) = square(&pencil.m, &applied.m_stretch);
        let (c, c_size) = square(&pencil.c, &applied.c_stretch);
        let count = (pencil.m.len() + pencil.c.len() + 32) as f64;
        // Sums of this many products in binary64, each with a few rounding errors; s_0 is rounded too.
        let error = count * f64::EPSILON * (2.0 * s.abs() * m_size + c_size) * UP;
        Slope { value: s.scale(2.0) * m + c, error, inertia: m_size * UP }
    }

    fn least(&self) -> f64 {
        (self.value.abs() - self.error) * down::DOZENS
    }
}

/// sum w t^2, and an upper bound of the sum of the magnitudes of its parts.
fn square(squares: &Squares<Precise>, stretches: &[Complex<Precise>]) -> (Complex<f64>, f64) {
    let (mut sum, mut sizes) = (Complex::ZERO, 0.0);
    for (w, t) in squares.weights.iter().zip(stretches) {
        let near = t.to_f64();
        let size = near.abs() * up::FEW + t.re.radius + t.im.radius;
        sum = sum + (near * near).scale(w.value.hi());
        sizes += (w.value.hi().abs() + w.radius) * size * size;
        // The uncertainty of the radii is far below the rounding errors, or it is added here.
        sizes += (w.radius * size + (t.re.radius + t.im.radius) * w.value.hi().abs()) * size / f64::EPSILON;
    }
    (sum, sizes * UP)
}

/// Bounds of the coupling of x to the rest of the basis.
struct Star {
    /// Upper bounds of |X_i^T r|, |X_i^T Q'(s_0) x|, |X_i^T M x|.
    along: Vec<[f64; 3]>,
    /// Bounds of the three vectors outside the span of the modes, in the norm of P^-1.
    outside: [f64; 3],
}

impl Star {
    fn of(
        frame: &Frame,
        pencil: &Pencil<Precise>,
        pair: &Pair,
        applied: &Application<Precise>,
        enough: f64,
    ) -> Option<Star> {
        let part = |of: fn(&Complex<Precise>) -> Precise| Image {
            value: applied.force.iter().map(|f| of(f).value.dd()).collect(),
            error: applied.force.iter().map(|f| of(f).radius + 1e-31 * of(f).value.hi().abs()).collect(),
            energy: Dd::ZERO,
        };
        let (re, im) = (part(|f| f.re), part(|f| f.im));
        let momentum = sizes_of_forces(&pencil.m, &applied.m_stretch, pencil.n);
        let drag = sizes_of_forces(&pencil.c, &applied.c_stretch, pencil.n);
        let size = 2.0 * pair.s.to_f64().abs() * UP;
        let slope: Vec<f64> = momentum.iter().zip(&drag).map(|(m, c)| (size * m + c) * UP).collect();
        let products = |x: &Vec<f64>| {
            let [r, q, m] = [libm::hypot(dot(x, &re), dot(x, &im)), sizes_dot(x, &slope), sizes_dot(x, &momentum)];
            [r * UP, q, m]
        };
        let along: Vec<[f64; 3]> = frame.x.iter().map(products).collect();
        let outside = [frame.dual(&re, &im, enough), frame.rough_dual(&slope), frame.rough_dual(&momentum)];
        outside.iter().all(|x| x.is_finite()).then_some(Star { along, outside })
    }
}

/// A = X'^T Q(s) X' near s_0, with scaled rows and columns.
struct Block {
    scale: Vec<f64>,
    /// A lower bound of the least singular value.
    least: f64,
}

impl Block {
    fn of(frame: &Frame, modes: &[usize], s: Complex<f64>, reach: f64) -> Option<Block> {
        let count = modes.len();
        if count == 0 {
            return Some(Block { scale: Vec::new(), least: 1.0 });
        }
        let (size, square) = ((s.abs() + reach) * UP, s * s);
        let entry = |i: usize, j: usize| {
            let at = (modes[i], modes[j]);
            let (k, c, m) = (frame.k[at], frame.c[at], frame.m[at]);
            let value = square.scale(m.value) + s.scale(c.value) + Complex::real(k.value);
            let sizes = size * size * m.value.abs() + size * c.value.abs() + k.value.abs();
            let moved = reach * (2.0 * size * m.value.abs() + c.value.abs());
            (value, (size * size * m.error + size * c.error + k.error + moved + 1e-14 * sizes) * UP)
        };
        let scale: Vec<f64> = (0..count).map(|i| entry(i, i).0.abs()).collect();
        if scale.iter().any(|&d| d.is_nan() || d <= 0.0) {
            return None;
        }
        let scaled = |i: usize, j: usize| {
            let by = 1.0 / (scale[i] * scale[j]).sqrt();
            let (value, error) = entry(i, j);
            (value.scale(by), (error + 1e-14 * value.abs()) * by * UP)
        };
        let a = Matrix::from_fn(count, count, |i, j| scaled(i, j).0);
        let doubt: f64 =
            (0..count).flat_map(|j| (0..count).map(move |i| (i, j))).map(|(i, j)| scaled(i, j).1.power(2)).sum();
        let inverse = inverse(&a)?;
        // |A^-1| <= |B| / (1 - |1 - A B|), in Frobenius norms.
        let norm = |b: &Matrix<Complex<f64>>| {
            (0..count).flat_map(|j| b.column(j)).map(|z| z.abs().power(2)).sum::<f64>().sqrt() * UP
        };
        let gamma = (4 * count + 16) as f64 * f64::EPSILON;
        let (size_a, size_b) = (norm(&a), norm(&inverse));
        let left = Matrix::from_fn(count, count, |i, j| {
            let product = (0..count).fold(Complex::ZERO, |sum, l| sum + a[(i, l)] * inverse[(l, j)]);
            product - Complex::real(if i == j { 1.0 } else { 0.0 })
        });
        let theta = norm(&left) + gamma * (size_a * size_b + 1.0) + (doubt * UP).sqrt() * size_b * UP;
        // |B|_2² is at most the largest row sum times the largest column sum.
        let sum = |of: &dyn Fn(usize, usize) -> f64| {
            (0..count).map(|i| (0..count).map(|j| of(i, j)).sum::<f64>()).fold(0.0, f64::max)
        };
        let rows = sum(&|i, j| inverse[(i, j)].abs()) * UP;
        let columns = sum(&|i, j| inverse[(j, i)].abs()) * UP;
        let size_b = size_b.min((rows * columns).sqrt() * UP);
        (theta < 0.5).then(|| Block { scale, least: (1.0 - theta) / size_b / UP })
    }
}

fn inverse(a: &Matrix<Complex<f64>>) -> Option<Matrix<Complex<f64>>> {
    let n = a.rows();
    let factors = Lu::nearly_singular(a.clone())?;
    let mut b = Matrix::from_fn(n, n, |i, j| Complex::real(if i == j { 1.0 } else { 0.0 }));
    (0..n).for_each(|j| factors.solve(b.column_mut(j)));
    Some(b)
}

/// Upper bounds of sum |w| |a| |a . x| at each coordinate.
fn sizes_of_forces(squares: &Squares<Precise>, stretches: &[Complex<Precise>], n: usize) -> Vec<f64> {
    let mut sizes = vec![0.0; n];
    for (t, stretch) in stretches.iter().enumerate() {
        let w = squares.weights[t];
        let stretch = stretch.to_f64().abs() * up::FEW + stretch.re.radius + stretch.im.radius;
        let force = (w.value.hi().abs() + w.radius) * stretch;
        let (indices, values) = squares.row(t);
        for (&i, a) in indices.iter().zip(values) {
            sizes[i as usize] += (a.value.hi().abs() * up::FEW + a.radius) * force;
        }
    }
    sizes.iter_mut().for_each(|size| *size *= UP);
    sizes
}

simd! {
    /// A bound of |x . f|.
    fn dot(x: &[f64], f: &Image) -> f64 {
        let (mut sum, mut error) = (Dd::ZERO, 0.0);
        for (x, (f, radius)) in x.iter().zip(f.value.iter().zip(&f.error)) {
            sum += *f * *x;
            // Sums of a million products in double-double have an error below 1e-24 of their parts.
            error += x.abs() * (radius + 1e-24 * f.hi.abs());
        }
        (sum.hi.abs() + error) * UP
    }
}

/// sum |x| f
fn sizes_dot(x: &[f64], f: &[f64]) -> f64 {
    x.iter().zip(f).map(|(x, f)| x.abs() * f).sum::<f64>() * UP
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::parts::Part;
    use crate::analysis::poles::targeted::iteration::follow;
    use crate::analysis::poles::targeted::tests::band;
    use crate::analysis::poles::targeted::{Large, undamped_starts};
    use crate::analysis::{Mode, modes};
    use crate::system::LinearSystem;

    fn forty_masses() -> LinearSystem {
        band(40, 2, -2, 2, true, 5)
    }

    /// The lowest modes of a band of masses, and the pair that the third of them becomes with dampers.
    fn followed_pair(system: &LinearSystem) -> (Large<'_>, Vec<Mode>, Pair) {
        let mut list = modes(system).expect("modes").list;
        list.truncate(14);
        let large = Large::of(system, &Part::whole(system)).expect("sparse");
        let start = undamped_starts(&list[..8], 8).swap_remove(2);
        let pair = follow(&large.networks, &large.exact.to_dd(), &start).expect("a pole");
        (large, list, pair)
    }

    /// On a circle of radius r the linear part of f is d r and the rest is at most a r² + b. If d² < 4 a b, no circle
    /// proves anything, however good the pair is; with a ten-thousandth of a, one does.
    #[test]
    fn a_circle_on_which_the_slope_does_not_exceed_the_rest_is_none() {
        let system = forty_masses();
        let (large, list, pair) = followed_pair(&system);
        let frame = large.frame(&list, 8).expect("a gap");
        let applied = large.exact.apply(pair.s, &pair.x);
        let s = pair.s.to_f64();
        let slope = Slope::of(&large.exact, s, &applied).least();
        let inertia = 1e6 * slope / s.im;
        let rest = 10.0 * slope * slope / inertia;
        let outside = [(rest * frame.stiffness(frame.top, s, 0.0)).sqrt(), 0.0, 0.0];
        let circle = |inertia: f64| {
            let star = Star { along: vec![[0.0; 3]; frame.x.len()], outside };
            let slope = Slope { value: Complex::real(slope), error: 0.0, inertia };
            Found { frame: &frame, pair: &pair, s, slope, star, from: 2 }.circle(frame.top, [Precise::ZERO; 2])
        };
        assert_eq!(circle(inertia), None);
        let proved = circle(1e-4 * inertia).expect("the slope is larger there");
        assert!(proved.s.im.rad >= rest / slope, "{proved:?}");
    }

    fn precise(value: f64, radius: f64) -> Precise {
        Precise { value: Triple::from(value), radius }
    }

    /// One mass and one damper whose weights, and the vector, are as far off as they may be: the slope is within its error, its least
    /// size below that of all of them, and so are the inertia and the sizes of the forces.
    #[test]
    fn a_slope_holds_those_of_the_ends() {
        const OFF: f64 = 1e-6;
        let s = Complex::new(-0.25, 2.0);
        for known in 0..16u32 {
            let off = |bit: u32| if known >> bit & 1 == 1 { OFF } else { 0.0 };
            let (m, c, t) = (
                precise(3.0, off(0)),
                precise(0.5, off(1)),
                Complex::new(precise(0.75, off(2)), precise(-1.5, off(3))),
            );
            let squares = |weights: &[Precise]| {
                let mut squares = Squares::with_capacity(weights.len());
                weights.iter().for_each(|&w| squares.push(w, [(0, precise(2.0, off(0)))]));
                squares
            };
            let pencil = Pencil { n: 1, m: squares(&[m]), c: squares(&[c, m]), k: squares(&[]) };
            let zero = Complex::new(Precise::ZERO, Precise::ZERO);
            let applied = Application { force: vec![zero], energy: zero, m_stretch: vec![t], c_stretch: vec![t, t] };
            let slope = Slope::of(&pencil, s, &applied);
            let drag = sizes_of_forces(&pencil.c, &applied.c_stretch, 1)[0];
            for ends in 0..16u32 {
                let end = |bit: u32| if ends >> bit & 1 == 1 { off(bit) } else { -off(bit) };
                let (m, c) = (3.0 + end(0), 0.5 + end(1));
                let t = Complex::new(0.75 + end(2), -1.5 + end(3));
                let inertia = (t * t).scale(m);
                let d = s.scale(2.0) * inertia + (t * t).scale(c) + inertia;
                // Roundings of these few products.
                let slack = 1e-14;
                assert!(
                    (d - slope.value).abs() <= slope.error + slack,
                    "{known} {ends}: {:e}",
                    (d - slope.value).abs()
                );
                assert!(slope.least() <= d.abs() + slack && inertia.abs() <= slope.inertia + slack, "{known} {ends}");
                assert!((2.0 + end(0)) * t.abs() * (c + m) <= drag + slack, "{known} {ends} {drag}");
            }
        }
    }

    /// The disc about a sum of three words that do not fit into two.
    #[test]
    fn a_disc_holds_what_its_centre_loses() {
        let exact = |x: f64| crate::base::Rational::from_f64(x).expect("finite");
        let third = Dd::from(1.0) / Dd::from(3.0);
        let pair = Pair {
            s: Complex::new(-third, third + Dd::ONE),
            x: crate::analysis::poles::pencil::Vector { re: vec![Dd::ONE], im: vec![] },
        };
        for step in [0.0, 1e-3 / 7.0, -1e-20 / 7.0, 1e-33 / 7.0] {
            for radius in [0.0, 1e-30, 1e-3] {
                let disc = around(&pair, Complex::new(step, -step), radius).expect("finite");
                for (found, s, step) in [(disc.s.re, pair.s.re, step), (disc.s.im, pair.s.im, -step)] {
                    let centre = &(&exact(s.hi) + &exact(s.lo)) + &exact(step);
                    let mid = &exact(found.mid.hi) + &exact(found.mid.lo);
                    let off = (&centre - &mid).to_f64().abs();
                    assert!(off + radius <= found.rad, "{step:e} {radius:e}: {off:e} {:e}", found.rad);
                }
            }
        }
        assert!(
            around(&pair, Complex::ZERO, f64::INFINITY).is_none() && around(&pair, Complex::ZERO, f64::NAN).is_none()
        );
    }

    /// Matrices of two modes at the ends of what is known, anywhere in a circle: none is nearer to a singular one than the bound says.
    /// And what the coupling to modes, or to what is outside of them, takes from f is as large as for the worst of these.
    #[test]
    fn a_block_and_a_share_hold_those_of_the_ends() {
        let system = forty_masses();
        let (large, list, pair) = followed_pair(&system);
        let mut frame = large.frame(&list, 8).expect("a gap");
        let (s, reach) = (Complex::new(-0.1, 1.0), 0.03125);
        let numbers = [[(5.0, 0.02), (0.3, 0.01)], [(0.4, 0.03), (0.2, 0.005)], [(2.0, 0.01), (-0.1, 0.02)]];
        let mut tightest = f64::INFINITY;
        for (which, entry) in [(9, 9), (0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)] {
            let known = |form: usize, i: usize, j: usize| {
                let (value, error) = numbers[form][usize::from(i != j)];
                let own = if i == j && i == 1 { -0.7 * value } else { value };
                (own, if which == 9 || (form, usize::from(i != j)) == (which, entry) { error } else { 0.0 })
            };
            for i in 0..2 {
                for j in 0..2 {
                    let of = |form: usize| known(form, i, j);
                    for (matrix, (value, error)) in
                        [&mut frame.k, &mut frame.c, &mut frame.m].into_iter().zip([of(0), of(1), of(2)])
                    {
                        (matrix[(i, j)].value, matrix[(i, j)].error) = (value, error);
                    }
                }
            }
            for reach in [0.0, reach] {
                let block = Block::of(&frame, &[0, 1], s, reach).expect("regular");
                let one = Block::of(&frame, &[0], s, reach).expect("regular");
                for turn in 0..8 {
                    let angle = f64::from(turn) * 0.25 * std::f64::consts::PI;
                    let near = s + Complex::new(angle.cos(), angle.sin()).scale(reach);
                    for ends in 0..64u32 {
                        let entry = |i: usize, j: usize| {
                            let [k, c, m] = [0, 1, 2].map(|form| {
                                let (value, error) = known(form, i, j);
                                let bit = 2 * form + usize::from(i != j);
                                value + if ends >> bit & 1 == 1 { error } else { -error }
                            });
                            (near * near).scale(m) + near.scale(c) + Complex::real(k)
                        };
                        let scaled =
                            |i: usize, j: usize| entry(i, j).scale(1.0 / (block.scale[i] * block.scale[j]).sqrt());
                        let determinant = (scaled(0, 0) * scaled(1, 1) - scaled(0, 1) * scaled(1, 0)).abs();
                        let squares: f64 =
                            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| scaled(i, j).abs().powi(2)).iter().sum();
                        let root = (squares * squares - 4.0 * determinant * determinant).max(0.0).sqrt();
                        let least = (2.0 * determinant * determinant / (squares + root)).sqrt();
                        assert!(block.least <= least * (1.0 + 1e-9), "{which} {reach} {ends}: {least} {}", block.least);
                        let alone = entry(0, 0).abs() / one.scale[0];
                        assert!(one.least <= alone * (1.0 + 1e-9), "{which} {reach} {ends}: {alone} {}", one.least);
                        tightest = tightest.min(alone / one.least);
                    }
                }
            }
        }
        assert!(tightest < 1.001, "{tightest}");
        // One coupling at a time, in each of its three parts.
        let level = frame.top;
        let (s, count) = (pair.s.to_f64(), frame.x.len());
        let frame = large.frame(&list, 8).expect("a gap");
        for part in 0..3 {
            for reach in [0.0, 1e-3] {
                let eta = frame.stiffness(level, s, reach);
                let amount = 1e-3 * [1.0, reach, reach * reach][part];
                let one: [f64; 3] = std::array::from_fn(|k| if k == part { 1e-3 } else { 0.0 });
                let share = |along: Option<usize>, outside: [f64; 3]| {
                    let mut star = Star { along: vec![[0.0; 3]; count], outside };
                    if let Some(i) = along {
                        star.along[i] = one;
                    }
                    let slope = Slope { value: Complex::real(1.0), error: 0.0, inertia: 1.0 };
                    Found { frame: &frame, pair: &pair, s, slope, star, from: 2 }.share(level, reach).expect("regular")
                };
                assert!(share(None, one) >= amount * amount / eta * (1.0 - 1e-12), "{part} {reach}");
                for i in (0..level.count).filter(|&i| i != 2) {
                    let (k, c, m) = (frame.k[(i, i)].value, frame.c[(i, i)].value, frame.m[(i, i)].value);
                    let own = ((s * s).scale(m) + s.scale(c) + Complex::real(k)).abs();
                    // Without couplings to others, and with these nearer to singular.
                    assert!(share(Some(i), [0.0; 3]) >= amount * amount / own * (1.0 - 1e-9), "{part} {reach} {i}");
                }
                // Both together at the least as large as each.
                let both = share(Some(0), one);
                assert!(both >= share(Some(0), [0.0; 3]) + amount * amount / eta * (1.0 - 1e-12), "{part} {reach}");
            }
        }
    }

    /// [least -e; -e eta] is the worst of all: by Cramer's rule.
    #[test]
    fn what_is_eliminated_is_that_of_the_worst_matrix() {
        for (p, q, least, eta) in
            [(1.0, 1.0, 1.0, 1.0), (3.0, 0.25, 0.5, 7.0), (0.0, 2.0, 5.0, 0.125), (2.0, 0.0, 0.25, 3.0)]
        {
            for share in [0.0, 0.25, 0.9, 0.99, 1.0, 1.5] {
                let e = share * f64::sqrt(least * eta);
                let found = bound_of_both_parts([p, q], [least, eta], e);
                let determinant = least * eta - e * e;
                if share >= 1.0 {
                    assert_eq!(found, None, "{p} {q} {least} {eta} {share}");
                    continue;
                }
                let truth = (p * p * eta + 2.0 * p * q * e + q * q * least) / determinant;
                let found = found.expect("regular");
                let over = found / truth;
                assert!((1.0..1.0 + 1e-6).contains(&over), "{p} {q} {least} {eta} {share}: {found} {truth}");
            }
        }
        assert_eq!(bound_of_both_parts([1.0, 1.0], [1.0, -1.0], 0.5), None);
        assert_eq!(bound_of_both_parts([1.0, 1.0], [-1.0, 1.0], 0.5), None);
    }

    /// f(w) = rho + d w + m w^2 + b with all of them as far off as they may be: the root is in the disc.
    #[test]
    fn a_circle_holds_the_root_of_the_worst_polynomial() {
        let system = forty_masses();
        let (large, list, pair) = followed_pair(&system);
        let frame = large.frame(&list, 8).expect("a gap");
        let s = pair.s.to_f64();
        let d = Complex::new(0.6, 0.8).scale(s.im);
        let eta = frame.stiffness(frame.top, s, 0.0);
        let (unit, mut tightest) = (1e-6 * s.im * s.im, 0.0f64);
        for which in 0..6 {
            // rho, what it is uncertain by, d's error, m and b: one, and what makes it matter.
            let only = |k: usize, x: f64| if which == k || which == 5 { x } else { 0.0 };
            let rho = Complex::new(0.8, -0.6).scale(if which == 1 { 0.0 } else { unit });
            let doubt = only(1, unit);
            let error = only(2, 1e-3 * d.abs());
            let inertia = only(3, 0.05 * d.abs() * d.abs() / unit);
            let b = only(4, 0.01 * unit);
            let star = Star { along: vec![[0.0; 3]; frame.x.len()], outside: [(b * eta).sqrt(), 0.0, 0.0] };
            let slope = Slope { value: d, error, inertia };
            let found = Found { frame: &frame, pair: &pair, s, slope, star, from: 2 };
            let of = |x: f64| precise(x, doubt);
            let Some(disc) = found.circle(frame.top, [of(rho.re), of(rho.im)]) else { panic!("{which}") };
            for turn in 0..4096u32 {
                let phase = |digit: u32| {
                    let angle = f64::from(turn >> (3 * digit) & 7) * 0.25 * std::f64::consts::PI;
                    Complex::new(angle.cos(), angle.sin())
                };
                let constant = rho + phase(0).scale(doubt) + phase(1).scale(b);
                let (d, m) = (d + phase(2).scale(error), phase(3).scale(inertia));
                // Newton's method from the linear root.
                let mut w = -(constant * d.recip());
                for _ in 0..30 {
                    w = w - (constant + d * w + m * w * w) * (d + (m * w).scale(2.0)).recip();
                }
                let off = [disc.s.re, disc.s.im].map(|part| part.mid);
                let centre = Complex::new((off[0] - pair.s.re).to_f64(), (off[1] - pair.s.im).to_f64());
                let off = (w - centre).abs();
                assert!(
                    off <= disc.s.re.rad.min(disc.s.im.rad) + 1e-14 * w.abs(),
                    "{which} {turn}: {off:e} {:e}",
                    disc.s.re.rad
                );
                if which == 5 {
                    tightest = tightest.max(off / disc.s.re.rad);
                }
            }
        }
        assert!(tightest > 0.2, "{tightest}");
    }

    /// X_i^T r, X_i^T Q'(s_0) x and X_i^T M x, added up over the terms: no bound is less, and that of the own mode is hardly more. A
    /// residual that is not known is as large as it may be.
    #[test]
    fn what_joins_a_pair_to_the_modes_is_bounded() {
        let system = forty_masses();
        let (large, list, pair) = followed_pair(&system);
        let frame = large.frame(&list, 8).expect("a gap");
        let (pencil, s) = (&large.exact, pair.s.to_f64());
        let mut applied = pencil.apply(pair.s, &pair.x);
        let star =
            |applied: &Application<Precise>| Star::of(&frame, pencil, &pair, applied, 1e-6).expect("finite").along;
        let known = star(&applied);
        for (i, (x, bounds)) in frame.x.iter().zip(&known).enumerate() {
            let product = |squares: &Squares<Precise>, stretches: &[Complex<Precise>]| {
                stretches.iter().enumerate().fold(Complex::ZERO, |sum, (t, stretch)| {
                    let (indices, values) = squares.row(t);
                    let own: f64 = indices.iter().zip(values).map(|(&i, a)| a.value.hi() * x[i as usize]).sum();
                    sum + stretch.to_f64().scale(own * squares.weights[t].value.hi())
                })
            };
            let inertia = product(&pencil.m, &applied.m_stretch);
            let slope = (s * inertia).scale(2.0) + product(&pencil.c, &applied.c_stretch);
            let [_, of_slope, of_inertia] = bounds;
            assert!(*of_inertia >= inertia.abs() * (1.0 - 1e-12), "{i}: {bounds:?}");
            assert!(*of_slope >= slope.abs() * (1.0 - 1e-12), "{i}: {bounds:?}");
            if i == 2 {
                assert!(*of_inertia <= 1.01 * inertia.abs() && *of_slope <= 1.5 * slope.abs(), "{bounds:?} {slope:?}");
            }
        }
        applied.force.iter_mut().for_each(|force| force.re.radius += 1e-3);
        for (x, [of_force, ..]) in frame.x.iter().zip(star(&applied)) {
            assert!(of_force >= 1e-3 * x.iter().map(|x| x.abs()).sum::<f64>());
        }
    }
}
