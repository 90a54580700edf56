//! Incomplete text, as it is while typing: every request is answered, with as much information as possible.

use super::client::{Client, URI};
use crate::fuzzing::scene_text;
use crate::independent::random_scenes::Random;
use serde_json::json;
use vibc::base::{SourceFile, Sources};
use vibc::editor::document::Document;
use vibc::editor::project::Project;
use vibc::editor::{completion, fixes, highlight, hints, hover, names, signature, symbols};

const CART: &str = include_str!("../../../examples/cart.vib");

/// Sends every request about every place of a text.
fn ask_everything(text: &str, places: impl Iterator<Item = usize>) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    let document = Document::new(sources, file, None);
    let project = Project::of(&document);
    for at in places.filter(|at| text.is_char_boundary(*at)) {
        hover::hover(&document, &project, at);
        signature::signature(&document, &project, at);
        let typed = completion::typed_prefix(&document, at);
        assert!(text.get(typed.clone()).is_some() && typed.end == at, "{typed:?} of {text}");
        completion::items(&document, &project, at);
        if let Some(name) = names::name_at(&project, at) {
            let all = names::references(&project, name, true);
            assert!(all.contains(&name), "{all:?}");
            let _ = names::rename(&project, name, "other");
        }
    }
    for finding in &document.findings {
        for action in fixes::actions(&document, finding) {
            assert!(action.edits.iter().all(|(range, _)| text.get(range.clone()).is_some()), "{action:?} of {text}");
        }
    }
    let pieces = highlight::pieces(&document);
    assert!(pieces.windows(2).all(|pair| pair[0].range.end <= pair[1].range.start), "{text}");
    symbols::symbols(&document);
    symbols::folds(&document);
    hints::hints(&document);
}

#[test]
fn a_model_is_typed_letter_by_letter() {
    let ends = (0..=CART.len()).filter(|end| CART.is_char_boundary(*end));
    for end in ends {
        ask_everything(&CART[..end], [end.saturating_sub(1), end].into_iter());
    }
}

#[test]
fn letters_are_lost_and_lines_are_swapped() {
    let mut random = Random::new(20_261_122);
    for _ in 0..150 {
        let mut text = CART.to_string();
        for _ in 0..3 {
            let at = random.below(text.len());
            if text.is_char_boundary(at) && text.is_char_boundary(at + 1) {
                text.replace_range(at..at + 1, ["", "(", "}", "\n", "\"", ".", "@", " { "][random.below(8)]);
            }
        }
        let places: Vec<usize> = (0..20).map(|_| random.below(text.len() + 1)).collect();
        ask_everything(&text, places.into_iter());
    }
}

#[test]
fn random_models_are_answered_everywhere() {
    let mut random = Random::new(7);
    for _ in 0..60 {
        let bytes: Vec<u8> = (0..10 + random.below(120)).map(|_| random.below(256) as u8).collect();
        let text = scene_text::text_of(&bytes);
        let places: Vec<usize> = (0..20).map(|_| random.below(text.len() + 1)).collect();
        ask_everything(&text, places.into_iter());
    }
}

/// A line that does not parse does not affect the others.
#[test]
fn broken_text_keeps_the_last_results() {
    let mut client = Client::open(CART);
    client.findings();
    let broken = CART.replace("damper d: ground@W -- block@A { c = b }", "damper d: ground@W -- block@A { c = ");
    client.change(&broken);
    assert!(!client.findings().is_empty());
    let block = client.ask_at("textDocument/hover", "block {", 0);
    let block = block["contents"]["value"].as_str().expect("a body");
    assert!(block.contains("mass 1 kg") && block.contains("share of kinetic energy"), "as it was before: {block}");
    let k = client.ask_at("textDocument/hover", "k = k", 0);
    assert!(!k.is_null());
    let symbols = client.ask("textDocument/documentSymbol", client.document());
    assert_eq!(symbols.as_array().unwrap().len(), 17, "{symbols}");
    let mut params = client.at("k  = 10", 0);
    params["newName"] = json!("stiffness");
    let edit = client.ask("textDocument/rename", params);
    assert!(client.edited(&edit).contains("{ k = stiffness, free_length"));
    let definition = client.ask_at("textDocument/definition", "A { c", 0);
    assert_eq!(definition[0]["range"]["start"]["line"], 17);
    let completion = client.ask("textDocument/completion", client.behind("{ c = "));
    assert!(completion.as_array().unwrap().iter().any(|item| item["label"] == "b"));
    let tokens = client.ask("textDocument/semanticTokens/full", json!({ "textDocument": { "uri": URI } }));
    assert!(tokens["data"].as_array().unwrap().len() > 400);
}
