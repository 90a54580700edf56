//! Eigenvalues of diag(D) - t B (1 + t G)^-1 W^T for many t side by side, one in each lane, with proved bounds of their errors; B and W
//! have R columns. In: the D_j, real ones and conjugate pairs, B, W and G, and bounds of what the true matrix has besides. Out: for each
//! t all eigenvalues, from
//!
//!   F(s) = det H(s),  H(s) = 1 + t (G + sum_j w_j b_j^T / (s - D_j)),
//!
//! an R x R determinant. See docs/method/studies.md#a-few-weights-and-all-poles.

use crate::base::Dd;
use crate::kernel::complex::Complex;
use crate::kernel::rank_one::{
    Cases, Changed, Differences, Eigenvalue, Equation, Factor, Found, Inverse, Look, NEAREST, Root, STEPS, Stretch, U,
    USUAL, holds, inverse, length, on_stretch, quotient, square_above, times,
};
use crate::kernel::simd::{Vector, simd};

/// R from 2 to [`MOST`].
pub type LowRank<const R: usize> = Changed<Terms<R>>;

/// The largest R.
pub const MOST: usize = 4;

/// The matrices of a change, with a column for each row that it weighs.
#[derive(Clone, Debug)]
pub struct Columns {
    /// The D_j, one of each conjugate pair.
    pub poles: Vec<Complex<Dd>>,
    pub b: Vec<Vec<Complex<Dd>>>,
    pub w: Vec<Vec<Complex<Dd>>>,
    /// G, whose rows are those of W^T.
    pub direct: Vec<Vec<Dd>>,
    pub off: Off,
}

/// Bounds of what the true matrices have besides. The 2-norm of all that the matrix has besides is at most `always` + t p `once` +
/// t^2 p^2 `twice`, with the bound p = 1 + `growth` |t| of the norm of (1 + t G)^-1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Off {
    pub always: f64,
    pub once: f64,
    pub twice: f64,
    pub growth: f64,
    /// The largest |t| for which p is proved.
    pub reach: f64,
    /// A bound of the norm of what the true G has besides.
    pub direct: f64,
}

/// The sums in H.
#[derive(Clone, Debug)]
pub struct Terms<const R: usize> {
    poles: Vec<Complex<Dd>>,
    off: Off,
    /// Entries of w_j b_j^T, each within 4 U of its size, and upper bounds of their sizes.
    products: Vec<[[Complex<f64>; R]; R]>,
    sizes: Vec<[[f64; R]; R]>,
    /// Upper bounds of the squares of the lengths of b_j and w_j.
    squares: [Vec<f64>; 2],
    direct: [[f64; R]; R],
}

/// What t p times the error of G may be: then p with one more percent is a bound for the G that is known, too.
const SMALL: f64 = 1e-3;

impl<const R: usize> LowRank<R> {
    /// For the factors from zero to `end`, or to where a bound is proved; `None` if numbers have no usual size, or there are not `R` columns.
    pub fn new(of: &Columns, end: f64) -> Option<LowRank<R>> {
        let mut terms = Terms {
            poles: Vec::new(),
            off: of.off,
            products: Vec::new(),
            sizes: Vec::new(),
            squares: Default::default(),
            direct: [[0.0; R]; R],
        };
        let is_square = |list: &[Vec<Dd>]| list.len() == R && list.iter().all(|row| row.len() == R);
        if of.b.len() != R || of.w.len() != R || !is_square(&of.direct) {
            return None;
        }
        for (row, known) in terms.direct.iter_mut().zip(&of.direct) {
            row.iter_mut().zip(known).for_each(|(g, known)| *g = known.to_f64());
        }
        for (j, s) in of.poles.iter().enumerate() {
            let column = |list: &[Vec<Complex<Dd>>]| std::array::from_fn(|i| list[i][j]);
            let (b, w): ([Complex<Dd>; R], [Complex<Dd>; R]) = (column(&of.b), column(&of.w));
            terms.push(*s, &b, &w);
            if !s.im.is_zero() {
                terms.push(s.conj(), &b.map(Complex::conj), &w.map(Complex::conj));
            }
        }
        let end = if end.abs() > of.off.reach { of.off.reach.copysign(end) } else { end };
        let is_small = |x: &f64| *x < USUAL.end;
        let off = [of.off.always, of.off.once, of.off.twice, of.off.growth];
        let fits =
            terms.sizes.iter().flatten().flatten().chain(terms.squares.iter().flatten()).chain(&off).all(is_small)
                && terms.direct.iter().flatten().all(|g| g.abs() < USUAL.end)
                && of.poles.iter().all(|pole| USUAL.contains(&pole.to_f64().one_norm()))
                && end.abs() * (1.0 + of.off.growth * end.abs()) * of.off.direct < SMALL;
        if fits { Changed::along(terms, end) } else { None }
    }
}

