//! Peaks of power spectral densities beside closed forms. See docs/method/random.md#peaks.

use super::random::answer;

fn oscillator(noise: &str, outputs: &str) -> String {
    format!(
        "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 50 N/m }}\n\
         damper d: ground -- b {{ c = 3 N*s/m }}\nforce F: b along x = {noise}\n{outputs}"
    )
}

/// Frequencies and densities of the peaks of each output.
fn peaks(text: &str) -> Vec<Result<Vec<(f64, f64)>, String>> {
    let of = |noisy: &vibc::Noisy| {
        noisy.peaks.as_ref().map_err(ToString::to_string).map(|list| {
            list.iter()
                .map(|peak| {
                    assert!(
                        peak.frequency.relative_error() < 1e-15 && peak.density.relative_error() < 1e-14,
                        "{peak:?}"
                    );
                    (peak.frequency.to_f64(), peak.density.to_f64())
                })
                .collect()
        })
    };
    answer(text).noisy.iter().map(of).collect()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-13 * b.abs()
}

/// |x|^2 = S / ((k - m w^2)^2 + c^2 w^2) is the largest at w^2 = k/m - c^2 / (2 m^2), |v|^2 at w^2 = k/m; a slope s moves the first one to
/// the larger root of s ((k - m w^2)^2 + c^2 w^2) = 2 w^2 (c^2 - 2 m (k - m w^2)), by the equation for w^2.
#[test]
fn an_oscillator_beside_closed_forms() {
    let (m, c, k) = (2.0f64, 3.0f64, 50.0f64);
    let gain2 = |y: f64| 1.0 / ((k - m * y).powi(2) + c * c * y);
    let hertz = |y: f64| y.sqrt() / std::f64::consts::TAU;
    let outputs = "output x = b.x\noutput v = b.vx\n";
    for noise in ["noise(white 6 N^2/Hz)", "noise(6 N^2/Hz, 0.1 Hz .. 3 Hz)"] {
        let found = peaks(&oscillator(noise, outputs));
        let y = k / m - c * c / (2.0 * m * m);
        let [Ok(x), Ok(v)] = &found[..] else { panic!("{found:?}") };
        assert!(x.len() == 1 && near(x[0].0, hertz(y)) && near(x[0].1, 6.0 * gain2(y)), "{x:?}");
        assert!(v.len() == 1 && near(v[0].0, hertz(k / m)) && near(v[0].1, 6.0 / (c * c)), "{v:?}");
    }
    for (slope, top) in [(1i32, "60"), (-1, "0.6"), (-2, "0.06")] {
        let found = peaks(&oscillator(&format!("noise((0.2 Hz, 6 N^2/Hz), (2 Hz, {top} N^2/Hz))"), outputs));
        let Ok(x) = &found[0] else { panic!("{found:?}") };
        let s = f64::from(slope);
        // s (k^2 - 2 k m y + m^2 y^2 + c^2 y) - 2 y (c^2 - 2 k m + 2 m^2 y) = 0
        let (a, b, e) = (s * m * m - 4.0 * m * m, (s - 2.0) * (c * c - 2.0 * k * m), s * k * k);
        let y = (-b - (b * b - 4.0 * a * e).sqrt()) / (2.0 * a);
        let density = 6.0 * (hertz(y) / 0.2).powi(slope) * gain2(y);
        let highest = x.last().expect("a peak");
        assert!(near(highest.0, hertz(y)) && near(highest.1, density), "{slope}: {x:?} {} {density}", hertz(y));
    }
    // Outside of the band there is none.
    assert_eq!(peaks(&oscillator("noise(6 N^2/Hz, 1 Hz .. 3 Hz)", "output x = b.x\n")), [Ok(Vec::new())]);
}

