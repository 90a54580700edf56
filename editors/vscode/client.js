// Starts `vibc lsp` for model files, and shows the page of a finding's code (`vibc explain`) where its link is followed.
const { execFile } = require('child_process');
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');

let client;

exports.activate = async (context) => {
  const program = vscode.workspace.getConfiguration('vib').get('program');
  const pages = {
    provideTextDocumentContent: (uri) => new Promise((resolve) => {
      const code = uri.path.replace(/^\//, '').replace(/\.md$/, '');
      execFile(program, ['explain', code], (error, page) => resolve(error ? `no page for ${code}` : page));
    }),
  };
  context.subscriptions.push(vscode.workspace.registerTextDocumentContentProvider('vibc', pages));
  const server = { command: program, args: ['lsp'] };
  client = new LanguageClient('vibc', 'vibc', server, { documentSelector: [{ language: 'vib' }] });
  await client.start();
};

exports.deactivate = () => client && client.stop();
