//! `sweep --format npz`: the numbers of the CSV, in an archive that is read here as the formats of ZIP and NumPy say. NumPy itself reads it in
//! python/tests/test_program.py.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A case without mass, in which a frequency and poles are missing, and one without a rest.
const MODEL: &str = "model one
param k = 100 N/m
param m = 1 kg
body b { mass = m, moves x }
body e { mass = 2 kg, moves x }
spring s: ground -- b { k = k }
spring r: b -- e { k = 40 N/mm }
damper d: ground -- b { c = 3 N*s/m }
force F: b along x
output x = b.x
require frequency(1) > 0.5 Hz
";

fn ran(at: &Path, arguments: &[&str]) -> Output {
    fs::write(at.join("one.vib"), MODEL).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(["sweep", "one.vib"]).args(arguments).current_dir(at).output().expect("the program starts")
}

const STUDY: [&str; 9] = [
    "--over",
    "m=1kg,-2kg,0kg",
    "--over",
    "k=0N/m..50N/m:41",
    "--poles",
    "--modes",
    "2",
    "--measure",
    "gain(F -> x, 0 Hz)",
];

fn integer(bytes: &[u8], at: usize, length: usize) -> usize {
    bytes[at..at + length].iter().rev().fold(0, |number, byte| (number << 8) | usize::from(*byte))
}

/// The remainder of the bits by the polynomial, one by one.
fn crc(bytes: &[u8]) -> u32 {
    let mut sum = !0_u32;
    for bit in bytes.iter().flat_map(|byte| (0..8).map(move |bit| (byte >> bit) & 1)) {
        let odd = (sum & 1) != u32::from(bit);
        sum = (sum >> 1) ^ if odd { 0xEDB8_8320 } else { 0 };
    }
    !sum
}

/// The kind, the shape and the data of each array, by its name.
fn arrays(file: &[u8]) -> Vec<(String, String, Vec<u8>)> {
    let end = file.len() - 22;
    assert_eq!(&file[end..end + 4], b"PK\x05\x06");
    let (count, size, mut at) = (integer(file, end + 10, 2), integer(file, end + 12, 4), integer(file, end + 16, 4));
    assert_eq!(at + size, end);
    let mut found = Vec::new();
    for _ in 0..count {
        assert_eq!(&file[at..at + 4], b"PK\x01\x02");
        let [method, sum, packed, size, name, place] = [(10, 2), (16, 4), (20, 4), (24, 4), (28, 2), (42, 4)]
            .map(|(from, length)| integer(file, at + from, length));
        let title = String::from_utf8(file[at + 46..at + 46 + name].to_vec()).expect("a name");
        at += 46 + name;
        assert_eq!((method, packed), (0, size));
        assert_eq!(
            (&file[place..place + 4], &file[place + 30..place + 30 + name]),
            (&b"PK\x03\x04"[..], title.as_bytes())
        );
        let data = &file[place + 30 + name..][..size];
        assert_eq!(crc(data) as usize, sum, "{title}");
        assert_eq!(&data[..8], b"\x93NUMPY\x01\0");
        let start = 10 + integer(data, 8, 2);
        assert!(start.is_multiple_of(64) && data[start - 1] == b'\n');
        found.push((title, String::from_utf8_lossy(&data[10..start]).trim_end().to_string(), data[start..].to_vec()));
    }
    assert_eq!(at, end);
    found
}

fn texts((_, heading, data): &(String, String, Vec<u8>)) -> Vec<String> {
    let longest: usize = heading.split("<U").nth(1).and_then(|rest| rest.split('\'').next()?.parse().ok()).expect("<U");
    let letter = |four: &[u8]| char::from_u32(integer(four, 0, 4) as u32).expect("a letter");
    let text = |bytes: &[u8]| bytes.chunks(4).map(letter).collect::<String>().trim_end_matches('\0').to_string();
    data.chunks(4 * longest).map(text).collect()
}

