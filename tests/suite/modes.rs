//! Undamped modes of models.
