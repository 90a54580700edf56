//! One file a kind of joint: the freedoms it leaves, or the constraint it closes. Clause: spec.md, "Freedoms".
