"""Transfer functions from the velocity or the acceleration of a base: those from its displacement, divided by s or s^2, with limits at 0 Hz."""

from flint import ctx, fmpq

from . import transfer
from .tally import decimal

BITS = 400


def scene(rng):
    """A net on a moving base."""
    while True:
        net = transfer.scene(rng)
        if net.bases:
            return net


def check(net, program, tally, rng):
    """Compares the values at some frequencies, zero among them."""
    ctx.prec = BITS
    words = ["0"] + transfer.frequencies(rng, transfer.function(net, 0, "u0")[1])
    asked = [option for word in words for option in ("--at", word + "Hz")]
    exact = {float(word): decimal(word) for word in words}
    for power, word in ((1, "vx"), (2, "ax")):
        told = program.ask(tally, "transfer", net.text(), "--format", "json", "--from", f"u0.{word}", *asked)
        if told is None:
            continue
        for _, output, row in transfer.rows(told):
            f = exact.get(row["frequency_hz"])
            if f is not None:
                numerator, denominator = transfer.function(net, int(output[1:]), "u0")
                compare(row, *cancelled(numerator, denominator, power), f, tally)


def cancelled(numerator, denominator, power):
    """N / (D s^power) without common powers of s."""
    above, below = list(numerator.coeffs()), [fmpq(0)] * power + list(denominator.coeffs())
    while above and above[0] == 0 and below[0] == 0:
        above, below = above[1:], below[1:]
    return type(numerator)(above), type(denominator)(below)


def compare(row, numerator, denominator, f, tally):
    """A value, a limit at 0 Hz, or that there is none."""
    if row["re"] is None and not row.get("infinite"):
        tally.refuse("no value")
        return
    is_infinite = f == 0 and not numerator.is_zero() and denominator[0] == 0
    tally.verdict("infinite", bool(row.get("infinite")), is_infinite)
    if not is_infinite:
        transfer.compare(row, numerator, denominator, f, tally)
