//! Converts the answers of the editor's modules to the protocol.

use super::files::shown_at;
use super::place::Encoding;
use crate::base::{Diagnostic, Severity, Span};
use crate::editor::completion::{Item, ItemKind};
use crate::editor::document::Document;
use crate::editor::highlight::{KINDS, MARKS, Piece};
use crate::editor::hints::Hint;
use crate::editor::hover::Hover;
use crate::editor::signature::Signature;
use crate::editor::symbols::{Fold, Symbol};
use gen_lsp_types as lsp;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::ops::Range;

/// The command that shows a code's page.
pub const EXPLAIN: &str = "vibc.explain";

/// The capabilities of this server.
pub fn capabilities(encoding: Encoding) -> Value {
    json!({
        "capabilities": {
            "positionEncoding": encoding.kind(),
            "textDocumentSync": { "openClose": true, "change": 1, "save": true },
            "hoverProvider": true,
            "inlayHintProvider": true,
            "completionProvider": { "triggerCharacters": [".", "@", " ", "{", ",", ":", ">", "("] },
            "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
            "definitionProvider": true,
            "referencesProvider": true,
            "documentHighlightProvider": true,
            "renameProvider": { "prepareProvider": true },
            "documentSymbolProvider": true,
            "semanticTokensProvider": { "legend": { "tokenTypes": KINDS, "tokenModifiers": MARKS }, "full": true },
            "foldingRangeProvider": true,
            "documentFormattingProvider": true,
            "codeActionProvider": { "codeActionKinds": ["quickfix"] },
            "executeCommandProvider": { "commands": [EXPLAIN] },
            "workspace": { "workspaceFolders": { "supported": true, "changeNotifications": true } },
        },
        "serverInfo": { "name": "vibc", "version": env!("CARGO_PKG_VERSION") },
    })
}

/// Finds the places of a finding, whatever file they are in.
pub trait Places {
    /// `None` in a file that the client cannot open.
    fn location(&self, span: Span) -> Option<lsp::Location>;
}

pub fn diagnostics(document: &Document, encoding: Encoding, places: &impl Places) -> Vec<lsp::Diagnostic> {
    document.findings.iter().map(|finding| diagnostic(document, encoding, places, finding)).collect()
}

/// A finding in a document.
pub fn diagnostic(
    document: &Document,
    encoding: Encoding,
    places: &impl Places,
    finding: &Diagnostic,
) -> lsp::Diagnostic {
    let mut found = diagnostic_at(encoding.range(document, shown_at(document, finding)), places, finding);
    if finding.primary.span.file() != document.file {
        let location = places.location(finding.primary.span);
        let message = "the mistake is here".to_string();
        let here = location.map(|location| lsp::DiagnosticRelatedInformation { location, message });
        found.related_information.get_or_insert_default().splice(0..0, here);
    }
    found
}

/// A finding at a range of the text that it is in.
pub fn diagnostic_at(range: lsp::Range, places: &impl Places, finding: &Diagnostic) -> lsp::Diagnostic {
    let mut message = finding.message.clone();
    if !finding.primary.text.is_empty() {
        message += &format!(" ({})", finding.primary.text);
    }
    if let Some(help) = &finding.help {
        message += &format!("\nhelp: {help}");
    }
    let related = finding.related.iter().filter_map(|label| {
        let location = places.location(label.span)?;
        Some(lsp::DiagnosticRelatedInformation { location, message: label.text.clone() })
    });
    let is_unused = finding.code.0.starts_with("vib::unused::");
    lsp::Diagnostic {
        range,
        severity: Some(match finding.severity {
            Severity::Error => lsp::DiagnosticSeverity::Error,
            Severity::Warning => lsp::DiagnosticSeverity::Warning,
            Severity::Note => lsp::DiagnosticSeverity::Information,
        }),
        code: Some(finding.code.0.to_string().into()),
        // An editor that knows the scheme gets the page from `vibc explain`.
        code_description: Some(lsp::CodeDescription { href: format!("vibc:/{}.md", finding.code.0).into() }),
        source: Some("vibc".into()),
        message: message.into(),
        tags: is_unused.then(|| vec![lsp::DiagnosticTag::Unnecessary]),
        related_information: Some(related.collect()),
        data: None,
    }
}