/// With c^2 = 2 k m, a root that no fraction is, the displacement under white noise has its peak at 0 Hz or next to it, and it is not
/// known whether there is one.
#[test]
fn a_peak_that_may_be_next_to_zero_is_not_forgotten() {
    let scene = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                 damper d: ground -- b { c = sqrt(200) * 1 N*s/m }\nforce F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n";
    let found = &peaks(scene)[0];
    assert!(found.as_ref().is_err_and(|why| why.contains("it is not proved that no peak is missing")), "{found:?}");
}

/// A base by its acceleration: relative motion as of a force, and none but what is proved.
#[test]
fn peaks_that_are_not_found_say_why() {
    let base = "body b { mass = 2 kg, moves x }\nbase g { moves x } = noise(white 0.5 m^2/s^4/Hz)\n\
                spring s: g -- b { k = 50 N/m }\ndamper d: g -- b { c = 3 N*s/m }\noutput z = b.x - g.x\noutput x = b.x\n";
    let found = peaks(base);
    let y: f64 = 25.0 - 9.0 / 8.0;
    assert!(
        matches!(&found[0], Ok(list) if list.len() == 1 && near(list[0].0, y.sqrt() / std::f64::consts::TAU)),
        "{found:?}"
    );
    assert!(matches!(&found[1], Err(why) if why.contains("drifts")), "{found:?}");
    let two = oscillator("noise(white 6 N^2/Hz)", "force G: b along x = delayed(F, 1 s)\noutput x = b.x\n");
    assert!(matches!(&peaks(&two)[0], Err(why) if why.contains("without end")));
}

