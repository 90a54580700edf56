//! Studies as arrays for NumPy: a ZIP archive without compression and without dates, so that the same study gives the same bytes. In: the
//! columns and the rows, piece by piece. Out: the bytes, in their order. See docs/cli.md#sweeps.

use super::json_number::JsonNumber;
use super::sweep::has_bound;
use crate::questions::answer::{Column, Entry};
use crate::questions::rows::Rows;

/// An archive that is being written: `columns`, `units`, `table` with a row for each case, `codes`.
pub struct Npz<'a> {
    columns: &'a [Column],
    members: Vec<Member>,
    /// Bytes so far.
    length: u32,
    /// The codes that occurred, the empty one first; the last number of a row says which it is.
    codes: Vec<&'static str>,
}

/// A file in the archive.
struct Member {
    name: &'static str,
    at: u32,
    size: u32,
    crc: u32,
}

/// More would need the extension of the format for large files.
const MOST_BYTES: u64 = 4_000_000_000;

/// Bytes of all names: each takes as much space as the longest.
const MOST_OF_NAMES: u64 = 100_000_000;

/// The numbers of a row: values and bounds, and the place of the code.
fn width(columns: &[Column]) -> u64 {
    columns.iter().map(|column| 1 + u64::from(has_bound(column))).sum::<u64>() + 1
}

impl<'a> Npz<'a> {
    /// The archive, and its bytes before the first row; `None` if there are more than fit into one.
    pub fn begin(columns: &'a [Column], cases: u64) -> Option<(Npz<'a>, Vec<u8>)> {
        let longest = columns.iter().map(|column| column.name.len().max(column.unit.len()) + "_bound".len()).max();
        let names = (longest.unwrap_or(0) as u64).saturating_mul(4 * width(columns));
        if cases.saturating_mul(8 * width(columns)) > MOST_BYTES || names > MOST_OF_NAMES {
            return None;
        }
        let mut npz = Npz { columns, members: Vec::new(), length: 0, codes: vec![""] };
        let (mut names, mut units) = (Vec::new(), Vec::new());
        for column in columns {
            names.push(column.name.clone());
            units.push(column.unit.as_str());
            if has_bound(column) {
                names.push(format!("{}_bound", column.name));
                units.push(&column.unit);
            }
        }
        names.push("code".into());
        units.push("");
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut out = npz.texts("columns.npy", &names);
        out.extend(npz.texts("units.npy", &units));
        let heading = npy("<f8", &format!("({cases}, {})", width(columns)));
        out.extend(npz.open("table.npy"));
        out.extend(npz.add(heading));
        Some((npz, out))
    }

    /// The bytes of the next rows.
    pub fn rows(&mut self, rows: &Rows) -> Vec<u8> {
        let mut numbers = Vec::with_capacity(rows.len() * 8 * width(self.columns) as usize);
        rows.for_each(|case| {
            for (column, entry) in self.columns.iter().zip(&case.entries) {
                let (value, bound) = number(entry);
                numbers.extend(value.to_le_bytes());
                if has_bound(column) {
                    numbers.extend(bound.to_le_bytes());
                }
            }
            let code = case.code.unwrap_or("");
            let place = self.codes.iter().position(|known| *known == code).unwrap_or_else(|| {
                self.codes.push(code);
                self.codes.len() - 1
            });
            numbers.extend((place as f64).to_le_bytes());
        });
        self.add(numbers)
    }

    /// The bytes behind the last row.
    pub fn end(mut self) -> Vec<u8> {
        let mut out = self.close();
        let codes = std::mem::take(&mut self.codes);
        out.extend(self.texts("codes.npy", &codes));
        let mut directory = Vec::new();
        for Member { name, at, size, crc } in &self.members {
            directory.extend(b"PK\x01\x02\x14\0");
            directory.extend(FORM);
            directory.extend([*crc, *size, *size, name.len() as u32].iter().flat_map(|number| number.to_le_bytes()));
            // No comment, the first disk, no attributes.
            directory.extend([0; 10]);
            directory.extend(at.to_le_bytes());
            directory.extend(name.as_bytes());
        }
        let count = (self.members.len() as u16).to_le_bytes();
        out.extend(&directory);
        out.extend(b"PK\x05\x06\0\0\0\0");
        out.extend([count, count].concat());
        out.extend([directory.len() as u32, self.length].iter().flat_map(|number| number.to_le_bytes()));
        out.extend([0; 2]);
        out
    }

