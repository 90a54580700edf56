"""The energies of the project's examples, written down by hand, for the comparison of their equations with SymPy's."""

import os

import mpmath
import sympy
from sympy.physics.mechanics import dynamicsymbols

from .equations import TIME, Comparison, Scene, belt_spans, minus, plus, rod, turn

# The value that `solve` finds is the model's from then on: bounds count from it, and it has an error of its own.
SOLVED = -26
FOLDER = os.path.join(os.path.dirname(__file__), "../../../examples")


class Example(Scene):
    """An example by its name, with the values of its names in SI units."""

    def __init__(self, name, values, change=("", "")):
        super().__init__()
        with open(os.path.join(FOLDER, f"{name}.vib"), encoding="utf-8") as file:
            self.model = file.read().replace(*change)
        self.given = {}
        for word, value in values.items():
            value = sympy.sympify(value, locals=dict(self.parameters), rational=True)
            self.parameters[word] = sympy.Symbol(word, real=True)
            self.given[self.parameters[word]] = value.xreplace(self.given)

    def text(self):
        return self.model

    def __getattr__(self, name):
        if name in self.__dict__.get("parameters", {}):
            return self.parameters[name]
        raise AttributeError(name)

    def base(self, label):
        u = dynamicsymbols(f"u{len(self.bases)}")
        self.bases.append((u, label))
        return u

    def spring(self, k, stretch):
        self.V += k * stretch ** 2 / 2

    def damper(self, c, stretch):
        self.D += c * stretch.diff(TIME) ** 2 / 2

    def mass(self, m, *place):
        self.T += sum(m * part.diff(TIME) ** 2 / 2 for part in place)

    def force(self, name, q, lever=1):
        self.Q[q] = self.Q.get(q, 0) + sympy.Symbol(name, real=True) * lever


def car_on_road():
    s = Example("car_on_road", {})
    wheel, hull, lane = s.coordinate("wheel", "y"), s.coordinate("hull", "y"), s.base("v")
    s.mass(40, wheel)
    s.mass(300, hull)
    s.spring(180000, wheel - lane)
    s.spring(18000, hull - wheel)
    s.damper(1200, hull - wheel)
    return s


def cart():
    s = Example("cart", {"m1": "1", "m2": "1/2", "L": "2", "k": "10", "b": "5", "g": "981/100"})
    x, q = s.coordinate("block", "x"), s.coordinate("rod", "angle")
    s.mass(s.m1, x)
    s.mass(s.m2, x + s.L / 2 * sympy.sin(q), -s.L / 2 * sympy.cos(q))
    s.T += s.m2 * s.L ** 2 / 24 * q.diff(TIME) ** 2
    s.V -= s.m2 * s.g * s.L / 2 * sympy.cos(q)
    s.spring(s.k, x)
    s.damper(s.b, x)
    s.force("F", x)
    return s


def double_pendulum():
    s = Example("double_pendulum", {"m": "1", "l": "1", "g": "981/100"})
    a, b = s.coordinate("upper", "angle"), s.coordinate("lower", "angle")
    # The drawing leans by 60 and 30 degrees.
    first = (s.l * sympy.sin(a + sympy.pi / 3), -s.l * sympy.cos(a + sympy.pi / 3))
    second = (first[0] + s.l * sympy.sin(b + sympy.pi / 6), first[1] - s.l * sympy.cos(b + sympy.pi / 6))
    for place in (first, second):
        s.mass(s.m, *place)
        s.V += s.m * s.g * place[1]
    s.force("push", a, second[0].diff(a))
    s.force("push", b, second[0].diff(b))
    return s


def drive_line():
    s = Example("drive_line", {"ratio": "1/2"})
    inertia = {"vehicle": 3100, "gear": 3100, "pinion1": 100, "pinion2": 110, "motor1": 300, "motor2": 172}
    q = {name: s.coordinate(name, "angle") for name in inertia}
    for name, J in inertia.items():
        s.mass(J, q[name])
    s.spring(23470, q["vehicle"] - q["gear"])
    s.spring(515384, q["pinion1"] - q["motor1"])
    s.spring(799520, q["pinion2"] - q["motor2"])
    s.constraints += [q["pinion1"] + s.ratio * q["gear"], q["pinion2"] + s.ratio * q["gear"]]
    s.force("T1", q["motor1"])
    s.force("T2", q["motor2"])
    return s


