//! Q(s) = M s^2 + C s + K of an independent part, applied to a vector from its terms: each term stretches x first
//! (t = a . x) and pushes back along its row (r += w z t a, z = s^2, s or 1), so a stiff spring that is hardly stretched
//! adds hardly anything, and no rounding of an assembled matrix. Clause: spec.md 11.5.

use super::complex::Complex;
use super::parts::Part;
use super::squares::Squares;
use crate::base::{Ball, Dd};
use crate::system::LinearSystem;

/// The three forms of a part as balls, in the part's own numbering.
#[derive(Clone, Debug)]
pub struct Pencil {
    pub n: usize,
    pub m: Squares,
    pub c: Squares,
    pub k: Squares,
}

/// A complex vector, exactly known; a real one has no imaginary part stored.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    pub re: Vec<Dd>,
    pub im: Vec<Dd>,
}

/// Q(s) x with what was met on the way.
#[derive(Clone, Debug)]
pub struct Application {
    /// Q(s) x
    pub force: Vec<Complex<Ball>>,
    /// x^T Q(s) x, term by term
    pub energy: Complex<Ball>,
    /// a . x of the terms of M, of C and of K
    pub m_stretch: Vec<Complex<Ball>>,
    pub c_stretch: Vec<Complex<Ball>>,
    pub k_stretch: Vec<Complex<Ball>>,
}

impl Pencil {
    /// The part's forms; the whole system's where the part is all of it.
    pub fn of(system: &LinearSystem, part: &Part, local: &[u32]) -> Pencil {
        Pencil {
            n: part.coordinates.len(),
            m: Squares::chosen(&system.m, &part.m, local),
            c: Squares::chosen(&system.c, &part.c, local),
            k: Squares::chosen(&system.k, &part.k, local),
        }
    }

    /// Q(s) x.
    pub fn apply(&self, s: Complex<Dd>, x: &Vector) -> Application {
        let s = s.to_ball();
        let mut result = Application {
            force: vec![Complex::ZERO; self.n],
            energy: Complex::ZERO,
            m_stretch: Vec::with_capacity(self.m.len()),
            c_stretch: Vec::with_capacity(self.c.len()),
            k_stretch: Vec::with_capacity(self.k.len()),
        };
        let (force, energy) = (&mut result.force, &mut result.energy);
        push(&self.m, s * s, x, force, energy, |t| result.m_stretch.push(t));
        push(&self.c, s, x, force, energy, |t| result.c_stretch.push(t));
        push(&self.k, Complex::real(Ball::ONE), x, force, energy, |t| result.k_stretch.push(t));
        result
    }

    /// x^T (2 s M + C) x in binary64, from the stretches.
    pub fn slope(&self, s: Complex<f64>, applied: &Application) -> Complex<f64> {
        s.scale(2.0) * square(&self.m, &applied.m_stretch) + square(&self.c, &applied.c_stretch)
    }
}

/// sum w t^2
fn square(squares: &Squares, stretches: &[Complex<Ball>]) -> Complex<f64> {
    squares.weights.iter().zip(stretches).fold(Complex::ZERO, |sum, (w, t)| {
        let t = t.mid().to_f64();
        sum + (t * t).scale(w.to_f64())
    })
}

/// Adds z (sum w a a^T) x to the force and z sum w (a . x)^2 to the energy.
fn push(
    squares: &Squares,
    z: Complex<Ball>,
    x: &Vector,
    force: &mut [Complex<Ball>],
    energy: &mut Complex<Ball>,
    mut keep: impl FnMut(Complex<Ball>),
) {
    for t in 0..squares.len() {
        let stretch = stretch(squares, t, x);
        keep(stretch);
        let tension = z * stretch.scale(squares.weights[t]);
        *energy = *energy + tension * stretch;
        let (indices, values) = squares.row(t);
        for (&i, &a) in indices.iter().zip(values) {
            let entry = &mut force[i as usize];
            *entry = *entry + by_factor(tension, a);
        }
    }
}

/// a . x of term t.
pub fn stretch(squares: &Squares, t: usize, x: &Vector) -> Complex<Ball> {
    let im = if x.im.is_empty() { Ball::ZERO } else { squares.stretch(t, &x.im) };
    Complex::new(squares.stretch(t, &x.re), im)
}

/// Most factors are 1 or -1: those round nothing.
#[inline]
fn by_factor(z: Complex<Ball>, a: Ball) -> Complex<Ball> {
    if a == Ball::ONE {
        z
    } else if a == -Ball::ONE {
        -z
    } else {
        z.scale(a)
    }
}

impl Vector {
    pub fn zeros(n: usize, real: bool) -> Vector {
        Vector { re: vec![Dd::ZERO; n], im: if real { Vec::new() } else { vec![Dd::ZERO; n] } }
    }

    pub fn is_real(&self) -> bool {
        self.im.is_empty()
    }

    pub fn entry(&self, i: usize) -> Complex<Dd> {
        Complex::new(self.re[i], self.im.get(i).copied().unwrap_or(Dd::ZERO))
    }

    /// x_i <- x_i + z
    pub fn add(&mut self, i: usize, z: Complex<f64>) {
        self.re[i] += Dd::from(z.re);
        if let Some(im) = self.im.get_mut(i) {
            *im += Dd::from(z.im);
        }
    }
}
