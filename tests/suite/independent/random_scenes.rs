//! Random models as text, from fixed seeds, so that everything between the text and the matrices is exercised.
//!
//! A scene is a tree of joints; each body is held to the ground by a spring of its own, stiff relative to the weights
//! and preloads, so that a rest lies near the drawing whatever else the scene contains.

use std::fmt::Write;

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): short, and the same everywhere.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number of 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    /// A decimal between two integers, with three digits after the point.
    pub fn decimal(&mut self, low: i64, high: i64) -> Decimal {
        Decimal(low * 1000 + self.below(((high - low) * 1000 + 1) as usize) as i64)
    }
}

/// A number in thousandths.
#[derive(Clone, Copy, PartialEq)]
pub struct Decimal(pub i64);

impl std::fmt::Display for Decimal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        write!(f, "{sign}{}.{:03}", self.0.abs() / 1000, self.0.abs() % 1000)
    }
}

#[derive(Clone, Copy)]
struct Place(Decimal, Decimal);

impl Place {
    fn distance(self, other: Place) -> f64 {
        let [x, y] = [self.0.0 - other.0.0, self.1.0 - other.1.0];
        ((x * x + y * y) as f64).sqrt() / 1000.0
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({} m, {} m)", self.0, self.1)
    }
}

struct Scene {
    random: Random,
    text: String,
    /// Centres of the bodies so far.
    centres: Vec<Place>,
    turns: Vec<bool>,
    /// A motion that the body certainly has: `x` or `y`; empty if it depends on its joints.
    motions: Vec<&'static str>,
    count: usize,
    loaded: bool,
}

/// A tree of up to `bodies` bodies with all kinds of elements; if `loaded`, with weights, preloads and constant forces,
/// so that its rest differs from the drawing.
pub fn tree(seed: u64, bodies: usize, loaded: bool) -> String {
    let mut scene = Scene::new(seed);
    scene.loaded = loaded;
    if loaded {
        scene.gravity();
    }
    let n = 1 + scene.random.below(bodies);
    for _ in 0..n {
        scene.body();
    }
    for i in 0..n {
        scene.held(i);
    }
    for _ in 0..scene.random.below(2 * n + 1) {
        scene.element();
    }
    for _ in 0..scene.random.below(3) {
        scene.input();
    }
    for _ in 0..1 + scene.random.below(3) {
        scene.output();
    }
    scene.text
}

/// A tree in which further joints and couplings close at least one loop.
pub fn linkage(seed: u64, bodies: usize, loaded: bool) -> String {
    let mut scene = Scene::new(seed);
    scene.loaded = loaded;
    if loaded {
        scene.gravity();
    }
    let n = 2 + scene.random.below(bodies - 1);
    for _ in 0..n {
        scene.body();
    }
    for _ in 0..1 + scene.random.below(2) {
        scene.closure();
    }
    for i in 0..n {
        scene.held(i);
    }
    for _ in 0..scene.random.below(n + 1) {
        scene.element();
    }
    for _ in 0..scene.random.below(3) {
        scene.input();
    }
    scene.output();
    scene.text
}

/// A network of masses on one line: springs and dampers between any two, some to the ground.
pub fn network(seed: u64, bodies: usize) -> String {
    let mut random = Random::new(seed);
    let n = 2 + random.below(bodies - 1);
    let mut text = String::from("model network\n");
    for i in 0..n {
        let mass = random.decimal(1, 20);
        let _ = writeln!(text, "body m{i} {{ mass = {mass} kg, moves x }}");
        // To an earlier mass or the ground, so that the network is coupled.
        let other = if i == 0 { "ground".into() } else { format!("m{}", random.below(i)) };
        let k = random.decimal(10, 5000);
        let _ = writeln!(text, "spring t{i}: {other} -- m{i} {{ k = {k} N/m }}");
    }
    for e in 0..random.below(2 * n) {
        let (a, b) = (random.below(n), random.below(n + 1));
        if a == b {
            continue;
        }
        let other = if b == n { "ground".into() } else { format!("m{b}") };
        let value = random.decimal(1, 900);
        let _ = match random.below(2) {
            0 => writeln!(text, "spring s{e}: {other} -- m{a} {{ k = {value} N/m }}"),
            _ => writeln!(text, "damper d{e}: m{a} -- {other} {{ c = {value} N*s/m }}"),
        };
    }
    text
}

