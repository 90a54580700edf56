//! An independent part of the system, w' = A w + B u, y = C w, with its relation to the model's own coordinates. In: A,
//! the factors of u, u' and u'', and the rows that read w and w'. Out: the same motion without derivatives of u (w = xi
//! + E0 u + E1 u'). See docs/method/emit.md.

use crate::base::Dd;
use crate::kernel::dense::Matrix;
use crate::system::LinearSystem;

/// An independent group of states.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its name in the header: `mode 2, 3.1 Hz`.
    pub name: String,
    /// |s| of its fastest pole, rad/s: the highest frequency at which the block may ring.
    pub rate: f64,
    pub a: Matrix<Dd>,
    /// One column for each input.
    pub b: Matrix<Dd>,
    /// One row for each output.
    pub c: Matrix<Dd>,
    /// The states from displacements and velocities of all coordinates: one row for each state, 2n columns.
    pub to: Matrix<Dd>,
    /// Displacements and velocities of all coordinates from the states: 2n rows.
    pub back: Matrix<Dd>,
}

/// Direct effects of inputs, without a state in between.
#[derive(Clone, Debug)]
pub struct Direct {
    /// Factors of u, u' and u'' in every output: one row for each output, one column for each input.
    pub outputs: [Matrix<Dd>; 3],
    /// Factors of u and u' in displacements and velocities of all coordinates: 2n rows.
    pub state: [Matrix<Dd>; 2],
}

impl Direct {
    pub fn none(n: usize, inputs: usize, outputs: usize) -> Direct {
        Direct {
            outputs: [0; 3].map(|_| Matrix::zeros(outputs, inputs)),
            state: [0; 2].map(|_| Matrix::zeros(2 * n, inputs)),
        }
    }

    /// Whether any direct effect uses u, u' and u'' of an input.
    pub fn used_orders(&self, input: usize) -> [bool; 3] {
        let any = |m: &Matrix<Dd>| m.column(input).iter().any(|x| !x.is_zero());
        [0, 1, 2].map(|p| any(&self.outputs[p]) || self.state.get(p).is_some_and(any))
    }
}

/// The parts of a continuous system.
#[derive(Clone, Debug)]
pub struct Split {
    pub blocks: Vec<Block>,
    pub direct: Direct,
    /// The method by which the blocks were found, for the header.
    pub method: &'static str,
}

impl Split {
    /// Whether an input has any effect.
    pub fn has_effect(&self, input: usize) -> bool {
        let column = |m: &Matrix<Dd>| m.column(input).iter().any(|x| !x.is_zero());
        self.blocks.iter().any(|block| column(&block.b)) || self.direct.outputs.iter().any(column)
    }
}

/// Eliminates derivatives: for w' = A w + B0 u + B1 u' + B2 u'' and w = xi + (B1 + A B2) u + B2 u', returns the B of
/// xi' = A xi + B u and the two offsets.
pub fn without_derivatives(a: &Matrix<Dd>, b: [Matrix<Dd>; 3]) -> (Matrix<Dd>, [Matrix<Dd>; 2]) {
    let [b0, b1, b2] = b;
    let offset = sum(&b1, &product(a, &b2));
    (sum(&b0, &product(a, &offset)), [offset, b2])
}

pub fn product(a: &Matrix<Dd>, b: &Matrix<Dd>) -> Matrix<Dd> {
    let mut c = Matrix::zeros(a.rows(), b.columns());
    for j in 0..b.columns() {
        for (k, &factor) in b.column(j).iter().enumerate() {
            if !factor.is_zero() {
                crate::kernel::dense::add_scaled(c.column_mut(j), factor, a.column(k));
            }
        }
    }
    c
}

/// Entries smaller than this share of the sum of their terms' magnitudes are rounding errors of zero.
pub const NOTHING: f64 = 1e-24;

/// A B, with exact zeros if terms cancel to rounding errors.
pub fn clean_product(a: &Matrix<Dd>, b: &Matrix<Dd>) -> Matrix<Dd> {
    let mut all = Matrix::zeros(a.rows(), b.columns());
    for j in 0..b.columns() {
        let factors = b.column(j);
        for i in 0..a.rows() {
            let (mut sum, mut size) = (Dd::ZERO, 0.0);
            for (k, &factor) in factors.iter().enumerate() {
                // Half of the factors between a mode and the coordinates are zero.
                let other = a[(i, k)];
                if !factor.is_zero() && !other.is_zero() {
                    let term = other * factor;
                    sum = if size == 0.0 { term } else { sum + term };
                    size += term.hi.abs();
                }
            }
            all[(i, j)] = if sum.hi.abs() <= NOTHING * size { Dd::ZERO } else { sum };
        }
    }
    all
}