impl<const R: usize> Terms<R> {
    fn push(&mut self, s: Complex<Dd>, b: &[Complex<Dd>; R], w: &[Complex<Dd>; R]) {
        let [of_b, of_w] = [b, w].map(|list| list.map(square_above));
        self.poles.push(s);
        self.products.push(w.map(|w| b.map(|b| (w * b).to_f64())));
        self.sizes.push(of_w.map(|w| of_b.map(|b| w.sqrt() * b.sqrt() * (1.0 + 4.0 * U))));
        for (list, squares) in self.squares.iter_mut().zip([of_b, of_w]) {
            list.push(squares.iter().sum::<f64>() * (1.0 + 8.0 * U));
        }
    }
}

/// A matrix of R rows.
type Square<T, const R: usize> = [[T; R]; R];

/// H and its derivative.
struct Value<V, const R: usize> {
    h: Square<[V; 2], R>,
    slope: Square<[V; 2], R>,
}

/// What bounds are made of.
struct Sizes<V, const R: usize> {
    /// The entries of 1 + |t| (|G| + sum |w_j b_j^T| / |s - D_j|), and |t| sum |w_j b_j^T| / |s - D_j|^2.
    of: Square<V, R>,
    slopes: Square<V, R>,
    /// sum |b_j|^2 / |s - D_j|^2, and with w_j.
    squares: [V; 2],
    /// The squares of the inverse distances from the nearest of all poles and of those that are not the origin.
    nearest: V,
    nearest_other: V,
}

/// 1 / (s - D_j) of all poles.
#[inline(always)]
fn pass<V: Vector>(from: &Differences, count: usize, tau: [V; 2], room: &mut Vec<Inverse<V>>) {
    room.clear();
    for j in 0..count {
        let (q, size) = inverse(from, j, tau);
        let square = [q[0].mul_add(q[0], -(q[1] * q[1])), V::splat(2.0) * (q[0] * q[1])];
        room.push(Inverse { q, square, parts: q[0].abs() + q[1].abs(), size });
    }
}

#[inline(always)]
fn one_at<V: Vector>(i: usize, k: usize) -> V {
    V::splat(if i == k { 1.0 } else { 0.0 })
}

#[inline(always)]
fn value<V: Vector, const R: usize>(terms: &Terms<R>, at: &[Inverse<V>], t: V) -> Value<V, R> {
    let zero = V::splat(0.0);
    let mut of = Value { h: [[[zero; 2]; R]; R], slope: [[[zero; 2]; R]; R] };
    for i in 0..R {
        for k in 0..R {
            let (mut sum, mut slope) = ([zero; 2], [zero; 2]);
            for (products, at) in terms.products.iter().zip(at) {
                let c = [V::splat(products[i][k].re), V::splat(products[i][k].im)];
                let add = |q: [V; 2], to: [V; 2]| {
                    [c[0].mul_add(q[0], c[1].mul_add(-q[1], to[0])), c[0].mul_add(q[1], c[1].mul_add(q[0], to[1]))]
                };
                sum = add(at.q, sum);
                slope = add(at.square, slope);
            }
            of.h[i][k] = [t.mul_add(V::splat(terms.direct[i][k]) + sum[0], one_at(i, k)), t * sum[1]];
            of.slope[i][k] = [-(t * slope[0]), -(t * slope[1])];
        }
    }
    of
}

