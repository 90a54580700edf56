//! Signals built into the state, so that nothing is lost between samples: a harmonic is two states that turn, a step, a ramp or a
//! polynomial a chain of states, and what happens between two samples (a step comes on, a ramp ends, a blow falls) is a change
//! of all states at the next sample. In: the signals of each input. Out: cells of their own, what they do to the other
//! blocks, and the changes. Clause: spec.md, "Simulation code".
//!
//! The states of a chain are u, h u', h^2 u''/2!, ...: one step adds binomial multiples of each other, whatever h is.

use crate::analysis::discrete::block::Block;
use crate::analysis::discrete::hold::coupled;
use crate::analysis::numeric::dense::Matrix;
use crate::analysis::response::signal::Source;
use crate::base::{Ball, Dd, Number};
use crate::system::{LinearSystem, Signal};

/// The states of one signal.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The input that it drives.
    pub input: usize,
    /// s' = R s, R times the step.
    pub generator: Matrix<Dd>,
    /// u, u' and u'' as rows over s.
    pub rows: [Vec<Dd>; 3],
    pub start: Vec<Dd>,
    pub name: String,
}

/// What happens at one time.
#[derive(Clone, Debug)]
pub struct Event {
    /// The first sample not before it.
    pub tick: u64,
    /// How long before that sample it happens, in steps.
    pub before: Dd,
    pub change: Change,
}

#[derive(Clone, Debug)]
pub enum Change {
    /// Of the states of a chain.
    Chain(usize, Vec<Dd>),
    /// A blow on an input.
    Blow(usize, Dd),
}

/// All signals made ready.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    pub chains: Vec<Chain>,
    /// Ascending.
    pub events: Vec<Event>,
}

/// A signal that needs more pieces than code is for, by its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong {
    pub input: usize,
}

/// More changes than this would make tables of megabytes.
const MOST_EVENTS: usize = 20_000;

impl Signals {
    /// The signals of each input until a time (all of them without one), for steps of `step`.
    pub fn of(drives: &[Vec<Signal>], step: &Number, until: Option<&Number>) -> Result<Signals, TooLong> {
        let mut signals = Signals::default();
        for (input, list) in drives.iter().enumerate() {
            let sources: Result<Vec<Source>, _> = list.iter().map(|signal| Source::of(signal, None)).collect();
            let sources = sources.map_err(|_| TooLong { input })?;
            let polynomials = sources.iter().filter(|source| matches!(source, Source::Pieces { .. }));
            let shared = polynomials.map(Source::order).max().map(|order| signals.chain(input, order, step));
            for source in &sources {
                signals.add(input, source, shared, step, until).ok_or(TooLong { input })?;
            }
        }
        signals.events.sort_by_key(|event| event.tick);
        Ok(signals)
    }

    /// A chain that all polynomials of an input add up in; its place.
    fn chain(&mut self, input: usize, order: usize, step: &Number) -> usize {
        let scale = scales(order, step.to_ball().mid);
        let rows = [0, 1, 2].map(|p| (0..order).map(|k| if k == p { Dd::ONE / scale[k] } else { Dd::ZERO }).collect());
        let generator = Matrix::from_fn(order, order, |i, j| if j == i + 1 { Dd::from(j as f64) } else { Dd::ZERO });
        let start = vec![Dd::ZERO; order];
        self.chains.push(Chain { input, generator, rows, start, name: "piecewise signals".into() });
        self.chains.len() - 1
    }

