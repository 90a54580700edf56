"""Emitted C: compiled, run for a thousand to a hundred thousand steps, and held against the bound in its own header."""

import os
import re
import shutil
import subprocess
from copy import deepcopy

from flint import arb, ctx, fmpq

from . import draw, motions, signals, transfer
from .exact import pi, roots
from .tally import decimal

BITS = 500
CHECKPOINTS = (0, 1, 2, 3, 10, 99, 316, 999, 1000, 3162, 9999, 31623, 100000)

DRIVER = """#include "truth.h"
#include <stdio.h>
int main(void) {
    static const unsigned long at[] = { %(at)s };
    static const double held[] = { %(held)s };
    truth_state state;
    truth_outputs outputs;
    unsigned long k;
    unsigned next = 0;
    double most = 0.0;
    truth_init(&state);
    for (k = 0; k <= %(last)sul; k++) {
        %(step)s
        %(most)s
        if (k == at[next]) {
            next++;
            printf("%(format)s %%.17g\\n", %(values)s, most);
        }
    }
    (void)held;
    return 0;
}
"""


def scene(rng):
    """A net under signals or under inputs that are held, and a step, often one that turns something by whole circles."""
    net = transfer.scene(rng, 3, rng.choice((0, 0, 0, 1)))
    base = bool(net.bases)
    net.hold = None if base else rng.choice((None, None, None, "zero", "first"))
    net.signals = []
    net.step = rng.choice(("1", "0.1", "0.01", "1e-3", "0.02", "0.25", draw.decimal_word(rng, -3, 1)))
    kind = rng.choice(("signal", "signal", "alias", "mode", "free"))
    if net.hold:
        values = [f"{rng.uniform(-1, 1):.2f}" for _ in range(8)]
        net.held = values
    elif kind == "alias":
        turns = rng.choice((1, 2, 7, 50, 92, 1000))
        net.step = rng.choice(("1", "0.1", "0.02", "10", "3550"))
        f = decimal(str(turns)) / decimal(net.step)
        shift = rng.choice(("", "", "0000001", "00000000001"))
        word = transfer.plain(arb(f).mid().str(12, radius=False))
        word = word + shift if shift and "." in word and "e" not in word else word
        net.signals = [signals.Harmonic(draw.decimal_word(rng, -1, 1, 1), word, str(rng.choice((0, 30, 90, 17, 180))))]
    elif kind != "free":
        net.signals = [signals.signal(rng, base, 1, base) for _ in range(rng.choice((1, 1, 2)))]
    if not net.hold and not net.signals:
        net.signals = [signals.Steps("step", "1", "0")]
    for i in range(net.size()):
        if rng.random() < 0.6 or kind == "free":
            net.initial[i] = (draw.decimal_word(rng, -2, 1), "-" + draw.decimal_word(rng, -2, 1))
    if kind == "mode" and not net.hold:
        whole_turn(rng, net)
    return net


def whole_turn(rng, net):
    """A step in which one mode turns by a whole number of circles, nearly."""
    ctx.prec = 200
    m, c, k = net.matrices()
    places = [s for s, _ in roots(transfer.quotient(net, *blank(net))[1], 200) if s.imag > 0]
    if places:
        period = 2 * pi() / rng.choice(places).imag * rng.choice((1, 1, 2))
        net.step = transfer.plain(period.mid().str(rng.choice((4, 8, 16)), radius=False))


def blank(net):
    row = [[fmpq(0)] * 3 for _ in range(net.size())]
    return row, row


def check(net, program, tally, rng):
    """Emits, compiles, runs and compares at some steps."""
    ctx.prec = BITS
    folder = os.path.join(program.folder, "emit")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    options = ["--hold", net.hold] if net.hold else ["--signals", "internal"]
    tally.command = f"vibc emit MODEL --target c --step {net.step}s {' '.join(options)}"
    answer = program.run("emit", net.text(), "--target", "c", "--step", net.step + "s", *options, "-o", folder, tables=net.tables)
    if answer.status != 0:
        tally.refuse(answer.reason())
        return
    with open(os.path.join(folder, "truth.h"), encoding="utf-8") as file:
        header = file.read()
    bounds = Bounds(header)
    if bounds.levels is None:
        tally.refuse("no bound in the header")
        return
    last = rng.choice((1000, 1000, 100000))
    steps = [k for k in CHECKPOINTS if k <= last]
    printed = run(net, folder, steps)
    if printed is None:
        tally.violate("code that does not compile or run", "no output", "C99")
        return
    if net.hold:
        net = as_signals(net)
    compare(net, printed, steps, bounds, tally)


