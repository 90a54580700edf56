//! Damped poles of models.
