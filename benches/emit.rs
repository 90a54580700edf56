//! Steps per second of emitted code, compared with a modal recurrence written by hand in C in the same run, and with
//! the Runge-Kutta and Newmark methods at equal error; then the ratio for every size up to 40. `cargo bench --bench
//! emit`; the last results are in benches/README.md.

#![allow(clippy::disallowed_methods)]

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::Command;
use vibc::analysis::discrete::{Hold, Options, Precision};
use vibc::analysis::{Modes, discretise, modes};
use vibc::backend::emit::{self, Language};
use vibc::base::{FileId, Name, Number, Span, Words};
use vibc::system::{Coordinate, CoordinateId, CoordinateKind, Form, Input, Label, LinearSystem, Nature, Output};

/// n masses of 1 kg between springs of 1000 N/m and dampers of 0.3 N*s/m, one end held; a force on the first mass, the
/// displacement of the last.
fn chain(n: usize) -> LinearSystem {
    let mut words = Words::new();
    let name = Label { name: Name::plain(words.intern("x")), motion: "" };
    let coordinate = Coordinate { name, kind: CoordinateKind::Translation, span: Span::new(FileId(0), 0, 0) };
    let (mut m, mut c, mut k) = (Form::new(), Form::new(), Form::new());
    let sources = [m.source(name), c.source(name), k.source(name)];
    let id = |i: usize| CoordinateId(i as u32);
    for i in 0..n {
        let between = |i: usize| {
            let back = i.checked_sub(1).map(|j| (id(j), Number::from(-1)));
            [(id(i), Number::ONE)].into_iter().chain(back)
        };
        m.push(sources[0], Nature::Property, Number::ONE, [(id(i), Number::ONE)]);
        c.push(sources[1], Nature::Property, Number::from("0.3"), between(i));
        k.push(sources[2], Nature::Property, Number::from(1000), between(i));
    }
    let at = |i: usize| vec![(id(i), Number::ONE)];
    LinearSystem {
        words,
        coordinates: vec![coordinate.clone(); n],
        m,
        c,
        k,
        inputs: vec![Input {
            name,
            span: coordinate.span,
            unit: "N",
            b: [at(0), Vec::new(), Vec::new()],
            undamped: None,
        }],
        outputs: vec![Output {
            name,
            unit: "m".into(),
            p: [at(n - 1), Vec::new(), Vec::new()],
            d: [Vec::new(), Vec::new(), Vec::new()],
        }],
        initial: Vec::new(),
        losses: None,
        chain: Vec::new(),
    }
}

const STEP: &str = "0.001";

/// Sizes that are also compared with integrators.
const SIZES: [usize; 3] = [2, 20, 200];
/// Sizes that are compared only with the recurrence: every remainder of every loop width.
const SWEEP: std::ops::RangeInclusive<usize> = 1..=40;
const FLAGS: [&[&str]; 2] = [&["-O2"], &["-O3", "-march=native"]];

/// Number of processes of which the median is taken: the position of the stack, which the system chooses, determines
/// whether vectors cross cache lines.
const PROCESSES: usize = 15;

fn main() {
    let mut out = std::io::stdout();
    for n in SIZES {
        let folder = Folder::with_sources(n);
        for flags in FLAGS {
            folder.compile(n, flags);
            let [emitted, by_hand, ratio] = folder.medians();
            let _ = writeln!(out, "n = {n}, {}", flags.join(" "));
            let _ = writeln!(out, "  emitted {emitted:.2e} steps/s, by hand {by_hand:.2e} steps/s: {ratio:.2} of it");
            folder.compile(n, &[flags, &["-DINTEGRATORS"]].concat());
            let _ = write!(out, "{}", folder.run());
        }
    }
    let _ = writeln!(out, "\n| masses | {} |\n| --- | --- | --- |", FLAGS.map(|flags| flags.join(" ")).join(" | "));
    for n in SWEEP {
        let folder = Folder::with_sources(n);
        let ratio = |flags: &[&str]| {
            folder.compile(n, flags);
            format!("{:.2}", folder.medians()[2])
        };
        let _ = writeln!(out, "| {n} | {} |", FLAGS.map(ratio).join(" | "));
    }
}

/// A temporary folder with emitted code and the program that measures it.
struct Folder(PathBuf);

