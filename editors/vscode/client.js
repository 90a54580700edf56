// Starts `vibc lsp` for model files, restarts it when the program's setting changes, and shows the page of a finding's code.
const { execFile } = require('child_process');
const os = require('os');
const path = require('path');
const vscode = require('vscode');
const { LanguageClient, State } = require('vscode-languageclient/node');

let client;

/** The program of the settings, with `~` and `${workspaceFolder}` as VS Code's own settings have them. */
function program() {
  const written = vscode.workspace.getConfiguration('vib').get('program') || 'vibc';
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath ?? '';
  const full = written.replaceAll('${workspaceFolder}', folder).replaceAll('${userHome}', os.homedir());
  return full === '~' || full.startsWith('~/') ? path.join(os.homedir(), full.slice(1)) : full;
}

/** Runs the program; resolves to what it prints, rejects where it cannot be started or fails. */
function run(args) {
  return new Promise((resolve, reject) => {
    execFile(program(), args, { timeout: 10_000 }, (error, printed) => (error ? reject(error) : resolve(printed)));
  });
}

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

async function start() {
  try {
    await run(['--version']);
  } catch (error) {
    missing(error);
    return;
  }
  const middleware = {
    // The server would answer with a message; a page is for reading.
    executeCommand: (command, args, next) => (command === 'vibc.explain' ? showPage(args[0]) : next(command, args)),
  };
  const server = { command: program(), args: ['lsp'] };
  client = new LanguageClient('vib', 'vibc', server, { documentSelector: [{ language: 'vib' }], middleware });
  await client.start();
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
  const pages = {
    provideTextDocumentContent: (uri) => {
      const code = uri.path.replace(/^\//, '').replace(/\.md$/, '');
      return run(['explain', code]).catch(() => `There is no page for \`${code}\`.`);
    },
  };
  context.subscriptions.push(
    vscode.workspace.registerTextDocumentContentProvider('vibc', pages),
    vscode.commands.registerCommand('vib.restart', restart),
    vscode.commands.registerCommand('vib.output', () => client?.outputChannel.show()),
    vscode.workspace.onDidChangeConfiguration((change) => change.affectsConfiguration('vib.program') && restart()),
  );
  await start();
};

exports.deactivate = stop;