impl Scene {
    fn new(seed: u64) -> Scene {
        Scene {
            random: Random::new(seed),
            text: String::from("model random\n"),
            centres: Vec::new(),
            turns: Vec::new(),
            motions: Vec::new(),
            count: 0,
            loaded: true,
        }
    }

    fn line(&mut self, text: std::fmt::Arguments) {
        let _ = self.text.write_fmt(text);
        self.text.push('\n');
    }

    fn fresh(&mut self) -> usize {
        self.count += 1;
        self.count
    }

    fn gravity(&mut self) {
        match self.random.below(4) {
            0 => {}
            1 => self.text.push_str("gravity (1.5 m/s^2, -3 m/s^2)\n"),
            _ => self.text.push_str("gravity 9.81 m/s^2\n"),
        }
    }

    fn place(&mut self) -> Place {
        Place(self.random.decimal(-3, 3), self.random.decimal(-3, 3))
    }

    /// A direction other than (0, 0), not always of rational length.
    fn direction(&mut self) -> String {
        ["(1, 0)", "(0, 1)", "(3, 4)", "(1, 1)", "(-2, 1)", "(1, -7)"][self.random.below(6)].into()
    }

    /// The ground or an earlier body; never `not`.
    fn part(&mut self, not: usize) -> Option<usize> {
        let pick = self.random.below(self.centres.len() + 1);
        (pick < self.centres.len() && pick != not).then_some(pick)
    }

    fn body(&mut self) {
        let i = self.centres.len();
        let tied = self.random.below(3) > 0;
        let (properties, centre) = self.properties();
        let clause = if tied { "" } else { self.clause() };
        self.line(format_args!("body b{i} {{ {properties}{clause} }}"));
        let turns = if tied { self.joint(i) } else { clause.contains("turns") || clause.contains("free") };
        self.centres.push(centre);
        self.turns.push(turns);
        self.motions.push(match clause {
            ", turns" | "" => "",
            ", moves y" => "y",
            _ => "x",
        });
    }

