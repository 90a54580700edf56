//! The program as a process: streams, exit status, message formats.
