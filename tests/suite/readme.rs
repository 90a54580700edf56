//! What the README prints is what the program prints.
