//! Q(s) = M s^2 + C s + K of an independent part, applied to a vector term by term: each term first stretches x (t = a
//! . x) and then pushes back along its row (r += w z t a, z = s^2, s or 1). So a stiff spring that is hardly stretched
//! adds hardly any error, and there are no rounding errors of an assembled matrix. Double-double is used to refine,
//! triple words with their radius to prove. See docs/method/poles.md#general-systems.

use crate::analysis::modes::parts::Part;
use crate::base::Dd;
use crate::kernel::complex::Complex;
use crate::kernel::real::Real;
use crate::kernel::simd::simd;
use crate::kernel::squares::{Squares, by_factor};
use crate::kernel::triple::Precise;
use crate::system::{Form, LinearSystem};

/// The three forms of a part, in the part's own numbering.
#[derive(Clone, Debug)]
pub struct Pencil<T> {
    pub n: usize,
    pub m: Squares<T>,
    pub c: Squares<T>,
    pub k: Squares<T>,
}

/// A complex vector, exactly known; a real one has no imaginary part stored.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    pub re: Vec<Dd>,
    pub im: Vec<Dd>,
}

/// Q(s) x and its intermediate results.
#[derive(Clone, Debug)]
pub struct Application<T> {
    /// Q(s) x
    pub force: Vec<Complex<T>>,
    /// x^T Q(s) x, term by term
    pub energy: Complex<T>,
    /// a . x of the terms of M and of C
    pub m_stretch: Vec<Complex<T>>,
    pub c_stretch: Vec<Complex<T>>,
}

impl Pencil<Precise> {
    /// The part's forms.
    pub fn of(system: &LinearSystem, part: &Part, local: &[u32]) -> Pencil<Precise> {
        Pencil {
            n: part.coordinates.len(),
            m: Squares::of_some(&system.m, &part.m, local),
            c: Squares::of_some(&system.c, &part.c, local),
            k: Squares::of_some(&system.k, &part.k, local),
        }
    }

    /// This pencil rounded to double-double.
    pub fn to_dd(&self) -> Pencil<Dd> {
        Pencil { n: self.n, m: self.m.to_dd(), c: self.c.to_dd(), k: self.k.to_dd() }
    }
}

impl Squares<Precise> {
    /// Some terms of a form, by index, with its coordinates renumbered by `local`.
    fn of_some(form: &Form, terms: &[u32], local: &[u32]) -> Squares<Precise> {
        let mut squares = Squares::with_capacity(terms.len());
        for &index in terms {
            let term = form.term(index as usize);
            let row = form.row(term).iter().map(|(i, value)| (local[i.index()], Precise::of(value)));
            squares.push(Precise::of(term.weight), row);
        }
        squares
    }

    fn to_dd(&self) -> Squares<Dd> {
        self.map(|w| w.value.dd(), |a| a.value.dd())
    }
}

/// sum w t^2 in binary64.
fn square<T: Real>(squares: &Squares<T>, stretches: &[Complex<T>]) -> Complex<f64> {
    squares.weights.iter().zip(stretches).fold(Complex::ZERO, |sum, (w, t)| {
        let t = t.to_f64();
        sum + (t * t).scale(w.to_f64())
    })
}

impl Pencil<Dd> {
    /// Q(s) x in double-double.
    pub fn apply(&self, s: Complex<Dd>, x: &Vector) -> Application<Dd> {
        in_double_double(self, s, x)
    }
}

impl Pencil<Precise> {
    /// Q(s) x in triple words with radii.
    pub fn apply(&self, s: Complex<Dd>, x: &Vector) -> Application<Precise> {
        in_triple_words(self, s, x)
    }
}

simd! {
    fn in_double_double(pencil: &Pencil<Dd>, s: Complex<Dd>, x: &Vector) -> Application<Dd> {
        pencil.application(s, x)
    }
}

simd! {
    fn in_triple_words(pencil: &Pencil<Precise>, s: Complex<Dd>, x: &Vector) -> Application<Precise> {
        pencil.application(s, x)
    }
}