class Bounds:
    """What a header says about rounding: relative to the sum of the largest parts, or to the largest output."""

    def __init__(self, header):
        text = re.sub(r"\s*\n \*\s*", " ", header)
        parts = re.search(r"rounding at most (\S+) after 1e3 steps and (\S+) after 1e5", text)
        seen = re.search(r"rounding takes at most (\S+) in (\d+) steps and (\S+) in (\d+) steps of the largest value", text)
        self.of_outputs = seen is not None
        try:
            if seen:
                self.levels = [(int(seen[2]), float(seen[1])), (int(seen[4]), float(seen[3]))]
            else:
                self.levels = [(1000, float(parts[1])), (100000, float(parts[2]))]
        except (ValueError, TypeError):
            self.levels = None

    def at(self, step):
        """How many steps the bound that holds at this one speaks of, and the bound."""
        return next(((last, bound) for last, bound in self.levels if step <= last), (step, None))


def run(net, folder, steps):
    """What the compiled code prints at these steps: a list of outputs each."""
    names = [f"y{i}" for i in range(len(net.outputs))]
    if net.hold:
        count = len(net.held)
        step = f"truth_inputs inputs; inputs.F0 = k < {count} ? held[k] : 0.0; truth_step(&state, &inputs, &outputs);"
    else:
        step = "truth_step(&state, &outputs);"
    source = DRIVER % {
        "at": ", ".join(str(k) for k in steps) + ", 0", "held": ", ".join(getattr(net, "held", ["0"])), "last": steps[-1], "step": step,
        "most": " ".join(f"if (outputs.{n} > most) most = outputs.{n}; if (-outputs.{n} > most) most = -outputs.{n};" for n in names),
        "format": " ".join("%.17g" for _ in names), "values": ", ".join(f"outputs.{name}" for name in names)}
    with open(os.path.join(folder, "main.c"), "w", encoding="utf-8") as file:
        file.write(source)
    out = os.path.join(folder, "run")
    words = ["cc", "-std=c99", "-O1", "-o", out, os.path.join(folder, "truth.c"), os.path.join(folder, "main.c"), "-lm"]
    if subprocess.run(words, capture_output=True, check=False).returncode != 0:
        return None
    done = subprocess.run([out], capture_output=True, check=False, timeout=60)
    if done.returncode != 0:
        return None
    return [[float(word) for word in line.split()] for line in done.stdout.decode().splitlines()]


def as_signals(net):
    """Inputs that were held as a signal: steps, or lines from sample to sample after a first jump."""
    h = decimal(net.step)
    pieces = []
    values = [decimal(v) for v in net.held] + [fmpq(0)]
    if net.hold == "zero":
        before = fmpq(0)
        for k, v in enumerate(values):
            pieces.append(signals.Piece(h * k, [v - before], 1))
            before = v
    else:
        pieces.append(signals.Piece(fmpq(0), [values[0]], 1))
        before = fmpq(0)
        for k, v in enumerate(values):
            slope = (values[k + 1] - v) / h if k + 1 < len(values) else fmpq(0)
            pieces.append(signals.Piece(h * k, [slope - before], 2))
            before = slope
    copy = deepcopy(net)
    copy.signals = [Held(pieces)]
    return copy


class Held:
    """An input as pieces of a signal."""

    def __init__(self, found):
        self.found = found

    def pieces(self):
        return self.found


def compare(net, printed, steps, bounds, tally):
    """The outputs at each checkpoint; the bound is relative to the sum of the largest parts so far."""
    h = decimal(net.step)
    most = {k: row[-1] for k, row in zip(steps, printed)}
    for i in range(len(net.outputs)):
        try:
            motion = motions.Motion(net, i)
        except ValueError:
            continue
        for k, row in zip(steps, printed):
            t = h * k
            last, bound = bounds.at(k)
            told = row[i]
            if bound is None:
                continue
            size = arb(most.get(last, row[-1])) if bounds.of_outputs else largest(motion, t)
            if told != told or abs(told) == float("inf"):
                tally.violate("no number", told, "a number")
                continue
            truth = motion.at(t)
            words = f"{truth.str(25, radius=False)}, size {size.str(5, radius=False)}"
            unit = size if size > 0 else arb(1)
            tally.settle("emitted output", told, f"{bound} at step {k}", size * bound, abs(arb(told) - truth), words, unit)


def largest(motion, t):
    """The sum of the largest sizes that the parts have had up to a time."""
    total = arb(0)
    for delay, fractions in motion.terms:
        if t < delay:
            continue
        for part in fractions:
            total += abs(motions.evaluated([part], fmpq(0))).max(abs(motions.evaluated([part], t - delay)))
    for chirp in motion.chirps:
        total += sum((abs(gs[0]) / (abs(p) + 1) for p, gs in motion.impulse), arb(0)) * abs(arb(decimal(chirp.a)))
    return total