impl Folder {
    fn with_sources(n: usize) -> Folder {
        let system = chain(n);
        let undamped = modes(&system).expect("modes");
        let options = Options {
            step: Number::from(STEP),
            hold: Hold::Zero,
            precision: Precision::Double,
            tolerance: None,
            unpruned: false,
            built_in: false,
            internal: Vec::new(),
            until: None,
        };
        let discrete = discretise(&system, &undamped, &options).expect("a discrete system");
        let folder = Folder(std::env::temp_dir().join(format!("vibc-bench-emit-{}-{n}", std::process::id())));
        fs::create_dir_all(&folder.0).expect("a temporary folder");
        for file in emit::files("chain", &discrete, Language::C, None) {
            fs::write(folder.0.join(file.name), file.text).expect("a temporary file");
        }
        let program = PROGRAM.replace("TABLES", &recurrence(&undamped, n));
        fs::write(folder.0.join("main.c"), program).expect("a temporary file");
        folder
    }

    fn compile(&self, n: usize, flags: &[&str]) {
        let compiled = Command::new("gcc")
            .args(["-std=c99", "-D_POSIX_C_SOURCE=200809L", &format!("-DN={n}")])
            .args(flags)
            .args(["main.c", "chain.c", "-o", "bench", "-lm"])
            .current_dir(&self.0)
            .status();
        assert!(compiled.is_ok_and(|status| status.success()), "gcc compiles");
    }

    /// Runs the program and returns its output.
    fn run(&self) -> String {
        let run = Command::new(self.0.join("bench")).output().expect("it runs");
        String::from_utf8_lossy(&run.stdout).into_owned()
    }