pub fn sum(a: &Matrix<Dd>, b: &Matrix<Dd>) -> Matrix<Dd> {
    Matrix::from_fn(a.rows(), a.columns(), |i, j| a[(i, j)] + b[(i, j)])
}

/// a <- a + b
pub fn add(a: &mut Matrix<Dd>, b: &Matrix<Dd>) {
    for j in 0..a.columns() {
        for (x, &y) in a.column_mut(j).iter_mut().zip(b.column(j)) {
            *x += y;
        }
    }
}

/// Direct effects as sums over the blocks, which cancel if there are no direct effects.
pub struct DirectSums {
    outputs: [Sum; 3],
    state: [Sum; 2],
}

struct Sum {
    value: Matrix<Dd>,
    /// The sum of the magnitudes.
    size: Matrix<f64>,
}

impl DirectSums {
    pub fn none(system: &LinearSystem) -> DirectSums {
        let (n, inputs, outputs) = (system.n(), system.inputs.len(), system.outputs.len());
        let of = |rows: usize| Sum { value: Matrix::zeros(rows, inputs), size: Matrix::fill_with(rows, inputs, 0.0) };
        DirectSums { outputs: [0; 3].map(|_| of(outputs)), state: [0; 2].map(|_| of(2 * n)) }
    }

    /// Adds the effects of the inputs of a block at once: `at_once` on outputs, by power, and what its states hold of `offsets` of u and
    /// u', which outputs and coordinates see by `c` and `back`.
    pub fn add(&mut self, at_once: &[Matrix<Dd>; 3], offsets: &[Matrix<Dd>; 2], c: &Matrix<Dd>, back: &Matrix<Dd>) {
        self.outputs.iter_mut().zip(at_once).for_each(|(sum, term)| sum.add(term));
        for (power, offset) in offsets.iter().enumerate().filter(|(_, offset)| !is_zero(offset)) {
            self.outputs[power].add(&product(c, offset));
            self.state[power].add(&product(back, offset));
        }
    }

    pub fn add_to(&self, direct: &mut Direct) {
        let sums = self.outputs.iter().chain(&self.state);
        for (sum, matrix) in sums.zip(direct.outputs.iter_mut().chain(&mut direct.state)) {
            add(matrix, &sum.without_rounding());
        }
    }
}

impl Sum {
    fn add(&mut self, term: &Matrix<Dd>) {
        let places = self.value.data_mut().iter_mut().zip(self.size.data_mut());
        for ((value, size), x) in places.zip(term.data()) {
            *value += *x;
            *size += x.hi.abs();
        }
    }

    /// The sums, with exact zeros where terms cancel to rounding errors.
    fn without_rounding(&self) -> Matrix<Dd> {
        Matrix::from_fn(self.value.rows(), self.value.columns(), |i, j| {
            let value = self.value[(i, j)];
            if value.hi.abs() <= NOTHING * self.size[(i, j)] { Dd::ZERO } else { value }
        })
    }
}

fn is_zero(m: &Matrix<Dd>) -> bool {
    m.data().iter().all(|x| x.is_zero())
}

impl Block {
    /// The block in other coordinates s w.
    pub fn transform(&self, s: &Matrix<Dd>, inverse: &Matrix<Dd>) -> Block {
        Block {
            name: self.name.clone(),
            rate: self.rate,
            a: product(s, &product(&self.a, inverse)),
            b: clean_product(s, &self.b),
            c: clean_product(&self.c, inverse),
            to: clean_product(s, &self.to),
            back: clean_product(&self.back, inverse),
        }
    }

    pub fn size(&self) -> usize {
        self.a.rows()
    }

    /// A single state of a block whose A is diagonal.
    pub fn state(&self, at: usize) -> Block {
        let row = |m: &Matrix<Dd>| Matrix::from_fn(1, m.columns(), |_, j| m[(at, j)]);
        let column = |m: &Matrix<Dd>| Matrix::from_fn(m.rows(), 1, |i, _| m[(i, at)]);
        Block {
            name: self.name.clone(),
            rate: self.a[(at, at)].hi.abs(),
            a: Matrix::fill_with(1, 1, self.a[(at, at)]),
            b: row(&self.b),
            c: column(&self.c),
            to: row(&self.to),
            back: column(&self.back),
        }
    }
}
