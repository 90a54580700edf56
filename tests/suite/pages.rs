//! `vibc report` and `vibc watch`: one file that asks for nothing; a server that answers its own pages only, and keeps the last
//! report without errors. What a browser makes of the page is tested by `clients.rs`. See docs/report.md.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use vibc::overview::Shown;
use vibc::{FileId, Overrides, SourceFile, Sources, Study};

fn page(text: &str) -> String {
    let mut sources = Sources::new();
    let model: FileId = sources.add(SourceFile::model("m.vib", text));
    let outcome = vibc::overview::overview(&sources, model, &Overrides::default(), &Study::default());
    outcome.answer.expect("a model without errors").page((&sources, model), &Shown::default())
}

const MASS: &str = "model mass\nbody block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 200 N/m }\n";

#[test]
fn the_page_is_one_file_that_names_no_other() {
    for name in ["cart.vib", "half_car.vib", "double_pendulum.vib"] {
        let text =
            fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)).expect("an example");
        let page = page(&text);
        // The one address is the name of a format.
        let addresses = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!addresses.contains("http:") && !addresses.contains("https:") && !addresses.contains("src="), "{name}");
        assert!(page.len() < 400_000, "{name}: {} bytes", page.len());
        assert_eq!(page, self::page(&text), "{name}: the same model gives the same bytes");
    }
}

/// A chain of twenty freedoms with damping, an input and two outputs.
#[test]
fn twenty_degrees_of_freedom_stay_below_400_kilobytes() {
    let text = "model chain\nbody m[1] { mass = 1 kg, moves x }\nspring k[1]: ground -- m[1] { k = 1 kN/m }\ndamper c: ground -- m[1] { c = 3 N*s/m }\n\
                repeat i in 2..20 {\nbody m[i] { mass = 1 kg, moves x }\nspring k[i]: m[i-1] -- m[i] { k = 1 kN/m }\n}\n\
                force push: m[20] along x = step(1 N, 0 s)\noutput end = m[20].x\noutput first = m[1].x\n";
    let page = page(text);
    assert!(page.len() < 400_000, "{} bytes", page.len());
    // Curves come from poles and residues, not from samples.
    assert!(page.contains("\"terms\":[[") && !page.contains("\"samples\":"), "curves are fractions");
}

/// The sections of noise and of response spectra, with their numbers, bounds and reasons.
#[test]
fn the_page_has_noise_and_spectra() {
    let scene = |signal: &str, more: &str| {
        format!(
            "base g {{ moves x }} = {signal}\nbody b {{ mass = 2 kg, moves x }}\nspring s: g -- b {{ k = 200 N/m }}\n{more}\
             output pull = s.force\noutput slip = g.vx\n"
        )
    };
    let text = |page: &str| page.replace("&nbsp;", " ").replace('\u{a0}', " ");
    let noisy = text(&page(&scene("noise(white 3 m^2/s^4/Hz)", "damper d: g -- b { c = 2 N*s/m }\n")));
    for words in
        ["<h2", "Noise</h2>", "stationary response to noise", "17.3205", "51.9615", "1.59155", "rms of slip: infinite"]
    {
        assert!(noisy.contains(words), "{words}: {noisy}");
    }
    let undamped = text(&page(&scene("noise(3 m^2/s^4/Hz, 1 Hz .. 2 Hz)", "")));
    assert!(
        undamped.contains("infinite: nothing damps mode 1, and the noise has power at its frequency"),
        "{undamped}"
    );
    let spectrum = "spectrum((0.5 Hz, 4 m/s^2), (9 Hz, 4 m/s^2), damping = 5 %)";
    let spectral = text(&page(&scene(spectrum, "damper d: g -- b { c = 2 N*s/m }\n")));
    for words in [
        "Response spectra</h2>",
        "by g: damping 5 %",
        "8.00000",
        "slip: a velocity, which a response spectrum does not have",
    ] {
        assert!(spectral.contains(words), "{words}: {spectral}");
    }
    let refused = text(&page(&scene(spectrum, "damper d: g -- b { c = 1.6 N*s/m }\n")));
    assert!(refused.contains("mode 1 has a damping ratio of 4.000 %"), "{refused}");
    assert!(!page(MASS).contains("Noise</h2>") && !page(MASS).contains("Response spectra</h2>"));
}

