"""The counts of a class: comparisons, violations, refusals, and how far the bounds lie above the errors."""

import os
from array import array

from flint import arb, acb, fmpq

# Half a unit in the last place of a binary64 number, relative to it: a smaller error is only rounding.
ROUNDING = arb(2) ** -54
# The smallest positive binary64 number: anything below it can only be reported as zero.
TINY = arb(2) ** -1074


class Violation:
    """A number, count or verdict that is not as the program told it."""

    def __init__(self, kind, told, true, bound=None, scene=None, command="", model=""):
        self.kind = kind
        self.told = told
        self.true = true
        self.bound = bound
        self.scene = scene
        self.command = command
        self.model = model

    def lines(self):
        """What was told and what is true, as comments above a model."""
        rows = [f"{self.kind}", f"told   {self.told}"]
        if self.bound is not None:
            rows.append(f"bound  {self.bound}")
        rows.append(f"true   {self.true}")
        if self.command:
            rows.append(f"run    {self.command}")
        return ["// " + row for row in rows]


class Tally:
    """The results of one class, number by number."""

    def __init__(self, name):
        self.name = name
        self.comparisons = 0
        self.undecided = 0
        self.open = {}
        self.scenes = 0
        self.refusals = {}
        self.without_bound = 0
        self.violations = []
        self.kinds = {}
        self.ratios = array("d")
        self.scene = None
        self.command = ""
        # What the program was asked with last, where that is more than the scene's own text.
        self.model = ""

    def refuse(self, reason):
        """The program gave no answer for a scene, or for a part of it."""
        self.refusals[reason] = self.refusals.get(reason, 0) + 1

    def violate(self, kind, told, true, bound=None):
        """A claim that does not hold."""
        self.kinds[kind] = self.kinds.get(kind, 0) + 1
        self.violations.append(Violation(kind, told, true, bound, self.scene, self.command, self.model))

    def verdict(self, kind, told, true):
        """A count, a word or a verdict, compared as it stands."""
        self.comparisons += 1
        if told != true:
            self.violate(kind, told, true)

    def absolute(self, kind, told, bound, truth, unit=None):
        """A real or complex number with an absolute bound. `unit` is the size of the numbers that it stands among."""
        if told is None or bound is None:
            self.without_bound += 1
            return
        value = number(told)
        error = abs(value - truth)
        self.settle(kind, told, bound, arb(bound), error, truth, abs(value), unit)

    def relative(self, kind, told, bound, truth, size=None):
        """A real or complex number with a bound relative to the true value."""
        if told is None or bound is None:
            self.without_bound += 1
            return
        value = number(told)
        error = abs(value - truth)
        self.settle(kind, told, bound, arb(bound) * abs(truth), error, truth, abs(value) if size is None else size)

    def digits(self, kind, told, truth):
        """A decimal number whose last digit may be off by one: the ratio counts units over the error."""
        unit = unit_of_last(told)
        error = abs(number(told) - truth)
        self.settle(kind, told, "1 unit", arb(unit), error, truth, arb(unit) / 2 / ROUNDING)

    def within(self, kind, told, bound, allowed, error, truth, unit):
        """The error, if it is within what is allowed."""
        self.comparisons += 1
        if error > allowed:
            self.violate(kind, told, text(truth), bound)
            return None
        if not error <= allowed:
            # Undecided: the error is zero to more digits than any bound has, or the oracle had too few digits.
            if not error.upper() <= unit * arb(2) ** -150:
                self.undecided += 1
                self.open[kind] = self.open.get(kind, 0) + 1
                return None
            error = arb(0)
        return error

    def ratio(self, bound, seen):
        """A relative bound of many numbers beside the largest error of them all."""
        self.ratios.append(bound / max(seen, float(ROUNDING)))

    def settle(self, kind, told, bound, allowed, error, truth, size, unit=None):
        """Whether an error is within what is allowed, and by how much; `size` is what rounding is measured by."""
        error = self.within(kind, told, bound, allowed, error, truth, size if unit is None else unit)
        if error is None:
            return
        floor = size * ROUNDING
        least = error if error > floor else floor
        if allowed.is_zero() or not least > TINY:
            self.ratios.append(1.0)
        else:
            self.ratios.append(float((allowed / least).mid()))

    def row(self):
        """The counts as words of a table."""
        ordered = sorted(self.ratios)
        median = ordered[len(ordered) // 2] if ordered else 0.0
        ninety = ordered[len(ordered) * 9 // 10] if ordered else 0.0
        most = ordered[-1] if ordered else 0.0
        refused = sum(self.refusals.values())
        return [self.name, str(self.scenes), str(self.comparisons), str(len(self.violations)), str(refused),
                str(self.without_bound), str(self.undecided), f"{median:.3g}", f"{ninety:.3g}", f"{most:.2g}"]


HEAD = ["class", "scenes", "comparisons", "violations", "refused", "no bound", "undecided", "median", "p90", "largest"]


def number(told):
    """A number as told, exactly: a float is the binary64 number, a text the decimal fraction, a pair is complex."""
    if isinstance(told, tuple):
        return acb(number(told[0]), number(told[1]))
    if isinstance(told, str):
        return arb(decimal(told))
    return arb(told)


def decimal(word):
    """The fraction that a decimal number shows."""
    word = word.strip()
    sign = 1
    if word[0] in "+-":
        sign = -1 if word[0] == "-" else 1
        word = word[1:]
    mantissa, _, exponent = word.lower().partition("e")
    whole, _, part = mantissa.partition(".")
    value = fmpq(int((whole + part) or "0")) * sign
    power = (int(exponent) if exponent else 0) - len(part)
    return value * fmpq(10) ** power if power >= 0 else value / fmpq(10) ** -power


def unit_of_last(word):
    """One unit of the last digit of a decimal number."""
    mantissa, _, exponent = word.lower().partition("e")
    power = (int(exponent) if exponent else 0) - len(mantissa.partition(".")[2])
    return fmpq(10) ** power if power >= 0 else 1 / fmpq(10) ** -power


def text(value):
    """A true value as words, with thirty digits."""
    if isinstance(value, (arb, acb)):
        return value.str(30, radius=False)
    return str(value)


def write(tally, folder, limit):
    """Writes the first violations, of different kinds first, each as a model with what was told and what is true."""
    os.makedirs(folder, exist_ok=True)
    for old in os.listdir(folder):
        if old.startswith(tally.name + "-"):
            os.remove(os.path.join(folder, old))
    seen, scenes = {}, set()
    for violation in tally.violations:
        key = (violation.kind, id(violation.scene))
        count = seen.get(violation.kind, 0)
        if count >= limit or key in scenes:
            continue
        scenes.add(key)
        seen[violation.kind] = count + 1
        place = os.path.join(folder, f"{tally.name}-{violation.kind.replace(' ', '_').replace('/', '_')}-{count + 1}.vib")
        with open(place, "w", encoding="utf-8") as file:
            file.write("\n".join(violation.lines()) + "\n")
            file.write(violation.model or (violation.scene.text() if violation.scene is not None else ""))
