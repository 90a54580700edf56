// Commands that run the program on the text in front, shown beside it; code lenses that call them; tasks.
const path = require('path');
const vscode = require('vscode');
const { program, run } = require('./program');

/** What is shown beside the text: the name of the command, its arguments, and the language of what it prints. */
const SHOWN = {
  analyze: { title: 'Analyze', args: async () => ['analyze', '--format', 'markdown'], markdown: true },
  transfer: { title: 'Transfer functions', args: async () => ['transfer', '--format', 'markdown'], markdown: true },
  equations: { title: 'Equations', args: async () => ['equations'], language: 'plaintext' },
  simulate: {
    title: 'Simulate',
    args: async () => {
      const until = await vscode.window.showInputBox({ prompt: 'How long', value: '10 s', validateInput: time });
      const step = until && await vscode.window.showInputBox({ prompt: 'Step of the samples', value: '10 ms', validateInput: time });
      return step && ['simulate', '--until', until.replaceAll(' ', ''), '--step', step.replaceAll(' ', ''), '--format', 'markdown'];
    },
    markdown: true,
  },
  emit: {
    title: 'Emit code',
    args: async () => {
      const target = await vscode.window.showQuickPick(['c', 'rust'], { placeHolder: 'Language' });
      const step = target && await vscode.window.showInputBox({ prompt: 'Step of the code', value: '1 ms', validateInput: time });
      return step && ['emit', '--target', target, '--step', step.replaceAll(' ', '')];
    },
    language: 'c',
  },
};

const time = (text) => (/^\s*[\d.]+(e-?\d+)?\s*(us|ms|s|min)\s*$/.test(text) ? undefined : 'a time, such as 10 s');

/** What was printed last, by the address of its page. */
const printed = new Map();
const changed = new vscode.EventEmitter();

/** Runs a command on the text as it stands in the editor, saved or not. */
async function show(name) {
  const editor = vscode.window.activeTextEditor;
  if (editor?.document.languageId !== 'vib') return;
  const { args, markdown, language } = SHOWN[name];
  const wanted = await args();
  if (!wanted) return;
  const { document } = editor;
  const cwd = document.uri.scheme === 'file' ? path.dirname(document.uri.fsPath) : undefined;
  const text = await run([...wanted.slice(0, 1), '-', ...wanted.slice(1)], { input: document.getText(), cwd })
    .catch((error) => (markdown ? `\`\`\`text\n${error.said || error.message}\n\`\`\`\n` : error.said || error.message));
  const file = path.basename(document.uri.path, '.vib');
  const uri = vscode.Uri.from({ scheme: 'vibc-result', path: `/${file} ${name}.${markdown ? 'md' : 'txt'}` });
  printed.set(uri.toString(), text);
  changed.fire(uri);
  if (markdown) {
    await vscode.commands.executeCommand('markdown.showPreviewToSide', uri);
    return;
  }
  const result = await vscode.workspace.openTextDocument(uri);
  await vscode.languages.setTextDocumentLanguage(result, wanted.includes('rust') ? 'rust' : language);
  await vscode.window.showTextDocument(result, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true });
}

/** Over `model` what can be done with it, over each `require` how it is checked. */
const lenses = {
  provideCodeLenses: (document) => {
    const list = [];
    const add = (line, title, command) => list.push(new vscode.CodeLens(document.lineAt(line).range, { title, command }));
    for (let line = 0; line < document.lineCount; line++) {
      const { text } = document.lineAt(line);
      if (/^model\b/.test(text)) {
        add(line, 'Preview', 'vib.preview');
        for (const name of ['analyze', 'transfer', 'simulate', 'emit']) add(line, SHOWN[name].title, `vib.${name}`);
      } else if (/^require\b/.test(text)) {
        add(line, 'Check requirements', 'vib.check');
      }
    }
    return list;
  },
};

/** A task of the program on a file; its findings go to Problems. */
function task(command, file) {
  const args = command === 'report' ? ['report', file, '-o', file.replace(/\.vib$/, '.html')]
    : command === 'check' ? ['check', '--message-format', 'short', file] : [command, file];
  const definition = { type: 'vibc', command, file };
  const made = new vscode.Task(definition, vscode.TaskScope.Workspace, `${command} ${path.basename(file)}`, 'vibc', new vscode.ProcessExecution(program(), args), '$vibc');
  if (command === 'check') made.group = vscode.TaskGroup.Build;
  return made;
}

const tasks = {
  provideTasks: () => {
    const document = vscode.window.activeTextEditor?.document;
    if (document?.languageId !== 'vib' || document.uri.scheme !== 'file') return [];
    return ['check', 'analyze', 'report'].map((command) => task(command, document.uri.fsPath));
  },
  resolveTask: ({ definition }) => (definition.file ? task(definition.command, definition.file) : undefined),
};

async function check() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== 'vib') return;
  await document.save();
  await vscode.tasks.executeTask(task('check', document.uri.fsPath));
}

exports.register = () => [
  changed,
  ...Object.keys(SHOWN).map((name) => vscode.commands.registerCommand(`vib.${name}`, () => show(name))),
  vscode.commands.registerCommand('vib.check', check),
  vscode.workspace.registerTextDocumentContentProvider('vibc-result', {
    onDidChange: changed.event,
    provideTextDocumentContent: (uri) => printed.get(uri.toString()) ?? '',
  }),
  vscode.languages.registerCodeLensProvider({ language: 'vib' }, lenses),
  vscode.tasks.registerTaskProvider('vibc', tasks),
];
