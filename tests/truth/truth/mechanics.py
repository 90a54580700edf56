"""Planar mechanics in balls: places of points as truncated power series along a line of coordinates, energies from them,
derivatives by reading off coefficients. Coordinates are translations of bodies and absolute angles; joints that close
loops are equations with multipliers."""

from flint import acb_mat, arb, arb_mat, arb_series

from .tally import decimal

GROUND = -1


class Body:
    """A body: where its mass is, how it moves (`x`, `y`, `xy`, `free`, or `pivot` at a point of another one)."""

    def __init__(self, mass, centre, motion, inertia=None, on=GROUND, at=None):
        self.mass, self.centre, self.motion, self.inertia, self.on, self.at = mass, centre, motion, inertia, on, at

    def names(self):
        """Its coordinates."""
        return {"x": ["x"], "y": ["y"], "xy": ["x", "y"], "free": ["x", "y", "angle"], "pivot": ["angle"]}[self.motion]


class Line:
    """A spring or damper between points, along the line that joins them; or torsional, between angles."""

    def __init__(self, a, b, value, free=None, preload=None, torsional=False):
        self.a, self.b, self.value, self.free, self.preload, self.torsional = a, b, value, free, preload, torsional


def exact(point):
    """A point of decimal words as fractions."""
    return decimal(point[0]), decimal(point[1])


