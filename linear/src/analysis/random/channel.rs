//! Inputs with a common noise as a system that white noise w of unit intensity drives directly: M v'' + C v' + K v = f
//! w, v' = u + h w, and the part that reaches an output without delay. In: a system, an input, the derivative of it
//! that is noise. Out: forces, jumps and direct paths, exact wherever the numbers are, because a variance is infinite
//! or finite depending on a zero. See docs/method/random.md#direct-paths.

use crate::analysis::following::{Following, Known, less};
use crate::analysis::forms::{apply, dense, dot, solution_on};
use crate::base::Number;
use crate::system::{LinearSystem, Losses, Output};

/// The action of the noise of some inputs on the coordinates.
pub struct Channel {
    /// M h, where v' = u + h w.
    pub jump: Vec<Number>,
    /// f
    pub force: Vec<Number>,
    /// g, h and M^-1 f, where q = v + g w + (what follows the base).
    direct: [Vec<Number>; 3],
    /// r and r' of q = v + r u + r' u'.
    followed: [Vec<Number>; 2],
    derivative: usize,
    pub inputs: Vec<usize>,
}

/// The part of the noise that reaches an output directly, not through the state: the factors of s^-2 w .. s^2 w.
pub type Feed = [Number; 5];

impl Channel {
    /// `None` if the static response to a base is not found, or if numbers do not decide.
    pub fn of(system: &LinearSystem, inputs: &[usize], derivative: u8) -> Option<Channel> {
        let (n, derivative) = (system.n(), usize::from(derivative));
        let Following { followed, forces } = Following::of(system, inputs, derivative, Known::Exactly)?;
        // Only forces by w and its first two derivatives are left; a base whose displacement is given has no others.
        let mut left = forces.into_iter().skip(derivative).chain(std::iter::repeat_with(|| vec![Number::ZERO; n]));
        let [f0, f1, f2] = std::array::from_fn(|_| left.next().unwrap_or_default());
        let g = mass_solution(system, &f2)?;
        let jump = less(&f1, &apply(&system.c, &g));
        let h = mass_solution(system, &jump)?;
        let force = less(&less(&f0, &apply(&system.k, &g)), &apply(&system.c, &h));
        let a = mass_solution(system, &force)?;
        Some(Channel { jump, force, direct: [g, h, a], followed, derivative, inputs: inputs.to_vec() })
    }

    pub fn feed(&self, output: &Output) -> Feed {
        let mut feed: Feed = std::array::from_fn(|_| Number::ZERO);
        for power in 0..3 {
            for (_, own) in output.d[power].iter().filter(|(input, _)| self.inputs.contains(&(*input as usize))) {
                let place = 2 + power - self.derivative;
                feed[place] = &feed[place] + own;
            }
            for (order, followed) in self.followed.iter().enumerate() {
                let seen = dot(&output.p[power], followed);
                if !seen.is_zero() {
                    let place = 2 + power + order - self.derivative;
                    feed[place] = &feed[place] + &seen;
                }
            }
            // s^power of g w, h w / s, M^-1 f w / s^2.
            for (order, direct) in self.direct.iter().enumerate().take(power + 1) {
                let place = 2 + power - order;
                feed[place] = &feed[place] + &dot(&output.p[power], direct);
            }
        }
        feed
    }

    /// The force of the loss factors, divided by i; `None` if it is not certain that it is zero in the motion that
    /// follows a base.
    pub fn loss_force(&self, losses: &Losses) -> Option<Vec<Number>> {
        let [follows, changes] = &self.followed;
        let b = dense(follows.len(), self.inputs.iter().flat_map(|&input| &losses.b[input]));
        let at_once = apply(&losses.h, &self.direct[0]);
        if self.derivative == 0 {
            return Some(less(&b, &at_once));
        }
        let moved = less(&b, &apply(&losses.h, follows)).into_iter().chain(apply(&losses.h, changes));
        let is_at_rest = moved.into_iter().all(|force| force.is_zero());
        is_at_rest.then(|| at_once.iter().map(|force| -force).collect())
    }

    /// The force along a motion r that no spring resists, at 0 Hz: r . (f + C h). `drag`: C r.
    pub fn force_along(&self, motion: &[Number], drag: &[Number]) -> Number {
        let across = |a: &[Number], b: &[Number]| a.iter().zip(b).fold(Number::ZERO, |sum, (a, b)| &sum + &(a * b));
        &across(motion, &self.force) + &across(drag, &self.direct[1])
    }

    /// Whether an output contains one of the inputs themselves.
    pub fn is_fed(&self, output: &Output) -> bool {
        output.d.iter().flatten().any(|(input, _)| self.inputs.contains(&(*input as usize)))
    }

    /// Whether the velocities are reached at once by the rate of a base, and not by a force.
    pub fn jumps(&self) -> bool {
        self.jump.iter().any(|jump| !jump.is_zero())
    }
}

/// M^-1 x, exact if possible; zero in the coordinates that inertia does not couple with those of x.
pub fn mass_solution(system: &LinearSystem, x: &[Number]) -> Option<Vec<Number>> {
    solution_on(&system.m, &(0..x.len()).collect::<Vec<_>>(), x)
}