    fn clause(&mut self) -> &'static str {
        [
            ", moves x",
            ", moves y",
            ", moves x y",
            ", moves along (1, 2)",
            ", turns",
            ", free",
            ", moves along (-3, 4), turns",
        ][self.random.below(7)]
    }

    /// Mass, inertia and place in one of the forms of the language; returns the centre too.
    fn properties(&mut self) -> (String, Place) {
        let mass = self.random.decimal(1, 5);
        let centre = self.place();
        let text = match self.random.below(6) {
            0 => {
                let (dx, dy) = (self.random.decimal(1, 2), self.random.decimal(-1, 1));
                let ends = [1, -1].map(|s| Place(Decimal(centre.0.0 + s * dx.0), Decimal(centre.1.0 + s * dy.0)));
                format!("mass = {mass} kg, shape = rod({}, {})", ends[0], ends[1])
            }
            1 => format!("mass = {mass} kg, at = {centre}, shape = disk({} m)", self.random.decimal(1, 2)),
            2 => format!("mass = {mass} kg, at = {centre}, shape = ring({} m)", self.random.decimal(1, 2)),
            3 => {
                let (w, h) = (self.random.decimal(1, 3), self.random.decimal(1, 2));
                format!("mass = {mass} kg, at = {centre}, shape = box({w} m, {h} m)")
            }
            4 => {
                // At most 5 kg, at a distance of at most sqrt(72) m: 360 kg m^2.
                let (about, inertia) = (self.place(), self.random.decimal(361, 380));
                format!("mass = {mass} kg, at = {centre}, inertia = {inertia} kg*m^2 about {about}")
            }
            _ => format!("mass = {mass} kg, at = {centre}, inertia = {} kg*m^2", self.random.decimal(1, 4)),
        };
        (text, centre)
    }

    /// Connects body `i` to an earlier part; returns whether it turns.
    fn joint(&mut self, i: usize) -> bool {
        let parent = self.part(i);
        let other = parent.map_or("ground".into(), |p| format!("b{p}"));
        let parent_turns = parent.is_some_and(|p| self.turns[p]);
        match self.random.below(5) {
            0 => {
                let along = self.direction();
                let ends = self.either(&other, &format!("b{i}"));
                self.line(format_args!("slide j{i}: {ends} along {along}"));
                parent_turns
            }
            1 if parent.is_some() => {
                let ends = self.either(&other, &format!("b{i}"));
                self.line(format_args!("weld j{i}: {ends}"));
                parent_turns
            }
            _ => {
                let at = self.place();
                let ends = match self.random.below(3) {
                    0 => format!("{other}@{at} -- b{i}"),
                    1 => format!("{other} -- b{i}@{at}"),
                    _ => format!("b{i}@{at} -- {other}@{at}"),
                };
                self.line(format_args!("pivot j{i}: {ends}"));
                true
            }
        }
    }

    /// A joint or coupling between parts that are already connected to the ground.
    fn closure(&mut self) {
        let (c, n) = (self.fresh(), self.centres.len());
        let b = self.random.below(n);
        let a = self.part(b);
        let other = a.map_or("ground".into(), |a| format!("b{a}"));
        let ends = self.either(&other, &format!("b{b}"));
        let at = self.place();
        let factor = self.random.decimal(1, 4);
        match self.random.below(6) {
            0 => {
                let along = self.direction();
                self.line(format_args!("slide c{c}: {ends} along {along}"));
            }
            1 => self.line(format_args!("couple c{c}: b{b}@{at}.x = b{}@(1 m, 0.5 m).y * {factor}", (b + 1) % n)),
            2 => {
                let turning: Vec<usize> = (0..n).filter(|i| self.turns[*i]).collect();
                match turning[..] {
                    [i, j, ..] => self.line(format_args!("couple c{c}: b{i}.angle * {factor} = -b{j}.angle")),
                    [i] => self.line(format_args!("couple c{c}: b{i}.angle * {factor} * 1 m = b{b}@{at}.y")),
                    [] => self.line(format_args!("pivot c{c}: b{b}@{at} -- {other}")),
                }
            }
            _ => self.line(format_args!("pivot c{c}: b{b}@{at} -- {other}")),
        }
    }

    fn either(&mut self, a: &str, b: &str) -> String {
        if self.random.chance(50) { format!("{a} -- {b}") } else { format!("{b} -- {a}") }
    }

    /// Springs of different kinds that hold body `i` against weights and preloads.
    fn held(&mut self, i: usize) {
        let (from, to) = (self.place_near(i), self.far_from(self.centres[i]));
        let k = self.random.decimal(3000, 9000);
        self.line(format_args!("spring h{i}: ground@{to} -- b{i}@{from} {{ k = {k} N/m }}"));
        for axis in ["x", "y"] {
            let k = self.random.decimal(3000, 9000);
            self.line(format_args!("spring h{i}{axis}: b{i} -- ground {{ k = {k} N/m, along = {axis} }}"));
        }
        if self.turns[i] {
            let k = self.random.decimal(3000, 9000);
            self.line(format_args!("spring h{i}t: ground -- b{i} {{ k = {k} N*m/rad }}"));
        }
    }

    fn place_near(&mut self, i: usize) -> Place {
        let c = self.centres[i];
        Place(Decimal(c.0.0 + self.random.decimal(-1, 1).0), Decimal(c.1.0 + self.random.decimal(-1, 1).0))
    }

    /// A place at least 2 m away, relative to which the formulation's step is small.
    fn far_from(&mut self, place: Place) -> Place {
        loop {
            let other = Place(self.random.decimal(-6, 6), self.random.decimal(-6, 6));
            if other.distance(place) > 3.5 {
                return other;
            }
        }
    }

    /// A spring, damper or inerter of any geometry between any two parts.
    fn element(&mut self) {
        let e = self.fresh();
        let b = self.random.below(self.centres.len());
        let a = self.part(b);
        let other = a.map_or("ground".into(), |a| format!("b{a}"));
        let turning = self.turns[b] || a.is_some_and(|a| self.turns[a]);
        match self.random.below(3) {
            0 if turning => {
                let ends = self.either(&other, &format!("b{b}"));
                self.law(e, &ends, "", "*m/rad", "*m*s/rad", None);
            }
            1 => {
                let along = ["x", "y", "(3, 4)", "(1, -2)"][self.random.below(4)];
                let ends = self.either(&format!("{other}@(0.25 m, -0.5 m)"), &format!("b{b}"));
                self.law(e, &ends, &format!(", along = {along}"), "/m", "*s/m", None);
            }
            _ => {
                let from = self.place_near(b);
                let to = self.far_from(from);
                let ends = self.either(&format!("{other}@{to}"), &format!("b{b}@{from}"));
                self.law(e, &ends, "", "/m", "*s/m", Some(from.distance(to)));
            }
        }
    }

    fn law(&mut self, e: usize, ends: &str, along: &str, stiffness: &str, damping: &str, length: Option<f64>) {
        if self.random.chance(15) {
            let b = self.random.decimal(1, 40);
            let unit = if stiffness == "/m" { "kg" } else { "kg*m^2" };
            return self.line(format_args!("inerter e{e}: {ends} {{ b = {b} {unit}{along} }}"));
        }
        if self.random.chance(40) {
            let c = self.random.decimal(1, 40);
            return self.line(format_args!("damper e{e}: {ends} {{ c = {c} N{damping}{along} }}"));
        }
        let low = if self.random.below(7) == 0 { -90 } else { 10 };
        let k = self.random.decimal(low, 900);
        let rest = match (self.random.below(3), length) {
            _ if !self.loaded => String::new(),
            (0, Some(length)) => {
                let free = Decimal((length * (900 + self.random.below(200)) as f64) as i64);
                format!(", free_length = {free} m")
            }
            (1, _) => {
                let unit = if stiffness == "/m" { "N" } else { "N*m" };
                format!(", preload = {} {unit}", self.random.decimal(-40, 40))
            }
            _ => String::new(),
        };
        self.line(format_args!("spring e{e}: {ends} {{ k = {k} N{stiffness}{along}{rest} }}"));
    }

    fn input(&mut self) {
        let i = self.fresh();
        let b = self.random.below(self.centres.len());
        let at = self.place_near(b);
        let to = self.far_from(at);
        let constant = |value: &str| if self.loaded { format!(" = constant({value})") } else { String::new() };
        let (torque, force) = (constant("3 N*m"), constant("-7.5 N"));
        match self.random.below(4) {
            0 if self.turns[b] => self.line(format_args!("torque u{i}: b{b}{torque}")),
            1 => self.line(format_args!("force u{i}: b{b}@{at} -- ground@{to}")),
            2 => self.line(format_args!("force u{i}: b{b}@{at} along (1, 2){force}")),
            _ => self.line(format_args!("force u{i}: b{b} along y")),
        }
    }

    fn output(&mut self) {
        let i = self.fresh();
        let b = self.random.below(self.centres.len());
        let at = self.place_near(b);
        let motion = self.motions[b];
        match self.random.below(4) {
            0 if self.turns[b] => self.line(format_args!("output y{i} = b{b}.angle * 2 - b{b}.omega * 3 s")),
            1 if !motion.is_empty() => self.line(format_args!("output y{i} = b{b}@{at}.{motion} + 2 * b{b}.{motion}")),
            2 if !motion.is_empty() => self.line(format_args!("output y{i} = b{b}@{at}.v{motion}")),
            _ => self.line(format_args!(
                "output y{i} = h{b}.force / 2 - hy{i}.force\nspring hy{i}: ground -- b{b} {{ k = 5 N/m, along = y }}"
            )),
        }
    }
}
