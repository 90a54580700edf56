//! The loops over samples: eight steps of every oscillator, then the outputs at these eight times in parallel. The
//! result does not depend on the vector width of the processor: no lane depends on its neighbours, and an output is
//! summed over the oscillators in their order.

use super::step::Step;
use crate::base::Dd;
use crate::kernel::lanes::{Double, Lanes};
use crate::kernel::simd::{Vector, simd};

/// Number of oscillators, or times, processed in parallel: the number of lanes of the widest vector.
const ROOM: usize = 8;

/// z of every oscillator.
#[derive(Clone, Debug)]
pub struct State {
    pub z: [Lanes; 2],
}

/// An output as a row over the state: (2 i + component, factor).
pub type Row = Vec<(u32, Dd)>;

/// Samples at equal steps.
pub struct Batch<'a> {
    /// `None` for one sample of the current state.
    pub step: Option<&'a Step>,
    pub count: usize,
    /// The states of the active sources at the beginning of each step.
    pub sources: &'a [Dd],
    pub rows: &'a [Row],
}

/// The computed samples.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// By sample, then output.
    pub values: Vec<Dd>,
    /// |z|^2 after each step.
    pub squares: Vec<f64>,
}

/// The state at eight times: of each number first the leading parts, then the others.
type Times = [[f64; ROOM]; 2];

simd! {
    /// Goes through the samples; the state is that of the last one afterwards.
    pub fn run<V: Vector>(batch: &Batch, state: &mut State) -> Samples {
        let outputs = batch.rows.len();
        let mut samples =
            Samples { values: vec![Dd::ZERO; batch.count * outputs], squares: vec![0.0; batch.count] };
        let mut times: Vec<Times> = vec![[[0.0; ROOM]; 2]; 2 * state.z[0].hi.len()];
        for start in (0..batch.count).step_by(ROOM) {
            let count = ROOM.min(batch.count - start);
            match batch.step {
                Some(step) => steps::<V>(batch, step, state, start, count, &mut times),
                None => store_current(state, &mut times),
            }
            for (row, output) in batch.rows.iter().zip(0..) {
                let (hi, lo) = outputs_at::<V>(row, &times);
                for t in 0..count {
                    samples.values[(start + t) * outputs + output] = Dd { hi: hi[t], lo: lo[t] };
                }
            }
            let squares = squares_at::<V>(&times);
            samples.squares[start..start + count].copy_from_slice(&squares[..count]);
        }
        samples
    }
}

/// Takes up to eight steps.
#[inline(always)]
fn steps<V: Vector>(batch: &Batch, step: &Step, state: &mut State, start: usize, count: usize, times: &mut [Times]) {
    let on = step.phi.len();
    for at in (0..state.z[0].hi.len()).step_by(V::WIDTH) {
        let f: [Double<V>; 4] = [0, 1, 2, 3].map(|i| step.f[i].at(at));
        let mut z: [Double<V>; 2] = [state.z[0].at(at), state.z[1].at(at)];
        for t in 0..count {
            let mut next = [Double::zero(); 2];
            let from = (start + t) * on;
            for (phi, &w) in step.phi.iter().zip(&batch.sources[from..from + on]) {
                let w = Double::splat(w);
                next = [next[0].plus_double(phi[0].at(at), w), next[1].plus_double(phi[1].at(at), w)];
            }
            z = [
                next[0].plus_double(f[0], z[0]).plus_double(f[1], z[1]).normalise(),
                next[1].plus_double(f[2], z[0]).plus_double(f[3], z[1]).normalise(),
            ];
            for (component, z) in z.iter().enumerate() {
                let (hi, lo) = (z.hi.to_array(), z.lo.to_array());
                for lane in 0..V::WIDTH {
                    let number = &mut times[2 * (at + lane) + component];
                    (number[0][t], number[1][t]) = (hi[lane], lo[lane]);
                }
            }
        }
        state.z[0].put(at, z[0]);
        state.z[1].put(at, z[1]);
    }
}

/// Stores the current state as that of the first time.
fn store_current(state: &State, times: &mut [Times]) {
    for (component, z) in state.z.iter().enumerate() {
        for i in 0..z.hi.len() {
            let number = &mut times[2 * i + component];
            (number[0][0], number[1][0]) = (z.hi[i], z.lo[i]);
        }
    }
}

/// An output at eight times.
#[inline(always)]
fn outputs_at<V: Vector>(row: &Row, times: &[Times]) -> ([f64; ROOM], [f64; ROOM]) {
    let (mut hi, mut lo) = ([0.0; ROOM], [0.0; ROOM]);
    for at in (0..ROOM).step_by(V::WIDTH) {
        let mut sum = Double::<V>::zero();
        for (index, factor) in row {
            let [high, low] = &times[*index as usize];
            let z = Double { hi: V::load(&high[at..]), lo: V::load(&low[at..]) };
            sum = sum.plus_double(Double::splat(*factor), z);
        }
        let sum = sum.normalise();
        sum.hi.store(&mut hi[at..]);
        sum.lo.store(&mut lo[at..]);
    }
    (hi, lo)
}

/// |z|^2 at eight times.
#[inline(always)]
fn squares_at<V: Vector>(times: &[Times]) -> [f64; ROOM] {
    let mut squares = [0.0; ROOM];
    for at in (0..ROOM).step_by(V::WIDTH) {
        let sum = times.iter().fold(V::splat(0.0), |sum, number| {
            let z = V::load(&number[0][at..]);
            z.mul_add(z, sum)
        });
        sum.store(&mut squares[at..]);
    }
    squares
}