def four_bar():
    s = Example("four_bar", {"m": "6", "l": "3", "g": "981/100"})
    a, b, c, d = ((sympy.Integer(x), sympy.Integer(y)) for x, y in ((0, 0), (1, -2), (3, -2), (4, 0)))
    q = [s.coordinate(name, "angle") for name in ("left", "bar", "right")]
    left, at_b = rod(s, s.l, (a, b), q[0], a)
    bar, at_c = rod(s, s.m, (b, c), q[1], at_b)
    right, other = rod(s, s.l, (d, c), q[2], d)
    s.constraints += list(minus(other, at_c))
    s.V += s.g * (s.l * left[1] + s.m * bar[1] + s.l * right[1])
    for coordinate in q:
        s.force("F", coordinate, bar[0].diff(coordinate))
    return s


def chain(name, count, body, motion, values, first, change=("", "")):
    """Equal masses in a row; the first spring goes to `first`, or is not there."""
    s = Example(name, values, change)
    q = [s.coordinate(f"{body}[{i}]", motion) for i in range(1, count + 1)]
    for own in q:
        s.mass(s.m, own)
    for a, b in zip(q, q[1:]):
        s.spring(s.k, b - a)
    if first is not None:
        s.spring(s.k, q[0] - (s.base(first) if first else 0))
    return s, q


def frame():
    s = Example("frame", {})
    x = [s.coordinate(body, "x") for body in ("basement", "floor[1]", "floor[2]", "roof")]
    below = s.base("u")
    for mass, k, at in zip((20000, 12000, 12000, 8000), (2 * 10**9, 16 * 10**6, 14 * 10**6, 10**7), x):
        s.mass(mass, at)
        s.spring(k, at - below)
        below = at
    return s


def free_free_chain():
    s, q = chain("free_free_chain", 5, "wagon", "x", {"m": "1", "k": "1"}, None)
    s.force("pull", q[0])
    return s


def long_chain():
    # A dozen of the hundred: SymPy takes its time.
    s, q = chain("long_chain", 12, "mass", "y", {"m": "1", "k": "100"}, "", ("param N = 100", "param N = 12"))
    s.force("blow", q[-1])
    return s


def shear_building():
    return chain("shear_building", 4, "floor", "x", {"m": "4000", "k": "5000"}, "u")[0]


def drop_test():
    s = Example("drop_test", {})
    module, part, table = s.coordinate("module", "y"), s.coordinate("part", "y"), s.base("v")
    s.mass(2, module)
    s.mass(sympy.Rational("0.1"), part)
    for k, c, stretch in ((2000000, 400, module - table), (40000, 6, part - module)):
        s.spring(k, stretch)
        s.damper(c, stretch)
    return s


def earthquake():
    return chain("earthquake", 3, "floor", "x", {"m": "20000", "k": "50000000"}, "u")[0]


def half_car(name="half_car"):
    s = Example(name, {"a": "1189/1000", "b": "1696/1000", "m_chassis": "1697500/981"})
    y, q = s.coordinate("chassis", "y"), s.coordinate("chassis", "angle")
    s.mass(s.m_chassis, y)
    s.mass(3267, q)
    front, rear = y + s.a * sympy.sin(q) - s.base("v_front_road"), y - s.b * sympy.sin(q) - s.base("v_rear_road")
    s.spring(35000, front)
    s.spring(38000, rear)
    s.damper(1000, front)
    s.damper(1200, rear)
    return s


def car_over_bump():
    return half_car("car_over_bump")


