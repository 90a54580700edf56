//! Chooses the blocks of a split system that are worth emitting: those that an input (or the initial state) reaches,
//! that an output sees, and that contribute more than the tolerance. In: the blocks, the initial state. Out: fewer
//! blocks, and the reasons. The static part of a dropped block goes into the feed-through. See docs/method/emit.md.

use crate::analysis::discrete::Options;
use crate::analysis::discrete::block::{Block, NOTHING, Split, add, product};
use crate::base::{Dd, OrderBy, Unproven};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;

/// A block that is not emitted.
#[derive(Clone, Debug, PartialEq)]
pub struct DroppedBlock {
    pub name: String,
    pub states: usize,
    pub why: Why,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Why {
    /// No input acts on it, and it starts at rest.
    Unreached,
    /// No output sees it.
    Unseen,
    /// It contributes about this share of any output over the band, the largest at the frequencies that were compared; its
    /// static part is kept.
    Small(Unproven),
}

/// Number of frequencies at which contributions are compared, between 0 and the highest of the band.
const FREQUENCIES: usize = 257;

/// Drops the blocks that are not worth emitting.
pub fn reduce(split: &mut Split, start: &[Dd], options: &Options) -> Vec<DroppedBlock> {
    let mut left = Vec::new();
    if options.unpruned {
        return left;
    }
    // Without inputs the motion depends only on the state, and any state may be set.
    let driven = split.blocks.iter().any(|block| block.b.columns() > 0);
    let mut kept = Vec::with_capacity(split.blocks.len());
    for block in std::mem::take(&mut split.blocks) {
        let why = if driven && is_zero(&block.b) && !starts(&block, start) {
            Some(Why::Unreached)
        } else if is_zero(&block.c) {
            Some(Why::Unseen)
        } else {
            None
        };
        match why {
            Some(why) => left.push(DroppedBlock { name: block.name.clone(), states: block.size(), why }),
            None => kept.push(block),
        }
    }
    split.blocks = kept;
    if let Some(tolerance) = options.tolerance {
        drop_small(split, start, tolerance, std::f64::consts::PI / options.step.to_f64(), &mut left);
    }
    left
}

fn is_zero(m: &Matrix<Dd>) -> bool {
    (0..m.columns()).all(|j| m.column(j).iter().all(|x| x.is_zero()))
}

/// Whether the block contributes to the initial state.
fn starts(block: &Block, start: &[Dd]) -> bool {
    (0..block.size()).any(|i| {
        let (sum, size) = (0..start.len()).fold((Dd::ZERO, 0.0), |(sum, size), j| {
            let term = block.to[(i, j)] * start[j];
            (sum + term, size + term.hi.abs())
        });
        sum.hi.abs() > NOTHING * size
    })
}

/// Drops blocks in ascending order of their contribution, while the sum of the dropped ones stays below the tolerance.
fn drop_small(split: &mut Split, start: &[Dd], tolerance: f64, highest: f64, left: &mut Vec<DroppedBlock>) {
    let frequencies: Vec<f64> = (0..FREQUENCIES).map(|i| highest * i as f64 / (FREQUENCIES - 1) as f64).collect();
    // Peaks are near the poles.
    let rates = split.blocks.iter().map(|block| block.rate).filter(|&rate| rate < highest);
    let frequencies: Vec<f64> = frequencies.into_iter().chain(rates).collect();
    let sizes = whole(split, &frequencies);
    let mut shares: Vec<(f64, usize)> = (split.blocks.iter().enumerate())
        .filter(|(_, block)| !starts(block, start))
        .filter_map(|(i, block)| Some((share(block, &sizes, &frequencies)?, i)))
        .collect();
    shares.order_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut total = 0.0;
    let mut dropped = vec![None; split.blocks.len()];
    for (share, i) in shares {
        if total + share > tolerance {
            break;
        }
        total += share;
        dropped[i] = Some(share);
    }
    let mut kept = Vec::new();
    for (block, dropped) in std::mem::take(&mut split.blocks).into_iter().zip(dropped) {
        match dropped.zip(static_part(&block)) {
            Some((share, gain)) => {
                add(&mut split.direct.outputs[0], &gain);
                left.push(DroppedBlock {
                    name: block.name.clone(),
                    states: block.size(),
                    why: Why::Small(Unproven(share)),
                });
            }
            None => kept.push(block),
        }
    }
    split.blocks = kept;
}

/// The largest |H| of each output and input over the frequencies.
fn whole(split: &Split, frequencies: &[f64]) -> Matrix<f64> {
    let [d0, d1, d2] = &split.direct.outputs;
    let mut sizes = Matrix::fill_with(d0.rows(), d0.columns(), 0.0f64);
    for &w in frequencies {
        let mut sum = Matrix::from_fn(d0.rows(), d0.columns(), |i, j| {
            Complex::new(d0[(i, j)].hi - w * w * d2[(i, j)].hi, w * d1[(i, j)].hi)
        });
        for block in &split.blocks {
            let gain = gain(block, w);
            sum = Matrix::from_fn(sum.rows(), sum.columns(), |i, j| sum[(i, j)] + gain[(i, j)]);
        }
        sizes = Matrix::from_fn(sum.rows(), sum.columns(), |i, j| {
            // At its own frequency an undamped pole is infinite: the neighbouring frequencies are used.
            let size = sum[(i, j)].abs();
            if size.is_finite() { sizes[(i, j)].max(size) } else { sizes[(i, j)] }
        });
    }
    sizes
}

/// The largest |H_block - its static part|, relative to the whole system; `None` if the block has no static part.
fn share(block: &Block, sizes: &Matrix<f64>, frequencies: &[f64]) -> Option<f64> {
    let still = static_part(block)?;
    let mut worst = 0.0f64;
    for &w in frequencies {
        let gain = gain(block, w);
        for j in 0..gain.columns() {
            for i in 0..gain.rows() {
                let moving = gain[(i, j)] - Complex::real(still[(i, j)].hi);
                let share = moving.abs() / sizes[(i, j)];
                // The output is zero: there is nothing to compare with.
                if moving.abs() > 0.0 {
                    worst = if share.is_finite() { worst.max(share) } else { f64::INFINITY };
                }
            }
        }
    }
    Some(worst)
}

/// -C A^-1 B
fn static_part(block: &Block) -> Option<Matrix<Dd>> {
    let exact = |m: &Matrix<Dd>| m.map(crate::base::Ball::exact);
    let x = crate::kernel::dense::enclosure::solve(&exact(&block.a), &exact(&block.b))?;
    Some(product(&block.c, &x.mid()).map(|x| -x))
}

/// C (i w - A)^-1 B in binary64: it only decides which contributions are small.
fn gain(block: &Block, w: f64) -> Matrix<Complex<f64>> {
    let (n, inputs) = (block.size(), block.b.columns());
    let mut rows: Vec<Vec<Complex<f64>>> = (0..n)
        .map(|i| {
            let left = (0..n).map(|j| Complex::new(-block.a[(i, j)].hi, if i == j { w } else { 0.0 }));
            left.chain((0..inputs).map(|j| Complex::real(block.b[(i, j)].hi))).collect()
        })
        .collect();
    for step in 0..n {
        let pivot = (step..n).fold(step, |best, i| if rows[i][step].abs() > rows[best][step].abs() { i } else { best });
        rows.swap(step, pivot);
        let inverse = rows[step][step].recip();
        let top: Vec<Complex<f64>> = rows[step].iter().map(|&x| x * inverse).collect();
        for (i, row) in rows.iter_mut().enumerate() {
            if i == step {
                row.copy_from_slice(&top);
            } else {
                let factor = row[step];
                row.iter_mut().zip(&top).for_each(|(x, &y)| *x = *x - factor * y);
            }
        }
    }
    Matrix::from_fn(block.c.rows(), inputs, |i, j| {
        (0..n).fold(Complex::ZERO, |sum, k| sum + rows[k][n + j].scale(block.c[(i, k)].hi))
    })
}
