//! Cubic splines through the rows of a table: their second derivatives at the rows, from a diagonally dominant tridiagonal
//! system (de Boor, *A Practical Guide to Splines*, chapter IV). In: times or steps, values. Out: second derivatives, as
//! enclosures. See docs/method/response.md#signals.

use crate::base::{Ball, Number};

/// Second derivatives of the natural spline: zero at both ends.
pub fn natural(times: &[Number], values: &[Number]) -> Vec<Number> {
    let n = times.len();
    let mut bends = vec![Number::ZERO; n];
    if n < 3 {
        return bends;
    }
    let h: Vec<Ball> = (1..n).map(|i| (&times[i] - &times[i - 1]).to_ball()).collect();
    let slope: Vec<Ball> = (1..n).map(|i| (&values[i] - &values[i - 1]).to_ball() / h[i - 1]).collect();
    let right: Vec<Ball> = (1..n - 1).map(|i| Ball::from(6.0) * (slope[i] - slope[i - 1])).collect();
    let found = solve_tridiagonal(&h, right);
    bends[1..n - 1].iter_mut().zip(found).for_each(|(bend, found)| *bend = Number::Ball(found));
    bends
}

/// Second derivatives of the spline that is as smooth from the last row to the first one of the next period as it is elsewhere.
/// `steps`: the times from each row to the next one, as many as there are values.
pub fn closed_derivatives(steps: &[Number], values: &[Number]) -> Vec<Number> {
    let n = values.len();
    if n < 2 {
        return vec![Number::ZERO; n];
    }
    let h: Vec<Ball> = steps.iter().map(Number::to_ball).collect();
    let slope: Vec<Ball> = (0..n).map(|i| (&values[(i + 1) % n] - &values[i]).to_ball() / h[i]).collect();
    let right = |i: usize| Ball::from(6.0) * (slope[i] - slope[(i + n - 1) % n]);
    // The rows after the first one, as a part of their own and as multiples of its bend; both follow from it then.
    let own = solve_tridiagonal(&h, (1..n).map(right).collect());
    let mut pull = vec![Ball::ZERO; n - 1];
    pull[0] = pull[0] - h[0];
    pull[n - 2] = pull[n - 2] - h[n - 1];
    let pulled = solve_tridiagonal(&h, pull);
    let (before, after) = (h[n - 1], h[0]);
    let known = right(0) - before * own[n - 2] - after * own[0];
    let first = known / (Ball::from(2.0) * (before + after) + before * pulled[n - 2] + after * pulled[0]);
    let others = own.into_iter().zip(pulled).map(|(own, pulled)| own + pulled * first);
    std::iter::once(first).chain(others).map(Number::Ball).collect()
}

/// Solves h[i] x[i-1] + 2 (h[i] + h[i+1]) x[i] + h[i+1] x[i+1] = right[i], with zero beyond both ends.
fn solve_tridiagonal(h: &[Ball], mut right: Vec<Ball>) -> Vec<Ball> {
    let n = right.len();
    let mut upper = vec![Ball::ZERO; n];
    for i in 0..n {
        let (above, before) = if i > 0 { (upper[i - 1], right[i - 1]) } else { (Ball::ZERO, Ball::ZERO) };
        let pivot = Ball::from(2.0) * (h[i] + h[i + 1]) - h[i] * above;
        upper[i] = h[i + 1] / pivot;
        right[i] = (right[i] - h[i] * before) / pivot;
    }
    for i in (0..n.saturating_sub(1)).rev() {
        right[i] = right[i] - upper[i] * right[i + 1];
    }
    right
}