#[test]
fn arrays_have_the_numbers_of_the_csv() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    let csv = String::from_utf8(ran(at, &[&STUDY[..], &["--format", "csv"]].concat()).stdout).expect("text");
    for name in ["a.npz", "b.npz"] {
        let written = ran(at, &[&STUDY[..], &["--format", "npz", "-o", name]].concat());
        assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    }
    let file = fs::read(at.join("a.npz")).expect("a file");
    assert_eq!(file, fs::read(at.join("b.npz")).expect("a file"));
    let arrays = arrays(&file);
    let names: Vec<&str> = arrays.iter().map(|(name, ..)| name.as_str()).collect();
    assert_eq!(names, ["columns.npy", "units.npy", "table.npy", "codes.npy"]);
    let [columns, units, codes] = [0, 1, 3].map(|place| texts(&arrays[place]));
    let (heading, rows) = csv.split_once('\n').expect("rows");
    let titled = |(name, unit): (&String, &String)| match unit.is_empty() || name.ends_with("_bound") {
        true => name.clone(),
        false => format!("{name} [{unit}]"),
    };
    let titles: Vec<String> = columns.iter().zip(&units).map(titled).collect();
    // Names with commas stand in quotation marks.
    assert_eq!(heading.replace('"', ""), format!("case,{}", titles.join(",")));
    let rows: Vec<Vec<&str>> = rows.lines().map(|row| row.split(',').skip(1).collect()).collect();
    assert_eq!((rows.len(), columns.len()), (123, rows[0].len()));
    assert_eq!(arrays[2].1, format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (123, {}), }}", columns.len()));
    let numbers: Vec<f64> =
        arrays[2].2.chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().expect("eight"))).collect();
    for (row, numbers) in rows.iter().zip(numbers.chunks(columns.len())) {
        for ((text, number), name) in row.iter().zip(numbers).zip(&columns) {
            let expected = match *text {
                _ if name == "code" => codes.iter().position(|code| code == text).expect("a code") as f64,
                "" if name.ends_with("_bound") => f64::INFINITY,
                "" => f64::NAN,
                "true" => 1.0,
                "false" => 0.0,
                text => text.parse().expect("a number"),
            };
            assert_eq!(expected.to_bits(), number.to_bits(), "{name}: {text} {number}");
        }
    }
    // Something of every sort was there.
    assert!(
        codes.len() > 1
            && codes[0].is_empty()
            && csv.contains(",inf,")
            && csv.contains("true")
            && csv.contains("false")
    );
}

#[test]
fn arrays_are_files_and_no_larger_than_their_format_allows() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (more, message) in [
        (&["k=1N/m,2N/m", "--format", "npz"][..], "add `-o FILE.npz`"),
        (&["k=1N/m,2N/m", "--format", "npz", "-o", "-"], "add `-o FILE.npz`"),
        (&["k=1N/m,2N/m", "--format", "npz", "-o", "a.npz", "--shard", "0/2"], "parts are CSV"),
        (&["k=1N/m..2N/m:1000000000", "--format", "npz", "-o", "a.npz"], "too much for one file"),
    ] {
        let output = ran(folder.path(), &[&["--over"], more].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.starts_with("error: ") && said.contains(message) && said.lines().count() == 1, "{said}");
        assert!(output.stdout.is_empty() && !folder.path().join("a.npz").exists());
    }
}

/// A parameter that is called as a column of every table would be taken for it, or it for the parameter.
#[test]
fn columns_of_the_table_are_no_parameters() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for name in ["case", "code"] {
        let model = MODEL.replace("k = 100", &format!("{name} = 100")).replace("k = k", &format!("k = {name}"));
        fs::write(folder.path().join("two.vib"), model).expect("a file");
        let run = |more: &[&str]| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
            command.args(["sweep", "two.vib", "--over", &format!("{name}=1N/m,2N/m")]).args(more);
            command.current_dir(folder.path()).output().expect("the program starts")
        };
        for more in [&["--format", "csv"][..], &["--format", "npz", "-o", "a.npz"]] {
            let output = run(more);
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(
                output.status.code() == Some(2) && said.contains(&format!("a column `{name}` of its own")),
                "{said}"
            );
            assert!(output.stdout.is_empty() && !folder.path().join("a.npz").exists());
        }
        assert_eq!(run(&["--format", "json"]).status.code(), Some(0));
    }
}