def belt_drive():
    s = Example("belt_drive", {"k": "60000"})
    x, a, b = s.coordinate("motor", "x"), s.coordinate("motor", "angle"), s.coordinate("fan", "angle")
    s.mass(20, x)
    s.T += 20 * sympy.Rational(2, 25) ** 2 / 4 * a.diff(TIME) ** 2 + 30 * sympy.Rational(1, 5) ** 2 / 4 * b.diff(TIME) ** 2
    for stretch in belt_spans((x, 0), (sympy.Rational(4, 5), 0), (sympy.Rational(2, 25), sympy.Rational(1, 5)), (a, b), [x], 1):
        s.V += s.k * stretch ** 2 / 2 + 300 * stretch
    # The tensioner holds the drawing against both spans: 2 T cos(beta).
    tension = s.parameters["T_tensioner"] = sympy.Symbol("T_tensioner", real=True)
    s.given[tension] = 600 * sympy.sqrt(1 - sympy.Rational(12, 80) ** 2)
    s.V += 40000 * x ** 2 / 2 + tension * x
    s.damper(300, x)
    s.damper(2, b)
    s.force("T", a)
    # The disks stay apart.
    s.reach = mpmath.mpf(1) / 8
    return s


def board_on_shaker():
    s = Example("board_on_shaker", {})
    board, cooler, shaker = s.coordinate("board", "y"), s.coordinate("cooler", "y"), s.base("v")
    s.mass(sympy.Rational(1, 2), board)
    s.mass(sympy.Rational(1, 25), cooler)
    for k, c, stretch in ((200000, 30, board - shaker), (9000, 2, cooler - board)):
        s.spring(k, stretch)
        s.damper(c, stretch)
    return s


def slider_crank():
    # The shaft holds the drawing: P times the piston's 0.0525 m a radian.
    s = Example("slider_crank", {"P": "1200", "T_shaft": "63", "J_rod": "2197/9375000"})
    o, c, a, b = ((sympy.Rational(x, 1000), sympy.Rational(y, 1000)) for x, y in ((0, 0), (9, 12), (30, 40), (126, 0)))
    crank, bar, piston = s.coordinate("crank", "angle"), s.coordinate("rod", "angle"), s.coordinate("piston", "slide")
    s.mass(sympy.Rational(9, 10), *turn(c, crank))
    s.mass(sympy.Rational(12, 10000), crank)
    pin, arm = turn(a, crank), minus(b, a)
    s.mass(sympy.Rational(26, 100), *plus(pin, turn((arm[0] / 2, arm[1] / 2), bar)))
    s.mass(s.J_rod, bar)
    s.mass(sympy.Rational(4, 10), piston)
    s.constraints += list(minus((b[0] + piston, b[1]), plus(pin, turn(arm, bar))))
    s.spring(900, crank)
    s.damper(sympy.Rational(6, 10), crank)
    s.V += s.T_shaft * crank + s.P * piston
    s.force("gas", piston, -1)
    return s


def optimal_absorber():
    s = Example("optimal_absorber", {"M": "100", "f": "5", "mu": "1/20", "K": "M*(2*pi*f)**2", "m": "mu*M", "r": "sqrt(4+3*mu)",
                                     "a": "2*(16+23*mu+9*mu**2+2*(2+mu)*r)/(3*(64+80*mu+27*mu**2))", "nu": "2/(1+mu)*sqrt(a)",
                                     "z": "sqrt((8+9*mu-4*r)/(1+mu))/4"})
    machine, absorber = s.coordinate("machine", "x"), s.coordinate("absorber", "x")
    s.mass(s.M, machine)
    s.mass(s.m, absorber)
    s.spring(s.K, machine)
    s.spring(s.m * (2 * sympy.pi * s.f * s.nu) ** 2, absorber - machine)
    s.damper(2 * s.z * s.m * 2 * sympy.pi * s.f * s.nu, absorber - machine)
    s.force("F", machine)
    return s


