//! The fuzzer's models for a second, from stated seeds, and what fuzzing once found.

#[path = "../../fuzz/scene_text.rs"]
mod scene_text;
#[path = "../../fuzz/whole_pipeline.rs"]
mod whole_pipeline;

use crate::independent::random_scenes::Random;

/// Bytes of random length, half of them small so that the plain choices at the start of each list are often taken.
fn bytes(random: &mut Random) -> Vec<u8> {
    let length = 10 + random.below(300);
    (0..length).map(|_| if random.chance(20) { random.below(256) as u8 } else { random.below(24) as u8 }).collect()
}

#[test]
fn no_stage_stumbles_over_random_models() {
    let mut random = Random::new(20_261_121);
    for _ in 0..ROUNDS {
        whole_pipeline::run(&scene_text::text_of(&bytes(&mut random)));
    }
}

const ROUNDS: usize = 400;
