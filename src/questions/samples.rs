//! Random values of the parameters that have a tolerance or a spread. In: tolerances, their correlations, a seed. Out:
//! the values of each case, which depend only on the seed and the number of the case. See
//! docs/method/studies.md#samples.

use super::answer::REPLICATES;
use crate::base::{Number, Quantity, Rational};
use crate::kernel::normal::{cumulative, quantile};
use crate::kernel::philox::philox;
use crate::kernel::sobol;
use crate::model::Setting;
use crate::model::scene::{Scene, Spread, Tolerance};

/// The number and kind of the random values of a study.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    pub count: u64,
    pub seed: u64,
    /// Whether the values are taken from `REPLICATES` scrambled Sobol sequences in turn.
    pub sobol: bool,
}

/// The draws of a study.
#[derive(Clone, Debug)]
pub struct Samples {
    pub draws: Draws,
    pub tolerances: Vec<Tolerance>,
    /// For each parameter that is correlated with one before it, its row of the Cholesky factor L of the matrix of correlations.
    rows: Vec<Option<Vec<f64>>>,
}

/// Random streams for other purposes use other numbers here.
const STREAM: u32 = 0x7661_7279;

impl Samples {
    /// The draws of a scene; parameters that are held get none.
    pub fn of(scene: &Scene, held: &[Setting], draws: Draws) -> Samples {
        let is_free = |tolerance: &Tolerance| held.iter().all(|(name, _)| *name != tolerance.parameter.name);
        let places: Vec<usize> = (0..scene.tolerances.len()).filter(|&i| is_free(&scene.tolerances[i])).collect();
        let n = places.len();
        let mut matrix = vec![vec![0.0; n]; n];
        for correlation in &scene.correlations {
            let [a, b] = correlation.pair.map(|of| places.iter().position(|&place| place == of));
            if let (Some(a), Some(b)) = (a, b) {
                matrix[a.max(b)][a.min(b)] = correlation.coefficient.to_f64();
            }
        }
        let tolerances = places.iter().map(|&place| scene.tolerances[place].clone()).collect();
        Samples { draws, tolerances, rows: factor(matrix) }
    }

    /// The values of a case.
    pub fn values(&self, case: u64) -> Vec<Setting> {
        let value = |(tolerance, value): (&Tolerance, f64)| {
            let parameter = &tolerance.parameter;
            let si = Rational::from_f64(value).map_or(parameter.value.si.clone(), Number::from);
            (parameter.name.clone(), Quantity { si, ..parameter.value.clone() })
        };
        self.tolerances.iter().zip(self.numbers(case)).map(value).collect()
    }

    /// The values of a case in SI units.
    pub fn numbers(&self, case: u64) -> Vec<f64> {
        let uniform: Vec<f64> = (0..self.tolerances.len()).map(|i| self.uniform(case, i)).collect();
        let value = |(i, tolerance): (usize, &Tolerance)| {
            let place = match &self.rows[i] {
                None => Place::Probability(uniform[i]),
                Some(row) => Place::Normal(row.iter().zip(&uniform).map(|(l, u)| l * quantile(*u)).sum()),
            };
            draw(tolerance, place).clamp(-f64::MAX, f64::MAX)
        };
        self.tolerances.iter().enumerate().map(value).collect()
    }

    /// For each parameter its declared value and the least and largest one: the ends of its tolerance, or so many deviations away.
    pub fn ranges(&self, deviations: f64) -> Vec<[f64; 3]> {
        let range = |tolerance: &Tolerance| {
            let ends = match &tolerance.within {
                Some(ends) => ends.each_ref().map(Number::to_f64),
                None => [-deviations, deviations].map(|z| draw(tolerance, Place::Normal(z))),
            };
            [tolerance.parameter.value.si.to_f64(), ends[0], ends[1]]
        };
        self.tolerances.iter().map(range).collect()
    }

