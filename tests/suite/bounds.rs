//! Every printed bound holds: random systems against references of higher precision.
