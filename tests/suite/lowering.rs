//! Matrices against independent computations: energies differentiated numerically, closed forms.