    /// Medians over several processes: steps per second of emitted code and of the recurrence, and the ratio within
    /// each process.
    fn medians(&self) -> [f64; 3] {
        let read = |text: String| -> Vec<f64> {
            text.split_whitespace().map(|number| number.parse().expect("a number")).collect()
        };
        let all: Vec<Vec<f64>> = (0..PROCESSES).map(|_| read(self.run())).collect();
        [0, 1, 2].map(|which| {
            let mut column: Vec<f64> = all.iter().map(|row| row[which]).collect();
            column.sort_by(f64::total_cmp);
            column[PROCESSES / 2]
        })
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The tables of the hand-written recurrence: the rotation and decay of each mode, and the effect of a held force.
fn recurrence(undamped: &Modes, n: usize) -> String {
    let h: f64 = STEP.parse().expect("a number");
    let mut rows = [const { Vec::new() }; 5];
    for mode in &undamped.list {
        let w = mode.omega.to_f64();
        let decay = 0.5 * 0.0003 * w * w;
        let turn = (w * w - decay * decay).sqrt();
        let (r, angle) = ((-decay * h).exp(), turn * h);
        let values = [r * angle.cos(), r * angle.sin(), h * mode.shape[0], h * h * mode.shape[0], mode.shape[n - 1]];
        rows.iter_mut().zip(values).for_each(|(row, value)| row.push(format!("{value:e}")));
    }
    let table =
        |(name, row): (&str, &Vec<String>)| format!("static const double {name}[N] = {{{}}};\n", row.join(", "));
    ["A", "B", "G1", "G2", "C1"].into_iter().zip(&rows).map(table).collect()
}

/// The programs run in turn, and the fastest run counts; the integrators' steps are halved until their error is at most
/// 1e-6.
const PROGRAM: &str = r#"
#include "chain.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
TABLES
typedef struct { double x[N], v[N]; } hand_state;
__attribute__((noinline)) static double hand(hand_state *s, double u)
{
    double y = 0.0;
    for (int i = 0; i < N; i++) {
        const double x = s->x[i], v = s->v[i];
        y += C1[i] * x;
        s->x[i] = A[i] * x + B[i] * v + G1[i] * u;
        s->v[i] = A[i] * v - B[i] * x + G2[i] * u;
    }
    return y;
}
static void rhs(const double *q, const double *v, double u, double *a)
{
    double tension = 1000.0 * q[0] + 0.3 * v[0];
    for (int i = 0; i < N; i++) {
        const double next = i + 1 < N ? 1000.0 * (q[i + 1] - q[i]) + 0.3 * (v[i + 1] - v[i]) : 0.0;
        a[i] = next - tension + (i == 0 ? u : 0.0);
        tension = next;
    }
}
static void rk4(double *q, double *v, double u, double h)
{
    double qa[N], va[N], k1[N], k2[N], k3[N], k4[N];
    int i;
    rhs(q, v, u, k1);
    for (i = 0; i < N; i++) { qa[i] = q[i] + h / 2 * v[i]; va[i] = v[i] + h / 2 * k1[i]; }
    rhs(qa, va, u, k2);
    for (i = 0; i < N; i++) { qa[i] = q[i] + h / 2 * v[i] + h * h / 4 * k1[i]; va[i] = v[i] + h / 2 * k2[i]; }
    rhs(qa, va, u, k3);
    for (i = 0; i < N; i++) { qa[i] = q[i] + h * v[i] + h * h / 2 * k2[i]; va[i] = v[i] + h * k3[i]; }
    rhs(qa, va, u, k4);
    for (i = 0; i < N; i++) {
        q[i] += h * v[i] + h * h / 6 * (k1[i] + k2[i] + k3[i]);
        v[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
}
/* Average acceleration, gamma = 1/2 and beta = 1/4: a tridiagonal system a step, factored for each step length. */
static double pivots[N], lowers[N], factored;
static void newmark(double *q, double *v, double *a, double u, double h)
{
    const double s = 0.3 * h / 2 + 1000.0 * h * h / 4;
    double qp[N], vp[N], b[N];
    int i;
    if (factored != h) {
        for (i = 0; i < N; i++) {
            const double own = 1.0 + (i + 1 < N ? 2 * s : s);
            lowers[i] = i ? -s / pivots[i - 1] : 0.0;
            pivots[i] = own - (i ? lowers[i] * -s : 0.0);
        }
        factored = h;
    }
    for (i = 0; i < N; i++) { qp[i] = q[i] + h * v[i] + h * h / 4 * a[i]; vp[i] = v[i] + h / 2 * a[i]; }
    rhs(qp, vp, u, b);
    for (i = 1; i < N; i++) b[i] -= lowers[i] * b[i - 1];
    for (i = N - 1; i >= 0; i--) b[i] = (b[i] + (i + 1 < N ? s * b[i + 1] : 0.0)) / pivots[i];
    for (i = 0; i < N; i++) { a[i] = b[i]; q[i] = qp[i] + h * h / 4 * b[i]; v[i] = vp[i] + h / 2 * b[i]; }
}
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static double force(int k) { return (k & 64) ? 1.0 : 0.0; }
/* Long enough for a wave to cross 200 masses. */
#define SAMPLES 12000
static double exact[SAMPLES], found[SAMPLES];
static double run(int method, int parts)
{
    static double q[N], v[N], a[N];
    const double h = 0.001 / parts;
    double start;
    int k, i;
    memset(q, 0, sizeof q); memset(v, 0, sizeof v); memset(a, 0, sizeof a);
    start = now();
    for (k = 0; k < SAMPLES; k++) {
        const double u = force(k);
        found[k] = q[N - 1];
        /* A force that jumps makes the acceleration jump. */
        if (method) rhs(q, v, u, a);
        for (i = 0; i < parts; i++) {
            if (method) newmark(q, v, a, u, h); else rk4(q, v, u, h);
        }
    }
    return now() - start;
}
static void integrators(double per_step)
{
    int k, method;
    {
        chain_state s; chain_inputs in; chain_outputs y;
        chain_init(&s);
        for (k = 0; k < SAMPLES; k++) { in.x = force(k); chain_step(&s, &in, &y); exact[k] = y.x; }
    }
    for (method = 0; method < 2; method++) {
        double worst = 1.0, time = 0.0;
        int parts = 1;
        for (;;) {
            double size = 0.0;
            time = run(method, parts); worst = 0.0;
            for (k = 0; k < SAMPLES; k++) {
                if (fabs(exact[k]) > size) size = fabs(exact[k]);
                if (fabs(exact[k] - found[k]) > worst) worst = fabs(exact[k] - found[k]);
            }
            worst /= size;
            if (worst < 1e-6 || parts > 128) break;
            parts *= 2;
        }
        printf("  %s: error %.0e with %d steps a sample, %.0f times the time of emitted code\n",
               method ? "Newmark" : "Runge and Kutta", worst, parts, time / SAMPLES / per_step);
    }
}
int main(void)
{
    const int steps = 2000000 / N;
    double best[2] = {1e9, 1e9}, sum = 0.0;
    int repeat, k;
    for (repeat = 0; repeat < 5; repeat++) {
        chain_state s; chain_inputs in; chain_outputs y; hand_state t; double start;
        memset(&t, 0, sizeof t); chain_init(&s);
        start = now();
        for (k = 0; k < steps; k++) { in.x = force(k); chain_step(&s, &in, &y); sum += y.x; }
        start = now() - start; if (start < best[0]) best[0] = start;
        start = now();
        for (k = 0; k < steps; k++) sum += hand(&t, force(k));
        start = now() - start; if (start < best[1]) best[1] = start;
    }
#ifdef INTEGRATORS
    integrators(best[0] / steps);
#else
    printf("%.4e %.4e %.4f\n", steps / best[0], steps / best[1], best[1] / best[0]);
#endif
    return sum == 1.5;
}
"#;