impl<T: Real> Pencil<T> {
    #[inline(always)]
    fn application(&self, s: Complex<Dd>, x: &Vector) -> Application<T> {
        let s = Complex::new(T::of_dd(s.re), T::of_dd(s.im));
        let words = |list: &[Dd]| -> Vec<T> { list.iter().map(|&x| T::of_dd(x)).collect() };
        let (re, im) = (words(&x.re), words(&x.im));
        let mut result = Application {
            force: vec![Complex::ZERO; self.n],
            energy: Complex::ZERO,
            m_stretch: stretches(&self.m, &re, &im),
            c_stretch: stretches(&self.c, &re, &im),
        };
        let (force, energy) = (&mut result.force, &mut result.energy);
        // (M s + C) s + K
        push(&self.m, None, &result.m_stretch, force, energy);
        multiply(s, force, energy);
        push(&self.c, None, &result.c_stretch, force, energy);
        multiply(s, force, energy);
        push(&self.k, None, &stretches(&self.k, &re, &im), force, energy);
        result
    }

    /// Turns Q(s) x into Q(z) x, including its energy.
    pub fn shift(&self, applied: &mut Application<T>, from: Complex<T>, to: Complex<T>) {
        let Application { force, energy, m_stretch, c_stretch } = applied;
        push(&self.m, Some(to * to - from * from), m_stretch, force, energy);
        push(&self.c, Some(to - from), c_stretch, force, energy);
    }

    /// (2 s M + C) x
    pub fn slope_force(&self, s: Complex<T>, applied: &Application<T>) -> Vec<Complex<f64>> {
        let (mut force, mut energy) = (vec![Complex::ZERO; self.n], Complex::ZERO);
        push(&self.m, Some(s + s), &applied.m_stretch, &mut force, &mut energy);
        push(&self.c, None, &applied.c_stretch, &mut force, &mut energy);
        force.into_iter().map(Complex::to_f64).collect()
    }

    /// x^T (2 s M + C) x in binary64, from the stretches.
    pub fn slope(&self, s: Complex<f64>, applied: &Application<T>) -> Complex<f64> {
        s.scale(2.0) * square(&self.m, &applied.m_stretch) + square(&self.c, &applied.c_stretch)
    }
}

#[inline(always)]
fn stretches<T: Real>(squares: &Squares<T>, re: &[T], im: &[T]) -> Vec<Complex<T>> {
    let part = |t: usize, x: &[T]| if x.is_empty() { T::ZERO } else { squares.stretch_of(t, x) };
    (0..squares.len()).map(|t| Complex::new(part(t, re), part(t, im))).collect()
}

#[inline(always)]
fn multiply<T: Real>(s: Complex<T>, force: &mut [Complex<T>], energy: &mut Complex<T>) {
    force.iter_mut().for_each(|entry| *entry = *entry * s);
    *energy = *energy * s;
}

/// Adds z (sum w a a^T) x to the force and z sum w (a . x)^2 to the energy; z = 1 if there is none.
#[inline(always)]
fn push<T: Real>(
    squares: &Squares<T>,
    z: Option<Complex<T>>,
    stretches: &[Complex<T>],
    force: &mut [Complex<T>],
    energy: &mut Complex<T>,
) {
    for (t, &stretch) in stretches.iter().enumerate() {
        let mut tension = stretch.scale(squares.weights[t]);
        // w (a . x)^2
        let across = tension.re * stretch.im;
        let square = Complex::new(tension.re * stretch.re - tension.im * stretch.im, across + across);
        match z {
            Some(z) => {
                tension = z * tension;
                *energy = *energy + z * square;
            }
            None => *energy = *energy + square,
        }
        let (indices, values) = squares.row(t);
        for (&i, &a) in indices.iter().zip(values) {
            let entry = &mut force[i as usize];
            *entry = *entry + Complex::new(by_factor(tension.re, a), by_factor(tension.im, a));
        }
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
