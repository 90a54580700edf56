"""Planar scenes: rests that are not the drawing, tensions, frequencies and poles about them, buckling."""

from flint import acb_mat, arb, arb_mat, ctx

from . import draw, poles, transfer
from .exact import I, pi
from .mechanics import GROUND, Body, Line, Rest, Scene, eigenvalues
from .tally import decimal

BITS = 330


def scene(rng):
    """Pendulums in a row, free bodies and sliders on springs, four-bar linkages, and columns that nearly buckle."""
    kind = rng.choice(("row", "row", "free", "free", "cart", "point", "four", "drawn", "column", "column"))
    found = {"row": row, "free": free, "cart": cart, "point": point, "four": four, "drawn": drawn, "column": column}[kind](rng)
    if kind != "column" and rng.random() < 0.6:
        dampers(rng, found)
    if rng.random() < 0.5:
        i = rng.randrange(len(found.bodies))
        body = found.bodies[i]
        axis = body.motion if body.motion in ("x", "y") else rng.choice(("x", "y"))
        found.force = (i, body.centre, axis)
        found.output = (i, body.centre, axis)
    return found


def coordinate(rng, low=-2.0, high=2.0):
    return f"{rng.uniform(low, high):.{rng.choice((1, 1, 2, 3))}f}"


def somewhere(rng):
    return coordinate(rng), coordinate(rng)


def stiffness(rng, decades=0):
    return draw.decimal_word(rng, 1 - decades, 4 + decades)


def spring(rng, scene, i, point, decades=0):
    """A spring from the ground to a point of a body, with a free length, a preload, or neither."""
    start = (coordinate(rng, -4, 4), coordinate(rng, -4, 4))
    if start == point:
        start = (start[0], "4.5")
    kind = rng.choice(("plain", "plain", "free", "preload"))
    span = ((float(start[0]) - float(point[0])) ** 2 + (float(start[1]) - float(point[1])) ** 2) ** 0.5
    rest = f"{span * rng.uniform(0.6, 1.3):.2f}" if kind == "free" else None
    pull = f"{rng.uniform(-5, 20):.2f}" if kind == "preload" else None
    scene.springs.append(Line((GROUND, start), (i, point), stiffness(rng, decades), rest, pull))


def mass(rng, decades=0):
    return draw.decimal_word(rng, -1 - decades, 1 + decades)


def row(rng):
    """One to three links on pivots, the first on the ground, with weights and springs."""
    scene = Scene()
    scene.gravity = rng.choice(("9.81", "9.81", "10"))
    at, on = somewhere(rng), GROUND
    decades = rng.choice((0, 0, 1, 3))
    for i in range(rng.choice((1, 2, 2, 3))):
        centre = somewhere(rng)
        inertia = mass(rng, decades) if rng.random() < 0.5 else None
        scene.bodies.append(Body(mass(rng, decades), centre, "pivot", inertia, on, at))
        if rng.random() < 0.6:
            spring(rng, scene, i, centre, decades)
        on, at = i, somewhere(rng)
    if rng.random() < 0.3:
        scene.springs.append(Line((GROUND, None), (0, None), stiffness(rng), torsional=True))
    return scene


def free(rng):
    """A free body on two to four springs."""
    scene = Scene()
    scene.gravity = "9.81"
    decades = rng.choice((0, 0, 0, 1, 3))
    scene.bodies.append(Body(mass(rng, decades), somewhere(rng), "free", mass(rng, decades)))
    for _ in range(rng.randint(2, 4)):
        spring(rng, scene, 0, somewhere(rng), decades)
    return scene


def cart(rng):
    """A cart on a spring, a pendulum on it."""
    scene = Scene()
    scene.gravity = "9.81"
    at = somewhere(rng)
    scene.bodies.append(Body(mass(rng), at, rng.choice(("x", "y", "xy"))))
    spring(rng, scene, 0, at)
    spring(rng, scene, 0, at)
    scene.bodies.append(Body(mass(rng), somewhere(rng), "pivot", rng.choice((None, mass(rng))), 0, at))
    if rng.random() < 0.5:
        spring(rng, scene, 1, scene.bodies[1].centre)
    return scene


def point(rng):
    """Masses that move in the plane, on springs to the ground and to each other."""
    scene = Scene()
    scene.gravity = rng.choice((None, "9.81"))
    for i in range(rng.choice((1, 1, 2))):
        centre = somewhere(rng)
        scene.bodies.append(Body(mass(rng), centre, "xy"))
        for _ in range(rng.randint(2, 3)):
            spring(rng, scene, i, centre)
    if len(scene.bodies) > 1 and scene.bodies[0].centre != scene.bodies[1].centre:
        scene.springs.append(Line((0, scene.bodies[0].centre), (1, scene.bodies[1].centre), stiffness(rng)))
    return scene


