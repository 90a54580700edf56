//! Any bytes as the text of a model, through every stage. Start it with the examples as its corpus and `vib.dict`:
//! `cargo fuzz run text fuzz/corpus/text examples tests/diagnostics -- -dict=fuzz/vib.dict`.

#![no_main]

#[path = "../whole_pipeline.rs"]
mod whole_pipeline;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    whole_pipeline::run(&String::from_utf8_lossy(bytes));
});