#[inline(always)]
fn sizes<V: Vector, const R: usize>(terms: &Terms<R>, from: &Differences, at: &[Inverse<V>], t: V) -> Sizes<V, R> {
    let zero = V::splat(0.0);
    let mut of =
        Sizes { of: [[zero; R]; R], slopes: [[zero; R]; R], squares: [zero; 2], nearest: zero, nearest_other: zero };
    for (j, at) in at.iter().enumerate() {
        of.squares[0] = V::splat(terms.squares[0][j]).mul_add(at.size, of.squares[0]);
        of.squares[1] = V::splat(terms.squares[1][j]).mul_add(at.size, of.squares[1]);
        // `max` takes its second operand where one is NaN, as at a pole itself.
        of.nearest = of.nearest.max(at.size);
        of.nearest_other = of.nearest_other.max(at.size * V::splat(from.others[j]));
    }
    for i in 0..R {
        for k in 0..R {
            let (mut sum, mut slope) = (V::splat(terms.direct[i][k].abs()), zero);
            for (sizes, at) in terms.sizes.iter().zip(at) {
                let size = V::splat(sizes[i][k]);
                sum = size.mul_add(at.parts, sum);
                slope = size.mul_add(at.size, slope);
            }
            of.of[i][k] = t.abs().mul_add(sum, one_at(i, k));
            of.slopes[i][k] = t.abs() * slope;
        }
    }
    of
}

/// The numbers of a determinant, or their sizes: then nothing is subtracted, and the determinant is a permanent, which is no smaller than
/// the size of one.
trait Number: Copy {
    fn plus(self, b: Self) -> Self;
    fn minus(self, b: Self) -> Self;
    fn product(self, b: Self) -> Self;
    fn negative(self) -> Self;
}

/// A complex number.
impl<V: Vector> Number for [V; 2] {
    #[inline(always)]
    fn plus(self, b: [V; 2]) -> [V; 2] {
        [self[0] + b[0], self[1] + b[1]]
    }

    #[inline(always)]
    fn minus(self, b: [V; 2]) -> [V; 2] {
        [self[0] - b[0], self[1] - b[1]]
    }

    #[inline(always)]
    fn product(self, b: [V; 2]) -> [V; 2] {
        times(self, b)
    }

    #[inline(always)]
    fn negative(self) -> [V; 2] {
        [-self[0], -self[1]]
    }
}

/// The size of a number.
#[derive(Clone, Copy)]
struct Size<V>(V);

impl<V: Vector> Number for Size<V> {
    #[inline(always)]
    fn plus(self, b: Size<V>) -> Size<V> {
        Size(self.0 + b.0)
    }

    #[inline(always)]
    fn minus(self, b: Size<V>) -> Size<V> {
        Size(self.0 + b.0)
    }

    #[inline(always)]
    fn product(self, b: Size<V>) -> Size<V> {
        Size(self.0 * b.0)
    }

    #[inline(always)]
    fn negative(self) -> Size<V> {
        self
    }
}

/// The cofactor of each entry, R from 2 to 4.
#[inline(always)]
fn cofactors<T: Number, const R: usize>(a: &Square<T, R>) -> Square<T, R> {
    let mut of = *a;
    for i in 0..R {
        for k in 0..R {
            // The other rows and columns in cyclic order, which of three is an even permutation of the ascending one.
            let at = |row: usize, column: usize| a[(i + row) % R][(k + column) % R];
            let minor = |rows: [usize; 2], [c, d]: [usize; 2]| {
                at(rows[0], c).product(at(rows[1], d)).minus(at(rows[0], d).product(at(rows[1], c)))
            };
            let one = match R {
                2 => at(1, 1),
                3 => minor([1, 2], [1, 2]),
                _ => {
                    let of_column = |c: usize, others: [usize; 2]| at(1, c).product(minor([2, 3], others));
                    of_column(1, [2, 3]).plus(of_column(2, [3, 1])).plus(of_column(3, [1, 2]))
                }
            };
            // Of three rows and columns the cyclic order has the sign in it.
            of[i][k] = if R != 3 && (i + k) % 2 == 1 { one.negative() } else { one };
        }
    }
    of
}

/// The sum of the products of the entries of two matrices.
#[inline(always)]
fn sum_of_products<T: Number, const R: usize>(a: &Square<T, R>, b: &Square<T, R>) -> T {
    let mut sum = row_product(&a[0], &b[0]);
    for i in 1..R {
        sum = sum.plus(row_product(&a[i], &b[i]));
    }
    sum
}

