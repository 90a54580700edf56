//! Answers and systems to text, JSON, CSV and code. Rounding happens here only. Clause: spec.md, "Report".
