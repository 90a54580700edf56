//! Requests by their methods: parameters in, answers out, obtained from the responsible module.

use super::answers;
use super::files::shown_at;
use super::{Refusal, Server};
use crate::backend::explain;
use crate::base::Diagnostic;
use crate::editor::document::Document;
use crate::editor::project::{At, Project};
use crate::editor::{completion, fixes, highlight, hints, hover, names, preview, signature, symbols};
use gen_lsp_types::{
    CodeActionParams, CodeActionRequest, CompletionRequest, DefinitionRequest, DocumentFormattingRequest,
    DocumentHighlight, DocumentHighlightRequest, DocumentSymbolRequest, ExecuteCommandParams, ExecuteCommandRequest,
    FoldingRangeRequest, HoverRequest, InlayHintRequest, Location, Position, PrepareRenamePlaceholder,
    PrepareRenameRequest, ReferencesRequest, RenameRequest, Request, SemanticTokensRequest, SignatureHelpRequest,
    TextDocumentPositionParams, Uri,
};
use lsp_server::{ErrorCode, Notification};
use serde_json::Value;
use std::ops::Range;

type Answer<R> = Result<<R as Request>::Result, Refusal>;

impl Server<'_> {
    pub(super) fn answer(&mut self, method: &str, params: Value) -> Result<Value, Refusal> {
        match method {
            "textDocument/hover" => {
                self.answer_request::<HoverRequest>(params, |s, p| s.hover(p.text_document_position_params))
            }
            "textDocument/inlayHint" => self.answer_request::<InlayHintRequest>(params, |s, p| {
                let (document, range) = s.part(&p.text_document.uri, p.range)?;
                let wanted =
                    hints::hints(document).into_iter().filter(|hint| range.start <= hint.at && hint.at <= range.end);
                Ok(Some(wanted.map(|hint| answers::hint(document, s.encoding, hint)).collect()))
            }),
            "textDocument/completion" => {
                self.answer_request::<CompletionRequest>(params, |s, p| s.completion(p.text_document_position_params))
            }
            "textDocument/definition" => self.answer_request::<DefinitionRequest>(params, |s, p| {
                let places = s.places(&p.text_document_position_params, false, names::declarations)?;
                Ok(Some(gen_lsp_types::Definition::LocationList(places).into()))
            }),
            "textDocument/references" => self.answer_request::<ReferencesRequest>(params, |s, p| {
                let all = p.context.include_declaration;
                let find = |project: &Project, name| names::references(project, name, all);
                s.places(&p.text_document_position_params, true, find).map(Some)
            }),
            "textDocument/documentHighlight" => self.answer_request::<DocumentHighlightRequest>(params, |s, p| {
                let own = |at: &At| at.file == 0;
                let find =
                    |project: &Project, name| names::references(project, name, true).into_iter().filter(own).collect();
                let places = s.places(&p.text_document_position_params, false, find)?;
                Ok(Some(places.into_iter().map(|place| DocumentHighlight { range: place.range, kind: None }).collect()))
            }),
            "textDocument/prepareRename" => self.answer_request::<PrepareRenameRequest>(params, |s, p| {
                s.prepare_rename(&p.text_document_position_params)
            }),
            "textDocument/rename" => self.answer_request::<RenameRequest>(params, |s, p| {
                let (index, _, offset) = s.asked_at(&p.text_document_position_params)?;
                s.in_project(index, true, |project| {
                    let none = || refusal("there is no name here".into());
                    let name = names::name_at(project, offset).ok_or_else(none)?;
                    let places = names::rename(project, name, &p.new_name).map_err(refusal)?;
                    let edits = places.into_iter().filter_map(|at| s.location(project, at));
                    Ok(Some(answers::edits_of(edits.map(|location| (location, p.new_name.clone())))))
                })
            }),
            "textDocument/documentSymbol" => self.answer_request::<DocumentSymbolRequest>(params, |s, p| {
                let document = s.document(&p.text_document.uri)?;
                let list = symbols::symbols(document).into_iter();
                let list: Vec<_> = list.map(|symbol| answers::symbol(document, s.encoding, symbol)).collect();
                Ok(Some(list.into()))
            }),
            "textDocument/semanticTokens/full" => self.answer_request::<SemanticTokensRequest>(params, |s, p| {
                let document = s.document(&p.text_document.uri)?;
                Ok(Some(answers::tokens(document, s.encoding, &highlight::pieces(document))))
            }),
            "textDocument/foldingRange" => self.answer_request::<FoldingRangeRequest>(params, |s, p| {
                let document = s.document(&p.text_document.uri)?;
                Ok(Some(symbols::folds(document).iter().map(|fold| answers::fold(document, fold)).collect()))
            }),
            "textDocument/formatting" => self.answer_request::<DocumentFormattingRequest>(params, |s, p| {
                let document = s.document(&p.text_document.uri)?;
                let laid_out = crate::format(&document.sources, document.file);
                if laid_out.answer.is_none() {
                    s.show(MESSAGE_WARNING, not_laid_out(document, &laid_out.diagnostics));
                }
                Ok(laid_out.answer.map(|text| answers::difference(document, s.encoding, &text)))
            }),
            "textDocument/signatureHelp" => self.answer_request::<SignatureHelpRequest>(params, |s, p| {
                let (index, document, offset) = s.asked_at(&p.text_document_position_params)?;
                let ask = |project: &Project| signature::signature(document, project, offset);
                Ok(s.in_project(index, false, ask).map(answers::signature))
            }),
            "vibc/page" => self.page(&params),
            "textDocument/codeAction" => self.answer_request::<CodeActionRequest>(params, |s, p| s.actions(&p)),
            "workspace/executeCommand" => self.answer_request::<ExecuteCommandRequest>(params, |s, p| s.execute(&p)),
            _ => Err(Refusal { code: ErrorCode::MethodNotFound, message: format!("`{method}` is not known") }),
        }
    }

    /// Reads the parameters, brings every text up to date, and gets the answer.
    fn answer_request<R: Request>(
        &mut self,
        params: Value,
        ask: impl FnOnce(&Self, R::Params) -> Answer<R>,
    ) -> Result<Value, Refusal> {
        let invalid = |error: serde_json::Error| Refusal { code: ErrorCode::InvalidParams, message: error.to_string() };
        let params = serde_json::from_value(params).map_err(invalid)?;
        self.publish_all();
        serde_json::to_value(ask(self, params)?).map_err(invalid)
    }

    /// The page beside a text, an extension of the protocol: `null` if the scene is too large for one.
    fn page(&mut self, params: &Value) -> Result<Value, Refusal> {
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
        self.publish_all();
        let document = self.document(&Uri(uri.into()))?;
        let html = preview::page(document).map_or(Value::Null, Value::String);
        Ok([("html".to_string(), html)].into_iter().collect())
    }

    fn document(&self, uri: &Uri) -> Result<&Document, Refusal> {
        self.text(uri).map(|(_, document)| document)
    }

    fn text(&self, uri: &Uri) -> Result<(usize, &Document), Refusal> {
        let index = self.texts.iter().position(|text| text.uri == *uri);
        let found = index.and_then(|index| Some((index, self.texts[index].document.as_ref()?)));
        found.ok_or_else(|| refusal(format!("`{}` is not open", uri.0)))
    }

    /// The text that is asked about, and the byte.
    fn asked_at(&self, place: &TextDocumentPositionParams) -> Result<(usize, &Document, usize), Refusal> {
        let (index, document) = self.text(&place.text_document.uri)?;
        Ok((index, document, self.encoding.offset(document, place.position)))
    }

    fn part(&self, uri: &Uri, range: gen_lsp_types::Range) -> Result<(&Document, Range<usize>), Refusal> {
        let document = self.document(uri)?;
        let offset = |position: Position| self.encoding.offset(document, position);
        Ok((document, offset(range.start)..offset(range.end)))
    }

    fn hover(&self, place: TextDocumentPositionParams) -> Answer<HoverRequest> {
        let (index, document, offset) = self.asked_at(&place)?;
        let found = self.in_project(index, false, |project| hover::hover(document, project, offset));
        Ok(found.map(|hover| answers::hover(document, self.encoding, hover)))
    }

    fn completion(&self, place: TextDocumentPositionParams) -> Answer<CompletionRequest> {
        let (index, document, offset) = self.asked_at(&place)?;
        let range = self.encoding.range(document, completion::typed_prefix(document, offset));
        let items = self.in_project(index, false, |project| completion::items(document, project, offset));
        let items: Vec<_> =
            items.into_iter().enumerate().map(|(order, item)| answers::item(order, item, range)).collect();
        Ok(Some(items.into()))
    }

    /// The places that a name refers to; empty if there is no name.
    fn places(
        &self,
        place: &TextDocumentPositionParams,
        is_wide: bool,
        find: impl FnOnce(&Project, At) -> Vec<At>,
    ) -> Result<Vec<Location>, Refusal> {
        let (index, _, offset) = self.asked_at(place)?;
        Ok(self.in_project(index, is_wide, |project| {
            let found = names::name_at(project, offset).map_or(Vec::new(), |name| find(project, name));
            found.into_iter().filter_map(|at| self.location(project, at)).collect()
        }))
    }

    /// The location of a token; `None` in a file that comes with the program.
    fn location(&self, project: &Project, at: At) -> Option<Location> {
        let lexed = project.lexed_text(at.file);
        let range = self.encoding.range(lexed, lexed.tokens[at.token].range.clone());
        Some(Location { uri: self.uri(&project.files[at.file].key)?, range })
    }

    fn prepare_rename(&self, place: &TextDocumentPositionParams) -> Answer<PrepareRenameRequest> {
        let (index, document, offset) = self.asked_at(place)?;
        let name = self.in_project(index, false, |project| names::name_at(project, offset));
        let Some(At { token, .. }) = name else { return Ok(None) };
        let range = self.encoding.range(document, document.tokens[token].range.clone());
        let placeholder = document.token_text(token).to_string();
        Ok(Some(PrepareRenamePlaceholder { range, placeholder }.into()))
    }

    fn actions(&self, params: &CodeActionParams) -> Answer<CodeActionRequest> {
        let uri = &params.text_document.uri;
        let (document, range) = self.part(uri, params.range)?;
        let (index, _) = self.text(uri)?;
        let places = self.places_of(&self.texts[index], document);
        let fixes = params.context.only.as_ref().is_none_or(|only| only.iter().any(answers::is_quick_fix));
        let touches = |place: Range<usize>| place.start <= range.end && range.start <= place.end;
        let mut actions = Vec::new();
        for finding in document.findings.iter().filter(|_| fixes) {
            if !touches(shown_at(document, finding)) {
                continue;
            }
            let diagnostic = answers::diagnostic(document, self.encoding, &places, finding);
            for (order, action) in fixes::actions(document, finding).into_iter().enumerate() {
                let edit = answers::workspace_edit(document, self.encoding, uri, action.edits);
                actions.push(answers::action(action.title, diagnostic.clone(), edit, order == 0));
            }
            actions.push(answers::explain(finding.code.0, diagnostic));
        }
        Ok(Some(actions))
    }

    /// `vibc.explain CODE`: returns the code's page, and also shows it as a message.
    fn execute(&self, params: &ExecuteCommandParams) -> Answer<ExecuteCommandRequest> {
        let code = params.arguments.as_ref().and_then(|arguments| arguments.first()?.as_str());
        let (answers::EXPLAIN, Some(code)) = (params.command.as_str(), code) else {
            return Err(refusal(format!("`{}` is no command of this server", params.command)));
        };
        let page = explain::explain(code, std::iter::empty(), explain::WIDTH)
            .map_err(|_| refusal(format!("no diagnostic has the code `{code}`")))?;
        self.show(MESSAGE_INFO, page.clone());
        Ok(Some(page.into()))
    }

    /// Shows a message to the user.
    fn show(&self, kind: u32, message: String) {
        let params = serde_json::json!({ "type": kind, "message": message });
        self.send(Notification::new("window/showMessage".into(), params));
    }
}

/// The protocol's `MessageType`.
const MESSAGE_WARNING: u32 = 2;
const MESSAGE_INFO: u32 = 3;

/// The reason why a text is not formatted: the first error of its syntax.
fn not_laid_out(document: &Document, findings: &[Diagnostic]) -> String {
    let first = findings.iter().find(|finding| finding.is_error());
    let line = first.map(|finding| document.lines.line(finding.primary.span.start()) + 1);
    let place = line.map_or(String::new(), |line| format!(" in line {line}"));
    format!("The layout is left as it is: fix the syntax error{place} first.")
}

fn refusal(message: String) -> Refusal {
    Refusal { code: ErrorCode::RequestFailed, message }
}