class Scene:
    """Bodies, springs, dampers, loops and gravity."""

    def __init__(self):
        self.bodies, self.springs, self.dampers, self.loops = [], [], [], []
        self.gravity = None
        self.as_drawn = False
        self.force = None
        self.output = None

    def coordinates(self):
        """(body, name) of each coordinate, in the program's order."""
        return [(i, name) for i, body in enumerate(self.bodies) for name in body.names()]

    # --- text

    def text(self):
        rows = ["model truth"]
        if self.gravity:
            rows.append(f"gravity {self.gravity} m/s^2")
        if self.as_drawn:
            rows.append("rest as drawn")
        for i, body in enumerate(self.bodies):
            words = [f"mass = {body.mass} kg", f"at = {place(body.centre)}"]
            if body.inertia:
                words.append(f"inertia = {body.inertia} kg*m^2")
            move = {"x": "moves x", "y": "moves y", "xy": "moves x y", "free": "free", "pivot": None}[body.motion]
            rows.append(f"body b{i} {{ " + ", ".join(words + ([move] if move else [])) + " }")
        for i, body in enumerate(self.bodies):
            if body.motion == "pivot":
                rows.append(f"pivot p{i}: {name_of(body.on)}@{place(body.at)} -- b{i}")
        for i, (a, b, at) in enumerate(self.loops):
            rows.append(f"pivot loop{i}: {name_of(a)}@{place(at)} -- {name_of(b)}")
        for letter, word, lines in (("k", "spring", self.springs), ("c", "damper", self.dampers)):
            for i, line in enumerate(lines):
                unit = {"k": ("N/m", "N*m/rad"), "c": ("N*s/m", "N*m*s/rad")}[letter][line.torsional]
                fields = [f"{letter} = {line.value} {unit}"]
                if line.free is not None:
                    fields.append(f"free_length = {line.free} m")
                if line.preload is not None:
                    fields.append(f"preload = {line.preload} N")
                ends = [name_of(e[0]) + ("" if line.torsional else "@" + place(e[1])) for e in (line.a, line.b)]
                rows.append(f"{word} {letter}{i}: {ends[0]} -- {ends[1]} {{ {', '.join(fields)} }}")
        if self.force:
            rows.append(f"force F0: {name_of(self.force[0])}@{place(self.force[1])} along {self.force[2]}")
        if self.output:
            rows.append(f"output y0 = {name_of(self.output[0])}@{place(self.output[1])}.{self.output[2]}")
        return "\n".join(rows) + "\n"

    # --- places

    def at(self, i, point, q):
        """Where the point of body i that is drawn there is; `q` maps (body, name) to a series or number."""
        x, y = (arb(v) for v in exact(point))
        if i == GROUND:
            return x, y
        body = self.bodies[i]
        if body.motion == "pivot":
            px, py = (arb(v) for v in exact(body.at))
            cx, cy = self.at(body.on, body.at, q)
            return turned(cx, cy, x - px, y - py, q[i, "angle"])
        dx, dy = q.get((i, "x"), 0), q.get((i, "y"), 0)
        if body.motion == "free":
            cx, cy = (arb(v) for v in exact(body.centre))
            return turned(dx + cx, dy + cy, x - cx, y - cy, q[i, "angle"])
        return dx + x, dy + y

    def length(self, line, q):
        """The length of an element, or the relative angle of a torsional one."""
        if line.torsional:
            return q.get((line.b[0], "angle"), arb(0)) - q.get((line.a[0], "angle"), arb(0))
        ax, ay = self.at(*line.a, q)
        bx, by = self.at(*line.b, q)
        return ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt()

    def drawn(self):
        """All coordinates zero."""
        return {key: arb(0) for key in self.coordinates()}

    def stretch(self, line, q):
        """The length less the free length."""
        if line.torsional:
            return self.length(line, q)
        if line.free is not None:
            return self.length(line, q) - arb(decimal(line.free))
        return self.length(line, q) - self.length(line, self.drawn())

    def potential(self, q, tensions):
        """The potential energy."""
        total = arb(0)
        if self.gravity:
            for i, body in enumerate(self.bodies):
                total = total + self.at(i, body.centre, q)[1] * arb(decimal(body.mass) * decimal(self.gravity))
        for line, tension in zip(self.springs, tensions):
            e = self.stretch(line, q)
            total = total + e * e * arb(decimal(line.value) / 2) + e * tension
        return total

    def tensions(self):
        """Tensions as drawn beside those of the free lengths: the preloads, or what holds the drawing at rest."""
        found = [arb(decimal(line.preload)) if line.preload is not None else arb(0) for line in self.springs]
        if self.as_drawn:
            found = self.holding()
        return found

    def holding(self):
        """The tensions with the least sum of squares that make the drawing a rest; None where it takes more than that."""
        q = self.drawn()
        keys = self.coordinates()
        load = [-g for g in self.gradient(lambda at: self.potential(at, [arb(0)] * len(self.springs)), q)]
        rows = [self.gradient(lambda at, line=line: self.length(line, at), q) for line in self.springs]
        count = len(keys)
        gram = arb_mat(count, count, [sum((r[i] * r[j] for r in rows), arb(0)) for i in range(count) for j in range(count)])
        y = gram.solve(arb_mat(count, 1, load)).entries()
        return [sum((r[i] * y[i] for i in range(count)), arb(0)) for r in rows]

    def equations(self, q):
        """What closed loops hold at zero."""
        found = []
        for a, b, point in self.loops:
            ax, ay = self.at(a, point, q)
            bx, by = self.at(b, point, q)
            found += [bx - ax, by - ay]
        return found

    # --- derivatives

    def along(self, q, direction):
        """The coordinates as series q + t d."""
        return {key: arb_series([q[key], arb(direction.get(key, 0))], 3) for key in q}

    def gradient(self, f, q):
        """The first derivatives of a function of the coordinates."""
        return [coefficient(f(self.along(q, {key: 1})), 1) for key in self.coordinates()]

    def hessian(self, f, q):
        """The second derivatives."""
        keys = self.coordinates()
        count = len(keys)
        whole = arb_mat(count, count)
        for i in range(count):
            whole[i, i] = 2 * coefficient(f(self.along(q, {keys[i]: 1})), 2)
        for i in range(count):
            for j in range(i):
                both = 2 * coefficient(f(self.along(q, {keys[i]: 1, keys[j]: 1})), 2)
                whole[i, j] = whole[j, i] = (both - whole[i, i] - whole[j, j]) / 2
        return whole

    def jacobian(self, q):
        """The derivatives of the loops' equations."""
        count = len(self.equations(q))
        columns = []
        for key in self.coordinates():
            series = self.equations(self.along(q, {key: 1}))
            columns.append([coefficient(s, 1) for s in series])
        return arb_mat(count, len(columns), [columns[j][i] for i in range(count) for j in range(len(columns))])

    def mass_matrix(self, q):
        """M from the velocities of centres and the turns."""
        keys = self.coordinates()
        count = len(keys)
        whole = arb_mat(count, count)
        for i, body in enumerate(self.bodies):
            gx = self.gradient(lambda at, i=i, body=body: self.at(i, body.centre, at)[0], q)
            gy = self.gradient(lambda at, i=i, body=body: self.at(i, body.centre, at)[1], q)
            m = arb(decimal(body.mass))
            for a in range(count):
                for b in range(count):
                    whole[a, b] = whole[a, b] + m * (gx[a] * gx[b] + gy[a] * gy[b])
            if body.inertia and (i, "angle") in q:
                a = keys.index((i, "angle"))
                whole[a, a] = whole[a, a] + arb(decimal(body.inertia))
        return whole

    def squares(self, lines, q):
        """The sum of value (de/dq)(de/dq)^T of springs or dampers."""
        count = len(self.coordinates())
        whole = arb_mat(count, count)
        for line in lines:
            g = self.gradient(lambda at, line=line: self.length(line, at), q)
            value = arb(decimal(line.value))
            for a in range(count):
                for b in range(count):
                    whole[a, b] = whole[a, b] + value * g[a] * g[b]
        return whole


def turned(cx, cy, x, y, angle):
    """A point (x, y) from a centre, turned."""
    c, s = angle.cos(), angle.sin()
    return cx + c * x - s * y, cy + s * x + c * y


