//! The fuzzer's models for a second, from fixed seeds, and inputs that fuzzing once found.

#[path = "../../fuzz/scene_text.rs"]
pub mod scene_text;
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

/// Valid models with a few typing errors: characters lost, doubled or wrong, lines lost or doubled.
#[test]
fn no_stage_stumbles_over_slips_of_the_hand() {
    let mut random = Random::new(20_261_122);
    let read = |path| std::fs::read_to_string(path).expect("an example");
    let models: Vec<String> = crate::examples::examples().into_iter().map(read).collect();
    for round in 0..ROUNDS {
        let mut text: Vec<char> = models[round % models.len()].chars().collect();
        for _ in 0..=random.below(4) {
            slip(&mut text, &mut random);
        }
        whole_pipeline::run(&text.into_iter().collect::<String>());
    }
}

fn slip(text: &mut Vec<char>, random: &mut Random) {
    const TYPED: [char; 16] = ['{', '}', '(', ')', '[', ']', '"', '@', ':', '=', '-', '.', '/', '0', 'x', '\n'];
    if text.is_empty() {
        return;
    }
    let at = random.below(text.len());
    match random.below(5) {
        0 => drop(text.remove(at)),
        1 => text.insert(at, TYPED[random.below(TYPED.len())]),
        2 => text[at] = TYPED[random.below(TYPED.len())],
        kind => {
            let start = text[..at].iter().rposition(|c| *c == '\n').map_or(0, |end| end + 1);
            let end = text[at..].iter().position(|c| *c == '\n').map_or(text.len(), |end| at + end + 1);
            let line: Vec<char> = text[start..end].to_vec();
            let again = if kind == 3 { [line.clone(), line].concat() } else { Vec::new() };
            text.splice(start..end, again);
        }
    }
}

/// Byte sequences on which fuzzing once failed.
const FOUND: [(&str, &str); 3] = [
    ("modes after several rigid ones out of order", "826f770b4507585007faabaaaaaa18000000000000000aaaaaaa4507"),
    ("a real pole beyond binary64", "826f770bfaab5850070b1c1c1c4507585007fa5807fa58500a"),
    ("shares of a strain energy that is nothing", "826f775087fa583f07fa07581c000000000000000058faaaaafaaa82"),
];

#[test]
fn fuzzing_regressions_stay_fixed() {
    for (what, hex) in FOUND {
        let digits = |at: usize| hex.get(at..at + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok());
        let bytes: Option<Vec<u8>> = (0..hex.len()).step_by(2).map(digits).collect();
        let text = scene_text::text_of(&bytes.expect("pairs of digits"));
        println!("{what}:\n{text}");
        whole_pipeline::run(&text);
    }
}