/// Two structures alike on one base have double poles, which have no fractions: the page solves the equations at each frequency.
#[test]
fn curves_beside_double_poles_are_no_polygons() {
    let page = page(
        "model twins\nbase floor { moves x }\nrepeat i in 1..2 {\nbody low[i] { mass = 4 kg, moves x }\nbody high[i] { mass = 1 kg, moves x }\n\
         spring s[i]: floor -- low[i] { k = 400 N/m }\nspring t[i]: low[i] -- high[i] { k = 90 N/m }\ndamper d[i]: low[i] -- high[i] { c = 0.3 N*s/m }\n}\n\
         force F: low[1] along x\noutput first = high[1].x\noutput both = high[1].x + high[2].x\n",
    );
    assert!(page.contains("\"matrices\":[[0,0,4.0,0.3,490.0]") && page.contains("\"b\":[[0,"), "equations");
    assert!(!page.contains("\"samples\":"), "no samples");
}

#[test]
fn text_of_a_model_is_text_of_the_page() {
    let page = page(&format!("/// </script><script>alert(1)</script> <img src=x onerror=alert(1)>\n{MASS}"));
    assert_eq!(page.matches("<script").count(), 2, "the payload and the page's own");
    assert!(!page.contains("<img"));
    assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;"));
}

/// A server that ends with the test.
struct Watching {
    child: Child,
    port: u16,
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Watching {
    fn of(model: &Path) -> Watching {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
        let mut child = command.arg("watch").arg(model).stdout(Stdio::piped()).spawn().expect("the program starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output")).read_line(&mut line).expect("an address");
        let port = line.trim().trim_end_matches('/').rsplit(':').next().and_then(|port| port.parse().ok());
        Watching { child, port: port.unwrap_or_else(|| panic!("an address: {line}")) }
    }

    fn connect(&self, request: &str) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a time limit");
        stream.write_all(request.replace("PORT", &self.port.to_string()).as_bytes()).expect("a request");
        stream
    }

    fn ask(&self, request: &str) -> String {
        let mut answer = String::new();
        self.connect(request).read_to_string(&mut answer).expect("an answer");
        answer
    }
}

const GET: &str = "GET / HTTP/1.1\r\nHost: 127.0.0.1:PORT\r\nConnection: close\r\n\r\n";

#[test]
fn the_server_answers_its_own_pages_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("m.vib");
    fs::write(&model, MASS).expect("a model");
    let server = Watching::of(&model);
    assert!(server.ask(GET).starts_with("HTTP/1.1 200"));
    let status = |request: &str| server.ask(request).split(' ').nth(1).unwrap_or_default().to_string();
    assert_eq!(status(&GET.replace("127.0.0.1:PORT", "evil.example")), "403");
    assert_eq!(status(&GET.replace("Connection", "Origin: http://evil.example\r\nConnection")), "403");
    assert_eq!(status(&GET.replace("Connection", "Origin: http://127.0.0.1:PORT\r\nConnection")), "200");
    assert_eq!(status(&GET.replace("GET /", "GET /../etc/passwd")), "404");
    assert_eq!(status(&GET.replace("GET", "DELETE")), "405");
}

#[test]
fn a_save_is_noticed_and_errors_appear_above_the_last_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("m.vib");
    fs::write(&model, MASS).expect("a model");
    let server = Watching::of(&model);
    let mut events = BufReader::new(server.connect("GET /events HTTP/1.1\r\nHost: localhost:PORT\r\n\r\n"));
    let mut heard = || loop {
        let mut line = String::new();
        events.read_line(&mut line).expect("an event");
        if let Some(version) = line.strip_prefix("data: ") {
            return version.trim().to_string();
        }
    };
    assert_eq!(heard(), "1");
    assert!(server.ask(GET).contains("1.59"), "sqrt(100) / 2 pi Hz");
    // Saved as editors do: another file takes its place.
    let new = folder.path().join("m.vib.new");
    fs::write(&new, MASS.replace("200 N/m", "800 N/m")).expect("a save");
    fs::rename(&new, &model).expect("a save");
    assert_eq!(heard(), "2");
    assert!(server.ask(GET).contains("3.18"), "sqrt(400) / 2 pi Hz");
    fs::write(&model, MASS.replace("200 N/m", "200 N")).expect("a save");
    assert_eq!(heard(), "3");
    let page = server.ask(GET);
    assert!(page.contains("role=\"alert\"") && page.contains("vib::unit::mismatch"), "the error");
    assert!(page.contains("3.18") && page.contains("k = 200 N }"), "the last report, and the text as it is");
    assert!(page.contains("<li id=\"L3\" class=\"wrong\">"), "at its place");
}