    /// A number between 0 and 1, both excluded, uniformly distributed.
    fn uniform(&self, case: u64, parameter: usize) -> f64 {
        let words = |x: u64| [x as u32, (x >> 32) as u32];
        let key = words(self.draws.seed);
        if self.draws.sobol {
            let (index, replicate) = (case / REPLICATES, case % REPLICATES);
            return sobol::scramble_point(index as u32, parameter, key, [replicate as u32, STREAM]);
        }
        let [low, high] = words(case);
        let counter = [low, high, parameter as u32, STREAM];
        let [high, low, ..] = philox(counter, key);
        let bits = (u64::from(high) << 32 | u64::from(low)) >> 12;
        (bits as f64 + 0.5) / (1u64 << 52) as f64
    }
}

/// The position of a value in its distribution.
#[derive(Clone, Copy)]
enum Place {
    Probability(f64),
    /// The standard normal variable that has the same probability of being exceeded.
    Normal(f64),
}

impl Place {
    fn probability(self) -> f64 {
        match self {
            Place::Probability(p) => p,
            Place::Normal(z) => cumulative(z),
        }
    }

    fn normal(self) -> f64 {
        match self {
            Place::Probability(p) => quantile(p),
            Place::Normal(z) => z,
        }
    }
}

/// The value of a parameter at a place of its distribution, in SI units.
fn draw(tolerance: &Tolerance, place: Place) -> f64 {
    let centre = tolerance.parameter.value.si.to_f64();
    let ends = tolerance.within.as_ref().map(|ends| ends.each_ref().map(Number::to_f64));
    match (&tolerance.spread, ends) {
        (Some(Spread::Normal { deviation }), _) => {
            let deviation = deviation.to_f64();
            let within = ends.map(|ends| ends.map(|end| (end - centre) / deviation));
            clamp(ends, centre + deviation * truncated_normal(within, place))
        }
        (Some(Spread::Lognormal { deviation }), _) => {
            let deviation = deviation.to_f64();
            let log = |end: f64| if end > 0.0 { libm::log(end / centre) / deviation } else { f64::NEG_INFINITY };
            clamp(ends, centre * libm::exp(deviation * truncated_normal(ends.map(|ends| ends.map(log)), place)))
        }
        (Some(Spread::Uniform) | None, Some([low, high])) => clamp(ends, low + (high - low) * place.probability()),
        (Some(Spread::Uniform) | None, None) => centre,
    }
}

/// A standard normal variable that lies within the ends.
fn truncated_normal(ends: Option<[f64; 2]>, place: Place) -> f64 {
    match ends.map(|ends| ends.map(cumulative)) {
        None => place.normal(),
        Some([low, high]) => quantile(low + (high - low) * place.probability()),
    }
}

/// Rounding does not leave the range.
fn clamp(ends: Option<[f64; 2]>, value: f64) -> f64 {
    match ends {
        Some([low, high]) => value.max(low).min(high),
        None => value,
    }
}

/// The rows of L, where L L^T is the matrix with ones on its diagonal and this lower triangle; zero for a row of which
/// rounding leaves nothing.
fn factor(mut matrix: Vec<Vec<f64>>) -> Vec<Option<Vec<f64>>> {
    for i in 0..matrix.len() {
        let (before, rest) = matrix.split_at_mut(i);
        let row = &mut rest[0];
        for (j, other) in before.iter().enumerate() {
            let sum: f64 = row.iter().zip(other).take(j).map(|(a, b)| a * b).sum();
            row[j] = (row[j] - sum) / other[j];
        }
        let sum: f64 = row[..i].iter().map(|x| x * x).sum();
        // The matrix is positive definite: the check proves it. Rounding may leave nothing of a small pivot.
        row[i] = (1.0 - sum).max(f64::EPSILON).sqrt();
    }
    let row = |(i, row): (usize, Vec<f64>)| row[..i].iter().any(|x| *x != 0.0).then(|| row[..=i].to_vec());
    matrix.into_iter().enumerate().map(row).collect()
}
