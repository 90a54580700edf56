"""Forces in pivots, at rest and under a force that shakes the scene: every pivot may open, equations keep it shut, and their
multipliers are the forces."""

from flint import acb_mat, arb, arb_mat, ctx

from . import planar, transfer
from .exact import I, pi
from .mechanics import GROUND, Rest, Scene, exact, turned
from .tally import decimal

BITS = 330


class Opened(Scene):
    """The same bodies, each on a pivot free to leave it by (ex, ey)."""

    def __init__(self, scene):
        super().__init__()
        self.bodies, self.springs, self.dampers, self.loops = scene.bodies, scene.springs, scene.dampers, scene.loops
        self.gravity, self.force = scene.gravity, scene.force

    def pivots(self):
        return [i for i, body in enumerate(self.bodies) if body.motion == "pivot"]

    def coordinates(self):
        return super().coordinates() + [(i, name) for i in self.pivots() for name in ("ex", "ey")]

    def at(self, i, point, q):
        if i == GROUND or self.bodies[i].motion != "pivot":
            return super().at(i, point, q)
        body = self.bodies[i]
        (x, y), (px, py) = exact(point), exact(body.at)
        cx, cy = self.at(body.on, body.at, q)
        return turned(cx + q.get((i, "ex"), 0), cy + q.get((i, "ey"), 0), arb(x) - arb(px), arb(y) - arb(py), q[i, "angle"])


def scene(rng):
    """Rows of links, carts with a pendulum, four-bar linkages, with a force on one of the bodies."""
    found = rng.choice((planar.row, planar.row, planar.cart, planar.four))(rng)
    if rng.random() < 0.6:
        planar.dampers(rng, found)
    i = rng.randrange(len(found.bodies))
    body = found.bodies[i]
    axis = body.motion if body.motion in ("x", "y") else rng.choice(("x", "y"))
    found.force = (i, body.centre, axis)
    return found


def names(scene):
    """Every reaction: its word and its place among the multipliers, those of the loops first."""
    loops = [(f"loop{k}", 2 * k) for k in range(len(scene.loops))]
    pivots = [(f"p{i}", 2 * (len(scene.loops) + k)) for k, i in enumerate(Opened(scene).pivots())]
    return [(f"{name}.f{axis}", place + side) for name, place in loops + pivots for side, axis in enumerate("xy")]


def text(scene, limits):
    rows = [f"output r{place} = {word}" for word, place in names(scene)]
    rows += [f"require rest({word}) > -1e30 N" for word, _ in names(scene)] if limits else []
    return scene.text() + "\n".join(rows) + "\n"


class Forces:
    """The multipliers of an opened scene about a rest."""

    def __init__(self, scene, rest):
        self.opened = Opened(scene)
        keys = self.opened.coordinates()
        q = {key: rest.q.get(key, arb(0)) for key in keys}
        held = [key for key in keys if key not in rest.q]

        def lagrangian(at):
            total = self.opened.potential(at, rest.tensions)
            for g, force in zip(self.opened.equations(at), rest.forces):
                total = total + g * force
            return total

        slope = dict(zip(keys, self.opened.gradient(lagrangian, q)))
        # What the joint does to the second part is minus its multiplier.
        self.at_rest = [-force for force in rest.forces] + [slope[key] for key in held]
        self.k = self.opened.hessian(lagrangian, q)
        self.m = self.opened.mass_matrix(q)
        self.c = self.opened.squares(self.opened.dampers, q)
        rows = []
        if scene.loops:
            g = self.opened.jacobian(q)
            rows = [[g[i, j] for j in range(len(keys))] for i in range(g.nrows())]
        self.rows = rows + [[arb(1 if key == other else 0) for other in keys] for key in held]
        i, place, axis = scene.force
        side = 0 if axis == "x" else 1
        self.b = self.opened.gradient(lambda at: self.opened.at(i, place, at)[side], q)

    def under(self, s):
        """The reactions under a unit of the force."""
        size, count = self.k.nrows(), len(self.rows)
        whole, right = acb_mat(size + count, size + count), acb_mat(size + count, 1)
        z = acb_mat(self.k) + acb_mat(self.c) * s + acb_mat(self.m) * (s * s)
        for i in range(size):
            right[i, 0] = self.b[i]
            for j in range(size):
                whole[i, j] = z[i, j]
            for k, row in enumerate(self.rows):
                whole[i, size + k] = whole[size + k, i] = row[i]
        solved = whole.solve(right)
        return [-solved[size + k, 0] for k in range(count)]


def check(scene, program, tally, rng):
    """Compares the whole of each reaction at rest, and its transfer values."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", text(scene, True), "--format", "json")
    if told is None:
        return
    if not told["rest"]["proven"]:
        tally.refuse("rest not proven")
        return
    shown = told["rest"]["displacement"]
    try:
        rest = Rest(scene, {(i, name): shown.get(f"b{i}.{name}", 0.0) for i, name in scene.coordinates()})
        forces = Forces(scene, rest)
    except (ValueError, ZeroDivisionError):
        tally.refuse("the oracle proves no rest")
        return
    for (_, place), row in zip(names(scene), told["requirements"]):
        if row["value"] is None:
            tally.refuse("no value")
            continue
        tally.relative("reaction at rest", row["value"], row["error_bound"], forces.at_rest[place])
    responses(scene, forces, program, tally, told)


def responses(scene, forces, program, tally, told):
    """Transfer values below, at and above the first frequency."""
    omega = told["modes"][0]["omega"] or 1.0
    words = [f"{omega / 6.283 * share:.4g}".replace("e+", "e") for share in (0.3, 1.0, 2.7)]
    asked = [option for word in words for option in ("--at", word + "Hz")]
    shown = program.ask(tally, "transfer", text(scene, False), "--format", "json", *asked)
    if shown is None:
        return
    truths = {}
    for word in words:
        try:
            truths[float(word)] = forces.under(I * 2 * pi() * decimal(word))
        except ZeroDivisionError:
            continue
    for _, output, row in transfer.rows(shown):
        truth = truths.get(row["frequency_hz"])
        if truth is not None and output.startswith("r"):
            transfer.compare_value(row, truth[int(output[1:])], tally)