def four(rng):
    """Three bars on two pivots of the ground, with weights and a spring."""
    scene = Scene()
    scene.gravity = "9.81"
    a, d = ("0", "0"), (coordinate(rng, 1.5, 2.5), coordinate(rng, -0.3, 0.3))
    b, c = (coordinate(rng, -0.5, 0.5), coordinate(rng, 0.7, 1.3)), (coordinate(rng, 1.5, 2.5), coordinate(rng, 0.8, 1.6))
    scene.bodies.append(Body(mass(rng), somewhere(rng), "pivot", mass(rng), GROUND, a))
    scene.bodies.append(Body(mass(rng), somewhere(rng), "pivot", mass(rng), 0, b))
    scene.bodies.append(Body(mass(rng), somewhere(rng), "pivot", mass(rng), 1, c))
    scene.loops.append((GROUND, 2, d))
    spring(rng, scene, rng.randrange(3), somewhere(rng))
    return scene


def drawn(rng):
    """A scene whose drawing is declared to be its rest."""
    scene = Scene()
    scene.gravity = "9.81"
    scene.as_drawn = True
    many = rng.choice(("xy", "free"))
    scene.bodies.append(Body(mass(rng), somewhere(rng), many, mass(rng) if many == "free" else None))
    for _ in range(rng.randint(3, 5)):
        spring(rng, scene, 0, somewhere(rng) if many == "free" else scene.bodies[0].centre)
    for line in scene.springs:
        line.free = line.preload = None
    return scene


def column(rng):
    """Bars upright one on another, held by level springs; a single one at its buckling load within 1e-3 to 1e-60."""
    scene = Scene()
    scene.gravity = rng.choice(("9.81", "10"))
    count = rng.choice((1, 1, 2, 3))
    single = count == 1 and rng.random() < 0.8
    at, on = ("0", "0"), GROUND
    for i in range(count):
        top = ("0", str(i + 1))
        scene.bodies.append(Body("1" if single else mass(rng), top, "pivot", None, on, at))
        k = near_load(rng, scene.gravity) if single else stiffness(rng)
        scene.springs.append(Line((GROUND, (rng.choice(("-1", "2")), top[1])), (i, top), k))
        on, at = i, top
    return scene


def near_load(rng, gravity):
    """A stiffness next to m g / l = gravity, with many digits."""
    depth = rng.choice((1, 3, 8, 15, 17, 25, 31, 40, 60))
    whole, _, part = gravity.partition(".")
    digit = rng.choice("13579")
    if rng.random() < 0.5:
        return f"{whole}.{part}{'0' * depth}{digit}"
    shown = int(whole + part) - 1
    words = str(shown)
    head, tail = (words[: len(words) - len(part)], words[len(words) - len(part):]) if part else (words, "")
    return f"{head}.{tail}{'9' * depth}{digit}"


def dampers(rng, scene):
    """Dampers beside springs."""
    for line in scene.springs:
        if rng.random() < 0.6 and not line.torsional:
            scene.dampers.append(Line(line.a, line.b, draw.decimal_word(rng, -2, 1)))


