//! Every diagnostic: the smallest model that shows it, and its snapshot.
