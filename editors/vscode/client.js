// Starts `vibc lsp` for model files and keeps the preview beside them. What the other commands do is in `commands.js`, the
// preview in `preview.js`; esbuild makes one file of all.
const vscode = require('vscode');
const { LanguageClient, State } = require('vscode-languageclient/node');
const commands = require('./commands');
const { Preview } = require('./preview');
const { program, run } = require('./program');

let client;
let preview;
let status;

/** Tells what to do where the program is missing: which name was tried, and where another one is said. */
async function missing(error) {
  const why = error.code === 'ENOENT' ? 'there is no such program' : error.message;
  const told = `The language server could not be started: \`${program()}\` (${why}). Install it with \`cargo install --path .\` in a checkout of vibc, or say in the setting vib.program where it is.`;
  if (await vscode.window.showErrorMessage(told, 'Open the setting')) {
    await vscode.commands.executeCommand('workbench.action.openSettings', 'vib.program');
  }
}

/** The page of a code, as Markdown is read. */
function showPage(code) {
  const page = vscode.Uri.from({ scheme: 'vibc', path: `/${code}.md` });
  return vscode.commands.executeCommand('markdown.showPreview', page);
}

/** What the status item says of the server and of the text in front. */
function say(text, severity = vscode.LanguageStatusSeverity.Information, detail = '') {
  Object.assign(status, { text, severity, detail });
}

function sayFindings(uri) {
  if (vscode.window.activeTextEditor?.document.uri.toString() !== uri.toString()) return;
  const errors = vscode.languages.getDiagnostics(uri).filter(({ severity }) => severity === vscode.DiagnosticSeverity.Error).length;
  if (errors) say(`vib: ${errors} ${errors === 1 ? 'error' : 'errors'}`, vscode.LanguageStatusSeverity.Error);
  else say('vib: no errors');
}

async function start() {
  let version;
  try {
    version = (await run(['--version'])).trim();
  } catch (error) {
    say('vib: not started', vscode.LanguageStatusSeverity.Error, program());
    missing(error);
    return;
  }
  const middleware = {
    // The server would answer with a message; a page is for reading.
    executeCommand: (command, args, next) => (command === 'vibc.explain' ? showPage(args[0]) : next(command, args)),
    // Findings tell that a text has gone through every stage: the preview is asked for then.
    handleDiagnostics: (uri, diagnostics, next) => {
      next(uri, diagnostics);
      sayFindings(uri);
      preview.update(uri);
    },
  };
  const server = { command: program(), args: ['lsp'] };
  client = new LanguageClient('vib', 'vibc', server, { documentSelector: [{ language: 'vib' }], middleware });
  await client.start();
  say('vib', vscode.LanguageStatusSeverity.Information, version);
}

async function stop() {
  const running = client;
  client = undefined;
  if (running && running.state !== State.Stopped) {
    await running.stop().catch(() => {});
  }
}

async function restart() {
  await stop();
  await start();
}

exports.activate = async (context) => {
  status = vscode.languages.createLanguageStatusItem('vib.status', { language: 'vib' });
  status.name = 'vib';
  status.command = { command: 'vib.restart', title: 'Restart' };
  say('vib: starting');
  preview = new Preview((uri) => client?.sendRequest('vibc/page', { textDocument: { uri: uri.toString() } }));
  const pages = {
    provideTextDocumentContent: (uri) => {
      const code = uri.path.replace(/^\//, '').replace(/\.md$/, '');
      return run(['explain', code]).catch(() => `There is no page for \`${code}\`.`);
    },
  };
  context.subscriptions.push(
    status,
    preview,
    vscode.workspace.registerTextDocumentContentProvider('vibc', pages),
    vscode.commands.registerCommand('vib.restart', restart),
    vscode.commands.registerCommand('vib.output', () => client?.outputChannel.show()),
    vscode.commands.registerCommand('vib.preview', () => preview.open()),
    vscode.window.onDidChangeActiveTextEditor((editor) => editor?.document.languageId === 'vib' && sayFindings(editor.document.uri)),
    vscode.workspace.onDidChangeConfiguration((change) => change.affectsConfiguration('vib.program') && restart()),
    ...commands.register(),
  );
  await start();
};

exports.deactivate = stop;
