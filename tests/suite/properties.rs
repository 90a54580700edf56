//! What must not change an answer: renaming, reordering, other units, moving, turning, splitting.