def tuned_absorber():
    # `minimise` sets both parameters: the optimum of Nishihara and Asami.
    mu = "Rational(1,20)"
    r, nu = f"sqrt(4+3*{mu})", f"2/(1+{mu})"
    a = f"2*(16+23*{mu}+9*{mu}**2+2*(2+{mu})*{r})/(3*(64+80*{mu}+27*{mu}**2))"
    k = f"5*(2*pi*f*{nu})**2*{a}"
    c = f"sqrt((8+9*{mu}-4*{r})/(1+{mu}))/2*5*2*pi*f*{nu}*sqrt({a})"
    s = Example("tuned_absorber", {"M": "100", "f": "5", "K": "M*(2*pi*f)**2", "k": k, "c": c})
    machine, absorber = s.coordinate("machine", "x"), s.coordinate("absorber", "x")
    s.mass(s.M, machine)
    s.mass(5, absorber)
    s.spring(s.K, machine)
    s.spring(s.k, absorber - machine)
    s.damper(s.c, absorber - machine)
    s.force("F", machine)
    s.digits = SOLVED
    return s


def train():
    values = {}
    for i, liquid in ((1, 40000), (2, 30000), (3, 20000)):
        sloshing = liquid * 2 // 5
        of = {"liquid": liquid, "sloshing": sloshing, "k": 2000000, "c": 30000, "slosh.m": sloshing, "slosh.k": f"{sloshing}*pi**2",
              "slosh.c": f"{sloshing}*pi/100"}
        values |= {f"wagon[{i}].{name}": str(value) for name, value in of.items()}
    with open(os.path.join(FOLDER, "parts/wagon.vib"), encoding="utf-8") as file:
        s = Example("train", values, ('use "parts/wagon.vib"', file.read()))
    ahead = s.coordinate("engine", "x")
    s.mass(80000, ahead)
    s.force("pull", ahead)
    for i in (1, 2, 3):
        own = {name: s.parameters[f"wagon[{i}].{name}"] for name in ("liquid", "sloshing", "k", "c", "slosh.m", "slosh.k", "slosh.c")}
        tank, slosh = s.coordinate(f"wagon[{i}].tank", "x"), s.coordinate(f"wagon[{i}].slosh.mass", "x")
        s.mass(20000 + own["liquid"] - own["sloshing"], tank)
        s.mass(own["slosh.m"], slosh)
        for k, c, stretch in ((own["k"], own["c"], tank - ahead), (own["slosh.k"], own["slosh.c"], slosh - tank)):
            s.spring(k, stretch)
            s.damper(c, stretch)
        ahead = tank
    return s


def stiffening_mount():
    s = Example("stiffening_mount", {"m": "40", "k1": "10000", "k3": "5000000", "g": "981/100"})
    y = s.coordinate("machine", "y")
    s.mass(s.m, y)
    s.V += s.m * s.g * y + s.k1 * y ** 2 / 2 + s.k3 * y ** 4 / 4
    # 60 N s/m y' + 40 N s^2/m^2 y' |y'|
    s.damper(60, y)
    rate = y.diff(TIME)
    s.force("F", y)
    s.Q[y] -= 40 * rate * sympy.Abs(rate)
    return s


