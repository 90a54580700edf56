"""Emitted C: compiled, run for a thousand to a hundred thousand steps, and held against the bound in its own header."""

import os
import re
from math import pi as PI
import shutil
import subprocess

from flint import arb, ctx, fmpq

from . import draw, held, motions, signals, transfer
from .exact import pi, roots
from .tally import decimal

BITS = 500
CHECKPOINTS = (0, 1, 2, 3, 5, 7, 10, 17, 31, 56, 99, 177, 316, 562, 999, 1000, 3162, 9999, 31623, 100000)

DRIVER = """#include "truth.h"
#include <stdio.h>
int main(void) {
    static const unsigned long at[] = { %(at)s };
    truth_state state;
    truth_outputs outputs;
    unsigned long k;
    unsigned next = 0;
    double most[%(count)s] = {0.0};
    truth_init(&state);
    for (k = 0; k <= %(last)sul; k++) {
        truth_step(&state, &outputs);
        %(most)s
        if (k == at[next]) {
            next++;
            printf("%(format)s %(format)s\\n", %(values)s, %(mosts)s);
        }
    }
    return 0;
}
"""


# The emitted code once more in long double, with names of its own.
WIDE = """#define double long double
#define truth_state wide_state
#define truth_inputs wide_inputs
#define truth_outputs wide_outputs
#define truth_motion wide_motion
#define truth_init wide_init
#define truth_reset wide_reset
#define truth_step wide_step
#define truth_set_state wide_set_state
#define truth_get_state wide_get_state
"""