def check(scene, program, tally, rng):
    """Compares rest, tensions, modes, poles and buckling of a scene."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", scene.text(), "--format", "json")
    if told is None:
        return
    if not told["rest"]["proven"]:
        tally.refuse("rest not proven")
        return
    words = {(i, name): f"b{i}.{name}" for i, name in scene.coordinates()}
    shown = told["rest"]["displacement"]
    near = {key: shown.get(word, 0.0) for key, word in words.items()}
    try:
        rest = Rest(scene, near)
    except (ValueError, ZeroDivisionError):
        tally.refuse("the oracle proves no rest")
        return
    displacement(told, rest, words, tally)
    if scene.as_drawn:
        for i, tension in enumerate(rest.tensions):
            stated = told["rest"]["tensions"].get(f"k{i}")
            bound = (told["rest"].get("tension_error_bounds") or {}).get(f"k{i}", 2.0 ** -52)
            tally.relative("tension", stated, bound, tension)
    try:
        linear(told, rest, tally)
    except ValueError:
        tally.refuse("the oracle isolates no eigenvalues")
        return
    if scene.force and told["rest"]["kind"] != "undetermined":
        responses(scene, rest, program, tally, told)


def displacement(told, rest, words, tally):
    """The rest itself: within the rounding of the numbers that are told, or their bounds where they have some."""
    bounds = told["rest"].get("displacement_error_bounds") or {}
    for key, word in words.items():
        if word not in told["rest"]["displacement"]:
            continue
        stated = told["rest"]["displacement"][word]
        truth = rest.q[key]
        if word in bounds and bounds[word] is not None:
            tally.absolute("rest displacement", stated, bounds[word], truth)
        else:
            allowed = abs(arb(stated)) * arb(2) ** -52 + arb(10) ** -24
            tally.settle("rest displacement", stated, "its rounding", allowed, abs(arb(stated) - truth), truth, abs(arb(stated)))


def linear(told, rest, tally):
    """Modes, poles and the buckling load."""
    inverse = rest.m.inv()
    values = eigenvalues(inverse * rest.k)
    squares = sorted((v.real for v in values), key=lambda x: float(x.mid()))
    if any(v.imag != 0 for v in values):
        raise ValueError("not isolated")
    if any(x.contains(0) for x in squares):
        tally.refuse("the oracle cannot tell a frequency from zero")
        return
    modes(told, squares, tally)
    size = rest.m.nrows()
    state = arb_mat(2 * size, 2 * size)
    stiff, damp = inverse * rest.k, inverse * rest.c
    for i in range(size):
        state[i, size + i] = 1
        for j in range(size):
            state[size + i, j] = -stiff[i, j]
            state[size + i, size + j] = -damp[i, j]
    if rest.scene.dampers:
        poles.compare(told, eigenvalues(state), None, tally)
    buckling(told, rest, squares, tally)


def modes(told, squares, tally):
    """The list of modes against isolated squares of frequencies."""
    tally.verdict("number of modes", len(told["modes"]), len(squares))
    if any(mode["kind"] == "undetermined" for mode in told["modes"]) or len(told["modes"]) != len(squares):
        tally.refuse("undetermined")
        return
    for mode, square in zip(told["modes"], squares):
        kind = "oscillation" if square > 0 else "divergence"
        tally.verdict("kind of mode", mode["kind"], kind)
        if mode["kind"] == kind == "oscillation":
            tally.relative("omega", mode["omega"], mode["omega_error_bound"], square.sqrt())
        elif mode["kind"] == kind:
            tally.relative("growth rate", mode["growth_rate"], mode["omega_error_bound"], (-square).sqrt())
    if not told["rest"]["kind"] == "undetermined" and any(square < 0 for square in squares):
        tally.verdict("stability", told["rest"]["kind"], "unstable")


def buckling(told, rest, squares, tally):
    """The load factor and its margin."""
    row = told.get("buckling")
    if row is None or row.get("load_factor") is None:
        return
    geometric = rest.k - rest.own
    own = definite(rest.own)
    if own:
        largest = max((v.real for v in eigenvalues(rest.own.inv() * geometric * arb(-1))), key=lambda x: float(x.mid()))
        factor = 1 / largest
        margin = factor - 1
    elif all(square > 0 for square in squares):
        least = min((v.real for v in eigenvalues(rest.k.inv() * geometric)), key=lambda x: float(x.mid()))
        margin = -1 / least
        factor = 1 + margin
    else:
        return
    tally.relative("load factor", row["load_factor"], row["error_bound"], factor)
    tally.relative("buckling margin", row["margin"], row["margin_error_bound"], margin)


def definite(a):
    """Whether a symmetric matrix is certainly positive definite: its leading minors are."""
    size = a.nrows()
    for n in range(1, size + 1):
        if not arb_mat(n, n, [a[i, j] for i in range(n) for j in range(n)]).det() > 0:
            return False
    return True


def responses(scene, rest, program, tally, told):
    """Transfer values about the rest."""
    i, place, axis = scene.force
    side = 0 if axis == "x" else 1
    row = rest.scene.gradient(lambda at: scene.at(i, place, at)[side], rest.q)
    b = rest.z.transpose() * arb_mat(len(row), 1, row)
    omega = told["modes"][0]["omega"] or 1.0
    words = [f"{omega / 6.283 * share:.4g}".replace("e+", "e") for share in (0.3, 1.0, 2.7)]
    asked = [option for word in words for option in ("--at", word + "Hz")]
    shown = program.ask(tally, "transfer", scene.text(), "--format", "json", *asked)
    if shown is None:
        return
    for (_, _, entry), word in zip(transfer.rows(shown), words):
        s = I * 2 * pi() * decimal(word)
        q = acb_mat(rest.k) + acb_mat(rest.c) * s + acb_mat(rest.m) * (s * s)
        try:
            truth = (acb_mat(b.transpose()) * q.solve(acb_mat(b)))[0, 0]
        except ZeroDivisionError:
            continue
        if entry["re"] is None:
            tally.refuse("no value")
            continue
        tally.relative("transfer value", (entry["re"], entry["im"]), entry["error_bound"], truth)