def test_hall():
    mu = "(600/28000)"
    s = Example("test_hall", {
        "floor.m": "20000", "floor.k": "20000000", "floor.c": "40000", "roof.m": "15000", "roof.k": "15000000", "roof.c": "30000",
        "machine.m": "800", "machine.k": "500000", "machine.c": "2000", "tmd.m": "600", "tmd.main_mass": "28000", "tmd.f": "16/5",
        "tmd.mu": mu, "tmd.omega": f"2*pi*16/5/(1+{mu})", "tmd.zeta": f"sqrt(3*{mu}/(8*(1+{mu})))", "corner.m": "40", "corner.k": "20000",
        "corner.c": "1500", "corner.tyre_k": "180000", "corner.tyre_c": "0", "mount.k": "8000", "mount.c": "120", "mount.n": "3",
        "drive.J1": "1/2", "drive.J2": "1/50", "drive.k1": "800", "drive.k2": "100", "drive.ratio": "3"})
    p = s.parameters
    floor, roof = s.coordinate("floor.slab", "x"), s.coordinate("roof.slab", "x")
    machine, tmd = s.coordinate("machine.mass", "x"), s.coordinate("tmd.mass", "x")
    car, wheel = s.coordinate("car", "y"), s.coordinate("corner.wheel", "y")
    instrument, knot = s.coordinate("instrument", "y"), s.coordinate("mount.knot", "y")
    gear, pinion, load = (s.coordinate(f"drive.{name}", "angle") for name in ("gear", "pinion", "load"))
    road = s.base("v")
    for name, own, below in (("floor", floor, 0), ("roof", roof, floor), ("machine", machine, roof)):
        s.mass(p[f"{name}.m"], own)
        s.spring(p[f"{name}.k"], own - below)
        s.damper(p[f"{name}.c"], own - below)
    s.mass(p["tmd.m"], tmd)
    s.spring(p["tmd.m"] * p["tmd.omega"] ** 2, tmd - roof)
    s.damper(2 * p["tmd.zeta"] * p["tmd.m"] * p["tmd.omega"], tmd - roof)
    s.mass(300, car)
    s.mass(p["corner.m"], wheel)
    for k, c, stretch in (("corner.tyre_k", "corner.tyre_c", wheel - road), ("corner.k", "corner.c", car - wheel)):
        s.spring(p[k], stretch)
        s.damper(p[c], stretch)
    s.mass(25, instrument)
    s.spring(p["mount.k"], instrument)
    s.spring(p["mount.n"] * p["mount.k"], knot)
    s.damper(p["mount.c"], instrument - knot)
    s.mass(p["drive.J1"], gear)
    s.mass(p["drive.J2"], load)
    s.spring(p["drive.k1"], gear)
    s.spring(p["drive.k2"], load - pinion)
    s.constraints.append(pinion + p["drive.ratio"] * gear)
    s.force("unbalance", machine)
    return s


def single(name, values, body, motion, m, k, c=0, force=None):
    s = Example(name, values)
    q = s.coordinate(body, motion)
    of = lambda word: s.parameters.get(word, word) if isinstance(word, str) else word(s)
    s.mass(of(m), q)
    s.spring(of(k), q)
    if c:
        s.damper(of(c), q)
    if force:
        s.force(force, q)
    return s


def hinged_body():
    # `solve` sets both parameters: 10 N * 0.4 m / 0.005 rad, and 5 Hz.
    s = single("hinged_body", {"kt": "800", "J": "kt/(10*pi)**2"}, "beam", "angle", "J", "kt", force="T")
    s.digits = SOLVED
    return s


def inerter_table():
    s = Example("inerter_table", {"m": "200", "fn": "10", "fs": "30", "k": "m*(2*pi*fn)**2"})
    y = s.coordinate("table", "y")
    stretch = y - s.base("v")
    s.mass(s.m, y)
    s.mass(s.k / (2 * sympy.pi * s.fs) ** 2, stretch)
    s.spring(s.k, stretch)
    return s


def inverted_pendulum():
    s = Example("inverted_pendulum", {"m": "1", "L": "1", "k": "5", "g": "981/100"})
    q = s.coordinate("rod", "angle")
    s.mass(s.m * s.L ** 2 / 3, q)
    s.V += s.m * s.g * s.L / 2 * sympy.cos(q)
    tip = turn((sympy.Integer(0), s.L), q)
    for side in (-1, 1):
        s.spring(s.k, sympy.sqrt((tip[0] - side) ** 2 + (tip[1] - s.L) ** 2) - 1)
    s.force("gust", q)
    return s


def isolation_table():
    # `solve` asks for -12 dB at 30 Hz.
    s = Example("isolation_table", {"m": "200", "fn": "30*sqrt(10**(-3/5)/(1+10**(-3/5)))", "zeta": "1/10", "wn": "2*pi*fn"})
    table, damped, floor = s.coordinate("table", "y"), s.coordinate("damped", "y"), s.base("v")
    for y in (table, damped):
        s.mass(s.m, y)
        s.spring(s.m * s.wn ** 2, y - floor)
    s.damper(2 * s.zeta * s.m * s.wn, damped - floor)
    s.digits = SOLVED
    return s


def machine_series():
    return single("machine_series", {"m": "120", "k": "480000", "c": "2000"}, "machine", "y", "m", "k", "c", "F")