    /// An array of texts.
    fn texts(&mut self, name: &'static str, texts: &[&str]) -> Vec<u8> {
        let longest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
        let mut array = npy(&format!("<U{longest}"), &format!("({},)", texts.len()));
        for text in texts {
            let padded = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest);
            array.extend(padded.flat_map(u32::to_le_bytes));
        }
        [self.open(name), self.add(array), self.close()].concat()
    }

    /// Begins a file, whose size and sum follow behind it.
    fn open(&mut self, name: &'static str) -> Vec<u8> {
        let header = [b"PK\x03\x04", &FORM[..], &[0; 12], &(name.len() as u32).to_le_bytes(), name.as_bytes()].concat();
        self.members.push(Member { name, at: self.length, size: 0, crc: !0 });
        self.length += header.len() as u32;
        header
    }

    /// Adds bytes to the open file.
    fn add(&mut self, bytes: Vec<u8>) -> Vec<u8> {
        self.length += bytes.len() as u32;
        if let Some(member) = self.members.last_mut() {
            member.size += bytes.len() as u32;
            member.crc = bytes.iter().fold(member.crc, |sum, byte| CRC[usize::from(sum as u8 ^ byte)] ^ (sum >> 8));
        }
        bytes
    }

    fn close(&mut self) -> Vec<u8> {
        let mut out = b"PK\x07\x08".to_vec();
        if let Some(member) = self.members.last_mut() {
            member.crc = !member.crc;
            out.extend([member.crc, member.size, member.size].iter().flat_map(|number| number.to_le_bytes()));
        }
        self.length += out.len() as u32;
        out
    }
}

/// Version 2.0, sizes behind the data, no compression, the first day that the format knows.
const FORM: [u8; 10] = [20, 0, 8, 0, 0, 0, 0, 0, 0x21, 0];

/// The heading of an array (NumPy's format 1.0): 64 bytes or a multiple.
fn npy(kind: &str, shape: &str) -> Vec<u8> {
    const OPENING: &[u8] = b"\x93NUMPY\x01\0";
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let length = (OPENING.len() + 2 + text.len() + 1).next_multiple_of(64) - OPENING.len() - 2;
    [OPENING, &(length as u16).to_le_bytes(), format!("{text:<width$}\n", width = length - 1).as_bytes()].concat()
}

/// The number and its bound as the CSV has them: NaN where there is none, an infinite bound where nothing is known; a verdict is one
/// or zero.
fn number(entry: &Entry) -> (f64, f64) {
    let (value, bound) = match *entry {
        Entry::Enclosed(value) => (JsonNumber::from_enclosure(value), JsonNumber::absolute_bound(value)),
        Entry::Unproven(value) => (JsonNumber::unproven(value), JsonNumber::NULL),
        Entry::Infinite => return (f64::INFINITY, f64::INFINITY),
        Entry::Verdict(holds) => return (f64::from(u8::from(holds)), f64::INFINITY),
        Entry::None(_) => (JsonNumber::NULL, JsonNumber::NULL),
    };
    (value.or(f64::NAN), bound.or(f64::INFINITY))
}

/// The remainder of each byte for a cyclic redundancy check (CRC-32 of ISO 3309, reflected).
const CRC: [u32; 256] = {
    let (mut table, mut byte) = ([0; 256], 0);
    while byte < 256 {
        let (mut sum, mut bit) = (byte as u32, 0);
        while bit < 8 {
            sum = (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg());
            bit += 1;
        }
        table[byte] = sum;
        byte += 1;
    }
    table
};
