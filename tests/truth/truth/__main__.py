"""`tests/truth/run`: chooses classes, makes their scenes, prints a table; status 1 on a violation."""

import argparse
import os
import random
import signal
import sys
import time

from . import classes
from .program import Program
from .shrink import shrink
from .tally import HEAD, Tally, write


def arguments():
    words = argparse.ArgumentParser(prog="tests/truth/run", description="Compares what vibc prints with exact and ball arithmetic.")
    words.add_argument("classes", nargs="*", help=f"classes to run; all without any: {', '.join(classes.ALL)}")
    words.add_argument("--program", help="the binary; target/release/vibc, or target/debug/vibc, without it")
    words.add_argument("--seed", type=int, default=1, help="the first number of every scene's random generator")
    words.add_argument("--scenes", type=int, help="scenes of each class, instead of its own number")
    words.add_argument("--comparisons", type=int, help="go on until each class has so many comparisons")
    words.add_argument("--seconds", type=float, help="stop a class after so many seconds")
    words.add_argument("--quick", action="store_true", help="the few scenes with fixed seeds that the gate runs")
    words.add_argument("--show", type=int, default=3, help="violations of each kind to write out")
    words.add_argument("--only", type=int, help="this scene alone, by its number")
    words.add_argument("--no-shrink", action="store_true", help="write violations out as they were found")
    words.add_argument("--target", default="target", help=argparse.SUPPRESS)
    return words.parse_args()


def binary(options):
    """The program under test."""
    if options.program:
        return options.program
    for profile in ("release", "debug"):
        place = os.path.join(options.target, profile, "vibc")
        if os.path.exists(place):
            return place
    sys.exit("truth: no program; build one, or name it with --program")


class Stop:
    """Asked for by Ctrl-C or SIGTERM: the scene at hand is finished, and the table printed of what there is."""

    def __init__(self):
        self.asked = False

    def __call__(self, *_):
        self.asked = True


stop = Stop()


def run_class(name, program, options):
    """All scenes of a class."""
    chosen = classes.ALL[name]
    tally = Tally(name)
    many = options.scenes or (chosen.quick if options.quick else chosen.scenes)
    if options.comparisons:
        many = 10 ** 9
    start = time.monotonic()
    numbers = [options.only] if options.only is not None else range(many)
    for number in numbers:
        if options.comparisons and tally.comparisons >= options.comparisons:
            break
        if stop.asked or options.seconds and time.monotonic() - start > options.seconds:
            break
        one(chosen, name, number, program, tally, options)
    return tally, time.monotonic() - start


def one(chosen, name, number, program, tally, options):
    """One scene: made from seed, class and number alone, so that it can be made again."""
    rng = random.Random(f"{options.seed} {name} {number}")
    scene = chosen.scene(rng)
    before = len(tally.violations)
    tally.scene, tally.model, tally.scenes = scene, "", tally.scenes + 1
    key = f"{options.seed} {name} {number} check"
    chosen.check(scene, program, tally, random.Random(key))
    fresh = tally.violations[before:]
    if fresh and not options.no_shrink and len(tally.violations) < 40:
        for violation in {v.kind: v for v in fresh}.values():
            shrink(chosen, violation, program, key)
    for violation in fresh:
        violation.command += f"   (seed {options.seed}, class {name}, scene {number})"


def table(rows):
    """Rows as a Markdown table whose columns stand below each other."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["| " + " | ".join(word.ljust(w) for word, w in zip(row, widths)) + " |" for row in rows]
    lines.insert(1, "| " + " | ".join("-" * w for w in widths) + " |")
    return "\n".join(lines)


def main():
    options = arguments()
    for kind in (signal.SIGINT, signal.SIGTERM):
        signal.signal(kind, stop)
    program = Program(binary(options))
    names = options.classes or list(classes.ALL)
    unknown = [name for name in names if name not in classes.ALL]
    if unknown:
        sys.exit(f"truth: no class {unknown[0]}; there are {', '.join(classes.ALL)}")
    rows = [HEAD + ["seconds"]]
    failed = False
    folder = os.path.join(options.target, "truth", "violations")
    for name in names:
        tally, seconds = run_class(name, program, options)
        rows.append(tally.row() + [f"{seconds:.0f}"])
        write(tally, folder, options.show)
        if tally.violations:
            failed = True
            for kind, count in sorted(tally.kinds.items()):
                print(f"{name}: {count} x {kind}", file=sys.stderr)
        if tally.comparisons == 0 and not stop.asked:
            failed = True
            print(f"{name}: nothing was compared", file=sys.stderr)
        for kind, count in sorted(tally.open.items()):
            print(f"{name}: undecided {count} x {kind}", file=sys.stderr)
        for reason, count in sorted(tally.refusals.items()):
            print(f"{name}: refused {count} x {reason}", file=sys.stderr)
        sys.stderr.flush()
    print(table(rows))
    if failed:
        print(f"violations are written out in {folder}")
    sys.exit(1 if failed else 0)


main()
