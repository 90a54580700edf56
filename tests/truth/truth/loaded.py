"""Scenes by closed forms: bodies that hang on springs with a law, belts between disks, rotating unbalances."""

from flint import acb, acb_mat, arb, ctx, fmpq, fmpq_poly

from . import draw, transfer
from .exact import I, pi, real_roots
from .tally import decimal

BITS = 330


class Text:
    """A model, and the numbers that it was made from."""

    def __init__(self, model, **numbers):
        self.model = model
        self.__dict__.update(numbers)

    def text(self):
        return self.model


def squares_of_two(m, k):
    """The two omega^2 of symmetric 2 x 2 matrices of balls, M diagonal."""
    a, b, c = k[0][0] / m[0], k[1][1] / m[1], k[0][1] * k[0][1] / (m[0] * m[1])
    middle, apart = (a + b) / 2, (((a - b) / 2) ** 2 + c).sqrt()
    # The smaller one without cancellation.
    high = middle + apart
    return [(a * b - c) / high, high]


def frequencies(told, squares, tally):
    """The frequencies of a report beside omega^2, ascending."""
    rows = told["modes"]
    tally.verdict("number of modes", len(rows), len(squares))
    for row, square in zip(rows, squares):
        tally.relative("omega", row["omega"], row["omega_error_bound"], square.sqrt())


# Bodies that hang one below another on springs with the law k1 s + k2 s^2 + k3 s^3: each one's tension is the weight below it.

def law_scene(rng):
    count = rng.choice((1, 1, 2))
    words = lambda low, high: [draw.decimal_word(rng, low, high) for _ in range(count)]
    masses, k1, k3 = words(-1, 1), words(1, 4), words(2, 6)
    k2 = [draw.decimal_word(rng, 0, 2) if rng.random() < 0.3 else "0" for _ in range(count)]
    gravity = rng.choice(("9.81", "1.62", "9.80665"))
    rows = [f"gravity {gravity} m/s^2"]
    for i in range(count):
        over = "ground@(0, 0)" if i == 0 else f"b{i - 1}"
        terms = [f"{k1[i]} N/m * stretch", f"{k2[i]} N/m^2 * stretch^2", f"{k3[i]} N/m^3 * stretch^3"]
        shown = " + ".join(term for term, word in zip(terms, (k1[i], k2[i], k3[i])) if word != "0")
        law = f"({k3[i]} N/m^3 * stretch * stretch + {k1[i]} N/m) * stretch" if k2[i] == "0" and rng.random() < 0.3 else shown
        rows += [f"body b{i} {{ mass = {masses[i]} kg, at = (0, {-i - 1} m), moves y }}", f"spring s{i}: {over} -- b{i} {{ law = {law} }}"]
    limits = [f"require rest({kind}{i}.{word}) > -1e30 {unit}" for i in range(count)
              for kind, word, unit in (("s", "stretch", "m"), ("s", "tension", "N"))]
    return Text("\n".join(rows + limits) + "\n", masses=masses, laws=list(zip(k1, k2, k3)), gravity=gravity)


def law_check(scene, program, tally, rng):
    ctx.prec = BITS
    told = program.ask(tally, "analyze", scene.text(), "--format", "json")
    if told is None:
        return
    masses = [decimal(word) for word in scene.masses]
    stretches, tangents, tensions = [], [], []
    for i, words in enumerate(scene.laws):
        one, two, three = (decimal(word) for word in words)
        tension = sum(masses[i:], fmpq(0)) * decimal(scene.gravity)
        found = [x for x, _ in real_roots(fmpq_poly([-tension, one, two, three]), BITS) if x > 0]
        if len(found) != 1:
            return
        s = found[0]
        stretches.append(s)
        tensions.append(arb(tension))
        tangents.append(arb(one) + 2 * arb(two) * s + 3 * arb(three) * s * s)
    if len(masses) == 1:
        squares = [tangents[0] / arb(masses[0])]
    else:
        k = [[tangents[0] + tangents[1], -tangents[1]], [-tangents[1], tangents[1]]]
        squares = squares_of_two([arb(m) for m in masses], k)
    frequencies(told, squares, tally)
    truths = [x for pair in zip(stretches, tensions) for x in pair]
    for row, truth in zip(told["requirements"], truths):
        if row["value"] is None:
            tally.refuse("no value")
            continue
        tally.relative("law at rest", row["value"], row["error_bound"], truth)


# Belts: the length of each span between the tangent points, by the motions of both disks.

def belt_scene(rng):
    small = lambda: f"0.{rng.randrange(1, 40):02d}"
    radii = [small(), small()]
    crossed = rng.random() < 0.4
    least = sum(map(float, radii)) if crossed else abs(float(radii[0]) - float(radii[1]))
    apart = f"{least + rng.choice((0.01, 0.1, 0.5, 1.5)):.2f}"
    stiffness, held = draw.decimal_word(rng, 1, 5), draw.decimal_word(rng, 0, 3)
    masses = [draw.decimal_word(rng, -1, 2) for _ in range(2)]
    moves = rng.random() < 0.5
    ground = draw.decimal_word(rng, 0, 2, 1)
    # The second disk turns, or it moves along the line of the centres without turning.
    motion, unit, along = ("moves x", "N/m", ", along = x") if moves else ("turns", "N*m/rad", "")
    text = (f"body a {{ mass = {masses[0]} kg, at = (0, 0), shape = disk({radii[0]} m), turns }}\n"
            f"body b {{ mass = {masses[1]} kg, at = ({apart} m, 0), shape = disk({radii[1]} m), {motion} }}\n"
            f"spring u: ground -- a {{ k = {ground} N*m/rad }}\nspring t: ground -- b {{ k = {held} {unit}{along} }}\n"
            f"belt r: a -- b {{ k = {stiffness} N/m{', crossed' if crossed else ''} }}\n")
    return Text(text, radii=radii, crossed=crossed, apart=apart, stiffness=stiffness, held=held, masses=masses, moves=moves, ground=ground)


