//! Any bytes, made into a model, through every stage: no panic, no endless loop, and what comes out is consistent.

#![no_main]

#[path = "../scene_text.rs"]
mod scene_text;
#[path = "../whole_pipeline.rs"]
mod whole_pipeline;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    whole_pipeline::run(&scene_text::text_of(bytes));
});