def coefficient(series, i):
    """A coefficient of a series, zero where it is a number."""
    if isinstance(series, arb_series):
        coefficients = series.coeffs()
        return coefficients[i] if i < len(coefficients) else arb(0)
    return arb(0)


def place(point):
    return f"({point[0]} m, {point[1]} m)"


def name_of(i):
    return "ground" if i == GROUND else f"b{i}"


class Rest:
    """A rest, enclosed, and the matrices about it over independent coordinates."""

    def __init__(self, scene, near):
        self.scene = scene
        self.keys = scene.coordinates()
        self.tensions = scene.tensions()
        self.q, self.forces = self.find(near)
        self.reduce()

    def lagrangian(self, multipliers):
        """Potential energy and the loops' equations times their multipliers."""
        def f(at):
            total = self.scene.potential(at, self.tensions)
            for g, force in zip(self.scene.equations(at), multipliers):
                total = total + g * force
            return total
        return f

    def find(self, near):
        """Newton's method from near the rest, then one interval step that proves a rest in the box."""
        scene, keys = self.scene, self.keys
        q = {key: arb(near.get(key, 0)) for key in keys}
        forces = self.first_forces(q)
        size = len(keys)
        for _ in range(8):
            step = self.step(q, forces, q, forces)
            q = {key: (q[key] + step[i]).mid() for i, key in enumerate(keys)}
            forces = [(f + step[size + i]).mid() for i, f in enumerate(forces)]
        radius = arb(2) ** -180
        widths = [arb(0, radius)] * size
        box = {key: q[key] + w for key, w in zip(keys, widths)}
        wide = [f + arb(0, radius * (1 + abs(f).mid())) for f in forces]
        step = self.step(q, forces, box, wide)
        result = {key: q[key] + step[i] for i, key in enumerate(keys)}
        for i, key in enumerate(keys):
            if not box[key].contains_interior(result[key]):
                raise ValueError("no rest is proven")
        return result, [f + step[size + i] for i, f in enumerate(forces)]

    def first_forces(self, q):
        """The multipliers that leave the least force: from the equations G^T f = -grad V, least squares."""
        count = len(self.scene.equations(q))
        if not count:
            return []
        g = self.scene.jacobian(q)
        load = self.scene.gradient(lambda at: self.scene.potential(at, self.tensions), q)
        right = g * arb_mat(len(load), 1, [-v for v in load])
        return [v.mid() for v in (g * g.transpose()).solve(right).entries()]

    def step(self, q, forces, box, wide):
        """-H(box)^-1 F(q), with the forces as unknowns too."""
        scene = self.scene
        h = scene.hessian(self.lagrangian(wide), box)
        size, count = len(self.keys), len(forces)
        whole = arb_mat(size + count, size + count)
        right = arb_mat(size + count, 1)
        first = scene.gradient(self.lagrangian(forces), q)
        for i in range(size):
            right[i, 0] = -first[i]
            for j in range(size):
                whole[i, j] = h[i, j]
        if count:
            g = scene.jacobian(box)
            values = scene.equations(q)
            for i in range(count):
                right[size + i, 0] = -values[i]
                for j in range(size):
                    whole[size + i, j] = whole[j, size + i] = g[i, j]
        return whole.solve(right).entries()

    def reduce(self):
        """M, C, K and the share of the springs' own stiffness in it, over independent coordinates."""
        scene = self.scene
        z = self.motions()
        self.z = z
        over = z.transpose()
        self.m = over * scene.mass_matrix(self.q) * z
        self.c = over * scene.squares(scene.dampers, self.q) * z
        self.k = over * scene.hessian(self.lagrangian(self.forces), self.q) * z
        self.own = over * scene.squares(scene.springs, self.q) * z

    def motions(self):
        """A basis of the motions that the loops allow, by elimination with the largest pivots."""
        size = len(self.keys)
        g = self.scene.jacobian(self.q)
        count = g.nrows()
        rows = [[g[i, j] for j in range(size)] for i in range(count)]
        pivots = []
        for i in range(count):
            j = max((j for j in range(size) if j not in pivots), key=lambda j: float(abs(rows[i][j]).mid()))
            pivots.append(j)
            scale = rows[i][j]
            rows[i] = [v / scale for v in rows[i]]
            for k in range(count):
                if k != i:
                    factor = rows[k][j]
                    rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i])]
        free = [j for j in range(size) if j not in pivots]
        z = arb_mat(size, len(free))
        for column, j in enumerate(free):
            z[j, column] = 1
            for row, pivot in zip(rows, pivots):
                z[pivot, column] = -row[j]
        return z


def eigenvalues(a):
    """Isolated eigenvalues of a real matrix; those that can only be real are made so."""
    found = []
    for value in acb_mat(a).eig():
        if value.imag.contains(0):
            value = type(value)(value.real)
        found.append(value)
    return found