def light_station():
    return single("light_station", {"m": "273000", "fn": "1", "zeta": "1/100", "wn": "2*pi*fn"}, "station", "x", "m",
                  lambda s: s.m * s.wn ** 2, lambda s: 2 * s.zeta * s.m * s.wn, "machine")


def mortar():
    return single("mortar", {"m": "10000", "k": "15791", "c": "25133/100"}, "car", "y", "m", "k", "c")


def quarter_car():
    s = Example("quarter_car", {})
    chassis, wheel, road = s.coordinate("chassis", "y"), s.coordinate("wheel", "y"), s.base("v")
    s.mass(500, chassis)
    s.mass(50, wheel)
    for k, c, stretch in ((18000, 1500, chassis - wheel), (180000, 500, wheel - road)):
        s.spring(k, stretch)
        s.damper(c, stretch)
    return s


def rotor():
    # The frame moves along y alone: the component along x does no work.
    s = Example("rotor", {"m": "50", "speed": "50*pi"})
    y = s.coordinate("frame", "y")
    s.mass(s.m, y)
    s.spring(2000000, y)
    s.damper(1000, y)
    s.unbalance("U", (sympy.Integer(0), y), sympy.Rational(1, 100), "speed")
    return s


def shaker_test():
    s = Example("shaker_test", {})
    module, part, shaker = s.coordinate("module", "y"), s.coordinate("part", "y"), s.base("v")
    s.mass(sympy.Rational("2.4"), module)
    s.mass(sympy.Rational("0.3"), part)
    for k, c, stretch in ((4200000, 320, module - shaker), (130000, 12, part - module)):
        s.spring(k, stretch)
        s.damper(c, stretch)
    return s


def stacked_blocks():
    return single("stacked_blocks", {"small": "1", "large": "10", "m": "small+large", "k": "250", "zeta": "1/20"}, "blocks", "x", "m", "k",
                  lambda s: 2 * s.zeta * sympy.sqrt(s.m * s.k), "F")


def tuned_mass_damper():
    s = Example("tuned_mass_damper", {"M": "100", "f": "5", "mu": "1/20", "m": "mu*M", "w": "2*pi*f", "wa": "w/(1+mu)",
                                      "zeta": "sqrt(3*mu/(8*(1+mu)))"})
    machine, absorber = s.coordinate("machine", "x"), s.coordinate("absorber", "x")
    s.mass(s.M, machine)
    s.mass(s.m, absorber)
    s.spring(s.M * s.w ** 2, machine)
    s.spring(s.m * s.wa ** 2, absorber - machine)
    s.damper(2 * s.zeta * s.m * s.wa, absorber - machine)
    s.force("F", machine)
    return s


ALL = [belt_drive, board_on_shaker, car_on_road, car_over_bump, cart, double_pendulum, drive_line, drop_test, earthquake, four_bar, frame, free_free_chain, half_car, hinged_body,
       inerter_table, inverted_pendulum, isolation_table, light_station, long_chain, machine_series, mortar, optimal_absorber, quarter_car, rotor, shaker_test, shear_building,
       slider_crank, stacked_blocks, stiffening_mount, test_hall, train, tuned_absorber, tuned_mass_damper]
# An example that is added needs its energies here.
# A loss factor is no law in time, so that `vibc equations` refuses it.
REFUSED = ["rubber_mounts.vib"]
assert sorted([f"{made.__name__}.vib" for made in ALL] + REFUSED) == sorted(name for name in os.listdir(FOLDER) if name.endswith(".vib"))

made = iter(())


def scene(rng):
    """One example after the other."""
    global made
    try:
        return next(made)()
    except StopIteration:
        made = iter(ALL)
        return next(made)()


def check(scene, program, tally, rng):
    """The example as it is, parameters that `solve` would set included."""
    tally.command = "vibc equations MODEL --format json"
    told = program.run("equations", scene.text(), "--format", "json").json()
    if told is None:
        tally.refuse("no equations")
        return
    Comparison(scene, told, tally, rng).run()
