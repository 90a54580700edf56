"""Bodies whose motions are tied to each other by `couple`: gears and levers, as the ratios of their motions."""

from flint import ctx, fmpq, fmpq_mat

from . import draw, modes, poles, transfer
from .tally import decimal

BITS = 400
RATIOS = ("1", "-1", "2", "-2", "0.5", "-3", "0.1", "1.7", "-0.3", "1e-3", "250")


class Coupled:
    """A net, and of some bodies the pairs (dependent, ratio, leader): x_dependent = ratio x_leader."""

    damping = None

    def __init__(self, net, ties):
        self.net, self.ties = net, ties
        self.kept = [i for i in range(net.size()) if i not in {i for i, _, _ in ties}]

    def text(self):
        """The model; an equation is written either way round."""
        rows = []
        for number, (i, ratio, j) in enumerate(self.ties):
            sides = [f"b{i}.x", f"{ratio} * b{j}.x"]
            rows.append(f"couple r{number}: " + " = ".join(sides if number % 2 == 0 else reversed(sides)))
        return self.net.text() + "".join(row + "\n" for row in rows)

    def map(self):
        """x = T q with the motions q of the bodies that lead."""
        t = fmpq_mat(self.net.size(), len(self.kept))
        for column, i in enumerate(self.kept):
            t[i, column] = 1
        left = list(self.ties)
        done = set(self.kept)
        while left:
            tie = next(tie for tie in left if tie[2] in done)
            i, ratio, j = tie
            for column in range(len(self.kept)):
                t[i, column] = decimal(ratio) * t[j, column]
            done.add(i)
            left.remove(tie)
        return t

    # --- the quantities of a net that the oracles compute

    @property
    def outputs(self):
        return self.net.outputs

    def inputs(self):
        return self.net.inputs()

    def size(self):
        return len(self.kept)

    def matrices(self):
        t = self.map()
        return tuple(t.transpose() * part * t for part in self.net.matrices())

    def projected(self, entries):
        """T^T b, of coefficients of 1, s, s^2 for each body."""
        t = self.map()
        return [[sum((t[i, column] * entry[power] for i, entry in enumerate(entries)), fmpq(0)) for power in range(3)]
                for column in range(len(self.kept))]

    def column(self, name):
        return self.projected(self.net.column(name))

    def row(self, i, name=None):
        row, direct = self.net.row(i, name)
        return self.projected(row), direct

    # --- smaller scenes

    def smaller(self):
        """The same ties with less beside them, or one tie less."""
        for k in range(len(self.ties) if len(self.ties) > 1 else 0):
            yield Coupled(self.net, self.ties[:k] + self.ties[k + 1:])
        for net in self.net.smaller():
            if net.size() == self.net.size():
                yield Coupled(net, self.ties)


def scene(rng):
    """A damped net in which some bodies follow others; the last of a row of followers is farther from what leads it."""
    net = transfer.scene(rng, most=5)
    while net.size() < 2:
        net = transfer.scene(rng, most=5)
    order = list(range(net.size()))
    rng.shuffle(order)
    count = rng.randint(1, net.size() - 1)
    ties = []
    for place in range(net.size() - count, net.size()):
        ties.append((order[place], rng.choice(RATIOS), order[rng.randrange(place)]))
    if rng.random() < 0.3:
        net.masses[order[-1]] = "0"
    return Coupled(net, ties)


def check(net, program, tally, rng):
    """Compares what is told of modes, poles and transfer values."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    modes.compare(told, modes.squares(net), tally)
    poles.compare(told, poles.true_poles(net), None, tally)
    transfer.check(net, program, tally, rng)