pub fn hover(document: &Document, encoding: Encoding, hover: Hover) -> lsp::Hover {
    let contents = lsp::MarkupContent { kind: lsp::MarkupKind::Markdown, value: hover.markdown };
    lsp::Hover { contents: contents.into(), range: Some(encoding.range(document, hover.range)) }
}

pub fn hint(document: &Document, encoding: Encoding, hint: Hint) -> lsp::InlayHint {
    lsp::InlayHint {
        position: encoding.position(document, hint.at),
        label: hint.text.into(),
        kind: None,
        text_edits: None,
        tooltip: hint.tooltip.map(Into::into),
        padding_left: Some(true),
        padding_right: None,
        data: None,
    }
}

pub fn signature(found: Signature) -> lsp::SignatureHelp {
    // In UTF-16: the protocol requires it here, whatever encoding was agreed on.
    let units = |end: usize| found.form[..end].encode_utf16().count() as u32;
    let parameter = |range: &Range<usize>| {
        let label = lsp::ParameterInformationLabel::Tuple((units(range.start), units(range.end)));
        lsp::ParameterInformation { label, documentation: None }
    };
    let parameters = found.arguments.iter().map(parameter).collect();
    // An index beyond the last parameter highlights none of them.
    let active = found.argument.unwrap_or(found.arguments.len()) as u32;
    let signature = lsp::SignatureInformation {
        label: found.form,
        documentation: Some(found.meaning.into()),
        parameters: Some(parameters),
        active_parameter: None,
    };
    lsp::SignatureHelp { signatures: vec![signature], active_signature: Some(0), active_parameter: Some(active.into()) }
}

pub fn item(order: usize, item: Item, range: lsp::Range) -> lsp::CompletionItem {
    let kind = match item.kind {
        ItemKind::Keyword => lsp::CompletionItemKind::Keyword,
        ItemKind::Field => lsp::CompletionItemKind::Field,
        ItemKind::Value => lsp::CompletionItemKind::Variable,
        ItemKind::Part => lsp::CompletionItemKind::Class,
        ItemKind::Motion => lsp::CompletionItemKind::Property,
        ItemKind::Function => lsp::CompletionItemKind::Function,
        ItemKind::Unit => lsp::CompletionItemKind::Unit,
    };
    let new_text = item.insert.unwrap_or_else(|| item.label.clone());
    lsp::CompletionItem {
        kind: Some(kind),
        detail: (!item.detail.is_empty()).then_some(item.detail),
        // Sorted by likelihood.
        sort_text: Some(format!("{order:04}")),
        filter_text: Some(item.label.clone()),
        text_edit: Some(lsp::TextEdit { range, new_text }.into()),
        label: item.label,
        ..lsp::CompletionItem::default()
    }
}

type Edits = Vec<(Range<usize>, String)>;

pub fn workspace_edit(document: &Document, encoding: Encoding, uri: &lsp::Uri, edits: Edits) -> lsp::WorkspaceEdit {
    edits_of(edits.into_iter().map(|(range, new_text)| {
        let location = lsp::Location { uri: uri.clone(), range: encoding.range(document, range) };
        (location, new_text)
    }))
}

/// Edits of several files, in order.
pub fn edits_of(edits: impl IntoIterator<Item = (lsp::Location, String)>) -> lsp::WorkspaceEdit {
    let mut changes: HashMap<lsp::Uri, Vec<lsp::TextEdit>> = HashMap::new();
    for (lsp::Location { uri, range }, new_text) in edits {
        changes.entry(uri).or_default().push(lsp::TextEdit { range, new_text });
    }
    lsp::WorkspaceEdit { changes: Some(changes), ..lsp::WorkspaceEdit::default() }
}

pub fn is_quick_fix(kind: &lsp::CodeActionKind) -> bool {
    matches!(kind, lsp::CodeActionKind::QuickFix | lsp::CodeActionKind::Empty)
}

pub fn action(
    title: String,
    fixed: lsp::Diagnostic,
    edit: lsp::WorkspaceEdit,
    is_preferred: bool,
) -> lsp::CodeActionResponse {
    let action = lsp::CodeAction {
        title,
        kind: Some(lsp::CodeActionKind::QuickFix),
        diagnostics: Some(vec![fixed]),
        is_preferred: is_preferred.then_some(true),
        edit: Some(edit),
        ..lsp::CodeAction::default()
    };
    action.into()
}

