"""The program under test, driven as a process: a model on its standard input, its answer read back."""

import json
import os
import resource
import signal
import subprocess
import tempfile

# Processor seconds of one run, so that other work on the machine does not count; and wall-clock seconds, for one that hangs.
TIME_LIMIT = 10
PATIENCE = 600.0


def limit_time():
    """Ends the process by SIGXCPU after its processor seconds; another process inherits nothing of it."""
    resource.setrlimit(resource.RLIMIT_CPU, (TIME_LIMIT, TIME_LIMIT + 1))


class Answer:
    """What one run of the program left: exit status, standard output, standard error."""

    def __init__(self, status, out, err):
        self.status = status
        self.out = out
        self.err = err

    def json(self):
        """The standard output read as JSON, or None where it is none."""
        try:
            return json.loads(self.out)
        except ValueError:
            return None

    def codes(self):
        """The codes of the findings on standard error, in their order."""
        found = []
        for line in self.err.splitlines():
            try:
                found.append(json.loads(line)["code"])
            except (ValueError, KeyError, TypeError):
                continue
        return found

    def reason(self):
        """One word for why there is no answer: the first error's code, or the exit status."""
        for line in self.err.splitlines():
            try:
                finding = json.loads(line)
            except ValueError:
                continue
            if isinstance(finding, dict) and finding.get("severity") == "error":
                return finding.get("code", "error")
        return f"status {self.status}"


TOO_LONG = Answer(-1, "", '{"code": "timeout", "severity": "error"}')


class Program:
    """The binary, and a folder of its own for models and tables."""

    def __init__(self, path):
        self.path = os.path.abspath(path)
        memory = "/dev/shm"
        self.home = tempfile.TemporaryDirectory(prefix="truth", dir=memory if os.path.isdir(memory) else None)
        self.folder = self.home.name
        self.runs = 0

    def run(self, command, text, *options, tables=None):
        """Runs `command` on the model; `tables` are files that stand beside it."""
        for name, content in (tables or {}).items():
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(content)
        model = os.path.join(self.folder, "model.vib")
        with open(model, "w", encoding="utf-8") as file:
            file.write(text)
        self.runs += 1
        words = [self.path, command, model, *options, "--message-format", "json"]
        try:
            done = subprocess.run(words, capture_output=True, timeout=PATIENCE, check=False, preexec_fn=limit_time)
        except subprocess.TimeoutExpired:
            return TOO_LONG
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return TOO_LONG
        return Answer(done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace"))

    def ask(self, tally, command, text, *options, tables=None):
        """The JSON that `command` prints; without one None, and the tally has the reason."""
        tally.command = " ".join(["vibc", command, "MODEL", *options])
        tally.model = text
        answer = self.run(command, text, *options, tables=tables)
        told = answer.json()
        if told is None:
            tally.refuse(answer.reason())
        return told