# Of a few inputs each the one is chosen after which the rounding errors of the states are largest, for a bound for all inputs speaks
# of roundings that conspire. The long doubles only choose; what is printed is compared with the truth.
STEERED = """#include "truth.h"
#undef VIBC_TRUTH_H
""" + WIDE + """#include "truth.h"
#undef double
#undef truth_state
#undef truth_inputs
#undef truth_outputs
#undef truth_init
#undef truth_step
#include <stdio.h>
static unsigned long long bits = 88172645463325252ull;
static double noise(void) {
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    return (double)(bits >> 11) * 0x1p-52 - 1.0;
}
#define COUNT (sizeof(truth_state) / sizeof(double))
static double used[%(last)s + 1];
static double sizes[COUNT];
/* 0 for the states of other blocks than the one that is steered. */
static double shares[COUNT];
static int block[COUNT];
static int blocks;
static double error(const truth_state *state, const wide_state *wide) {
    const double *a = (const double *)state;
    const long double *b = (const long double *)wide;
    double sum = 0.0;
    for (unsigned i = 0; i < COUNT; i++) {
        if (sizes[i] > 0.0 && shares[i] > 0.0) {
            const double e = (double)(a[i] - b[i]) / sizes[i];
            sum += e * e;
        }
    }
    return sum;
}
/* States that act on each other in a step without inputs are a block. */
static void find_blocks(void) {
    static wide_state zero;
    static long double to[COUNT][COUNT];
    const wide_inputs none = {0};
    wide_state still = zero;
    wide_outputs nothing;
    wide_step(&still, &none, &nothing);
    for (unsigned j = 0; j < COUNT; j++) {
        wide_state trial = zero;
        wide_outputs ignored;
        ((long double *)&trial)[j] = 1.0L;
        wide_step(&trial, &none, &ignored);
        for (unsigned i = 0; i < COUNT; i++) to[i][j] = ((long double *)&trial)[i] - ((long double *)&still)[i];
    }
    for (unsigned i = 0; i < COUNT; i++) block[i] = -1;
    for (unsigned i = 0; i < COUNT; i++) {
        if (block[i] >= 0) continue;
        block[i] = blocks;
        for (int again = 1; again;) {
            again = 0;
            for (unsigned k = 0; k < COUNT; k++) for (unsigned l = 0; l < COUNT; l++) {
                if (block[k] == blocks && block[l] < 0 && (to[k][l] != 0.0L || to[l][k] != 0.0L)) {
                    block[l] = blocks;
                    again = 1;
                }
            }
        }
        blocks++;
    }
}
/* The sign of the input after which the steered states are larger: as a swing is pushed. */
static double push(const truth_state *state) {
    double after[2];
    for (int k = 0; k < 2; k++) {
        truth_state trial = *state;
        truth_outputs ignored;
        const truth_inputs inputs = { k ? 0x1p20 : -0x1p20 };
        truth_step(&trial, &inputs, &ignored);
        after[k] = 0.0;
        for (unsigned i = 0; i < COUNT; i++) {
            const double x = sizes[i] > 0.0 ? ((const double *)&trial)[i] / sizes[i] : 0.0;
            after[k] += shares[i] * x * x;
        }
    }
    return after[1] < after[0] ? -1.0 : 1.0;
}
int main(void) {
    static const unsigned long at[] = { %(at)s };
    truth_state state;
    wide_state wide;
    unsigned next = 0;
    truth_init(&state);
    wide_init(&wide);
    find_blocks();
    for (unsigned i = 0; i < COUNT; i++) shares[i] = %(steered)s < 0 || block[i] == %(steered)s %% blocks ? 1.0 : 0.0;
    for (unsigned long k = 0; k <= %(last)sul; k++) {
        truth_state chosen = state;
        wide_state beside = wide;
        truth_outputs outputs = {0};
        double most = -1.0;
        for (unsigned i = 0; i < COUNT; i++) {
            const double x = ((const double *)&state)[i];
            if (x > sizes[i]) sizes[i] = x;
            if (-x > sizes[i]) sizes[i] = -x;
        }
        const double sign = push(&state);
        (void)sign;
        for (int choice = 0; choice < %(choices)s; choice++) {
            const double u = %(u)s;
            truth_state trial = state;
            wide_state other = wide;
            truth_outputs seen;
            wide_outputs ignored;
            const truth_inputs inputs = { u };
            const wide_inputs same = { u };
            truth_step(&trial, &inputs, &seen);
            wide_step(&other, &same, &ignored);
            const double now = error(&trial, &other);
            if (now > most) {
                most = now;
                used[k] = u;
                outputs = seen;
                chosen = trial;
                beside = other;
            }
        }
        state = chosen;
        wide = beside;
        if (k == at[next]) {
            next++;
            printf("%(format)s\\n", %(values)s);
        }
    }
    for (unsigned long k = 0; k <= %(last)sul; k++) {
        printf("%%.17g\\n", used[k]);
    }
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
    if kind == "alias" and not net.hold:
        turns = rng.choice((1, 2, 7, 50, 92, 1000))
        net.step = rng.choice(("1", "0.1", "0.02", "10", "3550"))
        f = decimal(str(turns)) / decimal(net.step)
        shift = rng.choice(("", "", "0000001", "00000000001"))
        word = transfer.plain(arb(f).mid().str(12, radius=False))
        word = word + shift if shift and "." in word and "e" not in word else word
        net.signals = [signals.Harmonic(draw.decimal_word(rng, -1, 1, 1), word, str(rng.choice((0, 30, 90, 17, 180))))]
    elif kind != "free" and not net.hold:
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
    seen = Seen(bounds)
    kinds = ["steered", *(f"resonant {block}" for block in range(net.size())), "slight", rng.choice(("noise", "burst", "constant"))]
    for kind in kinds if net.hold else ["internal"]:
        inputs = None
        if net.hold:
            printed, inputs = run_held(net, folder, steps, kind) or (None, None)
        else:
            printed = run(net, folder, steps)
        if printed is None:
            tally.violate("code that does not compile or run", "no output", "C99")
            return
        if net.hold:
            compare_held(net, printed, steps, inputs, seen, tally)
        else:
            compare(net, printed, steps, seen, tally)
    seen.tell(tally)


class Bounds:
    """What a header says about rounding: relative to the sum of the largest parts, or to the largest value of each output."""

    def __init__(self, header):
        text = re.sub(r"\s*\n \*\s*", " ", header)
        parts = re.search(r"rounding at most (\S+) after 1e3 steps(?: and (\S+) after 1e5)?", text)
        seen = re.search(r"rounding takes at most (\S+) in (\d+) steps and (\S+) in (\d+) steps of the largest value", text)
        self.of_outputs = seen is not None
        try:
            if seen:
                self.levels = [(int(seen[2]), float(seen[1])), (int(seen[4]), float(seen[3]))]
            else:
                self.levels = [(steps, float(bound)) for steps, bound in zip((1000, 100000), parts.groups()) if bound]
        except (ValueError, TypeError, AttributeError):
            self.levels = None
        self.blocks = re.findall(r"- ((?:pole|mode) [^:]*): at most (\S+) and ([0-9.e+-]+)", text)

    def share(self, p, level):
        """The bound of the block of this pole over that of all blocks; 1 where the header names none."""
        place = [last for last, _ in self.levels].index(level)
        whole = self.levels[place][1]
        found = [float(bounds[place]) / whole for name, *bounds in self.blocks if of_block(name, p)]
        return max(found, default=1.0)

    def at(self, step):
        """How many steps the bound that holds at this one speaks of, and the bound."""
        return next(((last, bound) for last, bound in self.levels if step <= last), (step, None))


def of_block(name, p):
    """Whether a block may be that of a pole, by what its name says: six digits of the pole, or of a mode's frequency."""
    numbers = [float(x) for x in re.findall(r"[+-]?[0-9.]+(?:e[+-]?[0-9]+)?(?=i| )", name + " ")]
    near = lambda a, b: abs(a - b) <= 2e-5 * abs(p)
    if name.startswith("pole"):
        re_part, im_part = (numbers + [0.0])[:2]
        return near(re_part, p.real) and near(abs(im_part), abs(p.imag))
    # A mode: the modulus of a pair is its angular frequency, of which six decimals in Hz are written.
    hertz = re.search(r"\(([0-9.]+) Hz\)", name)
    return bool(hertz) and p.imag != 0 and abs(abs(p) / (2 * PI) - float(hertz[1])) <= 1e-6 + 1e-9 * abs(p)


