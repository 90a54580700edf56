//! Every code has its clause, its smallest failing model and its snapshot.
