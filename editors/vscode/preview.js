// The page beside a text: the server makes it, and its own script puts each new version in the place of the last one. A click on
// a part selects its line, and the cursor's line marks its part.
const vscode = require('vscode');

exports.Preview = class Preview {
  /** `ask`: the page of a text, by its URI. */
  constructor(ask) {
    this.ask = ask;
    this.panel = undefined;
    this.uri = undefined;
    this.watching = [
      vscode.window.onDidChangeActiveTextEditor((editor) => editor && this.follow(editor)),
      vscode.window.onDidChangeTextEditorSelection(({ textEditor, kind }) => {
        // What a click in the page selected is marked there already.
        if (kind !== undefined && this.shows(textEditor.document.uri)) this.mark(textEditor);
      }),
    ];
  }

  shows(uri) {
    return this.panel !== undefined && this.uri?.toString() === uri.toString();
  }

  async open() {
    const editor = vscode.window.activeTextEditor;
    if (editor?.document.languageId !== 'vib') return;
    if (!this.panel) {
      const column = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      this.panel = vscode.window.createWebviewPanel('vib.preview', 'vib', column, { enableScripts: true, localResourceRoots: [] });
      this.panel.onDidDispose(() => { this.panel = undefined; this.uri = undefined; });
      this.panel.webview.onDidReceiveMessage((message) => this.hear(message));
    }
    this.panel.reveal(undefined, true);
    await this.show(editor.document.uri);
  }

  follow(editor) {
    if (this.panel && editor.document.languageId === 'vib' && !this.shows(editor.document.uri)) this.show(editor.document.uri);
  }

  async page(uri) {
    const answer = await Promise.resolve(this.ask(uri)).catch(() => undefined);
    return answer?.html ?? undefined;
  }

  /** A text that was not shown before. */
  async show(uri) {
    this.uri = uri;
    this.ready = false;
    const html = await this.page(uri);
    if (!this.shows(uri)) return;
    this.panel.title = `Preview ${uri.path.split('/').pop()}`;
    this.panel.webview.html = html ?? '<!doctype html><p>There is no page for this model: it is not open in the language server, or too large.';
    this.isPage = html !== undefined;
  }

  /** A new version of the text that is shown. Of several that come while one is made, the last counts. */
  async update(uri) {
    if (!this.shows(uri)) return;
    if (this.isMaking) {
      this.isStale = true;
      return;
    }
    this.isMaking = true;
    do {
      this.isStale = false;
      if (!this.isPage) await this.show(uri);
      else {
        const html = await this.page(uri);
        if (html !== undefined && this.shows(uri)) this.panel.webview.postMessage({ page: html });
      }
    } while (this.isStale && this.shows(uri));
    this.isMaking = false;
  }

  mark(editor) {
    this.panel.webview.postMessage({ line: editor.selection.active.line + 1 });
  }

  async hear({ line }) {
    if (typeof line !== 'number' || !this.uri) return;
    const open = vscode.window.visibleTextEditors.find(({ document }) => this.shows(document.uri));
    const editor = open ?? await vscode.window.showTextDocument(this.uri, { viewColumn: vscode.ViewColumn.One });
    const text = editor.document.lineAt(Math.min(line, editor.document.lineCount) - 1).range;
    editor.selection = new vscode.Selection(text.start, text.end);
    editor.revealRange(text, vscode.TextEditorRevealType.InCenterIfOutsideViewport);
  }

  dispose() {
    this.watching.forEach((watch) => watch.dispose());
    this.panel?.dispose();
  }
};