def run(net, folder, steps):
    """What the compiled code prints at these steps, for a model without inputs: all outputs, and the largest size of each so far."""
    names = [f"y{i}" for i in range(len(net.outputs))]
    source = DRIVER % {
        "at": ", ".join(str(k) for k in steps) + ", 0", "last": steps[-1],
        "most": " ".join(f"if (outputs.{n} > most[{i}]) most[{i}] = outputs.{n}; if (-outputs.{n} > most[{i}]) most[{i}] = -outputs.{n};" for i, n in enumerate(names)),
        "count": len(names), "mosts": ", ".join(f"most[{i}]" for i in range(len(names))),
        "format": " ".join("%.17g" for _ in names), "values": ", ".join(f"outputs.{name}" for name in names)}
    return compiled(folder, {"main.c": source})


def run_held(net, folder, steps, kind):
    """The same for inputs that are held, and all inputs."""
    names = [f"y{i}" for i in range(len(net.outputs))]
    name, block = (kind + " -1").split()[:2]
    source = STEERED % {
        "at": ", ".join(str(k) for k in steps) + ", 0", "last": steps[-1], "choices": 8 if name in ("steered", "resonant", "slight") else 1, "steered": block,
        "u": {"steered": "noise() * 0x1p20", "slight": "noise() * 0x1p-10", "resonant": "sign * (1.0 + 0.01 * noise()) * 0x1p20", "noise": "noise()", "burst": "k < 8 ? noise() : 0.0", "constant": "0.7"}[name],
        "format": " ".join("%.17g" for _ in names), "values": ", ".join(f"outputs.{name}" for name in names)}
    lines = compiled(folder, {"main.c": source, "wide.c": WIDE + '#include "truth.c"\n'})
    if lines is None:
        return None
    count = len(steps)
    return lines[:count], [line[0] for line in lines[count:]]


def compiled(folder, sources):
    """The numbers in each line that a program around the emitted code prints; None where it does not compile or run."""
    for name, text in sources.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
    out = os.path.join(folder, "run")
    places = [os.path.join(folder, name) for name in ("truth.c", *sources)]
    if subprocess.run(["cc", "-std=c99", "-O1", "-o", out, *places, "-lm"], capture_output=True, check=False).returncode != 0:
        return None
    done = subprocess.run([out], capture_output=True, check=False, timeout=60)
    if done.returncode != 0:
        return None
    return [[float(word) for word in line.split()] for line in done.stdout.decode().splitlines()]


class Seen:
    """The largest error that is seen below each bound: over outputs, steps and inputs."""

    def __init__(self, bounds):
        self.bounds, self.most = bounds, {}

    def output(self, told, step, truth, size, tally):
        """One output at one step; `size` is what the bound is relative to."""
        last, bound = self.bounds.at(step)
        if bound is None:
            return
        if told != told or abs(told) == float("inf"):
            tally.violate("no number", told, "a number")
            return
        words = f"{truth.str(25, radius=False)}, size {arb(size).str(5, radius=False)}"
        error = abs(arb(told) - truth)
        tally.within("emitted output", told, f"{bound} at step {step}", size * bound, error, words, size if size > 0 else arb(1))
        if size > 0:
            self.most[last] = max(self.most.get(last, 0.0), float((error / size).upper()))

    def tell(self, tally):
        """Each bound over what is seen."""
        for last, bound in self.bounds.levels:
            if last in self.most:
                tally.ratio(bound, self.most[last])


def compare(net, printed, steps, seen, tally):
    """The outputs of a model without inputs at each checkpoint; the bound is relative to the largest value of each."""
    h = decimal(net.step)
    count = len(net.outputs)
    for i in range(count):
        most = {k: row[count + i] for k, row in zip(steps, printed)}
        try:
            motion = motions.Motion(net, i)
        except ValueError:
            continue
        for k, row in zip(steps, printed):
            last, _ = seen.bounds.at(k)
            seen.output(row[i], k, motion.at(h * k), arb(most.get(last, row[count + i])), tally)


def compare_held(net, printed, steps, inputs, seen, tally):
    """The outputs under inputs at each checkpoint; the bound is relative to the sum of the largest sizes of their parts."""
    for i in range(len(net.outputs)):
        try:
            output = held.Output(net, i, inputs)
        except ValueError:
            continue
        levels = [last for last, _ in seen.bounds.levels]
        sizes = {last: output.sizes(lambda p, last=last: seen.bounds.share(p, last)) for last in levels}
        for k, row in zip(steps, printed):
            last, _ = seen.bounds.at(k)
            if last in sizes:
                # The sizes are those of binary64 numbers: half a millionth is far more than they are off.
                seen.output(row[i], k, output.at(k), arb(sizes[last][k]) * arb("1.0000005"), tally)