/// The last root of a function that falls, between two frequencies.
fn root(slope: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    assert!(slope(low) > 0.0 && slope(high) < 0.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// d ln |x|^2 / dw of the oscillator.
fn own_slope(w: f64) -> f64 {
    let (m, c, k) = (2.0, 3.0, 50.0);
    let rest = k - m * w * w;
    (4.0 * m * w * rest - 2.0 * c * c * w) / (rest * rest + c * c * w * w)
}

/// A slope that is no whole number, and lines of a table, beside the roots of the derivative.
#[test]
fn any_slope_and_lines_of_a_table() {
    let tau = std::f64::consts::TAU;
    for (top, slope) in [(7.0f64, (7.0f64 / 6.0).log10()), (0.1, (0.1f64 / 6.0).log10()), (900.0, 150f64.log10())] {
        let noise = format!("noise((0.2 Hz, 6 N^2/Hz), (2 Hz, {top} N^2/Hz))");
        let found = peaks(&oscillator(&noise, "output x = b.x\n"));
        let Ok(list) = &found[0] else { panic!("{found:?}") };
        let w = root(|w| own_slope(w) + slope / w, [4.0, 6.5]);
        assert!(list.len() == 1 && near(list[0].0, w / tau), "{list:?} {}", w / tau);
    }
    for (rows, line) in
        [("0.2,1\n2,9\n", [1.0 - 8.0 / 9.0, 8.0 / 1.8]), ("0.2,9\n2,1\n", [9.0 + 8.0 / 9.0, -8.0 / 1.8])]
    {
        let noisy = with_table(&oscillator("noise(table(\"psd.csv\", 1 N^2/Hz))", "output x = b.x\n"), rows);
        let list = noisy[0].peaks.as_ref().expect("peaks");
        let rise = line[1] / tau;
        let w = root(|w| own_slope(w) + rise / (line[0] + rise * w), [4.0, 6.5]);
        assert!(list.len() == 1 && near(list[0].frequency.to_f64(), w / tau), "{list:?} {}", w / tau);
        let density = (line[0] + rise * w) / ((50.0 - 2.0 * w * w).powi(2) + 9.0 * w * w);
        assert!(near(list[0].density.to_f64(), density) && list[0].density.relative_error() < 1e-13, "{list:?}");
    }
}

/// The density of a free mass under a force of density 9 f - 8 from 1 Hz on: (9 f - 8) / f^4 has its maximum at 32/27 Hz, its rate
/// (9 f - 8) / f^2 at 16/9 Hz. The line is zero below the table, between two maxima of the product with a root there.
#[test]
fn a_line_that_is_zero_below_its_table_hides_no_peak() {
    let scene = "body b { mass = 1 kg, moves x }\nforce F: b along x = noise(table(\"psd.csv\", 1 N^2/Hz))\noutput x = b.x\noutput v = b.vx\n";
    let noisy = with_table(scene, "1,1\n2,10\n");
    for (own, frequency, power) in [(&noisy[0], 32.0 / 27.0, 4), (&noisy[1], 16.0 / 9.0, 2)] {
        let list = own.peaks.as_ref().expect("peaks");
        let density = (9.0 * frequency - 8.0) / (std::f64::consts::TAU * frequency).powi(power);
        assert!(list.len() == 1 && near(list[0].frequency.to_f64(), frequency), "{list:?} {frequency}");
        assert!(near(list[0].density.to_f64(), density), "{list:?} {density}");
    }
}

/// A line that begins or ends with nothing: (f - 1) / f^4 has its maximum at 4/3 Hz, (2 - f) / f^4 only falls; and an
/// oscillator under a line that ends with nothing, beside the root of the slope.
#[test]
fn a_line_from_nothing_or_to_nothing() {
    let free =
        "body b { mass = 1 kg, moves x }\nforce F: b along x = noise(table(\"psd.csv\", 1 N^2/Hz))\noutput x = b.x\n";
    for (rows, frequencies) in [("1,0\n2,10\n", &[4.0 / 3.0][..]), ("1,10\n2,0\n", &[]), ("1,0\n1.2,4\n2,0\n", &[])] {
        let noisy = with_table(free, rows);
        let list = noisy[0].peaks.as_ref().expect(rows);
        assert!(list.len() == frequencies.len(), "{rows} {list:?}");
        assert!(list.iter().zip(frequencies).all(|(peak, truth)| near(peak.frequency.to_f64(), *truth)), "{list:?}");
    }
    let tau = std::f64::consts::TAU;
    let noisy =
        with_table(&oscillator("noise(table(\"psd.csv\", 1 N^2/Hz))", "output x = b.x\n"), "0.7,0\n0.72,9\n3,0\n");
    let list = noisy[0].peaks.as_ref().expect("peaks");
    let truth = maxima(|w| own_slope(w) + 1.0 / (w - 3.0 * tau), [0.72, 2.9]);
    assert_eq!((list.len(), truth.len()), (1, 1), "{list:?} {truth:?}");
    assert!(near(list[0].frequency.to_f64(), truth[0]), "{list:?} {truth:?}");
}

/// A model beside a table.
fn with_table(text: &str, rows: &str) -> Vec<vibc::Noisy> {
    let mut sources = vibc::Sources::new();
    let model = sources.add(vibc::SourceFile::decode(vibc::SourceKind::Model, "m", text.as_bytes().to_vec()));
    sources.add(vibc::SourceFile::decode(vibc::SourceKind::Table, "psd.csv", rows.as_bytes().to_vec()));
    vibc::analyze(&sources, model, &Default::default()).answer.expect("an answer").noisy
}

/// A force and a base, each with a noise of its own: S = (A + B y) / ((k - m y)^2 + c^2 y), y = w^2, A = S_F + S_q k^2, B = S_q c^2, is the
/// largest where B m^2 y^2 + 2 m^2 A y = B k^2 - A (c^2 - 2 m k).
#[test]
fn several_noises_beside_the_closed_form() {
    let (m, c, k) = (2.0f64, 3.0f64, 50.0f64);
    let hertz = |y: f64| y.sqrt() / std::f64::consts::TAU;
    let scene = |force: &str, base: &str, output: &str| {
        format!(
            "base g {{ moves x }} = noise({base})\nbody b {{ mass = 2 kg, moves x }}\nspring s: g -- b {{ k = 50 N/m }}\n\
             damper d: g -- b {{ c = 3 N*s/m }}\nforce F: b along x = noise({force})\noutput x = {output}\n"
        )
    };
    let truth = |force: f64, base: f64| {
        let (a, b) = (force + base * k * k, base * c * c);
        let rest = b * k * k - a * (c * c - 2.0 * m * k);
        let y = ((m.powi(4) * a * a + b * m * m * rest).sqrt() - m * m * a) / (b * m * m);
        (hertz(y), (a + b * y) / ((k - m * y).powi(2) + c * c * y))
    };
    let cases = [
        ("6 N^2/Hz, 0 Hz .. 3 Hz", "0.5 m^2/Hz, 0 Hz .. 3 Hz", truth(6.0, 0.5)),
        ("6000 N^2/Hz, 0 Hz .. 3 Hz", "0.5 m^2/Hz, 0.1 Hz .. 2 Hz", truth(6000.0, 0.5)),
        // Only the base acts at the peak.
        ("6000 N^2/Hz, 0.1 Hz .. 0.7 Hz", "0.5 m^2/Hz, 0.5 Hz .. 2 Hz", truth(0.0, 0.5)),
    ];
    for (force, base, (frequency, density)) in cases {
        let found = peaks(&scene(force, base, "b.x"));
        let Ok(list) = &found[0] else { panic!("{found:?}") };
        assert!(
            list.len() == 1 && near(list[0].0, frequency) && near(list[0].1, density),
            "{list:?} {frequency} {density}"
        );
    }
    // By its acceleration the base moves the mass relative to itself as a force of -m a does.
    let (together, y) =
        (peaks(&scene("white 6 N^2/Hz", "white 2 m^2/s^4/Hz", "b.x - g.x")), k / m - c * c / (2.0 * m * m));
    let density = (6.0 + 2.0 * m * m) / ((k - m * y).powi(2) + c * c * y);
    let Ok(list) = &together[0] else { panic!("{together:?}") };
    assert!(list.len() == 1 && near(list[0].0, hertz(y)) && near(list[0].1, density), "{list:?}");
    // Both with the slope -2.
    let found =
        peaks(&scene("(0.2 Hz, 6 N^2/Hz), (2 Hz, 0.06 N^2/Hz)", "(0.2 Hz, 0.5 m^2/Hz), (2 Hz, 0.005 m^2/Hz)", "b.x"));
    let (a, b) = (6.0 + 0.5 * k * k, 0.5 * c * c);
    let w = root(|w| own_slope(w) - 2.0 / w + 2.0 * b * w / (a + b * w * w), [4.0, 6.5]);
    let Ok(list) = &found[0] else { panic!("{found:?}") };
    assert!(list.len() == 1 && near(list[0].0, w / std::f64::consts::TAU), "{list:?} {w}");
    // Of different slopes, one of them no whole number, with the white one alone before and after; and a line of a table.
    let top = 0.3f64;
    let found = peaks(&scene("white 6000 N^2/Hz", "(0.2 Hz, 1 m^2/Hz), (2 Hz, 0.3 m^2/Hz)", "b.x"));
    let slope = top.log10();
    let base = |w: f64| (w / (0.2 * std::f64::consts::TAU)).powf(slope);
    let density = |w: f64| {
        let up = k * k + c * c * w * w;
        let (a, a1) = (6000.0 + base(w) * up, base(w) * (slope / w * up + 2.0 * c * c * w));
        a1 / a + own_slope(w)
    };
    same(&found[0], &maxima(density, [0.2, 2.0]));
}

/// The frequencies in Hz at which a slope falls through zero, by its signs at 40,000 places and bisection.
fn maxima(slope: impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> Vec<f64> {
    let place = |i: i32| std::f64::consts::TAU * (from + (to - from) * f64::from(i) / 40_000.0);
    let falls = |i: &i32| slope(place(*i)) > 0.0 && slope(place(i + 1)) < 0.0;
    (0..40_000).filter(falls).map(|i| root(&slope, [place(i), place(i + 1)]) / std::f64::consts::TAU).collect()
}

#[track_caller]
fn same(found: &Result<Vec<(f64, f64)>, String>, truth: &[f64]) {
    let Ok(list) = found else { panic!("{found:?}") };
    let agree = list.iter().zip(truth).all(|((frequency, _), truth)| near(*frequency, *truth));
    assert!(list.len() == truth.len() && agree, "{list:?} {truth:?}");
}

/// A force that comes again after a time: S = 2 S_F (1 + cos w t) |H|^2 has a peak between any two of its zeros at odd multiples of
/// 1 / (2 t), in a band and under a slope; in a band of white noise without end there would be infinitely many.
#[test]
fn a_force_that_comes_again_makes_many_peaks() {
    for (noise, slope, range) in [
        ("noise(6 N^2/Hz, 0 Hz .. 3 Hz)", 0.0, [1e-3, 3.0]),
        ("noise((0.2 Hz, 6 N^2/Hz), (2 Hz, 0.1 N^2/Hz))", (0.1f64 / 6.0).log10(), [0.2, 2.0]),
    ] {
        for delay in [0.7f64, 3.3] {
            let later = format!("force G: b along x = delayed(F, {delay} s)\noutput x = b.x\n");
            let found = peaks(&oscillator(noise, &later));
            let truth = maxima(|w| slope / w - delay * (0.5 * delay * w).tan() + own_slope(w), range);
            assert!(truth.len() as f64 >= (delay * range[1]).floor(), "{truth:?}");
            same(&found[0], &truth);
        }
    }
}

/// With a loss factor and a damper S / ((k - m w^2)^2 + (k loss + c w)^2), with the slope 2 in w for the rate; with the loss factor of a
/// spring between two masses beside the derivative of its quotient.
#[test]
fn loss_factors_beside_the_closed_form() {
    let (m, c, k) = (2.0f64, 3.0f64, 50.0f64);
    let outputs = "output x = b.x\noutput v = b.vx\noutput a = b.ax\n";
    for loss in [0.1, 1.5] {
        let own = |w: f64| {
            let (re, im) = (k - m * w * w, k * loss + c * w);
            (4.0 * m * w * re - 2.0 * c * im) / (re * re + im * im)
        };
        for (noise, slope, range) in [
            ("noise(white 6 N^2/Hz)", 0.0, [1e-4, 20.0]),
            ("noise(6 N^2/Hz, 0 Hz .. 3 Hz)", 0.0, [1e-4, 3.0]),
            ("noise((0.2 Hz, 6 N^2/Hz), (2 Hz, 0.1 N^2/Hz))", (0.1f64 / 6.0).log10(), [0.2, 2.0]),
        ] {
            let scene = oscillator(noise, outputs).replace("50 N/m", &format!("50 N/m, loss = {loss}"));
            // White noise reaches the acceleration itself.
            let is_white = noise.contains("white");
            for (index, found) in peaks(&scene).iter().enumerate().filter(|(index, _)| !(is_white && *index == 2)) {
                same(found, &maxima(|w| own(w) + (slope + 2.0 * index as f64) / w, range));
            }
        }
        let later = format!("force G: b along x = delayed(F, 3.3 s)\n{outputs}");
        let scene =
            oscillator("noise(6 N^2/Hz, 0 Hz .. 3 Hz)", &later).replace("50 N/m", &format!("50 N/m, loss = {loss}"));
        same(&peaks(&scene)[0], &maxima(|w| own(w) - 3.3 * (0.5 * 3.3 * w).tan(), [1e-4, 3.0]));
    }
}

/// A force on the first of 14 equal masses in a row, which are no fractions: as white noise, and under a slope that is no whole number.
/// Of the last mass, which moves only through thirteen springs, white noise takes too long.
#[test]
fn a_long_row_of_masses_beside_elimination_by_hand() {
    let n = 14;
    let bodies: String = (0..n).map(|i| format!("body b{i} {{ mass = 1 kg, moves x }}\n")).collect();
    let tie = |i: usize| {
        let ends = if i == 0 { "ground -- b0".to_owned() } else { format!("b{} -- b{i}", i - 1) };
        format!("spring s{i}: {ends} {{ k = sqrt(2) * 1 kN/m }}\ndamper d{i}: {ends} {{ c = 2 N*s/m }}\n")
    };
    let ties: String = (0..n).map(tie).collect();
    // (K + i w C - w^2 M) q = f and its derivative, from the free end on: q_(i - 1) follows from q_i and q_(i + 1).
    let density = |w: f64, seen: usize| {
        let tie = [2f64.sqrt() * 1000.0, 2.0 * w];
        let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let over = |a: [f64; 2], b: [f64; 2]| {
            let size = b[0] * b[0] + b[1] * b[1];
            [(a[0] * b[0] + a[1] * b[1]) / size, (a[1] * b[0] - a[0] * b[1]) / size]
        };
        // With the end moving by one; each beside its derivative.
        let (mut q, mut q1) = (vec![[1.0, 0.0]], vec![[0.0, 0.0]]);
        let (mut pull, mut pull1) = ([0.0, 0.0], [0.0, 0.0]);
        for i in 0..n {
            let (x, x1) = (q[i], q1[i]);
            pull = [pull[0] - w * w * x[0], pull[1] - w * w * x[1]];
            pull1 = [pull1[0] - 2.0 * w * x[0] - w * w * x1[0], pull1[1] - 2.0 * w * x[1] - w * w * x1[1]];
            let stretch = over(pull, tie);
            let stretch1 = over([pull1[0] + 2.0 * stretch[1], pull1[1] - 2.0 * stretch[0]], tie);
            q.push([x[0] + stretch[0], x[1] + stretch[1]]);
            q1.push([x1[0] + stretch1[0], x1[1] + stretch1[1]]);
        }
        // The force on the first mass holds the ground: f = (K x - ..), the support at rest.
        let force = times(tie, q[n]);
        let force1 = times(tie, q1[n]);
        let force1 = [force1[0] - 2.0 * q[n][1], force1[1] + 2.0 * q[n][0]];
        let (x, x1) = (q[n - 1 - seen], q1[n - 1 - seen]);
        let size = |a: [f64; 2], b: [f64; 2]| 2.0 * (a[0] * b[0] + a[1] * b[1]) / (a[0] * a[0] + a[1] * a[1]);
        size(x, x1) - size(force, force1)
    };
    let scene =
        |noise: &str, seen: usize| format!("{bodies}{ties}force F: b0 along x = {noise}\noutput x = b{seen}.x\n");
    let white = "noise(white 1 N^2/Hz)";
    assert!(matches!(&peaks(&scene(white, n - 1))[0], Err(why) if why.contains("takes too long")));
    for (noise, seen, range, slope) in [
        (white, 1, [0.05, 20.0], 0.0),
        ("noise((0.5 Hz, 2 N^2/Hz), (12 Hz, 0.3 N^2/Hz))", 3, [0.5, 12.0], (0.3f64 / 2.0).ln() / 24f64.ln()),
    ] {
        let found = peaks(&scene(noise, seen));
        let Ok(list) = &found[0] else { panic!("{found:?}") };
        let truth = maxima(|w| slope / w + density(w, seen), range);
        let agree = list.iter().zip(&truth).all(|((frequency, _), truth)| (frequency / truth - 1.0).abs() < 1e-11);
        assert!(list.len() == truth.len() && truth.len() > 5 && agree, "{list:?} {truth:?}");
    }
}
