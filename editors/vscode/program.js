// The program `vibc` of the settings, and runs of it.
const { execFile } = require('child_process');
const os = require('os');
const path = require('path');
const vscode = require('vscode');

/** The program of the settings, with `~` and `${workspaceFolder}` as VS Code's own settings have them. */
exports.program = () => {
  const written = vscode.workspace.getConfiguration('vib').get('program') || 'vibc';
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath ?? '';
  const full = written.replaceAll('${workspaceFolder}', folder).replaceAll('${userHome}', os.homedir());
  return full === '~' || full.startsWith('~/') ? path.join(os.homedir(), full.slice(1)) : full;
};

/** Runs the program; resolves to what it prints, rejects where it cannot be started or fails. */
exports.run = (args, { input, cwd } = {}) => new Promise((resolve, reject) => {
  const child = execFile(exports.program(), args, { timeout: 60_000, maxBuffer: 64 << 20, cwd }, (error, printed, said) => {
    if (error) reject(Object.assign(error, { said }));
    else resolve(printed);
  });
  // A program that has ended reads nothing.
  child.stdin.on('error', () => {});
  child.stdin.end(input ?? '');
});
