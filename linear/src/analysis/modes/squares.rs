//! A form of the system as flat numbers: the weights and sparse rows of `sum w a a^T` as balls.
//!
//! Any uncertainty in the model (a root, a sine, the rounding of 0.1 to a double-double) is in the balls and so in
//! every bound.

use crate::base::Ball;
use crate::kernel::squares::Squares;
use crate::system::Form;

impl Squares<Ball> {
    pub fn of_form(form: &Form) -> Squares<Ball> {
        let mut squares = Squares::with_capacity(form.terms().len());
        for term in form.terms() {
            squares.push(term.weight.to_ball(), form.row(term).iter().map(|(i, value)| (i.0, value.to_ball())));
        }
        squares
    }
}
