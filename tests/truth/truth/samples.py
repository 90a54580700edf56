"""Random cases of `vibc sweep --samples`: nets whose masses and springs are functions of a few parameters that are drawn from their tolerances
and spreads. The frequencies of each case at exactly the values that its row shows, from characteristic polynomials in exact arithmetic,
lie within the bounds that stand beside them, however many cases the program computes at once."""

from fractions import Fraction

from flint import ctx, fmpq

from . import draw
from .loaded import Text
from .sweeps import has_numbers
from .tolerated import BITS, Box

COMPARED = 12


class Drawn(Box):
    """Parameters with tolerances, with spreads, and with both."""

    def parameter(self, rng, name, unit):
        value, share = draw.decimal_word(rng, -1, 2), rng.choice(("0.1", "1", "5", "15"))
        spread = rng.choice((f"spread {share} %", f"spread lognormal {share} %", f"spread uniform within {share} %", f"within {share} %", f"spread {share} % within {share} %"))
        self.rows.append(f"param {name} = {value} {unit} {spread}")
        self.names.append(name)


def scene(rng):
    box = Drawn(rng)
    if len(box.names) > 1 and rng.random() < 0.3:
        box.rows.append(f"correlate {box.names[0]}, {box.names[1]} {rng.choice(('0.7', '-0.3'))}")
    net = Text("\n".join(box.rows) + "\n")
    net.box, net.number = box, rng.choice((16, 48, 320))
    net.options = ["--samples", str(net.number), "--seed", str(rng.randrange(1000)), "--modes", str(len(box.masses))]
    if rng.random() < 0.3:
        net.options.append("--sobol")
    return net


def check(net, program, tally, rng):
    told = program.ask(tally, "sweep", net.text(), "--format", "json", *net.options)
    if told is None or "cases" not in told:
        return
    ctx.prec = BITS
    tally.verdict("number of cases", len(told["cases"]), net.number)
    places = {column["name"]: at for at, column in enumerate(told["columns"])}
    for number in sorted(rng.sample(range(net.number), min(COMPARED, net.number))):
        row = told["cases"][number]
        exact = lambda x: fmpq(*Fraction(x).as_integer_ratio())
        truth = net.box.frequencies({name: exact(row["values"][places[name]]) for name in net.box.names})
        if not has_numbers(row, truth, tally):
            continue
        for i, frequency in enumerate(truth):
            value, bound = (row[list_of][places[f"frequency_{i + 1}"]] for list_of in ("values", "error_bounds"))
            if frequency is None:
                tally.refuse("a motion that does not oscillate")
            elif value is None:
                tally.without_bound += 1
            else:
                tally.absolute("frequency", value, bound, frequency)