#[inline(always)]
fn row_product<T: Number, const R: usize>(a: &[T; R], b: &[T; R]) -> T {
    let mut sum = a[0].product(b[0]);
    for k in 1..R {
        sum = sum.plus(a[k].product(b[k]));
    }
    sum
}

/// F with its derivative, and the sum of the diagonal of the adjugate of H.
#[inline(always)]
fn determinant<V: Vector, const R: usize>(of: &Value<V, R>) -> [[V; 2]; 3] {
    let cofactors = cofactors(&of.h);
    let mut diagonal = cofactors[0][0];
    for (i, row) in cofactors.iter().enumerate().skip(1) {
        diagonal = diagonal.plus(row[i]);
    }
    [row_product(&of.h[0], &cofactors[0]), sum_of_products(&of.slope, &cofactors), diagonal]
}

/// Permanents in the place of determinants: of the sizes, of their cofactors, and the length of all these.
struct Permanents<V, const R: usize> {
    whole: V,
    cofactors: Square<Size<V>, R>,
    length: V,
}

#[inline(always)]
fn permanents<V: Vector, const R: usize>(of: &Square<V, R>) -> Permanents<V, R> {
    let sizes = with_sizes(of);
    let cofactors = cofactors(&sizes);
    let length = sum_of_products(&cofactors, &cofactors).0.sqrt();
    Permanents { whole: row_product(&sizes[0], &cofactors[0]).0, cofactors, length }
}

#[inline(always)]
fn with_sizes<V: Vector, const R: usize>(of: &Square<V, R>) -> Square<Size<V>, R> {
    let mut sizes = [[Size(of[0][0]); R]; R];
    for i in 0..R {
        for k in 0..R {
            sizes[i][k] = Size(of[i][k]);
        }
    }
    sizes
}

impl<const R: usize> Equation for Terms<R> {
    fn poles(&self) -> &[Complex<Dd>] {
        &self.poles
    }

    fn departure(&self, pole: usize) -> Complex<f64> {
        (0..R).fold(Complex::ZERO, |sum, i| sum - self.products[pole][i][i])
    }

    fn pull(&self, pole: usize) -> f64 {
        self.sizes[pole].iter().flatten().sum()
    }

    fn look(&self, from: &Differences, tau: [f64; 2], rho: f64) -> Look {
        look(self, from, tau, rho)
    }

    // See docs/method/studies.md#a-few-weights-and-all-poles for this and the numbers below.
    #[inline(always)]
    fn rounding(&self) -> f64 {
        (3.0 * self.poles.len() as f64 + 64.0) * U
    }

    #[inline(always)]
    fn eta<V: Vector>(&self, rho: V) -> V {
        let Off { always, once, twice, growth, .. } = self.off;
        let t = rho.abs();
        // With the percent for the inverse that is known.
        let p = t * t.mul_add(V::splat(growth), V::splat(1.0)) * V::splat(1.02);
        p.mul_add(p.mul_add(V::splat(twice), V::splat(once)), V::splat(always))
    }

    #[inline(always)]
    fn moving<V: Vector>(
        &self,
        from: &Differences,
        root: &Root,
        start: [V; 2],
        of: &Cases<V>,
        room: &mut Vec<Inverse<V>>,
    ) -> Found<V> {
        let moves = V::splat(if root.is_real { 0.0 } else { 1.0 });
        let mut tau = start;
        for _ in 0..STEPS {
            pass(from, self.poles.len(), tau, room);
            let [f, slope, _] = determinant(&value(self, room, of.rho));
            let step = quotient(f, slope);
            tau = [tau[0] - step[0], tau[1] - step[1] * moves];
        }
        pass(from, self.poles.len(), tau, room);
        let [f, slope, _] = determinant(&value(self, room, of.rho));
        let sizes = sizes(self, from, room, of.rho);
        let of_sizes = permanents(&sizes.of);
        let slope = length(slope);
        let noise = of.noise * V::splat(R as f64 + 2.0);
        let size = of_sizes.whole.mul_add(noise, length(f));
        let resolvent =
            V::splat(1.03) * (of.rho.abs() * of.eta) * (sizes.squares[0] * sizes.squares[1]).sqrt() * of_sizes.length;
        let radius = V::splat(1.1) * resolvent.mul_add(V::splat(1.1), size) / slope;
        let slopes = sum_of_products(&with_sizes(&sizes.slopes), &of_sizes.cofactors).0;
        let curved = V::splat(4.1 * power_of_two(R)) * of_sizes.whole * sizes.nearest;
        let is_proved = holds(noise * slopes, slope * V::splat(0.005))
            * holds(radius * radius * sizes.nearest, V::splat(8e-5))
            * holds(of.eta * of.eta * sizes.nearest, V::splat(0.008))
            * holds(radius * curved, slope * V::splat(0.009))
            * holds(sizes.nearest_other * V::splat(NEAREST * NEAREST * from.farthest), V::splat(1.0));
        Found { tau, radius, is_proved }
    }

