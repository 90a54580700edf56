//! Natural frequencies and poles in closed form, for one and two coordinates.