/// The action that shows a code's page.
pub fn explain(code: &str, diagnostic: lsp::Diagnostic) -> lsp::CodeActionResponse {
    let title = format!("explain {code}");
    let arguments = Some(vec![code.into()]);
    let command = lsp::Command { title: title.clone(), command: EXPLAIN.into(), arguments, tooltip: None };
    let action = lsp::CodeAction {
        title,
        kind: Some(lsp::CodeActionKind::QuickFix),
        diagnostics: Some(vec![diagnostic]),
        command: Some(command),
        ..lsp::CodeAction::default()
    };
    action.into()
}

pub fn symbol(document: &Document, encoding: Encoding, symbol: Symbol) -> lsp::DocumentSymbol {
    let kind = match symbol.detail.as_str() {
        "model" => lsp::SymbolKind::Module,
        "param" | "let" => lsp::SymbolKind::Variable,
        "point" => lsp::SymbolKind::Constant,
        "body" => lsp::SymbolKind::Class,
        "base" | "force" | "torque" | "unbalance" => lsp::SymbolKind::Event,
        "output" => lsp::SymbolKind::Property,
        "repeat" => lsp::SymbolKind::Array,
        "component" => lsp::SymbolKind::Struct,
        "require" | "solve" | "minimise" | "maximise" => lsp::SymbolKind::Boolean,
        _ => lsp::SymbolKind::Object,
    };
    let children: Vec<_> = symbol.children.into_iter().map(|child| self::symbol(document, encoding, child)).collect();
    lsp::DocumentSymbol {
        name: symbol.name,
        detail: Some(symbol.detail),
        kind,
        tags: None,
        #[allow(deprecated)]
        deprecated: None,
        range: encoding.range(document, symbol.range),
        selection_range: encoding.range(document, symbol.selection),
        children: (!children.is_empty()).then_some(children),
    }
}

pub fn fold(document: &Document, fold: &Fold) -> lsp::FoldingRange {
    let line = |offset: usize| document.lines.line(offset) as u32;
    lsp::FoldingRange {
        start_line: line(fold.range.start),
        end_line: line(fold.range.end),
        kind: fold.is_comment.then_some(lsp::FoldingRangeKind::Comment),
        ..lsp::FoldingRange::default()
    }
}

/// Encodes each piece relative to the previous one.
pub fn tokens(document: &Document, encoding: Encoding, pieces: &[Piece]) -> lsp::SemanticTokens {
    let mut data = Vec::with_capacity(pieces.len());
    let (mut line, mut start) = (0, 0);
    for piece in pieces {
        let position = encoding.position(document, piece.range.start);
        if position.line != line {
            start = 0;
        }
        data.push(lsp::SemanticToken {
            delta_line: position.line - line,
            delta_start: position.character - start,
            length: encoding.count(&document.text()[piece.range.clone()]),
            token_type: piece.kind as u32,
            token_modifiers_bitset: piece.marks,
        });
        (line, start) = (position.line, position.character);
    }
    lsp::SemanticTokens { result_id: None, data }
}

/// The edit that turns the document's text into the new one: whole lines, without unchanged ones at both ends.
pub fn difference(document: &Document, encoding: Encoding, new: &str) -> Vec<lsp::TextEdit> {
    let old = document.text();
    if old == new {
        return Vec::new();
    }
    let same = old.split_inclusive('\n').zip(new.split_inclusive('\n')).take_while(|(a, b)| a == b);
    let start: usize = same.map(|(line, _)| line.len()).sum();
    let (old_rest, new_rest) = (&old[start..], &new[start..]);
    let backwards = old_rest.split_inclusive('\n').rev().zip(new_rest.split_inclusive('\n').rev());
    let end: usize = backwards.take_while(|(a, b)| a == b && a.ends_with('\n')).map(|(line, _)| line.len()).sum();
    let range = encoding.range(document, start..old.len() - end);
    vec![lsp::TextEdit { range, new_text: new_rest[..new_rest.len() - end].to_string() }]
}