def belt_check(scene, program, tally, rng):
    ctx.prec = BITS
    told = program.ask(tally, "analyze", scene.text(), "--format", "json")
    if told is None:
        return
    (one, two), d, k = [arb(decimal(word)) for word in scene.radii], arb(decimal(scene.apart)), arb(decimal(scene.stiffness))
    # Stretches of the two spans: the first disk winds up one and lets out the other.
    offset = one + two if scene.crossed else one - two
    along = (1 - (offset / d) ** 2).sqrt()
    second = (along, along) if scene.moves else ((two, -two) if scene.crossed else (-two, two))
    spans = [(one, second[0]), (-one, second[1])]
    matrix = [[sum(k * span[i] * span[j] for span in spans) for j in range(2)] for i in range(2)]
    matrix[0][0] += arb(decimal(scene.ground))
    matrix[1][1] += arb(decimal(scene.held))
    masses = [arb(decimal(word)) for word in scene.masses]
    masses[0] *= one * one / 2
    masses[1] *= 1 if scene.moves else two * two / 2
    squares = squares_of_two(masses, matrix)
    frequencies(told, sorted(squares, key=lambda x: float(x.mid())), tally)


# A body on springs along different lines, with dampers, and a rotating unbalance.

LINES = (((1, 0), "x"), ((0, 1), "y"), ((fmpq(3, 5), fmpq(4, 5)), "(3, 4)"), ((fmpq(-5, 13), fmpq(12, 13)), "(-5, 12)"))


def unbalance_scene(rng):
    mass, me, speed = draw.decimal_word(rng, -1, 1), draw.decimal_word(rng, -3, 0), draw.decimal_word(rng, 0, 2)
    clockwise = rng.random() < 0.5
    rows, springs, dampers = [f"body a {{ mass = {mass} kg, at = (0, 0), moves x y }}"], [], []
    for kind, unit, list_of in (("spring", "N/m", springs), ("damper", "N*s/m", dampers)):
        for i in range(rng.choice((2, 3))):
            line, word = LINES[i] if i < 2 and kind == "spring" else rng.choice(LINES)
            size = draw.decimal_word(rng, 1, 3) if kind == "spring" else draw.decimal_word(rng, -1, 1)
            rows.append(f"{kind} {kind[0]}{i}: ground -- a {{ {'k' if kind == 'spring' else 'c'} = {size} {unit}, along = {word} }}")
            list_of.append((line, size))
    rows += [f"unbalance U: a {{ me = {me} kg*m, speed = {speed} Hz{', clockwise' if clockwise else ''} }}", "output x = a.x",
             "output y = a.y", "require amplitude(x) < 1e30 m", "require amplitude(y) < 1e30 m"]
    return Text("\n".join(rows) + "\n", mass=mass, me=me, speed=speed, clockwise=clockwise, springs=springs, dampers=dampers)


def unbalance_check(scene, program, tally, rng):
    ctx.prec = BITS
    words = [scene.speed, draw.decimal_word(rng, -1, 1), draw.decimal_word(rng, 0, 2)]
    asked = [option for word in dict.fromkeys(words) for option in ("--at", word + "Hz")]

    def form(elements):
        return [[sum(decimal(size) * line[i] * line[j] for line, size in elements) for j in range(2)] for i in range(2)]

    k, c, mass = form(scene.springs), form(scene.dampers), decimal(scene.mass)

    def under(word):
        """The motions under unit forces along x and y, each times omega^2."""
        omega = 2 * pi() * decimal(word)
        s = I * omega
        z = acb_mat(2, 2, [acb(k[i][j]) + s * c[i][j] + (s * s * mass if i == j else 0) for i in range(2) for j in range(2)])
        return z.inv() * acb(omega * omega)

    told = program.ask(tally, "transfer", scene.text(), "--format", "json", *asked)
    if told is None:
        return
    found = {float(word): under(word) for word in words}
    sense = -1 if scene.clockwise else 1
    # x turns as cos, y as sin in its sense: each component is against itself at that of the heavy spot.
    for name, output, row in transfer.rows(told):
        truth = found.get(row["frequency_hz"])
        if truth is not None:
            entry = truth[0 if output == "x" else 1, 0 if name == "U.x" else 1]
            transfer.compare_value(row, entry, tally)
    told = program.ask(tally, "analyze", scene.text(), "--format", "json")
    if told is None:
        return
    h = found[float(scene.speed)]
    for place, row in enumerate(told["requirements"]):
        true = abs(h[place, 0] - sense * I * h[place, 1]) * arb(decimal(scene.me))
        tally.relative("amplitude", row["value"], row["error_bound"], true)