    #[inline(always)]
    fn staying<V: Vector>(
        &self,
        from: &Differences,
        root: &Root,
        of: &Cases<V>,
        room: &mut Vec<Inverse<V>>,
    ) -> Found<V> {
        let tau = [V::splat(0.0); 2];
        pass(from, self.poles.len(), tau, room);
        let [f, ..] = determinant(&value(self, room, of.rho));
        let sizes = sizes(self, from, room, of.rho);
        let of_sizes = permanents(&sizes.of);
        let f = length(f);
        // The term of the pole, times its distance.
        let mut term = sizes.of;
        for (row, sizes) in term.iter_mut().zip(&self.sizes[root.pole]) {
            for (term, size) in row.iter_mut().zip(sizes) {
                *term = of.rho.abs() * V::splat(*size);
            }
        }
        let own = sum_of_products(&with_sizes(&term), &of_sizes.cofactors).0;
        let size = root.origin.to_f64().one_norm();
        let radius = own.mul_add(V::splat(8.0) / f, of.eta.mul_add(V::splat(4.0), V::splat(1e-20 * size)));
        let off = of_sizes.whole * of.noise * V::splat(R as f64 + 2.0);
        let curved = V::splat(2.1 * power_of_two(R)) * of_sizes.whole * sizes.nearest.sqrt();
        // On the circle, with the term of the pole.
        let mut with_term = term;
        for i in 0..R {
            for k in 0..R {
                with_term[i][k] = sizes.of[i][k].mul_add(V::splat(1.01), term[i][k] / radius);
            }
        }
        let inverse = V::splat(1.0) / (radius * radius);
        let square = |which: usize| {
            V::splat(self.squares[which][root.pole]).mul_add(inverse, sizes.squares[which] * V::splat(1.03))
        };
        let resolvent = of.rho.abs() * of.eta * square(0).sqrt() * square(1).sqrt() * permanents(&with_term).length;
        let is_proved = holds(radius * radius * sizes.nearest, V::splat(8e-5))
            * holds(radius.mul_add(curved, off), f * V::splat(0.5))
            * holds(own * V::splat(7.9), radius * f)
            * holds(resolvent, f * V::splat(0.25));
        Found { tau, radius, is_proved }
    }

    fn follow(of: &LowRank<R>, stretch: &Stretch, factors: &[Factor], found: &mut [Eigenvalue]) {
        of_few(of, stretch, factors, found);
    }
}

const fn power_of_two(exponent: usize) -> f64 {
    (1u64 << exponent) as f64
}

simd! {
    fn of_few<V: Vector, const R: usize>(of: &LowRank<R>, stretch: &Stretch, factors: &[Factor], found: &mut [Eigenvalue]) {
        on_stretch::<V, Terms<R>>(of, stretch, factors, found);
    }
}

simd! {
    fn look<const R: usize>(terms: &Terms<R>, from: &Differences, tau: [f64; 2], t: f64) -> Look {
        let mut room = Vec::with_capacity(terms.poles.len());
        pass(from, terms.poles.len(), tau, &mut room);
        let [f, slope, diagonal] = determinant(&value(terms, &room, t));
        // At an eigenvalue t dF/dt is less the sum of the diagonal.
        let [re, im] = quotient(diagonal, [slope[0] * t, slope[1] * t]);
        let nearest = room.iter().fold(0.0f64, |most, at| most.max(at.size));
        Look { step: complex(quotient(f, slope)), slope: Complex::new(re, im), nearest }
    }
}

#[inline(always)]
fn complex([re, im]: [f64; 2]) -> Complex<f64> {
    Complex::new(re, im)
}

#[cfg(test)]
mod tests;