    fn add(
        &mut self,
        input: usize,
        source: &Source,
        shared: Option<usize>,
        step: &Number,
        until: Option<&Number>,
    ) -> Option<()> {
        let h = step.to_ball().mid;
        match source {
            Source::Harmonic { amplitude, omega, sine, cosine } => {
                let turn = omega.mid * h;
                let generator = Matrix::from_fn(2, 2, |i, j| match (i, j) {
                    (0, 1) => turn,
                    (1, 0) => -turn,
                    _ => Dd::ZERO,
                });
                let (a, w) = (amplitude.mid, omega.mid);
                let rows = [vec![a, Dd::ZERO], vec![Dd::ZERO, a * w], vec![-(a * w * w), Dd::ZERO]];
                let start = vec![sine.mid, cosine.mid];
                self.chains.push(Chain { input, generator, rows, start, name: "harmonic signal".into() });
            }
            Source::Pieces { pieces, .. } => {
                let chain = shared?;
                let scale = scales(self.chains[chain].size(), h);
                let scaled = |derivatives: &[Ball]| -> Vec<Dd> {
                    let value = |k: usize| derivatives.get(k).map_or(Dd::ZERO, |x| x.mid);
                    scale.iter().enumerate().map(|(k, &scale)| value(k) * scale).collect()
                };
                let mut start = scaled(&[]);
                for (i, piece) in pieces.iter().enumerate() {
                    if until.is_some_and(|until| (until - &piece.at).is_negative()) {
                        break;
                    }
                    if !piece.at.is_positive() {
                        start = scaled(&piece.at_time(&Number::ZERO));
                        continue;
                    }
                    let old = i.checked_sub(1).map_or_else(|| scaled(&[]), |i| scaled(&pieces[i].at_time(&piece.at)));
                    let new = scaled(&piece.at_time(&piece.at));
                    let change = new.into_iter().zip(old).map(|(new, old)| new - old).collect();
                    self.event(&piece.at, step, Change::Chain(chain, change))?;
                }
                self.chains[chain].start.iter_mut().zip(start).for_each(|(sum, x)| *sum += x);
            }
            Source::Impulse { value, at } => {
                if until.is_none_or(|until| !(until - at).is_negative()) {
                    self.event(at, step, Change::Blow(input, value.mid))?;
                }
            }
        }
        Some(())
    }

    fn event(&mut self, at: &Number, step: &Number, change: Change) -> Option<()> {
        let samples = at / step;
        let near = samples.to_f64().ceil();
        if !(0.0..4e9).contains(&near) || self.events.len() >= MOST_EVENTS {
            return None;
        }
        // The quotient may have been rounded over a whole number.
        let mut tick = near as i64;
        while (&Number::from(tick) - &samples).is_negative() {
            tick += 1;
        }
        while tick > 0 && !(&Number::from(tick - 1) - &samples).is_negative() {
            tick -= 1;
        }
        let before = (&Number::from(tick) - &samples).to_ball();
        let before = if before.contains_zero() { Dd::ZERO } else { before.mid };
        self.events.push(Event { tick: tick as u64, before, change });
        Some(())
    }

    /// A prescribed motion that has a blow, which would need infinite forces.
    pub fn blow_on_base(&self, system: &LinearSystem) -> Option<usize> {
        self.events.iter().find_map(|event| match event.change {
            Change::Blow(input, _) => {
                let b = &system.inputs[input].b;
                (!(b[1].is_empty() && b[2].is_empty())).then_some(input)
            }
            Change::Chain(..) => None,
        })
    }

    /// Those of inputs that anything feels.
    pub fn useful(self, felt: impl Fn(usize) -> bool) -> Signals {
        let mut kept = Vec::with_capacity(self.chains.len());
        let mut chains = Vec::new();
        for chain in self.chains {
            kept.push(felt(chain.input).then_some(chains.len()));
            chains.extend(Some(chain).filter(|chain| felt(chain.input)));
        }
        let renumbered = |event: Event| {
            let change = match event.change {
                Change::Chain(chain, change) => Change::Chain(kept[chain]?, change),
                Change::Blow(input, value) => Change::Blow(Some(input).filter(|&input| felt(input))?, value),
            };
            Some(Event { change, ..event })
        };
        Signals { chains, events: self.events.into_iter().filter_map(renumbered).collect() }
    }
}

/// h^k / k!
fn scales(order: usize, h: Dd) -> Vec<Dd> {
    let mut scale = vec![Dd::ONE];
    for k in 1..order {
        scale.push(scale[k - 1] * h / Dd::from(k as f64));
    }
    scale
}

impl Chain {
    pub fn size(&self) -> usize {
        self.start.len()
    }

    /// What the chain's states do to a block's in so many steps.
    pub fn on(&self, block: &Block, steps: Dd, h: Dd) -> Option<Matrix<Dd>> {
        let drive = Matrix::from_fn(block.size(), self.size(), |i, j| block.b[(i, self.input)] * self.rows[0][j]);
        coupled(&block.a, &drive, &self.generator, steps, h)
    }

    /// Whether it turns, rather than being a polynomial.
    pub fn turns(&self) -> bool {
        self.size() == 2 && !self.generator[(1, 0)].is_zero()
    }
}
